//! Hard cases about spheres: far, near, huge and tiny ones, and frames at their poles.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3, Vec3};

use super::random::Random;
use super::stage::{U, camera, emitter, larger, picture, sphere, sum_agrees, weighted};
use super::{Case, Class, Effort, Figure};
use crate::math::orthonormal_basis;
use crate::scene::Scene;
use crate::shape::{Ray, sphere as shape};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N22",
        class: Class::Unit,
        guards: "A sphere is met or missed as in exact arithmetic, from next to it and from a million radii away.",
        run: from_afar,
    },
    Case {
        id: "N23",
        class: Class::Unit,
        guards: "Rays that start on a sphere, or next to it on either side, meet what they should and nothing else.",
        run: from_the_surface,
    },
    Case {
        id: "N24",
        class: Class::Unit,
        guards: "A tiny sphere far from the origin, and a sphere as large as a planet underfoot, are met where they are.",
        run: tiny_and_huge,
    },
    Case {
        id: "N25",
        class: Class::Statistical,
        guards: "A sphere covers as much of a picture, and of all directions, as geometry says.",
        run: coverage,
    },
    Case {
        id: "N26",
        class: Class::Unit,
        guards: "Frames are orthonormal around every normal, at the poles too.",
        run: frames,
    },
];

/// The first hit in (0, inf) of the very ray that is tested, in `f64`, from Lagrange's identity
/// |f|^2 |d|^2 = (f . d)^2 + |f x d|^2: the distance of the line from the centre comes from a cross product
/// and loses nothing by distance.
fn first_hit(ray: &Ray, center: Vec3, radius: f32) -> Option<f64> {
    let (f, d, r) = (ray.o.as_dvec3() - center.as_dvec3(), ray.d.as_dvec3(), f64::from(radius));
    let a = d.length_squared();
    let discriminant = r * r * a - f.cross(d).length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let (b, root) = (-f.dot(d), discriminant.sqrt());
    let outside = (f.length() - r) * (f.length() + r);
    let t = match (outside > 0.0, b > 0.0) {
        (true, true) => outside / (b + root),
        (true, false) => return None,
        (false, true) => (b + root) / a,
        (false, false) => outside / (b - root),
    };
    (t > 0.0).then_some(t)
}

/// What comparing many rays found.
#[derive(Default)]
struct Found {
    rays: u64,
    /// Hits where there is none, and none where there is a hit.
    wrong: u64,
    /// Largest relative error of a distance.
    t: f64,
    /// Largest distance of a hit point from the sphere, over the largest of its coordinates and the radius.
    off: f64,
}

impl Found {
    fn compare(&mut self, ray: &Ray, center: Vec3, radius: f32) {
        self.rays += 1;
        let found = shape::first_hit(ray, center, radius, false);
        let (found, expected) = match (found, first_hit(ray, center, radius)) {
            (Some(found), Some(expected)) => (found, expected),
            (None, None) => return,
            _ => {
                self.wrong += 1;
                return;
            }
        };
        self.t = self.t.max((f64::from(found) / expected - 1.0).abs());
        let (p, _, _) = shape::point(ray, found, center, radius);
        let off = ((p.as_dvec3() - center.as_dvec3()).length() - f64::from(radius)).abs();
        self.off = self.off.max(off / f64::from(center.abs().max_element().max(radius)));
    }

    fn figures(&self, what: &str, t: f64) -> Vec<Figure> {
        let what = format!("{} rays {what}", self.rays);
        vec![
            Figure::exactly(format!("{what}: hits and misses that are wrong"), self.wrong as f64, 0.0),
            Figure::at_most(format!("{what}: relative error of t"), self.t, t),
            Figure::at_most(
                format!("{what}: hit point off the sphere, of its coordinates"),
                self.off,
                4.0 * U,
            ),
        ]
    }
}

/// A ray from `origin` to a random point of the disc of `radius` around `center` that faces it.
fn aimed(random: &mut Random, origin: Vec3, center: Vec3, radius: f64) -> Ray {
    let axis = (center.as_dvec3() - origin.as_dvec3()).normalize();
    let (x, y) = axis.any_orthonormal_pair();
    let r = radius * random.unit().sqrt();
    let (s, c) = libm::sincos(std::f64::consts::TAU * random.unit());
    let d = center.as_dvec3() + x * (r * c) + y * (r * s) - origin.as_dvec3();
    Ray::new(origin, d.normalize().as_vec3())
}

fn from_afar(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N22");
    let mut figures = Vec::new();
    for distance in [1.01, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6] {
        let mut found = Found::default();
        for _ in 0..effort.trials(150_000) {
            let origin = random.direction() * distance as f32;
            found.compare(&aimed(&mut random, origin, Vec3::ZERO, 0.99), Vec3::ZERO, 1.0);
        }
        // The list allows 8e-7; nothing is rounded but t itself.
        figures.extend(found.figures(&format!("from {distance} radii"), 1.001 * U));
    }
    figures
}

fn from_the_surface(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N23");
    let (mut near, mut escapes) = (Found::default(), 0);
    let per_shell = effort.trials(25_000);
    for k in 5..=23 {
        for sign in [-1.0, 1.0] {
            let distance = 1.0 + sign / f64::from(1u32 << k);
            for _ in 0..per_shell {
                let o = (random.direction().as_dvec3().normalize() * distance).as_vec3();
                let ray = Ray::new(o, random.direction());
                let cos = o.dot(ray.d);
                let outside = o.as_dvec3().length() > 1.0;
                if outside && cos >= 0.0 {
                    escapes += u64::from(shape::first_hit(&ray, Vec3::ZERO, 1.0, false).is_some());
                } else if cos.abs() >= 1e-2 {
                    near.compare(&ray, Vec3::ZERO, 1.0);
                }
            }
        }
    }
    // Points that are exactly on a sphere: x^2 + y^2 + z^2 = r^2 in whole numbers.
    let exact = [[1, 2, 2, 3], [2, 3, 6, 7], [1, 4, 8, 9], [4, 4, 7, 9], [2, 6, 9, 11], [0, 3, 4, 5]];
    let (mut chord, mut outward) = (0.0f64, 0);
    let chords = effort.trials(200_000);
    for i in 0..chords {
        let [x, y, z, r] = exact[i as usize % exact.len()].map(|v: i32| v as f32);
        let bits = random.bits();
        let sign = |bit: u32, v: f32| if bits >> bit & 1 == 1 { -v } else { v };
        let o = Vec3::new(sign(0, x), sign(1, y), sign(2, z));
        let ray = Ray::new(o, random.direction());
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        let expected = -2.0 * o.dot(d) / d.length_squared();
        match shape::first_hit(&ray, Vec3::ZERO, r, true) {
            Some(_) if expected <= 0.0 => outward += 1,
            Some(t) => chord = chord.max((f64::from(t) / expected - 1.0).abs()),
            None if expected > 0.0 => chord = f64::INFINITY,
            None => {}
        }
    }
    let what = "that start 2^-5 to 2^-23 of the radius beside a sphere";
    // The list allows 1e-4. This close the discriminant is a difference, in `f64`, of numbers near one.
    let mut figures = near.figures(what, 2.0 * U);
    figures.push(Figure::exactly("hits of rays that start outside and go outwards", escapes as f64, 0.0));
    let what = format!("{chords} rays that leave points exactly on a sphere");
    figures.push(Figure::exactly(format!("{what}: hits outwards"), f64::from(outward), 0.0));
    figures.push(Figure::at_most(format!("{what}: relative error of the chord 2 R cos"), chord, 1.001 * U));
    figures
}

fn tiny_and_huge(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N24");
    let trials = effort.trials(200_000);
    let mut tiny = Found::default();
    for _ in 0..trials {
        // Coordinates of this size are multiples of 2^-7 metres: less than a radius.
        let center = random.direction() * 1e5;
        let distance = libm::exp(random.between(libm::log(0.05), libm::log(1e3))) as f32;
        let origin = center + random.direction() * distance;
        if (origin - center).length() > 0.011 {
            tiny.compare(&aimed(&mut random, origin, center, 0.99e-2), center, 1e-2);
        }
    }
    let mut figures = tiny.figures("at spheres of a centimetre, a hundred kilometres from the origin", 8e-7);

    let (eye, center, radius) = (Vec3::new(0.0, 1.7, 0.0), Vec3::new(0.0, -1e6, 0.0), 1e6f32);
    let height = f64::from(eye.y);
    let dip = libm::acos(f64::from(radius) / (f64::from(radius) + height));
    let mut huge = Found::default();
    for _ in 0..trials {
        // From straight down to just above the horizon, most of them near it.
        let angle = if random.bits() & 1 == 0 {
            random.between(0.0, 0.5 * PI)
        } else {
            dip * random.between(0.9, 1.2)
        };
        let (s, c) = libm::sincos(std::f64::consts::TAU * random.unit());
        let (down, ahead) = libm::sincos(angle);
        let ray = Ray::new(eye, DVec3::new(ahead * c, -down, ahead * s).as_vec3());
        huge.compare(&ray, center, radius);
    }
    figures.extend(huge.figures("at a ground of a thousand kilometres from 1.7 metres above", 8e-7));

    // Where hits begin, looking down from above the horizon.
    let at = |angle: f64| {
        let (down, ahead) = libm::sincos(angle);
        Ray::new(eye, DVec3::new(ahead, -down, 0.0).as_vec3())
    };
    let (mut above, mut below) = (0.0, 0.1);
    for _ in 0..60 {
        let middle = 0.5 * (above + below);
        if shape::first_hit(&at(middle), center, radius, false).is_some() {
            below = middle;
        } else {
            above = middle;
        }
    }
    // The tangent is as long as the eye is far from the centre, times the sine of its dip.
    let found = (f64::from(radius) + height) * libm::sin(below);
    let expected = (height * (2.0 * f64::from(radius) + height)).sqrt();
    figures.push(Figure::at_most(
        "relative error of the distance of the horizon",
        (found / expected - 1.0).abs(),
        1e-4,
    ));
    figures
}

/// Area of the outline of a sphere on the plane at distance one of a camera at the origin that looks along
/// -Z: an ellipse with the half axes of the cone's section.
fn outline(center: DVec3, radius: f64) -> f64 {
    let depth2 = center.z * center.z - radius * radius;
    PI * radius * radius * ((center.length_squared() - radius * radius) / depth2).sqrt() / depth2
}

fn coverage(effort: Effort) -> Vec<Figure> {
    let side = 256u32;
    let passes = effort.trials(16);
    let samples = u64::from(side * side) * passes;
    let extent = 2.0 * libm::tan(20f64.to_radians());
    let pixel = extent / f64::from(side);
    let mut figures = Vec::new();
    for (name, center) in [("ahead", DVec3::new(0.0, 0.0, -4.0)), ("aside", DVec3::new(0.3, -0.25, -4.0))] {
        let mut scene = Scene::default();
        sphere(&mut scene, center, 1.0, emitter(1.0));
        scene.cameras.push(camera(DAffine3::IDENTITY, 40.0, None));
        let image = picture(scene, "N25", [side; 2], passes);
        let mut agree = |what: &str, weight: &dyn Fn(f64, f64) -> f64, expected: f64| {
            let sum = image.as_ref().map_or((f64::NAN, f64::NAN), |(image, _)| weighted(image, weight));
            figures.extend(sum_agrees(&format!("{what} of a sphere {name}"), samples, sum, (expected, 5e-4)));
        };
        agree("outline", &|_, _| pixel * pixel, outline(center, 1.0));
        // The solid angle of a pixel is its area times the cube of the cosine; both vary little within one.
        let solid = |x: f64, y: f64| {
            let c = 1.0 / (1.0 + (x * x + y * y) * pixel * pixel).sqrt();
            pixel * pixel * c * c * c
        };
        let cos = (1.0 - 1.0 / center.length_squared()).sqrt();
        agree("solid angle", &solid, 2.0 * PI * (1.0 - cos));
    }
    figures
}

fn frames(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N26");
    let (mut dot, mut length, mut hand) = (0.0f64, 0.0f64, 1.0f64);
    let mut check = |n: Vec3| {
        let (s, t) = orthonormal_basis(n);
        let (n, s, t) = (n.as_dvec3(), s.as_dvec3(), t.as_dvec3());
        for v in [s.dot(t), s.dot(n), t.dot(n)] {
            dot = larger(dot, v);
        }
        for v in [s, t] {
            length = larger(length, v.length() - 1.0);
        }
        hand = hand.min(s.cross(t).dot(n));
    };
    let trials = effort.trials(1_000_000);
    for _ in 0..trials {
        check(random.direction());
    }
    // The poles, and what rounding makes of them.
    let tiny = f32::EPSILON;
    for z in [1.0, -1.0, 1.0 - 0.5 * tiny, -1.0 + 0.5 * tiny, -1.0 - tiny, 1.0 + tiny] {
        for x in [0.0, -0.0, tiny, -tiny, 1e-20, -1e-38, 1e-42] {
            for y in [0.0, -0.0, tiny, 1e-30] {
                check(Vec3::new(x, y, z));
            }
        }
    }
    for n in [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y] {
        check(n);
        check(Vec3::new(n.x, n.y, -0.0));
    }
    let mut poles = 0.0f64;
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for sign in [-1.0, 1.0] {
            let ray = Ray::new(axis * (3.0 * sign), axis * -sign);
            let found = shape::first_hit(&ray, Vec3::ZERO, 1.0, false).map_or(f64::NAN, |t| {
                let (p, p_err, n) = shape::point(&ray, t, Vec3::ZERO, 1.0);
                check(n);
                f64::from(
                    (p - n).length() + (n - axis * sign).length() + (p_err.max_element() - 4.0e-7).max(0.0),
                )
            });
            poles = larger(poles, found);
        }
    }
    let what = format!("{trials} normals, and the poles");
    vec![
        // The list allows 4 u. Normals are unit only to rounding, and the basis completes what it is given.
        Figure::at_most(format!("{what}: largest scalar product of two axes"), dot, 8.0 * U),
        Figure::at_most(format!("{what}: error of a length"), length, 8.0 * U),
        Figure::at_least(format!("{what}: smallest s x t . n"), hand, 1.0 - 8.0 * U),
        Figure::exactly("error of points and normals at the poles of a sphere", poles, 0.0),
    ]
}

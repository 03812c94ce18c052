//! What numerical accuracy costs: each robust choice beside its cheap twin, in time and in what the twin loses.
//!
//! In: nothing. Out: nanoseconds of both on this machine, and a count or an error that the twin has on inputs
//! made for it. Times are news, and decide nothing; counts and errors are the same everywhere.

use std::hint::black_box;
use std::time::Instant;

use glam::{DVec3, Vec3};

use super::random::Random;
use super::triangles::slivers::{aimed_at, in_own_box};
use crate::bsdf::fresnel;
use crate::integrate::report::{
    Slips, moeller_trumbore, offset_along_normal, schlick_outside_angle, sphere_pq,
};
use crate::light::Rectangle;
use crate::shape::triangle::Shear;
use crate::shape::{Ray, offset_origin, sphere};

/// A choice and its price.
#[derive(Clone, Debug, PartialEq)]
pub struct Price {
    /// What this renderer does.
    pub choice: &'static str,
    /// What it could do instead.
    pub twin: &'static str,
    /// Nanoseconds a call of the choice and of its twin.
    pub ns: [f64; 2],
    /// What the choice keeps away: its figure and the twin's.
    pub prevents: &'static str,
    /// The figures.
    pub figures: [f64; 2],
}

/// Rays or samples of each measurement.
const CALLS: usize = 200_000;

/// Measures all of them; takes about a second.
#[must_use]
pub fn prices() -> Vec<Price> {
    vec![triangle(), sliver(), sphere_test(), origin(), reflectance(), light()]
}

/// The fastest of a few passes over the inputs, nanoseconds a call: what else runs can only add to it.
fn time<T, R>(inputs: &[T], mut call: impl FnMut(&T) -> R) -> f64 {
    const PASSES: usize = 5;
    let pass = |_| {
        let begin = Instant::now();
        for input in inputs {
            black_box(call(black_box(input)));
        }
        begin.elapsed().as_secs_f64()
    };
    let best = (0..PASSES).map(pass).fold(f64::INFINITY, f64::min);
    1e9 * best / inputs.len().max(1) as f64
}

/// A ray, and two triangles with a common edge that it is aimed at.
type Crossing = (Ray, [Vec3; 3], [Vec3; 3]);

/// Rays at the common edge of two triangles that lie across their way: at least one must be hit.
fn triangle() -> Price {
    let mut random = Random::of("price of a triangle");
    let corner = |random: &mut Random| {
        Vec3::new(random.between(-1.0, 1.0) as f32, random.between(-1.0, 1.0) as f32, 0.0)
    };
    let mut inputs = Vec::with_capacity(CALLS);
    while inputs.len() < CALLS {
        // An edge, and a third corner on either side of it, tilted together so that no coordinate is zero.
        let (a, b) = (corner(&mut random), corner(&mut random));
        let across = Vec3::new(a.y - b.y, b.x - a.x, 0.0);
        let (c, d) = (a + across + (b - a) * 0.3, b - across * 0.7);
        let lift = |p: Vec3| Vec3::new(p.x, p.y, 5.0 + 0.3 * p.x - 0.2 * p.y);
        let [a, b, c, d] = [a, b, c, d].map(lift);
        let s = random.between(0.05, 0.95) as f32;
        let at = a + (b - a) * s;
        let ray = Ray::new(Vec3::ZERO, at.normalize());
        if across.length() > 0.1 {
            inputs.push((ray, [a, b, c], [b, a, d]));
        }
    }
    let shear = |(ray, one, other): &Crossing| {
        let shear = Shear::new(ray);
        let hit = |[a, b, c]: [Vec3; 3]| shear.intersect(a, b, c).is_some();
        hit(*one) | hit(*other)
    };
    let direct = |(ray, one, other): &Crossing| {
        let hit = |t: [Vec3; 3]| moeller_trumbore(ray.o, ray.d, t, Slips::NONE).is_some();
        hit(*one) | hit(*other)
    };
    let leaks = |hit: &dyn Fn(&Crossing) -> bool| {
        1e6 * inputs.iter().filter(|i| !hit(i)).count() as f64 / inputs.len() as f64
    };
    let figures = [leaks(&shear), leaks(&direct)];
    Price {
        choice: "watertight triangle test, in double precision",
        twin: "Moeller and Trumbore's",
        // Two triangles a call.
        ns: [0.5 * time(&inputs, shear), 0.5 * time(&inputs, direct)],
        prevents: "leaks of 1e6 rays at the edge between two triangles",
        figures,
    }
}

/// The watertight test as it was published: in single precision, and exact where an edge function is zero.
fn in_single_precision(shear: &Shear, v: [Vec3; 3]) -> Option<f32> {
    let [x, y, z] = shear.axes;
    let [a, b, c] = v.map(|v| {
        let v = v.to_array();
        let az = v[z] - shear.o[z];
        [v[x] - shear.o[x] - shear.s[0] * az, v[y] - shear.o[y] - shear.s[1] * az, az]
    });
    let edge = |a: [f32; 3], b: [f32; 3]| a[0] * b[1] - a[1] * b[0];
    let mut e = [edge(c, b), edge(a, c), edge(b, a)];
    if e.contains(&0.0) {
        let exact = |a: [f32; 3], b: [f32; 3]| {
            let [a, b] = [a, b].map(|v| v.map(f64::from));
            (a[0] * b[1] - a[1] * b[0]) as f32
        };
        e = [exact(c, b), exact(a, c), exact(b, a)];
    }
    let det = e[0] + e[1] + e[2];
    if (e.iter().any(|&e| e < 0.0) && e.iter().any(|&e| e > 0.0)) || det == 0.0 {
        return None;
    }
    let t = (e[0] * a[2] + e[1] * b[2] + e[2] * c[2]) * shear.s[2] / det;
    (t > 0.0 && t < f32::INFINITY).then_some(t)
}

/// A ray, and the triangle that it is aimed at.
type Aimed = (Ray, [Vec3; 3]);

/// Rays at triangles 1e-7 as high as they are long.
fn sliver() -> Price {
    let mut random = Random::of("price of a sliver");
    let input = |_| {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::new(random.unit(), 1e-7, 0.0)];
        aimed_at(&mut random, flat, 1.0, 1.0)
    };
    let inputs: Vec<Aimed> = (0..CALLS).filter_map(input).collect();
    let robust = |(ray, v): &Aimed| Shear::new(ray).intersect(v[0], v[1], v[2]).map(|h| h.t);
    let cheap = |(ray, v): &Aimed| in_single_precision(&Shear::new(ray), *v);
    let outside = |t: &dyn Fn(&Aimed) -> Option<f32>| {
        let beyond = |i: &&Aimed| t(i).is_some_and(|t| !in_own_box(&i.0, i.1, t.into()));
        1e6 * inputs.iter().filter(beyond).count() as f64 / inputs.len() as f64
    };
    let figures = [outside(&robust), outside(&cheap)];
    Price {
        choice: "watertight triangle test, in double precision",
        twin: "in single precision, exact where an edge is met",
        ns: [time(&inputs, robust), time(&inputs, cheap)],
        prevents: "hits of 1e6 rays beyond a triangle that is 1e-7 as high as it is long",
        figures,
    }
}

/// A unit sphere from ten thousand of its radii away, hit within 99 % of its disk.
fn sphere_test() -> Price {
    let mut random = Random::of("price of a sphere");
    let input = |_| {
        let toward = random.direction();
        let (center, side) = (toward * 1e4, random.direction());
        let offset = (side - toward * side.dot(toward)).normalize_or_zero() * (0.99 * random.unit_f32());
        (Ray::new(Vec3::ZERO, (center + offset).normalize()), center)
    };
    let inputs: Vec<(Ray, Vec3)> = (0..CALLS).map(input).collect();
    let robust = |(ray, c): &(Ray, Vec3)| sphere::first_hit(ray, *c, 1.0, false);
    let cheap = |(ray, c): &(Ray, Vec3)| sphere_pq(ray.o, ray.d, *c, 1.0).map(|t| t[0]);
    let misses = |hit: &dyn Fn(&(Ray, Vec3)) -> Option<f32>| {
        1e6 * inputs.iter().filter(|i| hit(i).is_none()).count() as f64 / inputs.len() as f64
    };
    let figures = [misses(&robust), misses(&cheap)];
    Price {
        choice: "sphere test in double precision from the closest approach",
        twin: "the pq formula in single precision",
        ns: [time(&inputs, robust), time(&inputs, cheap)],
        prevents: "misses of 1e6 rays at a sphere from 1e4 radii away",
        figures,
    }
}

/// How far a ray starts from where it should, on a surface a micrometre to a kilometre from the origin.
fn origin() -> Price {
    let mut random = Random::of("price of an origin");
    let input = |_| {
        let size = libm::exp10(random.between(-6.0, 3.0)) as f32;
        (random.direction() * size, random.direction(), random.direction())
    };
    let inputs: Vec<(Vec3, Vec3, Vec3)> = (0..CALLS).map(input).collect();
    let bound = |p: Vec3| p.abs() * crate::math::gamma(9);
    let robust = |(p, n, w): &(Vec3, Vec3, Vec3)| offset_origin(*p, bound(*p), *n, *w);
    let cheap = |(p, n, _): &(Vec3, Vec3, Vec3)| offset_along_normal(*p, *n, 0.04);
    let step = |of: &dyn Fn(&(Vec3, Vec3, Vec3)) -> Vec3| {
        inputs.iter().map(|i| f64::from((of(i) - i.0).length() / i.0.length())).fold(0.0, f64::max)
    };
    let figures = [step(&robust), step(&cheap)];
    Price {
        choice: "ray origins moved by their error bound",
        twin: "moved by 0.04 along the normal",
        ns: [time(&inputs, robust), time(&inputs, cheap)],
        prevents: "longest step, in distances from the origin of space",
        figures,
    }
}

/// Reflectance of glass of index 1.5 at all angles.
fn reflectance() -> Price {
    let inputs: Vec<f32> = (0..CALLS).map(|i| (i as f32 + 0.5) / CALLS as f32).collect();
    let exact = |&cos: &f32| fresnel::dielectric(cos, 1.5).0;
    let cheap = |&cos: &f32| schlick_outside_angle(1.0, 1.5, cos);
    let formula = |cos: f32| {
        let cos = f64::from(cos);
        let cos_t = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
        let (s, p) = ((cos - 1.5 * cos_t) / (cos + 1.5 * cos_t), (1.5 * cos - cos_t) / (1.5 * cos + cos_t));
        0.5 * (s * s + p * p)
    };
    let error = |of: &dyn Fn(&f32) -> f32| {
        inputs.iter().map(|&cos| (f64::from(of(&cos)) - formula(cos)).abs()).fold(0.0, f64::max)
    };
    let figures = [error(&exact), error(&cheap)];
    Price {
        choice: "Fresnel's equations",
        twin: "Schlick's approximation",
        ns: [time(&inputs, exact), time(&inputs, cheap)],
        prevents: "largest error of the reflectance of glass",
        figures,
    }
}

/// One sample of a square lamp of a metre from a tenth of a metre below its middle.
fn light() -> Price {
    let mut random = Random::of("price of a light");
    let inputs: Vec<[f32; 2]> = (0..CALLS).map(|_| [random.unit_f32(), random.unit_f32()]).collect();
    let p = Vec3::new(0.5, 0.5, -0.1);
    let Some(lamp) = Rectangle::new(Vec3::ZERO, [Vec3::Y, Vec3::X]) else {
        return Price { choice: "", twin: "", ns: [0.0; 2], prevents: "", figures: [f64::NAN; 2] };
    };
    let [a, b, _, d] = lamp.corners();
    let robust = |u: &[f32; 2]| lamp.sample(p, *u).map_or(0.0, |s| contribution(p, s.p, s.pdf));
    let cheap = |u: &[f32; 2]| {
        let q = a + (b - a) * u[0] + (d - a) * u[1];
        let v = q - p;
        // Density per area, one, as a density per solid angle.
        let pdf = v.length_squared() * v.length() / v.dot(lamp.normal()).abs();
        contribution(p, q, pdf)
    };
    let variation = |of: &dyn Fn(&[f32; 2]) -> f64| {
        let m: crate::stats::Moments = inputs.iter().map(of).collect();
        m.variance().sqrt() / m.mean
    };
    let figures = [variation(&robust), variation(&cheap)];
    Price {
        choice: "rectangular lamps sampled by solid angle",
        twin: "sampled by area",
        ns: [time(&inputs, robust), time(&inputs, cheap)],
        prevents: "deviation of one sample over its mean, 0.1 m from a lamp of 1 m",
        figures,
    }
}

/// What a point of a lamp gives to a surface at `p` that faces +Z.
fn contribution(p: Vec3, q: Vec3, pdf: f32) -> f64 {
    let wi = (q - p).normalize();
    f64::from(wi.z.max(0.0) / pdf)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards that each choice prevents what it is said to prevent, and that its twin does not.
    #[test]
    fn twins_lose_what_is_said() {
        let prices = prices();
        let figures: Vec<[f64; 2]> = prices.iter().map(|p| p.figures).collect();
        let [triangle, sliver, sphere, origin, fresnel, light] = figures[..] else { panic!("{figures:?}") };
        assert!(triangle[0] == 0.0 && triangle[1] > 1e4, "{triangle:?}");
        assert!(sliver[0] == 0.0 && sliver[1] > 100.0, "{sliver:?}");
        assert!(sphere[0] == 0.0 && sphere[1] > 1e4, "{sphere:?}");
        assert!(origin[0] < 1e-5 && origin[1] > 1e3, "{origin:?}");
        assert!(fresnel[0] < 4e-6 && fresnel[1] > 0.03, "{fresnel:?}");
        assert!(light[0] < 0.5 && light[1] > 2.0, "{light:?}");
    }
}

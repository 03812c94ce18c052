//! Light that must arrive, and light that must not: N09, N10 and N12.

use glam::{DVec3, Vec3};

use crate::accel::{Hit, PrimitiveId};
use crate::check::random::Random;
use crate::check::surfaces::{
    aimed, ball, barycentric, closed, cube, lamp, material, mesh, prepared, refused, square, tilted,
};
use crate::check::{Effort, Figure};
use crate::color::Rgb;
use crate::integrate::{Counters, kernel};
use crate::light::LightContext;
use crate::prepare::Prepared;
use crate::sampling::Address;
use crate::scene::{Environment, MaterialKind, Mesh, Principled, Scene};
use crate::shape::Ray;

/// The lights of N09.
const LAMPS: [&str; 4] = ["triangle", "rectangle", "box", "sphere"];

/// A floor (primitives 0 and 1) and one light at `distance` above the middle of it, to some side.
fn floor_and_lamp(r: &mut Random, lamp_is: &str, distance: f64) -> Option<Prepared> {
    let mut scene = Scene::default();
    let floor = material(&mut scene, MaterialKind::Diffuse { color: Rgb::grey(0.5) });
    mesh(&mut scene, square(DVec3::ZERO, 2.0, false), floor);
    let light = material(&mut scene, lamp(1.0));
    let mut d = r.direction().as_dvec3();
    d.y = d.y.abs().max(0.3);
    let middle = d.normalize() * distance;
    match lamp_is {
        "sphere" => ball(&mut scene, middle + DVec3::Y * 0.5, 0.5, light),
        "box" => mesh(&mut scene, cube(middle + DVec3::Y * 0.5, 1.0), light),
        "rectangle" => mesh(&mut scene, square(middle, 1.0, true), light),
        _ => {
            let mut m = square(middle, 1.0, true);
            m.triangles.pop();
            mesh(&mut scene, m, light);
        }
    }
    prepared(scene, DVec3::new(0.0, 1.0, 5.0), None)
}

/// N09. The ray ends on a light that may consist of many triangles, of which only the one that was chosen is
/// known to it.
pub(super) fn unobstructed(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N09");
    let n = effort.trials(5_000);
    let mut figures = Vec::new();
    for name in LAMPS {
        let (mut rays, mut occluded) = (0u64, 0u64);
        for k in -3..=6 {
            let Some(scene) = floor_and_lamp(&mut r, name, libm::exp10(f64::from(k))) else {
                figures.push(refused(name));
                continue;
            };
            for i in 0..n {
                let Some(blocked) = shadowed(&mut r, &scene, (i % 2) as u32) else { continue };
                rays += 1;
                occluded += u64::from(blocked);
            }
        }
        let place = format!("{name} light of 1 m, 1e-3 to 1e6 m away");
        figures.push(Figure::at_least(
            format!("shadow rays of {} points, {place}", 10 * n),
            rays as f64,
            n as f64,
        ));
        figures.push(Figure::exactly(format!("occluded of {rays} rays, {place}"), occluded as f64, 0.0));
    }
    figures
}

/// Whether a point of a triangle of the floor sees its light blocked; `None` where no light was sampled.
fn shadowed(r: &mut Random, scene: &Prepared, triangle: u32) -> Option<bool> {
    let id = PrimitiveId { instance: 0, primitive: triangle };
    let hit = Hit { t: 1.0, id, b: barycentric(r).map(|x| x as f32) };
    // A triangle's surface is a function of the hit alone.
    let s = scene.surface(&Ray::new(Vec3::Y, -Vec3::Y), &hit, false);
    let context =
        LightContext { p: s.p, p_err: s.p_err, from: id, ng: s.ng, ns: s.ns, wo: s.ng, transmits: false };
    let light = scene.lights.sample(&context, [r.unit_f32(), r.unit_f32(), r.unit_f32()])?;
    if light.wi.dot(s.ng) <= 0.0 {
        return None;
    }
    Some(scene.accel.occluded(&light.shadow_ray, [id, light.target]))
}

/// Radius of the resting ball, reflectance of its floor, and radiance of the lamp.
const BALL: f64 = 1.0;
const FLOOR: f32 = 0.5;
const LAMP: f32 = 10.0;
/// Distances from the point of contact.
const RINGS: [f64; 6] = [1e-3, 3e-3, 0.01, 0.02, 0.03, 0.05];

/// A black ball on the floor, which is tangent to it at the origin, and a spherical lamp.
fn resting(center: DVec3, radius: f64) -> Option<Prepared> {
    let mut scene = Scene::default();
    let floor = material(&mut scene, MaterialKind::Diffuse { color: Rgb::grey(FLOOR) });
    let black = material(&mut scene, MaterialKind::Diffuse { color: Rgb::BLACK });
    let light = material(&mut scene, lamp(LAMP));
    // Rays are moved off a floor by a share of its size, 3 units of rounding of half its edge. Were it 40 R wide, that
    // would be enough to narrow the wedge at 0.01 R by a fiftieth, and millions of samples see it.
    mesh(&mut scene, square(DVec3::ZERO, 4.0, false), floor);
    ball(&mut scene, DVec3::Y * BALL, BALL, black);
    ball(&mut scene, center, radius, light);
    prepared(scene, DVec3::new(0.0, 1.0, 5.0), Some(1))
}

/// Radiance that leaves the floor at `p`, by a midpoint sum over the cone of directions to the lamp.
fn lit_floor(p: DVec3, center: DVec3, radius: f64) -> f64 {
    const N: u32 = 512;
    let to = center - p;
    let sin2 = radius * radius / to.length_squared();
    let one_minus_cos = sin2 / (1.0 + (1.0 - sin2).sqrt());
    let axis = to.normalize();
    let (s, t) = axis.any_orthonormal_pair();
    let mut sum = 0.0;
    for i in 0..N {
        let c = 1.0 - one_minus_cos * (f64::from(i) + 0.5) / f64::from(N);
        let sin = ((1.0 - c) * (1.0 + c)).sqrt();
        for j in 0..N {
            let (sin_phi, cos_phi) =
                libm::sincos(std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(N));
            let w = axis * c + (s * cos_phi + t * sin_phi) * sin;
            // The floor is tangent to the ball: a ray meets it where it points below the horizon of both.
            let b = w.dot(DVec3::Y * BALL - p);
            let blocked = b > 0.0 && (DVec3::Y * BALL - p - w * b).length_squared() < BALL * BALL;
            if w.y > 0.0 && !blocked {
                sum += w.y;
            }
        }
    }
    let solid_angle = std::f64::consts::TAU * one_minus_cos;
    let irradiance = f64::from(LAMP) * solid_angle * sum / f64::from(N * N);
    f64::from(FLOOR) * irradiance * std::f64::consts::FRAC_1_PI
}

/// N10. The wedge between ball and floor is open by twice the distance from the contact, in radians; a lamp low
/// above the floor shines into it, one above the ball does not.
pub(super) fn contact(effort: Effort) -> Vec<Figure> {
    let n = effort.trials(8_000);
    let mut figures = Vec::new();
    for (place, center, radius) in
        [("above", DVec3::new(0.0, 6.0, 0.0), 0.8), ("near the horizon", DVec3::new(8.0, 0.55, 0.0), 0.5)]
    {
        let Some(scene) = resting(center, radius) else {
            figures.push(refused(place));
            continue;
        };
        let li = kernel(&scene.plan).li;
        for (ring, x) in RINGS.into_iter().enumerate() {
            // From the middle of the gap straight down: the floor is seen from nowhere else.
            let ray = Ray::new(Vec3::new(x as f32, (x * x / (4.0 * BALL)) as f32, 0.0), -Vec3::Y);
            let (mut sum, mut squares) = (0.0, 0.0);
            for i in 0..n {
                let address = Address::new(10, i, ring as u32, 0);
                let l = f64::from(li(&scene, address, ray, &mut Counters::default()).g);
                sum += l;
                squares += l * l;
            }
            let mean = sum / n as f64;
            let error = ((squares / n as f64 - mean * mean).max(0.0) / n as f64).sqrt();
            let expected = lit_floor(DVec3::new(f64::from(x as f32), 0.0, 0.0), center, radius);
            let what = format!("{n} samples, {x} R from the contact, lamp {place}");
            if expected == 0.0 {
                figures.push(Figure::exactly(format!("radiance in the umbra, {what}"), mean, 0.0));
                continue;
            }
            figures.push(Figure::at_most(
                format!("|z| of the radiance, {what}"),
                (mean - expected).abs() / error.max(1e-5 * expected),
                4.5,
            ));
        }
    }
    figures
}

/// The walls of N12.
fn walls() -> [(&'static str, MaterialKind); 3] {
    let rough =
        Principled { base_color: Rgb::grey(0.9), metallic: 1.0, roughness: 0.4, ..Principled::default() };
    [
        ("diffuse", MaterialKind::Diffuse { color: Rgb::grey(0.8) }),
        ("mirror", MaterialKind::Mirror { color: Rgb::grey(0.8) }),
        ("rough metal", MaterialKind::Principled(Box::new(rough))),
    ]
}

/// A round, closed room of radius one around the origin whose normals are bent by up to 60 degrees.
fn bent_room(r: &mut Random) -> Mesh {
    let (positions, triangles) = closed(16, Vec3::ZERO, || 1.0);
    let bend = |p: &Vec3| {
        let cos = libm::cos(std::f64::consts::FRAC_PI_3 * r.unit());
        tilted(r, p.normalize(), cos)
    };
    let normals = positions.iter().map(bend).collect();
    Mesh { positions, triangles, normals, ..Mesh::default() }
}

/// What many paths saw.
#[derive(Default)]
struct Seen {
    leaked: u64,
    refused: u64,
    lit: u64,
}

impl Seen {
    /// `n` paths through `ray`.
    fn of(scene: &Prepared, n: u64, mut ray: impl FnMut() -> Option<Ray>) -> Self {
        let li = kernel(&scene.plan).li;
        let mut seen = Self::default();
        for i in 0..n {
            let Some(ray) = ray() else { continue };
            let l = li(scene, Address::new(12, i, 0, 0), ray, &mut Counters::default());
            let channels = l.to_array();
            seen.leaked += u64::from(!l.is_black());
            seen.lit += u64::from(channels.iter().all(|&c| c > 0.0));
            seen.refused += u64::from(channels.iter().any(|&c| !(c >= 0.0 && c.is_finite())));
        }
        seen
    }
}

/// N12.
pub(super) fn bent_normals(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N12");
    let n = effort.trials(3_000);
    let mut figures = Vec::new();
    for (name, kind) in walls() {
        let room = bent_room(&mut r);
        let mut dark = Scene::default();
        let wall = material(&mut dark, kind);
        mesh(&mut dark, room, wall);
        let mut lit = dark.clone();
        dark.environment = Some(Environment {
            name: "sky".into(),
            radiance: Rgb::WHITE,
            image: None,
            visible_to_camera: true,
        });
        let light = material(&mut lit, lamp(1.0));
        ball(&mut lit, DVec3::new(0.2, 0.1, -0.1), 0.2, light);
        let (Some(dark), Some(lit)) = (prepared(dark, DVec3::ZERO, None), prepared(lit, DVec3::ZERO, None))
        else {
            figures.push(refused(name));
            continue;
        };
        let outside = |r: &mut Random| {
            let o = r.direction() * 3.0;
            aimed_within(r, o, 0.8)
        };
        let within = |r: &mut Random| Some(Ray::new(r.direction() * 0.5, r.direction()));
        let inside_dark = Seen::of(&dark, n, || within(&mut r));
        let outside_lit = Seen::of(&lit, n, || outside(&mut r));
        let inside_lit = Seen::of(&lit, n, || within(&mut r));
        let outside_dark = Seen::of(&dark, n, || outside(&mut r));
        let count = |what: &str, value: u64| {
            Figure::exactly(format!("{what} of {n} paths, {name} walls"), value as f64, 0.0)
        };
        figures.push(count("light from outside seen inside", inside_dark.leaked));
        figures.push(count("light from inside seen outside", outside_lit.leaked));
        let bad = inside_dark.refused + outside_lit.refused + inside_lit.refused + outside_dark.refused;
        figures.push(count("negative or not finite, in four lots", bad));
        // Or the three above would prove nothing.
        figures.push(Figure::at_least(
            format!("lit of {n} paths on the lit side, {name} walls"),
            inside_lit.lit.min(outside_dark.lit) as f64,
            0.1 * n as f64,
        ));
    }
    figures
}

/// A ray from `o` to a point of the ball of `radius` around the origin.
fn aimed_within(r: &mut Random, o: Vec3, radius: f64) -> Option<Ray> {
    let target = r.direction().as_dvec3() * (radius * r.unit());
    aimed(o, target)
}

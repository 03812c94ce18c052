//! Light through a ball of glass onto a floor, traced from the light.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::super::build::{Build, Probe, Shooter, apart, diffuse, emitter, glass, look_at};
use super::super::random::Random;
use super::super::{Effort, Figure};
use crate::scene::Scene;
use crate::stats::Moments;

/// The floor lies at z = 0, 8 on a side, and reflects half; on it the square of side two in the middle is looked at.
const FLOOR: f64 = 8.0;
const PATCH: f64 = 2.0;
const RHO: f64 = 0.5;
const BALL: DVec3 = DVec3::new(0.2, 0.1, 1.3);
const IOR: f64 = 1.5;
/// A black ball of radiance ten.
const LAMP: DVec3 = DVec3::new(0.5, 0.0, 4.0);
const RADIUS: f64 = 0.5;
const RADIANCE: f64 = 10.0;

/// Distance along a unit direction to a sphere around `c`, beyond what rounding may leave of the start.
fn sphere(o: DVec3, d: DVec3, c: DVec3, r: f64) -> Option<f64> {
    let to = c - o;
    let b = to.dot(d);
    let h2 = r * r - (to - d * b).length_squared();
    if h2 < 0.0 {
        return None;
    }
    [b - h2.sqrt(), b + h2.sqrt()].into_iter().find(|&t| t > 1e-9)
}

/// A direction about `n`, with the density of its cosine.
fn cosine(n: DVec3, random: &mut Random) -> DVec3 {
    let u = random.unit();
    let (s, c) = libm::sincos(TAU * random.unit());
    let (x, y) = n.any_orthonormal_pair();
    n * (1.0 - u).sqrt() + (x * c + y * s) * u.sqrt()
}

/// What a path from the lamp brings to the patch: the number of its visits, each with what the floor left of it.
fn path(random: &mut Random) -> f64 {
    let z = random.between(-1.0, 1.0);
    let (s, c) = libm::sincos(TAU * random.unit());
    let r = ((1.0 - z) * (1.0 + z)).sqrt();
    let n = DVec3::new(r * c, r * s, z);
    let (mut o, mut d) = (LAMP + n * RADIUS, cosine(n, random));
    let (mut weight, mut brought) = (1.0, 0.0);
    for _ in 0..200 {
        let lamp = sphere(o, d, LAMP, RADIUS).unwrap_or(f64::INFINITY);
        let ball = sphere(o, d, BALL, 1.0).unwrap_or(f64::INFINITY);
        let floor = if d.z < 0.0 && o.z > 1e-9 { -o.z / d.z } else { f64::INFINITY };
        if ball < lamp.min(floor) {
            o += d * ball;
            let n = o - BALL;
            let outside = d.dot(n) < 0.0;
            let (n, eta) = if outside { (n, IOR) } else { (-n, 1.0 / IOR) };
            let cos = -d.dot(n);
            let (reflectance, cos_t) = super::super::materials::exact(cos, eta);
            d = if random.unit() < reflectance {
                d + n * (2.0 * cos)
            } else {
                d / eta + n * (cos / eta - cos_t)
            };
            d = d.normalize();
        } else if floor < lamp {
            o += d * floor;
            if o.x.abs().max(o.y.abs()) > 0.5 * FLOOR {
                break;
            }
            if o.x.abs().max(o.y.abs()) < 0.5 * PATCH {
                brought += weight;
            }
            o.z = 0.0;
            weight *= RHO;
            d = cosine(DVec3::Z, random);
        } else {
            break;
        }
    }
    brought
}

/// N61.
pub(super) fn caustic(effort: Effort) -> Vec<Figure> {
    let mut scene = Scene::default();
    scene.square(DVec3::ZERO, DVec3::Z, FLOOR, diffuse(RHO as f32));
    scene.sphere(BALL, 1.0, glass(IOR as f32)).sphere(LAMP, RADIUS, emitter(RADIANCE as f32));
    let at = |i: usize, n: usize| ((i as f64 + 0.5) / n as f64 - 0.5) * PATCH;
    let (rows, columns) = (64, 65);
    let points =
        (0..rows * columns).map(|i| DVec3::new(at(i / columns, rows), at(i % columns, columns), 0.0));
    let probes: Vec<Probe> = points.map(|p| look_at(p, DVec3::Z, 1e-3)).collect();
    let rendered = Shooter::new("N61", &scene, None).map(|s| s.mean(&probes, effort.trials(1 << 20)));
    let mut random = Random::of("N61");
    let paths = effort.trials(100_000);
    let power = 4.0 * PI * RADIUS * RADIUS * PI * RADIANCE;
    let to_radiance = RHO / PI / (PATCH * PATCH) * power;
    let batch = |_| (0..paths).map(|_| path(&mut random)).sum::<f64>() / paths as f64 * to_radiance;
    let traced: Moments = (0..16).map(batch).collect();
    let [off, z] = rendered.map_or([f64::NAN; 2], |rendered| {
        [(rendered.mean / traced.mean - 1.0).abs(), apart(&rendered, &traced)]
    });
    // Half a per cent takes the paths of a night.
    let most = if effort == Effort::Usual { 0.02 } else { 0.005 };
    vec![
        Figure::at_most("radiance of the floor and light tracing: relative difference", off, most),
        Figure::at_most("radiance of the floor and light tracing: standard errors apart", z, 4.5),
    ]
}

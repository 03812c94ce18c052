//! The choice of a light, and of a way to find it.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3, Vec3};

use super::super::build::{Build, Shooter, diffuse, emitter, look_at, worst, z_score};
use super::super::random::Random;
use super::super::{Effort, Figure};
use crate::accel::PrimitiveId;
use crate::color::Rgb;
use crate::integrate::mis_weight;
use crate::light::{Emitter, LightContext, LightId, LightSet, SphereLight};
use crate::scene::{AreaShape, LightKind, Scene};

fn context(p: Vec3) -> LightContext {
    let n = Vec3::Z;
    LightContext { p, p_err: Vec3::ZERO, from: PrimitiveId::NONE, ng: n, ns: n, wo: n, transmits: false }
}

/// How far the mean of what single samples bring is from the irradiance of `count` point lights, one of them 1e6 times
/// as strong as the others; relative.
fn many(count: usize, samples: u32) -> f64 {
    let mut random = Random::of(&format!("N53 {count}"));
    let mut irradiance = 0.0;
    let mut groups = Vec::new();
    for i in 0..count {
        let strength = if i == count / 3 { 1e6 } else { 1.0 };
        let at = [random.between(-10.0, 10.0), random.between(-10.0, 10.0), random.between(1.0, 5.0)];
        let position = DVec3::from_array(at).as_vec3();
        let d = position.as_dvec3();
        irradiance += strength * d.z / (d.length_squared() * d.length());
        groups.push(vec![Emitter::Point { position, intensity: Rgb::grey(strength as f32), spot: None }]);
    }
    let set = LightSet::new(groups, 0, 10.0);
    let mut brought = 0.0;
    // Even numbers, not random ones: each light is met as often as its probability says, to one.
    for i in 0..samples {
        if let Some(s) = set.sample(&context(Vec3::ZERO), [(i as f32 + 0.5) / samples as f32, 0.5, 0.5]) {
            brought += f64::from(s.weight.g * s.wi.z);
        }
    }
    (brought / f64::from(samples) / irradiance - 1.0).abs()
}

/// What a white receiver under two lamps, and what is no light, sends back; relative to what it should.
fn odd_lights() -> [f64; 2] {
    let mut scene = Scene::default();
    scene.square(DVec3::ZERO, DVec3::Z, 1.0, diffuse(1.0));
    let lamp = |scene: &mut Scene, at: DVec3, intensity: f32| {
        let kind = LightKind::Point { intensity: Rgb::grey(intensity), radius: 0.0 };
        scene.light(kind, DAffine3::from_translation(at));
    };
    lamp(&mut scene, 2.0 * DVec3::Z, 4.0);
    // Without power, turned away, below the floor, without area: none of these lights anything.
    lamp(&mut scene, DVec3::Z, 0.0);
    scene.square(DVec3::new(0.3, 0.0, 1.0), DVec3::Z, 0.1, emitter(5.0));
    scene.square(DVec3::new(0.3, 0.0, -1.0), DVec3::Z, 0.1, emitter(5.0));
    scene.square(DVec3::new(-0.3, 0.0, 1.0), -DVec3::Z, 0.1, emitter(0.0));
    let flat = [DVec3::Z, DVec3::Z + DVec3::X, DVec3::Z + 2.0 * DVec3::X];
    scene.mesh(&flat, vec![[0, 1, 2]], emitter(7.0));
    // Nor does a sphere that stands next to the mesh without area in every list.
    scene.sphere(DVec3::new(1.0, 0.0, 0.5), 0.2, diffuse(0.0));
    let black = LightKind::Area { shape: AreaShape::Rectangle, size: [1.0; 2], radiance: Rgb::BLACK };
    scene.light(black, DAffine3::from_translation(DVec3::new(0.0, 1.0, 3.0)));
    let ray = look_at(DVec3::new(0.01, 0.02, 0.0), DVec3::Z, 0.5);
    let d = DVec3::new(-0.01, -0.02, 2.0);
    let expected = 4.0 * d.z / (d.length_squared() * d.length()) / PI;
    let mean = |scene: &Scene| {
        let shooter = Shooter::new("N53 odd lights", scene, None)?;
        Some(shooter.mean(&[ray], 1 << 14))
    };
    let lit = mean(&scene).map_or(f64::NAN, |m| {
        // All that is left is the noise of the choice: single samples of the lamp or of nothing.
        z_score((m.mean - expected).abs(), &m)
    });
    let mut dark = Scene::default();
    dark.square(DVec3::ZERO, DVec3::Z, 1.0, diffuse(1.0));
    [lit, mean(&dark).map_or(f64::NAN, |m| m.mean)]
}

/// N53.
pub(super) fn choice(_: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (count, samples) in [(2, 1 << 16), (50, 1 << 20), (10_000, 1 << 20)] {
        let brought = many(count, samples);
        figures.push(Figure::at_most(
            format!("irradiance of {count} lights, one 1e6 times as strong: relative error"),
            brought,
            1e-3,
        ));
    }
    figures.extend(probabilities());
    let [lit, dark] = odd_lights();
    figures.push(Figure::at_most("a lamp among lights without power or area: standard errors off", lit, 4.5));
    figures.push(Figure::exactly("radiance where there is no light", dark, 0.0));
    figures.push(Figure::exactly("what an empty set samples", empty(), 0.0));
    figures
}

fn empty() -> f64 {
    let set = LightSet::new(Vec::new(), 0, 1.0);
    (0..100).filter(|&i| set.sample(&context(Vec3::ZERO), [i as f32 / 100.0; 3]).is_some()).count() as f64
}

/// The sum of all probabilities less one, and how far a sample's probability is from that which is asked for later.
fn probabilities() -> Vec<Figure> {
    let mut random = Random::of("N53 probabilities");
    let (mut off, mut same) = (0f64, 0f64);
    for count in [1usize, 3, 64, 65, 10_000] {
        let mut groups = Vec::new();
        for i in 0..count {
            let center = random.direction() * random.between(2.0, 50.0) as f32;
            let radiance = Rgb::grey(if i == count / 2 { 1e6 } else { 1.0 });
            let shape = SphereLight { center, radius: random.between(0.1, 0.9) as f32 };
            let (both_sides, visible_to_camera) = (false, true);
            groups.push(vec![Emitter::Sphere {
                shape,
                radiance,
                both_sides,
                spot: None,
                primitive: None,
                visible_to_camera,
            }]);
        }
        let set = LightSet::new(groups, 0, 50.0);
        for _ in 0..10 {
            let ctx = context(random.direction() * random.unit_f32());
            let mut sum = 0.0;
            for (i, e) in set.emitters().iter().enumerate() {
                let Emitter::Sphere { shape, .. } = e else { continue };
                // Choice and direction together, less the direction: the choice alone.
                let alone = shape.pdf(ctx.p, false, shape.center, Vec3::Z);
                sum += f64::from(set.pdf(&ctx, LightId(i as u32), shape.center, Vec3::Z) / alone);
            }
            off = worst([off, (sum - 1.0).abs()]);
            for _ in 0..100 {
                let u = [random.unit_f32(), random.unit_f32(), random.unit_f32()];
                let Some(s) = set.sample(&ctx, u) else { continue };
                // The shadow ray ends on the light that was chosen.
                let end = s.shadow_ray.at(s.shadow_ray.t_max);
                let near = |e: &Emitter| match e {
                    Emitter::Sphere { shape, .. } => {
                        ((end - shape.center).length() / shape.radius - 1.0).abs()
                    }
                    _ => f32::INFINITY,
                };
                let chosen = set.emitters().iter().enumerate().min_by(|a, b| near(a.1).total_cmp(&near(b.1)));
                let Some((i, _)) = chosen else { continue };
                let pdf = set.pdf(&ctx, LightId(i as u32), end, Vec3::Z);
                same = worst([same, f64::from(pdf / s.pdf - 1.0).abs()]);
            }
        }
    }
    vec![
        Figure::at_most("sum of the probabilities of 1 to 1e4 lights: less one", off, 1e-6),
        Figure::at_most(
            "density of 5e3 samples, and the density asked for later: relative difference",
            same,
            1e-5,
        ),
    ]
}

/// N54.
pub(super) fn weights(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N54");
    let (mut off, mut outside) = (0f64, 0.0);
    let mut look = |a: f32, b: f32| {
        let (wa, wb) = (mis_weight(a, b), mis_weight(b, a));
        outside += f64::from(!((0.0..=1.0).contains(&wa) && (0.0..=1.0).contains(&wb)));
        off = worst([off, (f64::from(wa) + f64::from(wb) - 1.0).abs()]);
    };
    let pairs = effort.trials(1_000_000);
    for _ in 0..pairs {
        let density = |r: &mut Random| libm::exp(r.between(-69.0, 69.0)) as f32;
        let (a, b) = (density(&mut random), density(&mut random));
        look(a, b);
        // Most pairs above are far apart; these are close.
        look(a, a * (0.5 + random.unit_f32()));
    }
    let mut limits = 0f64;
    for own in [1e-30, 1.0, 1e30f32] {
        limits = worst([limits, f64::from((mis_weight(own, 0.0) - 1.0).abs())]);
        limits = worst([limits, f64::from(mis_weight(own, f32::INFINITY))]);
    }
    vec![
        Figure::at_most(
            format!("weights of {:e} pairs of densities, 1e-30..1e30: sum less one", 2 * pairs),
            off,
            1e-6,
        ),
        Figure::exactly("weights outside 0..1, or not numbers", outside, 0.0),
        Figure::exactly("weights where the other density is none or infinite: error", limits, 0.0),
    ]
}

//! Hard cases about lights: what arrives at a point, against closed forms.

mod choice;
mod extent;

pub(super) use extent::chi_square_p;

use std::f64::consts::{FRAC_PI_4, PI, SQRT_2};

use glam::{DVec3, Vec3};

use super::build::{Build, Probe, Shooter, beside, diffuse, emitter, look_at, worst};
use super::closed_forms::{polygon_irradiance, sphere_irradiance};
use super::random::Random;
use super::{Case, Class, Effort, Figure};
use crate::accel::PrimitiveId;
use crate::light::{LightContext, SphereLight};
use crate::scene::Scene;

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N47",
        class: Class::Unit,
        guards: "The solid angle of triangles, large and tiny, seen from the front and edge-on.",
        run: extent::triangles,
    },
    Case {
        id: "N48",
        class: Class::Unit,
        guards: "Rectangles: the density is one over the solid angle, and samples are distributed accordingly.",
        run: extent::rectangles,
    },
    Case {
        id: "N49",
        class: Class::Statistical,
        guards: "Square lights on a diffuse point: close, far, beside, cut by the horizon.",
        run: squares,
    },
    Case {
        id: "N50",
        class: Class::Statistical,
        guards: "One light sample is no noisier than a uniform direction towards the light, also next to it.",
        run: noise,
    },
    Case {
        id: "N51",
        class: Class::Statistical,
        guards: "Sphere lights: below the horizon, tiny, touching the receiver, and from inside.",
        run: spheres,
    },
    Case {
        id: "N52",
        class: Class::Statistical,
        guards: "Area to area: form factors of squares that face each other and that share an edge.",
        run: form_factors,
    },
    Case {
        id: "N53",
        class: Class::Unit,
        guards: "The choice of a light: probabilities, lights without area or power, ten thousand lights, none.",
        run: choice::choice,
    },
    Case {
        id: "N54",
        class: Class::Unit,
        guards: "Weights of two ways to find a light sum to one at every density, none and infinite ones included.",
        run: choice::weights,
    },
];

/// A white receiver at the origin, tilted towards +X; it is small, to stand clear of the lights, and the ray avoids
/// its diagonal. Its radiance is the irradiance over pi.
fn receiver(scene: &mut Scene, tilt: f64) -> Probe {
    let n = tilted(tilt);
    scene.square(DVec3::ZERO, n, 1e-3, diffuse(1.0));
    look_at(1e-6 * n.any_orthonormal_vector(), n, 1e-5)
}

fn tilted(tilt: f64) -> DVec3 {
    DVec3::new(libm::sin(tilt), 0.0, libm::cos(tilt))
}

/// The list's O04 f is left out: it has a value (0.460072152) and no set-up. O05 is irradiance times d^2.
fn squares(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    let aside = DVec3::new(0.25, 0.0, 1.0);
    for (id, center, tilt, scale, listed) in [
        ("O04 a", DVec3::Z, 0.0, 1.0, 0.752_274_688),
        ("O04 b", DVec3::new(1.0, 0.5, 1.0), 0.0, 1.0, 0.215_455_970),
        ("O04 c", 0.01 * DVec3::Z, 0.0, 1.0, 3.140_564_683),
        ("O04 d", aside, 30.0, 1.0, 0.673_495_767),
        ("O04 e", aside, 90.0, 1.0, 0.159_242_507),
        ("O05, distance 4", 4.0 * DVec3::Z, 0.0, 16.0, 0.979_612_178),
        ("O05, distance 16", 16.0 * DVec3::Z, 0.0, 256.0, 0.998_699_694),
        ("O05, distance 64", 64.0 * DVec3::Z, 0.0, 4096.0, 0.999_918_627),
        ("O05, distance 1024", 1024.0 * DVec3::Z, 0.0, 1_048_576.0, 0.999_999_682),
    ] {
        let tilt = f64::to_radians(tilt);
        let mut scene = Scene::default();
        scene.quad(center, DVec3::Y, DVec3::X, emitter(1.0));
        let ray = receiver(&mut scene, tilt);
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let irradiance =
            polygon_irradiance(&corners.map(|(x, y)| center + DVec3::new(x, y, 0.0)), tilted(tilt));
        let listed_off = (irradiance * scale - listed).abs();
        let shooter = Shooter::new(&format!("N49 {id}"), &scene, Some(1));
        let mean = shooter.map(|s| s.mean(&[ray], effort.trials(1 << 16)));
        figures.push(Figure::at_most(format!("{id}: closed form and list"), listed_off, 1e-8));
        figures.extend(beside(&format!("{id}: square light"), mean, irradiance / PI, 1e-5, 0.003));
    }
    figures
}

/// The coefficient of variation of one light sample on a point below the middle of a unit square. Sampling the area
/// would have up to sixty times as much.
fn noise(effort: Effort) -> Vec<Figure> {
    let one = |h: f64, uniform: f64| {
        let mut scene = Scene::default();
        scene.square(DVec3::ZERO, DVec3::Z, 1e-3, diffuse(1.0));
        scene.quad(h * DVec3::Z, DVec3::Y, DVec3::X, emitter(1.0));
        let n = Vec3::Z;
        let from = PrimitiveId::NONE;
        let context =
            LightContext { p: Vec3::ZERO, p_err: Vec3::ZERO, from, ng: n, ns: n, wo: n, transmits: false };
        let cv = Shooter::new("N50", &scene, Some(1)).map_or(f64::NAN, |shooter| {
            let mut random = Random::of(&format!("N50 {h}"));
            let (mut sum, mut squares) = (0.0, 0.0);
            let count = effort.trials(200_000);
            for _ in 0..count {
                let u = [random.unit_f32(), random.unit_f32(), random.unit_f32()];
                let value = shooter
                    .prepared
                    .lights
                    .sample(&context, u)
                    .map_or(0.0, |s| f64::from(s.weight.g * s.wi.z.max(0.0)));
                (sum, squares) = (sum + value, squares + value * value);
            }
            let mean = sum / count as f64;
            (squares / count as f64 - mean * mean).max(0.0).sqrt() / mean
        });
        Figure::at_most(format!("variation of one light sample, square light {h} above"), cv, 1.05 * uniform)
    };
    vec![one(0.01, 0.5524), one(0.1, 0.4045), one(1.0, 0.0433), one(16.0, 2.1e-4)]
}

fn spheres(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (id, radius, distance, tilt, listed) in [
        ("O07 a", 0.5, 1.0, 0.0, FRAC_PI_4),
        ("O07 b", 0.5, 1.0, 45.0, 0.555_360_367),
        ("O07 c", 0.5, 1.0, 80.0, 0.171_831_975),
        ("O07 d", 0.5, 1.0, 90.0, 0.090_586_074),
        ("O07 e", 0.5, 1.0, 110.0, 0.006_753_066),
        ("O07 f", 1.0, 1.001, 90.0, 1.481_450_382),
        ("O07 g", 1e-6, 1.0, 60.0, 1.570_796e-12),
        ("O07 h", 1.0, 1.0001, 0.0, 3.140_964_429),
    ] {
        let mut scene = Scene::default();
        scene.sphere(distance * DVec3::Z, radius, emitter(1.0));
        let tilt = f64::to_radians(tilt);
        let ray = receiver(&mut scene, tilt);
        let irradiance = sphere_irradiance(radius, distance, tilt);
        // Nine decimals, or the seven digits of what is smaller.
        let listed_off = (irradiance - listed).abs() / (1e-6 * listed).min(6e-10);
        let shooter = Shooter::new(&format!("N51 {id}"), &scene, Some(1));
        let mean = shooter.map(|s| s.mean(&[ray], effort.trials(1 << 16)));
        figures.push(Figure::at_most(format!("{id}: closed form and list, in last digits"), listed_off, 1.0));
        figures.extend(beside(&format!("{id}: sphere light"), mean, irradiance / PI, 1e-5, 0.003));
    }
    figures.extend(sphere_densities());
    figures
}

/// Densities from outside against the cone, and from inside, where they must cover all directions.
fn sphere_densities() -> Vec<Figure> {
    let outside = [(1.0, 2.0), (1e-6, 1.0), (1.0, 1.0001), (1.0, 1.000_001), (1e-3, 50.0), (1e4, 2e4f32)];
    let off = worst(outside.map(|(r, d)| {
        let light = SphereLight { center: Vec3::Z * d, radius: r };
        let ratio = f64::from(r) / f64::from(d);
        let one_minus_cos = ratio * ratio / (1.0 + (1.0 - ratio * ratio).sqrt());
        let sample = light.sample(Vec3::ZERO, false, [0.3, 0.7]);
        sample.map_or(f64::NAN, |s| {
            let same = light.pdf(Vec3::ZERO, false, s.p, s.n) == s.pdf;
            if same { (f64::from(s.pdf) * 2.0 * PI * one_minus_cos - 1.0).abs() } else { f64::NAN }
        })
    }));
    let mut random = Random::of("N51 inside");
    let mut bad = 0.0;
    let mut whole = 0f64;
    for i in 0..40 {
        // From the middle to next to the surface.
        let p = random.direction() * (1.0 - libm::exp(-0.25 * f64::from(i))) as f32;
        let light = SphereLight { center: Vec3::ZERO, radius: 1.0 };
        let (n, mut sum) = (300, 0.0);
        for k in 0..n * n {
            let u = [(k % n) as f32 + 0.5, (k / n) as f32 + 0.5].map(|x| x / n as f32);
            match light.sample(p, false, u) {
                Some(s) if s.pdf > 0.0 && s.pdf.is_finite() => sum += 1.0 / f64::from(s.pdf),
                _ => bad += 1.0,
            }
        }
        // The middle of a cell stands for it only where the sphere is not next to the point.
        if i < 10 {
            whole = whole.max((sum / f64::from(n * n) / (4.0 * PI) - 1.0).abs());
        }
    }
    vec![
        Figure::at_most("density of sphere lights from outside: relative error", off, 1e-5),
        Figure::exactly("samples from inside without a finite density, of 3.6e6", bad, 0.0),
        Figure::at_most("directions that samples from inside cover: relative error", whole, 1e-3),
    ]
}

/// O09, unit squares (Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", C-11 and C-14).
fn form_factors(effort: Effort) -> Vec<Figure> {
    let angle = libm::atan(1.0 / SQRT_2);
    let facing = 2.0 / PI * (0.5 * libm::log(4.0 / 3.0) + 2.0 * SQRT_2 * angle - 0.5 * PI);
    let corner = (0.5 * PI - SQRT_2 * angle + 0.25 * libm::log(0.75)) / PI;
    let mut figures = Vec::new();
    for (id, center, n, expected, listed) in [
        ("O09 facing", DVec3::new(0.5, 0.5, 1.0), -DVec3::Z, facing, 0.199_824_895_698),
        ("O09 corner", DVec3::new(0.0, 0.5, 0.5), DVec3::X, corner, 0.200_043_776_075),
    ] {
        let mut scene = Scene::default();
        scene.square(DVec3::new(0.5, 0.5, 0.0), DVec3::Z, 1.0, diffuse(1.0));
        scene.square(center, n, 1.0, emitter(1.0));
        // Two numbers without a common factor: no point lies on the square's diagonal.
        let (rows, columns) = (64, 65);
        let at = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        let points =
            (0..rows * columns).map(|i| DVec3::new(at(i / columns, rows), at(i % columns, columns), 0.0));
        let probes: Vec<Probe> = points.map(|p| look_at(p, DVec3::Z, 1e-4)).collect();
        let shooter = Shooter::new(&format!("N52 {id}"), &scene, Some(1));
        let mean = shooter.map(|s| s.mean(&probes, effort.trials(1 << 19)));
        figures.push(Figure::at_most(
            format!("{id}: closed form and list"),
            (expected - listed).abs(),
            1e-11,
        ));
        // The grid of points itself stands for the square to a few millionths.
        figures.extend(beside(&format!("{id}: form factor"), mean, expected, 4e-5, 0.002));
    }
    figures
}

//! Hard cases about transport: closed rooms, what a depth is, roulette, emitters in shells, mirrors.

mod caustic;
mod ways;

use glam::{DVec3, Vec3};

use super::build::{Build, Probe, Shooter, beside, diffuse, glowing, mirror, probe, sky, worst};
use super::random::Random;
use super::{Case, Class, Effort, Figure};
use crate::accel::{PrimitiveId, RayKind};
use crate::bsdf::Transport;
use crate::color::Rgb;
use crate::integrate::survive;
use crate::math::Frame;
use crate::prepare::ROULETTE_START;
use crate::scene::Scene;
use crate::shape::{Ray, offset_origin};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N55",
        class: Class::Statistical,
        guards: "A light is as bright however it is found: by itself, by chance, or by both ways together.",
        run: ways::ways,
    },
    Case {
        id: "N56",
        class: Class::Statistical,
        guards: "Interreflection: rooms whose walls emit what they absorb have radiance one everywhere.",
        run: closed_rooms,
    },
    Case {
        id: "N57",
        class: Class::Unit,
        guards: "What a depth is: k scattering events add the first k terms of the series, no more and no less.",
        run: capped_rooms,
    },
    Case {
        id: "N58",
        class: Class::Statistical,
        guards: "Roulette: paths that go on make up for those that end, and no path is made to shine.",
        run: roulette,
    },
    Case {
        id: "N59",
        class: Class::Statistical,
        guards: "Small emitters in large shells: area, distance and the factor 1/pi of the light that is sampled.",
        run: shells,
    },
    Case {
        id: "N60",
        class: Class::Unit,
        guards: "Mirrors in a row keep the colour, mirrors in a corner the direction.",
        run: mirrors,
    },
    Case {
        id: "N61",
        class: Class::Statistical,
        guards: "Light that glass focuses on a floor is as bright as paths from the light say.",
        run: caustic::caustic,
    },
];

/// A room that reflects `rho` and emits the rest.
fn room(shape: &str, rho: f32) -> Scene {
    let walls = glowing(rho, 1.0 - rho);
    let mut scene = Scene::default();
    match shape {
        "sphere" => scene.sphere(DVec3::ZERO, 1.0, walls),
        "cube" => scene.prism(4, std::f64::consts::SQRT_2, [-1.0, 1.0], walls),
        _ => scene.prism(6, 1.2, [-0.8, 0.7], walls),
    };
    scene
}

const ROOMS: [&str; 3] = ["sphere", "cube", "hexagonal"];

/// Rays from within, towards no corner.
fn within() -> [Probe; 3] {
    let from = DVec3::new(0.1, 0.2, 0.3);
    [[0.5, -0.3, 0.7], [-0.7, 0.1, 0.2], [0.2, 0.9, -0.4]].map(|d| probe(from, DVec3::from_array(d)))
}

/// O02: the walls' radiance after at most `depth` events.
fn series(rho: f32, depth: Option<u32>) -> f64 {
    let rho = f64::from(rho);
    1.0 - depth.map_or(0.0, |k| (0..=k).fold(1.0, |p, _| p * rho))
}

fn closed_rooms(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    for shape in ROOMS {
        // Single paths vary by half of the mean and more, for roulette ends them: 0.3 % (1 % of the brightest room)
        // takes the samples of a night. Where nothing is wrong the usual ones come to within 2 or 3 %.
        for (rho, usual, nightly, samples) in [
            (0.5, 0.003, 0.003, 1 << 14),
            (0.8, 0.02, 0.003, 1 << 14),
            (0.9, 0.02, 0.003, 1 << 14),
            (0.99, 0.03, 0.01, 1 << 12),
        ] {
            let most = if effort == Effort::Usual { usual } else { nightly };
            let what = format!("{shape} room, reflectance {rho}");
            let shooter = Shooter::new(&format!("N56 {what}"), &room(shape, rho), None);
            let mean = shooter.map(|s| s.mean(&within(), effort.trials(samples)));
            figures.extend(beside(&what, mean, 1.0, 4e-6, most));
        }
    }
    figures
}

fn capped_rooms(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    for shape in ROOMS {
        for depth in [0, 1, 2, 3, 8] {
            let what = format!("{shape} room, reflectance 0.5, at most {depth} events");
            let shooter = Shooter::new(&format!("N57 {what}"), &room(shape, 0.5), Some(depth));
            let samples = if depth > 3 { 1 << 14 } else { 1 << 12 };
            let mean = shooter.map(|s| s.mean(&within(), effort.trials(samples)));
            figures.extend(beside(&what, mean, series(0.5, Some(depth)), 4e-6, 0.002));
        }
    }
    figures
}

/// The renderer has one roulette, which starts after the fourth event and cannot be set. So its means, of paths that
/// end by it before a cap or after it, are held against the closed form; caps of one and three know no roulette.
fn roulette(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    for depth in [Some(1), Some(3), Some(8), Some(20), None] {
        let what = depth.map_or("no cap".into(), |k| format!("at most {k} events"));
        let shooter = Shooter::new(&format!("N58 {what}"), &room("cube", 0.9), depth);
        let mean = shooter.map(|s| s.mean(&within(), effort.trials(1 << 15)));
        // As in N56: where roulette plays a part 0.3 % takes the samples of a night.
        let rare = effort == Effort::Usual && depth.is_none_or(|k| k > 3);
        figures.extend(beside(&what, mean, series(0.9, depth), 4e-6, if rare { 0.02 } else { 0.003 }));
    }
    let mut random = Random::of("N58");
    let (mut mean_off, mut largest) = (0f64, 0f64);
    for _ in 0..200 {
        let beta = libm::exp(random.between(-9.0, 0.0)) as f32;
        let eta_scale = [1.0, 2.25, 1.0 / 2.25][(random.bits() % 3) as usize];
        let n = 4096;
        let scales = (0..n).filter_map(|i| {
            survive(Rgb::grey(beta), eta_scale, 9, ROULETTE_START, (i as f32 + 0.5) / n as f32)
        });
        let mut sum = 0.0;
        for scale in scales {
            sum += f64::from(scale);
            // Where the throughput is above one already, roulette leaves it alone.
            largest = largest.max(f64::from(scale * (beta * eta_scale).min(1.0)));
        }
        // One step of the numbers that roulette is played with may fall on either side.
        let step = 1.0 / f64::from(n) / f64::from((beta * eta_scale).min(1.0)).sqrt();
        mean_off = mean_off.max((sum / f64::from(n) - 1.0).abs() / step);
    }
    figures.extend([
        Figure::at_most(
            "mean factor of 4096 even numbers less one, in steps, 200 throughputs",
            mean_off,
            1.0,
        ),
        Figure::at_most("largest throughput that roulette made, 200 throughputs", largest, 1.0 + 1e-6),
    ]);
    figures
}

/// O03: an emitter of radiance `le` in the middle of a shell of reflectance `rho`; `x` is the squared ratio of radii.
fn shells(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (id, outer, inner, le, rho, own, listed) in [
        ("O03 a", 1.0, 0.1, 10.0, 0.8, 0.0, 0.384_615_385),
        ("O03 b", 1.0, 0.01, 1000.0, 0.5, 0.0, 0.099_990_001),
        ("O03 c", 1.0, 0.5, 1.0, 0.5, 0.3, 0.212_765_957),
        ("O03 d", 1e4, 100.0, 1e4, 0.8, 0.0, 3.998_400_640),
    ] {
        let x = (inner / outer) * (inner / outer);
        let expected = rho * x * le / (1.0 - rho * (1.0 - x) - rho * own * x);
        let mut scene = Scene::default();
        scene.sphere(DVec3::ZERO, outer, diffuse(rho as f32));
        scene.sphere(DVec3::ZERO, inner, glowing(own as f32, le as f32));
        let ray = probe(DVec3::new(0.9 * outer, 0.0, 0.0), DVec3::X);
        let shooter = Shooter::new(&format!("N59 {id}"), &scene, None);
        let mean = shooter.map(|s| s.mean(&[ray], effort.trials(1 << 17)));
        let what = format!("{id}: emitter of radius {inner} in a shell of radius {outer}");
        figures.push(Figure::at_most(
            format!("{id}: closed form and list"),
            (expected - listed).abs(),
            6e-10,
        ));
        figures.extend(beside(&what, mean, expected, 4e-6, 0.003));
    }
    figures
}

fn mirrors(effort: Effort) -> Vec<Figure> {
    let mut figures = row(effort);
    let rays = effort.trials(20_000);
    let (off, other) = corner(rays).unwrap_or((f64::NAN, f64::NAN));
    figures.extend([
        Figure::at_most(
            format!("O17: radians off the way back, corner of mirrors, {rays:e} rays"),
            off,
            1e-6,
        ),
        Figure::exactly("O17: rays that did not meet three mirrors", other, 0.0),
    ]);
    figures
}

/// O16: twenty reflections of 0.9 between parallel mirrors, and out. Roulette ends most of these paths, which the
/// list did not foresee; what survives is the closed form over the chance to survive, each time.
fn row(effort: Effort) -> Vec<Figure> {
    let mut scene = Scene { environment: sky(1.0), ..Scene::default() };
    let (u, v) = (20.0 * DVec3::X, 2.0 * DVec3::Y);
    scene.quad(DVec3::new(-10.0, 0.0, 0.0), u, v, mirror(0.9));
    scene.quad(DVec3::new(-10.0, 0.0, 1.0), u, -v, mirror(0.9));
    let ray = probe(DVec3::new(-20.25, 0.0, 0.5), DVec3::new(1.0, 0.0, 1.0));
    let shooter = Shooter::new("N60", &scene, None);
    let expected = (0..20).fold(1.0, |p, _| p * 0.9);
    let (mut beta, mut chance) = (1.0f32, 1.0f64);
    for depth in 1..=20 {
        beta *= 0.9;
        let scale = survive(Rgb::grey(beta), 1.0, depth, ROULETTE_START, 0.0).unwrap_or(f32::NAN);
        (beta, chance) = (beta * scale, chance / f64::from(scale));
    }
    let survivors = shooter.as_ref().map_or(vec![f64::NAN], |s| {
        let all = (0..10_000).map(|i| f64::from(s.radiance(&ray, 0, 0, i)[1]));
        all.filter(|&l| l != 0.0).collect()
    });
    let off = worst(survivors.iter().map(|l| (l * chance / expected - 1.0).abs()));
    let mean = shooter.map(|s| s.mean(&[ray], effort.trials(1 << 17)));
    let [_, z] = beside("O16: 20 mirrors of 0.9, mean", mean, expected, 4e-6, 0.0);
    vec![
        Figure::at_least("O16: paths that roulette let live, of 1e4", survivors.len() as f64, 100.0),
        Figure::at_most("O16: relative error of each, the chance to live taken into account", off, 2e-6),
        z,
    ]
}

/// Rays into a corner of three mirrors: how far from straight back they come out, and how many met other than three.
fn corner(rays: u64) -> Option<(f64, f64)> {
    let mut scene = Scene::default();
    for (n, u) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::Z, DVec3::X)] {
        let v = n.cross(u);
        scene.quad(20.0 * (u + v), 40.0 * u, 40.0 * v, mirror(1.0));
    }
    let shooter = Shooter::new("N60 corner", &scene, None)?;
    let scene = &shooter.prepared;
    let mut random = Random::of("N60 corner");
    let (mut off, mut other) = (0f64, 0.0);
    for _ in 0..rays {
        let aim = Vec3::new(random.unit_f32(), random.unit_f32(), random.unit_f32()) * 0.5 + 0.05;
        let d = -random.direction().abs().max(Vec3::splat(0.05)).normalize();
        let mut ray = Ray::new(aim, d);
        let (mut from, mut met) = (PrimitiveId::NONE, 0);
        while let Some(hit) = scene.accel.closest(&ray, from, RayKind::Other) {
            let surface = scene.surface(&ray, &hit, false);
            let frame = Frame::from_z(surface.ns);
            let bsdf = &scene.materials[scene.material_of(surface.object) as usize].bsdf;
            let sample = bsdf.sample(frame.to_local(-ray.d), [0.5; 3], Transport::Radiance)?;
            let wi = frame.to_world(sample.wi).normalize();
            ray = Ray::new(offset_origin(surface.p, surface.p_err, surface.ng, wi), wi);
            (from, met) = (surface.id, met + 1);
            if met > 3 {
                break;
            }
        }
        off = worst([off, ray.d.as_dvec3().cross(d.as_dvec3()).length()]);
        other += f64::from(met != 3);
    }
    Some((off, other))
}

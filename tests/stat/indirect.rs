//! Indirect light by photons against paths: no gap, nothing twice, and a bias that vanishes.

use epsilux::color::Rgb;
use epsilux::glam::DVec3;
use epsilux::integrate::{Quiet, RenderOptions, render};
use epsilux::math::mix64;
use epsilux::prepare::{Algorithms, CausticsMode, Indirect, prepare};
use epsilux::scene::text::parse_toml;
use epsilux::scene::{AlphaMode, Principled, Scene};
use epsilux::stats::{Moments, sidak_each, student_two_sided, welch};

use crate::agree::enlarge;
use crate::support::compare::keep;
use crate::support::fast::{options, valid};
use crate::support::features;
use crate::support::scenes::{Build, emitter, principled};
use crate::support::seed::seed;

/// Chance that a scene fails although nothing is wrong.
const ALPHA: f64 = 1e-4;

/// Runs of each.
const RUNS: u32 = 6;

/// Side of the pictures, pixels.
const SIDE: usize = 32;

/// The whole picture and its quarters.
type Parts = [Moments; 5];

/// Means of the parts over runs of some passes.
fn means(name: &str, scene: &Scene, algorithms: Algorithms, passes: std::ops::Range<u32>) -> Parts {
    let mut means = [Moments::default(); 5];
    for run in 0..RUNS {
        let mut options = options([SIDE as u32; 2], mix64(seed(name) ^ u64::from(run)), Some(10));
        options.algorithms = algorithms;
        let prepared = prepare(scene, &options).expect("a camera");
        assert_eq!(prepared.plan.indirect, algorithms.indirect);
        let passes = RenderOptions { threads: 1, ..RenderOptions::passes(passes.clone()) };
        let outcome = render(&prepared, &passes, &Quiet).expect("passes");
        assert_eq!(outcome.film.refused_total(), 0, "{:?}", outcome.bad);
        let mut sums = [0.0; 5];
        for (i, rgb) in outcome.film.to_image().rgb.iter().enumerate() {
            let light = rgb.to_array().iter().map(|&v| f64::from(v)).sum::<f64>();
            let quarter = usize::from(2 * (i % SIDE) >= SIDE) + 2 * usize::from(2 * (i / SIDE) >= SIDE);
            sums[0] += light;
            sums[1 + quarter] += 4.0 * light;
        }
        means.iter_mut().zip(sums).for_each(|(m, s)| m.add(s / (3 * SIDE * SIDE) as f64));
    }
    means
}

/// Renders by paths, by photons of the first passes and by those of late ones, whose radius is a fifth; late ones may
/// differ by what noise explains and by `bias`, which the first ones do not reach, and the whole has to be sharp enough to
/// see `bound`.
fn check(name: &str, scene: &Scene, caustics: CausticsMode, passes: [u32; 2], bounds: [f64; 2]) {
    check_from(16_384, name, scene, caustics, passes, bounds);
}

/// The same, where late passes are those from `late_from` on.
fn check_from(
    late_from: u32,
    name: &str,
    scene: &Scene,
    caustics: CausticsMode,
    [photons, paths]: [u32; 2],
    [bias, bound]: [f64; 2],
) {
    let algorithms = |indirect| Algorithms { caustics, indirect, ..Algorithms::PATHS };
    let by_paths = means(name, scene, algorithms(Indirect::Path), 0..paths);
    let early = means(name, scene, algorithms(Indirect::Photon), 0..photons);
    let late = means(name, scene, algorithms(Indirect::Photon), late_from..late_from + photons);
    let limit = sidak_each(ALPHA, late.len());
    let mut wrong = String::new();
    for (i, (a, b)) in late.iter().zip(&by_paths).enumerate() {
        let found = welch(a, b).expect("runs");
        let difference = (a.mean - b.mean).abs();
        let left = (difference - bias * b.mean).max(0.0);
        let p = if left == 0.0 { 1.0 } else { student_two_sided(found.t * left / difference, found.freedom) };
        if p < limit {
            wrong += &format!(" part {i}: {:+.2} %, p {p:.1e};", 100.0 * (a.mean / b.mean - 1.0));
        }
    }
    let relative = |m: &Moments| 100.0 * (m.mean / by_paths[0].mean - 1.0);
    let sigma = |m: &Moments| m.variance_of_mean().sqrt() / by_paths[0].mean;
    let seen = 8.0 * (sigma(&late[0]) * sigma(&late[0]) + sigma(&by_paths[0]) * sigma(&by_paths[0])).sqrt();
    let report = format!(
        "{name}: {:+.2} % in the first passes, {:+.2} % in late ones, sees {:.1} %",
        relative(&early[0]),
        relative(&late[0]),
        100.0 * seen
    );
    keep(&format!("indirect, {name}"), &report);
    assert!(wrong.is_empty(), "{report}\n  {wrong}");
    assert!(seen < bound, "{report}: too noisy");
    // Nearer than at first, where that was far.
    let [early, late] = [&early[0], &late[0]].map(|m| (m.mean - by_paths[0].mean).abs() / by_paths[0].mean);
    assert!(late < early.max(seen), "{report}");
}

fn file(text: &str) -> Scene {
    parse_toml(text).expect("a scene of the project").0
}

/// Guards diffuse interreflection, where the map is all there is.
#[test]
fn diffuse_rooms() {
    let cornell = file(include_str!("../../scenes/cornell.toml"));
    check("cornell", &cornell, CausticsMode::Path, [128, 160], [0.004, 0.03]);
    let hexroom = file(include_str!("../../scenes/hexroom-diffuse.toml"));
    check("hexroom-diffuse", &hexroom, CausticsMode::Path, [128, 160], [0.004, 0.03]);
}

/// Guards glossy and layered materials, mirrors and glass on the way to the map and from it.
#[test]
fn materials() {
    let mut scene = file(include_str!("../../scenes/materials.toml"));
    scene.settings.max_depth = None;
    check("materials", &valid(&scene), CausticsMode::Path, [96, 128], [0.006, 0.06]);
}

/// Guards each way that has a caustic in it: with a map of caustics beside, and without.
#[test]
fn caustics_beside() {
    let mut hexroom = file(include_str!("../../scenes/hexroom.toml"));
    enlarge(&mut hexroom, "light", 4.8);
    check("hexroom", &hexroom, CausticsMode::Path, [96, 128], [0.006, 0.06]);
    check("hexroom, both by photons", &hexroom, CausticsMode::Photon, [96, 48], [0.006, 0.06]);
}

/// Guards absorption, textures and every kind of light.
#[test]
fn everything_at_once() {
    let scene = valid(&features::everything());
    check("everything", &scene, CausticsMode::Photon, [128, 96], [0.004, 0.06]);
}

/// Guards rough glass and rough metal, which make dots of photons: a few passes have to show the light that there is, so
/// that the path goes on there.
#[test]
fn rough_glass_and_metal() {
    let rough = |change: &dyn Fn(&mut Principled)| {
        let mut scene = features::stage();
        scene.sphere(features::MIDDLE, 1.0, principled(change));
        valid(&scene)
    };
    let glass = rough(&|p| (p.transmission, p.roughness) = (1.0, 0.5));
    check("rough glass", &glass, CausticsMode::Photon, [128, 96], [0.004, 0.03]);
    let sheet = rough(&|p| (p.transmission, p.roughness, p.thin) = (0.8, 0.3, true));
    check("sheet", &sheet, CausticsMode::Photon, [128, 96], [0.004, 0.1]);
}

/// Guards surfaces of which a share is there, for photons as for paths: counted twice, it would take a tenth of the
/// light in a ball whose wall reflects where it is, and lets light out where it is not. Where disks are small that is
/// lost in noise.
#[test]
fn walls_that_are_partly_there() {
    let mut scene = Scene::default();
    let wall = principled(|p| {
        (p.base_color, p.specular, p.roughness) = (Rgb::grey(0.9), 0.0, 1.0);
        (p.alpha, p.alpha_mode) = (0.5, AlphaMode::Blend);
    });
    scene.sphere(DVec3::ZERO, 3.0, wall);
    // Out of sight.
    scene.sphere(DVec3::new(0.0, 1.0, 2.0), 0.5, emitter(2.0));
    scene.cameras.push(features::camera(2.0 * DVec3::Z, DVec3::ZERO, 50.0));
    check_from(8, "walls", &valid(&scene), CausticsMode::Path, [512, 512], [0.004, 0.12]);
}

//! Photons against paths, and against closed forms: no gap, and nothing twice.

use epsilux::check::closed_forms::slab_transmittance;
use epsilux::color::Rgb;
use epsilux::glam::{DAffine3, DVec3};
use epsilux::prepare::{Algorithms, Caustics, CausticsMode};
use epsilux::scene::{LightKind, MaterialKind, Scene, Shape, SpotFalloff};
use epsilux::stats::Moments;

use crate::support::estimators::{Estimators, judge, means};
use crate::support::fast::{options, valid};
use crate::support::features::{self, MIDDLE, camera, dark_stage};
use crate::support::scenes::{Build, diffuse, facing, glass, mirror, principled};
use crate::support::seed::seed;

/// Compares light tracing with paths on each scene of a list.
fn check_all(scenes: Vec<(String, Scene)>, samples: [u32; 2], bound: impl Fn(&str) -> f64) {
    assert!(!scenes.is_empty());
    let check = |(name, scene): &(String, Scene)| {
        let report = Estimators {
            name,
            scene: &valid(scene),
            size: [8, 8],
            max_depth: Some(12),
            runs: 6,
            unbiased: true,
            samples,
            bound: bound(name),
            bias: 0.0,
        }
        .compare();
        println!("{}", report.as_ref().unwrap_or_else(|e| e));
        report.err()
    };
    let failures: Vec<String> = scenes.iter().filter_map(check).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Replaces the material of the object before the last light or of the ball of a stage.
fn with_ball(mut scene: Scene, kind: MaterialKind) -> Scene {
    let ball = scene
        .objects
        .iter()
        .find(|o| matches!(o.shape, Shape::Sphere { radius: 1.0 }) && o.transform.translation == MIDDLE)
        .expect("the ball of a stage");
    scene.materials[ball.material.0 as usize].kind = kind;
    scene
}

fn has_delta_light(name: &str) -> bool {
    matches!(name, "point" | "spot" | "spot with Blender's falloff" | "sharp sun")
}

/// Guards emission from every kind of light that paths can meet, aimed at a ball of glass.
#[test]
fn lights_through_glass() {
    let with_ball = |(name, scene): (String, Scene)| {
        let ball = scene
            .objects
            .iter()
            .any(|o| matches!(o.shape, Shape::Sphere { radius: 1.0 }) && o.transform.translation == MIDDLE);
        ball.then(|| (name, with_ball(scene, glass(1.5))))
    };
    let scenes = features::lights().into_iter().filter(|(name, _)| !has_delta_light(name));
    check_all(scenes.filter_map(with_ball).collect(), [256, 2048], |_| 0.2);
}

/// Guards pictures of the sky as a source of photons.
#[test]
fn panoramas_through_glass() {
    let scenes = features::panoramas().into_iter().filter(|(name, _)| !name.contains("mirror"));
    let glass_ball = |(name, scene)| (name, with_ball(scene, glass(1.5)));
    check_all(scenes.map(glass_ball).collect(), [256, 2048], |_| 0.3);
}

/// Guards what every material without roughness does to photons: tints, absorption, sheets, metals, mixtures.
#[test]
fn materials_throw_light() {
    let plain = ["mirror", "clear glass", "absorbing glass", "absorber of index one", "bubble"];
    let throws = |name: &str| {
        let smooth = name.ends_with("roughness 0") || name.contains("index one");
        smooth && !name.contains("dark metal") || plain.contains(&name)
    };
    let scenes = features::materials().into_iter().filter(|(name, _)| throws(name));
    check_all(scenes.collect(), [256, 2048], |_| 0.3);
}

/// Guards coats: what a layer takes from light that is refracted below it, either way.
#[test]
fn coats_throw_light() {
    let throws =
        ["smooth coat over a rough base", "rough coat over a smooth base", "smooth coat over smooth metal"];
    let mut scenes: Vec<_> =
        features::layers().into_iter().filter(|(name, _)| throws.contains(&name.as_str())).collect();
    // Light that enters at one angle and leaves at another is dimmed by that at which it leaves.
    let coated = principled(|p| {
        (p.coat, p.coat_ior, p.coat_roughness) = (1.0, 2.5, 0.3);
        (p.roughness, p.transmission) = (0.0, 1.0);
    });
    scenes.push((
        "strong coat over smooth glass".to_owned(),
        with_ball(features::layers().remove(0).1, coated),
    ));
    check_all(scenes, [256, 2048], |_| 0.3);
}

/// Guards shapes and cameras: instances, interpolated normals that bend light, hidden objects, lens and
/// orthographic views.
#[test]
fn shapes_and_cameras() {
    let kinds = |name: &str| {
        if name.contains("instances") || name.contains("mesh") { None } else { Some(glass(1.5)) }
    };
    let scenes = features::shapes_and_cameras().into_iter().filter_map(|(name, scene)| match kinds(&name) {
        None if name.contains("glass") => Some((name, scene)),
        None => None,
        Some(kind) => Some((name, with_ball(scene, kind))),
    });
    check_all(scenes.collect(), [256, 2048], |_| 0.3);
}

/// Guards what features do to each other.
#[test]
fn everything_at_once() {
    let mut scene = features::everything();
    // Paths cannot find these behind glass.
    let delta = |kind: &LightKind| match kind {
        LightKind::Point { radius: extent, .. }
        | LightKind::Spot { radius: extent, .. }
        | LightKind::Sun { angle: extent, .. } => *extent == 0.0,
        LightKind::Area { .. } => false,
    };
    scene.lights.retain(|l| !delta(&l.kind));
    check_all(vec![("everything".to_owned(), scene)], [512, 512], |_| 0.3);
}

fn photons(unbiased: bool) -> Algorithms {
    Algorithms { caustics: CausticsMode::Photon, unbiased }
}

/// Guards lights that paths cannot find at all: they give what the same light gives that is a little wide.
#[test]
fn lights_without_extent() {
    let above = DVec3::new(2.0, 4.0, 1.0);
    let aim = facing(above, (above - MIDDLE).normalize());
    let color = Rgb::new(8.0, 6.0, 3.0);
    let spot =
        |falloff, radius| LightKind::Spot { intensity: color, inner: 0.1, outer: 0.3, falloff, radius };
    let pairs = [
        ("point", [0.0, 0.01].map(|radius| LightKind::Point { intensity: color, radius })),
        ("spot", [0.0, 0.01].map(|radius| spot(SpotFalloff::Gltf, radius))),
        ("spot, Blender", [0.0, 0.01].map(|radius| spot(SpotFalloff::Blender, radius))),
        ("sun", [0.0, 0.01].map(|angle| LightKind::Sun { irradiance: color, angle })),
    ];
    for (name, kinds) in pairs {
        let [sharp, wide] = kinds.map(|kind| {
            let mut scene = dark_stage();
            scene.sphere(MIDDLE, 1.0, glass(1.5)).light(kind, aim);
            let base = options([8, 8], seed(name), None);
            means(&valid(&scene), &base, photons(true), 6, 256, Caustics::Traced)
        });
        let report = judge(name, &sharp, &wide, 0.2, 0.0).unwrap_or_else(|e| panic!("{e}"));
        println!("{report}");
    }
}

/// A wide slab of glass between a light and a floor of reflectance `rho`, with a camera below it that sees the
/// floor, and nothing but it.
fn slab(rho: f32, kind: LightKind, transform: DAffine3) -> Scene {
    let mut scene = Scene::default();
    scene.square(DVec3::ZERO, DVec3::Y, 40.0, diffuse(rho));
    scene.cuboid(DVec3::new(-6.0, 3.0, -6.0), DVec3::new(6.0, 3.5, 6.0), glass(1.5));
    scene.light(kind, transform);
    scene.cameras.push(camera(DVec3::new(0.0, 2.8, 0.0), DVec3::new(0.0, 0.0, 0.001), 80.0));
    scene
}

fn expect(name: &str, found: &Moments, expected: f64, bias: f64) {
    let sigma = found.variance_of_mean().sqrt();
    println!("{name}: {:.6} +- {sigma:.6}, expected {expected:.6}", found.mean);
    // Six runs: t of five degrees of freedom passes 9 with a chance of 3e-4.
    assert!((found.mean - expected).abs() < 9.0 * sigma + bias * expected, "{name}");
    assert!(sigma < 0.006 * expected, "{name}: too noisy");
}

/// Guards the scale of photons by closed forms: a sun through a slab of glass makes the floor as bright as the
/// slab's transmittance has it. Seen directly that is light tracing, in a mirror it is the photon map, whose
/// kernel has no bias where the light is the same all over.
#[test]
fn a_slab_lets_through_what_it_should() {
    let (towards, angle) = (DVec3::new(0.6, 0.8, 0.0), libm::acos(0.8));
    let sun = LightKind::Sun { irradiance: Rgb::grey(2.0), angle: 0.0 };
    let rho = 0.02;
    // What the floor reflects comes back from the slab by less than a fifth: 0.4 % of rho.
    let expected = 2.0 * 0.8 * slab_transmittance(angle, 1.5, 1.0) * f64::from(rho) / std::f64::consts::PI;
    let direct = slab(rho, sun, facing(DVec3::ZERO, towards));
    let mut mirrored = direct.clone();
    // An upright mirror that the sun passes edge-on, and in it the floor.
    mirrored.cameras[0] = camera(DVec3::new(0.0, 2.8, 0.0), DVec3::new(0.0, 1.8, -1.0), 40.0);
    mirrored.square(DVec3::new(0.0, 1.5, -1.0), DVec3::Z, 2.9, mirror(1.0));
    for (name, scene, unbiased, plan) in [
        ("slab, seen directly", &direct, true, Caustics::Traced),
        ("slab, seen in a mirror", &mirrored, false, Caustics::Photon),
    ] {
        let base = options([32, 32], seed(name), None);
        let found = means(&valid(scene), &base, photons(unbiased), 6, 128, plan);
        expect(name, &found[0], expected, 0.004);
    }
}

#[test]
fn scratch() {
    let pick = ["plastic, roughness 0", "weak layer, roughness 0", "strong tinted layer, roughness 0"];
    let scenes: Vec<_> =
        features::materials().into_iter().filter(|(name, _)| pick.contains(&name.as_str())).collect();
    check_all(scenes, [1024, 4096], |_| 0.3);
}

fn file(text: &str) -> Scene {
    epsilux::scene::text::parse_toml(text).expect("a scene of the project").0
}

#[test]
fn scratch_rooms() {
    let text = include_str!("../../scenes/hexroom.toml");
    for unbiased in [true, false] {
        let report = Estimators {
            name: "hexroom",
            scene: &file(text),
            size: [48, 48],
            max_depth: None,
            runs: 6,
            unbiased,
            samples: [16, 256],
            bound: 0.3,
            bias: 0.0,
        }
        .compare();
        println!("{unbiased} {}", report.unwrap_or_else(|e| e));
    }
}

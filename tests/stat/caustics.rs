//! Photons against paths, and against closed forms: no gap, and nothing twice.

use epsilux::check::closed_forms::slab_transmittance;
use epsilux::color::Rgb;
use epsilux::glam::{DAffine3, DVec3};
use epsilux::prepare::{Algorithms, Caustics, CausticsMode};
use epsilux::scene::text::parse_toml;
use epsilux::scene::{LightKind, MaterialKind, Object, Scene, Shape, SpotFalloff};
use epsilux::stats::Moments;

use crate::agree::enlarge;
use crate::support::estimators::{Estimators, judge, means};
use crate::support::fast::{options, valid};
use crate::support::features::{self, MIDDLE, camera, dark_stage, stage};
use crate::support::scenes::{Build, diffuse, emitter, facing, glass, mirror, principled};
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
            runs: 12,
            unbiased: true,
            samples,
            bound: bound(name),
            bias: 0.0,
        }
        .compare();
        report.err()
    };
    let failures: Vec<String> = scenes.iter().filter_map(check).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn is_ball(object: &Object) -> bool {
    matches!(object.shape, Shape::Sphere { radius: 1.0 }) && object.transform.translation == MIDDLE
}

/// Replaces the material of the ball of a stage.
fn with_ball(mut scene: Scene, kind: MaterialKind) -> Scene {
    let ball = scene.objects.iter().find(|o| is_ball(o)).expect("the ball of a stage");
    scene.materials[ball.material.0 as usize].kind = kind;
    scene
}

fn has_delta_light(name: &str) -> bool {
    matches!(name, "point" | "spot" | "spot with Blender's falloff" | "sharp sun")
}

/// The stages with one light each that paths can meet, their ball made of glass.
fn glass_under_lights(part: impl Fn(&str) -> bool) -> Vec<(String, Scene)> {
    let has_ball = |scene: &Scene| scene.objects.iter().any(is_ball);
    let scenes = features::lights().into_iter();
    scenes
        .filter(|(name, scene)| !has_delta_light(name) && has_ball(scene) && part(name))
        .map(|(name, scene)| (name, with_ball(scene, glass(1.5))))
        .collect()
}

fn is_flat(name: &str) -> bool {
    ["rectangle", "ellipse", "triangles", "square", "sheet"].iter().any(|shape| name.contains(shape))
}

/// Guards emission from flat lights, surfaces and others, aimed at a ball of glass.
#[test]
fn flat_lights_through_glass() {
    check_all(glass_under_lights(is_flat), [96, 384], |_| 0.25);
}

/// Guards emission from round lights, suns and skies.
#[test]
fn round_and_distant_lights_through_glass() {
    check_all(glass_under_lights(|name| !is_flat(name)), [96, 384], |_| 0.3);
}

/// Guards pictures of the sky as a source of photons.
#[test]
fn panoramas_through_glass() {
    let scenes = features::panoramas().into_iter().filter(|(name, _)| !name.contains("mirror"));
    let glass_ball = |(name, scene)| (name, with_ball(scene, glass(1.5)));
    let bound = |name: &str| if name.contains("sun") { 0.6 } else { 0.35 };
    check_all(scenes.map(glass_ball).collect(), [128, 512], bound);
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
    let (thin, others): (Vec<_>, Vec<_>) = scenes.partition(|(name, _)| is_thin(name));
    check_all(others, [96, 256], |_| 0.35);
    check_all(thin, [640, 512], |_| 0.5);
}

/// Guards materials all of whose lobes are narrow: what they throw is left to photons too, whether paths would have met
/// the light or sampled it.
#[test]
fn narrow_materials_throw_light() {
    let kinds = ["metal,", "glass of roughness,", "absorbing glass of roughness,"];
    let narrow =
        |name: &str| name.ends_with("roughness 0.25") && kinds.iter().any(|kind| name.starts_with(kind));
    let mut scenes: Vec<_> = features::materials().into_iter().filter(|(name, _)| narrow(name)).collect();
    assert_eq!(scenes.len(), kinds.len());
    let coated = principled(|p| {
        (p.coat, p.coat_roughness) = (1.0, 0.2);
        (p.metallic, p.roughness) = (1.0, 0.1);
    });
    scenes
        .push(("coat over metal, both narrow".to_owned(), with_ball(features::layers().remove(0).1, coated)));
    check_all(scenes, [96, 256], |_| 0.35);
}

/// Reflections by thin layers throw little light, and few photons.
fn is_thin(name: &str) -> bool {
    ["plastic", "layer"].iter().any(|n| name.contains(n))
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
    check_all(scenes, [192, 512], |_| 0.6);
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
    check_all(scenes.collect(), [192, 384], |name| if name.contains("instances") { 0.6 } else { 0.35 });
}

/// Guards lamps inside of glass, from where everything is in the direction of the target, absorption on the
/// way out, and cameras inside of glass.
#[test]
fn lamps_inside_of_glass() {
    let mut lamp = dark_stage();
    lamp.sphere(MIDDLE, 1.0, features::tinted_glass(1.3, 0.7)).sphere(MIDDLE, 0.4, emitter(3.0));
    let mut free = dark_stage();
    free.sphere(MIDDLE, 1.0, features::tinted_glass(1.3, 0.7)).light(
        LightKind::Point { intensity: Rgb::grey(4.0), radius: 0.4 },
        DAffine3::from_translation(MIDDLE + DVec3::X * 0.2),
    );
    let scenes = [
        ("a lamp inside of absorbing glass", lamp),
        ("a free sphere inside of absorbing glass", free),
        ("lamp-in-glass", file(include_str!("../../fixtures/golden/lamp-in-glass/scene.toml"))),
        ("nested-glass", file(include_str!("../../fixtures/golden/nested-glass/scene.toml"))),
    ];
    check_all(scenes.map(|(name, scene)| (name.to_owned(), scene)).to_vec(), [96, 512], |_| 0.35);
}

fn file(text: &str) -> Scene {
    parse_toml(text).expect("a scene of the project").0
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
    check_all(vec![("everything".to_owned(), scene)], [1024, 512], |_| 0.4);
}

fn photons(unbiased: bool) -> Algorithms {
    Algorithms { caustics: CausticsMode::Photon, unbiased, ..Algorithms::PATHS }
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
        judge(name, &sharp, &wide, 0.1, 0.0).unwrap_or_else(|e| panic!("{e}"));
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
    // Six runs: t of five degrees of freedom passes 9 with a chance of 3e-4.
    assert!(
        (found.mean - expected).abs() < 9.0 * sigma + bias * expected,
        "{name}: {} +- {sigma}, {expected}",
        found.mean
    );
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

/// Compares photon maps with paths; `bias` is granted to what is gathered from around a point.
fn check_maps(name: &str, scene: &Scene, samples: [u32; 2], bound: f64, bias: f64) {
    let size = [32, 32];
    let pair =
        Estimators { name, scene, size, max_depth: Some(12), runs: 8, unbiased: false, samples, bound, bias };
    pair.compare().unwrap_or_else(|e| panic!("{e}"));
}

/// Guards that nothing is found twice or not at all in a room of glass, mirrors and interreflection, where every
/// part of a caustic occurs: seen directly, in mirrors, through glass, and lighting something else.
#[test]
fn maps_in_the_hexagonal_room() {
    let mut scene = file(include_str!("../../scenes/hexroom.toml"));
    enlarge(&mut scene, "light", 4.8);
    check_maps("hexroom", &scene, [6, 48], 0.15, 0.03);
}

/// Guards the same with glass and metal that are a little rough, seen in one another.
#[test]
fn maps_of_narrow_materials() {
    let mut scene = file(include_str!("../../scenes/hexroom.toml"));
    enlarge(&mut scene, "light", 4.8);
    for m in &mut scene.materials {
        match m.kind {
            MaterialKind::Glass(_) => {
                m.kind = principled(|p| (p.transmission, p.roughness) = (1.0, 0.2));
            }
            MaterialKind::Mirror { .. } => {
                m.kind = principled(|p| (p.metallic, p.roughness) = (1.0, 0.25));
            }
            _ => {}
        }
    }
    check_maps("narrow hexroom", &valid(&scene), [6, 48], 0.15, 0.03);
}

/// Guards the same where the caustic is all there is.
#[test]
fn maps_under_a_ball_of_glass() {
    let mut scene = file(include_str!("../../scenes/caustic.toml"));
    enlarge(&mut scene, "light", 20.0);
    check_maps("caustic", &scene, [24, 192], 0.15, 0.03);
}

/// Guards absorption between the glass that a photon entered and where it is gathered, through the same glass.
#[test]
fn maps_inside_of_absorbing_glass() {
    let mut scene = stage();
    scene.sphere(MIDDLE, 1.0, features::tinted_glass(1.3, 0.7)).sphere(MIDDLE, 0.6, diffuse(0.8));
    check_maps("core", &valid(&scene), [24, 96], 0.15, 0.03);
}

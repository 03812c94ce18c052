//! The fast integrator against the reference, which shares nothing with it but the scene.
//!
//! In copies of the project's scenes the light is larger and dimmer, so that the reference finds it,
//! which never looks for lights; materials, shapes and camera are those of the file.

use epsilux::color::Rgb;
use epsilux::glam::Vec3;
use epsilux::scene::text::parse_toml;
use epsilux::scene::{MaterialKind, Scene, Shape};

use crate::support::compare::Pair;
use crate::support::fast::valid;
use crate::support::{features, nested};

/// Compares each scene of a list; small pictures of scenes that differ in one feature.
fn check_all(scenes: Vec<(String, Scene)>, samples: [u32; 2], bound: impl Fn(&str) -> f64) {
    assert!(!scenes.is_empty());
    let check = |(name, scene): &(String, Scene)| {
        Pair {
            name,
            scene: &valid(scene),
            size: [8, 8],
            max_depth: 8,
            samples,
            tiles: [2, 2],
            bound: bound(name),
        }
        .compare()
        .err()
    };
    let failures: Vec<String> = scenes.iter().filter_map(check).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// What gathers light on the floor, or keeps it inside for long, is noisier.
fn material_bound(name: &str) -> f64 {
    let noisy = ["glass", "absorb", "sheet", "mixture", "bubble", "coated lamp"];
    if noisy.iter().any(|n| name.contains(n)) { 0.1 } else { 0.05 }
}

fn materials(part: impl Fn(&str) -> bool) {
    check_all(
        features::materials().into_iter().filter(|(name, _)| part(name)).collect(),
        [640, 1500],
        material_bound,
    );
}

/// Guards the materials that have no roughness, absorption among them.
#[test]
fn plain_materials() {
    materials(|name| !name.contains("roughness"));
}

/// Guards the principled material with delta lobes, and their mixtures with diffuse.
#[test]
fn smooth_principled() {
    materials(|name| name.ends_with("roughness 0"));
}

/// Guards narrow lobes, for which a wrong density is a large error.
#[test]
fn glossy_principled() {
    materials(|name| name.ends_with("roughness 0.25"));
}

/// Guards wide lobes and their compensation.
#[test]
fn rough_principled() {
    materials(|name| name.ends_with("roughness 0.6"));
}

/// Guards the widest lobes, whose compensation is largest.
#[test]
fn matt_principled() {
    materials(|name| name.ends_with("roughness 1"));
}

/// Guards coat and sheen: their lobes, what they leave to what is below them, and emission below them.
#[test]
fn layers() {
    check_all(features::layers(), [512, 1500], material_bound);
}

/// Guards pictures as environments: their lookup, and that what is sampled has the density it says.
#[test]
fn panoramas() {
    check_all(features::panoramas(), [1024, 8000], |name| if name.contains("sun") { 0.15 } else { 0.05 });
}

/// Guards every kind of light, its falloff, its front and its visibility.
#[test]
fn lights() {
    check_all(features::lights(), [512, 3000], |_| 0.1);
}

/// Guards absorption along shadow rays, in and out of bodies.
#[test]
fn lights_and_media() {
    check_all(features::lights_and_media(), [1024, 3000], |_| 0.35);
}

/// Guards instances, mirroring transforms, shading normals, hidden objects and cameras.
#[test]
fn shapes_and_cameras() {
    check_all(features::shapes_and_cameras(), [640, 3000], material_bound);
}

/// Guards which of several bodies is there, what their interfaces do, and what the camera is in.
#[test]
fn nested_bodies() {
    check_all(nested::nested(), [512, 1200], |name| if name.contains("in a body") { 0.35 } else { 0.25 });
}

/// Guards what features do to each other.
#[test]
fn everything_at_once() {
    Pair {
        name: "everything",
        scene: &valid(&features::everything()),
        size: [12, 12],
        max_depth: 8,
        samples: [1024, 3000],
        tiles: [3, 3],
        bound: 0.06,
    }
    .compare()
    .unwrap_or_else(|e| panic!("{e}"));
}

fn file(text: &str) -> Scene {
    parse_toml(text).expect("a scene of the project").0
}

/// Makes the lamp called `name` `factor` times as long and as wide, moves it ten centimetres to where it
/// shines so that it does not coincide with the ceiling, and dims it so that its power is the same.
pub(crate) fn enlarge(scene: &mut Scene, name: &str, factor: f32) {
    let object = scene.objects.iter().find(|o| o.name == name).expect("the lamp");
    let Shape::Mesh(mesh) = object.shape else { panic!("a flat lamp") };
    let mesh = &mut scene.meshes[mesh.0 as usize];
    let middle = mesh.positions.iter().sum::<Vec3>() / mesh.positions.len() as f32;
    let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
    let n = (b - a).cross(c - a).normalize();
    let grow = |p: &Vec3| middle + (*p - middle) * factor + 0.1 * n;
    mesh.positions = mesh.positions.iter().map(grow).collect();
    let material = object.material.0 as usize;
    let MaterialKind::Light { radiance, .. } = &mut scene.materials[material].kind else { panic!("a lamp") };
    *radiance = Rgb::from(radiance.to_array().map(|c| c / (factor * factor)));
}

/// Guards glass, mirrors, caustics and interreflection in the report's room.
#[test]
fn hexroom() {
    let mut scene = file(include_str!("../../scenes/hexroom.toml"));
    enlarge(&mut scene, "light", 4.8);
    Pair {
        name: "hexroom",
        scene: &scene,
        size: [24, 24],
        max_depth: 12,
        samples: [64, 1000],
        tiles: [4, 2],
        bound: 0.03,
    }
    .compare()
    .unwrap_or_else(|e| panic!("{e}"));
}

/// Guards diffuse interreflection, and the ceiling that is lit by it alone.
#[test]
fn hexroom_diffuse() {
    let mut scene = file(include_str!("../../scenes/hexroom-diffuse.toml"));
    enlarge(&mut scene, "light", 4.8);
    Pair {
        name: "hexroom-diffuse",
        scene: &scene,
        size: [24, 24],
        max_depth: 8,
        samples: [160, 1500],
        tiles: [4, 2],
        bound: 0.01,
    }
    .compare()
    .unwrap_or_else(|e| panic!("{e}"));
}

/// Guards diffuse interreflection in an open room.
#[test]
fn cornell() {
    let mut scene = file(include_str!("../../scenes/cornell.toml"));
    enlarge(&mut scene, "light", 4.0);
    Pair {
        name: "cornell",
        scene: &scene,
        size: [24, 24],
        max_depth: 8,
        samples: [320, 4200],
        tiles: [4, 2],
        bound: 0.01,
    }
    .compare()
    .unwrap_or_else(|e| panic!("{e}"));
}

/// Guards light that glass gathers; the picture is cropped by its camera to the ball and its spot.
#[test]
fn caustic() {
    let mut scene = file(include_str!("../../scenes/caustic.toml"));
    enlarge(&mut scene, "light", 20.0);
    Pair {
        name: "caustic",
        scene: &scene,
        size: [24, 24],
        max_depth: 8,
        samples: [128, 1000],
        tiles: [4, 2],
        bound: 0.05,
    }
    .compare()
    .unwrap_or_else(|e| panic!("{e}"));
}

/// Guards the materials side by side, under a sky and two large lamps that need no enlarging.
#[test]
fn all_materials() {
    let scene = file(include_str!("../../scenes/materials.toml"));
    Pair {
        name: "materials",
        scene: &scene,
        size: [30, 12],
        max_depth: 8,
        samples: [640, 4600],
        tiles: [4, 2],
        bound: 0.03,
    }
    .compare()
    .unwrap_or_else(|e| panic!("{e}"));
}

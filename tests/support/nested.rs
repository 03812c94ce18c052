//! Tiny scenes of bodies that overlap, touch and lie within each other, each on the stage of
//! [`super::features`], and cameras inside of what absorbs.

use epsilux::color::Rgb;
use epsilux::glam::{DAffine3, DVec3};
use epsilux::scene::{
    Absorption, AlphaMode, Glass, LightKind, MaterialKind, MeshId, Principled, Scene, Shape, Texture,
};

use super::features::{MIDDLE, camera, dark_stage, stage};
use super::scenes::{Build, diffuse, emitter, principled};
use super::textured::{laid_mesh, noise_image};

fn dye(distance: f32) -> Option<Absorption> {
    Some(Absorption { color: Rgb::new(0.8, 0.5, 0.3), distance })
}

fn clear(ior: f32, priority: u8) -> MaterialKind {
    MaterialKind::Glass(Glass { ior, tint: Rgb::WHITE, absorption: None, priority: Some(priority) })
}

fn dyed(ior: f32, priority: u8) -> MaterialKind {
    MaterialKind::Glass(Glass { ior, tint: Rgb::WHITE, absorption: dye(1.0), priority: Some(priority) })
}

fn rough(ior: f32, priority: u8, change: impl FnOnce(&mut Principled)) -> MaterialKind {
    principled(|p| {
        (p.ior, p.transmission, p.roughness) = (ior, 1.0, 0.5);
        (p.absorption, p.priority) = (dye(0.7), Some(priority));
        change(p);
    })
}

fn up(height: f64) -> DVec3 {
    DVec3::new(0.0, height, 0.0)
}

/// What is drunk from a glass ball: air in it, and a drink that overlaps the glass.
fn drink() -> Scene {
    let mut scene = stage();
    scene.sphere(MIDDLE, 1.0, clear(1.5, 3));
    scene.sphere(MIDDLE, 0.85, clear(1.0, 4));
    scene.cuboid(MIDDLE - DVec3::new(0.4, 0.9, 0.4), MIDDLE + DVec3::new(0.4, 0.0, 0.4), dyed(1.33, 5));
    scene.sphere(MIDDLE - up(0.3), 0.2, diffuse(0.8));
    scene
}

/// Boxes on each other, with faces in common.
fn stack(lower: MaterialKind, upper: MaterialKind) -> Scene {
    let mut scene = stage();
    let [low, middle, high] =
        [DVec3::new(-0.8, 0.3, -0.8), DVec3::new(0.8, 1.0, 0.8), DVec3::new(0.5, 1.8, 0.6)];
    scene.cuboid(low, middle, lower);
    scene.cuboid(DVec3::new(-0.5, 1.0, -0.6), high, upper);
    scene
}

/// A point light and what it shines on, behind surfaces that are not there.
fn shadows(kind: MaterialKind) -> Scene {
    let mut scene = dark_stage();
    scene.sphere(MIDDLE, 1.0, kind);
    scene.sphere(MIDDLE, 0.6, dyed(1.3, 0));
    scene.sphere(MIDDLE, 0.3, diffuse(0.8));
    let intensity = Rgb::new(40.0, 30.0, 15.0);
    let at = DAffine3::from_translation(MIDDLE + DVec3::new(0.3, 0.6, 0.5));
    scene.light(LightKind::Point { intensity, radius: 0.0 }, at);
    scene
}

/// A picture that varies how much of a body's surface is there, and in what colour.
fn textured() -> Scene {
    let mut scene = stage();
    let texture = Texture::new(noise_image(&mut scene, 5));
    scene.meshes.push(laid_mesh(2, true));
    let mesh = Shape::Mesh(MeshId(scene.meshes.len() as u32 - 1));
    let kind = rough(1.5, 2, |p| {
        (p.alpha, p.alpha_mode) = (0.7, AlphaMode::Blend);
        p.textures.base_color = Some(texture);
    });
    scene.object(mesh, DAffine3::from_translation(MIDDLE), kind);
    scene.sphere(MIDDLE, 0.7, dyed(1.2, 3));
    scene.sphere(MIDDLE + DVec3::new(0.5, 0.4, 0.2), 0.6, clear(1.33, 1));
    scene
}

/// The camera is in a ball of dye, which the stage does not see.
fn under_water(kind: MaterialKind, more: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = stage();
    scene.sphere(up(2.2), 30.0, kind);
    scene.sphere(MIDDLE, 0.6, diffuse(0.7));
    scene.cameras = vec![camera(DVec3::new(0.0, 1.4, 3.0), up(0.8), 40.0)];
    more(&mut scene);
    scene
}

/// All of them.
pub(crate) fn nested() -> Vec<(String, Scene)> {
    let mut halves = stage();
    halves.sphere(MIDDLE - DVec3::new(0.4, 0.0, 0.0), 0.8, rough(1.5, 1, |_| {}));
    halves.sphere(MIDDLE + DVec3::new(0.4, 0.0, 0.0), 0.8, rough(1.2, 2, |p| p.roughness = 0.3));
    halves.sphere(MIDDLE, 0.25, emitter(2.0));
    let mut shells = stage();
    shells.sphere(MIDDLE, 1.0, clear(1.5, 1));
    shells.sphere(MIDDLE, 0.8, clear(1.0, 2));
    shells.sphere(MIDDLE, 0.8, dyed(1.33, 3));
    shells.sphere(MIDDLE, 0.4, diffuse(0.8));
    let mut mixed = stage();
    mixed.sphere(MIDDLE, 1.0, dyed(1.33, 1));
    mixed.sphere(
        MIDDLE + DVec3::new(0.3, 0.1, 0.2),
        0.5,
        rough(1.5, 2, |p| (p.transmission, p.coat) = (0.5, 0.5)),
    );
    mixed.sphere(MIDDLE - DVec3::new(0.4, 0.1, 0.2), 0.4, super::scenes::glass(1.2));
    let ordinary =
        MaterialKind::Glass(Glass { ior: 1.0, tint: Rgb::WHITE, absorption: dye(2.0), priority: None });
    [
        ("a drink", drink()),
        ("rough bodies that overlap", halves),
        ("bodies of one kind on each other", stack(dyed(1.5, 1), dyed(1.5, 1))),
        ("bodies of two kinds on each other", stack(dyed(1.3, 2), clear(1.6, 1))),
        ("rough bodies on each other", stack(rough(1.5, 0, |_| {}), rough(1.3, 0, |p| p.roughness = 0.2))),
        ("shells with a surface in common", shells),
        ("bodies with and without a priority", mixed),
        ("a point light behind what is not there", shadows(dyed(1.0, 1))),
        ("a textured body", textured()),
        ("a camera in dye", under_water(ordinary, |_| {})),
        (
            "a camera in a body of dye",
            under_water(dyed(1.0, 1), |scene| {
                scene.sphere(MIDDLE + DVec3::new(0.7, 0.2, 0.6), 0.4, clear(1.2, 2));
                scene.sphere(DVec3::new(0.1, 1.3, 3.1), 0.5, clear(1.0, 9));
            }),
        ),
    ]
    .map(|(name, scene)| (name.to_owned(), scene))
    .to_vec()
}

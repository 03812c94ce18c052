//! What Blender's exporter really writes, from `fixtures/blender`.

use std::path::Path;

use super::super::super::{ReadOptions, read};
use super::build::{lines, principled};
use crate::scene::{MaterialKind, Principled, Shape};

/// Counts, cameras, emitters and notes of the still life.
#[test]
fn the_still_life_is_understood() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/blender/still-life.glb");
    let (scene, notes) = read(&path, &ReadOptions::default()).unwrap();
    let triangles: usize = scene.meshes.iter().map(|m| m.triangles.len()).sum();
    let placed = scene.objects.iter().map(|o| match o.shape {
        Shape::Mesh(id) => scene.meshes[id.0 as usize].triangles.len(),
        Shape::Sphere { .. } => 0,
    });
    let mut said = format!(
        "{:?}: {} objects, {} meshes, {triangles} triangles ({} placed), {} lights\n",
        scene.title,
        scene.objects.len(),
        scene.meshes.len(),
        placed.sum::<usize>(),
        scene.lights.len()
    );
    for (i, material) in scene.materials.iter().enumerate() {
        let p = principled(&scene, i);
        let users = scene.objects.iter().filter(|o| o.material.0 as usize == i).count();
        // What none of these materials has only makes the lines long.
        let rest = format!("{:?}", Principled::default());
        let rest = &rest[rest.find(", alpha: ").unwrap()..];
        said += &format!("{} x{users}: {p:?}\n", material.name).replace(rest, " }");
    }
    for camera in &scene.cameras {
        said += &format!("{}: {:?} aspect {:?}\n", camera.name, camera.projection, camera.aspect);
    }
    said += &lines(&notes);
    insta::assert_snapshot!(said);
    let emits = |k: &MaterialKind| k.emission().is_some();
    assert_eq!(scene.materials.iter().filter(|m| emits(&m.kind)).count(), 3);
}

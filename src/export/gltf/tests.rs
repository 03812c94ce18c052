//! Scenes out to glTF and back in.

use std::path::{Path, PathBuf};

use crate::export::{Format, encode, write};
use crate::import;
use crate::scene::{Note, Scene, Shape, validate};

/// A scene written as `format` and read again, with the notes of both ways.
fn round_trip(scene: &Scene, format: Format) -> (Scene, Vec<Note>, Vec<Note>) {
    let folder = tempfile::tempdir().unwrap();
    let name = if format == Format::Glb { "a scene.glb" } else { "a scene.gltf" };
    let encoded = encode(scene, format, name).unwrap();
    write(&encoded.files, folder.path()).unwrap();
    let (mut read, notes) = import::read(&folder.path().join(name), &import::ReadOptions::default())
        .unwrap_or_else(|e| panic!("{e}"));
    validate(&mut read).unwrap_or_else(|e| panic!("{e}"));
    (read, encoded.notes, notes)
}

/// The scenes that come with the program.
fn scenes() -> Vec<(PathBuf, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let (scene, _) = import::read(&path, &import::ReadOptions::default()).unwrap();
            found.push((path, scene));
        }
    }
    assert!(found.len() >= 5);
    found
}

/// A scene as it is after a round trip: meshes in the order of their first use.
fn in_order_of_use(scene: &Scene) -> Scene {
    let mut out = scene.clone();
    let mut order = Vec::new();
    for object in &mut out.objects {
        if let Shape::Mesh(id) = &mut object.shape {
            let index = order.iter().position(|o| o == id).unwrap_or_else(|| {
                order.push(*id);
                order.len() - 1
            });
            *id = crate::scene::MeshId(index as u32);
        }
    }
    out.meshes = order.iter().map(|id| scene.meshes[id.0 as usize].clone()).collect();
    out
}

/// Everything that a scene of ours says comes back, bit for bit, through either form of glTF.
#[test]
fn the_scenes_of_this_program_survive() {
    for (path, scene) in scenes() {
        let expected = in_order_of_use(&scene);
        for format in [Format::Glb, Format::Gltf] {
            let (read, out, back) = round_trip(&scene, format);
            assert_eq!(out, [], "{}", path.display());
            assert_eq!(back, [], "{}", path.display());
            assert_eq!(read.materials, expected.materials, "{}", path.display());
            assert_eq!(read.cameras, expected.cameras, "{}", path.display());
            assert!(read == expected, "{}: something else differs", path.display());
        }
    }
}

//! What is understood of the scenes in `fixtures/blender`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use epsilux::import::{self, ReadOptions};
use epsilux::scene::{Mesh, Note, Object, Scene, Shape};

use crate::command::Folder;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/blender").join(name)
}

fn read(name: &str) -> (Scene, Vec<Note>) {
    import::read(&fixture(name), &ReadOptions::default()).unwrap()
}

/// What `epsilux info` says about a fixture.
fn info(name: &str) -> String {
    Folder::new().done(&format!("info {}", fixture(name).display())).out
}

/// Counts, cameras, lights, bounds and all notes of each exported file, as a user reads them; what is
/// carried is not said to be lost, and what is lost is said.
#[test]
fn what_info_says() {
    for name in ["still-life.glb", "room.glb", "textured.glb", "grove.glb"] {
        insta::assert_snapshot!(name, info(name));
    }
}

/// Two thousand linked duplicates are one mesh in memory, and one tree of boxes; each tenth is mirrored.
#[test]
fn the_grove_is_one_tree() {
    let (scene, _) = read("grove.glb");
    let users = |i: usize| -> Vec<&Object> {
        let of_mesh = |o: &&Object| matches!(o.shape, Shape::Mesh(id) if id.0 as usize == i);
        scene.objects.iter().filter(of_mesh).collect()
    };
    let shared: Vec<usize> = (0..scene.meshes.len()).filter(|&i| users(i).len() > 1000).collect();
    let [tree] = shared[..] else { panic!("meshes with more than a thousand users: {shared:?}") };
    let trees = users(tree);
    assert_eq!((trees.len(), scene.meshes[tree].triangles.len()), (2000, 66));
    let mirrored = trees.iter().filter(|o| o.transform.matrix3.determinant() < 0.0).count();
    assert_eq!(mirrored, 200);

    // What the instances save, in bytes of vertices and indices.
    let kept: usize = scene.meshes.iter().map(bytes).sum();
    let copied: usize = (0..scene.meshes.len()).map(|i| bytes(&scene.meshes[i]) * users(i).len()).sum();
    let mut said = String::new();
    writeln!(said, "{} meshes, {} objects", scene.meshes.len(), scene.objects.len()).unwrap();
    writeln!(said, "meshes {} kB, a copy for each object {} kB", kept / 1000, copied / 1000).unwrap();
    let places = scene.objects.len() * size_of::<Object>();
    writeln!(said, "objects {} kB", places / 1000).unwrap();
    insta::assert_snapshot!(said);
    assert!(kept + places < copied / 10, "{said}");
}

/// Bytes of a mesh's vertices and indices.
fn bytes(mesh: &Mesh) -> usize {
    size_of_val(&mesh.positions[..])
        + size_of_val(&mesh.triangles[..])
        + size_of_val(&mesh.normals[..])
        + size_of_val(&mesh.tangents[..])
        + mesh.uvs.iter().map(|set| size_of_val(&set[..])).sum::<usize>()
        + size_of_val(&mesh.colors[..])
}

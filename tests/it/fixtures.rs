//! What is understood of the scenes in `fixtures/blender`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use epsilux::import::{self, ReadOptions};
use epsilux::report::inventory;
use epsilux::scene::{MaterialKind, Mesh, Note, Object, Principled, Scene, Shape};

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
    for name in ["still-life.glb", "room.glb", "room.obj", "textured.glb", "grove.glb"] {
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

/// What both files of the room say about one material; OBJ has underscores for blanks.
fn principled<'a>(scene: &'a Scene, name: &str) -> &'a Principled {
    let same = |found: &str| found.replace(' ', "_") == name.replace(' ', "_");
    match scene.materials.iter().find(|m| same(&m.name)).map(|m| &m.kind) {
        Some(MaterialKind::Principled(p)) => p,
        other => panic!("{name}: {other:?}"),
    }
}

/// The room is one room, whether Blender wrote it as glTF, as OBJ with PBR statements or as OBJ without:
/// geometry, camera, and each material to the six digits that MTL has.
#[test]
fn the_room_is_the_same_in_each_format() {
    let folder = Folder::new();
    for name in ["room.obj", "room.epsilux.toml", "room-parquet.jpg", "room-painting.png"] {
        std::fs::copy(fixture(name), folder.path(name)).unwrap();
    }
    std::fs::copy(fixture("room-plain.mtl"), folder.path("room.mtl")).unwrap();
    let plain = import::read(&folder.path("room.obj"), &ReadOptions::default()).unwrap().0;
    let (gltf, _) = read("room.glb");
    let expected = inventory(&gltf);
    for (obj, tolerance) in [(read("room.obj").0, 1e-6), (plain, 1e-5)] {
        let found = inventory(&obj);
        assert_eq!(found.triangles, expected.triangles);
        assert!((found.area / expected.area - 1.0).abs() < 1e-5, "{} {}", found.area, expected.area);
        for (a, b) in found.bounds.unwrap().as_flattened().iter().zip(expected.bounds.unwrap().as_flattened())
        {
            assert!((a - b).abs() < 1e-5, "{:?} {:?}", found.bounds, expected.bounds);
        }
        assert_eq!((found.materials.len(), found.emitters), (expected.materials.len(), expected.emitters));
        for material in &gltf.materials {
            let (a, b) = (principled(&obj, &material.name), principled(&gltf, &material.name));
            for (x, y) in [(a.base_color, b.base_color), (a.emission, b.emission)] {
                let off = (0..3).map(|c| (x[c] - y[c]).abs()).fold(0.0, f32::max);
                assert!(off <= tolerance * y.max_channel().max(1.0), "{}: {x:?} {y:?}", material.name);
            }
            assert!((a.roughness - b.roughness).abs() <= tolerance, "{}", material.name);
            assert_eq!((a.metallic, a.ior, a.specular), (b.metallic, b.ior, b.specular), "{}", material.name);
            assert_eq!(a.textures.base_color.is_some(), b.textures.base_color.is_some(), "{}", material.name);
        }
        let [a, b] = [&obj, &gltf].map(|s| {
            let camera = &s.cameras[0];
            (camera.transform, camera.projection)
        });
        assert!(a.0.abs_diff_eq(b.0, 1e-5), "{:?} {:?}", a.0, b.0);
    }
}

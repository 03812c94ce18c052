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

/// Files of Blender with pictures: all that is seen comes back, pictures by what they show.
#[test]
fn textured_files_survive() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/blender");
    for name in ["textured.glb", "room.glb", "still-life.glb"] {
        let mut scene = import::read(&folder.join(name), &import::ReadOptions::default()).unwrap().0;
        validate(&mut scene).unwrap();
        let strip = |mut scene: Scene| {
            for image in &mut scene.images {
                (image.name, image.file, image.encoded) = (String::new(), None, None);
            }
            scene
        };
        let expected = strip(in_order_of_use(&scene));
        for format in [Format::Glb, Format::Gltf] {
            let (read, out, _) = round_trip(&scene, format);
            assert_eq!(out, [], "{name}");
            let read = strip(read);
            assert_eq!(read.materials, expected.materials, "{name}");
            assert_eq!(read.lights, expected.lights, "{name}");
            assert_eq!(read.cameras, expected.cameras, "{name}");
            assert_eq!(read.objects, expected.objects, "{name}");
            assert!(read.images == expected.images, "{name}: pictures");
            assert!(read == expected, "{name}: something else differs");
        }
    }
}

/// glTF wants roughness in green and metal in blue; a scene may have them anywhere.
#[test]
fn channels_are_put_where_gltf_wants_them() {
    use std::sync::Arc;

    use crate::scene::{
        Channel, Image, ImageId, Material, MaterialKind, Pixels, Principled, ScalarTexture, Texels, Texture,
    };
    let image = |texels: Vec<[u8; 4]>| Image {
        name: "picture".into(),
        file: None,
        encoded: None,
        pixels: Some(Arc::new(Pixels { width: 2, height: 1, texels: Texels::Byte(texels) })),
    };
    let mut p = Principled { metallic: 1.0, ..Principled::default() };
    let scalar = |i, channel| Some(ScalarTexture { texture: Texture::new(ImageId(i)), channel });
    p.textures.roughness = scalar(0, Channel::R);
    p.textures.metallic = scalar(1, Channel::A);
    let kind = MaterialKind::Principled(Box::new(p));
    let scene = Scene {
        images: vec![image(vec![[10, 1, 2, 3], [20, 1, 2, 3]]), image(vec![[4, 5, 6, 30], [4, 5, 6, 40]])],
        materials: vec![Material { name: "m".into(), kind }],
        ..Scene::default()
    };
    let (read, out, back) = round_trip(&scene, Format::Glb);
    assert_eq!((out, back), (vec![], vec![]));
    let texels = &read.images[0].pixels.as_ref().unwrap().texels;
    assert_eq!(*texels, Texels::Byte(vec![[255, 10, 30, 255], [255, 20, 40, 255]]));
    let MaterialKind::Principled(p) = &read.materials[0].kind else { panic!("principled") };
    assert_eq!(p.textures.roughness.map(|t| t.channel), Some(Channel::G));
    assert_eq!(p.textures.metallic.map(|t| t.channel), Some(Channel::B));
}

//! The fixture that Blender's exporter wrote, in both of its dialects.

use std::fmt::Write;

use super::*;
use crate::scene::{MaterialKind, Principled, validate};

const OBJ: &[u8] = include_bytes!("../../../../fixtures/blender/room.obj");
const MTL: &[u8] = include_bytes!("../../../../fixtures/blender/room.mtl");
const PLAIN: &[u8] = include_bytes!("../../../../fixtures/blender/room-plain.mtl");
const SIDECAR: &[u8] = include_bytes!("../../../../fixtures/blender/room.epsilux.toml");

fn room(mtl: &[u8]) -> (Scene, Vec<Note>) {
    let (mut scene, mut notes) = try_load(&[
        ("scene.obj", OBJ),
        ("room.mtl", mtl),
        ("scene.epsilux.toml", SIDECAR),
        ("room-painting.png", include_bytes!("../../../../fixtures/blender/room-painting.png")),
        ("room-parquet.jpg", include_bytes!("../../../../fixtures/blender/room-parquet.jpg")),
    ])
    .unwrap();
    notes.extend(validate(&mut scene).unwrap());
    (scene, notes)
}

/// Guards what a user gets from Blender: everything, and nothing to complain of.
#[test]
fn a_room_of_blender_is_read_whole() {
    let (scene, notes) = room(MTL);
    let mut said = String::new();
    for note in &notes {
        writeln!(said, "{}: {note}", note.code).unwrap();
    }
    let triangles: usize = scene.meshes.iter().map(|m| m.triangles.len()).sum();
    let total: f64 = scene.meshes.iter().map(area).sum();
    writeln!(
        said,
        "{} objects, {} meshes, {triangles} triangles of {total:.3} m2, {} pictures, cameras {:?}",
        scene.objects.len(),
        scene.meshes.len(),
        scene.images.len(),
        scene.cameras.iter().map(|c| &*c.name).collect::<Vec<_>>()
    )
    .unwrap();
    for material in &scene.materials {
        let MaterialKind::Principled(p) = &material.kind else { panic!("{material:?}") };
        let Principled { base_color: c, metallic, roughness, emission: e, .. } = **p;
        let textures: Vec<&str> = p.textures.iter().map(|(key, _)| key).collect();
        writeln!(
            said,
            "{}: base {:.2} {:.2} {:.2}, metallic {metallic}, roughness {roughness}, emission {:.1} {:.1} {:.1}, {textures:?}",
            material.name, c.r, c.g, c.b, e.r, e.g, e.b
        )
        .unwrap();
    }
    insta::assert_snapshot!(said);
}

/// Guards that both dialects of the exporter, with and without its PBR extensions, mean the same.
#[test]
fn both_dialects_of_blender_mean_the_same() {
    let (extended, plain) = (room(MTL).0, room(PLAIN).0);
    assert_eq!(extended.meshes, plain.meshes);
    for (a, b) in extended.materials.iter().zip(&plain.materials) {
        let (MaterialKind::Principled(p), MaterialKind::Principled(q)) = (&a.kind, &b.kind) else { panic!() };
        assert_eq!((&a.name, p.base_color, p.emission), (&b.name, q.base_color, q.emission));
        assert_eq!((p.metallic, p.specular, p.ior), (q.metallic, q.specular, q.ior), "{}", a.name);
        assert!((p.roughness - q.roughness).abs() < 1e-4, "{}: {} {}", a.name, p.roughness, q.roughness);
        assert_eq!(p.textures, q.textures, "{}", a.name);
    }
}

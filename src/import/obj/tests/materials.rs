//! MTL: statements, conventions of Blender and of others, textures.

use std::io::Cursor;

use image::{ImageFormat, Rgba, RgbaImage};

use super::super::texture::{Map, parse_map};
use super::*;
use crate::color::Rgb;
use crate::scene::{
    AlphaMode, Channel, Glass, MaterialKind, NoteEffect, Principled, Sides, Textures, Wrap, validate,
};

const TRIANGLE: &str = "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";
const BLENDER: &str = "# Blender 5.0.1 MTL File: 'room.blend'\n# www.blender.org\n\n";

pub(super) fn png(texel: impl Fn(u32) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let picture = RgbaImage::from_fn(4, 4, |x, y| Rgba(texel(x + 4 * y)));
    picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The material that `statements` make, in a folder with a few pictures, and the codes of the notes.
fn kind(statements: &str) -> (MaterialKind, Vec<&'static str>) {
    let (header, statements) = match statements.strip_prefix(BLENDER) {
        Some(rest) => (BLENDER, rest),
        None => ("", statements),
    };
    let files: [(&str, &[u8]); 6] = [
        ("scene.obj", TRIANGLE.as_bytes()),
        ("scene.mtl", &[header.as_bytes(), b"newmtl m\n", statements.as_bytes()].concat()),
        ("grey.png", &png(|i| [i as u8 * 15, i as u8 * 15, i as u8 * 15, 255])),
        ("my normals.png", &png(|_| [127, 128, 255, 255])),
        ("leaf.png", &png(|i| [0, 200, 0, if i % 2 == 0 { 0 } else { 255 }])),
        ("maps/100% deep.png", &png(|_| [9; 4])),
    ];
    let (mut scene, notes) = try_load(&files).unwrap();
    validate(&mut scene).unwrap();
    assert_eq!(scene.materials[0].name, "m");
    (scene.materials[0].kind.clone(), codes(&notes))
}

fn blender(statements: &str) -> Principled {
    let (kind, notes) = kind(&format!("{BLENDER}{statements}"));
    assert_eq!(notes, [""; 0], "{statements}");
    principled(kind)
}

fn principled(kind: MaterialKind) -> Principled {
    match kind {
        MaterialKind::Principled(p) => *p,
        other => panic!("{other:?}"),
    }
}

/// Guards the conventions of Blender's exporter, against what it is known to write.
#[test]
fn files_of_blender_mean_what_its_exporter_writes() {
    let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-5, "{a}, expected {b}");
    // Principled BSDF with roughness 0.3 and everything else at its default.
    let usual = "Ns 490.000000\nKa 1 1 1\nKd 0.8 0.4 0.2\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.5\nd 1\nillum 2\n";
    let p = blender(usual);
    near(p.roughness, 0.3);
    let expected =
        Principled { base_color: Rgb::new(0.8, 0.4, 0.2), roughness: p.roughness, ..Principled::default() };
    assert_eq!(Principled { transmission_tint: Rgb::WHITE, ..p }, expected);
    // Metal of weight 0.7; its Ka says so.
    near(blender("Ns 250\nKa 0.7 0.7 0.7\nKd 1 1 1\nKs 0.5 0.5 0.5\nillum 3").metallic, 0.7);
    near(blender("Ns 250\nKa 1 1 1\nKd 1 1 1\nKs 0.5 0.5 0.5\nillum 2").metallic, 0.0);
    // Transparent metal is no glass.
    let p = blender("Ns 250\nKa 1 1 1\nKd 1 1 1\nKs 0.5 0.5 0.5\nNi 1.5\nd 0.25\nillum 6");
    assert_eq!((p.metallic, p.alpha, p.alpha_mode, p.transmission), (1.0, 0.25, AlphaMode::Blend, 0.0));
    let p = blender("Kd 1 1 1\nKs 0.5 0.5 0.5\nd 0.5\nillum 9");
    assert_eq!((p.alpha, p.alpha_mode), (0.5, AlphaMode::Blend));
    // Specular level below and above its default.
    assert_eq!(blender("Ks 0.25 0.25 0.25").specular, 0.5);
    let p = blender("Ks 1 1 1");
    assert_eq!((p.specular, p.specular_color), (1.0, Rgb::grey(2.0)));
    assert_eq!(blender("Ks 0 0 0\nillum 1").specular, 0.0);
    // The PBR extensions: the coat is written four times its weight.
    let p = blender(
        "Kd 0.25 0.25 0.25\nPr 0.2\nPm 0.9\nPs 0.5\nPc 2.8\nPcr 0.1\nNi 1.45\nTf 1 1 1\naniso 0\nanisor 0",
    );
    near(p.coat, 0.7);
    near(p.coat_roughness, 0.1);
    assert_eq!((p.roughness, p.metallic, p.sheen_color), (0.2, 0.9, Rgb::grey(0.5)));
    assert_eq!((p.transmission, p.ior, p.transmission_tint, p.thin), (1.0, 1.45, Rgb::grey(0.5), false));
    // Emission is colour times strength, without bound.
    assert_eq!(blender("Kd 0.8 0.8 0.8\nKe 12 6 3").emission, Rgb::new(12.0, 6.0, 3.0));
    // Where a picture is linked there is no factor.
    let p = blender(
        "Kd 0.8 0.8 0.8\nmap_Ns grey.png\nmap_refl grey.png\nmap_Ke grey.png\nmap_Bump -bm 0.5 my normals.png",
    );
    assert_eq!((p.roughness, p.metallic, p.emission), (1.0, 1.0, Rgb::WHITE));
    let t = &p.textures;
    assert!(t.roughness.is_some() && t.metallic.is_some() && t.emission.is_some());
    assert_eq!(t.normal.map(|n| n.scale), Some(0.5));
    // What it writes where it found no Principled BSDF.
    let (_, notes) = kind(&format!("{BLENDER}Ns 360\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNi 1\nd 1\nillum 2"));
    assert_eq!(notes, ["material-lost"]);
}

/// Guards the illumination models of files of all other programs.
#[test]
fn other_files_follow_the_illumination_models() {
    let check = |statements: &str, expected: MaterialKind| {
        assert_eq!(kind(statements).0, expected, "{statements}");
    };
    let matte = |kd: f32| Principled {
        base_color: Rgb::grey(kd),
        roughness: 1.0,
        specular: 0.0,
        ..Principled::default()
    };
    let boxed = |p: Principled| MaterialKind::Principled(Box::new(p));
    check("Kd 0.5 0.5 0.5", boxed(matte(0.5)));
    check("Kd 0.5\nKs 1 1 1\nillum 1", boxed(matte(0.5)));
    check("illum 0", boxed(matte(0.8)));
    // Phong: Ns 126 is a width of 1/8, the square of the roughness.
    let p = principled(kind("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 126\nillum 2").0);
    assert!((p.roughness * p.roughness - 0.125).abs() < 1e-6 && p.specular == 1.0 && p.ior == 1.5);
    // Lamps, mirrors, and glass.
    let lamp = MaterialKind::Light { radiance: Rgb::new(17.0, 12.0, 4.0), sides: Sides::Both };
    check("Kd 0 0 0\nKe 17 12 4", lamp);
    assert_eq!(principled(kind("Kd 0.7 0.7 0.7\nKe 17 12 4").0).emission, Rgb::new(17.0, 12.0, 4.0));
    check("Kd 0 0 0\nKs 0.9 0.9 0.9\nillum 3\nNs 1000", MaterialKind::Mirror { color: Rgb::grey(0.9) });
    let p = principled(kind("Kd 0 0 0\nKs 0.9 0.9 0.9\nillum 3\nNs 30").0);
    assert_eq!((p.metallic, p.base_color), (1.0, Rgb::grey(0.9)));
    let p = principled(kind("Kd 0.5 0.5 0.5\nKs 0.4 0.4 0.4\nillum 3\nNs 1000\nNi 1.5").0);
    assert!(p.roughness == 0.0 && (p.specular_color.r * 0.04 - 0.4).abs() < 1e-6);
    let glass = |ior: f32, tint: f32| {
        MaterialKind::Glass(Glass { ior, tint: Rgb::grey(tint), absorption: None, priority: None })
    };
    check("Kd 0 0 0\nillum 7\nNi 1.33", glass(1.33, 1.0));
    check("Kd 0 0 0\nillum 6\nNi 1.5\nTf 0.5 0.5 0.5", glass(1.5, 0.5));
    check("Kd 0 0 0\nillum 4\nNi 1.5\nd 0.1", glass(1.5, 1.0));
    check("illum 7", glass(1.5, 1.0));
    // Opaque materials of programs that always write Tf or illum 4.
    check("Kd 0.5 0.5 0.5\nillum 4\nTf 1 1 1\nNi 1", boxed(matte(0.5)));
    check("Kd 0.5 0.5 0.5\nKs 0 0 0\nillum 2\nTf 1 1 1\nNi 1.5\nd 1\nTr 0", boxed(matte(0.5)));
    // d wins over Tr; Tr alone is its opposite.
    assert_eq!(principled(kind("d 0.75\nTr 0.9").0).alpha, 0.75);
    assert_eq!(principled(kind("Tr 0.25").0).alpha, 0.75);
    assert_eq!(kind("Tr 1").1, ["alpha-ignored"]);
    // Physical statements are taken as they are, the coat too.
    let p = principled(kind("Kd 1 1 1\nPr 0.25\nPm 1\nPc 0.5").0);
    assert_eq!((p.roughness, p.metallic, p.coat), (0.25, 1.0, 0.5));
}

/// Guards against one statement that costs all materials, which it does in tobj alone.
#[test]
fn a_broken_statement_costs_itself_alone() {
    let check = |statements: &str, expected: &[&str]| {
        let (found, notes) = kind(&format!("Kd 0.25 0.25 0.25\n{statements}"));
        assert_eq!(notes, expected, "{statements}");
        assert_eq!(principled(found).base_color, Rgb::grey(0.25), "{statements}");
    };
    check("d -halo 0.5", &["halo-ignored"]);
    check("Ks spectral metal.rfl 1", &["statement-ignored"]);
    check("Ks xyz 0.1 0.2 0.3", &["statement-ignored"]);
    check("map_Kd", &["statement-ignored"]);
    check("map_Bump   ", &["statement-ignored"]);
    check("Ks", &["statement-ignored"]);
    check("Ns shiny\nNi\nillum\nd", &["statement-ignored"; 4]);
    check("Ns 1e400\nKe nan nan nan", &["statement-ignored"; 2]);
    check("frobnicate 3", &["statement-ignored"]);
    check("Ka 1 1 1\nKs 0.5 # half\nTf 1 1", &[]);
    check("illum 99\nillum -3", &[]);
    check("newmtl\nKd 1 0 0\nnewmtl other", &["material-unnamed", "statement-ignored"]);
    check("Ns -5\nd 7\nKe -1 0 0", &["value-clamped"; 3]);
}

/// Guards options, blanks in names, folders, and which way v runs.
#[test]
fn maps_are_placed_and_found() {
    let check = |text: &str, file: &str, change: fn(&mut Map)| {
        let mut expected = parse_map(file);
        change(&mut expected);
        assert_eq!(parse_map(text), expected, "{text}");
    };
    check("my tex.png", "my tex.png", |_| ());
    check("\"my tex.png\"", "my tex.png", |_| ());
    check("-s 2 3 1 my tex.png", "my tex.png", |m| m.scale = [2.0, 3.0]);
    check("-o 0.5 -s 2 a-b -c.png", "a-b -c.png", |m| (m.offset, m.scale) = ([0.5, 0.0], [2.0, 1.0]));
    check("-bm 0.25 -clamp on -imfchan r t.png", "t.png", |m| {
        (m.strength, m.clamp, m.channel) = (Some(0.25), true, Some('r'));
    });
    check("t.png -bm 2", "t.png", |m| m.strength = Some(2.0));
    check("-mm 0 1 -t 0 0 0 -texres 512 -blendu off t.png", "t.png", |_| ());
    check("-mm 0.1 2 -type sphere t.png", "t.png", |m| {
        m.ignored = vec!["-mm 0.1 2".into(), "-type sphere".into()];
    });
    check("-s 1 2", "2", |_| ());
    check("textures\\sub\\t.png", "textures/sub/t.png", |_| ());
    check("-s nan inf 1 t.png", "t.png", |_| ());

    let textures = |statements: &str| -> (Textures, Vec<&'static str>) {
        let (kind, notes) = kind(statements);
        (principled(kind).textures, notes)
    };
    let (t, notes) = textures("map_Kd -s 2 4 1 -o 0.5 0.25 0 -clamp on grey.png");
    let t = t.base_color.unwrap();
    // v' = 4 v + 1/4 upwards is 4 v - 3 - 1/4 downwards.
    assert_eq!((t.scale, t.offset, t.wrap), ([2.0, 4.0], [0.5, -3.25], [Wrap::Clamp; 2]));
    assert_eq!(notes, [""; 0]);
    for path in
        ["maps/100% deep.png", "maps\\100% deep.png", ".\\maps/../maps/100% deep.png", "C:\\art\\grey.png"]
    {
        let (t, notes) = textures(&format!("map_Kd {path}"));
        assert!(t.base_color.is_some(), "{path}: {notes:?}");
    }
    assert_eq!(textures("map_Kd C:\\art\\grey.png").1, ["path-shortened"]);
    for path in ["missing.png", "../scene.mtl", "/etc/hostname", "scene.obj", "maps", "file:///etc/passwd"] {
        let (t, notes) = textures(&format!("map_Kd {path}"));
        assert!(t.base_color.is_none() && notes == ["texture-missing"], "{path}: {notes:?}");
    }
    // Heights are told from normals by their colours, alpha is used where there is any.
    assert_eq!(textures("bump grey.png").1, ["bump-ignored"]);
    assert!(textures("map_bump my normals.png").0.normal.is_some());
    assert!(textures("norm grey.png").0.normal.is_some());
    assert_eq!(textures("map_d leaf.png").0.alpha.unwrap().channel, Channel::A);
    assert_eq!(textures("map_d grey.png").0.alpha.unwrap().channel, Channel::R);
    assert_eq!(textures("map_d -imfchan g leaf.png").0.alpha.unwrap().channel, Channel::G);
    let (black, notes) = kind("Kd 0 0 0\nmap_Kd grey.png");
    assert_eq!((principled(black).base_color, notes), (Rgb::WHITE, vec!["factor-ignored"]));
}

/// Guards that a scene renders without what it names, and says so.
#[test]
fn libraries_are_found_or_missed_aloud() {
    let check = |obj: &str, mtl: &str, expected: &[&str]| {
        let (scene, notes) = load_with(&format!("{obj}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3"), mtl);
        assert_eq!(codes(&notes), expected, "{obj}");
        assert_eq!(scene.materials[0].name, "m");
        assert!(notes.iter().all(|n| n.effect != NoteEffect::Missing));
    };
    let mtl = "newmtl m\nKd 1 0 0\n";
    check("mtllib scene.mtl", mtl, &[]);
    check("mtllib ./scene.mtl", mtl, &[]);
    check("mtllib .\\scene.mtl", mtl, &[]);
    check("mtllib C:\\work\\scene.mtl", mtl, &[]);
    check("mtllib other.mtl scene.mtl", mtl, &["mtllib-missing"]);
    check("mtllib my room.mtl\nmtllib scene.mtl", mtl, &["mtllib-missing"]);
    check("mtllib scene.mtl\nmtllib scene.mtl", mtl, &[]);
    check("mtllib ../scene.obj", mtl, &["statement-ignored", "material-missing"]);
    check("mtllib scene.obj", mtl, &["statement-ignored", "material-missing"]);
    check("mtllib gone.mtl", mtl, &["mtllib-missing", "material-missing"]);
    check("", mtl, &["material-missing"]);
    check("mtllib scene.mtl", "Kd 1 0 0\n# nothing", &["statement-ignored", "material-missing"]);
    // The first definition counts.
    let twice = "newmtl m\nKd 0.25 0.25 0.25\nnewmtl m\nKd 1 0 0";
    check("mtllib scene.mtl", twice, &["material-redefined"]);
}

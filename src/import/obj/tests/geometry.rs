//! Vertices, faces, sections, smoothing.

use glam::{Vec2, Vec3};

use super::*;
use crate::scene::{Shape, validate};

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Triangles, area and notes of small files; what each guards stands beside it.
#[test]
fn statements_are_read_in_every_way_they_are_written() {
    let check = |obj: &str, triangles: usize, total: f64, expected: &[&str]| {
        let (mut scene, notes) = load(obj);
        assert_eq!(scene.meshes.iter().map(|m| m.triangles.len()).sum::<usize>(), triangles, "{obj}");
        let found: f64 = scene.meshes.iter().map(area).sum();
        assert!((found - total).abs() < 1e-6 * total.max(1.0), "{obj}: area {found}, expected {total}");
        assert_eq!(codes(&notes), expected, "{obj}");
        validate(&mut scene).unwrap();
    };
    let with = |rest: &str| format!("{QUAD}{rest}");
    let plain = ["material-missing"];
    check(&with("f 1 2 3 4"), 2, 1.0, &plain);
    check(&with("f 1 2 3 4").replace('\n', "\r\n"), 2, 1.0, &plain);
    check(&with("f 1 2 3 4").replace('\n', "\r"), 2, 1.0, &plain);
    check(&with("f\t1\t2\t3 4 # end"), 2, 1.0, &plain);
    check(&with("f 1 2 \\\n 3 4\\"), 2, 1.0, &plain);
    check(&with("f -4 -3 -2 -1"), 2, 1.0, &plain);
    // An index may point forward, a negative one counts back from where it stands.
    check(&format!("f 1 2 3\n{QUAD}f -1 1 3\nv 9 9 9"), 2, 1.0, &plain);
    check(&format!("\u{feff}{QUAD}f 1 2 3 4"), 2, 1.0, &plain);
    // Polylines and points are no faces.
    check(&with("f 1 2 3\nl 1 2 3 4\nl 1 2\np 1"), 1, 0.5, &["lines-ignored", "points-ignored", plain[0]]);
    check(&with("f 1 2\nf 1\nf\nf 1 2 3"), 1, 0.5, &["faces-dropped", plain[0]]);
    // The fourth coordinate is a weight of rational curves and divides nothing.
    check("v 0 0 0 2\nv 1 0 0 2\nv 0 1 0 0\nf 1 2 3", 1, 0.5, &["weight-ignored", plain[0]]);
    check("v 0 0 0 1\nv 1 0 0 1.0\nv 0 1 0 1\nf 1 2 3", 1, 0.5, &plain);
    // Numbers that are none: their faces go, and are counted.
    check(&with("v nan 0 0\nf 1 2 5\nf 1 2 3"), 1, 0.5, &["non-finite-triangles", plain[0]]);
    check(
        &with("v 1e400 0 0\nv inf 0 0\nf 1 2 5\nf 1 2 6\nf 1 2 3"),
        1,
        0.5,
        &["non-finite-triangles", plain[0]],
    );
    check(&with("v 1e30 0 0\nf 1 2 5\nf 1 2 3"), 1, 0.5, &["non-finite-triangles", plain[0]]);
    // One that no face uses harms nothing.
    check(&with("v nan 0 0\nf 1 2 3"), 1, 0.5, &plain);
    // Corners in one place count once; a face without area is counted.
    check(&with("f 1 1 2 3 3 4 1"), 2, 1.0, &plain);
    check(&with("f 1 2 1 2\nf 1 1 1 1\nf 1 2 3"), 1, 0.5, &["degenerate-faces", plain[0]]);
    check(
        &with("csh rm -rf /\ncall scene.obj\nf 1 2 3"),
        1,
        0.5,
        &["command-ignored", "command-ignored", plain[0]],
    );
    check(
        &with("cstype bezier\ndeg 3\ncurv 0 1 1 2 3 4\nend\nf 1 2 3"),
        1,
        0.5,
        &["free-form-ignored", plain[0]],
    );
    check(
        &with("frobnicate 1\nlod 3\nf 1 2 3"),
        1,
        0.5,
        &["statement-ignored", "statement-ignored", plain[0]],
    );
    // The figure of eight shows both of its halves.
    check(&with("f 1 2 4 3"), 2, 1.0, &["crossing-face", plain[0]]);
    check(QUAD, 0, 0.0, &["no-faces"]);
    check("", 0, 0.0, &["no-faces"]);
    check("# only a comment", 0, 0.0, &["no-faces"]);
}

/// Guards the shape of messages, and that nothing which contradicts the format loads.
#[test]
fn contradictions_name_their_line() {
    let check = |obj: &str, expected: &str| assert_eq!(error(obj), expected, "{obj}");
    check(
        &format!("{QUAD}\nf 1 2 5"),
        "line 6: found an index 5 of `v`, expected at most 4, the number of `v` in the file",
    );
    check(
        "v 0 0 0\nf 1 1 1\nf 1/1 1/1 1/1",
        "line 3: found an index 1 of `vt`, expected none, since the file has no `vt`",
    );
    check(
        "v 0 0 0\nf 0 1 1",
        "line 2: found the corner \"0\", expected indices that count from 1, or back from -1",
    );
    check(
        "v 0 0 0\nf -2 1 1",
        "line 2: found the corner \"-2\", expected a negative index that stays within the vertices before the face",
    );
    check(
        "v 0 0 0\nf 99999999999 1 1",
        "line 2: found the corner \"99999999999\", expected an index below 2^32",
    );
    let shape = "expected `v`, `v/vt`, `v//vn` or `v/vt/vn` in whole numbers";
    check("v 0 0 0\nf 1 1 x", &format!("line 2: found the corner \"x\", {shape}"));
    check("v 0 0 0\nf 1 1 /1", &format!("line 2: found the corner \"/1\", {shape}"));
    check("v 0 0 0\nf 1 1 1/1/1/1", &format!("line 2: found the corner \"1/1/1/1\", {shape}"));
    check(
        "v 0 0 0\nf 1 1 99999999999999999999999",
        &format!("line 2: found the corner \"99999999999999999999999\", {shape}"),
    );
    check("v 0 0", "line 1: found 2 numbers, expected three numbers, and maybe a weight or a colour");
    check("v 0 0 zero", "line 1: found \"zero\" after `v`, expected a number");
    check("vn 1", "line 1: found 1 numbers, expected three numbers");
    check("vt", "line 1: found 0 numbers, expected one to three numbers");
    check(
        "\n\nhello, world",
        "line 3: found \"hello,\", expected a statement of OBJ, such as `v` or `f`, somewhere in the file",
    );
}

/// Guards names, and that a mesh is one object with one material, however its faces are scattered.
#[test]
fn objects_groups_and_materials_make_meshes() {
    let check = |statements: &str, expected: &[&str]| {
        let (scene, _) = load(&format!("{QUAD}{statements}"));
        let name = |o: &crate::scene::Object| {
            let Shape::Mesh(id) = o.shape else { unreachable!() };
            let count = scene.meshes[id.0 as usize].triangles.len();
            format!("{}: {} x{count}", o.name, scene.materials[o.material.0 as usize].name)
        };
        let found: Vec<String> = scene.objects.iter().map(name).collect();
        assert_eq!(found, expected, "{statements}");
    };
    check("f 1 2 3", &["scene: default x1"]);
    check("o A\nf 1 2 3\no B b\nf 1 3 4", &["A: default x1", "B b: default x1"]);
    check("g left side\nf 1 2 3\ng default\nf 1 3 4", &["left side: default x1", "scene: default x1"]);
    check("o A\ng A\nf 1 2 3\ng B\nf 1 3 4", &["A: default x1", "A/B: default x1"]);
    check(
        "usemtl red paint\nf 1 2 3\nusemtl blue\nf 1 3 4\nusemtl red paint\nf 1 2 4",
        &["scene: red paint x2", "scene: blue x1"],
    );
    check("usemtl a\no A\nf 1 2 3\no B\nf 1 3 4\no A\nf 1 2 4", &["A: a x2", "B: a x1"]);
    check("o A\nusemtl a\no B\nusemtl\nf 1 2 3", &["B: default x1"]);
}

/// Guards the origin of texture coordinates and the indices of corners.
#[test]
fn texture_coordinates_are_turned_and_normals_kept() {
    let (scene, _) = load(&format!("{QUAD}vt 0 0\nvt 1 0.25\nvt 1\nvn 0 0 2\nf 1/1/1 2/2/1 3/3/1"));
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.uvs[0], [Vec2::new(0.0, 1.0), Vec2::new(1.0, 0.75), Vec2::new(1.0, 1.0)]);
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
    // One corner without, and one that is not a number, leave the others where they are.
    let (scene, notes) = load(&format!("{QUAD}vt 0.5 0.5\nvt nan 0\nf 1/1 2 3/2"));
    assert_eq!(scene.meshes[0].uvs[0], [Vec2::splat(0.5), Vec2::Y, Vec2::Y]);
    assert_eq!(codes(&notes), ["attribute-dropped", "uvs-partial", "material-missing"]);
    // A normal of length zero comes from the face.
    let (scene, notes) = load(&format!("{QUAD}vn 0 0 0\nvn 1 0 0\nf 1//1 2//2 3//2"));
    assert_eq!(scene.meshes[0].normals, [Vec3::Z, Vec3::X, Vec3::X]);
    assert_eq!(codes(&notes), ["normals-repaired", "material-missing"]);
}

/// A roof of two sides: smooth across the ridge in one group, sharp between groups, flat without.
#[test]
fn smoothing_groups_become_normals() {
    let roof = "v 0 0 0\nv 0 0 1\nv 1 1 0\nv 1 1 1\nv 2 0 0\nv 2 0 1\n";
    let normals = |faces: &str| {
        let (scene, _) = load(&format!("{roof}{faces}"));
        let mesh = &scene.meshes[0];
        // At the ridge, as many different normals as there are.
        let ridge: Vec<Vec3> =
            mesh.positions.iter().zip(&mesh.normals).filter(|(p, _)| p.y == 1.0).map(|(_, n)| *n).collect();
        (mesh.normals.is_empty(), ridge)
    };
    let (empty, ridge) = normals("s 1\nf 1 2 4 3\nf 3 4 6 5");
    assert!(!empty && ridge.len() == 2 && ridge.iter().all(|n| n.distance(Vec3::Y) < 1e-6), "{ridge:?}");
    let (_, ridge) = normals("s 1\nf 1 2 4 3\ns 2\nf 3 4 6 5");
    assert!(ridge.len() == 4 && ridge.iter().all(|n| n.y < 0.8), "{ridge:?}");
    for off in ["", "s off\n", "s 0\n"] {
        assert!(normals(&format!("{off}f 1 2 4 3\nf 3 4 6 5")).0, "{off:?}");
    }
    // Half smooth, half flat: the flat half gets the normals of its faces.
    let (_, ridge) = normals("s 1\nf 1 2 4 3\ns off\nf 3 4 6 5");
    assert!(ridge.iter().all(|n| n.y < 0.8), "{ridge:?}");
}

/// Guards the encoding of colours, and that a file with some of them loads.
#[test]
fn vertex_colours_are_linear_and_may_be_partial() {
    let (scene, notes) = load("v 0 0 0 1 0.5 0\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\nf 1 2 3");
    let half = crate::color::srgb_to_linear(0.5);
    assert_eq!(scene.meshes[0].colors[0].to_array(), [1.0, half, 0.0, 1.0]);
    assert_eq!(codes(&notes), ["material-missing"]);
    let (scene, notes) = load("v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nv 1 1 0 2 nan -1\nf 1 2 3\nf 2 4 3");
    let colors: Vec<_> = scene.meshes[0].colors.iter().map(|c| c.truncate()).collect();
    assert_eq!(colors, [Vec3::ONE, Vec3::X, Vec3::ONE, Vec3::X]);
    assert_eq!(codes(&notes), ["value-clamped", "vertex-colors-partial", "material-missing"]);
}

/// Guards that copies cost one mesh.
#[test]
fn equal_meshes_are_shared() {
    let (scene, _) = load(&format!("{QUAD}o A\nf 1 2 3\no B\nf 1 2 3\no C\nf 1 3 4"));
    assert_eq!((scene.objects.len(), scene.meshes.len()), (3, 2));
}

/// Guards against files that ask for more than they hold.
#[test]
fn limits_are_kept() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("scene.obj"), format!("{QUAD}{}", "f 1 2 3 4\n".repeat(1000))).unwrap();
    let check = |options: ReadOptions, expected: &str| {
        let e = read(&dir.path().join("scene.obj"), &options).unwrap_err().to_string();
        assert!(e.contains(expected), "{e}");
    };
    check(
        ReadOptions { max_triangles: 100, ..ReadOptions::default() },
        "line 55: a file of more than 100 triangles",
    );
    check(ReadOptions { max_bytes: 100_000, ..ReadOptions::default() }, "more than 100000 bytes");
}

/// Guards the time that a large file takes: half a million triangles, smooth, with texture coordinates.
#[test]
fn half_a_million_triangles_load_in_seconds() {
    use std::fmt::Write;
    let mut obj = String::from("s 1\n");
    let side = 501;
    for i in 0..side * side {
        let (x, y) = (i % side, i / side);
        writeln!(
            obj,
            "v {x}.25 {}.5 {y}.125\nvt {} {}",
            (x * 7 + y * 3) % 5,
            x as f32 / 500.0,
            y as f32 / 500.0
        )
        .unwrap();
    }
    for i in (0..(side - 1) * side).filter(|i| (i + 1) % side != 0) {
        let [a, b, c, d] = [i + 1, i + 2, i + side + 2, i + side + 1];
        writeln!(obj, "f {a}/{a} {b}/{b} {c}/{c} {d}/{d}").unwrap();
    }
    let start = std::time::Instant::now();
    let (scene, _) = load(&obj);
    assert_eq!(scene.meshes[0].triangles.len(), 500_000);
    assert_eq!(scene.meshes[0].positions.len(), side * side);
    let seconds = start.elapsed().as_secs_f64();
    assert!(seconds < 30.0, "{seconds} s");
}

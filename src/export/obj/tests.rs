//! What is written, as a reader of the files sees it.

use super::*;
use crate::scene::text::parse_toml;

/// All files but pictures, one after the other, and the notes.
fn written(toml: &str) -> String {
    let scene = parse_toml(&format!("epsilux = 1\n{toml}")).unwrap_or_else(|e| panic!("{e}")).0;
    let encoded = encode(&scene, "room.obj").unwrap();
    let mut out = String::new();
    for file in &encoded.files {
        let _ = writeln!(out, "== {}\n{}", file.path, String::from_utf8_lossy(&file.bytes));
    }
    for note in &encoded.notes {
        let _ = writeln!(out, "{} ({:?}): {note}", note.code, note.effect);
    }
    out
}

/// One object of each sort: placed, mirrored, shared, coloured, hidden, with a name of two lines.
#[test]
fn objects_are_placed_and_what_is_lost_is_said() {
    insta::assert_snapshot!(written(
        r#"
        title = "Small"
        camera.main = { eye = [0, 1, 5], target = [0, 1, 0], fov = 40 }
        environment = { radiance = [1, 1, 1] }
        [material]
        grey = { diffuse = [0.5, 0.5, 0.5] }
        "two\nlines" = { mirror = [0.9, 0.9, 0.9] }
        unused = { light = [1, 1, 1] }
        [mesh.card]
        positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        normals = [[0, 0, 1], [0, 0, 1], [0, 0, 1]]
        uvs = [[0, 1], [1, 1], [0, 0.25]]
        uvs2 = [[0, 0], [0, 0], [0, 0]]
        colors = [[1, 1, 1, 1], [0.2140411, 1, 0, 0.5], [0, 0, 2, 1]]
        triangles = [[0, 1, 2]]
        [[object]]
        name = "card"
        material = "grey"
        mesh = "card"
        [[object]]
        name = "card"
        material = "two\nlines"
        mesh = "card"
        transform = { translate = [0, 0, 3], scale = [-1, 1, 2] }
        visible_to_camera = false
        [[object]]
        material = "grey"
        mesh = { positions = [[0, 0, 0], [0.1, 0, 0], [0, 1e-12, 0]], triangles = [[0, 1, 2]] }
        transform = { rotate = [0, 0, 90] }
        [[object]]
        name = "nothing"
        material = "grey"
        mesh = { positions = [], triangles = [] }
        [[object]]
        material = "grey"
        sphere = { radius = 1 }
        "#
    ));
}

/// Each kind of material has the statements that the format has for it; where those do not say all of it,
/// the sidecar does.
#[test]
fn materials_are_written_as_far_as_mtl_goes() {
    let mut objects = String::new();
    let names =
        ["matte", "mirror", "glass", "ruby", "lamp", "panel", "plastic", "cloth", "frosted", "veil", "leaf"];
    for name in names {
        objects += &format!(
            "[[object]]\nmaterial = \"{name}\"\nmesh = {{ positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }}\n"
        );
    }
    let materials = r#"
        [material]
        matte = { diffuse = [0.5, 0.4, 0.3] }
        mirror = { mirror = [0.95, 0.95, 0.95] }
        glass = { glass = { ior = 1.45, tint = [0.9, 1, 0.9] } }
        ruby = { glass = { ior = 1.76, absorption = { color = [0.8, 0.05, 0.1], distance = 0.01 } } }
        lamp = { light = [10, 9, 8], sides = "both" }
        panel = { light = [10, 9, 8] }
        plastic = { principled = { base_color = [0.7, 0.1, 0.1], roughness = 0.2, coat = 1, coat_roughness = 0.1 } }
        cloth = { principled = { base_color = [0.1, 0.1, 0.4], sheen_color = [0.5, 0.5, 0.6] } }
        frosted = { principled = { transmission = 1, roughness = 0.4, base_color = [0.9, 1, 0.95] } }
        veil = { principled = { alpha = 0.5 } }
        leaf = { principled = { alpha = 0.5, alpha_mode = "mask" } }
    "#;
    insta::assert_snapshot!(written(&format!("{materials}{objects}")));
}

/// The inverse transpose leaves normals upright on the surface, whatever the transform does to it.
#[test]
fn normals_stay_normal() {
    let transforms = [
        DMat3::from_diagonal(DVec3::new(1.0, 4.0, 0.5)),
        DMat3::from_diagonal(DVec3::new(-1.0, 2.0, 3.0)),
        DMat3::from_cols(DVec3::new(1.0, 0.5, 0.0), DVec3::new(0.0, 1e-9, 0.0), DVec3::new(0.2, 0.0, 1e9)),
    ];
    let (a, b) = (DVec3::new(1.0, 2.0, -0.5), DVec3::new(-0.3, 0.4, 2.0));
    let n = a.cross(b);
    for m in transforms {
        let turned = (normal_matrix(m) * n).normalize();
        let expected = (m * a).cross(m * b).normalize() * m.determinant().signum();
        assert!((turned - expected).length() < 1e-9, "{m}: {turned} {expected}");
    }
}

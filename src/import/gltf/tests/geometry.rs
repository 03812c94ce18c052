//! Accessors and primitives: each way of storing the same square gives the same square.

use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use super::build::{SQUARE, floats, lines, read, square_with, uri};
use crate::scene::Mesh;

fn mesh(doc: &Value) -> Mesh {
    let (scene, notes) = read(doc).unwrap();
    assert_eq!(lines(&notes), "");
    assert_eq!((scene.meshes.len(), scene.objects.len()), (1, 1));
    scene.meshes.into_iter().next().unwrap()
}

/// The positions of the triangles' corners, whatever the indices are.
fn corners(mesh: &Mesh) -> Vec<[f32; 3]> {
    mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize].to_array()).collect()
}

fn expected_corners() -> Vec<[f32; 3]> {
    [0, 1, 2, 0, 2, 3].map(|i: usize| [SQUARE[3 * i], SQUARE[3 * i + 1], SQUARE[3 * i + 2]]).into()
}

fn check(changes: &[(&str, Value)]) {
    assert_eq!(corners(&mesh(&square_with(changes))), expected_corners(), "{changes:?}");
}

/// Replaces the indices: their bytes, component type, and number.
fn with_indices(indices: &[u8], component: u32, count: usize, mode: u32) -> Vec<(&'static str, Value)> {
    let mut bytes = floats(&SQUARE);
    bytes.extend(indices);
    vec![
        ("/buffers/0", json!({"byteLength": bytes.len(), "uri": uri(&bytes)})),
        ("/bufferViews/1/byteLength", json!(indices.len())),
        ("/accessors/1/componentType", json!(component)),
        ("/accessors/1/count", json!(count)),
        ("/meshes/0/primitives/0/mode", json!(mode)),
    ]
}

#[test]
fn all_index_types_and_modes_give_the_same_square() {
    check(&[]);
    check(&with_indices(&[0, 1, 2, 0, 2, 3], 5121, 6, 4));
    let wide: Vec<u8> = [0_u32, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect();
    check(&with_indices(&wide, 5125, 6, 4));
    // A fan over 1 2 3 about 0 names the same corners, turned round within a triangle.
    let fan = mesh(&square_with(&with_indices(&[0, 1, 2, 3], 5121, 4, 6)));
    assert_eq!(fan.triangles, [[1, 2, 0], [2, 3, 0]]);
    let strip = mesh(&square_with(&with_indices(&[1, 2, 0, 3], 5121, 4, 5)));
    assert_eq!(strip.triangles, [[1, 2, 0], [2, 3, 0]]);
}

#[test]
fn a_mesh_without_indices_uses_its_vertices_in_order() {
    let positions: Vec<f32> = expected_corners().concat();
    let mut doc = square_with(&[
        ("/accessors/0/count", json!(6)),
        ("/bufferViews/0/byteLength", json!(72)),
        ("/buffers/0", json!({"byteLength": 72, "uri": uri(&floats(&positions))})),
        ("/bufferViews/1", json!({"buffer": 0, "byteLength": 4})),
    ]);
    doc.pointer_mut("/meshes/0/primitives/0").unwrap().as_object_mut().unwrap().remove("indices");
    assert_eq!(corners(&mesh(&doc)), expected_corners());
}

#[test]
fn interleaved_vertices_are_read_at_their_stride() {
    // Position, texture coordinate, position, ...
    let mut bytes = Vec::new();
    for p in SQUARE.chunks(3) {
        bytes.extend(floats(p));
        bytes.extend(floats(&[p[0], 1.0 - p[1]]));
    }
    bytes.extend([0_u8, 1, 2, 0, 2, 3]);
    let mesh = mesh(&square_with(&[
        ("/buffers/0", json!({"byteLength": bytes.len(), "uri": uri(&bytes)})),
        ("/bufferViews/0", json!({"buffer": 0, "byteLength": 80, "byteStride": 20})),
        ("/bufferViews/1", json!({"buffer": 0, "byteOffset": 80, "byteLength": 6})),
        ("/accessors/1/componentType", json!(5121)),
        (
            "/accessors/2",
            json!({"bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 4, "type": "VEC2"}),
        ),
        ("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(2)),
    ]));
    assert_eq!(corners(&mesh), expected_corners());
    assert_eq!(mesh.uvs[0], [[0., 1.], [1., 1.], [1., 0.], [0., 0.]].map(Vec2::from));
}

#[test]
fn sparse_accessors_replace_values_of_a_view_or_of_zeros() {
    // The square lacks its last corner; a sparse accessor puts it there.
    let mut bytes = floats(&SQUARE);
    bytes[36..48].fill(0);
    bytes.extend([0_u8, 1, 2, 0, 2, 3, 3, 0]);
    bytes.extend(floats(&[0., 1., 0.]));
    let sparse = json!({
        "count": 1,
        "indices": {"bufferView": 2, "componentType": 5121},
        "values": {"bufferView": 3},
    });
    let changes = vec![
        ("/buffers/0", json!({"byteLength": bytes.len(), "uri": uri(&bytes)})),
        ("/bufferViews/1/byteLength", json!(6)),
        ("/bufferViews/2", json!({"buffer": 0, "byteOffset": 54, "byteLength": 1})),
        ("/bufferViews/3", json!({"buffer": 0, "byteOffset": 56, "byteLength": 12})),
        ("/accessors/1/componentType", json!(5121)),
        ("/accessors/0/sparse", sparse),
    ];
    check(&changes);
    let mut doc = square_with(&changes);
    doc["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let zeros = mesh(&doc);
    assert_eq!(zeros.positions, [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::Y]);
}

/// Normalised integers follow glTF's formulas, where -128 and -127 are both -1.
#[test]
fn normalised_integers_become_floats() {
    let mut bytes = floats(&SQUARE);
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend([0, 255, 51, 0].repeat(4)); // colours
    bytes.extend([0x80, 0, 0, 0].repeat(4)); // normals, with padding
    let colors =
        json!({"bufferView": 2, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"});
    let normals =
        json!({"bufferView": 3, "componentType": 5120, "normalized": true, "count": 4, "type": "VEC3"});
    let doc = square_with(&[
        ("/buffers/0", json!({"byteLength": bytes.len(), "uri": uri(&bytes)})),
        ("/bufferViews/2", json!({"buffer": 0, "byteOffset": 60, "byteLength": 16})),
        ("/bufferViews/3", json!({"buffer": 0, "byteOffset": 76, "byteLength": 16, "byteStride": 4})),
        ("/accessors/2", colors),
        ("/accessors/3", normals),
        ("/meshes/0/primitives/0/attributes/COLOR_0", json!(2)),
        ("/meshes/0/primitives/0/attributes/NORMAL", json!(3)),
    ]);
    let (scene, notes) = read(&doc).unwrap();
    assert_eq!(scene.meshes[0].colors, [Vec4::new(0.0, 1.0, 0.2, 0.0); 4]);
    assert_eq!(scene.meshes[0].normals, [Vec3::NEG_X; 4]);
    insta::assert_snapshot!(lines(&notes), @r#"
    "#);
}

/// A normal that is no direction is made from the faces; the others stay.
#[test]
fn broken_normals_are_taken_from_the_faces() {
    let mut bytes = floats(&SQUARE);
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend(floats(&[f32::NAN, 0., 0., 0., 0., 0., 2., 0., 0., 0., 3., 0.]));
    let doc = square_with(&[
        ("/buffers/0", json!({"byteLength": bytes.len(), "uri": uri(&bytes)})),
        ("/bufferViews/2", json!({"buffer": 0, "byteOffset": 60, "byteLength": 48})),
        ("/accessors/2", json!({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"})),
        ("/meshes/0/primitives/0/attributes/NORMAL", json!(2)),
    ]);
    let (scene, notes) = read(&doc).unwrap();
    assert_eq!(scene.meshes[0].normals, [Vec3::Z, Vec3::Z, Vec3::X, Vec3::Y]);
    insta::assert_snapshot!(lines(&notes), @r#"
    normals-repaired (Differs) meshes[0].primitives[0].attributes.NORMAL: 2 normals are zero or not finite: taken from the faces
    "#);
}

/// Points and lines have no surface; each is said once, with a count.
#[test]
fn points_and_lines_are_ignored_with_a_count() {
    let p = json!({"attributes": {"POSITION": 0}, "mode": 0});
    let l = json!({"attributes": {"POSITION": 0}, "mode": 3});
    let (scene, notes) = read(&square_with(&[("/meshes/0/primitives", json!([p, l]))])).unwrap();
    assert!(scene.objects.is_empty() && scene.meshes.is_empty());
    insta::assert_snapshot!(lines(&notes), @r#"
    primitive-ignored (Missing) meshes[0].primitives[0]: points and lines are not rendered (here and in 1 more)
    "#);
}

/// Modified duplicates come with a mesh each; they are one mesh here, and may differ in material.
#[test]
fn equal_primitives_share_a_mesh() {
    let copy = json!({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"});
    let doc = square_with(&[
        ("/accessors/2", copy),
        ("/materials", json!([{}])),
        ("/meshes/1", json!({"primitives": [{"attributes": {"POSITION": 2}, "indices": 1, "material": 0}]})),
        ("/nodes/1", json!({"mesh": 1})),
        ("/nodes/2", json!({"mesh": 0})),
        ("/scenes/0/nodes", json!([0, 1, 2])),
    ]);
    let (scene, _) = read(&doc).unwrap();
    assert_eq!((scene.meshes.len(), scene.objects.len(), scene.materials.len()), (1, 3, 2));
    let materials: Vec<_> = scene.objects.iter().map(|o| o.material.0).collect();
    assert_eq!(materials, [1, 0, 1]);
}

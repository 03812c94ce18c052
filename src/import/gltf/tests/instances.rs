//! Many objects from little: linked duplicates, instances, and morphed shapes.

use glam::DVec3;
use serde_json::{Value, json};

use super::super::super::ReadOptions;
use super::build::{SQUARE, floats, lines, read, read_as, set, square, square_with, uri};
use crate::scene::Shape;

/// The square, and a buffer of other numbers with views and accessors over it: (bytes, accessor).
fn with_accessors(list: &[(Vec<u8>, Value)]) -> Value {
    let mut doc = square();
    for (i, (bytes, accessor)) in list.iter().enumerate() {
        let n = i + 2;
        set(&mut doc, &format!("/buffers/{}", i + 1), json!({"byteLength": bytes.len(), "uri": uri(bytes)}));
        set(&mut doc, &format!("/bufferViews/{n}"), json!({"buffer": i + 1, "byteLength": bytes.len()}));
        set(&mut doc, &format!("/accessors/{n}"), accessor.clone());
        set(&mut doc, &format!("/accessors/{n}/bufferView"), json!(n));
    }
    doc
}

fn vec3(count: usize) -> Value {
    json!({"componentType": 5126, "count": count, "type": "VEC3"})
}

/// Two thousand nodes with one mesh are two thousand objects with one mesh; so are equal meshes.
#[test]
fn linked_duplicates_are_one_mesh() {
    let node = |i: usize| json!({"mesh": i % 2, "translation": [i, 0, 0]});
    let nodes: Vec<_> = (0..2000).map(node).collect();
    let roots: Vec<_> = (0..2000).collect();
    let mut doc = square_with(&[("/nodes", json!(nodes)), ("/scenes/0/nodes", json!(roots))]);
    let mesh = doc["meshes"][0].clone();
    set(&mut doc, "/meshes/1", mesh);
    let (scene, notes) = read(&doc).unwrap();
    assert_eq!((scene.objects.len(), scene.meshes.len(), notes.len()), (2000, 1, 0));
    assert!(scene.objects.iter().all(|o| matches!(o.shape, Shape::Mesh(id) if id.0 == 0)));
    assert_eq!(scene.objects[1999].transform.translation, DVec3::new(1999.0, 0.0, 0.0));
}

/// Instances stand where translation, rotation and scale say, below their node.
#[test]
fn instances_are_objects() {
    let turns: Vec<u8> = [[0, 0, 0, 127], [0, 0, 127, 0_u8]].concat();
    let mut doc = with_accessors(&[
        (floats(&[1., 0., 0., 0., 5., 0.]), vec3(2)),
        (turns, json!({"componentType": 5120, "normalized": true, "count": 2, "type": "VEC4"})),
        (floats(&[1., 1., 1., 2., 3., 4.]), vec3(2)),
    ]);
    let attributes = json!({"TRANSLATION": 2, "ROTATION": 3, "SCALE": 4, "_ID": 0});
    set(&mut doc, "/nodes/0/extensions", json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}}));
    set(&mut doc, "/nodes/0/translation", json!([0, 0, 9]));
    set(&mut doc, "/extensionsRequired", json!(["EXT_mesh_gpu_instancing"]));
    let (scene, notes) = read(&doc).unwrap();
    assert_eq!((scene.objects.len(), scene.meshes.len(), lines(&notes)), (2, 1, String::new()));
    let at = |i: usize| scene.objects[i].transform.transform_point3(DVec3::new(1.0, 1.0, 1.0));
    assert_eq!(at(0), DVec3::new(2.0, 1.0, 10.0));
    assert!((at(1) - DVec3::new(-2.0, 2.0, 13.0)).length() < 1e-12, "{}", at(1));

    let refuse = |pointer: &str, value: Value| {
        let mut doc = doc.clone();
        set(&mut doc, pointer, value);
        let options = ReadOptions { max_bytes: 1 << 20, ..ReadOptions::default() };
        read_as(&doc, &options).unwrap_err().to_string() + "\n"
    };
    let at = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";
    let zero = json!({"bufferView": 3, "componentType": 5120, "normalized": true, "count": 2, "type": "VEC4", "byteOffset": 9});
    let huge = json!({"componentType": 5126, "count": 1_000_000_000_000_u64, "type": "VEC3"});
    let mut said = refuse(&format!("{at}/SCALE"), json!(99));
    said += &refuse(&format!("{at}/SCALE"), json!("a"));
    said += &refuse(&format!("{at}/SCALE"), json!(0));
    said += &refuse("/accessors/3", zero);
    said += &refuse("/accessors/3", json!({"componentType": 5126, "count": 2, "type": "VEC4"}));
    said += &refuse(at, json!({"TRANSLATION": 2, "ROTATION": 2}));
    let mut doc = doc.clone();
    set(&mut doc, at, json!({"TRANSLATION": 2}));
    set(&mut doc, "/accessors/2", huge);
    said += &read(&doc).unwrap_err().to_string();
    insta::assert_snapshot!(said);
}

/// Few nodes and few primitives make many objects: the limit holds for their product.
#[test]
fn objects_are_charged() {
    let primitive = json!({"attributes": {"POSITION": 0}, "indices": 1});
    let nodes: Vec<_> = (0..300).map(|_| json!({"mesh": 0})).collect();
    let doc = square_with(&[
        ("/meshes/0/primitives", json!(vec![primitive; 300])),
        ("/nodes", json!(nodes)),
        ("/scenes/0/nodes", json!((0..300).collect::<Vec<_>>())),
    ]);
    let options = ReadOptions { max_bytes: 1 << 20, ..ReadOptions::default() };
    let error = read_as(&doc, &options).unwrap_err().to_string();
    assert!(error.contains("needs more than 1048576 bytes"), "{error}");
    assert_eq!(read(&doc).unwrap().0.objects.len(), 90_000);
}

/// Weights of the mesh, or of the node before them, move vertices; without any the base shape is right.
#[test]
fn morph_targets_are_applied_by_their_weights() {
    let mut lift = floats(&[0., 0., 2.].repeat(4));
    let mut doc =
        with_accessors(&[(std::mem::take(&mut lift), vec3(4)), (floats(&[1., 0., 0.].repeat(4)), vec3(4))]);
    set(&mut doc, "/meshes/0/primitives/0/targets", json!([{"POSITION": 2}, {"POSITION": 3}]));
    let z_and_x = |doc: &Value| {
        let (scene, notes) = read(doc).unwrap();
        assert_eq!(lines(&notes), "");
        let p = scene.meshes[0].positions[0];
        (p.z - SQUARE[2], p.x - SQUARE[0])
    };
    assert_eq!(z_and_x(&doc), (0.0, 0.0));
    set(&mut doc, "/meshes/0/weights", json!([0.5, 0]));
    assert_eq!(z_and_x(&doc), (1.0, 0.0));
    set(&mut doc, "/nodes/0/weights", json!([0.25, -1]));
    assert_eq!(z_and_x(&doc), (0.5, -1.0));
    set(&mut doc, "/nodes/1", json!({"mesh": 0}));
    set(&mut doc, "/scenes/0/nodes", json!([0, 1]));
    assert_eq!(read(&doc).unwrap().0.meshes.len(), 2, "different weights are different shapes");
    set(&mut doc, "/meshes/0/primitives/0/targets/0/POSITION", json!(1));
    insta::assert_snapshot!(read(&doc).unwrap_err().to_string(), @r#"
    test.gltf: accessors[1]: found 6 elements, expected 4, as of the base shape
    "#);
}

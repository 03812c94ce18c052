//! Transforms, the shape of the node graph, and exact spheres.

use glam::DVec3;
use serde_json::{Value, json};

use super::build::{lines, read, square_with};
use crate::scene::Shape;

/// Where a node below another puts the point (1, 2, 3) of its mesh.
fn check(parent: Value, child: Value, expected: [f64; 3]) {
    let mut child = child;
    child["mesh"] = json!(0);
    let mut parent = parent;
    parent["children"] = json!([1]);
    let (scene, _) = read(&square_with(&[("/nodes", json!([parent, child]))])).unwrap();
    let p = scene.objects[0].transform.transform_point3(DVec3::new(1.0, 2.0, 3.0));
    assert!((p - DVec3::from(expected)).length() < 1e-7, "{p} {expected:?}");
}

#[test]
fn transforms_multiply_from_the_root_down() {
    let turn = std::f32::consts::FRAC_1_SQRT_2;
    check(json!({}), json!({}), [1., 2., 3.]);
    check(json!({"translation": [10, 0, 0]}), json!({"scale": [2, 3, -4]}), [12., 6., -12.]);
    check(json!({"scale": [2, 2, 2]}), json!({"translation": [10, 0, 0]}), [22., 4., 6.]);
    check(json!({"rotation": [0, 0, turn, turn]}), json!({}), [-2., 1., 3.]);
    check(
        json!({"matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}),
        json!({"rotation": [0, 0, turn, turn], "scale": [1, 1, 2]}),
        [4., 4., 13.],
    );
}

/// A mirrored object keeps its transform; turning its winding is the business of `prepare`.
#[test]
fn negative_determinants_are_kept() {
    let (scene, notes) = read(&square_with(&[("/nodes/0/scale", json!([-1, 1, 1]))])).unwrap();
    assert_eq!(scene.objects[0].transform.matrix3.determinant(), -1.0);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(notes.is_empty());
}

/// A long chain is walked without recursion.
#[test]
fn chains_of_nodes_may_be_long() {
    let n = 100_000;
    let mut nodes: Vec<_> = (0..n).map(|i| json!({"translation": [1, 0, 0], "children": [i + 1]})).collect();
    nodes.push(json!({"mesh": 0}));
    let (scene, _) = read(&square_with(&[("/nodes", json!(nodes))])).unwrap();
    assert_eq!(scene.objects[0].transform.translation, DVec3::new(f64::from(n), 0.0, 0.0));
}

/// Only the default scene shows, and without scenes every root does.
#[test]
fn the_default_scene_is_read() {
    let nodes =
        ("/nodes", json!([{"name": "a", "mesh": 0}, {"name": "b", "mesh": 0, "children": [2]}, {"mesh": 0}]));
    let check = |changes: &[(&str, Value)], expected: &[&str]| {
        let mut changes = changes.to_vec();
        changes.push(nodes.clone());
        let (scene, _) = read(&square_with(&changes)).unwrap();
        let names: Vec<_> = scene.objects.iter().map(|o| &*o.name).collect();
        assert_eq!(names, expected);
    };
    check(&[("/scenes", json!([{"nodes": [0]}, {"nodes": [1]}])), ("/scene", json!(1))], &["b", "mesh 0"]);
    check(&[("/scenes", json!([{"nodes": [0]}, {"nodes": [1]}]))], &["a"]);
    check(&[("/scenes", json!([]))], &["a", "b", "mesh 0"]);
    check(&[("/scenes", json!([{}]))], &[]);
}

/// `extras.epsilux.sphere` replaces the mesh where the transform keeps a sphere a sphere.
#[test]
fn spheres_are_exact_where_the_transform_allows() {
    let check = |node: Value, is_sphere: bool| {
        let mut node = node;
        node["mesh"] = json!(0);
        let (scene, notes) = read(&square_with(&[("/nodes/0", node.clone())])).unwrap();
        let found = scene.objects[0].shape == Shape::Sphere { radius: 1.5 };
        assert_eq!(found, is_sphere, "{node}");
        assert_eq!(scene.meshes.is_empty(), is_sphere);
        if is_sphere {
            assert!(scene.objects[0].transform.matrix3.determinant() > 0.0, "{node}");
        }
        lines(&notes)
    };
    let sphere = json!({"epsilux": {"sphere": {"radius": 1.5}}});
    let mut said = String::new();
    said += &check(json!({"extras": sphere}), true);
    said += &check(json!({"extras": sphere, "scale": [2, 2, 2], "rotation": [0.6, 0, 0, 0.8]}), true);
    said += &check(json!({"extras": sphere, "scale": [-2, 2, 2]}), true);
    said += &check(json!({"extras": sphere, "scale": [1, 2, 1]}), false);
    said += &check(json!({"extras": {"epsilux": {"sphere": {"radius": 0}, "color": 1}}}), false);
    said += &check(json!({"extras": {"other": 1}}), false);
    insta::assert_snapshot!(said, @r#"
    sphere-ignored (Differs) nodes[0]: a sphere under a transform that is no rotation and uniform scale: the mesh is kept
    extension-value-ignored (Differs) nodes[0].extras.epsilux.color: unknown field `color`, expected one of `sphere`, `light`, `visibility`, `matrix`: it is left out
    sphere-ignored (Differs) nodes[0].extras.epsilux.sphere: a sphere needs a `radius` above zero: the mesh is kept
    "#);
}

//! `extras.epsilux.sphere = {radius}` on a node with a mesh: an exact sphere instead of the mesh.

use glam::{DAffine3, DMat3, DVec3};
use gltf::json;
use serde_json::Value;

use super::super::notes::Notes;
use crate::scene::NoteEffect;

/// The radius of the sphere that `node` asks for, own space, (0, inf).
pub(super) fn radius(node: &json::Node, place: &str, notes: &mut Notes) -> Option<f64> {
    let extras: Value = serde_json::from_str(node.extras.as_ref()?.get()).ok()?;
    let ours = extras.get("epsilux")?.as_object()?;
    for key in ours.keys().filter(|k| *k != "sphere") {
        let message = format!("`{key}` is not known here; `sphere` is");
        notes.add("extras-ignored", NoteEffect::Missing, format!("{place}.extras.epsilux"), message);
    }
    let sphere = ours.get("sphere")?;
    let radius = sphere.get("radius").and_then(Value::as_f64).filter(|r| r.is_finite() && *r > 0.0);
    if radius.is_none() {
        let message = "a sphere needs a `radius` above zero: the mesh is kept";
        notes.add("sphere-ignored", NoteEffect::Differs, format!("{place}.extras.epsilux.sphere"), message);
    }
    radius
}

/// `transform` where it keeps a sphere a sphere; a reflection, which a sphere does not show, is taken out.
pub(super) fn placement(transform: DAffine3) -> Option<DAffine3> {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = transform.matrix3;
    // Matrices in files are products of 32-bit numbers.
    let small = 1e-5 * x.length_squared();
    let near = |a: f64, b: f64| (a - b).abs() <= small;
    let uniform =
        near(y.length_squared(), x.length_squared()) && near(z.length_squared(), x.length_squared());
    let square = near(x.dot(y), 0.0) && near(y.dot(z), 0.0) && near(z.dot(x), 0.0);
    (uniform && square && x != DVec3::ZERO).then(|| {
        let x = if transform.matrix3.determinant() < 0.0 { -x } else { x };
        DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: transform.translation }
    })
}

//! Exact spheres: where they may stand.

use glam::{DAffine3, DMat3, DVec3};

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

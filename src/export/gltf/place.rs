//! Transforms as translation, rotation and scale.
//!
//! In: an affine transform. Out: the nodes that place something by it. glTF wants a matrix to be a
//! product of translation, rotation and scale, so one that shears is written as two nodes, by its
//! singular value decomposition. glTF's singles lose digits; where they do, the extension says the
//! matrix exactly.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use serde_json::{Map, Value, json};

use super::number::single;

/// How far from the right angle the axes of a transform may be, as a cosine, to count as square.
const SQUARE: f64 = 1e-6;

/// One node's transform.
pub(super) struct Placed {
    /// `translation`, `rotation` and `scale`, where they are not the default.
    pub(super) keys: Map<String, Value>,
    /// The matrix in full precision, where those do not give it.
    pub(super) matrix: Option<[f64; 16]>,
}

/// The transform of one node, or of a node and its child.
pub(super) enum Place {
    One(Placed),
    Two(Placed, Placed),
}

/// Places by `t`.
pub(super) fn place(t: &DAffine3) -> Place {
    let m = t.matrix3;
    let cosine = |a: DVec3, b: DVec3| (a.normalize_or_zero().dot(b.normalize_or_zero())).abs();
    let worst = cosine(m.x_axis, m.y_axis).max(cosine(m.y_axis, m.z_axis)).max(cosine(m.z_axis, m.x_axis));
    if worst <= SQUARE {
        return Place::One(square(t, t));
    }
    // M = U S V^T: the child turns by V^T, the parent scales by S and turns by U.
    let (outer, turn) = singular(m);
    let outer = DAffine3 { matrix3: outer, translation: t.translation };
    let inner = DAffine3 { matrix3: turn, translation: DVec3::ZERO };
    Place::Two(square(&outer, t), square(&inner, &DAffine3::IDENTITY))
}

/// Places by `t`, whose axes are square, and says that `exact` is meant.
fn square(t: &DAffine3, exact: &DAffine3) -> Placed {
    let (scale, rotation, translation) = t.to_scale_rotation_translation();
    let scale = scale.as_vec3();
    let translation = translation.as_vec3();
    let rotation = rotation.normalize().as_quat();
    let mut keys = Map::new();
    let list = |values: &[f32]| values.iter().copied().map(single).collect::<Vec<f64>>();
    if translation != glam::Vec3::ZERO {
        keys.insert("translation".into(), json!(list(&translation.to_array())));
    }
    if rotation != glam::Quat::IDENTITY {
        keys.insert("rotation".into(), json!(list(&rotation.to_array())));
    }
    if scale != glam::Vec3::ONE {
        keys.insert("scale".into(), json!(list(&scale.to_array())));
    }
    // What a reader makes of them in double precision.
    let read = DAffine3::from_scale_rotation_translation(
        scale.as_dvec3(),
        DQuat::from_array(rotation.to_array().map(f64::from)).normalize(),
        translation.as_dvec3(),
    );
    let matrix = (read != *exact).then(|| DMat4::from(*exact).to_cols_array());
    Placed { keys, matrix }
}

/// `m` as (U S, V^T), with U and V rotations, by Jacobi's method on m^T m.
fn singular(m: DMat3) -> (DMat3, DMat3) {
    let mut v = DMat3::IDENTITY;
    // The columns of m v become orthogonal; three sweeps suffice for doubles, eight are cheap.
    for (i, j) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(24) {
        let a = m * v;
        let (p, q) = (a.col(i), a.col(j));
        let off = p.dot(q);
        if off == 0.0 {
            continue;
        }
        let zeta = (q.length_squared() - p.length_squared()) / (2.0 * off);
        let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
        let c = 1.0 / (1.0 + t * t).sqrt();
        let s = c * t;
        let (x, y) = (v.col(i), v.col(j));
        *v.col_mut(i) = x * c - y * s;
        *v.col_mut(j) = x * s + y * c;
    }
    (m * v, v.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheared matrix is the product of its two nodes.
    #[test]
    fn shears_are_two_nodes() {
        let m = DMat3::from_cols_array(&[1.0, 0.2, -0.4, 0.9, 2.0, 0.1, 0.3, -0.7, 0.5]);
        let (outer, turn) = singular(m);
        let product = outer * turn;
        assert!((product - m).to_cols_array().iter().all(|d| d.abs() < 1e-14), "{product}");
        let square = turn * turn.transpose() - DMat3::IDENTITY;
        assert!(square.to_cols_array().iter().all(|d| d.abs() < 1e-14), "a rotation");
        let t = DAffine3 { matrix3: m, translation: DVec3::X };
        match place(&t) {
            Place::Two(parent, child) => {
                let exact = DMat4::from(t).to_cols_array();
                assert_eq!(parent.matrix, Some(exact));
                assert_eq!(child.matrix, Some(DMat4::IDENTITY.to_cols_array()));
            }
            Place::One(_) => panic!("a shear needs two nodes"),
        }
    }

    /// What singles hold needs no matrix, and what they do not has one.
    #[test]
    fn exact_matrices_are_written_where_singles_lose_digits() {
        let matrix = |t: DAffine3| match place(&t) {
            Place::One(placed) => placed.matrix,
            Place::Two(..) => panic!("no shear"),
        };
        let scale = DAffine3::from_scale_rotation_translation(
            DVec3::new(2.0, -0.5, 1.0),
            DQuat::IDENTITY,
            DVec3::new(1.0, 0.25, -3.0),
        );
        assert_eq!(matrix(DAffine3::IDENTITY), None);
        assert_eq!(matrix(DAffine3::from_translation(DVec3::new(1.0, 0.25, -3.0))), None);
        assert!(matrix(DAffine3::from_translation(DVec3::new(0.1, 0.0, 0.0))).is_some());
        let exact = matrix(scale).unwrap_or_else(|| DMat4::from(scale).to_cols_array());
        assert_eq!(exact, DMat4::from(scale).to_cols_array());
    }
}

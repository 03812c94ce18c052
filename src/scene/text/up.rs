//! Which way is up in a file, and the exact way from there to the scene's +Y up.
//!
//! The change from z-up is (x, y, z) -> (x, z, -y): a permutation and a sign, so no digit is lost.

use glam::{DAffine3, DMat3, DVec3, Vec3};

/// The axis that points up in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Up {
    /// +Y, as in the scene.
    #[default]
    Y,
    /// +Z; the ground is the xy plane.
    Z,
}

impl Up {
    /// 0, 1 or 2 for x, y or z.
    pub(super) fn axis_index(self) -> usize {
        match self {
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    /// The up direction in the file's axes.
    pub(super) fn axis(self) -> DVec3 {
        DVec3::AXES[self.axis_index()]
    }

    /// A point from its ground plan and its height, in the file's axes.
    pub(super) fn raise(self, [a, b]: [f64; 2], height: f64) -> DVec3 {
        match self {
            Self::Y => DVec3::new(a, height, b),
            Self::Z => DVec3::new(a, b, height),
        }
    }

    /// A point or direction of the file in the scene's axes. (`0 - y`, so that zero stays positive.)
    pub(super) fn to_scene(self, p: DVec3) -> DVec3 {
        match self {
            Self::Y => p,
            Self::Z => DVec3::new(p.x, p.z, 0.0 - p.y),
        }
    }

    /// The same in single precision.
    pub(super) fn to_scene_f32(self, p: Vec3) -> Vec3 {
        match self {
            Self::Y => p,
            Self::Z => Vec3::new(p.x, p.z, 0.0 - p.y),
        }
    }

    /// A transform of something with its own axes, such as a camera: only the outside turns.
    pub(super) fn place(self, t: DAffine3) -> DAffine3 {
        let m = t.matrix3;
        DAffine3 {
            matrix3: DMat3::from_cols(
                self.to_scene(m.x_axis),
                self.to_scene(m.y_axis),
                self.to_scene(m.z_axis),
            ),
            translation: self.to_scene(t.translation),
        }
    }

    /// A transform of something whose points were turned by [`Up::to_scene`] too.
    pub(super) fn conjugate(self, t: DAffine3) -> DAffine3 {
        let mut t = self.place(t);
        if self == Self::Z {
            let m = t.matrix3;
            t.matrix3 = DMat3::from_cols(m.x_axis, m.z_axis, DVec3::ZERO - m.y_axis);
        }
        t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_placed_point_is_the_same_before_and_after_the_turn() {
        let t = DAffine3 {
            matrix3: DMat3::from_cols_array(&[1.0, 2.0, 3.0, -4.0, 5.0, 6.0, 7.0, -8.0, 10.0]),
            translation: DVec3::new(0.5, -0.25, 3.0),
        };
        let p = DVec3::new(1.0, 2.0, -3.0);
        let turned = Up::Z.conjugate(t).transform_point3(Up::Z.to_scene(p));
        assert_eq!(turned, Up::Z.to_scene(t.transform_point3(p)));
        assert_eq!(Up::Z.place(t).transform_point3(p), turned);
        assert_eq!(Up::Z.to_scene(Up::Z.axis()), DVec3::Y);
    }
}

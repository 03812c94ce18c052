//! Orthonormal frames.

use glam::Vec3;

/// Two unit vectors that complete the unit vector `n` to a right-handed orthonormal basis
/// (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017).
#[inline]
#[must_use]
pub fn orthonormal_basis(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}

/// A local frame whose z axis is the given normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Local x axis, world space, unit.
    pub s: Vec3,
    /// Local y axis, world space, unit.
    pub t: Vec3,
    /// Local z axis, world space, unit.
    pub n: Vec3,
}

impl Frame {
    /// The frame around the unit vector `n`.
    #[inline]
    #[must_use]
    pub fn from_z(n: Vec3) -> Self {
        let (s, t) = orthonormal_basis(n);
        Self { s, t, n }
    }

    /// World to local.
    #[inline]
    #[must_use]
    pub fn to_local(&self, w: Vec3) -> Vec3 {
        Vec3::new(w.dot(self.s), w.dot(self.t), w.dot(self.n))
    }

    /// Local to world.
    #[inline]
    #[must_use]
    pub fn to_world(&self, l: Vec3) -> Vec3 {
        self.s * l.x + self.t * l.y + self.n * l.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn basis_is_orthonormal_at_the_poles_too() {
        let tiny = f32::EPSILON;
        for n in [
            Vec3::Z,
            -Vec3::Z,
            Vec3::new(tiny, 0.0, -1.0),
            Vec3::new(0.0, -tiny, -1.0 + tiny),
            Vec3::new(0.3, -0.5, 0.81).normalize(),
            Vec3::new(0.0, 0.0, -0.0) + Vec3::X,
        ] {
            let (s, t) = orthonormal_basis(n);
            let bound = 4.0 * f32::EPSILON;
            assert!(s.dot(t).abs() < bound && s.dot(n).abs() < bound && t.dot(n).abs() < bound);
            assert!((s.length() - 1.0).abs() < bound && (t.length() - 1.0).abs() < bound);
            assert!(s.cross(t).dot(n) > 0.999);
        }
    }
}

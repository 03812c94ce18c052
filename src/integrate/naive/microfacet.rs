//! The GGX distribution of half vectors, isotropic, and its masking (E. Heitz, JCGT 3(2), 2014).
//!
//! Vectors are in the local frame, whose z axis is the shading normal.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::rng::Rng;

/// GGX of width `alpha`, (0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Ggx {
    pub(super) alpha: f64,
}

impl Ggx {
    /// Density of half vectors D(h), sr^-1; the integral of D cos over the hemisphere is one.
    pub(super) fn d(self, h: DVec3) -> f64 {
        let a2 = self.alpha * self.alpha;
        let s = a2 * h.z * h.z + h.x * h.x + h.y * h.y;
        a2 / (PI * s * s)
    }

    /// Smith's auxiliary function; the side of `w` does not matter.
    fn lambda(self, w: DVec3) -> f64 {
        let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }

    /// Height-correlated masking and shadowing; the same formula serves transmission.
    pub(super) fn g2(self, wo: DVec3, wi: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(wo) + self.lambda(wi))
    }

    /// A half vector with density D cos.
    pub(super) fn sample(self, rng: &mut Rng) -> DVec3 {
        let u = rng.uniform();
        let tan = self.alpha * (u / (1.0 - u)).sqrt();
        half_vector(tan, TAU * rng.uniform())
    }

    /// Density of [`Ggx::sample`], per solid angle of the half vector.
    pub(super) fn pdf(self, h: DVec3) -> f64 {
        self.d(h) * h.z
    }
}

/// The unit vector of slope `tan` towards `phi`.
pub(super) fn half_vector(tan: f64, phi: f64) -> DVec3 {
    DVec3::new(tan * libm::cos(phi), tan * libm::sin(phi), 1.0).normalize()
}

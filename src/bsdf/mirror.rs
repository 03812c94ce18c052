//! A perfect mirror.

use glam::Vec3;

use super::BsdfSample;
use crate::color::Rgb;

/// Reflects every ray about the normal, on both sides, without Fresnel's law.
#[derive(Clone, Copy, Debug)]
pub struct Mirror {
    /// Reflectance, [0, 1].
    pub color: Rgb,
}

impl Mirror {
    /// The one direction.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: Vec3) -> Option<BsdfSample> {
        let wi = Vec3::new(-wo.x, -wo.y, wo.z);
        BsdfSample { wi, weight: self.color, pdf: 1.0, delta: true, eta: 1.0 }.checked()
    }
}

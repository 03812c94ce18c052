//! Lambert's reflector.

use glam::Vec3;

use super::{BsdfSample, same_side};
use crate::color::Rgb;
use crate::math::INV_PI;
use crate::sampling::warp::{square_to_cosine_hemisphere, square_to_cosine_hemisphere_pdf};

/// Scatters equally in all directions, on both sides.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// Reflectance, [0, 1].
    pub color: Rgb,
}

impl Diffuse {
    /// BSDF value, sr^-1.
    #[inline]
    #[must_use]
    pub fn f(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if same_side(wo, wi) { self.color * INV_PI } else { Rgb::BLACK }
    }

    /// Density of [`Self::sample`].
    #[inline]
    #[must_use]
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        if same_side(wo, wi) { square_to_cosine_hemisphere_pdf(wi.z.abs()) } else { 0.0 }
    }

    /// Cosine-distributed directions, whose weight is the reflectance.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<BsdfSample> {
        let mut wi = square_to_cosine_hemisphere(u);
        let pdf = square_to_cosine_hemisphere_pdf(wi.z);
        wi.z = wi.z.copysign(wo.z);
        BsdfSample { wi, weight: self.color, pdf, delta: false, eta: 1.0 }.checked()
    }
}

//! A smooth dielectric.

use glam::Vec3;

use super::fresnel::{Fresnel, refract};
use super::{BsdfSample, Transport};
use crate::color::Rgb;
use crate::mutants::planted;

/// Reflects and refracts as Fresnel and Snell have it; the front side is outside.
#[derive(Clone, Copy, Debug)]
pub struct Glass {
    /// n_inside / n_outside.
    pub ior: f32,
    /// Factor on each refraction, [0, 1].
    pub tint: Rgb,
    /// True for a sheet that encloses nothing: light passes straight, after all reflections within.
    pub thin: bool,
    /// Its reflectance.
    pub fresnel: Fresnel,
}

impl Glass {
    /// Reflection or refraction, chosen by their share of the energy.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: Vec3, u: f32, transport: Transport) -> Option<BsdfSample> {
        let cos_o = wo.z.abs();
        if self.thin {
            let (r, _) = self.fresnel.dielectric(cos_o, self.ior);
            // Both faces of the sheet, and every path between them: R + T^2 R / (1 - R^2).
            let r = 2.0 * r / (1.0 + r);
            return if u < r {
                reflected(wo, r)
            } else {
                BsdfSample { wi: -wo, weight: self.tint, pdf: 1.0 - r, delta: true, eta: 1.0 }.checked()
            };
        }
        let eta = if wo.z > 0.0 { self.ior } else { 1.0 / self.ior };
        let (r, cos_t) = self.fresnel.dielectric(cos_o, eta);
        if u < r {
            return reflected(wo, r);
        }
        let m = Vec3::new(0.0, 0.0, 1.0f32.copysign(wo.z));
        let wi = refract(wo, m, cos_o, cos_t, eta).normalize();
        let scale = match transport {
            Transport::Radiance => 1.0 / (eta * eta),
            Transport::Importance => 1.0,
        };
        let weight = self.tint * planted!(eta_squared(scale, eta));
        BsdfSample { wi, weight, pdf: 1.0 - r, delta: true, eta }.checked()
    }
}

fn reflected(wo: Vec3, probability: f32) -> Option<BsdfSample> {
    let wi = Vec3::new(-wo.x, -wo.y, wo.z);
    BsdfSample { wi, weight: Rgb::WHITE, pdf: probability, delta: true, eta: 1.0 }.checked()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N38: energy is conserved in every single sample, not only on average.
    #[test]
    fn every_sample_of_clear_glass_weighs_one() {
        let exact = Fresnel::Exact;
        for (thin, fresnel) in [(false, exact), (true, exact), (false, Fresnel::Schlick)] {
            let glass = Glass { ior: 1.5, tint: Rgb::WHITE, thin, fresnel };
            for i in 0..2000 {
                let mu = (i as f32 + 0.5) / 1000.0 - 1.0;
                let wo = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                for k in 0..10 {
                    let s = glass
                        .sample(wo, (k as f32 + 0.5) / 10.0, Transport::Importance)
                        .expect("a direction");
                    assert_eq!(s.weight, Rgb::WHITE);
                    assert!((s.wi.length() - 1.0).abs() < 2.0 * f32::EPSILON);
                }
            }
        }
    }
}

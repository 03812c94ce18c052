//! A rough dielectric boundary or sheet: microfacets that each reflect and refract.
//!
//! Source: Walter et al., EGSR 2007, with visible-normal sampling. Both lobes use the same shadowing
//! term 1 / (1 + Lambda_o + Lambda_i), and both are divided by their total albedo, so that untinted
//! glass loses nothing at any roughness.

use glam::Vec3;

use super::fresnel::{Fresnel, refract};
use super::tables::Albedo;
use super::{Transport, ggx};
use crate::color::Rgb;
use crate::mutants::planted;

/// The rough counterpart of [`super::Glass`].
#[derive(Clone, Debug)]
pub struct RoughDielectric {
    /// GGX width.
    pub alpha: f32,
    /// n_inside / n_outside.
    pub ior: f32,
    /// Factor on each transmission.
    pub tint: Rgb,
    /// True for a sheet that light passes without bending.
    pub thin: bool,
    /// Its reflectance.
    pub fresnel: Fresnel,
    /// Total single-scattering albedo for light incident from outside and from inside.
    pub total: [Albedo; 2],
}

/// `wo` and `wi` turned so that `wo` is above, and eta as seen from there.
struct Turned {
    wo: Vec3,
    wi: Vec3,
    eta: f32,
    total: f32,
}

impl RoughDielectric {
    fn turned(&self, wo: Vec3, wi: Vec3) -> Turned {
        let outside = wo.z > 0.0;
        let sign = 1.0f32.copysign(wo.z);
        let turn = |w: Vec3| Vec3::new(w.x, w.y, w.z * sign);
        let eta = if outside || self.thin { self.ior } else { 1.0 / self.ior };
        let total = self.total[usize::from(!outside)].at(wo.z.abs());
        Turned { wo: turn(wo), wi: turn(wi), eta, total }
    }

    /// Share of light that a microfacet reflects at `cos`, and the cosine beyond it.
    fn reflectance(&self, cos: f32, eta: f32) -> (f32, f32) {
        let (r, cos_t) = self.fresnel.dielectric(cos, eta);
        if self.thin { (2.0 * r / (1.0 + r), cos_t) } else { (r, cos_t) }
    }

    /// BSDF value and density.
    #[must_use]
    pub fn f_and_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        const NONE: (Rgb, f32) = (Rgb::BLACK, 0.0);
        let t = self.turned(wo, wi);
        if t.wo.z == 0.0 || t.wi.z == 0.0 {
            return NONE;
        }
        let lambda_o = ggx::lambda(t.wo, self.alpha);
        let g2 = ggx::g2(lambda_o, ggx::lambda(t.wi, self.alpha));
        let reflects = t.wi.z > 0.0;
        if reflects || self.thin {
            // A sheet's transmission is its reflection seen from the other side.
            let up = Vec3::new(t.wi.x, t.wi.y, t.wi.z.abs());
            let Some(m) = (t.wo + up).try_normalize() else { return NONE };
            let (r, _) = self.reflectance(t.wo.dot(m), t.eta);
            let d = ggx::d(m, self.alpha);
            let color = if reflects { Rgb::grey(r) } else { self.tint * (1.0 - r) };
            let share = if reflects { r } else { 1.0 - r };
            let f = color * (d * g2 / (4.0 * t.wo.z * up.z * t.total));
            return (f, share * d / (4.0 * t.wo.z * (1.0 + lambda_o)));
        }
        let Some(mut m) = (t.wo + t.wi * t.eta).try_normalize() else { return NONE };
        if m.z < 0.0 {
            m = -m;
        }
        let (cos_o, cos_i) = (t.wo.dot(m), t.wi.dot(m));
        if cos_o <= 0.0 || cos_i >= 0.0 {
            return NONE;
        }
        let (r, _) = self.reflectance(cos_o, t.eta);
        let d = ggx::d(m, self.alpha);
        let scale = match transport {
            Transport::Radiance => 1.0,
            Transport::Importance => t.eta * t.eta,
        };
        // |dm / dwi| = eta^2 |cos_i| / (cos_o + eta cos_i)^2, with eta relative to the side of wo; the
        // value carries 1 / eta^2 for radiance.
        let root = cos_o + t.eta * cos_i;
        let jacobian = -cos_i / (root * root);
        let f = self.tint
            * ((1.0 - r) * d * g2 * cos_o * jacobian * planted!(eta_squared(scale, t.eta))
                / (t.wo.z * -t.wi.z * t.total));
        let pdf = (1.0 - r) * d * cos_o / ((1.0 + lambda_o) * t.wo.z) * jacobian * t.eta * t.eta;
        (f, pdf)
    }

    /// A microfacet visible from `wo`, and reflection or refraction at it by `choice`; also eta.
    #[must_use]
    pub fn sample_direction(&self, wo: Vec3, choice: f32, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let t = self.turned(wo, Vec3::Z);
        if t.wo.z <= 0.0 {
            return None;
        }
        let m = ggx::sample_visible_normal(t.wo, self.alpha, u);
        let cos = t.wo.dot(m);
        let (r, cos_t) = self.reflectance(cos, t.eta);
        let sign = 1.0f32.copysign(wo.z);
        let reflected = crate::math::reflect(t.wo, m);
        let (wi, eta) = if choice < r {
            (reflected, 1.0)
        } else if self.thin {
            (Vec3::new(reflected.x, reflected.y, -reflected.z), 1.0)
        } else {
            (refract(t.wo, m, cos, cos_t, t.eta).normalize(), t.eta)
        };
        // A direction on the wrong side is light that the model loses between microfacets; the total
        // albedo gives it back to the others.
        let right_side = if choice < r { wi.z > 0.0 } else { wi.z < 0.0 };
        right_side.then_some((Vec3::new(wi.x, wi.y, wi.z * sign), eta))
    }
}

//! Microfacets in `f64`, and sums over their normals.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};

use super::super::build::{compile, principled};
use super::exact;
use crate::bsdf::Bsdf;

/// Density of GGX's normals.
pub(super) fn d(m: DVec3, alpha: f64) -> f64 {
    let e = (m.x * m.x + m.y * m.y) / (alpha * alpha) + m.z * m.z;
    1.0 / (PI * alpha * alpha * e * e)
}

/// Smith's Lambda.
pub(super) fn lambda(w: DVec3, alpha: f64) -> f64 {
    let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Density of the normals that `wo` sees.
pub(super) fn visible(wo: DVec3, m: DVec3, alpha: f64) -> f64 {
    d(m, alpha) * wo.dot(m).max(0.0) / ((1.0 + lambda(wo, alpha)) * wo.z)
}

/// Calls `visit` with the middles of cells of normals, and their solid angles. The cells have equal sides in azimuth and
/// in s, where tan(theta) = alpha tan(x), which spreads a lobe of any width evenly, and x = (1 - (1 - s)^2) pi/2: all that
/// refracts at grazing angles from within glass does so at the few normals that lie almost in the surface.
pub(super) fn normals(
    alpha: f64,
    rings: usize,
    sectors: usize,
    mut visit: impl FnMut(usize, usize, DVec3, f64),
) {
    let turns: Vec<(f64, f64)> =
        (0..sectors).map(|k| libm::sincos(((k as f64 + 0.5) / sectors as f64 - 0.5) * TAU)).collect();
    let cell = PI / rings as f64 * TAU / sectors as f64;
    for i in 0..rings {
        let rest = 1.0 - (i as f64 + 0.5) / rings as f64;
        // Sine and cosine of x, which is that much less than a right angle.
        let (c, s) = libm::sincos(rest * rest * FRAC_PI_2);
        // With t = tan(theta): d(theta) = alpha / (c^2 + alpha^2 s^2) dx.
        let e = c * c + alpha * alpha * s * s;
        let (sin, cos) = (alpha * s / e.sqrt(), c / e.sqrt());
        let solid_angle = sin * alpha / e * rest * cell;
        for (k, (st, ct)) in turns.iter().enumerate() {
            visit(i, k, DVec3::new(sin * ct, sin * st, cos), solid_angle);
        }
    }
}

/// The cell of a normal.
pub(super) fn cell_of(m: DVec3, alpha: f64, rings: usize, sectors: usize) -> [usize; 2] {
    let less_than_right = libm::atan2(alpha * m.z, (m.x * m.x + m.y * m.y).sqrt());
    let s = 1.0 - (less_than_right / FRAC_PI_2).sqrt();
    let turn = libm::atan2(m.y, m.x) / TAU + 0.5;
    let ring = ((s * rings as f64) as usize).min(rings - 1);
    [ring, ((turn * sectors as f64) as usize).min(sectors - 1)]
}

/// Share of light that microfacets without absorption reflect once, at the cosine `mu`.
pub(super) fn single_scattering(mu: f64, alpha: f64) -> f64 {
    let wo = DVec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, mu);
    let mut sum = 0.0;
    let lambda_o = lambda(wo, alpha);
    normals(alpha, 1200, 400, |_, _, m, solid_angle| {
        let cos = wo.dot(m);
        let wi = m * (2.0 * cos) - wo;
        if cos > 0.0 && wi.z > 0.0 {
            sum += d(m, alpha) * cos / (mu * (1.0 + lambda_o + lambda(wi, alpha))) * solid_angle;
        }
    });
    sum
}

/// A rough material, and how its normals make its directions.
pub(super) struct Rough {
    pub(super) name: String,
    pub(super) bsdf: Bsdf,
    pub(super) alpha: f64,
    /// n_inside / n_outside; `None` for metal.
    ior: Option<f64>,
}

impl Rough {
    /// White metal and white glass.
    pub(super) fn metal_and_glass(alpha: f32) -> Vec<Self> {
        let kind = |transmission: f32| {
            principled(|p| {
                (p.metallic, p.transmission, p.roughness) = (1.0 - transmission, transmission, alpha.sqrt());
            })
        };
        // The width that the material has after its roughness was rounded.
        let width = f64::from(alpha.sqrt() * alpha.sqrt());
        [("metal", 0.0, None), ("glass", 1.0, Some(1.5))]
            .into_iter()
            .filter_map(|(name, transmission, ior)| {
                let bsdf = compile(kind(transmission))?;
                Some(Self { name: format!("{name} of width {alpha}"), bsdf, alpha: width, ior })
            })
            .collect()
    }

    /// Whether it has another side.
    pub(super) fn transmits(&self) -> bool {
        self.ior.is_some()
    }

    /// n_transmitted / n_incident for light that is seen along `wo`.
    fn eta(&self, wo: Vec3) -> f64 {
        self.ior.map_or(1.0, |n| if wo.z > 0.0 { n } else { 1.0 / n })
    }

    /// The reflected and the refracted direction of the normal `m` (above, and `wo` turned there), each with how much
    /// solid angle a solid angle of normals becomes and with the share of the light; `None` where it leaves to the wrong
    /// side or there is none.
    pub(super) fn directions(&self, wo: Vec3, m: DVec3) -> [(Option<(Vec3, f64)>, f64); 2] {
        let sign = f64::from(1f32.copysign(wo.z));
        let turn = |w: DVec3| DVec3::new(w.x, w.y, w.z * sign);
        let up = turn(wo.as_dvec3());
        let cos = up.dot(m);
        let eta = self.eta(wo);
        let (r, cos_t) = if self.transmits() { exact(cos, eta) } else { (1.0, 0.0) };
        let reflected = m * (2.0 * cos) - up;
        let reflection = (reflected.z > 0.0).then(|| (turn(reflected).as_vec3(), 4.0 * cos));
        let refracted = -up / eta + m * (cos / eta - cos_t);
        let root = cos - eta * cos_t;
        let refraction = (r < 1.0 && refracted.z < 0.0)
            .then(|| (turn(refracted).normalize().as_vec3(), root * root / (eta * eta * cos_t)));
        [(reflection, r), (refraction, 1.0 - r)]
    }

    /// The normal, turned above, that makes `wi` of `wo`.
    pub(super) fn normal(&self, wo: Vec3, wi: Vec3) -> DVec3 {
        let eta = if wo.z * wi.z > 0.0 { 1.0 } else { self.eta(wo) };
        let m = (wo.as_dvec3() + wi.as_dvec3() * eta).normalize();
        let m = DVec3::new(m.x, m.y, m.z * f64::from(1f32.copysign(wo.z)));
        if m.z < 0.0 { -m } else { m }
    }
}

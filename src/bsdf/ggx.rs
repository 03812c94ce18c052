//! The GGX distribution of microfacet normals, isotropic, with height-correlated Smith shadowing.
//!
//! Sources: Walter et al., EGSR 2007 (distribution); Heitz, JCGT 3(2), 2014 (shadowing) and JCGT 7(4),
//! 2018 (visible normals); Dupuy and Benyoub, HPG 2023 (sampling them by spherical caps).
//! `alpha` is the GGX width, in [`super::SMOOTH_ALPHA`]..=1. Directions are local, +Z up.

use glam::Vec3;

use crate::math::{INV_PI, safe_sqrt, sin_cos_turn, sqr};
use crate::rare::rarely;

/// Density of microfacet normals at `m`, sr^-1. Formed from the tangential components, which stay
/// accurate for narrow lobes.
#[inline]
#[must_use]
pub fn d(m: Vec3, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let e = (m.x * m.x + m.y * m.y) / a2 + m.z * m.z;
    INV_PI / (a2 * sqr(e))
}

/// Smith's Lambda of a direction: masked over visible microfacet area.
#[inline]
#[must_use]
pub fn lambda(w: Vec3, alpha: f32) -> f32 {
    // (sqrt(1 + x) - 1) / 2 without cancellation.
    let x = alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z);
    x / (2.0 * (1.0 + (1.0 + x).sqrt()))
}

/// Share of microfacets visible from both directions, height-correlated.
#[inline]
#[must_use]
pub fn g2(lambda_o: f32, lambda_i: f32) -> f32 {
    1.0 / (1.0 + lambda_o + lambda_i)
}

/// A normal visible from `wo`, which must have `wo.z` > 0.
#[inline]
#[must_use]
pub fn sample_visible_normal(wo: Vec3, alpha: f32, u: [f32; 2]) -> Vec3 {
    // In the space where the surface is a hemisphere, a cap of directions reflects to `wo`.
    let stretched = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let z = (1.0 - u[0]) * (1.0 + stretched.z) - stretched.z;
    let r = safe_sqrt((1.0 - z) * (1.0 + z));
    let (s, c) = sin_cos_turn(u[1]);
    let h = Vec3::new(r * c, r * s, z) + stretched;
    let m = Vec3::new(alpha * h.x, alpha * h.y, h.z.max(0.0)).try_normalize();
    // Opposite directions of the cap add up to nothing.
    if rarely!(1e-5, m.is_none()) { Vec3::Z } else { m.unwrap_or(Vec3::Z) }
}

/// Density of [`sample_visible_normal`] per solid angle of `m`, given `lambda_o` of `wo`.
#[inline]
#[must_use]
pub fn visible_normal_pdf(wo: Vec3, m: Vec3, alpha: f32, lambda_o: f32) -> f32 {
    d(m, alpha) * wo.dot(m).max(0.0) / ((1.0 + lambda_o) * wo.z.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::PI;

    fn direction(mu: f32) -> Vec3 {
        Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu)
    }

    /// N40, the weak furnace: visible normals are a density, at every width and angle.
    #[test]
    fn visible_normals_integrate_to_one() {
        for alpha in [0.05, 0.1, 0.25, 0.5, 1.0f32] {
            for mu in [1.0, 0.5, 0.1] {
                let wo = direction(mu);
                let lambda_o = lambda(wo, alpha);
                let (n_theta, n_phi) = (4000, 256);
                let mut sum = 0.0f64;
                for i in 0..n_theta {
                    // tan(theta) = alpha * tan(x): even spacing over the lobe.
                    let x = (f64::from(i) + 0.5) / f64::from(n_theta) * 0.5 * std::f64::consts::PI;
                    let t = f64::from(alpha) * libm::tan(x);
                    let theta = libm::atan(t);
                    let dtheta = f64::from(alpha) / (libm::cos(x) * libm::cos(x)) / (1.0 + t * t);
                    for k in 0..n_phi {
                        let (s, c) = sin_cos_turn((k as f32 + 0.5) / n_phi as f32);
                        let (st, ct) = (libm::sin(theta) as f32, libm::cos(theta) as f32);
                        let m = Vec3::new(st * c, st * s, ct);
                        sum +=
                            f64::from(visible_normal_pdf(wo, m, alpha, lambda_o)) * libm::sin(theta) * dtheta;
                    }
                }
                sum *=
                    f64::from(2.0 * PI) / f64::from(n_phi) * 0.5 * std::f64::consts::PI / f64::from(n_theta);
                assert!((sum - 1.0).abs() < 2e-5, "{alpha} {mu} {sum}");
            }
        }
    }

    /// O15: the directional albedo of the single-scattering lobe, whose weight is G2 / G1 <= 1.
    #[test]
    fn single_scattering_loses_what_the_closed_form_says() {
        let cases = [
            (0.1, [0.988304, 0.969205, 0.883455]),
            (0.25, [0.915812, 0.857263, 0.891622]),
            (0.5, [0.687849, 0.698251, 0.860105]),
            (1.0, [0.306853, 0.450694, 0.760210]),
        ];
        for (alpha, expected) in cases {
            for (mu, expected) in [1.0, 0.5, 0.1].into_iter().zip(expected) {
                let e = super::super::tables::reflected(mu, alpha, |_| 1.0);
                assert!((e / expected - 1.0).abs() < 2e-3, "{alpha} {mu}: {e} {expected}");
            }
        }
    }
}

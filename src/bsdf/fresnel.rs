//! Fresnel's equations, unpolarised.

use glam::Vec3;

use crate::color::Rgb;
use crate::math::{pow5, sqr};
use crate::mutants::planted;

/// Reflectance of a dielectric boundary, exact; `cos_i` in [0, 1] is the cosine on the incident side
/// and `eta` = n_transmitted / n_incident. Also returns the cosine on the other side, which is zero
/// at total reflection.
///
/// The squared cosine inside is formed as a product of sums, so that it keeps its accuracy near the
/// critical angle and is exactly `cos_i`^2 where eta is one.
#[inline]
#[must_use]
pub fn dielectric(cos_i: f32, eta: f32) -> (f32, f32) {
    if eta == 1.0 {
        return (0.0, cos_i);
    }
    let cos_i = cos_i.clamp(0.0, 1.0);
    let inv = 1.0 / f64::from(eta);
    let sin_t = (1.0 - sqr64(f64::from(cos_i))).sqrt() * inv;
    let cos2_t = ((1.0 - sin_t) * (1.0 + sin_t)) as f32;
    if planted!(fresnel_angle(cos2_t <= 0.0, sin_t, eta)) {
        return (1.0, 0.0);
    }
    let cos_t = cos2_t.sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let r = (0.5 * (sqr(parallel) + sqr(perpendicular))).min(1.0);
    (planted!(schlick_inside(r, cos_i, eta)), cos_t)
}

#[inline]
fn sqr64(x: f64) -> f64 {
    x * x
}

/// Reflectance at normal incidence of a dielectric with index `ior`.
#[inline]
#[must_use]
pub fn f0_of_ior(ior: f32) -> f32 {
    sqr((ior - 1.0) / (ior + 1.0))
}

/// The index whose reflectance at normal incidence is `f0` in [0, 1).
#[must_use]
pub fn ior_of_f0(f0: f32) -> f32 {
    let s = f0.sqrt();
    (1.0 + s) / (1.0 - s)
}

/// Schlick's approximation with reflectance `f0` at normal and one at grazing incidence
/// (Schlick, Computer Graphics Forum 13(3), 1994).
#[inline]
#[must_use]
pub fn schlick(f0: Rgb, cos: f32) -> Rgb {
    f0.lerp(Rgb::WHITE, pow5((1.0 - cos).clamp(0.0, 1.0)))
}

/// Refracts `wo` about `m` (both leave the surface, `wo . m` = `cos_o` > 0) into the medium beyond,
/// where the cosine is `cos_t`.
#[inline]
#[must_use]
pub fn refract(wo: Vec3, m: Vec3, cos_o: f32, cos_t: f32, eta: f32) -> Vec3 {
    -wo / eta + m * (cos_o / eta - cos_t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N28 and O14: close to the critical angle from inside glass, and total beyond it.
    #[test]
    fn rises_to_total_reflection_without_a_step() {
        let critical = libm::asin(1.0 / 1.5);
        for (before, expected) in [(0.1, 0.100282), (0.01, 0.439576), (0.001, 0.763641), (0.0001, 0.917238)] {
            let (r, _) = dielectric(libm::cos(critical - before) as f32, 1.0 / 1.5);
            assert!((r - expected).abs() < 2e-3, "{before}: {r} {expected}");
        }
        assert_eq!(dielectric(libm::cos(critical + 1e-4) as f32, 1.0 / 1.5).0, 1.0);
        let mut last = 0.0;
        for i in 0..10_000 {
            let angle = critical * f64::from(i) / 10_000.0;
            let (r, _) = dielectric(libm::cos(angle) as f32, 1.0 / 1.5);
            assert!(r >= last - 1e-6, "not monotone at {angle}");
            last = r.max(last);
        }
    }

    /// N27: against the textbook formula in `f64`, at many indices; nothing reflects where eta is one.
    #[test]
    fn agrees_with_the_formula_in_f64() {
        for eta in [1.0 + 1e-6, 1.33, 1.5, 2.4, 1.0 / 1.5, 0.5, 4.0f32] {
            for i in 0..=1000 {
                let mu = i as f32 / 1000.0;
                let (m, n) = (f64::from(mu), f64::from(eta));
                let s2 = (1.0 - m * m) / (n * n);
                let expected = if s2 >= 1.0 {
                    1.0
                } else {
                    let t = (1.0 - s2).sqrt();
                    let (a, b) = ((n * m - t) / (n * m + t), (m - n * t) / (m + n * t));
                    0.5 * (a * a + b * b)
                };
                let near_critical = (s2 - 1.0).abs() < 3e-4;
                let (r, _) = dielectric(mu, eta);
                assert!(near_critical || (f64::from(r) - expected).abs() < 4e-6, "{eta} {mu} {r} {expected}");
            }
        }
        assert_eq!(dielectric(0.3, 1.0), (0.0, 0.3));
        let brewster = libm::atan(1.5);
        let (r, t) = dielectric(libm::cos(brewster) as f32, 1.5);
        let parallel = sqr((1.5 * libm::cos(brewster) as f32 - t) / (1.5 * libm::cos(brewster) as f32 + t));
        assert!(parallel <= 1e-7 && r > 0.0);
    }

    /// N30: refraction in and back out is the identity.
    #[test]
    fn refraction_reverses() {
        for i in 1..=1000 {
            let mu = i as f32 / 1000.0;
            let wo = Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
            let (_, cos_t) = dielectric(mu, 1.5);
            let inside = refract(wo, Vec3::Z, mu, cos_t, 1.5).normalize();
            let (_, cos_back) = dielectric(-inside.z, 1.0 / 1.5);
            let back = refract(inside, -Vec3::Z, -inside.z, cos_back, 1.0 / 1.5);
            let angle = (back - wo).length();
            // Near grazing the cosine outside magnifies the rounding of the direction inside by 1 / mu.
            assert!(mu < 1e-2 || angle * mu < 3e-7, "{mu}: {angle}");
        }
    }
}

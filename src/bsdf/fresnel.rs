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
    let sin_t = sin_beyond(cos_i, eta);
    let cos2_t = cos2_of(sin_t);
    if planted!(fresnel_angle(cos2_t <= 0.0, sin_t, eta)) {
        return (1.0, 0.0);
    }
    let cos_t = cos2_t.sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let r = (0.5 * (sqr(parallel) + sqr(perpendicular))).min(1.0);
    (planted!(schlick_inside(r, cos_i, eta)), cos_t)
}

/// The sine on the other side (Snell), above one at total reflection.
#[inline]
fn sin_beyond(cos_i: f32, eta: f32) -> f64 {
    (1.0 - sqr64(f64::from(cos_i))).sqrt() * (1.0 / f64::from(eta))
}

/// The squared cosine to a sine.
#[inline]
fn cos2_of(sin: f64) -> f32 {
    ((1.0 - sin) * (1.0 + sin)) as f32
}

#[inline]
fn sqr64(x: f64) -> f64 {
    x * x
}

/// How the reflectance of a dielectric boundary is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fresnel {
    /// By Fresnel's equations: [`dielectric`].
    #[default]
    Exact,
    /// By Schlick's approximation: a shortcut, too dark by up to 0.036 of the light at an index of 1.5.
    Schlick,
}

impl Fresnel {
    /// Reflectance, and the cosine on the other side, as [`dielectric`] has them.
    #[inline]
    #[must_use]
    pub fn dielectric(self, cos_i: f32, eta: f32) -> (f32, f32) {
        match self {
            Self::Exact => dielectric(cos_i, eta),
            Self::Schlick => schlick_dielectric(cos_i, eta),
        }
    }

    /// How far the reflectance has risen from its value `f0` at normal incidence, [0, 1), where the index is `eta`
    /// and the cosine on the outer side is `cos`, [0, 1].
    #[inline]
    #[must_use]
    pub fn grazing_share(self, cos: f32, eta: f32, f0: f32) -> f32 {
        match self {
            Self::Exact => ((dielectric(cos, eta).0 - f0) / (1.0 - f0)).clamp(0.0, 1.0),
            Self::Schlick => grazing(cos),
        }
    }
}

/// Schlick's curve for a dielectric boundary. It takes the cosine on the side of the smaller index, where it can be
/// grazing, so that both directions of a ray have the same reflectance; total reflection is as it is.
#[inline]
fn schlick_dielectric(cos_i: f32, eta: f32) -> (f32, f32) {
    if eta == 1.0 {
        return (0.0, cos_i);
    }
    let cos_i = cos_i.clamp(0.0, 1.0);
    let cos2_t = cos2_of(sin_beyond(cos_i, eta));
    if cos2_t <= 0.0 {
        return (1.0, 0.0);
    }
    let cos_t = cos2_t.sqrt();
    let f0 = f0_of_ior(eta);
    let r = f0 + (1.0 - f0) * grazing(if eta < 1.0 { cos_t } else { cos_i });
    (r.min(1.0), cos_t)
}

/// (1 - cos)^5.
#[inline]
fn grazing(cos: f32) -> f32 {
    pow5((1.0 - cos).clamp(0.0, 1.0))
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
    f0.lerp(Rgb::WHITE, grazing(cos))
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

    /// Guards the shortcut: the same at normal and at grazing incidence, the same from both sides, total where the exact
    /// curve is; and its largest error at an index of 1.5, which is known (Schlick 1994, figure 3: it lies below the
    /// exact curve between normal and grazing incidence).
    #[test]
    fn schlick_is_close() {
        let both = |cos, eta| [Fresnel::Exact, Fresnel::Schlick].map(|f| f.dielectric(cos, eta));
        let mut worst = 0.0f32;
        for i in 0..=1000 {
            let cos = i as f32 / 1000.0;
            let [(exact, cos_t), (schlick, same)] = both(cos, 1.5);
            assert_eq!(cos_t, same);
            worst = worst.max((exact - schlick).abs());
            let (back, _) = Fresnel::Schlick.dielectric(cos_t, 1.0 / 1.5);
            assert!((back - schlick).abs() < 2e-3, "{cos}: {schlick} there, {back} back");
            let [inside, approximate] = both(cos, 1.0 / 1.5);
            assert_eq!((inside.0 == 1.0, inside.1), (approximate.0 == 1.0, approximate.1), "{cos}");
        }
        assert!((worst - 0.036).abs() < 0.001, "{worst}");
        let [exact, schlick] = both(1.0, 1.5);
        assert!((exact.0 - schlick.0).abs() < 1e-6);
        assert_eq!(both(0.0, 1.5).map(|r| r.0), [1.0; 2]);
        assert_eq!(Fresnel::Schlick.dielectric(0.3, 1.0), (0.0, 0.3));
        let share = Fresnel::Schlick.grazing_share(0.5, 1.5, 0.04);
        assert_eq!(share, 0.03125);
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

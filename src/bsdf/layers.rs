//! Layers over the principled material: fibres on top, a clear coat below them.
//!
//! Sources: `KHR_materials_clearcoat` and `KHR_materials_sheen` of glTF; Estevez and Kulla, "Production
//! Friendly Microfacet Sheen BRDF", SIGGRAPH course 2017 (Charlie's distribution and its shadowing).
//! Each layer takes from what is below it its own directional albedo, 1 - A(mu_o), emission included;
//! so the whole never reflects more than it receives. Both layers look the same from both sides.
//! Directions are local, both on the side of +Z.
//!
//! The coat's lobe is not compensated for multiple scattering: what it fails to reflect reaches the base.
//!
//! The sheen is glTF's, which Blender's importer and Cycles replace by another lobe: at roughness 0.5
//! its albedo at 0, 60 and 80 degrees is .027, .188 and .453, that of Cycles .019, .154 and .458.

use glam::Vec3;

use super::fresnel::Fresnel;
use super::tables::Albedo;
use super::{SMOOTH_ALPHA, ggx};
use crate::color::Rgb;
use crate::math::{self, INV_PI, PI, sin_cos_turn};

/// A clear dielectric coat.
#[derive(Clone, Debug)]
pub struct Coat {
    /// Share of the surface that has it, (0, 1].
    pub weight: f32,
    /// GGX width; zero where smooth.
    pub alpha: f32,
    /// Index of refraction, above one.
    pub ior: f32,
    /// Its reflectance.
    pub fresnel: Fresnel,
    /// Albedo of the whole lobe at weight one; `None` where smooth.
    pub albedo: Option<Albedo>,
}

impl Coat {
    /// Whether it reflects in one direction only.
    #[inline]
    #[must_use]
    pub fn is_smooth(&self) -> bool {
        self.alpha < SMOOTH_ALPHA
    }

    /// Directional albedo, its weight included.
    #[inline]
    #[must_use]
    pub fn albedo(&self, mu: f32) -> f32 {
        self.weight
            * match &self.albedo {
                Some(row) => row.at(mu),
                None => self.fresnel.dielectric(mu, self.ior).0,
            }
    }

    /// Value, its weight included, and density; zero where smooth.
    #[inline]
    #[must_use]
    pub fn f_and_pdf(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let Some(m) = (wo + wi).try_normalize().filter(|_| !self.is_smooth()) else { return (0.0, 0.0) };
        let (lo, li) = (ggx::lambda(wo, self.alpha), ggx::lambda(wi, self.alpha));
        let d = ggx::d(m, self.alpha);
        let r = self.fresnel.dielectric(wo.dot(m), self.ior).0;
        let f = self.weight * r * d * ggx::g2(lo, li) / (4.0 * wo.z * wi.z);
        (f, d / (4.0 * wo.z * (1.0 + lo)))
    }

    /// A direction of the rough lobe; `None` where it ends between microfacets.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: Vec3, u: [f32; 2]) -> Option<Vec3> {
        let wi = math::reflect(wo, ggx::sample_visible_normal(wo, self.alpha, u));
        (wi.z > 0.0).then_some(wi)
    }
}

/// Cosines below this count as this in [`Charlie`], whose fitted shadowing means nothing there.
const GRAZING: f32 = 1e-4;

/// Smallest perceptual roughness of the sheen; below it the lobe is a line of light at grazing angles.
pub const MIN_SHEEN_ROUGHNESS: f32 = 0.07;

/// Fibres that stand up: Charlie's distribution with its fitted shadowing.
#[derive(Clone, Copy, Debug)]
pub struct Charlie {
    inv_alpha: f32,
    /// Parameters of the fit at this width.
    fit: [f32; 5],
    /// The fit at one half.
    middle: f32,
}

impl Charlie {
    /// The lobe of a perceptual roughness, [0, 1].
    #[must_use]
    pub fn new(roughness: f32) -> Self {
        const SHARP: [f32; 5] = [25.3245, 3.32435, 0.16801, -1.27393, -4.85967];
        const WIDE: [f32; 5] = [21.5473, 3.82987, 0.19823, -1.97760, -4.32054];
        let roughness = roughness.max(MIN_SHEEN_ROUGHNESS);
        let alpha = roughness * roughness;
        let t = (1.0 - alpha) * (1.0 - alpha);
        let fit = std::array::from_fn(|i| WIDE[i] + (SHARP[i] - WIDE[i]) * t);
        let mut lobe = Self { inv_alpha: 1.0 / alpha, fit, middle: 0.0 };
        lobe.middle = lobe.exponent(0.5);
        lobe
    }

    fn exponent(&self, x: f32) -> f32 {
        let [a, b, c, d, e] = self.fit;
        a / (1.0 + b * math::pow(x, c)) + d * x + e
    }

    fn lambda(&self, mu: f32) -> f32 {
        let mu = mu.clamp(GRAZING, 1.0);
        math::exp(if mu < 0.5 {
            self.exponent(mu)
        } else {
            // Point symmetric about one half, in the logarithm.
            2.0 * self.middle - self.exponent(1.0 - mu)
        })
    }

    /// Value of the white lobe, sr^-1.
    #[must_use]
    pub fn f(&self, wo: Vec3, wi: Vec3) -> f32 {
        let Some(h) = (wo + wi).try_normalize() else { return 0.0 };
        let sin2 = h.x * h.x + h.y * h.y;
        let d = (2.0 + self.inv_alpha) * math::pow(sin2, 0.5 * self.inv_alpha) * (0.5 * INV_PI);
        let shadowing = 1.0 + self.lambda(wo.z) + self.lambda(wi.z);
        d / (shadowing * 4.0 * wo.z.max(GRAZING) * wi.z.max(GRAZING))
    }

    /// Directional albedo of the white lobe, by quadrature. It exceeds one at grazing angles where the
    /// roughness is small.
    #[must_use]
    pub fn albedo(&self, mu: f32) -> f32 {
        const POLAR: u32 = 96;
        const AZIMUTH: u32 = 48;
        let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
        let mut sum = 0.0f64;
        for i in 0..POLAR {
            // Dense towards grazing directions; half of the turn, which the other half mirrors.
            let x = (i as f32 + 0.5) / POLAR as f32;
            let z = x * x;
            let r = (1.0 - z * z).sqrt();
            for k in 0..AZIMUTH {
                let (s, c) = sin_cos_turn(0.5 * (k as f32 + 0.5) / AZIMUTH as f32);
                sum += f64::from(self.f(wo, Vec3::new(r * c, r * s, z)) * z * 2.0 * x);
            }
        }
        (sum / f64::from(POLAR * AZIMUTH)) as f32 * 2.0 * PI
    }
}

/// The layer of fibres.
#[derive(Clone, Debug)]
pub struct Sheen {
    /// Factor on the lobe, [0, 1], not black.
    pub color: Rgb,
    /// The lobe.
    pub lobe: Charlie,
    /// Albedo of the white lobe.
    pub albedo: Albedo,
}

impl Sheen {
    /// What the layer takes from what is below: the albedo of its brightest channel.
    #[inline]
    #[must_use]
    pub fn albedo(&self, mu: f32) -> f32 {
        self.color.max_channel() * self.albedo.at(mu).min(1.0)
    }

    /// Value, and density of uniform directions. Where the lobe would reflect more than it receives it
    /// is scaled down to all.
    #[inline]
    #[must_use]
    pub fn f_and_pdf(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let scale = 1.0 / self.albedo.at(wo.z).max(1.0);
        (self.color * (self.lobe.f(wo, wi) * scale), 0.5 * INV_PI)
    }

    /// A direction.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: [f32; 2]) -> Vec3 {
        let r = math::safe_sqrt((1.0 - u[0]) * (1.0 + u[0]));
        let (s, c) = sin_cos_turn(u[1]);
        Vec3::new(r * c, r * s, u[0])
    }
}

#[cfg(test)]
mod tests {
    use super::super::tables::AlbedoRow;
    use super::*;

    /// Guards Charlie's lobe against albedos computed elsewhere, and the row's interpolation between its
    /// nodes, down to the sharpest lobe.
    #[test]
    fn charlie_has_the_known_albedos() {
        for (roughness, expected) in [
            (0.3, [0.0010, 0.0870, 0.3832, 0.5409]),
            (0.5, [0.0270, 0.1879, 0.4525, 0.5666]),
            (1.0, [0.1639, 0.3563, 0.6144, 0.7206]),
        ] {
            let lobe = Charlie::new(roughness);
            for (mu, expected) in [1.0, 0.5, 0.1736, 0.1].into_iter().zip(expected) {
                let found = lobe.albedo(mu);
                assert!((found - expected).abs() < 5e-4, "{roughness} {mu}: {found}, expected {expected}");
            }
        }
        for roughness in [0.0, 0.1, 0.3, 1.0] {
            let lobe = Charlie::new(roughness);
            let row = AlbedoRow::new(|mu| lobe.albedo(mu));
            for mu in [0.001, 0.0123, 0.05, 0.123, 0.37, 0.71, 0.993] {
                let (found, direct) = (row.at(mu), lobe.albedo(mu));
                assert!((found - direct).abs() < 2e-3 * direct.max(1.0), "{roughness} {mu} {found} {direct}");
            }
        }
    }
}

//! Coat and sheen of the reference integrator.
//!
//! f = f_sheen + (1 - A_sheen(mu_o)) (f_coat + (1 - A_coat(mu_o)) f_below), the same from both sides;
//! emission is dimmed by both factors at the cosine of the geometric normal.
//!
//! * `f_coat` = weight F D G2 / (4 mu_i mu_o), GGX of alpha = roughness^2, a delta below
//!   [`super::principled::SMOOTH`], F exact for `coat_ior`; `A_coat` its directional albedo.
//! * `f_sheen` = colour D / (4 mu_i mu_o (1 + Lambda_i + Lambda_o)) / max(1, E), D = (2 + 1/alpha)
//!   sin^(1/alpha)(theta_h) / 2 pi, alpha = roughness^2 with a roughness of at least 0.07, Lambda as
//!   A. C. Estevez and C. Kulla fitted it (SIGGRAPH course, 2017), cosines of both at least 1e-4;
//!   E is the albedo before the division, `A_sheen` = largest channel of the colour times min(1, E).

use glam::DVec3;
use std::f64::consts::TAU;

use super::albedo::{Lobe, Mix};
use super::fresnel;
use super::microfacet::Ggx;
use super::principled::SMOOTH;
use super::rgb;
use crate::scene;

/// The layers on top of a principled material.
#[derive(Clone, Debug)]
pub(super) struct Layers {
    coat: Option<Coat>,
    sheen: Option<Sheen>,
}

#[derive(Clone, Debug)]
struct Coat {
    weight: f64,
    eta: f64,
    /// None where smooth.
    rough: Option<(Ggx, Mix)>,
}

#[derive(Clone, Debug)]
struct Sheen {
    color: DVec3,
    alpha: f64,
    albedo: Mix,
}

impl Layers {
    pub(super) fn new(p: &scene::Principled, curves: &mut dyn FnMut(Lobe, f64) -> Mix) -> Self {
        let coat = (p.coat > 0.0).then(|| {
            let (eta, alpha) = (f64::from(p.coat_ior), square(p.coat_roughness));
            let rough = (alpha >= SMOOTH).then(|| (Ggx { alpha }, curves(Lobe::Coat { eta }, alpha)));
            Coat { weight: f64::from(p.coat), eta, rough }
        });
        let color = rgb(p.sheen_color);
        let sheen = (color != DVec3::ZERO).then(|| {
            let alpha = square(p.sheen_roughness.max(0.07));
            Sheen { color, alpha, albedo: curves(Lobe::Sheen, alpha) }
        });
        Self { coat, sheen }
    }

    /// What the sheen leaves to what is below it.
    fn below_sheen(&self, mu: f64) -> f64 {
        self.sheen.as_ref().map_or(1.0, |s| 1.0 - s.color.max_element() * s.albedo.at(mu).min(1.0))
    }

    /// What both leave to what is below them, emission included.
    pub(super) fn below(&self, mu: f64) -> f64 {
        let coat = self.coat.as_ref().map_or(0.0, |c| {
            c.weight * c.rough.as_ref().map_or_else(|| fresnel::exact(mu, c.eta), |(_, curve)| curve.at(mu))
        });
        self.below_sheen(mu) * (1.0 - coat)
    }

    /// Value of the layers themselves, without delta lobes; both directions are above.
    pub(super) fn f(&self, wo: DVec3, wi: DVec3) -> DVec3 {
        let mut f = DVec3::ZERO;
        if let Some(Coat { weight, eta, rough: Some((ggx, _)) }) = &self.coat {
            let h = (wo + wi).normalize();
            let reflected = fresnel::exact(wo.dot(h), *eta) * ggx.d(h) * ggx.g2(wo, wi);
            f += self.below_sheen(wo.z) * weight * reflected / (4.0 * wo.z * wi.z);
        }
        if let Some(sheen) = &self.sheen {
            f += sheen.color * charlie(sheen.alpha, wo, wi) / sheen.albedo.at(wo.z).max(1.0);
        }
        f
    }

    /// Weight of the mirrored direction where the coat is smooth.
    pub(super) fn delta(&self, mu: f64) -> f64 {
        match &self.coat {
            Some(Coat { weight, eta, rough: None }) => {
                self.below_sheen(mu) * weight * fresnel::exact(mu, *eta)
            }
            _ => 0.0,
        }
    }

    /// The half vectors of a rough coat, and a share of the directions for them.
    pub(super) fn half_vectors(&self) -> Option<(Ggx, f64)> {
        let coat = self.coat.as_ref()?;
        coat.rough.as_ref().map(|(ggx, _)| (*ggx, 0.4 * coat.weight))
    }

    /// A share of the directions for what is wide.
    pub(super) fn wide(&self) -> f64 {
        let coat = self.half_vectors().map_or(0.0, |_| 0.1);
        self.sheen.as_ref().map_or(coat, |s| coat + 0.5 * s.color.max_element())
    }
}

fn square(x: f32) -> f64 {
    f64::from(x) * f64::from(x)
}

/// The white sheen before it is scaled, sr^-1.
pub(super) fn charlie(alpha: f64, wo: DVec3, wi: DVec3) -> f64 {
    let h = (wo + wi).normalize();
    let sin = (h.x * h.x + h.y * h.y).sqrt();
    let d = (2.0 + 1.0 / alpha) * libm::pow(sin, 1.0 / alpha) / TAU;
    let (mu_o, mu_i) = (wo.z.max(1e-4), wi.z.max(1e-4));
    d / (4.0 * mu_o * mu_i * (1.0 + shadowing(alpha, mu_o) + shadowing(alpha, mu_i)))
}

/// Lambda of the sheen: the fit for alpha = 0 and alpha = 1, blended by (1 - alpha)^2.
fn shadowing(alpha: f64, mu: f64) -> f64 {
    let t = (1.0 - alpha) * (1.0 - alpha);
    let blend = |at_one: f64, at_zero: f64| at_one * (1.0 - t) + at_zero * t;
    let fit = |x: f64| {
        blend(21.5473, 25.3245) / (1.0 + blend(3.82987, 3.32435) * libm::pow(x, blend(0.19823, 0.16801)))
            + blend(-1.97760, -1.27393) * x
            + blend(-4.32054, -4.85967)
    };
    if mu < 0.5 { libm::exp(fit(mu)) } else { libm::exp(2.0 * fit(0.5) - fit(1.0 - mu)) }
}

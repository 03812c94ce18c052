//! Directional albedos of rough lobes, tabulated over the cosine.
//!
//! A lobe's albedo depends on the cosine of the one direction, its width and its Fresnel term; with
//! the last two fixed by the material, one row remains. Rows are computed by quadrature over visible
//! normals in `prepare`, once for each pair, and interpolated.

use std::sync::Arc;

use glam::Vec3;

use super::fresnel::{Fresnel, refract};
use super::ggx;

/// Intervals of a row. Nodes are dense towards grazing angles: node i stands at mu = (i / N)^2.
const N: usize = 128;
/// Quadrature points over the polar and the azimuthal half of the normals.
const POLAR: u32 = 128;
const AZIMUTH: u32 = 24;

/// A directional albedo over the cosine mu in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub struct AlbedoRow {
    nodes: Vec<f32>,
    average: f32,
}

impl AlbedoRow {
    /// Tabulates `albedo(mu)`.
    #[must_use]
    pub fn new(albedo: impl Fn(f32) -> f32) -> Self {
        let mu = |i: usize| (i as f32 / N as f32) * (i as f32 / N as f32);
        // At mu = 0 the lobe degenerates; the row is continued by its nearest neighbour's slope.
        let nodes: Vec<f32> = (0..=N).map(|i| albedo(mu(i.max(1)).max(1e-4))).collect();
        // 2 int E mu dmu with mu = x^2: 4 int E x^3 dx, by Simpson's rule.
        let weight = |i: usize| match i {
            0 | N => 1.0,
            i if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let sum: f64 = nodes
            .iter()
            .enumerate()
            .map(|(i, &e)| {
                let x = i as f64 / N as f64;
                weight(i) * 4.0 * f64::from(e) * x * x * x
            })
            .sum();
        Self { nodes, average: (sum / (3.0 * N as f64)) as f32 }
    }

    /// The albedo at the cosine `mu`.
    #[inline]
    #[must_use]
    pub fn at(&self, mu: f32) -> f32 {
        let x = mu.clamp(0.0, 1.0).sqrt() * N as f32;
        let i = (x as usize).min(N - 1);
        let t = x - i as f32;
        self.nodes[i] * (1.0 - t) + self.nodes[i + 1] * t
    }

    /// The cosine-weighted average, 2 int E(mu) mu dmu.
    #[must_use]
    pub fn average(&self) -> f32 {
        self.average
    }
}

/// A directional albedo as a lobe reads it: over every cosine, or at the one that it will be asked for.
#[derive(Clone, Debug)]
pub enum Albedo {
    /// Over every cosine.
    Row(Arc<AlbedoRow>),
    /// Looked up already, for the cosine of one hit.
    Value {
        /// The albedo there.
        at: f32,
        /// The cosine-weighted average over all cosines.
        average: f32,
    },
}

impl Albedo {
    /// The albedo at the cosine `mu`.
    #[inline]
    #[must_use]
    pub fn at(&self, mu: f32) -> f32 {
        match self {
            Self::Row(row) => row.at(mu),
            Self::Value { at, .. } => *at,
        }
    }

    /// The cosine-weighted average.
    #[inline]
    #[must_use]
    pub fn average(&self) -> f32 {
        match self {
            Self::Row(row) => row.average(),
            Self::Value { average, .. } => *average,
        }
    }
}

fn quadrature(mu: f32, alpha: f32, value: impl Fn(Vec3, Vec3, f32) -> f32) -> f32 {
    let wo = Vec3::new((1.0 - mu * mu).max(0.0).sqrt(), 0.0, mu);
    let lambda_o = ggx::lambda(wo, alpha);
    let mut sum = 0.0f64;
    for i in 0..POLAR {
        for k in 0..AZIMUTH {
            // Dense towards grazing normals, where the lobe changes most: 1 - u is a cube. Half of the
            // turn: the other half mirrors it.
            let rest = 1.0 - (i as f32 + 0.5) / POLAR as f32;
            let u = [1.0 - rest * rest * rest, 0.5 * (k as f32 + 0.5) / AZIMUTH as f32];
            let m = ggx::sample_visible_normal(wo, alpha, u);
            sum += f64::from(3.0 * rest * rest * value(wo, m, lambda_o));
        }
    }
    (sum / f64::from(POLAR * AZIMUTH)) as f32
}

/// Albedo of the single-scattering reflection lobe with Fresnel term `fresnel(wo . m)`.
#[must_use]
pub fn reflected(mu: f32, alpha: f32, fresnel: impl Fn(f32) -> f32) -> f32 {
    quadrature(mu, alpha, |wo, m, lambda_o| {
        let cos = wo.dot(m);
        let wi = m * (2.0 * cos) - wo;
        if wi.z <= 0.0 {
            return 0.0;
        }
        fresnel(cos) * (1.0 + lambda_o) * ggx::g2(lambda_o, ggx::lambda(wi, alpha))
    })
}

/// Albedo of the single-scattering dielectric lobes together, reflected and transmitted, without tint
/// and without the radiance scaling; `eta` = n_transmitted / n_incident.
#[must_use]
pub fn dielectric_total(mu: f32, alpha: f32, eta: f32, fresnel: Fresnel) -> f32 {
    quadrature(mu, alpha, |wo, m, lambda_o| {
        let cos = wo.dot(m);
        let (r, cos_t) = fresnel.dielectric(cos, eta);
        let seen = |w: Vec3| (1.0 + lambda_o) * ggx::g2(lambda_o, ggx::lambda(w, alpha));
        let mut sum = 0.0;
        let up = m * (2.0 * cos) - wo;
        if up.z > 0.0 {
            sum += r * seen(up);
        }
        if r < 1.0 {
            let down = refract(wo, m, cos, cos_t, eta);
            if down.z < 0.0 {
                sum += (1.0 - r) * seen(down);
            }
        }
        sum
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Interpolation adds less than 2e-4 to the quadrature between the nodes.
    #[test]
    fn rows_follow_the_quadrature() {
        for alpha in [0.01, 0.1, 0.5, 1.0] {
            let row = AlbedoRow::new(|mu| reflected(mu, alpha, |_| 1.0));
            for mu in [0.05, 0.123, 0.37, 0.71, 0.993] {
                let direct = reflected(mu, alpha, |_| 1.0);
                assert!((row.at(mu) - direct).abs() < 3e-4, "{alpha} {mu} {} {direct}", row.at(mu));
            }
        }
        let linear = AlbedoRow::new(|mu| mu);
        assert!((linear.average() - 2.0 / 3.0).abs() < 1e-4, "{}", linear.average());
    }

    /// N39: albedos of single scattering, computed apart with a hundred times as many points.
    #[test]
    fn rows_have_the_known_albedos() {
        for (alpha, mu, expected) in [
            (0.09, 0.7, 0.98515),
            (0.09, 0.3, 0.94587),
            (0.1, 1.0, 0.988304),
            (0.1, 0.5, 0.969205),
            (0.1, 0.1, 0.883455),
            (0.25, 0.5, 0.857263),
            (0.5, 0.1, 0.860105),
            (1.0, 1.0, 0.306853),
        ] {
            let found = reflected(mu, alpha, |_| 1.0);
            assert!((found - expected).abs() < 3e-4, "{alpha} {mu}: {found}, expected {expected}");
        }
    }
}

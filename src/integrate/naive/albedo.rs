//! Directional albedos of single-scattering GGX lobes, by quadrature.
//!
//! Each is a [`Curve`] over the cosine of the viewing angle: tabulated where interpolation needs it, to
//! about 1e-5, and computed once for each width and index of refraction.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use super::fresnel;
use super::material::{reflect, refract};
use super::microfacet::{Ggx, half_vector};
use super::quadrature::gauss;

/// Largest difference between a curve and its quadrature halfway between two of its points.
const TOLERANCE: f64 = 2e-5;

/// A function of the cosine in [0, 1], linear between its points.
#[derive(Debug)]
pub(super) struct Curve {
    points: Vec<[f64; 2]>,
}

/// What an albedo counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lobe {
    /// Reflection, with Fresnel factor one.
    Reflection,
    /// Reflection, with the Fresnel factor of `eta` scaled to [0, 1]: (F - F0) / (1 - F0).
    Layer {
        /// n_inside / n_outside.
        eta: f64,
    },
    /// Reflection and transmission together, without tint and without 1/eta^2.
    Dielectric {
        /// n_transmitted / n_incident.
        eta: f64,
    },
}

/// The curves computed so far, by lobe, width and index of refraction.
#[derive(Debug, Default)]
pub(super) struct Curves(BTreeMap<(u8, u64, u64), Arc<Curve>>);

impl Curves {
    /// The curve of `lobe` at width `alpha`.
    pub(super) fn get(&mut self, lobe: Lobe, alpha: f64) -> Arc<Curve> {
        let (kind, eta) = match lobe {
            Lobe::Reflection => (0, 1.0),
            Lobe::Layer { eta } => (1, eta),
            Lobe::Dielectric { eta } => (2, eta),
        };
        let key = (kind, alpha.to_bits(), eta.to_bits());
        let curve = self.0.entry(key).or_insert_with(|| {
            let rule = gauss(64);
            Arc::new(Curve::new(|mu| albedo(lobe, Ggx { alpha }, mu, &rule)))
        });
        Arc::clone(curve)
    }
}

impl Curve {
    /// Tabulates `f`: intervals are halved until the middle is within [`TOLERANCE`] of the line.
    fn new(f: impl Fn(f64) -> f64) -> Self {
        let at = |mu: f64| [mu, f(mu.max(1e-9))];
        let mut points = vec![at(0.0)];
        let coarse = 8;
        for i in 0..coarse {
            let [a, b] = [i, i + 1].map(|i| {
                let x = f64::from(i) / f64::from(coarse);
                x * x
            });
            refine(at(a), at(b), &at, 0, &mut points);
        }
        Self { points }
    }

    /// The value at `mu`, [0, 1].
    pub(super) fn at(&self, mu: f64) -> f64 {
        let next = self.points.partition_point(|p| p[0] < mu).clamp(1, self.points.len() - 1);
        let ([x0, y0], [x1, y1]) = (self.points[next - 1], self.points[next]);
        y0 + (y1 - y0) * ((mu - x0) / (x1 - x0)).clamp(0.0, 1.0)
    }

    /// The average over the hemisphere: twice the integral of the value times the cosine.
    pub(super) fn average(&self) -> f64 {
        let segment = |w: &[[f64; 2]]| {
            let ([x0, y0], [x1, y1]) = (w[0], w[1]);
            (x1 - x0) / 3.0 * (y0 * (2.0 * x0 + x1) + y1 * (x0 + 2.0 * x1))
        };
        self.points.windows(2).map(segment).sum()
    }
}

/// Appends what is needed between `a` (already there) and `b`, then `b`.
fn refine(a: [f64; 2], b: [f64; 2], at: &impl Fn(f64) -> [f64; 2], level: u32, out: &mut Vec<[f64; 2]>) {
    let middle = at(0.5 * (a[0] + b[0]));
    if level < 16 && (middle[1] - 0.5 * (a[1] + b[1])).abs() > TOLERANCE {
        refine(a, middle, at, level + 1, out);
        refine(middle, b, at, level + 1, out);
    } else {
        out.extend([middle, b]);
    }
}

/// Twice the average over the hemisphere of the Fresnel reflectance, weighted with the cosine.
pub(super) fn average_fresnel(eta: f64) -> f64 {
    gauss(256).iter().map(|[mu, w]| 2.0 * w * mu * fresnel::exact(*mu, eta)).sum()
}

/// The albedo of a lobe seen under the cosine `mu`: an integral over the half vectors h,
/// of D (wo.h) / mu times what happens at h.
fn albedo(lobe: Lobe, ggx: Ggx, mu: f64, rule: &[[f64; 2]]) -> f64 {
    let wo = DVec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, mu);
    let at_half_vector = |h: DVec3| {
        let cos = wo.dot(h);
        if cos <= 0.0 {
            return 0.0;
        }
        let wi = reflect(wo, h);
        let reflected = if wi.z > 0.0 { ggx.g2(wo, wi) } else { 0.0 };
        let share = match lobe {
            Lobe::Reflection => reflected,
            Lobe::Layer { eta } => {
                let f0 = fresnel::exact(1.0, eta);
                reflected * (fresnel::exact(cos, eta) - f0) / (1.0 - f0)
            }
            Lobe::Dielectric { eta } => {
                let f = fresnel::exact(cos, eta);
                let through = refract(wo, h, eta).filter(|wi| wi.z < 0.0);
                f * reflected + (1.0 - f) * through.map_or(0.0, |wi| ggx.g2(wo, wi))
            }
        };
        share * cos / (mu * h.z)
    };
    // D cos is uniform in (sin^2 psi, phi), where alpha tan(psi) is the slope of h. The picture is
    // symmetric in phi.
    let turns = 64;
    let mut sum = 0.0;
    for [x, weight] in rule {
        let psi = 0.5 * PI * x;
        let (sin, cos) = (libm::sin(psi), libm::cos(psi));
        let tan = ggx.alpha * sin / cos;
        let ring: f64 = (0..turns)
            .map(|i| at_half_vector(half_vector(tan, PI * (f64::from(i) + 0.5) / f64::from(turns))))
            .sum();
        sum += 0.5 * PI * weight * 2.0 * sin * cos * ring / f64::from(turns);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards E(mu, alpha) of single-scattering GGX against values computed elsewhere; that at
    /// alpha = 1, mu = 1 is 1 - ln 2.
    #[test]
    fn single_scattering_loses_what_it_should() {
        let mut curves = Curves::default();
        for (alpha, expected) in [
            (0.1, [0.988_304, 0.969_205, 0.883_455]),
            (0.25, [0.915_812, 0.857_263, 0.891_622]),
            (0.5, [0.687_849, 0.698_251, 0.860_105]),
            (1.0, [0.306_853, 0.450_694, 0.760_210]),
        ] {
            let curve = curves.get(Lobe::Reflection, alpha);
            for (mu, expected) in [1.0, 0.5, 0.1].into_iter().zip(expected) {
                let e = curve.at(mu);
                assert!((e - expected).abs() < 1e-4, "alpha {alpha}, mu {mu}: {e}, expected {expected}");
            }
        }
    }

    /// Guards interpolation: between its points a curve is as good as the quadrature it replaces, and
    /// the quadrature as good as one of four times the nodes.
    #[test]
    fn curves_agree_with_a_finer_quadrature() {
        let fine = gauss(256);
        let mut curves = Curves::default();
        for (lobe, alpha) in [
            (Lobe::Reflection, 0.04),
            (Lobe::Layer { eta: 1.5 }, 0.3),
            (Lobe::Dielectric { eta: 1.5 }, 0.3),
            (Lobe::Dielectric { eta: 1.0 / 1.5 }, 0.2),
        ] {
            let curve = curves.get(lobe, alpha);
            for i in 1..40 {
                let mu = f64::from(i) / 40.0 - 0.007;
                let expected = albedo(lobe, Ggx { alpha }, mu, &fine);
                assert!((curve.at(mu) - expected).abs() < 1e-4, "{lobe:?} {alpha} {mu} {expected}");
            }
        }
    }
}

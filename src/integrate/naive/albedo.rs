//! Directional albedos of single-scattering GGX lobes, by quadrature.
//!
//! Each is a [`Curve`] over the cosine of the viewing angle: tabulated where interpolation needs it, to
//! about 1e-5, and computed once for each width and index of refraction.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::{Arc, LazyLock};

use glam::DVec3;

use super::fresnel;
use super::layers::charlie;
use super::material::{reflect, refract};
use super::microfacet::{Ggx, half_vector};
use super::quadrature::gauss;
use crate::scene::{Principled, Textures};

/// Largest difference between a curve and its quadrature halfway between two of its points.
const TOLERANCE: f64 = 2e-5;

/// Slopes in each quadrature, and azimuths, at least.
const NODES: usize = 64;

/// A function of the cosine in [0, 1], linear between its points.
#[derive(Debug)]
pub(super) struct Curve {
    points: Vec<[f64; 2]>,
    average: f64,
}

/// Curves of neighbouring parameters, with their weights.
#[derive(Clone, Debug)]
pub(super) struct Mix(Vec<(f64, Arc<Curve>)>);

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
    /// Reflection with the Fresnel factor of `eta`.
    Coat {
        /// n_inside / n_outside.
        eta: f64,
    },
    /// The white sheen before it is scaled.
    Sheen,
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
    /// The curve of `lobe` at width `alpha`, alone.
    pub(super) fn mix(&mut self, lobe: Lobe, alpha: f64) -> Mix {
        Mix(vec![(1.0, self.get(lobe, alpha))])
    }

    /// The curve of `lobe` at width `alpha`.
    fn get(&mut self, lobe: Lobe, alpha: f64) -> Arc<Curve> {
        let (kind, eta) = match lobe {
            Lobe::Reflection => (0, 1.0),
            Lobe::Layer { eta } => (1, eta),
            Lobe::Dielectric { eta } => (2, eta),
            Lobe::Coat { eta } => (3, eta),
            Lobe::Sheen => return self.of_value(alpha, |wo, wi| charlie(alpha, wo, wi)),
        };
        let key = (kind, alpha.to_bits(), eta.to_bits());
        let curve = self.0.entry(key).or_insert_with(|| {
            let rule = gauss(NODES);
            Arc::new(Curve::new(|mu| albedo(lobe, Ggx { alpha }, mu, &rule)))
        });
        Arc::clone(curve)
    }

    /// The curve of a lobe that is `f` times its cosine, of `wo` and `wi`, known by `key`.
    fn of_value(&mut self, key: f64, f: impl Fn(DVec3, DVec3) -> f64) -> Arc<Curve> {
        let curve = self.0.entry((4, key.to_bits(), 0)).or_insert_with(|| {
            let rule = gauss(NODES);
            Arc::new(Curve::new(|mu| {
                let wo = DVec3::new(((1.0 - mu) * (1.0 + mu)).sqrt(), 0.0, mu);
                // Gauss's rule in the square root of the cosine, and in half a turn of the azimuth.
                let ring = |[x, weight]: &[f64; 2]| {
                    let z = x * x;
                    let r = (1.0 - z * z).sqrt();
                    let at = |[y, w]: &[f64; 2]| {
                        let phi = PI * y;
                        w * f(wo, DVec3::new(r * libm::cos(phi), r * libm::sin(phi), z))
                    };
                    2.0 * PI * weight * 2.0 * x * z * rule.iter().map(at).sum::<f64>()
                };
                rule.iter().map(ring).sum()
            }))
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
        let segment = |w: &[[f64; 2]]| {
            let ([x0, y0], [x1, y1]) = (w[0], w[1]);
            (x1 - x0) / 3.0 * (y0 * (2.0 * x0 + x1) + y1 * (x0 + 2.0 * x1))
        };
        let average = points.windows(2).map(segment).sum();
        Self { points, average }
    }

    /// The value at `mu`, [0, 1].
    pub(super) fn at(&self, mu: f64) -> f64 {
        let next = self.points.partition_point(|p| p[0] < mu).clamp(1, self.points.len() - 1);
        let ([x0, y0], [x1, y1]) = (self.points[next - 1], self.points[next]);
        y0 + (y1 - y0) * ((mu - x0) / (x1 - x0)).clamp(0.0, 1.0)
    }

    /// The average over the hemisphere: twice the integral of the value times the cosine.
    pub(super) fn average(&self) -> f64 {
        self.average
    }
}

impl Mix {
    /// The value at `mu`, [0, 1].
    pub(super) fn at(&self, mu: f64) -> f64 {
        self.0.iter().map(|(w, curve)| w * curve.at(mu)).sum()
    }

    /// The average over the hemisphere.
    pub(super) fn average(&self) -> f64 {
        self.0.iter().map(|(w, curve)| w * curve.average()).sum()
    }
}

/// The curves that a material with textures may need: at its own parameters where they are constant, else
/// at nodes to interpolate between.
#[derive(Debug, Default)]
pub(super) struct Shelf {
    /// Nodes of roughness, and of the root of F0.
    roughness: Vec<f64>,
    root: Vec<f64>,
    reflection: Vec<Arc<Curve>>,
    /// For each node of roughness, those of the root.
    layer: Vec<Vec<Arc<Curve>>>,
    dielectric: [Vec<Arc<Curve>>; 2],
    /// Nodes of roughness of coat and sheen, and their curves; empty where there is none.
    coat: (Vec<f64>, Vec<Arc<Curve>>),
    sheen: (Vec<f64>, Vec<Arc<Curve>>),
}

/// Smallest roughness that has curves.
const LEAST: f64 = 0.01;

impl Shelf {
    pub(super) fn new(p: &Principled, textures: &Textures) -> Self {
        let steps = |from: f64, to: f64, n: u32| {
            (0..=n).map(|i| from + (to - from) * f64::from(i) / f64::from(n)).collect::<Vec<f64>>()
        };
        let roughness = match textures.roughness {
            Some(_) => steps(LEAST, 1.0, 24),
            None => vec![f64::from(p.roughness).max(LEAST)],
        };
        let (ior, brightest) = (f64::from(p.ior), f64::from(p.specular_color.max_channel()).max(1.0));
        let largest = ((ior - 1.0) / (ior + 1.0)).abs() * (f64::from(p.specular) * brightest).sqrt();
        let largest = largest.min(0.99f64.sqrt());
        let varies = textures.specular.is_some() || textures.specular_color.is_some() && brightest > 1.0;
        let root = if varies { steps(1e-3 * largest, largest, 12) } else { vec![largest] };
        let mut curves = Curves::default();
        let mut row = |lobe| roughness.iter().map(|r| curves.get(lobe, r * r)).collect::<Vec<_>>();
        let solid = p.transmission > 0.0 && !p.thin && ior != 1.0;
        let dielectric = |row: &mut dyn FnMut(Lobe) -> Vec<Arc<Curve>>, eta| {
            if solid { row(Lobe::Dielectric { eta }) } else { Vec::new() }
        };
        let mut layer = vec![Vec::new(); roughness.len()];
        if largest > 0.0 {
            for s in &root {
                let eta = (1.0 + s) / (1.0 - s);
                for (list, curve) in layer.iter_mut().zip(row(Lobe::Layer { eta })) {
                    list.push(curve);
                }
            }
        }
        let reflection = row(Lobe::Reflection);
        let dielectric = [dielectric(&mut row, ior), dielectric(&mut row, 1.0 / ior)];
        let mut over = |textured: bool, value: f32, lobe, wanted: bool| {
            let nodes = if textured { steps(LEAST, 1.0, 24) } else { vec![f64::from(value).max(LEAST)] };
            let row =
                if wanted { nodes.iter().map(|r| curves.get(lobe, r * r)).collect() } else { Vec::new() };
            (nodes, row)
        };
        let eta = f64::from(p.coat_ior);
        let coat =
            over(textures.coat_roughness.is_some(), p.coat_roughness, Lobe::Coat { eta }, p.coat > 0.0);
        let colored = p.sheen_color.max_channel() > 0.0;
        let sheen =
            over(textures.sheen_roughness.is_some(), p.sheen_roughness.max(0.07), Lobe::Sheen, colored);
        Self { reflection, layer, dielectric, roughness, root, coat, sheen }
    }

    /// The curve of a lobe, interpolated over roughness and over the root of F0.
    pub(super) fn mix(&self, lobe: Lobe, alpha: f64) -> Mix {
        let over = |(nodes, curves): &(Vec<f64>, Vec<Arc<Curve>>)| {
            let mix = between(nodes, alpha.sqrt()).into_iter();
            Mix(mix.map(|(i, w)| (w, Arc::clone(&curves[i]))).collect())
        };
        match lobe {
            Lobe::Coat { .. } => return over(&self.coat),
            Lobe::Sheen => return over(&self.sheen),
            _ => {}
        }
        let mut mix = Vec::new();
        for (i, w) in between(&self.roughness, alpha.sqrt()) {
            match lobe {
                Lobe::Reflection => mix.push((w, &self.reflection[i])),
                Lobe::Dielectric { eta } => {
                    // Materials that transmit nothing ask too, and do not use it.
                    let list = &self.dielectric[usize::from(eta < 1.0)];
                    mix.push((w, list.get(i).unwrap_or(&self.reflection[i])));
                }
                Lobe::Layer { eta } if !self.layer[i].is_empty() => {
                    for (k, v) in between(&self.root, (eta - 1.0) / (eta + 1.0)) {
                        mix.push((w * v, &self.layer[i][k]));
                    }
                }
                Lobe::Layer { .. } | Lobe::Coat { .. } | Lobe::Sheen => {}
            }
        }
        Mix(mix.into_iter().map(|(w, curve)| (w, Arc::clone(curve))).collect())
    }
}

/// The nodes around `x`, with their weights.
fn between(nodes: &[f64], x: f64) -> Vec<(usize, f64)> {
    if nodes.len() == 1 {
        return vec![(0, 1.0)];
    }
    let next = nodes.partition_point(|n| *n < x).clamp(1, nodes.len() - 1);
    let t = ((x - nodes[next - 1]) / (nodes[next] - nodes[next - 1])).clamp(0.0, 1.0);
    vec![(next - 1, 1.0 - t), (next, t)]
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

/// The average over the hemisphere of the Fresnel reflectance, weighted with the cosine.
pub(super) fn average_fresnel(eta: f64) -> f64 {
    static RULE: LazyLock<Vec<[f64; 2]>> = LazyLock::new(|| gauss(256));
    RULE.iter().map(|[mu, w]| 2.0 * w * mu * fresnel::exact(*mu, eta)).sum()
}

/// The albedo of a lobe seen under the cosine `mu`: an integral over the half vectors h, of
/// D (wo.h) / mu times the share that leaves in the direction that h gives.
fn albedo(lobe: Lobe, ggx: Ggx, mu: f64, rule: &[[f64; 2]]) -> f64 {
    let sin = ((1.0 - mu) * (1.0 + mu)).sqrt();
    let wo = DVec3::new(sin, 0.0, mu);
    let reflected = |h: DVec3| {
        let wi = reflect(wo, h);
        let share = match lobe {
            Lobe::Reflection | Lobe::Sheen => 1.0,
            Lobe::Layer { eta } => {
                let f0 = fresnel::exact(1.0, eta);
                (fresnel::exact(wo.dot(h), eta) - f0) / (1.0 - f0)
            }
            Lobe::Coat { eta } | Lobe::Dielectric { eta } => fresnel::exact(wo.dot(h), eta),
        };
        if wi.z > 0.0 { share * ggx.g2(wo, wi) } else { 0.0 }
    };
    let transmitted = |h: DVec3, eta: f64| {
        let through = 1.0 - fresnel::exact(wo.dot(h), eta);
        let wi = refract(wo, h, eta).filter(|wi| wi.z < 0.0);
        wi.map_or(0.0, |wi| through * ggx.g2(wo, wi))
    };
    let visible = |h: DVec3| wo.dot(h) / (mu * h.z);
    // The picture is symmetric in the azimuth of h, so that half a turn is enough.
    // Total reflection sets in at some azimuths only, which takes more of them to see.
    let turns = match lobe {
        Lobe::Dielectric { eta } if eta < 1.0 => 3 * rule.len(),
        _ => rule.len(),
    };
    let ring = |i: usize| {
        let phi = PI * (i as f64 + 0.5) / turns as f64;
        let along = sin * libm::cos(phi);
        // Steeper half vectors reflect into the surface; steeper ones still look away.
        let reflects = (along + (along * along + mu * mu).sqrt()) / mu;
        let faces = if along < 0.0 { mu / -along } else { f64::INFINITY };
        let mut sum = 0.0;
        match lobe {
            Lobe::Reflection | Lobe::Layer { .. } | Lobe::Coat { .. } | Lobe::Sheen => {
                sum += over_slopes(ggx, phi, [0.0, reflects], rule, |h| reflected(h) * visible(h));
            }
            Lobe::Dielectric { eta } => {
                for [from, to] in pieces(critical_slopes(along, mu, eta), reflects) {
                    sum += over_slopes(ggx, phi, [from, to], rule, |h| reflected(h) * visible(h));
                }
                for [from, to] in pieces(critical_slopes(along, mu, eta), faces) {
                    sum += over_slopes(ggx, phi, [from, to], rule, |h| transmitted(h, eta) * visible(h));
                }
            }
        }
        sum
    };
    (0..turns).map(ring).sum::<f64>() / turns as f64
}

/// The slopes t of half vectors under which total reflection begins or ends: the positive roots of
/// (along t + mu)^2 = c^2 (1 + t^2), c being the critical cosine. There the integrand has a kink.
fn critical_slopes(along: f64, mu: f64, eta: f64) -> Vec<f64> {
    if eta >= 1.0 {
        return Vec::new();
    }
    let c2 = (1.0 - eta) * (1.0 + eta);
    let (a, b, c) = (along * along - c2, along * mu, mu * mu - c2);
    let discriminant = b * b - a * c;
    if discriminant < 0.0 || a == 0.0 {
        return Vec::new();
    }
    let mut roots = [-1.0, 1.0].map(|sign| (-b + sign * discriminant.sqrt()) / a).to_vec();
    roots.retain(|t| *t > 0.0);
    roots.sort_by(f64::total_cmp);
    roots
}

/// The intervals into which `breaks`, in rising order, cut [0, `end`].
fn pieces(mut breaks: Vec<f64>, end: f64) -> Vec<[f64; 2]> {
    breaks.retain(|t| *t < end);
    breaks.insert(0, 0.0);
    breaks.push(end);
    breaks.windows(2).map(|w| [w[0], w[1]]).collect()
}

/// The integral of `g` over half vectors with density D cos, for one azimuth and a range of slopes.
/// The density is uniform in sin^2 psi, where alpha tan(psi) is the slope.
fn over_slopes(ggx: Ggx, phi: f64, range: [f64; 2], rule: &[[f64; 2]], g: impl Fn(DVec3) -> f64) -> f64 {
    let [from, to] = range.map(|slope| libm::atan2(slope, ggx.alpha));
    let node = |[x, weight]: &[f64; 2]| {
        let psi = from + (to - from) * x;
        let (sin, cos) = (libm::sin(psi), libm::cos(psi));
        weight * (to - from) * 2.0 * sin * cos * g(half_vector(ggx.alpha * sin / cos, phi))
    };
    rule.iter().map(node).sum()
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

    /// Guards the hemispherical averages against values computed elsewhere (n = 1.5, both sides). From
    /// the inside, where no material asks for it, total reflection costs digits.
    #[test]
    fn hemispherical_fresnel() {
        for (eta, expected, bound) in [(1.5, 0.091_777_959, 1e-9), (1.0 / 1.5, 0.596_345_760, 1e-4)] {
            let average = average_fresnel(eta);
            assert!((average - expected).abs() < bound, "{eta}: {average}");
        }
    }

    /// Guards interpolation: between its points a curve is as good as the quadrature it replaces, and
    /// the quadrature as good as one of twice the nodes.
    #[test]
    fn curves_agree_with_a_finer_quadrature() {
        let fine = gauss(2 * NODES);
        let mut curves = Curves::default();
        for (lobe, alpha) in [
            (Lobe::Reflection, 0.04),
            (Lobe::Layer { eta: 1.5 }, 0.3),
            (Lobe::Dielectric { eta: 1.5 }, 0.3),
            (Lobe::Dielectric { eta: 1.0 / 1.5 }, 0.2),
        ] {
            let curve = curves.get(lobe, alpha);
            for i in 1..16 {
                let mu = f64::from(i) / 16.0 - 0.045;
                let expected = albedo(lobe, Ggx { alpha }, mu, &fine);
                assert!((curve.at(mu) - expected).abs() < 1e-4, "{lobe:?} {alpha} {mu} {expected}");
            }
        }
    }
}

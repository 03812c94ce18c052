//! The principled material of the reference integrator.
//!
//! With m = metallic, t = transmission, A = the directional albedo of `f_spec`, per channel:
//!
//! f = m f_metal + (1-m) [ t f_trans + (1-t) ( f_spec + (1 - A(mu_o)) base/pi ) ]
//!
//! below the layers of [`super::layers`]. Everything but transmission is the same from both sides. GGX of alpha = roughness^2 with
//! height-correlated Smith masking: f_ss = F D G2 / (4 mu_i mu_o); below alpha = [`SMOOTH`] the lobes are
//! deltas. E is the directional albedo of f_ss with F = 1, E_avg its hemispherical average; a lobe with
//! average Fresnel factor Favg is compensated by 1 + Fms (1-E)/E, Fms = Favg E_avg / (1 - Favg (1-E_avg))
//! (E. Turquin, "Practical multiple scattering compensation for microfacet models", 2019).
//!
//! * `f_metal`: F = Schlick from base to one at wo.h, Favg = base + (1-base)/21.
//! * `f_spec`: F0 of the ior times `specular` and the largest channel of `specular_color` above one (at
//!   most 0.99), tinted; F = lerp(tint F0, 1, s), s = (F_exact(wo.h) - F0)/(1 - F0) for the index of
//!   refraction that has F0. No lobe where F0 is zero, no compensation where it is smooth.
//! * `f_trans`, solid: B. Walter et al. (EGSR 2007) with the exact Fresnel factor of `ior`, G2 =
//!   1/(1 + Lambda_o + Lambda_i) for reflection and transmission; transmission is tinted and divided by
//!   eta^2; both are divided by their total albedo from that side. Where `ior` is one nothing is
//!   bent: a delta straight through, whatever the roughness.
//! * `f_trans`, thin: both faces at once, F = 2F/(1+F); transmission is the reflection lobe mirrored
//!   through the surface with (1-F) tint; both divided by E.
//!
//! Directions: a mixture of the cosine hemisphere, on each side that the material scatters to, and of
//! half vectors drawn from D, to reflect at or to pass; the density is that of the whole mixture.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use super::albedo::{Lobe, Mix, average_fresnel};
use super::fresnel;
use super::layers::Layers;
use super::material::{Scatter, cosine_hemisphere, reflect, refract};
use super::microfacet::Ggx;
use super::rgb;
use super::rng::Rng;
use crate::scene;

/// Widths below this are perfectly smooth.
pub(super) const SMOOTH: f64 = 1e-4;

/// A principled material, ready to be evaluated. Directions are local, with z on the side of `wo`.
#[derive(Clone, Debug)]
pub(super) struct Principled {
    base: DVec3,
    metallic: f64,
    transmission: f64,
    transmission_tint: DVec3,
    thin: bool,
    ior: f64,
    layer: Layer,
    /// Coat and sheen.
    pub(super) layers: Layers,
    /// None where smooth.
    rough: Option<Rough>,
}

/// The dielectric layer on top.
#[derive(Clone, Debug)]
struct Layer {
    f0: f64,
    tint: DVec3,
    /// The index of refraction whose reflectance at normal incidence is `f0`.
    eta: f64,
}

/// What a rough material needs to know of itself.
#[derive(Clone, Debug)]
struct Rough {
    ggx: Ggx,
    /// E.
    reflection: Mix,
    /// Albedo of the layer's scaled Fresnel factor.
    layer: Mix,
    /// Total albedo of solid transmission from the front and from the back.
    dielectric: [Mix; 2],
    metal_fms: DVec3,
    layer_fms: DVec3,
}

/// How likely each way to draw a direction is; need not sum to one.
struct Mixture {
    /// Cosine hemisphere on the side of `wo`, and on the other.
    cosine: [f64; 2],
    /// A half vector, to reflect at.
    reflect: f64,
    /// A half vector, to reflect at with the probability that Fresnel gives, and else to pass.
    split: f64,
    /// A half vector of the coat, to reflect at.
    coat: f64,
}

impl Principled {
    /// `curves` gives the albedo of a lobe at a width.
    pub(super) fn new(p: &scene::Principled, curves: &mut dyn FnMut(Lobe, f64) -> Mix) -> Self {
        let (base, ior) = (rgb(p.base_color), f64::from(p.ior));
        let alpha = f64::from(p.roughness) * f64::from(p.roughness);
        let layer = Layer::new(ior, f64::from(p.specular), rgb(p.specular_color));
        let rough = (alpha >= SMOOTH).then(|| {
            let reflection = curves(Lobe::Reflection, alpha);
            let e_avg = reflection.average();
            let fms = |f_avg: DVec3| f_avg * e_avg / (1.0 - f_avg * (1.0 - e_avg));
            let dielectric = if p.transmission > 0.0 && !p.thin && ior != 1.0 {
                [ior, 1.0 / ior].map(|eta| curves(Lobe::Dielectric { eta }, alpha))
            } else {
                [reflection.clone(), reflection.clone()]
            };
            Rough {
                ggx: Ggx { alpha },
                layer: curves(Lobe::Layer { eta: layer.eta }, alpha),
                dielectric,
                metal_fms: fms(base + (1.0 - base) / 21.0),
                layer_fms: fms(layer.blend(average_fresnel(layer.eta))),
                reflection,
            }
        });
        Self {
            base,
            metallic: f64::from(p.metallic),
            transmission: f64::from(p.transmission),
            transmission_tint: rgb(p.transmission_tint),
            thin: p.thin,
            ior,
            layer,
            layers: Layers::new(p, curves),
            rough,
        }
    }

    /// The BSDF without its delta lobes, sr^-1. `front`: whether `wo` is on the front side.
    pub(super) fn f(&self, wo: DVec3, wi: DVec3, front: bool) -> DVec3 {
        let below = self.layers.below(wo.z) * self.f_below(wo, wi, front);
        if wi.z > 0.0 { below + self.layers.f(wo, wi) } else { below }
    }

    /// What is below coat and sheen.
    fn f_below(&self, wo: DVec3, wi: DVec3, front: bool) -> DVec3 {
        let [metal, trans, layered] = self.shares();
        let mut f = DVec3::ZERO;
        if wi.z > 0.0 {
            f += layered * (1.0 - self.layer_albedo(wo.z)) * self.base * FRAC_1_PI;
        }
        let Some(rough) = &self.rough else { return f };
        let ggx = rough.ggx;
        let e = rough.reflection.at(wo.z);
        // f_ss without its Fresnel factor, and the cosine that the factor needs.
        let single = |wi: DVec3| {
            let h = (wo + wi).normalize();
            (ggx.d(h) * ggx.g2(wo, wi) / (4.0 * wo.z * wi.z), wo.dot(h))
        };
        if wi.z > 0.0 {
            let (value, cos) = single(wi);
            let compensated = |fms: DVec3| value * (1.0 + fms * (1.0 - e) / e);
            f += metal * fresnel::schlick(self.base, cos) * compensated(rough.metal_fms);
            f += layered * self.layer.fresnel(cos) * compensated(rough.layer_fms);
        }
        if trans > 0.0 && self.thin {
            let (value, cos) = single(DVec3::new(wi.x, wi.y, wi.z.abs()));
            let sheet = self.sheet(cos);
            let share = if wi.z > 0.0 { DVec3::splat(sheet) } else { (1.0 - sheet) * self.transmission_tint };
            f += trans * share * value / e;
        } else if trans > 0.0 && self.ior != 1.0 {
            let eta = self.eta(front);
            let total = rough.dielectric[usize::from(!front)].at(wo.z);
            let share = if wi.z > 0.0 {
                let (value, cos) = single(wi);
                DVec3::splat(value * fresnel::exact(cos, eta))
            } else if let Some((h, jacobian)) = refracting_half_vector(wo, wi, eta) {
                let through = (1.0 - fresnel::exact(wo.dot(h), eta)) * ggx.d(h) * ggx.g2(wo, wi);
                self.transmission_tint * through * wo.dot(h) * jacobian / (wo.z * -wi.z * eta * eta)
            } else {
                DVec3::ZERO
            };
            f += trans * share / total;
        }
        f
    }

    /// A direction, where the path goes on.
    pub(super) fn sample(&self, wo: DVec3, front: bool, rng: &mut Rng) -> Option<Scatter> {
        let deltas = self.deltas(wo, front);
        let mixture = self.mixture();
        let rough_share = mixture.total();
        let total = rough_share + deltas.iter().map(|d| d.weight.max_element()).sum::<f64>();
        let mut u = rng.uniform() * total;
        for delta in deltas {
            let share = delta.weight.max_element();
            if u < share {
                return Some(Scatter { weight: delta.weight * total / share, ..delta });
            }
            u -= share;
        }
        let wi = self.draw(&mixture, wo, front, rng)?;
        let pdf = self.pdf(&mixture, wo, wi, front) * rough_share / total;
        (pdf > 0.0).then(|| Scatter { wi, weight: self.f(wo, wi, front) * wi.z.abs() / pdf })
    }

    /// Shares of metal, transmission, and the layer over diffuse.
    fn shares(&self) -> [f64; 3] {
        let (m, t) = (self.metallic, self.transmission);
        [m, (1.0 - m) * t, (1.0 - m) * (1.0 - t)]
    }

    fn eta(&self, front: bool) -> f64 {
        if front { self.ior } else { 1.0 / self.ior }
    }

    /// Reflectance of a sheet: both faces, and all that bounces between them.
    fn sheet(&self, cos: f64) -> f64 {
        let f = fresnel::exact(cos, self.ior);
        2.0 * f / (1.0 + f)
    }

    /// A(mu_o): what the layer takes from what is below.
    fn layer_albedo(&self, mu: f64) -> DVec3 {
        if self.layer.f0 == 0.0 {
            return DVec3::ZERO;
        }
        let Some(rough) = &self.rough else { return self.layer.fresnel(mu) };
        let e = rough.reflection.at(mu);
        let f0 = self.layer.tint * self.layer.f0;
        let single = f0 * e + (1.0 - f0) * rough.layer.at(mu);
        single * (1.0 + rough.layer_fms * (1.0 - e) / e)
    }

    /// The lobes of a single direction, with their weights.
    fn deltas(&self, wo: DVec3, front: bool) -> Vec<Scatter> {
        let [metal, trans, layered] = self.shares();
        let (mut reflected, mut transmitted) = (DVec3::ZERO, DVec3::ZERO);
        let mut beyond = -wo;
        if self.rough.is_none() {
            reflected += metal * fresnel::schlick(self.base, wo.z);
            reflected += layered * self.layer.fresnel(wo.z);
            if self.thin {
                let sheet = self.sheet(wo.z);
                reflected += trans * sheet;
                transmitted += trans * (1.0 - sheet) * self.transmission_tint;
            } else {
                let eta = self.eta(front);
                let f = fresnel::exact(wo.z, eta);
                reflected += trans * f;
                if let Some(wi) = refract(wo, DVec3::Z, eta) {
                    beyond = wi;
                    transmitted += trans * (1.0 - f) * self.transmission_tint / (eta * eta);
                }
            }
        } else if !self.thin && self.ior == 1.0 {
            transmitted += trans * self.transmission_tint;
        }
        let below = self.layers.below(wo.z);
        let lobes = [
            Scatter { wi: reflect(wo, DVec3::Z), weight: below * reflected + self.layers.delta(wo.z) },
            Scatter { wi: beyond, weight: below * transmitted },
        ];
        lobes.into_iter().filter(|lobe| lobe.weight != DVec3::ZERO).collect()
    }

    fn mixture(&self) -> Mixture {
        let [metal, trans, layered] = self.shares();
        let diffuse = layered * self.base.max_element();
        let coat = self.layers.half_vectors().map_or(0.0, |(_, share)| share);
        let wide = self.layers.wide();
        if self.rough.is_none() {
            return Mixture { cosine: [diffuse + wide, 0.0], reflect: 0.0, split: 0.0, coat };
        }
        let trans = if !self.thin && self.ior == 1.0 { 0.0 } else { trans };
        let layer = if self.layer.f0 > 0.0 { 0.5 * layered } else { 0.0 };
        let reflect = metal + layer;
        let split = trans;
        // A little of the hemisphere bounds the weights; more would thin out long paths inside glass.
        let cosine = [diffuse + 0.02 * (reflect + split) + wide, 0.02 * split];
        Mixture { cosine, reflect, split, coat }
    }

    /// A direction from the mixture; none where what was drawn leads nowhere.
    fn draw(&self, mixture: &Mixture, wo: DVec3, front: bool, rng: &mut Rng) -> Option<DVec3> {
        let below = |w: DVec3| DVec3::new(w.x, w.y, -w.z);
        let mut u = rng.uniform() * mixture.total();
        if u < mixture.cosine[0] {
            return Some(cosine_hemisphere(rng));
        }
        u -= mixture.cosine[0];
        if u < mixture.cosine[1] {
            return Some(below(cosine_hemisphere(rng)));
        }
        u -= mixture.cosine[1];
        if u < mixture.coat {
            let h = self.layers.half_vectors()?.0.sample(rng);
            return Some(reflect(wo, h)).filter(|wi| wo.dot(h) > 0.0 && wi.z > 0.0);
        }
        u -= mixture.coat;
        let h = self.rough.as_ref()?.ggx.sample(rng);
        if wo.dot(h) <= 0.0 {
            return None;
        }
        let mirrored = Some(reflect(wo, h)).filter(|wi| wi.z > 0.0);
        if u < mixture.reflect || rng.uniform() < self.split_reflects(wo.dot(h), front) {
            mirrored
        } else if self.thin {
            mirrored.map(below)
        } else {
            refract(wo, h, self.eta(front)).filter(|wi| wi.z < 0.0)
        }
    }

    /// Reflectance of the transmissive lobe at a half vector.
    fn split_reflects(&self, cos: f64, front: bool) -> f64 {
        if self.thin { self.sheet(cos) } else { fresnel::exact(cos, self.eta(front)) }
    }

    /// Density of [`Principled::draw`], per solid angle.
    fn pdf(&self, mixture: &Mixture, wo: DVec3, wi: DVec3, front: bool) -> f64 {
        let up = DVec3::new(wi.x, wi.y, wi.z.abs());
        let mut pdf = mixture.cosine[usize::from(wi.z < 0.0)] * up.z * FRAC_1_PI;
        if let Some((ggx, _)) = self.layers.half_vectors().filter(|_| wi.z > 0.0) {
            let h = (wo + wi).normalize();
            pdf += mixture.coat * ggx.pdf(h) * 0.25 / wo.dot(h);
        }
        if let Some(rough) = &self.rough {
            // The half vector, |d h / d wi|, and how often it is used in this way.
            let h = (wo + up).normalize();
            let mirrored = (h, 0.25 / wo.dot(h));
            let reflects = self.split_reflects(wo.dot(h), front);
            let way = if wi.z > 0.0 {
                Some((mirrored, mixture.reflect + mixture.split * reflects))
            } else if self.thin {
                Some((mirrored, mixture.split * (1.0 - reflects)))
            } else {
                refracting_half_vector(wo, wi, self.eta(front)).map(|(h, jacobian)| {
                    let passes = 1.0 - self.split_reflects(wo.dot(h), front);
                    ((h, jacobian), mixture.split * passes)
                })
            };
            if let Some(((h, jacobian), share)) = way {
                pdf += share * rough.ggx.pdf(h) * jacobian;
            }
        }
        pdf / mixture.total()
    }
}

impl Mixture {
    fn total(&self) -> f64 {
        self.cosine[0] + self.cosine[1] + self.reflect + self.split + self.coat
    }
}

impl Layer {
    fn new(ior: f64, specular: f64, color: DVec3) -> Self {
        let r = (ior - 1.0) / (ior + 1.0);
        let brightest = color.max_element();
        let (f0, tint) = if brightest > 1.0 {
            ((r * r * specular * brightest).min(0.99), color / brightest)
        } else {
            (r * r * specular, color)
        };
        Self { f0, tint, eta: (1.0 + f0.sqrt()) / (1.0 - f0.sqrt()) }
    }

    /// The Fresnel factor; black where there is no layer.
    fn fresnel(&self, cos: f64) -> DVec3 {
        if self.f0 == 0.0 { DVec3::ZERO } else { self.blend(fresnel::exact(cos, self.eta)) }
    }

    /// From the tinted F0 to one, as the exact reflectance goes from F0 to one.
    fn blend(&self, exact: f64) -> DVec3 {
        let s = (exact - self.f0) / (1.0 - self.f0);
        let f0 = self.tint * self.f0;
        f0 + (1.0 - f0) * s
    }
}

/// The half vector (z up) that refracts `wo` into `wi`, and |d h / d wi|; none where the two are not on
/// opposite sides of it. eta = n_transmitted / n_incident, with wo incident.
fn refracting_half_vector(wo: DVec3, wi: DVec3, eta: f64) -> Option<(DVec3, f64)> {
    let h = (wo + eta * wi).try_normalize()?;
    let h = if h.z < 0.0 { -h } else { h };
    let (cos_o, cos_i) = (wo.dot(h), wi.dot(h));
    if cos_o <= 0.0 || cos_i >= 0.0 {
        return None;
    }
    let denominator = cos_o + eta * cos_i;
    Some((h, eta * eta * -cos_i / (denominator * denominator)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards sampling, value and albedo of the dielectric lobes together: light that arrives is
    /// reflected or transmitted, all of it, from both sides and at every angle.
    #[test]
    fn one_interaction_keeps_energy() {
        for (roughness, thin) in [(0.1, false), (0.3, false), (0.6, false), (1.0, false), (0.5, true)] {
            let p = scene::Principled { roughness, thin, transmission: 1.0, ..Default::default() };
            let p = {
                let mut curves = super::super::albedo::Curves::default();
                Principled::new(&p, &mut |lobe, alpha| curves.mix(lobe, alpha))
            };
            for front in [true, false] {
                let squeeze = if thin { 1.0 } else { p.eta(front) * p.eta(front) };
                for mu in [1.0f64, 0.8, 0.5, 0.2, 0.05] {
                    let wo = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
                    let mut moments = super::super::path::Moments::default();
                    let mut rng = Rng::new(7, 0, 0);
                    for _ in 0..30_000 {
                        let next = p.sample(wo, front, &mut rng);
                        moments.add(next.map_or(DVec3::ZERO, |s| {
                            if s.wi.z < 0.0 { s.weight * squeeze } else { s.weight }
                        }));
                    }
                    let (mean, error) = (moments.mean.x, moments.variance_of_mean().x.sqrt());
                    let difference = (mean - 1.0).abs();
                    assert!(
                        difference <= 4.5 * error && error < 0.02,
                        "roughness {roughness} thin {thin} front {front} mu {mu}: {mean} +- {error}"
                    );
                }
            }
        }
    }
}

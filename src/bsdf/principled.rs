//! The principled material: metal, and a dielectric layer over diffuse or transmission, all of it below
//! the layers of [`super::layers`].
//!
//! Layering follows Blender: a lower layer receives what the directional albedo of the layer above
//! leaves, 1 - A(mu_o). Rough lobes are compensated for the multiple scattering that the
//! single-scattering model loses (Kulla and Conty, SIGGRAPH course 2017; applied as a scale on the
//! single-scattering lobe, after Turquin, 2019): a white metal reflects everything at any roughness.
//! Neither is reciprocal; `transport` is the place where that would be mended.
//!
//! With alpha below [`SMOOTH_ALPHA`] the dielectric and metallic lobes are delta lobes.

use glam::Vec3;

use super::dielectric::RoughDielectric;
use super::fresnel::{Fresnel, schlick};
use super::layers::{Coat, Sheen};
use super::tables::Albedo;
use super::{BsdfSample, Diffuse, Glass, SMOOTH_ALPHA, Transport, ggx, same_side};
use crate::color::Rgb;
use crate::mutants::planted;
use crate::rare::rarely;

/// The dielectric specular layer.
#[derive(Clone, Debug)]
pub struct Specular {
    /// Reflectance at normal incidence, untinted, (0, 1).
    pub f0: f32,
    /// Tint at normal incidence, [0, 1].
    pub tint: Rgb,
    /// The index whose reflectance at normal incidence is `f0`.
    pub eta: f32,
    /// The curve between normal and grazing incidence.
    pub fresnel: Fresnel,
    /// Share of the grazing term in the lobe's albedo; `None` for a smooth layer.
    pub grazing: Option<Albedo>,
    /// Cosine-weighted average of the Fresnel term.
    pub average: Rgb,
}

impl Specular {
    /// Fresnel term: from the tint at normal incidence to white at grazing, along the curve.
    #[inline]
    fn fresnel(&self, cos: f32) -> Rgb {
        self.mix(self.grazing_share(cos))
    }

    /// How far the curve has risen from its value at normal incidence, [0, 1].
    #[inline]
    pub(super) fn grazing_share(&self, cos: f32) -> f32 {
        self.fresnel.grazing_share(cos, self.eta, self.f0)
    }

    fn mix(&self, share: f32) -> Rgb {
        (self.tint * self.f0).lerp(Rgb::WHITE, share)
    }
}

/// A prepared principled material; weights are shares of the whole.
#[derive(Clone, Debug)]
pub struct Principled {
    /// GGX width; zero where the specular lobes are smooth.
    pub alpha: f32,
    /// Metallic share.
    pub metal: f32,
    /// Share of the dielectric that transmits.
    pub transmission: f32,
    /// Base colour.
    pub base: Rgb,
    /// The specular layer; `None` where the index is one or the layer is off.
    pub specular: Option<Specular>,
    /// Albedo of the uncompensated white reflection lobe; `None` where smooth.
    pub white: Option<Albedo>,
    /// The transmissive lobes where rough.
    pub rough: Option<RoughDielectric>,
    /// The transmissive lobes where smooth.
    pub smooth: Glass,
    /// A clear coat over all of this.
    pub coat: Option<Coat>,
    /// Fibres over the coat.
    pub sheen: Option<Sheen>,
}

/// Shares of the energy at one outgoing direction, which are the probabilities of sampling each lobe.
struct Shares {
    reflect: f32,
    diffuse: f32,
    transmit: f32,
    /// What the specular layer lets through to the diffuse one.
    below: Rgb,
    /// Scale of the metal lobe and of the specular lobe.
    metal_scale: Rgb,
    specular_scale: Rgb,
    /// Albedo of all lobes, roughly.
    albedo: f32,
}

/// The same for the layers on top of it all.
struct Layers {
    sheen: f32,
    coat: f32,
    /// What the fibres leave to the coat, and both to the rest.
    below_sheen: f32,
    below_coat: f32,
}

impl Principled {
    fn is_smooth(&self) -> bool {
        self.alpha < SMOOTH_ALPHA
    }

    /// 1 + Fms (1 - E) / E: what multiple scattering adds to a lobe of average Fresnel term `average`.
    #[inline]
    fn compensation(&self, average: Rgb, mu: f32) -> Rgb {
        let Some(white) = &self.white else { return Rgb::WHITE };
        let (e, e_avg) = (white.at(mu), white.average());
        average.map(|f| 1.0 + f * e_avg / (1.0 - f * (1.0 - e_avg)) * (1.0 - e) / e)
    }

    #[inline]
    fn shares(&self, mu: f32) -> Shares {
        let metal_average = self.base * (20.0 / 21.0) + Rgb::grey(1.0 / 21.0);
        let metal_scale = if self.metal > 0.0 { self.compensation(metal_average, mu) } else { Rgb::WHITE };
        let (mut specular_albedo, mut specular_scale) = (Rgb::BLACK, Rgb::WHITE);
        if let Some(s) = &self.specular {
            match (&s.grazing, &self.white) {
                (Some(grazing), Some(white)) => {
                    specular_scale = self.compensation(s.average, mu);
                    // The lobe is linear in the grazing share, so two rows give every tint.
                    let (g, e) = (grazing.at(mu), white.at(mu));
                    specular_albedo = ((s.tint * s.f0) * (e - g) + Rgb::grey(g)) * specular_scale;
                }
                _ => specular_albedo = s.fresnel(mu),
            }
        }
        let below = (Rgb::WHITE - specular_albedo).map(|x| x.max(0.0));
        let opaque = (1.0 - self.metal) * (1.0 - self.transmission);
        let metal_albedo = schlick(self.base, mu).luminance();
        let reflect = self.metal * metal_albedo + opaque * specular_albedo.luminance();
        let diffuse = opaque * (below * self.base).luminance();
        let transmit = (1.0 - self.metal) * self.transmission;
        let sum = reflect + diffuse + transmit;
        let inv = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Shares {
            reflect: reflect * inv,
            diffuse: diffuse * inv,
            transmit: transmit * inv,
            below,
            metal_scale,
            specular_scale,
            albedo: sum,
        }
    }

    /// True where every lobe is a delta lobe.
    #[must_use]
    pub fn is_delta(&self) -> bool {
        self.is_smooth()
            && (self.metal == 1.0 || self.transmission == 1.0)
            && self.sheen.is_none()
            && self.coat.as_ref().is_none_or(Coat::is_smooth)
    }

    fn has_layers(&self) -> bool {
        self.coat.is_some() || self.sheen.is_some()
    }

    /// What coat and sheen leave of light that leaves the rest of the material at the cosine `mu`, [0, 1].
    #[inline]
    #[must_use]
    pub fn below_layers(&self, mu: f32) -> f32 {
        let below_sheen = self.sheen.as_ref().map_or(1.0, |s| 1.0 - s.albedo(mu));
        below_sheen * self.coat.as_ref().map_or(1.0, |c| 1.0 - c.albedo(mu))
    }

    fn layers(&self, mu: f32, base: f32) -> Layers {
        let sheen = self.sheen.as_ref().map_or(0.0, |s| s.albedo(mu));
        let below_sheen = 1.0 - sheen;
        let coat = self.coat.as_ref().map_or(0.0, |c| c.albedo(mu));
        let below_coat = below_sheen * (1.0 - coat);
        let coat = below_sheen * coat;
        let sum = sheen + coat + below_coat * base;
        let inv = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        Layers { sheen: sheen * inv, coat: coat * inv, below_sheen, below_coat }
    }

    /// Fresnel terms of metal and specular layer at `cos`, with their shares and scales.
    #[inline]
    fn reflectance(&self, cos: f32, s: &Shares) -> Rgb {
        let mut f = Rgb::BLACK;
        if self.metal > 0.0 {
            f += schlick(self.base, cos) * s.metal_scale * self.metal;
        }
        if let Some(specular) = &self.specular {
            let opaque = (1.0 - self.metal) * (1.0 - self.transmission);
            f += specular.fresnel(cos) * s.specular_scale * opaque;
        }
        f
    }

    /// BSDF value and density of everything that is not a delta lobe.
    #[must_use]
    pub fn f_and_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        let s = self.shares(wo.z.abs());
        if self.has_layers() {
            let layers = self.layers(wo.z.abs(), s.albedo);
            self.evaluate_layers(wo, wi, transport, &s, &layers)
        } else {
            self.evaluate(wo, wi, transport, &s)
        }
    }

    fn evaluate_layers(
        &self,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
        s: &Shares,
        layers: &Layers,
    ) -> (Rgb, f32) {
        let base_share = (1.0 - layers.sheen - layers.coat).max(0.0);
        let (f, pdf) = self.evaluate(wo, wi, transport, s);
        let (mut f, mut pdf) = (f * layers.below_coat, pdf * base_share);
        if same_side(wo, wi) {
            let sign = 1.0f32.copysign(wo.z);
            let (wo, wi) = (Vec3::new(wo.x, wo.y, wo.z * sign), Vec3::new(wi.x, wi.y, wi.z * sign));
            if let Some(coat) = &self.coat {
                let (g, p) = coat.f_and_pdf(wo, wi);
                f += Rgb::grey(g * layers.below_sheen);
                pdf += layers.coat * p;
            }
            if let Some(sheen) = &self.sheen {
                let (g, p) = sheen.f_and_pdf(wo, wi);
                f += g;
                pdf += layers.sheen * p;
            }
        }
        (f, pdf)
    }

    /// A layer in proportion to its share of the energy (`u[0]`), then a direction of it.
    fn sample_layers(&self, wo: Vec3, u: [f32; 3], transport: Transport) -> Option<BsdfSample> {
        let s = self.shares(wo.z.abs());
        let layers = self.layers(wo.z.abs(), s.albedo);
        let sign = 1.0f32.copysign(wo.z);
        let turn = |w: Vec3| Vec3::new(w.x, w.y, w.z * sign);
        let above = layers.sheen + layers.coat;
        let (wi, eta) = if let Some(sheen) = self.sheen.as_ref().filter(|_| u[0] < layers.sheen) {
            (turn(sheen.sample([u[1], u[2]])), 1.0)
        } else if let Some(coat) = self.coat.as_ref().filter(|_| u[0] < above) {
            if coat.is_smooth() {
                let wi = Vec3::new(-wo.x, -wo.y, wo.z);
                let weight = Rgb::grey(layers.below_sheen * coat.albedo(wo.z.abs()) / layers.coat);
                return BsdfSample { wi, weight, pdf: layers.coat, delta: true, eta: 1.0 }.checked();
            }
            (turn(coat.sample(turn(wo), [u[1], u[2]])?), 1.0)
        } else {
            let share = 1.0 - above;
            let choice = ((u[0] - above) / share).clamp(0.0, crate::math::ONE_MINUS_EPSILON);
            let sample = self.sample_base(wo, [choice, u[1], u[2]], transport, &s)?;
            if sample.delta {
                let weight = sample.weight * (layers.below_coat / share);
                return BsdfSample { weight, pdf: sample.pdf * share, ..sample }.checked();
            }
            (sample.wi, sample.eta)
        };
        let (f, pdf) = self.evaluate_layers(wo, wi, transport, &s, &layers);
        BsdfSample { wi, weight: f * (wi.z.abs() / pdf), pdf, delta: false, eta }.checked()
    }

    fn evaluate(&self, wo: Vec3, wi: Vec3, transport: Transport, s: &Shares) -> (Rgb, f32) {
        let (mut f, mut pdf) = (Rgb::BLACK, 0.0);
        if same_side(wo, wi) {
            if s.diffuse > 0.0 {
                let opaque = (1.0 - self.metal) * (1.0 - self.transmission);
                let lambert = Diffuse { color: self.base };
                f += lambert.f(wo, wi) * s.below * opaque;
                pdf += s.diffuse * lambert.pdf(wo, wi);
            }
            if s.reflect > 0.0 && !self.is_smooth() {
                let sign = 1.0f32.copysign(wo.z);
                let (wo, wi) = (Vec3::new(wo.x, wo.y, wo.z * sign), Vec3::new(wi.x, wi.y, wi.z * sign));
                let half = (wo + wi).try_normalize();
                let opposite = rarely!(1e-5, half.is_none());
                if let Some(m) = half
                    && !opposite
                {
                    let (lo, li) = (ggx::lambda(wo, self.alpha), ggx::lambda(wi, self.alpha));
                    let d = ggx::d(m, self.alpha);
                    f += self.reflectance(wo.dot(m), s) * (d * ggx::g2(lo, li) / (4.0 * wo.z * wi.z));
                    pdf += planted!(ndf_pdf(s.reflect * d / (4.0 * wo.z * (1.0 + lo)), wo, m, lo));
                }
            }
        }
        if s.transmit > 0.0
            && let Some(rough) = &self.rough
        {
            let (g, p) = rough.f_and_pdf(wo, wi, transport);
            f += g * ((1.0 - self.metal) * self.transmission);
            pdf += s.transmit * p;
        }
        (f, pdf)
    }

    /// A lobe in proportion to its share of the energy (`u[0]`), then a direction of it.
    #[must_use]
    pub fn sample(&self, wo: Vec3, u: [f32; 3], transport: Transport) -> Option<BsdfSample> {
        if self.has_layers() {
            return self.sample_layers(wo, u, transport);
        }
        self.sample_base(wo, u, transport, &self.shares(wo.z.abs()))
    }

    fn sample_base(&self, wo: Vec3, u: [f32; 3], transport: Transport, s: &Shares) -> Option<BsdfSample> {
        let (choice, u) = (u[0], [u[1], u[2]]);
        let (wi, eta) = if choice < s.diffuse {
            (Diffuse { color: self.base }.sample(wo, u).map(|b| b.wi)?, 1.0)
        } else if choice < s.diffuse + s.reflect {
            if self.is_smooth() {
                let weight = self.reflectance(wo.z.abs(), s) / s.reflect;
                let wi = Vec3::new(-wo.x, -wo.y, wo.z);
                return BsdfSample { wi, weight, pdf: s.reflect, delta: true, eta: 1.0 }.checked();
            }
            let sign = 1.0f32.copysign(wo.z);
            let up = Vec3::new(wo.x, wo.y, wo.z * sign);
            let m = ggx::sample_visible_normal(up, self.alpha, u);
            let wi = crate::math::reflect(up, m);
            if wi.z <= 0.0 {
                // Lost between microfacets. Below the surface it would pass for a transmitted direction,
                // whose density does not count this way to get there.
                return None;
            }
            (Vec3::new(wi.x, wi.y, wi.z * sign), 1.0)
        } else {
            let within =
                ((choice - s.diffuse - s.reflect) / s.transmit).clamp(0.0, crate::math::ONE_MINUS_EPSILON);
            match &self.rough {
                Some(rough) => rough.sample_direction(wo, within, u)?,
                None => {
                    let sample = self.smooth.sample(wo, within, transport)?;
                    let share = (1.0 - self.metal) * self.transmission / s.transmit;
                    let (weight, pdf) = (sample.weight * share, sample.pdf * s.transmit);
                    return BsdfSample { weight, pdf, ..sample }.checked();
                }
            }
        };
        let (f, pdf) = self.evaluate(wo, wi, transport, s);
        BsdfSample { wi, weight: f * (wi.z.abs() / pdf), pdf, delta: false, eta }.checked()
    }
}

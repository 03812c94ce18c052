//! A path on its way: what it carries from vertex to vertex, and what it gathers.
//!
//! In: light that was met, sampled, or brought by photons, with the path's throughput already in it. Out: radiance, its
//! layers, and counters. Which way light came is known here alone: by the number of events, of those with a spread,
//! and by whether the last one had none.

use glam::Vec3;

use super::direct::{Lit, mis_weight};
use super::photon::Gathered;
use crate::accel::PrimitiveId;
use crate::bsdf::BsdfSample;
use crate::color::Rgb;
use crate::film::{Found, LightLayer, light_class};
use crate::light::{LightContext, LightId};
use crate::mutants::planted;
use crate::prepare::{Caustics, Effect, Effects, Kept, Medium, Prepared, Surface, Way};
use crate::shape::{Ray, offset_origin};

/// Scattering events, and surfaces passed, after which a path is cut although nothing asks for it. Only paths that lose
/// nothing at all get here (a camera in a closed box of perfect mirrors); they are counted.
pub(super) const FAR_CAP: u32 = 10_000;

/// What a ray leaves that does not start on a surface.
pub(super) const NOWHERE: [PrimitiveId; 2] = [PrimitiveId::NONE; 2];

/// What a path did, for reports.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counters {
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Paths cut by the far safety cap.
    pub capped: u64,
    /// Photons gathered from maps, by paths that look for caustics.
    pub gathered: u64,
    /// Rays by the [`LightLayer`] of the light that they look for, where layers are recorded: a shadow ray by that
    /// of its light, any other by that of a light at its end.
    pub layer_rays: [u64; LightLayer::ALL.len()],
    /// What of these photons took.
    pub photon_rays: [u64; LightLayer::ALL.len()],
    /// What they found of the light that photons can bring to the camera too: `E D (D|S)* L`.
    pub found: Found,
}

/// The parts of a radiance, by number of their [`LightLayer`].
pub type Layers = [Rgb; LightLayer::ALL.len()];

/// What a sample consists of.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Parts {
    /// By number of their layer.
    pub(super) layers: Layers,
    /// See [`Sample::widening`](crate::film::Sample).
    pub(super) widening: f32,
}

/// Where a direction was sampled, and how probable it was: what the next emitter's weight depends on.
#[derive(Clone, Copy)]
pub(super) struct Sampled {
    pub(super) context: LightContext,
    pub(super) pdf: f32,
    /// Samples of lights that were taken there.
    pub(super) lights: f32,
}

impl Sampled {
    /// The share of an emitter that was met by chance, where a sample of lights finds it with density `light`.
    #[inline(always)]
    pub(super) fn weight(&self, light: f32) -> f32 {
        mis_weight(self.pdf, self.lights * light)
    }
}

/// A surface that a path leaves.
pub(super) struct Vertex<'a> {
    pub(super) surface: &'a Surface,
    pub(super) context: LightContext,
    /// The medium on its other side.
    pub(super) beyond: Medium,
    /// What the next ray leaves.
    pub(super) ids: [PrimitiveId; 2],
    /// Whether its material has none but delta and narrow lobes.
    pub(super) narrow: bool,
    /// Whether photons have brought what else arrives there, if it spreads the path.
    pub(super) ends: bool,
    /// Samples of lights that were taken there.
    pub(super) lights: f32,
}

/// A path on its way.
#[derive(Clone)]
pub(super) struct PathState {
    pub(super) ray: Ray,
    /// The primitives that the ray leaves: that of a surface, and of another that lies on it.
    pub(super) from: [PrimitiveId; 2],
    /// Scattering events so far.
    pub(super) depth: u32,
    /// Surfaces passed that were not there.
    pub(super) passed: u32,
    /// Throughput.
    pub(super) beta: Rgb,
    /// What the path has gathered.
    pub(super) radiance: Rgb,
    /// What that consists of, where it is asked for.
    pub(super) parts: Parts,
    /// Whether its first event had no spread, or a narrow one: the camera looks into a mirror or through glass.
    pub(super) through: bool,
    /// How many of its events had a spread, and not a narrow one.
    pub(super) spread: u32,
    /// Whether the last event had no spread, or a narrow one.
    pub(super) thrown: bool,
    /// Whether photons have brought whatever else arrives where the last event was, but what its next ray meets.
    pub(super) supplied: bool,
    /// Whether it is `E D (S+ D)*` so far, or nothing yet: the form of which photons reach the camera directly.
    pub(super) linked: bool,
    /// Which caustics it leaves to photons.
    pub(super) caustics: Caustics,
    /// The last scattering event where it had a density; `None` after the camera and after delta lobes.
    pub(super) sampled: Option<Sampled>,
    /// What the path is in.
    pub(super) medium: Medium,
    /// Product of eta^2: what refractions have taken from `beta` and will give back; over `share`, so that roulette sees
    /// what has been lost since then.
    pub(super) eta_scale: f32,
    /// How often what wider disks would show counts, of which few paths look: zero for most.
    pub(super) widened: f32,
    /// Whether it goes on in several ways where what it meets first is a mirror or clear glass.
    pub(super) forks: bool,
    /// Which way it is where paths have taken both, one bit for each time, after a leading one.
    pub(super) turns: u32,
    /// What it carried where both ways were taken last, until it meets what spreads light; one elsewhere.
    pub(super) share: f32,
}

impl PathState {
    pub(super) fn new(scene: &Prepared, ray: Ray) -> Self {
        Self {
            ray,
            from: NOWHERE,
            depth: 0,
            passed: 0,
            beta: Rgb::WHITE,
            radiance: Rgb::BLACK,
            sampled: None,
            medium: scene.start,
            eta_scale: 1.0,
            parts: Parts::default(),
            through: false,
            spread: 0,
            thrown: false,
            supplied: false,
            linked: true,
            caustics: scene.plan.caustics,
            widened: 0.0,
            forks: scene.plan.split > 1,
            turns: 1,
            share: 1.0,
        }
    }

    /// Branch of the numbers that the path draws: its own, so that both ways on from a surface are independent.
    #[inline(always)]
    pub(super) fn branch(&self) -> u32 {
        self.turns - 1
    }

    /// Goes on from a vertex in the direction `wi`, world space.
    #[inline(always)]
    pub(super) fn leave(&mut self, fx: Effects, vertex: &Vertex<'_>, wi: Vec3, sample: &BsdfSample) {
        let &Vertex { surface, context, beyond, ids, narrow, ends, lights } = vertex;
        self.beta *= planted!(bsdf_pdf(sample.weight, sample.delta));
        self.eta_scale *= sample.eta * sample.eta;
        if (fx.has(Effect::Absorption) || fx.has(Effect::Nesting)) && context.crosses(wi) {
            self.medium = beyond;
        }
        let thrown = sample.delta || narrow;
        self.linked &= if self.depth == 0 { !thrown } else { thrown || self.thrown };
        self.through |= self.depth == 0 && thrown;
        self.spread += u32::from(!thrown);
        self.thrown = thrown;
        self.supplied = ends && !thrown;
        self.sampled = (!sample.delta).then_some(Sampled { context, pdf: sample.pdf, lights });
        self.ray = Ray::new(offset_origin(surface.p, surface.p_err, surface.ng, wi), wi);
        self.from = ids;
        self.depth += 1;
    }

    /// Whether light that the path meets now is a caustic: its last event had no spread, or a narrow one; an earlier
    /// one had.
    #[inline(always)]
    pub(super) fn meets_caustic(&self) -> bool {
        self.thrown && self.spread > 0
    }

    /// Counts light that the path meets now and of which photons can say how much there is, unless they supply it.
    #[inline(always)]
    pub(super) fn count(&self, scene: &Prepared, found: Rgb, light: LightId, counters: &mut Counters) {
        let caustic = self.meets_caustic();
        if self.depth == 0 || self.through || (caustic && self.caustics.by_photons(self.linked)) {
            return;
        }
        let way = || Way { events: self.depth, spread: self.spread, caustic };
        let found = scene.kept.of(found, way).luminance();
        counters.found.by_class[light_class(scene.apart.number(light), caustic)] += f64::from(found);
    }

    /// Counts the same of light that was sampled at a vertex, on a material that may be `narrow`, and that `found` is
    /// left of, whether it arrived or was blocked.
    #[inline(always)]
    pub(super) fn count_lit(
        &self,
        scene: &Prepared,
        narrow: bool,
        found: Rgb,
        lit: &Lit,
        counters: &mut Counters,
    ) {
        if self.through || (narrow && self.depth == 0) {
            return;
        }
        let way = || self.way_lit(narrow);
        let found = f64::from(scene.kept.of(found, way).luminance());
        let light = scene.apart.number(lit.light);
        if lit.arrives {
            counters.found.by_class[light_class(light, narrow)] += found;
        } else {
            let [sum, squares] = &mut counters.found.blocked[usize::from(light)];
            *sum += found;
            *squares += found * found;
        }
    }

    /// The layer of light that the path meets now.
    #[inline(always)]
    pub(super) fn meets(&self) -> LightLayer {
        match (self.depth, &self.sampled) {
            (0, _) => LightLayer::Emitted,
            _ if self.meets_caustic() => LightLayer::Caustic,
            _ if self.through => LightLayer::Glass,
            (1, _) => LightLayer::Direct,
            _ => LightLayer::Indirect,
        }
    }

    /// The layer of light that is sampled at the vertex where the path is now, on a material that may be `narrow`.
    #[inline(always)]
    pub(super) fn samples(&self, narrow: bool) -> LightLayer {
        match self.depth {
            _ if narrow && self.spread > 0 => LightLayer::Caustic,
            _ if self.through => LightLayer::Glass,
            0 => LightLayer::Direct,
            _ => LightLayer::Indirect,
        }
    }

    /// Adds light that the path met on its way, unless photons supply it.
    #[inline(always)]
    pub(super) fn meet<const LAYERS: bool>(&mut self, found: Rgb, kept: &Kept) {
        if self.meets_caustic() && self.caustics.by_photons(self.linked) {
            return;
        }
        let way = || Way { events: self.depth, spread: self.spread, caustic: self.meets_caustic() };
        let radiance = planted!(clamp(kept.of(found, way)));
        self.radiance += radiance;
        if LAYERS {
            self.parts.layers[self.meets() as usize] += radiance;
        }
    }

    /// The way of light that is sampled at the vertex where the path is now, on a material that may be `narrow`.
    #[inline(always)]
    pub(super) fn way_lit(&self, narrow: bool) -> Way {
        Way {
            events: self.depth + 1,
            spread: self.spread + u32::from(!narrow),
            caustic: narrow && self.spread > 0,
        }
    }

    /// Adds light that was sampled at a vertex that has a spread, on a material that may be `narrow`.
    #[inline(always)]
    pub(super) fn lit<const LAYERS: bool>(&mut self, narrow: bool, found: Rgb, kept: &Kept) {
        let radiance = planted!(clamp(kept.of(found, || self.way_lit(narrow))));
        self.radiance += radiance;
        if LAYERS {
            self.parts.layers[self.samples(narrow) as usize] += radiance;
        }
    }

    /// Adds the light of photons around a vertex that has a spread.
    pub(super) fn gather(&mut self, found: &Gathered, kept: &Kept, counters: &mut Counters) {
        for (class, &found) in found.by_class.iter().enumerate().filter(|(_, f)| !f.is_black()) {
            // At least one event brought it here.
            let caustic = class % 2 == 1;
            let way = || Way { events: self.depth + 2, spread: self.spread + 1, caustic };
            let radiance = kept.of(self.beta * found, way);
            self.radiance += radiance;
            let layer = match self.through {
                _ if caustic => LightLayer::Caustic,
                true => LightLayer::Glass,
                false => LightLayer::Indirect,
            };
            self.parts.layers[layer as usize] += radiance;
            if !self.through {
                counters.found.by_class[class] += f64::from(radiance.luminance());
            }
        }
        let way = || Way { events: self.depth + 2, spread: self.spread + 1, caustic: false };
        self.parts.widening += kept.of(self.beta * found.widening, way).luminance();
    }
}

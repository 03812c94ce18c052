//! The path loop of the reference integrator, and the statistics of its samples.

use std::borrow::Cow;

use glam::DVec3;

use super::albedo::Curves;
use super::detail::Details;
use super::geometry::{Geometry, Hit, Source};
use super::light::Lights;
use super::material::{Surface, Vertex, Way};
use super::medium::transmittance;
use super::nesting::{Nesting, Place};
use super::rng::Rng;
use super::varying::Varying;
use crate::scene::{Scene, Shape};

/// Scattering events after which a path ends where no `max_depth` is given. This is the integrator's
/// only bias: what is cut is at most (largest reflectance)^1000 of the light.
pub const DEPTH_CAP: u32 = 1000;

/// Surfaces in a row that a path or a shadow ray may pass because they are not there.
const PASS_CAP: u32 = 10_000;

/// A ray, as a camera sends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Metres, world space.
    pub origin: DVec3,
    /// Unit, world space.
    pub direction: DVec3,
}

/// A mean over independent samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Radiance, W sr^-1 m^-2, linear Rec. 709.
    pub mean: [f64; 3],
    /// Standard error of `mean`, per channel.
    pub standard_error: [f64; 3],
    /// Samples taken.
    pub samples: u64,
}

/// A scene, ready to be traced.
#[derive(Debug)]
pub struct Tracer {
    geometry: Geometry,
    lights: Lights,
    surfaces: Vec<Surface>,
    details: Details,
    /// For each material that differs from point to point.
    varying: Vec<Option<Varying>>,
    nesting: Nesting,
}

impl Ray {
    /// A ray; the direction is normalised.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction: direction.normalize_or_zero() }
    }
}

impl Tracer {
    /// Flattens a scene into world space and tabulates its materials' albedos.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let mut curves = Curves::default();
        let mut curve = |lobe, alpha| curves.mix(lobe, alpha);
        let mut colored = vec![false; scene.materials.len()];
        for object in &scene.objects {
            if let Shape::Mesh(id) = object.shape {
                colored[object.material.0 as usize] |= !scene.meshes[id.0 as usize].colors.is_empty();
            }
        }
        let nesting = Nesting::new(scene, &colored, &mut curve);
        let varying = scene.materials.iter().zip(colored);
        Self {
            details: Details::new(scene),
            varying: varying.map(|(m, colored)| Varying::new(m, colored, scene)).collect(),
            geometry: Geometry::new(scene),
            lights: Lights::new(scene),
            surfaces: scene.materials.iter().map(|m| Surface::new(&m.kind, &mut curve)).collect(),
            nesting,
        }
    }

    /// What is at a point, world space.
    pub(super) fn place(&self, p: DVec3) -> Place {
        self.nesting.at(p, &self.geometry, &self.surfaces)
    }

    /// Radiance that arrives at the origin of `ray`, a camera ray, against its direction: the mean of
    /// `samples` independent paths, a pure function of the arguments.
    #[must_use]
    pub fn estimate(&self, ray: Ray, max_depth: Option<u32>, samples: u64, seed: u64) -> Estimate {
        let start = self.place(ray.origin);
        let mut moments = Moments::default();
        for sample in 0..samples {
            moments.add(self.radiance(ray, &start, max_depth, &mut Rng::new(seed, 0, sample)));
        }
        let error = moments.variance_of_mean();
        Estimate {
            mean: moments.mean.to_array(),
            standard_error: error.to_array().map(f64::sqrt),
            samples: moments.count,
        }
    }

    /// Radiance of one path, followed from `ray`, which begins in `start`, depth first.
    pub(super) fn radiance(&self, ray: Ray, start: &Place, max_depth: Option<u32>, rng: &mut Rng) -> DVec3 {
        let max_depth = max_depth.unwrap_or(DEPTH_CAP);
        let mut radiance = DVec3::ZERO;
        let mut beta = DVec3::ONE;
        let mut place = start.clone();
        let mut source = Source::default();
        let (mut o, mut d) = (ray.origin, ray.direction);

        for depth in 0..=max_depth {
            // Segments up to a surface that is there: the lights they cross, what lies behind everything.
            let mut passed = 0;
            let (hit, surface, vertex, crossing) = loop {
                let hit = self.geometry.closest(o, d, f64::INFINITY, source, depth == 0);
                let length = hit.map_or(f64::INFINITY, |hit| hit.t);
                radiance += beta * self.lights.along(o, d, length, depth == 0, place.medium);
                let Some(hit) = hit else { return radiance };
                beta *= transmittance(place.medium, length);
                let Some(surface) = self.surfaces.get(hit.material) else { return radiance };
                let crossing = self.nesting.meet(&self.geometry, &hit, d, &place);
                let side = if crossing.as_ref().is_some_and(|c| c.flipped) { -1.0 } else { 1.0 };
                let vertex = Vertex::new(side * hit.ng, side * hit.ns, -d);
                let interface = match &crossing {
                    None => Some((Cow::Borrowed(surface), self.varying[hit.material].as_ref())),
                    Some(crossing) => crossing.interface.and_then(|key| self.nesting.interface(key)),
                };
                if let Some((surface, varying)) = interface {
                    let Some(varying) = varying else { break (hit, surface, vertex, crossing) };
                    let detail = self.details.at(&hit);
                    let coverage = varying.coverage(&detail);
                    if coverage == 1.0 || (coverage > 0.0 && rng.uniform() < coverage) {
                        let mapped = varying.normal(&detail);
                        let mapped = mapped.and_then(|(set, map)| self.details.normal(&hit, set, map));
                        let vertex = mapped.map_or(vertex, |n| vertex.mapped(n));
                        break (hit, Cow::Owned(varying.at(&detail)), vertex, crossing);
                    }
                }
                passed += 1;
                if passed == PASS_CAP {
                    return radiance;
                }
                source = Source::of(&hit, crossing.as_ref());
                if let Some(crossing) = crossing {
                    place = crossing.beyond;
                }
                o = hit.point;
            };
            let beyond = |wi: DVec3| match &crossing {
                Some(crossing) if vertex.way(wi) == Some(Way::Transmitted) => crossing.beyond.clone(),
                Some(_) => place.clone(),
                None => {
                    let medium =
                        surface.medium_beyond(&vertex, wi, place.medium, self.nesting.medium_around(&place));
                    place.with(medium)
                }
            };

            // Emission of the surface.
            radiance += beta * surface.emitted(&vertex);
            if depth == max_depth {
                break;
            }

            // Lights that no direction finds: shadow rays, from surfaces that do more than mirror.
            for light in &self.lights.delta {
                let Some(arrival) = light.arrive(hit.point) else { continue };
                let f = surface.f(&vertex, arrival.wi);
                if f != DVec3::ZERO {
                    let source = Source::of(&hit, crossing.as_ref());
                    let share = self.passes(&hit, source, beyond(arrival.wi), arrival.wi, arrival.distance);
                    let cos = vertex.ns.dot(arrival.wi).abs();
                    radiance += beta * f * cos * share * arrival.irradiance;
                }
            }

            // A direction from the BSDF.
            let Some(next) = surface.sample(&vertex, rng) else { break };
            beta *= next.weight;
            if beta == DVec3::ZERO {
                break;
            }
            place = beyond(next.wi);
            source = Source::of(&hit, crossing.as_ref());
            (o, d) = (hit.point, next.wi);
        }
        radiance
    }

    /// Share of light that comes to a hit along `wi` from `distance` away: what surfaces and media in between
    /// leave. The way begins in `place`.
    fn passes(&self, hit: &Hit, mut source: Source, mut place: Place, wi: DVec3, distance: f64) -> DVec3 {
        let (mut share, mut left) = (DVec3::ONE, distance);
        let mut o = hit.point;
        for _ in 0..PASS_CAP {
            let Some(next) = self.geometry.closest(o, wi, left, source, false) else {
                return share * transmittance(place.medium, left);
            };
            share *= transmittance(place.medium, next.t);
            let crossing = self.nesting.meet(&self.geometry, &next, wi, &place);
            if crossing.as_ref().is_none_or(|c| c.interface.is_some()) {
                let varying = self.varying[next.material].as_ref();
                share *= 1.0 - varying.map_or(1.0, |v| v.coverage(&self.details.at(&next)));
                if share == DVec3::ZERO {
                    return share;
                }
            }
            (o, left) = (next.point, left - next.t);
            source = Source::of(&next, crossing.as_ref());
            if let Some(crossing) = crossing {
                place = crossing.beyond;
            }
        }
        DVec3::ZERO
    }
}

/// Mean and spread of samples (B. P. Welford, Technometrics 4(3), 1962).
#[derive(Clone, Debug, Default)]
pub(super) struct Moments {
    pub(super) count: u64,
    pub(super) mean: DVec3,
    squares: DVec3,
}

impl Moments {
    pub(super) fn add(&mut self, value: DVec3) {
        self.count += 1;
        let before = value - self.mean;
        self.mean += before / self.count as f64;
        self.squares += before * (value - self.mean);
    }

    /// Unbiased variance of the mean; zero below two samples.
    pub(super) fn variance_of_mean(&self) -> DVec3 {
        if self.count < 2 {
            return DVec3::ZERO;
        }
        self.squares / (self.count - 1) as f64 / self.count as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards mean and variance of the mean against their definitions.
    #[test]
    fn moments_match_their_definitions() {
        let values = [1000.0, 1001.0, 999.0, 1004.0];
        let mut moments = Moments::default();
        values.iter().for_each(|v| moments.add(DVec3::splat(*v)));
        assert!((moments.mean.x - 1001.0).abs() < 1e-12);
        assert!((moments.variance_of_mean().x - 14.0 / 3.0 / 4.0).abs() < 1e-12);
    }
}

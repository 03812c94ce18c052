//! Surfaces of the reference integrator: emission, BSDF value, and a sampled direction.
//!
//! Diffuse: rho/pi on both sides. Mirror: a delta lobe of its colour on both sides. Glass: a delta
//! lobe with the exact unpolarised Fresnel reflectance R, and one with (1 - R) tint / eta^2, where
//! eta = n_transmitted / n_incident and the front is outside; 1/eta^2 because radiance is transported.
//! Principled: see [`super::principled`].

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use super::albedo::{Lobe, Mix};
use super::fresnel;
use super::medium::Medium;
use super::principled::Principled;
use super::rgb;
use super::rng::Rng;
use crate::scene::{MaterialKind, Sides};

/// A material, ready to be evaluated.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    emission: DVec3,
    both_sides: bool,
    absorption: Option<Medium>,
    /// Whether transmission leads into or out of a volume.
    encloses: bool,
    bsdf: Bsdf,
}

#[derive(Clone, Debug)]
enum Bsdf {
    Black,
    Diffuse { rho: DVec3 },
    Mirror { color: DVec3 },
    Glass { ior: f64, tint: DVec3 },
    Principled(Box<Principled>),
}

/// The directions at a hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// Geometric normal, unit, on the front side.
    ng: DVec3,
    /// Shading normal, unit, on the same side as `ng` as seen along `wo`.
    pub(super) ns: DVec3,
    /// Unit, to the previous vertex.
    wo: DVec3,
    /// Whether `wo` is on the front side.
    pub(super) front: bool,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scatter {
    /// Unit, to the next vertex.
    pub(super) wi: DVec3,
    /// f cos / pdf.
    pub(super) weight: DVec3,
}

/// Which way light goes at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    Reflected,
    Transmitted,
}

impl Vertex {
    pub(super) fn new(ng: DVec3, ns: DVec3, wo: DVec3) -> Self {
        let ns = if ns.dot(wo) * ng.dot(wo) <= 0.0 { ng } else { ns };
        Self { ng, ns, wo, front: ng.dot(wo) > 0.0 }
    }

    /// The same with the normal of a map, where it faces `wo` as the surface does.
    pub(super) fn mapped(self, n: DVec3) -> Self {
        if n.dot(self.wo) * self.ng.dot(self.wo) > 0.0 { Self { ns: n, ..self } } else { self }
    }

    /// The way from `wi` to `wo`, where both normals agree on it.
    pub(super) fn way(&self, wi: DVec3) -> Option<Way> {
        let geometric = self.ng.dot(wi) * self.ng.dot(self.wo);
        let shading = self.ns.dot(wi) * self.ns.dot(self.wo);
        if geometric > 0.0 && shading > 0.0 {
            Some(Way::Reflected)
        } else if geometric < 0.0 && shading < 0.0 {
            Some(Way::Transmitted)
        } else {
            None
        }
    }

    /// Local axes: z is the shading normal on the side of `wo`.
    fn axes(&self) -> [DVec3; 3] {
        let z = if self.ns.dot(self.wo) < 0.0 { -self.ns } else { self.ns };
        let other = if z.x.abs() < 0.5 { DVec3::X } else { DVec3::Y };
        let x = other.cross(z).normalize();
        [x, z.cross(x), z]
    }

    fn to_local(self, w: DVec3) -> DVec3 {
        let [x, y, z] = self.axes();
        DVec3::new(w.dot(x), w.dot(y), w.dot(z))
    }

    fn to_world(self, w: DVec3) -> DVec3 {
        let [x, y, z] = self.axes();
        w.x * x + w.y * y + w.z * z
    }
}

impl Surface {
    /// `curves` gives the albedo of a lobe at a width.
    pub(super) fn new(kind: &MaterialKind, curves: &mut dyn FnMut(Lobe, f64) -> Mix) -> Self {
        let (emission, sides) = kind.emission().unwrap_or_default();
        let (bsdf, absorption, encloses) = match kind {
            MaterialKind::Diffuse { color } => (Bsdf::Diffuse { rho: rgb(*color) }, None, false),
            MaterialKind::Mirror { color } => (Bsdf::Mirror { color: rgb(*color) }, None, false),
            MaterialKind::Glass(glass) => {
                let bsdf = Bsdf::Glass { ior: f64::from(glass.ior), tint: rgb(glass.tint) };
                (bsdf, glass.absorption, true)
            }
            MaterialKind::Light { .. } => (Bsdf::Black, None, false),
            MaterialKind::Principled(p) => (
                Bsdf::Principled(Box::new(Principled::new(p, curves))),
                p.absorption,
                !p.thin && p.transmission > 0.0,
            ),
        };
        Self {
            emission: rgb(emission),
            both_sides: sides == Sides::Both,
            absorption: absorption.map(Medium::from),
            encloses,
            bsdf,
        }
    }

    /// Radiance emitted to the viewer at `wo`.
    pub(super) fn emitted(&self, vertex: &Vertex) -> DVec3 {
        if !vertex.front && !self.both_sides {
            return DVec3::ZERO;
        }
        match &self.bsdf {
            Bsdf::Principled(p) => self.emission * p.layers.below(vertex.ng.dot(vertex.wo).abs()),
            _ => self.emission,
        }
    }

    /// Whether transmission leads into or out of a volume.
    pub(super) fn encloses(&self) -> bool {
        self.encloses
    }

    /// What the volume absorbs.
    pub(super) fn absorption(&self) -> Option<Medium> {
        self.absorption
    }

    /// The medium of the segment along `wi`, where that before the vertex was `medium`, and `around` is what
    /// the volume lies in.
    pub(super) fn medium_beyond(
        &self,
        vertex: &Vertex,
        wi: DVec3,
        medium: Option<Medium>,
        around: Option<Medium>,
    ) -> Option<Medium> {
        if !self.encloses || vertex.way(wi) != Some(Way::Transmitted) {
            return medium;
        }
        if vertex.front { self.absorption } else { around }
    }

    /// The BSDF's value without its delta lobes, sr^-1, cosine not included.
    pub(super) fn f(&self, vertex: &Vertex, wi: DVec3) -> DVec3 {
        let Some(way) = vertex.way(wi) else { return DVec3::ZERO };
        match &self.bsdf {
            Bsdf::Diffuse { rho } if way == Way::Reflected => *rho * FRAC_1_PI,
            Bsdf::Principled(p) => p.f(vertex.to_local(vertex.wo), vertex.to_local(wi), vertex.front),
            Bsdf::Diffuse { .. } | Bsdf::Black | Bsdf::Mirror { .. } | Bsdf::Glass { .. } => DVec3::ZERO,
        }
    }

    /// A direction for the path to go on in.
    pub(super) fn sample(&self, vertex: &Vertex, rng: &mut Rng) -> Option<Scatter> {
        let wo = vertex.to_local(vertex.wo);
        if wo.z <= 0.0 {
            return None;
        }
        let local = match &self.bsdf {
            Bsdf::Black => None,
            Bsdf::Diffuse { rho } => Some(Scatter { wi: cosine_hemisphere(rng), weight: *rho }),
            Bsdf::Mirror { color } => Some(Scatter { wi: reflect(wo, DVec3::Z), weight: *color }),
            Bsdf::Glass { ior, tint } => {
                let eta = if vertex.front { *ior } else { 1.0 / ior };
                let reflectance = fresnel::exact(wo.z, eta);
                if rng.uniform() < reflectance {
                    Some(Scatter { wi: reflect(wo, DVec3::Z), weight: DVec3::ONE })
                } else {
                    let weight = *tint / (eta * eta);
                    refract(wo, DVec3::Z, eta).map(|wi| Scatter { wi, weight })
                }
            }
            Bsdf::Principled(p) => p.sample(wo, vertex.front, rng),
        }?;
        // The direction must be on the side that the lobe meant, for both normals.
        let meant = if local.wi.z > 0.0 { Way::Reflected } else { Way::Transmitted };
        let wi = vertex.to_world(local.wi);
        (vertex.way(wi) == Some(meant)).then_some(Scatter { wi, weight: local.weight })
    }
}

/// A direction about +z with density cos/pi.
pub(super) fn cosine_hemisphere(rng: &mut Rng) -> DVec3 {
    let u = rng.uniform();
    let phi = 2.0 * PI * rng.uniform();
    let r = u.sqrt();
    DVec3::new(r * libm::cos(phi), r * libm::sin(phi), (1.0 - u).sqrt())
}

/// Mirrors `w` about `n`; both leave the surface.
pub(super) fn reflect(w: DVec3, n: DVec3) -> DVec3 {
    2.0 * w.dot(n) * n - w
}

/// The continuation of `w` (leaving the surface on the side of `n`) through the surface, by Snell's law.
pub(super) fn refract(w: DVec3, n: DVec3, eta: f64) -> Option<DVec3> {
    let cos = w.dot(n);
    let cos_t = fresnel::refracted_cos(cos, eta)?;
    Some(((cos / eta - cos_t) * n - w / eta).normalize())
}

//! How surfaces scatter light.
//!
//! In: two directions in the local frame of a hit (+Z is the shading normal on the front side), and
//! uniform numbers. Out: values, densities and samples. Conventions: `wo` and `wi` are unit and leave
//! the surface; `f` does not contain the cosine; `weight` is f * |cos| / pdf, simplified on paper;
//! densities are per solid angle. A `Some` sample has finite weight and positive density.
//!
//! The set of materials is closed, so it is an enum; each variant is a small struct in its own file.

pub mod dielectric;
mod diffuse;
pub mod fresnel;
pub mod ggx;
mod glass;
pub mod layers;
mod mirror;
mod principled;
pub mod tables;

pub use diffuse::Diffuse;
pub use glass::Glass;
pub use layers::{Charlie, Coat, Sheen};
pub use mirror::Mirror;
pub use principled::{Principled, Specular};

use glam::Vec3;

use crate::color::Rgb;
use crate::rare::rarely;

/// GGX widths below this are treated as perfectly smooth. At 1e-4 the lobe is 0.01 degrees wide, and
/// `f32` half vectors begin to be too coarse for it.
pub const SMOOTH_ALPHA: f32 = 1e-4;

/// What is transported, which decides the factor at refractions (Veach, thesis, section 5.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Radiance, along paths from the camera: refraction scales by 1 / eta^2.
    Radiance,
    /// Importance, along paths from lights: it does not.
    Importance,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The direction, local.
    pub wi: Vec3,
    /// f * |cos| / pdf.
    pub weight: Rgb,
    /// Density per solid angle of all lobes together; for a delta lobe, its probability.
    pub pdf: f32,
    /// True where the direction is the only one that its lobe has.
    pub delta: bool,
    /// eta = n_transmitted / n_incident where the surface was crossed into another medium, else 1.
    pub eta: f32,
}

impl BsdfSample {
    /// `Some` only where weight and density are usable.
    #[inline]
    fn checked(self) -> Option<Self> {
        let unusable = !(self.pdf > 0.0 && self.pdf.is_finite() && self.weight.is_finite());
        // What is dropped here is light that is lost.
        (!rarely!(1e-5, unusable) && !self.weight.is_black()).then_some(self)
    }
}

/// A prepared material. It lies on the stack where it is made for a hit, so nothing in it is boxed.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant)]
pub enum Bsdf {
    /// Absorbs everything.
    Black,
    /// Lambert's reflector.
    Diffuse(Diffuse),
    /// A perfect mirror.
    Mirror(Mirror),
    /// A smooth dielectric.
    Glass(Glass),
    /// Everything else.
    Principled(Principled),
}

/// True where both directions lie strictly on the same side.
#[inline]
#[must_use]
pub fn same_side(a: Vec3, b: Vec3) -> bool {
    a.z * b.z > 0.0
}

impl Bsdf {
    /// True where every lobe is a delta lobe, so that sampling lights is of no use.
    #[inline]
    #[must_use]
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Black | Self::Mirror(_) | Self::Glass(_) => true,
            Self::Diffuse(_) => false,
            Self::Principled(p) => p.is_delta(),
        }
    }

    /// True where light can pass to the other side.
    #[inline]
    #[must_use]
    pub fn transmits(&self) -> bool {
        match self {
            Self::Black | Self::Mirror(_) | Self::Diffuse(_) => false,
            Self::Glass(_) => true,
            Self::Principled(p) => p.transmission > 0.0 && p.metal < 1.0,
        }
    }

    /// What layers on top leave of light that the surface itself emits, where `mu` in [0, 1] is the cosine
    /// at which it leaves; one where there are none.
    #[inline]
    #[must_use]
    pub fn emission_scale(&self, mu: f32) -> f32 {
        match self {
            Self::Principled(p) => p.below_layers(mu),
            Self::Black | Self::Mirror(_) | Self::Glass(_) | Self::Diffuse(_) => 1.0,
        }
    }

    /// BSDF value (sr^-1) and density of everything that is not a delta lobe.
    #[inline]
    #[must_use]
    pub fn f_and_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        match self {
            Self::Black | Self::Mirror(_) | Self::Glass(_) => (Rgb::BLACK, 0.0),
            Self::Diffuse(d) => (d.f(wo, wi), d.pdf(wo, wi)),
            Self::Principled(p) => p.f_and_pdf(wo, wi, transport),
        }
    }

    /// A direction; `u[0]` chooses the lobe.
    #[inline]
    #[must_use]
    pub fn sample(&self, wo: Vec3, u: [f32; 3], transport: Transport) -> Option<BsdfSample> {
        match self {
            Self::Black => None,
            Self::Diffuse(d) => d.sample(wo, [u[1], u[2]]),
            Self::Mirror(m) => m.sample(wo),
            Self::Glass(g) => g.sample(wo, u[0], transport),
            Self::Principled(p) => p.sample(wo, u, transport),
        }
    }
}

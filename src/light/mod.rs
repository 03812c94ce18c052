//! Where light comes from.
//!
//! In: the point that is lit, with everything a density may depend on ([`LightContext`]). Out: a
//! direction towards a light with radiance and density per solid angle, and the density with which
//! that would have been sampled. `sample` and `pdf` receive the same context, so that both sides of
//! multiple importance sampling see the same numbers.
//!
//! Lights with an extent are sampled by solid angle. Radiance does not change along a ray, so what a
//! light emits towards a point is known from where the ray meets it.

mod aim;
mod ellipse;
mod emit;
mod panorama;
mod pick;
mod rectangle;
mod set;
mod sphere;
mod triangle;

pub use aim::{Aim, Shape as TargetShape, Target, ball_around};
pub use ellipse::Ellipse;
pub use emit::{Emission, PhotonLights};
pub use panorama::Panorama;
pub(crate) use pick::MANY_LIGHTS;
pub use rectangle::{Rectangle, from_triangles};
pub use set::{Emitter, FreeHit, LightId, LightSample, LightSet, Spot, SpotCurve};
pub use sphere::SphereLight;
pub use triangle::TriangleLight;

use glam::Vec3;

use crate::accel::PrimitiveId;

/// What a density of light may depend on.
#[derive(Clone, Copy, Debug)]
pub struct LightContext {
    /// The point that is lit, world space.
    pub p: Vec3,
    /// Bound on the error of each of its coordinates.
    pub p_err: Vec3,
    /// The primitive that it lies on.
    pub from: PrimitiveId,
    /// Geometric normal, unit.
    pub ng: Vec3,
    /// Shading normal, unit.
    pub ns: Vec3,
    /// The direction that light is scattered into, unit, leaving the surface.
    pub wo: Vec3,
    /// Whether light from behind the surface counts.
    pub transmits: bool,
}

impl LightContext {
    /// Whether light along `wi` comes from the other side of the surface than `wo`.
    #[inline]
    #[must_use]
    pub fn crosses(&self, wi: Vec3) -> bool {
        wi.dot(self.ng) * self.wo.dot(self.ng) < 0.0
    }
}

/// A point on a light, as seen from a point that is lit.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceSample {
    /// The point, world space.
    pub p: Vec3,
    /// Bound on the error of each of its coordinates.
    pub p_err: Vec3,
    /// Unit normal of the light there.
    pub n: Vec3,
    /// Density per solid angle at the point that is lit, (0, inf).
    pub pdf: f32,
}

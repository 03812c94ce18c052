//! BSDFs in world space, pruned to a kernel's effects.
//!
//! Also the rule for shading normals: a direction counts as reflected or transmitted only where both
//! normals agree about its side, so that no light leaks through a surface.

use glam::Vec3;

use crate::bsdf::{Bsdf, BsdfSample, Transport};
use crate::color::Rgb;
use crate::math;
use crate::prepare::{Effect, Effects, Surface};

/// The frame of a hit, and the outgoing direction in it.
pub(super) struct Frame {
    frame: math::Frame,
    ng: Vec3,
    wo: Vec3,
    /// Sign of the geometric side of `wo`.
    side: f32,
}

impl Frame {
    #[inline(always)]
    pub(super) fn new(surface: &Surface, wo: Vec3) -> Self {
        let frame = math::Frame::from_z(surface.ns);
        Self { frame, ng: surface.ng, wo: frame.to_local(wo), side: wo.dot(surface.ng) }
    }

    #[inline(always)]
    pub(super) fn ns(&self) -> Vec3 {
        self.frame.n
    }

    /// Cosine between the outgoing direction and the shading normal, without its sign.
    #[inline(always)]
    pub(super) fn cos(&self) -> f32 {
        self.wo.z.abs()
    }

    /// Whether both normals see `wi` on the same side relative to `wo`.
    #[inline(always)]
    fn consistent(&self, wi: Vec3, wi_local: Vec3) -> bool {
        let geometric = wi.dot(self.ng) * self.side;
        let shading = wi_local.z * self.wo.z;
        (geometric > 0.0 && shading > 0.0) || (geometric < 0.0 && shading < 0.0)
    }
}

/// BSDF value and density of everything that is not a delta lobe; `None` where both are zero.
#[inline(always)]
pub(super) fn f_and_pdf(
    fx: Effects,
    bsdf: &Bsdf,
    frame: &Frame,
    wi: Vec3,
    transport: Transport,
) -> Option<(Rgb, f32)> {
    let local = frame.frame.to_local(wi);
    if !frame.consistent(wi, local) {
        return None;
    }
    Some(match bsdf {
        Bsdf::Diffuse(d) if fx.has(Effect::Diffuse) => (d.f(frame.wo, local), d.pdf(frame.wo, local)),
        Bsdf::Principled(p) if fx.has(Effect::Glossy) => p.f_and_pdf(frame.wo, local, transport),
        _ => return None,
    })
}

/// A direction in world space.
#[inline(always)]
pub(super) fn sample(
    fx: Effects,
    bsdf: &Bsdf,
    frame: &Frame,
    u: [f32; 3],
    transport: Transport,
) -> Option<(Vec3, BsdfSample)> {
    let sample = match bsdf {
        Bsdf::Diffuse(d) if fx.has(Effect::Diffuse) => d.sample(frame.wo, [u[1], u[2]]),
        Bsdf::Mirror(m) if fx.has(Effect::Mirror) => m.sample(frame.wo),
        Bsdf::Glass(g) if fx.has(Effect::Refraction) => g.sample(frame.wo, u[0], transport),
        Bsdf::Principled(p) if fx.has(Effect::Glossy) => p.sample(frame.wo, u, transport),
        _ => None,
    }?;
    let wi = frame.frame.to_world(sample.wi).normalize();
    frame.consistent(wi, sample.wi).then_some((wi, sample))
}

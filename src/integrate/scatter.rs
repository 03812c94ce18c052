//! BSDFs in world space, pruned to a kernel's effects.
//!
//! Also the rule for shading normals: a direction counts as reflected or transmitted only where both
//! normals agree about its side, so that no light leaks through a surface.

use glam::Vec3;

use crate::bsdf::{Bsdf, BsdfSample, Transport};
use crate::color::Rgb;
use crate::math::{self, ONE_MINUS_EPSILON};
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

/// Both directions of a surface that has two delta lobes and nothing else, each weighted by its share of the energy, so that
/// what they bring adds up; `None` where there are not two.
pub(super) fn lobes(
    fx: Effects,
    bsdf: &Bsdf,
    frame: &Frame,
    transport: Transport,
) -> Option<[(Vec3, BsdfSample); 2]> {
    if !bsdf.transmits() {
        return None;
    }
    let at = |u: f32| sample(fx, bsdf, frame, [u, 0.5, 0.5], transport);
    let (first, last) = (at(0.0)?, at(ONE_MINUS_EPSILON)?);
    let [p, q] = [&first, &last].map(|(_, s)| s.pdf);
    // Lobes share out one number, so that the first and the last are all where their probabilities add up to one.
    let all = p < 1.0 && q < 1.0 && (p + q - 1.0).abs() <= f32::EPSILON;
    let shared = |(wi, s): (Vec3, BsdfSample)| (wi, BsdfSample { weight: s.weight * s.pdf, ..s });
    (all && first.1.delta && last.1.delta).then(|| [first, last].map(shared))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::PrimitiveId;
    use crate::bsdf::fresnel::Fresnel;
    use crate::bsdf::{Diffuse, Glass, Mirror};
    use crate::color::Rgb;

    /// Guards that both lobes of glass share out all light, whichever side it comes from, and that there are not two where
    /// all light is reflected, or where a material has other lobes.
    #[test]
    fn two_lobes_share_all_light() {
        let tint = Rgb::new(1.0, 0.5, 0.25);
        let glass = |thin| Bsdf::Glass(Glass { ior: 1.5, tint, thin, fresnel: Fresnel::Exact });
        let surface = Surface {
            p: Vec3::ZERO,
            p_err: Vec3::ZERO,
            ng: Vec3::Z,
            ns: Vec3::Z,
            id: PrimitiveId::NONE,
            object: 0,
        };
        let all = Effects(u32::MAX);
        let at = |bsdf: &Bsdf, cos: f32| {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            lobes(all, bsdf, &Frame::new(&surface, wo), Transport::Importance)
        };
        for cos in [1.0, 0.8, 0.1, -0.1, -0.75, -1.0] {
            for thin in [false, true] {
                let found = at(&glass(thin), cos);
                let total = !thin && (-0.74..0.0).contains(&cos);
                assert_eq!(found.is_none(), total, "{cos} {thin}");
                let Some([(_, a), (_, b)]) = found else { continue };
                assert!(a.wi.z * b.wi.z < 0.0);
                assert!((a.weight.r + b.weight.r - 1.0).abs() < 1e-6);
                // What is reflected has no tint.
                assert!((a.weight.g + 2.0 * b.weight.g - 1.0).abs() < 1e-6, "{a:?} {b:?}");
            }
        }
        let grey = Rgb::grey(0.5);
        for other in [Bsdf::Mirror(Mirror { color: grey }), Bsdf::Diffuse(Diffuse { color: grey })] {
            assert!(at(&other, 0.8).is_none());
        }
    }
}

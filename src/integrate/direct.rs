//! Next-event estimation.

use super::li::{Counters, interior};
use super::scatter;
use crate::accel::PrimitiveId;
use crate::bsdf::{Bsdf, Transport};
use crate::color::Rgb;
use crate::light::LightContext;
use crate::prepare::{Effect, Effects, Prepared};

/// The share of a sample found with density `own` where the other way would have found it with density
/// `other`: Veach's power heuristic with exponent two, as a ratio, so that no density is squared before
/// it is divided.
#[inline]
#[must_use]
pub(super) fn mis_weight(own: f32, other: f32) -> f32 {
    if other <= own {
        let r = other / own;
        1.0 / (1.0 + r * r)
    } else {
        let r = own / other;
        let r2 = r * r;
        r2 / (1.0 + r2)
    }
}

/// Radiance scattered from one sampled light, unweighted by the throughput; `media` are those on the side
/// of the surface that is seen, and on the other.
#[inline(always)]
pub(super) fn direct_light<const FX: u32>(
    scene: &Prepared,
    bsdf: &Bsdf,
    frame: &scatter::Frame,
    context: &LightContext,
    media: [Option<u32>; 2],
    u: [f32; 4],
    counters: &mut Counters,
) -> Rgb {
    let Some(light) = scene.lights.sample(context, [u[0], u[1], u[2]]) else { return Rgb::BLACK };
    let Some((f, pdf)) = scatter::f_and_pdf::<FX>(bsdf, frame, light.wi, Transport::Radiance) else {
        return Rgb::BLACK;
    };
    let weight = if light.delta { 1.0 } else { mis_weight(light.pdf, pdf) };
    let cos = light.wi.dot(frame.ns()).abs();
    let mut ld = f * light.weight * (cos * weight);
    if const { Effects(FX).has(Effect::Glossy) } && light.target != PrimitiveId::NONE {
        ld *= scene.emission_scale(light.target, light.cos);
    }
    if ld.is_black() {
        return Rgb::BLACK;
    }
    counters.rays += 1;
    if scene.accel.occluded(&light.shadow_ray, [context.from, light.target]) {
        return Rgb::BLACK;
    }
    if const { Effects(FX).has(Effect::Absorption) }
        && let Some(medium) = media[usize::from(context.crosses(light.wi))]
    {
        ld *= interior(scene, medium, light.shadow_ray.t_max);
    }
    ld
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N54: weights of both sides sum to one, at densities whose squares overflow, vanish, or are infinite.
    #[test]
    fn weights_sum_to_one() {
        for a in [1e-30, 1e-3, 0.5, 1.0, 7.0, 1e10, 1e30f32] {
            for b in [1e-30, 1e-3, 0.5, 1.0, 7.0, 1e10, 1e30f32] {
                let sum = mis_weight(a, b) + mis_weight(b, a);
                assert!((sum - 1.0).abs() < 1e-6, "{a} {b} {sum}");
            }
            assert_eq!(mis_weight(a, 0.0), 1.0);
            assert_eq!(mis_weight(a, f32::INFINITY), 0.0);
        }
    }
}

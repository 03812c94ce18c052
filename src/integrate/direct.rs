//! Next-event estimation.

use glam::Vec3;

use super::li::interior;
use super::path::{Counters, FAR_CAP};
use super::scatter;
use crate::accel::{PrimitiveId, RayKind};
use crate::bsdf::{Bsdf, Transport};
use crate::color::Rgb;
use crate::light::{LightContext, LightId};
use crate::mutants::planted;
use crate::prepare::{Detail, Effect, Medium, Prepared};
use crate::shape::{Ray, offset_origin};

/// The share of a sample found with density `own` where the other way would have found it with density
/// `other`: Veach's power heuristic with exponent two, as a ratio, so that no density is squared before
/// it is divided.
#[inline]
#[must_use]
pub(crate) fn mis_weight(own: f32, other: f32) -> f32 {
    if other <= own {
        let r = other / own;
        1.0 / (1.0 + r * r)
    } else {
        let r = own / other;
        let r2 = r * r;
        r2 / (1.0 + r2)
    }
}

/// Light that was sampled.
pub(super) struct Lit {
    /// Radiance that is scattered of it, unweighted by the throughput; what it would be, had nothing been in the way,
    /// where it does not arrive.
    pub(super) radiance: Rgb,
    /// Which light it is from.
    pub(super) light: LightId,
    /// Whether anything arrives.
    pub(super) arrives: bool,
}

/// One of `samples` sampled lights; `None` where nothing of it would be scattered. `media` are those on the side of the
/// surface that is seen, and on the other.
#[inline(always)]
pub(super) fn direct_light<const FX: u32>(
    scene: &Prepared,
    bsdf: &Bsdf,
    frame: &scatter::Frame,
    context: &LightContext,
    media: [Medium; 2],
    u: [f32; 4],
    samples: f32,
    counters: &mut Counters,
) -> Option<Lit> {
    let fx = scene.simulated::<FX>();
    let light = scene.lights.sample(context, [u[0], u[1], u[2]])?;
    let (f, pdf) = scatter::f_and_pdf(fx, bsdf, frame, light.wi, Transport::Radiance)?;
    let weight = if light.delta { 1.0 } else { mis_weight(samples * light.pdf, pdf) };
    let cos = planted!(cosine_dropped(light.wi.dot(frame.ns()).abs()));
    let mut ld = f * light.weight * (cos * weight);
    if (fx.has(Effect::Textures) || fx.has(Effect::Cutouts) || fx.has(Effect::Glossy))
        && light.target != PrimitiveId::NONE
    {
        let ray = &light.shadow_ray;
        ld *= emitted_share(scene, light.target, ray.at(ray.t_max), light.cos);
    }
    if ld.is_black() {
        return None;
    }
    let between = [context.from, light.target];
    let medium = media[usize::from(context.crosses(light.wi))];
    counters.rays += 1;
    if (fx.has(Effect::Cutouts) && scene.has_cutouts()) || (fx.has(Effect::Nesting) && scene.has_nesting()) {
        let left = ld * passed(scene, light.shadow_ray, between, medium, counters);
        let arrives = !left.is_black();
        return Some(Lit { radiance: if arrives { left } else { ld }, light: light.light, arrives });
    }
    if scene.accel.occluded(&light.shadow_ray, between) {
        return Some(Lit { radiance: ld, light: light.light, arrives: false });
    }
    if fx.has(Effect::Absorption)
        && let Some(medium) = medium.absorbs
    {
        ld *= interior(scene, medium, light.shadow_ray.t_max);
    }
    Some(Lit { radiance: ld, light: light.light, arrives: true })
}

/// The factor on light that leaves the point `p` of the surface `id` at a cosine: the texel of its emission
/// there, the share of the surface that is there, and what layers on it leave.
#[inline]
pub(super) fn emitted_share(scene: &Prepared, id: PrimitiveId, p: Vec3, cos: f32) -> Rgb {
    let (material, object) = scene.material_at(id);
    if !material.detailed {
        return Rgb::grey(material.emission_scale(&Detail::NONE, cos));
    }
    let hit = scene.hit_at(id, p);
    let detail = scene.detail(object, &hit);
    let nominal = scene.lights.of_surface(id).map(|id| scene.lights.nominal(id));
    let texel = match (&material.emission, nominal) {
        (Some(glow), Some(nominal)) => glow.share(nominal, &detail.uv),
        _ => Rgb::WHITE,
    };
    let there = material.cutout.as_ref().map_or(1.0, |c| c.coverage(&detail));
    texel * (there * material.emission_scale(&detail, cos))
}

/// The share of light that passes everything that is in the way of a shadow ray, which starts in `medium`.
#[inline(never)]
fn passed(
    scene: &Prepared,
    mut ray: Ray,
    between: [PrimitiveId; 2],
    mut medium: Medium,
    counters: &mut Counters,
) -> Rgb {
    let [mut from, target] = between;
    let mut share = Rgb::WHITE;
    // Absorption acts over a whole stretch of the same medium, so that what is passed on the way does not show.
    let mut length = 0.0;
    let absorbed =
        |medium: Medium, length: f32| medium.absorbs.map_or(Rgb::WHITE, |m| interior(scene, m, length));
    for _ in 0..FAR_CAP {
        let hit = scene.accel.closest_between(&ray, [from, target], RayKind::Other);
        let Some(hit) = hit.filter(|h| h.t < ray.t_max) else {
            return share * absorbed(medium, length + ray.t_max);
        };
        let surface = scene.surface(&ray, &hit, false);
        let met = scene.meet(&surface, ray.d, medium);
        if met.is_none_or(|m| m.interface.is_some()) {
            share *= 1.0 - scene.coverage(&hit);
            if share.is_black() {
                return Rgb::BLACK;
            }
        }
        length += hit.t;
        if let Some(met) = met.filter(|m| m.beyond.absorbs != medium.absorbs) {
            share *= absorbed(medium, length);
            (medium, length) = (met.beyond, 0.0);
        } else if let Some(met) = met {
            medium = met.beyond;
        }
        let o = offset_origin(surface.p, surface.p_err, surface.ng, ray.d);
        ray = Ray { o, t_max: ray.t_max - hit.t, ..ray };
        from = hit.id;
        counters.rays += 1;
    }
    counters.capped += 1;
    Rgb::BLACK
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

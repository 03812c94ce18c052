//! What the camera sees of a photon.

use super::trace::{Landing, spread};
use crate::accel::RayKind;
use crate::color::Rgb;
use crate::integrate::li::{interior, medium_beyond};
use crate::integrate::path::{Counters, FAR_CAP};
use crate::prepare::{Prepared, Way};
use crate::sampling::warp::square_to_disk;
use crate::sampling::{Address, Purpose};
use crate::shape::{Ray, offset_origin};

/// Radiance that a photon adds to a pixel.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrate) struct Splat {
    /// Index of the pixel in the crop.
    pub(in crate::integrate) pixel: u32,
    /// W sr^-1 m^-2.
    pub(in crate::integrate) radiance: Rgb,
    /// Class of the light ([`light_class`](crate::film::light_class)).
    pub(in crate::integrate) class: usize,
}

/// What a photon that landed adds to the picture; `None` where the camera does not see it within the crop.
pub(super) fn splat(
    scene: &Prepared,
    landing: &Landing<'_>,
    address: &Address,
    [left, top, width, height]: [u32; 4],
    counters: &mut Counters,
) -> Option<Splat> {
    let Landing { photon, surface, .. } = landing;
    if scene.accel.is_hidden(surface.id) {
        return None;
    }
    let lens = || {
        let u = address.block(photon.bounces, Purpose::Camera, 0, 0);
        square_to_disk([u[2], u[3]])
    };
    let seen = scene.camera.see(surface.p, lens)?;
    let (x, y) = (seen.pixel[0].wrapping_sub(left), seen.pixel[1].wrapping_sub(top));
    if x >= width || y >= height {
        return None;
    }
    let cos = seen.wo.dot(surface.ng).abs();
    let mut radiance = photon.power * spread(scene, landing, seen.wo)? * (cos * seen.importance);
    if radiance.is_black() {
        return None;
    }
    radiance *= visible(scene, landing, seen.origin, counters);
    if radiance.is_black() {
        return None;
    }
    // Up to the camera light is in what that stands in; where it passes the surface, it arrived in what that encloses.
    if let Some(medium) = scene.start.absorbs {
        radiance *= interior(scene, medium, seen.origin.distance(surface.p));
    }
    let context = surface.lit(seen.wo, true);
    let medium = if context.crosses(photon.wi) {
        medium_beyond(scene, scene.start, landing.index, &context)
    } else {
        scene.start
    };
    if let Some(medium) = medium.absorbs {
        radiance *= interior(scene, medium, photon.inside);
    }
    let way = || Way { events: photon.bounces + 1, spread: 1 + landing.spread, caustic: photon.is_caustic() };
    let radiance = scene.kept.of(radiance, way);
    Some(Splat { pixel: y * width + x, radiance, class: usize::from(photon.class) })
}

/// The share of light from a photon that reaches the camera at `eye`.
fn visible(scene: &Prepared, landing: &Landing<'_>, eye: glam::Vec3, counters: &mut Counters) -> f32 {
    let surface = &landing.surface;
    let aim = |p, p_err, ng| -> Option<Ray> {
        let o = offset_origin(p, p_err, ng, eye - p);
        let d = eye - o;
        Some(Ray { o, d: d.try_normalize()?, t_max: d.length() })
    };
    let Some(mut ray) = aim(surface.p, surface.p_err, surface.ng) else { return 0.0 };
    let mut from = surface.id;
    let mut share = 1.0;
    for _ in 0..FAR_CAP {
        counters.rays += 1;
        let hit = scene.accel.closest(&ray, from, RayKind::Camera).filter(|h| h.t < ray.t_max);
        let Some(hit) = hit else { return share };
        share *= 1.0 - scene.coverage(&hit);
        if share <= 0.0 {
            return 0.0;
        }
        let s = scene.surface(&ray, &hit, false);
        let Some(next) = aim(s.p, s.p_err, s.ng) else { return share };
        ray = next;
        from = hit.id;
    }
    counters.capped += 1;
    0.0
}

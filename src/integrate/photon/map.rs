//! The photons of a pass, and the light of those around a point.
//!
//! A balanced k-d tree that is stored as the order of its photons: the middle one of a range splits it. Which
//! photon that is follows from coordinates and indices alone, and the photons around a point are visited in the
//! order of the tree, so that the sums of light are the same on every machine.

use glam::Vec3;

use super::trace::{Photon, cosine_ratio};
use crate::bsdf::{Bsdf, Transport};
use crate::color::Rgb;
use crate::film::LIGHT_CLASSES;
use crate::integrate::li::interior;
use crate::integrate::path::Counters;
use crate::integrate::scatter;
use crate::light::LightContext;
use crate::math::INV_PI;
use crate::prepare::{Effect, Medium, Prepared};

/// Photons in a leaf, at most.
const LEAF: usize = 8;

/// Radius of the disk that photons are gathered from in the first pass, in pixels at the distance of the point,
/// where the point is seen in mirrors and through glass only.
const RADIUS: f32 = 1.5;

/// The same where light has been spread on the way: what is then seen of the caustic is blurred anyway.
const RADIUS_SPREAD: f32 = 3.0;

/// No radius in the first pass is larger than this share of the smallest thing that throws light, whose size
/// is that of the caustic's features, but for [`RADIUS_LEAST`] pixels.
const RADIUS_OF_TARGET: f32 = 0.2;

/// Least radius in the first pass, in pixels.
const RADIUS_LEAST: f32 = 0.5;

/// The alpha of the sequence of radii: squared error falls fastest for 2/3 (Kaplanyan and Dachsbacher, TOG 2013).
const ALPHA: f64 = 2.0 / 3.0;

/// Cosine between the normals of a photon and of a point above which they are taken for one surface.
const SAME_SURFACE: f32 = 0.9;

/// Photons in an order that makes them a tree.
pub(in crate::integrate) struct PhotonMap {
    photons: Vec<Photon>,
    /// Where each is, once more: what the search reads lies close together.
    places: Vec<Vec3>,
    /// Axis along which each photon splits its range.
    axes: Vec<u8>,
    scale: Scale,
    /// Radius in the first pass, metres, where it is the same everywhere.
    fixed: Option<f32>,
}

/// Where photons are gathered.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrate) struct Place {
    /// Events that the path to the point had.
    pub(in crate::integrate) depth: u32,
    /// Whether one of them had a spread.
    pub(in crate::integrate) spread: bool,
    /// Whether photons count whose way is S+ (D S+)*.
    pub(in crate::integrate) linked: bool,
    /// How often a disk of twice the radius counts; zero where none is looked at.
    pub(in crate::integrate) widened: f32,
}

/// What radii follow from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Factor in this pass.
    pub(super) factor: f32,
    /// Width of a pixel, in those of the picture.
    pub(super) pixel: f32,
    /// The least distance from the camera that they are proportional to, metres.
    pub(super) nearest: f32,
    /// Radius of the smallest thing that throws light, metres.
    pub(super) smallest: f32,
}

/// The factor on the radius in a pass, counted from zero: sqrt(prod (j + a) / (j + 1)) over j = 1 .. pass.
pub(super) fn radius_scale(pass: u32) -> f32 {
    (1..=pass).map(shrink).product::<f64>().sqrt() as f32
}

/// The factor from the square of the radius in the pass before to that in pass j, from one on.
pub(super) fn shrink(j: u32) -> f64 {
    (f64::from(j) + ALPHA) / (f64::from(j) + 1.0)
}

impl PhotonMap {
    /// Where `fixed` is not given, the radius follows from the pixel.
    pub(super) fn new(photons: Vec<Photon>, scale: Scale, fixed: Option<f32>) -> Self {
        let mut order: Vec<(Vec3, u32)> = photons.iter().zip(0..).map(|(p, i)| (p.p, i)).collect();
        let mut axes = vec![0; order.len()];
        split(&mut order, &mut axes);
        let (places, photons) = order.into_iter().map(|(p, i)| (p, photons[i as usize])).unzip();
        Self { photons, places, axes, scale, fixed }
    }

    /// The radius of the disk around `p`; `spread` says whether light has been spread on its way from there.
    fn radius(&self, scene: &Prepared, p: Vec3, spread: bool) -> f32 {
        let Scale { factor, pixel, nearest, smallest } = self.scale;
        if let Some(radius) = self.fixed {
            return radius * factor;
        }
        let pixel = pixel * scene.camera.footprint(p, nearest);
        let width = if spread { RADIUS_SPREAD } else { RADIUS };
        (width * pixel).min(RADIUS_OF_TARGET * smallest).max(RADIUS_LEAST * pixel) * factor
    }

    /// Calls `found` for each photon whose distance from `p` is at most `r`, with the square of that.
    #[inline]
    fn within(&self, p: Vec3, r: f32, found: &mut impl FnMut(&Photon, f32)) {
        let mut stack = [(0u32, 0u32); 64];
        stack[0] = (0, self.photons.len() as u32);
        let mut depth = 1;
        let r2 = r * r;
        while depth > 0 {
            depth -= 1;
            let (mut low, mut high) = stack[depth];
            while high as usize - low as usize > LEAF {
                let middle = low + (high - low) / 2;
                let at = self.places[middle as usize];
                let axis = usize::from(self.axes[middle as usize]);
                let d = p[axis] - at[axis];
                let d2 = at.distance_squared(p);
                if d2 <= r2 {
                    found(&self.photons[middle as usize], d2);
                }
                let (left, right) = ((low, middle), (middle + 1, high));
                let (near, far) = if d <= 0.0 { (left, right) } else { (right, left) };
                if d * d <= r2 {
                    stack[depth] = far;
                    depth += 1;
                }
                (low, high) = near;
            }
            for i in low as usize..high as usize {
                let d2 = self.places[i].distance_squared(p);
                if d2 <= r2 {
                    found(&self.photons[i], d2);
                }
            }
        }
    }
}

/// Sorts a range into a tree, ranges of at most [`LEAF`] by index.
fn split(order: &mut [(Vec3, u32)], axes: &mut [u8]) {
    if order.len() <= LEAF {
        order.sort_unstable_by_key(|&(_, i)| i);
        return;
    }
    let lo = order.iter().fold(Vec3::INFINITY, |m, (p, _)| m.min(*p));
    let hi = order.iter().fold(Vec3::NEG_INFINITY, |m, (p, _)| m.max(*p));
    let axis = (hi - lo).max_position();
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    axes[middle] = axis as u8;
    let ((left, right), (left_axes, right_axes)) = (order.split_at_mut(middle), axes.split_at_mut(middle));
    split(left, left_axes);
    split(&mut right[1..], &mut right_axes[1..]);
}

/// Radiance that a surface makes of the photons around a point of it.
pub(in crate::integrate) struct Gathered {
    /// By the class of light that they bring.
    pub(in crate::integrate) by_class: [Rgb; LIGHT_CLASSES],
    /// What a disk of twice the radius shows, less all of it, as often as that counts: noise and bias of either sign.
    pub(in crate::integrate) widening: Rgb,
}

/// Gathers the photons around a point: their power, weighed by Epanechnikov's kernel over the disk. `media` are those on the side of the surface that is seen,
/// and on the other.
#[inline(never)]
pub(in crate::integrate) fn gathered(
    scene: &Prepared,
    map: &PhotonMap,
    bsdf: &Bsdf,
    frame: &scatter::Frame,
    context: &LightContext,
    media: [Medium; 2],
    place: Place,
    counters: &mut Counters,
) -> Gathered {
    let r = map.radius(scene, context.p, place.spread);
    let inv_r2 = 1.0 / (r * r);
    // Events that a photon may have had, so that the whole path keeps the cap.
    let most = scene.max_depth.map_or(u32::MAX, |cap| cap.saturating_sub(place.depth + 1));
    let (mut sums, mut widening) = ([Rgb::BLACK; LIGHT_CLASSES], Rgb::BLACK);
    let wider = place.widened > 0.0;
    map.within(context.p, if wider { 2.0 * r } else { r }, &mut |photon, d2| {
        counters.gathered += 1;
        if photon.ng.dot(context.ng) < SAME_SURFACE
            || photon.bounces > most
            || (photon.linked && !place.linked)
        {
            return;
        }
        let value = scatter::f_and_pdf(scene.simulates, bsdf, frame, photon.wi, Transport::Radiance);
        let Some((f, _)) = value else { return };
        let mut light = f * photon.power * cosine_ratio(photon, frame.ns());
        if scene.simulates.has(Effect::Absorption)
            && let Some(medium) = media[usize::from(context.crosses(photon.wi))].absorbs
        {
            light *= interior(scene, medium, photon.inside);
        }
        let x = d2 * inv_r2;
        let own = 1.0 - x;
        if own >= 0.0 {
            sums[usize::from(photon.class)] += light * own;
        }
        if wider {
            widening += light * (0.25 * (1.0 - 0.25 * x) - own.max(0.0));
        }
    });
    let scale = 2.0 * INV_PI * inv_r2;
    Gathered { by_class: sums.map(|sum| sum * scale), widening: widening * (scale * place.widened) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mix64;

    fn photons(n: u64) -> Vec<Photon> {
        let unit = |i: u64| (mix64(i + 1) >> 40) as f32 / 16_777_216.0;
        let at = |i| {
            // Clustered, and with many equal coordinates.
            let [x, y, z] = [0, 1, 2].map(|k| unit(3 * i + k));
            Vec3::new(x * x, (8.0 * y).floor() / 8.0, if i % 3 == 0 { 0.5 } else { z })
        };
        let photon = |i| Photon {
            p: at(i),
            wi: Vec3::Y,
            ng: Vec3::Y,
            power: Rgb::grey(i as f32),
            inside: 0.0,
            bounces: 1,
            class: 1,
            linked: true,
        };
        (0..n).map(photon).collect()
    }

    /// Guards the tree against trying every photon.
    #[test]
    fn the_tree_finds_what_is_there() {
        for n in [0, 1, 8, 9, 17, 1000, 4097] {
            let all = photons(n);
            let scale = Scale { factor: 1.0, pixel: 1.0, nearest: 1.0, smallest: 1.0 };
            let map = PhotonMap::new(all.clone(), scale, None);
            for (i, r) in [(3u64, 0.05f32), (10, 0.3), (77, 0.0), (5, 2.0)] {
                let p = photons(i + 1)[i as usize].p;
                let mut found = Vec::new();
                map.within(p, r, &mut |photon, _| found.push(photon.power.r as u32));
                found.sort_unstable();
                let near = |q: &&Photon| q.p.distance_squared(p) <= r * r;
                let expected: Vec<u32> = all.iter().filter(near).map(|q| q.power.r as u32).collect();
                assert_eq!(found, expected, "{n} {r}");
            }
        }
    }

    /// Guards the closed form: squared radii fall as p^(a - 1).
    #[test]
    fn radii_shrink() {
        assert_eq!(radius_scale(0), 1.0);
        assert!((radius_scale(1) - (5.0f32 / 6.0).sqrt()).abs() < 1e-6);
        let ratio = crate::math::sqr(radius_scale(8000) / radius_scale(1000));
        assert!((ratio - 0.5).abs() < 1e-3, "{ratio}");
    }
}

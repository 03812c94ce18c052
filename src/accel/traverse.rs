//! Walking the trees: one generic body, instantiated by `simd` for each instruction set.
//!
//! Only box tests may be inexact, and they err on the side of entering: boxes are padded, near planes
//! are moved nearer and far planes farther by more than their rounding (Ize, JCGT 2(2), 2013). The
//! triangle test is `shape::triangle`'s, eight lanes at a time; a lane it does not rule out is decided
//! by the scalar test itself.

use glam::Vec3;

use super::build;
use super::packet::Packet;
use super::tree::{LEAF_BIT, Node, Tree};
use super::{Accel, Hit, PrimitiveId};
use crate::shape::triangle::Shear;
use crate::shape::{Ray, sphere};

/// A node pushes at most seven entries more than it pops.
const STACK: usize = 7 * build::MAX_DEPTH as usize + 1;

/// Slack of box distances, relative: more than three roundings on either side.
const SLACK: f32 = 4.0 * f32::EPSILON;

struct Boxes {
    o: [f32; 3],
    inv: [f32; 3],
    near: [usize; 3],
}

impl Boxes {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        // A direction component of zero must not make 0 * inf = NaN of a plane through the origin.
        const SMALLEST: f32 = 1e-37;
        let d = ray.d.to_array();
        let inv = d.map(|d| 1.0 / if d.abs() < SMALLEST { SMALLEST.copysign(d) } else { d });
        let near = std::array::from_fn(|a| if inv[a] < 0.0 { a + 3 } else { a });
        Self { o: ray.o.to_array(), inv, near }
    }

    /// Distances at which the eight boxes are entered, and a mask of those entered before `t_max`.
    #[inline(always)]
    fn enter(&self, node: &Node, t_max: f32) -> ([f32; 8], u32) {
        let mut near = [0.0f32; 8];
        let mut far = [t_max; 8];
        for axis in 0..3 {
            let lo = &node.planes[self.near[axis]];
            let hi = &node.planes[(self.near[axis] + 3) % 6];
            let (o, inv) = (self.o[axis], self.inv[axis]);
            for lane in 0..8 {
                let a = (lo[lane] - o) * inv * (1.0 - SLACK);
                let b = (hi[lane] - o) * inv * (1.0 + SLACK);
                near[lane] = if a > near[lane] { a } else { near[lane] };
                far[lane] = if b < far[lane] { b } else { far[lane] };
            }
        }
        let mut mask = 0;
        for lane in 0..8 {
            mask |= u32::from(near[lane] <= far[lane]) << lane;
        }
        (near, mask)
    }
}

/// A mask of the packet's lanes that the sheared ray may meet.
#[inline(always)]
fn candidates(shear: &Shear, packet: &Packet) -> u32 {
    let [x, y, z] = shear.axes;
    let [sx, sy, _] = shear.s;
    let (ox, oy, oz) = (shear.o[x], shear.o[y], shear.o[z]);
    let mut p = [[[0.0f32; 8]; 2]; 3];
    for k in 0..3 {
        let v = &packet.v[k];
        for lane in 0..8 {
            let az = v[z][lane] - oz;
            p[k][0][lane] = v[x][lane] - ox - sx * az;
            p[k][1][lane] = v[y][lane] - oy - sy * az;
        }
    }
    let [a, b, c] = &p;
    let mut mask = 0;
    for lane in 0..8 {
        let u = c[0][lane] * b[1][lane] - c[1][lane] * b[0][lane];
        let v = a[0][lane] * c[1][lane] - a[1][lane] * c[0][lane];
        let w = b[0][lane] * a[1][lane] - b[1][lane] * a[0][lane];
        let inside = ((u >= 0.0) & (v >= 0.0) & (w >= 0.0)) | ((u <= 0.0) & (v <= 0.0) & (w <= 0.0));
        mask |= u32::from(inside) << lane;
    }
    mask
}

/// Visits the leaves of `tree` that `boxes` enters, nearest first, until `visit` returns true.
#[inline(always)]
fn walk(tree: &Tree, boxes: &Boxes, t_max: &mut f32, mut visit: impl FnMut(usize, &mut f32) -> bool) -> bool {
    if tree.nodes.is_empty() {
        return false;
    }
    let mut stack = [(0.0f32, 0u32); STACK];
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let (near, child) = stack[top];
        if near > *t_max {
            continue;
        }
        if child & LEAF_BIT != 0 {
            if visit((child & !LEAF_BIT) as usize, t_max) {
                return true;
            }
            continue;
        }
        let node = &tree.nodes[child as usize];
        let (near, mut mask) = boxes.enter(node, *t_max);
        let first = top;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 7;
            mask &= mask - 1;
            let entry = (near[lane], node.child[lane]);
            // Insertion keeps the nearest on top.
            let mut at = top;
            while at > first && stack[at - 1].0 < entry.0 {
                stack[at] = stack[at - 1];
                at -= 1;
            }
            stack[at] = entry;
            top += 1;
        }
    }
    false
}

/// What both queries need to know of a ray.
struct Query<'a> {
    ray: &'a Ray,
    skip: [PrimitiveId; 2],
    camera: bool,
}

/// Offers every hit of `tree` nearer than `t_max` to `accept`, which may shorten it.
#[inline(always)]
fn hits_in(
    tree: &Tree,
    instance: u32,
    query: &Query<'_>,
    t_max: &mut f32,
    accept: &mut impl FnMut(Hit, &mut f32) -> bool,
) -> bool {
    let boxes = Boxes::new(query.ray);
    let shear = Shear::new(query.ray);
    let skip = query.skip.map(|s| if s.instance == instance { s.primitive } else { u32::MAX });
    let hidden = |primitive: u32| {
        query.camera && tree.geometry.hidden.get(primitive as usize).copied().unwrap_or(false)
    };
    walk(tree, &boxes, t_max, |leaf, t_max| {
        let leaf = tree.leaves[leaf];
        for packet in &tree.packets[leaf.packets[0] as usize..leaf.packets[1] as usize] {
            let mut mask = candidates(&shear, packet);
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                let primitive = packet.id[lane];
                let vertex =
                    |k: usize| Vec3::new(packet.v[k][0][lane], packet.v[k][1][lane], packet.v[k][2][lane]);
                let Some(h) = shear.intersect(vertex(0), vertex(1), vertex(2)) else { continue };
                if h.t > *t_max || primitive == skip[0] || primitive == skip[1] || hidden(primitive) {
                    continue;
                }
                let hit = Hit { t: h.t, id: PrimitiveId { instance, primitive }, b: [h.b1, h.b2] };
                if accept(hit, t_max) {
                    return true;
                }
            }
        }
        for &primitive in &tree.others[leaf.others[0] as usize..leaf.others[1] as usize] {
            let (center, radius) = tree.geometry.spheres[(primitive - tree.triangle_count) as usize];
            if primitive == skip[1] || hidden(primitive) {
                continue;
            }
            let Some(t) = sphere::first_hit(query.ray, center, radius, primitive == skip[0]) else {
                continue;
            };
            if t > *t_max {
                continue;
            }
            if accept(Hit { t, id: PrimitiveId { instance, primitive }, b: [0.0; 2] }, t_max) {
                return true;
            }
        }
        false
    })
}

/// All hits of the world and of every instance, through `accept`.
#[inline(always)]
fn hits(
    accel: &Accel,
    query: &Query<'_>,
    t_max: &mut f32,
    accept: &mut impl FnMut(Hit, &mut f32) -> bool,
) -> bool {
    if hits_in(&accel.spaces[0], 0, query, t_max, accept) {
        return true;
    }
    let Some(top) = &accel.top else { return false };
    walk(top, &Boxes::new(query.ray), t_max, |leaf, t_max| {
        let leaf = top.leaves[leaf];
        for &i in &top.others[leaf.others[0] as usize..leaf.others[1] as usize] {
            let instance = &accel.instances[i as usize];
            if query.camera && instance.hidden {
                continue;
            }
            // The direction is not made unit again, so that t means the same in both spaces.
            let local = Ray {
                o: instance.linear * query.ray.o + instance.translation,
                d: instance.linear * query.ray.d,
                t_max: *t_max,
            };
            let query = Query { ray: &local, skip: query.skip, camera: false };
            if hits_in(&accel.spaces[instance.mesh as usize], i + 1, &query, t_max, accept) {
                return true;
            }
        }
        false
    })
}

#[inline(always)]
pub(super) fn closest(accel: &Accel, ray: &Ray, from: PrimitiveId, camera: bool) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    let mut t_max = ray.t_max;
    let query = Query { ray, skip: [from, PrimitiveId::NONE], camera };
    hits(accel, &query, &mut t_max, &mut |hit, t_max| {
        if best.is_none_or(|b| (hit.t, hit.id) < (b.t, b.id)) {
            best = Some(hit);
            *t_max = hit.t;
        }
        false
    });
    best
}

#[inline(always)]
pub(super) fn occluded(accel: &Accel, ray: &Ray, between: [PrimitiveId; 2]) -> bool {
    let mut t_max = ray.t_max;
    let query = Query { ray, skip: between, camera: false };
    hits(accel, &query, &mut t_max, &mut |hit, _| hit.t < ray.t_max)
}

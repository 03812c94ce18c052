//! Walking the trees: one generic body, instantiated by `simd` for each instruction set.
//!
//! Only box tests and the first look at triangles may be inexact, and they err on the side of entering: boxes
//! are padded, near planes are moved nearer and far planes farther by more than rounding (Ize, JCGT 2(2), 2013),
//! and a triangle is ruled out for eight lanes at a time only where the error of its edge functions cannot
//! matter. What is left is decided one by one by `shape::triangle`, in double precision.

use std::marker::PhantomData;

use super::lanes::{F8, Lanes};
use super::packet::Packet;
use super::tree::{LEAF_BIT, Leaf, Node, Tree};
use super::{Accel, Hit, PrimitiveId};
use crate::shape::triangle::{Shear, TriangleHit};
use crate::shape::{Ray, sphere};

/// Slack of box distances, relative. It makes sure that a hit lies in the box of its triangle, so that no box
/// hides a hit that is nearer than the best.
///
/// With u = EPSILON / 2, a ray that meets the projected triangle exactly passes within 4 u |x - o| of its point in
/// each axis, by the rounding of x - o, of z - o, of the shear and of their product, and another u times the size of
/// the triangle by the last difference; the distance itself has 2 u (the scale of z, the last rounding). Planes add
/// 4 u (difference, product, reciprocal and its slack). That is 10 u of the distance, and 12 are taken; where the
/// box straddles the origin of the ray, |x - o| is at most the size of the triangle, and what is relative to that
/// is in the padding (`Aabb::padded`).
const SLACK: f32 = 6.0 * f32::EPSILON;

/// Bound on the error of an edge function of `f32`s, relative to the product of the largest projected x and y: two
/// products, each at most that, and their difference round by 4 u, and as much again is for the bound's own rounding.
const EDGE_ERROR: f32 = 4.0 * f32::EPSILON;

struct Boxes {
    o: [f32; 3],
    inv: [f32; 3],
    near: [usize; 3],
    far: [usize; 3],
}

impl Boxes {
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        // A direction component of zero must not make 0 * inf = NaN of a plane through the origin.
        const SMALLEST: f32 = 1e-37;
        let d = ray.d.to_array();
        let inv = d.map(|d| 1.0 / if d.abs() < SMALLEST { SMALLEST.copysign(d) } else { d });
        let [near, far] =
            [false, true].map(|far| [0, 1, 2].map(|a| if (inv[a] < 0.0) != far { a + 3 } else { a }));
        Self { o: ray.o.to_array(), inv, near, far }
    }

    /// Distances at which the eight boxes are entered, and a mask of those entered before `t_max`.
    #[inline(always)]
    fn enter<L: Lanes>(&self, node: &Node, t_max: f32) -> (F8, u32) {
        let (mut near, mut far) = (L::splat(0.0), L::splat(t_max));
        for axis in 0..3 {
            let (o, inv) = (L::splat(self.o[axis]), self.inv[axis]);
            let (lo, hi) = (L::load(&node.planes[self.near[axis]]), L::load(&node.planes[self.far[axis]]));
            near = lo.sub(o).mul(L::splat(inv * (1.0 - SLACK))).max(near);
            far = hi.sub(o).mul(L::splat(inv * (1.0 + SLACK))).min(far);
        }
        (near.store(), near.le(far))
    }
}

/// The packet's triangles as the sheared ray sees them.
struct Seen {
    /// x, y and z of each vertex, by lane.
    p: [[F8; 3]; 3],
    /// Lanes that the ray may meet.
    mask: u32,
}

/// Projects a packet; `None` where the ray meets none of its triangles.
#[inline(always)]
fn see<L: Lanes>(shear: &Shear, packet: &Packet, t_max: f32) -> Option<Seen> {
    let axes = shear.axes;
    let s = [L::splat(shear.s[0]), L::splat(shear.s[1])];
    let o = [L::splat(shear.o[axes[0]]), L::splat(shear.o[axes[1]]), L::splat(shear.o[axes[2]])];
    let a = project(&packet.v[0], axes, o, s);
    let b = project(&packet.v[1], axes, o, s);
    let c = project(&packet.v[2], axes, o, s);
    let u = c[0].mul(b[1]).sub(c[1].mul(b[0]));
    let v = a[0].mul(c[1]).sub(a[1].mul(c[0]));
    let w = b[0].mul(a[1]).sub(b[1].mul(a[0]));
    let x = a[0].abs().max(b[0].abs()).max(c[0].abs());
    let y = a[1].abs().max(b[1].abs()).max(c[1].abs());
    // The smallest normal number is for products that underflow.
    let error = x.mul(L::splat(EDGE_ERROR)).mul(y).add(L::splat(f32::MIN_POSITIVE));
    let mask = L::signs_may_agree(u, v, w, error) & packet.used;
    if mask == 0 {
        return None;
    }
    // The hit is not nearer than the nearest vertex and not beyond the farthest; the slack covers the rounding of
    // the mean.
    let scale = L::splat(shear.s[2]);
    let (ta, tb, tc) = (a[2].mul(scale), b[2].mul(scale), c[2].mul(scale));
    let (near, far) = (ta.min(tb).min(tc), ta.max(tb).max(tc));
    let mask = mask & near.le(L::splat(t_max * (1.0 + SLACK))) & L::splat(0.0).le(far);
    if mask == 0 {
        return None;
    }
    Some(Seen { p: [store(a), store(b), store(c)], mask })
}

/// Vertices relative to the origin, permuted and sheared, as `Shear` does it with one.
#[inline(always)]
fn project<L: Lanes>(v: &[F8; 3], [x, y, z]: [usize; 3], o: [L; 3], s: [L; 2]) -> [L; 3] {
    let az = L::load(&v[z]).sub(o[2]);
    [L::load(&v[x]).sub(o[0]).sub(s[0].mul(az)), L::load(&v[y]).sub(o[1]).sub(s[1].mul(az)), az]
}

#[inline(always)]
fn store<L: Lanes>(v: [L; 3]) -> [F8; 3] {
    [v[0].store(), v[1].store(), v[2].store()]
}

impl Seen {
    /// Decides one lane.
    #[inline(always)]
    fn hit(&self, shear: &Shear, lane: usize) -> Option<TriangleHit> {
        let vertex = |v: &[F8; 3]| [v[0].0[lane], v[1].0[lane], v[2].0[lane]];
        shear.decide([vertex(&self.p[0]), vertex(&self.p[1]), vertex(&self.p[2])])
    }
}

/// What happens to the leaves that a ray enters. Traits instead of closures, because a closure would be
/// compiled for the portable instructions.
trait Visit {
    /// Visits a leaf; may shorten `t_max`; true ends the walk.
    fn leaf(&mut self, leaf: Leaf, t_max: &mut f32) -> bool;
}

/// What happens to hits nearer than the best so far; true ends the query.
trait Accept {
    fn accept(&mut self, hit: Hit, t_max: &mut f32) -> bool;
}

/// Nodes still to visit, nearest on top. Clearing an array that fits the deepest tree would cost more than
/// a typical walk, so the array is short and what does not fit spills to the heap.
struct Stack {
    entries: [(f32, u32); SHORT],
    top: usize,
    spilled: Vec<(f32, u32)>,
}

/// Entries of the short stack.
const SHORT: usize = 32;

impl Stack {
    #[inline(always)]
    fn new(root: u32) -> Self {
        let mut entries = [(0.0, 0); SHORT];
        entries[0].1 = root;
        Self { entries, top: 1, spilled: Vec::new() }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(f32, u32)> {
        if self.top == 0 {
            return None;
        }
        if self.top == SHORT
            && let Some(entry) = self.spilled.pop()
        {
            return Some(entry);
        }
        self.top -= 1;
        Some(self.entries[self.top])
    }

    /// Pushes below everything nearer that was pushed since the stack was `first` high.
    #[inline(always)]
    fn push(&mut self, entry: (f32, u32), first: usize) {
        if self.top == SHORT {
            self.spill(entry);
            return;
        }
        let mut at = self.top;
        while at > first && self.entries[at - 1].0 < entry.0 {
            self.entries[at] = self.entries[at - 1];
            at -= 1;
        }
        self.entries[at] = entry;
        self.top += 1;
    }

    #[cold]
    #[inline(never)]
    fn spill(&mut self, entry: (f32, u32)) {
        self.spilled.push(entry);
    }
}

/// Visits the leaves of `tree` that `boxes` enters, nearest first.
#[inline(always)]
fn walk<L: Lanes>(tree: &Tree, boxes: &Boxes, t_max: &mut f32, visit: &mut impl Visit) -> bool {
    if tree.nodes.is_empty() {
        return false;
    }
    let mut stack = Stack::new(0);
    while let Some((near, child)) = stack.pop() {
        if near > *t_max {
            continue;
        }
        if child & LEAF_BIT != 0 {
            if visit.leaf(tree.leaves[(child & !LEAF_BIT) as usize], t_max) {
                return true;
            }
            continue;
        }
        let node = &tree.nodes[child as usize];
        let (near, mut mask) = boxes.enter::<L>(node, *t_max);
        let first = stack.top;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 7;
            mask &= mask - 1;
            stack.push((near.0[lane], node.child[lane]), first);
        }
    }
    false
}

/// What both queries need to know of a ray.
#[derive(Clone, Copy)]
struct Query<'a> {
    ray: &'a Ray,
    skip: [PrimitiveId; 2],
    camera: bool,
}

/// Offers the primitives of one space to `accept`.
struct Primitives<'a, L, A> {
    tree: &'a Tree,
    instance: u32,
    ray: &'a Ray,
    shear: Shear,
    skip: [u32; 2],
    camera: bool,
    accept: &'a mut A,
    lanes: PhantomData<L>,
}

impl<L: Lanes, A: Accept> Primitives<'_, L, A> {
    #[inline(always)]
    fn hidden(&self, primitive: u32) -> bool {
        self.camera && self.tree.geometry.hidden.get(primitive as usize).copied().unwrap_or(false)
    }

    #[inline(always)]
    fn offer(&mut self, t: f32, primitive: u32, b: [f32; 2], t_max: &mut f32) -> bool {
        t <= *t_max
            && !self.hidden(primitive)
            && self.accept.accept(Hit { t, id: PrimitiveId { instance: self.instance, primitive }, b }, t_max)
    }
}

impl<L: Lanes, A: Accept> Visit for Primitives<'_, L, A> {
    #[inline(always)]
    fn leaf(&mut self, leaf: Leaf, t_max: &mut f32) -> bool {
        let tree = self.tree;
        for packet in &tree.packets[leaf.packets[0] as usize..leaf.packets[1] as usize] {
            let Some(seen) = see::<L>(&self.shear, packet, *t_max) else { continue };
            let mut mask = seen.mask;
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                let primitive = packet.id[lane];
                if primitive == self.skip[0] || primitive == self.skip[1] {
                    continue;
                }
                if let Some(h) = seen.hit(&self.shear, lane)
                    && self.offer(h.t, primitive, [h.b1, h.b2], t_max)
                {
                    return true;
                }
            }
        }
        for &primitive in &tree.others[leaf.others[0] as usize..leaf.others[1] as usize] {
            if primitive == self.skip[1] {
                continue;
            }
            let (center, radius) = tree.geometry.spheres[(primitive - tree.triangle_count) as usize];
            let leaving = primitive == self.skip[0];
            if let Some(t) = sphere::first_hit(self.ray, center, radius, leaving)
                && self.offer(t, primitive, [0.0; 2], t_max)
            {
                return true;
            }
        }
        false
    }
}

/// Offers every hit of one space that is nearer than `t_max`.
#[inline(always)]
fn in_space<L: Lanes, A: Accept>(
    tree: &Tree,
    instance: u32,
    query: Query<'_>,
    t_max: &mut f32,
    accept: &mut A,
) -> bool {
    let skip = query.skip.map(|s| if s.instance == instance { s.primitive } else { u32::MAX });
    let Query { ray, camera, .. } = query;
    let mut visit = Primitives {
        tree,
        instance,
        ray,
        shear: Shear::new(ray),
        skip,
        camera,
        accept,
        lanes: PhantomData::<L>,
    };
    walk::<L>(tree, &Boxes::new(ray), t_max, &mut visit)
}

/// Enters the instances of the top tree.
struct Instances<'a, L, A> {
    accel: &'a Accel,
    top: &'a Tree,
    query: Query<'a>,
    accept: &'a mut A,
    lanes: PhantomData<L>,
}

impl<L: Lanes, A: Accept> Visit for Instances<'_, L, A> {
    #[inline(always)]
    fn leaf(&mut self, leaf: Leaf, t_max: &mut f32) -> bool {
        for &i in &self.top.others[leaf.others[0] as usize..leaf.others[1] as usize] {
            let instance = &self.accel.instances[i as usize];
            if self.query.camera && instance.hidden {
                continue;
            }
            // The direction is not made unit again, so that t means the same in both spaces.
            let local = Ray {
                o: instance.linear * self.query.ray.o + instance.translation,
                d: instance.linear * self.query.ray.d,
                t_max: *t_max,
            };
            let query = Query { ray: &local, skip: self.query.skip, camera: false };
            if in_space::<L, A>(&self.accel.spaces[instance.mesh as usize], i + 1, query, t_max, self.accept)
            {
                return true;
            }
        }
        false
    }
}

/// All hits of the world and of every instance.
#[inline(always)]
fn hits<L: Lanes, A: Accept>(accel: &Accel, query: Query<'_>, t_max: &mut f32, accept: &mut A) -> bool {
    if in_space::<L, A>(&accel.spaces[0], 0, query, t_max, accept) {
        return true;
    }
    let Some(top) = &accel.top else { return false };
    walk::<L>(
        top,
        &Boxes::new(query.ray),
        t_max,
        &mut Instances { accel, top, query, accept, lanes: PhantomData::<L> },
    )
}

/// Keeps the lexicographic minimum of (t, instance, primitive).
struct Closest(Option<Hit>);

impl Accept for Closest {
    #[inline(always)]
    fn accept(&mut self, hit: Hit, t_max: &mut f32) -> bool {
        if self.0.is_none_or(|b| (hit.t, hit.id) < (b.t, b.id)) {
            self.0 = Some(hit);
            *t_max = hit.t;
        }
        false
    }
}

/// Ends at the first hit before the end of the ray.
struct Any(f32);

impl Accept for Any {
    #[inline(always)]
    fn accept(&mut self, hit: Hit, _: &mut f32) -> bool {
        hit.t < self.0
    }
}

#[inline(always)]
pub(super) fn closest<L: Lanes>(
    accel: &Accel,
    ray: &Ray,
    skip: [PrimitiveId; 2],
    camera: bool,
) -> Option<Hit> {
    let mut best = Closest(None);
    let mut t_max = ray.t_max;
    hits::<L, _>(accel, Query { ray, skip, camera }, &mut t_max, &mut best);
    best.0
}

#[inline(always)]
pub(super) fn occluded<L: Lanes>(accel: &Accel, ray: &Ray, between: [PrimitiveId; 2]) -> bool {
    let mut t_max = ray.t_max;
    hits::<L, _>(accel, Query { ray, skip: between, camera: false }, &mut t_max, &mut Any(ray.t_max))
}

//! Building the tree: binned surface-area heuristic (Wald, IRT 2007), then collapsed to eight wide.

use glam::{DAffine3, Vec3};

/// An axis-aligned box; empty where `lo` exceeds `hi`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aabb {
    pub(super) lo: Vec3,
    pub(super) hi: Vec3,
}

impl Aabb {
    pub(super) const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    pub(super) fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { lo: b.lo.min(p), hi: b.hi.max(p) })
    }

    pub(super) fn union(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    /// Half the surface area, relative to `unit` (a power of two near the scene's size, so that
    /// squares neither over- nor underflow).
    fn half_area(self, unit: f32) -> f32 {
        let e = (self.hi - self.lo) / unit;
        if e.x < 0.0 { 0.0 } else { e.x * e.y + e.y * e.z + e.z * e.x }
    }

    /// Widened by 2^-20 of the largest coordinate, which is at least half of the size of what it contains: eight
    /// units of rounding of that size, of which the intersection test can be wrong by six where the box straddles
    /// the origin of the ray (see `SLACK` of `traverse`). So no box hides a hit.
    pub(super) fn padded(self) -> Self {
        let m = self.lo.abs().max(self.hi.abs()).max_element() * (1.0 / 1_048_576.0);
        Self { lo: self.lo - m, hi: self.hi + m }
    }

    /// The box around the transformed box, padded for the rounding of rays that enter its space.
    pub(super) fn transformed(self, m: &DAffine3) -> Self {
        let (lo, hi) = (self.lo.as_dvec3(), self.hi.as_dvec3());
        let corners = (0..8).map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { lo[axis] } else { hi[axis] };
            m.transform_point3(glam::DVec3::new(pick(0), pick(1), pick(2))).as_vec3()
        });
        Self::of_points(corners).padded().padded()
    }
}

/// A node of the eight-wide tree under construction.
pub(super) enum Child {
    Node(usize),
    /// A range of the reordered primitives.
    Leaf {
        start: usize,
        end: usize,
    },
}

/// Nodes of the eight-wide tree (children with their boxes, root first) and the order of primitives.
pub(super) struct Built {
    pub(super) nodes: Vec<Vec<(Aabb, Child)>>,
    pub(super) order: Vec<u32>,
}

/// Primitives that a leaf may hold.
pub(super) const LEAF: usize = 8;
const BINS: usize = 16;
struct Binary {
    bounds: Aabb,
    /// Indices of the two children, or the range of a leaf.
    content: Result<[usize; 2], (usize, usize)>,
}

struct Builder<'a> {
    boxes: &'a [Aabb],
    order: Vec<u32>,
    nodes: Vec<Binary>,
    unit: f32,
}

impl Builder<'_> {
    fn boxed(&self, i: usize) -> Aabb {
        self.boxes[self.order[i] as usize]
    }

    fn centroid(&self, i: usize) -> Vec3 {
        let b = self.boxed(i);
        b.lo * 0.5 + b.hi * 0.5
    }

    /// Builds the subtree over `order[start..end]`; `depth` bounds the recursion.
    fn node(&mut self, start: usize, end: usize, depth: u32) -> usize {
        let bounds = (start..end).fold(Aabb::EMPTY, |b, i| b.union(self.boxed(i)));
        // A packet costs the same however full it is, so what fits into one is not split further.
        let split = if end - start <= LEAF { None } else { Some(self.split(start, end, depth)) };
        let Some(middle) = split else {
            self.nodes.push(Binary { bounds, content: Err((start, end)) });
            return self.nodes.len() - 1;
        };
        let left = self.node(start, middle, depth + 1);
        let right = self.node(middle, end, depth + 1);
        self.nodes.push(Binary { bounds, content: Ok([left, right]) });
        self.nodes.len() - 1
    }

    /// Partitions `order[start..end]` and returns the boundary.
    fn split(&mut self, start: usize, end: usize, depth: u32) -> usize {
        let n = end - start;
        let centroids = Aabb::of_points((start..end).map(|i| self.centroid(i)));
        let extent = centroids.hi - centroids.lo;
        // Deep chains of the heuristic are cut to halves, which bounds the recursion.
        let best = if depth < 48 { self.best_plane(start, end, centroids) } else { None };
        if let Some((axis, bin, _)) = best {
            let scale = BINS as f32 / extent[axis];
            let in_left = |c: Vec3| (((c[axis] - centroids.lo[axis]) * scale) as usize).min(BINS - 1) <= bin;
            let mut middle = start;
            for i in start..end {
                if in_left(self.centroid(i)) {
                    self.order.swap(i, middle);
                    middle += 1;
                }
            }
            if middle > start && middle < end {
                return middle;
            }
        }
        // All centroids coincide, or the chain grew too deep: halves.
        start + n / 2
    }

    /// The best of all binned planes: axis, last bin of the left side, and the children's cost.
    fn best_plane(&self, start: usize, end: usize, centroids: Aabb) -> Option<(usize, usize, f32)> {
        let extent = centroids.hi - centroids.lo;
        let mut best: Option<(usize, usize, f32)> = None;
        for axis in 0..3 {
            let scale = BINS as f32 / extent[axis];
            if !scale.is_finite() {
                continue;
            }
            let mut bins = [(Aabb::EMPTY, 0usize); BINS];
            for i in start..end {
                let k = (((self.centroid(i)[axis] - centroids.lo[axis]) * scale) as usize).min(BINS - 1);
                bins[k] = (bins[k].0.union(self.boxed(i)), bins[k].1 + 1);
            }
            let cost = |b: Aabb, n: usize| b.half_area(self.unit) * n.div_ceil(LEAF) as f32;
            let mut right = [0.0; BINS];
            let mut acc = (Aabb::EMPTY, 0);
            for k in (1..BINS).rev() {
                acc = (acc.0.union(bins[k].0), acc.1 + bins[k].1);
                right[k] = if acc.1 == 0 { f32::INFINITY } else { cost(acc.0, acc.1) };
            }
            acc = (Aabb::EMPTY, 0);
            for k in 0..BINS - 1 {
                acc = (acc.0.union(bins[k].0), acc.1 + bins[k].1);
                if acc.1 == 0 {
                    continue;
                }
                let total = cost(acc.0, acc.1) + right[k + 1];
                if total.is_finite() && best.is_none_or(|b| total < b.2) {
                    best = Some((axis, k, total));
                }
            }
        }
        best
    }
}

/// The eight-wide tree over `boxes`; `None` where there are none.
pub(super) fn build(boxes: &[Aabb]) -> Option<Built> {
    if boxes.is_empty() {
        return None;
    }
    let whole = boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b));
    let size = (whole.hi - whole.lo).max_element();
    let unit = if size.is_normal() { crate::math::floor_pow2(size) } else { 1.0 };
    let order = (0..boxes.len() as u32).collect();
    let mut builder = Builder { boxes, order, nodes: Vec::new(), unit };
    let root = builder.node(0, boxes.len(), 0);
    let Builder { nodes: binary, order, .. } = builder;

    let mut nodes: Vec<Vec<(Aabb, Child)>> = vec![Vec::new()];
    let mut todo = vec![(root, 0usize)];
    while let Some((source, target)) = todo.pop() {
        let mut children = Vec::with_capacity(8);
        for b in widen(&binary, source, unit) {
            let child = match binary[b].content {
                Err((start, end)) => Child::Leaf { start, end },
                Ok(_) => {
                    nodes.push(Vec::new());
                    todo.push((b, nodes.len() - 1));
                    Child::Node(nodes.len() - 1)
                }
            };
            children.push((binary[b].bounds, child));
        }
        nodes[target] = children;
    }
    Some(Built { nodes, order })
}

/// The binary nodes that become the children of `source`: the one with the largest surface is opened
/// until there are eight.
fn widen(binary: &[Binary], source: usize, unit: f32) -> Vec<usize> {
    let Ok(pair) = binary[source].content else { return vec![source] };
    let mut open = pair.to_vec();
    while open.len() < 8 {
        let area = |i: usize| binary[open[i]].bounds.half_area(unit);
        let widest = (0..open.len())
            .filter(|&i| binary[open[i]].content.is_ok())
            .max_by(|&a, &b| area(a).total_cmp(&area(b)));
        let Some(i) = widest else { break };
        let Ok([left, right]) = binary[open[i]].content else { break };
        open[i] = left;
        open.push(right);
    }
    open
}

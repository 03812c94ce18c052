//! The eight-wide tree as the kernels walk it.

use glam::Vec3;

use super::Geometry;
use super::build::{self, Aabb, Child};
use super::lanes::F8;
use super::packet::Packet;

/// Eight boxes and what they hold. Empty places have `lo` = +inf and `hi` = -inf, and are never entered.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// lo x, y, z, hi x, y, z.
    pub(super) planes: [F8; 6],
    /// Index of a node, or of a leaf with [`LEAF_BIT`].
    pub(super) child: [u32; 8],
}

/// Marks a child as an index into [`Tree::leaves`].
pub(super) const LEAF_BIT: u32 = 1 << 31;

/// What a leaf holds.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Leaf {
    /// Range of [`Tree::packets`].
    pub(super) packets: [u32; 2],
    /// Range of [`Tree::others`]: spheres, or the instances of the top tree.
    pub(super) others: [u32; 2],
}

/// A tree and the geometry it orders.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) packets: Vec<Packet>,
    pub(super) others: Vec<u32>,
    pub(super) geometry: Geometry,
    pub(super) bounds: Aabb,
    /// Number of triangles; primitives from here on are spheres.
    pub(super) triangle_count: u32,
}

impl Tree {
    pub(super) fn over_geometry(geometry: Geometry) -> Self {
        let triangles =
            (0..geometry.triangles.len() as u32).map(|i| Aabb::of_points(geometry.vertices(i)).padded());
        let spheres = geometry
            .spheres
            .iter()
            .map(|&(c, r)| Aabb { lo: c - Vec3::splat(r), hi: c + Vec3::splat(r) }.padded());
        let boxes: Vec<Aabb> = triangles.chain(spheres).collect();
        Self::assemble(&boxes, geometry)
    }

    /// A tree whose leaves name the boxes themselves.
    pub(super) fn over_boxes(boxes: &[Aabb]) -> Self {
        Self::assemble(boxes, Geometry::default())
    }

    fn assemble(boxes: &[Aabb], geometry: Geometry) -> Self {
        let triangle_count = geometry.triangles.len() as u32;
        let bounds = boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b));
        let mut tree = Self {
            nodes: Vec::new(),
            leaves: Vec::new(),
            packets: Vec::new(),
            others: Vec::new(),
            geometry,
            bounds,
            triangle_count,
        };
        let Some(built) = build::build(boxes) else { return tree };
        for children in &built.nodes {
            let (lo, hi) = (F8::all(f32::INFINITY), F8::all(f32::NEG_INFINITY));
            let mut node = Node { planes: [lo, lo, lo, hi, hi, hi], child: [0; 8] };
            for (lane, (bounds, child)) in children.iter().enumerate() {
                for axis in 0..3 {
                    node.planes[axis].0[lane] = bounds.lo[axis];
                    node.planes[axis + 3].0[lane] = bounds.hi[axis];
                }
                node.child[lane] = match *child {
                    Child::Node(i) => i as u32,
                    Child::Leaf { start, end } => LEAF_BIT | tree.leaf(&built.order[start..end]),
                };
            }
            tree.nodes.push(node);
        }
        tree
    }

    fn leaf(&mut self, primitives: &[u32]) -> u32 {
        let mut triangles: Vec<u32> =
            primitives.iter().copied().filter(|&p| p < self.triangle_count).collect();
        triangles.sort_unstable();
        let first_packet = self.packets.len() as u32;
        for chunk in triangles.chunks(8) {
            self.packets.push(Packet::new(&self.geometry, chunk));
        }
        let first_other = self.others.len() as u32;
        self.others.extend(primitives.iter().filter(|&&p| p >= self.triangle_count));
        self.leaves.push(Leaf {
            packets: [first_packet, self.packets.len() as u32],
            others: [first_other, self.others.len() as u32],
        });
        self.leaves.len() as u32 - 1
    }
}

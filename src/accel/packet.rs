//! Eight triangles side by side.

use super::Geometry;
use super::lanes::F8;

/// Vertices of up to eight triangles, by vertex, axis and lane.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct Packet {
    pub(super) v: [[F8; 3]; 3],
    /// Index of the triangle, ascending.
    pub(super) id: [u32; 8],
    /// A bit for each lane that holds a triangle.
    pub(super) used: u32,
}

impl Packet {
    pub(super) fn new(geometry: &Geometry, triangles: &[u32]) -> Self {
        let mut packet =
            Self { v: [[F8::all(0.0); 3]; 3], id: [u32::MAX; 8], used: (1 << triangles.len()) - 1 };
        for (lane, &triangle) in triangles.iter().enumerate() {
            for (k, vertex) in geometry.vertices(triangle).iter().enumerate() {
                for axis in 0..3 {
                    packet.v[k][axis].0[lane] = vertex[axis];
                }
            }
            packet.id[lane] = triangle;
        }
        packet
    }
}

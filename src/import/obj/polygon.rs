//! Polygons become triangles that cover the same area.
//!
//! In: the corners of a polygon, in space. Out: triangles over them, wound as the polygon is. The polygon
//! is seen along its area vector (Newell's normal, Sutherland, Sproull and Schumacker 1974), convex ones are
//! fanned, others clipped by ears (`earcut`). Invariant: seen so, the triangles cover the polygon's own area
//! to [`AREA_TOLERANCE`], or the answer says that they do not, which happens where the outline crosses
//! itself. Works badly: corners on a straight edge may stay unused by concave polygons.

use earcut::Earcut;
use glam::DVec3;

/// Relative difference allowed between the polygon's area and that of its triangles.
pub(super) const AREA_TOLERANCE: f64 = 2e-3;
/// The most corners of a polygon that is not convex: clipping ears may take the square of their number.
pub(super) const MAX_CORNERS: usize = 100_000;
/// The most pairs of corners that such polygons of one file may have in all: a bound on the time they take.
const MAX_PAIRS: u64 = 20_000_000_000;

/// How well a polygon could be covered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cover {
    /// To the tolerance.
    Whole,
    /// The outline crosses itself: triangles of another area.
    Crossing,
    /// No triangles, since no area.
    Empty,
    /// No triangles: too many corners, in it or in all such polygons of the file.
    TooLarge,
}

/// Triangulates, with memory that is used again.
#[derive(Default)]
pub(super) struct Triangulator {
    flat: Vec<[f64; 2]>,
    earcut: Earcut<f64>,
    indices: Vec<u32>,
    /// Pairs of corners so far.
    pairs: u64,
}

impl Triangulator {
    /// Appends triangles over `corners` to `out`, which is cleared first.
    pub(super) fn cover(&mut self, corners: &[DVec3], out: &mut Vec<[u32; 3]>) -> Cover {
        out.clear();
        let n = corners.len();
        if n < 3 {
            return Cover::Empty;
        }
        if n == 3 {
            // Without area it is found and counted when the scene is validated.
            out.push([0, 1, 2]);
            return Cover::Whole;
        }
        let normal = area_vector(corners);
        let size = corners.iter().map(|p| p.distance_squared(corners[0])).fold(0.0, f64::max);
        if size == 0.0 {
            return Cover::Empty;
        }
        let length = normal.length();
        if length.is_nan() || length <= 1e-12 * size {
            return self.without_normal(corners, size, out);
        }

        // Seen along the normal's largest component nothing is lost: two coordinates are simply kept.
        let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = if normal[axis] > 0.0 { (u, v) } else { (v, u) };
        self.flat.clear();
        self.flat.extend(corners.iter().map(|p| [p[u] - corners[0][u], p[v] - corners[0][v]]));
        let area = normal[axis].abs();
        if self.fan(area, out) {
            return Cover::Whole;
        }
        self.pairs = self.pairs.saturating_add(n as u64 * n as u64);
        if n > MAX_CORNERS || self.pairs > MAX_PAIRS {
            return Cover::TooLarge;
        }
        if self.ears(area, out) {
            return Cover::Whole;
        }

        // Corners far from their plane may cross in that view, and not when seen along the normal itself.
        let kept = std::mem::take(out);
        let unit = normal.normalize();
        let (u, v) = unit.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend(corners.iter().map(|&p| [(p - corners[0]).dot(u), (p - corners[0]).dot(v)]));
        if self.ears(normal.length(), out) {
            return Cover::Whole;
        }
        if !kept.is_empty() {
            *out = kept;
        }
        if out.is_empty() { Cover::Empty } else { Cover::Crossing }
    }

    /// A figure of eight encloses nothing in sum; a fan shows at least what it is made of.
    fn without_normal(&mut self, corners: &[DVec3], size: f64, out: &mut Vec<[u32; 3]>) -> Cover {
        out.extend((2..corners.len() as u32).map(|i| [0, i - 1, i]));
        let doubled = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| corners[i as usize]);
            (b - a).cross(c - a).length()
        };
        out.retain(|t| doubled(t) > 1e-12 * size);
        if out.is_empty() { Cover::Empty } else { Cover::Crossing }
    }

    /// A fan, where it covers the area: of a convex polygon, or from the inner corner of a quadrilateral.
    fn fan(&self, area: f64, out: &mut Vec<[u32; 3]>) -> bool {
        let n = self.flat.len() as u32;
        // A fan from either of two neighbours splits a quadrilateral along either of its diagonals.
        for first in if n == 4 { 0..2 } else { 0..1 } {
            out.clear();
            let at = |i: u32| (first + i) % n;
            let mut covered = 0.0;
            for i in 2..n {
                let t = [at(0), at(i - 1), at(i)];
                let part = self.signed_area(t);
                if part.is_nan() || part <= 0.0 {
                    break;
                }
                covered += part;
                out.push(t);
            }
            let turns_left = n == 4 || (0..n).all(|i| self.signed_area([i, (i + 1) % n, (i + 2) % n]) > 0.0);
            if out.len() as u32 == n - 2 && turns_left && close(covered, area) {
                return true;
            }
        }
        out.clear();
        false
    }

    /// Ears of any polygon; whether they cover the area.
    fn ears(&mut self, area: f64, out: &mut Vec<[u32; 3]>) -> bool {
        self.earcut.earcut_slice(&self.flat, &[] as &[u32], &mut self.indices);
        out.clear();
        let mut covered = 0.0;
        for t in self.indices.chunks_exact(3) {
            let part = self.signed_area([t[0], t[1], t[2]]);
            covered += part.abs();
            if part != 0.0 {
                out.push(if part > 0.0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] });
            }
        }
        close(covered, area)
    }

    /// Of a triangle in the plane, times two as the length of [`area_vector`] is: left turns are positive.
    fn signed_area(&self, t: [u32; 3]) -> f64 {
        let [a, b, c] = t.map(|i| self.flat[i as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    }
}

fn close(covered: f64, area: f64) -> bool {
    (covered - area).abs() <= AREA_TOLERANCE * area
}

/// Newell's normal of a closed outline: its length is twice the area.
pub(super) fn area_vector(corners: &[DVec3]) -> DVec3 {
    let origin = corners[0];
    corners.windows(2).map(|w| (w[0] - origin).cross(w[1] - origin)).sum()
}

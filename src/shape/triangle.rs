//! The watertight ray-triangle test (Woop, Benthin and Wald, JCGT 2(1), 2013), decided exactly.
//!
//! A vertex is projected along the ray by itself, so all triangles around it see it in the same place. The
//! edge functions are computed in `f64`, in which the products of two `f32` are exact and a difference has the
//! right sign: a ray is in a projected triangle or it is not, and cannot pass between triangles that share an
//! edge or a vertex. The paper does so only where an edge function is zero in `f32`; but on a triangle that
//! looks thin all three are as small as their rounding, its signs are chance, and rays met such triangles beyond
//! their tip. With exact signs a ray meets a triangle only where rounding of the vertices alone puts it, which
//! the slack of the boxes covers (`accel`), and the distance is a mean of the vertices' with weights that are
//! exact but for their last place.

use glam::Vec3;

use super::Ray;
use crate::math::gamma;
use crate::mutants::planted;

/// A ray prepared for the test: the axis in which it is longest becomes z, and a shear makes it
/// point along that axis.
#[derive(Clone, Copy, Debug)]
pub struct Shear {
    /// Indices of the permuted axes x, y and z.
    pub axes: [usize; 3],
    /// Shear of x and y, and scale of z.
    pub s: [f32; 3],
    /// Origin, unpermuted.
    pub o: [f32; 3],
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Distance in units of the ray's direction, > 0.
    pub t: f32,
    /// Barycentric coordinate of the second vertex.
    pub b1: f32,
    /// Barycentric coordinate of the third vertex.
    pub b2: f32,
}

impl Shear {
    /// Prepares `ray`; its direction need not be unit.
    #[inline]
    #[must_use]
    pub fn new(ray: &Ray) -> Self {
        let a = ray.d.abs();
        let z = if a.x > a.y {
            if a.x > a.z { 0 } else { 2 }
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let d = ray.d.to_array();
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            // Keeps the winding.
            std::mem::swap(&mut x, &mut y);
        }
        Self { axes: [x, y, z], s: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]], o: ray.o.to_array() }
    }

    /// Sheared x and y of a vertex relative to the origin, and its unsheared z.
    #[inline(always)]
    fn project(&self, v: Vec3) -> [f32; 3] {
        let v = v.to_array();
        let [x, y, z] = self.axes;
        let az = v[z] - self.o[z];
        [v[x] - self.o[x] - self.s[0] * az, v[y] - self.o[y] - self.s[1] * az, az]
    }

    /// The triangle `v0 v1 v2`, either side, at a distance in (0, inf).
    #[inline]
    #[must_use]
    pub fn intersect(&self, v0: Vec3, v1: Vec3, v2: Vec3) -> Option<TriangleHit> {
        self.decide([v0, v1, v2].map(|v| self.project(v)))
    }

    /// Decides from the projected vertices.
    #[inline(always)]
    #[must_use]
    pub fn decide(&self, vertices: [[f32; 3]; 3]) -> Option<TriangleHit> {
        let met = self.exactly(vertices);
        planted!(moeller_trumbore(met, vertices, self.s[2], |[t, b1, b2]| TriangleHit { t, b1, b2 }))
    }

    #[inline(always)]
    fn exactly(&self, vertices: [[f32; 3]; 3]) -> Option<TriangleHit> {
        let [a, b, c] = vertices.map(|v| v.map(f64::from));
        // Opposite to each vertex; no product is too small or too large for double precision.
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 {
            return None;
        }
        let inv = 1.0 / det;
        let t = ((u * a[2] + v * b[2] + w * c[2]) * inv * f64::from(self.s[2])) as f32;
        // Written so that NaN misses.
        (t > 0.0 && t < f32::INFINITY).then_some(TriangleHit {
            t,
            b1: (v * inv) as f32,
            b2: (w * inv) as f32,
        })
    }
}

/// The point with barycentric coordinates (1 - b1 - b2, b1, b2), and a bound on the error of each of
/// its coordinates: gamma(7) times the sum of the absolute products (Pharr et al., section 6.8.5), and
/// two roundings more for moving it (see `offset_origin`). No bound is less than gamma(3) of the largest
/// coordinate: in a plane with a coordinate of exactly zero the point is exact in it, but a ray that
/// starts in that plane could still meet a coplanar neighbour by the rounding of the shear.
#[inline]
#[must_use]
pub fn point(v: [Vec3; 3], b1: f32, b2: f32) -> (Vec3, Vec3) {
    let b0 = 1.0 - b1 - b2;
    let (a, b, c) = (v[0] * b0, v[1] * b1, v[2] * b2);
    let magnitude = a.abs() + b.abs() + c.abs();
    (a + b + c, (magnitude * gamma(9)).max(Vec3::splat(magnitude.max_element() * gamma(3))))
}

/// Unit normal of the counter-clockwise triangle, computed in `f64` (thin triangles keep their
/// direction, and no power of two of the scale under- or overflows); `None` where it has no area.
#[inline]
#[must_use]
pub fn normal(v: [Vec3; 3]) -> Option<Vec3> {
    let v0 = v[0].as_dvec3();
    let n = (v[1].as_dvec3() - v0).cross(v[2].as_dvec3() - v0);
    let length = n.length();
    (length > 0.0 && length.is_finite()).then(|| (n / length).as_vec3())
}

/// Area in square metres, computed in `f64`.
#[must_use]
pub fn area(v: [Vec3; 3]) -> f64 {
    let v0 = v[0].as_dvec3();
    0.5 * (v[1].as_dvec3() - v0).cross(v[2].as_dvec3() - v0).length()
}

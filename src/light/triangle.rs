//! Triangles, sampled by solid angle.
//!
//! Sources: Van Oosterom and Strackee, IEEE TBME 30(2), 1983 (solid angle by one arc tangent, from
//! edge differences); Arvo, SIGGRAPH 1995 (area-preserving map onto a spherical triangle). In `f64`
//! from `f32` vertices; below [`SMALLEST`] steradians the triangle is sampled by area instead.

use glam::{DVec3, Vec3};

use super::SurfaceSample;
use crate::math::{self, sin_cos};
use crate::rare::rarely;
use crate::sampling::warp::square_to_triangle;
use crate::shape::triangle;

/// Solid angle below which area sampling is used, steradians.
const SMALLEST: f64 = 1e-6;

/// An emissive triangle.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLight {
    /// World-space vertices.
    pub v: [Vec3; 3],
    n: Vec3,
    area: f64,
}

struct View {
    /// Unit directions to the vertices.
    a: DVec3,
    b: DVec3,
    c: DVec3,
    solid_angle: f64,
}

impl TriangleLight {
    /// The triangle; `None` where it has no area.
    #[must_use]
    pub fn new(v: [Vec3; 3]) -> Option<Self> {
        Some(Self { v, n: triangle::normal(v)?, area: triangle::area(v) })
    }

    /// Unit normal of the counter-clockwise side.
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        self.n
    }

    /// Area, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    fn view(&self, p: Vec3) -> Option<View> {
        let p = p.as_dvec3();
        let [ra, rb, rc] = self.v.map(|v| v.as_dvec3() - p);
        // The triple product is unchanged when two vertices are taken relative to the third, and then
        // does not cancel for triangles that look small.
        let volume = ra.dot((rb - ra).cross(rc - ra)).abs();
        let (a, b, c) = (ra.try_normalize()?, rb.try_normalize()?, rc.try_normalize()?);
        let volume = volume / (ra.length() * rb.length() * rc.length());
        let denominator = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        let solid_angle = 2.0 * f64::from(math::atan2(volume as f32, denominator as f32));
        // Without volume the point lies in the plane: inside the triangle that looks like a half-space.
        (volume > 0.0 && solid_angle > 0.0).then_some(View { a, b, c, solid_angle })
    }

    /// A point of the triangle as seen from `p`; `None` where `p` lies in its plane.
    #[must_use]
    pub fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<SurfaceSample> {
        let view = self.view(p)?;
        if view.solid_angle < SMALLEST {
            let s = self.at(square_to_triangle(u), 1.0);
            let pdf = super::set::area_pdf(p, s.p, self.n, self.area);
            return (pdf > 0.0 && pdf.is_finite()).then_some(SurfaceSample { pdf, ..s });
        }
        let w = arvo(&view, u)?;
        // Back to the plane: barycentric coordinates of the direction in the vertices.
        let p64 = p.as_dvec3();
        let [ra, rb, rc] = self.v.map(|v| v.as_dvec3() - p64);
        let (wb, wc) = (w.dot(rc.cross(ra)), w.dot(ra.cross(rb)));
        let wa = w.dot(rb.cross(rc));
        let sum = wa + wb + wc;
        let (b1, b2) = (wb / sum, wc / sum);
        if rarely!(1e-5, !(b1.is_finite() && b2.is_finite())) {
            return None;
        }
        let b1 = b1.clamp(0.0, 1.0);
        let b2 = b2.clamp(0.0, 1.0 - b1);
        Some(self.at([b1 as f32, b2 as f32], (1.0 / view.solid_angle) as f32))
    }

    /// Density per solid angle at `p` of [`Self::sample`] for the direction to the point `q` of the
    /// triangle; zero where `p` lies in its plane.
    #[must_use]
    pub fn pdf(&self, p: Vec3, q: Vec3) -> f32 {
        match self.view(p) {
            None => 0.0,
            Some(view) if view.solid_angle < SMALLEST => super::set::area_pdf(p, q, self.n, self.area),
            Some(view) => (1.0 / view.solid_angle) as f32,
        }
    }

    /// Whether the point `q` of its plane lies within the edges.
    #[must_use]
    pub fn contains(&self, q: Vec3) -> bool {
        let [a, b, c] = self.v.map(|v| v.as_dvec3() - q.as_dvec3());
        let n = self.n.as_dvec3();
        [a.cross(b), b.cross(c), c.cross(a)].iter().all(|edge| edge.dot(n) >= 0.0)
    }

    /// The point with these barycentric coordinates (of the second and third vertex).
    pub(super) fn at(&self, b: [f32; 2], pdf: f32) -> SurfaceSample {
        let (p, p_err) = triangle::point(self.v, b[0], b[1]);
        SurfaceSample { p, p_err, n: self.n, pdf }
    }
}

/// The direction that Arvo's map gives to `u`; `None` where the triangle is degenerate on the sphere.
fn arvo(view: &View, u: [f32; 2]) -> Option<DVec3> {
    let View { a, b, c, solid_angle } = *view;
    let ab = a.cross(b).try_normalize()?;
    let ca = c.cross(a).try_normalize()?;
    let (cos_alpha, sin_alpha) = (-ab.dot(ca), ab.cross(ca).length());
    let cos_c = a.dot(b);
    // The sub-triangle with area u S: its corner c' on the arc from a to c.
    let (s, t) = sin_cos(u[0] * solid_angle as f32);
    let (sin_s, cos_s) = (f64::from(s), f64::from(t));
    // sin and cos of (S' - alpha).
    let s = sin_s * cos_alpha - cos_s * sin_alpha;
    let t = cos_s * cos_alpha + sin_s * sin_alpha;
    let (uu, vv) = (t - cos_alpha, s + sin_alpha * cos_c);
    let numerator = (vv * t - uu * s) * cos_alpha - vv;
    let denominator = (vv * s + uu * t) * sin_alpha;
    let q = if denominator == 0.0 { 1.0 } else { (numerator / denominator).clamp(-1.0, 1.0) };
    let towards_c = (c - a * c.dot(a)).try_normalize()?;
    let c_prime = a * q + towards_c * ((1.0 - q) * (1.0 + q)).sqrt();
    // Along the arc from b to c': uniform in 1 - cos. 1 - c'.b is formed from the chord.
    let h = 0.5 * (c_prime - b).length_squared() * f64::from(u[1]);
    let Some(towards) = (c_prime - b * c_prime.dot(b)).try_normalize() else { return Some(b) };
    Some(b * (1.0 - h) + towards * (h * (2.0 - h)).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of a square whose corner is straight above the origin, cut through that corner.
    fn right_triangle(size: f32, distance: f32) -> TriangleLight {
        let v = [[0.0, 0.0], [size, 0.0], [size, size]].map(|[x, y]| Vec3::new(x, y, distance));
        TriangleLight::new(v).expect("a triangle")
    }

    /// N47: two halves of a square, whose solid angle has a closed form.
    #[test]
    fn density_is_one_over_the_solid_angle() {
        for size in [100.0, 1.0, 0.1, 0.02, 1e-3, 1e-4f32] {
            let t = right_triangle(size, 1.0);
            let s = f64::from(size);
            let expected = 0.5 * libm::asin(s * s / (s * s + 1.0));
            let pdf = f64::from(t.pdf(Vec3::ZERO, t.at([0.3, 0.3], 1.0).p));
            // Below the limit the density is that of area sampling, which varies a little over the triangle.
            let bound = if expected < SMALLEST { 1e-3 } else { 2e-5 };
            assert!((pdf * expected - 1.0).abs() < bound, "{size}: {}", pdf * expected);
        }
    }

    /// A glossy lamp is lit by itself: from a point inside a triangle, or on its edge or corner, nothing is
    /// sampled and the density is zero.
    #[test]
    fn a_point_of_the_triangle_sees_none_of_it() {
        let t = right_triangle(1.0, 2.0);
        for [x, y] in [[0.5, 0.25], [0.5, 0.0], [1.0, 1.0], [3.0, 0.0]] {
            let p = Vec3::new(x, y, 2.0);
            for u in [[0.0, 0.0], [0.5, 0.5], [0.3, 0.9]] {
                assert!(t.sample(p, u).is_none(), "{p}");
            }
            assert_eq!(t.pdf(p, Vec3::new(0.9, 0.1, 2.0)), 0.0, "{p}");
        }
    }

    #[test]
    fn samples_are_uniform_over_the_solid_angle() {
        let t = TriangleLight::new([
            Vec3::new(-1.0, 0.2, 1.0),
            Vec3::new(0.8, -0.3, 1.3),
            Vec3::new(0.1, 1.4, 0.8),
        ])
        .expect("ok");
        for p in
            [Vec3::ZERO, Vec3::new(0.0, 0.5, 0.95), Vec3::new(4.0, 3.0, -2.0), Vec3::new(50.0, 3.0, -20.0)]
        {
            let n = 400;
            let (mut by_angle, mut by_area, mut total) = (DVec3::ZERO, DVec3::ZERO, 0.0);
            for i in 0..n * n {
                let u = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
                by_angle += (t.sample(p, u).expect("visible").p - p).normalize().as_dvec3();
                let q = t.at(square_to_triangle(u), 1.0).p;
                let w = 1.0 / f64::from(super::super::set::area_pdf(p, q, t.n, t.area));
                by_area += (q - p).normalize().as_dvec3() * w;
                total += w;
            }
            let angle = total / f64::from(n * n);
            assert!((angle * f64::from(t.pdf(p, t.at([0.3, 0.3], 1.0).p)) - 1.0).abs() < 2e-3, "{p}");
            let difference = (by_angle / f64::from(n * n) - by_area / total).length();
            assert!(difference < 2e-4, "{p} {difference}");
        }
    }
}

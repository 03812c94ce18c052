//! Rectangles, sampled by solid angle.
//!
//! Source: Urena, Fajardo and King, "An Area-Preserving Parametrization for Spherical Rectangles",
//! EGSR 2013. The solid angle is the sum of the four inner angles less 2 pi; here the angles are
//! added as arguments of complex numbers in `f64` and leave one arc tangent, so that rectangles that
//! look small keep their relative accuracy. Where even that ends (below [`SMALLEST`]) the rectangle is
//! sampled by area, with the density that belongs to it.

use glam::{DVec3, Vec3};

use super::SurfaceSample;
use crate::math::{self, gamma, sin_cos};
use crate::mutants::planted;

/// Solid angle below which area sampling is used, steradians.
const SMALLEST: f64 = 1e-7;

/// A rectangle from its corner and two perpendicular edges.
#[derive(Clone, Copy, Debug)]
pub struct Rectangle {
    corner: Vec3,
    edges: [Vec3; 2],
    /// Unit axes along the edges and the normal, and the edge lengths.
    x: DVec3,
    y: DVec3,
    n: Vec3,
    size: [f64; 2],
}

/// The rectangle as seen from one point.
struct View {
    /// Extents in the rectangle's axes relative to the point; z0 < 0 is the distance to its plane.
    x0: f64,
    x1: f64,
    y0: f64,
    y1: f64,
    z0: f64,
    b0: f64,
    b1: f64,
    /// Cosine and sine of k = 2 pi - (angle 2 + angle 3).
    k: (f64, f64),
    solid_angle: f64,
}

impl Rectangle {
    /// The rectangle `corner + a edges[0] + b edges[1]`, a and b in [0, 1]; its normal is the cross
    /// product of the edges. `None` where the edges are not perpendicular (to 1e-5) or have no area.
    #[must_use]
    pub fn new(corner: Vec3, edges: [Vec3; 2]) -> Option<Self> {
        let (e0, e1) = (edges[0].as_dvec3(), edges[1].as_dvec3());
        let size = [e0.length(), e1.length()];
        let area = size[0] * size[1];
        if !(area > 0.0 && area.is_finite()) || e0.dot(e1).abs() > 1e-5 * area {
            return None;
        }
        let (x, y) = (e0 / size[0], e1 / size[1]);
        let n = x.cross(y).normalize().as_vec3();
        Some(Self { corner, edges, x, y, n, size })
    }

    /// Unit normal.
    #[must_use]
    pub fn normal(&self) -> Vec3 {
        self.n
    }

    /// All four corners.
    #[must_use]
    pub fn corners(&self) -> [Vec3; 4] {
        let [a, b] = self.edges;
        [Vec3::ZERO, a, b, a + b].map(|o| self.corner + o)
    }

    /// The corner that the edges leave.
    #[must_use]
    pub fn corner(&self) -> Vec3 {
        self.corner
    }

    /// Whether the point `p` of its plane lies within the edges.
    #[must_use]
    pub fn contains(&self, p: Vec3) -> bool {
        let d = p.as_dvec3() - self.corner.as_dvec3();
        let (a, b) = (d.dot(self.x), d.dot(self.y));
        a >= 0.0 && a <= self.size[0] && b >= 0.0 && b <= self.size[1]
    }

    /// Whether the point `p` of the rectangle lies in the triangle opposite to the corner, beyond the
    /// diagonal between the ends of the edges.
    #[must_use]
    pub fn in_second_half(&self, p: Vec3) -> bool {
        let d = p.as_dvec3() - self.corner.as_dvec3();
        d.dot(self.x) / self.size[0] + d.dot(self.y) / self.size[1] > 1.0
    }

    /// Area, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.size[0] * self.size[1]
    }

    fn view(&self, p: Vec3) -> Option<View> {
        let d = self.corner.as_dvec3() - p.as_dvec3();
        // Seen from either side alike.
        let z0 = -d.dot(self.x.cross(self.y)).abs();
        let (x0, y0) = (d.dot(self.x), d.dot(self.y));
        let (x1, y1) = (x0 + self.size[0], y0 + self.size[1]);
        if z0 == 0.0 {
            return None;
        }
        // z components of the normals of the four planes through the point and an edge.
        let edge = |a: f64| a / (a * a + z0 * z0).sqrt();
        let n = [-edge(y0), edge(x1), edge(y1), -edge(x0)];
        // Inner angle g between neighbouring planes: cos g = -n_i n_j (their normals' x and y parts are
        // perpendicular), sin g > 0.
        let angle = |i: usize| {
            let c = -n[i] * n[(i + 1) % 4];
            (c, ((1.0 - c) * (1.0 + c)).sqrt())
        };
        let times = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let upper = times(angle(2), angle(3));
        // The sum of all four is the solid angle plus a full turn.
        let all = times(times(angle(0), angle(1)), upper);
        // The arc tangent keeps the relative accuracy of small angles in f32 too.
        let mut solid_angle = f64::from(math::atan2(all.1 as f32, all.0 as f32));
        if solid_angle < 0.0 {
            solid_angle += 2.0 * std::f64::consts::PI;
        }
        let k = (upper.0, -upper.1);
        Some(View { x0, x1, y0, y1, z0, b0: n[0], b1: n[2], k, solid_angle })
    }

    /// A point of the rectangle as seen from `p`; `None` where `p` lies in its plane.
    #[must_use]
    pub fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<SurfaceSample> {
        let view = self.view(p)?;
        if planted!(area_sampling(view.solid_angle < SMALLEST)) {
            return self.sample_area(p, u);
        }
        // cos and sin of u S + k; S u needs no more than f32, its influence is relative to S.
        let (s, c) = sin_cos(u[0] * view.solid_angle as f32);
        let (s, c) = (f64::from(s), f64::from(c));
        let (sin_au, cos_au) = (s * view.k.0 + c * view.k.1, c * view.k.0 - s * view.k.1);
        let fu = (cos_au * view.b0 - view.b1) / sin_au;
        let cu = (1.0 / (fu * fu + view.b0 * view.b0).sqrt()).copysign(fu).clamp(-1.0, 1.0);
        let xu = -(cu * view.z0) / ((1.0 - cu) * (1.0 + cu)).max(1e-300).sqrt();
        let xu = xu.clamp(view.x0, view.x1);
        let d2 = xu * xu + view.z0 * view.z0;
        let (h0, h1) = (view.y0 / (d2 + view.y0 * view.y0).sqrt(), view.y1 / (d2 + view.y1 * view.y1).sqrt());
        let hv = h0 + f64::from(u[1]) * (h1 - h0);
        let yv = (hv * d2.sqrt() / ((1.0 - hv) * (1.0 + hv)).max(1e-300).sqrt()).clamp(view.y0, view.y1);
        let (a, b) = ((xu - view.x0) / self.size[0], (yv - view.y0) / self.size[1]);
        Some(self.at(a as f32, b as f32, (1.0 / view.solid_angle) as f32))
    }

    /// Density per solid angle at `p` of [`Self::sample`] for the direction to the point `q` of the
    /// rectangle; zero where `p` lies in its plane.
    #[must_use]
    pub fn pdf(&self, p: Vec3, q: Vec3) -> f32 {
        match self.view(p) {
            None => 0.0,
            Some(view) if planted!(area_sampling(view.solid_angle < SMALLEST)) => {
                super::set::area_pdf(p, q, self.n, self.area())
            }
            Some(view) => (1.0 / view.solid_angle) as f32,
        }
    }

    fn sample_area(&self, p: Vec3, u: [f32; 2]) -> Option<SurfaceSample> {
        let s = self.at(u[0], u[1], 1.0);
        let pdf = super::set::area_pdf(p, s.p, self.n, self.area());
        (pdf > 0.0 && pdf.is_finite()).then_some(SurfaceSample { pdf, ..s })
    }

    /// The point at these shares of the edges, [0, 1].
    pub(super) fn at(&self, a: f32, b: f32, pdf: f32) -> SurfaceSample {
        let (e0, e1) = (self.edges[0] * a, self.edges[1] * b);
        let p_err = (self.corner.abs() + e0.abs() + e1.abs()) * gamma(7);
        SurfaceSample { p: self.corner + e0 + e1, p_err, n: self.n, pdf }
    }
}

/// The rectangle that two triangles with a shared diagonal form, if they do: its corner and edges, in
/// an order that keeps the first triangle's winding.
#[must_use]
pub fn from_triangles(a: [Vec3; 3], b: [Vec3; 3]) -> Option<Rectangle> {
    // The corner is the vertex of `a` that `b` does not have; the far corner likewise.
    let lone = |s: [Vec3; 3], o: [Vec3; 3]| {
        let mut found = (0..3).filter(|&i| !o.contains(&s[i]));
        let i = found.next()?;
        found.next().is_none().then_some(i)
    };
    let i = lone(a, b)?;
    let far = b[lone(b, a)?];
    let (corner, p, q) = (a[i], a[(i + 1) % 3], a[(i + 2) % 3]);
    let (e0, e1) = (p - corner, q - corner);
    let size = e0.abs().max(e1.abs()).max_element().max(corner.abs().max_element());
    let parallelogram = ((corner + e0 + e1) - far).abs().max_element() <= 8.0 * f32::EPSILON * size;
    let (na, nb) = (crate::shape::triangle::normal(a)?, crate::shape::triangle::normal(b)?);
    (parallelogram && na.dot(nb) > 0.999_999).then(|| Rectangle::new(corner, [e0, e1]))?
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_square_at(z: f32) -> Rectangle {
        Rectangle::new(Vec3::new(-0.5, -0.5, z), [Vec3::X, Vec3::Y]).expect("a square")
    }

    /// N48: 1 / pdf is the solid angle, near and far, in front and grazing, against the closed form
    /// 4 asin(ab / sqrt((a^2+d^2)(b^2+d^2))) of a rectangle seen from above its middle.
    #[test]
    fn density_is_one_over_the_solid_angle() {
        for d in [0.01, 0.1, 1.0, 10.0, 100.0, 1000.0f32] {
            let r = unit_square_at(d);
            let d = f64::from(d);
            let expected = 4.0 * libm::asin(0.25 / (0.25 + d * d));
            let pdf = r.pdf(Vec3::ZERO, Vec3::new(0.0, 0.0, d as f32));
            assert!((f64::from(pdf) * expected - 1.0).abs() < 2e-5, "{d} {pdf} {expected}");
        }
    }

    /// Sampling is uniform over the solid angle: the mean direction agrees with quadrature by area.
    #[test]
    fn samples_are_uniform_over_the_solid_angle() {
        for p in [Vec3::ZERO, Vec3::new(2.0, 1.0, 0.0), Vec3::new(0.45, -0.4, 0.9), Vec3::new(3.0, 0.0, 0.95)]
        {
            let r = unit_square_at(1.0);
            let n = 400;
            let (mut by_angle, mut by_area, mut total) = (DVec3::ZERO, DVec3::ZERO, 0.0);
            for i in 0..n * n {
                let u = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
                by_angle += (r.sample(p, u).expect("visible").p - p).normalize().as_dvec3();
                let q = r.at(u[0], u[1], 1.0).p;
                let w = 1.0 / f64::from(super::super::set::area_pdf(p, q, r.n, 1.0));
                by_area += (q - p).normalize().as_dvec3() * w;
                total += w;
            }
            let difference = (by_angle / f64::from(n * n) - by_area / total).length();
            assert!(difference < 1e-4, "{p} {difference}");
        }
    }

    #[test]
    fn two_triangles_are_recognised_and_others_are_not() {
        let [a, b, c, d] =
            [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 3.0));
        for (s, t) in [([a, b, c], [a, c, d]), ([c, a, b], [d, a, c]), ([b, c, d], [d, a, b])] {
            let r = from_triangles(s, t).expect("a rectangle");
            assert!((r.area() - 2.0).abs() < 1e-12 && r.normal() == Vec3::Z);
        }
        let slanted = d + Vec3::X * 0.5;
        assert!(from_triangles([a, b, c], [a, c, slanted]).is_none());
        assert!(from_triangles([a, b, c], [a, d, c]).is_none(), "opposite windings");
        assert!(from_triangles([a, b, c], [a, b, c]).is_none());
    }
}

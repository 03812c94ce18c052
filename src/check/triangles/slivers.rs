//! Thin triangles: N16.

use glam::{DVec2, DVec3, Vec3};

use super::tree::{Compared, Trees};
use crate::accel::Geometry;
use crate::check::random::Random;
use crate::check::stage::U;
use crate::check::surfaces::{aimed, at, barycentric, rotation};
use crate::check::{Effort, Figure};
use crate::shape::Ray;
use crate::shape::triangle::Shear;

/// The ray's view of a triangle in double precision, whose rounding is 2^-29 of what is looked for.
struct Exact {
    /// Vertices in the plane across the ray, which passes through the origin of that plane.
    v: [DVec2; 3],
    /// The largest coordinate of a vertex relative to the ray's origin.
    reach: f64,
    /// Distances along the ray at which the vertices are passed.
    t: [f64; 3],
}

impl Exact {
    fn new(ray: &Ray, v: [Vec3; 3]) -> Self {
        let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
        let [x, y, z] = Shear::new(ray).axes;
        let relative = v.map(|p| p.as_dvec3() - o);
        let flat = relative.map(|p| DVec2::new(p[x] - d[x] / d[z] * p[z], p[y] - d[y] / d[z] * p[z]));
        Self {
            v: flat,
            reach: relative.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max),
            t: relative.map(|p| p[z] / d[z]),
        }
    }

    /// Whether the ray meets the triangle, and how far it passes from the nearest edge.
    fn decide(&self) -> (bool, f64) {
        let mut distance = f64::INFINITY;
        let mut sides = [false; 2];
        for k in 0..3 {
            let (a, b) = (self.v[k], self.v[(k + 1) % 3]);
            let edge = b - a;
            let along = (-a.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            distance = distance.min((a + edge * along).length());
            sides[usize::from(a.perp_dot(b) > 0.0)] = true;
        }
        (sides[0] != sides[1], distance)
    }
}

/// What happened to rays aimed at thin triangles.
#[derive(Default)]
struct Tally {
    rays: u64,
    hits: u64,
    /// Hits nearer or farther than every vertex.
    far_off: u64,
    /// Hits outside of the padded box of the triangle.
    outside: u64,
    /// Distance from the edge of the worst wrong decision, units of rounding of the reach.
    wrong: f64,
}

impl Tally {
    fn add(&mut self, crossing: Option<(Ray, [Vec3; 3])>) {
        let Some((ray, v)) = crossing else { return };
        let exact = Exact::new(&ray, v);
        let (near, far) =
            (exact.t[0].min(exact.t[1]).min(exact.t[2]), exact.t[0].max(exact.t[1]).max(exact.t[2]));
        if near <= 0.0 {
            return;
        }
        self.rays += 1;
        let hit = Shear::new(&ray).intersect(v[0], v[1], v[2]);
        let (expected, distance) = exact.decide();
        if hit.is_some() != expected {
            self.wrong = self.wrong.max(distance / (U * exact.reach));
        }
        if let Some(hit) = hit {
            self.hits += 1;
            let (t, slack) = (f64::from(hit.t), 16.0 * U);
            self.far_off += u64::from(t < near * (1.0 - slack) || t > far * (1.0 + slack));
            self.outside += u64::from(!in_own_box(&ray, v, t));
        }
    }

    fn figures(&self, what: &str) -> [Figure; 4] {
        let n = self.rays;
        [
            Figure::at_least(
                format!("share of {n} rays that hit, {what}"),
                self.hits as f64 / n as f64,
                0.02,
            ),
            Figure::exactly(
                format!("of {} hits nearer or farther than every vertex, {what}", self.hits),
                self.far_off as f64,
                0.0,
            ),
            Figure::exactly(
                format!("of {} hits outside of the triangle's own box, {what}", self.hits),
                self.outside as f64,
                0.0,
            ),
            Figure::at_most(
                format!(
                    "largest distance from an edge of a wrong answer, units of rounding, {n} rays, {what}"
                ),
                self.wrong,
                8.0,
            ),
        ]
    }
}

/// Whether a distance along a ray lies between those at which it enters and leaves the box of a triangle. The tree's
/// boxes have this padding and slack, in single precision; this is neither their code nor their precision.
pub(in crate::check) fn in_own_box(ray: &Ray, v: [Vec3; 3], t: f64) -> bool {
    let v = v.map(|p| p.as_dvec3());
    let pad = v.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max) / 1_048_576.0;
    let (low, high) = (v[0].min(v[1]).min(v[2]) - pad, v[0].max(v[1]).max(v[2]) + pad);
    let (o, d) = (ray.o.as_dvec3(), ray.d.as_dvec3());
    let slack = 12.0 * U;
    (0..3).all(|axis| {
        let (a, b) = ((low[axis] - o[axis]) / d[axis], (high[axis] - o[axis]) / d[axis]);
        d[axis] == 0.0 || (a.min(b) * (1.0 - slack) <= t && t <= a.max(b) * (1.0 + slack))
    })
}

/// N16. Rays come from up to a thousand times the size of the triangle away; the second shape has sides of 11.2
/// and 9.8 with an angle of 0.52 degrees, up to 600 from the origin (embree, issue 387).
pub(super) fn thin(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N16");
    let n = effort.trials(30_000);
    let mut figures = Vec::new();
    for height in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
        let mut tally = Tally::default();
        for _ in 0..n {
            let apex = r.unit();
            let flat = [DVec3::ZERO, DVec3::X, DVec3::new(apex, height, 0.0)];
            tally.add(aimed_at(&mut r, flat, 1.0, 1.0));
        }
        figures.extend(tally.figures(&format!("base 1, height {height:e}")));
    }
    let mut tally = Tally::default();
    let (sin, cos) = libm::sincos(0.52f64.to_radians());
    for _ in 0..n {
        let flat = [DVec3::ZERO, DVec3::X * 11.2, DVec3::new(9.8 * cos, 9.8 * sin, 0.0)];
        tally.add(aimed_at(&mut r, flat, 350.0, 11.0));
    }
    figures.extend(tally.figures("sides 11.2 and 9.8, an angle of 0.52 degrees"));
    figures.extend(together(&mut r, effort.trials(5_000)));
    figures
}

/// Slivers of all heights, on each other, through a tree: what lies outside of its box would be found by brute force
/// alone.
fn together(r: &mut Random, n: u64) -> Vec<Figure> {
    const SLIVERS: u32 = 500;
    let mut g = Geometry::default();
    for i in 0..SLIVERS {
        let (turn, middle) = (rotation(r), r.direction().as_dvec3() * (0.2 * r.unit()));
        let height = libm::pow(10.0, r.between(-8.0, -3.0));
        let flat = [DVec3::ZERO, DVec3::X, DVec3::new(r.unit(), height, 0.0)];
        g.positions.extend(flat.map(|p| (middle + turn * (p - 0.5 * DVec3::X)).as_vec3()));
        g.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let trees = Trees::over(g);
    let mut compared = Compared::default();
    for i in 0..n {
        let v = trees.geometry().vertices((r.unit() * f64::from(SLIVERS)) as u32);
        let target = at(v, barycentric(r));
        // Half of them look along the sliver, from near its plane.
        let along =
            (v[1] - v[0]).as_dvec3() + r.direction().as_dvec3() * libm::pow(10.0, r.between(-6.0, 0.0));
        let from = if i % 2 == 0 { along } else { r.direction().as_dvec3() };
        let o = target + from * libm::pow(10.0, r.between(-1.0, 3.0));
        if let Some(ray) = aimed(o.as_vec3(), target) {
            compared.add(&trees, &ray);
        }
    }
    compared.figures(&format!("{SLIVERS} slivers of height 1e-8 to 1e-3"), 0.02)
}

/// A triangle that is turned and placed anywhere up to `place`, and a ray aimed at it from `size` times 1e-1 to 1e3.
pub(in crate::check) fn aimed_at(
    r: &mut Random,
    flat: [DVec3; 3],
    place: f64,
    size: f64,
) -> Option<(Ray, [Vec3; 3])> {
    let turn = rotation(r);
    let middle = r.direction().as_dvec3() * (place * r.unit());
    let v = flat.map(|p| (middle + turn * p).as_vec3());
    let target = at(v, barycentric(r));
    let o = target + r.direction().as_dvec3() * (size * libm::pow(10.0, r.between(-1.0, 3.0)));
    Some((aimed(o.as_vec3(), target)?, v))
}

//! Tiny, huge, far and grazed triangles: N19 and N20.

use glam::{DMat3, DVec3, Vec3};

use crate::check::random::Random;
use crate::check::stage::U;
use crate::check::surfaces::{Departure, Plane, aimed, any_triangle, at, barycentric, largest, rotation};
use crate::check::{Effort, Figure};
use crate::math::reflect;
use crate::shape::Ray;
use crate::shape::triangle::{Shear, point};

/// How far points that rays find lie from the exact plane, in units of rounding of the largest coordinate.
#[derive(Default)]
struct OffPlane {
    hits: u64,
    worst: f64,
}

impl OffPlane {
    fn add(&mut self, v: [Vec3; 3], ray: &Ray) -> Option<()> {
        let plane = Plane::of(v)?;
        let hit = Shear::new(ray).intersect(v[0], v[1], v[2])?;
        let (p, _) = point(v, hit.b1, hit.b2);
        self.hits += 1;
        self.worst = self.worst.max(plane.height(p).abs() / (U * largest(v)));
        Some(())
    }

    fn figures(&self, n: u64, what: &str) -> [Figure; 2] {
        [
            Figure::at_least(format!("hits of {n} rays, {what}"), self.hits as f64, 0.2 * n as f64),
            Figure::at_most(
                format!(
                    "largest distance from the plane of {} points, units of rounding of the largest coordinate, {what}",
                    self.hits
                ),
                self.worst,
                32.0,
            ),
        ]
    }
}

/// N19.
pub(super) fn in_plane(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N19");
    let n = effort.trials(60_000);
    let [mut tiny, mut ground, mut far] = [0; 3].map(|_| OffPlane::default());
    for _ in 0..n {
        // Rounding of a direction moves a ray from 1e3 m by more than the triangle is large, so these are
        // parallel to an axis, which is exact.
        let v = any_triangle(&mut r, 1e-6, DVec3::ZERO);
        let axis = (r.unit() * 3.0) as usize;
        let mut o = at(v, barycentric(&mut r)).as_vec3().to_array();
        let mut d = [0.0; 3];
        d[axis] = if r.unit() < 0.5 { -1.0 } else { 1.0f32 };
        o[axis] = -1e3 * d[axis];
        tiny.add(v, &Ray::new(Vec3::from_array(o), Vec3::from_array(d)));

        // A plane that is not quite level, 1e7 m wide, seen from 1.7 m above its middle.
        let slope =
            DMat3::from_rotation_z(r.between(-1e-3, 1e-3)) * DMat3::from_rotation_x(r.between(-1e-3, 1e-3));
        let corner = |x: f64, z: f64| (slope * DVec3::new(x, 0.0, z)).as_vec3();
        let v = [corner(-5e6, 5e6), corner(5e6, 5e6), corner(0.0, -5e6)];
        let mut down = r.direction();
        down.y = -down.y.abs();
        ground.add(v, &Ray::new(Vec3::Y * 1.7, down));

        // Beyond 2^24 m from the origin, where the distance of neighbouring numbers is 2 m.
        let place = DVec3::new(16_777_216.0 + 1e4 * r.unit(), 2e7 * r.unit(), -3e7);
        let v = any_triangle(&mut r, 1e3, place);
        let o = (place + r.direction().as_dvec3() * 3e3).as_vec3();
        if let Some(ray) = aimed(o, at(v, barycentric(&mut r))) {
            far.add(v, &ray);
        }
    }
    let mut figures = Vec::new();
    figures.extend(tiny.figures(n, "edges of 1e-6 m seen from 1e3 m"));
    figures.extend(ground.figures(n, "a ground of 1e7 m seen from 1.7 m"));
    figures.extend(far.figures(n, "edges of 1e3 m, camera beyond 2^24 m"));
    figures
}

/// Edge of the plane of N20, metres.
const WIDE: f64 = 1e4;

/// N20. Incidence is measured for the ray as rounded.
pub(super) fn grazing(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N20");
    let n = effort.trials(120_000);
    let (mut hits, mut worst) = (0u64, 0.0f64);
    let (mut front, mut left) = (0u64, 0u64);
    for _ in 0..n {
        let turn = rotation(&mut r);
        let corner = |x: f64, y: f64| (turn * DVec3::new(x, y, 0.0)).as_vec3();
        let v = [corner(-WIDE, -WIDE), corner(WIDE, -WIDE), corner(0.0, WIDE)];
        let Some(plane) = Plane::of(v) else { continue };
        let sin = libm::pow(10.0, r.between(-6.0, -1.0)) * if r.unit() < 0.5 { -1.0 } else { 1.0 };
        let (s, c) = libm::sincos(std::f64::consts::TAU * r.unit());
        let d = turn * DVec3::new(c, s, -sin).normalize();
        let target = turn * DVec3::new(r.between(-0.2, 0.2) * WIDE, r.between(-0.4, 0.0) * WIDE, 0.0);
        let o = (target - d * (WIDE * r.between(0.3, 1.0))).as_vec3();
        let ray = Ray::new(o, d.as_vec3().normalize());
        let (height, slope) = (plane.height(o), ray.d.as_dvec3().dot(plane.n));
        let t = -height / slope;
        // Rounding may put the origin on the other side of the plane.
        if !(1e-6..=0.1).contains(&slope.abs()) || t <= 0.0 {
            continue;
        }
        let Some(hit) = Shear::new(&ray).intersect(v[0], v[1], v[2]) else { continue };
        hits += 1;
        // A plane is known to a few units of rounding of its size, however near the ray starts to it.
        let bound = 16.0 * U * t.max(WIDE) / slope.abs();
        worst = worst.max((f64::from(hit.t) - t).abs() / bound);
        // The side that is seen is the one that the origin lies on, and what is reflected leaves to it.
        let Some(reflected) = Departure::new(v, [hit.b1, hit.b2], |ng| reflect(-ray.d, ng)) else { continue };
        front += u64::from((ray.d.dot(reflected.ng) < 0.0) != (height > 0.0));
        left += u64::from(plane.height(reflected.ray.o).signum() != height.signum());
    }
    let what = format!("{hits} hits at 1e-6 to 1e-1 rad of a plane of 1e4 m");
    vec![
        Figure::at_least(format!("hits of {n} rays, {what}"), hits as f64, 0.5 * n as f64),
        Figure::at_most(
            format!("largest error of the distance, of 16 units of rounding / sin(angle), {what}"),
            worst,
            1.0,
        ),
        Figure::exactly(format!("wrong sides seen, {what}"), front as f64, 0.0),
        Figure::exactly(format!("reflected rays that start on the wrong side, {what}"), left as f64, 0.0),
    ]
}

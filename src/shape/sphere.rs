//! The ray-sphere test, in `f64`.
//!
//! The quadratic's coefficients are formed from the point of closest approach instead of from the
//! origin (Haines, Gunther and Akenine-Moller, Ray Tracing Gems, chapter 7, 2019), and the smaller
//! root from the product of both. The inputs are `f32`, so `f64` leaves rounding that is far below
//! the last place of the result, near and far.

use glam::{DVec3, Vec3};

use super::Ray;
use crate::math::gamma;
use crate::mutants::planted;

/// Distances at which the line of `ray` enters and leaves the sphere; `None` where it misses.
/// Either may be negative or zero.
#[inline]
#[must_use]
pub fn intersect(ray: &Ray, center: Vec3, radius: f32) -> Option<(f64, f64)> {
    let d = ray.d.as_dvec3();
    let f = ray.o.as_dvec3() - center.as_dvec3();
    let r = f64::from(radius);
    let a = d.length_squared();
    let b = -f.dot(d);
    let nearest = f + d * (b / a);
    let discriminant = r * r - nearest.length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let q = b + (a * discriminant).sqrt().copysign(b);
    let length = f.length();
    let c = (length - r) * (length + r);
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
    Some(if t0 <= t1 { (t0, t1) } else { (t1, t0) })
}

/// The distance at which `ray` first meets the sphere, in (0, inf); `leaving` is true where the ray
/// starts on this very sphere, which it can then meet again only from inside.
#[inline]
#[must_use]
pub fn first_hit(ray: &Ray, center: Vec3, radius: f32, leaving: bool) -> Option<f32> {
    if leaving {
        let outwards = (ray.o - center).as_dvec3().dot(ray.d.as_dvec3()) >= 0.0;
        if outwards {
            return None;
        }
    }
    let met = intersect(ray, center, radius);
    let (t0, t1) = planted!(sphere_pq(met, ray.o, ray.d, center, radius))?;
    let t = if t0 > 0.0 && !leaving { t0 } else { t1 };
    let t = t as f32;
    (t > 0.0 && t < f32::INFINITY).then_some(t)
}

/// The point at distance `t`, moved onto the sphere, with a bound on the error of each coordinate (see
/// `offset_origin`), and the outward unit normal there.
#[inline]
#[must_use]
pub fn point(ray: &Ray, t: f32, center: Vec3, radius: f32) -> (Vec3, Vec3, Vec3) {
    let c = center.as_dvec3();
    let p = ray.o.as_dvec3() + ray.d.as_dvec3() * f64::from(t);
    let n = (p - c).try_normalize().unwrap_or(DVec3::Y);
    let p = (c + n * f64::from(radius)).as_vec3();
    (p, p.abs() * gamma(4), n.as_vec3())
}

//! Leaving spheres: N05 and N06.

use glam::Vec3;

use crate::bsdf::fresnel::Fresnel;
use crate::bsdf::{Glass, Transport};
use crate::check::random::Random;
use crate::check::surfaces::{aimed, tilted};
use crate::check::{Effort, Figure};
use crate::color::Rgb;
use crate::math::{Frame, ONE_MINUS_EPSILON};
use crate::shape::{Ray, offset_origin, sphere};

/// Index of refraction of the ball.
const IOR: f32 = 1.5;

/// The direction of `ray` after it went into a ball of glass and out of it; `None` where it misses or is
/// reflected.
fn through(ray: &Ray, center: Vec3, radius: f32) -> Option<Vec3> {
    let glass = Glass { ior: IOR, tint: Rgb::WHITE, thin: false, fresnel: Fresnel::Exact };
    let mut ray = *ray;
    for leaving in [false, true] {
        let t = sphere::first_hit(&ray, center, radius, leaving)?;
        let (p, p_err, n) = sphere::point(&ray, t, center, radius);
        let frame = Frame::from_z(n);
        // The last uniform number refracts wherever anything is refracted.
        let sample = glass.sample(frame.to_local(-ray.d), ONE_MINUS_EPSILON, Transport::Radiance)?;
        let w = frame.to_world(sample.wi).normalize();
        if sample.eta == 1.0 {
            return None;
        }
        ray = Ray::new(offset_origin(p, p_err, n, w), w);
    }
    Some(ray.d)
}

/// A ray from outside that passes the centre of the ball at up to 0.99 of its radius.
fn towards(r: &mut Random, center: Vec3, radius: f64) -> Option<Ray> {
    let axis = r.direction();
    let o = (center.as_dvec3() - axis.as_dvec3() * (radius * r.between(1.5, 4.0))).as_vec3();
    let aside = tilted(r, axis, 0.0).as_dvec3() * (radius * 0.99 * r.unit().sqrt());
    // Not aimed at the centre plane but parallel to the axis, so that the distance is what was drawn.
    aimed((o.as_dvec3() + aside).as_vec3(), center.as_dvec3() + aside)
}

/// The angle by which a ball deflects a ray: 2 (i - t), where n sin t = sin i = b / R.
fn closed_form(ray: &Ray, center: Vec3, radius: f32) -> f64 {
    let d = ray.d.as_dvec3();
    let f = ray.o.as_dvec3() - center.as_dvec3();
    let sin = f.cross(d).length() / d.length() / f64::from(radius);
    2.0 * (libm::asin(sin) - libm::asin(sin / f64::from(IOR)))
}

/// N05.
pub(super) fn deflection(effort: Effort) -> Vec<Figure> {
    let (mut r, n) = (Random::of("N05"), effort.trials(60_000));
    let mut figures = Vec::new();
    for radius in [1e-4f32, 1.0, 1e4] {
        let (mut worst, mut lost) = (0.0f64, 0u64);
        for _ in 0..n {
            let Some(ray) = towards(&mut r, Vec3::ZERO, radius.into()) else { continue };
            let Some(out) = through(&ray, Vec3::ZERO, radius) else {
                lost += 1;
                continue;
            };
            let (a, b) = (ray.d.as_dvec3(), out.as_dvec3());
            let angle = libm::atan2(a.cross(b).length(), a.dot(b));
            let expected = closed_form(&ray, Vec3::ZERO, radius);
            // Relative to the deflection at a tenth of the radius where that is more: the rounding of a
            // direction, 1e-7 rad, is a large share of a deflection near zero.
            worst = worst.max((angle - expected).abs() / expected.max(0.066_902_546));
        }
        figures.push(Figure::exactly(
            format!("of {n} rays lost or reflected, R = {radius:e} m"),
            lost as f64,
            0.0,
        ));
        figures.push(Figure::at_most(
            format!("largest relative error of the deflection of {n} rays, R = {radius:e} m"),
            worst,
            1e-5,
        ));
    }
    let n = effort.trials(500);
    let center = Vec3::new(1.5, -0.7, 2.0);
    let different: u64 = (0..n).map(|_| differs(&mut r, center)).sum();
    figures.push(Figure::exactly(
        format!("directions of {n} rays that are not the same bits at 40 other scales, R = 2^-20 to 2^20 m"),
        different as f64,
        0.0,
    ));
    figures
}

/// At how many scales by powers of two a ray leaves the ball in another direction.
fn differs(r: &mut Random, center: Vec3) -> u64 {
    let Some(ray) = towards(r, center, 1.0) else { return 0 };
    let expected = through(&ray, center, 1.0);
    let scaled = |k: i32| {
        let s = libm::exp2(f64::from(k)) as f32;
        through(&Ray { o: ray.o * s, ..ray }, center * s, s)
    };
    (-20..=20).filter(|&k| scaled(k) != expected).count() as u64
}

/// N06.
pub(super) fn outwards(effort: Effort) -> Vec<Figure> {
    let (mut r, n) = (Random::of("N06"), effort.trials(50_000));
    let mut figures = Vec::new();
    for (radius, away) in [(1e-4f32, 1.0f64), (1e-2, 1.0), (1.0, 10.0), (1.0, 1e4), (1e3, 1e4), (1e7, 2e7)] {
        let (mut again, mut unaware, mut inside) = (0u64, 0u64, 0u64);
        for _ in 0..n {
            let center = (r.direction().as_dvec3() * away).as_vec3();
            let Some(ray) = towards(&mut r, center, radius.into()) else { continue };
            let Some(t) = sphere::first_hit(&ray, center, radius, false) else { continue };
            let (p, p_err, normal) = sphere::point(&ray, t, center, radius);
            let w = outer(&mut r, normal);
            let ray = Ray::new(offset_origin(p, p_err, normal, w), w);
            again += u64::from(sphere::first_hit(&ray, center, radius, true).is_some());
            unaware += u64::from(sphere::first_hit(&ray, center, radius, false).is_some());
            let distance: f64 = (ray.o.as_dvec3() - center.as_dvec3()).length();
            inside += u64::from(distance < f64::from(radius));
        }
        let place = format!("R = {radius:e} m, {away:e} m away");
        figures.push(Figure::exactly(format!("self-hits of {n} rays, {place}"), again as f64, 0.0));
        figures.push(Figure::exactly(format!("origins of {n} inside, {place}"), inside as f64, 0.0));
        figures.push(Figure::exactly(
            format!("hits of {n} rays that do not know what they left, {place}"),
            unaware as f64,
            0.0,
        ));
    }
    figures
}

/// Uniform over the directions on the side of `n`.
fn outer(r: &mut Random, n: Vec3) -> Vec3 {
    let w = r.direction();
    if w.dot(n) < 0.0 { -w } else { w }
}

//! Spheres: a uniform cone of directions from outside, uniform by area from inside.

use glam::Vec3;

use super::SurfaceSample;
use crate::math::Frame;
use crate::sampling::warp::{square_to_cone, square_to_cone_pdf, square_to_sphere};
use crate::shape::{Ray, sphere};

/// An emissive sphere.
#[derive(Clone, Copy, Debug)]
pub struct SphereLight {
    /// World space.
    pub center: Vec3,
    /// Metres.
    pub radius: f32,
}

impl SphereLight {
    /// Area, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        4.0 * std::f64::consts::PI * f64::from(self.radius) * f64::from(self.radius)
    }

    /// 1 - cos of the half angle under which the sphere is seen from `p`, without cancellation;
    /// `None` from inside, and for a point that lies `on_it`, from which every other point of the sphere
    /// is seen from inside, whichever side rounding put the point on.
    fn one_minus_cos(&self, p: Vec3, on_it: bool) -> Option<f32> {
        let d2 = (self.center.as_dvec3() - p.as_dvec3()).length_squared();
        let sin2 = f64::from(self.radius) * f64::from(self.radius) / d2;
        (sin2 < 1.0 && !on_it).then(|| (sin2 / (1.0 + (1.0 - sin2).sqrt())) as f32)
    }

    /// The cone of directions from `p` to the sphere: its axis, and 1 - cos of its half angle; `None` from
    /// inside.
    #[must_use]
    pub fn cone(&self, p: Vec3) -> Option<(Vec3, f32)> {
        let one_minus_cos = self.one_minus_cos(p, false)?;
        let axis = (self.center.as_dvec3() - p.as_dvec3()).normalize().as_vec3();
        Some((axis, one_minus_cos))
    }

    /// A point of the sphere as seen from `p`; `on_it` says that `p` is a point of this very sphere.
    #[must_use]
    pub fn sample(&self, p: Vec3, on_it: bool, u: [f32; 2]) -> Option<SurfaceSample> {
        let Some(one_minus_cos) = self.one_minus_cos(p, on_it) else {
            let n = square_to_sphere(u);
            let q = self.center + n * self.radius;
            let pdf = super::set::area_pdf(p, q, n, self.area());
            let p_err = (self.center.abs() + Vec3::splat(self.radius)) * crate::math::gamma(5);
            return (pdf > 0.0 && pdf.is_finite()).then_some(SurfaceSample { p: q, p_err, n, pdf });
        };
        let axis = (self.center.as_dvec3() - p.as_dvec3()).normalize().as_vec3();
        let w = Frame::from_z(axis).to_world(square_to_cone(u, one_minus_cos)).normalize();
        let ray = Ray::new(p, w);
        // A direction at the rim may miss by rounding: the tangent point then.
        let t = sphere::first_hit(&ray, self.center, self.radius, false)
            .unwrap_or_else(|| (self.center - p).dot(w));
        let (q, p_err, n) = sphere::point(&ray, t, self.center, self.radius);
        Some(SurfaceSample { p: q, p_err, n, pdf: square_to_cone_pdf(one_minus_cos) })
    }

    /// Density per solid angle at `p` of [`Self::sample`] for the direction to the point `q` of the
    /// sphere with unit normal `n`.
    #[must_use]
    pub fn pdf(&self, p: Vec3, on_it: bool, q: Vec3, n: Vec3) -> f32 {
        match self.one_minus_cos(p, on_it) {
            Some(h) => square_to_cone_pdf(h),
            None => super::set::area_pdf(p, q, n, self.area()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N51: the cone's density is one over the solid angle 2 pi (1 - cos), also where r / d = 1e-6.
    #[test]
    fn density_is_one_over_the_solid_angle() {
        for (r, d) in [(1.0, 2.0), (1e-6, 1.0), (1.0, 1.0001), (1e-3, 50.0f32)] {
            let light = SphereLight { center: Vec3::Z * d, radius: r };
            let ratio = f64::from(r) / f64::from(d);
            let one_minus_cos = ratio * ratio / (1.0 + (1.0 - ratio * ratio).sqrt());
            let expected = 1.0 / (2.0 * std::f64::consts::PI * one_minus_cos);
            let s = light.sample(Vec3::ZERO, false, [0.3, 0.7]).expect("visible");
            assert!((f64::from(s.pdf) / expected - 1.0).abs() < 1e-5, "{r} {d}");
            let on_sphere = ((s.p - light.center).length() - r).abs() <= 4.0 * f32::EPSILON * d;
            assert!(on_sphere && light.pdf(Vec3::ZERO, false, s.p, s.n) == s.pdf);
        }
    }

    /// From inside, one over the densities averages to the whole sphere of directions.
    #[test]
    fn from_inside_all_directions_are_covered() {
        let light = SphereLight { center: Vec3::new(0.2, 0.1, 0.3), radius: 1.0 };
        let n = 300;
        let mut sum = 0.0;
        for i in 0..n * n {
            let u = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
            sum += 1.0 / f64::from(light.sample(Vec3::new(0.5, -0.2, 0.1), false, u).expect("inside").pdf);
        }
        let whole = 4.0 * std::f64::consts::PI;
        assert!((sum / f64::from(n * n) / whole - 1.0).abs() < 1e-4);
    }

    /// A point of the sphere lights itself: half of such points lie outside by rounding, and must see the
    /// inside all the same. The directions to the samples are then distributed as the cosine.
    #[test]
    fn a_point_of_the_sphere_sees_all_of_it() {
        let light = SphereLight { center: Vec3::new(0.2, 0.1, 0.3), radius: 1.0 };
        for scale in [1.0 - 2e-7, 1.0, 1.0 + 2e-7f32] {
            let n = Vec3::new(0.36, 0.48, 0.8);
            let p = light.center + n * scale;
            let (count, mut cos) = (256, 0.0);
            for i in 0..count * count {
                let u = [(i % count) as f32 + 0.5, (i / count) as f32 + 0.5].map(|x| x / count as f32);
                let s = light.sample(p, true, u).expect("another point");
                let w = (s.p - p).normalize();
                assert!((light.pdf(p, true, s.p, s.n) / s.pdf - 1.0).abs() < 1e-6);
                cos += f64::from(-w.dot(n));
            }
            assert!((cos / f64::from(count * count) - 2.0 / 3.0).abs() < 1e-3, "{scale} {cos}");
        }
    }
}

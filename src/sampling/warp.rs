//! Warps from the unit square, each with its density.
//!
//! `u` is uniform in [0, 1)^2; local frames have +Z up. Densities are per solid angle (or per area
//! where the name says so) and are exact for what the warp does, up to rounding.

use glam::{Vec2, Vec3};

use crate::math::{INV_PI, PI, safe_sqrt, sin_cos, sin_cos_turn};

/// Unit disk, uniform by area, with little distortion (Shirley and Chiu, JGT 2(3), 1997).
#[inline]
#[must_use]
pub fn square_to_disk(u: [f32; 2]) -> Vec2 {
    let (x, y) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if x == 0.0 && y == 0.0 {
        return Vec2::ZERO;
    }
    if x.abs() > y.abs() {
        let (s, c) = sin_cos((PI / 4.0) * (y / x));
        Vec2::new(x * c, x * s)
    } else {
        let (s, c) = sin_cos((PI / 4.0) * (x / y));
        Vec2::new(y * s, y * c)
    }
}

/// Upper hemisphere, density cos / pi (Malley's method).
#[inline]
#[must_use]
pub fn square_to_cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let d = square_to_disk(u);
    d.extend(safe_sqrt(1.0 - d.length_squared()))
}

/// Density of [`square_to_cosine_hemisphere`] at a direction with this cosine; zero below.
#[inline]
#[must_use]
pub fn square_to_cosine_hemisphere_pdf(cos: f32) -> f32 {
    cos.max(0.0) * INV_PI
}

/// Whole sphere, uniform.
#[inline]
#[must_use]
pub fn square_to_sphere(u: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * u[0];
    let r = safe_sqrt(1.0 - z * z);
    let (s, c) = sin_cos_turn(u[1]);
    Vec3::new(r * c, r * s, z)
}

/// Density of [`square_to_sphere`].
pub const SQUARE_TO_SPHERE_PDF: f32 = INV_PI / 4.0;

/// Cone about +Z, uniform. `one_minus_cos` is 1 - cos of its half angle, in (0, 2]; given that way it
/// keeps small cones accurate.
#[inline]
#[must_use]
pub fn square_to_cone(u: [f32; 2], one_minus_cos: f32) -> Vec3 {
    let h = u[0] * one_minus_cos;
    let r = safe_sqrt(h * (2.0 - h));
    let (s, c) = sin_cos_turn(u[1]);
    Vec3::new(r * c, r * s, 1.0 - h)
}

/// Density of [`square_to_cone`] inside the cone.
#[inline]
#[must_use]
pub fn square_to_cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos)
}

/// Barycentric coordinates (of the second and third vertex), uniform by area
/// (Heitz, "A Low-Distortion Map Between Triangle and Square", 2019).
#[inline]
#[must_use]
pub fn square_to_triangle(u: [f32; 2]) -> [f32; 2] {
    if u[1] > u[0] {
        let b = 0.5 * u[0];
        [b, u[1] - b]
    } else {
        let b = 0.5 * u[1];
        [u[0] - b, b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: u32) -> impl Iterator<Item = [f32; 2]> {
        let at = move |i| (i as f32 + 0.5) / n as f32;
        (0..n * n).map(move |k| [at(k % n), at(k / n)])
    }

    /// Each warp's mean direction or point is the one that its density implies.
    #[test]
    fn warps_have_the_mean_of_their_density() {
        let n = 256;
        let mean = |f: &dyn Fn([f32; 2]) -> Vec3| grid(n).map(f).sum::<Vec3>() / (n * n) as f32;
        let near = |a: Vec3, b: Vec3| (a - b).length() < 1e-3;
        assert!(near(mean(&|u| square_to_disk(u).extend(0.0)), Vec3::ZERO));
        assert!(near(mean(&square_to_cosine_hemisphere), Vec3::Z * (2.0 / 3.0)));
        assert!(near(mean(&square_to_sphere), Vec3::ZERO));
        assert!(near(mean(&|u| square_to_cone(u, 0.25)), Vec3::Z * 0.875));
        let third = 1.0 / 3.0;
        let triangle = |u| Vec2::from(square_to_triangle(u)).extend(0.0);
        assert!(near(mean(&triangle), Vec3::new(third, third, 0.0)));
        // Second moments tell uniform from merely centred.
        let r2 = grid(n).map(|u| square_to_disk(u).length_squared()).sum::<f32>() / (n * n) as f32;
        assert!((r2 - 0.5).abs() < 1e-4, "{r2}");
        let x2 = grid(n).map(|u| crate::math::sqr(square_to_triangle(u)[0])).sum::<f32>() / (n * n) as f32;
        assert!((x2 - 1.0 / 6.0).abs() < 1e-4, "{x2}");
    }
}

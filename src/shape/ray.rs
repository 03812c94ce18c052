//! Rays, and where they start.

use glam::Vec3;

use crate::mutants::planted;

/// A half line, or the part of it up to `t_max`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin, metres, world space.
    pub o: Vec3,
    /// Direction, unit.
    pub d: Vec3,
    /// Only hits nearer than this count, metres, (0, inf].
    pub t_max: f32,
}

impl Ray {
    /// The half line from `o` along the unit vector `d`.
    #[inline]
    #[must_use]
    pub fn new(o: Vec3, d: Vec3) -> Self {
        Self { o, d, t_max: f32::INFINITY }
    }

    /// The point at distance `t`.
    #[inline]
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.o + self.d * t
    }
}

/// Moves the surface point `p` off its surface, to the side that `w` points to.
///
/// `p_err` bounds the absolute error of each coordinate of `p`, and two units of rounding of that
/// coordinate on top; the exact surface point lies in that box, so a step of `|ng| . p_err` along the
/// unit normal `ng` clears the tangent plane (Pharr et al., "Physically Based Rendering", 4th ed.,
/// section 6.8.6), and the extra units keep it cleared when the sums are rounded. The step is
/// proportional to the coordinates: scale free.
#[inline]
#[must_use]
pub fn offset_origin(p: Vec3, p_err: Vec3, ng: Vec3, w: Vec3) -> Vec3 {
    let step = planted!(fixed_epsilon(planted!(origin_offset(ng.abs().dot(p_err)))));
    p + ng * step.copysign(w.dot(ng))
}

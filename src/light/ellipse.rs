//! Ellipses and disks, sampled by area.

use glam::Vec3;

use super::SurfaceSample;
use crate::math::gamma;
use crate::sampling::warp::square_to_disk;

/// A flat ellipse from its centre and two perpendicular half axes.
#[derive(Clone, Copy, Debug)]
pub struct Ellipse {
    /// Centre, world space.
    pub center: Vec3,
    /// Half axes, metres.
    pub half_axes: [Vec3; 2],
    /// Unit normal.
    pub n: Vec3,
}

impl Ellipse {
    /// Area, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        std::f64::consts::PI * f64::from(self.half_axes[0].length()) * f64::from(self.half_axes[1].length())
    }

    /// Whether the point `p` of its plane lies within the outline.
    #[must_use]
    pub fn contains(&self, p: Vec3) -> bool {
        let d = p - self.center;
        let along = |axis: Vec3| {
            let length = axis.length();
            d.dot(axis / length) / length
        };
        let (a, b) = (along(self.half_axes[0]), along(self.half_axes[1]));
        a * a + b * b <= 1.0
    }

    /// A point of the ellipse as seen from `p`; `None` where `p` lies in its plane.
    #[must_use]
    pub fn sample(&self, p: Vec3, u: [f32; 2]) -> Option<SurfaceSample> {
        let s = self.at(u, 1.0);
        let pdf = self.pdf(p, s.p);
        (pdf > 0.0 && pdf.is_finite()).then_some(SurfaceSample { pdf, ..s })
    }

    /// A point, uniform by area.
    pub(super) fn at(&self, u: [f32; 2], pdf: f32) -> SurfaceSample {
        let d = square_to_disk(u);
        let (a, b) = (self.half_axes[0] * d.x, self.half_axes[1] * d.y);
        let p_err = (self.center.abs() + a.abs() + b.abs()) * gamma(7);
        SurfaceSample { p: self.center + a + b, p_err, n: self.n, pdf }
    }

    /// Density per solid angle at `p` of [`Self::sample`] for the direction to its point `q`.
    #[must_use]
    pub fn pdf(&self, p: Vec3, q: Vec3) -> f32 {
        super::set::area_pdf(p, q, self.n, self.area())
    }
}

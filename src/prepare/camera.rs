//! Where camera rays start.

use glam::{DVec3, Vec2, Vec3};

use crate::mutants::planted;
use crate::scene::{Camera, FovAxis, Projection};
use crate::shape::Ray;

/// A camera with the constants of one picture size.
#[derive(Clone, Debug)]
pub struct CameraRays {
    origin: DVec3,
    right: DVec3,
    up: DVec3,
    back: DVec3,
    /// Extent of the picture in camera space at distance one (perspective) or at all (orthographic).
    extent: [f64; 2],
    /// Offset of the picture's middle, the same units.
    shift: [f64; 2],
    size: [f64; 2],
    orthographic: bool,
    lens: Option<(f64, f64)>,
}

impl CameraRays {
    /// The rays of `camera` for a picture of `size` pixels.
    #[must_use]
    pub fn new(camera: &Camera, size: [u32; 2]) -> Self {
        let m = camera.transform.matrix3;
        let unit = |v: DVec3| v.try_normalize().unwrap_or(DVec3::ZERO);
        let size = size.map(f64::from);
        let (side, axis, orthographic) = match camera.projection {
            Projection::Perspective { fov, axis } => (2.0 * libm::tan(0.5 * fov), axis, false),
            Projection::Orthographic { extent, axis } => (extent, axis, true),
        };
        let extent = match axis {
            FovAxis::Horizontal => [side, side * size[1] / size[0]],
            FovAxis::Vertical => [side * size[0] / size[1], side],
        };
        Self {
            origin: camera.transform.translation,
            right: unit(m.x_axis),
            up: unit(m.y_axis),
            back: unit(m.z_axis),
            extent,
            shift: camera.shift.map(|s| s * side),
            size,
            orthographic,
            lens: camera.lens.filter(|l| l.radius > 0.0).map(|l| (l.radius, l.focus_distance)),
        }
    }

    /// The same rays from one point.
    #[must_use]
    pub(super) fn pinhole(self) -> Self {
        Self { lens: None, ..self }
    }

    /// The ray through the point `offset` in [0, 1)^2 of a pixel (top left is its origin), from the
    /// point `lens` of the unit disk scaled to the aperture.
    #[inline]
    #[must_use]
    pub fn ray(&self, pixel: [u32; 2], offset: [f32; 2], lens: impl FnOnce() -> Vec2) -> Ray {
        let x = (f64::from(pixel[0]) + f64::from(planted!(filter_shift(offset[0])))) / self.size[0] - 0.5;
        let y = 0.5 - (f64::from(pixel[1]) + f64::from(planted!(filter_shift(offset[1])))) / self.size[1];
        let x = x * self.extent[0] + self.shift[0];
        let y = y * self.extent[1] + self.shift[1];
        let (mut o, mut d) = if self.orthographic {
            (self.right * x + self.up * y, -self.back)
        } else {
            (DVec3::ZERO, self.right * x + self.up * y - self.back)
        };
        if let Some((radius, focus)) = self.lens {
            let l = lens();
            let from = self.right * (radius * f64::from(l.x)) + self.up * (radius * f64::from(l.y));
            // The point in focus stays where it is.
            d = (o + d * focus) - (o + from);
            o += from;
        }
        Ray::new((self.origin + o).as_vec3(), d.normalize().as_vec3())
    }

    /// Distance of `p` from the camera's plane along the view axis, metres.
    #[must_use]
    pub fn depth(&self, p: Vec3) -> f32 {
        -(p.as_dvec3() - self.origin).dot(self.back) as f32
    }
}

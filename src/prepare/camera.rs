//! Where camera rays start.

use glam::{DVec3, Vec2, Vec3};

use crate::mutants::planted;
use crate::scene::{Camera, FovAxis, Projection};
use crate::shape::Ray;

/// How a camera sees a point.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The pixel, of the whole picture.
    pub pixel: [u32; 2],
    /// Unit direction from the point to where camera rays start.
    pub wo: Vec3,
    /// Where the camera ray starts.
    pub origin: Vec3,
    /// What a watt per steradian of intensity at the point, sent along `wo`, adds to the radiance of the
    /// pixel, m^-2: the density of camera rays through the pixel at the point, per area across `wo`.
    pub importance: f32,
}

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

    /// How the point `p` is seen from the point `lens` of the unit disk scaled to the aperture; `None`
    /// where it lies outside of the picture or behind.
    ///
    /// A pixel is the mean of the radiance over its area on the plane at distance one; that area, seen from
    /// the aperture under the angle t to the axis, is the solid angle times 1 / cos^3 t.
    #[must_use]
    pub fn see(&self, p: Vec3, lens: impl FnOnce() -> Vec2) -> Option<Seen> {
        let d = p.as_dvec3() - self.origin;
        let (x, y, z) = (d.dot(self.right), d.dot(self.up), -d.dot(self.back));
        if z <= 0.0 {
            return None;
        }
        let (lx, ly, focus) = match self.lens {
            Some((radius, focus)) => {
                let l = lens();
                (radius * f64::from(l.x), radius * f64::from(l.y), focus)
            }
            None => (0.0, 0.0, 1.0),
        };
        // Where the ray starts, relative to the middle of the lens, and where it passes the picture's plane.
        let ((ox, oy), (sx, sy)) = if self.orthographic {
            // All rays from one point of the lens are parallel.
            let s = (x + (z / focus - 1.0) * lx, y + (z / focus - 1.0) * ly);
            ((s.0 + lx, s.1 + ly), s)
        } else {
            ((lx, ly), ((x - lx) / z + lx / focus, (y - ly) / z + ly / focus))
        };
        let i = ((sx - self.shift[0]) / self.extent[0] + 0.5) * self.size[0];
        let j = (0.5 - (sy - self.shift[1]) / self.extent[1]) * self.size[1];
        if !(i >= 0.0 && i < self.size[0] && j >= 0.0 && j < self.size[1]) {
            return None;
        }
        let to = self.right * (ox - x) + self.up * (oy - y) + self.back * z;
        let distance = to.length();
        let cos = z / distance;
        let pixel_area = self.extent[0] * self.extent[1] / (self.size[0] * self.size[1]);
        let importance = if self.orthographic {
            1.0 / (cos * pixel_area)
        } else {
            1.0 / (distance * distance * cos * cos * cos * pixel_area)
        };
        Some(Seen {
            pixel: [i as u32, j as u32],
            wo: (to / distance).as_vec3(),
            origin: (self.origin + self.right * ox + self.up * oy).as_vec3(),
            importance: importance as f32,
        })
    }

    /// Width of a pixel at the point `p`, or as far away as that, metres; `nearest` bounds the distance
    /// from below.
    #[must_use]
    pub fn footprint(&self, p: Vec3, nearest: f32) -> f32 {
        let width = (self.extent[0] * self.extent[1] / (self.size[0] * self.size[1])).sqrt();
        if self.orthographic {
            return width as f32;
        }
        let distance = (p.as_dvec3() - self.origin).length();
        (width * distance.max(f64::from(nearest))) as f32
    }

    /// Distance of `p` from the point where camera rays start, or its middle, metres.
    #[must_use]
    pub fn distance(&self, p: Vec3) -> f32 {
        (p.as_dvec3() - self.origin).length() as f32
    }

    /// Distance of `p` from the camera's plane along the view axis, metres.
    #[must_use]
    pub fn depth(&self, p: Vec3) -> f32 {
        -(p.as_dvec3() - self.origin).dot(self.back) as f32
    }
}

#[cfg(test)]
mod tests {
    use glam::DAffine3;

    use super::*;
    use crate::scene::Lens;

    fn cameras() -> Vec<Camera> {
        let transform = DAffine3::from_rotation_translation(
            glam::DQuat::from_euler(glam::EulerRot::YXZ, 0.7, -0.3, 0.2),
            DVec3::new(1.0, -2.0, 0.5),
        );
        let mut list = Vec::new();
        let perspective = Projection::Perspective { fov: 0.9, axis: FovAxis::Horizontal };
        for projection in [perspective, Projection::Orthographic { extent: 3.0, axis: FovAxis::Vertical }] {
            for lens in [None, Some(Lens { radius: 0.3, focus_distance: 2.5 })] {
                let (name, shift, aspect) = ("c".to_owned(), [0.2, -0.1], None);
                list.push(Camera { name, transform, projection, shift, lens, aspect });
            }
        }
        list
    }

    /// Guards that a camera sees a point in the pixel, and from where, that the ray to it passes; and that its
    /// importance is one over the area which the pixel has on a plane there that faces the camera.
    #[test]
    fn a_point_is_seen_where_its_ray_passes() {
        let size = [17, 11];
        for camera in cameras() {
            let rays = CameraRays::new(&camera, size);
            for (i, t) in [(0u32, 0.5f32), (40, 1.7), (100, 9.0), (186, 2.5)] {
                let pixel = [i % size[0], i / size[0]];
                let lens = Vec2::new(0.4, -0.7);
                let ray = rays.ray(pixel, [0.3, 0.6], || lens);
                let p = ray.at(t);
                let seen = rays.see(p, || lens).expect("in view");
                assert_eq!(seen.pixel, pixel, "{camera:?}");
                assert!((seen.wo + ray.d).length() < 1e-5 && (seen.origin - ray.o).length() < 1e-5);
                // Neighbouring rays through one point of the lens, on the plane through p.
                let on_plane = |x: f32, y: f32| {
                    let r = rays.ray(pixel, [x, y], || lens);
                    let n = rays.back.as_vec3();
                    r.o + r.d * ((p - r.o).dot(n) / r.d.dot(n))
                };
                let corner = on_plane(0.0, 0.0);
                let area = (on_plane(1.0, 0.0) - corner).cross(on_plane(0.0, 1.0) - corner).length();
                let cos = seen.wo.dot(rays.back.as_vec3());
                let product = seen.importance * cos * area;
                assert!((product - 1.0).abs() < 2e-3, "{camera:?}: {product}");
            }
            let behind = (rays.origin + rays.back).as_vec3();
            assert!(rays.see(behind, || Vec2::ZERO).is_none());
            let beside = (rays.origin - rays.back + rays.right * 9.0).as_vec3();
            assert!(rays.see(beside, || Vec2::ZERO).is_none());
        }
    }
}

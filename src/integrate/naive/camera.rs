//! Cameras of the reference integrator: a pixel and random numbers in, a world-space ray out.

use glam::{DMat3, DVec3};

use super::Ray;
use super::rng::Rng;
use crate::scene::{Camera, FovAxis, Lens, Projection};

/// A ray through a uniform point of pixel (`x`, `y`) of a picture of `size` pixels; row 0 is on top.
pub(super) fn camera_ray(camera: &Camera, size: [u32; 2], [x, y]: [u32; 2], rng: &mut Rng) -> Ray {
    let [w, h] = size.map(f64::from);
    // Position in the picture: the middle is zero, each side is one long, y up.
    let sx = (f64::from(x) + rng.uniform()) / w - 0.5;
    let sy = 0.5 - (f64::from(y) + rng.uniform()) / h;
    let [shift_x, shift_y] = camera.shift;
    // The same, in units of the side that the projection names.
    let plane = |axis: FovAxis| match axis {
        FovAxis::Horizontal => DVec3::new(sx + shift_x, sy * h / w + shift_y, 0.0),
        FovAxis::Vertical => DVec3::new(sx * w / h + shift_x, sy + shift_y, 0.0),
    };
    // A pinhole ray, parametrised so that one unit of `d` is one metre along -Z.
    let (mut o, mut d) = match camera.projection {
        Projection::Perspective { fov, axis } => {
            (DVec3::ZERO, 2.0 * libm::tan(0.5 * fov) * plane(axis) - DVec3::Z)
        }
        Projection::Orthographic { extent, axis } => (extent * plane(axis), -DVec3::Z),
    };
    // A lens moves the origin and keeps the point in focus.
    if let Some(Lens { radius, focus_distance }) = camera.lens {
        let focus = o + focus_distance * d;
        let [lens_x, lens_y] = rng.disk();
        o += radius * DVec3::new(lens_x, lens_y, 0.0);
        d = focus - o;
    }
    // Scale in the transform is ignored.
    let [a, b, c] = [0, 1, 2].map(|i| camera.transform.matrix3.col(i).normalize_or_zero());
    let rotation = DMat3::from_cols(a, b, c);
    Ray::new(camera.transform.translation + rotation * o, rotation * d)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards pixel to direction: corners, axis, shift, row order, and rotation without scale.
    #[test]
    fn pixels_map_to_directions() {
        let camera = |projection, shift| Camera {
            name: String::new(),
            transform: glam::DAffine3::from_scale(DVec3::splat(3.0)),
            projection,
            shift,
            lens: None,
            aspect: None,
        };
        // A pixel so small that its extent does not matter: 2^20 on each side.
        let n = 1 << 20;
        let check = |camera: &Camera, pixel, o: DVec3, d: DVec3| {
            let ray = camera_ray(camera, [n, n / 2], pixel, &mut Rng::new(1, 2, 3));
            assert!(ray.origin.distance(o) < 1e-5, "{ray:?}");
            assert!(ray.direction.distance(d.normalize()) < 1e-5, "{ray:?}");
        };
        let fov = 2.0 * libm::atan(0.5);
        let wide = camera(Projection::Perspective { fov, axis: FovAxis::Horizontal }, [0.0; 2]);
        check(&wide, [n / 2, n / 4], DVec3::ZERO, -DVec3::Z);
        check(&wide, [0, 0], DVec3::ZERO, DVec3::new(-0.5, 0.25, -1.0));
        check(&wide, [n - 1, n / 2 - 1], DVec3::ZERO, DVec3::new(0.5, -0.25, -1.0));
        let tall = camera(Projection::Perspective { fov, axis: FovAxis::Vertical }, [0.1, 0.2]);
        check(&tall, [0, 0], DVec3::ZERO, DVec3::new(-0.9, 0.7, -1.0));
        let flat = camera(Projection::Orthographic { extent: 4.0, axis: FovAxis::Horizontal }, [0.0; 2]);
        check(&flat, [0, 0], DVec3::new(-2.0, 1.0, 0.0), -DVec3::Z);
    }

    /// Guards the lens: all rays of a pixel meet in the plane of focus, from all over the aperture.
    #[test]
    fn lens_rays_meet_in_focus() {
        let camera = Camera {
            name: String::new(),
            transform: glam::DAffine3::IDENTITY,
            projection: Projection::Perspective { fov: 1.0, axis: FovAxis::Horizontal },
            shift: [0.0; 2],
            lens: Some(Lens { radius: 0.5, focus_distance: 3.0 }),
            aspect: None,
        };
        let n = 1 << 24;
        let mut widest: f64 = 0.0;
        for i in 0..1000 {
            let ray = camera_ray(&camera, [n, n], [n / 4, n / 2], &mut Rng::new(0, 0, i));
            let at = ray.origin + ray.direction * (-3.0 / ray.direction.z);
            assert!(at.distance(DVec3::new(-1.5 * libm::tan(0.5), 0.0, -3.0)) < 1e-5, "{at}");
            widest = widest.max(ray.origin.length());
        }
        assert!(widest <= 0.5 && widest > 0.49);
    }
}

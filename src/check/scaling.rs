//! Scenes at another scale.

use glam::{DAffine3, DVec3};

use crate::color::Rgb;
use crate::scene::{LightKind, MaterialKind, Projection, Scene, Shape};

/// The scene with lengths times 2^`k`, and watts and watts per steradian times 4^`k`: vertices,
/// translations, radii, extents, lens, focus and absorption distances. Irradiance and radiance stay.
///
/// Every product is exact, so that a renderer without absolute lengths makes the same picture of it. Suns and
/// environments have no lengths and stay.
#[must_use]
pub fn scaled(scene: &Scene, k: i32) -> Scene {
    let s = libm::exp2(f64::from(k));
    let place = |t: &mut DAffine3| t.translation *= s;
    let intensity = |c: Rgb| c * (s * s) as f32;
    let mut scene = scene.clone();
    for mesh in &mut scene.meshes {
        mesh.positions.iter_mut().for_each(|p| *p *= s as f32);
    }
    for object in &mut scene.objects {
        place(&mut object.transform);
        if let Shape::Sphere { radius } = &mut object.shape {
            *radius *= s;
        }
    }
    for material in &mut scene.materials {
        let absorption = match &mut material.kind {
            MaterialKind::Glass(g) => &mut g.absorption,
            MaterialKind::Principled(p) => &mut p.absorption,
            _ => continue,
        };
        if let Some(a) = absorption {
            a.distance *= s as f32;
        }
    }
    for light in &mut scene.lights {
        place(&mut light.transform);
        light.kind = match light.kind {
            LightKind::Point { intensity: i, radius } => {
                LightKind::Point { intensity: intensity(i), radius: radius * s }
            }
            LightKind::Spot { intensity: i, inner, outer, falloff, radius } => {
                LightKind::Spot { intensity: intensity(i), inner, outer, falloff, radius: radius * s }
            }
            LightKind::Area { shape, size, radiance } => {
                LightKind::Area { shape, size: size.map(|x| x * s), radiance }
            }
            sun @ LightKind::Sun { .. } => sun,
        };
    }
    for camera in &mut scene.cameras {
        place(&mut camera.transform);
        if let Projection::Orthographic { extent, .. } = &mut camera.projection {
            *extent *= s;
        }
        if let Some(lens) = &mut camera.lens {
            lens.radius *= s;
            lens.focus_distance *= s;
        }
    }
    scene
}

/// `scene` somewhere else.
#[must_use]
pub(super) fn moved(scene: &Scene, by: DVec3) -> Scene {
    let mut scene = scene.clone();
    scene.objects.iter_mut().for_each(|o| o.transform.translation += by);
    scene.lights.iter_mut().for_each(|l| l.transform.translation += by);
    scene.cameras.iter_mut().for_each(|c| c.transform.translation += by);
    scene
}

//! What a scene gets that lacks light or a camera.
//!
//! In: a valid scene. Out: a scene that shows something, and a note for each addition, which says how
//! to replace it. A scene that has both comes out untouched.

use glam::{DAffine3, DVec3};

use super::text::look_along;
use super::{Camera, Environment, FovAxis, LightKind, Note, NoteEffect, Projection, Scene, Shape};
use crate::color::Rgb;

/// Name of the environment that lights a scene without light.
pub const DEFAULT_DOME: &str = "default dome";
/// Name of the camera of a scene without one.
pub const DEFAULT_CAMERA: &str = "default camera";
/// Angle over the shorter side of the picture, degrees.
const DEFAULT_FOV: f64 = 40.0;
/// From the middle of the scene to the camera: in front, to the right, and above.
const DEFAULT_VIEW: DVec3 = DVec3::new(1.0, 0.75, 1.5);
/// Space around the scene's bounding sphere.
const MARGIN: f64 = 1.05;

/// Adds what a scene needs to be seen, each with a note:
/// - where nothing emits (no material on any surface, no light, no environment with power), a white
///   environment of radiance 1, named [`DEFAULT_DOME`], in place of a black environment;
/// - where there is no camera, one of 40 degrees that frames all objects from the front, right and
///   above, named [`DEFAULT_CAMERA`].
pub fn complete(scene: &mut Scene) -> Vec<Note> {
    let mut notes = Vec::new();
    let mut note = |code, message: &str| {
        notes.push(Note {
            code,
            place: String::new(),
            message: message.to_owned(),
            effect: NoteEffect::Differs,
        });
    };
    if !emits(scene) {
        scene.environment = Some(Environment {
            name: DEFAULT_DOME.to_owned(),
            radiance: Rgb::WHITE,
            image: None,
            visible_to_camera: true,
        });
        note(
            "default-dome",
            "nothing in the scene emits light: it is lit by the default dome, white of radiance 1",
        );
    }
    if scene.cameras.is_empty() {
        scene.cameras.push(default_camera(scene));
        note("default-camera", "the scene has no camera: the default camera frames all of its objects");
    }
    notes
}

fn emits(scene: &Scene) -> bool {
    let lit = |c: Rgb| !c.is_black();
    let surfaces = scene.objects.iter().any(|o| {
        let has_area = match o.shape {
            Shape::Mesh(id) => scene.meshes.get(id.0 as usize).is_some_and(|m| !m.triangles.is_empty()),
            Shape::Sphere { .. } => true,
        };
        has_area && scene.materials.get(o.material.0 as usize).is_some_and(|m| m.kind.emission().is_some())
    });
    let lights = scene.lights.iter().any(|l| match l.kind {
        LightKind::Point { intensity, .. } | LightKind::Spot { intensity, .. } => lit(intensity),
        LightKind::Sun { irradiance, .. } => lit(irradiance),
        LightKind::Area { radiance, .. } => lit(radiance),
    });
    surfaces || lights || scene.environment.as_ref().is_some_and(|e| lit(e.radiance))
}

fn default_camera(scene: &Scene) -> Camera {
    let (center, radius) = bounding_sphere(scene);
    let direction = DEFAULT_VIEW.normalize();
    let half = (0.5 * DEFAULT_FOV).to_radians();
    let eye = center + direction * (MARGIN * radius / libm::sin(half));
    let axis = match scene.settings.size {
        Some([w, h]) if w < h => FovAxis::Horizontal,
        _ => FovAxis::Vertical,
    };
    Camera {
        name: DEFAULT_CAMERA.to_owned(),
        // The view is not along +Y, so there is a transform.
        transform: look_along(eye, -direction, DVec3::Y).unwrap_or(DAffine3::IDENTITY),
        projection: Projection::Perspective { fov: DEFAULT_FOV.to_radians(), axis },
        shift: [0.0; 2],
        lens: None,
        aspect: None,
    }
}

/// The sphere around the box around all objects; a unit sphere where there are none.
fn bounding_sphere(scene: &Scene) -> (DVec3, f64) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut cover = |p: DVec3, margin: f64| {
        low = low.min(p - margin);
        high = high.max(p + margin);
    };
    for object in &scene.objects {
        match object.shape {
            Shape::Sphere { radius } => {
                cover(object.transform.translation, radius * object.transform.matrix3.x_axis.length());
            }
            Shape::Mesh(id) => {
                let Some(mesh) = scene.meshes.get(id.0 as usize) else { continue };
                let used = mesh.triangles.iter().flatten().filter_map(|&i| mesh.positions.get(i as usize));
                used.for_each(|p| cover(object.transform.transform_point3(p.as_dvec3()), 0.0));
            }
        }
    }
    let radius = 0.5 * low.distance(high);
    if radius.is_finite() && radius > 0.0 { ((low + high) * 0.5, radius) } else { (DVec3::ZERO, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::text::parse;

    fn completed(source: &str) -> (Scene, Vec<&'static str>) {
        let (mut scene, _) = parse(source).unwrap_or_else(|e| panic!("{e}"));
        let notes = complete(&mut scene);
        (scene, notes.iter().map(|n| n.code).collect())
    }

    const BALL: &str = "epsilux = 1\nmaterial.m = { diffuse = [1, 1, 1] }\nmaterial.unused = { light = [1, 1, 1] }\n\
                        [[object]]\nmaterial = 'm'\nsphere = { center = [3, 0, 0], radius = 2 }\n";

    #[test]
    fn a_scene_without_light_and_camera_gets_both_light_first() {
        let (scene, notes) = completed(BALL);
        assert_eq!(notes, ["default-dome", "default-camera"]);
        let dome = scene.environment.as_ref().unwrap();
        assert_eq!((dome.name.as_str(), dome.radiance), (DEFAULT_DOME, Rgb::WHITE));
        let camera = &scene.cameras[0];
        // The middle of the ball is in the middle of the picture, and the ball fits in with its margin.
        let middle = camera.transform.inverse().transform_point3(DVec3::new(3.0, 0.0, 0.0));
        assert!(middle.truncate().length() < 1e-12);
        let half_angle = libm::asin(2.0 / -middle.z).to_degrees();
        assert!(half_angle < 20.0 && half_angle > 10.0, "{half_angle}");
    }

    #[test]
    fn only_what_emits_counts_as_light() {
        let check = |extra: &str, expected: bool| {
            let (_, notes) = completed(&format!("{BALL}{extra}"));
            assert_eq!(!notes.contains(&"default-dome"), expected, "{extra}");
        };
        check("[[object]]\nmaterial = 'unused'\nsphere = { radius = 1 }", true);
        check("[[object]]\nmaterial = 'unused'\nmesh = { positions = [], triangles = [] }", false);
        check("[[light]]\npoint = { intensity = [0, 0, 0] }", false);
        check("[[light]]\nsun = { irradiance = [0, 1, 0] }", true);
        check("[environment]\nradiance = [0, 0, 0]", false);
        check("[environment]\nradiance = [0, 0, 0.1]", true);
    }

    #[test]
    fn a_scene_without_objects_still_completes() {
        let (scene, notes) = completed("epsilux = 1");
        assert_eq!(notes.len(), 2);
        assert!(scene.cameras[0].transform.is_finite());
    }
}

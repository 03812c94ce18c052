//! Light on a white diffuse point: squares (O04, O05), a disk (O06), spheres (O07), and lights without
//! extent. The point's radiance is the irradiance over pi; the list has irradiances.

use std::f64::consts::{FRAC_PI_4, PI};

use epsilux::color::Rgb;
use epsilux::glam::{DAffine3, DVec3};
use epsilux::scene::{AreaShape, LightKind, Scene, SpotFalloff};

use super::{Build, Case, absorber, diffuse, emitter, facing, look_at};
use epsilux::check::closed_forms::{disk_irradiance, polygon_irradiance, sphere_irradiance};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for as_surface in [true, false] {
        let square = |id: &str, center, tilt| square(id, center, tilt, as_surface);
        let aside = DVec3::new(0.25, 0.0, 1.0);
        cases.extend([
            square("O04 a", DVec3::Z, 0.0).listed_irradiance(0.752_274_688),
            square("O04 b", DVec3::new(1.0, 0.5, 1.0), 0.0)
                .listed_irradiance(0.215_455_970)
                .samples(2_000_000),
            square("O04 c", 0.01 * DVec3::Z, 0.0).listed_irradiance(3.140_564_683),
            square("O04 d", aside, 30.0).listed_irradiance(0.673_495_767),
            square("O04 e", aside, 90.0).listed_irradiance(0.159_242_507).samples(4_000_000),
        ]);
    }
    let listed =
        [(4.0, 0.979_612_178), (16.0, 0.998_699_694), (64.0, 0.999_918_627), (1024.0, 0.999_999_682)];
    for (d, value) in listed {
        let case = square(&format!("O05 distance {d}"), d * DVec3::Z, 0.0, true);
        let scaled = case.expected * PI * d * d;
        assert!((scaled - value).abs() < 1e-8, "{}: {scaled} is listed as {value}", case.id);
        cases.push(case.samples(if d < 10.0 { 8_000_000 } else { 0 }));
    }
    cases.extend([
        disk().listed_irradiance(0.628_318_531),
        sphere("O07 a", 0.5, 1.0, 0.0).listed_irradiance(FRAC_PI_4),
        sphere("O07 b", 0.5, 1.0, 45.0).listed_irradiance(0.555_360_367).samples(1_000_000),
        sphere("O07 c", 0.5, 1.0, 80.0).listed_irradiance(0.171_831_975).samples(2_000_000),
        sphere("O07 d", 0.5, 1.0, 90.0).listed_irradiance(0.090_586_074).samples(4_000_000),
        sphere("O07 e", 0.5, 1.0, 110.0).listed_irradiance(0.006_753_066).samples(0),
        sphere("O07 f", 1.0, 1.001, 90.0).listed_irradiance(1.481_450_382),
        sphere("O07 g", 1e-6, 1.0, 60.0).listed_irradiance(1.570_796e-12).samples(0),
        sphere("O07 h", 1.0, 1.0001, 0.0).listed_irradiance(3.140_964_429),
        sphere_light(),
        point_light(),
        spot_light(SpotFalloff::Gltf),
        spot_light(SpotFalloff::Blender),
        sun(0.0),
        sun(1.0),
        inside_a_medium(),
    ]);
    cases
}

/// A white receiver at the origin, tilted towards +X by `tilt` radians. It is small, to stand clear of
/// the lights; the ray avoids its diagonal.
fn receiver(id: impl Into<String>, mut scene: Scene, tilt: f64, irradiance: f64) -> Case {
    let n = tilted(tilt);
    scene.square(DVec3::ZERO, n, 1e-3, diffuse(1.0));
    let aside = 1e-6 * n.any_orthonormal_vector();
    Case::new(id, scene, look_at(aside, n, 1e-5), irradiance / PI).depth(1).samples(500_000)
}

fn tilted(tilt: f64) -> DVec3 {
    DVec3::new(libm::sin(tilt), 0.0, libm::cos(tilt))
}

/// A unit square of radiance one that shines down.
fn square(id: &str, center: DVec3, tilt_degrees: f64, as_surface: bool) -> Case {
    let tilt = tilt_degrees.to_radians();
    let mut scene = Scene::default();
    if as_surface {
        scene.quad(center, DVec3::Y, DVec3::X, emitter(1.0));
    } else {
        let kind = LightKind::Area { shape: AreaShape::Rectangle, size: [1.0; 2], radiance: Rgb::WHITE };
        scene.light(kind, DAffine3::from_translation(center));
    }
    let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    let corners = corners.map(|(x, y)| center + DVec3::new(x, y, 0.0));
    let id = format!("{id}{}", if as_surface { "" } else { " area light" });
    receiver(id, scene, tilt, polygon_irradiance(&corners, tilted(tilt)))
}

/// A disk that the receiver faces, scaled by its transform.
fn disk() -> Case {
    let mut scene = Scene::default();
    let kind = LightKind::Area { shape: AreaShape::Ellipse, size: [0.5; 2], radiance: Rgb::WHITE };
    scene.light(kind, DAffine3::from_translation(DVec3::Z) * DAffine3::from_scale(DVec3::splat(2.0)));
    receiver("O06", scene, 0.0, disk_irradiance(0.5, 1.0))
}

/// An emitting sphere above the receiver.
fn sphere(id: &str, radius: f64, distance: f64, tilt_degrees: f64) -> Case {
    let tilt = tilt_degrees.to_radians();
    let mut scene = Scene::default();
    scene.sphere(distance * DVec3::Z, radius, emitter(1.0));
    receiver(id, scene, tilt, sphere_irradiance(radius, distance, tilt))
}

/// The same as a point light with a radius.
fn sphere_light() -> Case {
    let mut scene = Scene::default();
    let intensity = Rgb::grey((PI * 0.25) as f32);
    scene.light(LightKind::Point { intensity, radius: 0.5 }, DAffine3::from_translation(DVec3::Z));
    receiver("O07 b point light", scene, 45f64.to_radians(), sphere_irradiance(0.5, 1.0, 45f64.to_radians()))
        .samples(1_000_000)
}

/// I cos / d^2.
fn point_light() -> Case {
    let mut scene = Scene::default();
    let position = DAffine3::from_translation(3.0 * DVec3::Z);
    scene.light(LightKind::Point { intensity: Rgb::grey(18.0), radius: 0.0 }, position);
    receiver("point light", scene, 60f64.to_radians(), 1.0).samples(1)
}

/// A spot that looks past the receiver by half its cone, in the cosine.
fn spot_light(falloff: SpotFalloff) -> Case {
    let mut scene = Scene::default();
    // Cosines of the inner, the actual and the outer half angle: 1, 0.9, 0.8; Blender's ramp runs over
    // (1 - 0.8) (1 - inner/outer), which is the same for inner = 0.
    let outer = libm::acos(0.8);
    let kind = LightKind::Spot { intensity: Rgb::grey(4.0), inner: 0.0, outer, falloff, radius: 0.0 };
    let off_axis = libm::acos(0.9);
    scene.light(kind, facing(2.0 * DVec3::Z, tilted(off_axis)));
    let factor = match falloff {
        SpotFalloff::Gltf => 0.25,
        SpotFalloff::Blender => 0.5,
    };
    receiver(format!("spot light {falloff:?}"), scene, 0.0, factor).samples(1)
}

/// Irradiance times the cosine, whatever the angle of the disk, while all of it is above the horizon.
fn sun(angle: f64) -> Case {
    let mut scene = Scene::default();
    scene.light(LightKind::Sun { irradiance: Rgb::grey(2.0), angle }, facing(DVec3::ZERO, DVec3::Z));
    receiver(format!("sun of angle {angle}"), scene, 60f64.to_radians(), 1.0).samples(2_000_000)
}

/// A point light and a receiver inside an absorber that does not refract: one half is left after a
/// metre, and both the camera's segment and the shadow ray run half a metre in it.
fn inside_a_medium() -> Case {
    let mut scene = Scene::default();
    scene.sphere(DVec3::ZERO, 1.0, absorber(0.5, 1.0));
    scene.square(DVec3::new(0.0, 0.0, -0.5), DVec3::Z, 0.1, diffuse(1.0));
    let intensity = Rgb::grey(0.25);
    scene.light(LightKind::Point { intensity, radius: 0.0 }, DAffine3::IDENTITY);
    let n = DVec3::new(0.0, -0.6, 0.8);
    let at = DVec3::new(1e-3, 2e-3, -0.5);
    // From the surface to the camera: the sphere is left where |at + t n| = 1.
    let b = at.dot(n);
    let inside = -b + (b * b + 1.0 - at.length_squared()).sqrt();
    let shadow = at.length();
    let cos = 0.5 / shadow;
    let irradiance = 0.25 * cos / (shadow * shadow) * libm::pow(0.5, shadow + inside);
    Case::new("inside a medium", scene, look_at(at, n, 2.0), irradiance / PI).samples(1).tolerance(1e-5)
}

//! Rays into scenes of glass whose radiance is known.

use glam::{DAffine3, DVec3};

use crate::check::closed_forms::{ball_with_core, slab_transmittance};
use crate::check::stage::{Stage, cuboid, diffuse, emitter, glass, quad, sky, sphere};
use crate::check::{Effort, Figure};
use crate::color::Rgb;
use crate::scene::{Light, LightKind, MaterialKind, Principled, Scene};

/// Light behind a slab of index 1.5.
pub(super) fn slabs(effort: Effort) -> Vec<Figure> {
    let brewster = libm::atan(1.5).to_degrees();
    // Angle, the listed value, the tolerance, and the logarithm of the samples of a replication.
    // The last two pass a quarter and a twentieth of the light: 0.2 % would take most of a minute.
    let angles = [
        (0.0, Some(0.923_076_923), 2e-3, 13),
        (30.0, Some(0.920_265_533), 2e-3, 13),
        (brewster, Some(0.862_258_953), 2e-3, 14),
        (60.0, Some(0.836_232_463), 2e-3, 14),
        (75.0, Some(0.596_092_048), 2e-3, 15),
        (85.0, Some(0.240_079_638), 4e-3, 15),
        (89.0, None, 1e-2, 15),
    ];
    let mut scene = Scene::default();
    cuboid(&mut scene, DVec3::new(-50.0, -50.0, -1.0), DVec3::new(50.0, 50.0, 0.0), glass(1.5));
    quad(&mut scene, DVec3::new(0.0, 0.0, -4.0), 1e5 * DVec3::X, 1e5 * DVec3::Y, emitter(1.0));
    let stage = Stage::new(scene, "N31");
    let mut figures = Vec::new();
    for (degrees, listed, tolerance, log) in angles {
        let angle = f64::to_radians(degrees);
        let expected = slab_transmittance(angle, 1.5, 1.0);
        let what = format!("transmittance at {degrees:.1} degrees");
        if let Some(listed) = listed {
            figures.push(Figure::at_most(
                format!("{what}: closed form against the list"),
                f64::abs(expected - listed),
                6e-10,
            ));
        }
        let (sin, cos) = libm::sincos(angle);
        let d = DVec3::new(sin, 0.0, -cos);
        let ray = [DVec3::new(0.1, 0.2, 0.0) - d, d];
        figures.extend(stage.agrees(&what, ray, (expected, tolerance), (effort, 1 << log)));
    }
    figures
}

fn glowing(rho: f32, radiance: f32) -> MaterialKind {
    let mut p = Principled { base_color: Rgb::grey(rho), specular: 0.0, ..Principled::default() };
    p.emission = Rgb::grey(radiance);
    MaterialKind::Principled(Box::new(p))
}

fn ball(core: MaterialKind, environment: f32) -> Scene {
    let mut scene = Scene { environment: Some(sky(environment)), ..Scene::default() };
    sphere(&mut scene, DVec3::ZERO, 1.0, glass(1.5));
    sphere(&mut scene, DVec3::ZERO, 0.5, core);
    scene
}

fn at(b: f64) -> [DVec3; 2] {
    [DVec3::new(b, 0.0, -3.0), DVec3::Z]
}

/// A ball that is seen at `b` and must look as listed; the closed form is held against the list too.
fn core(what: &str, scene: Scene, b: f64, [expected, listed]: [f64; 2], effort: Effort) -> Vec<Figure> {
    let stage = Stage::new(scene, what);
    let mut figures = vec![Figure::at_most(
        format!("{what}: closed form against the list"),
        (expected - listed).abs(),
        6e-10,
    )];
    figures.extend(stage.agrees(what, at(b), (expected, 3e-3), (effort, 1 << 13)));
    figures
}

pub(super) fn diffuse_cores(effort: Effort) -> Vec<Figure> {
    let seen = |what: &str, b: f64, rho: f32, listed: f64| {
        let expected = ball_with_core(b, 1.5, 0.5, f64::from(rho), 0.0, 1.0);
        core(what, ball(diffuse(rho), 1.0), b, [expected, listed], effort)
    };
    let mut figures = seen("O12 a", 0.0, 0.5, 0.509_263_144);
    figures.extend(seen("O12 b", 0.6, 0.5, 0.511_254_071));
    figures.extend(core("O12 c, past the core", ball(diffuse(0.5), 1.0), 0.9, [1.0; 2], effort));
    figures.extend(seen("O12 f", 0.3, 1.0, 1.0));
    figures
}

pub(super) fn emissive_cores(effort: Effort) -> Vec<Figure> {
    let seen = |what: &str, b: f64, rho: f32, listed: f64| {
        let expected = ball_with_core(b, 1.5, 0.5, f64::from(rho), 1.0, 0.0);
        core(what, ball(glowing(rho, 1.0), 0.0), b, [expected, listed], effort)
    };
    let mut figures = seen("O12 d", 0.0, 0.0, 0.426_666_667);
    figures.extend(seen("O12 e", 0.5, 0.5, 0.435_518_679));
    figures
}

pub(super) fn inside(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    let mut see = |what: &str, scene: Scene, ray: [DVec3; 2], expected: f64| {
        let stage = Stage::new(scene, what);
        figures.extend(stage.agrees(what, ray, (expected, 3e-3), (effort, 1 << 12)));
    };
    // Whoever is in the glass sees all of the sky that is not reflected totally as n^2 times as bright:
    // what is reflected inwards at the surface is as bright itself.
    let furnace = |kind: MaterialKind| {
        let mut scene = Scene { environment: Some(sky(1.0)), ..Scene::default() };
        sphere(&mut scene, DVec3::ZERO, 1.0, kind);
        scene
    };
    let aside = [DVec3::new(0.2, 0.1, -0.3), DVec3::new(0.1, 0.7, 0.4)];
    see("a white sky, seen from inside a ball", furnace(glass(1.5)), aside, 2.25);
    see("a white sky, seen from inside a bubble", furnace(glass(1.0 / 1.5)), aside, 1.0 / 2.25);
    // An emitter that shares the glass with the camera: nothing is between them.
    let near = [DVec3::new(0.0, 0.1, -0.9), DVec3::Z];
    see("an emissive core, seen from inside the glass", ball(emitter(1.0), 0.0), near, 1.0);
    // A light that does not block: the ray passes it again after each reflection, and gathers
    // (1 - R) / n^2 (1 + R + R^2 + ..).
    let mut scene = Scene::default();
    sphere(&mut scene, DVec3::ZERO, 1.0, glass(1.5));
    let intensity = Rgb::grey((std::f64::consts::PI * 0.25) as f32);
    scene.lights.push(Light {
        name: "light".into(),
        kind: LightKind::Point { intensity, radius: 0.5 },
        transform: DAffine3::IDENTITY,
        visible_to_camera: true,
    });
    see("a light in a ball, seen through the middle", scene, at(0.0), 1.0 / 2.25);
    // Air in glass: four per cent at either surface, and all reflections between them.
    let bubble = |environment: f32| {
        let mut scene = Scene { environment: Some(sky(environment)), ..Scene::default() };
        sphere(&mut scene, DVec3::ZERO, 1.0, glass(1.5));
        sphere(&mut scene, DVec3::ZERO, 0.6, glass(1.0 / 1.5));
        scene
    };
    for b in [0.0, 0.3, 0.8] {
        see(&format!("a white sky through air in glass at {b}"), bubble(1.0), at(b), 1.0);
    }
    let mut scene = bubble(0.0);
    sphere(&mut scene, DVec3::ZERO, 0.3, emitter(1.0));
    see("an emissive core in air in glass, through the middle", scene, at(0.0), 12.0 / 13.0);
    figures.extend(super::nested::around_the_camera(effort));
    figures
}

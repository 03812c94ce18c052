//! Glass: slabs (O10), a ball around a core (O12), deflection (O13), the critical angle (O14), absorption.

use std::f64::consts::PI;

use epsilux::color::Rgb;
use epsilux::glam::DVec3;
use epsilux::scene::{LightKind, Scene};

use super::{Build, Case, absorber, diffuse, emitter, facing, glass, glowing, probe, sky};
use epsilux::check::closed_forms::{ball_deflection, ball_with_core, fresnel, slab_transmittance};

pub(super) fn cases() -> Vec<Case> {
    let brewster = libm::atan(1.5).to_degrees();
    let mut cases: Vec<Case> = [
        (0.0, 0.923_076_923),
        (30.0, 0.920_265_533),
        (45.0, 0.904_326_791),
        (brewster, 0.862_258_953),
        (60.0, 0.836_232_463),
        (75.0, 0.596_092_048),
        (85.0, 0.240_079_638),
    ]
    .into_iter()
    .map(|(degrees, value)| slabs(&format!("O10 at {degrees:.0} degrees"), degrees, 1).listed(value))
    .collect();
    cases.push(slabs("O10 two slabs", 0.0, 2).listed(6.0 / 7.0));
    cases.extend([
        core("O12 a", 0.0, 0.5, 0.0, 1.0).listed(0.509_263_144),
        core("O12 b", 0.6, 0.5, 0.0, 1.0).listed(0.511_254_071),
        ball("O12 c, past the core", 0.9, diffuse(0.5), 1.0, 1.0),
        core("O12 d", 0.0, 0.0, 1.0, 0.0).listed(0.426_666_667),
        core("O12 e", 0.5, 0.5, 1.0, 0.0).listed(0.435_518_679),
        core("O12 f", 0.3, 1.0, 0.0, 1.0).listed(1.0),
    ]);
    cases.extend(
        [(0.1, 0.066_902_546), (0.5, 0.367_523_732), (0.9, 0.952_536_812), (0.99, 1.416_876_185)]
            .map(|(b, value)| deflection(b, value)),
    );
    cases.extend(
        [(0.1, 0.100_282), (0.01, 0.439_576), (0.001, 0.763_641), (0.0001, 0.917_238)]
            .map(|(before, value)| critical(before, value)),
    );
    cases.push(absorption());
    cases
}

/// Slabs of index 1.5 with air between, and light behind them.
fn slabs(id: &str, degrees: f64, count: usize) -> Case {
    let mut scene = Scene::default();
    for i in 0..count {
        let top = -1.1 * i as f64;
        scene.cuboid(DVec3::new(-50.0, -50.0, top - 1.0), DVec3::new(50.0, 50.0, top), glass(1.5));
    }
    scene.square(DVec3::new(0.0, 0.0, -4.0), DVec3::Z, 1000.0, emitter(1.0));
    let angle = degrees.to_radians();
    let d = DVec3::new(libm::sin(angle), 0.0, -libm::cos(angle));
    let ray = probe(DVec3::new(0.1, 0.2, 0.0) - d, d);
    Case::new(id, scene, ray, slab_transmittance(angle, 1.5, count as f64)).tolerance(0.002).samples(800_000)
}

/// A ray that meets a diffuse core of radius 1/2 in a glass ball of radius one.
fn core(id: &str, b: f64, rho: f32, le: f32, environment: f32) -> Case {
    let expected = ball_with_core(b, 1.5, 0.5, f64::from(rho), f64::from(le), f64::from(environment));
    ball(id, b, glowing(rho, le), environment, expected)
}

fn ball(id: &str, b: f64, core: epsilux::scene::MaterialKind, environment: f32, expected: f64) -> Case {
    let mut scene = Scene { environment: sky(environment), ..Scene::default() };
    scene.sphere(DVec3::ZERO, 1.0, glass(1.5)).sphere(DVec3::ZERO, 0.5, core);
    Case::new(id, scene, probe(DVec3::new(b, 0.0, -3.0), DVec3::Z), expected).samples(300_000)
}

/// A ray through a solid ball into a sun so small that it is met only in the right direction.
fn deflection(b: f64, listed: f64) -> Case {
    let angle = ball_deflection(b, 1.5);
    assert!((angle - listed).abs() < 1e-8, "O13 {b}: {angle} is listed as {listed}");
    let mut scene = Scene::default();
    scene.sphere(DVec3::ZERO, 1.0, glass(1.5));
    let half = (1e-5 * angle).max(2e-6);
    let sin = libm::sin(half);
    let kind = LightKind::Sun { irradiance: Rgb::grey((PI * sin * sin) as f32), angle: 2.0 * half };
    let towards = DVec3::new(-libm::sin(angle), 0.0, libm::cos(angle));
    scene.light(kind, facing(DVec3::ZERO, towards));
    let through = 1.0 - fresnel(libm::asin(b), 1.5);
    let ray = probe(DVec3::new(b, 0.0, -3.0), DVec3::Z);
    Case::new(format!("O13 impact {b}"), scene, ray, through * through).samples(300_000)
}

/// A ray inside glass that meets the surface `before` radians before total reflection; what it reflects
/// is light.
fn critical(before: f64, listed: f64) -> Case {
    let angle = libm::asin(1.0 / 1.5) - before;
    let expected = fresnel(angle, 1.0 / 1.5);
    assert!((expected - listed).abs() < 1e-6, "O14 {before}: {expected} is listed as {listed}");
    let mut scene = Scene::default();
    scene.square(DVec3::ZERO, DVec3::Z, 100.0, glass(1.5));
    scene.square(DVec3::new(0.0, 0.0, -4.0), DVec3::Z, 100.0, emitter(1.0));
    let d = DVec3::new(libm::sin(angle), 0.0, libm::cos(angle));
    let ray = probe(DVec3::new(0.1, 0.2, 0.0) - d, d);
    Case::new(format!("O14 before {before}"), scene, ray, expected).samples(1_000_000)
}

/// Half is left after a metre, and the ray stays for two, under any sky.
fn absorption() -> Case {
    let mut scene = Scene { environment: sky(1.0), ..Scene::default() };
    scene.cuboid(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 2.0), absorber(0.5, 1.0));
    let ray = probe(DVec3::new(0.1, 0.2, -1.0), DVec3::Z);
    Case::new("absorption", scene, ray, 0.25).tolerance(1e-6).samples(1)
}

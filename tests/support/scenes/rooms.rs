//! Closed rooms (O02, O03), form factors (O09) and mirrors (O16).

use epsilux::glam::DVec3;
use epsilux::scene::Scene;

use super::{Build, Case, diffuse, emitter, glowing, look_at, mirror, probe};
use epsilux::check::closed_forms::{parallel_squares, perpendicular_squares, room_radiance, shell_radiance};

pub(super) fn cases() -> Vec<Case> {
    let mut cases = vec![room("O02", false, 0.5, None).listed(1.0)];
    let listed = [(0, 0.5), (1, 0.75), (2, 0.875), (3, 0.9375), (8, 0.998_046_875)];
    cases.extend(listed.map(|(depth, value)| room("O02", false, 0.5, Some(depth)).listed(value)));
    cases.extend([room("O02 cube", true, 0.5, None), room("O02 cube", true, 0.9, None)]);
    cases.extend([
        shell("O03 a", 1.0, 0.1, 10.0, 0.8, 0.0)
            .listed(0.384_615_385)
            .depth(60)
            .tolerance(0.01)
            .samples(300_000),
        shell("O03 b", 1.0, 0.01, 1000.0, 0.5, 0.0).listed(0.099_990_001).samples(0),
        shell("O03 c", 1.0, 0.5, 1.0, 0.5, 0.3).listed(0.212_765_957).depth(50).samples(200_000),
        shell("O03 d", 1e4, 100.0, 1e4, 0.8, 0.0).listed(3.998_400_640).samples(0),
    ]);
    cases.push(
        plates("O09 facing", DVec3::new(0.5, 0.5, 1.0), -DVec3::Z, parallel_squares())
            .listed(0.199_824_895_698),
    );
    cases.push(
        plates("O09 corner", DVec3::new(0.0, 0.5, 0.5), DVec3::X, perpendicular_squares())
            .listed(0.200_043_776_075),
    );
    cases.push(mirrors());
    cases
}

/// Everything emits 1 - rho and reflects rho: the radiance is one everywhere.
fn room(id: &str, cube: bool, rho: f32, depth: Option<u32>) -> Case {
    let mut scene = Scene::default();
    let walls = glowing(rho, 1.0 - rho);
    if cube {
        scene.cuboid(DVec3::splat(-1.0), DVec3::ONE, walls);
    } else {
        scene.sphere(DVec3::ZERO, 1.0, walls);
    }
    let (le, reflected) = (f64::from(1.0 - rho), f64::from(rho));
    let name = depth.map_or(format!("{id} rho {rho}"), |k| format!("{id} rho {rho} depth {k}"));
    let ray = probe(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.5, -0.3, 0.7));
    let case = Case::new(name, scene, ray, room_radiance(le, reflected, depth)).samples(100);
    Case { max_depth: depth, ..case }
}

/// An emitter in the middle of a diffuse shell.
fn shell(id: &str, outer: f64, inner: f64, le: f32, rho: f32, rho_emitter: f32) -> Case {
    let mut scene = Scene::default();
    scene.sphere(DVec3::ZERO, outer, diffuse(rho)).sphere(DVec3::ZERO, inner, glowing(rho_emitter, le));
    let expected = shell_radiance(inner / outer, f64::from(le), f64::from(rho), f64::from(rho_emitter));
    let ray = probe(DVec3::new(0.9 * outer, 0.0, 0.0), DVec3::X);
    // The list has decimal reflectances; those of the scene are rounded to f32.
    let exact = |v: f32| (f64::from(v) * 1e6).round() / 1e6;
    let decimal = shell_radiance(inner / outer, exact(le), exact(rho), exact(rho_emitter));
    assert!((decimal / expected - 1.0).abs() < 1e-6);
    Case::new(id, scene, ray, decimal)
}

/// The mean over a white unit square of what a square light sends: the form factor.
fn plates(id: &str, light: DVec3, light_normal: DVec3, expected: f64) -> Case {
    let mut scene = Scene::default();
    scene.square(DVec3::new(0.5, 0.5, 0.0), DVec3::Z, 1.0, diffuse(1.0));
    scene.square(light, light_normal, 1.0, emitter(1.0));
    // Two numbers without a common factor: no point lies on the square's diagonal.
    let (n, m) = (40, 41);
    let at = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let points = (0..n * m).map(|i| DVec3::new(at(i / m, n), at(i % m, m), 0.0));
    let probes = points.map(|p| look_at(p, DVec3::Z, 1e-4)).collect();
    let case = Case::new(id, scene, look_at(DVec3::ZERO, DVec3::Z, 1.0), expected);
    Case { probes, ..case }.depth(1).tolerance(0.002).samples(1000)
}

/// A ray between two parallel mirrors of reflectance 0.9, twenty times, and out.
fn mirrors() -> Case {
    let mut scene = Scene { environment: super::sky(1.0), ..Scene::default() };
    let (u, v) = (20.0 * DVec3::X, 2.0 * DVec3::Y);
    scene.quad(DVec3::new(-10.0, 0.0, 0.0), u, v, mirror(0.9));
    scene.quad(DVec3::new(-10.0, 0.0, 1.0), u, -v, mirror(0.9));
    let expected = (0..20).fold(1.0, |p, _| p * 0.9);
    let ray = probe(DVec3::new(-20.25, 0.0, 0.5), DVec3::new(1.0, 0.0, 1.0));
    Case::new("O16", scene, ray, expected).listed(0.121_576_655).tolerance(2e-6).samples(1)
}

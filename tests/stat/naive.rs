//! The reference integrator against closed forms.

use epsilux::integrate::naive::{Ray, Tracer};

use crate::support::scenes::{self, Case};

/// A mean may be this many standard errors away: chance of a false alarm 7e-6.
const SIGMAS: f64 = 4.5;

/// Rounding of scene data, which is f32, relative.
const ROUNDING: f64 = 1e-6;

/// Traces a case; what went wrong, if anything.
fn check(case: &Case) -> Option<String> {
    let tracer = Tracer::new(&case.scene);
    let (mut mean, mut variance) = (0.0, 0.0);
    let n = case.probes.len() as f64;
    for (i, probe) in case.probes.iter().enumerate() {
        let ray = Ray::new(probe.origin, probe.direction);
        let estimate = tracer.estimate(ray, case.max_depth, case.samples, i as u64);
        mean += estimate.mean[1] / n;
        variance += estimate.standard_error[1] * estimate.standard_error[1] / (n * n);
    }
    let error = variance.sqrt();
    let line = format!("{}: {mean:.9} +- {error:.2e}, expected {:.9}", case.id, case.expected);
    let difference = (mean - case.expected).abs();
    if mean.is_nan() || difference > SIGMAS * error + ROUNDING * case.expected {
        Some(format!("{line}: wrong"))
    } else if error > case.tolerance * case.expected {
        Some(format!("{line}: too noisy to tell {}", case.tolerance))
    } else {
        None
    }
}

fn check_all(prefix: &str) {
    let cases: Vec<Case> =
        scenes::all().into_iter().filter(|case| case.id.starts_with(prefix) && case.samples > 0).collect();
    assert!(!cases.is_empty(), "no case begins with {prefix}");
    let failures: Vec<String> = cases.iter().filter_map(check).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Guards the series of interreflections, and what a depth is.
#[test]
fn closed_rooms() {
    check_all("O02");
    check_all("O03");
}

/// Guards radiance, cosine, horizon and distance of square lights, as surfaces and as lights.
#[test]
fn square_lights() {
    check_all("O04");
    check_all("O05");
}

/// Guards ellipses and spheres, and their cut by the horizon.
#[test]
fn round_lights() {
    check_all("O06");
    check_all("O07");
}

/// Guards lights that only a shadow ray reaches, and the sun's disk.
#[test]
fn lights_without_extent() {
    check_all("point");
    check_all("spot");
    check_all("sun");
}

/// Guards area to area transfer between squares.
#[test]
fn form_factors() {
    check_all("O09");
}

/// Guards Fresnel, refraction and interreflection in slabs.
#[test]
fn slabs() {
    check_all("O10");
}

/// Guards 1/eta^2, deflection, and the reflectance around the critical angle.
#[test]
fn glass_balls_and_the_critical_angle() {
    check_all("O12");
    check_all("O13");
    check_all("O14");
}

/// Guards mirrors in a row, and absorption along the way.
#[test]
fn mirrors_and_media() {
    check_all("O16");
    check_all("absorption");
    check_all("inside");
}

/// Guards energy: no material that absorbs nothing gains or loses any.
#[test]
fn white_furnace() {
    check_all("furnace");
}

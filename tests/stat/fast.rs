//! The fast integrator against closed forms.
//!
//! The standard error comes from sixteen independent replications. A case passes where its mean is
//! within the tolerance, cannot be told from the expected value, and its error is small enough for that
//! to mean something.

use epsilux::accel::PrimitiveId;
use epsilux::integrate::{Counters, kernel};
use epsilux::light::LightContext;
use epsilux::sampling::{Address, Purpose};
use epsilux::stats::student_two_sided;

use crate::support::fast::Fast;
use crate::support::scenes::{self, Case};
use crate::support::seed::seed;

const REPLICATIONS: u32 = 16;

/// Samples of one replication, shared by the probes of a case.
const SAMPLES: usize = 2048;

/// Chance of a false alarm of one case: that of 4.5 standard deviations, two-sided.
const ALPHA: f64 = 6.8e-6;

/// Rounding of single precision along a path, relative.
const ROUNDING: f64 = 4e-6;

/// Cases in which few paths carry much of the light, and by how much more samples they need.
fn effort(id: &str) -> u32 {
    match id {
        "O10 at 85 degrees" => 64,
        _ if ["O02", "O03", "O10", "O16"].iter().any(|p| id.starts_with(p)) => 16,
        _ if ["O09", "O13"].iter().any(|p| id.starts_with(p)) => 8,
        _ if id.starts_with("furnace") && id.ends_with("roughness 1") => 8,
        _ => 1,
    }
}

/// Traces a case; what went wrong, if anything.
fn check(case: &Case) -> Option<String> {
    let fast = Fast::new(&case.scene, seed(&case.id), case.max_depth);
    let samples = (SAMPLES.div_ceil(case.probes.len()) as u32).next_power_of_two() * effort(&case.id);
    let estimate = fast.estimate(&case.probes, REPLICATIONS, samples)[1];
    let (mean, error) = (estimate.mean, estimate.variance_of_mean().sqrt());
    let difference = mean - case.expected;
    let line = format!(
        "{}: {mean:.9} +- {error:.2e}, expected {:.9}: {:+.4} %, t = {:+.2}",
        case.id,
        case.expected,
        100.0 * difference / case.expected,
        difference / error
    );
    // Furnaces of rough lobes are as white as tables of albedos make them: interpolation adds up to 3e-4.
    let rounding = match &*case.id {
        id if id.contains("roughness") => 5e-4,
        // Close to the critical angle, and to grazing, reflectance goes as the root of what a cosine is off by.
        "O13 impact 0.99" | "O14 before 0.0001" => 2e-5,
        _ => ROUNDING,
    };
    // Roulette ends most paths between mirrors, which leaves noise that the reference does not have.
    let tolerance = if case.id == "O16" { 0.008 } else { case.tolerance };
    let beyond_rounding = (difference.abs() - rounding * case.expected).max(0.0);
    let p = if beyond_rounding == 0.0 {
        1.0
    } else {
        student_two_sided(beyond_rounding / error, f64::from(REPLICATIONS - 1))
    };
    if mean.is_nan() || p < ALPHA || beyond_rounding > tolerance * case.expected {
        Some(format!("{line}: wrong"))
    } else if error > 0.5 * tolerance * case.expected {
        Some(format!("{line}: too noisy to tell {}", tolerance))
    } else {
        None
    }
}

fn check_all(prefixes: &[&str]) {
    let mut failures = Vec::new();
    for prefix in prefixes {
        let cases: Vec<Case> = scenes::all().into_iter().filter(|case| case.id.starts_with(prefix)).collect();
        assert!(!cases.is_empty(), "no case begins with {prefix}");
        failures.extend(cases.iter().filter_map(check));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Guards the series of interreflections, what a depth is, and light that a surface sheds on itself.
#[test]
fn closed_rooms() {
    check_all(&["O02", "O03"]);
}

/// Guards the sampling of square lights by solid angle, near, far, and cut by the horizon.
#[test]
fn square_lights() {
    check_all(&["O04", "O05"]);
}

/// Guards the sampling of spheres and ellipses: near, far, cut by the horizon, tiny.
#[test]
fn round_lights() {
    check_all(&["O06", "O07"]);
}

/// Guards lights that only a shadow ray reaches, and the sun's disk.
#[test]
fn lights_without_extent() {
    check_all(&["point", "spot", "sun"]);
}

/// Guards area to area transfer between squares.
#[test]
fn form_factors() {
    check_all(&["O09"]);
}

/// Guards Fresnel, refraction and interreflection in slabs.
#[test]
fn slabs() {
    check_all(&["O10"]);
}

/// Guards 1/eta^2, deflection, and the reflectance around the critical angle.
#[test]
fn glass_balls_and_the_critical_angle() {
    check_all(&["O12", "O13", "O14"]);
}

/// Guards mirrors in a row, and absorption along the way.
#[test]
fn mirrors_and_media() {
    check_all(&["O16", "absorption", "inside"]);
}

/// Guards energy: no material that absorbs nothing gains or loses any.
#[test]
fn white_furnace() {
    check_all(&["furnace"]);
}

/// Guards, without any statistics, the weights of perfect lobes (N38): under a white sky every single
/// path that leaves a white ball brings exactly the sky, whatever its length.
#[test]
fn every_path_of_a_perfect_furnace_brings_one() {
    for name in ["furnace: diffuse", "furnace: mirror", "furnace: glass", "furnace: bubble"] {
        let case = scenes::all().into_iter().find(|c| c.id == name).expect("a furnace");
        let fast = Fast::new(&case.scene, seed(name), None);
        for (pixel, probe) in case.probes.iter().enumerate() {
            for index in 0..1000 {
                let radiance = fast.radiance(probe, pixel as u64, 0, index);
                // The diffuse ball takes half from the sky's direction and half from its own: both have
                // the same density, so that each weight is one half exactly.
                let off = (radiance.max_channel() - 1.0).abs();
                assert!(off <= 2e-5, "{name}, {probe:?}, sample {index}: {radiance:?}");
            }
        }
    }
}

/// Guards solid-angle sampling by its noise (N50): the coefficient of variation of one light sample on a
/// point below the middle of a unit square is that of a uniform direction, and not that of a uniform
/// point, which has up to sixty times as much.
#[test]
fn one_light_sample_has_the_noise_of_solid_angle_sampling() {
    use crate::support::scenes::{Build, diffuse, emitter};
    use epsilux::glam::{DVec3, Vec3};
    for (h, expected) in [(0.01, 0.5524), (0.1, 0.4045), (1.0, 0.0433), (16.0, 2.1e-4)] {
        let mut scene = epsilux::scene::Scene::default();
        scene.square(DVec3::ZERO, DVec3::Z, 1e-3, diffuse(1.0));
        scene.quad(h * DVec3::Z, DVec3::Y, DVec3::X, emitter(1.0));
        let fast = Fast::new(&scene, seed("noise of one light sample"), Some(1));
        let n = Vec3::Z;
        let context = LightContext {
            p: Vec3::ZERO,
            p_err: Vec3::ZERO,
            from: PrimitiveId::NONE,
            ng: n,
            ns: n,
            wo: n,
            transmits: false,
        };
        let (count, mut sum, mut squares) = (1 << 16, 0.0, 0.0);
        for index in 0..count {
            let u = Address::new(fast.prepared.seed, 0, 0, index).block(0, Purpose::Test, 0, 0);
            let sample = fast.prepared.lights.sample(&context, [u[0], u[1], u[2]]);
            let value = sample.map_or(0.0, |s| f64::from(s.weight.g * s.wi.z.max(0.0)));
            sum += value;
            squares += value * value;
        }
        let mean = sum / f64::from(count);
        let cv = (squares / f64::from(count) - mean * mean).max(0.0).sqrt() / mean;
        assert!(cv <= 1.05 * expected, "at {h}: {cv}, expected {expected}");
    }
}

/// Guards the far safety cap: it ends paths that nothing else would, and counts them.
#[test]
fn a_closed_box_of_mirrors_ends() {
    use crate::support::scenes::{Build, mirror, probe};
    use epsilux::glam::DVec3;
    use epsilux::shape::Ray;
    let mut scene = epsilux::scene::Scene::default();
    scene.cuboid(DVec3::splat(-1.0), DVec3::ONE, mirror(1.0));
    let fast = Fast::new(&scene, 0, None);
    let mut counters = Counters::default();
    let ray = probe(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.5, -0.3, 0.7));
    let ray = Ray::new(ray.origin.as_vec3(), ray.direction.as_vec3());
    let li = kernel(&fast.prepared.plan).li;
    let radiance = li(&fast.prepared, Address::new(0, 0, 0, 0), ray, &mut counters);
    assert!(radiance.is_black() && counters.capped == 1 && counters.rays > 1000, "{counters:?}");
}

/// Guards what a turned picture means, for both integrators: of a picture that is red on its left and blue
/// on its right, turned by a quarter counter-clockwise from above, the ray to the left (-X) sees the middle.
#[test]
fn a_turned_picture_is_seen_where_it_should_be() {
    use crate::support::scenes::probe;
    use epsilux::color::Rgb;
    use epsilux::glam::DVec3;
    use epsilux::integrate::naive::{Ray, Tracer};
    use epsilux::scene::Texels;
    use std::f64::consts::FRAC_PI_2;
    let half = |i: u32| if i < 8 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let mut scene = crate::support::features::under(
        epsilux::scene::Scene::default(),
        [16, 1],
        Texels::Float((0..16).map(half).collect()),
    );
    let sky = scene.environment.as_mut().expect("a sky");
    sky.radiance = Rgb::WHITE;
    sky.image.as_mut().expect("a picture").rotation = FRAC_PI_2;
    let fast = Fast::new(&scene, 0, None);
    let tracer = Tracer::new(&scene);
    let (red, blue) = ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    for (direction, expected) in [
        (DVec3::new(-1.0, 0.3, 1.0), red),
        (DVec3::new(0.0, 0.3, 1.0), red),
        (DVec3::new(-1.0, -0.9, -1.0), blue),
        (DVec3::new(0.0, 0.0, -1.0), blue),
        (DVec3::new(-1.0, 0.0, 0.0), [0.5, 0.0, 0.5]),
        (DVec3::new(1.0, 0.0, 0.0), [0.5, 0.0, 0.5]),
    ] {
        let found = fast.radiance(&probe(DVec3::ZERO, direction), 0, 0, 0);
        let slow = tracer.estimate(Ray::new(DVec3::ZERO, direction), None, 1, 0).mean;
        for c in 0..3 {
            assert!((f64::from(found[c]) - expected[c]).abs() < 1e-5, "{direction}: {found:?}");
            assert!((slow[c] - expected[c]).abs() < 1e-5, "{direction}: {slow:?}");
        }
    }
}

/// Guards the limit case of a picture: one of a single colour lights like an environment of that colour, and
/// what absorbs nothing is invisible under it.
#[test]
fn a_picture_of_one_colour_is_a_furnace() {
    use epsilux::color::Rgb;
    use epsilux::scene::Texels;
    for name in ["furnace: diffuse", "furnace: glass", "furnace: rough coat over white, roughness 0.6"] {
        let case = scenes::all().into_iter().find(|c| c.id == name).expect("a furnace");
        let texels = Texels::Float(vec![[0.25; 3]; 8]);
        let mut scene = crate::support::features::under(case.scene, [4, 2], texels);
        scene.environment.as_mut().expect("a sky").radiance = Rgb::grey(4.0);
        let case = Case { id: format!("{name}, under a picture"), scene, ..case };
        if let Some(failure) = check(&case) {
            panic!("{failure}");
        }
    }
}

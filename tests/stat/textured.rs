//! Textures, alpha, normal maps and vertex colours: the fast integrator against the reference, and against
//! what is known.

use epsilux::color::Rgb;
use epsilux::glam::DVec3;
use epsilux::integrate::naive::{Ray, Tracer};
use epsilux::scene::{AlphaMode, Environment, Scene};

use crate::support::compare::Pair;
use crate::support::fast::{Fast, valid};
use crate::support::scenes::{Build, principled, probe};
use crate::support::seed::seed;
use crate::support::textured;

/// Compares each scene of a list; small pictures of scenes that differ in one feature.
fn check_all(scenes: Vec<(String, Scene)>, samples: [u32; 2], bound: f64) {
    assert!(!scenes.is_empty());
    let check = |(name, scene): &(String, Scene)| {
        let scene = &valid(scene);
        Pair { name, scene, size: [8, 8], max_depth: 6, samples, tiles: [2, 2], bound }.compare().err()
    };
    let failures: Vec<String> = scenes.iter().filter_map(check).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Guards how pictures lie and are filtered, and what each of them multiplies.
#[test]
fn textures() {
    check_all(textured::textures(), [384, 700], 0.1);
}

/// Guards the frames of normal maps, and on which side of the surface they may point.
#[test]
fn normal_maps() {
    check_all(textured::normal_maps(), [384, 700], 0.1);
}

/// Guards alpha: seen, in shadows, and in front of lights that only a shadow ray reaches.
#[test]
fn cutouts() {
    check_all(textured::cutouts(), [384, 700], 0.1);
}

/// Guards colours of vertices, and their alpha.
#[test]
fn vertex_colors() {
    check_all(textured::vertex_colors(), [384, 700], 0.1);
}

/// Guards the weights of lights whose radiance a picture varies.
#[test]
fn emissive_pictures() {
    check_all(textured::emissive(), [384, 3000], 0.15);
}

/// Guards what these features do to each other.
#[test]
fn everything_textured() {
    let scene = valid(&textured::everything_textured());
    Pair {
        name: "everything textured",
        scene: &scene,
        size: [12, 12],
        max_depth: 6,
        samples: [384, 1000],
        tiles: [3, 3],
        bound: 0.1,
    }
    .compare()
    .unwrap_or_else(|e| panic!("{e}"));
}

/// Guards how much passes: a black sheet of alpha 0.4 before a sky of one leaves 0.6, two of them 0.36, for a
/// camera ray and for the light of a white surface behind them.
#[test]
fn a_sheet_of_alpha_passes_the_rest() {
    let veil = || {
        principled(|p| {
            (p.alpha, p.alpha_mode) = (0.4, AlphaMode::Blend);
            (p.base_color, p.specular) = (Rgb::BLACK, 0.0);
        })
    };
    for (sheets, expected) in [(1, 0.6), (2, 0.36)] {
        let mut scene = Scene {
            environment: Some(Environment {
                name: "sky".into(),
                radiance: Rgb::WHITE,
                image: None,
                visible_to_camera: true,
            }),
            ..Scene::default()
        };
        for i in 0..sheets {
            scene.square(DVec3::new(0.0, f64::from(i), 0.0), DVec3::Y, 1e4, veil());
        }
        let above = probe(DVec3::new(0.1, 3.0, 0.2), DVec3::new(0.1, -1.0, 0.2));
        let fast = Fast::new(&scene, seed("veil"), None).estimate(&[above], 4, 1 << 14)[1];
        assert!((fast.mean - expected).abs() < 2e-3, "{sheets}: {}", fast.mean);
        let slow =
            Tracer::new(&valid(&scene)).estimate(Ray::new(above.origin, above.direction), None, 40_000, 1);
        assert!((slow.mean[1] - expected).abs() < 4.5 * slow.standard_error[1], "{sheets}: {slow:?}");
        // A white floor below the sheets reflects what they let through; nothing comes back from them.
        scene.square(DVec3::new(0.0, -1e-3, 0.0), DVec3::Y, 1.0, crate::support::scenes::diffuse(1.0));
        let below = probe(DVec3::new(0.1, -5e-4, 0.2), DVec3::new(0.0, -1.0, 0.0));
        let fast = Fast::new(&scene, seed("below the veil"), None).estimate(&[below], 4, 1 << 12)[1];
        assert!((fast.mean - expected).abs() < 2e-3, "below {sheets}: {}", fast.mean);
    }
}

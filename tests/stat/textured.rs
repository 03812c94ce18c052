//! Textures, alpha, normal maps and vertex colours: the fast integrator against the reference, and against
//! what is known.

use epsilux::scene::Scene;

use crate::support::compare::Pair;
use crate::support::fast::valid;
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

//! Choices of a plan change noise and nothing else: several samples of lights, several ways on at the first glass,
//! and roulette from elsewhere, against one of each.

use epsilux::film::Image;
use epsilux::glam::DVec3;
use epsilux::integrate::{Quiet, RenderOptions, render};
use epsilux::prepare::{Algorithms, CausticsMode, Options, prepare};
use epsilux::scene::text::parse_toml;
use epsilux::scene::{MaterialKind, Scene};

use crate::support::compare::Pair;
use crate::support::fast::{options, valid};
use crate::support::scenes::{Build, glass};
use crate::support::seed::seed;
use crate::support::{features, nested, textured};

fn picture(pair: &Pair<'_>, algorithms: Algorithms, number: u64, samples: u32) -> Image {
    let base = options(pair.size, seed(pair.name) ^ number, Some(pair.max_depth));
    let prepared = prepare(pair.scene, &Options { algorithms, ..base }).expect("a camera");
    let chosen = (prepared.plan.light_samples, prepared.plan.split, prepared.plan.roulette);
    let asked = (algorithms.light_samples, algorithms.split, algorithms.roulette);
    assert_eq!((Some(chosen.0), Some(chosen.1), Some(chosen.2)), asked);
    let outcome =
        render(&prepared, &RenderOptions { threads: 1, ..RenderOptions::passes(0..samples) }, &Quiet);
    let outcome = outcome.expect("passes");
    assert_eq!(outcome.film.refused_total(), 0, "{}: {:?}", pair.name, outcome.bad);
    outcome.film.to_image()
}

/// Compares `others` with paths as they are without choices, with seeds of their own.
fn check_by(scenes: Vec<(String, Scene)>, base: Algorithms, others: Algorithms, samples: u32, bound: f64) {
    assert!(!scenes.is_empty());
    let check = |(name, scene): &(String, Scene)| {
        let pair = Pair {
            name,
            scene: &valid(scene),
            size: [8, 8],
            max_depth: 12,
            samples: [samples; 2],
            tiles: [2, 2],
            bound,
        };
        let (a, b) = (picture(&pair, others, 1, samples), picture(&pair, base, 2, 2 * samples));
        pair.judge(&a, &b).err()
    };
    let failures: Vec<String> = scenes.iter().filter_map(check).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn check(scenes: Vec<(String, Scene)>, others: Algorithms, samples: u32, bound: f64) {
    check_by(scenes, Algorithms::PATHS, others, samples, bound);
}

const LIGHTS: Algorithms = Algorithms { light_samples: Some(3), ..Algorithms::PATHS };
const SPLIT: Algorithms = Algorithms { split: Some(3), ..Algorithms::PATHS };
const ALL: Algorithms =
    Algorithms { light_samples: Some(2), split: Some(5), roulette: Some(1), ..Algorithms::PATHS };

/// Guards the weights of several samples of each kind of light against those of a direction that meets it: wide
/// lights and glossy surfaces, where both ways matter.
#[test]
fn several_samples_of_every_light() {
    check(features::lights(), LIGHTS, 256, 0.1);
    let mut glossy = features::lights();
    for (_, scene) in &mut glossy {
        for material in &mut scene.materials {
            if let MaterialKind::Diffuse { color } = material.kind {
                material.kind = crate::support::scenes::principled(|p| {
                    (p.base_color, p.metallic, p.roughness) = (color, 1.0, 0.3);
                });
            }
        }
    }
    check(
        glossy.into_iter().map(|(name, scene)| (format!("glossy, {name}"), scene)).collect(),
        LIGHTS,
        256,
        0.2,
    );
    check(features::panoramas(), LIGHTS, 512, 0.2);
    check(textured::emissive(), LIGHTS, 256, 0.1);
}

/// Guards splitting at every material that it concerns, and that it leaves others alone: coats and mixtures, of which
/// one lobe is a mirror, cut-outs, bodies with an order, absorption before and after.
#[test]
fn several_ways_through_every_material() {
    check(features::materials(), SPLIT, 128, 0.25);
    check(features::layers(), SPLIT, 128, 0.25);
    check(nested::nested(), SPLIT, 256, 0.5);
    check(features::shapes_and_cameras(), SPLIT, 128, 0.25);
}

/// Guards glass of which a share is there, which is decided once for all ways, and glass that emits.
#[test]
fn splitting_where_glass_is_not_all_there() {
    let mut scenes = textured::cutouts();
    for (_, scene) in &mut scenes {
        for material in &mut scene.materials {
            if let MaterialKind::Principled(p) = &mut material.kind {
                (p.transmission, p.roughness, p.metallic) = (1.0, 0.0, 0.0);
                p.emission = epsilux::color::Rgb::grey(0.2);
                p.textures.roughness = None;
            }
        }
    }
    check(scenes, SPLIT, 256, 0.3);
}

/// Guards what the choices do together, and what features do to each other.
#[test]
fn all_choices_at_once() {
    let scenes =
        [("everything", features::everything()), ("everything textured", textured::everything_textured())];
    check(scenes.map(|(name, scene)| (name.to_owned(), scene)).to_vec(), ALL, 512, 0.15);
    let file =
        |name: &str, text: &str| (name.to_owned(), parse_toml(text).expect("a scene of the project").0);
    let rooms = vec![
        file("cornell", include_str!("../../scenes/cornell.toml")),
        file("materials", include_str!("../../scenes/materials.toml")),
    ];
    check(rooms, ALL, 768, 0.1);
}

/// Guards splitting with photons: which of them a path gathers depends on where it split.
#[test]
fn splitting_with_a_photon_map() {
    let mut scene = features::stage();
    scene.sphere(features::MIDDLE + 1.6 * DVec3::X, 0.6, glass(1.5));
    let photons = |of: Algorithms| Algorithms { caustics: CausticsMode::Photon, ..of };
    check_by(vec![("a map, split".to_owned(), scene)], photons(Algorithms::PATHS), photons(ALL), 512, 0.1);
}

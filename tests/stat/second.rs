//! The second opinion: what photons bring into view is what paths find there.
//!
//! The noise of both is their own: that of paths from replications, that of photons from one photon to the next.

use std::fmt::Write as _;

use epsilux::film::{CrossCell, Doubt, LIGHT_CLASSES};
use epsilux::integrate::{Quiet, RenderOptions, render, second_opinion};
use epsilux::prepare::{CausticsMode, prepare};
use epsilux::scene::Scene;
use epsilux::scene::text::parse_toml;
use epsilux::stats::{normal_quantile, sidak_each};

use crate::agree::enlarge;
use crate::support::compare::keep;
use crate::support::fast::{options, valid};
use crate::support::features;
use crate::support::seed::seed;

/// Chance that one scene fails although nothing is wrong, shared by all of its comparisons.
const FAMILY_ALPHA: f64 = 1e-4;

/// Both in the same light of one cell: (difference, its standard error, light by paths).
fn difference(cell: &CrossCell, class: Option<usize>) -> (f64, f64, f64) {
    let light = cell.light(class);
    (light.photons - light.paths, (light.variance + cell.variance).sqrt(), light.paths)
}

/// Where photons reach the camera by a narrow lobe: few carry most of the light, and those that are missing are
/// missing in the estimate of the noise too. Too much is still too much.
fn few_carry_most(name: &str) -> bool {
    ["roughness 0.25", "rough glass", "glass of roughness", "smooth glass", "absorbing glass"]
        .iter()
        .any(|n| name.contains(n))
}

/// Compares both in each cell and class where they are sharp; the whole has to be sharp enough to see `bound`. The
/// difference in all over its standard error, where that is known.
fn compare(
    name: &str,
    scene: &Scene,
    [passes, photons]: [u32; 2],
    bound: f64,
) -> Result<Option<f64>, String> {
    let prepared = prepare(scene, &options([32, 32], seed(name), Some(8))).expect("a camera");
    let passes = RenderOptions { threads: 1, ..RenderOptions::passes(0..passes) };
    let mut film = render(&prepared, &passes, &Quiet).expect("passes").film;
    second_opinion(&prepared, &mut film, passes.passes.end..photons);
    let cells = film.cross_cells();
    let classes = || (0..LIGHT_CLASSES).map(Some).chain([None]);
    // Sums of few photons, or of few paths that found anything, are not normal: they say nothing.
    let sharp = |d: &(f64, f64, f64)| d.1 < 0.1 * d.2;
    let pairs: Vec<_> = cells
        .iter()
        .flat_map(|cell| classes().map(move |class| (cell, class, difference(cell, class))))
        .filter(|(_, _, d)| sharp(d))
        .collect();
    let limit = -normal_quantile(0.5 * sidak_each(FAMILY_ALPHA, pairs.len().max(1)));
    let (mut wrong, mut largest) = (String::new(), 0.0f64);
    // Skewed sums are often too small by more than they say, and seldom too large: see `Doubt`.
    let whole_too = !few_carry_most(name);
    for (cell, class, (d, sigma, paths)) in &pairs {
        // Rounding of single precision.
        let z = d / (sigma + 1e-5 * paths);
        let z = if whole_too && cell.pixels == [0, 0, 32, 32] && class.is_none() { z.abs() } else { z };
        largest = largest.max(z);
        if z.is_nan() || z > limit {
            let _ = write!(
                wrong,
                " {:?} of class {class:?}: {:+.2} %, z {z:+.2};",
                cell.pixels,
                100.0 * d / paths
            );
        }
    }
    let whole = cells.last().map(|cell| difference(cell, None)).expect("photons");
    let seen = (limit + 2.3) * whole.1 / whole.2;
    let report = format!(
        "{name}: {:+.2} % in all, sees {:.1} %, {} comparisons, largest z {largest:+.2} of {limit:.2}",
        100.0 * whole.0 / whole.2,
        100.0 * seen,
        pairs.len()
    );
    if whole_too && (seen.is_nan() || seen > bound) {
        let _ = write!(wrong, " too noisy to see {} %", 100.0 * bound);
    }
    keep(&format!("second, {name}"), &report);
    if wrong.is_empty() {
        Ok(whole_too.then(|| whole.0 / whole.1))
    } else {
        Err(format!("{report}\n   {wrong}"))
    }
}

fn check_all(scenes: Vec<(String, Scene)>, passes: [u32; 2], bound: impl Fn(&str) -> f64) {
    assert!(!scenes.is_empty());
    let (mut failures, mut all) = (Vec::new(), Vec::new());
    for (name, scene) in &scenes {
        match compare(name, &valid(scene), passes, bound(name)) {
            Ok(z) => all.extend(z),
            Err(wrong) => failures.push(wrong),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    // Errors of all scenes in one direction show in their sum before they show in any of them.
    let z = all.iter().sum::<f64>() / (all.len() as f64).sqrt().max(1.0);
    assert!(z.abs() < 4.5, "z of all together {z:+.2}");
}

/// Guards how photons leave every kind of light.
#[test]
fn lights() {
    check_all(features::lights(), [64, 1760], |_| 0.5);
}

/// Guards every material: photons are scattered as paths are.
#[test]
fn materials() {
    check_all(features::materials(), [64, 1760], |_| 0.65);
}

/// Guards layers, which are not reciprocal.
#[test]
fn layers() {
    check_all(features::layers(), [64, 1760], |_| 0.65);
}

/// Guards instances, interpolated normals, hidden objects and cameras.
#[test]
fn shapes_and_cameras() {
    check_all(features::shapes_and_cameras(), [64, 1760], |_| 0.65);
}

/// Guards light that goes through absorbing bodies.
#[test]
fn lights_and_media() {
    let mut scenes = features::lights_and_media();
    // Paths do not meet a point by way of a smooth surface.
    scenes.retain(|(name, _)| name != "a point inside of an absorber");
    check_all(scenes, [128, 1760], |_| 0.65);
}

/// Guards rooms in which light is spread many times, and classes of light from several lamps.
#[test]
fn rooms() {
    let mut hexroom = parse_toml(include_str!("../../scenes/hexroom.toml")).expect("a scene").0;
    enlarge(&mut hexroom, "light", 4.8);
    let cornell = parse_toml(include_str!("../../scenes/cornell.toml")).expect("a scene").0;
    let scenes = [("hexroom", hexroom), ("cornell", cornell), ("everything", features::everything())];
    let scenes = scenes.map(|(name, scene)| (name.to_owned(), scene)).to_vec();
    check_all(scenes, [128, 3520], |name| if name == "everything" { 0.6 } else { 0.07 });
}

/// A render of some passes, and why its error is doubted.
fn doubt(scene: &Scene, seed: u64, caustics: CausticsMode, passes: u32) -> Option<Doubt> {
    let mut options = options([64, 64], seed, None);
    options.algorithms.caustics = caustics;
    let prepared = prepare(scene, &options).expect("a camera");
    let passes = RenderOptions { threads: 1, ..RenderOptions::passes(0..passes) };
    let film = render(&prepared, &passes, &Quiet).expect("passes").film;
    film.error().expect("an estimate").doubt
}

fn file(text: &str) -> Scene {
    valid(&parse_toml(text).expect("a scene").0)
}

/// What a light that is told apart is called.
fn called(scene: &Scene, light: u8) -> String {
    let prepared = prepare(scene, &options([64, 64], 0, None)).expect("a camera");
    prepared.lights_apart()[usize::from(light)].clone()
}

/// Guards what the second opinion is for: light behind a pinhole, which no path finds, is missed, and it is
/// known which.
#[test]
fn a_pinhole_is_noticed() {
    let scene = file(include_str!("../../fixtures/text/pinhole.toml"));
    for run in 0..2 {
        match doubt(&scene, seed("pinhole") ^ run, CausticsMode::Path, 96) {
            Some(Doubt::LightNotFound { share, light: Some(light), caustic: false, .. }) => {
                assert!(share > 0.05, "{share}");
                assert_eq!(called(&scene, light), "light \"lamp\"");
            }
            other => panic!("{other:?}"),
        }
    }
}

/// Guards the bound of light that neither paths nor photons find, behind a hole of a tenth of a millimetre: the truth
/// is a tenth of the picture, and known to be below some hundred times it. And that a lamp as bright as the rest is no
/// reason to doubt there: its bound is a ten-millionth of the other one.
#[test]
fn light_that_nobody_finds_is_doubted() {
    let text = include_str!("../../fixtures/misleading/pinhole.toml");
    let scene = file(text);
    for run in 0..2 {
        match doubt(&scene, seed("nobody") ^ run, CausticsMode::Path, 32) {
            Some(Doubt::LightNotReached { share, light }) => {
                assert!(share > 0.1 && share < 1e4, "{share}");
                assert_eq!(called(&scene, light), "light \"lamp\"");
            }
            other => panic!("{other:?}"),
        }
    }
    let bright = "[6.88e15, 6.88e15, 6.88e15]";
    assert!(text.contains(bright));
    let faint = file(&text.replace(bright, "[6.88e8, 6.88e8, 6.88e8]"));
    assert_eq!(doubt(&faint, seed("faint"), CausticsMode::Path, 32), None);
}

/// Guards caustics that paths have not found, and that photons which supply them are found sound.
#[test]
fn missing_caustics_are_noticed() {
    for text in
        [include_str!("../../scenes/caustic.toml"), include_str!("../../fixtures/text/small-lamp.toml")]
    {
        let scene = file(text);
        let found = doubt(&scene, seed("caustic"), CausticsMode::Path, 64);
        match found {
            Some(Doubt::LightNotFound { caustic: true, .. }) => {}
            // What some paths found makes the rest noise.
            Some(_) if text.contains("Thirty centimetres") => {}
            other => panic!("{other:?}"),
        }
        let found = doubt(&scene, seed("caustic"), CausticsMode::Photon, 64);
        assert!(!matches!(found, Some(Doubt::LightNotFound { .. })), "{found:?}");
    }
}

/// Guards sound pictures, and those that are only noisy.
#[test]
fn sound_pictures_are_not_doubted() {
    for (name, text) in [
        ("cornell", include_str!("../../scenes/cornell.toml")),
        ("hexroom-diffuse", include_str!("../../scenes/hexroom-diffuse.toml")),
        ("materials", include_str!("../../scenes/materials.toml")),
        ("many-lights", include_str!("../../fixtures/golden/many-lights/scene.toml")),
    ] {
        let found = doubt(&file(text), seed(name), CausticsMode::Path, 48);
        let missing = matches!(found, Some(Doubt::LightNotFound { .. } | Doubt::LightNotReached { .. }));
        assert!(!missing, "{name}: {found:?}");
    }
}

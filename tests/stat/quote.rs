//! Quotes against what renders then take.

use epsilux::film::{ErrorEstimate, Film, LightLayer, Squares};
use epsilux::integrate::{Quiet, RenderOptions, Sparse, render};
use epsilux::prepare::{Algorithms, CausticsMode, Options, Prepared, prepare};
use epsilux::quote::{Length, Pilot, pilot};
use epsilux::scene::text::parse_toml;

use crate::support::fast::options;
use crate::support::seed::seed;

const HEXROOM: &str = include_str!("../../scenes/hexroom.toml");
const CORNELL: &str = include_str!("../../scenes/cornell.toml");
const PENUMBRA: &str = include_str!("../../fixtures/golden/sphere-penumbra/scene.toml");
const SLAB: &str = include_str!("../../fixtures/golden/glass-slab/scene.toml");
const SHEEN: &str = include_str!("../../fixtures/golden/coat-sheen/scene.toml");

fn prepared(text: &str, side: u32, name: &str) -> Prepared {
    let scene = parse_toml(text).expect("a scene of the project").0;
    prepare(&scene, &options([side, side], seed(name), None)).expect("a camera")
}

/// A pilot of about so many samples for each pixel that it renders.
fn pilot_of(scene: &Prepared, rays: u64) -> Pilot {
    let options = RenderOptions { threads: 1, ..RenderOptions::passes(0..1) };
    pilot(scene, &options, Length { rays, narrow: None }, &Quiet).expect("a pilot")
}

/// Guards quotes against the samples at which renders then stop, from pilots of two thirds of them at most: a mean within
/// 15 %, and the stated interval, which is to hold 95 %, holds 15 of 18 (fewer have a chance of 2 in 1000).
#[test]
fn renders_stop_where_they_were_quoted_to() {
    let mut held = 0;
    for (name, text, error, rays) in [
        ("cornell", CORNELL, 0.04, 1_100_000),
        ("penumbra", PENUMBRA, 0.015, 500_000),
        ("sheen", SHEEN, 0.024, 600_000),
    ] {
        let (mut logs, mut runs) = (0.0, Vec::new());
        for i in 0..6 {
            let scene = prepared(text, 32, &format!("quote {name} {i}"));
            let pilot = pilot_of(&scene, rays);
            let quote = pilot
                .quote(error)
                .unwrap_or_else(|| panic!("{name} {i}: {:?} of {}", pilot.error, pilot.passes));
            let options = RenderOptions { error: Some(error), ..RenderOptions::passes(0..8192) };
            let outcome = render(&scene, &options, &Quiet).expect("passes");
            assert!(outcome.reached, "{name}");
            let came = outcome.passes.end;
            assert!(came >= 3 * pilot.passes / 2, "{name}: {} of {came} is no forecast", pilot.passes);
            let [low, high] = quote.samples_interval;
            held += u32::from((low..=high).contains(&came));
            logs += libm::log(f64::from(quote.samples) / f64::from(came)) / 6.0;
            runs.push(format!(
                "{} {:?} of {}, came {came}",
                quote.samples, quote.samples_interval, pilot.passes
            ));
        }
        assert!(logs.abs() <= libm::log(1.15), "{name}: {}\n{}", libm::exp(logs), runs.join("\n"));
    }
    assert!(held >= 15, "{held} of 18 intervals");
}

/// Guards how long a pilot is: it goes on for a quote that would be wide, but not beyond four times its rays, nor where
/// these do not pay for the least that it takes. And that a quote far beyond what was seen is none.
#[test]
fn a_pilot_goes_on_for_a_wide_quote() {
    let scene = prepared(SHEEN, 32, "a wide quote");
    let options = RenderOptions { threads: 1, ..RenderOptions::passes(0..1) };
    let of = |rays, narrow| pilot(&scene, &options, Length { rays, narrow }, &Quiet).expect("a pilot");
    let least = of(1, Some(0.02));
    assert_eq!(least.passes, 16);
    let rays = least.rays + least.rays / 32;
    let (plain, narrow) = (of(rays, None), of(rays, Some(0.02)));
    assert_eq!(plain.passes, 16);
    assert!((32..=64).contains(&narrow.passes), "{}", narrow.passes);
    let width = |p: &Pilot| {
        let [low, high] = p.curve.forecast(0.02).expect("points").interval;
        f64::from(high) / f64::from(low)
    };
    assert!(width(&narrow) < width(&plain), "{} {}", width(&narrow), width(&plain));
    assert!(plain.is_clear() && plain.quote(1e-4).is_none(), "{:?}", plain.quote(1e-4));
}

/// Guards that some of the pixels speak for all: the error of one pixel in four is that of the whole picture, within
/// three times what both intervals allow.
#[test]
fn some_pixels_speak_for_all() {
    let scene = prepared(CORNELL, 128, "some pixels speak for all");
    let some = pilot_of(&scene, 1);
    assert_eq!((some.every, some.passes), (4.0, 16));
    let whole = render(&scene, &RenderOptions::passes(0..16), &Quiet).expect("passes").film.error();
    agree(&some.error.expect("an error"), &whole.expect("an error"));
}

/// Guards the same with photons: of one pixel in sixteen, with one photon in sixteen in disks four times as wide. And that
/// these bring as much light.
#[test]
fn some_photons_speak_for_all() {
    let algorithms = Algorithms { caustics: CausticsMode::Photon, ..Algorithms::PATHS };
    let options = Options { algorithms, ..options([128; 2], seed("some photons speak for all"), None) };
    let scene = prepare(&parse_toml(HEXROOM).expect("a scene of the project").0, &options).expect("a camera");
    let sparse = Sparse::new([128; 2], [0, 0, 128, 128], 1024, 1024);
    assert_eq!(sparse.map(|s| (s.grid(), s.coarse())), Some(([32; 2], 4)));
    let of = |sparse| {
        let options = RenderOptions { sparse, layer_noise: true, ..RenderOptions::passes(0..32) };
        render(&scene, &options, &Quiet).expect("passes").film
    };
    let (some, whole) = (of(sparse), of(None));
    let noise = |film: &Film| Squares { map_bias: None, ..film.error_squares().expect("squares") }.estimate();
    agree(&noise(&some), &noise(&whole));
    let caustics = |film: &Film| {
        let all = film.layer_shares().expect("layers");
        *all.iter().find(|s| s.layer == LightLayer::Caustic).expect("caustics")
    };
    let (some, whole) = (caustics(&some), caustics(&whole));
    assert!((some.light / whole.light - 1.0).abs() < 0.1, "{some:?} {whole:?}");
    assert!((0.6..1.6).contains(&(some.noise / whole.noise)), "{some:?} {whole:?}");
}

/// Guards that a pilot with fewer photons says of the whole picture what it would say of itself: its noise, and which part of
/// the rays looks for what. By paths and photons to a pane of glass, whose light comes from a map for the most part.
#[test]
fn pilots_speak_for_all_photons() {
    let algorithms = Algorithms { caustics: CausticsMode::Photon, ..Algorithms::PATHS };
    let options = Options { algorithms, ..options([256; 2], seed("all photons"), None) };
    let scene = prepare(&parse_toml(SLAB).expect("a scene of the project").0, &options).expect("a camera");
    let pilot = pilot_of(&scene, 1);
    assert_eq!((pilot.every, pilot.passes), (16.0, 16));
    let options = RenderOptions { layer_noise: true, ..RenderOptions::passes(0..16) };
    let whole = render(&scene, &options, &Quiet).expect("passes");
    let noise = |error: &ErrorEstimate| {
        let bias = error.map_bias.map_or(0.0, |b| b.error);
        (error.error * error.error - bias * bias).sqrt()
    };
    let (some, all) = (pilot.error.expect("an error"), whole.film.error().expect("an error"));
    assert!((noise(&some) / noise(&all) - 1.0).abs() < 0.1, "{some:?} {all:?}");
    let rays: u64 = whole.counters.layer_rays.iter().sum();
    for part in &pilot.parts {
        let share = whole.counters.layer_rays[part.layer as usize] as f64 / rays as f64;
        assert!((part.rays - share).abs() < 0.02, "{part:?} {share}");
    }
}

/// Whether two errors are the same, within three times what both intervals allow.
fn agree(a: &ErrorEstimate, b: &ErrorEstimate) {
    let width = |e: &ErrorEstimate| libm::log(e.interval[1] / e.error);
    // Intervals are 1.96 standard errors.
    assert!(libm::log(a.error / b.error).abs() < 1.5 * libm::hypot(width(a), width(b)), "{a:?} {b:?}");
}

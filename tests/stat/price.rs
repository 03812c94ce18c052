//! What shortcuts cost, against closed forms and against what longer renders of other seeds say.

use epsilux::bsdf::fresnel::Fresnel;
use epsilux::color::Rgb;
use epsilux::film::LightLayer;
use epsilux::glam::DVec3;
use epsilux::integrate::{Quiet, RenderOptions, render};
use epsilux::math::mix64;
use epsilux::prepare::{Algorithms, CausticsMode, Effect, Omission, Options, Shortcut, Shortcuts, prepare};
use epsilux::price::{Better, Budget, Price, price};
use epsilux::scene::text::parse_toml;
use epsilux::scene::{FovAxis, MaterialKind, Projection, Scene};
use epsilux::stats::{Interval, Moments};

use crate::agree::enlarge;
use crate::support::fast::{options, valid};
use crate::support::features::camera;
use crate::support::scenes::{Build, diffuse, emitter, glass, glowing, sky};
use crate::support::seed::seed;

const SIZE: [u32; 2] = [20, 20];

/// Errors that a figure may be off: t of 15 degrees of freedom passes 7 with a chance of 4e-6.
const FAR: f64 = 7.0;

/// The quantile that intervals are made of.
const T: f64 = 2.131_449_545_559_323;

const CAUSTICS: Shortcut = Shortcut::Without(Omission::Caustics);
const INDIRECT: Shortcut = Shortcut::Without(Omission::Indirect);

fn file(text: &str) -> Scene {
    valid(&parse_toml(text).expect("a scene of the project").0)
}

fn hexroom() -> Scene {
    let mut scene = file(include_str!("../../scenes/hexroom.toml"));
    enlarge(&mut scene, "light", 4.8);
    scene
}

/// Prices shortcuts one by one.
fn prices(scene: &Scene, options: &Options, shortcuts: &[Shortcut], passes: u32) -> Vec<Price> {
    let sets: Vec<_> = shortcuts.iter().map(|&s| vec![s]).collect();
    let budget = Budget { passes, ..Budget::default() };
    let list = price(scene, options, &sets, &budget, &Quiet).expect("a scene");
    list.into_iter().map(|p| p.price.unwrap_or_else(|e| panic!("{:?}: {e}", p.shortcuts))).collect()
}

fn standard_error(e: Interval) -> f64 {
    e.within() / T
}

#[track_caller]
fn near(what: &str, found: Interval, expected: f64, error: f64, sees: f64) {
    let sigma = libm::hypot(standard_error(found), error);
    assert!(
        (found.value - expected).abs() <= FAR * sigma + 1e-6,
        "{what}: {} +- {sigma}, expected {expected}",
        found.value
    );
    assert!(FAR * sigma < sees, "{what}: too noisy to see {sees}: {sigma}");
}

/// Luminance of layers over that of all light, from runs of a render with seeds of its own.
fn shares(scene: &Scene, base: &Options, passes: u32) -> [Moments; 5] {
    let mut moments = [Moments::default(); 5];
    for run in 0..12u64 {
        let options = Options { seed: mix64(base.seed ^ (run + 1) << 20), ..base.clone() };
        let prepared = prepare(scene, &options).expect("a scene");
        let how = RenderOptions { layers: true, ..RenderOptions::passes(0..passes) };
        let image = render(&prepared, &how, &Quiet).expect("passes").film.to_image();
        let luminance = LightLayer::ALL.map(|layer| {
            let channels = image.layers.iter().flat_map(|l| &l.channels);
            let of = |(c, w): (&str, f64)| {
                let name = format!("{}.{c}", layer.name());
                let (_, values) = channels.clone().find(|(n, _)| *n == name).expect("recorded");
                w * values.iter().map(|&v| f64::from(v)).sum::<f64>()
            };
            [("R", 0.2126), ("G", 0.7152), ("B", 0.0722)].map(of).iter().sum::<f64>()
        });
        let all: f64 = luminance.iter().sum();
        moments.iter_mut().zip(luminance).for_each(|(m, l)| m.add(l / all));
    }
    moments
}

/// Guards the bias of a picture without caustics: minus the layer of caustics, as renders with other seeds have it, and
/// nothing from any other layer, to the last bit. By photons it is the same, up to the bias of their map.
#[test]
fn without_caustics_lacks_their_layer() {
    let scene = hexroom();
    let base = options(SIZE, seed("without caustics"), None);
    let truth = shares(&scene, &base, 64);
    let caustic = &truth[LightLayer::Caustic as usize];
    let share = caustic.mean;
    let error = caustic.variance_of_mean().sqrt();
    let path = prices(&scene, &base, &[CAUSTICS], 32).remove(0);
    near("by paths", path.bias, -share, error, 0.3 * share);
    for (layer, bias) in &path.layers {
        assert!((bias.value != 0.0) == (*layer == LightLayer::Caustic), "{layer:?}: {bias:?}");
    }
    assert!(path.error.low > 0.0 && path.variance < 1.0, "{path:?}");
    assert!(matches!(path.better, Better::Until(_)), "{:?}", path.better);
    let algorithms = Algorithms { caustics: CausticsMode::Photon, unbiased: false, ..Algorithms::PATHS };
    let photon = prices(&scene, &Options { algorithms, ..base }, &[CAUSTICS], 16).remove(0);
    near("by photons", photon.bias, -share, error + 0.03 * share / FAR, 0.3 * share);
    assert!(photon.work < 0.95, "photons are not traced: {}", photon.work);
    // Where caustics lie, and how bright they are there, is the same.
    let [a, b] = [path.error, photon.error];
    assert!((a.value / b.value - 1.0).abs() < 0.25, "{a:?} {b:?}");
}

/// A room whose walls emit 0.5 and reflect 0.5: after k events the radiance is 1 - 0.5^(k + 1).
fn furnace() -> Scene {
    let mut scene = Scene::default();
    scene.sphere(DVec3::ZERO, 1.0, glowing(0.5, 0.5));
    scene.cameras.push(camera(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.5, -0.3, 0.7), 60.0));
    valid(&scene)
}

/// Guards caps on depth, indirect light and its gain by the closed form, and that a clamp to next to nothing leaves what
/// one event brings.
#[test]
fn a_furnace_has_closed_forms() {
    let scene = furnace();
    let base = options(SIZE, seed("furnace"), None);
    let cases = [
        (Shortcut::MaxDepth(0), -0.5),
        (Shortcut::MaxDepth(1), -0.25),
        (Shortcut::MaxDepth(2), -0.125),
        (Shortcut::MaxDepth(5), -0.015_625),
        (INDIRECT, -0.25),
        (Shortcut::IndirectGain(3.0), 0.5),
        (Shortcut::IndirectGain(0.0), -0.25),
        (Shortcut::Clamp(1e-7), -0.25),
        (Shortcut::Clamp(1e7), 0.0),
    ];
    let found = prices(&scene, &base, &cases.map(|(s, _)| s), 8);
    for ((shortcut, expected), price) in cases.into_iter().zip(&found) {
        near(&shortcut.to_string(), price.bias, expected, 0.0, 0.01);
        // Every pixel has the same bias: over sqrt(1 + 0.1^2).
        let error = expected.abs() / 1.01f64.sqrt();
        assert!((price.error.value - error).abs() < 0.01, "{shortcut}: {:?} {error}", price.error);
        let shorter = matches!(shortcut, Shortcut::MaxDepth(_) | Shortcut::Without(_))
            || shortcut == Shortcut::IndirectGain(0.0);
        assert_eq!(price.work < 1.0, shorter, "{shortcut}: {}", price.work);
    }
    let clamped = &found[8];
    assert_eq!(
        (clamped.bias.value, clamped.work, clamped.variance),
        (0.0, 1.0, 1.0),
        "a clamp above all light"
    );
    // Emission alone is one ray; the others are known to be a little more than five.
    assert!((found[0].work * found[0].rays - 1.0).abs() < 1e-9);
}

/// Guards the gain in a room of glass and mirrors: the picture is linear in it, whichever estimator finds the light. What
/// is added with a gain of two is what lacks without indirect light, to rounding.
#[test]
fn the_picture_is_linear_in_the_gain() {
    let scene = hexroom();
    for (caustics, unbiased) in
        [(CausticsMode::Path, false), (CausticsMode::Photon, false), (CausticsMode::Photon, true)]
    {
        let algorithms = Algorithms { caustics, unbiased, ..Algorithms::PATHS };
        let base = Options { algorithms, ..options(SIZE, seed("gain"), None) };
        let gains = [INDIRECT, Shortcut::IndirectGain(2.0), Shortcut::IndirectGain(4.0)];
        let [without, twice, four] = <[Price; 3]>::try_from(prices(&scene, &base, &gains, 4)).expect("three");
        assert!(without.bias.value < -0.1, "{without:?}");
        for (name, price, factor) in [("2", &twice, 1.0), ("4", &four, 3.0)] {
            let expected = -factor * without.bias.value;
            assert!((price.bias.value / expected - 1.0).abs() < 1e-5, "{caustics:?} {name}: {price:?}");
            assert_eq!(price.work, 1.0);
        }
        assert!(without.work < 0.8, "paths end: {}", without.work);
    }
}

/// Guards Schlick's curve through the whole pipeline: a block of glass on a black floor under a white sky shows its
/// reflectance, at 60 degrees 0.0892 by Fresnel (O10) and 0.07 by Schlick.
#[test]
fn schlick_darkens_glass() {
    let mut scene = Scene::default();
    scene.square(DVec3::ZERO, DVec3::Y, 40.0, diffuse(0.0));
    scene.cuboid(DVec3::new(-20.0, 1.0, -20.0), DVec3::new(20.0, 2.0, 20.0), glass(1.5));
    scene.environment = sky(1.0);
    let towards = DVec3::new(0.75f64.sqrt(), 0.5, 0.0);
    let mut front = camera(3.0 * towards + DVec3::Y * 2.0, DVec3::Y * 2.0, 40.0);
    front.projection = Projection::Orthographic { extent: 1.0, axis: FovAxis::Horizontal };
    scene.cameras.push(front);
    let scene = valid(&scene);
    let price = prices(&scene, &options(SIZE, seed("schlick"), None), &[Shortcut::Schlick], 32).remove(0);
    let reflectance = |fresnel: Fresnel| f64::from(fresnel.dielectric(0.5, 1.5).0);
    let exact = reflectance(Fresnel::Exact);
    assert!((exact - 0.089_186).abs() < 1e-5);
    // What enters the glass leaves it below, for the floor, or by way of its lower face, towards the sky: two faces.
    let faces = |r: f64| r + (1.0 - r) * (1.0 - r) * r / (1.0 - r * r);
    let expected = faces(0.07) / faces(exact) - 1.0;
    near("Schlick", price.bias, expected, 0.0, 0.05);
    assert!(price.layers.iter().all(|(layer, bias)| *layer == LightLayer::Glass || bias.value == 0.0));
}

/// Guards clamps where they matter: a lamp in a mirror is seen over one event and kept, what it throws through two is cut.
#[test]
fn a_clamp_spares_what_one_event_brings() {
    let mut scene = Scene::default();
    scene.square(DVec3::ZERO, DVec3::Y, 8.0, diffuse(0.5));
    scene.square(DVec3::new(0.0, 4.0, 0.0), -DVec3::Y, 1.0, emitter(40.0));
    scene.cameras.push(camera(DVec3::new(0.0, 1.0, 3.0), DVec3::ZERO, 40.0));
    let scene = valid(&scene);
    let base = options(SIZE, seed("clamp"), None);
    let direct = prices(&scene, &base, &[Shortcut::Clamp(1e-6)], 8).remove(0);
    assert_eq!((direct.bias.value, direct.variance), (0.0, 1.0), "nothing but direct light");
    let room = prices(&hexroom(), &base, &[Shortcut::Clamp(0.1), Shortcut::MaxDepth(1)], 8);
    assert!(room[0].bias.high < -0.005 && room[0].variance < 1.0, "{:?}", room[0]);
    for ((layer, clamped), (_, capped)) in room[0].layers.iter().zip(&room[1].layers) {
        assert!(clamped.value >= capped.value - 1e-9, "{layer:?} lost more than all of its light");
    }
}

/// Guards that what is priced is what would be rendered: in a picture large enough for a pilot, caustics are by photons,
/// so that leaving them out saves the photons too, and pays for a short while only.
#[test]
fn prices_have_the_choices_of_the_render() {
    let scene = file(include_str!("../../scenes/caustic.toml"));
    let base = Options { algorithms: Algorithms::default(), ..options([200, 200], seed("choices"), None) };
    let of = |pilot: bool| {
        let budget = Budget { passes: 2, pilot, ..Budget::default() };
        let list = price(&scene, &base, &[vec![CAUSTICS]], &budget, &Quiet).expect("a scene");
        list.into_iter().next().expect("one").price.expect("measured")
    };
    let (paths, photons) = (of(false), of(true));
    assert!(paths.work > 0.9, "{paths:?}");
    assert!(photons.work < 0.8, "{photons:?}");
    // Without caustics there is as little noise; with them paths have much more of it.
    assert!(photons.variance > 5.0 * paths.variance, "{photons:?} {paths:?}");
}

/// Guards prices as a function of scene and settings: threads change nothing, nor do shortcuts that the options take
/// themselves; and what is not there is not measured.
#[test]
fn prices_repeat() {
    let scene = hexroom();
    let base = options([12, 12], seed("repeat"), None);
    let sets = [vec![CAUSTICS], vec![CAUSTICS, Shortcut::MaxDepth(3)]];
    let run = |options: &Options, threads| {
        let budget = Budget { passes: 2, threads, ..Budget::default() };
        let mut list = price(&scene, options, &sets, &budget, &Quiet).expect("a scene");
        for p in &mut list {
            p.price.as_mut().expect("measured").elapsed = [std::time::Duration::ZERO; 2];
        }
        list
    };
    let first = run(&base, 1);
    assert_eq!(run(&base, 3), first);
    let taken = Shortcuts { clamp: Some(0.1), ..Shortcuts::default() };
    assert_eq!(run(&Options { shortcuts: taken, max_depth: Some(1), ..base.clone() }, 1), first);
    assert_ne!(run(&Options { seed: 1, ..base.clone() }, 1), first);
    let lens = Shortcut::Without(Omission::Effect(Effect::Lens));
    let idle = price(&scene, &base, &[vec![lens]], &Budget::default(), &Quiet).expect("a scene").remove(0);
    assert_eq!(idle.price.expect_err("a pinhole"), "the camera is a pinhole");
    let mut dark = scene.clone();
    dark.materials.iter_mut().for_each(|m| {
        if let MaterialKind::Light { radiance, .. } = &mut m.kind {
            *radiance = Rgb::BLACK;
        }
    });
    let black =
        price(&dark, &base, &[vec![CAUSTICS]], &Budget::default(), &Quiet).expect("a scene").remove(0);
    assert_eq!(black.price.expect_err("no light"), "the picture is black");
}

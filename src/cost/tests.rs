//! What a measurement promises, on a scene of few pixels.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::*;
use crate::page::is_well_formed;
use crate::prepare::{Algorithms, EffectsMode, Options, Shortcuts};
use crate::scene::Scene;
use crate::stats::Interval;

/// A clock that counts how often it was asked, so that equal measurements tell equal times.
#[derive(Default)]
struct Counting(AtomicU64);

impl Observer for Counting {
    fn seconds(&self) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed) as f64
    }
}

/// A lamp over a matte floor, a ball of glass and a mirror.
const BALLS: &str = "
    epsilux = 1
    [camera.front]
    eye = [0, 1, 5]
    target = [0, 0.7, 0]
    fov = 40
    [material]
    floor = { diffuse = [0.7, 0.7, 0.7] }
    clear = { glass = { ior = 1.5 } }
    mirror = { mirror = [0.9, 0.9, 0.9] }
    lamp = { light = [8, 8, 8] }
    [[object]]
    material = 'floor'
    rect = { corner = [-5, 0, 5], edges = [[10, 0, 0], [0, 0, -10]] }
    [[object]]
    material = 'clear'
    sphere = { center = [-0.7, 0.6, 0], radius = 0.6 }
    [[object]]
    material = 'mirror'
    sphere = { center = [0.8, 0.5, 0], radius = 0.5 }
    [[object]]
    material = 'lamp'
    sphere = { center = [0, 4, 1], radius = 0.8 }
";

fn parsed(text: &str) -> Scene {
    let (mut scene, _) = crate::scene::text::parse(text).expect("a scene");
    crate::scene::complete(&mut scene);
    scene
}

fn balls() -> Scene {
    parsed(BALLS)
}

/// The objects of some materials alone.
fn only(mut scene: Scene, materials: &[&str]) -> Scene {
    scene.objects.retain(|o| materials.contains(&&*scene.materials[o.material.0 as usize].name));
    scene
}

/// A lamp over a matte floor: nothing throws light or scatters it twice.
fn matte() -> Scene {
    only(balls(), &["floor", "lamp"])
}

/// Matte balls under the sky, where noise is everywhere.
fn sky() -> Scene {
    let text = BALLS.replace("'clear'", "'floor'").replace("'mirror'", "'floor'");
    only(parsed(&(text + "[environment]\nradiance = [1, 1, 1]\n")), &["floor"])
}

fn options() -> CostOptions {
    CostOptions {
        name: "balls".into(),
        prepare: Options {
            camera: None,
            size: [64, 48],
            seed: 0,
            effects: EffectsMode::Auto,
            max_depth: None,
            shortcuts: Shortcuts::default(),
            transparent: false,
            algorithms: Algorithms::default(),
        },
        unbiased: false,
        measured: [16, 12],
        seeds: 4,
        effort: Effort::Samples(32),
        threads: 2,
    }
}

type Measurement = (CostReport, Pictures);

fn of(scene: &Scene, options: &CostOptions) -> Measurement {
    measure(scene, options, &Counting::default()).expect("a measurement")
}

static OF_BALLS: LazyLock<Measurement> = LazyLock::new(|| of(&balls(), &options()));
static OF_SKY: LazyLock<Measurement> =
    LazyLock::new(|| of(&sky(), &CostOptions { measured: [48, 36], seeds: 2, ..options() }));

/// What stands at each place of a table: what its numbers are counted in; texts only where they are one of a few.
fn shape(value: &serde_json::Value, place: &str, found: &mut BTreeMap<String, BTreeSet<String>>) {
    use serde_json::Value;
    let mut say = |what: String| {
        found.entry(place.to_owned()).or_default().insert(what);
    };
    match value {
        Value::Object(all) => all.iter().for_each(|(key, v)| shape(v, &format!("{place}.{key}"), found)),
        Value::Array(all) => all.iter().for_each(|v| shape(v, &format!("{place}[]"), found)),
        Value::String(s) if place.ends_with("schema") || place.ends_with("kind") || place.ends_with("is") => {
            say(format!("{s:?}"));
        }
        Value::String(_) => say("text".into()),
        Value::Number(_) => say(unit(place).into()),
        Value::Bool(_) => say("true or false".into()),
        // Where a number is not known.
        Value::Null => say("null".into()),
    }
}

/// What a number is counted in, by the last name of its place that is not an end of an interval.
fn unit(place: &str) -> &'static str {
    let ends = ["value", "low", "high"];
    let key = place.rsplit(['.', '[', ']']).find(|name| !name.is_empty() && !ends.contains(name));
    match key.unwrap_or_default() {
        _ if place.starts_with(".layers") => "share",
        "size" | "measured" => "pixels",
        "spp" | "reference_spp" | "samples" | "after" | "came" | "over" => "samples a pixel",
        "seconds" | "seconds_per_pass" | "seconds_quartiles" => "processor seconds",
        "rays_per_sample" => "rays",
        "error" | "reference_error" | "last" | "noise" | "floor" => "relative error",
        "bias_squared" => "square of a relative error",
        "change" | "difference" => "share",
        _ => "number",
    }
}

/// A row of a table for people, in two digits.
fn row(m: &Measured) -> String {
    let last = m.points.last().expect("points");
    let samples = m.price(0.01).map_or(f64::NAN, |p| p.samples.value);
    let efficiency = m.efficiency.unwrap_or(f64::NAN);
    let figures = [m.rays_per_sample, last.error.value, last.noise, m.floor.value, samples, efficiency];
    let [rays, error, noise, floor, samples, efficiency] = figures.map(|v| format!("{v:.1e}"));
    format!(
        "{} ({}): {rays} rays a sample; after {} samples E {error}, noise {noise}; floor {floor}; 1 % at {samples} \
         samples; efficiency {efficiency}",
        m.name, m.flag, last.spp
    )
}

/// The form of the JSON, and one way of each kind with its figures, which are a function of scene, settings and
/// samples.
#[test]
fn the_report_in_short() {
    let reports = [&OF_BALLS.0, &OF_SKY.0];
    let mut found = BTreeMap::new();
    for report in reports {
        shape(&serde_json::to_value(report).expect("JSON"), "", &mut found);
    }
    let mut lines: Vec<String> = found
        .iter()
        .map(|(place, what)| format!("{place}: {}", what.iter().cloned().collect::<Vec<_>>().join(" or ")))
        .collect();
    for kind in [Kind::Full, Kind::Algorithm, Kind::Shortcut] {
        lines.extend(reports[0].switches.iter().find(|m| m.kind == kind).map(row));
    }
    insta::assert_snapshot!(lines.join("\n"));
}

/// Every interval of a table, with its place.
fn intervals(value: &serde_json::Value, place: &str, found: &mut Vec<(String, [f64; 3])>) {
    use serde_json::Value;
    match value {
        Value::Object(all) if all.contains_key("low") => {
            // What is not finite is null.
            let of = |key: &str, instead| all[key].as_f64().unwrap_or(instead);
            let value = of("value", f64::NAN);
            found.push((place.to_owned(), [of("low", f64::NEG_INFINITY), value, of("high", f64::INFINITY)]));
        }
        Value::Object(all) => all.iter().for_each(|(key, v)| intervals(v, &format!("{place}.{key}"), found)),
        Value::Array(all) => all.iter().for_each(|v| intervals(v, &format!("{place}[]"), found)),
        _ => {}
    }
}

/// Guards that figures are a function of scene, settings and samples, and what holds between them: intervals hold
/// their figure, E^2 is noise^2 + bias^2, less error costs more, seconds are samples times those of a pass.
#[test]
fn figures_can_be_repeated_and_fit_together() {
    let report = &OF_BALLS.0;
    let json = |r: &CostReport| serde_json::to_value(r).expect("JSON");
    assert_eq!(json(report), json(&of(&balls(), &options()).0));
    let mut all = Vec::new();
    intervals(&json(report), "", &mut all);
    assert!(all.len() > 100, "{}", all.len());
    for (place, [low, value, high]) in all {
        assert!(value.is_nan() || (low <= value && value <= high), "{place}: {low} {value} {high}");
    }
    for m in &report.switches {
        for p in &m.points {
            let [error, noise] = [p.error.value * p.error.value, p.noise * p.noise];
            let parts = (noise + p.bias_squared.value).max(0.0);
            assert!((error - parts).abs() < 1e-9 * noise, "{}: {p:?}", m.name);
        }
        for pair in m.prices.windows(2) {
            assert!(
                pair[0].error > pair[1].error && pair[0].samples.value < pair[1].samples.value,
                "{pair:?}"
            );
        }
        for p in &m.prices {
            assert!((p.seconds.value - p.samples.value * m.seconds_per_pass).abs() < 1e-9 * p.seconds.value);
        }
        assert_eq!(m.points.iter().map(|p| p.spp).collect::<Vec<_>>(), [1, 2, 4, 8, 16, 32], "{}", m.name);
    }
}

/// Guards that everything that can be switched is tried, and what changes nothing is not: where nothing throws light or
/// scatters it twice, several samples of lights are all there is.
#[test]
fn what_changes_nothing_is_not_offered() {
    let names = |report: &CostReport, kind: Kind| -> Vec<String> {
        report.switches.iter().filter(|m| m.kind == kind).map(|m| m.name.clone()).collect()
    };
    let report = &OF_BALLS.0;
    assert_eq!(report.switches[0].name, "full");
    let ways = names(report, Kind::Algorithm);
    let expected = [
        "caustics by photons",
        "indirect light by photons",
        "4 light samples",
        "split 4 ways",
        "roulette from event 2",
        "roulette from event 8",
    ];
    assert_eq!(ways, expected);
    let shortcuts = names(report, Kind::Shortcut);
    for name in ["at most 4 events", "without mirror", "without caustics", "Schlick's reflectance"] {
        assert!(shortcuts.iter().any(|s| s == name), "{shortcuts:?}");
    }
    assert_eq!(names(&of(&matte(), &options()).0, Kind::Algorithm), ["4 light samples"]);
}

/// Guards that a quote is one beforehand, and right within the width of its interval; and that there is none where the
/// pilot does not see enough.
#[test]
fn quotes_are_held_against_what_came() {
    let said = OF_SKY.0.prediction.expect("long enough runs");
    assert!(said.came == 32 && said.after == 16, "{said:?}");
    let samples = said.samples.expect("a quote");
    let came = f64::from(said.came);
    let off = (came / samples.value).max(samples.value / came);
    assert!(off < samples.high / samples.low, "{said:?}");
    // Caustics that are met by chance.
    assert!(OF_BALLS.0.prediction.is_none_or(|p| p.samples.is_none()));
}

/// Guards that what is left out shows: without the mirror light is missing, which is a bias, and the errors of the
/// method without chance caustics fall.
#[test]
fn what_is_left_out_is_a_bias() {
    let (report, pictures) = &*OF_BALLS;
    let full = &report.switches[0];
    assert_eq!((full.efficiency, full.until), (Some(1.0), Until::NoShortcut));
    let photons = report.switches.iter().find(|m| m.name == "caustics by photons").expect("a switch");
    assert!(photons.points[4].error.value < 0.6 * photons.points[0].error.value, "{:?}", photons.points);
    let direct = report.switches.iter().find(|m| m.name == "at most 1 event").expect("a switch");
    assert!(direct.change.high < 0.0 && direct.floor.low > 0.0, "{direct:?}");
    let light: f64 = report.layers.iter().map(|l| l.light).sum();
    assert!((light - 1.0).abs() < 1e-5, "{light}");
    assert_eq!(pictures.switches.len(), report.switches.len());
    assert_eq!(pictures.whole.len(), (pictures.size[0] * pictures.size[1]) as usize);
}

/// Guards the page: well formed, from nowhere else, and no text of others as markup.
#[test]
fn the_page_stands_alone() {
    let (mut report, pictures) = OF_BALLS.clone();
    let evil = "\"><script>alert('x')</script>&";
    report.scene = evil.into();
    for m in &mut report.switches[1..] {
        (m.name, m.what, m.gives_up, m.flag) = (evil.into(), evil.into(), evil.into(), evil.into());
    }
    let about = About { command: evil.into(), facts: vec![(evil.into(), evil.into())] };
    let prices = crate::check::prices();
    let html = page(&report, &pictures, &prices, &about);
    is_well_formed(&html);
    assert_eq!(html.matches("<script").count(), 1, "its own alone");
    assert!(!html.contains("'x'"));
    for foreign in ["http:", "https:", "<link", "@import", "javascript:"] {
        assert!(!html.contains(foreign), "{foreign}");
    }
    assert!(html.split("src=\"").skip(1).all(|s| s.starts_with("data:image/png;base64,")));
    assert!(html.split("url(").skip(1).all(|s| s.starts_with("data:image/png;base64,")));
    assert_eq!(html.matches("<img ").count(), html.matches(" alt=\"").count());
    let text: String =
        html.split("base64,").map(|s| s.split_once(['"', ')']).map_or(s, |(_, rest)| rest)).collect();
    assert!(
        !text.contains("NaN") && !text.contains("inf,") && !text.contains("inf\""),
        "numbers that are none"
    );
}

/// Guards that the page tells no price of a way whose errors do not converge, and says so.
#[test]
fn what_does_not_converge_has_no_price() {
    let mut report = OF_BALLS.0.clone();
    let other = report.switches.iter().position(|m| m.kind == Kind::Algorithm).expect("another way");
    let mut way = report.switches.swap_remove(other);
    let fit = way.fit.as_mut().expect("a line");
    (fit.slope, fit.last) = (Interval::around(-0.3, 0.5), Interval::around(0.9, 0.3));
    way.prices.clear();
    way.points.last_mut().expect("points").error.value = 0.9;
    report.switches.truncate(1);
    report.switches.push(way);
    let html = page(&report, &OF_BALLS.1, &[], &About::default());
    is_well_formed(&html);
    assert!(html.contains("not converging") && html.contains("cannot be told"), "{html}");
    let full = report.switches[0].fit.as_mut().expect("a line");
    full.slope = Interval::around(-0.3, 0.5);
    report.switches[0].prices.clear();
    assert!(page(&report, &OF_BALLS.1, &[], &About::default()).contains("It does not converge yet"));
}

/// A page of nothing is a page; a black scene is an error; whoever cancels is obeyed.
#[test]
fn nothing_is_measured_of_nothing() {
    let mut report = OF_BALLS.0.clone();
    for m in &mut report.switches {
        (m.fit, m.points, m.prices) = (None, Vec::new(), Vec::new());
    }
    (report.layers, report.prediction, report.stated) = (Vec::new(), None, [0, 0]);
    is_well_formed(&page(&report, &Pictures::default(), &[], &About::default()));

    let dark = only(balls(), &["floor", "clear", "mirror"]);
    let black = measure(&dark, &options(), &Counting::default());
    assert!(matches!(black, Err(CostError::Black)));

    struct Impatient;
    impl Observer for Impatient {
        fn seconds(&self) -> f64 {
            0.0
        }
        fn cancelled(&self) -> bool {
            true
        }
    }
    let timed = CostOptions { effort: Effort::Time(Duration::from_millis(100)), ..options() };
    let stopped = measure(&balls(), &timed, &Impatient);
    assert!(matches!(stopped, Err(CostError::Run(crate::integrate::RunError::Cancelled))));
}

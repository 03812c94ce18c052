//! What a measurement promises, on a scene of few pixels.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use super::*;
use crate::page::is_well_formed;
use crate::prepare::{Algorithms, EffectsMode, Options, Shortcuts};
use crate::scene::Scene;

/// A clock that counts how often it was asked, so that equal measurements tell equal times.
#[derive(Default)]
struct Counting(AtomicU64);

impl Observer for Counting {
    fn seconds(&self) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed) as f64
    }
}

/// A lamp over a matte floor, a ball of glass and a mirror.
fn scene() -> Scene {
    const TEXT: &str = "
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
    let (mut scene, _) = crate::scene::text::parse(TEXT).expect("a scene");
    crate::scene::complete(&mut scene);
    scene
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
        measured: [16, 12],
        seeds: 4,
        effort: Effort::Samples(16),
        threads: 2,
    }
}

fn measured() -> (CostReport, Pictures) {
    measure(&scene(), &options(), &Counting::default()).expect("a measurement")
}

/// Keeps four digits of every number: quantiles of distributions may differ in their last bits between machines.
fn shorten(value: &mut serde_json::Value) {
    match value {
        serde_json::Value::Array(all) => all.iter_mut().for_each(shorten),
        serde_json::Value::Object(all) => all.values_mut().for_each(shorten),
        serde_json::Value::Number(n) if n.is_f64() => {
            let short: f64 = format!("{:.3e}", n.as_f64().unwrap_or_default()).parse().expect("a number");
            *value = short.into();
        }
        _ => {}
    }
}

/// Guards that figures are a function of scene, settings and samples, that nothing known is missing from them, and
/// the form of the JSON.
#[test]
fn figures_can_be_repeated() {
    let (report, _) = measured();
    let json = |r: &CostReport| {
        let mut value = serde_json::to_value(r).expect("JSON");
        shorten(&mut value);
        serde_json::to_string_pretty(&value).expect("JSON")
    };
    assert_eq!(json(&report), json(&measured().0));
    let names: Vec<&str> = report.switches.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names[0], "full");
    for name in ["at most 4 events", "without mirror", "without caustics", "Schlick's reflectance"] {
        assert!(names.contains(&name), "{names:?}");
    }
    insta::assert_snapshot!(json(&report));
}

/// Guards that what is left out shows: without the mirror light is missing, which is a bias, and the errors of the
/// full method fall.
#[test]
fn what_is_left_out_is_a_bias() {
    let (report, pictures) = measured();
    let full = &report.switches[0];
    assert_eq!((full.efficiency, full.until), (Some(1.0), Until::NoShortcut));
    assert!(full.points[4].error.value < 0.6 * full.points[0].error.value, "{:?}", full.points);
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
    let (mut report, pictures) = measured();
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

/// A page of nothing is a page; a black scene is an error; whoever cancels is obeyed.
#[test]
fn nothing_is_measured_of_nothing() {
    let (mut report, _) = measured();
    for m in &mut report.switches {
        (m.fit, m.points, m.prices) = (None, Vec::new(), Vec::new());
    }
    (report.layers, report.prediction, report.stated) = (Vec::new(), None, [0, 0]);
    is_well_formed(&page(&report, &Pictures::default(), &[], &About::default()));

    let mut dark = scene();
    dark.objects.retain(|o| dark.materials[o.material.0 as usize].name != "lamp");
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
    let stopped = measure(&scene(), &timed, &Impatient);
    assert!(matches!(stopped, Err(CostError::Run(crate::integrate::RunError::Cancelled))));
}

//! What a page promises, on made-up verifications.

use std::sync::LazyLock;

use super::*;
use crate::film::Image;
use crate::golden::Check;
use crate::page::is_well_formed;

static MADE: LazyLock<Vec<Verification>> = LazyLock::new(made::verifications);

fn about() -> About {
    About {
        title: "Golden tests".into(),
        command: "epsilux golden verify golden.toml --page golden.html".into(),
        significance: 1e-3,
        facts: vec![("Version".into(), "0.1.0".into()), ("Machine".into(), "2 cores".into())],
    }
}

/// What happened is said first, and the culprit is named before anything that went well.
#[test]
fn names_the_outcome_and_the_culprit() {
    let html = page(&MADE, &about());
    let place = |needle: &str| html.find(needle).unwrap_or_else(|| panic!("{needle} is missing"));
    let outcome = place("<h1 class=\"refused\">3 scenes: 1 passed, 1 improved, 1 refused</h1>");
    let [culprit, passed] =
        ["caustic light -6.0 %, z = -12.4", "<a href=\"#glossy-floor\">glossy-floor</a>"].map(place);
    assert!(outcome < culprit && culprit < passed);
    assert!(html.contains("<tr class=\"beyond\"><th scope=\"row\">matched, caustic</th>"));
    assert!(html.contains("class=\"frame\""), "the tile that is beyond the threshold is outlined");
    assert!(place("golden bless golden.toml --scene caustic-ball") > culprit);
}

/// Scenes that need a look are unfolded, and nobody is told to bless one that passed.
#[test]
fn passed_scenes_are_folded() {
    let html = page(&MADE, &about());
    assert_eq!(html.matches("<details open>").count(), 2);
    assert_eq!(html.matches("<details>").count(), 1);
    assert!(html.contains("golden verify golden.toml --scene glossy-floor"));
    assert!(!html.contains("golden bless golden.toml --scene glossy-floor"));
}

/// The page stands alone: no script, and every link and picture is within it.
#[test]
fn needs_nothing_else() {
    let html = page(&MADE, &about());
    for foreign in ["http:", "https:", "<script", "<link", "@import", "url(", "javascript:"] {
        assert!(!html.contains(foreign), "{foreign}");
    }
    assert!(html.split("src=\"").skip(1).all(|s| s.starts_with("data:image/png;base64,")));
    assert!(html.split("href=\"").skip(1).all(|s| s.starts_with('#')));
    // Reference, render, two maps of the difference, and two pictures for each part of the light.
    assert_eq!(html.matches("<img ").count(), 3 * (4 + 2 * 5));
    assert_eq!(html.matches("<img ").count(), html.matches(" alt=\"").count());
}

/// Equal verifications make equal pages.
#[test]
fn is_deterministic() {
    assert_eq!(page(&MADE, &about()), page(&MADE.clone(), &about()));
}

/// Text from scene files and command lines cannot become markup.
#[test]
fn foreign_text_is_escaped() {
    let evil = "\"><script>alert('x')</script>&";
    let mut v = MADE[1].clone();
    for text in [&mut v.name, &mut v.guards, &mut v.truth, &mut v.replay, &mut v.bless] {
        *text = evil.into();
    }
    v.reasons[0].message = evil.into();
    v.reasons[0].gate = evil.into();
    v.checks[0].message = evil.into();
    v.power[0].statistic = evil.into();
    let facts = vec![(evil.to_owned(), evil.to_owned())];
    let html = page(&[v], &About { title: evil.into(), command: evil.into(), facts, ..about() });
    assert!(!html.contains("<script") && !html.contains("'x'"));
    is_well_formed(&html);
}

/// Every element ends where it should, and no id occurs twice, for scenes of one name too.
#[test]
fn is_well_formed_html() {
    is_well_formed(&page(&MADE, &about()));
    let twins = [MADE[0].clone(), MADE[0].clone()];
    is_well_formed(&page(&twins, &about()));
    is_well_formed(&page(&[], &About::default()));
}

/// A render that failed, and numbers that are none, still make a page, and say what they are.
#[test]
fn broken_verifications_make_a_page() {
    let mut nothing = MADE[1].clone();
    nothing.image = None;
    nothing.outcome = None;
    nothing.z = Vec::new();
    nothing.curve = Vec::new();
    nothing.power = Vec::new();
    nothing.seconds = f64::NAN;
    nothing.checks = vec![Check { name: "finite", holds: false, message: "7 values are not finite".into() }];
    let html = page(&[nothing.clone()], &about());
    assert!(html.contains("nothing could be rendered") && html.contains("<li class=\"fails\">"));
    is_well_formed(&html);

    let mut odd = MADE[1].clone();
    odd.z[7] = f32::NAN;
    odd.image.as_mut().unwrap().rgb[7].r = f32::INFINITY;
    odd.curve[2].error = f64::NAN;
    let finding = &mut odd.outcome.as_mut().unwrap().findings[0];
    (finding.p, finding.shared, finding.z, finding.shift) = (0.0, 0.0, f64::INFINITY, f64::NAN);
    let html = page(&[odd], &about());
    let text: String = html.split("base64,").map(|s| s.split_once('"').map_or(s, |(_, rest)| rest)).collect();
    assert!(!text.contains("NaN") && !text.contains("inf"), "numbers that are none have words");
    is_well_formed(&html);

    nothing.reference = Image { width: 3, height: 3, ..Image::default() };
    let html = page(&[nothing], &about());
    assert!(html.contains("No picture"));
    is_well_formed(&html);
}

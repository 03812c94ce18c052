//! The referee refereed, on renders: how often soundness is refused, and which changes are seen.

use epsilux::golden::{
    Entry, RecordError, Reference, Settings, Subject, Suite, Verdict, Verification, VerifyOptions, Watch,
    record, verify, verify_picture,
};
use epsilux::integrate::naive::{ReferenceOptions, reference};
use epsilux::integrate::{Control, Quiet};
use epsilux::scene::{MaterialKind, Scene, complete, text::parse_toml};
use epsilux::stats::gate::FEWEST_RUNS;

const CORNELL: &str = include_str!("../../scenes/cornell.toml");
const CAUSTIC: &str = include_str!("../../scenes/caustic.toml");
const HEXROOM: &str = include_str!("../../scenes/hexroom.toml");

/// Alarm rate for one scene.
const SIGNIFICANCE: f64 = 1e-3;

fn scene(text: &str) -> Scene {
    let mut scene = parse_toml(text).expect("a scene of the project").0;
    complete(&mut scene);
    scene
}

/// A guarded scene: its entry, itself, and what was recorded of it.
struct Golden {
    entry: Entry,
    subject: Subject,
    reference: Reference,
}

fn watch() -> Watch<'static> {
    const CONTROL: &dyn Control = &Quiet;
    Watch { control: CONTROL, told: &|_| () }
}

fn guard(name: &str, text: &str, side: u32, more: &str) -> Result<Golden, RecordError> {
    let suite = format!(
        "golden = 1\n[[scene]]\nname = \"{name}\"\nfile = \"-\"\nspp = 32\nsize = [{side}, {side}]\n{more}"
    );
    let entry = Suite::parse(&suite).expect("a suite").scenes.remove(0);
    let scene = scene(text);
    let settings = Settings {
        camera: scene.cameras[0].name.clone(),
        size: entry.size,
        spp: entry.spp,
        max_depth: scene.settings.max_depth,
        caustics: entry.caustics,
    };
    let subject = Subject { scene, settings };
    let reference = record(&entry, &subject, FEWEST_RUNS as u32, "test", &watch())?;
    Ok(Golden { entry, subject, reference })
}

impl Golden {
    fn verify(&self, scene: &Scene, fresh: u64, runs: u32) -> Verification {
        let options = VerifyOptions { runs, fresh, significance: SIGNIFICANCE, check_scene: false };
        let subject = Subject { scene: scene.clone(), settings: self.subject.settings.clone() };
        verify(&self.entry, &subject, &self.reference, &options, &watch()).expect("a scene that renders")
    }
}

/// Verifies a sound scene with fresh seeds, two runs each, and counts alarms at three levels. The trials share a
/// reference, whose own noise they all meet, so that alarms come together; the bounds allow for that, and a
/// rate three times what is promised would be seen.
fn rarely_refused(name: &str, text: &str, trials: u64) {
    let golden = guard(name, text, 24, "").expect("a sound scene");
    let p: Vec<f64> = (1..=trials)
        .map(|fresh| golden.verify(&golden.subject.scene, fresh, 2))
        .map(|v| v.outcome.map_or(0.0, |o| o.p))
        .collect();
    let alarms = |level: f64| p.iter().filter(|&&p| p < level).count();
    let counts = [alarms(0.1), alarms(0.01), alarms(0.001)];
    let bounds = [0.2, 0.035, 0.012].map(|share| (share * trials as f64).ceil() as usize);
    keep(name, &format!("{counts:?} of {trials} below 0.1, 0.01, 0.001\n"));
    assert!(
        counts.iter().zip(bounds).all(|(&n, bound)| n <= bound),
        "{name}: {counts:?}, expected at most {bounds:?}"
    );
}

/// Leaves the figures in a file beside the build, for whoever asks how often soundness is refused.
fn keep(name: &str, text: &str) {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("alarms");
    if std::fs::create_dir_all(&folder).is_ok() {
        let _ = std::fs::write(folder.join(format!("{name}.txt")), text);
    }
}

/// Guards the promise about false alarms where light is smooth.
#[test]
fn sound_diffuse_light_is_rarely_refused() {
    rarely_refused("null-cornell", CORNELL, 340);
}

/// Guards the promise where most light comes by rare paths.
#[test]
fn sound_caustics_are_rarely_refused() {
    rarely_refused("null-caustic", CAUSTIC, 340);
}

/// Guards the promise where everything comes together.
#[test]
fn sound_rooms_are_rarely_refused() {
    rarely_refused("null-hexroom", HEXROOM, 340);
}

/// Makes every lamp this many times as bright.
fn brighter(scene: &Scene, factor: f32) -> Scene {
    let mut scene = scene.clone();
    for material in &mut scene.materials {
        if let MaterialKind::Light { radiance, .. } = &mut material.kind {
            *radiance *= factor;
        }
    }
    scene
}

/// Guards the power: a lamp one per cent brighter, or darker, is refused with nine of ten fresh seeds at least, by
/// a matched filter that names direct light and the size of the change; with the same seeds the scene as it was
/// passes.
#[test]
fn one_per_cent_of_a_lamp_is_seen_and_named() {
    let golden = guard("lamp", CORNELL, 32, "").expect("a sound scene");
    let scene = &golden.subject.scene;
    for factor in [1.01, 0.99] {
        let edited = brighter(scene, factor);
        let named = |v: &Verification| {
            let named = v.reasons.iter().any(|r| r.gate == "matched, direct");
            let mut findings = v.outcome.iter().flat_map(|o| &o.findings);
            let direct = findings.find(|f| f.statistic.to_string() == "matched, direct");
            let expected = f64::from(factor) - 1.0;
            v.verdict == Verdict::Refused
                && named
                && direct.is_some_and(|f| (f.shift - expected).abs() < 0.001)
        };
        let seen = (1..=10).filter(|&fresh| named(&golden.verify(&edited, fresh, 4))).count();
        assert!(seen >= 9, "{factor}: {seen} of 10");
    }
    let passed = (1..=10).filter(|&f| golden.verify(scene, f, 4).verdict == Verdict::Passed).count();
    assert!(passed >= 9, "{passed} of 10 pass");
}

/// Guards that what is stored is what was recorded: the files give the same verdict, and the picture comes back
/// bit for bit.
#[test]
fn files_hold_a_reference() {
    let golden = guard("files", CORNELL, 16, "").expect("a sound scene");
    let (image, text) = golden.reference.to_files().expect("finite numbers");
    let back = Reference::from_files(image, &text).expect("files that were just made");
    assert_eq!(back.image, golden.reference.image);
    assert_eq!(back.profile, golden.reference.profile);
    let read = Golden { reference: back, ..golden };
    let verdict = read.verify(&read.subject.scene, 0, 2);
    assert_eq!(verdict.verdict, Verdict::Passed, "{:?}", verdict.reasons);
    let bytes = verdict.checks.iter().find(|c| c.name == "bytes").expect("fixed seeds");
    assert!(bytes.message.contains("bit for bit"), "{}", bytes.message);
    let broken = text.replacen("matched, luminance", "matched, lightness", 1);
    let (image, _) = read.reference.to_files().expect("finite numbers");
    assert!(Reference::from_files(image, &broken).is_err(), "statistics of another version are refused");
}

/// Guards verification of pictures that another renderer made: the reference integrator's passes, and the same with
/// two per cent more light does not.
#[test]
fn another_renderer_is_judged_by_its_variance() {
    let golden = guard("other", CORNELL, 16, "max_depth = 3").expect("a sound scene");
    let mut subject = golden.subject.clone();
    subject.settings.max_depth = Some(3);
    let golden = Golden {
        reference: record(&golden.entry, &subject, FEWEST_RUNS as u32, "test", &watch())
            .expect("a sound scene"),
        subject,
        ..golden
    };
    let options = ReferenceOptions {
        camera: 0,
        size: [16, 16],
        crop: None,
        spp: 4096,
        seed: 1,
        max_depth: Some(3),
        threads: 0,
    };
    let mut picture =
        reference(&golden.subject.scene, &options, &|| false, &|_| ()).expect("a scene that renders");
    let judged = verify_picture(&golden.entry, &golden.reference, &picture, SIGNIFICANCE);
    assert_eq!(judged.verdict, Verdict::Passed, "{:?}", judged.reasons);
    for c in &mut picture.rgb {
        *c *= 1.06;
    }
    let judged = verify_picture(&golden.entry, &golden.reference, &picture, SIGNIFICANCE);
    assert_eq!(judged.verdict, Verdict::Refused);
    picture.variance = None;
    let judged = verify_picture(&golden.entry, &golden.reference, &picture, SIGNIFICANCE);
    assert_eq!((judged.verdict, judged.reasons[0].gate.as_str()), (Verdict::Refused, "picture"));
}

/// Guards that what is known to be wrong is not recorded: a furnace whose radiance is one is recorded with that
/// truth, and refused with one that is half a per cent off.
#[test]
fn a_reference_that_is_not_true_is_refused() {
    const FURNACE: &str = include_str!("../../fixtures/golden/furnace/scene.toml");
    let truth =
        |mean: f64| format!("truth = {{ closed_form = {{ mean = {mean}, source = \"a furnace\" }} }}");
    let golden = guard("furnace", FURNACE, 16, &truth(1.0)).expect("a sound scene");
    assert_eq!(golden.reference.truth.kind, "closed form");
    let wrong = guard("furnace", FURNACE, 16, &truth(1.005));
    assert!(matches!(&wrong, Err(RecordError::Untrue(said)) if said.contains("closed form 1.005")));
}

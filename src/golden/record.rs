//! Recording: many runs of a scene that is held to be right, and what else knows that it is.

use super::checks;
use super::reference::{Found, Reference, Stage, mean_image};
use super::run::{Baseline, LUMINANCE, Role, Run, Subject, luminance, pilot_planes, seed};
use super::suite::{Entry, Truth};
use super::verdict::{Check, Power};
use super::words::percent;
use crate::color::Rgb;
use crate::film::Image;
use crate::integrate::naive::{ReferenceError, ReferenceOptions, reference};
use crate::integrate::{Control, RunError};
use crate::scene;
use crate::stats::gate::{Family, Finding, Null, Outcome, Planes, Profile};
use crate::stats::{Moments, two_sided};

/// Pilots of a recording.
pub const PILOTS: u32 = 16;
/// A reference is refused where what it is compared with is less probable than this.
const TRUTH_SIGNIFICANCE: f64 = 1e-5;
/// What the reference integrator's single precision image may round away.
const ROUNDING: f64 = 2e-6;

/// How far a recording or a verification is.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Some runs of a kind are done.
    Runs {
        /// `pilots`, `runs` or `reference integrator, % of`.
        what: &'static str,
        /// How many.
        done: u32,
        /// Of how many.
        of: u32,
    },
    /// What the pilots let expect.
    Forecast(Forecast),
}

/// What a golden will cost and see.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// Wall-clock seconds of one run here.
    pub seconds_per_run: f64,
    /// Bytes of its files, roughly.
    pub bytes: u64,
    /// The most telling statistics for one run under test.
    pub power: Vec<Power>,
}

/// Whoever watches.
pub struct Watch<'a> {
    /// Asked whether to stop.
    pub control: &'a dyn Control,
    /// Told of each step.
    pub told: &'a (dyn Fn(&Step) + Sync),
}

/// Why a scene could not be recorded.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// It could not be rendered.
    #[error("{0}")]
    Run(#[from] RunError),
    /// The picture is black.
    #[error("the picture is black: there is nothing to guard")]
    Black,
    /// A gate without statistics does not hold.
    #[error("the gate {name} does not hold: {message}", name = .0.name, message = .0.message)]
    Check(Check),
    /// It is not what it should be.
    #[error("{0}")]
    Untrue(String),
    /// The reference integrator could not render it.
    #[error("the reference integrator: {0}")]
    Integrator(#[from] ReferenceError),
}

/// Renders pilots and `runs` null runs (at least [`FEWEST_RUNS`](crate::stats::gate::FEWEST_RUNS)), and
/// compares their mean with what the entry says is true.
///
/// # Errors
/// The scene cannot be rendered, is black, breaks a gate without statistics, or is not what it should be.
pub fn record(
    entry: &Entry,
    subject: &Subject,
    runs: u32,
    software: &str,
    watch: &Watch<'_>,
) -> Result<Reference, RecordError> {
    let begin = std::time::Instant::now();
    let pilots: Vec<Planes> =
        many(entry, subject, Role::Pilot, PILOTS, "pilots", watch)?.iter().map(pilot_planes).collect();
    let seconds_per_run = begin.elapsed().as_secs_f64() / f64::from(PILOTS);
    let profile = Profile::new(&pilots).ok_or(RecordError::Black)?;
    let baseline = Baseline::new(&profile).ok_or(RecordError::Black)?;
    let family = Family::design(&profile);
    if let Some(null) = Null::forecast(&family, &pilots) {
        let [w, h] = subject.settings.size.map(u64::from);
        let power = power(&family, &null, 1, super::SIGNIFICANCE);
        (watch.told)(&Step::Forecast(Forecast { seconds_per_run, bytes: w * h * 110 + 80_000, power }));
    }
    let runs = many(entry, subject, Role::Null, runs, "runs", watch)?;
    for check in
        [checks::samples(&runs, subject.settings.spp), checks::film(), checks::export(&runs[0].image)]
    {
        if !check.holds {
            return Err(RecordError::Check(check));
        }
    }
    let planes: Vec<Planes> = runs.iter().map(|r| baseline.planes(r)).collect();
    let null = Null::new(&family, &planes).ok_or(RecordError::Black)?;
    let image = mean_image(&runs).ok_or(RecordError::Black)?;
    let truth = truth(entry, subject, &family, &null, &runs, watch)?;
    let test = subject.run(seed(&entry.name, Role::Test(0), 0), watch.control)?;
    Ok(Reference {
        scene_sha256: scene::sha256(&subject.scene),
        settings: subject.settings.clone(),
        software: software.to_owned(),
        pilots: PILOTS,
        curve: curve(&baseline, &runs),
        profile,
        family,
        null,
        image: Image { attributes: Vec::new(), ..image },
        truth,
        test_sha256: checks::picture_sha256(&test.image),
    })
}

/// Renders runs of one role.
pub(super) fn many(
    entry: &Entry,
    subject: &Subject,
    role: Role,
    count: u32,
    what: &'static str,
    watch: &Watch<'_>,
) -> Result<Vec<Run>, RunError> {
    let run = |i: u32| {
        let run = subject.run(seed(&entry.name, role, i), watch.control)?;
        (watch.told)(&Step::Runs { what, done: i + 1, of: count });
        Ok(run)
    };
    (0..count).map(run).collect()
}

fn curve(baseline: &Baseline, runs: &[Run]) -> Vec<Stage> {
    let stages = runs.first().map_or(0, |r| r.stages.len());
    let stage = |s: usize| {
        let errors = runs.iter().map(|r| libm::log(baseline.error(&r.stages[s].1).max(1e-300)));
        let m: Moments = errors.collect();
        Stage { spp: runs[0].stages[s].0, ln_error: m.mean, deviation: m.variance().sqrt() }
    };
    (0..stages).map(stage).collect()
}

/// What the most telling statistics notice: matched filters, the whole picture, and noise.
pub(super) fn power(family: &Family, null: &Null, runs: usize, significance: f64) -> Vec<Power> {
    use crate::stats::gate::Kind;
    let shifts = null.power(family, runs, significance);
    let told = family.statistics.iter().zip(shifts).filter(|(s, _)| match s.kind {
        Kind::Matched => true,
        Kind::Image => s.of == LUMINANCE,
        Kind::Scalar => s.of == super::run::scalar::NOISE,
        _ => false,
    });
    told.map(|(s, shift)| {
        // Noise is a logarithm.
        let shift = if s.kind == Kind::Scalar { libm::expm1(shift) } else { shift };
        Power { statistic: s.to_string(), shift }
    })
    .collect()
}

/// Compares the mean of the runs with what the entry says is true.
fn truth(
    entry: &Entry,
    subject: &Subject,
    family: &Family,
    null: &Null,
    runs: &[Run],
    watch: &Watch<'_>,
) -> Result<Found, RecordError> {
    let found = match &entry.truth {
        Truth::Render => Found {
            kind: "render".to_owned(),
            statement: "nothing else knows it: the renderer's own mean".to_owned(),
            p: None,
            notices: None,
        },
        Truth::ClosedForm { mean, source } => closed_form(*mean, source, runs),
        Truth::Reference { spp } => {
            let mut image = slow(entry, subject, *spp, watch)?;
            image.layers = Vec::new();
            let outcome = test_picture(family, null, &image).ok_or(RecordError::Black)?;
            integrator(*spp, &outcome)
        }
    };
    match found.p {
        Some(p) if p < TRUTH_SIGNIFICANCE => Err(RecordError::Untrue(found.statement)),
        _ => Ok(found),
    }
}

fn closed_form(mean: f64, source: &str, runs: &[Run]) -> Found {
    let channel = |c: usize| {
        let whole =
            |r: &Run| r.image.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / r.image.rgb.len() as f64;
        let m: Moments = runs.iter().map(whole).collect();
        let error = (m.variance() / runs.len() as f64).sqrt() + ROUNDING * mean;
        ((m.mean - mean) / error, m.mean, error)
    };
    let worst = [0, 1, 2].map(channel).into_iter().max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let (z, found, error) = worst.unwrap_or_default();
    Found {
        kind: "closed form".to_owned(),
        statement: format!("closed form {mean} ({source}): found {found:.6} +- {error:.6}, z = {z:+.1}"),
        p: Some(two_sided(z)),
        notices: Some((4.42 + 2.33) * error / mean),
    }
}

fn slow(entry: &Entry, subject: &Subject, spp: u32, watch: &Watch<'_>) -> Result<Image, RecordError> {
    let settings = &subject.settings;
    let camera = subject.scene.cameras.iter().position(|c| c.name == settings.camera).unwrap_or(0);
    let options = ReferenceOptions {
        camera,
        size: settings.size,
        crop: None,
        spp,
        seed: seed(&entry.name, Role::Truth, 0),
        max_depth: settings.max_depth,
        threads: 0,
    };
    let progress = |share: f64| {
        let done = (100.0 * share) as u32;
        (watch.told)(&Step::Runs { what: "reference integrator, % of", done, of: 100 });
    };
    let image = reference(&subject.scene, &options, &|| watch.control.cancelled(), &progress)?;
    if watch.control.cancelled() {
        return Err(RunError::Cancelled.into());
    }
    Ok(image)
}

fn integrator(spp: u32, outcome: &Outcome) -> Found {
    use crate::stats::gate::Kind;
    let matched = |f: &&Finding| f.statistic.kind == Kind::Matched && f.statistic.of == LUMINANCE;
    let whole = outcome.findings.iter().find(matched);
    let said = |f: &Finding| format!("{} +- {:.2} %", percent(f.shift), 100.0 * f.error);
    let whole_said = whole.map_or_else(|| "nothing to compare".to_owned(), said);
    let worst = outcome.findings.first().map_or_else(String::new, |f| {
        let p = if outcome.p < 0.01 { format!("{:.0e}", outcome.p) } else { format!("{:.2}", outcome.p) };
        format!("; the least probable of {} statistics is {}, p {p}", outcome.findings.len(), f.statistic)
    });
    Found {
        kind: "reference integrator".to_owned(),
        statement: format!("the reference integrator with {spp} samples agrees: {whole_said}{worst}"),
        p: Some(outcome.p),
        notices: whole.map(|f| (4.42 + 2.33) * f.error),
    }
}

/// Judges a picture by the variances that it carries; the variance of luminance is bounded by that of channels
/// that rise and fall together.
pub(super) fn test_picture(family: &Family, null: &Null, image: &Image) -> Option<Outcome> {
    let variance = image.variance.as_ref()?;
    if !variance.iter().all(|v| v.is_finite()) {
        return None;
    }
    let deviation = |v: &Rgb| Rgb::from(v.to_array().map(|v| v.max(0.0).sqrt())).luminance();
    let channel = |c: usize| variance.iter().map(|v| v[c].max(0.0)).collect::<Vec<f32>>();
    let variances = Planes {
        width: image.width as usize,
        height: image.height as usize,
        planes: vec![
            (LUMINANCE.to_owned(), variance.iter().map(deviation).map(|d| d * d).collect()),
            ("red".to_owned(), channel(0)),
            ("green".to_owned(), channel(1)),
            ("blue".to_owned(), channel(2)),
        ],
        scalars: Vec::new(),
    };
    let colour = |c: usize| image.rgb.iter().map(|p| p[c]).collect();
    let picture = Planes {
        planes: vec![
            (LUMINANCE.to_owned(), luminance(image)),
            ("red".to_owned(), colour(0)),
            ("green".to_owned(), colour(1)),
            ("blue".to_owned(), colour(2)),
        ],
        ..variances.clone()
    };
    null.test_picture(family, &picture, &variances)
}

//! Verifying: is a render still what was recorded?

use std::time::Instant;

use super::checks;
use super::record::{Watch, many, power, test_picture};
use super::reference::{Reference, mean_image};
use super::run::{Baseline, Role, Run, Subject, luminance};
use super::suite::Entry;
use super::verdict::{Check, CurvePoint, Reason, Verdict, Verification};
use super::words;
use crate::film::Image;
use crate::integrate::RunError;
use crate::stats::gate::{Outcome, Planes};

/// How to verify.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerifyOptions {
    /// Runs under test; their mean is judged.
    pub runs: u32,
    /// Tells fresh seeds apart; zero for the fixed ones.
    pub fresh: u64,
    /// Probability of refusing this scene although nothing is wrong.
    pub significance: f64,
    /// Whether a scene that has changed is refused for that alone.
    pub check_scene: bool,
}

/// Renders a scene, and judges it.
///
/// # Errors
/// The scene cannot be rendered, or somebody asked to stop.
pub fn verify(
    entry: &Entry,
    subject: &Subject,
    reference: &Reference,
    options: &VerifyOptions,
    watch: &Watch<'_>,
) -> Result<Verification, RunError> {
    let begin = Instant::now();
    let mut checks = vec![checks::settings(subject, reference)];
    if options.check_scene {
        checks.insert(0, checks::scene(subject, reference));
    }
    let comparable =
        subject.settings.size == reference.settings.size && subject.settings.spp == reference.settings.spp;
    let mut judged = Judged::default();
    let mut seeds = Vec::new();
    if comparable {
        let role = Role::Test(options.fresh);
        let runs = many(entry, subject, role, options.runs.max(1), "runs", watch)?;
        seeds = runs.iter().map(|r| r.seed).collect();
        checks.push(checks::samples(&runs, subject.settings.spp));
        checks.push(checks::threads(subject, seeds[0])?);
        checks.push(checks::film());
        checks.push(checks::export(&runs[0].image));
        if options.fresh == 0 {
            checks.push(checks::bytes(&checks::picture_sha256(&runs[0].image), &reference.test_sha256));
        }
        judged = judge(entry, reference, &runs);
    }
    let mut done = conclude(entry, reference, options.significance, checks, judged);
    done.seeds = seeds;
    done.power = power(&reference.family, &reference.null, options.runs as usize, options.significance);
    done.seconds = begin.elapsed().as_secs_f64();
    Ok(done)
}

/// Judges a picture that somebody else rendered, by the variance and the count that it carries; its noise is not
/// judged, since its sampler is another.
#[must_use]
pub fn verify_picture(
    entry: &Entry,
    reference: &Reference,
    picture: &Image,
    significance: f64,
) -> Verification {
    let mut checks = Vec::new();
    let size = (picture.width, picture.height);
    let expected = (reference.image.width, reference.image.height);
    let check = |holds, message| Check { name: "picture", holds, message };
    let mut judged = Judged::default();
    if size != expected {
        let message = format!("found {}x{} pixels, expected {}x{}", size.0, size.1, expected.0, expected.1);
        checks.push(check(false, message));
    } else if picture.rgb.iter().any(|c| !c.is_finite()) {
        checks.push(check(false, "found values that are not finite".to_owned()));
    } else {
        match test_picture(&reference.family, &reference.null, picture) {
            None => {
                let message = "found no variance of each pixel's mean (channels variance.R, variance.G, variance.B), expected one that is finite";
                checks.push(check(false, message.to_owned()));
            }
            Some(outcome) => {
                checks.push(check(
                    true,
                    "size and variance are there; noise and layers are not judged".to_owned(),
                ));
                judged.outcome = Some(outcome);
                let variances = picture.variance.iter().flatten().map(|v| f64::from(v.luminance()));
                judged.z = z_map(reference, picture, variances.collect());
            }
        }
        judged.image = Some(picture.clone());
    }
    conclude(entry, reference, significance, checks, judged)
}

/// What there is to say about runs under test.
#[derive(Default)]
struct Judged {
    outcome: Option<Outcome>,
    image: Option<Image>,
    z: Vec<f32>,
    curve: Vec<CurvePoint>,
}

fn judge(entry: &Entry, reference: &Reference, runs: &[Run]) -> Judged {
    let Some(baseline) = Baseline::new(&reference.profile) else { return Judged::default() };
    let planes: Vec<Planes> = runs.iter().map(|r| baseline.planes(r)).collect();
    let outcome = reference.null.test(&reference.family, &planes, entry.accepted());
    let image = mean_image(runs);
    let curve = reference.curve.iter().enumerate().filter_map(|(s, stage)| {
        let errors = runs.iter().filter_map(|r| r.stages.get(s)).map(|(_, plane)| baseline.error(plane));
        let count = errors.clone().count();
        (count > 0).then(|| CurvePoint {
            spp: stage.spp,
            error: errors.sum::<f64>() / count as f64,
            expected: libm::exp(stage.ln_error),
            spread: libm::exp(stage.deviation),
        })
    });
    let curve = curve.collect();
    // A run's pixel varies as the null runs' do.
    let n = reference.runs() as f64 / runs.len().max(1) as f64;
    let own = reference.image.variance.iter().flatten().map(|v| f64::from(v.luminance()) * n).collect();
    let z = image.as_ref().map_or_else(Vec::new, |image| z_map(reference, image, own));
    Judged { outcome, image, z, curve }
}

/// Difference of luminance over its standard error.
fn z_map(reference: &Reference, image: &Image, own: Vec<f64>) -> Vec<f32> {
    let theirs = reference.image.variance.iter().flatten().map(|v| f64::from(v.luminance()));
    let pixel = |(((a, b), own), theirs): (((f32, f32), f64), f64)| {
        let (d, error) = (f64::from(a) - f64::from(b), (own + theirs).sqrt() + 1e-6 * f64::from(b));
        if error > 0.0 { (d / error) as f32 } else { 0.0 }
    };
    luminance(image).into_iter().zip(luminance(&reference.image)).zip(own).zip(theirs).map(pixel).collect()
}

fn conclude(
    entry: &Entry,
    reference: &Reference,
    significance: f64,
    checks: Vec<Check>,
    judged: Judged,
) -> Verification {
    let broken = checks.iter().filter(|c| !c.holds);
    let mut reasons: Vec<Reason> = broken
        .map(|c| Reason { gate: c.name.to_owned(), message: c.message.clone(), better: false })
        .collect();
    if let Some(outcome) = judged.outcome.as_ref().filter(|o| o.p < significance) {
        reasons.extend(words::reasons(outcome.significant(significance)));
    }
    let verdict = if reasons.is_empty() {
        Verdict::Passed
    } else if reasons.iter().all(|r| r.better) {
        Verdict::Improved
    } else {
        Verdict::Refused
    };
    Verification {
        name: entry.name.clone(),
        guards: entry.guards.clone(),
        truth: reference.truth.statement.clone(),
        spp: reference.settings.spp,
        seeds: Vec::new(),
        verdict,
        reasons,
        checks,
        outcome: judged.outcome,
        significance,
        reference: reference.image.clone(),
        image: judged.image,
        z: judged.z,
        curve: judged.curve,
        power: Vec::new(),
        replay: String::new(),
        bless: String::new(),
        seconds: 0.0,
    }
}

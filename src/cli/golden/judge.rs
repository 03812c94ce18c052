//! Verifying the scenes of suites: what `verify`, `report` and `bless` share.

use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use super::args::JudgeArgs;
use super::files::{self, Guarded};
use super::progress::Bar;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::golden::{self, SIGNIFICANCE, Verification, VerifyOptions, Watch};
use crate::output;
use crate::stats;

/// Verified scenes.
pub(super) struct Judged {
    pub(super) verifications: Vec<Verification>,
    /// Probability that the whole is refused although nothing is wrong.
    pub(super) significance: f64,
}

/// Verifies what was asked for; tells of each scene as soon as it is done.
pub(super) fn judge(
    args: &JudgeArgs,
    console: &Console,
    tell: &dyn Fn(&Verification) -> Result<(), Failure>,
) -> Result<Judged, Failure> {
    let all = files::guarded(&args.suite)?;
    let images = images(args, &all)?;
    let fresh = match args.fresh {
        None => 0,
        Some(Some(seed)) => seed.max(1),
        Some(None) => {
            let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |d| d.as_nanos() as u64);
            console.message(&format!("note: seeds of --fresh={now}"));
            now
        }
    };
    // Each scene has its share, so that the whole keeps its promise.
    let share = stats::sidak_each(SIGNIFICANCE, all.len());
    let options = VerifyOptions { runs: args.runs, fresh, significance: share, check_scene: !args.edited };
    let bar = Bar::new(all.len() as u32 * args.runs, console);
    let mut verifications = Vec::new();
    for guarded in &all {
        bar.scene(&guarded.entry.name);
        let image = images.iter().find(|(name, _)| *name == guarded.entry.name).map(|(_, path)| path);
        let done = one(guarded, image, &options, &bar)?;
        bar.suspend(|| tell(&done))?;
        verifications.push(done);
    }
    bar.clear();
    Ok(Judged { verifications, significance: SIGNIFICANCE })
}

/// Verifies a scene, or a picture of it.
pub(super) fn one(
    guarded: &Guarded,
    image: Option<&PathBuf>,
    options: &VerifyOptions,
    bar: &Bar,
) -> Result<Verification, Failure> {
    let name = &guarded.entry.name;
    let reference = guarded.reference()?;
    let mut done = if let Some(path) = image {
        let picture = output::read(path).map_err(|e| Failure::load(e.to_string()))?;
        golden::verify_picture(&guarded.entry, &reference, &picture, options.significance)
    } else {
        let subject = guarded.subject()?;
        let watch = Watch { control: bar, told: &|step| bar.told(step) };
        let mut done = golden::verify(&guarded.entry, &subject, &reference, options, &watch)
            .map_err(|e| bar.failure(name, &e))?;
        done.replay = guarded.replay(&subject, done.seeds.first().copied().unwrap_or(0));
        done
    };
    done.bless = guarded.bless();
    Ok(done)
}

/// Pictures by scene.
fn images(args: &JudgeArgs, all: &[Guarded]) -> Result<Vec<(String, PathBuf)>, Failure> {
    let parse = |text: &String| {
        let (name, path) = text
            .split_once('=')
            .ok_or_else(|| Failure::usage(format!("--image: found {text:?}, expected NAME=FILE")))?;
        if all.iter().all(|g| g.entry.name != name) {
            let names = all.iter().map(|g| g.entry.name.as_str()).collect::<Vec<_>>().join(", ");
            return Err(Failure::usage(format!("--image: found {name:?}, expected one of: {names}")));
        }
        Ok((name.to_owned(), PathBuf::from(path)))
    };
    args.images.iter().map(parse).collect()
}

//! What is said of a picture before it is there, and by it of itself, beside what came.
//!
//! In: the full method, ready to render, and what was measured of it. Out: a quote as `epsilux quote` gives it, for the
//! error that all runs had in the end, from a pilot with far fewer samples; and how many runs held the true error in
//! the interval that they state.

use super::report::{Measured, Prediction, Runs};
use super::run::{Run, Work};
use crate::integrate::RunError;
use crate::prepare::Prepared;
use crate::stats::Interval;

/// A pilot takes so many times fewer samples than the runs, or as few as it can do with.
const AHEAD: f64 = 8.0;
/// What is foretold takes at least so many times the samples of the pilot, of which there are so many at least.
const LEAST_AHEAD: u32 = 2;
const FEWEST: u32 = 16;
/// Pixels of a pilot, about.
const PIXELS: f64 = 4096.0;

/// What a quote says of the samples to the error of the longest runs; `None` where these are too short for a pilot
/// that would not have seen most of them.
pub(super) fn prediction(
    full: &Prepared,
    measured: &Measured,
    work: &Work<'_>,
) -> Result<Option<Prediction>, RunError> {
    let Some(last) = measured.points.last().filter(|p| p.spp >= LEAST_AHEAD * FEWEST) else {
        return Ok(None);
    };
    let [width, height] = full.size.map(f64::from);
    let rays = f64::from(last.spp) / AHEAD * measured.rays_per_sample * (width * height).min(PIXELS);
    let pilot = work.pilot(full, rays as u64)?;
    let error = last.error.value;
    let quote = pilot.quote(error);
    // Where the error was not clear a pilot goes on, and may have gone too far to be a pilot.
    if pilot.passes * LEAST_AHEAD > last.spp {
        return Ok(None);
    }
    let samples = quote.map(|q| {
        let [low, high] = q.samples_interval.map(f64::from);
        Interval { value: f64::from(q.samples), low, high }
    });
    Ok(Some(Prediction { after: pilot.passes, every: pilot.one_in(), error, samples, came: last.spp }))
}

/// How many statements of the last pictures hold their true error, and of how many.
pub(super) fn stated(runs: &[Run], summed: &Runs) -> [u32; 2] {
    let Some(last) = summed.parts.last() else { return [0, 0] };
    let pairs = runs.iter().zip(&last.squares);
    let holds = |(run, square): (&Run, &f64)| {
        let stated = (*run.stated.last()?)?;
        let truth = square.max(0.0).sqrt();
        Some((stated.interval[0]..=stated.interval[1]).contains(&truth))
    };
    let all: Vec<bool> = pairs.filter_map(holds).collect();
    [all.iter().filter(|h| **h).count() as u32, all.len() as u32]
}

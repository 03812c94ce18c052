//! The first samples of a render, at some of its pixels.

use std::ops::Range;
use std::sync::Mutex;
use std::time::Duration;

use super::curve::{Curve, Forecast};
use crate::film::{ErrorEstimate, Film};
use crate::integrate::{
    Busy, Control, Counters, RenderError, RenderOptions, is_looked_at, layout, render_onto,
};
use crate::prepare::Prepared;

/// Pixels of a pilot, at least, where the picture has as many: enough for an interval, and few enough for many samples
/// of each.
const PIXELS: u64 = 4096;
/// Rays that a pilot may take: a second or two on a few cores.
const RAYS: u64 = 6_000_000;
/// Passes of a pilot: at least what a curve needs, at most what any error above a thousandth does.
const PASSES: Range<u32> = 16..4096;
/// Passes that say how many rays one takes.
const FIRST: u32 = 4;

/// What a pilot found.
#[derive(Clone, Debug)]
pub struct Pilot {
    /// How the error fell.
    pub curve: Curve,
    /// The error after all passes, of the pixels that were rendered; `None` where it cannot be estimated.
    pub error: Option<ErrorEstimate>,
    /// One pixel of so many was rendered.
    pub every: u32,
    /// Samples of each of these.
    pub passes: u32,
    /// Wall-clock time.
    pub elapsed: Duration,
    /// Seconds that a pass of the whole picture takes on the same threads.
    pub pass_seconds: f64,
    /// Threads that worked.
    pub threads: usize,
    /// The sums of the pixels that were rendered.
    pub film: Film,
    /// Rays, photons' included, and paths that were cut.
    pub counters: Counters,
}

impl Pilot {
    /// Samples for an error, where the pilot's own can be trusted.
    #[must_use]
    pub fn forecast(&self, error: f64) -> Option<Forecast> {
        self.error.filter(|e| e.trusted)?;
        self.curve.forecast(error)
    }

    /// Seconds of so many samples per pixel.
    #[must_use]
    pub fn seconds(&self, samples: u32) -> f64 {
        f64::from(samples) * self.pass_seconds
    }
}

/// Takes notes at each look, and passes on the wish to stop.
struct Notes<'a> {
    curve: Mutex<Curve>,
    control: &'a dyn Control,
}

impl Control for Notes<'_> {
    fn committed(&self, film: &Film, passes: Range<u32>, _: Counters) {
        if is_looked_at(passes.end)
            && let Some(squares) = film.error_squares()
        {
            self.curve.lock().unwrap_or_else(std::sync::PoisonError::into_inner).add(passes.end, &squares);
        }
    }

    fn cancelled(&self) -> bool {
        self.control.cancelled()
    }
}

/// Renders some pixels of a picture for as many passes as fixed work allows; `options` say which threads and part of
/// it, and what to record.
///
/// # Errors
/// As [`render_onto`].
pub fn pilot(
    scene: &Prepared,
    options: &RenderOptions,
    control: &dyn Control,
) -> Result<Pilot, RenderError> {
    let layout = layout(scene, options);
    let pixels = u64::from(layout.crop[2]) * u64::from(layout.crop[3]);
    let every = (pixels / PIXELS).clamp(1, u64::from(u32::MAX)) as u32;
    let notes = Notes { curve: Mutex::new(Curve::new(every)), control };
    let options = RenderOptions { passes: 0..FIRST, every, time: None, error: None, ..options.clone() };
    let first = render_onto(scene, Film::new(layout), &options, &notes)?;
    let affordable = RAYS * u64::from(FIRST) / first.counters.rays.max(1);
    let passes = (affordable.min(u64::from(PASSES.end)) as u32).max(PASSES.start) / FIRST * FIRST;
    let options = RenderOptions { passes: FIRST..passes, ..options };
    let rest = render_onto(scene, first.film, &options, &notes)?;
    let elapsed = first.elapsed + rest.elapsed;
    let counters = Counters {
        rays: first.counters.rays + rest.counters.rays,
        capped: first.counters.capped + rest.counters.capped,
    };
    let passes = rest.passes.end;
    Ok(Pilot {
        curve: notes.curve.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner),
        error: rest.film.error(),
        every,
        passes,
        elapsed,
        pass_seconds: whole(&[first.busy, rest.busy], every) * elapsed.as_secs_f64() / f64::from(passes.max(1)),
        threads: rest.threads,
        film: rest.film,
        counters,
    })
}

/// How many times as long a pass of all pixels takes as one of a part: photons are the same.
fn whole(busy: &[Busy], every: u32) -> f64 {
    let sum = |of: fn(&Busy) -> Duration| busy.iter().map(|b| of(b).as_secs_f64()).sum::<f64>();
    let (photons, paths) = (sum(|b| b.photons), sum(|b| b.tiles) + sum(|b| b.film));
    (photons + paths * f64::from(every)) / (photons + paths).max(1e-9)
}

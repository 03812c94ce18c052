//! What a render foresees of itself while it runs, kept for when it is done.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::units::{show_range, show_time};
use crate::film::Squares;
use crate::integrate::Progress;
use crate::quote::{Curve, Quote};
use serde::Serialize;

/// When a render says what it will take: the pilot of `epsilux quote` is as long.
const AFTER: Duration = Duration::from_secs(1);
/// Between two looks ahead for the bar.
const AGAIN: Duration = Duration::from_secs(1);
/// Fewer samples say too little.
const FEWEST: u32 = 32;

/// Foresees when a render reaches its error.
pub(super) struct Forecaster {
    target: f64,
    begin: Instant,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    curve: Curve,
    /// Whether the last look was trusted.
    trusted: bool,
    quoted: Option<Quoted>,
    /// What was foreseen last: the quote, when, and after how many passes of this run.
    last: Option<(Quote, Instant)>,
}

/// What was foreseen, and when.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Quoted {
    /// Seconds that the render had taken.
    after: f64,
    samples: u32,
    samples_interval: [u32; 2],
    seconds: f64,
    seconds_interval: [f64; 2],
}

impl Forecaster {
    /// For a render that asks for this error and begins now.
    pub(super) fn new(target: f64) -> Self {
        let state = State { curve: Curve::new(1.0), ..State::default() };
        Self { target, begin: Instant::now(), state: Mutex::new(state) }
    }

    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Takes note of what the pixels add to the error after some passes.
    pub(super) fn looked(&self, passes: u32, squares: &Squares) {
        let mut state = self.state();
        state.trusted = squares.estimate().trusted;
        state.curve.add(passes, squares);
    }

    /// Seconds left, from and to, where that can be said; `before` are the passes that the film held at the start.
    pub(super) fn left(&self, progress: &Progress, before: u32) -> Option<[f64; 2]> {
        let elapsed = self.begin.elapsed();
        let mut state = self.state();
        let due = state.last.is_none_or(|(_, when)| when.elapsed() >= AGAIN);
        if elapsed >= AFTER && due && state.trusted && state.curve.passes() >= FEWEST && progress.passes > 0 {
            let pass = elapsed.as_secs_f64() / f64::from(progress.passes);
            if let Some(mut found) = state.curve.forecast(self.target) {
                // Of this run; what was there before took no time.
                let own = |n: u32| n.saturating_sub(before).max(progress.passes);
                let [low, high] = found.interval;
                (found.samples, found.interval) = (own(found.samples), [own(low), own(high)]);
                let quote = Quote::new(found, pass);
                state.last = Some((quote, Instant::now()));
                if state.quoted.is_none() {
                    state.quoted = Some(Quoted {
                        after: elapsed.as_secs_f64(),
                        samples: quote.samples,
                        samples_interval: quote.samples_interval,
                        seconds: quote.seconds,
                        seconds_interval: quote.seconds_interval,
                    });
                }
            }
        }
        let (quote, _) = state.last?;
        Some(quote.seconds_interval.map(|s| (s - elapsed.as_secs_f64()).max(0.0)))
    }

    /// What was foreseen first.
    pub(super) fn quoted(&self) -> Option<Quoted> {
        self.state().quoted
    }
}

impl Quoted {
    /// Beside what came, in seconds.
    pub(super) fn beside(&self, came: f64) -> String {
        format!(
            "quoted {} ({}) after {}, came {}",
            show_time(self.seconds),
            show_range(self.seconds_interval),
            show_time(self.after),
            show_time(came)
        )
    }
}

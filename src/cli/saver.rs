//! Saving a render while it runs.

use std::ops::Range;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::console::Console;
use super::failure::Failure;
use super::parts::{Checkpoint, Found};
use super::progress::Watch;
use super::units::show_passes;
use crate::film::{Film, Squares};
use crate::integrate::{Control, Counters, Outcome, Progress};
use crate::part::{Identity, Part};

/// Keeps the state of a render in a file.
pub(super) struct Saver<'a> {
    checkpoint: Checkpoint,
    identity: Identity,
    screen: (String, f32),
    /// The first pass of the picture, and rays and cut paths of what the file held at the start.
    first: u32,
    before: Counters,
    last: Mutex<Instant>,
    interval: Duration,
    console: &'a Console,
}

impl<'a> Saver<'a> {
    /// The file, and what was `found` in it of the render; `passes` are those that are asked for, and `interval` is the
    /// time between two checkpoints.
    pub(super) fn open(
        checkpoint: Checkpoint,
        found: Option<Found>,
        identity: &Identity,
        screen: (String, f32),
        passes: &Range<u32>,
        interval: Duration,
        console: &'a Console,
    ) -> Result<(Self, Option<Part>), Failure> {
        let usage = |message: String| {
            Failure::usage(format!("--checkpoint {}: {message}", checkpoint.path().display()))
                .help("remove the file to begin anew, or name another one")
        };
        let mut before = Counters::default();
        let part = match found {
            None => None,
            Some(Found { part, warning }) => {
                if let Some(warning) = warning {
                    console.message(&format!("note: {warning}"));
                }
                part.identity.check(identity).map_err(|e| usage(e.to_string()))?;
                let fits = matches!(&part.passes[..], [r] if r.start == passes.start && r.end <= passes.end);
                if !fits {
                    let (held, asked) =
                        (show_passes(&part.passes), show_passes(std::slice::from_ref(passes)));
                    return Err(usage(format!("it holds passes {held}, and {asked} were asked for")));
                }
                before = Counters { rays: part.rays, capped: part.capped, ..Counters::default() };
                Some(part)
            }
        };
        let (identity, last) = (identity.clone(), Mutex::new(Instant::now()));
        let first = passes.start;
        Ok((Self { checkpoint, identity, screen, first, before, last, interval, console }, part))
    }

    fn save(&self, film: &Film, end: u32, counters: Counters) -> Result<(), Failure> {
        self.checkpoint.write(&Part {
            identity: self.identity.clone(),
            screen: self.screen.clone(),
            passes: std::iter::once(self.first..end).collect(),
            film: film.clone(),
            rays: self.before.rays + counters.rays,
            capped: self.before.capped + counters.capped,
        })
    }

    /// Saves what a render ended with; nothing where not one pass is whole.
    pub(super) fn finish(&self, outcome: &Outcome) -> Result<(), Failure> {
        if outcome.partial {
            return Ok(());
        }
        self.save(&outcome.film, outcome.passes.end, outcome.counters)
    }
}

/// Whoever watches a render, and what saves it.
pub(super) struct Saved<'a> {
    pub(super) watch: &'a Watch<'a>,
    pub(super) saver: Option<&'a Saver<'a>>,
}

impl Control for Saved<'_> {
    fn progress(&self, progress: &Progress) {
        self.watch.progress(progress);
    }

    fn looked(&self, passes: u32, squares: &Squares) {
        self.watch.looked(passes, squares);
    }

    fn committed(&self, film: &Film, passes: Range<u32>, counters: Counters) {
        let Some(saver) = self.saver else { return };
        let mut last = saver.last.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if last.elapsed() < saver.interval {
            return;
        }
        // The render goes on: at the end it is tried again, and then it counts.
        if let Err(failure) = saver.save(film, passes.end, counters) {
            saver.console.message(&format!("note: {}", failure.render(false).trim_end()));
        }
        *last = Instant::now();
    }

    fn cancelled(&self) -> bool {
        self.watch.cancelled()
    }
}

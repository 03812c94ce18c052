//! How far a recording or a verification is, on standard error.

use std::sync::Mutex;
use std::time::Instant;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::signal::Stop;
use crate::cli::units::show_time;
use crate::golden::Step;
use crate::integrate::{Control, RunError};

/// A bar over all runs of all scenes.
pub(super) struct Bar {
    bar: Option<ProgressBar>,
    stop: Stop,
    begin: Instant,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    scene: String,
    /// Runs of scenes that are finished, and of this one.
    before: u32,
    here: u32,
}

impl Bar {
    /// For `runs` runs in all.
    pub(super) fn new(runs: u32, console: &Console) -> Self {
        let bar = console.colours().then(|| {
            let bar = ProgressBar::with_draw_target(Some(u64::from(runs)), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{bar:32.cyan} {percent:>3} %  {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        Self { bar, stop: Stop::listen(), begin: Instant::now(), state: Mutex::default() }
    }

    /// Begins a scene.
    pub(super) fn scene(&self, name: &str) {
        let mut state = self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let before = state.before + state.here;
        *state = State { scene: name.to_owned(), before, here: 0 };
    }

    /// Shows a step; runs count, whatever they are for.
    pub(super) fn told(&self, step: &Step) {
        let Step::Runs { what, done, of } = step else { return };
        let mut state = self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if *what == "pilots" || *what == "runs" {
            state.here += 1;
        }
        let Some(bar) = &self.bar else { return };
        let count = u64::from(state.before + state.here);
        bar.set_position(count);
        let share = count as f64 / bar.length().unwrap_or(1).max(1) as f64;
        let seconds = self.begin.elapsed().as_secs_f64();
        let left = if share > 0.0 { show_time(seconds * (1.0 - share) / share) } else { "?".into() };
        bar.set_message(format!("{left} left, {}: {what} {done}/{of}", state.scene));
    }

    /// Prints a line without disturbing the bar.
    pub(super) fn suspend(&self, print: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    /// Takes the bar away.
    pub(super) fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    /// What a run that did not end well means.
    pub(super) fn failure(&self, scene: &str, error: &RunError) -> Failure {
        match (error, self.stop.code()) {
            (RunError::Cancelled, Some(code)) => {
                Failure::stopped(code, format!("{scene}: stopped; nothing of it was written"))
            }
            _ => Failure::load(format!("{scene}: {error}")),
        }
    }
}

impl Control for Bar {
    fn cancelled(&self) -> bool {
        self.stop.requested()
    }
}

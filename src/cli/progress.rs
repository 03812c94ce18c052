//! How far a render is, on standard error.

use std::sync::atomic::{AtomicU32, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use super::args::ProgressArg;
use super::console::Console;
use super::forecast::Forecaster;
use super::machine::ErrorJson;
use super::signal::Stop;
use super::units::{show_range, show_time};
use crate::film::Squares;
use crate::integrate::{Control, Progress};

/// Shows progress in the way that was asked for.
pub(super) enum Display<'a> {
    Bar(ProgressBar),
    Json(&'a Console),
    Nothing,
}

/// One line of `--progress json`.
#[derive(Serialize)]
struct Line {
    schema: &'static str,
    percent: f64,
    passes: u32,
    samples: u64,
    seconds: f64,
    seconds_left: Option<f64>,
    /// With 95 %, where an error was asked for and its estimate is trusted.
    seconds_left_interval: Option<[f64; 2]>,
    rays: u64,
    mrays_per_second: f64,
    /// The last estimate of the error, where one was asked for, and the passes that it is of.
    error: Option<ErrorJson>,
    error_passes: Option<u32>,
    error_target: Option<f64>,
}

/// One line of `--progress json` of what is more than one render.
#[derive(Serialize)]
struct ShareLine<'a> {
    schema: &'static str,
    percent: f64,
    doing: &'a str,
    seconds: f64,
    seconds_left: Option<f64>,
}

/// Steps of the bar.
const STEPS: u64 = 10_000;

impl<'a> Display<'a> {
    pub(super) fn new(kind: ProgressArg, quiet: bool, console: &'a Console) -> Self {
        match kind {
            ProgressArg::Json => Self::Json(console),
            ProgressArg::Auto if console.colours() && !quiet => {
                let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
                let style = ProgressStyle::with_template("{bar:32.cyan} {percent:>3} %  {msg}");
                bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
                Self::Bar(bar)
            }
            ProgressArg::Auto | ProgressArg::None => Self::Nothing,
        }
    }

    /// `range` are the seconds left, from and to, where they are foreseen.
    fn show(&self, p: &Progress, range: Option<[f64; 2]>) {
        let share = p.share();
        let seconds = p.elapsed.as_secs_f64();
        // Before the error is looked at for the first time nobody knows what it takes.
        let known = p.time.is_some() || p.error_target.is_none() || p.error.is_some();
        let left = (share > 0.0 && known).then(|| seconds * (1.0 - share) / share);
        let mrays_per_second = p.rays as f64 / seconds.max(1e-9) / 1e6;
        match self {
            Self::Nothing => {}
            Self::Bar(bar) => {
                let left = match (range.filter(|_| p.time.is_none()), left) {
                    (Some(range), _) => format!("{} left, ", show_range(range)),
                    (None, Some(left)) => format!("{} left, ", show_time(left)),
                    (None, None) => String::new(),
                };
                bar.set_message(format!("{left}{mrays_per_second:.2} Mrays/s, {} samples", p.passes));
                bar.set_position((share * STEPS as f64) as u64);
            }
            Self::Json(console) => {
                let line = Line {
                    schema: "epsilux.progress/1",
                    percent: 100.0 * share,
                    passes: p.passes,
                    samples: p.samples,
                    seconds,
                    seconds_left: left,
                    seconds_left_interval: range,
                    rays: p.rays,
                    mrays_per_second,
                    error: p.error.map(|(e, _)| ErrorJson::new(&e, &[])),
                    error_passes: p.error.map(|(_, passes)| passes),
                    error_target: p.error_target,
                };
                if let Ok(line) = serde_json::to_string(&line) {
                    console.message(&line);
                }
            }
        }
    }

    /// Shows how much of something other than one render is done.
    pub(super) fn show_share(&self, share: f64, seconds: f64, doing: &str) {
        // The first moments say nothing of the time.
        let left = (share > 0.005).then(|| seconds * (1.0 - share) / share);
        match self {
            Self::Nothing => {}
            Self::Bar(bar) => {
                let left = left.map_or(String::new(), |left| format!("{} left, ", show_time(left)));
                bar.set_message(format!("{left}{doing}"));
                bar.set_position((share * STEPS as f64) as u64);
            }
            Self::Json(console) => {
                let line = ShareLine {
                    schema: "epsilux.progress-of/1",
                    percent: 100.0 * share,
                    doing,
                    seconds,
                    seconds_left: left,
                };
                if let Ok(line) = serde_json::to_string(&line) {
                    console.message(&line);
                }
            }
        }
    }

    /// Takes the bar away.
    pub(super) fn clear(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// Shows progress, and passes on the wish to stop.
pub(super) struct Watch<'a> {
    pub(super) display: Display<'a>,
    pub(super) stop: Stop,
    /// What the render foresees, where it asks for an error.
    pub(super) forecaster: Option<Forecaster>,
    /// Passes that the film held before.
    pub(super) before: AtomicU32,
}

impl Control for Watch<'_> {
    fn progress(&self, progress: &Progress) {
        let before = self.before.load(Ordering::Relaxed);
        let range = self.forecaster.as_ref().and_then(|f| f.left(progress, before));
        self.display.show(progress, range);
    }

    fn looked(&self, passes: u32, squares: &Squares) {
        if let Some(forecaster) = &self.forecaster {
            forecaster.looked(passes, squares);
        }
    }

    fn cancelled(&self) -> bool {
        self.stop.requested()
    }
}

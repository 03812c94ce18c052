//! How far a render is, on standard error.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use super::args::ProgressArg;
use super::console::Console;
use super::doubt::DoubtJson;
use super::units::show_time;
use crate::integrate::{Control, Progress};

use super::signal::Stop;

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
    mrays_per_second: f64,
    /// Why the last estimate of the error cannot be trusted.
    #[serde(skip_serializing_if = "Option::is_none")]
    doubt: Option<DoubtJson>,
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

    fn show(&self, p: &Progress) {
        let share = p.share();
        let seconds = p.elapsed.as_secs_f64();
        let left = (share > 0.0).then(|| seconds * (1.0 - share) / share);
        let mrays_per_second = p.rays as f64 / seconds.max(1e-9) / 1e6;
        match self {
            Self::Nothing => {}
            Self::Bar(bar) => {
                let left = left.map_or(String::new(), |left| format!("{} left, ", show_time(left)));
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
                    mrays_per_second,
                    doubt: p.error.and_then(|(e, _)| e.doubt).map(|d| DoubtJson::new(&d, &[])),
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
}

impl Control for Watch<'_> {
    fn progress(&self, progress: &Progress) {
        self.display.show(progress);
    }

    fn cancelled(&self) -> bool {
        self.stop.requested()
    }
}

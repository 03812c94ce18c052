//! NAME.report.json: what a run took, beside the image that it made.
//!
//! The image files are a function of scene, settings and samples; whatever else there is to say about a
//! run (time, machine, command line) is said here.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::doubt::DoubtJson;
use super::forecast::Quoted;
use super::notes::NoteJson;
use super::shortcuts::PricedJson;
use crate::film::ErrorEstimate;
use crate::report::PlanFacts;

/// What a run took.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    pub(super) schema: &'static str,
    pub(super) software: String,
    pub(super) command: String,
    pub(super) scene: &'a str,
    pub(super) scene_sha256: &'a str,
    pub(super) outputs: Vec<String>,
    pub(super) method: &'static str,
    pub(super) camera: &'a str,
    pub(super) size: [u32; 2],
    pub(super) seed: u64,
    /// Passes in the picture, half open: samples per pixel.
    pub(super) passes: [u32; 2],
    pub(super) partial: bool,
    pub(super) error: Option<ErrorJson>,
    /// What was foreseen of the render while it ran, where an error was asked for.
    pub(super) quoted: Option<Quoted>,
    pub(super) stopped_by_signal: bool,
    pub(super) seconds: Seconds,
    pub(super) threads: usize,
    pub(super) rays: Option<u64>,
    pub(super) rays_per_second: Option<f64>,
    pub(super) samples_refused: u64,
    pub(super) refused: Vec<RefusedJson>,
    pub(super) paths_cut: u64,
    /// What was left out or approximated on purpose, and what each costs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) shortcuts: Vec<PricedJson>,
    pub(super) plan: PlanFacts<'a>,
    pub(super) plan_sha256: String,
    pub(super) notes: Vec<NoteJson<'a>>,
    pub(super) machine: Machine,
}

/// The estimated error of the picture.
#[derive(Clone, Serialize)]
pub(super) struct ErrorJson {
    error: f64,
    interval: [f64; 2],
    /// What of it is bias of photon maps, where there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    map_bias: Option<MapBiasJson>,
    trusted: bool,
    /// How many pixels carry it.
    pixels: f64,
    tail: Option<TailJson>,
    /// Why it cannot be trusted.
    doubt: Option<DoubtJson>,
}

/// Bias of photon maps, as an error, and its 95 % interval.
#[derive(Clone, Copy, Serialize)]
pub(super) struct MapBiasJson {
    error: f64,
    interval: [f64; 2],
}

/// Few samples that carry much of the light: shares of both.
#[derive(Clone, Copy, Serialize)]
pub(super) struct TailJson {
    samples: f64,
    light: f64,
}

impl ErrorJson {
    /// Of a picture whose lights are told apart by these names.
    pub(super) fn new(e: &ErrorEstimate, lights: &[String]) -> Self {
        Self {
            error: e.error,
            interval: e.interval,
            map_bias: e.map_bias.map(|b| MapBiasJson { error: b.error, interval: b.interval }),
            trusted: e.trusted,
            pixels: e.effective_pixels,
            tail: e.tail.map(|t| TailJson { samples: t.samples, light: t.light }),
            doubt: e.doubt.as_ref().map(|d| DoubtJson::new(d, lights)),
        }
    }
}

/// Wall-clock time of each step, seconds.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Seconds {
    pub(super) load: f64,
    pub(super) prepare: f64,
    pub(super) render: f64,
    pub(super) write: f64,
}

/// A sample that was refused.
#[derive(Serialize)]
pub(super) struct RefusedJson {
    pub(super) pixel: [u32; 2],
    pub(super) pass: u32,
    pub(super) reason: String,
}

/// The machine, as far as it matters for time.
#[derive(Serialize)]
pub(super) struct Machine {
    os: &'static str,
    arch: &'static str,
    cores: usize,
    cpu: Option<String>,
}

impl Machine {
    pub(super) fn this() -> Self {
        Self {
            os: std::env::consts::OS,
            arch: std::env::consts::ARCH,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            cpu: cpu_name(),
        }
    }
}

/// The processor's name, where Linux tells it.
pub(super) fn cpu_name() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// Where the report of an image lies.
pub(super) fn report_path(image: &Path) -> PathBuf {
    image.with_extension("report.json")
}

/// The command line as a shell would take it.
pub(super) fn command_line(arguments: &[OsString]) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+%@".contains(c);
    let quote = |word: &OsString| {
        let word = word.to_string_lossy();
        if !word.is_empty() && word.chars().all(plain) {
            word.into_owned()
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    arguments.iter().map(quote).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_lines_can_be_pasted() {
        let words = ["epsilux", "render", "my scene.toml", "--camera", "it's", ""].map(OsString::from);
        assert_eq!(command_line(&words), r"epsilux render 'my scene.toml' --camera 'it'\''s' ''");
    }

    #[test]
    fn reports_lie_beside_images() {
        assert_eq!(report_path(Path::new("a/room.v2.png")), Path::new("a/room.v2.report.json"));
    }
}

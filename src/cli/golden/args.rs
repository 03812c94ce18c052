//! Flags of `epsilux golden` as typed.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::stats::gate::FEWEST_RUNS;

/// Guard pictures: is a scene still rendered as it was recorded?
///
/// A golden.toml lists scenes. `record` renders each some 80 times, to learn what its runs are like when nothing
/// is wrong; `verify` renders it a few times more and judges them by statistics: the whole picture, its parts,
/// direct, indirect and caustic light, noise. Over a whole suite it cries wolf once in 1000 times, and it says
/// which change it would notice.
#[derive(Args, Debug)]
#[command(after_help = "\
A golden.toml:
  golden = 1

  [[scene]]
  name = \"room\"                 what it is called here
  file = \"room.glb\"             any scene that can be rendered
  size = [64, 64]               [default: 64x64]
  spp = 64                      samples per pixel of one run, a multiple of 32 [default: 64]
  guards = \"soft shadows\"       a line for people

Keys besides: camera, max_depth, reference (folder of the recorded files), truth (\"render\",
{ reference = { spp = 256 } } or { closed_form = { mean = 1.0, source = \"..\" } }) and
accept = { shift = 0.01, reason = \"..\" }.

Examples:
  epsilux golden record                          what golden.toml lists, in the current folder
  epsilux golden verify                          exit code 0: as recorded; 1: something changed
  epsilux golden verify --junit results.xml      for CI
  epsilux golden report -o golden.html           the same as a page with pictures and plots
  epsilux golden bless golden.toml room --reason \"the lamp is warmer now\"
  epsilux golden power                           which change would be noticed")]
pub(in crate::cli) struct GoldenArgs {
    #[command(subcommand)]
    pub(super) command: GoldenCommand,
}

#[derive(Debug, Subcommand)]
pub(super) enum GoldenCommand {
    Record(RecordArgs),
    Verify(VerifyArgs),
    Bless(BlessArgs),
    Report(ReportArgs),
    Power(PowerArgs),
}

/// Which scenes.
#[derive(Args, Clone, Debug)]
pub(super) struct SuiteArgs {
    /// Files that list scenes
    #[arg(value_name = "GOLDEN.toml", default_value = "golden.toml")]
    pub(super) suites: Vec<PathBuf>,

    /// Only the scene of this name; may repeat
    #[arg(long = "scene", value_name = "NAME")]
    pub(super) scenes: Vec<String>,
}

/// Render scenes that are held to be right, and keep what their runs are like
///
/// Says what a verification will cost and the smallest change it will notice before the long part begins. Writes
/// reference.exr and reference.json for each scene and a line in BLESSINGS.md. What is recorded already is left
/// alone: `bless` replaces it.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux golden record
  epsilux golden record tests/golden.toml --scene room")]
pub(super) struct RecordArgs {
    #[command(flatten)]
    pub(super) suite: SuiteArgs,

    /// Runs that say what is normal
    #[arg(long, value_name = "N", default_value_t = FEWEST_RUNS as u32,
        value_parser = clap::value_parser!(u32).range(FEWEST_RUNS as i64..=4096))]
    pub(super) runs: u32,
}

/// How scenes are judged.
#[derive(Args, Clone, Debug)]
pub(super) struct JudgeArgs {
    #[command(flatten)]
    pub(super) suite: SuiteArgs,

    /// Runs under test; their mean is judged, so four times as many see half the change
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(super) runs: u32,

    /// Take new seeds instead of the fixed ones, or those of an earlier --fresh; for nightly tests
    #[arg(long, value_name = "SEED", num_args = 0..=1, require_equals = true)]
    #[allow(clippy::option_option)]
    pub(super) fresh: Option<Option<u64>>,

    /// Judge this picture of a scene instead of rendering it: an EXR of any renderer with the variance of each
    /// pixel's mean (variance.R, .G, .B) and the same size; may repeat
    #[arg(long = "image", value_name = "NAME=FILE")]
    pub(super) images: Vec<String>,

    /// Do not refuse a scene for having been edited: let the pictures speak
    #[arg(long)]
    pub(super) edited: bool,

    /// Fail (exit code 1) on improvements too, so that they are blessed
    #[arg(long)]
    pub(super) strict: bool,
}

/// Render scenes again, and judge them
///
/// Exit code 0: all as recorded, or better; 1: a scene is refused. Seeds are fixed, so unchanged code gives an
/// unchanged verdict.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux golden verify
  epsilux golden verify --junit results.xml --html golden.html
  epsilux golden verify --runs 32 --fresh               nightly: sharper, with new seeds
  epsilux golden verify --image room=other-renderer.exr")]
pub(super) struct VerifyArgs {
    #[command(flatten)]
    pub(super) judge: JudgeArgs,

    /// Write JUnit XML, as CI systems show it
    #[arg(long, value_name = "FILE")]
    pub(super) junit: Option<PathBuf>,

    /// Write a page with pictures and plots
    #[arg(long, value_name = "FILE")]
    pub(super) html: Option<PathBuf>,

    /// Print JSON (epsilux.golden-verify/1)
    #[arg(long)]
    pub(super) json: bool,
}

/// Accept what a scene renders to now as its reference
///
/// Says what changed: mean light by layer, noise, how it looks. Refuses where a sample is no radiance, where the
/// scene has moved away from what is known to be true, and where git sees changes that are not committed.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux golden bless golden.toml room --reason \"the lamp is warmer now\"")]
pub(super) struct BlessArgs {
    /// File that lists the scene
    #[arg(value_name = "GOLDEN.toml")]
    pub(super) suite: PathBuf,

    /// Scenes
    #[arg(value_name = "NAME", required = true)]
    pub(super) scenes: Vec<String>,

    /// Why it changed; kept in BLESSINGS.md
    #[arg(long, value_name = "WHY")]
    pub(super) reason: String,

    /// Runs that say what is normal
    #[arg(long, value_name = "N", default_value_t = FEWEST_RUNS as u32,
        value_parser = clap::value_parser!(u32).range(FEWEST_RUNS as i64..=4096))]
    pub(super) runs: u32,

    /// Bless although git sees changes that are not committed
    #[arg(long)]
    pub(super) allow_dirty: bool,
}

/// Verify, and write a page with pictures, differences, p-values and plots
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux golden report
  epsilux golden report tests/golden.toml --scene room -o room.html")]
pub(super) struct ReportArgs {
    #[command(flatten)]
    pub(super) judge: JudgeArgs,

    /// The page; it needs no other file
    #[arg(short, long, value_name = "FILE", default_value = "golden.html")]
    pub(super) output: PathBuf,
}

/// Say which change of a scene would be noticed, from its recorded runs
///
/// For each scene and layer the smallest relative change that `verify` notices with a probability of 99 %. Nothing
/// is rendered.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux golden power
  epsilux golden power --runs 32              what verify --runs 32 would notice")]
pub(super) struct PowerArgs {
    #[command(flatten)]
    pub(super) suite: SuiteArgs,

    /// Runs under test
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub(super) runs: u32,

    /// Print JSON (epsilux.golden-power/1)
    #[arg(long)]
    pub(super) json: bool,
}

//! `epsilux cost`

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;

use super::algorithm::AlgorithmArgs;
use super::args::{ProgressArg, SceneArgs};
use super::compare::unusable;
use super::console::Console;
use super::failure::Failure;
use super::machine::{command_line, cpu_name};
use super::progress::Display;
use super::schema::to_json;
use super::signal::Stop;
use super::units::show_time;
use super::{Code, load, notes, render, units};
use crate::check;
use crate::cost::{self, About, CostError, CostOptions, Effort, Observer};
use crate::integrate::RunError;
use crate::output::{check_place, write_bytes};
use crate::pilot::{self, Asked};
use crate::prepare::{EffectsMode, Options, Shortcuts};

/// Measure what accuracy costs in a scene, and what each effect has to do with it
///
/// Renders the scene, small, as it is and with each effect and estimator switched, with several seeds and more and
/// more samples, and compares with a long render: error over time, the price of 10, 5, 2, 1 and 0.5 %, what each
/// shortcut saves and what it loses. Writes one HTML page that needs no other file, with plots and pictures.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux cost scenes/hexroom.toml
      hexroom.cost.html in the current folder, after about two minutes
  epsilux cost scenes/hexroom.toml --budget 30s -o room.html
      a first look: wider intervals
  epsilux cost scenes/hexroom.toml --spp 64 --json room.json
      with 64 samples a pixel of everything: all figures but seconds can be repeated")]
pub(super) struct CostArgs {
    #[command(flatten)]
    scene: SceneArgs,

    /// The page [default: NAME.cost.html in the current folder, where --json is not given]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Write the figures as JSON (epsilux.cost/1)
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Camera by name [default: the scene's first]
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,

    /// Size of the picture whose price is told [default: the scene's own, else 800 pixels wide]
    #[arg(long, value_name = "WxH", value_parser = units::size)]
    size: Option<[u32; 2]>,

    /// Width of the pictures that are measured, pixels
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = clap::value_parser!(u32).range(16..=4096))]
    width: u32,

    /// Renders of everything, each with another seed
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(2..=64))]
    seeds: u32,

    /// About how long it may take
    #[arg(long, value_name = "TIME", default_value = "2min", value_parser = units::time, conflicts_with = "spp")]
    budget: Duration,

    /// Instead of a time, this many samples a pixel of everything, a power of two
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(8..=65536))]
    spp: Option<u32>,

    #[command(flatten)]
    algorithms: AlgorithmArgs,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Threads; 0 is one for each core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,

    /// How progress is shown, on standard error
    #[arg(long, value_enum, default_value_t, value_name = "KIND")]
    progress: ProgressArg,

    /// Say nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

/// Tells the time, shows progress, passes on the wish to stop.
struct Watch<'a> {
    display: Display<'a>,
    stop: Stop,
    begin: Instant,
}

impl Observer for Watch<'_> {
    fn seconds(&self) -> f64 {
        // Where the system does not tell, the clock on the wall stands in for each thread's.
        processor_seconds().unwrap_or_else(|| self.begin.elapsed().as_secs_f64())
    }

    fn progress(&self, share: f64, doing: &str) {
        self.display.show_share(share, self.begin.elapsed().as_secs_f64(), doing);
    }

    fn cancelled(&self) -> bool {
        self.stop.requested()
    }
}

/// Processor time of all threads of this process so far, where Linux tells it: numbers 14 and 15 of its line are
/// user and system time in hundredths of a second; the name before them may hold anything.
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut fields = text.rsplit(')').next()?.split_whitespace().skip(11);
    let mut ticks = || fields.next()?.parse::<f64>().ok();
    Some((ticks()? + ticks()?) / 100.0)
}

/// A name with another suffix, in the current folder.
fn default_output(scene: &Path) -> PathBuf {
    let stem = Path::new(scene.file_stem().unwrap_or(scene.as_os_str()));
    PathBuf::from(format!("{}.cost.html", stem.display()))
}

pub(super) fn run(args: &CostArgs, arguments: &[OsString], console: &Console) -> Result<Code, Failure> {
    let page = match (&args.output, &args.json) {
        (Some(path), _) => Some(path.clone()),
        (None, None) => Some(default_output(&args.scene.scene)),
        (None, Some(_)) => None,
    };
    page.iter().chain(&args.json).try_for_each(|p| check_place(p)).map_err(|e| unusable(&e))?;
    let loaded = load::load(&args.scene)?;
    if !args.quiet {
        notes::show(&loaded.notes, false, console);
    }
    let camera = render::camera(&loaded.scene, args.camera.as_deref())?;
    let size = render::picture_size(&loaded.scene, camera, args.size);
    let mut options = CostOptions {
        name: args.scene.scene.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        prepare: Options {
            camera: Some(camera.name.clone()),
            size,
            seed: args.seed,
            effects: EffectsMode::Auto,
            max_depth: loaded.scene.settings.max_depth,
            shortcuts: Shortcuts::of(&loaded.scene.settings),
            transparent: false,
            algorithms: args.algorithms.meant(),
        },
        unbiased: args.algorithms.meant().unbiased,
        measured: measured_size(size, args.width),
        seeds: args.seeds,
        effort: args.spp.map_or(Effort::Time(args.budget), Effort::Samples),
        threads: args.threads,
    };
    // Measured is what a render without limit would do.
    let asked = Asked { threads: args.threads, ..Asked::default() };
    let plan = pilot::plan(&loaded.scene, &options.prepare, &asked)
        .map_err(|e| Failure::load(format!("{}: {e}", args.scene.scene.display())))?;
    options.prepare.algorithms = plan.algorithms();
    let watch = Watch {
        display: Display::new(args.progress, args.quiet, console),
        stop: Stop::listen(),
        begin: Instant::now(),
    };
    let measured = cost::measure(&loaded.scene, &options, &watch);
    watch.display.clear();
    let (report, pictures) = measured.map_err(|e| match (e, watch.stop.code()) {
        (CostError::Run(RunError::Cancelled), Some(code)) => {
            Failure::stopped(code, "stopped; nothing was written")
        }
        (e, _) => Failure::load(format!("{}: {e}", args.scene.scene.display())),
    })?;
    let write = |path: &Path, text: &str| {
        write_bytes(path, text.as_bytes()).map_err(|e| Failure::write(format!("{}: {e}", path.display())))
    };
    let mut written = Vec::new();
    if let Some(path) = &page {
        let about = about(arguments, watch.begin.elapsed().as_secs_f64());
        let prices = check::prices();
        write(path, &cost::page(&report, &pictures, &prices, &about))?;
        written.push(path.display().to_string());
    }
    if let Some(path) = &args.json {
        write(path, &(to_json(&report)? + "\n"))?;
        written.push(path.display().to_string());
    }
    if !args.quiet {
        console.message(&cost::summary(&report));
        console.result(&written.join("\n"))?;
    }
    Ok(Code::Done)
}

/// A picture of so many pixels as a square of this width, with the aspect of the whole one; never larger than it.
fn measured_size([w, h]: [u32; 2], width: u32) -> [u32; 2] {
    let scale = (f64::from(width) / (f64::from(w) * f64::from(h)).sqrt()).min(1.0);
    [w, h].map(|v| (f64::from(v) * scale).round().max(1.0) as u32)
}

fn about(arguments: &[OsString], seconds: f64) -> About {
    let mut facts = vec![
        ("Version".to_owned(), format!("epsilux {}", env!("CARGO_PKG_VERSION"))),
        ("Took".to_owned(), show_time(seconds)),
    ];
    facts.extend(cpu_name().map(|cpu| ("Processor".to_owned(), cpu)));
    About { command: command_line(arguments), facts }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_pictures_keep_their_shape() {
        assert_eq!(measured_size([800, 800], 128), [128, 128]);
        assert_eq!(measured_size([1600, 400], 128), [256, 64]);
        assert_eq!(measured_size([64, 32], 128), [64, 32]);
    }

    /// Time goes on while something is computed.
    #[test]
    fn processor_time_is_told_or_not_there() {
        if let Some(seconds) = processor_seconds() {
            assert!(seconds.is_finite() && seconds >= 0.0);
        }
    }
}

//! `cargo xtask golden`: the project's own goldens, and the referee of the gates that judge them.
//!
//! In: `fixtures/golden/*/golden.toml`, and the program. Judging, recording and blessing are `epsilux golden`, as
//! anybody has it; what only this repository needs stands here: which files nobody uses, whether planted faults
//! are noticed, and how often soundness is called a fault.

mod dead;
pub(crate) mod mutate;
mod null;

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Runs under test of the quick mode and of the full one.
const QUICK: u32 = 4;
const FULL: u32 = 32;

/// Judge the goldens of this repository, and the gates that judge them.
///
/// Without a chore: verifies, and writes target/golden.html.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    chore: Option<Chore>,
    /// Scenes [default: all]
    #[arg(value_name = "NAME")]
    scenes: Vec<String>,
    /// Four runs of each scene; the default
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Thirty-two runs of each scene
    #[arg(long)]
    full: bool,
    /// Take new seeds
    #[arg(long)]
    fresh: bool,
}

#[derive(clap::Subcommand)]
enum Chore {
    /// Record scenes that have no reference yet
    Record {
        /// Scenes [default: all]
        #[arg(value_name = "NAME")]
        scenes: Vec<String>,
    },
    /// Accept what scenes render to now
    Bless {
        /// Scenes
        #[arg(value_name = "NAME", required = true)]
        scenes: Vec<String>,
        /// Why it changed
        #[arg(long, value_name = "WHY")]
        reason: String,
    },
    /// Say which change of a scene would be noticed, in quick and in full mode
    Power,
    /// Verify, and write a page with pictures and plots
    Report {
        /// The page
        #[arg(short, long, value_name = "FILE", default_value = "target/golden.html")]
        output: PathBuf,
    },
    /// Find files that no golden uses, and effects that none guards
    Dead,
    Mutate(mutate::Arguments),
    Null(null::Arguments),
}

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let bench = Bench::new()?;
    match &arguments.chore {
        None => {
            let runs = if arguments.full { FULL } else { QUICK }.to_string();
            let mut words = vec!["verify", "--strict", "--runs", &runs, "--html", "target/golden.html"];
            if arguments.fresh {
                words.push("--fresh");
            }
            bench.on(&words, &arguments.scenes)
        }
        Some(Chore::Record { scenes }) => bench.on(&["record"], scenes),
        Some(Chore::Bless { scenes, reason }) => {
            for scene in scenes {
                let suite = bench.suite_of(scene)?;
                bench.passes(&["bless", &suite.display().to_string(), scene, "--reason", reason])?;
            }
            Ok(())
        }
        Some(Chore::Power) => {
            for runs in [QUICK, FULL] {
                bench.on(&["power", "--runs", &runs.to_string()], &[])?;
            }
            Ok(())
        }
        Some(Chore::Report { output }) => bench.on(&["report", "-o", &output.display().to_string()], &[]),
        Some(Chore::Dead) => dead::run(&bench),
        Some(Chore::Mutate(arguments)) => mutate::run(&bench, arguments),
        Some(Chore::Null(arguments)) => null::run(&bench, arguments),
    }
}

/// The repository, its goldens, and the program.
struct Bench {
    root: PathBuf,
    program: PathBuf,
    suites: Vec<PathBuf>,
}

impl Bench {
    /// Builds the program.
    fn new() -> Result<Self, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
        let built =
            Command::new(env!("CARGO")).args(["build", "--release", "--quiet"]).current_dir(root).status();
        if !built.map_err(|e| format!("cargo could not be started: {e}"))?.success() {
            return Err("the program could not be built".to_owned());
        }
        let folder = root.join("fixtures/golden");
        let entries = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut suites: Vec<PathBuf> = entries
            .filter_map(|e| e.ok()?.file_name().into_string().ok())
            .map(|name| PathBuf::from(format!("fixtures/golden/{name}/golden.toml")))
            .filter(|suite| root.join(suite).is_file())
            .collect();
        suites.sort();
        Ok(Self { root: root.to_path_buf(), program: root.join("target/release/epsilux"), suites })
    }

    /// The `golden.toml` of a scene, which is named as its folder.
    fn suite_of(&self, scene: &str) -> Result<PathBuf, String> {
        let wanted = PathBuf::from(format!("fixtures/golden/{scene}/golden.toml"));
        let names =
            || self.suites.iter().filter_map(|s| s.parent()?.file_name()?.to_str()).collect::<Vec<_>>();
        let found = self.suites.contains(&wanted);
        found.then_some(wanted).ok_or_else(|| format!("{scene}: expected one of: {}", names().join(", ")))
    }

    /// The goldens of these scenes; all of them where there are none.
    fn suites_of(&self, scenes: &[String]) -> Result<Vec<PathBuf>, String> {
        if scenes.is_empty() {
            return Ok(self.suites.clone());
        }
        scenes.iter().map(|s| self.suite_of(s)).collect()
    }

    /// `epsilux golden` with these words.
    fn golden(&self, words: &[&str]) -> Command {
        let mut command = Command::new(&self.program);
        command.arg("golden").args(words).current_dir(&self.root);
        command
    }

    /// Runs `epsilux golden` with these words on some scenes.
    fn on(&self, words: &[&str], scenes: &[String]) -> Result<(), String> {
        let suites = self.suites_of(scenes)?;
        let mut command = self.golden(&words[..1]);
        succeeds(command.args(&suites).args(&words[1..]))
    }

    fn passes(&self, words: &[&str]) -> Result<(), String> {
        succeeds(&mut self.golden(words))
    }
}

fn succeeds(command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|e| format!("epsilux could not be started: {e}"))?;
    if status.success() { Ok(()) } else { Err("epsilux golden did not succeed".to_owned()) }
}

/// What a command prints as JSON. That `verify` refuses, and so ends with 1, is no failure.
pub(crate) fn json(command: &mut Command) -> Result<Value, String> {
    let said = command.output().map_err(|e| format!("epsilux could not be started: {e}"))?;
    if !matches!(said.status.code(), Some(0 | 1)) {
        let words = String::from_utf8_lossy(&said.stderr);
        return Err(format!("epsilux ended with {}\n{}", said.status, words.trim_end()));
    }
    serde_json::from_slice(&said.stdout).map_err(|e| format!("epsilux printed no JSON: {e}"))
}

/// An array in JSON; empty where there is none.
pub(crate) fn array<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

pub(crate) fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

/// To standard output; there is nobody left to tell where this fails.
pub(crate) fn println_line(line: &str) {
    use std::io::Write as _;
    let _ = writeln!(std::io::stdout(), "{line}");
}

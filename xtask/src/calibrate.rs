//! `cargo xtask calibrate`: whether the errors that renders state are true.
//!
//! In: scenes and the program. Out: for each scene a row that says how often the true error E lies inside the stated
//! interval of 95 %, how wide that is, and how often it is called not trustworthy. The truth comes from a long
//! reference of another seed, whose own noise is subtracted: E^2 = E(picture, reference)^2 - E(reference)^2. Results
//! are kept in target/calibrate, those of runs by the program that made them, so that it goes on where it ended. With
//! `--quotes` instead: what was quoted of an error and what came, which needs no reference (`quotes`).

mod cases;
mod quotes;
mod table;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};

use crate::golden::println_line;
use cases::{CASES, Case, Kind};
use table::Run;

/// Side of the pictures, pixels.
const SIZE: &str = "64x64";
/// Cases of the quick mode, on neither of which anything was tuned: both need few samples, and their references too.
const QUICK: [&str; 2] = ["edges", "sphere-penumbra"];

/// Hold the errors that renders state against long references
///
/// Each scene is rendered with --error under many seeds. The true error has to lie inside the stated interval of 95 %
/// in 92 to 98 % of the runs, and in at least 85 % of those of each scene; where a scene is made to mislead, 95 % of the
/// errors that are wrong have to be called not trustworthy.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Cases [default: all]
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Two scenes only
    #[arg(long, conflicts_with = "names")]
    quick: bool,
    /// Seeds of each case
    #[arg(long, value_name = "N", default_value_t = 40)]
    seeds: u32,
    /// Forget former results, and render references anew
    #[arg(long)]
    fresh: bool,
    /// Instead quote this error (1%), render to it, and say how far quotes were off: of all cases that are not made to
    /// mislead, where none is named; seconds mean something on an idle machine only
    #[arg(long, value_name = "E", value_parser = percent)]
    quotes: Option<f64>,
    /// Run this program instead of the one of this checkout
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    let bench = Bench::new(root, arguments)?;
    let chosen = |case: &&Case| match (arguments.quick, arguments.names.is_empty()) {
        (true, _) => QUICK.contains(&case.name),
        (false, all) => all || arguments.names.iter().any(|n| n == case.name),
    };
    let cases: Vec<&Case> = CASES.iter().filter(chosen).collect();
    if let Some(unknown) = arguments.names.iter().find(|n| !cases.iter().any(|c| c.name == **n)) {
        let known = CASES.iter().map(|c| c.name).collect::<Vec<_>>().join(", ");
        return Err(format!("{unknown}: expected some of: {known}"));
    }
    let mut known = bench.known()?;
    if let Some(error) = arguments.quotes {
        // What differs from another case in its target alone would be quoted twice.
        let differs =
            |c: &&&Case| !arguments.names.is_empty() || c.kind != Kind::Misleading && c.picture() == c.name;
        let cases: Vec<&Case> = cases.iter().filter(differs).copied().collect();
        quotes::run(&bench, &cases, arguments.seeds, error, known)?;
        bench.tidy();
        return Ok(());
    }
    let mut rows = Vec::new();
    println_line(&table::header());
    for case in cases {
        let mut runs = Vec::new();
        for i in 0..arguments.seeds {
            let key = format!("{}/{i}/{}/{}", case.name, case.reference, bench.version);
            let found = match known.remove(&key) {
                Some(found) => found,
                None => bench.measure(case, i, &key)?,
            };
            runs.push(Run::from_json(&found).ok_or_else(|| format!("{key}: the result cannot be read"))?);
        }
        let row = table::Row::new(case, &runs);
        println_line(&row.to_string());
        rows.push(row);
    }
    bench.tidy();
    println_line(&table::totals(&rows));
    let broken = table::broken(&rows);
    if broken.is_empty() { Ok(()) } else { Err(broken.join("\n  ")) }
}

/// The program, and where results lie.
struct Bench<'a> {
    root: &'a Path,
    folder: PathBuf,
    program: PathBuf,
    /// The beginning of the program's hash.
    version: String,
}

impl<'a> Bench<'a> {
    fn new(root: &'a Path, arguments: &Arguments) -> Result<Self, String> {
        let folder = root.join("target/calibrate");
        let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
        if arguments.fresh && folder.exists() {
            std::fs::remove_dir_all(&folder).map_err(failed)?;
        }
        std::fs::create_dir_all(&folder).map_err(failed)?;
        let built = match &arguments.program {
            Some(program) => program.clone(),
            None => {
                let mut cargo = Command::new(env!("CARGO"));
                cargo.args(["build", "--release", "--quiet"]).current_dir(root);
                succeeds(&mut cargo)?;
                root.join("target/release/epsilux")
            }
        };
        let bytes = std::fs::read(&built).map_err(|e| format!("{}: {e}", built.display()))?;
        let version: String = Sha256::digest(&bytes).iter().take(4).map(|b| format!("{b:02x}")).collect();
        // A copy, so that the checkout may be built meanwhile.
        let program = folder.join(format!("epsilux-{version}"));
        if !program.exists() {
            std::fs::copy(&built, &program).map_err(failed)?;
        }
        Ok(Self { root, folder, program, version })
    }

    /// The picture of a run, until the next one.
    fn picture(&self) -> PathBuf {
        self.folder.join(format!("run-{}.exr", std::process::id()))
    }

    /// Removes what is of no use any more; what cannot be removed does no harm.
    fn tidy(&self) {
        let picture = self.picture();
        let _ = std::fs::remove_file(picture.with_extension("report.json"));
        let _ = std::fs::remove_file(picture);
    }

    fn results(&self) -> PathBuf {
        self.folder.join("runs.jsonl")
    }

    /// What former calls measured, by its key; a line that was cut is measured again.
    fn known(&self) -> Result<BTreeMap<String, Value>, String> {
        let path = self.results();
        if !path.exists() {
            return Ok(BTreeMap::new());
        }
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let lines = text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
        Ok(lines.filter_map(|v| Some((v["key"].as_str()?.to_owned(), v))).collect())
    }

    /// Renders once, holds it against the reference, and keeps the result.
    fn measure(&self, case: &Case, i: u32, key: &str) -> Result<Value, String> {
        let (reference, reference_error) = self.reference(case)?;
        let picture = self.picture();
        let seed = seed(case, i).to_string();
        let target = format!("{}%", 100.0 * case.target);
        let most = case.most.to_string();
        self.render(case, case.scene, &picture, &["--error", &target, "--spp", &most, "--seed", &seed])?;
        let report = read_json(&picture.with_extension("report.json"))?;
        let mut compare = Command::new(&self.program);
        compare.args(["compare", "--json"]).arg(&picture).arg(&reference);
        let said = crate::golden::json(&mut compare)?;
        let apart = said["error"].as_f64().ok_or("compare says no error")?;
        let truth = (apart * apart - reference_error * reference_error).max(0.0).sqrt();
        self.keep(json!({
            "key": key,
            "truth": truth,
            "reference_error": reference_error,
            "samples": report["passes"][1],
            "error": report["error"],
        }))
    }

    /// Appends a result to those that are known.
    fn keep(&self, result: Value) -> Result<Value, String> {
        let path = self.results();
        let failed = |e: std::io::Error| format!("{}: {e}", path.display());
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(&path).map_err(failed)?;
        writeln!(file, "{result}").map_err(failed)?;
        Ok(result)
    }

    /// The reference of a case and its own error, rendered where it is not there.
    fn reference(&self, case: &Case) -> Result<(PathBuf, f64), String> {
        let path = self.folder.join(format!("{}-{}.exr", case.picture(), case.reference));
        if !path.exists() {
            let unfinished = self.folder.join(format!("unfinished-{}.exr", case.picture()));
            let samples = case.reference.to_string();
            let seed = seed(case, u32::MAX).to_string();
            self.render(case, case.reference_scene(), &unfinished, &["--spp", &samples, "--seed", &seed])?;
            let moved = |from: &Path, to: &Path| {
                std::fs::rename(from, to).map_err(|e| format!("{}: {e}", from.display()))
            };
            moved(&unfinished.with_extension("report.json"), &path.with_extension("report.json"))?;
            moved(&unfinished, &path)?;
        }
        let report = read_json(&path.with_extension("report.json"))?;
        let error = report["error"]["error"].as_f64();
        Ok((path, error.ok_or_else(|| format!("the reference of {} states no error", case.name))?))
    }

    fn render(&self, case: &Case, scene: &str, picture: &Path, words: &[&str]) -> Result<(), String> {
        let mut command = Command::new(&self.program);
        command.arg("render").arg(self.root.join(scene)).args(["--size", SIZE, "--quiet", "-o"]).arg(picture);
        command.args(case.flags).args(words).current_dir(self.root);
        let said = command.output().map_err(|e| format!("epsilux could not be started: {e}"))?;
        // Where the samples end before the error is reached, the picture is whole.
        if matches!(said.status.code(), Some(0 | 3)) {
            return Ok(());
        }
        Err(format!("{}: {}", case.name, String::from_utf8_lossy(&said.stderr).trim_end()))
    }
}

/// A share as people write it: `1%`.
fn percent(text: &str) -> Result<f64, String> {
    let number = text.strip_suffix('%').and_then(|n| n.trim().parse::<f64>().ok());
    number
        .filter(|n| *n > 0.0)
        .map(|n| n / 100.0)
        .ok_or_else(|| "expected a number of per cent, such as 1%".to_owned())
}

/// The seed of a run: the hash of its case and number.
fn seed(case: &Case, i: u32) -> u32 {
    let hash = Sha256::digest(format!("calibrate {} {i}", case.name));
    u32::from_le_bytes([hash[0], hash[1], hash[2], hash[3]])
}

fn read_json(path: &Path) -> Result<Value, String> {
    let failed = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let text = std::fs::read_to_string(path).map_err(|e| failed(&e))?;
    serde_json::from_str(&text).map_err(|e| failed(&e))
}

fn succeeds(command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|e| format!("cargo could not be started: {e}"))?;
    if status.success() { Ok(()) } else { Err("the program could not be built".to_owned()) }
}

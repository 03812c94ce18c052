//! Whether planted faults are noticed: a suite that cannot fail proves nothing.
//!
//! The program is built once with all faults, in a target folder of its own and with debug assertions (no release
//! can have them); an environment variable plants one at a time.

#[path = "../../../src/mutants/list.rs"]
#[allow(unreachable_pub, dead_code)]
mod list;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

use super::{Bench, QUICK, array, json, println_line, text};
pub(crate) use list::Mutant;

/// Plant the faults that golden tests have to notice, and say which gate notices each.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Mutants [default: all]
    #[arg(value_name = "MUTANT")]
    mutants: Vec<String>,
    /// Fresh seeds that the sound program must pass afterwards.
    #[arg(long, value_name = "N", default_value_t = 20)]
    sound: u64,
    /// Runs under test.
    #[arg(long, value_name = "N", default_value_t = QUICK)]
    runs: u32,
    /// Only these scenes; may repeat
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<String>,
}

/// Runs the chore; an error is a message for people.
pub(super) fn run(bench: &Bench, arguments: &Arguments) -> Result<(), String> {
    // Without a choice, those that gates have to notice.
    let chosen = |m: &Mutant| match arguments.mutants.as_slice() {
        [] => !m.gates().is_empty(),
        names => names.iter().any(|n| n == m.name()),
    };
    if let Some(unknown) =
        arguments.mutants.iter().find(|n| Mutant::ALL.iter().all(|m| m.name() != n.as_str()))
    {
        let names = Mutant::ALL.map(Mutant::name).join(", ");
        return Err(format!("{unknown}: expected one of: {names}"));
    }
    let suites = bench.suites_of(&arguments.scenes)?;
    let program = build(&bench.root)?;
    let mutants: Vec<Mutant> = Mutant::ALL.into_iter().filter(chosen).collect();
    let mut survivors = Vec::new();
    println_line("mutant                  seconds  scenes  killed by (the gate that has to | all others)");
    for mutant in &mutants {
        let begin = Instant::now();
        let said = judge(bench, &program, &suites, arguments.runs, &[], Some(mutant.name()))?;
        let (refused, named, others) = gates(&said, *mutant);
        println_line(&format!(
            "{:<23} {:>7.1}  {refused:>6}  {} | {}",
            mutant.name(),
            begin.elapsed().as_secs_f64(),
            match named.as_slice() {
                [] if mutant.gates().is_empty() => "none has to".to_owned(),
                [] => "SURVIVED".to_owned(),
                named => named.join("; "),
            },
            others.join(", ")
        ));
        if named.is_empty() && !mutant.gates().is_empty() {
            survivors.push(format!(
                "{} ({}): expected {}",
                mutant.name(),
                mutant.what(),
                mutant.gates().join(" or ")
            ));
        }
    }
    let mut alarms = Vec::new();
    for seed in 1..=arguments.sound {
        let fresh = format!("--fresh={seed}");
        let said = judge(bench, &bench.program, &suites, arguments.runs, &[&fresh], None)?;
        for scene in array(&said, "scenes").iter().filter(|s| text(s, "verdict") != "passed") {
            alarms.push(format!("{} with {fresh}: {}", text(scene, "name"), first_reason(scene)));
        }
    }
    println_line(&format!(
        "{} of {} mutants killed; {} alarms of the sound program in {} fresh seeds",
        mutants.len() - survivors.len(),
        mutants.len(),
        alarms.len(),
        arguments.sound
    ));
    for alarm in &alarms {
        println_line(&format!("  {alarm}"));
    }
    if !survivors.is_empty() {
        return Err(format!("survived:\n  {}", survivors.join("\n  ")));
    }
    if alarms.len() > 1 { Err("more than one alarm of the sound program".to_owned()) } else { Ok(()) }
}

/// Builds the program with all faults.
pub(crate) fn build(root: &Path) -> Result<PathBuf, String> {
    let target = root.join("target/mutants");
    let built = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--bin", "epsilux"])
        .env("CARGO_TARGET_DIR", &target)
        .env("RUSTFLAGS", "--cfg epsilux_mutants")
        .current_dir(root)
        .status();
    if !built.map_err(|e| format!("cargo could not be started: {e}"))?.success() {
        return Err("the mutants could not be built".to_owned());
    }
    Ok(target.join("debug/epsilux"))
}

fn judge(
    bench: &Bench,
    program: &PathBuf,
    suites: &[PathBuf],
    runs: u32,
    more: &[&str],
    mutant: Option<&str>,
) -> Result<Value, String> {
    let mut verify = Command::new(program);
    verify.args(["golden", "verify", "--json", "--runs", &runs.to_string()]).args(more).args(suites);
    verify.current_dir(&bench.root).env("EPSILUX_MUTANT", mutant.unwrap_or_default());
    json(&mut verify)
}

fn first_reason(scene: &Value) -> String {
    array(scene, "reasons").first().map_or_else(String::new, |r| text(r, "message").to_owned())
}

/// How many scenes refused, the best finding of the gates that have to notice, and the groups of the others.
fn gates(said: &Value, mutant: Mutant) -> (usize, Vec<String>, Vec<String>) {
    let (mut refused, mut named, mut others) = (0, Vec::new(), Vec::new());
    for scene in array(said, "scenes").iter().filter(|s| text(s, "verdict") == "refused") {
        refused += 1;
        for reason in array(scene, "reasons") {
            let gate = text(reason, "gate");
            if mutant.gates().iter().any(|k| gate.starts_with(k)) {
                if named.is_empty() {
                    named.push(format!("{}: {gate}: {}", text(scene, "name"), text(reason, "message")));
                }
            } else {
                let group = gate.split([',', ' ']).next().unwrap_or_default().to_owned();
                if !others.contains(&group) {
                    others.push(group);
                }
            }
        }
    }
    (refused, named, others)
}

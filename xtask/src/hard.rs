//! `cargo xtask hard`: the catalogue of hard cases with all figures, and whether it notices planted faults.

use std::process::Command;

use serde_json::Value;

use crate::golden::mutate::{Mutant, build};
use crate::golden::{array, json, println_line, text};

/// Run the catalogue of hard cases, each figure beside its threshold.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Cases [default: all]
    #[arg(value_name = "ID")]
    cases: Vec<String>,
    /// A hundred times the rays
    #[arg(long)]
    nightly: bool,
    /// Plant faults; each must be noticed by the cases that it names
    #[arg(long)]
    mutants: bool,
}

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let root =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    if arguments.mutants {
        return mutants(root, arguments);
    }
    let mut command = Command::new(env!("CARGO"));
    command.args(["run", "--release", "--quiet", "--", "check", "--figures"]).current_dir(root);
    if arguments.nightly {
        command.arg("--nightly");
    }
    let status =
        command.args(&arguments.cases).status().map_err(|e| format!("cargo could not be started: {e}"))?;
    if status.success() { Ok(()) } else { Err("some hard cases do not hold".to_owned()) }
}

/// Goes through the mutants. One that names hard cases must be noticed by each of them, as far as they are chosen;
/// whoever else notices is printed, since it says what a case is good for.
fn mutants(root: &std::path::Path, arguments: &Arguments) -> Result<(), String> {
    let program = build(root)?;
    let broken = |mutant: &str| -> Result<Vec<String>, String> {
        let mut check = Command::new(&program);
        check.args(["check", "--json"]).args(&arguments.cases).env("EPSILUX_MUTANT", mutant);
        let said: Value = json(&mut check)?;
        let failing = array(&said, "cases").iter().filter(|c| c["holds"] == false);
        Ok(failing.map(|c| text(c, "id").to_owned()).collect())
    };
    let sound = broken("")?;
    if !sound.is_empty() {
        return Err(format!("the sound program fails {}", sound.join(", ")));
    }
    let chosen = |id: &str| arguments.cases.is_empty() || arguments.cases.iter().any(|c| c == id);
    let (mut survivors, mut named) = (Vec::new(), 0);
    println_line("mutant                  noticed by (cases that have to | all others)");
    for mutant in Mutant::ALL {
        let noticed = broken(mutant.name())?;
        let has_to = |id: &String| mutant.cases().contains(&id.as_str());
        let (expected, others): (Vec<String>, Vec<String>) = noticed.iter().cloned().partition(has_to);
        println_line(&format!("{:<23} {} | {}", mutant.name(), expected.join(" "), others.join(" ")));
        named += usize::from(!mutant.cases().is_empty());
        let missing: Vec<&str> =
            mutant.cases().iter().copied().filter(|c| chosen(c) && !noticed.iter().any(|n| n == c)).collect();
        if !missing.is_empty() {
            survivors.push(format!("{} ({}): not by {}", mutant.name(), mutant.what(), missing.join(", ")));
        }
    }
    println_line(&format!(
        "{} of {named} mutants that name hard cases are noticed by each of these",
        named - survivors.len()
    ));
    if survivors.is_empty() { Ok(()) } else { Err(format!("survived:\n  {}", survivors.join("\n  "))) }
}

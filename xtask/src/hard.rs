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
    /// Plant faults, and say which cases notice each
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
    let mut survivors = Vec::new();
    for mutant in Mutant::ALL {
        let cases = broken(mutant.name())?;
        let said = if cases.is_empty() { "no case".to_owned() } else { cases.join(", ") };
        println_line(&format!("{:<23} {said}", mutant.name()));
        if cases.is_empty() {
            survivors.push(mutant.name());
        }
    }
    println_line(&format!(
        "{} of {} mutants are noticed by a hard case; not by any: {}",
        Mutant::ALL.len() - survivors.len(),
        Mutant::ALL.len(),
        if survivors.is_empty() { "none".to_owned() } else { survivors.join(", ") }
    ));
    Ok(())
}

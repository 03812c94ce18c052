//! What lies about: files of the goldens that none uses, effects and layers that none guards.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use super::{Bench, array, json, println_line, text};

/// A layer counts as guarded where some scene notices a change of this size in full mode.
const GUARDED: f64 = 0.03;

/// Runs the chore; an error is a message for people.
pub(super) fn run(bench: &Bench) -> Result<(), String> {
    let mut dead = Vec::new();
    // Files.
    for suite in &bench.suites {
        let folder = bench.root.join(suite.parent().unwrap_or(Path::new("")));
        let words = std::fs::read_to_string(bench.root.join(suite))
            .map_err(|e| format!("{}: {e}", suite.display()))?;
        let mut texts = vec![words];
        let mut names = Vec::new();
        let entries = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        for entry in entries.filter_map(Result::ok) {
            let name = entry.file_name().to_string_lossy().into_owned();
            if matches!(name.as_str(), "golden.toml" | "reference.exr" | "reference.json") {
                continue;
            }
            texts.extend(std::fs::read_to_string(entry.path()));
            names.push(name);
        }
        for kept in ["reference.exr", "reference.json"] {
            if !folder.join(kept).is_file() {
                dead.push(format!("{}: there is no {kept}", suite.display()));
            }
        }
        // A file is alive where another one names it.
        for name in names.iter().filter(|name| !texts.iter().any(|t| t.contains(name.as_str()))) {
            dead.push(format!("{}: nothing names {name}", suite.display()));
        }
    }
    // Effects.
    let (mut guarded, mut all) = (BTreeSet::new(), BTreeSet::new());
    for suite in &bench.suites {
        let words = std::fs::read_to_string(bench.root.join(suite))
            .map_err(|e| format!("{}: {e}", suite.display()))?;
        let file =
            words.lines().find_map(|l| l.trim().strip_prefix("file")?.split('"').nth(1).map(str::to_owned));
        let Some(file) = file else { continue };
        let scene = suite.with_file_name(file);
        let mut explain = Command::new(&bench.program);
        let plan = json(explain.arg("explain").arg(&scene).arg("--json").current_dir(&bench.root))?;
        guarded.extend(array(&plan, "simulated").iter().map(|n| text(n, "effect").to_owned()));
        all.extend(array(&plan, "left_out").iter().map(|n| text(n, "effect").to_owned()));
    }
    dead.extend(all.difference(&guarded).map(|effect| format!("no golden guards the effect {effect}")));
    // Layers.
    let mut power = bench.golden(&["power"]);
    let power = json(power.args(&bench.suites).args(["--runs", "32", "--json"]))?;
    for layer in ["direct", "indirect", "caustic", "glass", "emitted"] {
        let statistic = format!("matched, {layer}");
        let notices = array(&power, "scenes").iter().flat_map(|s| array(s, "notices"));
        let least = notices
            .filter(|n| text(n, "statistic") == statistic)
            .filter_map(|n| n["shift"].as_f64())
            .fold(f64::INFINITY, f64::min);
        if least > GUARDED {
            dead.push(format!("no golden notices {} % of {layer} light", 100.0 * GUARDED));
        }
    }
    if dead.is_empty() {
        println_line(&format!(
            "{} goldens, {} effects, 5 layers: all alive",
            bench.suites.len(),
            guarded.len()
        ));
        return Ok(());
    }
    Err(format!("dead or unguarded:\n  {}", dead.join("\n  ")))
}

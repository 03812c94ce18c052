//! `cargo xtask gltf-validate`: what we write is valid glTF.
//!
//! In: scenes in any form that epsilux reads. Out: each as GLB in `target/gltf-validate`, and what the
//! Khronos validator (the npm package `gltf-validator`) says about it. An error of the validator fails.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The validator's version.
const PACKAGE: &str = "gltf-validator@2.0.0-dev.3.10";

/// Validates the files named on its command line; one line for each, and each error and warning.
const SCRIPT: &str = r#"
const fs = require("fs");
const validator = require("gltf-validator");
(async () => {
  let failed = 0;
  for (const file of process.argv.slice(2)) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 1000 });
    const { numErrors, numWarnings, numInfos, messages } = report.issues;
    const name = file.split("/").pop();
    console.log(`${name}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos`);
    const seen = new Map();
    for (const m of messages.filter((m) => m.severity < 2 || process.env.VERBOSE)) {
      const text = `  ${["error", "warning", "info", "hint"][m.severity]} ${m.code} ${m.pointer}: ${m.message}`;
      const count = seen.get(m.code) || 0;
      if (count < 3) console.log(text);
      seen.set(m.code, count + 1);
    }
    failed += numErrors;
  }
  process.exit(failed > 0 ? 1 : 0);
})();
"#;

/// Write scenes as GLB and let the Khronos validator look at them (needs Node.js and npm).
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Scenes [default: all of scenes/, and the GLB fixtures]
    files: Vec<PathBuf>,
}

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    let folder = root.join("target/gltf-validate");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    install(&folder)?;
    let files = if arguments.files.is_empty() { default_files(root)? } else { arguments.files.clone() };
    let mut written = Vec::new();
    for file in &files {
        let suffix = file.extension().unwrap_or_default().to_string_lossy().into_owned();
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let out = folder.join(format!("{stem}-{suffix}.glb"));
        let mut convert = Command::new(env!("CARGO"));
        convert.args(["run", "--quiet", "--", "convert"]).arg(file).arg(&out);
        execute(&mut convert)?;
        written.push(out);
    }
    let script = folder.join("validate.js");
    std::fs::write(&script, SCRIPT).map_err(|e| format!("{}: {e}", script.display()))?;
    execute(Command::new("node").arg(&script).args(&written))
}

/// Installs the validator, where it is not there yet.
fn install(folder: &Path) -> Result<(), String> {
    if folder.join("node_modules/gltf-validator").is_dir() {
        return Ok(());
    }
    execute(Command::new("npm").args(["install", "--silent", "--no-save", PACKAGE, "--prefix"]).arg(folder))
        .map_err(|e| format!("{e}; the validator needs Node.js with npm, and a network once"))
}

fn default_files(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    for (folder, suffix) in [("scenes", "toml"), ("fixtures/blender", "glb")] {
        let folder = root.join(folder);
        let entries = std::fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let paths = entries.filter_map(Result::ok).map(|e| e.path());
        found.extend(paths.filter(|p| p.extension().is_some_and(|e| e == suffix)));
    }
    found.sort();
    Ok(found)
}

/// Runs a command to its end, its output going where ours goes.
fn execute(command: &mut Command) -> Result<(), String> {
    let name = command.get_program().to_string_lossy().into_owned();
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{name} ended with {status}")),
        Err(e) => Err(format!("{name} could not be started: {e}")),
    }
}

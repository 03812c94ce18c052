//! `cargo xtask blender`: makes `fixtures/blender/still-life.glb` with Blender as a Python module.
//!
//! In: `fixtures/blender/still_life.py`, and a virtual environment that holds bpy. Out: the exported
//! file, and on request the same scene rendered by Cycles.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The version whose export is committed; its wheel runs under CPython 3.11 only.
const BPY: &str = "bpy==5.0.1";

/// Build the still life with Blender and export it to fixtures/blender/still-life.glb.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Virtual environment with bpy 5.0.1; made where it is missing (needs python3.11, downloads
    /// about 400 MB) [default: target/blender-venv]
    #[arg(long, value_name = "DIR")]
    venv: Option<PathBuf>,
    /// Render the scene with Cycles to this EXR as well.
    #[arg(long, value_name = "FILE.exr")]
    cycles: Option<PathBuf>,
    /// Size of the Cycles picture.
    #[arg(long, default_value = "320x240", value_name = "WxH")]
    size: String,
    /// Samples per pixel of the Cycles picture.
    #[arg(long, default_value_t = 256)]
    spp: u32,
}

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    let venv = arguments.venv.clone().unwrap_or_else(|| root.join("target/blender-venv"));
    let python = venv.join("bin/python");
    if !python.exists() {
        execute(Command::new("python3.11").args(["-m", "venv"]).arg(&venv))?;
        execute(Command::new(&python).args(["-m", "pip", "install", "--quiet", BPY]))?;
    }
    let folder = root.join("fixtures/blender");
    let mut script = Command::new(&python);
    script.arg(folder.join("still_life.py")).arg("--glb").arg(folder.join("still-life.glb"));
    // The profile of a Blender that the user may have stays out of it.
    script.env("BLENDER_USER_RESOURCES", root.join("target/blender-user"));
    if let Some(path) = &arguments.cycles {
        script.arg("--cycles").arg(std::path::absolute(path).map_err(|e| e.to_string())?);
        script.args(["--size", &arguments.size, "--spp", &arguments.spp.to_string()]);
    }
    execute(&mut script)
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

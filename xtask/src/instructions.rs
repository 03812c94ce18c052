//! `cargo xtask instructions`: what plans save, and what the code of one more effect costs those without it.
//!
//! Counted by callgrind, so that neither clock nor load matters: one thread, and the same instructions on every
//! machine with AVX2 (valgrind knows no wider ones, and says so to programs that ask). A scene is rendered with few
//! and with more samples; the difference is what samples take, without loading, preparing and writing.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::golden::println_line;

/// Scenes that must take fewer instructions under their plan than under everything.
const PLANNED: [&str; 2] = ["scenes/hexroom-diffuse.toml", "scenes/cornell.toml"];

/// Scenes of every kernel; none calls for the effect that is added.
const SCENES: [&str; 5] = [
    "scenes/hexroom-diffuse.toml",
    "scenes/cornell.toml",
    "scenes/hexroom.toml",
    "scenes/materials.toml",
    "fixtures/blender/still-life.glb",
];

/// Samples per pixel of the two renders; far enough apart to drown the last difference between two runs, the order of
/// hash maps while a scene is loaded (about 0.1 % of a sample of the still life).
const SAMPLES: [u64; 2] = [1, 9];

/// The most that an effect may cost scenes without it.
const MOST: f64 = 0.01;

/// Count instructions: what plans save, and what one more effect costs scenes without it
///
/// Builds the program twice, once with a dummy effect. Says "not run" where valgrind is missing.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Width and height of the pictures, pixels
    #[arg(long, value_name = "N", default_value_t = 40)]
    size: u32,
}

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    if !Command::new("valgrind").arg("--version").output().is_ok_and(|o| o.status.success()) {
        println_line("not run: valgrind is missing");
        return Ok(());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    let scratch = root.join("target/instructions");
    let bench = Bench { root, size: arguments.size, scratch };
    let with_dummy = bench.build("with-dummy", "--cfg epsilux_dummy_effect")?;
    let program = bench.build("as-it-is", "")?;
    let mut broken = Vec::new();

    println_line("instructions per sample, as planned / by the kernel of everything");
    for scene in SCENES {
        let [planned, everything] =
            [bench.count(&program, scene, "auto", false)?, bench.count(&program, scene, "all", false)?];
        let ratio = planned / everything;
        println_line(&format!("{scene:<34} {planned:>8.0} / {everything:>8.0} = {ratio:.4}"));
        if ratio >= 1.0 && PLANNED.contains(&scene) {
            broken.push(format!("{scene}: the plan saves nothing"));
        }
    }

    println_line(
        "instructions per sample, with a dummy effect that the scene does not have / without its code",
    );
    for scene in SCENES {
        let [with, without] =
            [bench.count(&with_dummy, scene, "auto", false)?, bench.count(&program, scene, "auto", false)?];
        let change = with / without - 1.0;
        println_line(&format!("{scene:<34} {with:>8.0} / {without:>8.0} = {:+.3} %", 100.0 * change));
        if change >= MOST {
            broken.push(format!("{scene}: {:+.3} % by an effect that it does not have", 100.0 * change));
        }
    }
    // A dummy that is not there costs nothing either.
    let scene = PLANNED[1];
    let [idle, asked] = [false, true].map(|asked| bench.count(&with_dummy, scene, "auto", asked));
    let (idle, asked) = (idle?, asked?);
    println_line(&format!("{scene:<34} {asked:>8.0} with the dummy effect itself"));
    if asked <= idle {
        broken.push("the dummy effect does nothing where it is asked for".to_owned());
    }
    if broken.is_empty() { Ok(()) } else { Err(broken.join("\n  ")) }
}

struct Bench<'a> {
    root: &'a Path,
    size: u32,
    /// Where programs and pictures lie.
    scratch: PathBuf,
}

/// Valgrind runs on Unix only.
#[cfg(unix)]
fn make_executable(script: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    std::fs::set_permissions(script, std::fs::Permissions::from_mode(0o755))
}

#[cfg(not(unix))]
fn make_executable(_: &Path) -> std::io::Result<()> {
    Ok(())
}

impl Bench<'_> {
    /// Builds the program, with `flags` for the compiler of this repository's code alone, and keeps it as `name`.
    fn build(&self, name: &str, flags: &str) -> Result<PathBuf, String> {
        let failed = |e: std::io::Error| format!("{}: {e}", self.scratch.display());
        std::fs::create_dir_all(&self.scratch).map_err(failed)?;
        // Flags in RUSTFLAGS would build every package again.
        let wrapper = self.scratch.join(format!("{name}.sh"));
        std::fs::write(&wrapper, format!("#!/bin/sh\nexec \"$@\" {flags}\n")).map_err(failed)?;
        make_executable(&wrapper).map_err(failed)?;
        let built = Command::new(env!("CARGO"))
            .args(["build", "--release", "--quiet", "--bin", "epsilux"])
            .env("RUSTC_WORKSPACE_WRAPPER", &wrapper)
            .current_dir(self.root)
            .status();
        if !built.map_err(|e| format!("cargo could not be started: {e}"))?.success() {
            return Err("the program could not be built".to_owned());
        }
        let kept = self.scratch.join(name);
        std::fs::copy(self.root.join("target/release/epsilux"), &kept).map_err(failed)?;
        Ok(kept)
    }

    /// Instructions for one sample of one pixel.
    fn count(&self, program: &Path, scene: &str, effects: &str, dummy: bool) -> Result<f64, String> {
        let [few, many] = SAMPLES.map(|spp| self.instructions(program, scene, effects, dummy, spp));
        let samples = u64::from(self.size).pow(2) * (SAMPLES[1] - SAMPLES[0]);
        Ok((many? as f64 - few? as f64) / samples as f64)
    }

    /// Instructions of one whole run.
    fn instructions(
        &self,
        program: &Path,
        scene: &str,
        effects: &str,
        dummy: bool,
        spp: u64,
    ) -> Result<u64, String> {
        let mut command = Command::new("valgrind");
        command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program);
        command.args(["render", scene, "--threads", "1", "-q", "--effects", effects]);
        command.args(["--size", &format!("{0}x{0}", self.size), "--spp", &spp.to_string()]);
        command.arg("-o").arg(self.scratch.join("picture.exr")).current_dir(self.root);
        // Threads that wait for work while a scene is prepared would be counted too.
        command.env("RAYON_NUM_THREADS", "1");
        if dummy {
            command.env("EPSILUX_DUMMY_EFFECT", "0.1");
        }
        let output = command.output().map_err(|e| format!("valgrind could not be started: {e}"))?;
        let said = String::from_utf8_lossy(&output.stderr);
        let collected = said.lines().find_map(|l| l.split_once("Collected :")?.1.trim().parse().ok());
        match collected {
            Some(n) if output.status.success() => Ok(n),
            _ => Err(format!("{scene}: callgrind did not succeed\n{}", said.trim_end())),
        }
    }
}

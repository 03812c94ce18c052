//! `cargo xtask blender`: makes `fixtures/blender` with Blender as a Python module, and compares what
//! epsilux renders from it with Cycles.
//!
//! In: the scripts of `fixtures/blender`, and a virtual environment that holds bpy. Out: the exported
//! files; or pictures, figures and contact sheets in a folder of their own.

mod compare;
mod picture;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The version whose exports are committed; its wheel runs under CPython 3.11 only.
const BPY: &str = "bpy==5.0.1";

/// A scene of `fixtures/blender`.
struct Fixture {
    /// Stem of its files; the script has _ for -.
    name: &'static str,
    /// Width and height at which renders are compared, pixels.
    size: [u32; 2],
    /// The exported files that show it.
    files: &'static [&'static str],
}

const FIXTURES: [Fixture; 4] = [
    Fixture { name: "still-life", size: [256, 192], files: &["still-life.glb"] },
    Fixture { name: "room", size: [256, 192], files: &["room.glb", "room.obj"] },
    Fixture { name: "textured", size: [256, 192], files: &["textured.glb"] },
    Fixture { name: "grove", size: [192, 256], files: &["grove.glb"] },
];

/// Build the scenes of fixtures/blender with Blender and export them; or render them with Cycles.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Which: still-life, room, textured, grove [default: all]
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Instead of exporting, render the Cycles references to NAME.exr in this folder.
    #[arg(long, value_name = "DIR", conflicts_with = "compare")]
    cycles: Option<PathBuf>,
    /// Instead of exporting, render the exported files with epsilux and the scenes with Cycles, and say
    /// how far apart the pictures are.
    #[arg(long)]
    compare: bool,
    /// Where --compare puts pictures and contact sheets; Cycles pictures that are there are used again
    /// [default: target/blender]
    #[arg(long, value_name = "DIR", requires = "compare")]
    out: Option<PathBuf>,
    /// Samples per pixel of a Cycles picture; --compare takes two with different seeds, and twice as
    /// many samples of ours.
    #[arg(long, default_value_t = 256)]
    spp: u32,
    /// Threads of a render; 0 is one for each core.
    #[arg(long, default_value_t = 0)]
    threads: u32,
    /// Virtual environment with bpy 5.0.1; made where it is missing (needs python3.11, downloads
    /// about 400 MB) [default: target/blender-venv]
    #[arg(long, value_name = "DIR")]
    venv: Option<PathBuf>,
}

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let chosen = choose(&arguments.names)?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    let blender = Blender::new(root, arguments)?;
    if arguments.compare {
        let out = arguments.out.clone().unwrap_or_else(|| root.join("target/blender"));
        create(&out)?;
        return compare::run(&blender, &chosen, &out);
    }
    if let Some(folder) = &arguments.cycles {
        create(folder)?;
        return chosen.iter().try_for_each(|f| blender.cycles(f, &folder.join(format!("{}.exr", f.name)), 0));
    }
    chosen.iter().try_for_each(|f| blender.export(f))
}

/// The fixtures of these names, or all.
fn choose(names: &[String]) -> Result<Vec<&'static Fixture>, String> {
    if let Some(name) = names.iter().find(|n| FIXTURES.iter().all(|f| f.name != n.as_str())) {
        let expected = FIXTURES.map(|f| f.name).join(", ");
        return Err(format!("there is no fixture {name}, expected one of: {expected}"));
    }
    Ok(FIXTURES.iter().filter(|f| names.is_empty() || names.iter().any(|n| n == f.name)).collect())
}

/// Blender as a Python module, known to be there.
struct Blender<'a> {
    root: &'a Path,
    python: PathBuf,
    spp: u32,
    threads: u32,
}

impl<'a> Blender<'a> {
    /// Makes the virtual environment where it is missing.
    fn new(root: &'a Path, arguments: &Arguments) -> Result<Self, String> {
        let venv = arguments.venv.clone().unwrap_or_else(|| root.join("target/blender-venv"));
        let python = venv.join("bin/python");
        if !python.exists() {
            say(&format!("installing {BPY} in {}", venv.display()))?;
            execute(Command::new("python3.11").args(["-m", "venv"]).arg(&venv))
                .map_err(|e| format!("{e}; Blender's Python module needs CPython 3.11"))?;
            execute(Command::new(&python).args(["-m", "pip", "install", "--quiet", BPY]))?;
        }
        let mut probe = Command::new(&python);
        probe.args(["-c", "import bpy, numpy"]).stderr(Stdio::null());
        if execute(&mut probe).is_err() {
            return Err(format!(
                "{} has no bpy that works: delete it and run this again, or install {BPY} in it",
                venv.display()
            ));
        }
        Ok(Self { root, python, spp: arguments.spp, threads: arguments.threads })
    }

    fn folder(&self) -> PathBuf {
        self.root.join("fixtures/blender")
    }

    /// Where the fixture's script lies.
    fn script(&self, fixture: &Fixture) -> PathBuf {
        self.folder().join(format!("{}.py", fixture.name.replace('-', "_")))
    }

    /// A command that runs the script and leaves no traces elsewhere.
    fn command(&self, fixture: &Fixture) -> Command {
        let mut command = Command::new(&self.python);
        command.args(["-W", "ignore::DeprecationWarning", "-B"]).arg(self.script(fixture));
        // The profile of a Blender that the user may have stays out of it.
        command.env("BLENDER_USER_RESOURCES", self.root.join("target/blender-user"));
        command.stdout(Stdio::null());
        command
    }

    fn export(&self, fixture: &Fixture) -> Result<(), String> {
        say(&format!("{}: exporting", fixture.name))?;
        execute(self.command(fixture).arg("--out").arg(self.folder()))
    }

    /// Renders the fixture with Cycles to an EXR file.
    fn cycles(&self, fixture: &Fixture, to: &Path, seed: u32) -> Result<(), String> {
        say(&format!("{}: Cycles, {} samples, seed {seed}", fixture.name, self.spp))?;
        let mut command = self.command(fixture);
        command.arg("--cycles").arg(std::path::absolute(to).map_err(|e| e.to_string())?);
        command.args(["--size", &size(fixture)]);
        for (flag, value) in [("--spp", self.spp), ("--seed", seed), ("--threads", self.threads)] {
            command.args([flag, &value.to_string()]);
        }
        execute(&mut command)
    }
}

/// As flags want it.
fn size(fixture: &Fixture) -> String {
    format!("{}x{}", fixture.size[0], fixture.size[1])
}

fn create(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))
}

/// One line on standard output.
fn say(line: &str) -> Result<(), String> {
    writeln!(std::io::stdout(), "{line}").map_err(|e| e.to_string())
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A misspelt name is an error that says what there is, not an empty run.
    #[test]
    fn names_are_checked() {
        assert_eq!(choose(&[]).unwrap().len(), FIXTURES.len());
        assert_eq!(choose(&["grove".into()]).unwrap()[0].name, "grove");
        let said = choose(&["groove".into()]).err().unwrap();
        assert!(said.contains("groove") && said.contains("still-life, room"), "{said}");
    }

    /// The table and the folder agree.
    #[test]
    fn all_files_exist() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/blender");
        for fixture in &FIXTURES {
            assert!(folder.join(format!("{}.py", fixture.name.replace('-', "_"))).exists());
            assert!(fixture.files.iter().all(|f| folder.join(f).exists()), "{}", fixture.name);
        }
    }
}

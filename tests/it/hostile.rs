//! Hostile files: whatever a file holds, `epsilux info` ends soon, within little memory, without a panic,
//! and says what is wrong and where.
//!
//! To add cases, write a function that returns [`Case`]s in a module below (one for each format), and a test
//! that snapshots [`transcript`] of it.

mod gltf;
mod obj;

use std::fmt::Write as _;
use std::fs::{self, File};
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// One hostile scene.
pub(crate) struct Case {
    /// What is wrong with it, in a few words.
    name: String,
    /// What to open.
    scene: &'static str,
    /// Names and contents of files; folders are made.
    files: Vec<(String, Vec<u8>)>,
    /// What contents alone cannot make: links, pipes.
    prepare: Option<fn(&Path)>,
}

impl Case {
    /// A case whose scene is one file.
    pub(crate) fn new(name: impl Into<String>, scene: &'static str, content: impl Into<Vec<u8>>) -> Self {
        let files = vec![(scene.to_owned(), content.into())];
        Self { name: name.into(), scene, files, prepare: None }
    }

    /// With another file beside the scene.
    pub(crate) fn with(mut self, name: &str, content: impl Into<Vec<u8>>) -> Self {
        self.files.push((name.to_owned(), content.into()));
        self
    }

    /// With something in the folder that is no plain file.
    pub(crate) fn prepared(mut self, prepare: fn(&Path)) -> Self {
        self.prepare = Some(prepare);
        self
    }
}

/// Address space of the program, KiB.
const MEMORY: u32 = 1 << 20;
/// Seconds until a case counts as hanging; a slow machine needs some for starting a program.
const SECONDS: u64 = 10;

/// Runs the program on each case and says how it ended: the message, or the notes, with the exit code.
#[track_caller]
pub(crate) fn transcript(cases: Vec<Case>) -> String {
    let mut text = String::new();
    for case in &cases {
        let folder = tempfile::tempdir().unwrap();
        // A folder above the scene's, for references that try to leave it.
        let inside = folder.path().join("scene");
        for (name, content) in &case.files {
            let path = inside.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, content).unwrap();
        }
        fs::write(folder.path().join("secret.bin"), [0; 4096]).unwrap();
        if let Some(prepare) = case.prepare {
            prepare(&inside);
        }
        let (code, out, err) = run(case, folder.path());
        for sign in ["panicked", "RUST_BACKTRACE", "overflowed its stack", "memory allocation"] {
            assert!(!err.contains(sign), "{}: {err}", case.name);
        }
        let told = match code {
            Some(4) => {
                assert_eq!(out, "", "{}", case.name);
                // A file that the scene names is named itself, with the place that names it.
                // The scene itself, or what belongs to it by name, such as `scene.epsilux.toml`.
                let stem = case.scene.trim_end_matches(|c| c != '.');
                let is_placed = err.contains(stem) || err.contains(" names it)");
                // A mistake in the text form is shown with its line.
                let is_error = err.starts_with("error: ") || err.trim_start().starts_with('\u{d7}');
                assert!(is_error && is_placed, "{}: {err}", case.name);
                assert!(err.len() < 1000, "{}: a short message: {err}", case.name);
                err
            }
            Some(0) => {
                assert_eq!(err, "", "{}", case.name);
                let notes = out.lines().filter_map(|l| l.strip_prefix("note ").map(str::trim_start));
                // That these scenes lack light and camera is not what is tested.
                let notes =
                    notes.filter(|n| !n.contains("the default dome") && !n.contains("the default camera"));
                notes.map(|n| format!("note: {n}\n")).collect()
            }
            code => panic!("{}: ended with {code:?}: {err}", case.name),
        };
        let told = told.replace(&*folder.path().to_string_lossy(), "DIR");
        writeln!(text, "# {}\n{told}[exit code {}]\n", case.name, code.unwrap()).unwrap();
    }
    text
}

/// Exit code, standard output and standard error of `epsilux info`.
fn run(case: &Case, folder: &Path) -> (Option<i32>, String, String) {
    let program = env!("CARGO_BIN_EXE_epsilux");
    let mut command = if cfg!(unix) {
        let mut command = Command::new("sh");
        command.args(["-c", &format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\""), program]);
        command
    } else {
        Command::new(program)
    };
    // Into files, since a full pipe would look like a hang.
    let (out, err) = (folder.join("out"), folder.join("err"));
    command.args(["info", case.scene]).current_dir(folder.join("scene"));
    command.stdout(File::create(&out).unwrap()).stderr(File::create(&err).unwrap());
    let mut child = command.spawn().unwrap();
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > Duration::from_secs(SECONDS) {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{}: no end after {SECONDS} s", case.name);
        }
        sleep(Duration::from_millis(5));
    };
    let text = |path| String::from_utf8(fs::read(path).unwrap()).unwrap();
    (status.code(), text(out), text(err))
}

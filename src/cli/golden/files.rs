//! Suites, scenes and references on disk.

use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::args::SuiteArgs;
use crate::cli::args::{LightUnitsArg, SceneArgs};
use crate::cli::failure::Failure;
use crate::cli::{load, render};
use crate::golden::{Entry, Reference, Settings, Subject, Suite};
use crate::output::{self, WriteOptions};

/// A scene of a suite, and where its files are.
pub(super) struct Guarded {
    pub(super) entry: Entry,
    /// The `golden.toml`.
    pub(super) suite: PathBuf,
    /// Where reasons are kept.
    pub(super) blessings: PathBuf,
}

/// The scenes that were asked for.
pub(super) fn guarded(args: &SuiteArgs) -> Result<Vec<Guarded>, Failure> {
    let mut all = Vec::new();
    for path in &args.suites {
        all.extend(suite(path)?);
    }
    let known = |name: &String| all.iter().any(|g| g.entry.name == *name);
    if let Some(unknown) = args.scenes.iter().find(|name| !known(name)) {
        let names = all.iter().map(|g| g.entry.name.as_str()).collect::<Vec<_>>().join(", ");
        return Err(Failure::usage(format!("--scene: found {unknown:?}, expected one of: {names}")));
    }
    if !args.scenes.is_empty() {
        all.retain(|g| args.scenes.contains(&g.entry.name));
    }
    Ok(all)
}

/// The scenes of a `golden.toml`.
pub(super) fn suite(path: &Path) -> Result<Vec<Guarded>, Failure> {
    let text = std::fs::read_to_string(path).map_err(|e| {
        let failure = Failure::load(format!("{}: cannot read: {e}", path.display()));
        if path.exists() {
            failure
        } else {
            failure.help("`epsilux golden --help` shows what stands in a golden.toml")
        }
    })?;
    let suite = Suite::parse(&text)
        .map_err(|e| Failure::load(format!("{}: {}", path.display(), e.to_string().trim_end())))?;
    let blessings = beside(path, suite.blessings.as_deref().unwrap_or("BLESSINGS.md"));
    let guarded = |entry| Guarded { entry, suite: path.to_path_buf(), blessings: blessings.clone() };
    Ok(suite.scenes.into_iter().map(guarded).collect())
}

fn beside(file: &Path, name: &str) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).join(name)
}

impl Guarded {
    /// The scene's file.
    pub(super) fn scene(&self) -> PathBuf {
        beside(&self.suite, &self.entry.file)
    }

    fn folder(&self) -> PathBuf {
        match self.entry.reference.as_deref() {
            Some(".") => self.suite.parent().unwrap_or(Path::new("")).to_path_buf(),
            Some(folder) => beside(&self.suite, folder),
            None => beside(&self.suite, &self.entry.name),
        }
    }

    pub(super) fn image_path(&self) -> PathBuf {
        self.folder().join("reference.exr")
    }

    pub(super) fn text_path(&self) -> PathBuf {
        self.folder().join("reference.json")
    }

    /// Reads the scene.
    pub(super) fn subject(&self) -> Result<Subject, Failure> {
        let args = SceneArgs { scene: self.scene(), light_units: LightUnitsArg::Auto };
        let scene = load::load(&args)?.scene;
        let camera = render::camera(&scene, self.entry.camera.as_deref())?.name.clone();
        let settings = Settings {
            camera,
            size: self.entry.size,
            spp: self.entry.spp,
            max_depth: self.entry.max_depth.or(scene.settings.max_depth),
            caustics: self.entry.caustics,
        };
        Ok(Subject { scene, settings })
    }

    /// Reads what was recorded.
    pub(super) fn reference(&self) -> Result<Reference, Failure> {
        let (image, text) = (self.image_path(), self.text_path());
        if !text.exists() {
            let message =
                format!("{}: nothing is recorded of it: found no {}", self.entry.name, text.display());
            return Err(
                Failure::load(message).help(format!("epsilux golden record {}", self.suite.display()))
            );
        }
        let string = std::fs::read_to_string(&text)
            .map_err(|e| Failure::load(format!("{}: cannot read: {e}", text.display())))?;
        let image = output::read_exr(&image).map_err(|e| Failure::load(e.to_string()))?;
        Reference::from_files(image, &string).map_err(|e| Failure::load(format!("{}: {e}", text.display())))
    }

    /// Writes what was recorded; the name by content of the text.
    pub(super) fn write(&self, reference: &Reference) -> Result<String, Failure> {
        let (image, text) = reference
            .to_files()
            .map_err(|e| Failure::write(format!("{}: {e}", self.text_path().display())))?;
        let folder = self.folder();
        std::fs::create_dir_all(&folder)
            .map_err(|e| Failure::write(format!("{}: cannot create: {e}", folder.display())))?;
        output::write(&image, &self.image_path(), &WriteOptions::default())
            .map_err(|e| Failure::write(e.to_string()))?;
        output::write_bytes(&self.text_path(), text.as_bytes())
            .map_err(|e| Failure::write(format!("{}: cannot write: {e}", self.text_path().display())))?;
        Ok(short_hash(text.as_bytes()))
    }

    /// Adds a section to the file of blessings.
    pub(super) fn tell(&self, section: &str) -> Result<(), Failure> {
        const HEAD: &str =
            "# Blessings\n\nWhy references are what they are, newest last; written by `epsilux golden`.\n";
        let path = &self.blessings;
        let old = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => HEAD.to_owned(),
            Err(e) => return Err(Failure::load(format!("{}: cannot read: {e}", path.display()))),
        };
        output::write_bytes(path, format!("{}\n\n{}\n", old.trim_end(), section.trim_end()).as_bytes())
            .map_err(|e| Failure::write(format!("{}: cannot write: {e}", path.display())))
    }

    /// Renders a run again.
    pub(super) fn replay(&self, subject: &Subject, seed: u64) -> String {
        let s = &subject.settings;
        let mut command = format!(
            "epsilux render {} -o {}.exr --size {}x{} --spp {} --seed {seed} --aov layers",
            word(&self.scene().display().to_string()),
            self.entry.name,
            s.size[0],
            s.size[1],
            s.spp
        );
        if subject.scene.cameras.len() > 1 {
            command += &format!(" --camera {}", word(&s.camera));
        }
        if let Some(depth) = s.max_depth {
            command += &format!(" --max-depth {depth}");
        }
        command
    }

    /// Accepts what is rendered now.
    pub(super) fn bless(&self) -> String {
        let suite = word(&self.suite.display().to_string());
        format!("epsilux golden bless {suite} {} --reason \"..\"", self.entry.name)
    }
}

/// A word of a command line.
fn word(text: &str) -> String {
    crate::cli::machine::command_line(&[text.into()])
}

/// The first 16 digits of the SHA-256, which name a reference in the file of blessings.
pub(super) fn short_hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().take(8).map(|b| format!("{b:02x}")).collect()
}

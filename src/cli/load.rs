//! From a path as typed to a complete scene with notes.

use std::io::ErrorKind;
use std::path::Path;

use super::args::SceneArgs;
use super::failure::Failure;
use crate::import::{self, ReadOptions};
use crate::scene::{self, Note, Scene};

/// A scene that can be rendered.
pub(super) struct Loaded {
    pub(super) scene: Scene,
    /// What was ignored, repaired or assumed; additions of light or camera come first.
    pub(super) notes: Vec<Note>,
}

/// Reads, validates and completes the scene that was asked for.
pub(super) fn load(args: &SceneArgs) -> Result<Loaded, Failure> {
    let path = args.scene.as_path();
    let (scene, notes) = if is_text(path) { read_text(path)? } else { read_file(args)? };
    Ok(complete(scene, notes))
}

/// A scene from text that is called `name`.
pub(super) fn parse(name: &str, text: &str) -> Result<Loaded, Failure> {
    let (scene, notes) = scene::text::parse(text).map_err(|e| Failure::text(name, text.to_owned(), &e))?;
    Ok(complete(scene, notes))
}

/// Adds what a render needs and the scene lacks.
fn complete(mut scene: Scene, mut notes: Vec<Note>) -> Loaded {
    let additions = scene::complete(&mut scene);
    notes.splice(0..0, additions);
    Loaded { scene, notes }
}

/// Whether a path's suffix is one of the text form.
fn is_text(path: &Path) -> bool {
    let suffix = path.extension().and_then(|s| s.to_str()).unwrap_or_default();
    ["toml", "json"].iter().any(|s| suffix.eq_ignore_ascii_case(s))
}

/// The text form, whose mistakes are shown with their line.
fn read_text(path: &Path) -> Result<(Scene, Vec<Note>), Failure> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| match e.kind() {
        ErrorKind::NotFound => Failure::load(format!("{name}: no such file"))
            .help("`epsilux demo` renders a scene without any file"),
        _ => Failure::load(format!("{name}: cannot read: {e}")),
    })?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        Failure::load(format!("{name}: byte {at}: found bytes that are no UTF-8, expected text"))
    })?;
    scene::text::parse(&text).map_err(|e| Failure::text(&name, text.clone(), &e))
}

/// Every other format.
fn read_file(args: &SceneArgs) -> Result<(Scene, Vec<Note>), Failure> {
    let options = ReadOptions { light_units: args.light_units.into(), ..ReadOptions::default() };
    let (mut scene, mut notes) =
        import::read(&args.scene, &options).map_err(|e| Failure::load(e.to_string()))?;
    let repairs =
        scene::validate(&mut scene).map_err(|e| Failure::load(format!("{}: {e}", args.scene.display())))?;
    notes.extend(repairs);
    Ok((scene, notes))
}

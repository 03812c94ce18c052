//! From a path as typed to a complete scene with notes.

use super::args::SceneArgs;
use super::failure::Failure;
use crate::import::{self, ImportError, ReadOptions};
use crate::scene::{self, Note, Scene};

/// A scene that can be rendered.
pub(super) struct Loaded {
    pub(super) scene: Scene,
    /// What was ignored, repaired or assumed; additions of light or camera come first.
    pub(super) notes: Vec<Note>,
}

/// Reads, validates and completes the scene that was asked for.
pub(super) fn load(args: &SceneArgs) -> Result<Loaded, Failure> {
    let (scene, notes) = read(args)?;
    Ok(complete(scene, notes))
}

/// Reads and validates the scene that was asked for, as it is.
pub(super) fn read(args: &SceneArgs) -> Result<(Scene, Vec<Note>), Failure> {
    let name = args.scene.display().to_string();
    let options = ReadOptions { light_units: args.light_units.into(), ..ReadOptions::default() };
    let (mut scene, mut notes) = import::read(&args.scene, &options).map_err(|error| match error {
        ImportError::Text { path, error, text } => Failure::text(&path.display().to_string(), text, &error),
        ImportError::File { .. } if !args.scene.exists() => Failure::load(format!("{name}: no such file"))
            .help("`epsilux demo` renders a scene without any file"),
        other => Failure::load(other.to_string()),
    })?;
    let more = scene::validate(&mut scene).map_err(|e| Failure::load(format!("{name}: {e}")))?;
    // A reader that validates has said some of it already.
    let known = |n: &Note| notes.iter().any(|k| (k.code, &k.message) == (n.code, &n.message));
    let more: Vec<Note> = more.into_iter().filter(|n| !known(n)).collect();
    notes.extend(more);
    Ok((scene, notes))
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

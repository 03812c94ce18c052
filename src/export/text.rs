//! A scene becomes epsilux's own text form, with its pictures beside it. Nothing is lost.

use std::borrow::Cow;

use super::files::{pictures, stem_of};
use super::{Encoded, ExportError, OutFile};
use crate::scene::Scene;
use crate::scene::text::{Syntax, to_json, to_toml};

/// Converts a scene; `name` is the file name that it will have.
pub(super) fn encode(scene: &Scene, syntax: Syntax, name: &str) -> Result<Encoded, ExportError> {
    let found = pictures(&scene.images, stem_of(name))?;
    let scene = with_paths(scene, found.paths);
    let text = match syntax {
        Syntax::Toml => to_toml(&scene),
        Syntax::Json => to_json(&scene),
    };
    let mut files = found.files;
    files.push(OutFile { path: name.to_owned(), bytes: text.into_bytes() });
    Ok(Encoded { files, notes: Vec::new() })
}

/// The scene, whose pictures lie where `paths` says.
pub(super) fn with_paths(scene: &Scene, paths: Vec<String>) -> Cow<'_, Scene> {
    if paths.is_empty() {
        return Cow::Borrowed(scene);
    }
    let mut scene = scene.clone();
    for (image, path) in scene.images.iter_mut().zip(paths) {
        image.file = Some(path);
    }
    Cow::Owned(scene)
}

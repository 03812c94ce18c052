//! The text form of a scene: TOML, and the same model as JSON.
//!
//! In: text, which somebody else has read from a file. Out: a validated [`Scene`] with notes, or one
//! [`TextError`] that says where, what was found, what was expected and what may have been meant. The
//! other way: the canonical form of a scene. Invariant: `parse(write(scene)) == scene`, bit for bit.
//!
//! Pictures have files of their own, which nothing here opens: [`parse`] leaves their pixels `None`, and
//! [`parse_with`] asks its caller for each.
//!
//! A file is marked by the key `epsilux = 1` at its top. Tables read on their way in pass `model`
//! (serde), `expand` (constructors) and [`super::validate`]; a place found wrong in any of them is
//! looked up again in the text by `place`.

mod error;
mod expand;
mod layout;
mod model;
mod names;
mod place;
mod shapes;
mod texture;
mod up;
mod value;
mod write;

pub use error::{TextError, TextErrorKind};
pub(super) use expand::look_along;
pub(crate) use names::Word;

use std::sync::Arc;

use error::Fault;
use place::Place;

use super::{Image, Note, Pixels, Scene, SceneError, Texels, validate};

/// The two ways to write the same tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Syntax {
    /// For people.
    Toml,
    /// For programs.
    Json,
}

/// The version of the form, and the value of its key `epsilux`.
pub const VERSION: u32 = 1;

/// Fills in the pixels of a picture, which the text names at this place, or says what is wrong with it.
pub type LoadImage<'a> = dyn FnMut(&mut Image, &str) -> Result<(), String> + 'a;

/// Reads a scene in either syntax: JSON where the first character is `{`, else TOML. Its pictures have
/// no pixels yet.
///
/// # Errors
/// The first mistake in the text.
pub fn parse(text: &str) -> Result<(Scene, Vec<Note>), TextError> {
    let text_start = text.trim_start_matches(['\u{feff}', ' ', '\t', '\r', '\n']);
    if text_start.starts_with('{') { parse_json(text) } else { parse_toml(text) }
}

/// Reads a scene in TOML; its pictures have no pixels yet.
///
/// # Errors
/// The first mistake in the text.
pub fn parse_toml(text: &str) -> Result<(Scene, Vec<Note>), TextError> {
    finish(toml_document(text)?, text, Syntax::Toml, None)
}

/// Reads a scene in JSON; its pictures have no pixels yet.
///
/// # Errors
/// The first mistake in the text.
pub fn parse_json(text: &str) -> Result<(Scene, Vec<Note>), TextError> {
    finish(json_document(text)?, text, Syntax::Json, None)
}

/// Reads a scene with its pictures, for each of which `load` is called once.
///
/// # Errors
/// The first mistake in the text, which may be the name of a picture that `load` refuses.
pub fn parse_with(
    text: &str,
    syntax: Syntax,
    load: &mut LoadImage<'_>,
) -> Result<(Scene, Vec<Note>), TextError> {
    let document = match syntax {
        Syntax::Toml => toml_document(text)?,
        Syntax::Json => json_document(text)?,
    };
    finish(document, text, syntax, Some(load))
}

fn toml_document(text: &str) -> Result<model::Document, TextError> {
    toml::from_str(text).map_err(|e| {
        let head = toml::from_str::<Head<toml::Value>>(text).ok();
        let version = head.map(|h| h.epsilux.and_then(|v| v.as_integer()));
        wrong_version(version, text, Syntax::Toml).unwrap_or_else(|| error::from_toml(text, &e))
    })
}

fn json_document(text: &str) -> Result<model::Document, TextError> {
    serde_json::from_str(text).map_err(|e| {
        let head = serde_json::from_str::<Head<serde_json::Value>>(text).ok();
        let version = head.map(|h| h.epsilux.and_then(|v| v.as_i64()));
        wrong_version(version, text, Syntax::Json).unwrap_or_else(|| error::from_json(text, &e))
    })
}

/// A scene in canonical TOML; [`parse_toml`] gives the same scene back, bit for bit, if it is valid and its
/// pictures have files; of those the text has the names alone.
#[must_use]
pub fn to_toml(scene: &Scene) -> String {
    layout::toml(&write::tree(scene))
}

/// A scene in canonical JSON; [`parse_json`] gives the same scene back, bit for bit, if it is valid and its
/// pictures have files; of those the text has the names alone.
#[must_use]
pub fn to_json(scene: &Scene) -> String {
    layout::json(&write::tree(scene))
}

/// The JSON Schema of the text form, for editors; it holds for TOML and JSON.
#[must_use]
pub fn schema() -> serde_json::Value {
    schemars::schema_for!(model::Document).to_value()
}

/// The mark alone, read from files that are not scenes of this version.
#[derive(serde::Deserialize)]
struct Head<V> {
    epsilux: Option<V>,
}

/// An error where the text is well formed (`Some`) but not marked as a scene of this version.
fn wrong_version(found: Option<Option<i64>>, text: &str, syntax: Syntax) -> Option<TextError> {
    let message = match found? {
        Some(version) if version == i64::from(VERSION) => return None,
        Some(version) => {
            format!("the scene is of version {version} of the form, this program reads {VERSION}")
        }
        None => "the key `epsilux = 1` that marks a scene is missing at the top".to_owned(),
    };
    Some(Fault::new(TextErrorKind::Version, Place::top("epsilux"), message).locate(text, syntax))
}

fn finish(
    document: model::Document,
    text: &str,
    syntax: Syntax,
    load: Option<&mut LoadImage<'_>>,
) -> Result<(Scene, Vec<Note>), TextError> {
    let version = i64::from(document.epsilux);
    if let Some(error) = wrong_version(Some(Some(version)), text, syntax) {
        return Err(error);
    }
    let (mut scene, origins) = expand::expand(document).map_err(|fault| fault.locate(text, syntax))?;
    let read = load.is_some();
    if let Some(load) = load {
        for (image, place) in scene.images.iter_mut().zip(&origins.images) {
            load(image, &place.to_string()).map_err(|message| {
                Fault::new(TextErrorKind::Picture, place.clone(), message).locate(text, syntax)
            })?;
        }
    }
    match valid(&mut scene, read) {
        Ok(mut notes) => {
            for note in &mut notes {
                note.place = origins.find(&note.place).to_string();
            }
            Ok((scene, notes))
        }
        Err(e) => Err(Fault::value(origins.find(&e.place), e.message).locate(text, syntax)),
    }
}

/// Validates; pictures that nobody has read count as one texel each, so that all else is checked.
fn valid(scene: &mut Scene, read: bool) -> Result<Vec<Note>, SceneError> {
    if read {
        return validate(scene);
    }
    let texel = Arc::new(Pixels { width: 1, height: 1, texels: Texels::Byte(vec![[255; 4]]) });
    scene.images.iter_mut().for_each(|image| image.pixels = Some(Arc::clone(&texel)));
    let result = validate(scene);
    scene.images.iter_mut().for_each(|image| image.pixels = None);
    result
}

#[cfg(test)]
mod scenes_test;
#[cfg(test)]
mod tests;

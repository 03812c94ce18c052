//! The text form of a scene, TOML or JSON, read from a file.

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::error::Fault;
use crate::scene::{Note, Scene, text};

/// Parses the TOML form.
pub(super) fn read_toml(bytes: Vec<u8>) -> Result<(Scene, Vec<Note>), Fault> {
    let text = utf8(bytes)?;
    text::parse_toml(&text).map_err(|error| Fault::Text { error: Box::new(error), text })
}

/// Parses the JSON form.
pub(super) fn read_json(bytes: Vec<u8>) -> Result<(Scene, Vec<Note>), Fault> {
    let text = utf8(bytes)?;
    text::parse_json(&text).map_err(|error| Fault::Text { error: Box::new(error), text })
}

/// True for JSON that is glTF by its keys: `asset` and not `epsilux`.
pub(super) fn is_gltf(bytes: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct Keys {
        asset: Option<IgnoredAny>,
        epsilux: Option<IgnoredAny>,
    }
    serde_json::from_slice::<Keys>(bytes).is_ok_and(|k| k.asset.is_some() && k.epsilux.is_none())
}

fn utf8(bytes: Vec<u8>) -> Result<String, Fault> {
    String::from_utf8(bytes).map_err(|e| {
        let place = format!("byte {}", e.utf8_error().valid_up_to());
        Fault::invalid(place, "an invalid sequence", "UTF-8")
    })
}

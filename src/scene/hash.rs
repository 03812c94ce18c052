//! A scene's name by content.

use sha2::{Digest, Sha256};

use super::{Scene, Texels, text};

/// SHA-256 of the scene's canonical text form and of its pictures, which that only names; hexadecimal.
#[must_use]
pub fn sha256(scene: &Scene) -> String {
    let mut hash = Sha256::new_with_prefix(text::to_json(scene));
    for pixels in scene.images.iter().filter_map(|i| i.pixels.as_ref()) {
        hash.update(pixels.width.to_le_bytes());
        match &pixels.texels {
            Texels::Byte(t) => t.iter().for_each(|t| hash.update(t)),
            Texels::Short(t) => t.iter().flatten().for_each(|c| hash.update(c.to_le_bytes())),
            Texels::Float(t) => t.iter().flatten().for_each(|c| hash.update(c.to_le_bytes())),
        }
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

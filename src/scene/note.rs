//! Notes: what was ignored, repaired or assumed on the way to a scene.

use std::fmt;

/// Something that a reader ignored, repaired or assumed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Stable name of the kind of note, such as `extension-ignored`, for programs.
    pub code: &'static str,
    /// Where: a path in the file, such as `materials[3].extensions.KHR_materials_sheen`.
    pub place: String,
    /// What was found and what was done with it.
    pub message: String,
    /// What that does to the picture.
    pub effect: Effect,
}

/// What a [`Note`] means for the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// The picture is what the file asks for.
    None,
    /// The picture may differ from what the author saw.
    Differs,
    /// Something the file describes is missing from the picture.
    Missing,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.place.is_empty() {
            write!(f, "{}", self.message)
        } else {
            write!(f, "{}: {}", self.place, self.message)
        }
    }
}

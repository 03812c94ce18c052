//! The words of the text form for the scene's small enums: one table for reading, writing and schema.

use crate::scene::{AreaShape, FovAxis, Sides, SpotFalloff, ToneCurve};

use super::up::Up;

/// An enum whose values are words in a scene file.
pub(crate) trait Vocabulary: Copy + PartialEq + 'static {
    /// Name of the set, for the schema.
    const NAME: &'static str;
    /// All values, each with its word.
    const WORDS: &'static [(&'static str, Self)];

    /// The words alone.
    fn words() -> Vec<&'static str> {
        Self::WORDS.iter().map(|&(word, _)| word).collect()
    }

    /// The word for `self`.
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|&&(_, value)| value == self).map_or("", |&(word, _)| word)
    }
}

/// A value that is read from its word.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Word<T>(pub(crate) T);

macro_rules! vocabulary {
    ($($type:ident { $($word:literal = $variant:ident),+ })+) => {$(
        impl Vocabulary for $type {
            const NAME: &'static str = stringify!($type);
            const WORDS: &'static [(&'static str, Self)] = &[$(($word, $type::$variant)),+];
        }
    )+};
}

vocabulary! {
    Up { "y" = Y, "z" = Z }
    Sides { "front" = Front, "both" = Both }
    FovAxis { "horizontal" = Horizontal, "vertical" = Vertical }
    AreaShape { "rectangle" = Rectangle, "ellipse" = Ellipse }
    SpotFalloff { "gltf" = Gltf, "blender" = Blender }
    ToneCurve { "srgb" = Srgb, "agx" = Agx, "neutral" = Neutral, "sqrt" = Sqrt, "linear" = Linear }
}

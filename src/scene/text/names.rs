//! The words of the text form for the scene's small enums: one table for reading, writing and schema.

use crate::scene::{AreaShape, Channel, Filter, FovAxis, Sides, SpotFalloff, ToneCurve, Wrap};

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

/// What alpha does, without the number that goes with "mask".
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum AlphaWord {
    /// Nothing.
    #[default]
    Opaque,
    /// It is compared with the cut-off.
    Mask,
    /// It is a share.
    Blend,
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
    AlphaWord { "opaque" = Opaque, "mask" = Mask, "blend" = Blend }
    Wrap { "repeat" = Repeat, "mirror" = Mirror, "clamp" = Clamp }
    Filter { "linear" = Linear, "nearest" = Nearest }
    Channel { "r" = R, "g" = G, "b" = B, "a" = A }
    ToneCurve { "srgb" = Srgb, "agx" = Agx, "neutral" = Neutral, "sqrt" = Sqrt, "linear" = Linear }
}

impl ToneCurve {
    /// Its word in a scene file.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.word()
    }

    /// The one of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(word, _)| *word == name).map(|&(_, curve)| curve)
    }
}

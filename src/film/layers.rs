//! The parts that the light of a picture consists of.

/// Which way light took to the camera. Each contribution to a picture belongs to exactly one of these, so the
/// layers add up to the picture.
///
/// Written as Heckbert's path expressions (SIGGRAPH 1990) from the eye E to the light L, where S is an event
/// without spread (a perfect mirror, clear glass) or of a material that is hardly rough (GGX widths below 0.1), and D any
/// other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum LightLayer {
    /// `E D L`.
    Direct,
    /// `E D (D|S)* D L`.
    Indirect,
    /// `E (D|S)* D S+ L`: what mirrors and glass throw onto something else.
    Caustic,
    /// `E S (D|S)* L`, where it is not a caustic: what is seen in mirrors and through glass.
    Glass,
    /// `E L`: lamps and the sky themselves.
    Emitted,
}

impl LightLayer {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 5] = [Self::Direct, Self::Indirect, Self::Caustic, Self::Glass, Self::Emitted];

    /// Its name in files and reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::Caustic => "caustic",
            Self::Glass => "glass",
            Self::Emitted => "emitted",
        }
    }
}

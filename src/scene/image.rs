//! Pictures that textures and environments refer to.

use std::sync::Arc;

/// Index into [`super::Scene::images`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ImageId(pub u32);

/// A picture, decoded once and shared by every texture that uses it.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// For people and error messages; need not be unique.
    pub name: String,
    /// Where the picture lies, relative to the scene's file, with `/` between folders; `None` where the
    /// scene's file holds the picture itself.
    pub file: Option<String>,
    /// The file's own bytes, for writers that copy pictures unchanged; `None` for pictures made in memory.
    pub encoded: Option<Encoded>,
    /// What is seen. The text form alone leaves it `None`: a reader of files has to fill it in before
    /// [`super::validate`].
    pub pixels: Option<Arc<Pixels>>,
}

/// A picture as its file holds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Encoded {
    /// Which format the bytes are in.
    pub format: ImageFormat,
    /// The whole file.
    pub bytes: Arc<[u8]>,
}

/// File formats of pictures that scenes may refer to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImageFormat {
    /// Portable Network Graphics, 8 or 16 bit.
    Png,
    /// JPEG.
    Jpeg,
    /// WebP.
    Webp,
    /// Radiance RGBE, linear.
    Hdr,
    /// OpenEXR, linear.
    Exr,
    /// Windows bitmap.
    Bmp,
    /// Truevision TGA.
    Tga,
}

impl ImageFormat {
    /// The usual suffix of file names, without a dot.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpg",
            Self::Webp => "webp",
            Self::Hdr => "hdr",
            Self::Exr => "exr",
            Self::Bmp => "bmp",
            Self::Tga => "tga",
        }
    }
}

/// Decoded pixels, row-major, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// At least 1.
    pub width: u32,
    /// At least 1.
    pub height: u32,
    /// `width * height` of them.
    pub texels: Texels,
}

/// Texels of one kind. A texture slot says whether integers are encoded (sRGB, for colours) or linear
/// (for data such as normals and roughness); alpha is always linear, and so are floats.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Red, green, blue, alpha; 255 is one. Grey pictures repeat their value, and where there is no
    /// alpha it is 255.
    Byte(Vec<[u8; 4]>),
    /// The same with 65535 for one.
    Short(Vec<[u16; 4]>),
    /// Linear red, green, blue, [0, inf) and finite; alpha is one.
    Float(Vec<[f32; 3]>),
}

impl Texels {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Byte(t) => t.len(),
            Self::Short(t) => t.len(),
            Self::Float(t) => t.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes of memory that they take.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Byte(t) => size_of_val(&**t),
            Self::Short(t) => size_of_val(&**t),
            Self::Float(t) => size_of_val(&**t),
        }
    }
}

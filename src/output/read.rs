//! Image files back to linear images, for comparing.

use std::io;
use std::path::{Path, PathBuf};

use super::exr;
use crate::color::{Rgb, srgb_to_linear};
use crate::film::Image;

/// Why an image file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadImageError {
    /// The file system refused.
    #[error("{}: cannot read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it said.
        source: io::Error,
    },
    /// The content is not an image that can be read.
    #[error("{}: {message}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What was found, and what was expected.
        message: String,
    },
}

/// Reads an EXR file; the inverse of [`write`](super::write) in every channel and attribute (attributes
/// come back sorted by name, layers sorted and grouped by the part of the name before the dot).
///
/// # Errors
/// The file cannot be read, or holds neither the channels R, G and B nor Y.
pub fn read_exr(path: &Path) -> Result<Image, ReadImageError> {
    let bytes = bytes_of(path)?;
    exr::decode(&bytes).map_err(|message| ReadImageError::Content { path: path.to_path_buf(), message })
}

/// Reads any image file that can be compared, told by its content: EXR and HDR as they are, PNG, BMP and
/// the like from sRGB to linear; colour is multiplied by alpha.
///
/// # Errors
/// The file cannot be read, or its content is not an image of a known kind.
pub fn read(path: &Path) -> Result<Image, ReadImageError> {
    decode(&bytes_of(path)?).map_err(|message| ReadImageError::Content { path: path.to_path_buf(), message })
}

/// The image in the bytes of a file, as [`read()`] does.
///
/// # Errors
/// What was found, and what was expected.
pub fn decode(bytes: &[u8]) -> Result<Image, String> {
    const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
    if bytes.starts_with(&EXR_MAGIC) { exr::decode(bytes) } else { decode_picture(bytes) }
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadImageError> {
    std::fs::read(path).map_err(|source| ReadImageError::Io { path: path.to_path_buf(), source })
}

fn decode_picture(bytes: &[u8]) -> Result<Image, String> {
    let picture = image::load_from_memory(bytes)
        .map_err(|e| format!("expected an image (EXR, HDR, PNG, BMP, JPEG, WebP): {e}"))?;
    let (width, height) = (picture.width(), picture.height());
    let mut image = Image { width, height, full_size: [width, height], ..Image::default() };
    let linear =
        matches!(picture, image::DynamicImage::ImageRgb32F(_) | image::DynamicImage::ImageRgba32F(_));
    let has_alpha = picture.color().has_alpha();
    let mut alpha = Vec::new();
    for image::Rgba([r, g, b, a]) in picture.into_rgba32f().pixels().copied() {
        let c = Rgb::new(r, g, b);
        let c = if linear { c } else { c.map(srgb_to_linear) };
        image.rgb.push(if has_alpha { c * a } else { c });
        alpha.push(a);
    }
    image.alpha = has_alpha.then_some(alpha);
    Ok(image)
}

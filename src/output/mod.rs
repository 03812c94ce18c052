//! Images to files, and back.
//!
//! In: a [`film::Image`](crate::film::Image). Out: EXR (everything the image knows), PNG, BMP or Radiance
//! HDR (what those can hold), chosen by the file's suffix. Invariants: a file is written whole or not at
//! all; equal images and options give equal bytes; a value that is not a number never reaches a file.

mod atomic;
mod exr;
mod picture;
mod read;
mod texels;
mod tone;

pub use atomic::write_bytes;
pub use read::{ReadImageError, decode, read, read_exr};
pub use texels::encode_pixels;
pub use tone::Tone;

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

use crate::film::Image;

/// How an image becomes a file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Exposure and tone curve of PNG and BMP; EXR and HDR hold radiance and ignore it.
    pub tone: Tone,
}

/// The kinds of image file, by suffix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: 32-bit floats, all layers, lossless.
    Exr,
    /// PNG: eight bits, toned, with alpha.
    Png,
    /// Windows bitmap: eight bits, toned, over black.
    Bmp,
    /// Radiance HDR: shared exponent, colour only.
    Hdr,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Exr, Self::Png, Self::Bmp, Self::Hdr];

    /// Suffix without its dot.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Exr => "exr",
            Self::Png => "png",
            Self::Bmp => "bmp",
            Self::Hdr => "hdr",
        }
    }

    /// The format that a path's suffix names, in any case.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let suffix = path.extension()?.to_str()?;
        Self::ALL.into_iter().find(|f| f.suffix().eq_ignore_ascii_case(suffix))
    }
}

/// Why an image was not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The suffix names no format that can be written.
    #[error("{}: found {}, expected a name that ends in {Suffixes}", path.display(), found_suffix(path))]
    UnknownSuffix {
        /// The file.
        path: PathBuf,
    },
    /// The folder does not exist, or is none.
    #[error("{}: the folder {} does not exist", path.display(), folder.display())]
    NoFolder {
        /// The file.
        path: PathBuf,
        /// The folder.
        folder: PathBuf,
    },
    /// The name belongs to a folder.
    #[error("{}: is a folder, expected a file name", path.display())]
    IsFolder {
        /// The folder.
        path: PathBuf,
    },
    /// The file system refused.
    #[error("{}: cannot write: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it said.
        source: io::Error,
    },
    /// Some values are not numbers.
    #[error(
        "{}: {count} of the image's values are not finite, the first in {channel} at pixel {},{}; nothing was written",
        path.display(), pixel[0], pixel[1]
    )]
    NotFinite {
        /// The file.
        path: PathBuf,
        /// How many values.
        count: usize,
        /// Channel of the first.
        channel: String,
        /// Column and row of the first, within this image.
        pixel: [u32; 2],
    },
    /// A channel's length is not the image's width times height.
    #[error("{}: {channel} has {found} values, expected {expected}; nothing was written", path.display())]
    WrongLength {
        /// The file.
        path: PathBuf,
        /// The channel.
        channel: String,
        /// Its length.
        found: usize,
        /// Width times height.
        expected: usize,
    },
    /// The encoder refused.
    #[error("{}: cannot encode: {message}", path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// Why.
        message: String,
    },
}

/// The suffixes, as a list for people.
struct Suffixes;

impl fmt::Display for Suffixes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first @ .., last] = Format::ALL.map(|format| format!(".{}", format.suffix()));
        write!(f, "{} or {last}", first.join(", "))
    }
}

fn found_suffix(path: &Path) -> String {
    path.extension().map_or_else(|| "no suffix".into(), |s| format!(".{}", s.to_string_lossy()))
}

/// Checks, before any work is done, that an image could be written to `path`: known suffix, existing
/// folder, permission.
///
/// # Errors
/// The reason why [`write()`] would fail.
pub fn check_path(path: &Path) -> Result<Format, WriteError> {
    let format = Format::of(path).ok_or_else(|| WriteError::UnknownSuffix { path: path.to_path_buf() })?;
    check_place(path)?;
    Ok(format)
}

/// Checks, before any work is done, that a file of any kind could be written to `path`: existing folder, permission.
///
/// # Errors
/// The reason why [`write_bytes`] would fail.
pub fn check_place(path: &Path) -> Result<(), WriteError> {
    let path_buf = || path.to_path_buf();
    let folder = atomic::folder_of(path);
    if !folder.is_dir() {
        return Err(WriteError::NoFolder { path: path_buf(), folder: folder.to_path_buf() });
    }
    if path.is_dir() {
        return Err(WriteError::IsFolder { path: path_buf() });
    }
    atomic::probe(path).map_err(|source| WriteError::Io { path: path_buf(), source })
}

/// Writes an image in the format that the suffix of `path` names. What the format cannot hold is left
/// out: only EXR has layers, variance and counts; BMP and HDR have no alpha, and show the picture over
/// black; HDR cuts negative values to zero.
///
/// # Errors
/// Nothing is written where the path is unusable, the file system refuses, or a value is not finite.
/// Infinite variances are no error: they say that a variance is not known.
pub fn write(image: &Image, path: &Path, options: &WriteOptions) -> Result<(), WriteError> {
    let format = check_path(path)?;
    check_values(image, path)?;
    let bytes = encode(image, format, options)
        .map_err(|message| WriteError::Encode { path: path.to_path_buf(), message })?;
    write_bytes(path, &bytes).map_err(|source| WriteError::Io { path: path.to_path_buf(), source })
}

/// The bytes of an image file; its values are not checked.
///
/// # Errors
/// What the encoder says.
pub fn encode(image: &Image, format: Format, options: &WriteOptions) -> Result<Vec<u8>, String> {
    match format {
        Format::Exr => exr::encode(image),
        Format::Png => picture::encode_png(image, &options.tone),
        Format::Bmp => picture::encode_bmp(image, &options.tone),
        Format::Hdr => picture::encode_hdr(image),
    }
}

/// Every channel has one value a pixel, and every value that must be finite is.
fn check_values(image: &Image, path: &Path) -> Result<(), WriteError> {
    let expected = image.width as usize * image.height as usize;
    let mut count = 0;
    let mut first: Option<(String, usize)> = None;
    let mut check = |channel: &str, values: &mut dyn ExactSizeIterator<Item = bool>| {
        if values.len() != expected {
            let (channel, found) = (channel.to_owned(), values.len());
            return Err(WriteError::WrongLength { path: path.to_path_buf(), channel, found, expected });
        }
        for (i, good) in values.enumerate() {
            if !good {
                count += 1;
                first.get_or_insert_with(|| (channel.to_owned(), i));
            }
        }
        Ok(())
    };
    check("the colour", &mut image.rgb.iter().map(|c| c.is_finite()))?;
    if let Some(alpha) = &image.alpha {
        check("alpha", &mut alpha.iter().map(|a| a.is_finite()))?;
    }
    if let Some(variance) = &image.variance {
        let known_or_infinite = |v: f32| !v.is_nan();
        check("the variance", &mut variance.iter().map(|v| v.to_array().into_iter().all(known_or_infinite)))?;
    }
    if let Some(counts) = &image.count {
        check("the count", &mut counts.iter().map(|_| true))?;
    }
    for (name, values) in image.layers.iter().flat_map(|l| &l.channels) {
        check(name, &mut values.iter().map(|v| v.is_finite()))?;
    }
    match first {
        None => Ok(()),
        Some((channel, i)) => {
            let pixel = [i as u32 % image.width, i as u32 / image.width];
            Err(WriteError::NotFinite { path: path.to_path_buf(), count, channel, pixel })
        }
    }
}

#[cfg(test)]
mod tests;

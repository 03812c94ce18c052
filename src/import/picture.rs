//! Pictures: the one place where the files that textures and skies name are decoded.
//!
//! In: bytes, or the name of a file below the scene's folder. Out: [`Pixels`], and [`ImageId`]s of
//! pictures that are decoded once and shared. The format is told by content, sizes are read from the
//! header and held against the limits before anything is allocated, and a broken stream is a [`Fault`].
//! Invariant: floats that come out are finite and not negative.

mod cache;
mod openexr;
#[cfg(test)]
mod tests;

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};

use image::codecs;
use image::{ColorType, ImageDecoder, ImageResult};

use super::budget::{Budget, filled};
use super::error::Fault;
use crate::scene::{ImageFormat, MAX_RADIANCE, MAX_SIDE, Pixels, Texels};

pub(super) use cache::Pictures;

/// The most pixels that a picture may have: as eight-bit texels, a GiB.
pub(super) const MAX_PIXELS: u64 = 1 << 28;

/// What an infinite texel stands for: the largest half float, which is where pictures overflow.
const INFINITE_TEXEL: f32 = 65504.0;

/// What a picture's bytes hold.
#[derive(Debug)]
pub(super) struct Decoded {
    /// What is seen.
    pub(super) pixels: Pixels,
    /// What the bytes turned out to be.
    pub(super) format: ImageFormat,
    /// How many float texels were negative, not finite, or too bright, and came out in range.
    pub(super) repaired: usize,
}

/// Decodes the picture in `bytes`; `place` is where the scene's file names it.
///
/// TGA has no mark at its beginning: it is taken for one where `place` ends in `.tga`, or the bytes in the
/// signature of TGA's second version.
pub(super) fn decode(bytes: &[u8], place: &str, budget: &mut Budget) -> Result<Decoded, Fault> {
    let Some(format) = format(bytes, place) else {
        let head = bytes[..bytes.len().min(8)].escape_ascii();
        let found = if bytes.is_empty() {
            "an empty picture".into()
        } else {
            format!("no picture that can be read (it begins with \"{head}\")")
        };
        return Err(Fault::invalid(place, found, "PNG, JPEG, WebP, Radiance HDR, OpenEXR, BMP or TGA"));
    };
    // The decoders report broken streams, but they are other people's code and have had bugs: one that
    // panics costs the picture and not the program.
    let decode = AssertUnwindSafe(|| match format {
        ImageFormat::Exr => openexr::decode(bytes, place, budget),
        _ => raster(bytes, format, place, budget),
    });
    let mut pixels = catch_unwind(decode).unwrap_or_else(|_| Err(broken(format, "a fault", place)))?;
    let repaired = match &mut pixels.texels {
        Texels::Float(texels) => repair(texels),
        Texels::Byte(_) | Texels::Short(_) => 0,
    };
    Ok(Decoded { pixels, format, repaired })
}

/// Which format the bytes are in.
fn format(bytes: &[u8], place: &str) -> Option<ImageFormat> {
    let is_webp = bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP");
    let is_tga = || place.to_ascii_lowercase().ends_with(".tga") || bytes.ends_with(b"TRUEVISION-XFILE.\0");
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some(ImageFormat::Png),
        [0xff, 0xd8, 0xff, ..] => Some(ImageFormat::Jpeg),
        _ if is_webp => Some(ImageFormat::Webp),
        [b'#', b'?', b'R', ..] => Some(ImageFormat::Hdr),
        [0x76, 0x2f, 0x31, 0x01, ..] => Some(ImageFormat::Exr),
        [b'B', b'M', ..] => Some(ImageFormat::Bmp),
        _ if is_tga() => Some(ImageFormat::Tga),
        _ => None,
    }
}

/// What people call a format.
fn title(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Png => "PNG",
        ImageFormat::Jpeg => "JPEG",
        ImageFormat::Webp => "WebP",
        ImageFormat::Hdr => "Radiance HDR",
        ImageFormat::Exr => "OpenEXR",
        ImageFormat::Bmp => "BMP",
        ImageFormat::Tga => "TGA",
    }
}

/// A stream that does not hold what its header promises.
fn broken(format: ImageFormat, reason: &str, place: &str) -> Fault {
    let title = title(format);
    // Without what the decoder says about itself, and on one line.
    let reason = match reason.strip_prefix("Format error decoding ").and_then(|r| r.split_once(": ")) {
        Some((_, reason)) => reason,
        None => reason,
    };
    let reason = reason.split_whitespace().collect::<Vec<_>>().join(" ");
    let reason = reason.split(" while decoding ").next().unwrap_or_default();
    Fault::invalid(place, format!("a broken {title} picture ({reason})"), format!("a whole {title}"))
}

/// Refuses sizes that are zero or above the limits, and charges `texel` bytes for each pixel.
fn check_size(
    [width, height]: [u64; 2],
    texel: u64,
    format: ImageFormat,
    place: &str,
    budget: &mut Budget,
) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        return Err(broken(format, &format!("{width}x{height} pixels"), place));
    }
    let side = u64::from(MAX_SIDE);
    // Sides are below 2^33 in every format, so that the product is below 2^64 only once they are checked.
    if width > side || height > side || width * height > MAX_PIXELS {
        return Err(Fault::Unsupported {
            place: place.into(),
            feature: format!("a picture of {width}x{height} pixels"),
            help: format!("use a smaller one: up to {MAX_SIDE} along a side, and {MAX_PIXELS} in all"),
        });
    }
    budget.charge_bytes(width * height, texel, place)
}

/// Decodes what the `image` package reads.
fn raster(bytes: &[u8], format: ImageFormat, place: &str, budget: &mut Budget) -> Result<Pixels, Fault> {
    let fault = |e: image::ImageError| broken(format, &e.to_string(), place);
    let decoder = decoder(bytes, format).map_err(fault)?;
    let (width, height) = decoder.dimensions();
    let (color, texel) = match decoder.color_type() {
        c @ (ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8) => (c, 4),
        c @ (ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16) => (c, 8),
        c => (c, 12),
    };
    check_size([width.into(), height.into()], texel, format, place, budget)?;
    // Both sides are bounded now, so that neither product overflows.
    let count = width as usize * height as usize;
    let size = count * usize::from(color.bytes_per_pixel());
    // A few bytes cannot hold many pixels: such a file is not worth the memory that it asks for.
    let most = match format {
        ImageFormat::Png | ImageFormat::Jpeg => 2048,
        ImageFormat::Bmp | ImageFormat::Tga => 512,
        _ => usize::MAX,
    };
    if size / most > bytes.len() {
        let reason = format!("{} bytes for {width}x{height} pixels", bytes.len());
        return Err(broken(format, &reason, place));
    }
    let mut raw = filled(size, 0_u8, place)?;
    decoder.read_image_boxed(&mut raw).map_err(fault)?;
    let texels = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            let mut texels = filled(count, [0; 4], place)?;
            spread(&mut texels, &raw, color, 255, |b: &[u8; 1]| b[0]);
            Texels::Byte(texels)
        }
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            let mut texels = filled(count, [0; 4], place)?;
            spread(&mut texels, &raw, color, u16::MAX, |b: &[u8; 2]| u16::from_ne_bytes(*b));
            Texels::Short(texels)
        }
        ColorType::Rgb32F => {
            let mut texels = filled(count, [0.0; 3], place)?;
            for (texel, raw) in texels.iter_mut().zip(raw.as_chunks::<12>().0) {
                for (slot, bytes) in texel.iter_mut().zip(raw.as_chunks::<4>().0) {
                    *slot = f32::from_ne_bytes(*bytes);
                }
            }
            Texels::Float(texels)
        }
        other => return Err(broken(format, &format!("texels of the kind {other:?}"), place)),
    };
    Ok(Pixels { width, height, texels })
}

/// A decoder that has read the header and nothing else.
fn decoder(bytes: &[u8], format: ImageFormat) -> ImageResult<Box<dyn ImageDecoder + '_>> {
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    // The decoded picture is ours; this is what a decoder may take besides.
    limits.max_alloc = Some(8 * MAX_PIXELS);
    let from = Cursor::new(bytes);
    Ok(match format {
        ImageFormat::Png => Box::new(codecs::png::PngDecoder::with_limits(from, png_limits(limits))?),
        ImageFormat::Jpeg => Box::new(codecs::jpeg::JpegDecoder::new(from)?),
        ImageFormat::Webp => Box::new(codecs::webp::WebPDecoder::new(from)?),
        ImageFormat::Bmp => Box::new(codecs::bmp::BmpDecoder::new(from)?),
        ImageFormat::Tga => Box::new(codecs::tga::TgaDecoder::new(from)?),
        ImageFormat::Hdr | ImageFormat::Exr => Box::new(codecs::hdr::HdrDecoder::new_nonstrict(from)?),
    })
}

/// The size is ours to refuse, with a better message.
fn png_limits(mut limits: image::Limits) -> image::Limits {
    limits.max_image_width = None;
    limits.max_image_height = None;
    limits
}

/// Grey becomes three equal channels, and where there is no alpha it is `one`.
fn spread<const N: usize, T: Copy>(
    texels: &mut [[T; 4]],
    raw: &[u8],
    color: ColorType,
    one: T,
    read: impl Fn(&[u8; N]) -> T,
) {
    let channels = usize::from(color.channel_count());
    let raw = raw.as_chunks::<N>().0;
    for (texel, raw) in texels.iter_mut().zip(raw.chunks_exact(channels)) {
        let c = |i: usize| read(&raw[i]);
        *texel = match channels {
            1 => [c(0), c(0), c(0), one],
            2 => [c(0), c(0), c(0), c(1)],
            3 => [c(0), c(1), c(2), one],
            _ => [c(0), c(1), c(2), c(3)],
        };
    }
}

/// Brings texels into range; returns how many were not.
fn repair(texels: &mut [[f32; 3]]) -> usize {
    let mut repaired = 0;
    for texel in texels {
        if texel.iter().all(|c| (0.0..=MAX_RADIANCE).contains(c)) {
            continue;
        }
        repaired += 1;
        for c in texel {
            *c = match *c {
                f32::INFINITY => INFINITE_TEXEL,
                v if v > 0.0 => v.min(MAX_RADIANCE),
                _ => 0.0,
            };
        }
    }
    repaired
}

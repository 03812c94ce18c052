//! PNG, BMP and Radiance HDR.
//!
//! In: an image. Out: the bytes of a file that holds its colour, and for PNG its alpha and attributes.
//! Colour in an [`Image`] is multiplied by alpha; PNG wants it divided out, the others show it over black.

use std::io::Cursor;

use image::codecs::bmp::BmpEncoder;
use image::codecs::hdr::HdrEncoder;

use super::tone::{Tone, to_byte};
use crate::color::Rgb;
use crate::film::Image;
use crate::scene::ToneCurve;

/// PNG, eight bits; attributes are `iTXt` chunks of their names.
pub(super) fn encode_png(image: &Image, tone: &Tone) -> Result<Vec<u8>, String> {
    let mut info = png::Info::with_size(image.width, image.height);
    info.bit_depth = png::BitDepth::Eight;
    info.color_type = if image.alpha.is_some() { png::ColorType::Rgba } else { png::ColorType::Rgb };
    // The other two curves are pictures of numbers, not colours of a known space.
    if matches!(tone.curve, ToneCurve::Srgb | ToneCurve::Agx | ToneCurve::Neutral) {
        info.srgb = Some(png::SrgbRenderingIntent::RelativeColorimetric);
    }
    for (name, value) in &image.attributes {
        info.utf8_text.push(png::text_metadata::ITXtChunk::new(name.as_str(), value.as_str()));
    }
    let mut pixels = Vec::with_capacity(image.rgb.len() * 4);
    for (i, &c) in image.rgb.iter().enumerate() {
        match image.alpha.as_ref().map(|alpha| alpha[i].clamp(0.0, 1.0)) {
            None => pixels.extend(tone.to_srgb8(c).0),
            Some(a) => {
                let straight = if a > 0.0 { (c / a).map(|v| v.min(f32::MAX)) } else { Rgb::BLACK };
                pixels.extend(tone.to_srgb8(straight).0);
                pixels.push(to_byte(a));
            }
        }
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::with_info(&mut bytes, info).map_err(|e| e.to_string())?;
    encoder.set_compression(png::Compression::Balanced);
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer.write_image_data(&pixels).map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// Windows bitmap, eight bits.
pub(super) fn encode_bmp(image: &Image, tone: &Tone) -> Result<Vec<u8>, String> {
    let pixels: Vec<u8> = image.rgb.iter().flat_map(|&c| tone.to_srgb8(c).0).collect();
    let mut bytes = Cursor::new(Vec::new());
    BmpEncoder::new(&mut bytes)
        .encode(&pixels, image.width, image.height, image::ExtendedColorType::Rgb8)
        .map_err(|e| e.to_string())?;
    Ok(bytes.into_inner())
}

/// Radiance HDR: eight bits a channel with a shared exponent.
pub(super) fn encode_hdr(image: &Image) -> Result<Vec<u8>, String> {
    let pixels: Vec<_> = image.rgb.iter().map(|c| image::Rgb(c.map(|v| v.max(0.0)).to_array())).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, image.width as usize, image.height as usize)
        .map_err(|e| e.to_string())?;
    Ok(bytes)
}

//! Pictures of a scene to files: PNG for integers, OpenEXR for floats, none of them toned.
//!
//! In: [`Pixels`]. Out: a whole file in memory. The invariant: reading it gives the same texels, bit for
//! bit; alpha is left out where all of it is one.

use crate::color::Rgb;
use crate::film::Image;
use crate::scene::{ImageFormat, Pixels, Texels};

/// The picture as a file, and the file's format.
///
/// # Errors
/// What the encoder said: there are not as many texels as width times height, or too many for a file.
pub fn encode_pixels(pixels: &Pixels) -> Result<(ImageFormat, Vec<u8>), String> {
    let bytes = match &pixels.texels {
        Texels::Byte(texels) => {
            let channels = channels(texels, u8::MAX);
            let data = texels.iter().flat_map(|t| &t[..channels]).copied().collect::<Vec<u8>>();
            encode_png(pixels, channels, png::BitDepth::Eight, &data)?
        }
        Texels::Short(texels) => {
            let channels = channels(texels, u16::MAX);
            let data = texels.iter().flat_map(|t| &t[..channels]).flat_map(|c| c.to_be_bytes());
            encode_png(pixels, channels, png::BitDepth::Sixteen, &data.collect::<Vec<u8>>())?
        }
        Texels::Float(texels) => return encode_exr(pixels, texels).map(|bytes| (ImageFormat::Exr, bytes)),
    };
    Ok((ImageFormat::Png, bytes))
}

/// Three where alpha says nothing, else four.
fn channels<T: PartialEq>(texels: &[[T; 4]], one: T) -> usize {
    if texels.iter().all(|t| t[3] == one) { 3 } else { 4 }
}

fn encode_png(
    pixels: &Pixels,
    channels: usize,
    depth: png::BitDepth,
    data: &[u8],
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width, pixels.height);
    encoder.set_color(if channels == 3 { png::ColorType::Rgb } else { png::ColorType::Rgba });
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::Balanced);
    let mut writer = encoder.write_header().map_err(|e| e.to_string())?;
    writer.write_image_data(data).map_err(|e| e.to_string())?;
    writer.finish().map_err(|e| e.to_string())?;
    Ok(bytes)
}

fn encode_exr(pixels: &Pixels, texels: &[[f32; 3]]) -> Result<Vec<u8>, String> {
    let size = [pixels.width, pixels.height];
    if u64::from(size[0]) * u64::from(size[1]) != texels.len() as u64 {
        return Err(format!("{} texels for a picture of {}x{}", texels.len(), size[0], size[1]));
    }
    super::exr::encode(&Image {
        width: size[0],
        height: size[1],
        origin: [0; 2],
        full_size: size,
        rgb: texels.iter().map(|&t| Rgb::from(t)).collect(),
        alpha: None,
        variance: None,
        count: None,
        layers: Vec::new(),
        attributes: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(width: u32, height: u32, texels: Texels) -> Pixels {
        Pixels { width, height, texels }
    }

    /// Equal texels make equal files, of the format that holds them exactly; wrong sizes are refused.
    #[test]
    fn each_kind_has_its_format() {
        let byte = pixels(2, 1, Texels::Byte(vec![[1, 2, 3, 255], [4, 5, 6, 0]]));
        let (format, bytes) = encode_pixels(&byte).unwrap();
        assert_eq!(format, ImageFormat::Png);
        let read = image::load_from_memory(&bytes).unwrap();
        assert_eq!(read.as_rgba8().unwrap().as_raw()[..], [1, 2, 3, 255, 4, 5, 6, 0]);
        let opaque = pixels(1, 1, Texels::Short(vec![[1, 256, 65535, 65535]]));
        let read = image::load_from_memory(&encode_pixels(&opaque).unwrap().1).unwrap();
        assert_eq!(read.as_rgb16().unwrap().as_raw()[..], [1, 256, 65535]);
        let float = pixels(2, 1, Texels::Float(vec![[0.1, 1e30, 1e-40], [0.0, 2.0, 3.0]]));
        let (format, bytes) = encode_pixels(&float).unwrap();
        assert_eq!((format, &bytes), (ImageFormat::Exr, &encode_pixels(&float).unwrap().1));
        let read = super::super::exr::decode(&bytes).unwrap();
        assert_eq!(read.rgb, [Rgb::new(0.1, 1e30, 1e-40), Rgb::new(0.0, 2.0, 3.0)]);
        let short = |texels| encode_pixels(&pixels(3, 1, texels)).is_err();
        assert!(short(Texels::Byte(vec![[0; 4]; 2])) && short(Texels::Float(vec![[0.0; 3]; 2])));
    }
}

//! Linear pictures as numbers, and as pixels on a contact sheet.
//!
//! In: EXR files. Out: block differences, means, RGB bytes. Blocks are those of section "Ours and Cycles"
//! in the guide: means over 8x8 pixels, compared relative to the reference's mean plus a small floor, since
//! single pixels are ruled by noise.

use std::path::Path;

use exr::prelude::read_first_rgba_layer_from_file;

/// Side of a block, pixels.
const BLOCK: usize = 8;
/// Added to the reference's mean of a block, so that dark blocks do not rule.
const FLOOR: f64 = 0.02;

/// Linear pixels, row by row from the top.
#[derive(Clone)]
pub(super) struct Picture {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) rgb: Vec<[f32; 3]>,
}

/// Relative differences over the blocks of two pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blocks {
    pub(super) median: f64,
    /// Nine blocks of ten differ by at most this.
    pub(super) tenth: f64,
    pub(super) max: f64,
}

impl Picture {
    pub(super) fn read(path: &Path) -> Result<Self, String> {
        let image = read_first_rgba_layer_from_file(
            path,
            |size, _| Self {
                width: size.width(),
                height: size.height(),
                rgb: vec![[0.0; 3]; size.width() * size.height()],
            },
            |picture: &mut Self, at, (r, g, b, _): (f32, f32, f32, f32)| {
                picture.rgb[at.y() * picture.width + at.x()] = [r, g, b];
            },
        );
        let picture = image.map_err(|e| format!("{}: {e}", path.display()))?.layer_data.channel_data.pixels;
        match picture.rgb.iter().flatten().all(|v| v.is_finite()) {
            true => Ok(picture),
            false => Err(format!("{}: holds values that are not numbers", path.display())),
        }
    }

    /// `a` times this plus `b` times the other, which has the same size.
    pub(super) fn mix(&self, a: f32, other: &Self, b: f32) -> Self {
        let mixed = |(p, q): (&[f32; 3], &[f32; 3])| [0, 1, 2].map(|c| a * p[c] + b * q[c]);
        Self { rgb: self.rgb.iter().zip(&other.rgb).map(mixed).collect(), ..*self }
    }

    /// Mean of each channel.
    pub(super) fn mean(&self) -> [f64; 3] {
        [0, 1, 2].map(|c| self.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / self.rgb.len() as f64)
    }

    /// Means over squares of this side, row by row; those at the right and lower border may be smaller.
    fn blocks(&self, side: usize) -> Vec<[f64; 3]> {
        let across = self.width.div_ceil(side);
        let mut sums = vec![([0.0; 3], 0.0); across * self.height.div_ceil(side)];
        for (i, p) in self.rgb.iter().enumerate() {
            let (x, y) = (i % self.width, i / self.width);
            let (sum, count) = &mut sums[y / side * across + x / side];
            *sum = [0, 1, 2].map(|c| sum[c] + f64::from(p[c]));
            *count += 1.0;
        }
        sums.into_iter().map(|(sum, count)| sum.map(|v| v / count)).collect()
    }

    /// How far this picture's blocks are from a reference's: the mean over the channels of the difference,
    /// relative to the mean over the reference's channels plus the floor.
    pub(super) fn block_differences(&self, reference: &Self) -> Blocks {
        let relative = |(a, r): (&[f64; 3], &[f64; 3])| {
            let difference: f64 = (0..3).map(|c| (a[c] - r[c]).abs()).sum();
            difference / (r.iter().sum::<f64>() + 3.0 * FLOOR)
        };
        let (a, r) = (self.blocks(BLOCK), reference.blocks(BLOCK));
        let mut all: Vec<f64> = a.iter().zip(&r).map(relative).collect();
        all.sort_by(f64::total_cmp);
        let at = |share: f64| all[((all.len() - 1) as f64 * share).round() as usize];
        Blocks { median: at(0.5), tenth: at(0.9), max: at(1.0) }
    }

    /// As an sRGB screen shows it; what is brighter than one clips.
    #[expect(clippy::disallowed_methods, reason = "the last bit does not matter on a contact sheet")]
    pub(super) fn to_bytes(&self) -> image::RgbImage {
        let encode = |v: f32| {
            let v = v.clamp(0.0, 1.0);
            let s = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
            (s * 255.0 + 0.5) as u8
        };
        let pixel = |x: u32, y: u32| image::Rgb(self.rgb[y as usize * self.width + x as usize].map(encode));
        image::RgbImage::from_fn(self.width as u32, self.height as u32, pixel)
    }

    /// Where this picture is brighter than the reference (red) or darker (blue), over squares of 4 pixels;
    /// grey where they agree, full colour at 25 %.
    pub(super) fn signed_difference(&self, reference: &Self) -> image::RgbImage {
        const SIDE: usize = 4;
        const FULL: f64 = 0.25;
        let (a, r) = (self.blocks(SIDE), reference.blocks(SIDE));
        let relative: Vec<f64> = a
            .iter()
            .zip(&r)
            .map(|(a, r)| {
                (a.iter().sum::<f64>() - r.iter().sum::<f64>()) / (r.iter().sum::<f64>() + 3.0 * FLOOR)
            })
            .collect();
        let across = self.width.div_ceil(SIDE);
        image::RgbImage::from_fn(self.width as u32, self.height as u32, |x, y| {
            let d = (relative[y as usize / SIDE * across + x as usize / SIDE] / FULL).clamp(-1.0, 1.0);
            let end = if d > 0.0 { [230.0, 40.0, 20.0] } else { [20.0, 90.0, 240.0] };
            image::Rgb(end.map(|e: f64| (128.0 + (e - 128.0) * d.abs()) as u8))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(value: f32) -> Picture {
        Picture { width: 20, height: 12, rgb: vec![[value; 3]; 240] }
    }

    /// A picture that is 10 % brighter differs by 10 % in each block, borders included; the floor counts.
    #[test]
    fn equal_ratios_are_equal_differences() {
        let d = flat(1.1).block_differences(&flat(1.0));
        assert!((d.median - 0.1 / 1.02).abs() < 1e-6 && (d.max - d.median).abs() < 1e-9, "{d:?}");
        assert_eq!(flat(0.4).block_differences(&flat(0.4)).max, 0.0);
    }

    /// One bright pixel is one block's maximum and no one's median; colours that cancel in brightness count.
    #[test]
    fn blocks_are_local() {
        let mut a = flat(1.0);
        a.rgb[0] = [65.0, 1.0, 1.0];
        let d = a.block_differences(&flat(1.0));
        assert!(d.median == 0.0 && (d.max - 1.0 / 3.06).abs() < 1e-6, "{d:?}");
        let swapped = Picture { rgb: vec![[1.5, 0.5, 1.0]; 240], ..flat(0.0) };
        assert!(swapped.block_differences(&flat(1.0)).median > 0.3);
    }

    /// Red is brighter, blue is darker.
    #[test]
    fn the_sign_has_a_colour() {
        let pixel = |a: f32| flat(a).signed_difference(&flat(1.0)).get_pixel(19, 11).0;
        assert!(pixel(2.0)[0] > 200 && pixel(0.5)[2] > 200);
        assert_eq!(pixel(1.0), [128; 3]);
    }
}

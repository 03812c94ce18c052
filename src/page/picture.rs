//! Pixels as a picture inside a page.
//!
//! In: linear pixels. Out: `img` elements that hold their picture, and the exposure that makes one legible. The
//! invariant: a value that is not a number is magenta, and nothing else is.

use super::base64;
use super::text::Text;
use crate::color::Rgb;
use crate::film::Image;
use crate::output::{Format, Tone, WriteOptions, encode};

/// What stands for a value that is not a number; linear.
pub(crate) const ODD: Rgb = Rgb::new(1.0, 0.0, 1.0);

/// Stops by which pixels are raised: halfway between what brings the median to a dark grey and what brings the
/// 95th percentile below white. Black pixels do not count.
pub(crate) fn exposure(pixels: &[Rgb]) -> f32 {
    let mut lit: Vec<f32> =
        pixels.iter().map(|c| c.luminance()).filter(|l| l.is_finite() && *l > 0.0).collect();
    lit.sort_by(f32::total_cmp);
    let quantile = |q: usize| lit.get((lit.len() * q / 100).min(lit.len().saturating_sub(1))).copied();
    let (Some(median), Some(high)) = (quantile(50), quantile(95)) else { return 0.0 };
    let stops = 0.5 * (libm::log2f(0.2) - libm::log2f(median) + libm::log2f(0.8) - libm::log2f(high));
    stops.clamp(-100.0, 100.0)
}

/// The same for a part of the light, which may be a small bright spot with long tails: half of its light comes
/// from pixels that become brighter than a middle grey.
pub(crate) fn exposure_of_part(pixels: &[Rgb]) -> f32 {
    let mut lit: Vec<f32> =
        pixels.iter().map(|c| c.luminance()).filter(|l| l.is_finite() && *l > 0.0).collect();
    lit.sort_by(f32::total_cmp);
    let all: f64 = lit.iter().map(|&l| f64::from(l)).sum();
    let mut below = 0.0;
    let half = lit.into_iter().find(|&l| {
        below += f64::from(l);
        below >= 0.5 * all
    });
    half.map_or(0.0, |l| (libm::log2f(0.4) - libm::log2f(l)).clamp(-100.0, 100.0))
}

/// Pixels of width and height as a PNG, in an address that holds it; or why there is none.
pub(crate) fn data([width, height]: [usize; 2], pixels: Vec<Rgb>, tone: Tone) -> Result<String, String> {
    let odd = ODD * libm::exp2f(-tone.exposure);
    let rgb = pixels.into_iter().map(|c| if c.is_finite() { c } else { odd }).collect();
    let image = Image { width: width as u32, height: height as u32, rgb, ..Image::default() };
    let png = encode(&image, Format::Png, &WriteOptions { tone })?;
    Ok(format!("data:image/png;base64,{}", base64::encode(&png)))
}

/// Pixels as a picture of width and height: an `img` element, or why there is none.
pub(crate) fn img([width, height]: [usize; 2], pixels: Vec<Rgb>, tone: Tone, alt: &str) -> String {
    match data([width, height], pixels, tone) {
        Ok(data) => {
            format!("<img src=\"{data}\" width=\"{width}\" height=\"{height}\" alt=\"{}\">", Text(alt))
        }
        Err(message) => format!("<p class=\"missing\">No picture: {}</p>", Text(&message)),
    }
}

/// The usual curve after so many stops.
pub(crate) fn raised(stops: f32) -> Tone {
    Tone { exposure: stops, ..Tone::default() }
}

/// Sum of luminance; what is not a number counts nothing.
pub(crate) fn total(pixels: &[Rgb]) -> f64 {
    pixels.iter().map(|c| f64::from(c.luminance())).filter(|l| l.is_finite()).sum()
}

/// A layer of three channels `NAME.R`, `NAME.G`, `NAME.B`, one value a pixel.
pub(crate) fn layer(image: &Image, name: &str) -> Option<Vec<Rgb>> {
    let channel = |suffix: &str| {
        let mut all = image.layers.iter().flat_map(|l| &l.channels);
        let wanted = |n: &str| n.strip_prefix(name).is_some_and(|rest| rest == suffix);
        let found = all.find(|(n, _)| wanted(n)).map(|(_, values)| values);
        found.filter(|values| values.len() == image.rgb.len())
    };
    let [r, g, b] = [channel(".R")?, channel(".G")?, channel(".B")?];
    Some((0..r.len()).map(|i| Rgb::new(r[i], g[i], b[i])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dim picture is raised until it can be seen, a bright one lowered; black and broken pixels do not matter.
    #[test]
    fn exposure_makes_legible() {
        let grey = |v: f32| vec![Rgb::grey(v); 50];
        let level = |v: f32| v * libm::exp2f(exposure(&grey(v)));
        for v in [1e-6, 0.4, 3e4] {
            assert!((0.2..0.8).contains(&level(v)), "{v} becomes {}", level(v));
        }
        assert_eq!(exposure(&[]), 0.0);
        let mut mixed = grey(0.5);
        mixed.extend([Rgb::BLACK, Rgb::grey(f32::NAN)].repeat(100));
        assert_eq!(exposure(&mixed), exposure(&grey(0.5)));
        assert!((exposure_of_part(&mixed) - libm::log2f(0.8)).abs() < 1e-6);
        let mut spot = vec![Rgb::grey(1e-4); 5000];
        spot.extend(grey(2.0));
        assert!(
            (exposure_of_part(&spot) - libm::log2f(0.2)).abs() < 1e-6,
            "the tail of a spot does not count"
        );
    }

    /// Wrong sizes make no picture, and no panic.
    #[test]
    fn wrong_sizes_are_left_out() {
        assert!(img([2, 2], vec![Rgb::BLACK; 3], Tone::default(), "x").contains("No picture"));
        assert!(img([0, 0], Vec::new(), Tone::default(), "x").contains("No picture"));
    }
}

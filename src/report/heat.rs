//! Difference images for people.
//!
//! In: two linear images of equal size. Out: an image whose pixels are display-encoded values, to be
//! written with the linear tone curve.

use super::CompareError;
use super::compare::check_sizes;
use super::flip::flip;
use crate::color::Rgb;
use crate::film::Image;
use crate::output::Tone;

/// FLIP per pixel, from black (no difference seen) through red and yellow to white (one).
///
/// # Errors
/// The sizes differ.
pub fn flip_map(a: &Image, reference: &Image) -> Result<Image, CompareError> {
    check_sizes(a, reference)?;
    let colours = display_flip(a, reference).into_iter().map(heat).collect();
    Ok(like(a, colours))
}

/// Luminance difference relative to the reference (with the floor of the error E): red where `a` is
/// brighter, blue where it is darker, black where they agree; full colour at 25 %.
///
/// # Errors
/// The sizes differ.
pub fn difference_map(a: &Image, reference: &Image) -> Result<Image, CompareError> {
    const FULL: f32 = 0.25;
    check_sizes(a, reference)?;
    let sum: f64 = reference.rgb.iter().map(|r| f64::from(r.luminance())).sum();
    let floor = 0.1 * (sum / reference.rgb.len().max(1) as f64) as f32;
    let colour = |(a, r): (&Rgb, &Rgb)| {
        let (a, r) = (a.luminance(), r.luminance());
        let scale = (r * r + floor * floor).sqrt();
        let d = if a == r { 0.0 } else { ((a - r) / scale / FULL).clamp(-1.0, 1.0) };
        let strength = d.abs().sqrt();
        if d > 0.0 { Rgb::new(strength, 0.25 * d, 0.0) } else { Rgb::new(0.0, 0.45 * -d, strength) }
    };
    Ok(like(a, a.rgb.iter().zip(&reference.rgb).map(colour).collect()))
}

/// FLIP of the two pictures as an sRGB screen shows them.
pub(super) fn display_flip(a: &Image, reference: &Image) -> Vec<f32> {
    let picture = |i: &Image| i.rgb.iter().map(|&c| Tone::default().encode(c)).collect::<Vec<_>>();
    flip(&picture(a), &picture(reference), a.width as usize)
}

fn like(image: &Image, rgb: Vec<Rgb>) -> Image {
    let Image { width, height, origin, full_size, .. } = *image;
    Image { width, height, origin, full_size, rgb, ..Image::default() }
}

/// Black, dark red, orange, pale yellow, white: each channel rises in its own third.
fn heat(v: f32) -> Rgb {
    Rgb::new(v * 2.5, v * 1.9 - 0.55, v * 3.0 - 2.0).map(|v| v.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Image {
        let rgb = values.iter().map(|&v| Rgb::grey(v)).collect();
        let width = values.len() as u32;
        Image { width, height: 1, full_size: [width, 1], rgb, ..Image::default() }
    }

    /// Brighter is red, darker is blue, equal is black.
    #[test]
    fn the_sign_has_a_colour() {
        let map = difference_map(&grey(&[1.1, 0.9, 1.0, 9.0]), &grey(&[1.0; 4])).unwrap();
        let [brighter, darker, equal, far] = map.rgb[..] else { panic!() };
        assert!(brighter.r > 0.5 && brighter.b == 0.0);
        assert!(darker.b > 0.5 && darker.r == 0.0);
        assert_eq!((equal, far.r), (Rgb::BLACK, 1.0));
    }

    /// More difference never looks darker.
    #[test]
    fn heat_is_monotone() {
        let colours: Vec<_> = (0..=100).map(|i| heat(i as f32 / 100.0)).collect();
        assert!(colours.windows(2).all(|w| (w[1] - w[0]).min_channel() >= 0.0 && w[1] != w[0]));
        assert_eq!((colours[0], colours[100]), (Rgb::BLACK, Rgb::WHITE));
    }

    #[test]
    fn sizes_must_agree() {
        assert!(flip_map(&grey(&[1.0]), &grey(&[1.0, 2.0])).is_err());
    }
}

//! The error of an image against a reference.
//!
//! In: two lists of linear pixels of equal length. Out: one number. An empty list has no error: zero.

use crate::color::Rgb;

/// Share of the reference's mean luminance, c / mean R, that is added in squares to what differences are divided by, so
/// that dark pixels do not count for everything.
pub const ERROR_FLOOR: f64 = 0.1;

/// The error E that every statement of this program about accuracy means, over luminance:
///
/// ```text
/// E = sqrt( mean over pixels of (I - R)^2 / (R^2 + (0.1 mean R)^2) )
/// ```
///
/// It is relative to each pixel's own brightness, with a floor at a tenth of the reference's mean, and so
/// does not change with exposure. Infinite where the reference is black and the image is not.
#[must_use]
pub fn relative_error(image: &[Rgb], reference: &[Rgb]) -> f64 {
    let floor = ERROR_FLOOR * mean(reference.iter().map(|r| luminance(*r)));
    let term = |(i, r): (&Rgb, &Rgb)| {
        let (i, r) = (luminance(*i), luminance(*r));
        quotient((i - r) * (i - r), r * r + floor * floor)
    };
    mean(image.iter().zip(reference).map(term)).sqrt()
}

/// relMSE, as renderers' papers have it: mean over pixels and channels of (I - R)^2 / (R^2 + 0.01)
/// (Rousselle et al., "Adaptive Sampling and Reconstruction using Greedy Error Minimization", ACM TOG
/// 30(6), 2011). The absolute 0.01 makes it depend on exposure.
#[must_use]
pub fn relative_mse(image: &[Rgb], reference: &[Rgb]) -> f64 {
    mean(channels(image, reference).map(|(i, r)| (i - r) * (i - r) / (r * r + 0.01)))
}

/// Root of the mean squared difference, over pixels and channels.
#[must_use]
pub fn root_mean_square_error(image: &[Rgb], reference: &[Rgb]) -> f64 {
    mean(channels(image, reference).map(|(i, r)| (i - r) * (i - r))).sqrt()
}

/// Luminance of a linear Rec. 709 colour, as every error has it.
#[must_use]
pub fn luminance(c: Rgb) -> f64 {
    luminance_of(c.to_array().map(f64::from))
}

/// The same of red, green and blue.
#[must_use]
pub fn luminance_of([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn channels<'a>(image: &'a [Rgb], reference: &'a [Rgb]) -> impl Iterator<Item = (f64, f64)> + 'a {
    let pair = |(i, r): (&'a Rgb, &'a Rgb)| (0..3).map(move |c| (f64::from(i[c]), f64::from(r[c])));
    image.iter().zip(reference).flat_map(pair)
}

fn quotient(numerator: f64, denominator: f64) -> f64 {
    if numerator == 0.0 { 0.0 } else { numerator / denominator }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (mut n, mut sum) = (0u64, 0.0);
    for v in values {
        (n, sum) = (n + 1, sum + v);
    }
    if n == 0 { 0.0 } else { sum / n as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: [Rgb; 2] = [Rgb::grey(1.0), Rgb::grey(3.0)];

    /// By hand: mean 2, floor 0.2, differences 0.1 and 0.
    #[test]
    fn values_by_hand() {
        let image = [Rgb::grey(1.1), Rgb::grey(3.0)];
        let check = |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-6, "{found}");
        check(relative_error(&image, &R), (0.01 / 1.04 / 2.0f64).sqrt());
        check(relative_mse(&image, &R), 0.01 / 1.01 / 2.0);
        check(root_mean_square_error(&image, &R), (0.01 / 2.0f64).sqrt());
        assert_eq!(relative_error(&R, &R), 0.0);
    }

    /// E does not change when both images become brighter; relMSE does, which is why E is the one used.
    #[test]
    fn only_the_relative_error_ignores_exposure() {
        let image = [Rgb::new(1.1, 0.9, 1.0), Rgb::new(2.8, 3.3, 3.0)];
        let (bright_image, bright_r) = (image.map(|c| c * 1024.0), R.map(|c| c * 1024.0));
        assert_eq!(relative_error(&image, &R), relative_error(&bright_image, &bright_r));
        assert_ne!(relative_mse(&image, &R), relative_mse(&bright_image, &bright_r));
    }

    #[test]
    fn black_images_are_equal() {
        assert_eq!(relative_error(&[Rgb::BLACK], &[Rgb::BLACK]), 0.0);
        assert_eq!(relative_error(&[Rgb::WHITE], &[Rgb::BLACK]), f64::INFINITY);
        assert_eq!(relative_error(&[], &[]), 0.0);
    }
}

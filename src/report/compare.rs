//! Two images: how far apart, and whether noise explains it.
//!
//! In: an image and a reference of the same size. Out: error measures, ratios of means, FLIP, and a
//! verdict. Where both images carry the variance of each pixel's mean, the verdict is statistical: means
//! of the whole image and of 16x16 tiles, per channel, against their standard errors; the significance is
//! shared over all of them after Šidák, and is 0.001 for the whole comparison. Otherwise any difference
//! counts.
//!
//! Pixels are taken as independent, so the variance of a mean is the sum of the pixels' variances. Those
//! are estimates from a few replications each: a pixel whose rare bright sample came up dominates its
//! tile's variance, and then so few degrees of freedom stand behind it that a normal distribution would
//! raise false alarms. p-values therefore come from Student's t with Satterthwaite's degrees of freedom
//! (Biometrics Bulletin 2(6), 1946). Works badly below about 16 samples a pixel, where means of rare
//! events are far from normal.

use std::fmt;

use serde::Serialize;

use super::heat::display_flip;
use crate::color::Rgb;
use crate::film::Image;
use crate::stats;

/// Probability of calling two renders of one scene different.
const SIGNIFICANCE: f64 = 0.001;
/// Side of a tile, pixels.
const TILE: usize = 16;
/// Degrees of freedom of one pixel's variance where the image does not say: four replications.
const FREEDOM: f64 = 3.0;

/// Why two images cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// They differ in size.
    #[error("the images differ in size: found {} and {}, expected the same", size(.a), size(.reference))]
    Sizes {
        /// Width and height of the image.
        a: [u32; 2],
        /// Width and height of the reference.
        reference: [u32; 2],
    },
    /// They have no pixels.
    #[error("the images have no pixels")]
    Empty,
    /// A value is not a number.
    #[error("{count} pixels of {which} are not finite")]
    NotFinite {
        /// `the image` or `the reference`.
        which: &'static str,
        /// How many.
        count: usize,
    },
}

fn size([w, h]: &[u32; 2]) -> String {
    format!("{w}x{h}")
}

/// What the comparison of two images says.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Name and version of this form: `epsilux.compare/1`.
    pub schema: &'static str,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The error E (see [`stats::relative_error`]); infinite values appear as null.
    pub error: f64,
    /// relMSE (see [`stats::relative_mse`]).
    pub rel_mse: f64,
    /// Root of the mean squared difference.
    pub rmse: f64,
    /// Mean FLIP of the two as sRGB pictures, [0, 1].
    pub flip: f64,
    /// Red, green and blue.
    pub channels: [Channel; 3],
    /// The test over tiles, where both images carry variance.
    pub tiles: Option<Tiles>,
    /// What it comes to.
    pub verdict: Verdict,
    /// Probability of differences at least as large from noise alone, where both images carry variance.
    pub p: Option<f64>,
    /// What the verdict rests on.
    pub basis: Basis,
}

/// One channel over the whole image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Channel {
    /// Mean of the image.
    pub mean: f64,
    /// Mean of the reference.
    pub reference: f64,
    /// The first over the second; none where the second is zero.
    pub ratio: Option<f64>,
    /// Half the width of the 95 % interval of the ratio, where both images carry variance.
    pub ratio_interval: Option<f64>,
    /// Difference of the means over its standard error, where both images carry variance.
    pub z: Option<f64>,
}

/// The test over tiles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tiles {
    /// Side of a tile, pixels; those at the right and lower border may be smaller.
    pub side: usize,
    /// How many tiles.
    pub count: usize,
    /// Left, top of the tile that differs most.
    pub worst: [usize; 2],
    /// Its difference over its standard error, in the channel where that is most significant.
    pub worst_z: f64,
    /// Probability of such a tile from noise alone, over all tiles and channels.
    pub p: f64,
}

/// What a comparison comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[must_use = "a verdict does nothing until it is reported"]
pub enum Verdict {
    /// Every colour is the same number.
    Identical,
    /// Noise explains the difference.
    NoSignificantDifference,
    /// It does not, or there is no noise to explain it.
    Differs,
}

/// What a verdict rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// Both images carry a variance per pixel.
    Variance,
    /// At least one does not, or does not know it: any difference counts.
    Values,
}

/// Compares an image with a reference.
///
/// # Errors
/// The sizes differ, there are no pixels, or a colour is not finite.
pub fn compare(a: &Image, reference: &Image) -> Result<Comparison, CompareError> {
    check_sizes(a, reference)?;
    for (which, image) in [("the image", a), ("the reference", reference)] {
        let count = image.rgb.iter().filter(|c| !c.is_finite()).count();
        if count > 0 {
            return Err(CompareError::NotFinite { which, count });
        }
    }
    let map = display_flip(a, reference);
    let differences = Differences::new(a, reference);
    let whole = Region { x: 0, y: 0, width: a.width as usize, height: a.height as usize };
    let tests = differences.as_ref().map(|d| [0, 1, 2].map(|c| d.test(whole, c)));
    let tiles = differences.as_ref().map(Differences::test_tiles);
    let p = tests.zip(tiles).map(|(tests, tiles)| {
        let channels = stats::sidak(least(tests.iter().map(|t| t.p)), tests.len());
        stats::sidak(channels.min(tiles.p), 2)
    });
    let verdict = match p {
        _ if a.rgb == reference.rgb => Verdict::Identical,
        Some(p) if p >= SIGNIFICANCE => Verdict::NoSignificantDifference,
        _ => Verdict::Differs,
    };
    Ok(Comparison {
        schema: "epsilux.compare/1",
        size: [a.width, a.height],
        error: stats::relative_error(&a.rgb, &reference.rgb),
        rel_mse: stats::relative_mse(&a.rgb, &reference.rgb),
        rmse: stats::root_mean_square_error(&a.rgb, &reference.rgb),
        flip: map.iter().map(|&v| f64::from(v)).sum::<f64>() / map.len() as f64,
        channels: std::array::from_fn(|c| channel(a, reference, c, tests.map(|t| t[c]))),
        tiles,
        verdict,
        p,
        basis: if p.is_some() { Basis::Variance } else { Basis::Values },
    })
}

/// The sizes agree, and the pixels fill them.
pub(super) fn check_sizes(a: &Image, reference: &Image) -> Result<(), CompareError> {
    let size = |i: &Image| [i.width, i.height];
    let pixels = a.width as usize * a.height as usize;
    if size(a) != size(reference) || a.rgb.len() != reference.rgb.len() {
        return Err(CompareError::Sizes { a: size(a), reference: size(reference) });
    }
    if pixels == 0 || a.rgb.len() != pixels { Err(CompareError::Empty) } else { Ok(()) }
}

fn channel(a: &Image, reference: &Image, c: usize, test: Option<Test>) -> Channel {
    let mean =
        |image: &Image| image.rgb.iter().map(|p| f64::from(p[c])).sum::<f64>() / image.rgb.len() as f64;
    let (mean, reference) = (mean(a), mean(reference));
    let relative = |v: f64| (reference != 0.0).then(|| v / reference);
    let half_width = |t: Test| relative(1.96 * t.standard_error / a.rgb.len() as f64).map(f64::abs);
    Channel {
        mean,
        reference,
        ratio: relative(mean),
        ratio_interval: test.and_then(half_width),
        z: test.map(|t| t.z),
    }
}

/// A rectangle of pixels.
#[derive(Clone, Copy)]
struct Region {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

/// A sum of differences against its standard error.
#[derive(Clone, Copy)]
struct Test {
    z: f64,
    p: f64,
    standard_error: f64,
}

/// Two images that both know their variances.
struct Differences<'a> {
    a: &'a Image,
    reference: &'a Image,
    variances: [&'a [Rgb]; 2],
    freedoms: [f64; 2],
}

impl<'a> Differences<'a> {
    /// `None` where a variance is missing, or not known for some pixel.
    fn new(a: &'a Image, reference: &'a Image) -> Option<Self> {
        let variance = |image: &'a Image| {
            let variance = image.variance.as_deref()?;
            let known = variance.len() == image.rgb.len() && variance.iter().all(|v| v.is_finite());
            known.then_some(variance)
        };
        let freedom = |image: &Image| {
            let stated = image.attributes.iter().find(|(name, _)| name == "replications");
            let replications = stated.and_then(|(_, v)| v.parse::<f64>().ok());
            replications.map_or(FREEDOM, |k| (k - 1.0).max(1.0))
        };
        let variances = [variance(a)?, variance(reference)?];
        Some(Self { a, reference, variances, freedoms: [freedom(a), freedom(reference)] })
    }

    /// Tests whether the sum of one channel over a region is the same in both images.
    fn test(&self, region: Region, c: usize) -> Test {
        // A mean is stored as f32, which rounds it by up to 2^-24 of itself.
        const ROUNDING: f64 = (f32::EPSILON as f64) * (f32::EPSILON as f64) / 4.0;
        let (mut difference, mut variance, mut squares) = (0.0, 0.0, 0.0);
        for y in region.y..region.y + region.height {
            for i in y * self.a.width as usize + region.x..y * self.a.width as usize + region.x + region.width
            {
                let pair = [self.a, self.reference].map(|image| f64::from(image.rgb[i][c]));
                difference += pair[0] - pair[1];
                variance += ROUNDING * (pair[0] * pair[0] + pair[1] * pair[1]);
                for (of, freedom) in self.variances.iter().zip(self.freedoms) {
                    let v = f64::from(of[i][c]).max(0.0);
                    variance += v;
                    // An unbiased estimate of the variance of this variance, over two.
                    squares += v * v / (freedom + 2.0);
                }
            }
        }
        if difference == 0.0 {
            return Test { z: 0.0, p: 1.0, standard_error: variance.sqrt() };
        }
        let z = difference / variance.sqrt();
        let freedom = if squares > 0.0 { variance * variance / squares } else { f64::INFINITY };
        Test { z, p: stats::student_two_sided(z, freedom), standard_error: variance.sqrt() }
    }

    fn test_tiles(&self) -> Tiles {
        let (width, height) = (self.a.width as usize, self.a.height as usize);
        let mut count = 0;
        let mut worst = ([0, 0], Test { z: 0.0, p: 1.0, standard_error: 0.0 });
        for y in (0..height).step_by(TILE) {
            for x in (0..width).step_by(TILE) {
                count += 1;
                let region = Region { x, y, width: TILE.min(width - x), height: TILE.min(height - y) };
                for test in [0, 1, 2].map(|c| self.test(region, c)) {
                    if test.p < worst.1.p {
                        worst = ([x, y], test);
                    }
                }
            }
        }
        Tiles { side: TILE, count, worst: worst.0, worst_z: worst.1.z, p: stats::sidak(worst.1.p, 3 * count) }
    }
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(1.0, f64::min)
}

/// A probability for people: three decimals, or its order of magnitude.
#[must_use]
pub fn probability(p: f64) -> String {
    if p < 5e-4 { format!("{p:.0e}") } else { format!("{p:.3}") }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Identical => "identical",
            Self::NoSignificantDifference => "no significant difference",
            Self::Differs => "differs",
        })
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [w, h] = self.size;
        writeln!(f, "size      {w}x{h}")?;
        writeln!(f, "error     {:.4} %   (E: relative to each pixel, luminance)", 100.0 * self.error)?;
        writeln!(f, "relMSE    {:.6}", self.rel_mse)?;
        writeln!(f, "RMSE      {:.6}", self.rmse)?;
        writeln!(f, "FLIP      {:.4}   (as sRGB pictures, 67 pixels per degree)", self.flip)?;
        for (name, c) in ["red", "green", "blue"].into_iter().zip(&self.channels) {
            write!(f, "{name:<9} mean {:.6}, reference {:.6}", c.mean, c.reference)?;
            if let Some(ratio) = c.ratio {
                write!(f, ", ratio {ratio:.5}")?;
            }
            if let Some(interval) = c.ratio_interval {
                write!(f, " +- {interval:.5}")?;
            }
            if let Some(z) = c.z {
                write!(f, ", z {z:+.2}")?;
            }
            writeln!(f)?;
        }
        if let Some(t) = &self.tiles {
            let [x, y] = t.worst;
            let (side, n, z) = (t.side, t.count, t.worst_z);
            let p = probability(t.p);
            writeln!(f, "tiles     {n} of {side}x{side}, the worst at {x},{y}: z {z:+.2}, p {p} over all")?;
        }
        write!(f, "verdict   {}", self.verdict)?;
        match (self.verdict, self.p) {
            (Verdict::Identical, _) => Ok(()),
            (_, Some(p)) => write!(f, " (p {})", probability(p)),
            (_, None) => f.write_str(" (without a variance in both images, any difference counts)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mix64;

    const SIDE: u32 = 48;
    const K: u64 = 4;

    /// A uniform number in (0, 1).
    fn uniform(seed: u64, i: u64) -> f64 {
        ((mix64(mix64(seed) ^ i) >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    /// A noisy image as a renderer makes it: each pixel the mean of four replications of `per` samples
    /// each, with the variance of that mean. A sample is `1 / share` times the colour with probability
    /// `share`, else black: a small share makes fireflies.
    fn noisy(seed: u64, per: u64, share: f64, colour: impl Fn(usize) -> f64) -> Image {
        let pixels = (SIDE * SIDE) as usize;
        let mut image = Image { width: SIDE, height: SIDE, full_size: [SIDE; 2], ..Image::default() };
        let mut variance = Vec::new();
        for pixel in 0..pixels {
            let mut value = [0.0f32; 3];
            let mut spread = [0.0f32; 3];
            for c in 0..3 {
                let mut moments = stats::Moments::default();
                for k in 0..K {
                    let address = |s: u64| ((pixel as u64 * 3 + c as u64) * K + k) * per + s;
                    let hits = (0..per).filter(|&s| uniform(seed, address(s)) < share).count();
                    moments.add(colour(pixel) * hits as f64 / (per as f64 * share));
                }
                value[c] = moments.mean as f32;
                spread[c] = moments.variance_of_mean() as f32;
            }
            image.rgb.push(Rgb::from(value));
            variance.push(Rgb::from(spread));
        }
        image.variance = Some(variance);
        image
    }

    fn flat(_: usize) -> f64 {
        0.5
    }

    /// The referee is refereed: noise alone is called a difference about as often as promised. With 60
    /// pairs and a rate of 0.001 even two alarms would have a probability of 0.002.
    #[test]
    fn noise_alone_is_no_difference() {
        for share in [0.5, 0.05] {
            let alarms = (0..60)
                .filter(|s| {
                    let (a, b) = (noisy(2 * s, 8, share, flat), noisy(2 * s + 1, 8, share, flat));
                    compare(&a, &b).unwrap().verdict == Verdict::Differs
                })
                .count();
            assert!(alarms <= 1, "{alarms} of 60 at share {share}");
        }
    }

    /// A change of one per cent over the whole image is caught by the means, where noise allows it (512 samples).
    #[test]
    fn one_per_cent_is_caught() {
        let c = compare(&noisy(1, 128, 0.5, |_| 0.505), &noisy(2, 128, 0.5, flat)).unwrap();
        assert_eq!(c.verdict, Verdict::Differs);
        for channel in c.channels {
            let (ratio, half) = (channel.ratio.unwrap(), channel.ratio_interval.unwrap());
            assert!((ratio - 1.01).abs() < 2.5 * half && half < 0.006, "{ratio} +- {half}");
        }
    }

    /// A change in one tile that leaves the mean of the image alone is caught, and located.
    #[test]
    fn a_tile_is_caught() {
        let spoiled = |pixel: usize| {
            let (x, y) = (pixel % SIDE as usize, pixel / SIDE as usize);
            match (x / 16, y / 16) {
                (1, 2) => 0.55,
                (0, 0) => 0.45,
                _ => 0.5,
            }
        };
        let c = compare(&noisy(1, 16, 0.5, spoiled), &noisy(2, 16, 0.5, flat)).unwrap();
        assert_eq!(c.verdict, Verdict::Differs);
        let tiles = c.tiles.unwrap();
        assert!(tiles.worst == [16, 32] || tiles.worst == [0, 0], "{tiles:?}");
        assert_eq!(tiles.count, 9);
    }

    /// Without variance, or where it is not known, any difference counts and no probability is claimed.
    #[test]
    fn without_variance_values_decide() {
        let a = noisy(1, 8, 0.5, flat);
        let plain = Image { variance: None, ..noisy(2, 8, 0.5, flat) };
        let c = compare(&a, &plain).unwrap();
        assert_eq!((c.verdict, c.p, c.basis), (Verdict::Differs, None, Basis::Values));
        let unknown = Image { variance: Some(vec![Rgb::grey(f32::INFINITY); a.rgb.len()]), ..a.clone() };
        assert_eq!(compare(&unknown, &a).unwrap().verdict, Verdict::Identical);
        assert_eq!(compare(&unknown, &plain).unwrap().basis, Basis::Values);
    }

    /// An image does not differ from itself in any measure.
    #[test]
    fn identical_images() {
        let a = noisy(1, 8, 0.5, flat);
        let c = compare(&a, &a).unwrap();
        assert_eq!((c.verdict, c.p), (Verdict::Identical, Some(1.0)));
        assert_eq!([c.error, c.rel_mse, c.rmse, c.flip], [0.0; 4]);
        assert_eq!(c.channels[1].ratio, Some(1.0));
    }

    /// Where there is no noise at all, rounding to f32 is forgiven and anything more is not.
    #[test]
    fn pixels_without_noise() {
        let image = |v: f32| Image {
            width: 4,
            height: 4,
            full_size: [4, 4],
            rgb: vec![Rgb::grey(v); 16],
            variance: Some(vec![Rgb::BLACK; 16]),
            ..Image::default()
        };
        let verdict = |b: f32| compare(&image(1.0), &image(b)).unwrap().verdict;
        assert_eq!(verdict(1.0 - f32::EPSILON / 2.0), Verdict::NoSignificantDifference);
        assert_eq!(verdict(1.0001), Verdict::Differs);
    }

    #[test]
    fn unusable_images_are_errors() {
        let image = |w: u32, v: f32| Image {
            width: w,
            height: 1,
            rgb: vec![Rgb::grey(v); w as usize],
            ..Image::default()
        };
        let message = |a: &Image, b: &Image| compare(a, b).unwrap_err().to_string();
        assert_eq!(
            message(&image(2, 0.0), &image(3, 0.0)),
            "the images differ in size: found 2x1 and 3x1, expected the same"
        );
        assert_eq!(message(&image(0, 0.0), &image(0, 0.0)), "the images have no pixels");
        assert_eq!(message(&image(2, f32::NAN), &image(2, 0.0)), "2 pixels of the image are not finite");
    }

    /// What people and programs read.
    #[test]
    fn the_report_is_readable() {
        let (mut a, mut b) = (noisy(1, 8, 0.5, |_| 0.55), noisy(2, 8, 0.5, flat));
        insta::assert_snapshot!(compare(&a, &b).unwrap());
        (a.variance, b.variance) = (None, None);
        insta::assert_snapshot!(serde_json::to_string_pretty(&compare(&a, &b).unwrap()).unwrap());
    }
}

//! Which part of the light comes from few, bright samples.
//!
//! In: the luminance of each sample. Out: exact sums by octave, and from them the share of the samples that carries
//! the most light beyond what their own pixels are like. Integers add up in any order, as in the rest of the film.
//!
//! An octave is a power of two of luminance: the exponent of the `f32`. What photons bring to a pixel directly is a
//! part of the sample of its pass; here each part counts for itself in the sum of its octave, and none as a sample, so
//! that a rare bright photon is seen and the many faint ones that most pixels get are not.
//!
//! A lamp in view is bright too, and no reason to doubt: its pixels are as bright as its samples. So the light of a
//! whole pixel is subtracted from what samples of an octave and above carry where the pixel's mean is not far below
//! that octave. What remains is a lower bound of the light that came in samples far brighter than their pixel. Works
//! badly where a pixel has fewer samples than [`FAR`] in octaves says: its one bright sample is then its mean.

use super::{Film, FixedPoint};

/// Octaves by which a sample has to be brighter than its pixel, to be far brighter.
const FAR: usize = 3;
/// Exponents of an `f32`.
const OCTAVES: usize = 256;
/// Samples are few up to this share of all.
const FEW: f64 = 0.01;

/// Samples and their light by octave.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Octaves {
    pub(super) counts: Vec<u64>,
    /// In the format of radiance.
    pub(super) sums: Vec<i128>,
}

impl Octaves {
    /// Bytes of [`Self::to_bytes`].
    pub(super) const BYTES: usize = OCTAVES * 24;

    pub(super) fn new() -> Self {
        Self { counts: vec![0; OCTAVES], sums: vec![0; OCTAVES] }
    }

    /// Adds a luminance, which is a sample or (`samples` 0) a part of one.
    #[inline]
    pub(super) fn add(&mut self, luminance: f32, samples: u64, format: FixedPoint) {
        let octave = octave(luminance);
        self.counts[octave] += samples;
        self.sums[octave] += format.encode(luminance);
    }

    pub(super) fn merge(&mut self, other: &Self) {
        for (n, other) in self.counts.iter_mut().zip(&other.counts) {
            *n += other;
        }
        for (sum, other) in self.sums.iter_mut().zip(&other.sums) {
            *sum += other;
        }
    }

    pub(super) fn to_bytes(&self) -> impl Iterator<Item = u8> + '_ {
        let counts = self.counts.iter().flat_map(|n| n.to_le_bytes());
        counts.chain(self.sums.iter().flat_map(|s| s.to_le_bytes()))
    }

    /// From [`Self::BYTES`] bytes; those that are missing are taken for zeros.
    pub(super) fn from_bytes(bytes: &[u8]) -> Self {
        let (counts, sums) = bytes.split_at((OCTAVES * 8).min(bytes.len()));
        let mut octaves = Self::new();
        for (n, bytes) in octaves.counts.iter_mut().zip(counts.as_chunks().0) {
            *n = u64::from_le_bytes(*bytes);
        }
        for (sum, bytes) in octaves.sums.iter_mut().zip(sums.as_chunks().0) {
            *sum = i128::from_le_bytes(*bytes);
        }
        octaves
    }
}

/// The exponent of a luminance that is not negative.
#[inline]
fn octave(luminance: f32) -> usize {
    (luminance.to_bits() >> 23) as usize & (OCTAVES - 1)
}

/// Few samples that carry much light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tail {
    /// Their share of all samples, [0, 0.01].
    pub samples: f64,
    /// Their share of the light, [0, 1].
    pub light: f64,
}

impl Film {
    /// The hundredth of the samples, or fewer, that carries the most light, counting only what is far brighter than
    /// its pixel; `None` where there is no such light.
    #[must_use]
    pub fn tail(&self) -> Option<Tail> {
        let total: u64 = self.octaves.counts.iter().sum();
        let light: f64 = self.octaves.sums.iter().map(|&s| s as f64).sum();
        // What whole pixels hold, by the octave of their mean.
        let (mut counts, mut sums) = (vec![0u64; OCTAVES], vec![0.0f64; OCTAVES]);
        let k = self.layout.replications as usize;
        for (cells, n) in self.sums.chunks(k).zip(self.counts.chunks(k)) {
            let n: u32 = n.iter().sum();
            let of = |c: usize| self.layout.radiance.mean(cells.iter().map(|s| s[c]).sum(), n);
            let mean = crate::stats::luminance_of([of(0), of(1), of(2)]);
            let octave = octave(mean as f32);
            counts[octave] += u64::from(n);
            sums[octave] += mean * f64::from(n);
        }
        let unit = self.layout.radiance.mean(1 << 70, 1) / (1u128 << 70) as f64;
        let (mut few, mut bright) = (0i128, 0.0);
        let mut best: Option<Tail> = None;
        for o in (FAR..OCTAVES).rev() {
            few += i128::from(self.octaves.counts[o]) - i128::from(counts[o - FAR]);
            bright += self.octaves.sums[o] as f64 * unit - sums[o - FAR];
            // The brightest pixels are above the first octave that is looked at.
            let found = Tail { samples: few as f64 / total.max(1) as f64, light: bright / (light * unit) };
            let more = best.is_none_or(|b| found.light > b.light);
            if (0.0..=FEW).contains(&found.samples) && found.light > 0.0 && more {
                best = Some(found);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::{FilmLayout, LightLayer, Sample};

    fn film(radiance: impl Fn(usize, u32) -> f32) -> Film {
        let mut film = Film::new(FilmLayout::plain([64, 64]));
        for pass in 0..64 {
            for pixel in 0..64 * 64 {
                let radiance = Rgb::grey(radiance(pixel, pass));
                film.add(pixel, pass, &Sample { radiance, ..Sample::default() }).expect("a radiance");
            }
        }
        film
    }

    /// By hand: each sample is 1, but in every 32nd pixel one of 64 is 1001.
    #[test]
    fn few_samples_that_carry_much_are_found() {
        let found = film(|pixel, pass| if pixel % 32 == 0 && pass == 9 { 1001.0 } else { 1.0 });
        let tail = found.tail().expect("a tail");
        let few = 1.0 / (32.0 * 64.0);
        assert!((tail.samples - few).abs() < 1e-12, "{tail:?}");
        assert!((tail.light - 1001.0 * few / (1.0 + 1000.0 * few)).abs() < 1e-6, "{tail:?}");
    }

    /// Guards that what is bright in every sample of its pixel is no tail, also where it hides a few samples that
    /// are as bright as it.
    #[test]
    fn a_lamp_in_view_is_no_tail() {
        let lamp = |pixel: usize| pixel.is_multiple_of(128);
        assert_eq!(film(|pixel, _| if lamp(pixel) { 5000.0 } else { 1.0 }).tail(), None);
        let both = film(|pixel, pass| if lamp(pixel) || pixel % 64 == 5 && pass == 5 { 5000.0 } else { 1.0 });
        let tail = both.tail().expect("a tail");
        assert!((tail.samples * 64.0 * 64.0 - 1.0).abs() < 1e-9, "{tail:?}");
    }

    /// Guards that a photon counts for itself, with its light and not as a sample.
    #[test]
    fn photons_are_parts_of_samples() {
        let mut film = film(|_, _| 1.0);
        for pixel in 0..64 {
            film.splat(pixel * 64, 3, Rgb::grey(2000.0), LightLayer::Caustic, 1).expect("a radiance");
        }
        let tail = film.tail().expect("a tail");
        assert_eq!(tail.samples, 0.0);
        assert!((tail.light - 2000.0 / (4096.0 + 2000.0)).abs() < 1e-6, "{tail:?}");
    }
}

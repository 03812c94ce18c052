//! The error of pictures against a reference, in its parts.
//!
//! In: luminances of the pictures of S seeds, of the same size, and a reference with its own noise. Out: the square
//! of E, and what of it is variance and what is bias.
//!
//! With w = 1 / (R^2 + c^2) of a pixel, c a tenth of the mean of R, N = mean w v_R the noise of the reference, and
//! V = mean w var(I) over the seeds:
//!
//! E^2 = mean over seeds and pixels of w (I - R)^2, less N
//! B   = mean over pixels of w (mean I - R)^2, less V / S and N
//!
//! so that E^2 = B + V, each without bias of its own where the reference has none.

use crate::stats::{ERROR_FLOOR, NORMAL_95};

/// A long render: its luminance, and the variance of each pixel of it.
pub(super) struct Reference {
    pub(super) luminance: Vec<f64>,
    variance: Vec<f64>,
    /// What a squared difference is multiplied by.
    weights: Vec<f64>,
    width: usize,
    /// N above.
    pub(super) noise: f64,
    /// Sum of the luminance.
    pub(super) total: f64,
}

/// Side of the blocks of pixels that count as independent.
const BLOCK: usize = 8;

impl Reference {
    /// The mean of independent pictures of `width` pixels a row; `None` where they are black, or fewer than two.
    pub(super) fn new(pictures: &[Vec<f64>], width: usize) -> Option<Self> {
        let n = pictures.len() as f64;
        if pictures.len() < 2 {
            return None;
        }
        let (luminance, variance) = moments(pictures.iter().map(Vec::as_slice));
        let variance: Vec<f64> = variance.into_iter().map(|v| v / n).collect();
        let total: f64 = luminance.iter().sum();
        let c = ERROR_FLOOR * total / luminance.len() as f64;
        if c.is_nan() || c <= 0.0 {
            return None;
        }
        let weights: Vec<f64> = luminance.iter().map(|r| 1.0 / (r * r + c * c)).collect();
        let noise = mean(weights.iter().zip(&variance).map(|(w, v)| w * v));
        Some(Self { luminance, variance, weights, width, noise, total })
    }
}

/// Mean and unbiased variance of each pixel over pictures.
fn moments<'a>(pictures: impl ExactSizeIterator<Item = &'a [f64]> + Clone) -> (Vec<f64>, Vec<f64>) {
    let n = pictures.len() as f64;
    let pixels = pictures.clone().next().map_or(0, <[f64]>::len);
    let (mut means, mut variances) = (vec![0.0; pixels], vec![0.0; pixels]);
    for picture in pictures.clone() {
        means.iter_mut().zip(picture).for_each(|(m, v)| *m += v / n);
    }
    for picture in pictures {
        for ((s, m), v) in variances.iter_mut().zip(&means).zip(picture) {
            *s += (v - m) * (v - m) / (n - 1.0).max(1.0);
        }
    }
    (means, variances)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = values.fold((0u64, 0.0), |(n, sum), v| (n + 1, sum + v));
    sum / n.max(1) as f64
}

/// What the squared error of a way to render consists of, each the square of a relative error.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// E^2 of each seed; the mean is E^2.
    pub squares: Vec<f64>,
    /// V: what differs from seed to seed.
    pub variance: f64,
    /// What of V is each seed's; the mean is V.
    pub variances: Vec<f64>,
    /// B: what is the same for all. May be negative, by noise.
    pub bias: f64,
    /// Half the width of the 95 % interval of B.
    pub bias_within: f64,
    /// Sum of the luminance of each seed.
    pub totals: Vec<f64>,
}

impl Parts {
    /// Of the pictures of at least two seeds.
    pub(super) fn new(pictures: &[Vec<f64>], reference: &Reference) -> Self {
        let seeds = pictures.len() as f64;
        let square = |picture: &Vec<f64>| {
            let pixels = picture.iter().zip(&reference.luminance).zip(&reference.weights);
            mean(pixels.map(|((i, r), w)| w * (i - r) * (i - r))) - reference.noise
        };
        let (means, variances) = moments(pictures.iter().map(Vec::as_slice));
        let variance = mean(variances.iter().zip(&reference.weights).map(|(v, w)| w * v));
        let apart = |picture: &Vec<f64>| {
            let pixels = picture.iter().zip(&means).zip(&reference.weights);
            mean(pixels.map(|((i, m), w)| w * (i - m) * (i - m))) * seeds / (seeds - 1.0).max(1.0)
        };
        let biases: Vec<f64> = (0..means.len())
            .map(|p| {
                let d = means[p] - reference.luminance[p];
                reference.weights[p] * (d * d - variances[p] / seeds - reference.variance[p])
            })
            .collect();
        Self {
            squares: pictures.iter().map(square).collect(),
            variance,
            variances: pictures.iter().map(apart).collect(),
            bias: mean(biases.iter().copied()),
            bias_within: NORMAL_95 * standard_error(&biases, reference.width),
            totals: pictures.iter().map(|p| p.iter().sum()).collect(),
        }
    }

    /// E^2, at least zero.
    #[must_use]
    pub fn square(&self) -> f64 {
        mean(self.squares.iter().copied()).max(0.0)
    }
}

/// Standard error of the mean over pixels, from the means of blocks, in which pixels may depend on each other.
fn standard_error(pixels: &[f64], width: usize) -> f64 {
    let across = width.div_ceil(BLOCK).max(1);
    let down = pixels.len().div_ceil(width.max(1)).div_ceil(BLOCK);
    let mut blocks = vec![(0.0, 0.0); across * down];
    for (i, v) in pixels.iter().enumerate() {
        let (sum, n) = &mut blocks[i / width / BLOCK * across + i % width / BLOCK];
        *sum += v;
        *n += 1.0;
    }
    let n = blocks.len() as f64;
    let (sum, count) = (pixels.iter().sum::<f64>(), pixels.len() as f64);
    // Of a ratio of sums, as blocks at the edges have fewer pixels.
    let squares: f64 =
        blocks.iter().map(|(s, k): &(f64, f64)| (s - k * sum / count) * (s - k * sum / count)).sum();
    (squares * n / (n - 1.0).max(1.0)).sqrt() / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mix64;

    struct Numbers(u64);

    impl Numbers {
        /// Mean zero, deviation one, about normal.
        fn next(&mut self) -> f64 {
            let mut unit = || {
                self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
                (mix64(self.0) >> 11) as f64 / (1u64 << 53) as f64
            };
            (0..12).map(|_| unit()).sum::<f64>() - 6.0
        }
    }

    const SIDE: usize = 64;

    fn picture(numbers: &mut Numbers, bias: f64, noise: f64) -> Vec<f64> {
        (0..SIDE * SIDE).map(|p| (1.0 + (p % 5) as f64) * (1.0 + bias + noise * numbers.next())).collect()
    }

    /// Known parts come back: a picture that is 3 % too bright with noise of 10 %, against a reference with noise of
    /// 2 %. Pixels of 1 to 5 have a floor of 0.3, so that squares are 0.917 to 0.996 of the relative ones.
    #[test]
    fn parts_are_told_apart() {
        let numbers = &mut Numbers(1);
        let long: Vec<Vec<f64>> = (0..4).map(|_| picture(numbers, 0.0, 0.04)).collect();
        let reference = Reference::new(&long, SIDE).expect("not black");
        let runs: Vec<Vec<f64>> = (0..8).map(|_| picture(numbers, 0.03, 0.1)).collect();
        let parts = Parts::new(&runs, &reference);
        let shrunk = (1..=5).map(|r| f64::from(r * r) / (f64::from(r * r) + 0.09)).sum::<f64>() / 5.0;
        assert!((reference.noise / (shrunk * 4e-4) - 1.0).abs() < 0.1, "{}", reference.noise);
        assert!((parts.variance / (shrunk * 0.01) - 1.0).abs() < 0.05, "{}", parts.variance);
        assert!((parts.bias - shrunk * 9e-4).abs() < 1.5 * parts.bias_within, "{parts:?}");
        assert!(parts.bias_within > 1e-5 && parts.bias_within < 2e-4, "{}", parts.bias_within);
        assert!((parts.square() - parts.bias - parts.variance).abs() < 1e-12);
        assert!((mean(parts.variances.iter().copied()) / parts.variance - 1.0).abs() < 1e-12);
    }

    /// Where there is no bias, the interval of it holds zero, in 95 of 100 trials; of 100, between 88 and 100.
    #[test]
    fn no_bias_is_found_where_there_is_none() {
        let numbers = &mut Numbers(2);
        let held = (0..100).filter(|_| {
            let long: Vec<Vec<f64>> = (0..4).map(|_| picture(numbers, 0.0, 0.05)).collect();
            let reference = Reference::new(&long, SIDE).expect("not black");
            let runs: Vec<Vec<f64>> = (0..4).map(|_| picture(numbers, 0.0, 0.1)).collect();
            let parts = Parts::new(&runs, &reference);
            parts.bias.abs() <= parts.bias_within
        });
        let held = held.count();
        assert!((88..=100).contains(&held), "{held}");
    }

    #[test]
    fn black_is_no_reference() {
        assert!(Reference::new(&[vec![0.0; 4], vec![0.0; 4]], 2).is_none());
        assert!(Reference::new(&[vec![1.0; 4]], 2).is_none());
    }
}

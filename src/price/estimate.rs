//! Bias, noise and their intervals from paired runs.
//!
//! In: luminance of each pixel in [`RUNS`] independent runs, in full and short, run by run with the same random
//! addresses. Out: estimates with 95 % intervals.
//!
//! *Mean bias*: sum of the differences over the sum of the full; its variance from the runs' residuals d - b f (ratio
//! estimator). *Bias of pixels*: the square of a pixel's mean difference is estimated without bias by the mean over
//! pairs of different runs of d_i d_j. *Noise*: the variance of a pixel over runs. The two are averaged over pixels
//! after division by R^2 + c^2, as the error of a picture is; their intervals come from leaving out each run in turn
//! (jackknife).
//!
//! R may not come from the runs that it divides: a pixel that a rare bright sample has hit would shrink its own error.
//! So the runs fall into two halves, and each is divided by the other's R. That is drawn from the pixel's own mean towards
//! that of its block as far as their difference is noise (James and Stein, 1961), or pixels that no such sample has hit yet
//! would seem dark.
//!
//! *Until when.* After n samples the full render has the squared error v / n. The short one, with the share w of its
//! work, takes n / w samples in the same time and has the squared error B^2 + v' w / n. It is the better choice while
//! n < (v - v' w) / B^2.

use crate::stats::{ERROR_FLOOR, Interval};

/// Runs of each render.
pub const RUNS: usize = 16;

/// The two-sided 95 % quantile of Student's t with `RUNS - 1` degrees of freedom.
const T: f64 = 2.131_449_545_559_323;

/// Side of the blocks of pixels whose means R is drawn to.
const BLOCK: usize = 4;

/// Until when a shortcut is the better choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Better {
    /// Never: for the same work the full render is no noisier.
    Never,
    /// The two are too much alike to say which is noisier for the same work.
    Unknown,
    /// While a full render would take fewer samples per pixel than this; from then on, what the shortcut takes from
    /// the picture is more than the noise that it saves. Infinite where no bias was seen.
    Until(Interval),
}

/// Sums of one pixel over runs: of full, short, and their difference, and of their squares.
#[derive(Clone, Copy, Default)]
struct Sums {
    full: [f64; 2],
    short: [f64; 2],
    difference: [f64; 2],
}

impl Sums {
    fn add(&mut self, full: f64, short: f64, sign: f64) {
        let put = |sums: &mut [f64; 2], x: f64| {
            sums[0] += sign * x;
            sums[1] += sign * (x * x);
        };
        put(&mut self.full, full);
        put(&mut self.short, short);
        put(&mut self.difference, short - full);
    }
}

/// Variance over `n` runs, from the sums of values and of squares.
fn variance([sum, squares]: [f64; 2], n: f64) -> f64 {
    (squares - sum * sum / n) / (n - 1.0)
}

/// Means over pixels, relative as the error of a picture is.
#[derive(Clone, Copy, Debug)]
struct Relative {
    /// Squared bias.
    bias2: f64,
    /// Variance of one sample, in full and short.
    variance: [f64; 2],
    /// How much less variance the short render has for the same work.
    gain: f64,
}

/// Paired runs of two renders.
pub(super) struct Paired {
    full: Vec<Vec<f64>>,
    short: Vec<Vec<f64>>,
    halves: [Half; 2],
    passes: f64,
    work: f64,
    relative: Relative,
    /// The same without each of the runs.
    left_out: Vec<Relative>,
}

/// Every second run.
struct Half {
    sums: Vec<Sums>,
    /// 1 / (R^2 + c^2) of each pixel, from the other half.
    weights: Vec<f64>,
    runs: f64,
}

/// Sums over every second run, from run `first` on.
fn half(full: &[Vec<f64>], short: &[Vec<f64>], first: usize) -> Vec<Sums> {
    let mut sums = vec![Sums::default(); full[first].len()];
    for (f, s) in full.iter().zip(short).skip(first).step_by(2) {
        sums.iter_mut().zip(f.iter().zip(s)).for_each(|(sums, (&f, &s))| sums.add(f, s, 1.0));
    }
    sums
}

/// Of the pixels of a block: their number, the sums of their means and of the squares of those, and the sum of the
/// variances of those means.
#[derive(Clone, Copy, Default)]
struct Block {
    pixels: f64,
    sum: f64,
    squares: f64,
    noise: f64,
}

impl Block {
    /// What the mean of a pixel becomes.
    fn draw(&self, mean: f64) -> f64 {
        let middle = self.sum / self.pixels;
        let spread = variance([self.sum, self.squares], self.pixels);
        let noise = self.noise / self.pixels;
        // A block of one pixel has no spread that could be told from noise.
        let own = if spread > noise { 1.0 - noise / spread } else { 0.0 };
        middle + own * (mean - middle)
    }
}

/// 1 / (R^2 + c^2) for each pixel of a picture of some width, from the sums over some runs.
fn weights(sums: &[Sums], runs: f64, width: usize, c: f64) -> Vec<f64> {
    let columns = width.div_ceil(BLOCK);
    let block = |pixel: usize| pixel / width / BLOCK * columns + pixel % width / BLOCK;
    let mut blocks = vec![Block::default(); sums.len().div_ceil(width).div_ceil(BLOCK) * columns];
    for (pixel, s) in sums.iter().enumerate() {
        let (block, mean) = (&mut blocks[block(pixel)], s.full[0] / runs);
        block.pixels += 1.0;
        block.sum += mean;
        block.squares += mean * mean;
        block.noise += variance(s.full, runs) / runs;
    }
    let weight = |(pixel, s): (usize, &Sums)| {
        let r = blocks[block(pixel)].draw(s.full[0] / runs);
        1.0 / (r * r + c * c)
    };
    sums.iter().enumerate().map(weight).collect()
}

impl Paired {
    /// From luminance by run and pixel, row by row; `work` is that of the short render over that of the full one. `None`
    /// where the full picture is black, or where there are fewer than six runs.
    pub(super) fn new(
        full: Vec<Vec<f64>>,
        short: Vec<Vec<f64>>,
        width: usize,
        passes: u32,
        work: f64,
    ) -> Option<Self> {
        let n = full.len();
        if n < 6 || width == 0 || full[0].is_empty() {
            return None;
        }
        let sums = [half(&full, &short, 0), half(&full, &short, 1)];
        let runs = [n.div_ceil(2) as f64, (n / 2) as f64];
        let sum: f64 = sums.iter().flatten().map(|s| s.full[0]).sum();
        let mean = sum / (n * full[0].len()) as f64;
        if mean <= 0.0 {
            return None;
        }
        let c = ERROR_FLOOR * mean;
        let [a, b] = [0, 1].map(|h| weights(&sums[h], runs[h], width, c));
        let [even, odd] = sums;
        let halves =
            [Half { sums: even, weights: b, runs: runs[0] }, Half { sums: odd, weights: a, runs: runs[1] }];
        let relative = Relative { bias2: 0.0, variance: [0.0; 2], gain: 0.0 };
        let passes = f64::from(passes);
        let mut paired = Self { full, short, halves, passes, work, relative, left_out: Vec::new() };
        paired.relative = paired.relative(None);
        paired.left_out = (0..n).map(|run| paired.relative(Some(run))).collect();
        Some(paired)
    }

    /// From all runs, or from all but one.
    fn relative(&self, without: Option<usize>) -> Relative {
        let (mut bias2, mut noise) = (0.0, [0.0; 2]);
        for (h, half) in self.halves.iter().enumerate() {
            let without = without.filter(|run| run % 2 == h);
            let n = half.runs - f64::from(u8::from(without.is_some()));
            for (pixel, (sums, weight)) in half.sums.iter().zip(&half.weights).enumerate() {
                let mut sums = *sums;
                if let Some(run) = without {
                    sums.add(self.full[run][pixel], self.short[run][pixel], -1.0);
                }
                let [sum, squares] = sums.difference;
                bias2 += weight * (sum * sum - squares) / (n * (n - 1.0));
                noise[0] += weight * variance(sums.full, n);
                noise[1] += weight * variance(sums.short, n);
            }
        }
        let pixels = 2.0 * self.halves[0].sums.len() as f64;
        let variance = noise.map(|v| v * self.passes / pixels);
        Relative { bias2: bias2 / pixels, variance, gain: variance[0] - self.work * variance[1] }
    }

    /// A figure, with the interval of the jackknife.
    fn jackknife(&self, figure: impl Fn(&Relative) -> f64) -> Interval {
        let n = self.left_out.len() as f64;
        let mean = self.left_out.iter().map(&figure).sum::<f64>() / n;
        let squares: f64 = self.left_out.iter().map(|r| (figure(r) - mean) * (figure(r) - mean)).sum();
        Interval::around(figure(&self.relative), T * (squares * (n - 1.0) / n).sqrt())
    }

    /// Bias of the mean of all pixels, relative.
    pub(super) fn bias(&self) -> Interval {
        let mean = |run: &Vec<f64>| run.iter().sum::<f64>() / run.len() as f64;
        let of = |runs: &[Vec<f64>]| runs.iter().map(mean).collect::<Vec<_>>();
        self.bias_of(&of(&self.full), &of(&self.short))
    }

    /// Bias of a part of the light whose means over the picture these are, by run, relative to all light.
    pub(super) fn bias_of(&self, full: &[f64], short: &[f64]) -> Interval {
        let n = self.full.len() as f64;
        let all: Vec<f64> = self.full.iter().map(|run| run.iter().sum::<f64>() / run.len() as f64).collect();
        let mean = all.iter().sum::<f64>() / n;
        let differences = || full.iter().zip(short).map(|(f, s)| s - f);
        let bias = differences().sum::<f64>() / (n * mean);
        let residuals = differences().zip(&all).map(|(d, f)| d - bias * f);
        let squares: f64 = residuals.map(|e| e * e).sum();
        Interval::around(bias, T * ((squares / (n * (n - 1.0))).sqrt() / mean))
    }

    /// Root of the mean squared relative bias of pixels.
    pub(super) fn error(&self) -> Interval {
        self.jackknife(|r| r.bias2).root()
    }

    /// Variance of the short render over that of the full one; infinite where that has none and this one has.
    pub(super) fn variance(&self) -> f64 {
        let [full, short] = self.relative.variance;
        if short <= 0.0 { 0.0 } else { short / full }
    }

    /// Until when the short render is the better choice.
    pub(super) fn better(&self) -> Better {
        let gain = self.jackknife(|r| r.gain);
        if gain.high <= 0.0 {
            return Better::Never;
        }
        if gain.low <= 0.0 {
            return Better::Unknown;
        }
        let bias2 = self.jackknife(|r| r.bias2);
        let until = |bias2: f64| if bias2 > 0.0 { gain.value / bias2 } else { f64::INFINITY };
        Better::Until(Interval { value: until(bias2.value), low: until(bias2.high), high: until(bias2.low) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mix64;

    /// Uniform numbers with mean one and variance 1/12.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            (mix64(self.0) >> 11) as f64 / (1u64 << 53) as f64 + 0.5
        }
    }

    const PIXELS: usize = 64;

    /// Full runs with noise of their own, and what `short` makes of each pixel's value.
    fn runs(seed: u64, short: impl Fn(f64, &mut Numbers) -> f64) -> [Vec<Vec<f64>>; 2] {
        let mut random = Numbers(seed);
        let mut full = Vec::new();
        let mut shorts = Vec::new();
        for _ in 0..RUNS {
            let run: Vec<f64> = (0..PIXELS).map(|_| random.next()).collect();
            shorts.push(run.iter().map(|&v| short(v, &mut random)).collect());
            full.push(run);
        }
        [full, shorts]
    }

    /// Guards pairing: where the short picture is the full one times a factor, the bias is known exactly however noisy
    /// both are, the variance is its square, and the rest follows.
    #[test]
    fn a_factor_is_seen_through_the_noise() {
        let [full, short] = runs(1, |v, _| 0.9 * v);
        let paired = Paired::new(full, short, 8, 4, 0.5).expect("runs");
        let bias = paired.bias();
        assert!((bias.value + 0.1).abs() < 1e-12 && bias.within() < 1e-12, "{bias:?}");
        assert!((paired.variance() - 0.81).abs() < 1e-9);
        // (B - R)^2 / (R^2 + c^2) with R = 1, c = 0.1.
        let expected = 0.1 / 1.01f64.sqrt();
        let error = paired.error();
        assert!((error.value / expected - 1.0).abs() < 0.01, "{error:?}");
        // v = 4 / 12 a sample over 1.01, of which 1 - 0.5 * 0.81 is gained.
        let expected = 4.0 / 12.0 * (1.0 - 0.405) / 0.01;
        let Better::Until(until) = paired.better() else { panic!("{:?}", paired.better()) };
        assert!((until.value / expected - 1.0).abs() < 0.1, "{until:?} {expected}");
        assert!(until.low < until.value && until.value < until.high, "{until:?}");
    }

    /// Guards the intervals: of 200 differences that are noise and a known bias, 95 % hold it, give or take three
    /// standard errors of 1.5 %; so do those of the bias of pixels.
    #[test]
    fn intervals_hold_the_truth() {
        let (mut means, mut pixels) = (0, 0);
        for seed in 0..200 {
            let [full, short] = runs(100 + seed, |_, random| random.next() - 0.2);
            let paired = Paired::new(full, short, 8, 1, 1.0).expect("runs");
            means += u32::from(paired.bias().holds(-0.2));
            pixels += u32::from(paired.error().holds(0.2 / 1.01f64.sqrt()));
        }
        assert!((181..=199).contains(&means) && (181..=199).contains(&pixels), "{means} {pixels}");
    }

    /// Guards R against the runs that it divides: where one sample in five brings nearly all of the light, and the short
    /// picture lacks it, the bias of pixels is right on average. Divided by a pixel's own mean it comes out a third too
    /// small.
    #[test]
    fn rare_light_does_not_shrink_its_own_error() {
        let mut squares = 0.0;
        const TRIALS: u64 = 40;
        for seed in 0..TRIALS {
            let mut random = Numbers(1000 + seed);
            let mut rare = || if random.next() < 0.7 { 5.5 } else { 0.5 };
            let full: Vec<Vec<f64>> = (0..RUNS).map(|_| (0..PIXELS).map(|_| rare()).collect()).collect();
            let short = vec![vec![0.5; PIXELS]; RUNS];
            let error = Paired::new(full, short, 8, 1, 1.0).expect("runs").error().value;
            squares += error * error / TRIALS as f64;
        }
        // B = 1, R = 1.5, c = 0.15.
        let expected = 1.0 / (1.5f64 * 1.5 * 1.01).sqrt();
        assert!((squares.sqrt() / expected - 1.0).abs() < 0.06, "{} {expected}", squares.sqrt());
    }

    /// Guards what is said where there is nothing to say: noise alone is no bias, no gain is no gain, and a shortcut
    /// that takes more work for the same picture is never better.
    #[test]
    fn nothing_is_not_something() {
        let [full, short] = runs(3, |_, random| random.next());
        let paired = Paired::new(full, short, 8, 1, 1.0).expect("runs");
        assert!(paired.bias().may_be_zero() && paired.error().low == 0.0);
        assert_eq!(paired.better(), Better::Unknown);
        let [full, short] = runs(4, |v, _| v);
        assert_eq!(
            Paired::new(full.clone(), short.clone(), 8, 1, 1.2).expect("runs").better(),
            Better::Never
        );
        let Better::Until(until) = Paired::new(full, short, 8, 1, 0.5).expect("runs").better() else {
            panic!("less work")
        };
        assert_eq!(until.value, f64::INFINITY);
        let black = vec![vec![0.0; PIXELS]; RUNS];
        assert!(Paired::new(black.clone(), black, 8, 1, 1.0).is_none());
    }
}

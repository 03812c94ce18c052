//! What trials say of each other: work for the same error, and how sure that is.
//!
//! Work is rays times the square of the error, in the sense of [`Film::error`](crate::film::Film::error): error
//! falls with the root of the work, so that whoever has half of it reaches the same error with half of the rays.

use super::trial::{Means, REPLICATIONS, Trial, variance};
use crate::stats::ERROR_FLOOR;

/// What the picture becomes, as far as all trials together know.
#[derive(Clone, Debug, Default)]
pub(super) struct Truth {
    sums: Vec<f64>,
    trials: f64,
}

impl Truth {
    /// Adds what a trial says.
    pub(super) fn add(&mut self, trial: &Trial) {
        self.sums.resize(trial.pixels(), 0.0);
        for (sum, means) in self.sums.iter_mut().zip(&trial.all) {
            *sum += means.iter().sum::<f64>() / REPLICATIONS as f64;
        }
        self.trials += 1.0;
    }

    /// What squared errors of pixels are multiplied by: 1 / (R^2 + c^2). `None` where all is black.
    pub(super) fn weights(&self) -> Option<Vec<f64>> {
        let mean = self.sums.iter().sum::<f64>() / (self.sums.len().max(1) as f64 * self.trials);
        let c = ERROR_FLOOR * mean;
        let weight = |sum: &f64| {
            let r = sum / self.trials;
            1.0 / (r * r + c * c)
        };
        (c > 0.0 && c.is_finite()).then(|| self.sums.iter().map(weight).collect())
    }
}

/// For each pixel the relative variance of its mean.
pub(super) fn relative(of: &[Means], weights: &[f64]) -> Vec<f64> {
    of.iter().zip(weights).map(|(m, w)| variance(m) * w).collect()
}

/// Mean over pixels.
pub(super) fn mean(of: &[f64]) -> f64 {
    of.iter().sum::<f64>() / of.len().max(1) as f64
}

/// Mean over pixels, and its standard error.
pub(super) fn mean_and_error(of: &[f64]) -> (f64, f64) {
    let (n, m) = (of.len() as f64, mean(of));
    let squares: f64 = of.iter().map(|x| (x - m) * (x - m)).sum();
    (m, (squares / (n * (n - 1.0).max(1.0))).sqrt())
}

/// How many times the work of one choice the other takes for the same error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gain {
    /// Work of the first over that of the second.
    pub(super) factor: f64,
    /// Its standard error.
    pub(super) error: f64,
}

/// Gains below this are not worth a change.
pub(super) const WORTH: f64 = 1.1;

/// Standard errors that a gain has to be away from none.
const SURE: f64 = 2.0;

impl Gain {
    /// Of going from trial `a` to `b`, which drew the same numbers.
    pub(super) fn new(a: &Trial, b: &Trial, weights: &[f64]) -> Self {
        let (x, y) = (relative(&a.all, weights), relative(&b.all, weights));
        let (mx, my) = (mean(&x), mean(&y));
        if mx <= 0.0 || my <= 0.0 {
            return Self { factor: 1.0, error: f64::INFINITY };
        }
        // The ratio of two means over the same pixels, by the delta method.
        let ratio: Vec<f64> = x.iter().zip(&y).map(|(x, y)| x / mx - y / my).collect();
        let factor = mx * a.rays / (my * b.rays);
        Self { factor, error: factor * mean_and_error(&ratio).1 }
    }

    /// Whether it is worth a change, and no accident.
    pub(super) fn is_sure(self) -> bool {
        self.factor > WORTH && self.factor - 1.0 > SURE * self.error
    }

    /// Whether an independent trial bears out what another one had promised.
    pub(super) fn bears_out(self) -> bool {
        self.factor > 1.0 + 0.5 * (WORTH - 1.0) && self.factor - 1.0 > self.error
    }
}

/// Taking several samples of a part of each sample: how many, and what that gains.
#[derive(Clone, Copy, Debug)]
pub(super) struct Several {
    /// How many samples of the part.
    pub(super) count: u32,
    /// Work of one over work of `count`, as predicted.
    pub(super) gain: f64,
    /// The same for two.
    pub(super) gain_of_two: f64,
    /// Rays of a pass with so many, over those with one.
    pub(super) rays: f64,
    /// Whether the part carries any noise, surely.
    pub(super) sure: bool,
}

impl Several {
    /// From a trial with one and another with `n` samples of the part. With variance V = rest + part / m and rays
    /// C = rest + m part, the product is least for m = sqrt((part / part) / (rest / rest)), the ratio of variance to
    /// rays within the part over that of the rest.
    pub(super) fn new(one: &Trial, many: &Trial, n: u32, most: u32, weights: &[f64]) -> Self {
        let (x, y) = (relative(&one.all, weights), relative(&many.all, weights));
        let less: Vec<f64> = x.iter().zip(&y).map(|(x, y)| x - y).collect();
        let (fall, error) = mean_and_error(&less);
        let n = f64::from(n);
        let total = mean(&x);
        let part = (fall * n / (n - 1.0)).clamp(0.0, total);
        let rest = total - part;
        let part_rays = ((many.rays - one.rays) / (n - 1.0)).max(1e-6 * one.rays);
        let rest_rays = (one.rays - part_rays).max(1e-6 * one.rays);
        let work = |m: f64| (rest + part / m) * (rest_rays + m * part_rays);
        let ideal = ((part / part_rays) / (rest / rest_rays)).sqrt();
        let ideal = if ideal.is_nan() { 1.0 } else { ideal.clamp(1.0, f64::from(most)) };
        let count = if work(ideal.floor()) <= work(ideal.ceil()) { ideal.floor() } else { ideal.ceil() };
        let gain = |m: f64| if work(m) > 0.0 { work(1.0) / work(m) } else { 1.0 };
        Self {
            count: count as u32,
            gain: gain(count),
            gain_of_two: gain(2.0),
            rays: (rest_rays + count * part_rays) / one.rays,
            sure: fall > SURE * error,
        }
    }

    /// Whether it is worth a change.
    pub(super) fn is_worth(&self) -> bool {
        self.count > 1 && self.gain > WORTH && self.sure
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trial whose pixels have given variances of their means.
    fn trial(variances: &[f64], rays: f64) -> Trial {
        // Means +-d around one have the variance d^2 / 3.
        let pixel = |v: &f64| {
            let d = (3.0 * v).sqrt();
            [1.0 - d, 1.0 + d, 1.0 - d, 1.0 + d]
        };
        let all: Vec<Means> = variances.iter().map(pixel).collect();
        let n = all.len();
        Trial {
            others: all.clone(),
            all,
            thrown: vec![0.0; n],
            met: vec![0.0; n],
            events: [0.0; 2],
            through: 0.0,
            passes: 4,
            rays,
            rays_of_photon: 1.0,
            spent: 0.0,
        }
    }

    /// Guards the optimum: with variance 1 + 8 / m and rays 6 + m, (1 + 8 / m) (6 + m) is least at sqrt(48) = 6.93.
    #[test]
    fn several_are_as_many_as_the_formula_says() {
        let one = trial(&[9.0; 50], 7.0);
        let four = trial(&[3.0; 50], 10.0);
        let weights = vec![1.0; 50];
        let found = Several::new(&one, &four, 4, 16, &weights);
        assert_eq!(found.count, 7);
        assert!((found.gain - 63.0 / ((1.0 + 8.0 / 7.0) * 13.0)).abs() < 1e-9, "{found:?}");
        assert!(found.is_worth());
        // Not where the part has no noise, and not where noise is all that there is to see of it.
        assert!(!Several::new(&one, &trial(&[9.0; 50], 10.0), 4, 16, &weights).is_worth());
        let mut outlier = [3.0; 50];
        outlier[0] = 200.0;
        let noisy = Several::new(&trial(&outlier, 7.0), &four, 4, 16, &weights);
        assert!(!noisy.is_worth(), "{noisy:?}");
    }

    /// Guards gains: work is rays times squared error, and a single pixel proves nothing.
    #[test]
    fn gains_are_ratios_of_work() {
        let weights = vec![1.0; 50];
        let gain = Gain::new(&trial(&[4.0; 50], 10.0), &trial(&[1.0; 50], 20.0), &weights);
        assert!((gain.factor - 2.0).abs() < 1e-9 && gain.is_sure(), "{gain:?}");
        let mut outlier = [1.0; 50];
        outlier[0] = 100.0;
        let gain = Gain::new(&trial(&outlier, 10.0), &trial(&[1.0; 50], 10.0), &weights);
        assert!(gain.factor > 2.0 && !gain.is_sure(), "{gain:?}");
    }
}

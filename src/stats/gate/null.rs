//! What statistics do when nothing is wrong, and how a run compares.

use statrs::distribution::{ContinuousCDF, Gamma};

use super::{Family, Planes, Statistic};
use crate::stats::{Moments, normal_quantile, sidak, student_two_sided, two_sided};

/// Fewest null runs: with 64 the deviation of a statistic is known to 9 %, and Student's t accounts for
/// the rest.
pub const FEWEST_RUNS: usize = 64;

/// Skewness beyond which a curve fitted to 64 runs says nothing any more.
const MOST_SKEW: f64 = 4.0;

/// The distribution of each statistic of a family over null runs.
///
/// A value is taken to a standard normal number through Student's t (mean and deviation come from a
/// finite number of runs), and from there to a p-value through the curve of Pearson's type III with
/// the statistic's skewness, which is the normal curve where that is zero. The skewness of a sum is
/// estimated from the third moments of its pixels, which is far more precise than from the sums
/// themselves, and from the sums themselves where they show more than that.
#[derive(Clone, Debug, PartialEq)]
pub struct Null {
    /// Of each statistic, in the family's order.
    pub statistics: Vec<NullStatistic>,
}

/// One statistic over null runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NullStatistic {
    /// Null runs.
    pub runs: u64,
    /// Their mean.
    pub mean: f64,
    /// Deviation of one run.
    pub deviation: f64,
    /// Third central moment over the cube of the deviation.
    pub skewness: f64,
}

/// What one statistic says about a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Which one.
    pub statistic: Statistic,
    /// Its value over the mean of the null runs, less one: 0.01 is one per cent more. For a scalar, the
    /// difference.
    pub shift: f64,
    /// Deviations from the mean.
    pub z: f64,
    /// Probability of a value as far out on either side where nothing is wrong, for this statistic alone.
    pub p: f64,
}

/// What all statistics say.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "a verdict does nothing until it is reported"]
pub struct Outcome {
    /// One for each statistic, least probable first.
    pub findings: Vec<Finding>,
    /// Probability that the least probable of them is as improbable as it is where nothing is wrong.
    pub p: f64,
}

impl Null {
    /// From at least [`FEWEST_RUNS`] runs that had no part in the design of `family`; `None` where there
    /// are fewer, or where they are not like the pilots.
    #[must_use]
    pub fn new(family: &Family, runs: &[Planes]) -> Option<Self> {
        if runs.len() < FEWEST_RUNS {
            return None;
        }
        let values: Vec<Vec<f64>> = runs.iter().map(|r| family.values(r)).collect::<Option<_>>()?;
        let of = |(k, statistic): (usize, &Statistic)| {
            let own: Vec<f64> = values.iter().map(|v| v[k]).collect();
            NullStatistic::new(&own, statistic.third_moment(runs))
        };
        Some(Self { statistics: family.statistics.iter().enumerate().map(of).collect() })
    }

    /// Judges a run; `None` where it is not like the null runs.
    #[must_use]
    pub fn test(&self, family: &Family, run: &Planes) -> Option<Outcome> {
        let values = family.values(run)?;
        let mut findings: Vec<Finding> = values
            .iter()
            .zip(&self.statistics)
            .zip(&family.statistics)
            .map(|((&value, null), statistic)| {
                let (z, p) = null.compare(value);
                let scalar = statistic.kind == super::Kind::Scalar || null.mean == 0.0;
                let shift = if scalar { value - null.mean } else { value / null.mean - 1.0 };
                Finding { statistic: statistic.clone(), shift, z, p }
            })
            .collect();
        findings.sort_by(|a, b| a.p.total_cmp(&b.p));
        let p = findings.first().map_or(1.0, |f| sidak(f.p, findings.len()));
        Some(Outcome { findings, p })
    }
}

impl NullStatistic {
    fn new(values: &[f64], third_moment: f64) -> Self {
        let m: Moments = values.iter().copied().collect();
        let (n, deviation) = (values.len() as f64, m.variance().sqrt());
        if deviation == 0.0 {
            return Self { runs: m.n, mean: m.mean, deviation, skewness: 0.0 };
        }
        let cubes: f64 = values.iter().map(|v| (v - m.mean) / deviation).map(|d| d * d * d).sum();
        let own = cubes * n / ((n - 1.0) * (n - 2.0));
        // Standard error of a normal sample's skewness.
        let error = (6.0 / n).sqrt();
        let pixels = third_moment / (deviation * deviation * deviation);
        let excess = (own.abs() - 2.0 * error).max(0.0);
        let skewness = if excess > pixels.abs() { excess.copysign(own) } else { pixels };
        Self { runs: m.n, mean: m.mean, deviation, skewness: skewness.clamp(-MOST_SKEW, MOST_SKEW) }
    }

    /// Deviations from the mean, and the two-sided p-value of a new run's value.
    #[must_use]
    pub fn compare(&self, value: f64) -> (f64, f64) {
        if !value.is_finite() {
            return (f64::INFINITY, 0.0);
        }
        let d = value - self.mean;
        if self.deviation == 0.0 {
            return if d == 0.0 { (0.0, 1.0) } else { (f64::INFINITY.copysign(d), 0.0) };
        }
        let n = self.runs as f64;
        let z = d / self.deviation;
        let t = z / (1.0 + 1.0 / n).sqrt();
        let tail = 0.5 * student_two_sided(t, n - 1.0);
        let normal = normal_quantile(tail.clamp(f64::MIN_POSITIVE, 0.5)).abs().copysign(t);
        (z, skewed_two_sided(normal, self.skewness).max(0.0))
    }
}

/// Two-sided p-value of a standard score: on the side of the long tail twice the tail of Pearson's type III
/// curve with this skewness, on the other that of the normal curve, which is heavier there. (The type III
/// curve ends on its short side, where a sum does not.)
fn skewed_two_sided(z: f64, skewness: f64) -> f64 {
    // Below this, the curve cannot be told from the normal one.
    const NORMAL: f64 = 1e-3;
    let normal = two_sided(z);
    if skewness.abs() < NORMAL || z * skewness <= 0.0 {
        return normal;
    }
    // A gamma distribution of shape k has skewness 2 / sqrt(k), mean k and deviation sqrt(k).
    let k = 4.0 / (skewness * skewness);
    let Ok(gamma) = Gamma::new(k, 1.0) else { return normal };
    (2.0 * gamma.sf(k + z.abs() * k.sqrt())).clamp(normal.min(1.0), 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known values: the exponential distribution is the gamma of skewness 2; its tail at mean + 3
    /// deviations is exp(-4). Without skewness it is the normal distribution, and small skewness is near it.
    #[test]
    fn tails_of_the_skewed_curve() {
        assert!((skewed_two_sided(3.0, 2.0) / (2.0 * libm::exp(-4.0)) - 1.0).abs() < 1e-9);
        assert!((skewed_two_sided(-3.0, -2.0) / (2.0 * libm::exp(-4.0)) - 1.0).abs() < 1e-9);
        assert_eq!(skewed_two_sided(-1.5, 2.0), two_sided(-1.5), "on the short side as without skewness");
        for z in [-4.0, -1.0, 2.0, 5.0] {
            let (exact, near) = (skewed_two_sided(z, 0.0), skewed_two_sided(z, 0.0011));
            assert!((near / exact - 1.0).abs() < 0.05, "{z} {near} {exact}");
        }
    }

    /// A constant statistic accepts nothing but its value, and what is not a number is refused.
    #[test]
    fn constants_and_broken_values() {
        let constant = NullStatistic::new(&[2.0; 64], 0.0);
        assert_eq!(constant.compare(2.0).1, 1.0);
        assert_eq!(constant.compare(2.0000001).1, 0.0);
        assert_eq!(constant.compare(f64::NAN).1, 0.0);
    }
}

//! What statistics do when nothing is wrong, and how runs compare.

use statrs::distribution::{ContinuousCDF, Gamma};

use super::{Family, Kind, Planes, Statistic};
use crate::stats::{Moments, normal_quantile, sidak, sidak_each, student_two_sided, two_sided};

/// Fewest null runs: with 64 the deviation of a statistic is known to 9 %, and Student's t accounts for
/// the rest.
pub const FEWEST_RUNS: usize = 64;

/// Skewness beyond which a curve fitted to 64 runs says nothing any more.
const MOST_SKEW: f64 = 4.0;

/// Deviations beyond which a run under test says no more about the mean of several: what only one of them met is
/// rare, what all of them show is wrong. (Tukey and McLaughlin, Sankhya A 25, 1963: Winsorized means.)
const MOST_DEVIATIONS: f64 = 5.0;

/// What single precision may do to a statistic, as a share of its scale: on another machine the last bits of
/// a pixel may differ. Where runs differ by less than this, they do not differ.
const ROUNDING: f64 = 2e-6;

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
#[derive(Clone, Debug, PartialEq)]
pub struct NullStatistic {
    /// Its value in each null run.
    pub values: Vec<f64>,
    /// Their mean.
    pub mean: f64,
    /// Deviation of one run.
    pub deviation: f64,
    /// Third central moment over the cube of the deviation.
    pub skewness: f64,
    /// What a change of all light, as a share, makes of it.
    pub scale: f64,
    /// What a shift is a share of.
    pub magnitude: f64,
    /// Mean and deviation without a bound on what a pixel contributes, for pictures whose noise is another.
    pub linear: [f64; 2],
}

/// What one statistic says about the runs under test.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Which one.
    pub statistic: Statistic,
    /// How far it is from the mean of the null runs, as a share, with all that every pixel contributes: 0.01 is one
    /// per cent more. For a scalar, the difference.
    pub shift: f64,
    /// The mean of the null runs.
    pub expected: f64,
    /// Standard error of the shift, in the same unit.
    pub error: f64,
    /// Standard errors from the mean.
    pub z: f64,
    /// Probability of a value as far out on either side where nothing is wrong, for this statistic alone.
    pub p: f64,
    /// The same after all statistics of its half of the family: it is significant below half of the
    /// family's significance.
    pub shared: f64,
}

/// What all statistics say.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "a verdict does nothing until it is reported"]
pub struct Outcome {
    /// One for each statistic, least probable first.
    pub findings: Vec<Finding>,
    /// Probability that the least probable of them is as improbable as it is where nothing is wrong. Half of
    /// the significance is for what looks at all of a run (images, matched filters, scalars), half for the
    /// many that look at parts of it.
    pub p: f64,
}

/// Whether a statistic looks at a part of a run; these are many.
fn is_part(statistic: &Statistic) -> bool {
    matches!(statistic.kind, Kind::Tile { .. } | Kind::Wave { .. })
}

/// Skewness of a tile's or a wave's values beyond which it is not judged alone.
const MERGED: f64 = 1.5;

/// Whether a part of the picture hangs on a few rare samples: then it is not judged alone, but as a part of the
/// larger tiles and of the whole that it belongs to.
fn is_merged(null: &NullStatistic, statistic: &Statistic) -> bool {
    is_part(statistic) && null.own_skewness().abs() > MERGED
}

/// Mean and deviation over runs without a bound on what a pixel contributes.
fn linear(statistic: &Statistic, runs: &[Planes]) -> [f64; 2] {
    let m: Moments = runs.iter().filter_map(|r| statistic.linear(r)).collect();
    [m.mean, m.variance().sqrt()]
}

impl Outcome {
    fn new(mut findings: Vec<Finding>) -> Self {
        let parts = findings.iter().filter(|f| is_part(&f.statistic)).count();
        let wholes = findings.len() - parts;
        for f in &mut findings {
            f.shared = sidak(f.p, if is_part(&f.statistic) { parts } else { wholes });
        }
        findings.sort_by(|a, b| a.shared.total_cmp(&b.shared).then(b.z.abs().total_cmp(&a.z.abs())));
        let p = findings.first().map_or(1.0, |f| sidak(f.shared, 2));
        Self { findings, p }
    }

    /// The findings that are improbable at this significance of the whole family.
    pub fn significant(&self, significance: f64) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |f| sidak(f.shared, 2) < significance)
    }
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
            let null = NullStatistic::new(own, statistic.third_moment(runs), statistic.scale(runs));
            if statistic.kind == Kind::Scalar {
                return null;
            }
            let magnitude: Moments = runs.iter().filter_map(|r| statistic.magnitude(r)).collect();
            NullStatistic { linear: linear(statistic, runs), magnitude: magnitude.mean, ..null }
        };
        Some(Self { statistics: family.statistics.iter().enumerate().map(of).collect() })
    }

    /// What pilots let expect of [`FEWEST_RUNS`] null runs, before there are any; good for a forecast and not for a
    /// verdict. `None` where they are not like each other.
    #[must_use]
    pub fn forecast(family: &Family, pilots: &[Planes]) -> Option<Self> {
        let values: Vec<Vec<f64>> = pilots.iter().map(|r| family.values(r)).collect::<Option<_>>()?;
        let of = |(k, statistic): (usize, &Statistic)| {
            let own: Vec<f64> = values.iter().map(|v| v[k]).collect();
            let one = NullStatistic::new(own, 0.0, statistic.scale(pilots));
            NullStatistic { values: vec![one.mean; FEWEST_RUNS], skewness: 0.0, ..one }
        };
        Some(Self { statistics: family.statistics.iter().enumerate().map(of).collect() })
    }

    /// Judges the mean of some runs, two at least if rare light is not to be called an error; shifts up to `accepted` (a share) are not held against them. `None` where
    /// there are none, or they are not like the null runs.
    #[must_use]
    pub fn test(&self, family: &Family, runs: &[Planes], accepted: f64) -> Option<Outcome> {
        let values: Vec<Vec<f64>> = runs.iter().map(|r| family.values(r)).collect::<Option<_>>()?;
        if values.is_empty() {
            return None;
        }
        let finding = |(k, (null, statistic)): (usize, (&NullStatistic, &Statistic))| {
            if is_merged(null, statistic) {
                return None;
            }
            let accepted = if statistic.kind == Kind::Scalar { 0.0 } else { accepted * null.scale };
            let limit = MOST_DEVIATIONS * null.deviation + accepted;
            let mean =
                |of: &dyn Fn(f64) -> f64| values.iter().map(|v| of(v[k])).sum::<f64>() / values.len() as f64;
            let value = mean(&|v| v);
            let limited = mean(&|v| null.mean + (v - null.mean).clamp(-limit, limit));
            let z = null.compare(value, values.len(), accepted).0;
            // A single run has nobody to disagree with.
            let judged = if values.len() > 1 { limited } else { value };
            let p = if value.is_finite() { null.compare(judged, values.len(), accepted).1 } else { 0.0 };
            let linear = runs.iter().filter_map(|r| statistic.linear(r)).sum::<f64>() / runs.len() as f64;
            let shift = null.share(linear - null.linear[0]);
            let error = null.share(null.linear[1] * null.spread(runs.len()));
            Some(Finding { statistic: statistic.clone(), shift, expected: null.mean, error, z, p, shared: p })
        };
        let all = self.statistics.iter().zip(&family.statistics).enumerate();
        Some(Outcome::new(all.filter_map(finding).collect()))
    }

    /// Judges a picture of unknown origin by the variances that it states of its pixels (see
    /// [`Statistic`]); planes that it lacks, and scalars, are left out. `None` where nothing is left.
    #[must_use]
    pub fn test_picture(&self, family: &Family, picture: &Planes, variances: &Planes) -> Option<Outcome> {
        if !family.fits(picture) || !family.fits(variances) {
            return None;
        }
        let finding = |(null, statistic): (&NullStatistic, &Statistic)| {
            if is_merged(null, statistic) {
                return None;
            }
            let (value, own) = (statistic.linear(picture)?, statistic.variance(variances)?);
            let [mean, deviation] = null.linear;
            let error =
                (own + deviation * deviation / null.values.len() as f64).sqrt() + ROUNDING * null.scale;
            let d = value - mean;
            let z = if d == 0.0 { 0.0 } else { d / error };
            let p = if z.is_finite() { two_sided(z) } else { 0.0 };
            let (shift, error) = (null.share(d), null.share(error));
            Some(Finding { statistic: statistic.clone(), shift, expected: null.mean, error, z, p, shared: p })
        };
        let findings: Vec<Finding> =
            self.statistics.iter().zip(&family.statistics).filter_map(finding).collect();
        (!findings.is_empty()).then(|| Outcome::new(findings))
    }

    /// The smallest relative shift of each statistic that the mean of `runs` runs shows with a probability of
    /// 99 % at the significance of the whole family; the difference for a scalar.
    #[must_use]
    pub fn power(&self, family: &Family, runs: usize, significance: f64) -> Vec<f64> {
        let all = || self.statistics.iter().zip(&family.statistics);
        let parts = all().filter(|(n, s)| is_part(s) && !is_merged(n, s)).count();
        let wholes = all().filter(|(_, s)| !is_part(s)).count();
        let shift = |(null, statistic): (&NullStatistic, &Statistic)| {
            // Undoes the two steps of sharing in `Outcome`.
            let n = if is_part(statistic) { parts } else { wholes };
            null.smallest_shift(runs, sidak_each(sidak_each(significance, 2), n))
        };
        self.statistics.iter().zip(&family.statistics).map(shift).collect()
    }
}

impl NullStatistic {
    fn new(values: Vec<f64>, third_moment: f64, scale: f64) -> Self {
        let m: Moments = values.iter().copied().collect();
        let (n, deviation) = (values.len() as f64, m.variance().sqrt());
        let scale = if scale > 0.0 { scale } else { 1.0 };
        let plain = Self {
            values,
            mean: m.mean,
            deviation,
            skewness: 0.0,
            scale,
            magnitude: 1.0,
            linear: [m.mean, deviation],
        };
        if deviation <= ROUNDING * scale {
            return Self { deviation: ROUNDING * scale, ..plain };
        }
        let own = plain.own_skewness();
        // Standard error of a normal sample's skewness.
        let error = (6.0 / n).sqrt();
        let pixels = third_moment / (deviation * deviation * deviation);
        let excess = (own.abs() - 2.0 * error).max(0.0);
        let skewness = if excess > pixels.abs() { excess.copysign(own) } else { pixels };
        let skewness = skewness.clamp(-MOST_SKEW, MOST_SKEW);
        Self { skewness, ..plain }
    }

    /// Third central moment over the cube of the deviation, from the values alone.
    fn own_skewness(&self) -> f64 {
        let n = self.values.len() as f64;
        let cubes: f64 =
            self.values.iter().map(|v| (v - self.mean) / self.deviation).map(|d| d * d * d).sum();
        cubes * n / ((n - 1.0) * (n - 2.0))
    }

    /// Standard errors from the mean, and the two-sided p-value, of the mean of some new runs; a difference up
    /// to `accepted` counts as none.
    #[must_use]
    pub fn compare(&self, value: f64, runs: usize, accepted: f64) -> (f64, f64) {
        if !value.is_finite() {
            return (f64::INFINITY, 0.0);
        }
        let d = value - self.mean;
        let d = (d.abs() - accepted).max(0.0).copysign(d);
        let (n, m) = (self.values.len() as f64, runs.max(1) as f64);
        let t = d / self.error(runs);
        let tail = 0.5 * student_two_sided(t, n - 1.0);
        let normal = normal_quantile(tail.clamp(f64::MIN_POSITIVE, 0.5)).abs().copysign(t);
        (t, skewed_two_sided(normal, self.skewness / m.sqrt()).max(0.0))
    }

    /// Standard error of the difference between the mean of some runs and that of the null runs.
    fn error(&self, runs: usize) -> f64 {
        self.deviation * self.spread(runs)
    }

    /// The same for a deviation of one.
    fn spread(&self, runs: usize) -> f64 {
        (1.0 / runs.max(1) as f64 + 1.0 / self.values.len() as f64).sqrt()
    }

    /// A difference as a share of all.
    fn share(&self, difference: f64) -> f64 {
        if self.magnitude > 0.0 { difference / self.magnitude } else { difference }
    }

    /// The shift that the mean of `runs` runs shows with a probability of 99 % at this significance, on the side
    /// where it is harder to see.
    fn smallest_shift(&self, runs: usize, significance: f64) -> f64 {
        /// Quantile of a power of 99 %.
        const POWER: f64 = 2.326;
        let error = self.error(runs);
        let p = |t: f64| self.compare(self.mean + t.copysign(self.skewness) * error, runs, 0.0).1;
        let (mut low, mut high) = (0.0, 4.0);
        while p(high) > significance && high < 1e6 {
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if p(middle) > significance { low = middle } else { high = middle }
        }
        (high + POWER) * error / self.scale
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

    /// A constant statistic accepts its value and what rounding makes of it, and nothing else; what is not a
    /// number is refused.
    #[test]
    fn constants_and_broken_values() {
        let constant = NullStatistic::new(vec![2.0; 64], 0.0, 2.0);
        assert_eq!(constant.compare(2.0, 1, 0.0).1, 1.0);
        assert!(constant.compare(2.000_001, 1, 0.0).1 > 0.5);
        assert!(constant.compare(2.000_1, 1, 0.0).1 < 1e-9);
        assert_eq!(constant.compare(f64::NAN, 1, 0.0).1, 0.0);
    }

    /// The smallest shift has the power that it says: a mean shifted by it is seen 99 times of 100, by the
    /// normal approximation of a run.
    #[test]
    fn a_shift_of_known_power() {
        let values: Vec<f64> = (0..64).map(|i| 10.0 + normal_quantile((f64::from(i) + 0.5) / 64.0)).collect();
        let null = NullStatistic::new(values, 0.0, 10.0);
        let shift = null.smallest_shift(4, 1e-5);
        let error = null.deviation * (1.0 / 4.0 + 1.0 / 64.0f64).sqrt();
        // One run of a hundred falls 2.326 errors short.
        let unlucky = null.mean + 10.0 * shift - 2.326 * error;
        let p = null.compare(unlucky, 4, 0.0).1;
        assert!((p / 1e-5 - 1.0).abs() < 1e-3, "{p}");
    }

    /// An accepted difference counts as none, on both sides, and what goes beyond it counts.
    #[test]
    fn accepted_differences() {
        let null =
            NullStatistic { deviation: 0.01, mean: 1.0, ..NullStatistic::new(vec![1.0; 64], 0.0, 1.0) };
        assert_eq!(null.compare(1.05, 1, 0.051).0, 0.0);
        assert_eq!(null.compare(0.95, 1, 0.06).0, 0.0);
        assert!(null.compare(1.10, 1, 0.05).0 > 4.0);
    }
}

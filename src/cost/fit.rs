//! A line through the errors of a way to render, and what it says of other times.
//!
//! In: E^2 of each seed at doubling numbers of samples. Out: log E = a - s log n by least squares over the last few,
//! with the interval of s from leaving out one seed after the other (the points of a seed depend on each other).
//!
//! Within the points, the line says how many samples an error takes. Beyond, the slope 1/2 of independent samples,
//! or the end of the interval of s that is nearest to it: a slope is believed only as far as it is proved. The
//! interval of the samples comes from the spread of E^2 over the seeds at the last point. Where errors grew, or are proved to
//! fall more slowly than the fourth root of samples, there is no line to continue: rare light that few samples have met so far
//! makes them so, and most of it may be missing yet.

use crate::stats::{Interval, slope, student_quantile};

/// Points at the end that the line goes through, at most.
const LAST: usize = 5;

/// The least slope that a line is continued with.
const SLOWEST: f64 = 0.25;

/// A line through errors over samples, both as logarithms.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Fit {
    /// s in log E = a - s log n.
    pub slope: Interval,
    /// Natural logarithm of E at one sample, as the line has it: a.
    pub intercept: f64,
    /// Samples of the first point of the line and of the last.
    pub over: [u32; 2],
    /// E at the last point.
    pub last: Interval,
}

impl Fit {
    /// Through the squared errors of all seeds at each number of samples, ascending; `None` below three points
    /// with an error, or two seeds.
    #[must_use]
    pub fn new(points: &[(u32, Vec<f64>)]) -> Option<Self> {
        let used = &points[points.len().saturating_sub(LAST)..];
        let seeds = used.first()?.1.len();
        if used.len() < 3 || seeds < 2 || used.iter().any(|(n, squares)| *n == 0 || squares.len() != seeds) {
            return None;
        }
        let line = |without: Option<usize>| {
            let at = |(n, squares): &(u32, Vec<f64>)| {
                let kept: Vec<f64> = (0..seeds).filter(|s| Some(*s) != without).map(|s| squares[s]).collect();
                let square = kept.iter().sum::<f64>() / kept.len() as f64;
                (square > 0.0).then(|| (libm::log(f64::from(*n)), 0.5 * libm::log(square)))
            };
            let at: Vec<(f64, f64)> = used.iter().map(at).collect::<Option<_>>()?;
            let s = -slope(&at);
            let n = at.len() as f64;
            let a = at.iter().map(|(x, y)| y + s * x).sum::<f64>() / n;
            Some([s, a])
        };
        let [s, intercept] = line(None)?;
        let without: Vec<[f64; 2]> = (0..seeds).map(|k| line(Some(k))).collect::<Option<_>>()?;
        let centre = without.iter().map(|l| l[0]).sum::<f64>() / seeds as f64;
        let spread: f64 = without.iter().map(|l| (l[0] - centre) * (l[0] - centre)).sum();
        let n = seeds as f64;
        let within = student_quantile(0.975, n - 1.0) * (spread * (n - 1.0) / n).sqrt();
        Some(Self {
            slope: Interval::around(s, within),
            intercept,
            over: [used.first()?.0, used.last()?.0],
            last: Interval::of_root(&used.last()?.1),
        })
    }

    /// Whether the errors fall as those of a picture do that converges, so that the line goes on.
    #[must_use]
    pub fn converges(&self) -> bool {
        self.slope.value > 0.0 && self.slope.high >= SLOWEST
    }

    /// The error after so many samples, positive; `None` beyond the points where it does not converge.
    #[must_use]
    pub fn error(&self, samples: f64) -> Option<f64> {
        let last = f64::from(self.over[1]);
        if samples <= last {
            Some(libm::exp(self.intercept - self.slope.value * libm::log(samples)))
        } else if self.converges() {
            Some(self.last.value * libm::exp(-self.slope_beyond() * libm::log(samples / last)))
        } else {
            None
        }
    }

    /// Samples that an error takes, both positive; `None` where it does not converge.
    #[must_use]
    pub fn samples(&self, error: f64) -> Option<Interval> {
        if !self.converges() {
            return None;
        }
        let last = f64::from(self.over[1]);
        let on_line = libm::exp((self.intercept - libm::log(error)) / self.slope.value);
        let beyond = |end: f64| last * libm::exp(libm::log(end / error) / self.slope_beyond());
        let value = if on_line <= last { on_line } else { beyond(self.last.value) };
        // How much the points vary is known best at the last one.
        let low = beyond(self.last.low) / beyond(self.last.value);
        let high = beyond(self.last.high) / beyond(self.last.value);
        Some(Interval { value, low: value * low, high: value * high })
    }

    /// What the error falls with beyond the last point.
    fn slope_beyond(&self) -> f64 {
        0.5f64.max(self.slope.low).min(self.slope.high).clamp(SLOWEST, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors e = 0.4 n^-s, each seed with a factor of its own.
    fn points(s: f64, seeds: &[f64]) -> Vec<(u32, Vec<f64>)> {
        let at = |k: u32| {
            let n = 1u32 << k;
            let e = 0.4 * libm::pow(f64::from(n), -s);
            (n, seeds.iter().map(|f| f * e * e).collect())
        };
        (0..7).map(at).collect()
    }

    fn samples(fit: &Fit, error: f64) -> Interval {
        fit.samples(error).expect("errors that fall")
    }

    /// A line that is known comes back, and what it says of other times.
    #[test]
    fn known_lines_come_back() {
        let fit = Fit::new(&points(0.5, &[1.0, 1.0, 1.0])).expect("enough points");
        assert!((fit.slope.value - 0.5).abs() < 1e-12 && fit.over == [4, 64], "{fit:?}");
        assert!((fit.error(16.0).expect("within") / 0.1 - 1.0).abs() < 1e-9);
        assert!((samples(&fit, 0.1).value / 16.0 - 1.0).abs() < 1e-9, "within the points");
        assert!((samples(&fit, 0.01).value / 1600.0 - 1.0).abs() < 1e-9, "beyond them");
        assert!((fit.error(1600.0).expect("it falls") / 0.01 - 1.0).abs() < 1e-9);
    }

    /// A slope that is proved is believed beyond the points; one that could be 1/2 is not.
    #[test]
    fn slopes_are_believed_as_far_as_they_are_proved() {
        let steep = Fit::new(&points(0.75, &[1.0, 1.0, 1.0])).expect("enough points");
        let error = steep.last.value / 8.0;
        assert!((samples(&steep, error).value / (64.0 * 16.0) - 1.0).abs() < 1e-9, "{steep:?}");
        // Seeds of which some fall faster than others: the mean slope is not proved to be another than 1/2.
        let mut mixed = points(0.5, &[1.0; 4]);
        for (n, squares) in &mut mixed {
            squares[0] *= libm::pow(f64::from(*n), 0.4);
            squares[1] *= libm::pow(f64::from(*n), -0.6);
        }
        let fit = Fit::new(&mixed).expect("enough points");
        assert!(fit.slope.low < 0.5 && fit.slope.high > 0.5, "{fit:?}");
        let ratio = samples(&fit, 0.5 * fit.last.value).value / 64.0;
        assert!((ratio - 4.0).abs() < 1e-9, "{ratio}");
    }

    /// The interval is that of the seeds: of squares with a relative standard error of 10 %, by Student's t with
    /// three degrees of freedom 3.18 of them.
    #[test]
    fn intervals_come_from_the_seeds() {
        let fit = Fit::new(&points(0.5, &[0.8, 0.8, 1.2, 1.2])).expect("enough points");
        let relative = 3.182_446_3 * (0.16 / 3.0 / 4.0f64).sqrt();
        let expected = libm::exp(0.5 * relative);
        assert!((fit.last.high / fit.last.value / expected - 1.0).abs() < 1e-6, "{fit:?}");
        let samples = samples(&fit, 0.01);
        assert!((samples.high / samples.value / (expected * expected) - 1.0).abs() < 1e-6, "{samples:?}");
        assert!(samples.low < samples.value);
    }

    /// Errors that grow, be it by chance, have no price, nor those that fall too slowly to be those of noise.
    #[test]
    fn what_does_not_converge_has_no_price() {
        let mut grows = points(0.1, &[1.0; 4]);
        // One seed meets rare light late.
        grows[6].1[0] *= 40.0;
        let fit = Fit::new(&grows).expect("enough points");
        assert!(fit.slope.value < 0.0 && fit.slope.high > 0.25 && !fit.converges(), "{fit:?}");
        assert!(fit.samples(0.01).is_none() && fit.error(128.0).is_none() && fit.error(32.0).is_some());
        assert!(!Fit::new(&points(0.1, &[1.0; 4])).expect("enough points").converges());
    }

    /// Too little to draw a line through, and errors that are none.
    #[test]
    fn no_line_through_too_little() {
        let all = points(0.5, &[1.0, 1.0]);
        assert!(Fit::new(&all[..2]).is_none() && Fit::new(&[]).is_none());
        assert!(Fit::new(&points(0.5, &[1.0])).is_none());
        assert!(Fit::new(&points(0.5, &[0.0, 0.0])).is_none());
    }
}

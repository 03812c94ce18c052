//! Figures with their 95 % intervals.

use super::{Moments, student_quantile};

/// A figure with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Interval {
    /// The figure.
    pub value: f64,
    /// Where it is in 95 of 100 measurements: from.
    pub low: f64,
    /// To.
    pub high: f64,
}

impl Interval {
    /// A figure, and as much on both sides of it.
    #[must_use]
    pub fn around(value: f64, within: f64) -> Self {
        Self { value, low: value - within, high: value + within }
    }

    /// Mean of numbers about normal, by Student's t; the whole line where there are fewer than two.
    #[must_use]
    pub fn of_mean(values: &[f64]) -> Self {
        let m: Moments = values.iter().copied().collect();
        let within = match m.n {
            0 | 1 => f64::INFINITY,
            n => student_quantile(0.975, (n - 1) as f64) * m.variance_of_mean().sqrt(),
        };
        Self::around(m.mean, within)
    }

    /// Root of the mean of positive squares: their interval is a factor, as is that of what spreads by factors.
    #[must_use]
    pub fn of_root(squares: &[f64]) -> Self {
        let square = Self::of_mean(squares);
        let value = square.value.max(0.0).sqrt();
        let relative = if square.value > 0.0 { square.within() / square.value } else { 0.0 };
        let factor = libm::exp(0.5 * relative);
        Self { value, low: value / factor, high: value * factor }
    }

    /// Every end times a positive number.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { value: self.value * factor, low: self.low * factor, high: self.high * factor }
    }

    /// The root of every end, zero where that is negative.
    #[must_use]
    pub fn root(self) -> Self {
        let root = |x: f64| x.max(0.0).sqrt();
        Self { value: root(self.value), low: root(self.low), high: root(self.high) }
    }

    /// Lower and upper end.
    #[must_use]
    pub fn ends(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Half its width.
    #[must_use]
    pub fn within(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// Whether a number lies in it.
    #[must_use]
    pub fn holds(&self, x: f64) -> bool {
        (self.low..=self.high).contains(&x)
    }

    /// Whether the figure is zero as far as can be seen.
    #[must_use]
    pub fn may_be_zero(&self) -> bool {
        self.holds(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: the mean of 1, 2 and 3 is 2, its standard error 1 / sqrt 3, and Student's t with two degrees of
    /// freedom 4.302653. Of one number nothing is known.
    #[test]
    fn means_have_the_intervals_of_students_t() {
        let found = Interval::of_mean(&[1.0, 2.0, 3.0]);
        assert_eq!(found.value, 2.0);
        assert!((found.within() - 4.302_652_73 / 3.0f64.sqrt()).abs() < 1e-6, "{found:?}");
        assert!(found.may_be_zero() && found.holds(4.48) && !found.holds(4.49));
        assert_eq!(Interval::of_mean(&[5.0]).ends(), [f64::NEG_INFINITY, f64::INFINITY]);
    }

    /// Roots of squares: the root of the mean, and an interval that is a factor; what is negative is zero.
    #[test]
    fn roots_are_of_squares() {
        let found = Interval::of_root(&[4.0, 4.0, 4.0]);
        assert_eq!((found.value, found.low, found.high), (2.0, 2.0, 2.0));
        let spread = Interval::of_root(&[3.0, 4.0, 5.0]);
        assert!((spread.high / spread.value - spread.value / spread.low).abs() < 1e-12, "{spread:?}");
        assert_eq!(Interval::around(3.0, 6.0).root(), Interval { value: 3.0f64.sqrt(), low: 0.0, high: 3.0 });
        assert!(!Interval::around(-2.0, 1.0).may_be_zero());
    }
}

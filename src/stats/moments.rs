//! Means, variances, and the difference of two means.

use super::student_two_sided;

/// Count, mean and unbiased variance of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Number of values.
    pub n: u64,
    /// Their mean; zero where there are none.
    pub mean: f64,
    /// Sum of squared deviations from the mean.
    deviations: f64,
}

impl Moments {
    /// Adds a value (Welford, Technometrics 4(3), 1962).
    pub fn add(&mut self, x: f64) {
        self.n += 1;
        let d = x - self.mean;
        self.mean += d / self.n as f64;
        self.deviations += d * (x - self.mean);
    }

    /// Unbiased variance of one value; infinite below two values.
    #[must_use]
    pub fn variance(&self) -> f64 {
        if self.n < 2 { f64::INFINITY } else { self.deviations / (self.n - 1) as f64 }
    }

    /// Variance of the mean; infinite below two values.
    #[must_use]
    pub fn variance_of_mean(&self) -> f64 {
        self.variance() / self.n as f64
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|x| moments.add(x));
        moments
    }
}

/// Result of [`welch`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use = "a test does nothing until its result is reported"]
pub struct Welch {
    /// Difference of the means over its standard error.
    pub t: f64,
    /// Degrees of freedom.
    pub freedom: f64,
    /// Probability of a difference at least as large where there is none.
    pub p: f64,
}

/// Tests whether two samples of unequal variance have the same mean (Welch, Biometrika 34, 1947, with
/// Satterthwaite's degrees of freedom); `None` where a sample has fewer than two values.
pub fn welch(a: &Moments, b: &Moments) -> Option<Welch> {
    if a.n < 2 || b.n < 2 {
        return None;
    }
    let (va, vb) = (a.variance_of_mean(), b.variance_of_mean());
    let d = a.mean - b.mean;
    if va + vb == 0.0 {
        let (t, p) = if d == 0.0 { (0.0, 1.0) } else { (f64::INFINITY.copysign(d), 0.0) };
        return Some(Welch { t, freedom: (a.n + b.n - 2) as f64, p });
    }
    let t = d / (va + vb).sqrt();
    let freedom = (va + vb) * (va + vb) / (va * va / (a.n - 1) as f64 + vb * vb / (b.n - 1) as f64);
    Some(Welch { t, freedom, p: student_two_sided(t, freedom) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_a_small_sample() {
        let m: Moments = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0].into_iter().collect();
        assert_eq!((m.n, m.mean), (8, 5.0));
        assert!((m.variance() - 32.0 / 7.0).abs() < 1e-14);
        assert_eq!(Moments::default().variance(), f64::INFINITY);
    }

    /// A large common offset does not eat the variance, as it would in mean of squares minus square of mean.
    #[test]
    fn moments_survive_an_offset() {
        let m: Moments = (0..1000).map(|i| 1e9 + f64::from(i % 2)).collect();
        assert!((m.variance() - 250.0 / 999.0).abs() < 1e-6, "{}", m.variance());
    }

    /// The formula by hand for {1, 2, 3, 4} and {2, 4, 6}: variances of the means 5/12 and 4/3, so
    /// t = -1.5 / sqrt(1.75) and 1.75^2 / ((5/12)^2/3 + (4/3)^2/2) degrees of freedom.
    #[test]
    fn welch_by_hand() {
        let a: Moments = [1.0, 2.0, 3.0, 4.0].into_iter().collect();
        let b: Moments = [2.0, 4.0, 6.0].into_iter().collect();
        let w = welch(&a, &b).unwrap();
        assert!((w.t + 1.5 / 1.75f64.sqrt()).abs() < 1e-14);
        assert!((w.freedom - 3.0625 / (25.0 / 432.0 + 8.0 / 9.0)).abs() < 1e-12, "{}", w.freedom);
        assert!(w.p > 0.3 && w.p < 0.4, "{}", w.p);
    }

    /// Two constants differ surely or not at all; a single value says nothing.
    #[test]
    fn welch_of_constants() {
        let constant = |v: f64| [v; 3].into_iter().collect::<Moments>();
        assert_eq!(welch(&constant(1.0), &constant(1.0)).unwrap().p, 1.0);
        assert_eq!(welch(&constant(1.0), &constant(2.0)).unwrap().p, 0.0);
        assert_eq!(welch(&constant(1.0), &[1.0].into_iter().collect()), None);
    }
}

//! Probabilities: normal, Student's t, and many tests at once.

use statrs::distribution::{ContinuousCDF, StudentsT};
use statrs::function::erf::{erfc, erfc_inv};

/// The two-sided 95 % quantile of the normal distribution.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Probability that a standard normal number is at most `z`: erfc(-z / sqrt 2) / 2, accurate in both
/// tails (Abramowitz and Stegun, 7.1 and 26.2).
#[must_use]
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// The `z` that a standard normal number stays below with probability `p` in (0, 1); infinite at the ends.
#[must_use]
pub fn normal_quantile(p: f64) -> f64 {
    -std::f64::consts::SQRT_2 * erfc_inv(2.0 * p)
}

/// Probability that a standard normal number is at least as far from zero as `z`.
#[must_use]
pub fn two_sided(z: f64) -> f64 {
    erfc(z.abs() * std::f64::consts::FRAC_1_SQRT_2)
}

/// Probability that a number of Student's t distribution with `freedom` degrees of freedom (positive,
/// need not be whole) is at least as far from zero as `t`.
#[must_use]
pub fn student_two_sided(t: f64, freedom: f64) -> f64 {
    // Above this the two agree to all digits that a report prints, and the series is slow.
    const NORMAL_FROM: f64 = 1e6;
    if freedom >= NORMAL_FROM || !t.is_finite() {
        return two_sided(t);
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |d| 2.0 * d.cdf(-t.abs()))
}

/// The number that Student's t with `freedom` degrees of freedom (positive, need not be whole) stays below with
/// probability `p` in (0, 1).
#[must_use]
pub fn student_quantile(p: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |d| d.inverse_cdf(p))
}

/// Probability that the smallest of `n` independent p-values is at most `p`: 1 - (1 - p)^n
/// (Šidák, JASA 62(318), 1967). For positively dependent tests it is an upper bound.
#[must_use]
pub fn sidak(p: f64, n: usize) -> f64 {
    -libm::expm1(n as f64 * libm::log1p(-p.clamp(0.0, 1.0)))
}

/// The p-value of one test out of `n` whose [`sidak`] value is `p`: what each may claim so that all together keep a
/// significance of `p`.
#[must_use]
pub fn sidak_each(p: f64, n: usize) -> f64 {
    -libm::expm1(libm::log1p(-p) / n.max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values from Abramowitz and Stegun, table 26.1, and a far tail where 1 - cdf would be zero.
    #[test]
    fn normal_distribution_has_its_table_values() {
        for (z, p) in [(0.0, 0.5), (1.0, 0.841_344_746_07), (-1.959_963_985, 0.025), (-6.0, 9.865_876_45e-10)]
        {
            assert!((normal_cdf(z) / p - 1.0).abs() < 1e-8, "{z}: {}", normal_cdf(z));
            assert!((normal_quantile(p) - z).abs() < 1e-7, "{p}: {}", normal_quantile(p));
        }
        assert!((two_sided(10.0) / 1.523_970_604e-23 - 1.0).abs() < 1e-6, "{}", two_sided(10.0));
    }

    /// Values from the same book, table 26.10: t with 3 and 10 degrees of freedom at 5 %.
    #[test]
    fn student_distribution_has_its_table_values() {
        for (t, freedom, p) in [(3.182_446_3, 3.0, 0.05), (2.228_138_9, 10.0, 0.05), (-63.656_741, 1.0, 0.01)]
        {
            assert!((student_two_sided(t, freedom) / p - 1.0).abs() < 1e-5, "{t} {freedom}");
            assert!((student_quantile(0.5 * p, freedom) / -t.abs() - 1.0).abs() < 1e-5, "{t} {freedom}");
        }
        assert!((student_two_sided(2.0, 1e5) - two_sided(2.0)).abs() < 1e-5);
        assert_eq!(student_two_sided(f64::INFINITY, 3.0), 0.0);
    }

    #[test]
    fn sidak_shares_the_significance() {
        assert!((sidak(0.05, 1) - 0.05).abs() < 1e-15);
        assert!((sidak(0.5, 2) - 0.75).abs() < 1e-15);
        assert!((sidak(1e-20, 1000) / 1e-17 - 1.0).abs() < 1e-12, "tiny values survive");
        assert_eq!(sidak(1.0, 10), 1.0);
    }
}

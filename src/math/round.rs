//! Bounds on rounding.

/// Bound on the relative error of `n` roundings in a row: n u / (1 - n u) with u = 2^-24
/// (Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed., lemma 3.1).
#[inline]
#[must_use]
pub const fn gamma(n: u32) -> f32 {
    const U: f32 = f32::EPSILON * 0.5;
    (n as f32 * U) / (1.0 - n as f32 * U)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gamma_grows_with_the_number_of_roundings() {
        assert!(gamma(1) > 0.5 * f32::EPSILON);
        assert!(gamma(3) > 2.9 * gamma(1) && gamma(7) < 1e-6);
    }
}

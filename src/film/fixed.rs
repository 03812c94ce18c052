//! Fixed point numbers.

/// Converts between `f32` and integers whose least bit is 2^-70 of a power of two.
///
/// A value within 2^46 of the scale keeps all its bits; smaller ones are cut off towards zero at
/// 2^-70 of the scale. Values up to 2^40 times the scale are accepted, so that 2^17 of the largest, or
/// any number of ordinary ones, add up without overflow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedPoint {
    scale: f32,
    to_int: f64,
    from_int: f64,
}

impl FixedPoint {
    const BITS: f64 = 1_180_591_620_717_411_303_424.0; // 2^70
    const LARGEST: f32 = 1_099_511_627_776.0; // 2^40

    /// The format for values around `magnitude`, which is rounded up to a power of two.
    #[must_use]
    pub fn around(magnitude: f32) -> Self {
        let magnitude = magnitude.clamp(1e-30, 1e30);
        let floor = crate::math::floor_pow2(magnitude);
        let scale = if floor < magnitude { 2.0 * floor } else { floor };
        let to_int = Self::BITS / f64::from(scale);
        Self { scale, to_int, from_int: 1.0 / to_int }
    }

    /// The power of two that the format is made for.
    #[must_use]
    pub fn scale(&self) -> f32 {
        self.scale
    }

    /// True where `v` can be represented; false for NaN.
    #[inline]
    #[must_use]
    pub fn holds(&self, v: f32) -> bool {
        v.abs() <= Self::LARGEST * self.scale
    }

    /// The integer for `v`, which must be held.
    #[inline]
    #[must_use]
    pub fn encode(&self, v: f32) -> i128 {
        // Exact: a product with a power of two.
        (f64::from(v) * self.to_int) as i128
    }

    /// `sum / n` as a real number.
    #[inline]
    #[must_use]
    pub fn mean(&self, sum: i128, n: u32) -> f64 {
        if n == 0 { 0.0 } else { sum as f64 * self.from_int / f64::from(n) }
    }

    /// The same within two roundings, for estimates: processors know integers of 64 bits.
    #[inline]
    #[must_use]
    pub fn about_mean(&self, sum: i128, n: u32) -> f64 {
        const HIGH: f64 = 18_446_744_073_709_551_616.0; // 2^64
        let size = sum.unsigned_abs();
        let about = (size >> 64) as u64 as f64 * HIGH + size as u64 as f64;
        let about = if sum < 0 { -about } else { about };
        if n == 0 { 0.0 } else { about * self.from_int / f64::from(n) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinary_values_survive_exactly() {
        for scale in [1.0, 14.0, 1e-6, 3e7f32] {
            let f = FixedPoint::around(scale);
            assert!(f.scale() >= scale && f.scale() < 2.0 * scale);
            for v in [0.0, 1.0, 0.1, 1e-9, 12345.678] {
                let v = v * scale;
                assert!(f.holds(v));
                assert_eq!(f.mean(f.encode(v), 1) as f32, v);
            }
            assert!(!f.holds(f32::NAN) && !f.holds(f32::INFINITY) && f.holds(1e6 * scale));
        }
    }

    /// Guards the quick mean: signs, and both halves of the integer.
    #[test]
    fn the_quick_mean_is_the_mean() {
        let f = FixedPoint::around(1.0);
        for sum in [0, 1, -1, 1 << 63, 1 << 64, -(1 << 64) - 1, i128::from(u64::MAX), 12345 << 70, -(7 << 90)]
        {
            let (exact, about) = (f.mean(sum, 3), f.about_mean(sum, 3));
            assert!((about - exact).abs() <= 4e-16 * exact.abs(), "{sum}: {about} {exact}");
        }
    }

    /// N62: a hundred million samples of one tenth add up without drift.
    #[test]
    fn sums_do_not_drift() {
        let f = FixedPoint::around(1.0);
        let sum = f.encode(0.1) * 100_000_000;
        assert_eq!(f.mean(sum, 100_000_000) as f32, 0.1);
    }

    /// Guards means for estimates against exact ones: sums of either sign, from the least bit to the largest.
    #[test]
    fn about_is_within_roundings() {
        let f = FixedPoint::around(3.0);
        for bits in 0..127 {
            for sum in [1i128 << bits, (1 << bits) + 12_345, (1 << bits) / 3 * 2] {
                for sum in [sum, -sum] {
                    let [about, exact] = [f.about_mean(sum, 7), f.mean(sum, 7)];
                    assert!(
                        (about - exact).abs() <= 4.0 * f64::EPSILON * exact.abs(),
                        "{sum}: {about} {exact}"
                    );
                }
            }
        }
        assert_eq!([f.about_mean(0, 7), f.about_mean(1 << 70, 0)], [0.0; 2]);
    }
}

//! Singles as JSON numbers.

use crate::color::Rgb;

/// The double with the fewest decimal digits that reads back as this single.
pub(super) fn single(value: f32) -> f64 {
    match value.to_string().parse::<f64>() {
        Ok(short) if (short as f32).to_bits() == value.to_bits() => short,
        _ => value.into(),
    }
}

/// The same for a colour.
pub(super) fn color(c: Rgb) -> [f64; 3] {
    c.to_array().map(single)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file says 0.1 and not 0.10000000149011612, and still means the same single.
    #[test]
    fn singles_are_short_and_exact() {
        assert_eq!(single(0.1), 0.1);
        assert_eq!(single(f32::MAX), 3.402_823_5e38);
        for i in 0..10_000_u32 {
            let value = f32::from_bits(i.wrapping_mul(4_294_967)).abs();
            if value.is_finite() {
                assert_eq!(single(value) as f32, value);
            }
        }
    }
}

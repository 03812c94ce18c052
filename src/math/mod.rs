//! Named numerics.
//!
//! Everything that could differ between CPUs or that needs a guard has a name here. Transcendental
//! functions come from the `libm` crate and nowhere else (clippy's `disallowed-methods` bans the
//! standard library's, whose results depend on the platform); only `sqrt` is used directly, since
//! IEEE 754 defines it to the last bit. No function here uses fused multiply-add.

mod frame;
mod round;
mod trig;

pub use frame::{Frame, orthonormal_basis};
pub use round::gamma;
pub use trig::{sin_cos, sin_cos_turn};

use glam::Vec3;

/// pi.
pub const PI: f32 = std::f32::consts::PI;
/// 1 / pi.
pub const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
/// The largest value below one: every uniform number is at most this.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// Sine of `x` radians.
#[inline]
#[must_use]
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of `x` radians.
#[inline]
#[must_use]
pub fn cos(x: f32) -> f32 {
    libm::cosf(x)
}

/// Angle of the point (x, y), in (-pi, pi].
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// e^x.
#[inline]
#[must_use]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Natural logarithm.
#[must_use]
pub fn ln(x: f32) -> f32 {
    libm::logf(x)
}

/// x^y.
#[must_use]
pub fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}

/// Square root whose argument may have been rounded slightly below zero.
#[inline]
#[must_use]
pub fn safe_sqrt(x: f32) -> f32 {
    x.max(0.0).sqrt()
}

/// `x * x`.
#[inline]
#[must_use]
pub fn sqr(x: f32) -> f32 {
    x * x
}

/// `x^5`, as products.
#[inline]
#[must_use]
pub fn pow5(x: f32) -> f32 {
    let x2 = x * x;
    x2 * x2 * x
}

/// Mirrors `wo` about `n`; both leave the surface, so does the result.
#[inline]
#[must_use]
pub fn reflect(wo: Vec3, n: Vec3) -> Vec3 {
    n * (2.0 * wo.dot(n)) - wo
}

/// The largest power of two that is at most `x`, for a positive, finite, normal `x`.
#[must_use]
pub fn floor_pow2(x: f32) -> f32 {
    debug_assert!(x.is_normal() && x > 0.0);
    f32::from_bits(x.to_bits() & 0x7f80_0000)
}

/// FNV-1a of some bytes, 64 bits (Fowler, Noll and Vo): the number of a name.
#[must_use]
pub fn fnv1a(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let step = |h: u64, b: u8| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3);
    bytes.into_iter().fold(0xcbf2_9ce4_8422_2325, step)
}

/// 64-bit mixing function (the finaliser of SplitMix64, Steele et al., OOPSLA 2014).
#[inline]
#[must_use]
pub fn mix64(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floor_pow2_is_a_power_at_most_x() {
        for x in [1.0, 1.5, 1.999, 2.0, 0.3, 1e-20, 3e30_f32] {
            let p = floor_pow2(x);
            assert!(p <= x && x < 2.0 * p, "{x} {p}");
        }
    }
}

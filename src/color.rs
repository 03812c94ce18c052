//! Linear colour.
//!
//! [`Rgb`] is always linear Rec. 709, whether it is a reflectance, a radiance or a throughput; what
//! is encoded for a screen has its own type, [`Srgb8`], so that the two cannot be mixed up.

use std::ops::{Add, AddAssign, Div, Index, Mul, MulAssign, Neg, Sub};

use crate::math;

/// Linear Rec. 709 colour: a reflectance in [0, 1], or a radiometric quantity per channel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rgb {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
}

/// Display-encoded sRGB, eight bits a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Srgb8(pub [u8; 3]);

impl Rgb {
    /// No light, or a surface that absorbs everything.
    pub const BLACK: Self = Self::grey(0.0);
    /// One in every channel.
    pub const WHITE: Self = Self::grey(1.0);

    /// A colour from its channels.
    #[inline]
    #[must_use]
    pub const fn new(r: f32, g: f32, b: f32) -> Self {
        Self { r, g, b }
    }

    /// The same value in every channel.
    #[inline]
    #[must_use]
    pub const fn grey(v: f32) -> Self {
        Self::new(v, v, v)
    }

    /// Relative luminance Y of Rec. 709 primaries (ITU-R BT.709, item 3.2).
    #[inline]
    #[must_use]
    pub fn luminance(self) -> f32 {
        0.2126 * self.r + 0.7152 * self.g + 0.0722 * self.b
    }

    /// The largest channel.
    #[inline]
    #[must_use]
    pub fn max_channel(self) -> f32 {
        self.r.max(self.g).max(self.b)
    }

    /// The smallest channel.
    #[inline]
    #[must_use]
    pub fn min_channel(self) -> f32 {
        self.r.min(self.g).min(self.b)
    }

    /// True where every channel is zero.
    #[inline]
    #[must_use]
    pub fn is_black(self) -> bool {
        self.r == 0.0 && self.g == 0.0 && self.b == 0.0
    }

    /// True where no channel is NaN or infinite.
    #[inline]
    #[must_use]
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }

    /// Applies `f` to each channel.
    #[inline]
    #[must_use]
    pub fn map(self, mut f: impl FnMut(f32) -> f32) -> Self {
        Self::new(f(self.r), f(self.g), f(self.b))
    }

    /// The channels as an array, red first.
    #[inline]
    #[must_use]
    pub const fn to_array(self) -> [f32; 3] {
        [self.r, self.g, self.b]
    }

    /// A mixture: `self` where `t` is 0, `other` where it is 1.
    #[inline]
    #[must_use]
    pub fn lerp(self, other: Self, t: f32) -> Self {
        self * (1.0 - t) + other * t
    }

    /// Per-channel exponential.
    #[must_use]
    pub fn exp(self) -> Self {
        self.map(math::exp)
    }
}

impl From<[f32; 3]> for Rgb {
    fn from([r, g, b]: [f32; 3]) -> Self {
        Self { r, g, b }
    }
}

impl Index<usize> for Rgb {
    type Output = f32;
    fn index(&self, i: usize) -> &f32 {
        match i {
            0 => &self.r,
            1 => &self.g,
            _ => &self.b,
        }
    }
}

impl Add for Rgb {
    type Output = Self;
    #[inline]
    fn add(self, o: Self) -> Self {
        Self::new(self.r + o.r, self.g + o.g, self.b + o.b)
    }
}

impl Sub for Rgb {
    type Output = Self;
    #[inline]
    fn sub(self, o: Self) -> Self {
        Self::new(self.r - o.r, self.g - o.g, self.b - o.b)
    }
}

impl Mul for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, o: Self) -> Self {
        Self::new(self.r * o.r, self.g * o.g, self.b * o.b)
    }
}

impl Mul<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn mul(self, s: f32) -> Self {
        Self::new(self.r * s, self.g * s, self.b * s)
    }
}

impl Mul<Rgb> for f32 {
    type Output = Rgb;
    #[inline]
    fn mul(self, c: Rgb) -> Rgb {
        c * self
    }
}

impl Div<f32> for Rgb {
    type Output = Self;
    #[inline]
    fn div(self, s: f32) -> Self {
        Self::new(self.r / s, self.g / s, self.b / s)
    }
}

impl Neg for Rgb {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.r, -self.g, -self.b)
    }
}

impl AddAssign for Rgb {
    #[inline]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl MulAssign for Rgb {
    #[inline]
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl MulAssign<f32> for Rgb {
    #[inline]
    fn mul_assign(&mut self, s: f32) {
        *self = *self * s;
    }
}

/// Decodes one sRGB-encoded value in [0, 1] to linear (IEC 61966-2-1).
#[must_use]
pub fn srgb_to_linear(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { math::pow((v + 0.055) / 1.055, 2.4) }
}

/// Encodes one linear value in [0, 1] to sRGB (IEC 61966-2-1).
#[must_use]
pub fn linear_to_srgb(v: f32) -> f32 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * math::pow(v, 1.0 / 2.4) - 0.055 }
}

/// Linear Rec. 709 colour of a black body of `kelvin`, scaled so that its luminance is one.
///
/// The chromaticity is the cubic fit of the Planckian locus by Kim et al. (US patent 7024034, 2002),
/// for 1667 K to 25000 K; temperatures outside are taken as the nearer end. Channels that fall
/// outside Rec. 709 are cut at zero.
#[must_use]
pub fn blackbody(kelvin: f32) -> Rgb {
    let t = kelvin.clamp(1667.0, 25_000.0);
    let (i, i2, i3) = (1e3 / t, 1e6 / (t * t), 1e9 / (t * t * t));
    let x = if t <= 4000.0 {
        -0.266_123_9 * i3 - 0.234_358_9 * i2 + 0.877_695_6 * i + 0.179_910
    } else {
        -3.025_847 * i3 + 2.107_037_9 * i2 + 0.222_634_7 * i + 0.240_390
    };
    let (x2, x3) = (x * x, x * x * x);
    let y = if t <= 2222.0 {
        -1.106_381_4 * x3 - 1.348_110_2 * x2 + 2.185_558_3 * x - 0.202_196_83
    } else if t <= 4000.0 {
        -0.954_947_6 * x3 - 1.374_185_9 * x2 + 2.091_37 * x - 0.167_488_67
    } else {
        3.081_758 * x3 - 5.873_387 * x2 + 3.751_13 * x - 0.370_014_83
    };
    let (big_x, big_z) = (x / y, (1.0 - x - y) / y);
    let c = Rgb::new(
        3.240_454_2 * big_x - 1.537_138_5 - 0.498_531_4 * big_z,
        -0.969_266 * big_x + 1.876_010_8 + 0.041_556 * big_z,
        0.055_643_4 * big_x - 0.204_025_9 + 1.057_225_2 * big_z,
    )
    .map(|v| v.max(0.0));
    c / c.luminance()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_encoding_round_trips() {
        for i in 0..=255u8 {
            let v = f32::from(i) / 255.0;
            assert!((linear_to_srgb(srgb_to_linear(v)) - v).abs() < 1e-6);
        }
    }

    #[test]
    fn daylight_is_nearly_white_and_candles_are_orange() {
        let d65 = blackbody(6500.0);
        assert!((d65.r / d65.b - 1.0).abs() < 0.1, "{d65:?}");
        let candle = blackbody(1900.0);
        assert!(candle.r > 2.0 * candle.g && candle.g > 3.0 * candle.b, "{candle:?}");
        assert!((candle.luminance() - 1.0).abs() < 1e-6);
    }
}

//! Sine and cosine for hot code, as polynomials.
//!
//! On [-pi/4, pi/4] the absolute error is at most 8e-8 and the relative error of the sine 7e-8; the
//! coefficients are a least-maximum-error fit made for this file. Everything else is reduction to
//! that interval, done exactly or in `f64`.

/// Sine and cosine of `r` in [-pi/4, pi/4].
#[inline]
fn kernel(r: f32) -> (f32, f32) {
    let r2 = r * r;
    let sin = r + r * r2 * (-0.166_666_55 + r2 * (0.008_332_176 - r2 * 0.000_195_169_75));
    let cos = 1.0 - 0.5 * r2 + r2 * r2 * (0.041_666_646 + r2 * (-0.001_388_736_4 + r2 * 2.443_808_4e-5));
    (sin, cos)
}

#[inline]
fn quadrant(q: i32, (sin, cos): (f32, f32)) -> (f32, f32) {
    match q & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Sine and cosine of `u` full turns, for |u| up to about a million.
#[inline]
#[must_use]
pub fn sin_cos_turn(u: f32) -> (f32, f32) {
    let q = (4.0 * u).round();
    // Exact: 4u is, and its distance to the nearest integer is representable.
    quadrant(q as i32, kernel((4.0 * u - q) * std::f32::consts::FRAC_PI_2))
}

/// Sine and cosine of `x` radians, for |x| up to about a million.
#[inline]
#[must_use]
pub fn sin_cos(x: f32) -> (f32, f32) {
    let q = (f64::from(x) * std::f64::consts::FRAC_2_PI).round();
    quadrant(q as i32, kernel((f64::from(x) - q * std::f64::consts::FRAC_PI_2) as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_f64() {
        for i in -4000..=4000 {
            let x = i as f32 * 0.005;
            let (s, c) = sin_cos(x);
            assert!((f64::from(s) - libm::sin(f64::from(x))).abs() < 1.5e-7, "{x}");
            assert!((f64::from(c) - libm::cos(f64::from(x))).abs() < 1.5e-7, "{x}");
            let u = i as f32 / 4000.0;
            let (s, c) = sin_cos_turn(u);
            let a = 2.0 * std::f64::consts::PI * f64::from(u);
            assert!(
                (f64::from(s) - libm::sin(a)).abs() < 1.5e-7 && (f64::from(c) - libm::cos(a)).abs() < 1.5e-7,
                "{u}"
            );
        }
        let tiny = 1e-6;
        assert!((sin_cos(tiny).0 / tiny - 1.0).abs() < 1e-6, "small angles keep their relative accuracy");
    }
}

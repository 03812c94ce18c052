//! From linear radiance to a picture for a screen: exposure, then a tone curve.
//!
//! In: linear Rec. 709 radiance. Out: display-encoded values in [0, 1] and their eight bits. The
//! invariant: every curve is monotone in a grey input, and its result is a function of the pixel alone
//! (no dither), so that equal images make equal files.
//!
//! Sources: IEC 61966-2-1 for sRGB; for AgX the configuration published by Troy Sobotka, whose
//! constants and matrices are those of B. Wrensch, "Minimal AgX Implementation" (2023), with the sigmoid
//! computed from its defining equations instead of the polynomial fitted to it; for Khronos PBR Neutral
//! the specification in KhronosGroup/ToneMapping, `PBR_Neutral` (2024).

use crate::color::{Rgb, Srgb8, linear_to_srgb};
use crate::math;
use crate::mutants::planted;
use crate::scene::ToneCurve;

/// Radiance to a displayable pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tone {
    /// The curve.
    pub curve: ToneCurve,
    /// Stops by which radiance is raised before the curve.
    pub exposure: f32,
}

impl Tone {
    /// The display-encoded colour of a finite radiance, each channel in [0, 1].
    #[must_use]
    pub fn encode(&self, radiance: Rgb) -> Rgb {
        let gain = libm::exp2f(self.exposure);
        // A finite radiance may overflow here; the largest float keeps the curves' quotients defined.
        let c = radiance.map(|v| (v * gain).clamp(0.0, f32::MAX));
        match self.curve {
            ToneCurve::Srgb => c.map(|v| linear_to_srgb(v.min(1.0))),
            ToneCurve::Sqrt => c.map(|v| v.min(1.0).sqrt()),
            ToneCurve::Linear => c.map(|v| v.min(1.0)),
            ToneCurve::Agx => agx(c).map(linear_to_srgb),
            ToneCurve::Neutral => neutral(c).map(linear_to_srgb),
        }
    }

    /// The eight-bit colour of a finite radiance.
    #[must_use]
    pub fn to_srgb8(&self, radiance: Rgb) -> Srgb8 {
        Srgb8(planted!(gamma_twice(self.encode(radiance))).to_array().map(to_byte))
    }
}

/// The nearest of 256 levels; `v` in [0, 1].
#[must_use]
pub(super) fn to_byte(v: f32) -> u8 {
    (v * 255.0 + 0.5) as u8
}

/// AgX's base look: linear light for an sRGB screen, [0, 1].
fn agx(c: Rgb) -> Rgb {
    let log = multiply(&AGX_INSET, c).map(|v| {
        let stops = libm::log2f(v.max(f32::MIN_POSITIVE)).clamp(AGX_MIN_EV, AGX_MAX_EV);
        (stops - AGX_MIN_EV) / (AGX_MAX_EV - AGX_MIN_EV)
    });
    // The curve is made for a display of plain exponent 2.2, which is undone here.
    multiply(&AGX_OUTSET, log.map(agx_sigmoid)).map(|v| math::pow(v.clamp(0.0, 1.0), 2.2))
}

/// log2 of the radiance that becomes black: ten stops below 0.18.
const AGX_MIN_EV: f32 = -12.473_931;
/// log2 of the radiance that becomes white: 6.5 stops above 0.18.
const AGX_MAX_EV: f32 = 4.026_069;

/// Rows of the matrix that moves the primaries inwards.
const AGX_INSET: [[f32; 3]; 3] = [
    [0.842_479_06, 0.078_433_6, 0.079_223_745],
    [0.042_328_242, 0.878_468_64, 0.079_166_13],
    [0.042_375_655, 0.078_433_6, 0.879_143],
];

/// Its inverse.
const AGX_OUTSET: [[f32; 3]; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];

/// AgX's curve over normalised log radiance: through (10/16.5, 0.5) with slope 2, and two hyperbolas of
/// power 3 (toe) and 3.25 (shoulder) that reach (0, 0) and (1, 1).
fn agx_sigmoid(x: f32) -> f32 {
    const PIVOT: f32 = 10.0 / 16.5;
    const SLOPE: f32 = 2.0;
    // The scale with which a hyperbola that leaves the pivot reaches `end_y` after `end_x`.
    let scale = |end_x: f32, end_y: f32, power: f32| {
        let reach = math::pow(SLOPE * end_x / end_y, power) - 1.0;
        math::pow(math::pow(SLOPE * end_x, -power) * reach, -1.0 / power)
    };
    let branch = |distance: f32, end_x: f32, power: f32| {
        let scale = scale(end_x, 0.5, power);
        let t = SLOPE * distance / scale;
        scale * t / math::pow(1.0 + math::pow(t, power), 1.0 / power)
    };
    if x < PIVOT { 0.5 - branch(PIVOT - x, PIVOT, 3.0) } else { 0.5 + branch(x - PIVOT, 1.0 - PIVOT, 3.25) }
}

/// Khronos PBR Neutral: linear light for an sRGB screen, [0, 1].
fn neutral(c: Rgb) -> Rgb {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    // The Fresnel reflection that a white room adds to a base colour is taken out.
    let x = c.min_channel();
    let offset = if x < 0.08 { x - 6.25 * x * x } else { 0.04 };
    let c = c - Rgb::grey(offset);
    let peak = c.max_channel();
    if peak < START {
        return c.map(|v| v.max(0.0));
    }
    // Highlights are compressed, then lose saturation.
    let d = 1.0 - START;
    let new_peak = 1.0 - d * d / (peak + d - START);
    let c = c.map(|v| v / peak * new_peak);
    let g = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    c.lerp(Rgb::grey(new_peak), g).map(|v| v.clamp(0.0, 1.0))
}

fn multiply(rows: &[[f32; 3]; 3], c: Rgb) -> Rgb {
    // Scaled sums could overflow for the largest floats; they are far above every curve's white.
    let c = c.map(|v| v.min(1e30));
    Rgb::from(rows.map(|[r, g, b]| r * c.r + g * c.g + b * c.b))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVES: [ToneCurve; 5] =
        [ToneCurve::Srgb, ToneCurve::Agx, ToneCurve::Neutral, ToneCurve::Sqrt, ToneCurve::Linear];

    fn level(curve: ToneCurve, exposure: f32, v: f32) -> u8 {
        Tone { curve, exposure }.to_srgb8(Rgb::grey(v)).0[1]
    }

    /// Middle grey, black, white and one stop of exposure have the levels that the sources give.
    #[test]
    fn known_greys() {
        let cases = [
            (ToneCurve::Srgb, 0.0, 0.18, 118),
            (ToneCurve::Srgb, 1.0, 0.09, 118),
            (ToneCurve::Srgb, 0.0, 1.0, 255),
            (ToneCurve::Srgb, -1.0, 2.0, 255),
            (ToneCurve::Sqrt, 0.0, 0.25, 128),
            (ToneCurve::Linear, 0.0, 0.5, 128),
            // 0.5 on a display of exponent 2.2, written for an sRGB display.
            (ToneCurve::Agx, 0.0, 0.18, 128),
            // The specification subtracts 0.04 of a bright enough grey: 0.14 is left.
            (ToneCurve::Neutral, 0.0, 0.18, 105),
        ];
        for (curve, exposure, v, expected) in cases {
            assert_eq!(level(curve, exposure, v), expected, "{curve:?} {exposure} {v}");
        }
        for curve in CURVES {
            assert_eq!(level(curve, 0.0, 0.0), 0, "{curve:?}");
            assert_eq!(level(curve, 0.0, -1.0), 0, "{curve:?}");
        }
    }

    /// Brighter never becomes darker, and nothing leaves [0, 1], up to the largest float.
    #[test]
    fn curves_are_monotone_and_in_range() {
        for curve in CURVES {
            for exposure in [-3.0, 0.0, 120.0] {
                let mut last = 0.0;
                for i in -40..256 {
                    let v = libm::exp2f(i as f32 * 0.5).min(f32::MAX);
                    let e = Tone { curve, exposure }.encode(Rgb::grey(v)).g;
                    assert!((last - 1e-6..=1.0).contains(&e), "{curve:?} {v}: {e} after {last}");
                    last = e;
                }
                assert!(last > 0.98, "{curve:?} ends at {last}");
            }
        }
    }

    /// Saturated and extreme colours stay in range too.
    #[test]
    fn colours_stay_in_range() {
        for curve in CURVES {
            for c in [[1e38, 0.0, 0.0], [0.0, 0.9, 3.0], [f32::MAX; 3], [0.5, 1e-30, 7.0]] {
                let e = Tone { curve, exposure: 0.0 }.encode(Rgb::from(c));
                assert!(e.min_channel() >= 0.0 && e.max_channel() <= 1.0, "{curve:?} {c:?} -> {e:?}");
            }
        }
    }

    /// The sigmoid agrees with the sixth-order polynomial that was published as a fit to it.
    #[test]
    fn agx_sigmoid_matches_the_published_fit() {
        for i in 0..=100 {
            let x = i as f32 / 100.0;
            let fit =
                (((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.002_32;
            assert!((agx_sigmoid(x) - fit).abs() < 0.007, "{x}: {} and {fit}", agx_sigmoid(x));
        }
    }

    /// Inset and outset undo each other, and keep greys grey.
    #[test]
    fn agx_matrices_are_inverse() {
        let c = Rgb::new(0.9, 0.2, 0.4);
        let back = multiply(&AGX_OUTSET, multiply(&AGX_INSET, c));
        assert!((back - c).map(f32::abs).max_channel() < 1e-5, "{back:?}");
    }

    /// A base colour well below one keeps its hue under the neutral curve: that is its purpose.
    #[test]
    fn neutral_keeps_base_colours() {
        let c = neutral(Rgb::new(0.7, 0.3, 0.1));
        assert!((c - Rgb::new(0.66, 0.26, 0.06)).map(f32::abs).max_channel() < 1e-6, "{c:?}");
    }
}

//! FLIP: the difference that an observer sees who flips between two pictures.
//!
//! In: two display-encoded sRGB pictures of equal size. Out: a value in [0, 1] per pixel. Source:
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for
//! Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020, with its letters; the
//! low-dynamic-range form, its constants, and 67 pixels per degree (a 4K screen 0.7 m wide, seen from
//! 0.7 m). It is a help for eyes and no test: it may overlook what statistics find, and shows harmless
//! noise.

use crate::color::{Rgb, srgb_to_linear};
use crate::math;

/// Pixels per degree of visual angle.
const PPD: f32 = 67.0;
/// Exponents of the colour and of the feature difference.
const QC: f32 = 0.7;
const QF: f32 = 0.5;
/// Colour differences below `PC` of the largest are stretched over [0, `PT`].
const PC: f32 = 0.4;
const PT: f32 = 0.95;
/// Width of the feature detectors, degrees.
const W: f32 = 0.082;

/// The FLIP value of each pixel, row by row; `a` and `b` are display-encoded, [0, 1], with `width` pixels
/// a row. Symmetric, and zero where the pictures agree around a pixel.
///
/// # Panics
/// Where the lengths differ, or are no multiple of `width`.
#[must_use]
pub fn flip(a: &[Rgb], b: &[Rgb], width: usize) -> Vec<f32> {
    assert!(a.len() == b.len() && a.len().is_multiple_of(width.max(1)), "pictures of one size");
    let [(a_lab, a_edges, a_points), (b_lab, b_edges, b_points)] = [a, b].map(|picture| {
        let opponent = Planes::opponent(picture, width);
        let (edges, points) = features(&opponent.y);
        (seen(opponent), edges, points)
    });
    let furthest = math::pow(hyab(hunt(Rgb::new(0.0, 1.0, 0.0)), hunt(Rgb::new(0.0, 0.0, 1.0))), QC);
    (0..a.len())
        .map(|i| {
            let colour = redistribute(math::pow(hyab(a_lab[i], b_lab[i]), QC), furthest);
            let feature = (a_edges[i] - b_edges[i]).abs().max((a_points[i] - b_points[i]).abs());
            let feature = math::pow(feature * std::f32::consts::FRAC_1_SQRT_2, QF).min(1.0);
            if colour == 0.0 { feature_alone(feature) } else { math::pow(colour, 1.0 - feature) }
        })
        .collect()
}

/// 0^(1 - feature): zero, but one where the feature difference is total.
fn feature_alone(feature: f32) -> f32 {
    if feature >= 1.0 { 1.0 } else { 0.0 }
}

/// One plane of a picture.
struct Plane {
    width: usize,
    values: Vec<f32>,
}

/// A picture in the linear opponent space YCxCz.
struct Planes {
    y: Plane,
    cx: Plane,
    cz: Plane,
}

impl Planes {
    fn opponent(picture: &[Rgb], width: usize) -> Self {
        let mut planes = [const { Vec::new() }; 3];
        for c in picture {
            let [x, y, z] = relative_xyz(c.map(srgb_to_linear));
            for (plane, v) in planes.iter_mut().zip([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]) {
                plane.push(v);
            }
        }
        let [y, cx, cz] = planes.map(|values| Plane { width, values });
        Self { y, cx, cz }
    }
}

impl Plane {
    /// The sum over (dx, dy) of `across[dx] * down[dy]` times the pixel there; pixels outside take the
    /// value of the nearest inside. Both kernels have odd length.
    fn filtered(&self, across: &[f32], down: &[f32]) -> Vec<f32> {
        let (width, height) = (self.width, self.values.len() / self.width.max(1));
        let mut rows = vec![0.0; self.values.len()];
        let radius = across.len() / 2;
        for (row, out) in self.values.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
            for (x, out) in out.iter_mut().enumerate() {
                let at = |i: usize| row[(x + i).saturating_sub(radius).min(width - 1)];
                *out = across.iter().enumerate().map(|(i, k)| k * at(i)).sum();
            }
        }
        let radius = down.len() / 2;
        let mut result = vec![0.0; rows.len()];
        for (y, out) in result.chunks_exact_mut(width).enumerate() {
            for (i, k) in down.iter().enumerate() {
                let from = (y + i).saturating_sub(radius).min(height - 1) * width;
                for (out, v) in out.iter_mut().zip(&rows[from..from + width]) {
                    *out += k * v;
                }
            }
        }
        result
    }
}

/// What remains of a picture at this distance: each opponent channel through its contrast sensitivity
/// (section 4.1.1), then CIELAB with Hunt's effect (4.1.2, 4.1.3).
fn seen(p: Planes) -> Vec<Rgb> {
    let y = sensitivity(&p.y, &[(1.0, 0.0047)]);
    let cx = sensitivity(&p.cx, &[(1.0, 0.0053)]);
    let cz = sensitivity(&p.cz, &[(34.1, 0.04), (13.5, 0.025)]);
    let pixel = |((y, cx), cz): ((&f32, &f32), &f32)| {
        let y_relative = (y + 16.0) / 116.0;
        let xyz = [cx / 500.0 + y_relative, y_relative, y_relative - cz / 200.0];
        hunt(linear_rgb(xyz).map(|v| v.clamp(0.0, 1.0)))
    };
    y.iter().zip(&cx).zip(&cz).map(pixel).collect()
}

/// Filters with a sum of Gaussians a sqrt(pi/b) exp(-pi^2 x^2 / b), x in degrees, normalised as a whole.
fn sensitivity(plane: &Plane, terms: &[(f32, f32)]) -> Vec<f32> {
    const WIDEST_B: f32 = 0.04;
    let radius = (3.0 * (WIDEST_B / (2.0 * math::PI * math::PI)).sqrt() * PPD).ceil() as i32;
    let kernels: Vec<(f32, Vec<f32>)> = terms
        .iter()
        .map(|&(a, b)| {
            let gauss = |i: i32| {
                let x = i as f32 / PPD;
                math::exp(-math::PI * math::PI * x * x / b)
            };
            (a * (math::PI / b).sqrt(), (-radius..=radius).map(gauss).collect())
        })
        .collect();
    let total: f32 = kernels.iter().map(|(a, k)| a * math::sqr(k.iter().sum())).sum();
    let mut result = vec![0.0; plane.values.len()];
    for (a, kernel) in &kernels {
        for (out, v) in result.iter_mut().zip(plane.filtered(kernel, kernel)) {
            *out += a / total * v;
        }
    }
    result
}

/// Strength of edges and of points in the luminance plane (section 4.2).
fn features(y: &Plane) -> (Vec<f32>, Vec<f32>) {
    let normalised = Plane { width: y.width, values: y.values.iter().map(|v| (v + 16.0) / 116.0).collect() };
    let sd = 0.5 * W * PPD;
    let radius = (3.0 * sd).ceil() as i32;
    let sample = |f: &dyn Fn(f32) -> f32| (-radius..=radius).map(|i| f(i as f32)).collect::<Vec<_>>();
    let gauss = |x: f32| math::exp(-x * x / (2.0 * sd * sd));
    let smooth = unit_positive(sample(&gauss));
    let strength = |kernel: Vec<f32>| -> Vec<f32> {
        let kernel = unit_positive(kernel);
        let (across, down) = (normalised.filtered(&kernel, &smooth), normalised.filtered(&smooth, &kernel));
        across.iter().zip(&down).map(|(x, y)| (x * x + y * y).sqrt()).collect()
    };
    let edges = strength(sample(&|x| -x * gauss(x)));
    let points = strength(sample(&|x| (x * x / (sd * sd) - 1.0) * gauss(x)));
    (edges, points)
}

/// Scales positive weights to a sum of one and negative ones to minus one.
fn unit_positive(kernel: Vec<f32>) -> Vec<f32> {
    let positive: f32 = kernel.iter().filter(|v| **v > 0.0).sum();
    let negative: f32 = -kernel.iter().filter(|v| **v < 0.0).sum::<f32>();
    kernel
        .into_iter()
        .map(|v| {
            if v > 0.0 {
                v / positive
            } else if v < 0.0 {
                v / negative
            } else {
                0.0
            }
        })
        .collect()
}

/// Maps differences to [0, 1], most of the range for the small ones (equation 18).
fn redistribute(difference: f32, furthest: f32) -> f32 {
    let knee = PC * furthest;
    if difference < knee {
        PT / knee * difference
    } else {
        (PT + (difference - knee) / (furthest - knee) * (1.0 - PT)).min(1.0)
    }
}

/// City-block distance in lightness, Euclidean in chroma.
fn hyab(a: Rgb, b: Rgb) -> f32 {
    let d = a - b;
    d.r.abs() + (d.g * d.g + d.b * d.b).sqrt()
}

/// CIELAB of a linear colour, as (L*, a*, b*), with chroma scaled by lightness (Hunt's effect).
fn hunt(c: Rgb) -> Rgb {
    let f = |t: f32| {
        const DELTA: f32 = 6.0 / 29.0;
        if t > DELTA * DELTA * DELTA { libm::cbrtf(t) } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = relative_xyz(c).map(f);
    let l = 116.0 * y - 16.0;
    Rgb::new(l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z))
}

/// CIE XYZ of linear Rec. 709, each divided by its value for white.
fn relative_xyz(c: Rgb) -> [f32; 3] {
    XYZ.map(|[r, g, b]| (r * c.r + g * c.g + b * c.b) / (r + g + b))
}

/// The inverse of [`relative_xyz`].
fn linear_rgb(relative: [f32; 3]) -> Rgb {
    let [x, y, z] = std::array::from_fn(|i| relative[i] * XYZ[i].iter().sum::<f32>());
    Rgb::from(RGB.map(|[a, b, c]| a * x + b * y + c * z))
}

/// Linear Rec. 709 to CIE XYZ, white D65 (IEC 61966-2-1).
const XYZ: [[f32; 3]; 3] = [
    [0.412_390_8, 0.357_584_34, 0.180_480_8],
    [0.212_639, 0.715_168_7, 0.072_192_32],
    [0.019_330_818, 0.119_194_78, 0.950_532_15],
];

/// Its inverse.
const RGB: [[f32; 3]; 3] = [
    [3.240_97, -1.537_383_2, -0.498_610_76],
    [-0.969_243_65, 1.875_967_5, 0.041_555_06],
    [0.055_630_08, -0.203_976_96, 1.056_971_5],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mix64;

    const WIDTH: usize = 40;

    fn noise(seed: u64) -> Vec<Rgb> {
        let value = |i: u64| (mix64(seed << 32 | i) >> 40) as f32 / (1u64 << 24) as f32;
        (0..(WIDTH * 30) as u64).map(|i| Rgb::new(value(3 * i), value(3 * i + 1), value(3 * i + 2))).collect()
    }

    fn mean(map: &[f32]) -> f32 {
        map.iter().sum::<f32>() / map.len() as f32
    }

    /// A picture does not differ from itself, and the order of two does not matter.
    #[test]
    fn zero_for_equal_and_symmetric() {
        let (a, b) = (noise(1), noise(2));
        assert_eq!(mean(&flip(&a, &a, WIDTH)), 0.0);
        assert_eq!(flip(&a, &b, WIDTH), flip(&b, &a, WIDTH));
        assert!(mean(&flip(&a, &b, WIDTH)) > 0.1);
    }

    /// Flat colours have no features, so the values follow from the colour pipeline alone: lightness 100
    /// apart is 100^0.7 = 25.119 of at most 41.28 (green to blue), past the knee at 0.4 of that.
    #[test]
    fn flat_pictures_have_the_closed_form() {
        let flat = |c: Rgb| vec![c; WIDTH * 30];
        let green_blue = flip(&flat(Rgb::new(0.0, 1.0, 0.0)), &flat(Rgb::new(0.0, 0.0, 1.0)), WIDTH);
        assert!((mean(&green_blue) - 1.0).abs() < 1e-3, "{}", mean(&green_blue));
        let black_white = flip(&flat(Rgb::BLACK), &flat(Rgb::WHITE), WIDTH);
        assert!((mean(&black_white) - 0.967).abs() < 2e-3, "{}", mean(&black_white));
        let least = black_white.iter().copied().fold(1.0, f32::min);
        assert!((mean(&black_white) - least).abs() < 1e-4, "the border is like the middle");
    }

    /// A feature that appears counts for more than its colour alone, and nothing leaves [0, 1].
    #[test]
    fn features_add_to_the_difference() {
        let grey = vec![Rgb::grey(0.5); WIDTH * 30];
        let mut dot = grey.clone();
        let middle = 15 * WIDTH + 20;
        dot[middle] = Rgb::WHITE;
        let map = flip(&grey, &dot, WIDTH);
        assert!(map.iter().all(|v| (0.0..=1.0).contains(v)));
        assert!(map[middle] > 0.2, "{}", map[middle]);
        assert_eq!(map[0], 0.0, "far away nothing is seen");
    }

    /// Larger differences have larger values.
    #[test]
    fn grows_with_the_difference() {
        let grey = |v: f32| vec![Rgb::grey(v); WIDTH * 30];
        let mut last = 0.0;
        for i in 1..=10 {
            let v = mean(&flip(&grey(0.0), &grey(i as f32 / 10.0), WIDTH));
            assert!(v > last, "{i}: {v} after {last}");
            last = v;
        }
    }

    /// The values that the authors' own program (flip-evaluator 1.7, low dynamic range, 67 pixels per
    /// degree) gives for the same two pictures: mean, two corners, the middle, and a pixel near a border.
    #[test]
    fn agrees_with_the_authors_program() {
        let map = flip(&noise(1), &noise(2), WIDTH);
        let check =
            |found: f32, expected: f32| assert!((found - expected).abs() < 2e-4, "{found} {expected}");
        check(mean(&map), 0.448_559_5);
        for ([x, y], expected) in
            [([0, 0], 0.732_446_4), ([20, 15], 0.537_082_5), ([39, 29], 0.459_389_1), ([17, 3], 0.741_147_3)]
        {
            check(map[y * WIDTH + x], expected);
        }
    }

    #[test]
    fn matrices_are_inverse() {
        let c = Rgb::new(0.2, 0.7, 0.4);
        assert!((linear_rgb(relative_xyz(c)) - c).map(f32::abs).max_channel() < 1e-5);
    }
}

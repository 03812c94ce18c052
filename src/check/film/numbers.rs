//! Uniform numbers.

use rand::RngExt as _;

use crate::check::random::Random;
use crate::check::stage::seed;
use crate::check::{Effort, Figure};
use crate::sampling::{Address, Discrete, Purpose, unit_f32};

const ONE_BELOW: f64 = 1.0 - 1.0 / 16_777_216.0;

pub(super) fn below_one(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N68");
    let trials = effort.trials(500_000);
    let (mut outside, mut largest) = (0u64, 0.0f32);
    for i in 0..trials {
        let address = Address::new(random.bits(), i, 0, random.bits() as u32);
        for u in address.block(i as u32 % 8, Purpose::Test, 0, 0) {
            outside += u64::from(!(0.0..1.0).contains(&u));
            largest = largest.max(u);
        }
        // As `rand`'s distributions draw it.
        let u: f32 = address.stream(0, Purpose::Test, 0).random();
        outside += u64::from(!(0.0..1.0).contains(&u));
    }
    // The largest number falls into the last of many choices, and is stretched to less than one within it.
    let mut stretched = 0.0f64;
    for n in [1, 2, 3, 7, 1000] {
        let weights: Vec<f64> = (0..n).map(|i| 1.0 + f64::from(i % 3)).collect();
        let inner = Discrete::new(&weights).sample(ONE_BELOW as f32).map_or(f64::NAN, |(_, _, u)| u.into());
        stretched = if inner.is_nan() { f64::INFINITY } else { stretched.max(inner) };
    }
    vec![
        Figure::exactly("2^32 - 1 as a uniform number", unit_f32(u32::MAX).into(), ONE_BELOW),
        Figure::exactly("0 as a uniform number", unit_f32(0).into(), 0.0),
        Figure::exactly(format!("numbers outside [0, 1), of {}", 5 * trials), outside as f64, 0.0),
        Figure::at_most(format!("largest of {} numbers", 4 * trials), largest.into(), ONE_BELOW),
        Figure::at_most("largest number stretched within a choice", stretched, ONE_BELOW),
    ]
}

/// Eight uses of four numbers each; what a path draws at its first vertices.
const USES: [(u32, Purpose); 8] = [
    (0, Purpose::Camera),
    (0, Purpose::Light),
    (0, Purpose::Bsdf),
    (1, Purpose::Light),
    (1, Purpose::Bsdf),
    (2, Purpose::Light),
    (2, Purpose::Bsdf),
    (3, Purpose::Bsdf),
];
const LOG: u32 = 16;
const POINTS: usize = 1 << LOG;

/// The 32 dimensions of many points, each a list over the points.
fn dimensions(points: impl Iterator<Item = Address>) -> Vec<Vec<f32>> {
    let mut dimensions = vec![Vec::new(); 4 * USES.len()];
    for address in points {
        for (of, &(depth, purpose)) in dimensions.chunks_exact_mut(4).zip(&USES) {
            for (values, u) in of.iter_mut().zip(address.block(depth, purpose, 0, 0)) {
                values.push(u);
            }
        }
    }
    dimensions
}

/// The samples of a pixel, in their order.
fn of_pixel(pixel: u64, samples: u32) -> Vec<Vec<f32>> {
    dimensions((0..samples).map(|index| Address::new(seed("N69"), pixel, 0, index)))
}

/// Chi-square of equally likely cells.
fn chi2(counts: &[u32], n: usize) -> f64 {
    let expected = n as f64 / counts.len() as f64;
    counts.iter().map(|&c| (f64::from(c) - expected) * (f64::from(c) - expected) / expected).sum()
}

/// The largest chi-square over 16 x 16 boxes, and the largest correlation, of all pairs of dimensions.
fn worst(dimensions: &[Vec<f32>]) -> [f64; 2] {
    let (mut most, mut r) = (0.0f64, 0.0f64);
    for (i, a) in dimensions.iter().enumerate() {
        for b in &dimensions[..i] {
            let mut counts = vec![0u32; 256];
            for (&x, &y) in a.iter().zip(b) {
                counts[(((x * 16.0) as usize) << 4 | (y * 16.0) as usize).min(255)] += 1;
            }
            most = most.max(chi2(&counts, a.len()));
            r = r.max(correlation(a, b).abs());
        }
    }
    [most, r]
}

/// How many standard deviations a chi-square lies above what chance gives, by the cube root of Wilson and
/// Hilferty (PNAS 17, 1931).
fn chi2_z(chi2: f64, freedom: f64) -> f64 {
    let v = 2.0 / (9.0 * freedom);
    (libm::cbrt(chi2 / freedom) - (1.0 - v)) / v.sqrt()
}

fn correlation(a: &[f32], b: &[f32]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(&x, &y)| (f64::from(x) - 0.5) * (f64::from(y) - 0.5)).sum();
    12.0 * sum / a.len() as f64
}

pub(super) fn uniform(_: Effort) -> Vec<Figure> {
    let dimensions = of_pixel(7, 1 << LOG);
    // Elementary intervals: of 2^16 points each of 2^k by 2^(16 - k) boxes holds exactly one.
    let mut uneven = 0u64;
    for of in dimensions.chunks_exact(4) {
        for k in 0..=LOG {
            let mut counts = vec![0u32; POINTS];
            for (&x, &y) in of[0].iter().zip(&of[1]) {
                let column = (f64::from(x) * f64::from(1u32 << k)) as usize;
                let row = (f64::from(y) * f64::from(1u32 << (LOG - k))) as usize;
                counts[((column << (LOG - k)) | row).min(POINTS - 1)] += 1;
            }
            uneven += counts.iter().filter(|&&c| c != 1).count() as u64;
        }
        for values in of {
            let mut counts = vec![0u32; POINTS];
            values.iter().for_each(|&x| counts[((x * POINTS as f32) as usize).min(POINTS - 1)] += 1);
            uneven += counts.iter().filter(|&&c| c != 1).count() as u64;
        }
    }
    let [in_sequence, r] = worst(&dimensions);
    // One sample each of the pixels of a picture: nothing is stratified, and chance decides alone.
    let pixels = (0..POINTS as u64).map(|pixel| Address::new(seed("N69"), pixel, 0, 5));
    let [over_pixels, r_over_pixels] = worst(&self::dimensions(pixels));
    // The same use at neighbouring pixels, and at the pixels of a large picture's next row.
    const FEW: u32 = 1 << 13;
    let pixels = [7, 8, 9, 7 + 1920, 8 + 1920].map(|pixel| of_pixel(pixel, FEW));
    let mut between = 0.0f64;
    for (i, a) in pixels.iter().enumerate() {
        for b in &pixels[..i] {
            for (a, b) in a.iter().zip(b) {
                between = between.max(correlation(a, b).abs());
            }
        }
    }
    let bound = |n: u32| 4.5 / f64::from(n).sqrt();
    let pairs = "of 496 pairs of dimensions, 2^16";
    vec![
        Figure::exactly(
            "elementary intervals of 2^16 points without exactly one, of 8 uses",
            uneven as f64,
            0.0,
        ),
        Figure::at_most(
            format!("z of chi-square of 16 x 16 boxes, largest {pairs} pixels"),
            chi2_z(over_pixels, 255.0),
            4.5,
        ),
        Figure::at_most(format!("|r|, largest {pairs} pixels"), r_over_pixels, bound(1 << LOG)),
        // Of the samples of one pixel any 16 in a row fill each row and each column of boxes once, in an order
        // that a shuffle of a tree of 16 leaves decides. So chi-square is no chi-square of 255 degrees of
        // freedom: it is 16 X(1) + 8 X(4) + 4 X(16) + 2 X(64) of such with the degrees in parentheses, a term
        // for each level of the tree. Its mean is 240, and one in 7e-6 has one of 448 pairs above 772.
        Figure::at_most(format!("chi-square of 16 x 16 boxes, largest {pairs} samples"), in_sequence, 772.0),
        Figure::at_most(format!("|r|, largest {pairs} samples"), r, bound(1 << LOG)),
        Figure::at_most("|r|, largest of 320 pairs of pixels and uses, 2^13 samples", between, bound(FEW)),
    ]
}

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

/// The 32 dimensions of the samples of a pixel, each a list over the samples.
fn dimensions(pixel: u64, points: usize) -> Vec<Vec<f32>> {
    let mut dimensions = vec![Vec::with_capacity(points); 4 * USES.len()];
    for index in 0..points as u32 {
        let address = Address::new(seed("N69"), pixel, 0, index);
        for (of, &(depth, purpose)) in dimensions.chunks_exact_mut(4).zip(&USES) {
            for (values, u) in of.iter_mut().zip(address.block(depth, purpose, 0, 0)) {
                values.push(u);
            }
        }
    }
    dimensions
}

/// How many standard deviations the chi-square of equally likely cells lies above what chance gives, by the
/// cube root of Wilson and Hilferty (PNAS 17, 1931).
fn chi2_z(counts: &[u32], n: usize) -> f64 {
    let expected = n as f64 / counts.len() as f64;
    let chi2: f64 = counts.iter().map(|&c| (f64::from(c) - expected) * (f64::from(c) - expected) / expected).sum();
    let k = (counts.len() - 1) as f64;
    (libm::cbrt(chi2 / k) - (1.0 - 2.0 / (9.0 * k))) / (2.0 / (9.0 * k)).sqrt()
}

fn correlation(a: &[f32], b: &[f32]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(&x, &y)| (f64::from(x) - 0.5) * (f64::from(y) - 0.5)).sum();
    12.0 * sum / a.len() as f64
}

pub(super) fn uniform(_: Effort) -> Vec<Figure> {
    let dimensions = dimensions(7, POINTS);
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
    let (mut chi2, mut r) = (f64::NEG_INFINITY, 0.0f64);
    for (i, a) in dimensions.iter().enumerate() {
        for b in &dimensions[..i] {
            let mut counts = vec![0u32; 256];
            for (&x, &y) in a.iter().zip(b) {
                counts[(((x * 16.0) as usize) << 4 | (y * 16.0) as usize).min(255)] += 1;
            }
            chi2 = chi2.max(chi2_z(&counts, POINTS));
            r = r.max(correlation(a, b).abs());
        }
    }
    // The same use at neighbouring pixels, and at the pixels of a large picture's next row.
    const FEW: usize = 1 << 13;
    let pixels: Vec<Vec<Vec<f32>>> =
        [7, 8, 9, 7 + 1920, 8 + 1920].map(|pixel| self::dimensions(pixel, FEW)).into();
    let mut between = 0.0f64;
    for (i, a) in pixels.iter().enumerate() {
        for b in &pixels[..i] {
            for (a, b) in a.iter().zip(b) {
                between = between.max(correlation(a, b).abs());
            }
        }
    }
    let bound = |n: usize| 4.5 / (n as f64).sqrt();
    vec![
        Figure::exactly("elementary intervals of 2^16 points without exactly one, of 8 uses", uneven as f64, 0.0),
        Figure::at_most("chi-square of 16 x 16 boxes, largest z of 496 pairs of dimensions", chi2, 4.5),
        Figure::at_most("|r| of 2^16 points, largest of 496 pairs of dimensions", r, bound(POINTS)),
        Figure::at_most("|r| of 2^13 points, largest of 320 pairs of pixels and dimensions", between, bound(FEW)),
    ]
}

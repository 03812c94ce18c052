//! How fast the mean of a sequence of samples converges.

use crate::check::stage::seed;
use crate::check::{Effort, Figure};
use crate::sampling::{Address, Purpose};
use crate::stats;

/// Sequences whose squared errors are averaged.
const SEQUENCES: u64 = 256;
/// Numbers of samples, as powers of two.
const LOGS: [u32; 5] = [4, 6, 8, 10, 12];

/// Slopes of the error over samples, both as logarithms. Independent samples have -1/2; Owen-scrambled points
/// have about -3/2 for smooth integrands (Owen, Annals of Statistics 25, 1997) and -3/4 across a slanted edge.
pub(super) fn convergence(_: Effort) -> Vec<Figure> {
    use std::f64::consts::{FRAC_PI_2, PI};
    let smooth = |u: f64, v: f64| FRAC_PI_2 * libm::sin(PI * u) * FRAC_PI_2 * libm::sin(PI * v) - 1.0;
    let step = |u: f64, v: f64| if u + 1.3 * v < 1.0 { 1.0 } else { 0.0 } - 0.5 / 1.3;
    vec![
        Figure::at_most("slope of the error, smooth integrand, 16 to 4096 samples", slope(smooth), -1.2),
        Figure::at_most("slope of the error, slanted edge, 16 to 4096 samples", slope(step), -0.65),
    ]
}

/// Of an integrand over the unit square whose mean is zero.
fn slope(f: impl Fn(f64, f64) -> f64) -> f64 {
    let error = |log: u32| {
        let n = 1u32 << log;
        let square = |pixel: u64| {
            let value = |i: u32| {
                let [u, v, ..] = Address::new(seed("N70"), pixel, 0, i).block(0, Purpose::Test, 0, 0);
                f(u.into(), v.into())
            };
            let mean = (0..n).map(value).sum::<f64>() / f64::from(n);
            mean * mean
        };
        0.5 * libm::log((0..SEQUENCES).map(square).sum::<f64>() / SEQUENCES as f64)
    };
    let points: Vec<(f64, f64)> =
        LOGS.iter().map(|&l| (f64::from(l) * std::f64::consts::LN_2, error(l))).collect();
    stats::slope(&points)
}

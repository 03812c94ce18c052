//! Integration rules of the reference integrator's tables.

use std::f64::consts::PI;

/// Nodes in (0, 1) and weights of Gauss's rule of `n` nodes, by Newton's iteration on the Legendre
/// polynomial.
pub(super) fn gauss(n: usize) -> Vec<[f64; 2]> {
    let node = |i: usize| {
        let mut x = libm::cos(PI * (i as f64 + 0.75) / (n as f64 + 0.5));
        let mut slope = 1.0;
        for _ in 0..100 {
            let (mut p, mut before) = (1.0, 0.0);
            for k in 0..n {
                let k = k as f64;
                (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
            }
            slope = n as f64 * (x * p - before) / (x * x - 1.0);
            let step = p / slope;
            x -= step;
            if step.abs() < 1e-15 {
                break;
            }
        }
        [0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..n).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the rule: exact for polynomials, here the integrals of 1, x^2 and x^9 over (0, 1).
    #[test]
    fn gauss_integrates_polynomials() {
        let rule = gauss(8);
        let integral =
            |power: u32| -> f64 { rule.iter().map(|[x, w]| w * (0..power).fold(1.0, |p, _| p * x)).sum() };
        for (power, expected) in [(0, 1.0), (2, 1.0 / 3.0), (9, 0.1)] {
            assert!((integral(power) - expected).abs() < 1e-14, "{power}: {}", integral(power));
        }
    }
}

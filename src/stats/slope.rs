//! A line through points.

/// Slope of the line of least squares through points (x, y); zero where their x are all the same.
#[must_use]
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len().max(1) as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / n, b + y / n));
    let (sxy, sxx) =
        points.iter().fold((0.0, 0.0), |(a, b), p| (a + (p.0 - x) * (p.1 - y), b + (p.0 - x) * (p.0 - x)));
    if sxx > 0.0 { sxy / sxx } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known value: error that falls with the root of the samples has slope -1/2.
    #[test]
    fn slopes() {
        let root: Vec<(f64, f64)> =
            [8.0, 16.0, 32.0, 64.0].map(|n: f64| (libm::log(n), -0.5 * libm::log(n) + 3.0)).to_vec();
        assert!((slope(&root) + 0.5).abs() < 1e-12);
        assert_eq!(slope(&[(1.0, 2.0)]), 0.0);
    }
}

//! How errors fall with the number of samples: E^2 = a / n + b / n^(3/2) + c / n^2, none of a, b, c negative.
//!
//! Independent samples give 1/n. Samples of a low-discrepancy sequence give n^(-3/2) where an edge crosses a pixel
//! (Mitchell, "Consequences of Stratified Sampling in Graphics", SIGGRAPH 1996), and n^-2 or less where everything is
//! smooth. Pictures have pixels of each kind, and the faster parts die out first: on the scenes that were looked at a
//! single power of n, fitted to the first samples, promises too much.

/// Exponents of n.
const POWERS: [f64; 3] = [1.0, 1.5, 2.0];

/// E^2 as a function of n.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Law([f64; 3]);

impl Law {
    /// Least squares of the relative deviations over points (n, E^2), both above zero; `None` where there are none.
    pub(super) fn fit(points: &[(f64, f64)]) -> Option<Self> {
        let rows: Vec<[f64; 3]> =
            points.iter().map(|&(n, e2)| POWERS.map(|p| libm::pow(n, -p) / e2)).collect();
        let mut best: Option<(f64, Self)> = None;
        // With three terms that may not be negative, the least is one of seven sets of terms, solved without that.
        for set in 1u32..8 {
            let terms: Vec<usize> = (0..3).filter(|t| set & (1 << t) != 0).collect();
            let Some(law) = solve(&rows, &terms).filter(|l| l.0.iter().all(|&c| c >= 0.0)) else { continue };
            let deviation = |row: &[f64; 3]| {
                let d = row.iter().zip(law.0).map(|(x, c)| x * c).sum::<f64>() - 1.0;
                d * d
            };
            let deviations = rows.iter().map(deviation).sum::<f64>();
            if best.is_none_or(|(least, _)| deviations < least) {
                best = Some((deviations, law));
            }
        }
        best.map(|(_, law)| law)
    }

    /// E^2 after n samples.
    pub(super) fn at(&self, n: f64) -> f64 {
        self.0.iter().zip(POWERS).map(|(c, p)| c * libm::pow(n, -p)).sum()
    }

    /// The same law with a factor on E^2.
    pub(super) fn times(self, factor: f64) -> Self {
        Self(self.0.map(|c| c * factor))
    }

    /// The number of samples after which E^2 is this; found by halving, since the law falls.
    pub(super) fn samples(&self, e2: f64) -> f64 {
        let (mut low, mut high) = (0.0f64, 60.0f64);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.at(libm::exp2(middle)) > e2 { low = middle } else { high = middle }
        }
        libm::exp2(high)
    }
}

/// Least squares with some of the terms, by the normal equations.
fn solve(rows: &[[f64; 3]], terms: &[usize]) -> Option<Law> {
    let k = terms.len();
    // Terms scaled to about one, since powers of n differ by far.
    let scale: Vec<f64> =
        terms.iter().map(|&t| rows.iter().map(|r| r[t] * r[t]).sum::<f64>().sqrt()).collect();
    let mut m = [[0.0f64; 4]; 3];
    for (i, &a) in terms.iter().enumerate() {
        for (j, &b) in terms.iter().enumerate() {
            m[i][j] = rows.iter().map(|r| r[a] * r[b]).sum::<f64>() / (scale[i] * scale[j]);
        }
        m[i][k] = rows.iter().map(|r| r[a]).sum::<f64>() / scale[i];
    }
    for i in 0..k {
        let pivot = (i..k).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs()))?;
        m.swap(i, pivot);
        // Fewer points than terms, or all at one n.
        if m[i][i].is_nan() || m[i][i].abs() <= 1e-9 {
            return None;
        }
        let row = m[i];
        for (_, other) in m.iter_mut().take(k).enumerate().filter(|&(j, _)| j != i) {
            let f = other[i] / row[i];
            other.iter_mut().zip(row).for_each(|(x, y)| *x -= f * y);
        }
    }
    let mut law = Law::default();
    for (i, &t) in terms.iter().enumerate() {
        law.0[t] = m[i][k] / m[i][i] / scale[i];
    }
    Some(law)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards that laws of each kind come back from their own points, and that the samples for an error invert them.
    #[test]
    fn laws_come_back() {
        for law in [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [1.0, 0.0, 40.0], [1.0, 5.0, 20.0]].map(Law) {
            let points: Vec<_> = (4..11).map(|o| f64::from(1 << o)).map(|n| (n, law.at(n))).collect();
            let found = Law::fit(&points).expect("points");
            for n in [16.0, 1e3, 1e5] {
                assert!((found.at(n) / law.at(n) - 1.0).abs() < 1e-6, "{law:?} {found:?}");
                assert!((found.samples(law.at(n)) / n - 1.0).abs() < 1e-6, "{law:?} {found:?}");
            }
        }
        assert_eq!(Law::fit(&[]), None);
    }

    /// Guards that noise makes no term negative.
    #[test]
    fn no_term_is_negative() {
        let steep = [(16.0, 1.0), (32.0, 0.2), (64.0, 0.04)];
        let flat = [(16.0, 1.0), (32.0, 0.9), (64.0, 0.8)];
        for points in [steep, flat] {
            let law = Law::fit(&points).expect("points");
            assert!(law.0.iter().all(|&c| c >= 0.0) && law.at(1e6) > 0.0, "{law:?}");
        }
    }
}

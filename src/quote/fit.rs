//! How errors fall with the number of samples: E^2 = a / n + b / n^(3/2), neither a nor b negative, and what photon maps
//! add, which is known beforehand: their bias, whose square falls as n^(-1/3), and the noise of the photons in them, which
//! falls as n^(-2/3): disks shrink (Knaus and Zwicker, TOG 2011, section 4).
//!
//! Independent samples give 1/n. Samples of a low-discrepancy sequence give n^(-3/2) where an edge crosses a pixel
//! (Mitchell, "Consequences of Stratified Sampling in Graphics", SIGGRAPH 1996), and n^-2 or less where everything is
//! smooth. Pictures have pixels of each kind; after some tens of samples the smooth ones have no part in the error any
//! more, and the slope goes from between the two to one. On eleven scenes of this project a third term, n^-2, made
//! what was foreseen worse: it follows the first samples, which say nothing of the later ones.

/// Exponents of n.
const POWERS: [f64; 2] = [1.0, 1.5];

/// The exponents of n with which fall the square of a bias that goes with the radius, since r^2 falls so, and the variance
/// of the mean of samples of which each varies as 1 / r^2.
const OF_BIAS: f64 = 1.0 / 3.0;
const OF_GATHERED: f64 = 2.0 / 3.0;

/// E^2 as a function of n.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Law {
    noise: [f64; 2],
    /// After one sample.
    bias: f64,
    gathered: f64,
}

impl Law {
    /// Least squares of the relative deviations over points (n, E^2), both above zero; `None` where there are none.
    pub(super) fn fit(points: &[(f64, f64)]) -> Option<Self> {
        // Of the terms over E^2, which are to add up to one: their products, and their sums.
        let (mut aa, mut ab, mut bb, mut a, mut b) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &(n, e2) in points {
            let [x, y] = POWERS.map(|p| libm::pow(n, -p) / e2);
            (aa, ab, bb) = (aa + x * x, ab + x * y, bb + y * y);
            (a, b) = (a + x, b + y);
        }
        if aa.is_nan() || aa <= 0.0 {
            return None;
        }
        let determinant = aa * bb - ab * ab;
        // Both terms, where points at several n tell them apart.
        if determinant > 1e-9 * aa * bb {
            let both = [(a * bb - b * ab) / determinant, (b * aa - a * ab) / determinant];
            if both.iter().all(|&c| c >= 0.0) {
                return Some(Self::of_noise(both));
            }
        }
        // With one term c x, the sum of (c x - 1)^2 is least for c = sum x / sum x^2, and then N - (sum x)^2 / sum x^2.
        let one = if a * a * bb >= b * b * aa { [a / aa, 0.0] } else { [0.0, b / bb] };
        Some(Self::of_noise(one))
    }

    fn of_noise(noise: [f64; 2]) -> Self {
        Self { noise, ..Self::default() }
    }

    /// The same with a bias whose square was `square` after `n` samples.
    pub(super) fn with_bias(self, square: f64, n: f64) -> Self {
        Self { bias: square * libm::pow(n, OF_BIAS), ..self }
    }

    /// The same with noise of gathered photons that was `square` after `n` samples.
    pub(super) fn with_gathered(self, square: f64, n: f64) -> Self {
        Self { gathered: square * libm::pow(n, OF_GATHERED), ..self }
    }

    /// E^2 after n samples.
    pub(super) fn at(&self, n: f64) -> f64 {
        let noise = self.noise.iter().zip(POWERS).map(|(c, p)| c * libm::pow(n, -p)).sum::<f64>();
        noise + self.bias * libm::pow(n, -OF_BIAS) + self.gathered * libm::pow(n, -OF_GATHERED)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards that laws of each kind come back from their own points, and that the samples for an error invert them.
    #[test]
    fn laws_come_back() {
        for law in [[2.0, 0.0], [0.0, 3.0], [1.0, 40.0]].map(Law::of_noise) {
            let points: Vec<_> = (4..11).map(|o| f64::from(1 << o)).map(|n| (n, law.at(n))).collect();
            let found = Law::fit(&points).expect("points");
            for n in [16.0, 1e3, 1e5] {
                assert!((found.at(n) / law.at(n) - 1.0).abs() < 1e-6, "{law:?} {found:?}");
                assert!((found.samples(law.at(n)) / n - 1.0).abs() < 1e-6, "{law:?} {found:?}");
            }
        }
        assert_eq!(Law::fit(&[]), None);
    }

    /// By hand: a bias of 1e-4 after 64 samples is half of that after 512, where noise of 1/n then adds the rest.
    #[test]
    fn bias_falls_slowly() {
        let law = Law::of_noise([1.0, 0.0]).with_bias(1e-4, 64.0);
        assert!((law.at(512.0) - (1.0 / 512.0 + 0.5e-4)).abs() < 1e-12, "{law:?}");
        assert!((law.samples(law.at(5000.0)) / 5000.0 - 1.0).abs() < 1e-6);
    }

    /// By hand: 8e-4 after 64 samples is a quarter of that after 512, beside noise of 1/n.
    #[test]
    fn gathered_photons_fall_more_slowly() {
        let law = Law::of_noise([1.0, 0.0]).with_gathered(8e-4, 64.0);
        assert!((law.at(512.0) - (1.0 / 512.0 + 2e-4)).abs() < 1e-12, "{law:?}");
        assert!((law.samples(law.at(5000.0)) / 5000.0 - 1.0).abs() < 1e-6);
    }

    /// Guards that noise makes no term negative, and that what remains is the better one; points at one n have a law.
    #[test]
    fn no_term_is_negative() {
        let steep = [(16.0, 1.0), (32.0, 0.2), (64.0, 0.04)];
        let flat = [(16.0, 1.0), (32.0, 0.9), (64.0, 0.8)];
        let of = |points: &[(f64, f64)]| Law::fit(points).expect("points");
        assert!(of(&steep).noise[0] == 0.0 && of(&steep).noise[1] > 0.0);
        assert!(of(&flat).noise[1] == 0.0 && of(&flat).noise[0] > 0.0);
        assert!((of(&[(16.0, 1.0), (16.0, 1.0)]).at(16.0) - 1.0).abs() < 1e-9);
    }
}

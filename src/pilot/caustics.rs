//! What caustics cost by paths and by photons, and how far a photon map is off.
//!
//! Paths miss rare light, so that the variance that they show is a lower bound: a picture in which no path met a
//! small lamp shows none. Photons know how much light there is, and that gives a better bound. Let S be the sum
//! over all samples of a trial of what paths should have met. If that came in pieces of the size v, paths met
//! S / v of them; having met k, they met with 95 % at least no more than k + 2 sqrt(k) + 3 on average (Poisson; the
//! three is the exact bound for none), so that v is at least S over that. A pixel of mean L then has at least the
//! variance L v of a sample.
//!
//! A photon map spreads light over a disk of radius r, and is off by what is proportional to r^q: q is two where light
//! is smooth, and one half for the root of the mean square over sharp edges. Let D be the mean square, over pixels,
//! of what halving the radius from R changes; the product of two independent replications of it has that mean. The
//! differences form a geometric series, so that the bias at R is root D / (1 - 2^-q), and at r it is (r / R)^q of that.
//! What is seen at once is R = 4 r, where disks hold sixteen times the photons; q comes from halving twice.

use super::judge::{mean, mean_and_error, relative};
use super::trial::{Means, Narrowed, REPLICATIONS, Trial, WIDTHS};
use crate::integrate::Radius;

/// How many pieces of light paths met on average at most, where they met `k`: with 95 %.
fn at_most(k: f64) -> f64 {
    k + 2.0 * k.sqrt() + 3.0
}

/// The least relative variance that a trial has, whose paths should have met the caustics `light` in each pixel.
pub(super) fn least_variance(trial: &Trial, light: &[f64], weights: &[f64]) -> f64 {
    let samples = f64::from(trial.passes);
    let [sum, squares] = trial.events;
    let met = if squares > 0.0 { sum * sum / squares } else { 0.0 };
    let size = (light.iter().sum::<f64>() * samples).max(sum) / at_most(met);
    let missed: Vec<f64> = light.iter().zip(weights).map(|(l, w)| l * size / samples * w).collect();
    mean(&relative(&trial.others, weights)) + mean(&missed)
}

/// An estimate of how far a photon map is off, as an error: the root of the mean square over pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bias {
    /// The estimate, relative.
    pub(super) estimate: f64,
    /// What it is at most: two standard errors of its square more.
    pub(super) most: f64,
}

/// The exponents of the radius that bias may have.
const EXPONENTS: [f64; 2] = [0.5, 2.0];

/// The exponent where the noise of trials does not show it.
const USUAL_EXPONENT: f64 = 1.0;

impl Bias {
    /// From what halving the radius changes, once and once more, of a mean over so many passes.
    pub(super) fn new(narrowed: &Narrowed, weights: &[f64], passes: u32) -> Self {
        let [(wide, error), (narrow, noise)] = [0, 1].map(|i| mean_square(&narrowed[i], weights));
        let q = if narrow > 2.0 * noise && wide > 2.0 * error {
            (0.5 * libm::log2(wide / narrow)).clamp(EXPONENTS[0], EXPONENTS[1])
        } else {
            USUAL_EXPONENT
        };
        let own =
            libm::pow(f64::from(WIDTHS[0]), -q) / (1.0 - libm::pow(2.0, -q)) * Radius::mean_power(passes, q);
        let bias = |square: f64| square.max(0.0).sqrt() * own;
        Self { estimate: bias(wide), most: bias(wide.max(0.0) + 2.0 * error) }
    }
}

/// The mean square over pixels, relative, of what has these means, without their noise; and its standard error.
fn mean_square(of: &[Means], weights: &[f64]) -> (f64, f64) {
    let k = REPLICATIONS as f64;
    let square = |(d, w): (&Means, &f64)| {
        let (sum, squares) = (d.iter().sum::<f64>(), d.iter().map(|x| x * x).sum::<f64>());
        (sum * sum - squares) / (k * (k - 1.0)) * w
    };
    mean_and_error(&of.iter().zip(weights).map(square).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the size of pieces: where nothing was met of a hundred units of light, they come in thirds of it at
    /// least; where many were met, in about their size.
    #[test]
    fn missed_light_has_a_least_variance() {
        let trial = |events: [f64; 2]| Trial {
            all: vec![Means::default(); 10],
            others: vec![Means::default(); 10],
            thrown: vec![0.0; 10],
            met: vec![0.0; 10],
            events,
            through: 0.0,
            passes: 5,
            rays: 1.0,
            rays_of_photon: 1.0,
            spent: 1.0,
        };
        // Ten pixels, five samples, two units a sample: a hundred units.
        let (light, weights) = ([2.0; 10], [1.0; 10]);
        let of_sample = |events| least_variance(&trial(events), &light, &weights) * 5.0 / 2.0;
        assert!((of_sample([0.0, 0.0]) - 100.0 / 3.0).abs() < 1e-9);
        // A hundred pieces of one.
        let found = of_sample([100.0, 100.0]);
        assert!((found - 100.0 / 123.0).abs() < 1e-9, "{found}");
    }

    /// Guards the bias: of b r^2 with b = 0.02, halving 4 r shows 12 b and halving 2 r shows 3 b; noise averages out,
    /// and widens what it may be; where the second difference drowns in it, bias is taken to fall with r.
    #[test]
    fn bias_is_what_narrowing_shows() {
        let weights = vec![0.25; 96];
        let of = |d: f64, noise: f64| -> Vec<Means> {
            let sign = |bit: usize| if bit == 0 { noise } else { -noise };
            (0..96).map(|i: usize| std::array::from_fn(|k| d + sign(i >> k & 1))).collect()
        };
        let exact = Bias::new(&[of(0.24, 0.0), of(0.06, 0.0)], &weights, 1);
        assert!((exact.estimate - 0.5 * 0.02).abs() < 1e-9 && exact.most == exact.estimate, "{exact:?}");
        let noisy = Bias::new(&[of(0.24, 0.01), of(0.06, 0.01)], &weights, 1);
        assert!((noisy.estimate - exact.estimate).abs() < 1e-9, "{noisy:?}");
        assert!(noisy.most > exact.estimate, "{noisy:?}");
        let drowned = Bias::new(&[of(0.24, 0.01), of(0.0, 0.3)], &weights, 1);
        assert!((drowned.estimate - 0.5 * 0.24 * 0.5).abs() < 1e-9, "{drowned:?}");
        // Sixty-four passes have narrower disks.
        let later = Bias::new(&[of(0.24, 0.0), of(0.06, 0.0)], &weights, 64);
        assert!(later.estimate < 0.5 * exact.estimate && later.estimate > 0.25 * exact.estimate, "{later:?}");
    }
}

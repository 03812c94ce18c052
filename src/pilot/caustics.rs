//! What caustics cost by paths and by photons, and how far a photon map is off.
//!
//! Paths miss rare light, so that the variance that they show is a lower bound: a picture in which no path met a
//! small lamp shows none. Photons know how much light there is, and that gives a better bound. Let S be the sum
//! over all samples of a trial of what paths should have met. If that came in pieces of the size v, paths met
//! S / v of them; having met k, they met with 95 % at least no more than k + 2 sqrt(k) + 3 on average (Poisson; the
//! three is the exact bound for none), so that v is at least S over that. A pixel of mean L then has at least the
//! variance L v of a sample.
//!
//! A photon map spreads light over a disk of radius r, and is off by what is proportional to r^2 in smooth places.
//! Light from disks of r less that from disks of r / 2, of the same photons, therefore has the mean of 3/4 of the bias.
//! The product of two independent replications of it has the mean of its square.

use super::judge::{mean, mean_and_error, relative};
use super::trial::{Means, REPLICATIONS, Trial};

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

impl Bias {
    /// From what halving the radius changes; `shrink` is the mean over all passes of the square of the radius, over
    /// that of the first one.
    pub(super) fn new(narrowed: &[Means], weights: &[f64], shrink: f64) -> Self {
        let k = REPLICATIONS as f64;
        let square = |(d, w): (&Means, &f64)| {
            let (sum, squares) = (d.iter().sum::<f64>(), d.iter().map(|x| x * x).sum::<f64>());
            (sum * sum - squares) / (k * (k - 1.0)) * w
        };
        let squares: Vec<f64> = narrowed.iter().zip(weights).map(square).collect();
        let (found, error) = mean_and_error(&squares);
        let root = |square: f64| square.max(0.0).sqrt() / 0.75 * shrink;
        Self { estimate: root(found), most: root(found.max(0.0) + 2.0 * error) }
    }
}

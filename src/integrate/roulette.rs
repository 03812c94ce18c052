//! Russian roulette.

use crate::color::Rgb;
use crate::mutants::planted;

/// Ends a path of `depth` events with a probability, from the event `start` on, or gives the factor that makes up for
/// those that end.
///
/// The chance to go on is the square root of the throughput's largest channel, with what refractions
/// have taken given back (inside glass radiance is larger by eta^2, and the path will leave it again).
#[inline]
#[must_use]
pub(crate) fn survive(beta: Rgb, eta_scale: f32, depth: u32, start: u32, u: f32) -> Option<f32> {
    let q = beta.max_channel() * eta_scale;
    if q <= 0.0 {
        return None;
    }
    if depth < start || q >= 1.0 {
        return Some(1.0);
    }
    let q = q.sqrt();
    (u < q).then_some(planted!(roulette_uncompensated(1.0 / q)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N58: the expected factor is one whatever the throughput.
    #[test]
    fn keeps_the_mean() {
        for beta in [1.0, 0.9, 0.5, 0.01] {
            let n = 1 << 16;
            let mean: f64 = (0..n)
                .filter_map(|i| survive(Rgb::grey(beta), 1.0, 5, 4, (i as f32 + 0.5) / n as f32))
                .map(f64::from)
                .sum::<f64>()
                / f64::from(n);
            assert!((mean - 1.0).abs() < 2e-3, "{beta} {mean}");
        }
        assert_eq!(survive(Rgb::BLACK, 1.0, 1, 4, 0.0), None);
    }
}

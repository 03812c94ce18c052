//! How far photon maps put a picture off, from the picture's own photons.
//!
//! In: for each pixel and replication, what disks of twice the radius would add to what photons brought. Out: the bias,
//! as the error E that a picture without noise would have.
//!
//! Let D be that difference in a pixel, without its noise. Two replications are independent, so that the product of
//! their differences has the mean D^2: over all pairs of K replications, (S^2 - Q) / (K (K - 1)), S and Q being the sum
//! of the differences and of their squares. Averaged over pixels, over R^2 + c^2, this is the relative mean square U of
//! what doubling the radius changes.
//!
//! Bias goes with r^q, and so is root U / (2^q - 1). Narrower disks would tell as well, but hold so few photons that noise
//! hides it. The exponent q is two where light is smooth, and one half for the root of the mean square over sharp edges;
//! it is taken for one, and the interval has room for others. U may be negative by its noise, whose
//! variance is that of products of normal numbers, 2 s^4 / (K (K - 1)) + 4 s^2 D^2 / K with s^2 that of one replication;
//! neighbours share photons, and so are counted together as [`Blocks`] has it.
//!
//! The noise of these differences also says how much of the picture's noise is that of gathered photons. These are
//! independent, so that a sum of them over a disk, weighed by Epanechnikov's kernel K_r, varies as the integral of K_r^2,
//! 4 / (3 pi r^2), and the difference as that of (K_2r - K_r)^2, which is 9/16 of it.

use super::Film;
use super::together::Blocks;
use crate::stats::{NORMAL_95, luminance_of};

/// Exponents of the radius: a low one, the usual one, and a high one. Pictures have edges and smooth light, so that
/// neither end of what is possible is likely.
const EXPONENTS: [f64; 3] = [2.0 / 3.0, 1.0, 1.5];

/// The variance of what disks of twice the radius add over that of the disks themselves.
const OF_DIFFERENCE: f64 = 9.0 / 16.0;

/// Samples of which one looks at wider disks too, in a picture of so many pixels: what pixels say of the bias of a map
/// together is the surer the more there are, and the square of that bias goes with the root of their number. Wider disks
/// hold four times the photons.
pub(crate) fn of_widened(pixels: u64) -> u32 {
    ((pixels.isqrt() / 16) as u32).clamp(1, 64)
}

/// How far photon maps put a picture off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapBias {
    /// E of the bias alone, relative.
    pub error: f64,
    /// Lower and upper end of its 95 % interval.
    pub interval: [f64; 2],
}

impl MapBias {
    /// Of U and its standard error.
    fn new(change: f64, noise: f64) -> Self {
        let change = change.max(0.0);
        let [most, own, least] = EXPONENTS.map(|q| libm::pow(libm::exp2(q) - 1.0, -2.0));
        let spread = NORMAL_95 * noise * own;
        let end = |factor: f64, sign: f64| {
            // The exponent and the noise have nothing to do with each other.
            let exponent = change * (factor - own);
            let away = (exponent * exponent + spread * spread).sqrt();
            (change * own + sign * away).max(0.0).sqrt()
        };
        Self { error: (change * own).sqrt(), interval: [end(least, -1.0), end(most, 1.0)] }
    }

    /// What is left of it with disks so many times narrower, [1, inf).
    #[must_use]
    pub fn of_narrower(self, times: f64) -> Self {
        let [most, own, least] = EXPONENTS.map(|q| libm::pow(times, -q));
        let [low, high] = self.interval;
        Self { error: self.error * own, interval: [low * least, high * most] }
    }
}

impl Film {
    /// How far photon maps put the picture off, and the part of E^2 that is noise of the photons in them; `c` is what E
    /// adds to luminances. `None` where there are none, or where fewer than two replications have samples everywhere.
    pub(super) fn map_bias(&self, c: f64) -> Option<(MapBias, f64)> {
        let cells = self.widening.as_ref()?;
        let k = self.layout.replications as usize;
        let format = self.layout.radiance;
        let width = self.layout.crop[2] as usize;
        let mut blocks = Blocks::new([width, self.layout.crop[3] as usize], k);
        let (mut sum, mut variance, mut noise, mut pixels) = (0.0, 0.0, 0.0, 0.0);
        let mut changes = vec![0.0; k];
        let of_pixels = cells.chunks(k).zip(self.sums.chunks(k)).zip(self.counts.chunks(k));
        for (pixel, ((widening, light), counts)) in of_pixels.enumerate() {
            if counts.iter().all(|&n| n == 0) {
                continue;
            }
            if k < 2 || counts.contains(&0) {
                return None;
            }
            let means = light.iter().zip(counts);
            let mean =
                means.map(|(s, &n)| luminance_of(s.map(|s| format.about_mean(s, n)))).sum::<f64>() / k as f64;
            let root = 1.0 / (mean * mean + c * c).sqrt();
            for (d, (&s, &n)) in changes.iter_mut().zip(widening.iter().zip(counts)) {
                *d = format.about_mean(s, n) * root;
            }
            let [all, squares] = [changes.iter().sum::<f64>(), changes.iter().map(|d| d * d).sum::<f64>()];
            let n = k as f64;
            let square = (all * all - squares) / (n * (n - 1.0));
            let own = (squares - all * all / n) / (n - 1.0);
            sum += square;
            noise += own / n;
            // The square of an estimate of a variance is too large on average.
            let fourth = own * own / (1.0 + 2.0 / (n - 1.0));
            variance += 2.0 * fourth / (n * (n - 1.0)) + 4.0 * own * square.max(0.0) / n;
            pixels += 1.0;
            changes.iter_mut().for_each(|d| *d -= all / n);
            blocks.add([pixel % width, pixel / width], &changes);
        }
        if pixels == 0.0 {
            return None;
        }
        let [width, height] = self.layout.full_size.map(u64::from);
        let gathered = noise / pixels / (OF_DIFFERENCE * f64::from(of_widened(width * height)));
        Some((MapBias::new(sum / pixels, (variance * blocks.factor()).sqrt() / pixels), gathered))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::{FilmLayout, Sample};
    use crate::math::mix64;

    const SIDE: u32 = 32;

    fn bias(change: f64, noise: f64, name: u64) -> MapBias {
        found(change, noise, name).0
    }

    /// A picture of ones in which doubling the radius changes the luminance by `change`, with noise around it.
    fn found(change: f64, noise: f64, name: u64) -> (MapBias, f64) {
        let mut film = Film::new(FilmLayout { widening: true, ..FilmLayout::plain([SIDE; 2]) });
        let mut state = mix64(name);
        let mut unit = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            (mix64(state) >> 11) as f64 / (1u64 << 53) as f64
        };
        for pass in 0..16 {
            for pixel in 0..SIDE * SIDE {
                let widening = (change + noise * (unit() - 0.5) * 12.0f64.sqrt()) as f32;
                let sample = Sample { radiance: Rgb::WHITE, widening, ..Sample::default() };
                film.add(pixel as usize, pass, &sample).expect("a radiance");
            }
        }
        film.map_bias(0.1).expect("replications")
    }

    /// By hand: a change of 1 % of each pixel, over the root of 1 + 0.1^2, is the bias, if that goes with the radius.
    #[test]
    fn doubling_adds_as_much_again() {
        let found = bias(0.01, 0.0, 1);
        let change = 0.01 / 1.01f64.sqrt();
        assert!((found.error / change - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found.interval[0] / (change / (8.0f64.sqrt() - 1.0)) - 1.0).abs() < 1e-6, "{found:?}");
        assert!((found.interval[1] / (change / (libm::cbrt(4.0) - 1.0)) - 1.0).abs() < 1e-6, "{found:?}");
    }

    /// Guards that noise alone is no bias, and that the interval has room for it: its ends for noise alone are 1.96
    /// standard errors of U, which for pixels of variance v over 4 replications is v times the root of (2 / 12 / pixels).
    #[test]
    fn noise_is_no_bias() {
        let (mut held, mut squares) = (0, 0.0);
        for name in 0..100 {
            let found = bias(0.002, 0.02, name);
            held += u32::from(found.interval[0] <= 0.002 && found.interval[1] >= 0.002);
            squares += found.error * found.error / 100.0;
        }
        assert!(held >= 90, "{held}");
        assert!((0.9..1.1).contains(&(squares / (0.002 * 0.002 / 1.01))), "{squares}");
        let variance: f64 = 0.1 * 0.1 / 4.0 / 1.01;
        let expected = (NORMAL_95 * variance * (2.0 / 12.0 / f64::from(SIDE * SIDE)).sqrt()).sqrt();
        let found = bias(0.0, 0.1, 7);
        let room = found.interval[1] * found.interval[1] - found.error * found.error;
        assert!((room.sqrt() / expected - 1.0).abs() < 0.15, "{found:?} {expected}");
    }

    /// By hand: an eighth with eight times narrower disks, if it goes with the radius.
    #[test]
    fn narrower_disks_have_less() {
        let found = MapBias { error: 0.08, interval: [0.064, 0.16] }.of_narrower(8.0);
        assert!((found.error - 0.01).abs() < 1e-12 && (found.interval[1] - 0.04).abs() < 1e-12, "{found:?}");
        assert!((found.interval[0] * 8.0f64.sqrt() - 0.008).abs() < 1e-12, "{found:?}");
        assert_eq!(found.of_narrower(1.0), found);
    }

    /// By hand: differences that vary by 0.01 from sample to sample, of which one in two is looked at, are of photons whose
    /// sums vary by 0.01 / 2 / (9 / 16); means of 16 by a sixteenth.
    #[test]
    fn differences_tell_noise() {
        assert_eq!(of_widened(u64::from(SIDE * SIDE)), 2);
        let (_, gathered) = found(0.01, 0.1, 3);
        let expected = 0.01 / 2.0 * 16.0 / 9.0 / 16.0 / 1.01;
        assert!((gathered / expected - 1.0).abs() < 0.1, "{gathered} {expected}");
    }

    /// Guards how many samples look at wider disks: each in small pictures, and few in large ones.
    #[test]
    fn few_samples_look_at_wider_disks() {
        let of = of_widened;
        assert_eq!([of(1), of(31 * 31), of(64 * 64), of(512 * 512), of(1 << 30)], [1, 1, 4, 32, 64]);
    }

    /// Guards that films without maps have no such figure.
    #[test]
    fn paths_have_none() {
        assert_eq!(Film::new(FilmLayout::plain([2, 2])).map_bias(0.1), None);
        assert_eq!(Film::new(FilmLayout { widening: true, ..FilmLayout::plain([2, 2]) }).map_bias(0.1), None);
    }
}

//! How an error has fallen so far, and when it will have fallen far enough.
//!
//! The pixels are dealt into groups. At each number of passes the curve keeps the square of the error of each group;
//! E^2 of the picture is their mean. Groups drawn with replacement (Efron, "Bootstrap Methods", Annals of Statistics
//! 7(1), 1979) give other curves, of which each says how many samples an error takes: their spread is the interval.
//! It holds what varies between pixels, and how errors at different numbers of samples go together. What a render itself
//! adds is added: its own estimate, which decides when it stops, has noise. And so is what the law is off by.

use super::fit::Law;
use crate::film::Squares;
use crate::integrate::is_looked_at;
use crate::math::mix64;
use crate::stats::NORMAL_95;

/// Groups of pixels.
const GROUPS: usize = 32;
/// Curves that are drawn for an interval.
const DRAWN: usize = 200;
/// The law is fitted over the last two octaves of passes: what comes before falls otherwise.
const BACK: u32 = 4;
/// Fewer passes say little: each replication then has less than four samples.
const FEWEST: u32 = 16;
/// Above this error estimates are off by what the law does not know.
const NOISIEST: f64 = 0.12;
/// What the law is off by, relative, for each octave that it is continued by, from so many passes on, and in inverse
/// proportion to them below: from the curves of eleven scenes.
const OFF: (f64, u32) = (0.03, 128);

/// The share of the noise that gathered photons may have at most: something is left to fit.
const MOST_GATHERED: f64 = 0.95;

/// Errors at growing numbers of passes.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    points: Vec<Point>,
    /// Pixels of the picture for each one that the curve knows.
    every: f64,
}

#[derive(Clone, Debug)]
struct Point {
    passes: u32,
    /// Sum over the pixels of each group, and their number.
    groups: Vec<(f64, f64)>,
    /// As an estimate of the error has them.
    effective_pixels: f64,
    /// As [`Squares`] has it.
    together: f64,
    /// The square of the bias of photon maps, and how far its upper end is from that.
    bias: [f64; 2],
    /// As [`Squares`] has it.
    gathered: f64,
}

/// A number of samples for each pixel, as it was foreseen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Forecast {
    /// Samples at which a render stops.
    pub samples: u32,
    /// Lower and upper end of the 95 % interval.
    pub interval: [u32; 2],
}

impl Curve {
    /// Of a picture of which one pixel in `every` is known, about.
    #[must_use]
    pub fn new(every: f64) -> Self {
        Self { points: Vec::new(), every }
    }

    /// The number of passes of the last point; zero where there is none.
    #[must_use]
    pub fn passes(&self) -> u32 {
        self.points.last().map_or(0, |p| p.passes)
    }

    /// Adds what the pixels add to the square of the error after some passes, more than before.
    pub fn add(&mut self, passes: u32, squares: &Squares) {
        let mut groups = vec![(0.0, 0.0); GROUPS];
        for (i, &t) in squares.of_pixels.iter().enumerate() {
            // Neighbours in different groups.
            let group = &mut groups[(mix64(i as u64) >> 32) as usize % GROUPS];
            group.0 += f64::from(t);
            group.1 += 1.0;
        }
        let effective_pixels = squares.estimate().effective_pixels;
        let bias = squares.map_bias.map_or([0.0; 2], |b| {
            let [square, end] = [b.error, b.interval[1]].map(|e| e * e);
            [square, end - square]
        });
        let (together, gathered) = (squares.together, squares.gathered);
        self.points.push(Point { passes, groups, effective_pixels, together, bias, gathered });
    }

    /// The points that a law is fitted to.
    fn fitted(&self) -> Vec<&Point> {
        let last = self.passes();
        let recent = |p: &&Point| p.passes >= FEWEST.min(last) && p.passes >= last / BACK;
        let recent: Vec<&Point> = self.points.iter().filter(recent).collect();
        let clear = |p: &&Point| p.weighted(&[1.0; GROUPS]) <= NOISIEST * NOISIEST;
        let clear: Vec<&Point> = recent.iter().copied().filter(clear).collect();
        if clear.len() < 3 { recent } else { clear }
    }

    /// Whether an error was reached within the curve.
    #[must_use]
    pub fn has_reached(&self, error: f64) -> bool {
        self.reached(error * error, &[1.0; GROUPS]).is_some()
    }

    /// The first point at which a weighting of the groups is no more than the square of an error.
    fn reached(&self, wanted: f64, weights: &[f64; GROUPS]) -> Option<&Point> {
        let last = self.points.last()?;
        let mut points = self.points.iter().filter(|p| p.passes >= FEWEST.min(last.passes));
        points.find(|p| p.weighted(weights) + p.bias[0] <= wanted)
    }

    /// When a render that asks for an error stops: `None` where the curve has no points.
    #[must_use]
    pub fn forecast(&self, error: f64) -> Option<Forecast> {
        let last = self.points.last()?;
        let wanted = error * error;
        let fitted = self.fitted();
        // Where the error is reached within the curve, that says when; beyond, the law goes on.
        let within = self.has_reached(error);
        let gathered = last.gathered / last.weighted(&[1.0; GROUPS]).max(f64::MIN_POSITIVE);
        let gathered = gathered.clamp(0.0, MOST_GATHERED);
        let stops = |weights: &[f64; GROUPS]| {
            // Noise at the first points is no reason to stop there, where the curve itself does not.
            if let Some(reached) = self.reached(wanted, weights).filter(|_| within) {
                return Some(f64::from(reached.passes));
            }
            let n = f64::from(last.passes);
            let known = Law::default().with_gathered(gathered * last.weighted(weights).max(0.0), n);
            let rest =
                |p: &&Point| (f64::from(p.passes), p.weighted(weights) - known.at(f64::from(p.passes)));
            // Noise may make some of them negative.
            let points: Vec<_> = fitted.iter().map(rest).filter(|(_, e2)| *e2 > 0.0).collect();
            let law = Law::fit(&points)?.with_gathered(known.at(n), n).with_bias(last.bias[0], n);
            Some(law.samples(wanted).max(n))
        };
        let middle = stops(&[1.0; GROUPS])?;
        let mut state = 0u64;
        let mut draw = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            mix64(state)
        };
        let mut logs = Vec::with_capacity(DRAWN);
        for _ in 0..DRAWN {
            let mut weights = [0.0; GROUPS];
            (0..GROUPS).for_each(|_| weights[draw() as usize % GROUPS] += 1.0);
            logs.extend(stops(&weights).map(libm::log));
        }
        let mean = logs.iter().sum::<f64>() / logs.len().max(1) as f64;
        let drawn = logs.iter().map(|l| (l - mean) * (l - mean)).sum::<f64>() / logs.len().max(2) as f64;
        // What the estimate of the whole picture varies by when it is compared with the error that was asked for.
        let own = 1.0 / (last.effective_pixels * self.every).max(1.0);
        let beyond = libm::log2(middle / f64::from(last.passes)).max(0.0);
        let off = beyond * OFF.0 * (f64::from(OFF.1) / f64::from(last.passes)).max(1.0);
        // What a bias is off by is missing for noise, or free for it, and samples go as one over that.
        let unsure = last.bias[1] / NORMAL_95 / (wanted - last.bias[0]).max(0.1 * wanted);
        // Groups hold neighbours of each other, so that they go together as pixels do.
        let variance = drawn * last.together + own + off * off + unsure * unsure;
        let spread = libm::exp(NORMAL_95 * variance.sqrt());
        Some(Forecast { samples: stop(middle), interval: [stop(middle / spread), stop(middle * spread)] })
    }
}

impl Point {
    /// The square of the error that a weighting of the groups gives; noise may make it negative.
    fn weighted(&self, weights: &[f64; GROUPS]) -> f64 {
        let pairs = self.groups.iter().zip(weights);
        let (sum, pixels) = pairs.fold((0.0, 0.0), |s, (g, w)| (s.0 + w * g.0, s.1 + w * g.1));
        sum / pixels
    }
}

/// The first number of passes, from some on, at which a render looks at its error.
fn stop(samples: f64) -> u32 {
    // Far beyond what anybody renders.
    const MOST: f64 = (1u64 << 30) as f64;
    let mut passes = (samples.clamp(1.0, MOST).ceil() as u32).max(8);
    // Looks are four passes apart, or a sixteenth of an octave.
    let step = |n: u32| ((1u32 << n.ilog2()) / 16).max(4);
    passes = passes.div_ceil(step(passes)) * step(passes);
    debug_assert!(is_looked_at(passes));
    passes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::MapBias;

    /// Curves of `pixels` with E^2 = 1/n and noise of some relative size, independent between points.
    fn curve(name: u64, pixels: usize, noise: f64, last: u32) -> Curve {
        biased(name, pixels, noise, last, None)
    }

    /// The same with the bias of a photon map.
    fn biased(name: u64, pixels: usize, noise: f64, last: u32, bias: Option<MapBias>) -> Curve {
        let mut curve = Curve::new(1.0);
        let mut state = name;
        for passes in (8..=last).filter(|&n| is_looked_at(n)) {
            let t = |_| {
                state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
                let u = (mix64(state) >> 11) as f64 / (1u64 << 53) as f64;
                ((1.0 + noise * (2.0 * u - 1.0)) / f64::from(passes)) as f32
            };
            let of_pixels = (0..pixels).map(t).collect();
            curve.add(passes, &Squares { of_pixels, together: 1.0, map_bias: bias, gathered: 0.0 });
        }
        curve
    }

    /// By hand: E^2 = 1/n is 1e-3 after 1000 samples; the next look is after 1024. That is three octaves on, for each of
    /// which the law may be off by 3 %: by 17 % with 95 %, and a little for the picture's own noise.
    #[test]
    fn a_known_law_is_foreseen() {
        let found = curve(1, 4096, 0.0, 128).forecast(1e-3f64.sqrt()).expect("points");
        assert_eq!(found.samples, 1024);
        assert!((850..=880).contains(&found.interval[0]), "{found:?}");
        assert!((1200..=1280).contains(&found.interval[1]), "{found:?}");
    }

    /// By hand: with a bias of 0.03 after 128 samples, squared 9e-4, and 9e-4 / 2 after 1024, noise has to fall to
    /// 5.5e-4 for 1e-3 there: a little sooner than after 1818. And that what is not known of the bias widens the interval.
    #[test]
    fn bias_takes_more_samples() {
        let of = |interval| {
            let bias = MapBias { error: 0.03, interval };
            biased(1, 4096, 0.0, 128, Some(bias)).forecast(1e-3f64.sqrt()).expect("points")
        };
        let known = of([0.03; 2]);
        let after = |n: f64| 1.0 / n + 9e-4 * libm::cbrt(128.0 / n);
        assert!(
            after(f64::from(known.samples)) <= 1e-3 && after(0.93 * f64::from(known.samples)) > 1e-3,
            "{known:?}"
        );
        let unsure = of([0.025, 0.035]);
        assert_eq!(unsure.samples, known.samples);
        assert!(unsure.interval[1] > known.interval[1], "{unsure:?}");
        // What is still above is not reached within the curve.
        let above = biased(1, 4096, 0.0, 1024, Some(MapBias { error: 0.03, interval: [0.03; 2] }));
        assert!(above.forecast(1e-3f64.sqrt()).expect("points").samples > 1024);
    }

    /// By hand: E^2 = 1 / (2 n) + (64 / n)^(2/3) / 128, of which half is noise of gathered photons after 64 samples, is
    /// 1 / 8192 + 1 / 2048 after 4096.
    #[test]
    fn gathered_photons_take_more_samples() {
        let of = |share: f64| {
            let mut curve = Curve::new(1.0);
            for passes in (8..=64).filter(|&n| is_looked_at(n)) {
                let n = f64::from(passes);
                let gathered = libm::pow(64.0 / n, 2.0 / 3.0) / 128.0;
                let of_pixels = vec![(0.5 / n + gathered) as f32; 4096];
                let gathered = share * gathered;
                curve.add(passes, &Squares { of_pixels, together: 1.0, map_bias: None, gathered });
            }
            curve.forecast((5.0f64 / 8192.0).sqrt()).expect("points").samples
        };
        assert!((4096..=4352).contains(&of(1.0)), "{}", of(1.0));
        assert!(of(0.0) < 2400, "{}", of(0.0));
    }

    /// Guards that an error which is reached within the curve is read off, and that single groups that noise makes small
    /// at first are no reason to stop there.
    #[test]
    fn what_was_seen_is_not_foreseen() {
        assert_eq!(
            curve(1, 4096, 0.0, 128).forecast(0.125).expect("points"),
            Forecast { samples: 64, interval: [64, 68] }
        );
        assert!(curve(1, 4096, 0.0, 128).has_reached(0.125) && !curve(1, 4096, 0.0, 128).has_reached(0.05));
        let found = curve(4, 1024, 8.0, 128).forecast(0.05).expect("points");
        assert!(found.interval[0] > 128 && found.interval[1] < 1500, "{found:?}");
    }

    /// Guards that a draw which noise makes small at first is no reason to stop there. Of the law 1/n, one pixel after 16
    /// passes seems 4000 times as bad and another one as much better: a third of all draws have more of the latter.
    #[test]
    fn noise_at_first_is_no_end() {
        let mut curve = Curve::new(1.0);
        for passes in (8..=128).filter(|&n| is_looked_at(n)) {
            let mut of_pixels = vec![1.0 / passes as f32; 4096];
            if passes == 16 {
                of_pixels[0] += 4000.0 / 16.0;
                of_pixels[1] -= 4000.0 / 16.0;
            }
            curve.add(passes, &Squares { of_pixels, together: 1.0, map_bias: None, gathered: 0.0 });
        }
        // As without it: 389 samples, of which the next look is after 400, and 10 % to either side.
        let found = curve.forecast(0.0507).expect("points");
        assert_eq!(found.samples, 400, "{found:?}");
        assert!(found.interval[0] > 340 && found.interval[1] < 450, "{found:?}");
    }

    /// Guards that noise widens the interval, and that it holds the truth.
    #[test]
    fn noise_widens_the_interval() {
        let width = |c: &Curve| {
            let f = c.forecast(0.05).expect("points");
            assert!((f.interval[0]..=f.interval[1]).contains(&400), "{f:?}");
            f64::from(f.interval[1]) / f64::from(f.interval[0])
        };
        let (few, many) = (curve(2, 300, 3.0, 128), curve(3, 30_000, 3.0, 128));
        assert!(width(&few) > 1.2 * width(&many), "{} {}", width(&few), width(&many));
    }

    #[test]
    fn renders_stop_where_they_look() {
        for (asked, found) in [(1.0, 8), (8.5, 12), (64.0, 64), (65.0, 68), (129.0, 136), (1025.0, 1088)] {
            assert_eq!(stop(asked), found);
        }
        for n in 1..3000 {
            let next = (n..).find(|&n| is_looked_at(n)).expect("some");
            assert_eq!(stop(f64::from(n)), next);
        }
    }
}

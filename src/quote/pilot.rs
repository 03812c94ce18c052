//! The first samples of a render, at some of its pixels.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::curve::{Curve, Forecast};
use crate::film::{ErrorEstimate, Film, LayerShare, LightLayer, Squares};
use crate::integrate::{
    Control, Counters, Outcome, RenderError, RenderOptions, Sparse, StopOnly, is_looked_at, layout,
    render_onto,
};
use crate::prepare::Prepared;

/// Pixels of a pilot, about, where the picture has as many: enough for an interval, and few enough for many samples of
/// each.
const PIXELS: u64 = 4096;
/// It traces photons as for so many pixels, where the picture has as many: they take about as long as the paths.
const PHOTONS_OF: u64 = 2 * PIXELS;
/// Rays of a pilot where nothing else is asked for: a second or two on a few cores.
pub const RAYS: u64 = 10_000_000;
/// Passes of a pilot: at least what a curve needs, at most what any error above a thousandth does.
const PASSES: Range<u32> = 16..4096;
/// The part of the passes that is rendered again for the shares of effects.
const PARTS: u32 = 4;
/// What a pass may take more or less later on, relative: 95 % of what was seen on a machine with nothing else to do.
const CLOCK: f64 = 0.08;
/// How many times as many rays a pilot takes at most where the error is not clear, or its quote wide.
const LONGER: u32 = 4;
/// A quote whose interval reaches to so many times its samples says nothing.
const SAYS_NOTHING: u32 = 10;
/// How wide the interval of a quote should be at most, to either side and relative.
const WIDEST: f64 = 0.2;
/// Pixels that carry the error of a pilot, at least, where it is clear.
const FEWEST: f64 = 20.0;
/// Passes that say how many rays one takes.
const FIRST: u32 = 4;

/// What a pilot found.
#[derive(Clone, Debug)]
pub struct Pilot {
    /// How the error fell.
    pub curve: Curve,
    /// The error after all passes, of the pixels that were rendered; `None` where it cannot be estimated.
    pub error: Option<ErrorEstimate>,
    /// One pixel of so many was rendered.
    pub every: f64,
    /// Samples of each of these.
    pub passes: u32,
    /// Rays, photons' included.
    pub rays: u64,
    /// Wall-clock time.
    pub elapsed: Duration,
    /// Seconds that a pass of the whole picture takes on the same threads.
    pub pass_seconds: f64,
    /// Threads that worked.
    pub threads: usize,
    /// What the parts of the light are of picture, noise and work, the noisiest first; empty where nothing was seen.
    pub parts: Vec<EffectShare>,
}

/// A part of the light: its share of the picture, of its noise and of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffectShare {
    /// The part.
    pub layer: LightLayer,
    /// Of the luminance, [0, 1].
    pub light: f64,
    /// Of E^2, about [0, 1].
    pub noise: f64,
    /// Of the rays, which the time goes into, [0, 1].
    pub rays: f64,
}

/// What an error costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quote {
    /// Samples per pixel.
    pub samples: u32,
    /// Lower and upper end of their 95 % interval.
    pub samples_interval: [u32; 2],
    /// Wall-clock time of rendering them.
    pub seconds: f64,
    /// Lower and upper end of its interval.
    pub seconds_interval: [f64; 2],
}

impl Pilot {
    /// The pixels for each one that was rendered, rounded.
    #[must_use]
    pub fn one_in(&self) -> u32 {
        self.every.round() as u32
    }

    /// Whether the error of the pilot says what that of the whole picture will be.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.error.is_some_and(|e| is_clear(&e, self.every))
    }

    /// What an error costs; `None` where the pilot does not say, be it within a factor of ten.
    #[must_use]
    pub fn quote(&self, error: f64) -> Option<Quote> {
        let says = |f: &Forecast| self.is_clear() && f.interval[1] / SAYS_NOTHING < f.samples;
        let found = self.curve.forecast(error).filter(says)?;
        Some(Quote::new(found, self.pass_seconds))
    }
}

impl Quote {
    /// Of samples that take so many seconds each.
    #[must_use]
    pub fn new(forecast: Forecast, pass_seconds: f64) -> Self {
        let Forecast { samples, interval } = forecast;
        let [low, high] = interval.map(|n| f64::from(n) / f64::from(samples));
        // Two independent reasons to be wrong, as factors.
        let both = |ratio: f64| libm::exp(libm::hypot(libm::log(ratio), libm::log(1.0 + CLOCK)));
        let seconds = f64::from(samples) * pass_seconds;
        let seconds_interval = [seconds / both(low), seconds * both(high)];
        Self { samples, samples_interval: interval, seconds, seconds_interval }
    }
}

/// Takes notes at each look, and passes on the wish to stop.
struct Notes<'a> {
    curve: Mutex<Curve>,
    /// See [`Sparse::coarse`].
    coarse: u32,
    control: &'a dyn Control,
}

impl Notes<'_> {
    fn curve(&self) -> MutexGuard<'_, Curve> {
        self.curve.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Control for Notes<'_> {
    fn committed(&self, film: &Film, passes: Range<u32>, _: Counters) {
        if is_looked_at(passes.end)
            && let Some(squares) = squares(film, self.coarse)
        {
            self.curve().add(passes.end, &squares);
        }
    }

    fn cancelled(&self) -> bool {
        self.control.cancelled()
    }
}

/// How long a pilot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length {
    /// Rays, about; where the error is not clear after them, it goes on, up to four times as long.
    pub rays: u64,
    /// An error of which the quote should be within 20 %: where it is not, the pilot goes on, too.
    pub narrow: Option<f64>,
}

/// Renders some pixels of a picture for as many passes as the rays of its length allow, but for the least that a curve
/// needs; `options` say which threads, and which part of the picture.
///
/// # Errors
/// As [`render_onto`].
pub fn pilot(
    scene: &Prepared,
    options: &RenderOptions,
    length: Length,
    control: &dyn Control,
) -> Result<Pilot, RenderError> {
    let plain = RenderOptions { layers: false, layer_noise: false, features: false, ..options.clone() };
    let sparse = Sparse::new(scene.size, plain.shown(scene), PIXELS, PHOTONS_OF);
    let part =
        sparse.map_or(Part { every: 1.0, coarse: 1 }, |s| Part { every: s.every(), coarse: s.coarse() });
    let Part { every, coarse } = part;
    let notes = Notes { curve: Mutex::new(Curve::new(every)), coarse, control };
    let options = RenderOptions { passes: 0..FIRST, sparse, time: None, error: None, ..plain };
    let film = Film::new(layout(scene, &options));
    let first = render_onto(scene, film, &options, &notes)?;
    let affordable = length.rays.saturating_mul(u64::from(FIRST)) / first.counters.rays.max(1);
    let within = |passes: u64| (passes.min(u64::from(PASSES.end)) as u32).max(PASSES.start) / FIRST * FIRST;
    // Rays bound both: where a pass takes many, there is no going on.
    let (planned, longest) = (within(affordable), within(affordable.saturating_mul(u64::from(LONGER))));
    let mut total = Spent::default();
    total.add(&first);
    let (mut film, mut passes) = (first.film, first.passes.end);
    // Longer, by up to as much as LONGER says, where that much does not show what the picture converges to, or when.
    let mut asked = planned;
    let (error, threads) = loop {
        let options = RenderOptions { passes: passes..asked, ..options.clone() };
        let more = render_onto(scene, film, &options, &notes)?;
        total.add(&more);
        (film, passes) = (more.film, more.passes.end);
        let error = squares(&film, coarse).map(|s| film.error_of(&s));
        let clear = error.is_some_and(|e| is_clear(&e, every))
            && length.narrow.is_none_or(|e| is_narrow(&notes.curve(), e));
        if clear || more.cancelled || asked >= longest {
            break (error, more.threads);
        }
        asked = (2 * asked).min(longest);
    };
    // What layers are recorded with costs time, which a render does not take.
    let parts = RenderOptions { passes: 0..(passes / PARTS).max(PASSES.start), layer_noise: true, ..options };
    let parts = render_onto(scene, Film::new(layout(scene, &parts)), &parts, &StopOnly(control))?;
    Ok(Pilot {
        curve: notes.curve.into_inner().unwrap_or_else(PoisonError::into_inner),
        error,
        every,
        passes,
        rays: total.rays,
        elapsed: total.elapsed,
        pass_seconds: total.whole(part) / f64::from(passes.max(1)),
        threads,
        parts: shares(&parts.film, &parts.counters, part),
    })
}

/// What the pixels add to the error; photon maps of the whole picture have disks so many times narrower.
fn squares(film: &Film, coarse: u32) -> Option<Squares> {
    let found = film.error_squares()?;
    Some(Squares { map_bias: found.map_bias.map(|b| b.of_narrower(f64::from(coarse))), ..found })
}

/// Whether the pilot's error says what that of the whole picture will be, of which one pixel in `every` is known.
fn is_clear(error: &ErrorEstimate, every: f64) -> bool {
    let carry = error.effective_pixels;
    error.error <= ErrorEstimate::NOISIEST && carry >= FEWEST && carry * every >= ErrorEstimate::FEWEST_PIXELS
}

/// Whether the quote of an error is as narrow as quotes should be, or as it gets: when an error was reached is known no
/// better after more passes.
fn is_narrow(curve: &Curve, error: f64) -> bool {
    let narrow = |found: Forecast| {
        let [low, high] = found.interval.map(f64::from);
        high - low <= 2.0 * WIDEST * f64::from(found.samples)
    };
    curve.has_reached(error) || curve.forecast(error).is_some_and(narrow)
}

/// How much of a picture a pilot renders.
#[derive(Clone, Copy)]
struct Part {
    /// One pixel of so many.
    every: f64,
    /// See [`Sparse::coarse`].
    coarse: u32,
}

impl Part {
    /// What all pixels and all photons of the picture take, if these paths and photons took so much.
    fn whole(self, paths: f64, photons: f64) -> f64 {
        paths * self.every + photons * f64::from(self.coarse * self.coarse)
    }
}

/// What renders took together.
#[derive(Default)]
struct Spent {
    rays: u64,
    elapsed: Duration,
    photons: Duration,
    paths: Duration,
}

impl Spent {
    fn add(&mut self, outcome: &Outcome) {
        self.rays += outcome.counters.rays;
        self.elapsed += outcome.elapsed;
        self.photons += outcome.busy.photons;
        self.paths += outcome.busy.tiles + outcome.busy.film;
    }

    /// Seconds that it would have taken to render all pixels, with all photons.
    fn whole(&self, part: Part) -> f64 {
        let [photons, paths] = [self.photons, self.paths].map(|d| d.as_secs_f64());
        self.elapsed.as_secs_f64() * part.whole(paths, photons) / (photons + paths).max(1e-9)
    }
}

/// The shares of the parts of the light, of the most noisy first.
fn shares(film: &Film, counters: &Counters, part: Part) -> Vec<EffectShare> {
    let rays: [f64; LightLayer::ALL.len()] = std::array::from_fn(|i| {
        let (all, photons) = (counters.layer_rays[i], counters.photon_rays[i]);
        part.whole((all - photons) as f64, photons as f64)
    });
    let total = rays.iter().sum::<f64>().max(1.0);
    let of = |s: LayerShare| EffectShare {
        layer: s.layer,
        light: s.light,
        noise: s.noise,
        rays: rays[s.layer as usize] / total,
    };
    let mut list: Vec<EffectShare> = film.layer_shares().into_iter().flatten().map(of).collect();
    list.sort_by(|a, b| b.noise.total_cmp(&a.noise));
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: of two seconds on two threads, one thread's one for a quarter of the photons and three for a tenth of the
    /// pixels: all take (4 + 30) / 4 times as long.
    #[test]
    fn the_whole_takes_all_photons_and_pixels() {
        let [two, one, three] = [2, 1, 3].map(Duration::from_secs);
        let spent = Spent { rays: 0, elapsed: two, photons: one, paths: three };
        assert!((spent.whole(Part { every: 10.0, coarse: 2 }) - 17.0).abs() < 1e-9);
    }
}

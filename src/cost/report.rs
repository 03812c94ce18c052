//! What was measured, and what follows from it.

use serde::Serialize;

use super::error::Parts;
use super::fit::Fit;
use super::numerics::DoubleReference;
use super::switches::{Kind, Switch};
use crate::stats::Interval;

/// Errors whose price is told.
pub const TARGETS: [f64; 5] = [0.1, 0.05, 0.02, 0.01, 0.005];
/// The one of them that the first sentence is about.
pub(super) const MAIN: f64 = 0.01;

/// What a scene costs (epsilux.cost/1).
#[derive(Clone, Debug, Serialize)]
pub struct CostReport {
    /// Form of this table.
    pub schema: &'static str,
    /// The scene's name.
    pub scene: String,
    /// Hash of the scene.
    pub scene_sha256: String,
    /// Camera.
    pub camera: String,
    /// Width and height of the picture whose price is told, pixels.
    pub size: [u32; 2],
    /// Width and height of the pictures that were measured, pixels.
    pub measured: [u32; 2],
    /// Renders of each way, each with another seed.
    pub seeds: u32,
    /// Threads that rendered.
    pub threads: usize,
    /// How the reference was rendered.
    pub reference_way: &'static str,
    /// Samples a pixel of the reference.
    pub reference_spp: u32,
    /// Its own error, relative.
    pub reference_error: f64,
    /// What was measured: first that nothing is switched.
    pub switches: Vec<Measured>,
    /// What a quote says beforehand, beside what came.
    pub prediction: Option<Prediction>,
    /// How many of the statements of the full pictures held the true error in their 95 % interval, and of how many.
    pub stated: [u32; 2],
    /// What the picture is made of.
    pub layers: Vec<LayerShare>,
    /// Single precision beside the reference integrator in double precision.
    pub double: Option<DoubleReference>,
}

/// A way to render, measured.
#[derive(Clone, Debug, Serialize)]
pub struct Measured {
    /// Its name.
    pub name: String,
    /// What it does.
    pub what: String,
    /// What the picture then lacks; empty where it lacks nothing.
    pub gives_up: String,
    /// The flag that throws it; empty where none is needed.
    pub flag: String,
    /// What it does to the picture.
    pub kind: Kind,
    /// Processor seconds of a sample for each pixel of the picture whose price is told: median over the seeds.
    pub seconds_per_pass: f64,
    /// Its quartiles over the seeds.
    pub seconds_quartiles: [f64; 2],
    /// Rays of one sample of a pixel.
    pub rays_per_sample: f64,
    /// Error over samples.
    pub points: Vec<Point>,
    /// Line through the errors; of a shortcut through the noise alone.
    pub fit: Option<Fit>,
    /// Share of the light that it adds or takes, relative, with sign: measured with the same random numbers.
    pub change: Interval,
    /// What the error does not fall below, relative: the root of the squared bias; zero where none is proved.
    pub floor: Interval,
    /// Seconds that it takes to some errors; of a shortcut to as much noise. Empty where it does not converge.
    pub prices: Vec<Price>,
    /// 1 / (V T) over that of the full method: how many times less its noise costs. Unknown where one of both does not
    /// converge.
    pub efficiency: Option<f64>,
    /// Until when a shortcut is the better choice.
    pub until: Until,
}

/// The error after some samples.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Samples a pixel.
    pub spp: u32,
    /// E against the reference.
    pub error: Interval,
    /// What of it differs from seed to seed.
    pub noise: f64,
    /// Square of what of it does not; by noise it may be negative.
    pub bias_squared: Interval,
}

/// What an error takes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Price {
    /// The error, relative.
    pub error: f64,
    /// Samples a pixel.
    pub samples: Interval,
    /// Processor seconds, at the size whose price is told.
    pub seconds: Interval,
    /// Whether so many samples were measured; else the line is continued.
    pub measured: bool,
}

/// Until when a shortcut is nearer to the full picture than the full method in the same time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
pub enum Until {
    /// It is no shortcut.
    NoShortcut,
    /// Never: its noise costs as much.
    Never,
    /// As far as was measured: no bias was proved.
    NotSeen,
    /// Nobody knows: one of both does not converge.
    NotKnown,
    /// Until then: (V T of the full method less its own) / bias^2.
    Seconds {
        /// Processor seconds.
        seconds: Interval,
        /// The error of both then, relative.
        error: f64,
    },
}

/// A quote, and what came.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Prediction {
    /// Samples a pixel that it rests on.
    pub after: u32,
    /// They were taken at one pixel of so many.
    pub every: u32,
    /// The error that it is for: that of the longest runs, relative.
    pub error: f64,
    /// Samples a pixel that it says to take; `None` where it does not say, since too little was seen.
    pub samples: Option<Interval>,
    /// Samples a pixel that the error took.
    pub came: u32,
}

/// A part of the light.
#[derive(Clone, Debug, Serialize)]
pub struct LayerShare {
    /// Its name.
    pub name: &'static str,
    /// Share of the light, [0, 1].
    pub light: f64,
    /// Share of the variance, where it was measured.
    pub noise: Option<f64>,
    /// Share of the rays, where they were counted.
    pub rays: Option<f64>,
}

/// What the runs of a way gave.
pub(super) struct Runs {
    pub(super) levels: Vec<u32>,
    /// At each level.
    pub(super) parts: Vec<Parts>,
    /// Processor seconds of each seed, for a pass of the picture whose price is told.
    pub(super) seconds: Vec<f64>,
    pub(super) rays_per_sample: f64,
}

impl Runs {
    /// The squared error of each seed at each level; of a shortcut that of its noise alone.
    fn squares(&self, kind: Kind) -> Vec<(u32, Vec<f64>)> {
        let of = |p: &Parts| if kind == Kind::Shortcut { p.variances.clone() } else { p.squares.clone() };
        self.levels.iter().zip(&self.parts).map(|(n, parts)| (*n, of(parts))).collect()
    }

    /// V T: what noise costs; none where it was not measured.
    fn price_of_noise(&self, kind: Kind, seconds_per_pass: f64) -> Option<f64> {
        let (n, parts) = (f64::from(*self.levels.last()?), self.parts.last()?);
        let square = if kind == Kind::Shortcut { parts.variance } else { parts.square() };
        Some(square * n * seconds_per_pass).filter(|v| *v > 0.0)
    }
}

impl Measured {
    /// What follows from the runs of a way, beside those of the full method and the light of the reference.
    pub(super) fn new(switch: &Switch, runs: &Runs, full: &Runs, light: f64) -> Self {
        let mut sorted = runs.seconds.clone();
        sorted.sort_by(f64::total_cmp);
        let quartile = |q: f64| quantile(&sorted, q);
        let seconds_per_pass = quartile(0.5);
        let shortcut = switch.kind == Kind::Shortcut;
        let fit = Fit::new(&runs.squares(switch.kind));
        let price = |fit: &Fit, error: f64| {
            let samples = fit.samples(error)?;
            let seconds = samples.times(seconds_per_pass);
            Some(Price { error, samples, seconds, measured: samples.value <= f64::from(fit.over[1]) })
        };
        let prices = fit.iter().flat_map(|f| TARGETS.into_iter().filter_map(|t| price(f, t))).collect();
        let median = |runs: &Runs| {
            let mut s = runs.seconds.clone();
            s.sort_by(f64::total_cmp);
            quantile(&s, 0.5)
        };
        // Where errors do not converge, nobody knows what noise there will be.
        let converges = |fit: &Option<Fit>| fit.as_ref().is_none_or(Fit::converges);
        let known = converges(&fit) && converges(&Fit::new(&full.squares(Kind::Full)));
        let own = runs.price_of_noise(switch.kind, seconds_per_pass);
        let of_full = full.price_of_noise(Kind::Full, median(full));
        let bias = runs.parts.last().map_or(Interval::around(0.0, 0.0), bias_squared);
        Self {
            name: switch.name.clone(),
            what: switch.what.clone(),
            gives_up: switch.gives_up.clone(),
            flag: switch.flag.clone(),
            kind: switch.kind,
            seconds_per_pass,
            seconds_quartiles: [quartile(0.25), quartile(0.75)],
            rays_per_sample: runs.rays_per_sample,
            points: runs.levels.iter().zip(&runs.parts).map(point).collect(),
            fit,
            change: change(runs, full, light),
            floor: bias.root(),
            prices,
            efficiency: own.zip(of_full).filter(|_| known).map(|(own, full)| full / own),
            until: match (shortcut, known) {
                (false, _) => Until::NoShortcut,
                (true, false) => Until::NotKnown,
                (true, true) => until(own, of_full, bias),
            },
        }
    }

    /// What an error costs; none where no line could be drawn, or continued.
    #[must_use]
    pub fn price(&self, error: f64) -> Option<&Price> {
        self.prices.iter().find(|p| p.error == error)
    }

    /// Whether its errors were seen not to converge, so that nobody can say what a smaller one takes.
    #[must_use]
    pub fn does_not_converge(&self) -> bool {
        self.fit.as_ref().is_some_and(|f| !f.converges())
    }

    /// Whether its picture is proved to be another than the full one.
    #[must_use]
    pub fn differs(&self) -> bool {
        self.floor.low > 0.0 || !self.change.may_be_zero()
    }
}

fn point((spp, parts): (&u32, &Parts)) -> Point {
    Point {
        spp: *spp,
        error: Interval::of_root(&parts.squares),
        noise: parts.variance.max(0.0).sqrt(),
        bias_squared: bias_squared(parts),
    }
}

fn bias_squared(parts: &Parts) -> Interval {
    Interval::around(parts.bias, parts.bias_within)
}

/// Share of the light that is added, seed by seed, where both have as many samples.
fn change(runs: &Runs, full: &Runs, light: f64) -> Interval {
    let common = runs.levels.iter().rposition(|n| full.levels.contains(n));
    let pair = common.and_then(|i| Some((i, full.levels.iter().position(|n| *n == runs.levels[i])?)));
    let Some((i, k)) = pair else {
        return Interval { value: f64::NAN, low: f64::NEG_INFINITY, high: f64::INFINITY };
    };
    let totals = runs.parts[i].totals.iter().zip(&full.parts[k].totals);
    Interval::of_mean(&totals.map(|(a, b)| (a - b) / light).collect::<Vec<f64>>())
}

fn until(own: Option<f64>, full: Option<f64>, bias: Interval) -> Until {
    let (Some(own), Some(full)) = (own, full) else { return Until::NotSeen };
    if own >= full {
        return Until::Never;
    }
    if bias.low <= 0.0 {
        return Until::NotSeen;
    }
    let seconds = |b: f64| (full - own) / b;
    let seconds = Interval { value: seconds(bias.value), low: seconds(bias.high), high: seconds(bias.low) };
    Until::Seconds { seconds, error: (full / seconds.value).sqrt() }
}

/// A quantile of ascending numbers, between neighbours by the straight line; zero where there are none.
fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let at = q * last as f64;
    let k = (at as usize).min(last);
    let next = sorted[(k + 1).min(last)];
    sorted[k] + (next - sorted[k]) * (at - k as f64)
}

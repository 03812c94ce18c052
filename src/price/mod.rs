//! What shortcuts cost: the bias of each, with its sign, beside the work and the noise that it saves.
//!
//! In: a scene, and how it is rendered. Out: for each set of shortcuts a [`Price`]. A small picture of the scene is
//! rendered [`RUNS`] times in full and as often short, both with the same random addresses: where nothing is left
//! out a path is the same in both, so that their difference is much less noisy than either. The runs are independent
//! of each other, and give the intervals. Their seeds have a domain of their own, so that a picture and its price
//! share no noise.
//!
//! Each is rendered with the choices that a pilot makes for the picture itself ([`Budget::pilot`]), as renders of 64 samples
//! and more have them: what is compared is what would be rendered. So a price does not depend on how many samples the
//! picture takes.
//!
//! Work is counted in rays, and the runs are of fixed size, so that prices are a function of scene, settings and
//! nothing else, and may stand in a picture. Seconds are measured beside them, for people.
//!
//! Where it works badly: what is priced is the whole of a picture of 64x64 pixels or so. What is wrong in a corner of a
//! large one is averaged with the rest, and light that hardly any sample finds is missed in both renders.

mod estimate;
mod words;

pub use estimate::{Better, RUNS};

use std::time::Duration;

use estimate::Paired;

use crate::color::Rgb;
use crate::film::{Image, LightLayer};
use crate::integrate::{self, Control, RenderOptions, RunError};
use crate::math::{fnv1a, mix64};
use crate::pilot::{self, Asked};
use crate::prepare::{self, Options, Plan, PrepareError, Prepared, Shortcut};
use crate::scene::Scene;
use crate::stats::{Interval, luminance};

/// How much work a price is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Pixels of the small picture, at most; at least 1.
    pub pixels: u32,
    /// Samples per pixel of one run, at least 1.
    pub passes: u32,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Whether a pilot makes the choices that are open, for the picture in its own size, with and without the shortcuts.
    pub pilot: bool,
}

impl Default for Budget {
    /// Half a million samples in full, and as many short.
    fn default() -> Self {
        Self { pixels: 4096, passes: 8, threads: 0, pilot: true }
    }
}

impl Budget {
    /// Width and height of the small picture, in the aspect of the large one.
    fn size(&self, [width, height]: [u32; 2]) -> [u32; 2] {
        let pixels = f64::from(width) * f64::from(height);
        let scale = (f64::from(self.pixels) / pixels).sqrt().min(1.0);
        [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1))
    }
}

/// What some shortcuts cost, each taken alone, or all of them together.
#[derive(Clone, Debug, PartialEq)]
pub struct Priced {
    /// Which.
    pub shortcuts: Vec<Shortcut>,
    /// What they cost; or why nothing was measured: what they leave out is not there.
    pub price: Result<Price, String>,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Price {
    /// By how much the mean luminance differs from that of the full picture, relative to it: -0.03 is three per cent
    /// too dark.
    pub bias: Interval,
    /// The same of each part of the light, relative to all light of the full picture; they add up to `bias`.
    pub layers: Vec<(LightLayer, Interval)>,
    /// The root of the mean over pixels of (B - R)^2 / (R^2 + c^2), B being what the short picture converges to, R what
    /// the full one does, and c a tenth of the mean of R: as the error of a picture, but of bias alone.
    pub error: Interval,
    /// Rays of the short render over those of the full one, for as many samples.
    pub work: f64,
    /// Variance of the short render over that of the full one, for as many samples, both relative as in `error`.
    pub variance: f64,
    /// Until when the short render is the better choice.
    pub better: Better,
    /// Rays for each sample of the full render.
    pub rays: f64,
    /// What the full and the short runs took.
    pub elapsed: [Duration; 2],
}

/// Each of some shortcuts alone, and all of them together where there are several.
#[must_use]
pub fn alone_and_together(shortcuts: &[Shortcut]) -> Vec<Vec<Shortcut>> {
    let mut sets: Vec<_> = shortcuts.iter().map(|&s| vec![s]).collect();
    if sets.len() > 1 {
        sets.push(shortcuts.to_vec());
    }
    sets
}

/// Prices each set of shortcuts against the render that `options` describe without any; those that these take
/// themselves count for nothing.
///
/// # Errors
/// The scene cannot be prepared or rendered, or `control` cancels.
pub fn price(
    scene: &Scene,
    options: &Options,
    sets: &[Vec<Shortcut>],
    budget: &Budget,
    control: &dyn Control,
) -> Result<Vec<Priced>, RunError> {
    let full = Options { size: budget.size(options.size), ..options.without_shortcuts() };
    let mut render = Runs { scene, size: options.size, budget, control, full: None };
    let mut list = Vec::new();
    for shortcuts in sets {
        let plan = render.plan(&full)?;
        let idle: Vec<_> = shortcuts.iter().map(|s| s.idle(scene, &plan)).collect();
        let price = match idle.into_iter().collect::<Option<Vec<_>>>() {
            Some(reasons) => {
                Err(reasons.into_iter().next().unwrap_or_else(|| "nothing is left out".to_owned()))
            }
            None => render.price(&full, shortcuts)?,
        };
        list.push(Priced { shortcuts: shortcuts.clone(), price });
    }
    Ok(list)
}

/// The runs of one render.
struct Rendered {
    plan: Plan,
    size: [u32; 2],
    runs: Vec<Run>,
    /// Rays of all runs.
    rays: u64,
    elapsed: Duration,
}

/// Luminance of one run.
struct Run {
    pixels: Vec<f64>,
    /// Mean of each part of the light.
    layers: [f64; LightLayer::ALL.len()],
}

struct Runs<'a> {
    scene: &'a Scene,
    /// Of the picture itself.
    size: [u32; 2],
    budget: &'a Budget,
    control: &'a dyn Control,
    /// The full render, once it is needed.
    full: Option<Rendered>,
}

impl Runs<'_> {
    /// What is simulated in full.
    fn plan(&self, full: &Options) -> Result<Plan, RunError> {
        match &self.full {
            Some(rendered) => Ok(rendered.plan.clone()),
            None => Ok(prepare::plan(self.scene, full)?),
        }
    }

    fn price(&mut self, full: &Options, shortcuts: &[Shortcut]) -> Result<Result<Price, String>, RunError> {
        let short = shortcuts.iter().fold(full.clone(), |options, &s| options.with_shortcut(s));
        let short = self.render(&short)?;
        let full = match self.full.take() {
            Some(rendered) => rendered,
            None => self.render(full)?,
        };
        let price = self.compare(&full, &short);
        self.full = Some(full);
        Ok(price)
    }

    fn compare(&self, full: &Rendered, short: &Rendered) -> Result<Price, String> {
        let pixels = |rendered: &Rendered| -> Vec<Vec<f64>> {
            rendered.runs.iter().map(|r| r.pixels.clone()).collect()
        };
        let work = short.rays as f64 / full.rays.max(1) as f64;
        let width = full.size[0] as usize;
        let paired = Paired::new(pixels(full), pixels(short), width, self.budget.passes, work);
        let paired = paired.ok_or_else(|| "the picture is black".to_owned())?;
        let layer = |layer: LightLayer| {
            let means =
                |r: &Rendered| -> Vec<f64> { r.runs.iter().map(|r| r.layers[layer as usize]).collect() };
            (layer, paired.bias_of(&means(full), &means(short)))
        };
        let samples = full.runs.len() as f64
            * full.runs.first().map_or(0, |r| r.pixels.len()) as f64
            * f64::from(self.budget.passes);
        Ok(Price {
            bias: paired.bias(),
            layers: LightLayer::ALL.into_iter().map(layer).collect(),
            error: paired.error(),
            work,
            variance: paired.variance(),
            better: paired.better(),
            rays: full.rays as f64 / samples,
            elapsed: [full.elapsed, short.elapsed],
        })
    }

    /// The scene, ready for the small picture that `options` ask for.
    fn prepare(&self, options: &Options) -> Result<Prepared, PrepareError> {
        if !self.budget.pilot {
            return prepare::prepare(self.scene, options);
        }
        let picture = Options { size: self.size, ..options.clone() };
        let asked = Asked { threads: self.budget.threads, ..Asked::default() };
        let mut prepared = pilot::prepare(self.scene, &picture, &asked)?;
        let small = Options { algorithms: prepared.plan.algorithms(), ..options.clone() };
        let plan = prepare::plan(self.scene, &small)?;
        prepared.revise(self.scene, &small, plan)?;
        Ok(prepared)
    }

    fn render(&self, options: &Options) -> Result<Rendered, RunError> {
        let mut prepared = self.prepare(options)?;
        let how = RenderOptions {
            threads: self.budget.threads,
            layers: true,
            ..RenderOptions::passes(0..self.budget.passes)
        };
        let mut rendered = Rendered {
            plan: prepared.plan.clone(),
            size: options.size,
            runs: Vec::new(),
            rays: 0,
            elapsed: Duration::ZERO,
        };
        for run in 0..RUNS {
            prepared.seed = seed(options.seed, run);
            let outcome = integrate::render(&prepared, &how, self.control)?;
            if outcome.cancelled || outcome.partial {
                return Err(RunError::Cancelled);
            }
            rendered.runs.push(Run::of(&outcome.film.to_image()));
            rendered.rays += outcome.counters.rays;
            rendered.elapsed += outcome.elapsed;
        }
        Ok(rendered)
    }
}

/// The seed of a run of prices, for the seed of a render.
fn seed(of_render: u64, run: usize) -> u64 {
    mix64(mix64(of_render ^ fnv1a(*b"price of shortcuts")).wrapping_add(run as u64))
}

impl Run {
    fn of(image: &Image) -> Self {
        let pixels: Vec<f64> = image.rgb.iter().map(|&c| luminance(c)).collect();
        let mut layers = [0.0; LightLayer::ALL.len()];
        for (layer, mean) in LightLayer::ALL.into_iter().zip(&mut layers) {
            let channel = |name: &str| {
                let name = format!("{}.{name}", layer.name());
                let mut channels = image.layers.iter().flat_map(|l| &l.channels);
                channels.find(|(n, _)| *n == name).map_or(&[][..], |(_, values)| values)
            };
            let colors = channel("R").iter().zip(channel("G")).zip(channel("B"));
            let sum: f64 = colors.map(|((&r, &g), &b)| luminance(Rgb::new(r, g, b))).sum();
            *mean = sum / pixels.len().max(1) as f64;
        }
        Self { pixels, layers }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the small picture: never larger than the large one, in its aspect, never empty.
    #[test]
    fn small_pictures_keep_the_aspect() {
        let budget = Budget::default();
        assert_eq!(budget.size([800, 800]), [64, 64]);
        assert_eq!(budget.size([1920, 1080]), [85, 48]);
        assert_eq!(budget.size([20, 10]), [20, 10]);
        assert_eq!(budget.size([65_536, 1]), [16_384, 1]);
    }

    /// Guards the domain of seeds: no run shares its numbers with the render or with another run.
    #[test]
    fn seeds_differ() {
        let mut seeds: Vec<u64> = (0..RUNS).map(|run| seed(7, run)).chain([7]).collect();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), RUNS + 1);
    }

    #[test]
    fn sets_are_each_alone_and_all() {
        let two = [Shortcut::Schlick, Shortcut::MaxDepth(3)];
        assert_eq!(alone_and_together(&two), [vec![two[0]], vec![two[1]], two.to_vec()]);
        assert_eq!(alone_and_together(&two[..1]), [vec![two[0]]]);
        assert!(alone_and_together(&[]).is_empty());
    }
}

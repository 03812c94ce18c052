//! A short render before the render, which decides how it is done.
//!
//! In: a scene, what it is prepared for, and what is asked of the render. Out: the scene prepared by a plan whose
//! choices are made: how caustics are found, how many samples of lights a first hit takes, whether paths split at
//! the first glass, where roulette starts; each with the figures that it was decided by.
//!
//! A pilot renders small pictures of the same view by the choices in question (`trial`), with random numbers that no
//! picture has, and takes what needs the least work for the same error (`judge`): rays times squared error, both
//! counted. What changes is first seen to gain more than a tenth and more than two standard errors, and is then
//! tried once more with other numbers. All of this is a function of scene, options and the error that is asked for:
//! renders of 64 samples and more have one plan, and so have their parts; below, and in pictures too small for it,
//! no pilot runs.
//!
//! The work of a pilot is a twentieth of that of 64 samples at most. It is shared by so many trials that pictures below
//! about 100x100 pixels are left without.

mod caustics;
mod decide;
mod judge;
mod trial;

use self::judge::Truth;
use self::trial::Trial;
use crate::math::mix64;
use crate::prepare::{
    self, Algorithms, Caustics, CausticsMode, Options, Plan, PrepareError, Prepared, ROULETTE_START, analyse,
    camera_of, prepare_planned,
};
use crate::scene::Scene;

/// Below so many samples no pilot runs; renders without a limit count as having as many.
pub const LEAST_SAMPLES: u32 = 64;

/// Share of the work of [`LEAST_SAMPLES`] that a pilot takes at most.
pub const SHARE: f64 = 0.05;

/// Samples of a pixel in a trial: each replication is long enough to show what low-discrepancy sequences gain.
const PASSES: u32 = 32;

/// Pixels of a trial, at most; more would decide the same.
const MOST_PIXELS: f64 = 1024.0;

/// Pixels of a trial, at least: with fewer no gain is sure.
const LEAST_PIXELS: f64 = 64.0;

/// What all trials take together, in trials by paths alone, roughly: where nothing throws light, and where something
/// does. A pilot that finds itself above what it may take stops trying.
const TRIALS: [f64; 2] = [7.0, 16.0];

/// What is asked of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asked {
    /// Samples of a pixel; `None` where something else ends the render, and for parts of one.
    pub samples: Option<u32>,
    /// The error at which it ends, relative.
    pub error: Option<f64>,
    /// Threads of the pilot; 0 is one for each core. They change nothing.
    pub threads: usize,
}

impl Asked {
    /// Some samples.
    #[must_use]
    pub fn samples(samples: u32) -> Self {
        Self { samples: Some(samples), ..Self::default() }
    }
}

/// Prepares a scene by a plan whose choices are made by a pilot, where one runs, and else as
/// [`prepare::prepare`] does.
///
/// # Errors
/// Where the camera or the size that `options` ask for cannot be.
pub fn prepare(scene: &Scene, options: &Options, asked: &Asked) -> Result<Prepared, PrepareError> {
    let camera = camera_of(scene, options)?;
    let plan = analyse(scene, camera, options);
    let Some(size) = small(scene, options, asked, &plan)? else {
        return prepare_planned(scene, options, plan);
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(asked.threads).build();
    let run = || Pilot::new(scene, options, asked, size)?.run();
    match pool {
        Ok(pool) => pool.install(run),
        // Threads change nothing, so those that there are will do.
        Err(_) => run(),
    }
}

/// The plan that [`prepare()`] would take.
///
/// # Errors
/// As [`prepare()`].
pub fn plan(scene: &Scene, options: &Options, asked: &Asked) -> Result<Plan, PrepareError> {
    let plan = analyse(scene, camera_of(scene, options)?, options);
    match small(scene, options, asked, &plan)? {
        None => Ok(plan),
        Some(_) => Ok(prepare(scene, options, asked)?.plan),
    }
}

/// The size of the pictures of a pilot; `None` where none runs, since nothing is left to choose, or too few samples
/// or pixels are asked for.
fn small(
    scene: &Scene,
    options: &Options,
    asked: &Asked,
    plan: &Plan,
) -> Result<Option<[u32; 2]>, PrepareError> {
    let Algorithms { caustics, light_samples, split, roulette, .. } = options.algorithms;
    let throws = throws(scene, options)?;
    let open = caustics == CausticsMode::Auto && throws
        || light_samples.is_none()
        || split.is_none() && throws
        || roulette.is_none();
    if !open || plan.needs.is_empty() || asked.samples.is_some_and(|n| n < LEAST_SAMPLES) {
        return Ok(None);
    }
    let [width, height] = options.size.map(f64::from);
    let samples = width * height * f64::from(LEAST_SAMPLES) * SHARE / TRIALS[usize::from(throws)];
    let pixels = (samples / f64::from(PASSES)).min(MOST_PIXELS);
    let scale = (pixels / (width * height)).sqrt();
    let size = [width, height].map(|side| ((side * scale) as u32).max(1));
    Ok((pixels >= LEAST_PIXELS).then_some(size))
}

/// Whether photons find anything.
fn throws(scene: &Scene, options: &Options) -> Result<bool, PrepareError> {
    let algorithms = Algorithms { caustics: CausticsMode::Photon, ..options.algorithms };
    let options = Options { algorithms, ..options.clone() };
    Ok(analyse(scene, camera_of(scene, &options)?, &options).caustics != Caustics::Path)
}

/// A pilot under way.
struct Pilot<'a> {
    scene: &'a Scene,
    /// What the render is prepared for.
    options: &'a Options,
    asked: &'a Asked,
    /// Size of the trials.
    size: [u32; 2],
    /// Whether photons find anything.
    throws: bool,
    prepared: Prepared,
    truth: Truth,
    /// Rays so far, and those of a sample as it would now be taken.
    spent: f64,
    rays_of_sample: f64,
    trials: u32,
    /// What is chosen so far.
    chosen: Algorithms,
    /// Decisions with their reasons.
    reasons: Vec<(&'static str, String, String)>,
}

impl<'a> Pilot<'a> {
    fn new(
        scene: &'a Scene,
        options: &'a Options,
        asked: &'a Asked,
        size: [u32; 2],
    ) -> Result<Self, PrepareError> {
        let asked_for = options.algorithms;
        let chosen = Algorithms {
            caustics: match asked_for.caustics {
                CausticsMode::Auto => CausticsMode::Path,
                mode => mode,
            },
            unbiased: asked_for.unbiased,
            indirect: asked_for.indirect,
            light_samples: Some(asked_for.light_samples.unwrap_or(1)),
            split: Some(asked_for.split.unwrap_or(1)),
            roulette: Some(asked_for.roulette.unwrap_or(ROULETTE_START)),
        };
        // Whatever the first plan builds is there for all: photons need the most.
        let all = Options {
            algorithms: Algorithms { caustics: CausticsMode::Photon, ..chosen },
            ..options.clone()
        };
        let prepared = prepare::prepare(scene, &all)?;
        Ok(Self {
            scene,
            options,
            asked,
            size,
            throws: throws(scene, options)?,
            prepared,
            truth: Truth::default(),
            spent: 0.0,
            rays_of_sample: 0.0,
            trials: 0,
            chosen,
            reasons: Vec::new(),
        })
    }

    /// Decides, and leaves the scene prepared for the render.
    fn run(mut self) -> Result<Prepared, PrepareError> {
        let base = self.caustics()?;
        self.others(&base)?;
        let options = Options { algorithms: self.chosen, ..self.options.clone() };
        let mut plan = self.plan_by(self.chosen)?;
        // What was asked for, or needs no pilot, keeps its reason.
        for choice in self.plan_by(self.options.algorithms)?.choices {
            plan.explain(choice.about, choice.chosen, choice.reason);
        }
        let share = self.share();
        for (about, chosen, reason) in self.reasons {
            plan.explain(about, chosen, reason);
        }
        let [width, height] = self.size;
        plan.explain(
            "pilot",
            format!("{} of the work of {LEAST_SAMPLES} samples", percent(share)),
            format!("{} trials of {PASSES} samples at {width}x{height} pixels", self.trials),
        );
        self.prepared.revise(self.scene, &options, plan)?;
        Ok(self.prepared)
    }

    /// The plan of the render by some choices.
    fn plan_by(&self, algorithms: Algorithms) -> Result<Plan, PrepareError> {
        let options = Options { algorithms, ..self.options.clone() };
        Ok(analyse(self.scene, camera_of(self.scene, &options)?, &options))
    }

    /// Makes the scene ready for a trial by some choices, with the numbers of a stage.
    fn ready(&mut self, algorithms: Algorithms, stage: u64) -> Result<(), PrepareError> {
        let seed = mix64(mix64(self.options.seed ^ 0x7069_6c6f_7421).wrapping_add(stage));
        let options = Options { algorithms, size: self.size, seed, ..self.options.clone() };
        let plan = analyse(self.scene, camera_of(self.scene, &options)?, &options);
        self.prepared.revise(self.scene, &options, plan)
    }

    fn try_out(&mut self, algorithms: Algorithms, stage: u64) -> Result<Trial, PrepareError> {
        self.ready(algorithms, stage)?;
        let trial = Trial::run(&self.prepared, 0..PASSES, self.pixels());
        self.spent += trial.spent;
        self.trials += 1;
        self.truth.add(&trial);
        Ok(trial)
    }

    /// Pixels of the picture.
    fn pixels(&self) -> u64 {
        self.options.size.map(u64::from).iter().product()
    }

    /// Takes the choices of a trial for those of the render.
    fn take(&mut self, trial: &Trial) {
        self.rays_of_sample = trial.rays / trial.pixels() as f64;
    }

    /// Share of the work of [`LEAST_SAMPLES`] by the choices so far that the pilot has taken.
    fn share(&self) -> f64 {
        let render = self.pixels() as f64 * f64::from(LEAST_SAMPLES) * self.rays_of_sample;
        self.spent / render.max(1.0)
    }

    /// Rays that the pilot may still take.
    fn left(&self) -> f64 {
        let render = self.pixels() as f64 * f64::from(LEAST_SAMPLES) * self.rays_of_sample;
        SHARE * render - self.spent
    }

    /// Whether so many times the work of `trial` is within what the pilot may still take.
    fn affords(&self, trial: &Trial, times: f64) -> bool {
        trial.spent * times <= self.left()
    }

    fn decide(&mut self, about: &'static str, chosen: impl Into<String>, reason: impl Into<String>) {
        self.reasons.push((about, chosen.into(), reason.into()));
    }
}

/// A ratio for people.
fn times(x: f64) -> String {
    match x {
        x if x >= 100.0 => format!("{x:.0}"),
        x if x >= 10.0 => format!("{x:.1}"),
        x => format!("{x:.2}"),
    }
}

/// A share for people.
fn percent(x: f64) -> String {
    match 100.0 * x {
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 1.0 => format!("{p:.1} %"),
        p if p >= 0.1 => format!("{p:.2} %"),
        p => format!("{p:.3} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::{Quiet, RenderOptions, render};
    use crate::prepare::EffectsMode;
    use crate::scene::text::parse_toml;
    use crate::scene::{complete, validate};

    fn scene(text: &str) -> Scene {
        let mut scene = parse_toml(text).expect("a scene").0;
        validate(&mut scene).expect("a valid scene");
        complete(&mut scene);
        scene
    }

    fn options(size: [u32; 2], algorithms: Algorithms) -> Options {
        Options {
            camera: None,
            size,
            seed: 5,
            effects: EffectsMode::Auto,
            max_depth: None,
            shortcuts: prepare::Shortcuts::default(),
            transparent: false,
            algorithms,
        }
    }

    const SIZE: [u32; 2] = [128, 112];

    /// Guards that the plan is a function of scene and options: threads and samples from 64 on change nothing, and a
    /// pilot stays within its share.
    #[test]
    fn one_plan_for_all_samples() {
        let room = scene(include_str!("../../scenes/hexroom.toml"));
        let options = options(SIZE, Algorithms::default());
        let with = |samples, threads| {
            plan(&room, &options, &Asked { samples, error: None, threads }).expect("a camera")
        };
        let found = with(Some(64), 1);
        assert_eq!(found, with(Some(100_000), 2));
        assert_eq!(found, with(None, 3));
        let pilot = found.choices.iter().find(|c| c.about == "pilot").expect("a pilot");
        let share: f64 = pilot.chosen.split(' ').next().and_then(|n| n.parse().ok()).expect("a number");
        assert!(share > 0.1 && share <= 100.0 * SHARE, "{pilot:?}");
    }

    /// Guards that what a pilot leaves behind is what its plan would be prepared to, and nothing of the pilot.
    #[test]
    fn a_pilot_leaves_nothing_but_its_plan() {
        for text in [include_str!("../../scenes/caustic.toml"), include_str!("../../scenes/cornell.toml")] {
            let (scene, options) = (scene(text), options(SIZE, Algorithms::default()));
            let after = prepare(&scene, &options, &Asked::samples(64)).expect("a camera");
            let anew = prepare_planned(&scene, &options, after.plan.clone()).expect("a camera");
            let film = |prepared: &Prepared| {
                render(prepared, &RenderOptions::passes(0..2), &Quiet).expect("passes").film
            };
            assert!(film(&after) == film(&anew));
        }
    }

    /// Guards when no pilot runs: below 64 samples, in small pictures, and where nothing is left to choose.
    #[test]
    fn no_pilot_where_none_pays() {
        let room = scene(include_str!("../../scenes/cornell.toml"));
        let ran = |options: &Options, asked: Asked| {
            let plan = plan(&room, options, &asked).expect("a camera");
            plan.choices.iter().any(|c| c.about == "pilot")
        };
        let open = options(SIZE, Algorithms::default());
        assert!(ran(&open, Asked::default()));
        assert!(ran(&open, Asked::samples(64)));
        assert!(!ran(&open, Asked::samples(63)));
        assert!(!ran(&options([64, 48], Algorithms::default()), Asked::samples(64)));
        assert!(!ran(&options(SIZE, Algorithms::PATHS), Asked::samples(64)));
        // Without a pilot the plan is the one of `analyse`.
        let camera = camera_of(&room, &open).expect("a camera");
        assert_eq!(plan(&room, &open, &Asked::samples(8)).expect("a camera"), analyse(&room, camera, &open));
    }
}

//! `epsilux render`

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use super::Code;
use super::adopt::adopt;
use super::args::{Aov, MAX_SAMPLES, Method, ProgressArg, RenderArgs, SlipArg};
use super::compare::unusable;
use super::console::Console;
use super::failure::Failure;
use super::forecast::Forecaster;
use super::load::{self, Loaded};
use super::machine::Seconds;
use super::notes;
use super::parts::Checkpoint;
use super::progress::{Display, Watch};
use super::rendered::Rendered;
use super::saver::{Saved, Saver};
use super::shortcuts;
use super::signal::Stop;
use super::stated::Stated;
use crate::film::{Film, Image};
use crate::integrate::naive::{ReferenceError, ReferenceOptions, reference};
use crate::integrate::report::{ReportError, ReportOptions, Shortcuts, Slips, Tracer, rays_per_pixel};
use crate::integrate::{self, Control, Progress, RenderError, RenderOptions};
use crate::output::{self, Format, Tone, WriteOptions};
use crate::part::Part;
use crate::pilot::{self, Asked};
use crate::prepare::{self, Algorithms, EffectsMode, PrepareError, Prepared};
use crate::report::Explanation;
use crate::scene::{Camera, Note, NoteEffect, Scene, sha256};

pub(super) fn run(args: &RenderArgs, arguments: &[OsString], console: &Console) -> Result<Code, Failure> {
    let begin = Instant::now();
    let outputs =
        if args.output.is_empty() { default_outputs(&args.scene.scene) } else { args.output.clone() };
    if args.replay.is_none() {
        check_outputs(&outputs)?;
    }
    check_flags(args, &outputs)?;
    let loaded = load::load(&args.scene)?;
    let job = Job::from_args(args, &loaded.scene, outputs)?;
    if let Some(sample) = args.replay {
        return job.replay(&loaded.scene, sample, console);
    }
    if args.strict {
        notes::refuse(&loaded.notes, notes::RENDERED)?;
    }
    job.run(loaded, begin, arguments, console)
}

/// The scene's name with .png and .exr, in the current folder.
fn default_outputs(scene: &Path) -> Vec<PathBuf> {
    let stem = Path::new(scene.file_stem().unwrap_or(scene.as_os_str()));
    // Appended, not exchanged: a scene called `room.v2.toml` becomes `room.v2.png`.
    let named = |suffix: &str| PathBuf::from(format!("{}.{suffix}", stem.display()));
    vec![named("png"), named("exr")]
}

/// Finds out before any work whether the outputs can be written.
pub(super) fn check_outputs(outputs: &[PathBuf]) -> Result<(), Failure> {
    outputs.iter().try_for_each(|path| output::check_path(path).map(drop).map_err(|e| unusable(&e)))
}

/// Flags that contradict each other or would have no effect.
fn check_flags(args: &RenderArgs, outputs: &[PathBuf]) -> Result<(), Failure> {
    let exr = outputs.iter().any(|o| Format::of(o) == Some(Format::Exr));
    if !args.aov.is_empty() && !exr {
        return Err(Failure::usage("--aov: layers fit only into .exr files, and no output is one")
            .help("add an output such as -o layers.exr"));
    }
    let (name, progress) = match args.method {
        Method::Default => ("default", true),
        Method::Reference => ("reference", false),
        Method::Report => ("report", true),
    };
    let others = args.method != Method::Default;
    if let Some(flag) = args.shortcuts.of_the_default_method().filter(|_| others) {
        return Err(Failure::usage(format!("{flag} is not available with --method {name}")));
    }
    let without: [(&str, bool); 12] = [
        ("--time", others && args.time.is_some()),
        ("--error", others && args.error.is_some()),
        ("--replay", others && args.replay.is_some()),
        ("--passes", others && args.passes.is_some()),
        ("--checkpoint", others && args.checkpoint.is_some()),
        ("--aov", others && !args.aov.is_empty()),
        ("--transparent", others && args.transparent),
        ("--effects", others && EffectsMode::from(args.effects) != EffectsMode::Auto),
        ("--algorithm", others && !args.algorithms.algorithm.is_empty()),
        ("--unbiased", others && args.algorithms.unbiased),
        ("--progress json", !progress && args.progress == ProgressArg::Json),
        ("--as-printed", args.method != Method::Report && args.as_printed.is_some()),
    ];
    if let Some((flag, _)) = without.into_iter().find(|(_, given)| *given) {
        return Err(Failure::usage(format!("{flag} is not available with --method {name}")));
    }
    Ok(())
}

/// The camera that was asked for.
pub(super) fn camera<'a>(scene: &'a Scene, name: Option<&str>) -> Result<&'a Camera, Failure> {
    let found = match name {
        None => scene.cameras.first(),
        Some(name) => scene.cameras.iter().find(|c| c.name == name),
    };
    found.ok_or_else(|| {
        let known = scene.cameras.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ");
        Failure::usage(format!("--camera: found {:?}, expected one of: {known}", name.unwrap_or_default()))
    })
}

/// The picture's size: as asked, else as the scene says, else 800 pixels wide.
pub(super) fn picture_size(scene: &Scene, camera: &Camera, asked: Option<[u32; 2]>) -> [u32; 2] {
    let from_aspect = || match camera.aspect {
        Some(aspect) => [800, (800.0 / aspect).round().clamp(1.0, 65_536.0) as u32],
        None => [800, 600],
    };
    asked.or(scene.settings.size).unwrap_or_else(from_aspect)
}

/// Samples per pixel where none are asked for: as the scene says, else 64.
pub(super) fn default_samples(scene: &Scene) -> u32 {
    scene.settings.spp.unwrap_or(64).clamp(1, MAX_SAMPLES)
}

/// A render as meant.
pub(super) struct Job {
    pub(super) scene_name: String,
    pub(super) outputs: Vec<PathBuf>,
    pub(super) prepare: prepare::Options,
    pub(super) camera: String,
    /// Samples per pixel, at most.
    pub(super) passes: u32,
    /// Samples per pixel as a pilot has to know them: none for parts, and where something else ends the render.
    pub(super) samples: Option<u32>,
    /// The first pass.
    pub(super) first: u32,
    pub(super) error: Option<f64>,
    pub(super) checkpoint: Option<PathBuf>,
    pub(super) checkpoint_every: Duration,
    pub(super) time: Option<Duration>,
    pub(super) threads: usize,
    pub(super) crop: Option<[u32; 4]>,
    pub(super) aovs: Vec<Aov>,
    pub(super) tone: Tone,
    pub(super) method: Method,
    pub(super) slips: Slips,
    pub(super) progress: ProgressArg,
    pub(super) strict: bool,
    pub(super) quiet: bool,
    pub(super) verbose: bool,
}

impl Job {
    /// A render with every default.
    pub(super) fn new(name: &str, scene: &Scene, camera: &Camera, size: [u32; 2]) -> Self {
        let hints = &scene.settings;
        Self {
            scene_name: name.to_owned(),
            outputs: Vec::new(),
            prepare: prepare::Options {
                camera: Some(camera.name.clone()),
                size,
                seed: 0,
                effects: EffectsMode::Auto,
                max_depth: hints.max_depth,
                shortcuts: prepare::Shortcuts::of(hints),
                transparent: false,
                algorithms: Algorithms::default(),
            },
            camera: camera.name.clone(),
            passes: default_samples(scene),
            samples: Some(default_samples(scene)),
            first: 0,
            error: None,
            checkpoint: None,
            checkpoint_every: Duration::from_secs(30),
            time: None,
            threads: 0,
            crop: None,
            aovs: Vec::new(),
            tone: Tone { curve: hints.tone.unwrap_or_default(), exposure: hints.exposure.unwrap_or(0.0) },
            method: Method::Default,
            slips: Slips::NONE,
            progress: ProgressArg::Auto,
            strict: false,
            quiet: false,
            verbose: false,
        }
    }

    /// Flags as typed over the scene's hints over the defaults.
    fn from_args(args: &RenderArgs, scene: &Scene, outputs: Vec<PathBuf>) -> Result<Self, Failure> {
        let camera = camera(scene, args.camera.as_deref())?;
        let name = args.scene.scene.display().to_string();
        let mut job = Self::new(&name, scene, camera, picture_size(scene, camera, args.size));
        job.outputs = outputs;
        job.prepare.seed = args.seed;
        job.prepare.effects = args.effects.into();
        job.prepare.transparent = args.transparent;
        job.prepare.algorithms = args.algorithms.meant();
        args.shortcuts.take(&mut job.prepare);
        job.passes = match (args.spp, args.time.is_some() || args.error.is_some()) {
            (Some(spp), _) => spp,
            (None, true) => MAX_SAMPLES,
            (None, false) => job.passes,
        };
        let unlimited = args.spp.is_none() && (args.time.is_some() || args.error.is_some());
        job.samples = Some(job.passes).filter(|_| args.passes.is_none() && !unlimited);
        if let Some(passes) = &args.passes {
            (job.first, job.passes) = (passes.start, passes.end);
        }
        job.error = args.error;
        job.checkpoint.clone_from(&args.checkpoint);
        job.checkpoint_every = args.checkpoint_every;
        job.time = args.time;
        job.threads = args.threads;
        job.crop = args.crop;
        job.aovs.clone_from(&args.aov);
        job.tone.curve = args.tone.map_or(job.tone.curve, Into::into);
        job.tone.exposure = args.exposure.unwrap_or(job.tone.exposure);
        job.method = args.method;
        if job.method != Method::Default {
            job.prepare.algorithms = Algorithms::PATHS;
        }
        job.slips = args.as_printed.as_deref().map_or(Slips::NONE, SlipArg::slips);
        if job.method == Method::Report {
            job.passes = rays_per_pixel(job.passes);
            job.prepare.max_depth = job.prepare.max_depth.or(Some(Shortcuts::REPORT.depth));
        }
        job.progress = args.progress;
        job.strict = args.strict;
        job.quiet = args.quiet;
        job.verbose = args.verbose;
        Ok(job)
    }

    /// Prepares, renders, writes, reports.
    pub(super) fn run(
        &self,
        loaded: Loaded,
        begin: Instant,
        arguments: &[OsString],
        console: &Console,
    ) -> Result<Code, Failure> {
        let Loaded { scene, mut notes } = loaded;
        let load = begin.elapsed().as_secs_f64();
        if !self.quiet {
            notes::show(&notes, self.verbose, console);
        }
        let watch = Watch {
            display: Display::new(self.progress, self.quiet, console),
            stop: Stop::listen(),
            forecaster: self.error.map(Forecaster::new),
            before: AtomicU32::new(0),
        };
        if self.method != Method::Default && scene.settings.indirect_gain.is_some_and(|gain| gain != 1.0) {
            let message = format!("--method {} does not amplify indirect light", self.method_name());
            let (place, effect) = ("render.indirect_gain".to_owned(), NoteEffect::Differs);
            let note = Note { code: "indirect-gain-ignored", place, message, effect };
            if self.strict {
                notes::refuse(std::slice::from_ref(&note), notes::RENDERED)?;
            }
            if !self.quiet {
                notes::show(std::slice::from_ref(&note), self.verbose, console);
            }
            notes.push(note);
        }
        let rendering = Instant::now();
        let hash = sha256(&scene);
        let (mut rendered, prepare) = match self.method {
            Method::Default => match self.render(&scene, &hash, &watch, console)? {
                Some(rendered) => rendered,
                None => {
                    console.message("stopped by a signal before the render began: nothing is written");
                    return Ok(watch.stop.code().unwrap_or(Code::Interrupted));
                }
            },
            Method::Reference => (self.render_reference(&scene, &watch)?, 0.0),
            Method::Report => (self.render_report(&scene, &watch, &mut notes, console)?, 0.0),
        };
        let render = rendering.elapsed().as_secs_f64() - prepare;
        watch.display.clear();
        rendered.quoted = watch.forecaster.as_ref().and_then(Forecaster::quoted);
        let lights = &rendered.stated.lights;
        let identity = self.identity(&rendered.plan, lights, &hash, &rendered.prices)?;
        rendered.image.attributes = rendered.stated.attributes(&identity);
        keep_layers(&mut rendered.image, &self.aovs);
        let writing = Instant::now();
        for path in &self.outputs {
            let options = WriteOptions { tone: self.tone };
            output::write(&rendered.image, path, &options).map_err(|e| unusable(&e))?;
        }
        let write = writing.elapsed().as_secs_f64();
        let stopped = watch.stop.code();
        let seconds = Seconds { load, prepare, render, write };
        let report = self.report(&rendered, &hash, seconds, stopped.is_some(), &notes, arguments)?;
        self.write_report(&report)?;
        if !self.quiet {
            self.summarise(&rendered, seconds, stopped, console);
        }
        if !self.quiet {
            let names = self.outputs.iter().map(|p| p.display().to_string()).collect::<Vec<_>>();
            console.result(&names.join("\n"))?;
        }
        let short = self.error.is_some() && !rendered.reached;
        Ok(stopped.unwrap_or(if short { Code::Short } else { Code::Done }))
    }

    /// The scene, prepared by the plan of what was saved of this render, or by one that is made for it.
    fn prepared(&self, scene: &Scene, saved: Option<&Part>) -> Result<Prepared, Failure> {
        let prepared = match saved {
            Some(part) => {
                let mut options = self.prepare.clone();
                let plan = adopt(scene, &mut options, &part.identity);
                plan.and_then(|plan| prepare::prepare_planned(scene, &options, plan))
            }
            None => {
                let asked = Asked { samples: self.samples, error: self.error, threads: self.threads };
                pilot::prepare(scene, &self.prepare, &asked)
            }
        };
        prepared.map_err(|e| match e {
            PrepareError::NoCamera => Failure::load(format!("{}: {e}", self.scene_name)),
            _ => Failure::usage(e.to_string()),
        })
    }

    /// Traces one sample alone.
    fn replay(&self, scene: &Scene, [x, y, pass]: [u32; 3], console: &Console) -> Result<Code, Failure> {
        let prepared = self.prepared(scene, None)?;
        let [width, height] = prepared.size;
        if x >= width || y >= height || pass >= MAX_SAMPLES {
            let most = MAX_SAMPLES - 1;
            return Err(Failure::usage(format!(
                "--replay: found pixel {x},{y} and pass {pass}, expected at most {},{} and {most}",
                width - 1,
                height - 1
            )));
        }
        let radiance = integrate::replay(&prepared, [x, y], pass).radiance;
        console.result(&format!("{} {} {}", radiance.r, radiance.g, radiance.b))?;
        Ok(Code::Done)
    }

    /// The default method; also the seconds that preparing took, prices included. `None` where somebody stopped it
    /// before it began.
    fn render(
        &self,
        scene: &Scene,
        hash: &str,
        watch: &Watch<'_>,
        console: &Console,
    ) -> Result<Option<(Rendered, f64)>, Failure> {
        let begin = Instant::now();
        let checkpoint = self.checkpoint.as_deref().map(Checkpoint::new);
        let found = checkpoint.as_ref().map_or(Ok(None), Checkpoint::read)?;
        let prepared = self.prepared(scene, found.as_ref().map(|f| &f.part))?;
        let Some(prices) = shortcuts::prices(scene, &self.prepare, self.threads, watch)? else {
            return Ok(None);
        };
        if !self.quiet {
            prices.iter().for_each(|priced| console.message(&priced.to_string()));
        }
        if self.verbose {
            // Notes have been said.
            let explanation = Explanation::new(&prepared.plan, &[]);
            console.message(&if console.colours() {
                explanation.coloured()
            } else {
                explanation.to_string()
            });
        }
        let seconds = begin.elapsed().as_secs_f64();
        let mut options = RenderOptions {
            passes: self.first..self.passes,
            time: self.time,
            error: self.error,
            threads: self.threads,
            crop: self.crop,
            sparse: None,
            features: self.aovs.iter().any(|a| *a != Aov::Layers),
            layers: self.aovs.contains(&Aov::Layers),
            layer_noise: false,
        };
        let identity = self.identity(&prepared.plan, prepared.lights_apart(), hash, &prices)?;
        let screen = (self.tone.curve.name().to_owned(), self.tone.exposure);
        let mut film = Film::new(integrate::layout(&prepared, &options));
        let mut saver = None;
        if let Some(checkpoint) = checkpoint {
            let every = self.checkpoint_every;
            let (opened, saved) =
                Saver::open(checkpoint, found, &identity, screen, &options.passes, every, console)?;
            if let Some(part) = saved {
                options.passes.start = part.passes.last().map_or(self.first, |r| r.end);
                watch.before.store(options.passes.start, Ordering::Relaxed);
                film = part.film;
            }
            saver = Some(opened);
        }
        let control = Saved { watch, saver: saver.as_ref() };
        let outcome = integrate::render_onto(&prepared, film, &options, &control).map_err(|e| match e {
            RenderError::Crop { .. } => Failure::usage(format!("--crop: {e}")),
            RenderError::Film => Failure::usage(format!("--checkpoint: {e}")),
            RenderError::NoPasses | RenderError::Sparse | RenderError::Threads { .. } => {
                Failure::usage(e.to_string())
            }
        })?;
        if let Some(saver) = &saver {
            saver.finish(&outcome)?;
        }
        let (plan, lights) = (prepared.plan.clone(), prepared.lights_apart());
        Ok(Some((Rendered::new(outcome, self.first, plan, lights, prices), seconds)))
    }

    /// The report's method; what it renders otherwise is added to the notes.
    fn render_report(
        &self,
        scene: &Scene,
        watch: &Watch<'_>,
        notes: &mut Vec<Note>,
        console: &Console,
    ) -> Result<Rendered, Failure> {
        let camera = self.camera_index(scene);
        let options = ReportOptions {
            camera,
            size: self.prepare.size,
            crop: self.crop,
            rays: self.passes,
            seed: self.prepare.seed,
            threads: self.threads,
            slips: self.slips,
            shortcuts: Shortcuts {
                depth: self.prepare.max_depth.unwrap_or(Shortcuts::REPORT.depth),
                ..Shortcuts::REPORT
            },
        };
        let failure = |e: ReportError| match e {
            ReportError::Render(RenderError::Crop { .. }) => Failure::usage(format!("--crop: {e}")),
            ReportError::Render(_) => Failure::usage(e.to_string()),
            _ => Failure::load(format!("{}: {e}", self.scene_name)),
        };
        let tracer = Tracer::new(scene, &options).map_err(failure)?;
        if self.strict {
            notes::refuse(tracer.notes(), notes::RENDERED)?;
        }
        if !self.quiet {
            notes::show(tracer.notes(), self.verbose, console);
        }
        notes.extend(tracer.notes().iter().cloned());
        let outcome = tracer.render(&options, watch).map_err(failure)?;
        let plan = prepare::analyse(scene, &scene.cameras[camera], &self.prepare);
        Ok(Rendered::new(outcome, 0, plan, &[], Vec::new()))
    }

    fn camera_index(&self, scene: &Scene) -> usize {
        scene.cameras.iter().position(|c| c.name == self.camera).unwrap_or(0)
    }

    fn render_reference(&self, scene: &Scene, watch: &Watch<'_>) -> Result<Rendered, Failure> {
        let index = self.camera_index(scene);
        let options = ReferenceOptions {
            camera: index,
            size: self.prepare.size,
            crop: self.crop,
            spp: self.passes,
            seed: self.prepare.seed,
            max_depth: self.prepare.max_depth,
            threads: self.threads,
        };
        let begin = Instant::now();
        let [_, _, width, height] = self.crop.unwrap_or([0, 0, self.prepare.size[0], self.prepare.size[1]]);
        let total = u64::from(width) * u64::from(height) * u64::from(self.passes);
        let progress = |share: f64| {
            let samples = (share * total as f64) as u64;
            let elapsed = begin.elapsed();
            watch.progress(&Progress {
                samples,
                samples_total: total,
                passes: 0,
                rays: 0,
                elapsed,
                time: None,
                error: None,
                error_target: None,
            });
        };
        let image = reference(scene, &options, &|| watch.cancelled(), &progress).map_err(|e| match e {
            ReferenceError::NoCamera { .. } => Failure::load(format!("{}: {e}", self.scene_name)),
            ReferenceError::Crop { .. } => Failure::usage(format!("--crop: {e}")),
            ReferenceError::Threads(_) => Failure::usage(e.to_string()),
        })?;
        let partial = image.count.as_ref().is_some_and(|c| c.contains(&0));
        Ok(Rendered {
            image,
            stated: Stated {
                passes: std::iter::once(0..self.passes).collect(),
                partial,
                ..Stated::default()
            },
            plan: prepare::analyse(scene, &scene.cameras[index], &self.prepare),
            prices: Vec::new(),
            added: self.passes,
            reached: false,
            threads: self.threads,
            counters: None,
            refused: 0,
            bad: Vec::new(),
            quoted: None,
        })
    }
}

/// Drops the layers that were not asked for.
fn keep_layers(image: &mut Image, aovs: &[Aov]) {
    let wanted =
        |name: &str| aovs.iter().any(|a| name.split('.').next().is_some_and(|n| a.groups().contains(&n)));
    image.layers.retain(|l| l.channels.iter().any(|(name, _)| wanted(name)));
}

//! Tiles, threads, passes and progress.
//!
//! A pass is one sample for each pixel and the unit of everything: of stopping, of sharing work over
//! machines, of what a file says it holds. Work is handed out as (pass, tile) in order, without a
//! barrier; the samples of a pass wait until all its tiles are done and are then added to the film
//! together, so that the film always holds whole passes. The order in which they arrive does not
//! matter to its bytes.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use super::kernels::{Kernel, kernel};
use super::li::{Counters, first_surface};
use crate::film::{Features, Film, FilmLayout, Refusal, Sample};
use crate::prepare::{PrepareError, Prepared};
use crate::sampling::warp::square_to_disk;
use crate::sampling::{Address, Purpose};

/// Side of a tile, pixels.
const TILE: u32 = 16;
/// Refused samples that are reported one by one.
const REPORTED: usize = 8;

/// What to render of a prepared scene.
#[derive(Clone, Debug)]
pub struct RenderOptions {
    /// Passes, half open; `0..n` gives n samples for each pixel.
    pub passes: Range<u32>,
    /// Stops handing out work after this long.
    pub time: Option<Duration>,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Left, top, width and height of the part to render, pixels of the whole picture.
    pub crop: Option<[u32; 4]>,
    /// Whether to record features of the first surface (albedo, normal, depth, position, ids).
    pub features: bool,
    /// Whether to record the parts of the light ([`LightLayer`](crate::film::LightLayer)) and each pixel's
    /// brightest sample.
    pub layers: bool,
}

impl RenderOptions {
    /// Some passes of the whole picture on all cores, and nothing else.
    #[must_use]
    pub fn passes(passes: Range<u32>) -> Self {
        Self { passes, time: None, threads: 0, crop: None, features: false, layers: false }
    }
}

/// How far a render is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Samples taken so far.
    pub samples: u64,
    /// Samples asked for.
    pub samples_total: u64,
    /// Passes that are complete.
    pub passes: u32,
    /// Rays traced so far.
    pub rays: u64,
    /// Time since the render began.
    pub elapsed: Duration,
    /// Time that was asked for.
    pub time: Option<Duration>,
}

impl Progress {
    /// Share of the target that is reached, [0, 1]: of the samples or of the time, whichever is nearer
    /// to its end.
    #[must_use]
    pub fn share(&self) -> f64 {
        let samples = self.samples as f64 / self.samples_total.max(1) as f64;
        let time = self.time.map_or(0.0, |t| self.elapsed.as_secs_f64() / t.as_secs_f64().max(1e-9));
        samples.max(time).min(1.0)
    }
}

/// Whoever watches a render; called from its threads.
pub trait Control: Sync {
    /// Called now and then.
    fn progress(&self, _progress: &Progress) {}
    /// Asked often; true ends the render soon.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl Control for Quiet {}

/// A sample that the film refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BadSample {
    /// Pixel of the whole picture.
    pub pixel: [u32; 2],
    /// Pass.
    pub pass: u32,
    /// Why.
    pub reason: Refusal,
}

/// What a render gave.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The sums.
    pub film: Film,
    /// The passes that the film holds whole.
    pub passes: Range<u32>,
    /// True where not even one pass was complete: some pixels are empty.
    pub partial: bool,
    /// True where it ended because someone asked.
    pub cancelled: bool,
    /// Rays, and paths that were cut.
    pub counters: Counters,
    /// Some of the samples that were refused; the film counts all.
    pub bad: Vec<BadSample>,
    /// Wall-clock time.
    pub elapsed: Duration,
    /// Threads that worked.
    pub threads: usize,
}

/// Why a render could not start.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RenderError {
    /// The crop is empty or reaches beyond the picture.
    #[error("the crop {crop:?} (left, top, width, height) is not inside of a picture of {}x{}", .size[0], .size[1])]
    Crop {
        /// What was asked for.
        crop: [u32; 4],
        /// The whole picture.
        size: [u32; 2],
    },
    /// There is nothing to do.
    #[error("no samples were asked for")]
    NoPasses,
    /// The threads could not be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system said.
        reason: String,
    },
}

/// Why a scene could not be prepared and rendered.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene cannot be prepared.
    #[error("{0}")]
    Prepare(#[from] PrepareError),
    /// The render could not start.
    #[error("{0}")]
    Render(#[from] RenderError),
    /// Somebody asked to stop.
    #[error("stopped")]
    Cancelled,
}

/// Whoever makes the samples: a method of light transport on a scene.
pub(super) trait Source: Sync {
    /// The sample of `pass` at a pixel of the whole picture: a function of these two and nothing else.
    fn sample(&self, pixel: [u32; 2], pass: u32, counters: &mut Counters) -> Sample;
}

/// The default method.
struct Planned<'a> {
    scene: &'a Prepared,
    kernel: Kernel,
    features: bool,
    layers: bool,
}

impl Source for Planned<'_> {
    fn sample(&self, pixel: [u32; 2], pass: u32, counters: &mut Counters) -> Sample {
        let mut s = sample(self.scene, &self.kernel, self.layers, pixel, pass, counters);
        if self.features {
            s.features = features(self.scene, pixel, pass);
        }
        s
    }
}

/// A sample at a pixel of the whole picture.
fn sample(
    scene: &Prepared,
    kernel: &Kernel,
    layers: bool,
    pixel: [u32; 2],
    pass: u32,
    counters: &mut Counters,
) -> Sample {
    let k = scene.plan.replications;
    let index = u64::from(pixel[1]) * u64::from(scene.size[0]) + u64::from(pixel[0]);
    let address = Address::new(scene.seed, index, pass % k, pass / k);
    let u = address.block(0, Purpose::Camera, 0, 0);
    let ray = scene.camera.ray(pixel, [u[0], u[1]], || square_to_disk([u[2], u[3]]));
    if layers {
        let (radiance, layers) = (kernel.layered)(scene, address, ray, counters);
        return Sample { radiance, features: None, layers: Some(layers) };
    }
    let radiance = (kernel.li)(scene, address, ray, counters);
    Sample { radiance, features: None, layers: None }
}

/// What the first surface seen through a sample is like.
fn features(scene: &Prepared, pixel: [u32; 2], pass: u32) -> Option<Features> {
    let k = scene.plan.replications;
    let index = u64::from(pixel[1]) * u64::from(scene.size[0]) + u64::from(pixel[0]);
    let address = Address::new(scene.seed, index, pass % k, pass / k);
    let u = address.block(0, Purpose::Camera, 0, 0);
    let ray = scene.camera.ray(pixel, [u[0], u[1]], || square_to_disk([u[2], u[3]]));
    let (surface, material, albedo) = first_surface(scene, &address, ray)?;
    Some(Features {
        albedo,
        normal: surface.ns.to_array(),
        depth: scene.camera.depth(surface.p),
        position: surface.p.to_array(),
        object: surface.object + 1,
        material: material + 1,
    })
}

/// Traces one sample alone: the very one that a render takes at this pixel and pass.
#[must_use]
pub fn replay(scene: &Prepared, pixel: [u32; 2], pass: u32) -> Sample {
    sample(scene, &kernel(&scene.plan), false, pixel, pass, &mut Counters::default())
}

/// Tiles of one pass that are done.
struct Pending {
    tiles: Vec<(usize, Vec<Sample>)>,
}

struct Job<'a> {
    source: &'a dyn Source,
    options: &'a RenderOptions,
    control: &'a dyn Control,
    crop: [u32; 4],
    tiles: [u32; 2],
    begin: Instant,
    next: AtomicU64,
    stop: AtomicBool,
    cancelled: AtomicBool,
    pending: Mutex<BTreeMap<u32, Pending>>,
    film: Mutex<FilmState>,
    samples: AtomicU64,
    rays: AtomicU64,
    capped: AtomicU64,
    last_report: AtomicU64,
}

struct FilmState {
    film: Film,
    passes_done: u32,
    bad: Vec<BadSample>,
}

/// Renders until the passes are done, the time is over or `control` cancels; an unfinished pass is
/// dropped, except where it is the only one.
///
/// # Errors
/// Where the options ask for nothing, or for what is not there.
pub fn render(
    scene: &Prepared,
    options: &RenderOptions,
    control: &dyn Control,
) -> Result<Outcome, RenderError> {
    let [width, height] = scene.size;
    let layout = FilmLayout {
        crop: options.crop.unwrap_or([0, 0, width, height]),
        full_size: scene.size,
        replications: scene.plan.replications,
        radiance: scene.radiance_format,
        length: scene.length_format,
        features: options.features,
        layers: options.layers,
        transparent: scene.transparent,
    };
    let features = options.features || scene.transparent;
    let layers = options.layers;
    drive(&Planned { scene, kernel: kernel(&scene.plan), features, layers }, layout, options, control)
}

/// Renders what `source` makes into a film of the given layout, as [`render`] does.
pub(super) fn drive(
    source: &dyn Source,
    layout: FilmLayout,
    options: &RenderOptions,
    control: &dyn Control,
) -> Result<Outcome, RenderError> {
    let ([width, height], crop) = (layout.full_size, layout.crop);
    let inside =
        |at: u32, extent: u32, size: u32| extent > 0 && u64::from(at) + u64::from(extent) <= u64::from(size);
    if !inside(crop[0], crop[2], width) || !inside(crop[1], crop[3], height) {
        return Err(RenderError::Crop { crop, size: layout.full_size });
    }
    if options.passes.is_empty() {
        return Err(RenderError::NoPasses);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()
        .map_err(|e| RenderError::Threads { threads: options.threads, reason: e.to_string() })?;
    let threads = pool.current_num_threads();
    let film = Film::new(layout);
    let job = Job {
        source,
        options,
        control,
        crop,
        tiles: [crop[2].div_ceil(TILE), crop[3].div_ceil(TILE)],
        begin: Instant::now(),
        next: AtomicU64::new(0),
        stop: AtomicBool::new(false),
        cancelled: AtomicBool::new(false),
        pending: Mutex::new(BTreeMap::new()),
        film: Mutex::new(FilmState { film, passes_done: 0, bad: Vec::new() }),
        samples: AtomicU64::new(0),
        rays: AtomicU64::new(0),
        capped: AtomicU64::new(0),
        last_report: AtomicU64::new(0),
    };
    pool.broadcast(|_| job.work());
    Ok(job.finish(threads))
}

impl Job<'_> {
    /// Takes tiles until there are none.
    fn work(&self) {
        let tiles = u64::from(self.tiles[0]) * u64::from(self.tiles[1]);
        let passes = u64::from(self.options.passes.end - self.options.passes.start);
        while !self.stop.load(Ordering::Relaxed) {
            let item = self.next.fetch_add(1, Ordering::Relaxed);
            let (pass, tile) = (item / tiles, item % tiles);
            if pass >= passes {
                break;
            }
            let pass = self.options.passes.start + pass as u32;
            let samples = self.tile(tile as u32, pass);
            self.deliver(pass, tile as usize, samples, tiles as usize);
            self.look_around();
        }
    }

    /// Left, top, width and height of a tile, within the crop.
    fn bounds(&self, tile: u32) -> [u32; 4] {
        let (x, y) = (tile % self.tiles[0] * TILE, tile / self.tiles[0] * TILE);
        [x, y, TILE.min(self.crop[2] - x), TILE.min(self.crop[3] - y)]
    }

    fn tile(&self, tile: u32, pass: u32) -> Vec<Sample> {
        let [x, y, w, h] = self.bounds(tile);
        let mut counters = Counters::default();
        let mut samples = Vec::with_capacity((w * h) as usize);
        for row in y..y + h {
            for column in x..x + w {
                let pixel = [self.crop[0] + column, self.crop[1] + row];
                samples.push(self.source.sample(pixel, pass, &mut counters));
            }
        }
        self.samples.fetch_add(samples.len() as u64, Ordering::Relaxed);
        self.rays.fetch_add(counters.rays, Ordering::Relaxed);
        self.capped.fetch_add(counters.capped, Ordering::Relaxed);
        samples
    }

    fn deliver(&self, pass: u32, tile: usize, samples: Vec<Sample>, tiles: usize) {
        let complete = {
            let mut pending = lock(&self.pending);
            let entry = pending.entry(pass).or_insert_with(|| Pending { tiles: Vec::with_capacity(tiles) });
            entry.tiles.push((tile, samples));
            if entry.tiles.len() == tiles { pending.remove(&pass) } else { None }
        };
        if let Some(complete) = complete {
            let mut state = lock(&self.film);
            self.commit(&mut state, pass, &complete);
            state.passes_done += 1;
        }
    }

    fn commit(&self, state: &mut FilmState, pass: u32, pending: &Pending) {
        for (tile, samples) in &pending.tiles {
            let [x, y, w, _] = self.bounds(*tile as u32);
            for (i, sample) in samples.iter().enumerate() {
                let (column, row) = (x + i as u32 % w, y + i as u32 / w);
                let pixel = row as usize * self.crop[2] as usize + column as usize;
                if let Err(reason) = state.film.add(pixel, pass, sample)
                    && state.bad.len() < REPORTED
                {
                    let pixel = [self.crop[0] + column, self.crop[1] + row];
                    state.bad.push(BadSample { pixel, pass, reason });
                }
            }
        }
    }

    /// Stops on time or on request, and reports progress a few times a second.
    fn look_around(&self) {
        let elapsed = self.begin.elapsed();
        if self.control.cancelled() {
            self.cancelled.store(true, Ordering::Relaxed);
            self.stop.store(true, Ordering::Relaxed);
        }
        if self.options.time.is_some_and(|t| elapsed >= t) {
            self.stop.store(true, Ordering::Relaxed);
        }
        let now = elapsed.as_millis() as u64 + 1;
        let last = self.last_report.load(Ordering::Relaxed);
        if now >= last + 100
            && self.last_report.compare_exchange(last, now, Ordering::Relaxed, Ordering::Relaxed).is_ok()
        {
            self.control.progress(&self.progress(elapsed));
        }
    }

    fn progress(&self, elapsed: Duration) -> Progress {
        let pixels = u64::from(self.crop[2]) * u64::from(self.crop[3]);
        Progress {
            samples: self.samples.load(Ordering::Relaxed),
            samples_total: pixels * u64::from(self.options.passes.end - self.options.passes.start),
            passes: lock(&self.film).passes_done,
            rays: self.rays.load(Ordering::Relaxed),
            elapsed,
            time: self.options.time,
        }
    }

    fn finish(self, threads: usize) -> Outcome {
        let elapsed = self.begin.elapsed();
        self.control.progress(&self.progress(elapsed));
        // Work is handed out in order and what was handed out is delivered, so the passes that are
        // complete are the first ones; of the others nothing is kept, unless there is nothing else.
        let pending = std::mem::take(&mut *lock(&self.pending));
        if let Some((&pass, first)) = pending.iter().next() {
            let mut state = lock(&self.film);
            if state.passes_done == 0 {
                self.commit(&mut state, pass, first);
            }
        }
        let start = self.options.passes.start;
        let counters =
            Counters { rays: self.rays.load(Ordering::Relaxed), capped: self.capped.load(Ordering::Relaxed) };
        let cancelled = self.cancelled.load(Ordering::Relaxed);
        let state = self.film.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Outcome {
            film: state.film,
            passes: start..start + state.passes_done,
            partial: state.passes_done == 0,
            cancelled,
            counters,
            bad: state.bad,
            elapsed,
            threads,
        }
    }
}

/// A poisoned lock means that another thread panicked; its data is whole all the same.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

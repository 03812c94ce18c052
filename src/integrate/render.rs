//! Tiles, threads, passes and progress.
//!
//! A pass is one sample for each pixel and the unit of everything: of stopping, of sharing work over
//! machines, of what a file says it holds. Work is handed out as (pass, tile) in order, without a
//! barrier; the samples of a pass wait until all its tiles are done and are then added to the film
//! together, so that the film always holds whole passes. The order in which they arrive does not
//! matter to its bytes.
//!
//! Where the plan has photons, those of a pass are traced in parts that are handed out a whole pass before its
//! tiles, so that tiles hardly ever wait for them: the parts of pass 0, then those of pass p + 1 before the
//! tiles of pass p. Whoever finishes the last part makes the map. A thread is never more than one item behind,
//! so no more passes are in memory than there are threads, and two.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

use super::kernels::{Kernel, kernel};
use super::li::{Counters, first_surface};
use super::photon::{Photon, PhotonMap, Splat, Tracer};
use crate::film::{ErrorEstimate, Features, Film, FilmLayout, LightLayer, Refusal, Sample};
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
    /// Stops once the estimate of the error ([`Film::error`]) is at most this, relative, and can be trusted. It
    /// is looked at after fixed numbers of passes, so that the same number of them is rendered everywhere.
    pub error: Option<f64>,
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
        Self { passes, time: None, error: None, threads: 0, crop: None, features: false, layers: false }
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
    /// The last estimate of the error, and the passes that it is of, where an error was asked for.
    pub error: Option<(ErrorEstimate, u32)>,
    /// Error that was asked for.
    pub error_target: Option<f64>,
}

impl Progress {
    /// Share of the target that is reached, [0, 1]: of the samples, of the time, or of what the error takes (its
    /// square falls with the number of samples), whichever is nearer to its end.
    #[must_use]
    pub fn share(&self) -> f64 {
        let samples = self.samples as f64 / self.samples_total.max(1) as f64;
        let time = self.time.map_or(0.0, |t| self.elapsed.as_secs_f64() / t.as_secs_f64().max(1e-9));
        let error = match (self.error, self.error_target) {
            (Some((found, passes)), Some(target)) if found.error > 0.0 && passes > 0 => {
                let needed = f64::from(passes) * (found.error / target) * (found.error / target);
                // Where the target is met and the estimate not trusted, nobody knows.
                (f64::from(self.passes) / needed).min(0.99)
            }
            _ => 0.0,
        };
        samples.max(time).max(error).min(1.0)
    }
}

/// Whoever watches a render; called from its threads.
pub trait Control: Sync {
    /// Called now and then.
    fn progress(&self, _progress: &Progress) {}
    /// Called with the film each time that a whole pass has been added, in order: the passes that this render has
    /// added so far, and what it took. Work waits meanwhile.
    fn committed(&self, _film: &Film, _passes: Range<u32>, _counters: Counters) {}
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
    /// True where it ended because the error that was asked for was reached.
    pub reached: bool,
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
    /// The film that was to be added to is that of another render.
    #[error("the film has another size or format than this render")]
    Film,
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
    /// The sample of `pass` at a pixel of the whole picture, with the photons of the pass where there are
    /// any: a function of these two and nothing else.
    fn sample(&self, pixel: [u32; 2], pass: u32, map: Option<&PhotonMap>, counters: &mut Counters) -> Sample;

    /// What traces photons, if anything does.
    fn tracer(&self) -> Option<&Tracer<'_>> {
        None
    }
}

/// The default method.
struct Planned<'a> {
    scene: &'a Prepared,
    kernel: Kernel,
    tracer: Option<Tracer<'a>>,
    features: bool,
    layers: bool,
}

impl Source for Planned<'_> {
    fn sample(&self, pixel: [u32; 2], pass: u32, map: Option<&PhotonMap>, counters: &mut Counters) -> Sample {
        let mut s = sample(self.scene, &self.kernel, self.layers, pixel, pass, map, counters);
        if self.features {
            s.features = features(self.scene, pixel, pass);
        }
        s
    }

    fn tracer(&self) -> Option<&Tracer<'_>> {
        self.tracer.as_ref()
    }
}

/// A sample at a pixel of the whole picture.
fn sample(
    scene: &Prepared,
    kernel: &Kernel,
    layers: bool,
    pixel: [u32; 2],
    pass: u32,
    map: Option<&PhotonMap>,
    counters: &mut Counters,
) -> Sample {
    let k = scene.plan.replications;
    let index = u64::from(pixel[1]) * u64::from(scene.size[0]) + u64::from(pixel[0]);
    let address = Address::new(scene.seed, index, pass % k, pass / k);
    let u = address.block(0, Purpose::Camera, 0, 0);
    let ray = scene.camera.ray(pixel, [u[0], u[1]], || square_to_disk([u[2], u[3]]));
    if layers || map.is_some() {
        let (radiance, parts) = (kernel.layered)(scene, map, address, ray, counters);
        return Sample { radiance, features: None, layers: layers.then_some(parts) };
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

/// Traces one sample alone: what a render adds to this pixel in this pass. Where the plan has photons, those of
/// the pass are all traced for it.
#[must_use]
pub fn replay(scene: &Prepared, pixel: [u32; 2], pass: u32) -> Sample {
    let counters = &mut Counters::default();
    let mut map = None;
    let mut splats = Vec::new();
    if let Some(tracer) = Tracer::new(scene, [pixel[0], pixel[1], 1, 1]) {
        let traced: Vec<_> = (0..tracer.chunks()).map(|chunk| tracer.trace(pass, chunk, counters)).collect();
        splats = traced.iter().flat_map(|t| t.splats.clone()).collect();
        let parts = || traced.into_iter().map(|t| t.photons).collect();
        map = tracer.maps().then(|| tracer.map(pass, parts()));
    }
    let mut sample = sample(scene, &kernel(&scene.plan), false, pixel, pass, map.as_ref(), counters);
    splats.iter().for_each(|s| sample.radiance += s.radiance);
    sample
}

/// What is done of one pass.
#[derive(Default)]
struct Pending {
    tiles: Vec<(usize, Vec<Sample>)>,
    /// Parts of the photons that are traced.
    chunks: u32,
    photons: Vec<(u32, Vec<Photon>)>,
    splats: Vec<Splat>,
}

impl Pending {
    fn is_complete(&self, tiles: usize, chunks: u32) -> bool {
        self.tiles.len() == tiles && self.chunks == chunks
    }
}

/// A piece of work.
enum Item {
    /// A part of the photons of a pass, counted from the first pass that is rendered.
    Chunk(u64, u32),
    /// A tile of a pass.
    Tile(u64, u32),
}

/// The piece of work with a number: see the top of this file.
fn item(number: u64, chunks: u64, tiles: u64) -> Item {
    if number < chunks {
        return Item::Chunk(0, number as u32);
    }
    let (pass, within) = ((number - chunks) / (chunks + tiles), (number - chunks) % (chunks + tiles));
    if within < chunks {
        Item::Chunk(pass + 1, within as u32)
    } else {
        Item::Tile(pass, (within - chunks) as u32)
    }
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
    /// Whether the film held something at the start.
    resumes: bool,
    cancelled: AtomicBool,
    pending: Mutex<BTreeMap<u32, Pending>>,
    /// The maps of passes on their way.
    maps: Mutex<BTreeMap<u32, Arc<PhotonMap>>>,
    mapped: Condvar,
    film: Mutex<FilmState>,
    samples: AtomicU64,
    rays: AtomicU64,
    capped: AtomicU64,
    last_report: AtomicU64,
}

struct FilmState {
    film: Film,
    /// Passes that are complete and wait for an earlier one.
    ready: BTreeMap<u32, Pending>,
    passes_done: u32,
    /// The last estimate of the error, and the passes that it is of.
    error: Option<(ErrorEstimate, u32)>,
    /// Whether the error that was asked for is reached: nothing is added any more.
    reached: bool,
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
    render_onto(scene, Film::new(layout(scene, options)), options, control)
}

/// What a render of a scene accumulates.
#[must_use]
pub fn layout(scene: &Prepared, options: &RenderOptions) -> FilmLayout {
    let [width, height] = scene.size;
    FilmLayout {
        crop: options.crop.unwrap_or([0, 0, width, height]),
        full_size: scene.size,
        replications: scene.plan.replications,
        radiance: scene.radiance_format,
        length: scene.length_format,
        features: options.features,
        layers: options.layers,
        transparent: scene.transparent,
    }
}

/// The same onto a film that holds other passes of the same render, all of those before the first one where an
/// error is asked for.
///
/// # Errors
/// As [`render`], and where the film has another [`layout`].
pub fn render_onto(
    scene: &Prepared,
    film: Film,
    options: &RenderOptions,
    control: &dyn Control,
) -> Result<Outcome, RenderError> {
    let layout = layout(scene, options);
    if *film.layout() != layout {
        return Err(RenderError::Film);
    }
    let features = options.features || scene.transparent;
    let (layers, tracer) = (options.layers, Tracer::new(scene, layout.crop));
    let source = Planned { scene, kernel: kernel(&scene.plan), tracer, features, layers };
    drive(&source, film, options, control)
}

/// Renders what `source` makes onto a film, as [`render_onto`] does.
pub(super) fn drive(
    source: &dyn Source,
    film: Film,
    options: &RenderOptions,
    control: &dyn Control,
) -> Result<Outcome, RenderError> {
    let ([width, height], crop) = (film.layout().full_size, film.layout().crop);
    let inside =
        |at: u32, extent: u32, size: u32| extent > 0 && u64::from(at) + u64::from(extent) <= u64::from(size);
    if !inside(crop[0], crop[2], width) || !inside(crop[1], crop[3], height) {
        return Err(RenderError::Crop { crop, size: [width, height] });
    }
    let resumes = !film.is_empty();
    if options.passes.is_empty() && !resumes {
        return Err(RenderError::NoPasses);
    }
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()
        .map_err(|e| RenderError::Threads { threads: options.threads, reason: e.to_string() })?;
    let threads = pool.current_num_threads();
    // Whoever goes on with a finished render finds it finished.
    let done = options.passes.start;
    let error = film.error().filter(|_| options.error.is_some() && resumes && is_looked_at(done));
    let reached = error.is_some_and(|e| e.trusted && options.error.is_some_and(|target| e.error <= target));
    let job = Job {
        source,
        options,
        control,
        crop,
        tiles: [crop[2].div_ceil(TILE), crop[3].div_ceil(TILE)],
        begin: Instant::now(),
        next: AtomicU64::new(0),
        stop: AtomicBool::new(reached),
        resumes,
        cancelled: AtomicBool::new(false),
        pending: Mutex::new(BTreeMap::new()),
        maps: Mutex::new(BTreeMap::new()),
        mapped: Condvar::new(),
        film: Mutex::new(FilmState {
            film,
            ready: BTreeMap::new(),
            passes_done: 0,
            error: error.map(|e| (e, done)),
            reached,
            bad: Vec::new(),
        }),
        samples: AtomicU64::new(0),
        rays: AtomicU64::new(0),
        capped: AtomicU64::new(0),
        last_report: AtomicU64::new(0),
    };
    pool.broadcast(|_| job.work());
    Ok(job.finish(threads))
}

/// Whether the error is looked at after so many passes: four times in each octave, where all replications have
/// the same number of them.
fn is_looked_at(passes: u32) -> bool {
    let octave = if passes == 0 { 0 } else { 1 << passes.ilog2() };
    passes >= 8 && passes.is_multiple_of((octave / 4).max(4))
}

impl Job<'_> {
    /// Takes tiles, and parts of photons, until there are none.
    fn work(&self) {
        let passes = u64::from(self.options.passes.end - self.options.passes.start);
        while !self.stop.load(Ordering::Relaxed) {
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            match item(number, u64::from(self.chunks()), self.tile_count() as u64) {
                Item::Chunk(pass, chunk) if pass < passes => {
                    self.photons(self.options.passes.start + pass as u32, chunk);
                }
                // The photons of a pass that is not asked for.
                Item::Chunk(..) => {}
                Item::Tile(pass, tile) if pass < passes => {
                    let pass = self.options.passes.start + pass as u32;
                    let samples = self.tile(tile, pass);
                    self.deliver(pass, |pending| pending.tiles.push((tile as usize, samples)));
                }
                Item::Tile(..) => break,
            }
            self.look_around();
        }
    }

    fn tile_count(&self) -> usize {
        self.tiles[0] as usize * self.tiles[1] as usize
    }

    /// Parts of the photons of a pass; none where there are none.
    fn chunks(&self) -> u32 {
        self.source.tracer().map_or(0, Tracer::chunks)
    }

    /// Traces a part of the photons of a pass; the last one makes the map.
    fn photons(&self, pass: u32, chunk: u32) {
        let Some(tracer) = self.source.tracer() else { return };
        let mut counters = Counters::default();
        let traced = tracer.trace(pass, chunk, &mut counters);
        self.count(&counters);
        let mut all = Vec::new();
        self.deliver(pass, |pending| {
            pending.splats.extend(traced.splats);
            pending.photons.push((chunk, traced.photons));
            pending.chunks += 1;
            if pending.chunks == tracer.chunks() {
                all = std::mem::take(&mut pending.photons);
            }
        });
        if !all.is_empty() && tracer.maps() {
            all.sort_by_key(|&(chunk, _)| chunk);
            let map = tracer.map(pass, all.into_iter().map(|(_, photons)| photons).collect());
            lock(&self.maps).insert(pass, Arc::new(map));
            self.mapped.notify_all();
        }
    }

    /// The map of a pass. Its photons were handed out before its tiles, and whoever has a part of them
    /// finishes it, so that the wait ends.
    fn map(&self, pass: u32) -> Option<Arc<PhotonMap>> {
        self.source.tracer().filter(|t| t.maps())?;
        let mut maps = lock(&self.maps);
        loop {
            if let Some(map) = maps.get(&pass) {
                return Some(Arc::clone(map));
            }
            maps = self.mapped.wait(maps).unwrap_or_else(std::sync::PoisonError::into_inner);
        }
    }

    fn count(&self, counters: &Counters) {
        self.rays.fetch_add(counters.rays, Ordering::Relaxed);
        self.capped.fetch_add(counters.capped, Ordering::Relaxed);
    }

    /// Left, top, width and height of a tile, within the crop.
    fn bounds(&self, tile: u32) -> [u32; 4] {
        let (x, y) = (tile % self.tiles[0] * TILE, tile / self.tiles[0] * TILE);
        [x, y, TILE.min(self.crop[2] - x), TILE.min(self.crop[3] - y)]
    }

    fn tile(&self, tile: u32, pass: u32) -> Vec<Sample> {
        let [x, y, w, h] = self.bounds(tile);
        let map = self.map(pass);
        let mut counters = Counters::default();
        let mut samples = Vec::with_capacity((w * h) as usize);
        for row in y..y + h {
            for column in x..x + w {
                let pixel = [self.crop[0] + column, self.crop[1] + row];
                samples.push(self.source.sample(pixel, pass, map.as_deref(), &mut counters));
            }
        }
        self.samples.fetch_add(samples.len() as u64, Ordering::Relaxed);
        self.count(&counters);
        samples
    }

    /// Adds to what is done of a pass, and all of that to the film where it is complete.
    fn deliver(&self, pass: u32, add: impl FnOnce(&mut Pending)) {
        let complete = {
            let mut pending = lock(&self.pending);
            let entry = pending.entry(pass).or_default();
            add(entry);
            if entry.is_complete(self.tile_count(), self.chunks()) { pending.remove(&pass) } else { None }
        };
        if let Some(complete) = complete {
            lock(&self.maps).remove(&pass);
            let mut state = lock(&self.film);
            state.ready.insert(pass, complete);
            self.add_passes(&mut state);
        }
    }

    /// Adds what is ready to the film, in the order of passes, until the error is reached that was asked for.
    fn add_passes(&self, state: &mut FilmState) {
        let start = self.options.passes.start;
        while !state.reached
            && let Some(next) = state.ready.remove(&(start + state.passes_done))
        {
            self.commit(state, start + state.passes_done, &next);
            state.passes_done += 1;
            let done = start + state.passes_done;
            self.control.committed(&state.film, start..done, self.counters());
            let Some(target) = self.options.error else { continue };
            if is_looked_at(done)
                && let Some(found) = state.film.error()
            {
                state.error = Some((found, done));
                state.reached = found.trusted && found.error <= target;
            }
        }
        if state.reached {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    fn counters(&self) -> Counters {
        Counters { rays: self.rays.load(Ordering::Relaxed), capped: self.capped.load(Ordering::Relaxed) }
    }

    fn commit(&self, state: &mut FilmState, pass: u32, pending: &Pending) {
        for (tile, samples) in &pending.tiles {
            let [x, y, w, _] = self.bounds(*tile as u32);
            for (i, sample) in samples.iter().enumerate() {
                let (column, row) = (x + i as u32 % w, y + i as u32 / w);
                let pixel = row as usize * self.crop[2] as usize + column as usize;
                let added = state.film.add(pixel, pass, sample);
                self.note(state, pixel, pass, added);
            }
        }
        for splat in &pending.splats {
            let pixel = splat.pixel as usize;
            let added = state.film.splat(pixel, pass, splat.radiance, LightLayer::Caustic);
            self.note(state, pixel, pass, added);
        }
    }

    /// Keeps some of the samples that the film refuses.
    fn note(&self, state: &mut FilmState, pixel: usize, pass: u32, added: Result<(), Refusal>) {
        if let Err(reason) = added
            && state.bad.len() < REPORTED
        {
            let (column, row) = (pixel as u32 % self.crop[2], pixel as u32 / self.crop[2]);
            let pixel = [self.crop[0] + column, self.crop[1] + row];
            state.bad.push(BadSample { pixel, pass, reason });
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
        let (passes, error) = {
            let state = lock(&self.film);
            (state.passes_done, state.error)
        };
        Progress {
            samples: self.samples.load(Ordering::Relaxed),
            samples_total: pixels * u64::from(self.options.passes.end - self.options.passes.start),
            passes,
            rays: self.rays.load(Ordering::Relaxed),
            elapsed,
            time: self.options.time,
            error,
            error_target: self.options.error,
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
            if state.passes_done == 0 && !self.resumes {
                self.commit(&mut state, pass, first);
            }
        }
        let start = self.options.passes.start;
        let counters = self.counters();
        let cancelled = self.cancelled.load(Ordering::Relaxed);
        let state = self.film.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        Outcome {
            film: state.film,
            passes: start..start + state.passes_done,
            partial: state.passes_done == 0 && !self.resumes,
            cancelled,
            reached: state.reached,
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

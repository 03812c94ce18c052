//! Tiles, threads, passes and progress: how the samples of a render come onto its film.
//!
//! A pass is one sample for each pixel and the unit of everything: of stopping, of sharing work over
//! machines, of what a file says it holds. Work is handed out as (pass, tile) in order, without a
//! barrier; the samples of a pass wait until all its tiles are done and are then added to the film
//! together, so that the film always holds whole passes. They are added in order, so that whoever saves the film or
//! looks at its error knows which passes it holds; to its bytes the order does not matter.
//!
//! Where the plan has photons, those of a pass are traced in parts that are handed out a whole pass before its
//! tiles, so that tiles hardly ever wait for them: the parts of pass 0, then those of pass p + 1 before the
//! tiles of pass p. Whoever finishes the last part makes the map. A thread is never more than one item behind,
//! so no more passes are in memory than there are threads, and two.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

use super::path::Counters;
use super::photon::{Maps, Photon, Radius, Second, Seen, Splat, Tracer};
use super::render::{BadSample, Busy, Control, Outcome, Progress, RenderError, RenderOptions};
use crate::film::{CELL, Doubt, ErrorEstimate, Film, Found, LightLayer, Refusal, Sample};

/// Side of a tile, pixels: light is compared by tiles.
const TILE: u32 = CELL;
/// Refused samples that are reported one by one.
const REPORTED: usize = 8;

/// Whoever makes the samples: a method of light transport on a scene.
pub(super) trait Source: Sync {
    /// The sample of `pass` at a pixel of the film's whole picture, with the photons of the pass where there are
    /// any: a function of these two and nothing else.
    fn sample(&self, pixel: [u32; 2], pass: u32, maps: Option<&Maps>, counters: &mut Counters) -> Sample;

    /// What traces photons, if anything does.
    fn tracer(&self) -> Option<&Tracer<'_>> {
        None
    }

    /// What says beside the paths how much light there is, if anything does.
    fn second(&self) -> Option<&Second<'_>> {
        None
    }
}

/// What is done of a tile of a pass.
struct Tile {
    index: usize,
    samples: Vec<Sample>,
    /// What its paths found, and photons that are traced beside.
    found: Found,
    seen: Seen,
}

/// What is done of one pass.
#[derive(Default)]
struct Pending {
    tiles: Vec<Tile>,
    /// Parts of the photons that are traced.
    chunks: u32,
    photons: Vec<(u32, LightLayer, Vec<Photon>)>,
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
    busy: Clocks,
    begin: Instant,
    next: AtomicU64,
    stop: AtomicBool,
    /// Whether the film held something at the start.
    resumes: bool,
    cancelled: AtomicBool,
    pending: Mutex<BTreeMap<u32, Pending>>,
    /// The maps of passes on their way.
    maps: Mutex<BTreeMap<u32, Arc<Maps>>>,
    mapped: Condvar,
    film: Mutex<FilmState>,
    samples: AtomicU64,
    rays: AtomicU64,
    capped: AtomicU64,
    gathered: AtomicU64,
    layer_rays: [AtomicU64; LightLayer::ALL.len()],
    photon_rays: [AtomicU64; LightLayer::ALL.len()],
    last_report: AtomicU64,
}

struct FilmState {
    film: Film,
    /// Passes that are complete and wait for an earlier one.
    ready: BTreeMap<u32, Pending>,
    passes_done: u32,
    /// The last estimate of the error, and the passes that it is of.
    error: Option<(ErrorEstimate, u32)>,
    /// The light that was missing when it was looked for last.
    missing: Option<Doubt>,
    /// Whether the error that was asked for is reached: nothing is added any more.
    reached: bool,
    bad: Vec<BadSample>,
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
        busy: Clocks::default(),
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
            missing: None,
            reached,
            bad: Vec::new(),
        }),
        samples: AtomicU64::new(0),
        rays: AtomicU64::new(0),
        capped: AtomicU64::new(0),
        gathered: AtomicU64::new(0),
        layer_rays: std::array::from_fn(|_| AtomicU64::new(0)),
        photon_rays: std::array::from_fn(|_| AtomicU64::new(0)),
        last_report: AtomicU64::new(0),
    };
    pool.broadcast(|_| job.work());
    Ok(job.finish(threads))
}

/// Whether the error is looked at after so many passes: sixteen times in each octave, and where all replications
/// have the same number of them. Looking less often would render up to as much longer as a step is; looking costs a
/// hundredth of the passes between.
#[must_use]
pub fn is_looked_at(passes: u32) -> bool {
    let octave = if passes == 0 { 0 } else { 1 << passes.ilog2() };
    passes >= 8 && passes.is_multiple_of((octave / 16).max(4))
}

/// Whether missing light is looked for after so many passes, where the error is not reached: at the first looks, and then
/// four times in each octave at most.
fn is_light_missed_at(passes: u32) -> bool {
    passes < 16 || passes.is_multiple_of(((1 << passes.ilog2()) / 4).max(16))
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
                    let tile = self.tile(tile, pass);
                    self.deliver(pass, |pending| pending.tiles.push(tile));
                }
                Item::Tile(..) => break,
            }
            self.look_around();
        }
    }

    fn records_layers(&self) -> bool {
        self.options.layers || self.options.layer_noise
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
        let begin = Instant::now();
        let mut counters = Counters::default();
        let traced = tracer.trace(pass, chunk, &mut counters);
        counters.layer_rays[traced.layer as usize] = counters.rays;
        counters.photon_rays = counters.layer_rays;
        self.count(&counters);
        let mut all = Vec::new();
        self.deliver(pass, |pending| {
            pending.splats.extend(traced.splats);
            pending.photons.push((chunk, traced.layer, traced.photons));
            pending.chunks += 1;
            if pending.chunks == tracer.chunks() {
                all = std::mem::take(&mut pending.photons);
            }
        });
        if !all.is_empty() && tracer.gathers() {
            all.sort_by_key(|&(chunk, ..)| chunk);
            let parts = all.into_iter().map(|(_, layer, photons)| (layer, photons)).collect();
            lock(&self.maps).insert(pass, Arc::new(tracer.maps(Radius::of(pass), parts)));
            self.mapped.notify_all();
        }
        self.busy.photons.add(begin);
    }

    /// The maps of a pass. Its photons were handed out before its tiles, and whoever has a part of them
    /// finishes it, so that the wait ends.
    fn maps(&self, pass: u32) -> Option<Arc<Maps>> {
        self.source.tracer().filter(|t| t.gathers())?;
        let mut maps = lock(&self.maps);
        loop {
            if let Some(own) = maps.get(&pass) {
                return Some(Arc::clone(own));
            }
            maps = self.mapped.wait(maps).unwrap_or_else(std::sync::PoisonError::into_inner);
        }
    }

    fn count(&self, counters: &Counters) {
        self.rays.fetch_add(counters.rays, Ordering::Relaxed);
        self.capped.fetch_add(counters.capped, Ordering::Relaxed);
        self.gathered.fetch_add(counters.gathered, Ordering::Relaxed);
        if self.records_layers() {
            let pairs = [(&self.layer_rays, counters.layer_rays), (&self.photon_rays, counters.photon_rays)];
            for (sum, n) in pairs.into_iter().flat_map(|(sums, own)| sums.iter().zip(own)) {
                sum.fetch_add(n, Ordering::Relaxed);
            }
        }
    }

    /// Left, top, width and height of a tile, within the crop.
    fn bounds(&self, tile: u32) -> [u32; 4] {
        let (x, y) = (tile % self.tiles[0] * TILE, tile / self.tiles[0] * TILE);
        [x, y, TILE.min(self.crop[2] - x), TILE.min(self.crop[3] - y)]
    }

    /// The pixels of a tile: column and row within the crop.
    fn pixels(&self, tile: u32) -> impl Iterator<Item = [u32; 2]> + use<> {
        let [x, y, w, h] = self.bounds(tile);
        (y..y + h).flat_map(move |row| (x..x + w).map(move |column| [column, row]))
    }

    fn tile(&self, tile: u32, pass: u32) -> Tile {
        let maps = self.maps(pass);
        let begin = Instant::now();
        let mut counters = Counters::default();
        let of = |[column, row]: [u32; 2]| {
            let pixel = [self.crop[0] + column, self.crop[1] + row];
            self.source.sample(pixel, pass, maps.as_deref(), &mut counters)
        };
        let samples: Vec<Sample> = self.pixels(tile).map(of).collect();
        let tiles = self.tile_count() as u32;
        // Their rays are not counted: they are not those of the picture.
        let mut beside = Counters::default();
        let trace = |s: &Second<'_>| s.trace(pass, tile, tiles, &mut beside);
        let seen = self.source.second().map(trace).unwrap_or_default();
        self.busy.tiles.add(begin);
        self.samples.fetch_add(samples.len() as u64, Ordering::Relaxed);
        self.count(&counters);
        Tile { index: tile as usize, samples, found: counters.found, seen }
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
                && let Some(squares) = state.film.error_squares()
            {
                self.control.looked(done, &squares);
                let error = squares.estimate().error;
                // It takes as long as the estimate, and matters where the error is reached; whoever watches hears of it, too.
                if error <= target || is_light_missed_at(done) {
                    state.missing = state.film.missing_light(error);
                }
                let found = state.film.error_beside(&squares, state.missing);
                state.error = Some((found, done));
                state.reached = found.trusted && found.error <= target;
            }
        }
        if state.reached {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    fn counters(&self) -> Counters {
        let now = |n: &AtomicU64| n.load(Ordering::Relaxed);
        let [layer_rays, photon_rays] =
            [&self.layer_rays, &self.photon_rays].map(|sums| std::array::from_fn(|i| now(&sums[i])));
        Counters {
            rays: now(&self.rays),
            capped: now(&self.capped),
            gathered: now(&self.gathered),
            layer_rays,
            photon_rays,
            ..Counters::default()
        }
    }

    fn commit(&self, state: &mut FilmState, pass: u32, pending: &Pending) {
        let begin = Instant::now();
        for Tile { index, samples, found, seen } in &pending.tiles {
            state.film.found(*index, found);
            state.film.glimpses(seen.traced, &seen.glimpses);
            for ([column, row], sample) in self.pixels(*index as u32).zip(samples) {
                let pixel = row as usize * self.crop[2] as usize + column as usize;
                let added = state.film.add(pixel, pass, sample);
                self.note(state, pixel, pass, added);
            }
        }
        for splat in &pending.splats {
            let pixel = splat.pixel as usize;
            let added = state.film.splat(pixel, pass, splat.radiance, LightLayer::Caustic, splat.class);
            self.note(state, pixel, pass, added);
        }
        self.busy.film.add(begin);
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
            busy: Busy {
                photons: self.busy.photons.read(),
                tiles: self.busy.tiles.read(),
                film: self.busy.film.read(),
            },
            threads,
        }
    }
}

/// What threads are busy with.
#[derive(Default)]
struct Clocks {
    photons: Clock,
    tiles: Clock,
    film: Clock,
}

/// Nanoseconds.
#[derive(Default)]
struct Clock(AtomicU64);

impl Clock {
    fn add(&self, begin: Instant) {
        self.0.fetch_add(begin.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    fn read(&self) -> Duration {
        Duration::from_nanos(self.0.load(Ordering::Relaxed))
    }
}

/// A poisoned lock means that another thread panicked; its data is whole all the same.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

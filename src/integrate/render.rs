//! Rendering a prepared scene: what is asked for, what comes of it, and one sample of it.
//!
//! A pass is one sample for each pixel and the unit of everything: of stopping, of sharing work over
//! machines, of what a file says it holds. [`super::drive`] shares the work.

use std::ops::Range;
use std::time::Duration;

use super::drive::{Source, drive};
use super::kernels::{Kernel, kernel};
use super::li::first_surface;
use super::path::Counters;
use super::photon::{self, Maps, Radius, Second, Tracer};
use super::sparse::Sparse;
use crate::film::{ErrorEstimate, Features, Film, FilmLayout, Refusal, Sample, Squares};
use crate::prepare::{PrepareError, Prepared};
use crate::sampling::warp::square_to_disk;
use crate::sampling::{Address, Purpose};

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
    /// Renders some of the pixels instead of all of them, onto a film of as many: to learn about a picture from a
    /// part of it, or of `crop`.
    pub sparse: Option<Sparse>,
    /// Whether to record features of the first surface (albedo, normal, depth, position, ids).
    pub features: bool,
    /// Whether to record the parts of the light ([`LightLayer`](crate::film::LightLayer)) and each pixel's
    /// brightest sample.
    pub layers: bool,
    /// Whether to record the noise of each of these parts ([`Film::layer_shares`]), and the rays that look for it
    /// ([`Counters::layer_rays`](super::Counters)).
    pub layer_noise: bool,
}

impl RenderOptions {
    /// Some passes of the whole picture on all cores, and nothing else.
    #[must_use]
    pub fn passes(passes: Range<u32>) -> Self {
        Self {
            passes,
            time: None,
            error: None,
            threads: 0,
            crop: None,
            sparse: None,
            features: false,
            layers: false,
            layer_noise: false,
        }
    }

    /// Left, top, width and height of the part that is rendered, pixels of the whole picture.
    #[must_use]
    pub fn shown(&self, scene: &Prepared) -> [u32; 4] {
        let [width, height] = scene.size;
        self.crop.unwrap_or([0, 0, width, height])
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
    /// Called after the passes at which the error is looked at, where one is asked for, with what the pixels add to it.
    /// Work waits meanwhile.
    fn looked(&self, _passes: u32, _squares: &Squares) {}
    /// Asked often; true ends the render soon.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quiet;

impl Control for Quiet {}

/// Passes on the wish to stop, and nothing else: of several renders that are one piece of work, none shows how far
/// that is.
#[derive(Clone, Copy)]
pub struct StopOnly<'a>(pub &'a dyn Control);

impl Control for StopOnly<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

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

/// What threads were busy with, in seconds of one thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Busy {
    /// Tracing photons, and making maps of them.
    pub photons: Duration,
    /// Tracing paths.
    pub tiles: Duration,
    /// Adding to the film.
    pub film: Duration,
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
    /// What the threads did meanwhile.
    pub busy: Busy,
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
    /// Some pixels were chosen of another picture, or of another part of it.
    #[error("the pixels that were chosen are not those of this part of the picture")]
    Sparse,
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

/// The default method.
struct Planned<'a> {
    scene: &'a Prepared,
    kernel: Kernel,
    tracer: Option<Tracer<'a>>,
    second: Option<Second<'a>>,
    sparse: Option<Sparse>,
    features: bool,
    layers: bool,
}

impl Source for Planned<'_> {
    fn sample(&self, pixel: [u32; 2], pass: u32, maps: Option<&Maps>, counters: &mut Counters) -> Sample {
        let pixel = self.sparse.map_or(pixel, |s| s.pixel(pixel));
        let mut s = sample(self.scene, &self.kernel, self.layers, pixel, pass, maps, counters);
        if self.features {
            s.features = features(self.scene, pixel, pass);
        }
        s
    }

    fn tracer(&self) -> Option<&Tracer<'_>> {
        self.tracer.as_ref()
    }

    fn second(&self) -> Option<&Second<'_>> {
        self.second.as_ref()
    }
}

/// A sample at a pixel of the whole picture.
pub(super) fn sample(
    scene: &Prepared,
    kernel: &Kernel,
    layers: bool,
    pixel: [u32; 2],
    pass: u32,
    maps: Option<&Maps>,
    counters: &mut Counters,
) -> Sample {
    let k = scene.plan.replications;
    let index = u64::from(pixel[1]) * u64::from(scene.size[0]) + u64::from(pixel[0]);
    let address = Address::new(scene.seed, index, pass % k, pass / k);
    let u = address.block(0, Purpose::Camera, 0, 0);
    let ray = scene.camera.ray(pixel, [u[0], u[1]], || square_to_disk([u[2], u[3]]));
    if layers || maps.is_some() {
        let (radiance, parts) = (kernel.layered)(scene, maps, address, ray, counters);
        let (layers, widening) = (layers.then_some(parts.layers), parts.widening);
        return Sample { radiance, layers, widening, ..Sample::default() };
    }
    let radiance = (kernel.li)(scene, address, ray, counters);
    Sample { radiance, ..Sample::default() }
}

/// Traces the photons of some passes that say how much light there is ([`Film::cross_cells`]) onto a film, alone: more
/// of them than a render has. Nothing where no light can be traced.
pub fn second_opinion(scene: &Prepared, film: &mut Film, passes: Range<u32>) {
    if let Some(second) = Second::new(scene, film.layout().crop) {
        passes.for_each(|pass| second.onto(film, pass, &mut Counters::default()));
    }
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
    let mut maps = None;
    let mut splats = Vec::new();
    if let Some(tracer) = Tracer::new(scene, [pixel[0], pixel[1], 1, 1], None) {
        let traced: Vec<_> = (0..tracer.chunks()).map(|chunk| tracer.trace(pass, chunk, counters)).collect();
        splats = traced.iter().flat_map(|t| t.splats.clone()).collect();
        let parts = || traced.into_iter().map(|t| (t.layer, t.photons)).collect();
        maps = tracer.gathers().then(|| tracer.maps(Radius::of(pass), parts()));
    }
    let mut sample = sample(scene, &kernel(&scene.plan), false, pixel, pass, maps.as_ref(), counters);
    splats.iter().for_each(|s| sample.radiance += s.radiance);
    sample
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
    let (crop, full_size) = match options.sparse.map(|s| s.grid()) {
        Some([columns, rows]) => ([0, 0, columns, rows], [columns, rows]),
        None => (options.shown(scene), scene.size),
    };
    FilmLayout {
        crop,
        full_size,
        replications: scene.plan.replications,
        radiance: scene.radiance_format,
        length: scene.length_format,
        features: options.features,
        layers: options.layers,
        layer_noise: options.layer_noise,
        transparent: scene.transparent,
        // Photons light all pixels.
        cross: scene.second().is_some() && options.sparse.is_none(),
        widening: photon::gathers(scene),
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
    if let Some(sparse) = &options.sparse
        && !sparse.is_of(scene.size, options.shown(scene))
    {
        return Err(RenderError::Sparse);
    }
    let layers = options.layers || options.layer_noise;
    let tracer = Tracer::new(scene, options.shown(scene), options.sparse);
    // What the film does not keep need not be traced.
    let second = Second::new(scene, layout.crop).filter(|_| layout.cross);
    let sparse = options.sparse;
    let source = Planned { scene, kernel: kernel(&scene.plan), tracer, second, sparse, features, layers };
    let mut outcome = drive(&source, film, options, control)?;
    if let Some(sparse) = &options.sparse {
        outcome.bad.iter_mut().for_each(|bad| bad.pixel = sparse.pixel(bad.pixel));
    }
    Ok(outcome)
}

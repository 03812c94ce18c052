//! The measurement: which renders, in which order, and what becomes of them.

use std::time::{Duration, Instant};

use super::beforehand::{prediction, stated};
use super::error::{Parts, Reference};
use super::numerics;
use super::pictures::{self, Pictures};
use super::report::{CostReport, Measured, Runs};
use super::run::{Run, Work, luminance};
use super::switches::{Kind, Switch, reference, reference_way, switches};
use crate::integrate::RunError;
use crate::prepare::{Options, Prepared};
use crate::scene::{Scene, sha256};

/// What to measure.
#[derive(Clone, Debug)]
pub struct CostOptions {
    /// The scene's name, for people.
    pub name: String,
    /// As the picture is rendered whose price is told.
    pub prepare: Options,
    /// Whether photon maps are forbidden. Where light tracing was chosen, and not asked for, they are not: it is
    /// measured beside them.
    pub unbiased: bool,
    /// Width and height of the pictures that are measured, pixels: noise of a pixel hardly depends on how many there
    /// are, and time is in proportion to them.
    pub measured: [u32; 2],
    /// Renders of each way, at least 2.
    pub seeds: u32,
    /// How much work.
    pub effort: Effort,
    /// Threads; 0 is one for each core.
    pub threads: usize,
}

/// How much work a measurement may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// About so long; each way is given the same time.
    Time(Duration),
    /// So many samples a pixel of each way, a power of two, at least 8: every figure but seconds is then the same
    /// everywhere.
    Samples(u32),
}

/// Whoever watches a measurement, and has the clock that prices are told by.
pub trait Observer: Sync {
    /// Processor seconds of all threads of this process so far.
    fn seconds(&self) -> f64;
    /// Called now and then with the share that is done, [0, 1], and what is being done.
    fn progress(&self, _share: f64, _doing: &str) {}
    /// Asked often; true ends the measurement soon.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Why nothing was measured.
#[derive(Debug, thiserror::Error)]
pub enum CostError {
    /// The scene cannot be rendered, or somebody asked to stop.
    #[error("{0}")]
    Run(#[from] RunError),
    /// Relative errors have no meaning.
    #[error("the picture is black: it has no relative error")]
    Black,
}

impl From<crate::prepare::PrepareError> for CostError {
    fn from(error: crate::prepare::PrepareError) -> Self {
        Self::Run(error.into())
    }
}

/// Independent renders that the reference is the mean of.
const REFERENCES: u32 = 4;
/// Shares of the time: the reference, the runs that are measured, pictures, double precision.
const SHARES: [f64; 4] = [0.28, 0.5, 0.16, 0.04];
/// Work of the reference over that of a run, where samples are asked for, and of a way's pictures.
const REFERENCE_OVER_RUN: u32 = 32;
const PICTURES_OVER_RUN: f64 = 6.0;
/// Fewest and most samples of a run.
const FEWEST: u32 = 8;
const MOST: u32 = 1 << 16;
/// Seeds of the reference and of pictures lie so far from those of the runs.
pub(super) const APART: u64 = 0x1000_0000;

/// How many passes of everything.
struct Schedule {
    /// Work of a pass of each way, and of the reference.
    units: Vec<f64>,
    reference_unit: f64,
    /// Passes of each of the reference's renders.
    reference: u32,
    /// Levels of each way.
    levels: Vec<Vec<u32>>,
    /// Work for pictures, all together.
    pictures: f64,
    /// Work for double precision.
    double: f64,
}

/// Measures what a scene costs.
///
/// # Errors
/// The scene cannot be rendered or is black, or the observer cancels.
pub fn measure(
    scene: &Scene,
    options: &CostOptions,
    observer: &dyn Observer,
) -> Result<(CostReport, Pictures), CostError> {
    let small = Options { size: options.measured, ..options.prepare.clone() };
    let mut work =
        Work { observer, threads: options.threads, total: f64::INFINITY, done: 0.0, doing: String::new() };
    let (ways, mut prepared) = ready(scene, &small, options.unbiased, &mut work)?;
    let mut long = reference(scene, &small, options.unbiased)?;
    let schedule = schedule(options, &mut prepared, &mut long, &mut work)?;

    let base = options.prepare.seed;
    work.doing = "the reference".to_owned();
    let mut pictures_of_reference = Vec::new();
    for k in 0..u64::from(REFERENCES) {
        long.seed = base.wrapping_add(APART + k);
        let rendered = work.film(&long, schedule.reference, false, schedule.reference_unit)?;
        pictures_of_reference.push(luminance(&rendered.film.to_image()));
    }
    let width = options.measured[0] as usize;
    let truth = Reference::new(&pictures_of_reference, width).ok_or(CostError::Black)?;

    // All ways in turn, seed after seed: whatever disturbs the machine disturbs all alike.
    let mut runs: Vec<Vec<Run>> = ways.iter().map(|_| Vec::new()).collect();
    for seed in 0..options.seeds.max(2) {
        for (i, way) in ways.iter().enumerate() {
            work.doing.clone_from(&way.name);
            prepared[i].seed = base.wrapping_add(u64::from(seed));
            runs[i].push(work.run(&prepared[i], &schedule.levels[i], schedule.units[i])?);
        }
    }
    let pixels = |[w, h]: [u32; 2]| f64::from(w) * f64::from(h);
    let larger = pixels(options.prepare.size) / pixels(options.measured);
    let summed: Vec<Runs> = runs
        .iter()
        .zip(&schedule.levels)
        .map(|(runs, levels)| summary(runs, levels, &truth, larger, pixels(options.measured)))
        .collect();
    let measured: Vec<Measured> =
        ways.iter().zip(&summed).map(|(w, r)| Measured::new(w, r, &summed[0], truth.total)).collect();

    work.doing = "a quote".to_owned();
    prepared[0].seed = base;
    let prediction = prediction(&prepared[0], &measured[0], &work)?;
    let (pictures, layers) =
        pictures::render(scene, options, &ways, &measured, &schedule.units, schedule.pictures, &mut work)?;
    work.doing = "double precision".to_owned();
    let double = numerics::double(scene, options, &mut work)?;
    work.done = work.total;
    observer.progress(1.0, "done");
    let report = CostReport {
        schema: "epsilux.cost/1",
        scene: options.name.clone(),
        scene_sha256: sha256(scene),
        camera: camera_name(scene, options),
        size: options.prepare.size,
        measured: options.measured,
        seeds: options.seeds.max(2),
        threads: threads(options),
        reference_way: reference_way(&long),
        reference_spp: schedule.reference * REFERENCES,
        reference_error: truth.noise.sqrt(),
        prediction,
        stated: stated(&runs[0], &summed[0]),
        switches: measured,
        layers,
        double,
    };
    Ok((report, pictures))
}

/// Passes that show whether an estimator has anything to do: one of each replication.
const FIRST: u32 = 4;
/// What two pictures of the same samples may differ by where sums are in another order, relative to all light.
const ROUNDING: f64 = 1e-5;

/// All ways, ready to render; without estimators that have nothing to do: their first passes are those of the full
/// method.
fn ready(
    scene: &Scene,
    options: &Options,
    unbiased: bool,
    work: &mut Work<'_>,
) -> Result<(Vec<Switch>, Vec<Prepared>), RunError> {
    work.doing = "what there is to switch".to_owned();
    let first = |prepared: &Prepared, work: &mut Work<'_>| -> Result<Vec<f64>, RunError> {
        Ok(luminance(&work.film(prepared, FIRST, false, 0.0)?.film.to_image()))
    };
    let (mut ways, mut ready, mut full) = (Vec::new(), Vec::new(), None);
    for way in switches(scene, options, unbiased)? {
        let prepared = way.prepare(scene, options)?;
        let shows = match way.kind {
            Kind::Full => {
                full = Some(first(&prepared, work)?);
                true
            }
            Kind::Algorithm => differs(full.as_deref().unwrap_or_default(), &first(&prepared, work)?),
            Kind::Shortcut => true,
        };
        if shows {
            ways.push(way);
            ready.push(prepared);
        }
    }
    Ok((ways, ready))
}

/// Whether two pictures hold more than the same samples.
fn differs(a: &[f64], b: &[f64]) -> bool {
    let apart: f64 = a.iter().zip(b).map(|(x, y)| (x - y).abs()).sum();
    a.len() != b.len() || apart > ROUNDING * a.iter().sum::<f64>()
}

fn camera_name(scene: &Scene, options: &CostOptions) -> String {
    let first = || scene.cameras.first().map(|c| c.name.clone()).unwrap_or_default();
    options.prepare.camera.clone().unwrap_or_else(first)
}

fn threads(options: &CostOptions) -> usize {
    match options.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    }
}

/// Powers of two up to the last.
fn doubling(last: u32) -> Vec<u32> {
    std::iter::successors(Some(1u32), |n| n.checked_mul(2)).take_while(|n| *n <= last).collect()
}

/// Decides how many passes of everything; where time is asked for, after a few passes of each way.
fn schedule(
    options: &CostOptions,
    prepared: &mut [Prepared],
    long: &mut Prepared,
    work: &mut Work<'_>,
) -> Result<Schedule, RunError> {
    let seeds = f64::from(options.seeds.max(2));
    let schedule = match options.effort {
        Effort::Samples(spp) => {
            let spp = spp.next_power_of_two().max(FEWEST);
            Schedule {
                units: vec![1.0; prepared.len()],
                reference_unit: 1.0,
                reference: spp * REFERENCE_OVER_RUN / REFERENCES,
                levels: vec![doubling(spp); prepared.len()],
                pictures: f64::from(spp) * PICTURES_OVER_RUN * prepared.len() as f64,
                double: 0.0,
            }
        }
        Effort::Time(time) => {
            work.doing = "a first look".to_owned();
            let time = time.as_secs_f64();
            let mut units = Vec::new();
            for p in prepared.iter_mut().chain(std::iter::once(&mut *long)) {
                units.push(seconds_of_pass(p, options.prepare.seed, work)?);
            }
            let reference_unit = units.pop().unwrap_or(1.0).max(1e-6);
            let each = SHARES[1] * time / prepared.len() as f64 / seeds;
            let last = |unit: f64| {
                let passes = (each / unit.max(1e-6)).clamp(f64::from(FEWEST), f64::from(MOST)) as u32;
                // The largest power of two that is no more.
                1 << passes.ilog2()
            };
            let levels: Vec<Vec<u32>> = units.iter().map(|u| doubling(last(*u))).collect();
            let reference = (SHARES[0] * time / f64::from(REFERENCES) / reference_unit) as u32;
            let fewest = levels[0].last().copied().unwrap_or(FEWEST);
            Schedule {
                reference: reference.max(fewest),
                reference_unit,
                levels,
                pictures: SHARES[2] * time,
                double: SHARES[3] * time,
                units,
            }
        }
    };
    let of_runs = schedule.levels.iter().zip(&schedule.units);
    let runs: f64 = of_runs.map(|(l, u)| seeds * u * f64::from(l.last().copied().unwrap_or(0))).sum();
    let reference = schedule.reference_unit * f64::from(schedule.reference * REFERENCES);
    work.done = 0.0;
    work.total = reference + runs + schedule.pictures + schedule.double;
    Ok(schedule)
}

/// Wall-clock seconds of a pass, after one that does not count.
fn seconds_of_pass(prepared: &mut Prepared, seed: u64, work: &mut Work<'_>) -> Result<f64, RunError> {
    prepared.seed = seed;
    work.film(prepared, 1, false, 0.0)?;
    let begin = Instant::now();
    work.film(prepared, 2, false, 0.0)?;
    Ok(begin.elapsed().as_secs_f64() / 2.0)
}

/// Errors, seconds and rays of the runs of one way.
fn summary(runs: &[Run], levels: &[u32], truth: &Reference, larger: f64, pixels: f64) -> Runs {
    let passes = f64::from(levels.last().copied().unwrap_or(1));
    let parts = (0..levels.len())
        .map(|l| Parts::new(&runs.iter().map(|r| r.luminance[l].clone()).collect::<Vec<_>>(), truth))
        .collect();
    let rays: f64 = runs.iter().map(|r| r.rays as f64).sum::<f64>() / runs.len() as f64;
    Runs {
        levels: levels.to_vec(),
        parts,
        seconds: runs.iter().map(|r| r.seconds * larger / passes).collect(),
        rays_per_sample: rays / (passes * pixels),
    }
}

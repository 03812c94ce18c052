//! Trials: a small picture by some choices, and what it tells of their noise and work.
//!
//! In: a prepared scene whose plan makes the choices. Out: means of four independent replications for each pixel,
//! rays, and what is known of caustics. All sums are in a fixed order, so that they are the same on every machine.

use std::ops::Range;

use crate::integrate::{Probe, Probed, Radius, photons};
use crate::prepare::Prepared;

/// Rays that take as long as gathering one photon from a map: on hexroom, the scene whose paths gather most, 24
/// million photons took 5.0 s where a ray took 0.37 us, the making of the maps included.
const RAYS_OF_GATHERED: f64 = 0.5;

/// Replications of a trial.
pub(super) const REPLICATIONS: usize = 4;

/// What a pixel of a trial tells: the mean luminance of each replication.
pub(super) type Means = [f64; REPLICATIONS];

/// What a trial found.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    /// All light, for each pixel.
    pub(super) all: Vec<Means>,
    /// All light but the caustics that paths met, or gathered from a map.
    pub(super) others: Vec<Means>,
    /// Mean luminance of the caustics that photons brought to the camera.
    pub(super) thrown: Vec<f64>,
    /// That of those that paths met, or gathered from a map.
    pub(super) met: Vec<f64>,
    /// Sum over all samples of the caustics that paths met, and of their squares.
    pub(super) events: [f64; 2],
    /// Share of samples with light that was seen first in a mirror or through clear glass.
    pub(super) through: f64,
    /// Samples of a pixel.
    pub(super) passes: u32,
    /// Rays of a pass, those of photons included, and what gathering them counts as.
    pub(super) rays: f64,
    /// Rays of a photon.
    pub(super) rays_of_photon: f64,
    /// Rays of all passes.
    pub(super) spent: f64,
}

/// Rays of a sample, and what gathering photons counts as.
fn work(found: &Probed) -> f64 {
    found.rays as f64 + RAYS_OF_GATHERED * found.gathered as f64
}

/// The variance of the mean over the replications.
pub(super) fn variance(means: &Means) -> f64 {
    let k = REPLICATIONS as f64;
    let mean = means.iter().sum::<f64>() / k;
    means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / (k * (k - 1.0))
}

impl Trial {
    /// Renders some passes, as many for each replication, with as many photons for each pixel as a picture of
    /// `pixels` has.
    pub(super) fn run(scene: &Prepared, passes: Range<u32>, pixels: u64) -> Self {
        let count = scene.size[0] as usize * scene.size[1] as usize;
        let each_pass = (count as u64 * u64::from(photons(pixels)) / pixels.max(1)).max(1) as u32;
        let probe = Probe::new(scene, each_pass);
        let n = f64::from(passes.end - passes.start);
        let each = REPLICATIONS as f64 / n;
        let mut trial = Self {
            all: vec![Means::default(); count],
            others: vec![Means::default(); count],
            thrown: vec![0.0; count],
            met: vec![0.0; count],
            events: [0.0; 2],
            through: 0.0,
            passes: passes.end - passes.start,
            rays: 0.0,
            rays_of_photon: 0.0,
            spent: 0.0,
        };
        let mut through = 0u64;
        for pass in passes {
            let r = pass as usize % REPLICATIONS;
            let [photons] = probe.photons(pass, [Radius::of(pass)]);
            trial.spent += photons.rays as f64;
            trial.rays_of_photon += photons.rays as f64 / (n * f64::from(each_pass));
            for (i, found) in probe.pass(pass, &photons).into_iter().enumerate() {
                trial.all[i][r] += found.luminance * each;
                trial.others[i][r] += (found.luminance - found.caustics) * each;
                trial.met[i] += found.caustics / n;
                trial.events[0] += found.caustics;
                trial.events[1] += found.caustics * found.caustics;
                trial.spent += work(&found);
                through += u64::from(found.through);
            }
            for &(pixel, luminance) in &photons.splats {
                trial.all[pixel as usize][r] += luminance * each;
                trial.others[pixel as usize][r] += luminance * each;
                trial.thrown[pixel as usize] += luminance / n;
            }
        }
        trial.rays = trial.spent / n;
        trial.through = through as f64 / (n * count as f64);
        trial
    }

    /// Number of pixels.
    pub(super) fn pixels(&self) -> usize {
        self.all.len()
    }

    /// The caustics of a pixel, all together.
    pub(super) fn caustics(&self, pixel: usize) -> f64 {
        self.thrown[pixel] + self.met[pixel]
    }
}

/// Factors on the radius of a photon map, each half of the one before it, down to its own.
pub(super) const WIDTHS: [f32; 3] = [4.0, 2.0, 1.0];

/// What narrower disks change: for each pixel and replication, the light that is gathered from disks of each of
/// [`WIDTHS`] but the last, less that from disks of the next.
pub(super) type Narrowed = [Vec<Means>; WIDTHS.len() - 1];

/// Renders with the maps of some passes, of so many photons each, whose disks are those of the first pass of a
/// picture whose pixels are `pixel` of those of `scene` wide, and wider; gives what narrower ones change, and rays.
pub(super) fn narrowed(scene: &Prepared, passes: u32, photons: u32, pixel: f32) -> (Narrowed, f64) {
    let probe = Probe::new(scene, photons);
    let each = REPLICATIONS as f64 / f64::from(passes);
    let count = scene.size[0] as usize * scene.size[1] as usize;
    let mut differences = Narrowed::default().map(|_| vec![Means::default(); count]);
    let mut spent = 0.0;
    for pass in 0..passes {
        let r = pass as usize % REPLICATIONS;
        let photons = probe.photons(pass, WIDTHS.map(|factor| Radius { factor, pixel }));
        spent += photons[0].rays as f64;
        let pictures = photons.map(|photons| probe.pass(pass, &photons));
        spent += pictures.iter().flatten().map(work).sum::<f64>();
        for (differences, pair) in differences.iter_mut().zip(pictures.windows(2)) {
            for (d, (wide, narrow)) in differences.iter_mut().zip(pair[0].iter().zip(&pair[1])) {
                d[r] += (wide.caustics - narrow.caustics) * each;
            }
        }
    }
    (differences, spent)
}

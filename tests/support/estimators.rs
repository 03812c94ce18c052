//! Two estimators of the same picture beside each other: caustics by paths, and by photons.
//!
//! Photons are shared by the pixels of a pass, so that the errors of pixels are not independent; the spread of
//! a part's mean is taken from whole runs with seeds of their own instead. What is compared is the light of
//! the whole picture, and the layer of caustics alone, in the picture and in each of its quarters.

use epsilux::film::Image;
use epsilux::integrate::{Quiet, RenderOptions, render};
use epsilux::math::mix64;
use epsilux::prepare::{Algorithms, Caustics, CausticsMode, Options, prepare};
use epsilux::scene::Scene;
use epsilux::stats::{Moments, sidak_each, student_two_sided, welch};

use super::compare::keep;
use super::fast::options;
use super::seed::seed;

/// Chance that one comparison fails although nothing is wrong, shared by all of its tests.
const FAMILY_ALPHA: f64 = 1e-4;

/// Parts of a picture: the whole and its quarters, first all light and then caustics alone.
const PARTS: usize = 10;

/// Standard errors that a bias must have to be seen nearly always, with the degrees of freedom of runs.
const SEEN: f64 = 8.0;

/// What to compare, and how well.
#[derive(Clone)]
pub(crate) struct Estimators<'a> {
    pub(crate) name: &'a str,
    /// A valid scene with a camera.
    pub(crate) scene: &'a Scene,
    pub(crate) size: [u32; 2],
    pub(crate) max_depth: Option<u32>,
    /// Runs of each.
    pub(crate) runs: u32,
    /// Whether photons go to what the camera sees directly only.
    pub(crate) unbiased: bool,
    /// Samples a pixel and run: by photons, and by paths.
    pub(crate) samples: [u32; 2],
    /// Largest relative bias of the caustics that may stay unseen.
    pub(crate) bound: f64,
    /// Relative bias that is granted.
    pub(crate) bias: f64,
}

/// The means of all parts over the runs.
pub(crate) type Means = [Moments; PARTS];

/// Renders a scene by one of the two, and gives the means of its parts over the runs.
pub(crate) fn means(
    scene: &Scene,
    base: &Options,
    algorithms: Algorithms,
    runs: u32,
    samples: u32,
    expected: Caustics,
) -> Means {
    let mut means = [Moments::default(); PARTS];
    for run in 0..runs {
        let seed =
            mix64(base.seed ^ u64::from(run) << 8 ^ u64::from(algorithms.caustics == CausticsMode::Photon));
        let options = Options { algorithms, seed, ..base.clone() };
        let prepared = prepare(scene, &options).expect("a camera");
        assert_eq!(prepared.plan.caustics, expected);
        let passes = RenderOptions { threads: 1, layers: true, ..RenderOptions::passes(0..samples) };
        let outcome = render(&prepared, &passes, &Quiet).expect("passes");
        assert_eq!(outcome.film.refused_total(), 0, "{:?}", outcome.bad);
        assert_eq!(outcome.counters.capped, 0);
        means.iter_mut().zip(parts(&outcome.film.to_image())).for_each(|(m, x)| m.add(x));
    }
    means
}

fn parts(image: &Image) -> [f64; PARTS] {
    let caustic = |channel: &str| {
        let name = format!("caustic.{channel}");
        let mut channels = image.layers.iter().flat_map(|l| &l.channels);
        &channels.find(|(n, _)| *n == name).expect("the layer").1
    };
    let [r, g, b] = ["R", "G", "B"].map(caustic);
    let (w, h) = (image.width as usize, image.height as usize);
    let mut sums = [0.0; PARTS];
    for i in 0..w * h {
        let quarter = 1 + usize::from(2 * (i % w) >= w) + 2 * usize::from(2 * (i / w) >= h);
        let all: f64 = image.rgb[i].to_array().iter().map(|&v| f64::from(v)).sum();
        let caustics: f64 = [r, g, b].map(|c| f64::from(c[i])).iter().sum();
        for (part, share) in [(0, 1.0), (quarter, 4.0)] {
            sums[part] += all * share;
            sums[PARTS / 2 + part] += caustics * share;
        }
    }
    sums.map(|s| s / (3 * w * h) as f64)
}

impl Estimators<'_> {
    /// Renders by both; the figures where they agree, the figures and what is wrong where not.
    pub(crate) fn compare(&self) -> Result<String, String> {
        let base = options(self.size, seed(self.name), self.max_depth);
        let photon =
            Algorithms { caustics: CausticsMode::Photon, unbiased: self.unbiased, ..Algorithms::PATHS };
        let plan = if self.unbiased { Caustics::Traced } else { Caustics::Photon };
        let a = means(self.scene, &base, photon, self.runs, self.samples[0], plan);
        let path = Algorithms::PATHS;
        let b = means(self.scene, &base, path, self.runs, self.samples[1], Caustics::Path);
        judge(self.name, &a, &b, self.bound, self.bias)
    }
}

/// Whether two agree, up to a relative `bias`; both have to be sharp enough to see `bound` in the caustics.
pub(crate) fn judge(name: &str, a: &Means, b: &Means, bound: f64, bias: f64) -> Result<String, String> {
    let limit = sidak_each(FAMILY_ALPHA, PARTS);
    let mut wrong = String::new();
    let mut least = 1.0f64;
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        if a.mean == 0.0 && b.mean == 0.0 {
            continue;
        }
        // What is granted is taken from the difference; rounding may differ where nothing is random.
        let found = welch(a, b).expect("runs");
        let difference = (a.mean - b.mean).abs();
        let left = (difference - bias * b.mean - 1e-6 * b.mean).max(0.0);
        let p = if left == 0.0 { 1.0 } else { student_two_sided(found.t * left / difference, found.freedom) };
        if p < limit {
            wrong += &format!(
                " part {i}: {:.6} against {:.6}, {:+.2} %, t {:+.2}, p {p:.1e};",
                a.mean,
                b.mean,
                100.0 * (a.mean / b.mean - 1.0),
                found.t,
            );
        }
        least = least.min(p);
    }
    let (a, b) = (&a[PARTS / 2], &b[PARTS / 2]);
    let sigma = [a, b].map(|m| m.variance_of_mean().sqrt() / b.mean);
    let seen = SEEN * (sigma[0] * sigma[0] + sigma[1] * sigma[1]).sqrt();
    let report = format!(
        "{name}: caustics {:.5} and {:.5}, {:+.2} %, errors {:.2} % and {:.2} %, sees {:.1} %, least p {least:.3}",
        a.mean,
        b.mean,
        100.0 * (a.mean / b.mean - 1.0),
        100.0 * sigma[0],
        100.0 * sigma[1],
        100.0 * seen
    );
    if seen.is_nan() || seen > bound {
        wrong += &format!(" too noisy to see {} %", 100.0 * bound);
    }
    keep(&format!("photons, {name}"), &report);
    if wrong.is_empty() { Ok(report) } else { Err(format!("{report}\n   {wrong}")) }
}

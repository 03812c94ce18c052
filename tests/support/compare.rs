//! The fast integrator's picture beside the reference's: z values, and the bias that they would see.
//!
//! A comparison of noisy pictures proves as much as its noise allows. So each states the smallest bias
//! of the mean that it would report with a probability of 99 %, and fails where that is too large.

use std::fmt::Write as _;
use std::path::Path;

use epsilux::film::Image;
use epsilux::integrate::naive::{ReferenceOptions, reference};
use epsilux::integrate::{Quiet, RenderOptions, render};
use epsilux::prepare::prepare;
use epsilux::scene::Scene;
use epsilux::stats::normal_quantile;

use super::fast::options;
use super::seed::seed;

/// Chance that one comparison fails although nothing is wrong, shared by all of its z values.
const FAMILY_ALPHA: f64 = 1e-4;

/// Quantile of a power of 99 %.
const POWER: f64 = 2.326;

/// What to compare, and how well.
pub(crate) struct Pair<'a> {
    pub(crate) name: &'a str,
    /// A valid scene with a camera.
    pub(crate) scene: &'a Scene,
    pub(crate) size: [u32; 2],
    /// Cap on scattering events, for both. The reference has no roulette, so closed rooms need one.
    pub(crate) max_depth: u32,
    /// Samples a pixel of the fast integrator, and of the reference.
    pub(crate) samples: [u32; 2],
    /// Columns and rows of tiles whose means are compared too; one each compares the whole alone.
    pub(crate) tiles: [u32; 2],
    /// Largest relative bias of a channel's mean that may stay unseen.
    pub(crate) bound: f64,
}

/// Sums of a part of a picture: mean and variance of the mean, for the three channels and their mean.
struct Part {
    mean: [f64; 4],
    variance: [f64; 4],
}

fn part(image: &Image, [x0, y0, x1, y1]: [u32; 4]) -> Part {
    let variance = image.variance.as_ref().expect("a variance");
    let (mut sum, mut spread, mut n) = ([0.0; 4], [0.0; 4], 0.0);
    for y in y0..y1 {
        for x in x0..x1 {
            let i = (y * image.width + x) as usize;
            n += 1.0;
            for c in 0..3 {
                let (value, v) = (f64::from(image.rgb[i][c]), f64::from(variance[i][c]));
                sum[c] += value;
                spread[c] += v;
                sum[3] += value / 3.0;
                // Channels of one path rise and fall together: the variance of their mean is at most this.
                spread[3] += v / 3.0;
            }
        }
    }
    Part { mean: sum.map(|s| s / n), variance: spread.map(|s| s / (n * n)) }
}

impl Pair<'_> {
    /// Renders both; the figures where they agree, the figures and what is wrong where not.
    pub(crate) fn compare(&self) -> Result<String, String> {
        let own = seed(self.name);
        let prepared = prepare(self.scene, &options(self.size, own, Some(self.max_depth))).expect("a camera");
        let passes = RenderOptions { threads: 1, ..RenderOptions::passes(0..self.samples[0]) };
        let outcome = render(&prepared, &passes, &Quiet).expect("passes");
        let slow = ReferenceOptions {
            camera: 0,
            size: self.size,
            crop: None,
            spp: self.samples[1],
            seed: own ^ 1,
            max_depth: Some(self.max_depth),
            threads: 1,
        };
        let slow = reference(self.scene, &slow, &|| false, &|_| ()).expect("a camera");
        if outcome.film.refused_total() > 0 {
            return Err(format!("{}: samples were refused: {:?}", self.name, outcome.bad));
        }
        self.judge(&outcome.film.to_image(), &slow)
    }

    /// Whether the second picture is what the first one is, up to noise.
    pub(crate) fn judge(&self, fast: &Image, slow: &Image) -> Result<String, String> {
        let [w, h] = self.size;
        let [columns, rows] = self.tiles;
        let mut parts = vec![[0, 0, w, h]];
        if columns * rows > 1 {
            let tile = |i: u32| {
                let (c, r) = (i % columns, i / columns);
                [c * w / columns, r * h / rows, (c + 1) * w / columns, (r + 1) * h / rows]
            };
            parts.extend((0..columns * rows).map(tile));
        }
        let tests = parts.len() as f64 * 3.0 + 1.0;
        let limit = -normal_quantile(0.5 * FAMILY_ALPHA / tests);
        let mut report = format!("{}: limit {limit:.2};", self.name);
        let mut wrong = String::new();
        let (mut detectable, mut largest, mut share) = (0.0f64, 0.0f64, 0.0f64);
        for (i, bounds) in parts.iter().enumerate() {
            let (a, b) = (part(fast, *bounds), part(slow, *bounds));
            for c in 0..4 {
                if i > 0 && c == 3 {
                    continue;
                }
                let sigma = (a.variance[c] + b.variance[c]).sqrt();
                let difference = a.mean[c] - b.mean[c];
                if b.mean[c] == 0.0 && difference == 0.0 {
                    continue;
                }
                // Single precision may differ in its last places where nothing is random.
                let z = difference / (sigma + 2e-6 * b.mean[c]);
                if z.is_nan() || z.abs() > limit {
                    let relative = 100.0 * difference / b.mean[c];
                    let _ = write!(
                        wrong,
                        " part {i} channel {c}: {} against {}, {relative:+.3} %, z {z:+.2};",
                        a.mean[c], b.mean[c]
                    );
                }
                if i == 0 {
                    share = share.max(b.variance[c] / (sigma * sigma).max(1e-300));
                    detectable = detectable.max((limit + POWER) * sigma / b.mean[c]);
                    let relative = 100.0 * difference / b.mean[c];
                    let _ = write!(report, " {relative:+.3} % (z {z:+.2})");
                } else {
                    largest = largest.max(z.abs());
                }
            }
        }
        let _ = write!(
            report,
            "; largest z of a tile {largest:.2}; sees {:.2} %, {:.0} % of the noise is the reference's",
            100.0 * detectable,
            100.0 * share
        );
        if detectable > self.bound || detectable.is_nan() {
            let _ = write!(wrong, " too noisy to see {} %", 100.0 * self.bound);
        }
        keep(self.name, &report);
        if wrong.is_empty() { Ok(report) } else { Err(format!("{report}\n   {wrong}")) }
    }
}

/// Leaves the figures of a comparison in a file beside the build, for whoever asks how sharp the tests are.
pub(crate) fn keep(name: &str, report: &str) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("agreement");
    let file: String = name.chars().map(|c| if c.is_alphanumeric() { c } else { '-' }).collect();
    if std::fs::create_dir_all(&folder).is_ok() {
        let _ = std::fs::write(folder.join(file + ".txt"), report);
    }
}

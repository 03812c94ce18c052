//! Single precision beside the reference integrator in double precision.
//!
//! Both render the same small picture. What they differ in, beyond noise, is what single precision costs in accuracy;
//! what they take, is what double precision and brute force cost in time.

use serde::Serialize;

use super::measure::{APART, CostOptions};
use super::run::{Work, luminance};
use crate::film::Image;
use crate::integrate::RunError;
use crate::integrate::naive::{ReferenceOptions, reference};
use crate::prepare::{Options, Shortcuts, prepare};
use crate::report::inventory;
use crate::scene::Scene;
use crate::stats::Interval;

/// What was found.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct DoubleReference {
    /// Width and height of the pictures, pixels.
    pub size: [u32; 2],
    /// Samples a pixel of both.
    pub spp: u32,
    /// All light of the default method over that of the reference, less one.
    pub difference: Interval,
    /// Processor seconds of the reference over those of the default method, for as many samples.
    pub time_ratio: f64,
}

/// Shorter side of the picture, at most.
const SIDE: f64 = 24.0;
/// Samples a pixel, in parts with seeds of their own.
const SAMPLES: u32 = 16;
const PARTS: u32 = 8;
/// Rays times objects and triangles that brute force may try.
const MOST_TRIES: f64 = 4e8;

/// Renders both ways; `None` where brute force would take too long or cannot render the scene.
pub(super) fn double(
    scene: &Scene,
    options: &CostOptions,
    work: &mut Work<'_>,
) -> Result<Option<DoubleReference>, RunError> {
    let [w, h] = options.prepare.size.map(f64::from);
    let size = [w, h].map(|v| (SIDE * v / w.min(h)).round().clamp(1.0, 4.0 * SIDE) as u32);
    let holds = inventory(scene);
    let shapes = holds.triangles as f64 + holds.spheres as f64;
    // Some ten segments a path.
    let tries = f64::from(size[0] * size[1] * SAMPLES * PARTS) * 10.0 * shapes;
    if tries > MOST_TRIES {
        return Ok(None);
    }
    let max_depth = Some(options.prepare.max_depth.unwrap_or(16).min(16));
    // Both simulate what is there: the reference knows no shortcut but a cap on depth.
    let shortcuts = Shortcuts::default();
    let small = Options { size, max_depth, shortcuts, ..options.prepare.clone() };
    let camera = scene.cameras.iter().position(|c| Some(&c.name) == small.camera.as_ref()).unwrap_or(0);
    let mut prepared = prepare(scene, &small)?;
    let (mut fast, mut slow, mut seconds) = (Vec::new(), Vec::new(), [0.0; 2]);
    for part in 0..PARTS {
        prepared.seed = small.seed.wrapping_add(3 * APART + u64::from(part));
        let rendered = work.film(&prepared, SAMPLES, false, 0.0)?;
        seconds[0] += rendered.seconds;
        fast.push(total(&rendered.film.to_image()));
        let asked = ReferenceOptions {
            camera,
            size,
            crop: None,
            spp: SAMPLES,
            seed: prepared.seed.wrapping_add(APART),
            max_depth,
            threads: work.threads,
        };
        let begin = work.observer.seconds();
        let image = reference(scene, &asked, &|| work.observer.cancelled(), &|_| ());
        seconds[1] += work.observer.seconds() - begin;
        if work.observer.cancelled() {
            return Err(RunError::Cancelled);
        }
        let Ok(image) = image else { return Ok(None) };
        slow.push(total(&image));
    }
    let light = slow.iter().sum::<f64>() / f64::from(PARTS);
    let relative: Vec<f64> = fast.iter().zip(&slow).map(|(a, b)| (a - b) / light).collect();
    Ok(Some(DoubleReference {
        size,
        spp: SAMPLES * PARTS,
        difference: Interval::of_mean(&relative),
        time_ratio: seconds[1] / seconds[0].max(1e-9),
    }))
}

fn total(image: &Image) -> f64 {
    luminance(image).iter().sum()
}

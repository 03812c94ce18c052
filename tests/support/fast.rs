//! The fast integrator along single rays, with an error from independent replications.
//!
//! The samples of one replication are one low-discrepancy sequence, so that their own variance says
//! nothing about the error of their mean; the means of several replications do.

use epsilux::color::Rgb;
use epsilux::integrate::{Counters, Kernel, kernel};
use epsilux::prepare::{Algorithms, EffectsMode, Options, Prepared, Shortcuts, prepare};
use epsilux::sampling::Address;
use epsilux::scene::{Scene, complete, validate};
use epsilux::shape::Ray;
use epsilux::stats::Moments;

use super::scenes::Probe;

/// Options for a picture of `size`, everything else as usual.
pub(crate) fn options(size: [u32; 2], seed: u64, max_depth: Option<u32>) -> Options {
    let effects = EffectsMode::Auto;
    let algorithms = Algorithms::PATHS;
    let shortcuts = Shortcuts::default();
    Options { camera: None, size, seed, effects, max_depth, shortcuts, transparent: false, algorithms }
}

/// A valid copy of `scene` that has a camera; its light is its own.
pub(crate) fn valid(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    validate(&mut scene).expect("a valid scene");
    let (lights, environment) = (scene.lights.clone(), scene.environment.clone());
    complete(&mut scene);
    (scene.lights, scene.environment) = (lights, environment);
    scene
}

/// A scene, ready for single rays.
pub(crate) struct Fast {
    pub(crate) prepared: Prepared,
    kernel: Kernel,
}

impl Fast {
    pub(crate) fn new(scene: &Scene, seed: u64, max_depth: Option<u32>) -> Self {
        let prepared = prepare(&valid(scene), &options([1, 1], seed, max_depth)).expect("a scene");
        let kernel = kernel(&prepared.plan);
        Self { prepared, kernel }
    }

    /// One sample along a ray.
    pub(crate) fn radiance(&self, probe: &Probe, pixel: u64, replication: u32, index: u32) -> Rgb {
        let ray = Ray::new(probe.origin.as_vec3(), probe.direction.as_vec3());
        let address = Address::new(self.prepared.seed, pixel, replication, index);
        (self.kernel.li)(&self.prepared, address, ray, &mut Counters::default())
    }

    /// The means over all probes of `samples` samples each, one mean for each replication and channel.
    pub(crate) fn estimate(&self, probes: &[Probe], replications: u32, samples: u32) -> [Moments; 3] {
        let mut moments = [Moments::default(); 3];
        for replication in 0..replications {
            let mut sum = [0.0; 3];
            for (i, probe) in probes.iter().enumerate() {
                for index in 0..samples {
                    let radiance = self.radiance(probe, i as u64, replication, index);
                    assert!(radiance.is_finite() && radiance.min_channel() >= 0.0, "{radiance:?}");
                    for (sum, value) in sum.iter_mut().zip(radiance.to_array()) {
                        *sum += f64::from(value);
                    }
                }
            }
            let n = probes.len() as f64 * f64::from(samples);
            moments.iter_mut().zip(sum).for_each(|(m, s)| m.add(s / n));
        }
        moments
    }
}

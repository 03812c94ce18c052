//! Scenes with a known answer: each case holds the scene, the rays to shoot and what they must see.
//!
//! The numbers O02 to O16 are those of the list of oracles; a case's expected value comes from
//! [`epsilux::check::closed_forms`], and the list's own value stands beside it where it has one.

mod build;
mod dielectrics;
mod furnace;
mod lights;
mod rooms;

pub(crate) use build::*;

use epsilux::glam::DVec3;
use epsilux::scene::Scene;

/// A scene, and the radiance that rays into it must find.
pub(crate) struct Case {
    /// Number of the oracle, and what distinguishes its variants.
    pub(crate) id: String,
    pub(crate) scene: Scene,
    pub(crate) probes: Vec<Probe>,
    /// The mean over the probes, the same in every channel.
    pub(crate) expected: f64,
    pub(crate) max_depth: Option<u32>,
    /// Largest relative error that passes.
    pub(crate) tolerance: f64,
    /// Samples for each probe with which BSDF sampling alone comes near the tolerance; zero where it
    /// would take too many.
    pub(crate) samples: u64,
}

/// A camera ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
}

impl Case {
    fn new(id: impl Into<String>, scene: Scene, probe: Probe, expected: f64) -> Self {
        Self {
            id: id.into(),
            scene,
            probes: vec![probe],
            expected,
            max_depth: None,
            tolerance: 0.003,
            samples: 100_000,
        }
    }

    /// Checks the closed form against the value in the list of oracles.
    fn listed(self, value: f64) -> Self {
        // Nine decimals, or six digits of what is smaller.
        let bound = (1e-6 * value).min(6e-10);
        assert!(
            (self.expected - value).abs() <= bound,
            "{}: {} is listed as {value}",
            self.id,
            self.expected
        );
        self
    }

    /// The same for a value that is an irradiance, where the radiance is that of a white surface.
    fn listed_irradiance(self, value: f64) -> Self {
        let expected = self.expected;
        let case = Self { expected: expected * std::f64::consts::PI, ..self }.listed(value);
        Self { expected, ..case }
    }

    fn depth(mut self, max_depth: u32) -> Self {
        self.max_depth = Some(max_depth);
        self
    }

    fn samples(mut self, samples: u64) -> Self {
        self.samples = samples;
        self
    }

    fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
}

/// All cases, in the order of their numbers.
pub(crate) fn all() -> Vec<Case> {
    let groups = [rooms::cases(), lights::cases(), dielectrics::cases(), furnace::cases()];
    groups.into_iter().flatten().collect()
}

//! Hard cases: what breaks renderers, and the proof that it does not break this one.
//!
//! In: nothing, or how much work to do. Out: for each case of the catalogue figures beside their bounds
//! ([`Case::run`]). The same cases are tests (`tests/hard`) and a command for users (`epsilux check`), who so can
//! run the proof on their own build and machine. A case knows its answer from a closed form, from an invariance, or
//! from a slower and simpler computation; it never compares the renderer with a number copied from it.
//!
//! Some of it holds of any scene: [`check_scene`] measures that on one of the user's.
//!
//! Seeds are functions of a case's id. The bounds say why they are what they are, where that is not plain. Ids are
//! never reused.

mod build;
mod camera;
pub mod closed_forms;
mod dielectrics;
mod film;
mod lights;
mod materials;
mod own;
mod position;
mod prices;
mod random;
mod scaling;
mod scenes;
mod spheres;
mod stage;
mod surfaces;
mod transport;
mod triangles;

pub use own::{Finding, Says, check_scene};
pub use prices::{Price, prices};
pub use scaling::scaled;

/// How long a case takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Under a second; no statistics.
    Unit,
    /// Some seconds; renders or counts.
    Statistical,
}

/// How much work to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// What runs with every change.
    Usual,
    /// A hundred times the rays where rare accidents are counted.
    Nightly,
}

impl Effort {
    /// A number of trials: `usual` of them, or a hundred times as many.
    #[must_use]
    pub fn trials(self, usual: u64) -> u64 {
        match self {
            Self::Usual => usual,
            Self::Nightly => 100 * usual,
        }
    }
}

/// A hard case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// `N01` and so on; never reused.
    pub id: &'static str,
    /// How long it takes.
    pub class: Class,
    /// What it guards, a sentence.
    pub guards: &'static str,
    /// Measures.
    pub run: fn(Effort) -> Vec<Figure>,
}

/// What was measured, beside what is allowed.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Of what, such as `self-hits of 1e6 rays, edges of 1e-4`.
    pub what: String,
    /// The figure.
    pub value: f64,
    /// What is allowed.
    pub bound: Bound,
}

/// What is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// This very number.
    Exactly(f64),
    /// At most this.
    AtMost(f64),
    /// At least this.
    AtLeast(f64),
}

impl Figure {
    /// A figure that must be this number.
    #[must_use]
    pub fn exactly(what: impl Into<String>, value: f64, expected: f64) -> Self {
        Self { what: what.into(), value, bound: Bound::Exactly(expected) }
    }

    /// A figure that may not be larger.
    #[must_use]
    pub fn at_most(what: impl Into<String>, value: f64, most: f64) -> Self {
        Self { what: what.into(), value, bound: Bound::AtMost(most) }
    }

    /// A figure that may not be smaller.
    #[must_use]
    pub fn at_least(what: impl Into<String>, value: f64, least: f64) -> Self {
        Self { what: what.into(), value, bound: Bound::AtLeast(least) }
    }

    /// Whether it is within its bound; what is not a number is not.
    #[must_use]
    pub fn holds(&self) -> bool {
        match self.bound {
            Bound::Exactly(v) => self.value == v,
            Bound::AtMost(v) => self.value <= v,
            Bound::AtLeast(v) => self.value >= v,
        }
    }
}

/// The catalogue, in the order of its ids.
#[must_use]
pub fn cases() -> Vec<&'static Case> {
    let groups: [&[Case]; 10] = [
        position::CASES,
        triangles::CASES,
        spheres::CASES,
        dielectrics::CASES,
        materials::CASES,
        lights::CASES,
        transport::CASES,
        film::CASES,
        camera::CASES,
        scenes::CASES,
    ];
    let mut cases: Vec<&Case> = groups.into_iter().flatten().collect();
    cases.sort_by_key(|c| c.id);
    cases
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the promise that ids are never reused, and bounds against what is not a number.
    #[test]
    fn ids_are_unique_and_bounds_are_strict() {
        let ids: Vec<&str> = cases().iter().map(|c| c.id).collect();
        assert!(ids.windows(2).all(|w| w[0] < w[1]), "{ids:?}");
        assert!(!Figure::at_most("", f64::NAN, 1.0).holds() && !Figure::at_least("", f64::NAN, 1.0).holds());
        assert!(Figure::exactly("", 0.0, 0.0).holds() && !Figure::exactly("", 1.0, 0.0).holds());
    }
}

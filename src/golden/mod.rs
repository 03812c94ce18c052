//! Golden tests: is a scene still rendered as it was recorded?
//!
//! In: a [`Suite`] of scenes that somebody guards. [`record()`] renders each many times and keeps what its runs
//! are like, as a [`Reference`]. [`verify()`] renders it again, a few times, and judges the mean of these runs by
//! [`gate`](crate::stats::gate): the whole picture, its channels, its light layers, tiles, slow waves, noise,
//! error, convergence and bright samples, each against its own values over the null runs. Out: a
//! [`Verification`], which names the culprit. Gates without statistics stand beside (`checks`): the scene is
//! the recorded one, every sample is a radiance, threads do not matter, files say what they hold.
//!
//! Invariants: seeds are functions of a scene's name, so that an unchanged renderer gives an unchanged verdict,
//! and pilots, null runs and runs under test share none. Nothing here reads or writes files, or prints.
//!
//! Sources: [`gate`](crate::stats::gate) names those of its statistics. Works badly for pictures that a
//! run sees by a handful of samples: the page says which shift each statistic notices.

mod blessing;
mod checks;
mod page;
mod record;
mod reference;
mod run;
mod suite;
mod verdict;
mod verify;
mod words;

pub use blessing::account;
pub use page::{About, page};
pub use record::{Forecast, PILOTS, RecordError, Step, Watch, record};
pub use reference::{Found, Reference, ReferenceError, SCHEMA, Stage};
pub use run::{Role, Run, Subject, seed};
pub use suite::{Accept, CausticsBy, Entry, Settings, Suite, SuiteError, Truth};
pub use verdict::{Check, CurvePoint, Power, Reason, Verdict, Verification, notices};
pub use verify::{VerifyOptions, verify, verify_picture};

/// Probability that a whole suite is refused although nothing is wrong; its scenes share it.
pub const SIGNIFICANCE: f64 = 1e-3;

/// What is noticed with a probability of 99 % where `runs` runs are verified at this significance.
#[must_use]
pub fn power_of(reference: &Reference, runs: usize, significance: f64) -> Vec<Power> {
    record::power(&reference.family, &reference.null, runs, significance)
}

/// The planes of a run, in the order in which they are told.
const PLANES: [&str; 9] =
    ["luminance", "red", "green", "blue", "direct", "indirect", "caustic", "glass", "emitted"];

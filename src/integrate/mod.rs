//! Light transport.
//!
//! In: a [`crate::prepare::Prepared`] scene. Out: a [`crate::film::Film`]. `li` is the path from the
//! camera to roulette and reads on its own; `photon` finds caustics from the lights; `render` says what can be
//! asked for and what comes of it, `drive` owns tiles, threads and progress; `kernels` holds `li` compiled for a
//! few sets of effects; `path` is what a path carries and gathers; `probe` takes samples without making a picture of them;
//! `naive` is the slow, obvious oracle of the tests; `report` is
//! the method of the student report that the project began with.

mod both_ways;
mod direct;
mod drive;
mod kernels;
mod li;
pub mod naive;
mod path;
mod photon;
mod probe;
mod render;
pub mod report;
mod roulette;
mod scatter;
mod sparse;

pub(crate) use direct::mis_weight;
pub use drive::is_looked_at;
pub use kernels::{Kernel, LiFn, kernel};
pub use path::{Counters, Layers};
pub(crate) use photon::{Radius, photons};
pub(crate) use probe::{Probe, Probed};
pub use render::{
    BadSample, Busy, Control, Outcome, Progress, Quiet, RenderError, RenderOptions, RunError, StopOnly,
    layout, render, render_onto, replay, second_opinion,
};
pub(crate) use roulette::survive;
pub use sparse::Sparse;

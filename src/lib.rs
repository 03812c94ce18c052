//! epsilux: a scene-file toolchain around a Monte Carlo path tracer.
//!
//! One arrow runs through the crate, and each stage is one function:
//! `import::read` -> `scene::validate` -> `prepare::analyse` -> `prepare::prepare` ->
//! `integrate::render` -> `output::write`. ARCHITECTURE.md walks through it.
//!
//! Units everywhere: metres, watts, radiance in W sr^-1 m^-2; colours are linear Rec. 709;
//! space is right-handed with +Y up.

pub mod accel;
pub mod bsdf;
pub mod check;
#[cfg(feature = "cli")]
pub mod cli;
pub mod color;
pub mod cost;
pub mod export;
pub mod film;
pub mod golden;
pub mod guide;
pub mod import;
pub mod integrate;
pub mod light;
pub mod math;
#[cfg(epsilux_mutants)]
pub mod mutants;
#[cfg(not(epsilux_mutants))]
mod mutants;
pub mod output;
mod page;
pub mod part;
pub mod pilot;
pub mod prepare;
pub mod price;
pub mod quote;
mod rare;
pub mod report;
pub mod sampling;
pub mod scene;
pub mod shape;
pub mod stats;

pub use glam;

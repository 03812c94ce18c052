//! Random numbers with an address, and the warps that shape them.
//!
//! In: where a number is needed (seed, pixel, replication, index, depth, purpose, branch). Out: four
//! uniform numbers of a scrambled low-discrepancy sequence, or directions and points made of them.
//! The invariant: a number depends on its address and on nothing else, so skipping one use shifts
//! nothing, and neither threads nor tiles nor the order of work matter.

mod address;
mod distribution;
mod piecewise;
mod sobol;
pub mod warp;

pub(crate) use address::unit_f32;
pub use address::{Address, PhotonUse, Purpose, Stream};
pub use distribution::Discrete;
pub use piecewise::{Cell, Grid};

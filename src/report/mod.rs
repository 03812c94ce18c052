//! Numbers about finished images: how far two of them are apart, and whether that means anything.

mod compare;
mod flip;
mod heat;

pub use compare::{Basis, Channel, CompareError, Comparison, Tiles, Verdict, compare};
pub use flip::flip;
pub use heat::{difference_map, flip_map};

//! The film: exact sums while rendering, an [`Image`] afterwards.
//!
//! In: radiance samples, each with its pixel and replication. Out: means and the variance of each
//! mean. The invariant: sums are integers, and integer addition is associative, so any split of the
//! samples over threads, tiles, pass ranges, restarts and machines gives the same bytes.
//!
//! Memory: three `i128` and one `u32` for each pixel and replication, about 200 bytes a pixel; one `i128` more where
//! photon maps are gathered from.

mod cross;
mod doubt;
mod error;
mod fixed;
mod image;
mod layers;
mod shares;
mod state;
mod sums;
mod tail;
mod together;
mod widening;

pub use cross::{CELL, Found, Glimpse, LIGHT_CLASSES, LIGHTS_APART, light_class};
pub use doubt::{CrossCell, Doubt, TwoWays};
pub use error::{ErrorEstimate, Squares};
pub use fixed::FixedPoint;
pub use image::{Image, Layer};
pub use layers::LightLayer;
pub use shares::LayerShare;
pub use state::StateError;
pub use sums::{Features, Film, FilmLayout, Refusal, Sample};
pub use tail::Tail;
pub use widening::MapBias;
pub(crate) use widening::of_widened;

//! The film: exact sums while rendering, an [`Image`] afterwards.

mod image;

pub use image::{Image, Layer};

//! Shapes: where a ray meets one, how exactly that is known, and where the next ray starts.
//!
//! In: a [`Ray`]. Out: a distance, and a point with a bound on its error. There is no epsilon here:
//! a ray leaves a surface from a point moved along the normal by the bound that came with it, and
//! does not meet again the primitive it leaves. Every formula commutes with scaling by a power of two.

pub mod ray;
pub mod sphere;
pub mod triangle;

pub use ray::{Ray, offset_origin};

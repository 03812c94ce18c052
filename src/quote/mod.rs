//! What a picture will cost before it is rendered: samples and seconds for an error.
//!
//! In: a prepared scene. A [`pilot`] takes samples at some of its pixels, the very samples that the render will take
//! there (with photons of a coarser picture where it is large), and notes how the error falls: a [`Curve`]. Out: for any
//! error a [`Forecast`] of the samples at which a render with `--error` stops, with an interval of 95 %, and from the
//! seconds of the pilot those of the render.
//! Counted work decides how long the pilot is; a clock is read only to say seconds.
//!
//! Works badly where light is found so rarely that the pilot does not find it, which no pilot can say of itself; where
//! its error is not trusted there is no forecast. Seconds are those of a machine as busy as it was during the pilot.

mod curve;
mod fit;
mod pilot;

pub use curve::{Curve, Forecast};
pub use pilot::{EffectShare, Length, Pilot, Quote, RAYS, pilot};

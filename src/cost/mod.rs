//! What accuracy costs: the error of a scene over time, measured, and what each effect has to do with it.
//!
//! In: a valid scene. [`measure()`] renders it, as a user would and with each [`Switch`] thrown, with several seeds and
//! twice as many samples again and again, beside a long render with other seeds. Out: a [`CostReport`]: for each
//! switch the error E ([`crate::film::ErrorEstimate`] has the formula) with its variance and its bias apart, and
//! what follows from them: the price of an accuracy, efficiency, the time until which a shortcut is the better
//! choice; and [`Pictures`] at equal time and at equal error. [`page()`] makes one HTML document of both.
//!
//! Invariants: every figure but seconds is a function of scene, settings and samples; the noise of the reference is
//! subtracted; what differs between two ways is measured with the same random numbers. Seconds are processor time
//! of one machine in one run, each seed going through all switches in turn: they are compared with
//! each other, and with nothing else.
//!
//! Sources: Hammersley and Handscomb, "Monte Carlo Methods" (1964), section 5.1, for efficiency. Works badly where
//! light is so rare that the reference lacks it: then E is too small for all ways alike, and the page says how far
//! the reference can be trusted.

mod beforehand;
mod error;
mod fit;
mod measure;
mod numerics;
mod page;
mod pictures;
mod report;
mod run;
mod switches;

#[cfg(test)]
mod tests;

pub use error::Parts;
pub use fit::Fit;
pub use measure::{CostError, CostOptions, Effort, Observer, measure};
pub use numerics::DoubleReference;
pub use page::{About, page, summary};
pub use pictures::{EqualError, LayerPicture, Pictures, SwitchPictures};
pub use report::{CostReport, LayerShare, Measured, Point, Prediction, Price, TARGETS, Until};
pub use switches::{Kind, Switch, switches};

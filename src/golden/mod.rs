//! Golden tests: renders of scenes against what they were recorded to be.

mod page;
mod verdict;

pub use page::{About, page};
pub use verdict::{Check, CurvePoint, Power, Reason, Verdict, Verification};

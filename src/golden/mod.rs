//! Golden tests: renders of scenes against what they were recorded to be.

mod verdict;

pub use verdict::{Check, CurvePoint, Power, Reason, Verdict, Verification};

//! Statistical tests: integrators against known answers.
//!
//! Every seed is fixed, so a result repeats; every comparison states the error that it would see.

#[path = "../support/mod.rs"]
mod support;

mod naive;

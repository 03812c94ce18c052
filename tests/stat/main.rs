//! Statistical tests: integrators against known answers, and against each other.
//!
//! Seeds are made from names, so a result repeats; every comparison states the error that it would see.

#[path = "../support/mod.rs"]
mod support;

mod agree;
mod bsdf;
mod caustics;
mod choices;
mod fast;
mod golden;
mod indirect;
mod naive;
mod price;
mod quote;
mod report;
mod second;
mod textured;

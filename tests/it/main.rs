//! Fast tests of the repository and of the whole program.

#[path = "../support/mod.rs"]
mod support;

mod bytes;
mod check;
mod command;
mod compare;
mod convert;
mod cost;
mod explain;
mod fixtures;
mod golden;
mod help;
mod hostile;
mod mistakes;
mod parts;
mod pruning;
mod quote;
mod render;
mod roundtrip;
mod shortcuts;
mod tidy;

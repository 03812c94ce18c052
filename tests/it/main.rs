//! Integration tests: the library and the command as their users meet them.

#[path = "../support/mod.rs"]
mod support;

mod bytes;

//! Shared by the test binaries: closed forms, and the scenes that they describe.

#![allow(dead_code, reason = "each test binary uses a part of it")]

pub(crate) mod closed_forms;
pub(crate) mod scenes;

//! Shared by the test binaries: closed forms and the scenes that they describe, further scenes, and ways
//! to trace and to compare them.

#![allow(dead_code, reason = "each test binary uses a part of it")]

pub(crate) mod compare;
pub(crate) mod estimators;
pub(crate) mod fast;
pub(crate) mod features;
pub(crate) mod nested;
pub(crate) mod scenes;
pub(crate) mod seed;
pub(crate) mod textured;

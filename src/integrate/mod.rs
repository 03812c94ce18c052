//! Light transport.

pub mod naive;

//! Seeds that nobody picks: a test's name is hashed, so that a seed with which it happens to pass is
//! never chosen by hand.

/// FNV-1a of the name, 64 bits (Fowler, Noll and Vo).
pub(crate) fn seed(name: &str) -> u64 {
    name.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

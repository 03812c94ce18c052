//! Seeds that nobody picks: a test's name is hashed, so that a seed with which it happens to pass is
//! never chosen by hand.

/// The number of a name.
pub(crate) fn seed(name: &str) -> u64 {
    epsilux::math::fnv1a(name.bytes())
}

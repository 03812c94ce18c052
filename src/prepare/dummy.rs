//! An effect for measurements: what the code of one more effect costs scenes that do not have it.
//!
//! Only a build with `--cfg epsilux_dummy_effect` has it, and only the environment variable `EPSILUX_DUMMY_EFFECT`
//! makes a scene call for it; `cargo xtask instructions` does both. It is a haze that dims light along each ray:
//! about the code that a small effect has, at the place where it is run most often.

/// A haze.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dummy {
    /// Per metre.
    density: f32,
}

/// Names the density; absent where there is no haze.
const VARIABLE: &str = "EPSILUX_DUMMY_EFFECT";

impl Dummy {
    /// The haze that the environment asks for.
    pub(super) fn asked() -> Option<Self> {
        let density = std::env::var(VARIABLE).ok()?.parse().ok()?;
        Some(Self { density })
    }

    /// Share of light left after `length` metres.
    #[inline]
    pub(crate) fn transmittance(self, length: f32) -> f32 {
        1.0 / (1.0 + self.density * length.min(1e6))
    }
}

//! Random inputs for hard cases: a function of the case's id, so that nobody picks them.

use glam::Vec3;

use crate::math::{fnv1a, mix64};

/// A stream of numbers (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
pub(super) struct Random(u64);

impl Random {
    /// The stream of a case.
    pub(super) fn of(id: &str) -> Self {
        Self(fnv1a(id.bytes()))
    }

    /// Any 64 bits.
    pub(super) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix64(self.0)
    }

    /// Uniform in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [0, 1), in single precision.
    pub(super) fn unit_f32(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u32 << 24) as f32
    }

    /// Uniform between two numbers.
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Uniform over the unit sphere.
    pub(super) fn direction(&mut self) -> Vec3 {
        let z = self.between(-1.0, 1.0);
        let (s, c) = libm::sincos(std::f64::consts::TAU * self.unit());
        let r = ((1.0 - z) * (1.0 + z)).sqrt();
        Vec3::new((r * c) as f32, (r * s) as f32, z as f32).normalize()
    }
}

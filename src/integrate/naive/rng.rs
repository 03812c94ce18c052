//! Random numbers of the reference integrator.
//!
//! A sample's numbers are a pure function of (seed, pixel, sample): a Weyl sequence whose start is a
//! hash of the three, each term finished by MurmurHash3's 64-bit mixer (A. Appleby, public domain).

use std::f64::consts::TAU;

/// Step of the Weyl sequence: 2^64 divided by the golden ratio, made odd.
const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

/// The numbers of one sample.
#[derive(Clone, Debug)]
pub(super) struct Rng(u64);

impl Rng {
    /// The sequence of sample `sample` of pixel `pixel`.
    pub(super) fn new(seed: u64, pixel: u64, sample: u64) -> Self {
        let mut state = 0;
        for part in [seed, pixel, sample] {
            state = mix(state ^ mix(part.wrapping_add(STEP)).wrapping_add(STEP));
        }
        Self(state)
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    pub(super) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STEP);
        (mix(self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in the unit disk.
    pub(super) fn disk(&mut self) -> [f64; 2] {
        let r = self.uniform().sqrt();
        let phi = TAU * self.uniform();
        [r * libm::cos(phi), r * libm::sin(phi)]
    }
}

fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    x = (x ^ (x >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    x ^ (x >> 33)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the address: neighbours in seed, pixel and sample give unrelated, uniform numbers.
    #[test]
    fn neighbouring_addresses_are_uniform_together() {
        for address in [[1, 0, 0], [0, 1, 0], [0, 0, 1]] {
            let n = 100_000;
            let (mut sum, mut product) = (0.0, 0.0);
            for i in 0..n {
                let at = |i: u64| Rng::new(i * address[0], i * address[1], i * address[2]).uniform() - 0.5;
                sum += at(i);
                product += at(i) * at(i + 1);
            }
            // Standard deviations: 1/sqrt(12 n) and 1/(12 sqrt n).
            let n = n as f64;
            assert!((sum / n).abs() < 4.5 / (12.0 * n).sqrt(), "{address:?} {sum}");
            assert!((product / n).abs() < 4.5 / (12.0 * n.sqrt()), "{address:?} {product}");
        }
    }
}

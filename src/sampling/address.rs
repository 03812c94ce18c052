//! The address of a random number.

use std::convert::Infallible;

use rand::rand_core::TryRng;

use super::sobol;
use crate::math::mix64;
use crate::mutants::planted;

/// What a random number is for. Append only: the number of a purpose is part of every address, and
/// with it of every picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Purpose {
    /// Position in the pixel (two numbers) and on the lens (two numbers).
    Camera = 0,
    /// Choice of a light (one number) and of a point on it (two numbers).
    Light = 1,
    /// Choice of a lobe (one number), of a direction (two numbers), roulette (one number).
    Bsdf = 2,
    /// Everything that tests draw.
    Test = 3,
    /// Everything that one ray of `--method report` draws, in the order of its tree.
    Report = 4,
    /// Whether a surface is there where it is partly transparent (one number); k counts what was passed.
    Alpha = 5,
    /// Where a photon starts: choice of a light (one number), a point on it (two numbers); then, at k = 1, what
    /// it is aimed at (one number), a direction (two numbers), the side of the light (one number).
    Photon = 6,
    /// Whether a sample looks how far photon maps may be off (one number).
    Widening = 7,
}

/// What a photon is for. Append only, as [`Purpose`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum PhotonUse {
    /// Caustics.
    Caustics = 0x7068_6f74_6f6e_7321,
    /// Saying beside the paths how much light there is.
    Second = 0x7365_636f_6e64_2121,
    /// Light that is reused where paths are spread for the second time.
    Indirect = 0x696e_6469_7265_6374,
}

/// Where in the computation a sample is: a pure function of (seed, pixel, replication, index).
///
/// Each address, completed by (depth, purpose, branch, k), names a padded four-dimensional block of
/// an Owen-scrambled Sobol' sequence with an index shuffle of its own; `index` counts along it. The
/// samples of one replication are one growing low-discrepancy sequence; replications are independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    key: u64,
    index: u32,
}

impl Address {
    /// The address of sample `index` of `replication` at `pixel`, counted over the whole picture
    /// (row-major), so that a crop keeps its numbers.
    #[must_use]
    pub fn new(seed: u64, pixel: u64, replication: u32, index: u32) -> Self {
        let key = mix64(mix64(seed ^ 0x6570_7369_6c75_7821) ^ pixel);
        Self { key: mix64(key ^ (u64::from(planted!(same_seed(replication))) << 32 | 0x7265_706c)), index }
    }

    /// The address of a photon in a domain of its own: the photons of one use and sequence (a pass, where passes are
    /// to be independent) are one low-discrepancy sequence, and others are independent of it.
    #[must_use]
    pub fn photon(seed: u64, of: PhotonUse, sequence: u32, index: u32) -> Self {
        let key = mix64(mix64(seed ^ 0x6570_7369_6c75_7821) ^ of as u64);
        Self { key: mix64(key ^ u64::from(sequence)), index }
    }

    /// Branch `j` of `m` of a split path: each branch is a sample of a sequence m times as dense.
    #[must_use]
    pub fn split(self, m: u32, j: u32) -> Self {
        Self { index: self.index.wrapping_mul(m).wrapping_add(j), ..self }
    }

    /// Four uniform numbers in [0, 1).
    #[inline]
    #[must_use]
    pub fn block(&self, depth: u32, purpose: Purpose, branch: u32, k: u32) -> [f32; 4] {
        self.block_u32(depth, purpose, branch, k).map(unit_f32)
    }

    /// A random number generator over the blocks k = 0, 1, 2, .. of one use, for `rand`'s distributions.
    #[must_use]
    pub fn stream(&self, depth: u32, purpose: Purpose, branch: u32) -> Stream {
        Stream { address: *self, depth, purpose, branch, next: 0, block: [0; 4] }
    }

    #[inline]
    fn block_u32(&self, depth: u32, purpose: Purpose, branch: u32, k: u32) -> [u32; 4] {
        // Two rounds, so that no two of (depth, purpose, branch, k) can cancel each other.
        let place = u64::from(depth) << 32 | u64::from(branch) << 8 | u64::from(purpose as u8);
        let a = mix64(
            self.key
                ^ place.wrapping_mul(0x9e37_79b9_7f4a_7c15)
                ^ u64::from(k).wrapping_mul(0xd1b5_4a32_d192_ed03),
        );
        let b = mix64(a.wrapping_add(0x9e37_79b9_7f4a_7c15));
        let c = mix64(a.wrapping_add(0x3c6e_f372_fe94_f82a));
        sobol::shuffled_scrambled(
            self.index,
            a as u32,
            [b as u32, (b >> 32) as u32, c as u32, (c >> 32) as u32],
        )
    }
}

/// The largest multiple of 2^-24 that is at most the fraction `x` / 2^32; never one.
#[inline]
pub(crate) fn unit_f32(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// The numbers of one use as a random number generator: dimension after dimension, block after block.
#[derive(Clone, Debug)]
pub struct Stream {
    address: Address,
    depth: u32,
    purpose: Purpose,
    branch: u32,
    next: u32,
    block: [u32; 4],
}

impl TryRng for Stream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        let dimension = self.next % 4;
        if dimension == 0 {
            self.block = self.address.block_u32(self.depth, self.purpose, self.branch, self.next / 4);
        }
        self.next += 1;
        Ok(self.block[dimension as usize])
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let high = self.try_next_u32()?;
        Ok(u64::from(high) << 32 | u64::from(self.try_next_u32()?))
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(4) {
            let word = self.try_next_u32()?.to_le_bytes();
            chunk.copy_from_slice(&word[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt as _;

    use super::*;

    #[test]
    fn numbers_are_below_one() {
        assert_eq!(unit_f32(u32::MAX), crate::math::ONE_MINUS_EPSILON);
    }

    /// An address is a pure function: the order in which numbers are drawn does not matter, and every
    /// part of the address does.
    #[test]
    fn every_part_of_the_address_counts() {
        let base = Address::new(1, 2, 3, 4);
        let b = |a: Address, d, p, br, k| a.block_u32(d, p, br, k);
        let reference = b(base, 1, Purpose::Bsdf, 0, 0);
        assert_eq!(reference, b(Address::new(1, 2, 3, 4), 1, Purpose::Bsdf, 0, 0));
        for other in [
            b(Address::new(2, 2, 3, 4), 1, Purpose::Bsdf, 0, 0),
            b(Address::new(1, 3, 3, 4), 1, Purpose::Bsdf, 0, 0),
            b(Address::new(1, 2, 4, 4), 1, Purpose::Bsdf, 0, 0),
            b(Address::new(1, 2, 3, 5), 1, Purpose::Bsdf, 0, 0),
            b(base, 2, Purpose::Bsdf, 0, 0),
            b(base, 1, Purpose::Light, 0, 0),
            b(base, 1, Purpose::Bsdf, 1, 0),
            b(base, 1, Purpose::Bsdf, 0, 1),
        ] {
            assert_ne!(reference, other);
        }
    }

    /// Blocks of different purposes are uncorrelated: |r| stays within 4.5 / sqrt(N).
    #[test]
    fn blocks_are_uncorrelated() {
        let n = 1 << 14;
        for (place_a, place_b) in [
            ((0, Purpose::Camera), (1, Purpose::Light)),
            ((1, Purpose::Light), (1, Purpose::Bsdf)),
            ((1, Purpose::Bsdf), (2, Purpose::Bsdf)),
        ] {
            for (i, j) in [(0, 0), (0, 1), (1, 0), (3, 2)] {
                let mut r = 0.0;
                for index in 0..n {
                    let a = Address::new(7, 11, 0, index);
                    let x = f64::from(a.block(place_a.0, place_a.1, 0, 0)[i]) - 0.5;
                    let y = f64::from(a.block(place_b.0, place_b.1, 0, 0)[j]) - 0.5;
                    r += 12.0 * x * y;
                }
                assert!(
                    (r / f64::from(n)).abs() < 4.5 / f64::from(n).sqrt(),
                    "{place_a:?} {place_b:?} {i} {j} {r}"
                );
            }
        }
    }

    /// `rand`'s distributions work on a stream.
    #[test]
    fn rand_distributions_draw_from_a_stream() {
        let mut mean = 0.0;
        for index in 0..4096 {
            let mut stream = Address::new(0, 0, 0, index).stream(0, Purpose::Test, 0);
            let first: f32 = stream.random();
            let roll = stream.random_range(1..=6);
            assert!((0.0..1.0).contains(&first) && (1..=6).contains(&roll));
            mean += f64::from(first) / 4096.0;
        }
        assert!((mean - 0.5).abs() < 1e-3, "{mean}");
    }
}

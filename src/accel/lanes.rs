//! Eight numbers at a time, as plain arrays that the compiler keeps in wide registers.

#![expect(clippy::needless_range_loop, reason = "one index walks two arrays, and this shape vectorises")]

use std::ops::{Add, Mul, Sub};

/// Eight `f32`.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct F8(pub(super) [f32; 8]);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for F8 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, o: Self) -> Self {
                let mut r = [0.0; 8];
                for i in 0..8 {
                    r[i] = self.0[i] $op o.0[i];
                }
                Self(r)
            }
        }
    };
}

lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);

impl F8 {
    /// The same number in every lane.
    #[inline(always)]
    pub(super) fn splat(v: f32) -> Self {
        Self([v; 8])
    }

    /// The larger of each pair; the second where one is NaN.
    #[inline(always)]
    pub(super) fn max(self, o: Self) -> Self {
        let mut r = [0.0; 8];
        for i in 0..8 {
            r[i] = if self.0[i] > o.0[i] { self.0[i] } else { o.0[i] };
        }
        Self(r)
    }

    /// The smaller of each pair; the second where one is NaN.
    #[inline(always)]
    pub(super) fn min(self, o: Self) -> Self {
        let mut r = [0.0; 8];
        for i in 0..8 {
            r[i] = if self.0[i] < o.0[i] { self.0[i] } else { o.0[i] };
        }
        Self(r)
    }

    /// A bit for each lane where `self` is at most `o`.
    #[inline(always)]
    pub(super) fn le(self, o: Self) -> u32 {
        let mut bits = [0u32; 8];
        for i in 0..8 {
            bits[i] = if self.0[i] <= o.0[i] { 1 << i } else { 0 };
        }
        any(bits)
    }

    /// A bit for each lane in which no two of the three numbers have opposite signs (zero has none).
    #[inline(always)]
    pub(super) fn signs_agree(u: Self, v: Self, w: Self) -> u32 {
        let mut bits = [0u32; 8];
        for i in 0..8 {
            let up = (u.0[i] >= 0.0) & (v.0[i] >= 0.0) & (w.0[i] >= 0.0);
            let down = (u.0[i] <= 0.0) & (v.0[i] <= 0.0) & (w.0[i] <= 0.0);
            bits[i] = if up | down { 1 << i } else { 0 };
        }
        any(bits)
    }
}

/// A bit for each lane in which `a * b` is not below zero and `a`, without its sign, is at most `b`'s
/// size times `limit`; NaN is in.
#[inline(always)]
pub(super) fn ratio_within(a: F8, b: F8, limit: f32) -> u32 {
    let mut bits = [0u32; 8];
    for i in 0..8 {
        let behind = a.0[i] * b.0[i] < 0.0;
        let beyond = a.0[i].abs() > b.0[i].abs() * limit;
        bits[i] = if behind | beyond { 0 } else { 1 << i };
    }
    any(bits)
}

/// The union of the bits.
#[inline(always)]
fn any(b: [u32; 8]) -> u32 {
    ((b[0] | b[4]) | (b[1] | b[5])) | ((b[2] | b[6]) | (b[3] | b[7]))
}

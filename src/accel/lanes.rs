//! Eight numbers at a time.

/// Eight `f32` as memory holds them.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct F8(pub(super) [f32; 8]);

/// Arithmetic on eight `f32`: plain arrays everywhere, wide registers where `simd` says so. Both give the
/// same bits. Masks have a bit for each lane, the first lane lowest.
pub(super) trait Lanes: Copy {
    fn load(v: &F8) -> Self;
    fn store(self) -> F8;
    fn splat(v: f32) -> Self;
    fn add(self, o: Self) -> Self;
    fn sub(self, o: Self) -> Self;
    fn mul(self, o: Self) -> Self;
    /// The larger of each pair; the second where one is NaN.
    fn max(self, o: Self) -> Self;
    /// The smaller of each pair; the second where one is NaN.
    fn min(self, o: Self) -> Self;
    /// Where `self` is at most `o`.
    fn le(self, o: Self) -> u32;
    /// Without the sign.
    fn abs(self) -> Self;
    /// Where no two of three numbers, known but for an error of up to `error`, have opposite signs (zero has none).
    fn signs_may_agree(u: Self, v: Self, w: Self, error: Self) -> u32;
}

impl F8 {
    /// The same number in every lane.
    pub(super) fn all(v: f32) -> Self {
        Self([v; 8])
    }

    #[inline(always)]
    fn zip(self, o: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], o.0[i])))
    }
}

#[inline(always)]
fn mask(lane: impl Fn(usize) -> bool) -> u32 {
    (0..8).fold(0, |m, i| m | u32::from(lane(i)) << i)
}

impl Lanes for F8 {
    #[inline(always)]
    fn load(v: &F8) -> Self {
        *v
    }

    #[inline(always)]
    fn store(self) -> F8 {
        self
    }

    #[inline(always)]
    fn splat(v: f32) -> Self {
        Self([v; 8])
    }

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, |a, b| a + b)
    }

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, |a, b| a - b)
    }

    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.zip(o, |a, b| a * b)
    }

    #[inline(always)]
    fn max(self, o: Self) -> Self {
        self.zip(o, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn min(self, o: Self) -> Self {
        self.zip(o, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn le(self, o: Self) -> u32 {
        mask(|i| self.0[i] <= o.0[i])
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }

    #[inline(always)]
    fn signs_may_agree(u: Self, v: Self, w: Self, error: Self) -> u32 {
        mask(|i| {
            let e = [u.0[i], v.0[i], w.0[i]];
            let below = e.iter().any(|&x| x < -error.0[i]);
            let above = e.iter().any(|&x| x > error.0[i]);
            !(below && above)
        })
    }
}

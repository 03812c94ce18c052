//! The one module with `unsafe`: kernels for instructions that were detected.
//!
//! Both instances are the same source (`traverse`) over other [`Lanes`], without fused multiply-add, so
//! they give the same bits. The portable one is the twin that tests compare with.

use super::lanes::F8;
use super::{Accel, Hit, PrimitiveId, traverse};
use crate::shape::Ray;

/// Which instance of the kernels this machine runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Features {
    #[cfg(target_arch = "x86_64")]
    avx2: bool,
}

impl Features {
    /// The instance that every machine runs.
    pub(super) const PORTABLE: Self = Self {
        #[cfg(target_arch = "x86_64")]
        avx2: false,
    };

    #[cfg(target_arch = "x86_64")]
    pub(super) fn detect() -> Self {
        let avx2 = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        Self { avx2 }
    }

    #[cfg(not(target_arch = "x86_64"))]
    pub(super) fn detect() -> Self {
        Self::PORTABLE
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn closest_avx2(accel: &Accel, ray: &Ray, skip: [PrimitiveId; 2], camera: bool) -> Option<Hit> {
    traverse::closest::<wide::Wide>(accel, ray, skip, camera)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn occluded_avx2(accel: &Accel, ray: &Ray, between: [PrimitiveId; 2]) -> bool {
    traverse::occluded::<wide::Wide>(accel, ray, between)
}

#[inline(never)]
fn closest_portable(accel: &Accel, ray: &Ray, skip: [PrimitiveId; 2], camera: bool) -> Option<Hit> {
    traverse::closest::<F8>(accel, ray, skip, camera)
}

#[inline(never)]
fn occluded_portable(accel: &Accel, ray: &Ray, between: [PrimitiveId; 2]) -> bool {
    traverse::occluded::<F8>(accel, ray, between)
}

#[inline]
#[cfg_attr(target_arch = "x86_64", expect(unsafe_code, reason = "a kernel for detected instructions"))]
pub(super) fn closest(accel: &Accel, ray: &Ray, skip: [PrimitiveId; 2], camera: bool) -> Option<Hit> {
    #[cfg(target_arch = "x86_64")]
    if accel.features.avx2 {
        // SAFETY: the only requirement of `closest_avx2` is that the CPU has the instructions it names,
        // and `avx2` is true only where `Features::detect` found all of them.
        return unsafe { closest_avx2(accel, ray, skip, camera) };
    }
    closest_portable(accel, ray, skip, camera)
}

#[inline]
#[cfg_attr(target_arch = "x86_64", expect(unsafe_code, reason = "a kernel for detected instructions"))]
pub(super) fn occluded(accel: &Accel, ray: &Ray, between: [PrimitiveId; 2]) -> bool {
    #[cfg(target_arch = "x86_64")]
    if accel.features.avx2 {
        // SAFETY: as for `closest`.
        return unsafe { occluded_avx2(accel, ray, between) };
    }
    occluded_portable(accel, ray, between)
}

/// Eight `f32` in one AVX register.
#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "intrinsics of detected instructions")]
mod wide {
    use std::arch::x86_64::{
        __m256, _CMP_GT_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps,
        _mm256_cmp_ps, _mm256_load_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps,
        _mm256_or_ps, _mm256_set1_ps, _mm256_store_ps, _mm256_sub_ps, _mm256_xor_ps,
    };

    use crate::accel::lanes::{F8, Lanes};

    // SAFETY of every block below: the only requirement of these intrinsics is a CPU with AVX. The type is
    // private to this file, and only `closest_avx2` and `occluded_avx2` name it, which run where AVX2 was
    // detected. Loads and stores go through references to `F8`, which is 32 bytes long and 32-byte aligned.

    /// See the module.
    #[derive(Clone, Copy)]
    pub(super) struct Wide(__m256);

    #[inline(always)]
    fn bits(m: __m256) -> u32 {
        // SAFETY: see above.
        unsafe { _mm256_movemask_ps(m) as u32 }
    }

    impl Lanes for Wide {
        #[inline(always)]
        fn load(v: &F8) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_load_ps(v.0.as_ptr()) })
        }

        #[inline(always)]
        fn store(self) -> F8 {
            let mut v = F8([0.0; 8]);
            // SAFETY: see above.
            unsafe { _mm256_store_ps(v.0.as_mut_ptr(), self.0) };
            v
        }

        #[inline(always)]
        fn splat(v: f32) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_set1_ps(v) })
        }

        #[inline(always)]
        fn add(self, o: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_add_ps(self.0, o.0) })
        }

        #[inline(always)]
        fn sub(self, o: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_sub_ps(self.0, o.0) })
        }

        #[inline(always)]
        fn mul(self, o: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_mul_ps(self.0, o.0) })
        }

        #[inline(always)]
        fn max(self, o: Self) -> Self {
            // SAFETY: see above. The instruction returns the second operand where one is NaN.
            Self(unsafe { _mm256_max_ps(self.0, o.0) })
        }

        #[inline(always)]
        fn min(self, o: Self) -> Self {
            // SAFETY: see above. The instruction returns the second operand where one is NaN.
            Self(unsafe { _mm256_min_ps(self.0, o.0) })
        }

        #[inline(always)]
        fn le(self, o: Self) -> u32 {
            // SAFETY: see above.
            bits(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, o.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }

        #[inline(always)]
        fn signs_may_agree(u: Self, v: Self, w: Self, error: Self) -> u32 {
            // SAFETY: see above.
            let apart = bits(unsafe {
                let least = _mm256_xor_ps(_mm256_set1_ps(-0.0), error.0);
                let below = _mm256_or_ps(
                    _mm256_cmp_ps::<_CMP_LT_OQ>(u.0, least),
                    _mm256_or_ps(
                        _mm256_cmp_ps::<_CMP_LT_OQ>(v.0, least),
                        _mm256_cmp_ps::<_CMP_LT_OQ>(w.0, least),
                    ),
                );
                let above = _mm256_or_ps(
                    _mm256_cmp_ps::<_CMP_GT_OQ>(u.0, error.0),
                    _mm256_or_ps(
                        _mm256_cmp_ps::<_CMP_GT_OQ>(v.0, error.0),
                        _mm256_cmp_ps::<_CMP_GT_OQ>(w.0, error.0),
                    ),
                );
                _mm256_and_ps(below, above)
            });
            !apart & 0xff
        }
    }
}

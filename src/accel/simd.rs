//! The one module with `unsafe`: calls into kernels compiled for instructions that were detected.
//!
//! Both instances are the same source (`traverse`), without fused multiply-add, so they give the same
//! bits; the compiler merely uses wider registers in the second. Tests compare the two.

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
fn closest_avx2(accel: &Accel, ray: &Ray, from: PrimitiveId, camera: bool) -> Option<Hit> {
    traverse::closest(accel, ray, from, camera)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn occluded_avx2(accel: &Accel, ray: &Ray, between: [PrimitiveId; 2]) -> bool {
    traverse::occluded(accel, ray, between)
}

#[inline(never)]
fn closest_portable(accel: &Accel, ray: &Ray, from: PrimitiveId, camera: bool) -> Option<Hit> {
    traverse::closest(accel, ray, from, camera)
}

#[inline(never)]
fn occluded_portable(accel: &Accel, ray: &Ray, between: [PrimitiveId; 2]) -> bool {
    traverse::occluded(accel, ray, between)
}

#[inline]
#[cfg_attr(target_arch = "x86_64", expect(unsafe_code, reason = "a kernel for detected instructions"))]
pub(super) fn closest(accel: &Accel, ray: &Ray, from: PrimitiveId, camera: bool) -> Option<Hit> {
    #[cfg(target_arch = "x86_64")]
    if accel.features.avx2 {
        // SAFETY: the only requirement of `closest_avx2` is that the CPU has the instructions it names,
        // and `avx2` is true only where `Features::detect` found all of them.
        return unsafe { closest_avx2(accel, ray, from, camera) };
    }
    closest_portable(accel, ray, from, camera)
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

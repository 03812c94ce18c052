//! `li` compiled for a few sets of effects.

use super::li::{li, li_in_layers};
use super::path::{Counters, Parts};
use super::photon::Maps;
use crate::color::Rgb;
use crate::prepare::{Effects, KERNELS, KernelSet, Plan, Prepared};
use crate::sampling::Address;
use crate::shape::Ray;

/// Radiance along a camera ray, W sr^-1 m^-2, for one set of effects.
pub type LiFn = fn(&Prepared, Address, Ray, &mut Counters) -> Rgb;

/// The same radiance, and the parts that it consists of; where there are maps, with the photons of the pass.
pub(super) type LayeredLiFn = fn(&Prepared, Option<&Maps>, Address, Ray, &mut Counters) -> (Rgb, Parts);

/// A compiled transport loop.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    /// Its name and what it simulates.
    pub set: KernelSet,
    /// Radiance along a camera ray.
    pub li: LiFn,
    /// The same, with its parts.
    pub(super) layered: LayeredLiFn,
}

/// The kernel that a plan names.
#[must_use]
pub fn kernel(plan: &Plan) -> Kernel {
    let compiled: [LiFn; KERNELS.len() + 1] = [
        li::<{ KERNELS[0].simulates.0 }>,
        li::<{ KERNELS[1].simulates.0 }>,
        li::<{ KERNELS[2].simulates.0 }>,
        li::<{ Effects::AT_RUN_TIME.0 }>,
    ];
    let layered: [LayeredLiFn; KERNELS.len() + 1] = [
        li_in_layers::<{ KERNELS[0].simulates.0 }>,
        li_in_layers::<{ KERNELS[1].simulates.0 }>,
        li_in_layers::<{ KERNELS[2].simulates.0 }>,
        li_in_layers::<{ Effects::AT_RUN_TIME.0 }>,
    ];
    let i = plan.kernel;
    Kernel { set: plan.kernel(), li: compiled[i], layered: layered[i] }
}

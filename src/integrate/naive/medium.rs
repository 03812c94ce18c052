//! Absorption between two vertices (Beer and Lambert).

use glam::DVec3;

use super::rgb;
use crate::scene::Absorption;

/// An absorbing medium: `color` is left of white light after `distance` metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Medium {
    color: DVec3,
    distance: f64,
}

impl From<Absorption> for Medium {
    fn from(a: Absorption) -> Self {
        Self { color: rgb(a.color), distance: f64::from(a.distance) }
    }
}

/// What is left after `length` metres: color^(length / distance); all of it without a medium.
/// Infinitely far, only what is not absorbed at all remains.
pub(super) fn transmittance(medium: Option<Medium>, length: f64) -> DVec3 {
    let Some(Medium { color, distance }) = medium else { return DVec3::ONE };
    let power = length / distance;
    DVec3::new(libm::pow(color.x, power), libm::pow(color.y, power), libm::pow(color.z, power))
}

//! Hard cases about spheres.

use super::Case;

pub(super) const CASES: &[Case] = &[];

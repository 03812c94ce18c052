//! Hard cases about materials.

use super::Case;

pub(super) const CASES: &[Case] = &[];

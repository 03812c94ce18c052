//! Hard cases about camera.

use super::Case;

pub(super) const CASES: &[Case] = &[];

//! Hard cases about lights.

use super::Case;

pub(super) const CASES: &[Case] = &[];

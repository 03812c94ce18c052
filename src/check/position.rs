//! Hard cases about position.

use super::Case;

pub(super) const CASES: &[Case] = &[];

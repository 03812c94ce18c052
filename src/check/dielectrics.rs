//! Hard cases about dielectrics.

use super::Case;

pub(super) const CASES: &[Case] = &[];

//! Hard cases about triangles.

use super::Case;

pub(super) const CASES: &[Case] = &[];

//! Hard cases about transport.

use super::Case;

pub(super) const CASES: &[Case] = &[];

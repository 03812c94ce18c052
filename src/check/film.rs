//! Hard cases about film.

use super::Case;

pub(super) const CASES: &[Case] = &[];

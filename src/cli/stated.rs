//! What image files say of themselves: a function of scene, settings and passes only.

use std::ops::Range;

use crate::film::{ErrorEstimate, Film};
use crate::integrate::Outcome;
use crate::part::Identity;

/// What a picture is of, and how good it is, beside its identity.
#[derive(Clone, Debug, Default)]
pub(super) struct Stated {
    /// Passes, half open, in order.
    pub(super) passes: Vec<Range<u32>>,
    /// Whether some pixels have no samples.
    pub(super) partial: bool,
    /// The error, where it can be estimated.
    pub(super) error: Option<ErrorEstimate>,
}

impl Stated {
    /// Of a film with these passes.
    pub(super) fn of(film: &Film, passes: Vec<Range<u32>>, partial: bool) -> Self {
        Self { passes, partial, error: film.error().filter(|_| !partial) }
    }

    /// Of a render whose film held the passes from `first` on before.
    pub(super) fn of_outcome(outcome: &Outcome, first: u32) -> Self {
        let passes = std::iter::once(first..outcome.passes.end).collect();
        Self::of(&outcome.film, passes, outcome.partial)
    }

    /// The attributes of an image file.
    pub(super) fn attributes(&self, identity: &Identity) -> Vec<(String, String)> {
        let range = |r: &Range<u32>| format!("{}..{}", r.start, r.end);
        let mut list = identity.0.clone();
        let mut add = |name: &str, value: String| list.push((name.to_owned(), value));
        add("passes", self.passes.iter().map(range).collect::<Vec<_>>().join(", "));
        if self.partial {
            add("partial", "some pixels have no samples".to_owned());
        }
        if let Some(e) = self.error {
            add("error", format!("{:.3e}", e.error));
            add("error_interval", format!("{:.3e}..{:.3e}", e.interval[0], e.interval[1]));
            add("error_trusted", e.trusted.to_string());
        }
        list
    }
}

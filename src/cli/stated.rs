//! What image files say of themselves: a function of scene, settings and passes only.

use std::ops::Range;

use super::units::{show_passes, show_share};
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
        let mut list = identity.0.clone();
        let mut add = |name: &str, value: String| list.push((name.to_owned(), value));
        add("passes", show_passes(&self.passes));
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

    /// A line about the error, and how sure it is; `None` where nothing can be said of it.
    pub(super) fn error_line(&self) -> Option<String> {
        let found = self.error?;
        let [low, high] = found.interval.map(show_share);
        Some(if found.trusted {
            format!("error {} ({low} to {high}, 95 % sure)", show_share(found.error))
        } else if found.error > ErrorEstimate::NOISIEST {
            format!("error above {}: too noisy to say", show_share(ErrorEstimate::NOISIEST))
        } else {
            let carry = found.effective_pixels;
            format!("error {}, not trustworthy yet: {carry:.0} pixels carry it", show_share(found.error))
        })
    }
}

//! What image files say of themselves: a function of scene, settings and passes only.

use std::ops::Range;

use super::doubt::words;
use super::units::{show_passes, show_share};
use crate::film::{Doubt, ErrorEstimate, Film};
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
    /// Names of the lights that are told apart where light was not found.
    pub(super) lights: Vec<String>,
}

impl Stated {
    /// Of a film with these passes.
    pub(super) fn of(film: &Film, passes: Vec<Range<u32>>, partial: bool, lights: &[String]) -> Self {
        Self { passes, partial, error: film.error().filter(|_| !partial), lights: lights.to_vec() }
    }

    /// Of a render whose film held the passes from `first` on before.
    pub(super) fn of_outcome(outcome: &Outcome, first: u32, lights: &[String]) -> Self {
        let passes = std::iter::once(first..outcome.passes.end).collect();
        Self::of(&outcome.film, passes, outcome.partial, lights)
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
            if let Some(doubt) = &e.doubt {
                add("error_doubt", words(doubt, &self.lights));
            }
        }
        list
    }

    /// A line about the error, and how sure it is; `None` where nothing can be said of it.
    pub(super) fn error_line(&self) -> Option<String> {
        let found = self.error?;
        let [low, high] = found.interval.map(show_share);
        Some(match &found.doubt {
            None => format!("error {} ({low} to {high}, 95 % sure)", show_share(found.error)),
            Some(doubt @ Doubt::TooNoisy) => {
                let noisiest = show_share(ErrorEstimate::NOISIEST);
                format!("error above {noisiest}: {}", words(doubt, &self.lights))
            }
            Some(doubt) => {
                let error = show_share(found.error);
                format!("error {error}, not trustworthy yet: {}", words(doubt, &self.lights))
            }
        })
    }
}

//! What image files say of themselves: a function of scene, settings and passes only.

use std::ops::Range;

use super::doubt::words;
use super::units::{show_passes, show_share};
use crate::film::{Doubt, ErrorEstimate, Film, MapBias};
use crate::integrate::Outcome;
use crate::part::Identity;

/// Share of the light from which on it is said that few samples carry it.
const TELLING: f64 = 0.02;

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
            if let Some(MapBias { error, interval: [low, high] }) = e.map_bias {
                add("error_map_bias", format!("{error:.3e}, {low:.3e}..{high:.3e}"));
            }
            add("error_trusted", e.trusted.to_string());
            if let Some(doubt) = &e.doubt {
                add("error_doubt", words(doubt, &self.lights));
            }
            if let Some(tail) = e.tail {
                add(
                    "error_tail",
                    format!("{:.3e} of the samples, {:.3e} of the light", tail.samples, tail.light),
                );
            }
        }
        list
    }

    /// [`error_line`] of its error.
    pub(super) fn error_line(&self) -> Option<String> {
        self.error.as_ref().map(|found| error_line(found, &self.lights))
    }
}

/// A line about an error, and how sure it is; `lights` are the names of the lights that are told apart.
pub(super) fn error_line(found: &ErrorEstimate, lights: &[String]) -> String {
    let [low, high] = found.interval.map(show_share);
    // What few samples carry is the reason where it is much.
    let tail = found.tail.filter(|t| t.light >= TELLING).map(|t| {
        format!("{} of the samples carry {:.0} % of the light", show_share(t.samples), 100.0 * t.light)
    });
    let noisy = found.error > ErrorEstimate::NOISIEST;
    let error = if noisy {
        format!("error above {}", show_share(ErrorEstimate::NOISIEST))
    } else {
        format!("error {}", show_share(found.error))
    };
    match (&found.doubt, tail) {
        (None, _) => {
            let bias = found.map_bias.map(|b| format!("; photon maps are off by {}", show_share(b.error)));
            let bias = bias.unwrap_or_default();
            format!("error {} ({low} to {high}, 95 % sure{bias})", show_share(found.error))
        }
        // What is missing says more than that something may be.
        (Some(doubt @ (Doubt::LightNotFound { .. } | Doubt::LightNotReached { .. })), _) => {
            format!("{error}, not trustworthy yet: {}", words(doubt, lights))
        }
        (_, Some(tail)) => format!("{error}, not trustworthy yet: {tail}"),
        (Some(doubt @ Doubt::TooNoisy), None) => format!("{error}: {}", words(doubt, lights)),
        (Some(doubt), None) => format!("{error}, not trustworthy yet: {}", words(doubt, lights)),
    }
}

//! Values of the extension, clamped or left out, each with a note.

use super::{ignored, is_length};
use crate::color::Rgb;
use crate::scene::notes::Notes;
use crate::scene::{MAX_RADIANCE, NoteEffect};

/// Checks the values of one table.
pub(super) struct Check<'n> {
    /// Where the table stands.
    pub(super) place: String,
    pub(super) notes: &'n mut Notes,
}

impl Check<'_> {
    /// Leaves `key` out.
    pub(super) fn ignore(&mut self, key: &str, why: &str) {
        ignored(self.notes, format!("{}.{key}", self.place), why);
    }

    /// A number, within [min, max].
    pub(super) fn number(&mut self, key: &str, value: f64, min: f64, max: f64) -> f64 {
        let good = value.clamp(min, max);
        if good != value {
            self.clamped(key, &format!("{value}"), &format!("{good}"));
        }
        good
    }

    /// A whole number, within [min, max].
    pub(super) fn whole(&mut self, key: &str, value: f64, min: u32, max: u32) -> u32 {
        let good = value.round().clamp(min.into(), max.into());
        if good != value {
            self.clamped(key, &format!("{value}"), &format!("{good}"));
        }
        good as u32
    }

    /// A length above zero.
    pub(super) fn length(&mut self, key: &str, value: f64) -> Option<f64> {
        if is_length(value) {
            return Some(value);
        }
        self.ignore(key, &format!("{value} is no length from 1e-15 to 1e15 metres"));
        None
    }

    /// A colour with each channel within [0, max].
    pub(super) fn color(&mut self, key: &str, value: [f64; 3], max: f32) -> Rgb {
        // A double beyond the singles becomes infinite, and is clamped.
        let color = Rgb::from(value.map(|v| v as f32));
        let good = color.map(|v| v.clamp(0.0, max));
        if good != color {
            self.clamped(key, &format!("{value:?}"), &format!("{:?}", good.to_array()));
        }
        good
    }

    /// Radiance, intensity or irradiance.
    pub(super) fn emitted(&mut self, key: &str, value: [f64; 3]) -> Rgb {
        self.color(key, value, MAX_RADIANCE)
    }

    /// Notes that `good` stands for what was `found`.
    pub(super) fn clamped(&mut self, key: &str, found: &str, good: &str) {
        let message = format!("{found}: taken as {good}");
        self.notes.add("value-clamped", NoteEffect::Differs, format!("{}.{key}", self.place), message);
    }
}

//! `golden.toml`: which scenes are guarded, and what for. Written by people; what is recorded lies beside it.

use serde::{Deserialize, Serialize};

use crate::prepare::{Algorithms, CausticsMode};

/// The version of the form that is read and written.
const VERSION: u32 = 1;
/// Samples a pixel are a multiple of this, so that eighths of them fill the replications evenly.
const UNIT: u32 = 32;
/// Longest side of a golden picture, pixels: it is small, or the reference is large and slow.
const LONGEST: u32 = 1024;

/// A `golden.toml`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Suite {
    /// Version of the form: 1.
    pub golden: u32,
    /// File, relative to this one, that keeps the reasons of blessings; `BLESSINGS.md` where absent.
    #[serde(default)]
    pub blessings: Option<String>,
    /// The scenes.
    #[serde(rename = "scene")]
    pub scenes: Vec<Entry>,
}

/// A scene that is guarded.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Its name: letters, digits, `-` and `_`.
    pub name: String,
    /// The scene's file, relative to `golden.toml`; any format that can be rendered.
    pub file: String,
    /// Camera by name; the scene's first where absent.
    #[serde(default)]
    pub camera: Option<String>,
    /// Width and height, pixels.
    #[serde(default = "small")]
    pub size: [u32; 2],
    /// Samples a pixel of one run.
    #[serde(default = "some_samples")]
    pub spp: u32,
    /// Cap on scattering events; that of the scene where absent.
    #[serde(default)]
    pub max_depth: Option<u32>,
    /// How caustics are found; no pilot chooses it.
    #[serde(default)]
    pub caustics: CausticsBy,
    /// Folder of the recorded files, relative to `golden.toml`; the scene's name where absent.
    #[serde(default)]
    pub reference: Option<String>,
    /// What it guards, a line for people.
    #[serde(default)]
    pub guards: String,
    /// How it is known that the reference is right.
    #[serde(default)]
    pub truth: Truth,
    /// A difference that is put up with.
    #[serde(default)]
    pub accept: Option<Accept>,
}

/// How it is known that a reference is right.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Truth {
    /// It is not: the renderer's own mean.
    #[default]
    Render,
    /// Every pixel's radiance is known, in every channel.
    ClosedForm {
        /// The radiance, W sr^-1 m^-2.
        mean: f64,
        /// Where it comes from.
        source: String,
    },
    /// The reference integrator, brute force in double precision.
    Reference {
        /// Its samples a pixel.
        spp: u32,
    },
}

/// A difference that is put up with.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Accept {
    /// As a share: 0.01 is one per cent.
    pub shift: f64,
    /// Why.
    pub reason: String,
}

/// What fixes a run besides the scene and the seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Camera by name.
    pub camera: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub spp: u32,
    /// Cap on scattering events.
    pub max_depth: Option<u32>,
    /// How caustics are found.
    #[serde(default, skip_serializing_if = "CausticsBy::is_path")]
    pub caustics: CausticsBy,
}

/// How the caustics of a golden scene are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CausticsBy {
    /// By paths.
    #[default]
    Path,
    /// By photons, with a map.
    Photon,
}

impl CausticsBy {
    fn is_path(&self) -> bool {
        *self == Self::Path
    }

    /// The same for [`prepare`](crate::prepare).
    pub(super) fn algorithms(self) -> Algorithms {
        let caustics = match self {
            Self::Path => CausticsMode::Path,
            Self::Photon => CausticsMode::Photon,
        };
        Algorithms { caustics, ..Algorithms::PATHS }
    }
}

/// Why a `golden.toml` cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SuiteError {
    /// Not TOML, or not of this form.
    #[error("{0}")]
    Text(#[from] toml::de::Error),
    /// The version is not known.
    #[error("golden: found version {0}, expected {VERSION}")]
    Version(u32),
    /// There are no scenes.
    #[error("no [[scene]] stands in it, expected at least one")]
    Empty,
    /// A value is not possible.
    #[error("scene {name:?}: {place}: found {found}, expected {expected}")]
    Value {
        /// The scene.
        name: String,
        /// The key.
        place: &'static str,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: &'static str,
    },
}

fn small() -> [u32; 2] {
    [64, 64]
}

fn some_samples() -> u32 {
    64
}

impl Suite {
    /// Reads a `golden.toml`.
    ///
    /// # Errors
    /// The text is not of this form, or a value is not possible.
    pub fn parse(text: &str) -> Result<Self, SuiteError> {
        let suite: Self = toml::from_str(text)?;
        if suite.golden != VERSION {
            return Err(SuiteError::Version(suite.golden));
        }
        if suite.scenes.is_empty() {
            return Err(SuiteError::Empty);
        }
        for (i, entry) in suite.scenes.iter().enumerate() {
            entry.check()?;
            if suite.scenes[..i].iter().any(|other| other.name == entry.name) {
                return Err(entry.wrong("name", &entry.name, "a name of its own"));
            }
        }
        Ok(suite)
    }
}

impl Entry {
    fn wrong(&self, place: &'static str, found: impl ToString, expected: &'static str) -> SuiteError {
        SuiteError::Value { name: self.name.clone(), place, found: found.to_string(), expected }
    }

    fn check(&self) -> Result<(), SuiteError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if self.name.is_empty() || !self.name.chars().all(plain) {
            return Err(self.wrong("name", &self.name, "letters, digits, `-` and `_`"));
        }
        let [w, h] = self.size;
        if !(8..=LONGEST).contains(&w) || !(8..=LONGEST).contains(&h) {
            return Err(self.wrong("size", format!("{w}x{h}"), "sides of 8 to 1024 pixels"));
        }
        if self.spp == 0 || !self.spp.is_multiple_of(UNIT) || self.spp > 1 << 20 {
            return Err(self.wrong("spp", self.spp, "a multiple of 32, at most 1048576"));
        }
        if let Some(accept) = &self.accept {
            if !(accept.shift > 0.0 && accept.shift < 1.0) {
                return Err(self.wrong("accept.shift", accept.shift, "a share above 0 and below 1"));
            }
            if accept.reason.trim().is_empty() {
                return Err(self.wrong("accept.reason", "nothing", "the reason for putting up with it"));
            }
        }
        match &self.truth {
            Truth::ClosedForm { mean, source } => {
                if !(mean.is_finite() && *mean > 0.0) {
                    return Err(self.wrong("truth.closed_form.mean", mean, "a radiance above zero"));
                }
                if source.trim().is_empty() {
                    return Err(self.wrong("truth.closed_form.source", "nothing", "where it comes from"));
                }
            }
            Truth::Reference { spp } if *spp < 2 => {
                return Err(self.wrong("truth.reference.spp", spp, "at least 2"));
            }
            _ => {}
        }
        Ok(())
    }

    /// Share of a difference that is put up with.
    #[must_use]
    pub fn accepted(&self) -> f64 {
        self.accept.as_ref().map_or(0.0, |a| a.shift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the form of the file: defaults, truths, tolerance.
    #[test]
    fn a_suite_is_read() {
        let suite = Suite::parse(
            r#"
            golden = 1
            [[scene]]
            name = "room"
            file = "room.toml"
            [[scene]]
            name = "furnace"
            file = "f.toml"
            spp = 128
            truth = { closed_form = { mean = 1, source = "a white furnace" } }
            accept = { shift = 0.01, reason = "two machines" }
            [[scene]]
            name = "ball"
            file = "b.glb"
            caustics = "photon"
            truth = { reference = { spp = 64 } }
            "#,
        )
        .expect("a suite");
        assert_eq!(suite.scenes[0].size, [64, 64]);
        assert_eq!((&suite.scenes[0].truth, suite.scenes[0].accepted()), (&Truth::Render, 0.0));
        assert_eq!(suite.scenes[1].accepted(), 0.01);
        assert_eq!(suite.scenes[2].truth, Truth::Reference { spp: 64 });
        let caustics: Vec<_> = suite.scenes.iter().map(|s| s.caustics).collect();
        assert_eq!(caustics, [CausticsBy::Path, CausticsBy::Path, CausticsBy::Photon]);
    }

    /// Guards the messages: the place, what was found, what was expected.
    #[test]
    fn mistakes_are_explained() {
        let message = |text: &str| Suite::parse(text).expect_err("a mistake").to_string();
        let scene = |more: &str| format!("golden = 1\n[[scene]]\nname = \"a\"\nfile = \"a.toml\"\n{more}\n");
        assert_eq!(message("golden = 2\nscene = []"), "golden: found version 2, expected 1");
        assert_eq!(
            message(&scene("spp = 100")),
            "scene \"a\": spp: found 100, expected a multiple of 32, at most 1048576"
        );
        assert!(message(&scene("colour = 3")).contains("unknown field `colour`"));
        let twice = scene("") + &scene("").replace("golden = 1", "");
        assert_eq!(message(&twice), "scene \"a\": name: found a, expected a name of its own");
        assert!(message(&scene("accept = { shift = 0.1, reason = \" \" }")).contains("accept.reason"));
    }
}

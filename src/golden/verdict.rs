//! What verifying a scene came to: everything that a page, a table or a file says about it.

use crate::film::Image;
use crate::stats::gate::Outcome;

/// How a scene fared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[must_use = "a verdict does nothing until it is reported"]
pub enum Verdict {
    /// Nothing but noise between the render and its reference.
    Passed,
    /// Less noise than recorded, and nothing else: good news that wants blessing, or it would hide a later
    /// loss.
    Improved,
    /// Something is wrong, or has changed on purpose and wants blessing.
    Refused,
}

impl Verdict {
    /// A word for people.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Improved => "improved",
            Self::Refused => "refused",
        }
    }
}

/// A gate without statistics: it holds or it does not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    /// Its name, such as `samples`.
    pub name: &'static str,
    /// Whether it holds.
    pub holds: bool,
    /// What was found, and what was expected where that differs.
    pub message: String,
}

/// Why a scene did not simply pass, worst first.
#[derive(Clone, Debug, PartialEq)]
pub struct Reason {
    /// The gate, as [`Check::name`], or as a statistic names itself (`matched, caustic`).
    pub gate: String,
    /// For people: `caustic light -4.1 %, z = -9.0`.
    pub message: String,
    /// True where this alone is an improvement.
    pub better: bool,
}

/// A point of the curve of error over samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Samples a pixel.
    pub spp: u32,
    /// Relative error of the render under test against the pilots' mean, the mean of its runs.
    pub error: f64,
    /// The same for the runs of the reference: geometric mean.
    pub expected: f64,
    /// Their deviation as a factor: two thirds of them lie between `expected / spread` and `expected * spread`.
    pub spread: f64,
}

/// What a statistic is able to notice.
#[derive(Clone, Debug, PartialEq)]
pub struct Power {
    /// As a statistic names itself: `matched, luminance`.
    pub statistic: String,
    /// Smallest relative shift that is noticed with a probability of 99 %: 0.01 is one per cent.
    pub shift: f64,
}

/// Everything about a scene that was verified.
#[derive(Clone, Debug)]
pub struct Verification {
    /// The scene's name in `golden.toml`.
    pub name: String,
    /// What it guards, a line for people.
    pub guards: String,
    /// How it is known that the reference is right, a line for people.
    pub truth: String,
    /// Samples a pixel of one run.
    pub spp: u32,
    /// Seeds of the runs under test.
    pub seeds: Vec<u64>,
    /// How it fared.
    pub verdict: Verdict,
    /// Why, worst first; empty where it passed.
    pub reasons: Vec<Reason>,
    /// The gates without statistics.
    pub checks: Vec<Check>,
    /// The gates with statistics: each finding with its p-value, least probable first; `None` where the
    /// checks left nothing to compare.
    pub outcome: Option<Outcome>,
    /// A scene is refused where the p-value of its family of findings is below this.
    pub significance: f64,
    /// Mean over the reference's runs, with the variance of that mean, and the layers `direct`, `indirect`,
    /// `caustic`, `glass` and `emitted`.
    pub reference: Image,
    /// Mean over the runs under test, the same way; `None` where nothing could be rendered.
    pub image: Option<Image>,
    /// Difference of the two over its standard error, per pixel, luminance: a diagnostic, not a gate.
    pub z: Vec<f32>,
    /// Error over samples.
    pub curve: Vec<CurvePoint>,
    /// What would be noticed, the most telling statistics only.
    pub power: Vec<Power>,
    /// Renders the run under test again with the seed that was used.
    pub replay: String,
    /// Accepts what was rendered as the new reference.
    pub bless: String,
    /// Wall-clock time, seconds.
    pub seconds: f64,
}

/// The smallest relative change of all light that is noticed with a probability of 99 %.
#[must_use]
pub fn notices(power: &[Power]) -> Option<f64> {
    power.iter().find(|p| p.statistic == "matched, luminance").map(|p| p.shift)
}

//! Words for why an error cannot be trusted.

use serde::Serialize;

use super::units::show_share;
use crate::film::Doubt;

/// A doubt for programs.
#[derive(Clone, Serialize)]
pub(super) struct DoubtJson {
    /// Its kind: `too-noisy`, `few-pixels`, `light-not-found`, `light-not-reached`.
    kind: &'static str,
    /// A line for people.
    what: String,
    /// Left, top, right and bottom of where light was not found, half open, pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pixels: Option<[u32; 4]>,
    /// How much is missing at least, over what the picture shows there; at most, where it was not reached.
    #[serde(skip_serializing_if = "Option::is_none")]
    share: Option<f64>,
    /// From which light.
    #[serde(skip_serializing_if = "Option::is_none")]
    light: Option<String>,
    /// Whether it is a caustic.
    #[serde(skip_serializing_if = "Option::is_none")]
    caustic: Option<bool>,
}

impl DoubtJson {
    /// Of a picture whose lights are told apart by these names.
    pub(super) fn new(doubt: &Doubt, lights: &[String]) -> Self {
        let what = words(doubt, lights);
        let none = Self { kind: "", what, pixels: None, share: None, light: None, caustic: None };
        match *doubt {
            Doubt::TooNoisy => Self { kind: "too-noisy", ..none },
            Doubt::FewPixels { .. } => Self { kind: "few-pixels", ..none },
            Doubt::LightNotFound { pixels, share, light, caustic } => Self {
                kind: "light-not-found",
                pixels: Some(pixels),
                share: Some(share).filter(|s| s.is_finite()),
                light: name(light, lights).map(str::to_owned),
                caustic: Some(caustic),
                ..none
            },
            Doubt::LightNotReached { share, light } => Self {
                kind: "light-not-reached",
                share: Some(share),
                light: name(Some(light), lights).map(str::to_owned),
                ..none
            },
        }
    }
}

/// A doubt for people; `lights` are the names of the lights that are told apart.
pub(super) fn words(doubt: &Doubt, lights: &[String]) -> String {
    let of = |light| name(light, lights).map_or(String::new(), |name| format!(" from {name}"));
    match *doubt {
        Doubt::TooNoisy => "too noisy to say".to_owned(),
        Doubt::FewPixels { carry } if carry.round() <= 1.0 => "1 pixel carries it".to_owned(),
        Doubt::FewPixels { carry } => format!("{carry:.0} pixels carry it"),
        Doubt::LightNotFound { pixels: [x0, y0, x1, y1], share, light, caustic } => {
            let from = of(light);
            let way = if caustic { " by way of mirrors or glass" } else { "" };
            let place = format!("to pixels {x0}..{x1},{y0}..{y1}");
            if share.is_finite() {
                let share = show_share(share.max(0.0));
                format!("photons{from} bring at least {share} more light{way} {place} than paths found")
            } else {
                format!("photons{from} bring light{way} {place}, where paths found none")
            }
        }
        Doubt::LightNotReached { share, light } => {
            let from = of(Some(light));
            let most = match share {
                s if s < 3.0 => format!("{} of", show_share(s)),
                s => format!("{s:.0} times"),
            };
            format!("nothing{from} arrived, of which so few samples may miss up to {most} what is shown")
        }
    }
}

fn name(light: Option<u8>, lights: &[String]) -> Option<&str> {
    lights.get(usize::from(light?)).map(String::as_str)
}

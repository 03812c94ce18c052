//! What follows from a quote: another estimator of the noisiest part of the light, or the picture without it.

use serde::Serialize;

use super::quote::PriceJson;
use super::units::{show_error, show_time};
use crate::film::LightLayer;
use crate::prepare::{Algorithms, Caustics, CausticsMode, Omission, Plan};
use crate::quote::{EffectShare, Pilot, Quote};

/// Share of the noise from which on something else than a part of the light as it is is tried.
const NOISY: f64 = 0.25;
/// Without more than this share of the light it is another picture.
const GIVEN_UP: f64 = 0.25;

/// Something else that may be rendered.
#[derive(Clone, Copy, Debug)]
pub(super) enum Other {
    /// Caustics by photons.
    Photons,
    /// The picture without a part of its light.
    Without(Omission, EffectShare),
}

/// Something else, and what it would cost.
pub(super) struct Alternative {
    pub(super) other: Other,
    pub(super) quote: Option<Quote>,
}

#[derive(Serialize)]
pub(super) struct AlternativeJson {
    /// As it is typed.
    flag: String,
    /// Share of the light that the picture lacks then, [0, 1].
    light_lost: f64,
    #[serde(flatten)]
    price: PriceJson,
}

impl Other {
    /// What is worth a try where a pilot of this plan found so much noise: photons where paths find caustics with much
    /// noise, or too rarely to say; and no part at all where it has the most noise and is not most of the light.
    pub(super) fn worth_a_try(plan: &Plan, asked: Algorithms, pilot: &Pilot) -> Vec<Self> {
        let mut list = Vec::new();
        let caustic = share(pilot, LightLayer::Caustic);
        let noisy = caustic.is_some_and(|c| c.noise >= NOISY) || !pilot.is_clear();
        if plan.caustics == Caustics::Path && asked.caustics != CausticsMode::Photon && noisy {
            list.push(Self::Photons);
        }
        if let Some(noisiest) = pilot.parts.first().filter(|p| p.noise >= NOISY && p.light <= GIVEN_UP) {
            let omission = match noisiest.layer {
                LightLayer::Caustic => Some(Omission::Caustics),
                LightLayer::Indirect => Some(Omission::Indirect),
                _ => None,
            };
            list.extend(omission.map(|o| Self::Without(o, *noisiest)));
        }
        list
    }

    /// As it is typed.
    fn flag(self) -> String {
        match self {
            Self::Photons => "--algorithm caustics=photon".to_owned(),
            Self::Without(omission, _) => format!("--without {}", omission.word()),
        }
    }
}

impl Alternative {
    pub(super) fn json(&self, error: f64) -> AlternativeJson {
        let light_lost = match self.other {
            Other::Photons => 0.0,
            Other::Without(_, part) => part.light,
        };
        AlternativeJson { flag: self.other.flag(), light_lost, price: PriceJson::new(error, self.quote) }
    }
}

fn share(pilot: &Pilot, layer: LightLayer) -> Option<&EffectShare> {
    pilot.parts.iter().find(|p| p.layer == layer)
}

/// What follows, line by line: what the noisiest part is of the picture and how it is found, then what else there is.
pub(super) fn lines(plan: &Plan, pilot: &Pilot, others: &[Alternative], error: f64) -> Vec<String> {
    let (own, error) = (pilot.quote(error), show_error(error));
    let mut lines = Vec::new();
    let part = match others.iter().any(|o| matches!(o.other, Other::Photons)) {
        true => share(pilot, LightLayer::Caustic),
        false => pilot.parts.first().filter(|p| p.noise >= NOISY),
    };
    if let Some(part) = part {
        let found = match (part.layer, plan.caustics) {
            (LightLayer::Caustic, how) => format!("; found by {}", how.name()),
            _ => String::new(),
        };
        let (name, light, noise) = (part.layer.name(), 100.0 * part.light, 100.0 * part.noise);
        lines.push(format!("{name}: {light:.1} % of the light, {noise:.0} % of the noise{found}"));
    }
    for Alternative { other, quote } in others {
        let flag = other.flag();
        let cost = match (own, quote) {
            (Some(own), Some(quote)) => {
                let [own, quote] = [&own, quote].map(|q| show_time(q.seconds));
                format!("{flag} would take {quote} instead of {own} for {error}")
            }
            (None, Some(quote)) => {
                format!("{flag} would take {} for {error}", show_time(quote.seconds))
            }
            (_, None) => format!("what {flag} would take cannot be said from so few samples"),
        };
        lines.push(match other {
            Other::Without(_, part) if quote.is_some() => {
                format!("{cost}, and lack {:.1} % of the light", 100.0 * part.light)
            }
            _ => cost,
        });
    }
    lines
}

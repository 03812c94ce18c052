//! Going on by the choices that a saved render was made by.

use serde_json::Value;

use crate::part::Identity;
use crate::prepare::{
    ABOUT, Algorithms, Caustics, CausticsMode, Options, Plan, PrepareError, analyse, camera_of,
};
use crate::scene::Scene;

/// The choices of a plan that change samples, by name, as files carry them.
pub(super) fn choices(plan: &Plan) -> [(&'static str, String); 4] {
    [
        ("caustics", plan.caustics.name().to_owned()),
        ("light_samples", plan.light_samples.to_string()),
        ("split", plan.split.to_string()),
        ("roulette", plan.roulette.to_string()),
    ]
}

/// The flags that ask for the choices of a plan.
pub(super) fn flags(plan: &Plan) -> String {
    let (mode, unbiased) = plan.caustics.mode();
    let caustics = if mode == CausticsMode::Path { "path" } else { "photon" };
    let unbiased = if unbiased { " --unbiased" } else { "" };
    let asked = [
        format!("caustics={caustics}"),
        format!("light-samples={}", plan.light_samples),
        format!("split={}", plan.split),
        format!("roulette={}", plan.roulette),
    ];
    asked.map(|a| format!(" --algorithm {a}")).concat() + unbiased
}

/// The plan of a scene by the choices that `identity` carries, with their reasons; they are also written to `options`.
/// What was asked for stays as it is, so that a render with other choices has another identity, and is refused.
pub(super) fn adopt(scene: &Scene, options: &mut Options, identity: &Identity) -> Result<Plan, PrepareError> {
    let value = |name: &str| identity.0.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str());
    let number = |asked: Option<u32>, name: &str| asked.or_else(|| value(name)?.parse().ok());
    let asked = options.algorithms;
    let saved = value("caustics").filter(|_| asked.caustics == CausticsMode::Auto);
    let (caustics, unbiased) = match saved {
        Some(name) => {
            let all = [Caustics::Path, Caustics::Traced, Caustics::Photon];
            let (mode, unbiased) = all.into_iter().find(|c| c.name() == name).unwrap_or_default().mode();
            (mode, unbiased || asked.unbiased)
        }
        None => (asked.caustics, asked.unbiased),
    };
    options.algorithms = Algorithms {
        caustics,
        unbiased,
        indirect: asked.indirect,
        light_samples: number(asked.light_samples, "light_samples"),
        split: number(asked.split, "split"),
        roulette: number(asked.roulette, "roulette"),
    };
    let mut plan = analyse(scene, camera_of(scene, options)?, options);
    let saved: Value = value("plan").and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
    for choice in saved["algorithms"].as_array().into_iter().flatten() {
        let text = |key: &str| choice[key].as_str();
        let about = ABOUT.into_iter().find(|&about| text("about") == Some(about));
        let (Some(about), Some(chosen), Some(reason)) = (about, text("chosen"), text("reason")) else {
            continue;
        };
        let made = plan.choices.iter().find(|c| c.about == about);
        if made.is_none_or(|made| made.chosen == chosen) {
            plan.explain(about, chosen, reason);
        }
    }
    Ok(plan)
}

//! Choices: how light is looked for, and what is not found that way.
//!
//! In: a scene and its folded materials. Out: decisions with their reasons, a pure function of scene and size.
//! They are the same whatever kernel runs.

use super::algorithm::{Algorithms, Caustics, CausticsMode, Indirect};
use super::casters::{casts, throws};
use super::fold::{Folded, has_surface};
use super::lights::{self, effect_of};
use super::material;
use super::plan::{Choice, Effect, Unseen};
use super::replications;
use crate::light::MANY_LIGHTS;
use crate::scene::{MaterialKind, Scene};

/// Scattering events before roulette starts. Four with the square root of the throughput had the smallest
/// product of rays and squared error on cornell at 64 samples; tried were also 3 and 5 with the square root, 2
/// and 5 with the throughput itself, and no roulette.
pub const ROULETTE_START: u32 = 4;

/// What decisions are about, in the order of reports.
pub const ABOUT: [&str; 8] =
    ["light", "light samples", "splitting", "caustics", "indirect", "roulette", "replications", "pilot"];

/// The decisions for a picture of so many pixels, where the materials `casters` focus light.
pub(super) fn choices(
    scene: &Scene,
    folded: &Folded<'_>,
    casters: &[usize],
    caustics: Caustics,
    algorithms: &Algorithms,
    pixels: u64,
) -> Vec<Choice> {
    let forced = out_of_reach(scene, folded, casters);
    vec![
        light_choice(scene, folded),
        light_samples(algorithms.light_samples),
        splitting(casters, algorithms.split),
        estimator(casters, caustics, algorithms.caustics, forced.as_deref()),
        roulette(algorithms.roulette),
        means(pixels),
    ]
}

/// How the light is chosen that is sampled at a hit.
fn light_choice(scene: &Scene, folded: &Folded<'_>) -> Choice {
    let emits = |kind: &MaterialKind| kind.emission().is_some();
    let surfaces = scene.objects.iter().filter(|o| has_surface(scene, o));
    let sky = folded.effects.has(Effect::Environment);
    let lights = surfaces.filter(|o| emits(&folded.kinds[o.material.0 as usize])).count()
        + scene.lights.iter().filter_map(lights::free).filter(|e| folded.effects.has(effect_of(e))).count()
        + scene.environment.iter().filter(|e| sky && !lights::is_dark(scene, e)).count();
    let (chosen, reason) = match lights {
        0 => ("none", "there is no light".to_owned()),
        1 => ("the only one", "sampled at each hit, but on mirrors and clear glass".to_owned()),
        n if n <= MANY_LIGHTS => {
            ("by contribution", format!("one of {n} at each hit, by what it could give there unobstructed"))
        }
        n => (
            "by power",
            format!("one of {n} at each hit; weighing each for every hit pays up to {MANY_LIGHTS}"),
        ),
    };
    choice("light", chosen, reason)
}

/// Why something is chosen that was asked for.
const ASKED: &str = "as asked for";

fn choice(about: &'static str, chosen: impl ToString, reason: impl Into<String>) -> Choice {
    Choice { about, chosen: chosen.to_string(), reason: reason.into() }
}

/// How many samples of lights the first hit takes.
fn light_samples(asked: Option<u32>) -> Choice {
    let why = if asked.is_some() { ASKED } else { "no pilot has seen that more would gain anything" };
    choice("light samples", asked.unwrap_or(1), why)
}

/// How many ways on paths take at a mirror or clear glass.
fn splitting(casters: &[usize], asked: Option<u32>) -> Choice {
    let chosen = asked.filter(|&m| m > 1).map_or_else(|| "none".to_owned(), |m| format!("{m} ways"));
    let why = match asked {
        _ if casters.is_empty() => "no surface is a mirror or clear glass",
        Some(_) => ASKED,
        None => "no pilot has seen that it would gain anything",
    };
    choice("splitting", chosen, why)
}

/// Who finds the light that mirrors and clear glass focus; `forced` is the light that paths do not find.
fn estimator(casters: &[usize], caustics: Caustics, mode: CausticsMode, forced: Option<&str>) -> Choice {
    let (chosen, reason) = match (casters.len(), caustics) {
        (0, _) => ("none", "no surface is so smooth that it would focus light".to_owned()),
        (_, Caustics::Path) => (
            caustics.name(),
            "after a smooth surface light is met by chance; the smaller the lights, the noisier".to_owned(),
        ),
        (_, Caustics::Traced | Caustics::Photon) => match forced.filter(|_| mode == CausticsMode::Auto) {
            Some(light) => (caustics.name(), format!("{}; no path finds {light}", caustics.what())),
            None => (caustics.name(), caustics.what().to_owned()),
        },
    };
    choice("caustics", chosen, reason)
}

/// Who finds indirect light, where that was asked.
pub(super) fn reuse(indirect: Indirect, why: &str) -> Choice {
    Choice { about: "indirect", chosen: indirect.name().to_owned(), reason: why.to_owned() }
}

fn roulette(asked: Option<u32>) -> Choice {
    let why = match asked {
        Some(_) => ASKED,
        None => "by the root of the throughput; ending paths earlier costs more noise than it saves",
    };
    choice("roulette", format!("from event {}", asked.unwrap_or(ROULETTE_START)), why)
}

fn means(pixels: u64) -> Choice {
    let k = replications(pixels);
    let reason = match k {
        2 => "independent sequences; two, since so many pixels take memory",
        _ => "independent sequences; their means give the error",
    };
    choice("replications", k, reason)
}

/// Materials in use that send light on in a single direction or nearly so: mirrors, clear glass, clear coats, what is
/// hardly rough. What they focus is a caustic.
pub(super) fn casters(scene: &Scene, folded: &Folded<'_>) -> Vec<usize> {
    (0..scene.materials.len())
        .filter(|&i| folded.uses[i].used && throws(scene, &folded.kinds[i]).is_some())
        .collect()
}

/// What no path finds: light of points and single directions that reaches a surface by way of a mirror or clear
/// glass. A path leaves those in one direction, and hits a point with probability zero.
pub(super) fn unseen(
    scene: &Scene,
    folded: &Folded<'_>,
    casters: &[usize],
    caustics: Caustics,
) -> Vec<Unseen> {
    let but = match caustics {
        Caustics::Photon => return Vec::new(),
        Caustics::Path => "",
        Caustics::Traced => ", and photons find it only on what the camera sees directly",
    };
    let Some(light) = out_of_reach(scene, folded, casters) else { return Vec::new() };
    let reason = format!("{light}: no path from the camera meets a point or a single direction{but}");
    vec![Unseen { what: "caustics", reason }]
}

/// The first light and the first material by way of which no path finds it, and how many more.
pub(super) fn out_of_reach(scene: &Scene, folded: &Folded<'_>, casters: &[usize]) -> Option<String> {
    let is_delta = |light: &&crate::scene::Light| {
        let points = folded.effects.has(Effect::DeltaLights);
        points && lights::free(light).is_some_and(|e| effect_of(&e) == Effect::DeltaLights)
    };
    let spreads = |i: usize| folded.uses[i].used && material::spreads(&folded.kinds[i]);
    let mut lights = scene.lights.iter().filter(is_delta);
    // At what is a little rough, lights are sampled.
    let mut smooth = casters.iter().filter(|&&i| casts(scene, &folded.kinds[i]).is_some());
    let (light, &caster) = (lights.next()?, smooth.next()?);
    if !(0..scene.materials.len()).any(spreads) {
        return None;
    }
    let more = |n: usize| if n > 0 { format!(" (and {n} more)") } else { String::new() };
    Some(format!(
        "light \"{}\"{} by way of material \"{}\"{}",
        light.name,
        more(lights.count()),
        scene.materials[caster].name,
        more(smooth.count())
    ))
}

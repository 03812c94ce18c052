//! Choices: how light is looked for, and what is not found that way.
//!
//! In: a scene and its folded materials. Out: decisions with their reasons, a pure function of scene and size.
//! They are the same whatever kernel runs.

use super::algorithm::Caustics;
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

/// The decisions for a picture of so many pixels, where the materials `casters` focus light.
pub(super) fn choices(
    scene: &Scene,
    folded: &Folded<'_>,
    casters: &[usize],
    caustics: Caustics,
    pixels: u64,
) -> Vec<Choice> {
    vec![light_choice(scene, folded), estimator(casters, caustics), roulette(), means(pixels)]
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
    Choice { about: "light", chosen: chosen.to_owned(), reason }
}

/// Who finds the light that mirrors and clear glass focus.
fn estimator(casters: &[usize], caustics: Caustics) -> Choice {
    let (chosen, reason) = match (casters.len(), caustics) {
        (0, _) => ("none", "no surface is so smooth that it would focus light"),
        (_, Caustics::Path) => (
            caustics.name(),
            "after a smooth surface light is met by chance; the smaller the lights, the noisier",
        ),
        (_, Caustics::Traced | Caustics::Photon) => (caustics.name(), caustics.what()),
    };
    Choice { about: "caustics", chosen: chosen.to_owned(), reason: reason.to_owned() }
}

fn roulette() -> Choice {
    Choice {
        about: "roulette",
        chosen: format!("from event {}", ROULETTE_START),
        reason: "by the root of the throughput; ending paths earlier costs more noise than it saves"
            .to_owned(),
    }
}

fn means(pixels: u64) -> Choice {
    let k = replications(pixels);
    let reason = match k {
        2 => "independent sequences; two, since so many pixels take memory",
        _ => "independent sequences; their means give the error",
    };
    Choice { about: "replications", chosen: k.to_string(), reason: reason.to_owned() }
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
    if caustics == Caustics::Photon {
        return Vec::new();
    }
    let is_delta = |light: &&crate::scene::Light| {
        let points = folded.effects.has(Effect::DeltaLights);
        points && lights::free(light).is_some_and(|e| effect_of(&e) == Effect::DeltaLights)
    };
    let spreads = |i: &usize| folded.uses[*i].used && material::spreads(&folded.kinds[*i]);
    let mut lights = scene.lights.iter().filter(is_delta);
    // At what is a little rough, lights are sampled.
    let mut smooth = casters.iter().filter(|&&i| casts(scene, &folded.kinds[i]).is_some());
    let (Some(light), Some(&caster)) = (lights.next(), smooth.next()) else { return Vec::new() };
    if !(0..scene.materials.len()).any(|i| spreads(&i)) {
        return Vec::new();
    }
    let more = |n: usize| if n > 0 { format!(" (and {n} more)") } else { String::new() };
    let but = match caustics {
        Caustics::Path | Caustics::Photon => "",
        Caustics::Traced => ", and photons find it only on what the camera sees directly",
    };
    let reason = format!(
        "light \"{}\"{} by way of material \"{}\"{}: no path from the camera meets a point or a single direction{but}",
        light.name,
        more(lights.count()),
        scene.materials[caster].name,
        more(smooth.count())
    );
    vec![Unseen { what: "caustics", reason }]
}

//! What can be switched: estimators, and effects that a picture could do without.

use crate::prepare::{
    self, Algorithms, Caustics, CausticsMode, Effect, Indirect, Omission, Options, Plan, PrepareError,
    Prepared, Shortcut, shortcuts_of,
};
use crate::scene::Scene;

/// What a switch does to the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Nothing is switched: what the program does by itself.
    Full,
    /// Another way to the same picture.
    Algorithm,
    /// Another picture: something is left out or made simpler.
    Shortcut,
}

/// One way to render a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Switch {
    /// What people call it, such as `without mirror`.
    pub name: String,
    /// What it does, a line for people.
    pub what: String,
    /// What the picture then lacks, such as `mirror`; empty where it lacks nothing.
    pub gives_up: String,
    /// The flag that throws it; empty where none is needed.
    pub flag: String,
    /// What it does to the picture.
    pub kind: Kind,
    how: How,
}

#[derive(Clone, Debug, PartialEq)]
enum How {
    Full,
    Algorithms(Algorithms),
    Shortcut(Shortcut),
}

/// Effects of which a picture is made: without them there is nothing to look at.
const NEEDED: [Effect; 4] = [Effect::AreaLights, Effect::FreeLights, Effect::DeltaLights, Effect::Diffuse];

impl Switch {
    /// What the program does by itself.
    fn full() -> Self {
        let [name, what, gives_up, flag] = ["full", "as the program renders it", "", ""].map(str::to_owned);
        Self { name, what, gives_up, flag, kind: Kind::Full, how: How::Full }
    }

    /// Another way to the same picture.
    fn algorithm(name: &str, flag: &str, what: &str, algorithms: Algorithms) -> Self {
        let [name, what, gives_up, flag] = [name, what, "", flag].map(str::to_owned);
        Self { name, what, gives_up, flag, kind: Kind::Algorithm, how: How::Algorithms(algorithms) }
    }

    fn shortcut(shortcut: Shortcut, plan: &Plan) -> Self {
        let (what, gives_up) = describe(&shortcut, plan);
        let (name, flag) = (shortcut.to_string(), shortcut.flag());
        Self { name, what, gives_up, flag, kind: Kind::Shortcut, how: How::Shortcut(shortcut) }
    }

    /// The scene, prepared this way.
    ///
    /// # Errors
    /// As [`prepare::prepare`].
    pub fn prepare(&self, scene: &Scene, options: &Options) -> Result<Prepared, PrepareError> {
        match &self.how {
            How::Full => prepare::prepare(scene, options),
            How::Algorithms(algorithms) => {
                prepare::prepare(scene, &Options { algorithms: *algorithms, ..options.clone() })
            }
            How::Shortcut(shortcut) => prepare::prepare(scene, &options.with_shortcut(*shortcut)),
        }
    }
}

/// What a shortcut does, and what the picture then lacks.
fn describe(shortcut: &Shortcut, plan: &Plan) -> (String, String) {
    match shortcut {
        Shortcut::Without(Omission::Effect(effect)) => {
            let need = plan.needs.iter().find(|n| n.effect == *effect);
            let what = need.map_or_else(String::new, |n| {
                let more = if n.count > 1 { format!(" (and {} more)", n.count - 1) } else { String::new() };
                format!("{}{more} has to do without", n.witness)
            });
            (what, effect.name().to_owned())
        }
        Shortcut::Without(omission) => {
            let what = match omission {
                Omission::Caustics => "what mirrors and glass throw onto something else is left out",
                _ => "light that was spread more than once is left out",
            };
            (what.to_owned(), omission.name().to_owned())
        }
        Shortcut::MaxDepth(most) => {
            let events = if *most == 1 { "event" } else { "events" };
            let what = format!("light that was scattered {most} times at most");
            let what = if *most == 1 {
                "light that comes from lamps at once, and no other".to_owned()
            } else {
                what
            };
            (what, format!("light after {most} {events}"))
        }
        Shortcut::Clamp(most) => (
            format!("no contribution after the first event counts for more than {most} W/(sr m\u{b2})"),
            "the brightest light".to_owned(),
        ),
        Shortcut::Schlick => (
            "dielectrics reflect by Schlick\u{2019}s approximation".to_owned(),
            "exact reflectance".to_owned(),
        ),
        Shortcut::IndirectGain(gain) => {
            (format!("indirect light times {gain}"), "what is physical".to_owned())
        }
    }
}

/// Everything that can be switched in a scene; the first one is that nothing is. Photon maps are no way where they are
/// forbidden, as `unbiased` says.
///
/// # Errors
/// The scene has no camera, or the options are refused.
pub fn switches(scene: &Scene, options: &Options, unbiased: bool) -> Result<Vec<Switch>, PrepareError> {
    let by_itself = prepare::plan(scene, options)?;
    let mut all = vec![Switch::full()];
    all.extend(estimators(scene, options, unbiased, &by_itself)?);
    let lower = |depth: u32| options.max_depth.is_none_or(|most| depth < most);
    let shows = |s: &Shortcut| match s {
        Shortcut::Without(Omission::Effect(effect)) => !NEEDED.contains(effect),
        // A cap that is no lower than what is asked for changes nothing.
        Shortcut::MaxDepth(depth) => lower(*depth),
        _ => true,
    };
    let shortcuts = shortcuts_of(scene, &prepare::plan(scene, &options.without_shortcuts())?);
    all.extend(shortcuts.into_iter().filter(shows).map(|s| Switch::shortcut(s, &by_itself)));
    Ok(all)
}

/// Samples of a part that are tried where one is taken.
const SEVERAL: u32 = 4;
/// Events from which roulette starts in other ways: before and after the usual one.
const ROULETTE_STARTS: [u32; 2] = [2, 8];

/// Estimators that the program would not choose by itself, as far as the plan tells them apart; of these, whoever
/// measures leaves out those that have nothing to do in the scene.
fn estimators(
    scene: &Scene,
    options: &Options,
    unbiased: bool,
    by_itself: &Plan,
) -> Result<Vec<Switch>, PrepareError> {
    // Light tracing asks for no map; what it is compared with may.
    let (asked, chosen) = (options.algorithms, by_itself.algorithms());
    let mapped = Algorithms { unbiased, ..asked };
    let other = |now: u32| if now == 1 { SEVERAL } else { 1 };
    let (samples, ways) = (other(by_itself.light_samples), other(by_itself.split));
    let caustics = |name: &str, word: &str, caustics| {
        let algorithms = Algorithms { caustics, ..mapped };
        (format!("caustics by {name}"), format!("caustics={word}"), None, algorithms)
    };
    let indirect = |name: &str, word: &str, what: &str, indirect| {
        // A map for indirect light comes with one for caustics.
        let algorithms = Algorithms { indirect, ..if indirect == Indirect::Photon { mapped } else { asked } };
        (format!("indirect light by {name}"), format!("indirect={word}"), Some(what.to_owned()), algorithms)
    };
    let mut tried = vec![
        caustics("paths", "path", CausticsMode::Path),
        caustics("photons", "photon", CausticsMode::Photon),
        indirect("paths", "path", "paths go on where they are spread again", Indirect::Path),
        indirect(
            "photons",
            "photon",
            "a path ends where it is spread for the second time, and photons say what light arrives there",
            Indirect::Photon,
        ),
        (
            format!("{samples} light sample{}", if samples == 1 { "" } else { "s" }),
            format!("light-samples={samples}"),
            Some("of lights at the first hit that spreads light".to_owned()),
            Algorithms { light_samples: Some(samples), ..asked },
        ),
        (
            if ways == 1 { "no splitting".to_owned() } else { format!("split {ways} ways") },
            format!("split={ways}"),
            Some("where the camera sees a mirror or clear glass first".to_owned()),
            Algorithms { split: Some(ways), ..asked },
        ),
    ];
    tried.extend(ROULETTE_STARTS.map(|start| {
        let what = "paths may end by chance from this event on".to_owned();
        let algorithms = Algorithms { roulette: Some(start), ..asked };
        (format!("roulette from event {start}"), format!("roulette={start}"), Some(what), algorithms)
    }));
    let mut others = Vec::new();
    for (name, typed, what, algorithms) in tried {
        let plan = prepare::plan(scene, &Options { algorithms, ..options.clone() })?;
        if plan.algorithms() != chosen {
            let what = what.unwrap_or_else(|| plan.caustics.what().to_owned());
            others.push(Switch::algorithm(&name, &format!("--algorithm {typed}"), &what, algorithms));
        }
    }
    Ok(others)
}

/// The way that a long render goes as the reference of the others: caustics by photons, where a scene has some.
///
/// # Errors
/// As [`prepare::prepare`].
pub(super) fn reference(scene: &Scene, options: &Options, unbiased: bool) -> Result<Prepared, PrepareError> {
    let algorithms = Algorithms { caustics: CausticsMode::Photon, unbiased, ..options.algorithms };
    prepare::prepare(scene, &Options { algorithms, ..options.clone() })
}

/// What people call how the reference finds caustics.
pub(super) fn reference_way(prepared: &Prepared) -> &'static str {
    match prepared.plan.caustics {
        Caustics::Path => "paths alone",
        Caustics::Traced | Caustics::Photon => "caustics by photons",
    }
}

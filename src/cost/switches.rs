//! What can be switched: estimators, and effects that a picture could do without.

use crate::prepare::{
    self, Algorithms, Caustics, CausticsMode, Effect, EffectsMode, Options, Plan, PrepareError, Prepared, analyse,
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
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Switch {
    /// What people call it, such as `without mirror`.
    pub name: String,
    /// What it does, a line for people.
    pub what: String,
    /// What the picture then lacks, such as `mirror`; empty where it lacks nothing.
    pub gives_up: String,
    /// What it does to the picture.
    pub kind: Kind,
    how: How,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum How {
    Full,
    Algorithms(Algorithms),
    Depth(u32),
    Without(Effect),
}

/// Caps on scattering events that are tried.
const DEPTHS: [u32; 4] = [1, 2, 4, 8];

/// Effects that a picture can do without. Of the others, the kinds of light and what is diffuse, a picture is made.
const OPTIONAL: [Effect; 11] = [
    Effect::Environment,
    Effect::Mirror,
    Effect::Refraction,
    Effect::Glossy,
    Effect::Absorption,
    Effect::SmoothNormals,
    Effect::Lens,
    Effect::Textures,
    Effect::Cutouts,
    Effect::NormalMaps,
    Effect::Nesting,
];

impl Switch {
    /// Another way to the same picture.
    fn algorithm(name: &str, what: &str, algorithms: Algorithms) -> Self {
        let (name, what, gives_up) = (name.to_owned(), what.to_owned(), String::new());
        Self { name, what, gives_up, kind: Kind::Algorithm, how: How::Algorithms(algorithms) }
    }

    fn shortcut(name: String, what: String, gives_up: String, how: How) -> Self {
        Self { name, what, gives_up, kind: Kind::Shortcut, how }
    }

    /// What the program does by itself.
    fn full() -> Self {
        let (name, what) = ("full".to_owned(), "as the program renders it".to_owned());
        Self { name, what, gives_up: String::new(), kind: Kind::Full, how: How::Full }
    }

    /// The scene, prepared this way.
    ///
    /// # Errors
    /// As [`prepare::prepare`].
    pub fn prepare(&self, scene: &Scene, options: &Options) -> Result<Prepared, PrepareError> {
        let mut options = options.clone();
        match &self.how {
            How::Full => {}
            How::Algorithms(algorithms) => options.algorithms = *algorithms,
            How::Depth(depth) => options.max_depth = Some(*depth),
            How::Without(effect) => {
                let plan = plan(scene, &options)?.without(*effect);
                return prepare::prepare_planned(scene, &options, plan);
            }
        }
        prepare::prepare(scene, &options)
    }
}

/// The plan of a scene.
fn plan(scene: &Scene, options: &Options) -> Result<Plan, PrepareError> {
    let named = |name: &String| scene.cameras.iter().find(|c| c.name == *name);
    let camera = options.camera.as_ref().map_or_else(|| scene.cameras.first(), named);
    Ok(analyse(scene, camera.ok_or(PrepareError::NoCamera)?, options))
}

/// Everything that can be switched in a scene; the first one is that nothing is.
///
/// # Errors
/// The scene has no camera.
pub fn switches(scene: &Scene, options: &Options) -> Result<Vec<Switch>, PrepareError> {
    let by_itself = plan(scene, options)?;
    let mut all = vec![Switch::full()];
    all.extend(estimators(scene, options, &by_itself)?);
    // A cap that is no lower than what is asked for changes nothing.
    for depth in DEPTHS.into_iter().filter(|d| options.max_depth.is_none_or(|most| *d < most)) {
        let events = if depth == 1 { "event" } else { "events" };
        let what = match depth {
            1 => "light that comes from lamps at once, and no other".to_owned(),
            _ => format!("light that was scattered {depth} times at most"),
        };
        let gives_up = format!("light after {depth} {events}");
        all.push(Switch::shortcut(format!("at most {depth} {events}"), what, gives_up, How::Depth(depth)));
    }
    for need in by_itself.needs.iter().filter(|n| OPTIONAL.contains(&n.effect)) {
        let more = if need.count > 1 { format!(" (and {} more)", need.count - 1) } else { String::new() };
        let name = need.effect.name();
        let what = format!("{}{more} has to do without", need.witness);
        let how = How::Without(need.effect);
        all.push(Switch::shortcut(format!("without {name}"), what, name.to_owned(), how));
    }
    Ok(all)
}

/// Estimators that the program would not choose by itself.
fn estimators(scene: &Scene, options: &Options, by_itself: &Plan) -> Result<Vec<Switch>, PrepareError> {
    let ways = [
        ("caustics by paths", Algorithms { caustics: CausticsMode::Path, ..options.algorithms }),
        ("caustics by photons", Algorithms { caustics: CausticsMode::Photon, ..options.algorithms }),
    ];
    let mut others = Vec::new();
    for (name, algorithms) in ways {
        let other = plan(scene, &Options { algorithms, ..options.clone() })?.caustics;
        if other != by_itself.caustics {
            others.push(Switch::algorithm(name, other.what(), algorithms));
        }
    }
    Ok(others)
}

/// The way that a long render goes as the reference of the others: caustics by photons, where a scene has some.
///
/// # Errors
/// As [`prepare::prepare`].
pub(super) fn reference(scene: &Scene, options: &Options) -> Result<Prepared, PrepareError> {
    let algorithms = Algorithms { caustics: CausticsMode::Photon, ..options.algorithms };
    let options = Options { algorithms, effects: EffectsMode::Auto, ..options.clone() };
    prepare::prepare(scene, &options)
}

/// What people call how the reference finds caustics.
pub(super) fn reference_way(prepared: &Prepared) -> &'static str {
    match prepared.plan.caustics {
        Caustics::Path => "paths alone",
        Caustics::Traced | Caustics::Photon => "caustics by photons",
    }
}

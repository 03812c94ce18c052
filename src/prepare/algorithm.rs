//! Which estimators run, where there is a choice.
//!
//! In: what was asked for, and the scene. Out: a part of the [`Plan`](super::Plan). A choice changes samples;
//! none runs where it would find nothing.

use super::casters::throws;
use super::choices::out_of_reach;
use super::fold::Folded;
use crate::scene::{MaterialKind, Scene, Sides};

/// Most samples of lights at a vertex, and most branches of a path.
pub const MOST_BRANCHES: u32 = 16;

/// What was asked for. What is not is chosen: by a pilot (`crate::pilot`), or where none runs as [`analyse`] says.
///
/// [`analyse`]: super::analyse
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Algorithms {
    /// How caustics are found.
    pub caustics: CausticsMode,
    /// Whether estimators are left out whose error does not vanish on average.
    pub unbiased: bool,
    /// How indirect light is found.
    pub indirect: Indirect,
    /// Samples of lights at the first vertex that spreads light, 1 to [`MOST_BRANCHES`].
    pub light_samples: Option<u32>,
    /// Branches of a path where the first thing that the camera sees is a mirror or clear glass, 1 to
    /// [`MOST_BRANCHES`].
    pub split: Option<u32>,
    /// Scattering events before roulette starts.
    pub roulette: Option<u32>,
}

impl Algorithms {
    /// Paths from the camera and nothing else, with a sample of lights and a branch each: what everything else is
    /// compared with.
    pub const PATHS: Self = Self {
        caustics: CausticsMode::Path,
        unbiased: false,
        indirect: Indirect::Path,
        light_samples: Some(1),
        split: Some(1),
        roulette: Some(super::ROULETTE_START),
    };
}

/// How caustics are to be found: light that mirrors and clear glass throw onto something else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CausticsMode {
    /// By whichever takes less work for the same error, as far as that is known; by photons where paths cannot find
    /// them.
    #[default]
    Auto,
    /// By paths from the camera that meet a light by chance.
    Path,
    /// By photons from the lights.
    Photon,
}

/// How caustics are found in a scene. A caustic is `E (D|S)* D S+ L` in Heckbert's notation: from the eye E
/// to the light L; S is an event without spread, or at a material all of
/// whose lobes are narrow (GGX widths below 0.1), and D any other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Caustics {
    /// By paths from the camera that meet a light by chance.
    #[default]
    Path,
    /// `E D (S+ D)* S+ L` by photons that are connected to the camera, without bias; the others as in `Path`.
    Traced,
    /// Those as in `Traced`, the others by density estimation: photons near a vertex D of a path. That is
    /// consistent: its bias vanishes as passes are added.
    Photon,
}

impl Caustics {
    /// What reports call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "paths",
            Self::Traced => "light tracing",
            Self::Photon => "photons",
        }
    }

    /// What asks for it: the mode, and whether without bias.
    #[must_use]
    pub fn mode(self) -> (CausticsMode, bool) {
        match self {
            Self::Path => (CausticsMode::Path, false),
            Self::Traced => (CausticsMode::Photon, true),
            Self::Photon => (CausticsMode::Photon, false),
        }
    }

    /// What it does, a line for people.
    #[must_use]
    pub fn what(self) -> &'static str {
        match self {
            Self::Path => "paths from the camera that meet a light by chance",
            Self::Traced => "from lights to what the camera sees directly; paths elsewhere",
            Self::Photon => "light tracing to what the camera sees directly, a photon map elsewhere",
        }
    }

    /// Whether paths from the camera leave a caustic to photons, which is `linked` (`E D (S+ D)* S+ L`) or not.
    #[inline]
    #[must_use]
    pub fn by_photons(self, linked: bool) -> bool {
        match self {
            Self::Path => false,
            Self::Traced => linked,
            Self::Photon => true,
        }
    }
}

/// How light is found that was scattered before it reaches a place where a path is spread for the second time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Indirect {
    /// By the path, which goes on.
    #[default]
    Path,
    /// By density estimation: photons near that place, traced anew in each pass. The path ends there. That is
    /// consistent: its bias vanishes as passes are added.
    Photon,
}

impl Indirect {
    /// What reports call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Path => "paths",
            Self::Photon => "photons",
        }
    }
}

/// The choice for a scene without a pilot, where the materials `casters` focus light: photons only where there is
/// something that throws light, and light; and unless asked for, only what paths cannot find.
pub(super) fn caustics(
    scene: &Scene,
    folded: &Folded<'_>,
    casters: &[usize],
    algorithms: &Algorithms,
) -> Caustics {
    match algorithms.caustics {
        CausticsMode::Path => Caustics::Path,
        CausticsMode::Auto if out_of_reach(scene, folded, casters).is_none() => Caustics::Path,
        CausticsMode::Auto | CausticsMode::Photon => by_photons(scene, folded, algorithms.unbiased),
    }
}

/// What photons can do for a scene.
fn by_photons(scene: &Scene, folded: &Folded<'_>, unbiased: bool) -> Caustics {
    let kind = |material: u32| &*folded.kinds[material as usize];
    let thrown = || scene.objects.iter().any(|o| throws(scene, kind(o.material.0)).is_some());
    match (photons_can(scene, folded) && thrown(), unbiased) {
        (false, _) => Caustics::Path,
        (true, true) => Caustics::Traced,
        (true, false) => Caustics::Photon,
    }
}

/// How indirect light is found, and why, where photons are asked for.
pub(super) fn indirect(
    scene: &Scene,
    folded: &Folded<'_>,
    algorithms: &Algorithms,
) -> (Indirect, &'static str) {
    match algorithms.indirect {
        Indirect::Path => (Indirect::Path, "asked for"),
        Indirect::Photon if algorithms.unbiased => (Indirect::Path, "a photon map has a bias"),
        Indirect::Photon if !photons_can(scene, folded) => (
            Indirect::Path,
            "there is no light, or bodies have priorities, where it is not known what photons are in",
        ),
        Indirect::Photon => (
            Indirect::Photon,
            "a map where a path is spread for the second time; its bias vanishes as passes are added",
        ),
    }
}

/// Whether light can be traced from where it starts: there is some, and it is known what photons are in.
pub(super) fn photons_can(scene: &Scene, folded: &Folded<'_>) -> bool {
    // What a photon is in where it starts is not known, and where bodies have an order all depends on it.
    if scene.objects.iter().any(|o| scene.materials[o.material.0 as usize].kind.body().is_some()) {
        return false;
    }
    let kind = |material: u32| &*folded.kinds[material as usize];
    let emits = |k: &MaterialKind| matches!(k.emission(), Some((_, Sides::Front | Sides::Both)));
    !scene.lights.is_empty()
        || scene.environment.is_some()
        || scene.objects.iter().any(|o| emits(kind(o.material.0)))
}

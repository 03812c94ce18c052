//! Which estimators run, where there is a choice.
//!
//! In: what was asked for, and the scene. Out: a part of the [`Plan`](super::Plan). A choice changes samples;
//! none runs where it would find nothing.

use super::Options;
use super::casters::throws;
use super::fold::Folded;
use crate::scene::{MaterialKind, Scene, Sides};

/// What was asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Algorithms {
    /// How caustics are found.
    pub caustics: CausticsMode,
    /// Whether estimators are left out whose error does not vanish on average.
    pub unbiased: bool,
}

/// How caustics are to be found: light that mirrors and clear glass throw onto something else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CausticsMode {
    /// By paths from the camera that meet a light by chance.
    #[default]
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

/// The choice for a scene: photons only where there is something that throws light, and light.
pub(super) fn caustics(scene: &Scene, folded: &Folded<'_>, options: &Options) -> Caustics {
    let Algorithms { caustics, unbiased } = options.algorithms;
    // What a photon is in where it starts is not known, and where bodies have an order all depends on it.
    let nested =
        || scene.objects.iter().any(|o| scene.materials[o.material.0 as usize].kind.body().is_some());
    if caustics == CausticsMode::Path || nested() {
        return Caustics::Path;
    }
    let kind = |material: u32| &*folded.kinds[material as usize];
    let thrown = scene.objects.iter().any(|o| throws(scene, kind(o.material.0)).is_some());
    let emits = |k: &MaterialKind| matches!(k.emission(), Some((_, Sides::Front | Sides::Both)));
    let lit = !scene.lights.is_empty()
        || scene.environment.is_some()
        || scene.objects.iter().any(|o| emits(kind(o.material.0)));
    match (thrown && lit, unbiased) {
        (false, _) => Caustics::Path,
        (true, true) => Caustics::Traced,
        (true, false) => Caustics::Photon,
    }
}

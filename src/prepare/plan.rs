//! The plan: what is simulated, why, by which kernel, and how.
//!
//! [`Effect`] is the one list. Analysis (`analyse`) collects the needs of a scene, each with a witness; tables
//! are built for them and for nothing else; the kernel is the smallest that covers them; the guards in the
//! kernels use the same names. Choices (which estimator, which probabilities) change samples and are the same
//! whatever kernel runs; pruning (kernels, tables) changes nothing: a test compares bytes.

use super::EffectsMode;
use super::algorithm::{Algorithms, Caustics, Indirect};
use super::shortcuts::Shortcut;

/// One thing light can do in a scene; declaration order is bit order and report order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Effect {
    /// Surfaces that emit.
    AreaLights,
    /// Lights that are not surfaces, with an extent.
    FreeLights,
    /// Lights that are points or single directions.
    DeltaLights,
    /// Light from infinitely far away.
    Environment,
    /// Lambertian reflection.
    Diffuse,
    /// Perfect mirrors.
    Mirror,
    /// Smooth dielectrics.
    Refraction,
    /// Rough or layered reflection and transmission.
    Glossy,
    /// Absorption inside of objects.
    Absorption,
    /// Interpolated normals.
    SmoothNormals,
    /// Depth of field.
    Lens,
    /// Pictures that vary what surfaces reflect, transmit and emit.
    Textures,
    /// Surfaces that are not there everywhere.
    Cutouts,
    /// Normals from pictures.
    NormalMaps,
    /// Colours of vertices.
    VertexColors,
    /// Bodies of which one is there where several are.
    Nesting,
    /// One that is compiled to measure what it costs scenes without it.
    #[cfg(epsilux_dummy_effect)]
    Dummy,
}

impl Effect {
    /// All of them, in report order.
    pub const ALL: [Self; 16 + cfg!(epsilux_dummy_effect) as usize] = [
        Self::AreaLights,
        Self::FreeLights,
        Self::DeltaLights,
        Self::Environment,
        Self::Diffuse,
        Self::Mirror,
        Self::Refraction,
        Self::Glossy,
        Self::Absorption,
        Self::SmoothNormals,
        Self::Lens,
        Self::Textures,
        Self::Cutouts,
        Self::NormalMaps,
        Self::VertexColors,
        Self::Nesting,
        #[cfg(epsilux_dummy_effect)]
        Self::Dummy,
    ];

    /// What people call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::AreaLights => "area lights",
            Self::FreeLights => "free lights",
            Self::DeltaLights => "point lights",
            Self::Environment => "environment",
            Self::Diffuse => "diffuse",
            Self::Mirror => "mirror",
            Self::Refraction => "refraction",
            Self::Glossy => "glossy",
            Self::Absorption => "absorption",
            Self::SmoothNormals => "smooth normals",
            Self::Lens => "lens",
            Self::Textures => "textures",
            Self::Cutouts => "cut-outs",
            Self::NormalMaps => "normal maps",
            Self::VertexColors => "vertex colours",
            Self::Nesting => "nested bodies",
            #[cfg(epsilux_dummy_effect)]
            Self::Dummy => "dummy",
        }
    }

    /// Why it is left out of a scene that has none of it.
    #[must_use]
    pub fn reason_absent(self) -> &'static str {
        match self {
            Self::AreaLights => "no surface emits",
            Self::FreeLights => "no light with an extent stands apart from surfaces",
            Self::DeltaLights => "no light is a point or a single direction",
            Self::Environment => "nothing shines from infinitely far away",
            Self::Diffuse => "no material is diffuse and nothing else",
            Self::Mirror => "no material is a mirror and nothing else",
            Self::Refraction => "no material is clear glass and nothing else",
            Self::Glossy => "no material is rough, layered or mixed",
            Self::Absorption => "no interior absorbs",
            Self::SmoothNormals => "no surface interpolates normals",
            Self::Lens => "the camera is a pinhole",
            Self::Textures => "no picture varies what a surface reflects or emits",
            Self::Cutouts => "every surface is solid",
            Self::NormalMaps => "no material takes normals from a picture",
            Self::VertexColors => "no surface has coloured vertices",
            Self::Nesting => "no body has a priority",
            #[cfg(epsilux_dummy_effect)]
            Self::Dummy => "nobody asks for it",
        }
    }
}

/// A set of effects, plain enough to be a const-generic argument.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effects(pub u32);

impl Effects {
    /// Every effect there is.
    pub const EVERYTHING: Self = Self((1 << Effect::ALL.len()) - 1);

    /// No set: the argument of the kernel that looks at run time what to simulate.
    pub const AT_RUN_TIME: Self = Self(u32::MAX);

    /// The set of some effects.
    #[must_use]
    pub const fn of(effects: &[Effect]) -> Self {
        let (mut bits, mut i) = (0, 0);
        while i < effects.len() {
            bits |= 1 << effects[i] as u8;
            i += 1;
        }
        Self(bits)
    }

    /// Whether the effect is in the set.
    #[inline(always)]
    #[must_use]
    pub const fn has(self, effect: Effect) -> bool {
        self.0 >> (effect as u8) & 1 == 1
    }

    /// The effects of both sets.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The set without an effect.
    #[must_use]
    pub const fn without(self, effect: Effect) -> Self {
        Self(self.0 & !(1 << effect as u8))
    }

    /// The set without the effects of another.
    #[must_use]
    pub const fn minus(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether every effect of `other` is in the set.
    #[must_use]
    pub const fn covers(self, other: Self) -> bool {
        other.0 & !self.0 == 0
    }
}

/// Why an effect is simulated: the first of `count` things that ask for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Need {
    /// What is simulated.
    pub effect: Effect,
    /// The first thing that asks for it, such as `material "Brass"`.
    pub witness: String,
    /// How many things ask for it.
    pub count: usize,
}

/// A transport loop that is compiled: its name and what it simulates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KernelSet {
    /// For reports.
    pub name: &'static str,
    /// What it simulates.
    pub simulates: Effects,
}

/// Effects that cost a kernel nothing: tables decide which lights there are and where camera rays start, and what
/// is infinitely far away is asked only where a ray meets nothing.
const FREE: Effects = Effects::of(&[Effect::DeltaLights, Effect::Lens, Effect::Environment]);

/// The kernels, from smallest to everything; `integrate` compiles one loop for each. One for all that does not vary
/// over surfaces was measured (`cargo xtask instructions`) and does not pay: 0.991 of the instructions of everything
/// on scenes/materials.toml, 1.009 on the still life, where matte has 0.926 on cornell and report 0.946 on hexroom.
pub const KERNELS: [KernelSet; 3] = [
    KernelSet { name: "matte", simulates: FREE.union(Effects::of(&[Effect::AreaLights, Effect::Diffuse])) },
    KernelSet {
        name: "report",
        simulates: FREE.union(Effects::of(&[
            Effect::AreaLights,
            Effect::Diffuse,
            Effect::Mirror,
            Effect::Refraction,
        ])),
    },
    KernelSet { name: "everything", simulates: Effects::EVERYTHING },
];

/// Number of the kernel after those of [`KERNELS`]: one loop that looks at run time what to simulate, so that
/// there is one for every set of effects. It is slower, and what tests compare with.
pub const EXACT: usize = KERNELS.len();

/// An effect that is not simulated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// What is not simulated.
    pub effect: Effect,
    /// Why it cannot matter, such as `light "Fill" has no power`.
    pub reason: String,
}

/// Light that a scene describes and that no sample finds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unseen {
    /// What people call it.
    pub what: &'static str,
    /// Which, and why it is not found.
    pub reason: String,
}

/// A decision that changes samples, though not what they average to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// What is decided, such as `light choice`.
    pub about: &'static str,
    /// What was chosen.
    pub chosen: String,
    /// Why, with the figures that it was decided by.
    pub reason: String,
}

/// Why something is left out that the scene calls for.
pub(super) const ASKED_FOR: &str = "asked for: the picture lacks it";

/// What is simulated, why, by which kernel, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What the scene calls for, in the order of [`Effect::ALL`].
    pub needs: Vec<Need>,
    /// What it does not call for, in the same order.
    pub left_out: Vec<LeftOut>,
    /// What it describes and no sample finds.
    pub unseen: Vec<Unseen>,
    /// How light is looked for.
    pub choices: Vec<Choice>,
    /// What tables are built for.
    pub tables: Effects,
    /// Index into [`KERNELS`], or [`EXACT`].
    pub kernel: usize,
    /// Replications: independent low-discrepancy sequences that take turns, pass by pass.
    pub replications: u32,
    /// How caustics are found.
    pub caustics: Caustics,
    /// How indirect light is found.
    pub indirect: Indirect,
    /// What is left out or approximated on purpose.
    pub shortcuts: Vec<Shortcut>,
    /// Samples of lights at the first vertex that spreads light, at least one.
    pub light_samples: u32,
    /// Branches of a path where the first thing that the camera sees is a mirror or clear glass, at least one.
    pub split: u32,
    /// Scattering events before roulette starts.
    pub roulette: u32,
}

impl Plan {
    /// The effects that the scene calls for.
    #[must_use]
    pub fn effects(&self) -> Effects {
        Effects(self.needs.iter().fold(0, |bits, n| bits | 1 << n.effect as u8))
    }

    /// What asks for the choices of this plan, so that none is left to a pilot.
    #[must_use]
    pub fn algorithms(&self) -> Algorithms {
        let (caustics, unbiased) = self.caustics.mode();
        Algorithms {
            caustics,
            unbiased,
            indirect: self.indirect,
            light_samples: Some(self.light_samples),
            split: Some(self.split),
            roulette: Some(self.roulette),
        }
    }

    /// The kernel that runs.
    #[must_use]
    pub fn kernel(&self) -> KernelSet {
        let exact = || KernelSet { name: "exact", simulates: self.effects() };
        KERNELS.get(self.kernel).copied().unwrap_or_else(exact)
    }

    /// Gives a decision another reason, or adds it.
    pub fn explain(&mut self, about: &'static str, chosen: impl Into<String>, reason: impl Into<String>) {
        let choice = Choice { about, chosen: chosen.into(), reason: reason.into() };
        match self.choices.iter_mut().find(|c| c.about == about) {
            Some(known) => *known = choice,
            None => self.choices.push(choice),
        }
    }

    /// The plan that simulates one effect less: the picture then lacks light that the scene calls for.
    #[must_use]
    pub fn without(&self, effect: Effect) -> Self {
        let mut plan = self.clone();
        let before = plan.needs.len();
        plan.needs.retain(|n| n.effect != effect);
        if plan.needs.len() < before {
            let at = plan.left_out.iter().position(|l| l.effect > effect).unwrap_or(plan.left_out.len());
            plan.left_out.insert(at, LeftOut { effect, reason: ASKED_FOR.into() });
        }
        plan.tables = plan.tables.without(effect);
        if plan.kernel < EXACT {
            plan.kernel = smallest(plan.effects());
        }
        plan
    }

    /// Takes the kernel that was asked for, and what tables are built for it: none for what is `omitted`, whatever
    /// the kernel simulates.
    pub(super) fn run_by(&mut self, mode: EffectsMode, omitted: Effects) {
        let effects = self.effects();
        (self.kernel, self.tables) = match mode {
            EffectsMode::Auto => (smallest(effects), effects),
            EffectsMode::All => (KERNELS.len() - 1, Effects::EVERYTHING.minus(omitted)),
            EffectsMode::Exact => (EXACT, effects),
        };
    }
}

/// The smallest kernel that covers some effects.
fn smallest(effects: Effects) -> usize {
    KERNELS.iter().position(|k| k.simulates.covers(effects)).unwrap_or(KERNELS.len() - 1)
}

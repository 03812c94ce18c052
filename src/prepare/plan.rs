//! The plan: what is simulated, why, and by which kernel.
//!
//! [`Effect`] is the one list. Analysis collects the needs of a scene, each with a witness; the kernel
//! is the smallest that covers them; the guards in the kernels use the same names. Choices (which
//! estimator, which probabilities) change samples and are the same whatever kernel runs; pruning
//! (kernels, tables) changes nothing: a test compares bytes.

use std::fmt;

use super::algorithm::{Caustics, caustics};
use super::fold::fold;
use super::material::{self, Numbers};
use super::{EffectsMode, Options};
use crate::scene::{AlphaMode, Camera, Light, LightKind, MaterialKind, Principled, Scene, Shape, Sides};

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
}

impl Effect {
    /// All of them, in report order.
    pub const ALL: [Self; 15] = [
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
            Self::Diffuse => "no material scatters diffusely",
            Self::Mirror => "no material is a perfect mirror",
            Self::Refraction => "no material transmits light smoothly",
            Self::Glossy => "no material is glossy or layered",
            Self::Absorption => "no interior absorbs",
            Self::SmoothNormals => "no mesh interpolates its normals",
            Self::Lens => "the camera is a pinhole",
            Self::Textures => "no material varies with a picture",
            Self::Cutouts => "every surface is solid",
            Self::NormalMaps => "no material takes normals from a picture",
            Self::VertexColors => "no mesh has coloured vertices",
        }
    }
}

/// A set of effects, plain enough to be a const-generic argument.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effects(pub u32);

impl Effects {
    /// Every effect there is.
    pub const EVERYTHING: Self = Self((1 << Effect::ALL.len()) - 1);

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

/// The kernels, from smallest to everything; `integrate` compiles one loop for each.
pub const KERNELS: [KernelSet; 3] = [
    KernelSet { name: "matte", simulates: Effects::of(&[Effect::AreaLights, Effect::Diffuse]) },
    KernelSet {
        name: "report",
        simulates: Effects::of(&[Effect::AreaLights, Effect::Diffuse, Effect::Mirror, Effect::Refraction]),
    },
    KernelSet { name: "everything", simulates: Effects::EVERYTHING },
];

/// What is simulated, why, and by which kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// What the scene calls for, in the order of [`Effect::ALL`].
    pub needs: Vec<Need>,
    /// Index into [`KERNELS`].
    pub kernel: usize,
    /// Replications: independent low-discrepancy sequences that take turns, pass by pass.
    pub replications: u32,
    /// How caustics are found.
    pub caustics: Caustics,
}

impl Plan {
    /// The effects that the scene calls for.
    #[must_use]
    pub fn effects(&self) -> Effects {
        Effects(self.needs.iter().fold(0, |bits, n| bits | 1 << n.effect as u8))
    }

    /// The kernel that runs.
    #[must_use]
    pub fn kernel(&self) -> KernelSet {
        KERNELS[self.kernel]
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for need in &self.needs {
            write!(f, "{:<14}{:<16}{}", "simulated", need.effect.name(), need.witness)?;
            if need.count > 1 {
                write!(f, " (and {} more)", need.count - 1)?;
            }
            writeln!(f)?;
        }
        let effects = self.effects();
        for effect in Effect::ALL.into_iter().filter(|&e| !effects.has(e)) {
            writeln!(f, "{:<14}{:<16}{}", "left out", effect.name(), effect.reason_absent())?;
        }
        let covers =
            if self.kernel().simulates == effects { "exactly this" } else { "covers all of the above" };
        writeln!(f, "{:<14}{:<16}{covers}", "kernel", self.kernel().name)?;
        if self.caustics != Caustics::Path {
            writeln!(f, "{:<14}{:<16}{}", "caustics", self.caustics.name(), self.caustics.what())?;
        }
        write!(
            f,
            "{:<14}{:<16}independent sequences; their means give the error",
            "replications", self.replications
        )
    }
}

/// Collects needs: the first witness of each effect, and the number of those who ask.
#[derive(Default)]
struct Collector {
    needs: [Option<Need>; Effect::ALL.len()],
}

impl Collector {
    fn ask(&mut self, effect: Effect, witness: impl FnOnce() -> String) {
        let slot = &mut self.needs[effect as usize];
        match slot {
            Some(need) => need.count += 1,
            None => *slot = Some(Need { effect, witness: witness(), count: 1 }),
        }
    }
}

/// Finds what the scene calls for. A material that no object uses, and a light without power, call for
/// nothing.
#[must_use]
pub fn analyse(scene: &Scene, camera: &Camera, options: &Options) -> Plan {
    let mut needs = Collector::default();
    let mut used = vec![false; scene.materials.len()];
    for object in &scene.objects {
        used[object.material.0 as usize] = true;
        if let Shape::Mesh(m) = object.shape
            && !scene.meshes[m.0 as usize].normals.is_empty()
        {
            needs.ask(Effect::SmoothNormals, || format!("object \"{}\"", object.name));
        }
    }
    let folded = fold(scene);
    for (i, material) in scene.materials.iter().enumerate().filter(|(i, _)| used[*i]) {
        let colored = folded.uses[i].colored;
        for effect in material_needs(&folded.kinds[i], colored.is_some()) {
            needs.ask(effect, || format!("material \"{}\"", material.name));
        }
        if let Some(object) = colored {
            needs.ask(Effect::VertexColors, || format!("object \"{}\"", scene.objects[object].name));
        }
    }
    for light in &scene.lights {
        if let Some(effect) = light.needs() {
            needs.ask(effect, || format!("light \"{}\"", light.name));
        }
    }
    if let Some(e) = &scene.environment
        && !e.radiance.is_black()
    {
        needs.ask(Effect::Environment, || format!("environment \"{}\"", e.name));
    }
    if camera.lens.is_some() {
        needs.ask(Effect::Lens, || format!("camera \"{}\"", camera.name));
    }
    let needs: Vec<Need> = needs.needs.into_iter().flatten().collect();
    let effects = Effects(needs.iter().fold(0, |bits, n| bits | 1 << n.effect as u8));
    let everything = KERNELS.len() - 1;
    let kernel = match options.effects {
        EffectsMode::All => everything,
        EffectsMode::Auto => KERNELS.iter().position(|k| k.simulates.covers(effects)).unwrap_or(everything),
    };
    let pixels = u64::from(options.size[0]) * u64::from(options.size[1]);
    let caustics = caustics(scene, &folded, options);
    Plan { needs, kernel, replications: super::replications(pixels), caustics }
}

/// What a folded material calls for, where `colored` says that vertices have colours.
fn material_needs(kind: &MaterialKind, colored: bool) -> Vec<Effect> {
    let mut needs = Vec::new();
    let absorbs = match kind {
        MaterialKind::Diffuse { .. } => {
            needs.push(Effect::Diffuse);
            false
        }
        MaterialKind::Mirror { .. } => {
            needs.push(Effect::Mirror);
            false
        }
        MaterialKind::Glass(g) => {
            needs.push(Effect::Refraction);
            g.absorption.is_some()
        }
        MaterialKind::Light { .. } => false,
        MaterialKind::Principled(p) => {
            needs.extend(principled_needs(p, colored));
            p.absorption.is_some()
        }
    };
    if absorbs {
        needs.push(Effect::Absorption);
    }
    if let Some((_, Sides::Front | Sides::Both)) = kind.emission() {
        needs.push(Effect::AreaLights);
    }
    needs
}

/// What a principled material compiles to decides; the compiler's tests compare the two.
fn principled_needs(p: &Principled, colored: bool) -> Vec<Effect> {
    let numbers = Numbers::from(p);
    let varies = material::varies(p, colored);
    // What varies is compiled at the hit, to all of its lobes.
    let mut needs = vec![if material::is_diffuse(&numbers) {
        Effect::Diffuse
    } else if material::is_smooth_glass(&numbers) && !varies {
        Effect::Refraction
    } else {
        Effect::Glossy
    }];
    let t = &p.textures;
    if material::varies(p, false) || t.emission.is_some() {
        needs.push(Effect::Textures);
    }
    if p.alpha_mode != AlphaMode::Opaque {
        needs.push(Effect::Cutouts);
    }
    if t.normal.is_some() {
        needs.push(Effect::NormalMaps);
    }
    needs
}

trait LightNeeds {
    fn needs(&self) -> Option<Effect>;
}

impl LightNeeds for Light {
    fn needs(&self) -> Option<Effect> {
        let (color, effect) = match self.kind {
            LightKind::Point { intensity, radius } | LightKind::Spot { intensity, radius, .. } => {
                (intensity, if radius > 0.0 { Effect::FreeLights } else { Effect::DeltaLights })
            }
            LightKind::Sun { irradiance, angle } => {
                (irradiance, if angle > 0.0 { Effect::Environment } else { Effect::DeltaLights })
            }
            LightKind::Area { radiance, .. } => (radiance, Effect::FreeLights),
        };
        (!color.is_black()).then_some(effect)
    }
}

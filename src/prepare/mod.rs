//! From a valid scene to what the integrator reads.
//!
//! In: a [`Scene`] that passed [`crate::scene::validate`]. Out: [`Prepared`]: world-space geometry in
//! trees, compiled materials, lights, a camera and the [`Plan`] that says what is simulated and why.
//! Only `prepare` makes a `Prepared`, so whoever holds one holds a scene that can be rendered. All
//! choices are a pure function of scene, options and seed.
//!
//! Nothing here normalises lengths: a scene scaled by a power of two is prepared into the same numbers
//! scaled by it.

mod albedo;
mod algorithm;
mod analyse;
mod camera;
mod casters;
mod choices;
mod cutout;
mod detail;
#[cfg(epsilux_dummy_effect)]
mod dummy;
mod fold;
mod geometry;
mod glow;
mod lights;
mod material;
mod nesting;
mod normal;
mod plan;
mod shortcuts;
mod start;
mod surface;
mod texture;
mod varying;

pub use crate::bsdf::fresnel::Fresnel;
pub use algorithm::{Algorithms, Caustics, CausticsMode, Indirect, MOST_BRANCHES};
pub use analyse::analyse;
pub use camera::{CameraRays, Seen};
pub(crate) use casters::{Casting, Photons};
pub use choices::{ABOUT, ROULETTE_START};
pub(crate) use detail::Detail;
pub use material::{Interior, PreparedMaterial};
pub use nesting::{Inside, Medium};
pub use plan::{Choice, EXACT, Effect, Effects, KERNELS, KernelSet, LeftOut, Need, Plan, Unseen};
pub(crate) use shortcuts::{Kept, Way};
pub use shortcuts::{Omission, Omissions, Shortcut, Shortcuts, shortcuts_of};
pub use surface::Surface;

use glam::DVec3;

use crate::accel::Accel;
use crate::film::FixedPoint;
use crate::light::LightSet;
use crate::scene::{Camera, Scene};

/// What to prepare a scene for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Name of the camera; the scene's first where absent.
    pub camera: Option<String>,
    /// Width and height of the whole picture, pixels, at least 1 each.
    pub size: [u32; 2],
    /// Seed of every random number.
    pub seed: u64,
    /// Which kernel runs.
    pub effects: EffectsMode,
    /// Cap on scattering events: 0 is emission only. None by default: a cap is a shortcut.
    pub max_depth: Option<u32>,
    /// The other shortcuts; none by default.
    pub shortcuts: Shortcuts,
    /// Whether camera rays that leave the scene see nothing, instead of what shines from there.
    pub transparent: bool,
    /// Which estimators run.
    pub algorithms: Algorithms,
}

/// Which kernel runs; the picture is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EffectsMode {
    /// The smallest that covers the scene.
    #[default]
    Auto,
    /// The one that simulates everything, with every table built.
    All,
    /// One that looks at run time which effects the scene has, and simulates exactly those: slower, and of use
    /// where something is left out on purpose, and to tests.
    Exact,
}

/// Why a scene could not be prepared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PrepareError {
    /// No camera has the name that was asked for.
    #[error("no camera is called \"{name}\"; the scene has: {}", .known.join(", "))]
    UnknownCamera {
        /// What was asked for.
        name: String,
        /// What there is.
        known: Vec<String>,
    },
    /// The scene has no camera at all (`scene::complete` adds one).
    #[error("the scene has no camera")]
    NoCamera,
    /// The picture has no pixels, or too many.
    #[error(
        "a picture of {width}x{height} pixels was asked for; each side must be 1 to 65536, and both together at most 2^28 pixels"
    )]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// The number of a shortcut means nothing.
    #[error("{shortcut}: found {found}, expected {expected}")]
    Shortcut {
        /// Its flag.
        shortcut: String,
        /// The number.
        found: f32,
        /// What it should be.
        expected: &'static str,
    },
}

/// A scene ready to be rendered.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// What is simulated, and why.
    pub plan: Plan,
    /// What the kernel simulates.
    pub simulates: Effects,
    /// Everything that blocks light.
    pub accel: Accel,
    /// Everything that emits.
    pub lights: LightSet,
    /// Compiled materials, indexed as in the scene.
    pub materials: Vec<PreparedMaterial>,
    /// Where camera rays start.
    pub camera: CameraRays,
    /// Width and height of the whole picture.
    pub size: [u32; 2],
    /// Seed of every random number.
    pub seed: u64,
    /// Cap on scattering events.
    pub max_depth: Option<u32>,
    /// What shortcuts leave of each contribution of light.
    pub(crate) kept: Kept,
    /// Whether the background counts as transparent.
    pub transparent: bool,
    /// What the camera is in.
    pub start: Medium,
    /// Format of radiance sums.
    pub radiance_format: FixedPoint,
    /// Format of length sums.
    pub length_format: FixedPoint,
    #[cfg(epsilux_dummy_effect)]
    pub(crate) dummy: Option<dummy::Dummy>,
    geometry: geometry::Attributes,
    details: detail::Details,
    /// Whether there is a surface that light may pass without being scattered.
    cutouts: bool,
    object_materials: Vec<u32>,
    /// Where bodies have an order.
    nesting: Option<nesting::Nesting>,
    /// Which lights are told apart where photons are compared with paths.
    pub(crate) apart: lights::Apart,
    /// Where photons start, where they can.
    photons: Option<Box<Photons>>,
}

/// Replications of a picture of this many pixels: independent sequences whose means give the error.
#[must_use]
pub fn replications(pixels: u64) -> u32 {
    if pixels > 4_000_000 { 2 } else { 4 }
}

/// Builds everything that the plan of `scene` calls for, and nothing else.
///
/// # Errors
/// Where the camera, the size or a shortcut that `options` ask for cannot be.
pub fn prepare(scene: &Scene, options: &Options) -> Result<Prepared, PrepareError> {
    prepare_planned(scene, options, plan(scene, options)?)
}

/// The plan for what `options` ask for.
///
/// # Errors
/// As [`prepare`], but for the size.
pub fn plan(scene: &Scene, options: &Options) -> Result<Plan, PrepareError> {
    options.check_shortcuts()?;
    Ok(analyse(scene, camera_of(scene, options)?, options))
}

/// The same for a plan that is at hand: that of [`analyse`], or one that leaves something out on purpose.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_planned(scene: &Scene, options: &Options, plan: Plan) -> Result<Prepared, PrepareError> {
    check_size(options.size)?;
    options.check_shortcuts()?;
    let camera = camera_of(scene, options)?;
    let folded = fold::fold(scene, plan.tables);
    let mut compiler = material::Compiler::new(scene, options.shortcuts.fresnel);
    let materials = compiler.all(&folded);
    let nesting =
        plan.tables.has(Effect::Nesting).then(|| nesting::Nesting::new(scene, &folded, &mut compiler));
    let nesting = nesting.flatten();
    let flat = geometry::flatten(scene, &folded, plan.tables.has(Effect::SmoothNormals));
    let details = detail::Details::new(scene, &folded, &flat, plan.tables.has(Effect::VertexColors));
    let lights = lights::collect(scene, &folded, &flat, &details, &materials, plan.tables);
    let lengths = FixedPoint::around(flat.reach(camera) as f32);
    let radiance_format =
        FixedPoint::around(lights::brightest(&lights, camera.transform.translation, flat.radius));
    let apart = lights::Apart::new(&lights, flat.radius);
    let cutouts = scene.objects.iter().any(|o| materials[o.material.0 as usize].cutout.is_some());
    let lights = lights.into_iter().map(|g| g.emitters).collect();
    let lights = LightSet::new(lights, flat.primitives, flat.radius);
    let all = (flat.middle, flat.radius);
    let casting = (flat.radius > 0.0 && algorithm::photons_can(scene, &folded))
        .then(|| Casting::new(scene, &folded, &flat, &lights));
    let accel = Accel::new(flat.world, flat.meshes, &flat.placements);
    let start = start::medium(scene, &materials, nesting.as_ref(), camera.transform.translation);
    let rays = rays(camera, options.size, &plan);
    let photons = casting.map(|c| Box::new(Photons::new(c, &lights, all, &accel, &rays, options.size)));
    Ok(Prepared {
        #[cfg(epsilux_dummy_effect)]
        dummy: dummy::Dummy::asked().filter(|_| plan.tables.has(Effect::Dummy)),
        simulates: plan.kernel().simulates,
        plan,
        accel,
        lights,
        materials,
        camera: rays,
        size: options.size,
        seed: options.seed,
        max_depth: options.max_depth,
        kept: Kept::new(&options.shortcuts),
        transparent: options.transparent,
        start,
        radiance_format,
        length_format: lengths,
        geometry: flat.attributes,
        details,
        cutouts,
        object_materials: scene.objects.iter().map(|o| o.material.0).collect(),
        nesting,
        apart,
        photons,
    })
}

fn check_size([width, height]: [u32; 2]) -> Result<(), PrepareError> {
    let side = 1..=65_536;
    if !side.contains(&width) || !side.contains(&height) || u64::from(width) * u64::from(height) > 1 << 28 {
        return Err(PrepareError::Size { width, height });
    }
    Ok(())
}

fn rays(camera: &Camera, size: [u32; 2], plan: &Plan) -> CameraRays {
    let rays = CameraRays::new(camera, size);
    if plan.tables.has(Effect::Lens) { rays } else { rays.pinhole() }
}

/// The camera that options ask for.
///
/// # Errors
/// Where there is none.
pub fn camera_of<'a>(scene: &'a Scene, options: &Options) -> Result<&'a Camera, PrepareError> {
    match &options.camera {
        None => scene.cameras.first().ok_or(PrepareError::NoCamera),
        Some(name) => scene.cameras.iter().find(|c| c.name == *name).ok_or_else(|| {
            let known = scene.cameras.iter().map(|c| c.name.clone()).collect();
            PrepareError::UnknownCamera { name: name.clone(), known }
        }),
    }
}

impl Prepared {
    /// The objects of the scene that this was prepared from that enclose a volume with the point `p`, metres,
    /// world space, in it: by index, the outermost first.
    #[must_use]
    pub fn around(&self, scene: &Scene, p: DVec3) -> Vec<usize> {
        start::around(scene, &self.materials, p)
    }

    /// Turns this into what `scene`, which it was prepared from, is for a plan with other choices and a picture of
    /// another size and seed. Tables and kernel stay.
    ///
    /// # Errors
    /// As [`prepare`].
    pub(crate) fn revise(
        &mut self,
        scene: &Scene,
        options: &Options,
        plan: Plan,
    ) -> Result<(), PrepareError> {
        check_size(options.size)?;
        self.camera = rays(camera_of(scene, options)?, options.size, &plan);
        (self.size, self.seed, self.plan) = (options.size, options.seed, plan);
        if let Some(photons) = &mut self.photons {
            photons.aim(&self.lights, &self.accel, &self.camera, self.size);
        }
        Ok(())
    }

    /// What a kernel simulates: its set, or for the one that looks at run time what the plan says.
    #[inline(always)]
    pub(crate) fn simulated<const FX: u32>(&self) -> Effects {
        if FX == Effects::AT_RUN_TIME.0 { self.simulates } else { Effects(FX) }
    }

    /// The material of an object.
    #[inline]
    #[must_use]
    pub fn material_of(&self, object: u32) -> u32 {
        self.object_materials[object as usize]
    }

    /// Where photons start that find caustics; `None` where the plan has none.
    #[inline]
    #[must_use]
    pub(crate) fn casting(&self) -> Option<&Casting> {
        self.photons.as_deref().filter(|_| self.plan.caustics != Caustics::Path).map(|p| &p.casting)
    }

    /// Where photons start that say beside the paths how much light there is; `None` where no light can be traced, or
    /// where it would not say what the picture shows.
    pub(crate) fn second(&self) -> Option<&Photons> {
        self.photons().filter(|_| !self.kept.clamps())
    }

    /// Where photons start; `None` where no light can be traced.
    #[inline]
    #[must_use]
    pub(crate) fn photons(&self) -> Option<&Photons> {
        self.photons.as_deref()
    }

    /// What people call the lights that [`Doubt::LightNotFound`](crate::film::Doubt::LightNotFound) tells apart.
    #[must_use]
    pub fn lights_apart(&self) -> &[String] {
        &self.apart.names
    }
}

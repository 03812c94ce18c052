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
mod camera;
mod casters;
mod cutout;
mod detail;
mod fold;
mod geometry;
mod glow;
mod lights;
mod material;
mod normal;
mod plan;
mod surface;
mod texture;
mod varying;

pub use algorithm::{Algorithms, Caustics, CausticsMode};
pub use camera::{CameraRays, Seen};
pub(crate) use casters::Casting;
pub(crate) use detail::Detail;
pub use material::{Interior, PreparedMaterial};
pub use plan::{Effect, Effects, KERNELS, KernelSet, Need, Plan, analyse};
pub use surface::Surface;

use crate::accel::Accel;
use crate::film::FixedPoint;
use crate::light::LightSet;
use crate::scene::Scene;

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
    /// Cap on scattering events: 0 is emission only. None by default.
    pub max_depth: Option<u32>,
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
    /// The one that simulates everything.
    All,
}

/// Why a scene could not be prepared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
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
}

/// A scene ready to be rendered.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// What is simulated, and why.
    pub plan: Plan,
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
    /// Whether the background counts as transparent.
    pub transparent: bool,
    /// Format of radiance sums.
    pub radiance_format: FixedPoint,
    /// Format of length sums.
    pub length_format: FixedPoint,
    geometry: geometry::Attributes,
    details: detail::Details,
    /// Whether there is a surface that light may pass without being scattered.
    cutouts: bool,
    object_materials: Vec<u32>,
    /// Where photons start, if there are any.
    casting: Option<Box<Casting>>,
}

/// Replications of a picture of this many pixels: independent sequences whose means give the error.
#[must_use]
pub fn replications(pixels: u64) -> u32 {
    if pixels > 4_000_000 { 2 } else { 4 }
}

/// Builds everything that the plan of `scene` calls for.
///
/// # Errors
/// Where the camera or the size that `options` ask for cannot be.
pub fn prepare(scene: &Scene, options: &Options) -> Result<Prepared, PrepareError> {
    let [width, height] = options.size;
    let side = 1..=65_536;
    if !side.contains(&width) || !side.contains(&height) || u64::from(width) * u64::from(height) > 1 << 28 {
        return Err(PrepareError::Size { width, height });
    }
    let camera = match &options.camera {
        None => scene.cameras.first().ok_or(PrepareError::NoCamera)?,
        Some(name) => scene.cameras.iter().find(|c| c.name == *name).ok_or_else(|| {
            let known = scene.cameras.iter().map(|c| c.name.clone()).collect();
            PrepareError::UnknownCamera { name: name.clone(), known }
        })?,
    };
    let plan = analyse(scene, camera, options);
    let folded = fold::fold(scene);
    let materials = material::compile(scene, &folded);
    let flat = geometry::flatten(scene, &folded);
    let details = detail::Details::new(scene, &folded, &flat);
    let lights = lights::collect(scene, &folded, &flat, &details, &materials);
    let lengths = FixedPoint::around(flat.reach(camera) as f32);
    let radiance_format =
        FixedPoint::around(lights::brightest(&lights, camera.transform.translation, flat.radius));
    let cutouts = scene.objects.iter().any(|o| materials[o.material.0 as usize].cutout.is_some());
    let lights = LightSet::new(lights, flat.primitives, flat.radius);
    let casting =
        (plan.caustics != Caustics::Path).then(|| Box::new(Casting::new(scene, &folded, &flat, &lights)));
    let accel = Accel::new(flat.world, flat.meshes, &flat.placements);
    Ok(Prepared {
        plan,
        accel,
        lights,
        materials,
        camera: CameraRays::new(camera, options.size),
        size: options.size,
        seed: options.seed,
        max_depth: options.max_depth,
        transparent: options.transparent,
        radiance_format,
        length_format: lengths,
        geometry: flat.attributes,
        details,
        cutouts,
        object_materials: scene.objects.iter().map(|o| o.material.0).collect(),
        casting,
    })
}

impl Prepared {
    /// The material of an object.
    #[inline]
    #[must_use]
    pub fn material_of(&self, object: u32) -> u32 {
        self.object_materials[object as usize]
    }

    /// Where photons start; `None` where the plan has none.
    #[inline]
    #[must_use]
    pub(crate) fn casting(&self) -> Option<&Casting> {
        self.casting.as_deref()
    }
}

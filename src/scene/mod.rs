//! The one scene description: plain data that knows neither files nor rays.
//!
//! In: what an importer or the text form understood. Out: what `prepare` flattens into tables.
//! Everything odd about a file format is resolved before it becomes a [`Scene`]; nothing after it
//! opens an input file. A scene is valid once [`validate`] has passed it.
//!
//! Space is right-handed with +Y up, lengths are metres, powers watts, colours linear Rec. 709.

mod camera;
mod defaults;
pub(crate) mod extension;
mod hash;
mod image;
mod light;
mod material;
mod mesh;
mod note;
pub(crate) mod notes;
mod pictures;
mod repair;
pub(crate) mod tangents;
pub mod text;
mod texture;
mod validate;

pub use camera::{Camera, FovAxis, Lens, Projection};
pub use defaults::{DEFAULT_CAMERA, DEFAULT_DOME, complete};
pub use hash::sha256;
pub use image::{Encoded, Image, ImageFormat, ImageId, Pixels, Texels};
pub use light::{AreaShape, Environment, EnvironmentImage, Light, LightKind, SpotFalloff};
pub use material::{
    Absorption, AlphaMode, Body, Glass, MAX_BODIES, Material, MaterialKind, Principled, Sides,
};
pub use mesh::Mesh;
pub use note::{Effect as NoteEffect, Note};
pub use texture::{Channel, Filter, NormalTexture, ScalarTexture, Texture, Textures, Wrap};
pub use validate::{MAX_INDIRECT_GAIN, MAX_LENGTH, MAX_RADIANCE, MAX_SIDE, MIN_LENGTH, SceneError, validate};

use glam::DAffine3;

/// Index into [`Scene::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// Index into [`Scene::meshes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeshId(pub u32);

/// Everything that is rendered, and hints about how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// One line for people.
    pub title: String,
    /// Materials; names are unique.
    pub materials: Vec<Material>,
    /// Pictures, each usable by any number of textures.
    pub images: Vec<Image>,
    /// Meshes, each usable by any number of objects.
    pub meshes: Vec<Mesh>,
    /// Shapes placed in the world. Their order decides ties between coincident surfaces.
    pub objects: Vec<Object>,
    /// Lights that are not surfaces: they emit, and never block a ray.
    pub lights: Vec<Light>,
    /// Cameras; the first is used where none is asked for. Names are unique.
    pub cameras: Vec<Camera>,
    /// What is seen where nothing is hit; black where absent.
    pub environment: Option<Environment>,
    /// Hints that flags override.
    pub settings: Settings,
}

/// A shape placed in the world, with a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// For people and error messages; need not be unique.
    pub name: String,
    /// What it is, in its own space.
    pub shape: Shape,
    /// What it is made of.
    pub material: MaterialId,
    /// Own space to world space. For a sphere: rotation, uniform scale and translation only.
    pub transform: DAffine3,
    /// Whether camera rays see it; reflections, refractions and shadows always do.
    pub visible_to_camera: bool,
}

/// The geometry of an [`Object`], in its own space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A triangle mesh.
    Mesh(MeshId),
    /// An exact sphere about the origin.
    Sphere {
        /// Metres, own space, (0, inf).
        radius: f64,
    },
}

/// How the author would like the scene rendered; every one of these has a flag that wins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Image width and height in pixels.
    pub size: Option<[u32; 2]>,
    /// Samples per pixel.
    pub spp: Option<u32>,
    /// Exposure in stops, applied to pictures for a screen and never to EXR or HDR.
    pub exposure: Option<f32>,
    /// Tone curve of pictures for a screen.
    pub tone: Option<ToneCurve>,
    /// Cap on scattering events; none where absent.
    pub max_depth: Option<u32>,
    /// Factor on light that was spread more than once, 0 to [`MAX_INDIRECT_GAIN`]; one where absent, as physics has
    /// it.
    pub indirect_gain: Option<f32>,
}

/// How linear radiance becomes a picture for a screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneCurve {
    /// The sRGB transfer function; what is brighter than one clips.
    #[default]
    Srgb,
    /// AgX: highlights lose saturation and roll off, as in Blender.
    Agx,
    /// Khronos PBR Neutral: keeps base colours, rolls off highlights only.
    Neutral,
    /// Square root of the value, as in the report.
    Sqrt,
    /// The value itself.
    Linear,
}

//! Lights that are not surfaces, and the environment.
//!
//! They emit and never block a ray, as in Blender: a ray that meets an area light gathers its
//! radiance and goes on. Surfaces that emit are materials (see [`super::MaterialKind::emission`]).

use glam::DAffine3;

use super::ImageId;
use crate::color::Rgb;

/// A light placed in the world; it shines along its own -Z, with +Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// For people and error messages; need not be unique.
    pub name: String,
    /// What it emits, in its own space.
    pub kind: LightKind,
    /// Own space to world space.
    pub transform: DAffine3,
    /// Whether camera rays see it, where it has an extent; reflections and refractions always do.
    pub visible_to_camera: bool,
}

/// The kinds of light. Extents are in the light's own space, so a scaled node scales them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Shines equally in all directions.
    Point {
        /// Radiant intensity, W sr^-1, [0, inf).
        intensity: Rgb,
        /// Metres; above zero it is a sphere of radiance intensity / (pi r^2).
        radius: f64,
    },
    /// Shines into a cone about -Z.
    Spot {
        /// Radiant intensity on the axis, W sr^-1, [0, inf).
        intensity: Rgb,
        /// Half angle where the falloff begins, radians, [0, `outer`].
        inner: f64,
        /// Half angle where the light ends, radians, (0, pi/2].
        outer: f64,
        /// The curve between the two.
        falloff: SpotFalloff,
        /// Metres; above zero it is a sphere, as for a point light.
        radius: f64,
    },
    /// Parallel light from infinitely far away, along -Z.
    Sun {
        /// Irradiance on a plane that faces it, W m^-2, [0, inf).
        irradiance: Rgb,
        /// Full angle of its disk, radians, [0, pi); zero casts perfectly sharp shadows.
        angle: f64,
    },
    /// A flat, one-sided Lambertian emitter in its own xy plane, shining towards -Z.
    Area {
        /// Outline.
        shape: AreaShape,
        /// Full extent along own x and y, metres, (0, inf).
        size: [f64; 2],
        /// Emitted radiance, W sr^-1 m^-2, [0, inf).
        radiance: Rgb,
    },
}

/// Outline of an area light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AreaShape {
    /// A rectangle.
    #[default]
    Rectangle,
    /// An ellipse; a disk where both sizes agree.
    Ellipse,
}

/// How a spot light fades between its inner and its outer half angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpotFalloff {
    /// Square of the ramp in the cosine (`KHR_lights_punctual`).
    #[default]
    Gltf,
    /// Smoothstep over the ramp, whose inner cosine is cos(outer) + (1 - cos(outer)) * (1 - inner/outer),
    /// as Cycles has it.
    Blender,
}

/// What is seen where a ray hits nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// For people.
    pub name: String,
    /// Radiance from every direction, W sr^-1 m^-2, [0, inf); a factor where there is an image.
    pub radiance: Rgb,
    /// A picture of all directions.
    pub image: Option<EnvironmentImage>,
    /// Whether camera rays see it.
    pub visible_to_camera: bool,
}

/// A picture of all directions: longitude and latitude (equirectangular), top row straight up (+Y).
///
/// Without rotation its middle is seen along -Z, and +X to the right of it: direction d has
/// u = 1/2 + atan2(d.x, -d.z) / (2 pi) and v = acos(d.y) / pi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentImage {
    /// The picture; integers in it are sRGB.
    pub image: ImageId,
    /// Radians by which everything is turned about +Y, counter-clockwise seen from above.
    pub rotation: f64,
}

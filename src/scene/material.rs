//! Materials: the report's four, and one principled material for everything else.

use super::Textures;
use crate::color::Rgb;

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Unique in the scene.
    pub name: String,
    /// What it does to light.
    pub kind: MaterialKind,
}

/// What a material does to light.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Lambert's reflector, on both sides.
    Diffuse {
        /// Reflectance, [0, 1].
        color: Rgb,
    },
    /// A perfect mirror without Fresnel, on both sides.
    Mirror {
        /// Reflectance, [0, 1].
        color: Rgb,
    },
    /// A smooth dielectric; the front side is outside.
    Glass(Glass),
    /// A black surface that emits.
    Light {
        /// Emitted radiance, W sr^-1 m^-2, [0, inf).
        radiance: Rgb,
        /// Which sides emit.
        sides: Sides,
    },
    /// glTF's metallic-roughness material, layered as Blender layers it.
    Principled(Box<Principled>),
}

/// Which sides of a surface emit; the front is where triangles wind counter-clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// The front only.
    #[default]
    Front,
    /// Both.
    Both,
}

/// A smooth dielectric with exact Fresnel reflection.
#[derive(Clone, Debug, PartialEq)]
pub struct Glass {
    /// Index of refraction against the medium outside, [1, inf) in practice, (0, inf) allowed.
    pub ior: f32,
    /// Factor on each refraction event, [0, 1]; reflections are not tinted.
    pub tint: Rgb,
    /// What the inside absorbs.
    pub absorption: Option<Absorption>,
    /// Which of the bodies that overlap or touch is there: see [`Body`]. None: an interface against
    /// whatever is outside, as Blender has it.
    pub priority: Option<u8>,
}

/// Absorption along the way through a medium, as Beer and Lambert have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Absorption {
    /// Transmittance after `distance`, (0, 1].
    pub color: Rgb,
    /// Metres, (0, inf).
    pub distance: f32,
}

/// glTF 2.0's metallic-roughness material with transmission, ior, specular, volume, emission,
/// clearcoat and sheen.
///
/// Layers, from the top: sheen, coat, then a dielectric specular layer over diffuse or transmission,
/// mixed with metal. A lower layer receives what the directional albedo of the one above leaves; the
/// coat dims emission too.
#[derive(Clone, Debug, PartialEq)]
pub struct Principled {
    /// Diffuse reflectance, or the metal's reflectance at normal incidence, [0, 1].
    pub base_color: Rgb,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// Perceptual roughness [0, 1]; the GGX width is its square.
    pub roughness: f32,
    /// Index of refraction of the dielectric, [1, inf); 1 has no specular reflection.
    pub ior: f32,
    /// Strength of the dielectric's specular reflection: a factor on F0, [0, 1].
    pub specular: f32,
    /// Tint of the dielectric's specular reflection: a factor on F0, [0, inf).
    pub specular_color: Rgb,
    /// Share of light that is transmitted instead of scattered diffusely, [0, 1].
    pub transmission: f32,
    /// Factor on each refraction event, [0, 1]. It takes part in what varies the base colour: texel and
    /// vertex colour multiply it too, by their square root where a body is entered and left (Cycles tints
    /// each interface so), as they are where a sheet is passed.
    pub transmission_tint: Rgb,
    /// True where transmission passes a sheet without bending: the surface encloses no volume.
    pub thin: bool,
    /// What the inside absorbs.
    pub absorption: Option<Absorption>,
    /// As [`Glass::priority`], where light is transmitted into a volume.
    pub priority: Option<u8>,
    /// Emitted radiance on both sides, W sr^-1 m^-2, [0, inf).
    pub emission: Rgb,
    /// Coverage, [0, 1], where `alpha_mode` looks at it: the rest of the light passes straight through.
    pub alpha: f32,
    /// What alpha does.
    pub alpha_mode: AlphaMode,
    /// Weight of a clear dielectric coat, [0, 1].
    pub coat: f32,
    /// Perceptual roughness of the coat, [0, 1].
    pub coat_roughness: f32,
    /// Index of refraction of the coat, [1, inf).
    pub coat_ior: f32,
    /// Reflectance of a layer of fibres, [0, 1]; black has no sheen.
    pub sheen_color: Rgb,
    /// Perceptual roughness of the sheen, [0, 1].
    pub sheen_roughness: f32,
    /// What multiplies the numbers and colours above; products that have to be fractions are clamped to
    /// [0, 1].
    pub textures: Textures,
}

/// What alpha does. Light that passes is not scattered: it goes straight on, shadow rays too, and no
/// depth is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Nothing: the surface is solid.
    #[default]
    Opaque,
    /// The surface is there where alpha reaches the cut-off, and not there elsewhere.
    Mask {
        /// [0, 1].
        cutoff: f32,
    },
    /// A share alpha of the surface is there.
    Blend,
}

impl Default for Principled {
    /// White, rough, not metallic, ior 1.5: the defaults of Blender's and this program's text form
    /// (glTF's own default, metallic 1, is resolved by the importer).
    fn default() -> Self {
        Self {
            base_color: Rgb::WHITE,
            metallic: 0.0,
            roughness: 0.5,
            ior: 1.5,
            specular: 1.0,
            specular_color: Rgb::WHITE,
            transmission: 0.0,
            transmission_tint: Rgb::WHITE,
            thin: false,
            absorption: None,
            priority: None,
            emission: Rgb::BLACK,
            alpha: 1.0,
            alpha_mode: AlphaMode::Opaque,
            coat: 0.0,
            coat_roughness: 0.0,
            coat_ior: 1.5,
            sheen_color: Rgb::BLACK,
            sheen_roughness: 0.5,
            textures: Textures::default(),
        }
    }
}

/// The inside of surfaces whose material has a priority.
///
/// Where several such bodies overlap, the one of the highest priority is there, and of equal ones that whose
/// material comes last in the scene; where there is none, there is vacuum, of index one. Surfaces within
/// what is there anyway are not there, and the others are interfaces between what is there on both sides
/// (C. M. Schmidt and B. Budge, "Simple Nested Dielectrics in Ray Traced Images", JGT 7(2), 2002). Bodies that
/// touch have one interface, between the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The higher one is there.
    pub priority: u8,
    /// Index of refraction, of the inside itself, (0, inf).
    pub ior: f32,
    /// What the inside absorbs.
    pub absorption: Option<Absorption>,
}

/// The largest number of materials with a [`Body`] in a scene.
pub const MAX_BODIES: usize = 16;

impl MaterialKind {
    /// The body that surfaces of the material enclose, where they take part in the order of priorities.
    #[must_use]
    pub fn body(&self) -> Option<Body> {
        let (priority, ior, absorption) = match self {
            Self::Glass(g) => (g.priority?, g.ior, g.absorption),
            Self::Principled(p) if !p.thin && p.transmission > 0.0 => (p.priority?, p.ior, p.absorption),
            Self::Principled(_) | Self::Diffuse { .. } | Self::Mirror { .. } | Self::Light { .. } => {
                return None;
            }
        };
        Some(Body { priority, ior, absorption })
    }

    /// Emitted radiance and the emitting sides, where the material emits at all.
    #[must_use]
    pub fn emission(&self) -> Option<(Rgb, Sides)> {
        let (radiance, sides) = match self {
            Self::Light { radiance, sides } => (*radiance, *sides),
            Self::Principled(p) => (p.emission, Sides::Both),
            Self::Diffuse { .. } | Self::Mirror { .. } | Self::Glass(_) => return None,
        };
        (!radiance.is_black()).then_some((radiance, sides))
    }
}

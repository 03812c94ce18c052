//! Textures: which picture a material's property is multiplied with, and how it lies on the surface.

use super::ImageId;

/// A picture laid over a surface by its texture coordinates.
///
/// Texture coordinates (u, v) go through the transform as in `KHR_texture_transform`: scaled, then
/// rotated, then moved. (0, 0) is then the top left corner of the picture and (1, 1) the bottom right;
/// texel i of w has its middle at (i + 1/2) / w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    /// The picture.
    pub image: ImageId,
    /// Which set of the mesh's texture coordinates, 0 or 1.
    pub uv_set: u8,
    /// Added last, in pictures.
    pub offset: [f32; 2],
    /// Radians, as in `KHR_texture_transform`: (u, v) becomes (c u + s v, c v - s u).
    pub rotation: f32,
    /// Multiplied first.
    pub scale: [f32; 2],
    /// What lies beyond the picture's left and right, and beyond its top and bottom.
    pub wrap: [Wrap; 2],
    /// What lies between texels.
    pub filter: Filter,
}

impl Texture {
    /// The whole picture over the unit square of the first set, repeated.
    #[must_use]
    pub fn new(image: ImageId) -> Self {
        Self {
            image,
            uv_set: 0,
            offset: [0.0; 2],
            rotation: 0.0,
            scale: [1.0; 2],
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Linear,
        }
    }
}

/// What lies beyond the edge of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored, then again.
    Mirror,
    /// The texels of its edge.
    Clamp,
}

/// What lies between the middles of texels. Linear filtering is done after decoding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// Bilinear interpolation of the four nearest.
    #[default]
    Linear,
    /// The nearest.
    Nearest,
}

/// One channel of a picture, as data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarTexture {
    /// The picture and how it lies.
    pub texture: Texture,
    /// Which channel counts.
    pub channel: Channel,
}

/// A channel of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Red; grey pictures have the same in all three.
    #[default]
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha.
    A,
}

/// A tangent-space normal map: texel t means the normal (2t - 1) with x and y times `scale`, in the
/// frame of the mesh's tangent, bitangent and normal (+y is up in the picture, as in glTF).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalTexture {
    /// The picture, as data.
    pub texture: Texture,
    /// Strength, (-inf, inf); 1 is as painted.
    pub scale: f32,
}

/// The textures of a principled material; each multiplies the number or colour of the same name.
/// Colours are encoded in sRGB where the picture's texels are integers, all else is linear data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Textures {
    /// Red, green and blue.
    pub base_color: Option<Texture>,
    /// Coverage.
    pub alpha: Option<ScalarTexture>,
    /// 0 dielectric, 1 metal.
    pub metallic: Option<ScalarTexture>,
    /// Perceptual roughness.
    pub roughness: Option<ScalarTexture>,
    /// Normals.
    pub normal: Option<NormalTexture>,
    /// Emitted radiance, as a factor.
    pub emission: Option<Texture>,
    /// Strength of the dielectric's specular reflection.
    pub specular: Option<ScalarTexture>,
    /// Tint of the dielectric's specular reflection.
    pub specular_color: Option<Texture>,
    /// Share of light that is transmitted.
    pub transmission: Option<ScalarTexture>,
    /// Weight of the coat.
    pub coat: Option<ScalarTexture>,
    /// Perceptual roughness of the coat.
    pub coat_roughness: Option<ScalarTexture>,
    /// Normals of the coat. Not rendered yet: the coat follows the normals of the rest.
    pub coat_normal: Option<NormalTexture>,
    /// Colour of the sheen.
    pub sheen_color: Option<Texture>,
    /// Perceptual roughness of the sheen.
    pub sheen_roughness: Option<ScalarTexture>,
}

impl Textures {
    /// Every texture that is set, with the key of its slot, in the order of the fields.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &Texture)> {
        [
            ("base_color", self.base_color.as_ref()),
            ("alpha", self.alpha.as_ref().map(|t| &t.texture)),
            ("metallic", self.metallic.as_ref().map(|t| &t.texture)),
            ("roughness", self.roughness.as_ref().map(|t| &t.texture)),
            ("normal", self.normal.as_ref().map(|t| &t.texture)),
            ("emission", self.emission.as_ref()),
            ("specular", self.specular.as_ref().map(|t| &t.texture)),
            ("specular_color", self.specular_color.as_ref()),
            ("transmission", self.transmission.as_ref().map(|t| &t.texture)),
            ("coat", self.coat.as_ref().map(|t| &t.texture)),
            ("coat_roughness", self.coat_roughness.as_ref().map(|t| &t.texture)),
            ("coat_normal", self.coat_normal.as_ref().map(|t| &t.texture)),
            ("sheen_color", self.sheen_color.as_ref()),
            ("sheen_roughness", self.sheen_roughness.as_ref().map(|t| &t.texture)),
        ]
        .into_iter()
        .filter_map(|(key, texture)| texture.map(|t| (key, t)))
    }

    /// The textures that are set, to be changed; in no particular order.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Texture> {
        let colors =
            [&mut self.base_color, &mut self.emission, &mut self.specular_color, &mut self.sheen_color];
        let scalars = [
            &mut self.alpha,
            &mut self.metallic,
            &mut self.roughness,
            &mut self.specular,
            &mut self.transmission,
            &mut self.coat,
            &mut self.coat_roughness,
            &mut self.sheen_roughness,
        ];
        let normals = [&mut self.normal, &mut self.coat_normal];
        let scalars = scalars.into_iter().flatten().map(|s| &mut s.texture);
        let normals = normals.into_iter().flatten().map(|n| &mut n.texture);
        colors.into_iter().flatten().chain(scalars).chain(normals)
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.iter().next().is_none()
    }
}

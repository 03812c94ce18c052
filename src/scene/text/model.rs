//! The tables of a scene file, as serde reads them and as the JSON Schema describes them.
//!
//! In: TOML or JSON. Out: a [`Document`], which `expand` turns into a scene. Of the kinds of a material,
//! object or light each is an optional key, and exactly one is given; `expand` checks that. (An enum
//! would lose the line and column of errors inside it.) Doc comments here are what editors show.

use schemars::JsonSchema;
use serde::Deserialize;

use super::names::{AlphaWord, Word};
use super::up::Up;
use super::value::{Angle, Color, Expected, NameOr, Named, OneOrTwo, Placement, Rotation, fixed};
use crate::scene::{AreaShape, Channel, Filter, FovAxis, Sides, SpotFalloff, ToneCurve, Wrap};

/// A scene for epsilux. Lengths are metres, colours linear Rec. 709, radiance is in W sr^-1 m^-2.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a scene")]
#[schemars(title = "epsilux scene")]
pub(super) struct Document {
    /// Where editors find this schema; without effect.
    #[serde(rename = "$schema")]
    #[schemars(rename = "$schema")]
    pub(super) _schema: Option<String>,
    /// Version of the form; marks the file as a scene.
    #[schemars(extend("const" = 1))]
    pub(super) epsilux: u32,
    /// One line for people.
    #[serde(default)]
    pub(super) title: String,
    /// The axis that points up in this file: "y" where left out.
    #[serde(default)]
    pub(super) up: Word<Up>,
    /// How the author would like it rendered; flags win.
    #[serde(default)]
    pub(super) render: RenderTable,
    /// Cameras by name; the first is used where none is asked for.
    #[serde(default)]
    pub(super) camera: Named<CameraTable>,
    /// Pictures that textures and the environment use, by name.
    #[serde(default)]
    pub(super) image: Named<NameOr<ImageTable>>,
    /// Materials by name.
    #[serde(default)]
    pub(super) material: Named<MaterialTable>,
    /// Meshes that several objects may share, by name.
    #[serde(default)]
    pub(super) mesh: Named<MeshTable>,
    /// Shapes placed in the world.
    #[serde(default)]
    pub(super) object: Vec<ObjectTable>,
    /// Lights that are not surfaces: they emit, and never block a ray.
    #[serde(default)]
    pub(super) light: Vec<LightTable>,
    /// What is seen where nothing is hit.
    pub(super) environment: Option<EnvironmentTable>,
}

/// How the author would like the scene rendered.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table of render settings")]
pub(super) struct RenderTable {
    /// Width and height in pixels.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) size: Option<[u32; 2]>,
    /// Samples per pixel.
    pub(super) spp: Option<u32>,
    /// Exposure in stops, for PNG and BMP only.
    pub(super) exposure: Option<f32>,
    /// Tone curve, for PNG and BMP only.
    pub(super) tone: Option<Word<ToneCurve>>,
    /// Cap on the number of times that light scatters.
    pub(super) max_depth: Option<u32>,
    /// Factor on light that diffuse or rough surfaces scattered more than once; physics has 1.
    pub(super) indirect_gain: Option<f32>,
}

/// A camera: `eye` and `target`, or `transform`; and `fov` or `orthographic`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a camera")]
#[schemars(extend("oneOf" = [{ "required": ["fov"] }, { "required": ["orthographic"] }]))]
pub(super) struct CameraTable {
    /// Where it stands.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) eye: Option<[f64; 3]>,
    /// What is in the middle of the picture.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) target: Option<[f64; 3]>,
    /// What is up in the picture; the scene's up where left out.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) up: Option<[f64; 3]>,
    /// Instead of eye and target: camera space to world space; it looks along -Z with +Y up.
    pub(super) transform: Option<Placement>,
    /// Full angle of view over the side named by fov_axis, degrees.
    pub(super) fov: Option<Angle>,
    /// Instead of fov: full extent of what is seen over the side named by fov_axis, metres.
    pub(super) orthographic: Option<f64>,
    /// "horizontal" where left out.
    #[serde(default)]
    pub(super) fov_axis: Word<FovAxis>,
    /// Shift of the picture to the right and up, in units of the side named by fov_axis.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) shift: [f64; 2],
    /// Depth of field.
    pub(super) lens: Option<LensTable>,
    /// Width over height, used where no size is given.
    pub(super) aspect: Option<f64>,
}

/// A thin lens.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a lens: { radius, focus }")]
pub(super) struct LensTable {
    /// Radius of the aperture, metres.
    pub(super) radius: f64,
    /// Distance of what is sharp, along the view axis, metres.
    pub(super) focus: f64,
}

/// A picture in a file of its own.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a picture: { file }")]
pub(super) struct ImageTable {
    /// For people; the table's own name where left out.
    pub(super) name: Option<String>,
    /// Where it lies, below the scene's folder.
    pub(super) file: String,
}

impl Expected for ImageTable {
    const EXPECTED: &'static str = "the file of a picture, such as \"wood.png\", or { file = \"wood.png\" }";
}

/// A picture laid over a surface: its `image` by name, or its `file`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "a texture: { image } or { file }")]
#[schemars(extend("oneOf" = [{ "required": ["image"] }, { "required": ["file"] }]))]
pub(super) struct TextureTable {
    /// Name of a picture of the table `image`.
    pub(super) image: Option<String>,
    /// Instead of image: where the picture lies, below the scene's folder.
    pub(super) file: Option<String>,
    /// Which set of the mesh's texture coordinates, 0 (uvs) or 1 (uvs2); 0 where left out.
    pub(super) uv_set: u8,
    /// Added to the texture coordinates last, in pictures.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) offset: Option<[f32; 2]>,
    /// Degrees by which the picture is turned clockwise about its top left corner.
    pub(super) rotation: Option<Angle>,
    /// Factor on the texture coordinates, or one for each; 2 shows the picture twice as often.
    pub(super) scale: Option<OneOrTwo<f32>>,
    /// What lies beyond the edges, or beyond left and right, then top and bottom; "repeat" where left out.
    pub(super) wrap: Option<OneOrTwo<Word<Wrap>>>,
    /// What lies between texels; "linear" where left out.
    pub(super) filter: Word<Filter>,
    /// Of textures that stand for a number: which channel counts; "a" for alpha, else "r" where left out.
    pub(super) channel: Option<Word<Channel>>,
    /// Of normal maps: factor on their slope; 1 where left out.
    pub(super) strength: Option<f32>,
}

impl Expected for TextureTable {
    const EXPECTED: &'static str = "the name of an image, or a table such as { image, scale } or { file }";
}

/// A material: exactly one of diffuse, mirror, glass, light, principled.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a material such as { diffuse = [0.8, 0.8, 0.8] }")]
#[schemars(extend("oneOf" = [{ "required": ["diffuse"] }, { "required": ["mirror"] }, { "required": ["glass"] },
    { "required": ["light"] }, { "required": ["principled"] }]))]
pub(super) struct MaterialTable {
    /// Lambert's reflector: its reflectance, 0 to 1.
    pub(super) diffuse: Option<Color>,
    /// A perfect mirror: its reflectance, 0 to 1.
    pub(super) mirror: Option<Color>,
    /// A smooth dielectric.
    pub(super) glass: Option<GlassTable>,
    /// A black surface that emits this radiance.
    pub(super) light: Option<Color>,
    /// Which sides of a light emit; "front" where left out.
    pub(super) sides: Option<Word<Sides>>,
    /// Metal, plastic, rough glass and what lies between, as in glTF.
    pub(super) principled: Option<PrincipledTable>,
}

/// A smooth dielectric; `{}` is clear glass.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "glass such as { ior = 1.5, tint = [1, 1, 1] }")]
pub(super) struct GlassTable {
    /// Index of refraction; 1.5 where left out.
    pub(super) ior: Option<f32>,
    /// Factor on each refraction, 0 to 1; reflections are not tinted.
    pub(super) tint: Option<Color>,
    /// What the inside absorbs.
    pub(super) absorption: Option<AbsorptionTable>,
    /// Where bodies overlap or touch, the one of the highest priority is there, 0 to 255. Where left out,
    /// the surface is an interface against whatever is outside, as in Blender.
    pub(super) priority: Option<u8>,
}

/// Absorption along the way.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "absorption: { color, distance }")]
pub(super) struct AbsorptionTable {
    /// What is left of white light after `distance`, above 0 and up to 1.
    pub(super) color: Color,
    /// Metres.
    pub(super) distance: f32,
}

/// glTF's metallic-roughness material with transmission, ior, specular, volume, emission, alpha, coat and
/// sheen. A texture multiplies the number or colour of its name.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a principled material such as { base_color, metallic, roughness }")]
pub(super) struct PrincipledTable {
    /// Diffuse reflectance, or the metal's reflectance seen straight on, 0 to 1; white where left out.
    pub(super) base_color: Option<Color>,
    /// 0 dielectric, 1 metal; 0 where left out.
    pub(super) metallic: Option<f32>,
    /// 0 polished to 1 matt; 0.5 where left out.
    pub(super) roughness: Option<f32>,
    /// Index of refraction; 1.5 where left out.
    pub(super) ior: Option<f32>,
    /// Strength of the dielectric's reflection, 0 to 1; 1 where left out.
    pub(super) specular: Option<f32>,
    /// Tint of the dielectric's reflection; white where left out.
    pub(super) specular_color: Option<Color>,
    /// Share of light that passes instead of scattering, 0 to 1; 0 where left out.
    pub(super) transmission: Option<f32>,
    /// Factor on each refraction, 0 to 1; white where left out.
    pub(super) transmission_tint: Option<Color>,
    /// True for a sheet that encloses no volume and does not bend light.
    pub(super) thin: Option<bool>,
    /// What the inside absorbs.
    pub(super) absorption: Option<AbsorptionTable>,
    /// Where bodies overlap or touch, the one of the highest priority is there, 0 to 255. Where left out,
    /// the surface is an interface against whatever is outside, as in Blender.
    pub(super) priority: Option<u8>,
    /// Emitted radiance; black where left out.
    pub(super) emission: Option<Color>,
    /// How much of the surface is there, 0 to 1; 1 where left out.
    pub(super) alpha: Option<f32>,
    /// What alpha does. Where left out: "mask" if there is a cutoff, "blend" if there is an alpha or a
    /// texture of it, else "opaque".
    pub(super) alpha_mode: Option<Word<AlphaWord>>,
    /// Of alpha_mode "mask": the alpha from which the surface is there; 0.5 where left out.
    pub(super) cutoff: Option<f32>,
    /// Weight of a clear coat, 0 to 1; 0 where left out.
    pub(super) coat: Option<f32>,
    /// Roughness of the coat, 0 to 1; 0 where left out.
    pub(super) coat_roughness: Option<f32>,
    /// Index of refraction of the coat; 1.5 where left out.
    pub(super) coat_ior: Option<f32>,
    /// Reflectance of a layer of fibres, 0 to 1; black where left out.
    pub(super) sheen_color: Option<Color>,
    /// Roughness of the sheen, 0 to 1; 0.5 where left out.
    pub(super) sheen_roughness: Option<f32>,
    /// Picture for base_color.
    pub(super) base_color_texture: Option<NameOr<TextureTable>>,
    /// Picture for alpha.
    pub(super) alpha_texture: Option<NameOr<TextureTable>>,
    /// Picture for metallic.
    pub(super) metallic_texture: Option<NameOr<TextureTable>>,
    /// Picture for roughness.
    pub(super) roughness_texture: Option<NameOr<TextureTable>>,
    /// Normal map (+y is up in the picture) of everything but the coat.
    pub(super) normal_texture: Option<NameOr<TextureTable>>,
    /// Picture for emission.
    pub(super) emission_texture: Option<NameOr<TextureTable>>,
    /// Picture for specular.
    pub(super) specular_texture: Option<NameOr<TextureTable>>,
    /// Picture for specular_color.
    pub(super) specular_color_texture: Option<NameOr<TextureTable>>,
    /// Picture for transmission.
    pub(super) transmission_texture: Option<NameOr<TextureTable>>,
    /// Picture for coat.
    pub(super) coat_texture: Option<NameOr<TextureTable>>,
    /// Picture for coat_roughness.
    pub(super) coat_roughness_texture: Option<NameOr<TextureTable>>,
    /// Normal map of the coat.
    pub(super) coat_normal_texture: Option<NameOr<TextureTable>>,
    /// Picture for sheen_color.
    pub(super) sheen_color_texture: Option<NameOr<TextureTable>>,
    /// Picture for sheen_roughness.
    pub(super) sheen_roughness_texture: Option<NameOr<TextureTable>>,
}

/// A triangle mesh; counter-clockwise is the front. Lists are empty or as long as `positions`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a mesh: { positions, triangles }")]
pub(super) struct MeshTable {
    /// For people; the table's own name where left out.
    pub(super) name: Option<String>,
    /// Vertex positions.
    #[serde(deserialize_with = "fixed")]
    pub(super) positions: Vec<[f32; 3]>,
    /// Unit shading normals; flat where left out.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) normals: Vec<[f32; 3]>,
    /// Unit tangents; the fourth number is the handedness, 1 or -1.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) tangents: Vec<[f32; 4]>,
    /// Texture coordinates from the top left.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) uvs: Vec<[f32; 2]>,
    /// A second set of texture coordinates.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) uvs2: Vec<[f32; 2]>,
    /// Linear vertex colours with alpha.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) colors: Vec<[f32; 4]>,
    /// Three vertex numbers a triangle, from zero.
    #[serde(deserialize_with = "fixed")]
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Expected for MeshTable {
    const EXPECTED: &'static str = "the name of a mesh, or { positions, triangles }";
}

/// A shape with a material: exactly one of sphere, box, rect, polygon, prism, mesh.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "an object")]
#[schemars(extend("oneOf" = [{ "required": ["sphere"] }, { "required": ["box"] }, { "required": ["rect"] },
    { "required": ["polygon"] }, { "required": ["prism"] }, { "required": ["mesh"] }]))]
pub(super) struct ObjectTable {
    /// For people and messages; its shape and number where left out.
    pub(super) name: Option<String>,
    /// Name of its material. (A prism may name one for each part instead.)
    pub(super) material: Option<String>,
    /// An exact sphere.
    pub(super) sphere: Option<SphereTable>,
    /// A box with its front outside.
    #[serde(rename = "box")]
    #[schemars(rename = "box")]
    pub(super) cuboid: Option<BoxTable>,
    /// A parallelogram.
    pub(super) rect: Option<RectTable>,
    /// A flat polygon, with holes if you like.
    pub(super) polygon: Option<PolygonTable>,
    /// Upright walls over a ground plan, with floor and ceiling: a room, or a block.
    pub(super) prism: Option<PrismTable>,
    /// Triangles, or the name of a mesh that is shared.
    pub(super) mesh: Option<NameOr<MeshTable>>,
    /// Where it goes, after its own coordinates.
    pub(super) transform: Option<Placement>,
    /// Whether the camera sees it directly; true where left out.
    pub(super) visible_to_camera: Option<bool>,
}

/// An exact sphere.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a sphere: { center, radius }")]
pub(super) struct SphereTable {
    /// The origin where left out.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) center: Option<[f64; 3]>,
    /// Metres.
    pub(super) radius: f64,
}

/// A box.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a box: { center, size }")]
pub(super) struct BoxTable {
    /// Its middle.
    #[serde(deserialize_with = "fixed")]
    pub(super) center: [f64; 3],
    /// Full extent along x, y and z before it is turned.
    #[serde(deserialize_with = "fixed")]
    pub(super) size: [f64; 3],
    /// Turn about its middle.
    pub(super) rotation: Option<Rotation>,
}

/// A parallelogram; its front is where `facing` is, else edges[0] x edges[1].
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a rect: { corner, edges = [[..], [..]] }")]
pub(super) struct RectTable {
    /// One corner.
    #[serde(deserialize_with = "fixed")]
    pub(super) corner: [f64; 3],
    /// The two edges that leave it.
    #[serde(deserialize_with = "fixed")]
    pub(super) edges: [[f64; 3]; 2],
    /// A point that its front looks at.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) facing: Option<[f64; 3]>,
}

/// A flat polygon; its front is where `facing` is, else where the corners run counter-clockwise.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a polygon: { corners = [[..], ..] }")]
pub(super) struct PolygonTable {
    /// Three or more corners in one plane.
    #[serde(deserialize_with = "fixed")]
    pub(super) corners: Vec<[f64; 3]>,
    /// Corners of each hole.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) holes: Vec<Vec<[f64; 3]>>,
    /// A point that its front looks at.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) facing: Option<[f64; 3]>,
}

/// Upright walls over a ground plan. Parts without a material of their own take the object's; where
/// there is none, they are left out.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a prism: { corners = [[..], ..], bottom, top }")]
pub(super) struct PrismTable {
    /// The ground plan: [x, y] where z is up, [x, z] where y is up. Either way round.
    #[serde(deserialize_with = "fixed")]
    pub(super) corners: Vec<[f64; 2]>,
    /// Height of the floor.
    pub(super) bottom: f64,
    /// Height of the ceiling.
    pub(super) top: f64,
    /// True for a room, whose front is inside.
    #[serde(default)]
    pub(super) inward: bool,
    /// Material of all walls, or a list: the wall from corner 1 to 2, from 2 to 3, .. and back to 1. An
    /// empty name leaves that wall out.
    pub(super) walls: Option<NameOr<Vec<String>>>,
    /// Material of the floor.
    pub(super) floor: Option<String>,
    /// Material of the ceiling.
    pub(super) ceiling: Option<String>,
    /// Corners of each hole in the floor.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) floor_holes: Vec<Vec<[f64; 2]>>,
    /// Corners of each hole in the ceiling.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) ceiling_holes: Vec<Vec<[f64; 2]>>,
}

/// A light that is not a surface: exactly one of point, spot, sun, area.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a light")]
#[schemars(extend("oneOf" = [{ "required": ["point"] }, { "required": ["spot"] }, { "required": ["sun"] },
    { "required": ["area"] }]))]
pub(super) struct LightTable {
    /// For people and messages.
    pub(super) name: Option<String>,
    /// Shines equally in all directions.
    pub(super) point: Option<PointTable>,
    /// Shines into a cone.
    pub(super) spot: Option<SpotTable>,
    /// Parallel light from far away.
    pub(super) sun: Option<SunTable>,
    /// A flat surface that shines to one side.
    pub(super) area: Option<AreaTable>,
    /// Where it is; the origin where left out.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) position: Option<[f64; 3]>,
    /// Where it shines to; straight down where left out.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) direction: Option<[f64; 3]>,
    /// Instead of direction: a point in the middle of its beam.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) target: Option<[f64; 3]>,
    /// Which way the y extent of an area light points.
    #[serde(default, deserialize_with = "fixed")]
    pub(super) up: Option<[f64; 3]>,
    /// Instead of all these: its own space to world space; it shines along -Z.
    pub(super) transform: Option<Placement>,
    /// Whether the camera sees it directly; true where left out.
    pub(super) visible_to_camera: Option<bool>,
}

/// A point light.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a point light: { intensity }")]
pub(super) struct PointTable {
    /// W/sr.
    pub(super) intensity: Color,
    /// Above zero it is a sphere of this radius with the same intensity.
    #[serde(default)]
    pub(super) radius: f64,
}

/// A spot light.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a spot light: { intensity, outer }")]
pub(super) struct SpotTable {
    /// W/sr on the axis.
    pub(super) intensity: Color,
    /// Half angle where it begins to fade, degrees; 0 where left out.
    pub(super) inner: Option<Angle>,
    /// Half angle where it ends, degrees.
    pub(super) outer: Angle,
    /// How it fades: "gltf" where left out.
    #[serde(default)]
    pub(super) falloff: Word<SpotFalloff>,
    /// Above zero it is a sphere of this radius with the same intensity.
    #[serde(default)]
    pub(super) radius: f64,
}

/// A sun.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a sun: { irradiance }")]
pub(super) struct SunTable {
    /// W/m^2 on a surface that faces it.
    pub(super) irradiance: Color,
    /// Full angle of its disk, degrees; 0 (perfectly sharp shadows) where left out.
    pub(super) angle: Option<Angle>,
}

/// An area light.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "an area light: { size, radiance }")]
pub(super) struct AreaTable {
    /// "rectangle" where left out.
    #[serde(default)]
    pub(super) shape: Word<AreaShape>,
    /// Full extent along its x and y.
    #[serde(deserialize_with = "fixed")]
    pub(super) size: [f64; 2],
    /// W sr^-1 m^-2.
    pub(super) radiance: Color,
}

/// What is seen where nothing is hit.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "an environment: { radiance } or { image }")]
#[schemars(extend("anyOf" = [{ "required": ["radiance"] }, { "required": ["image"] }]))]
pub(super) struct EnvironmentTable {
    /// For people; "environment" where left out.
    pub(super) name: Option<String>,
    /// Radiance from every direction, or a factor on the image; white where there is an image.
    pub(super) radiance: Option<Color>,
    /// Picture of all directions, equirectangular: name of an image, or { file }.
    pub(super) image: Option<NameOr<FileTable>>,
    /// Degrees by which the image is turned about the up axis, counter-clockwise seen from above.
    pub(super) rotation: Option<Angle>,
    /// Whether the camera sees it directly; true where left out.
    pub(super) visible_to_camera: Option<bool>,
}

/// A picture that only one place uses.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a picture: { file }")]
pub(super) struct FileTable {
    /// Where it lies, below the scene's folder.
    pub(super) file: String,
}

impl Expected for FileTable {
    const EXPECTED: &'static str = "the name of an image, or { file = \"sky.hdr\" }";
}

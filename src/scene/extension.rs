//! The glTF extension `EPSILUX_scene`: its tables, which the importer reads and the exporter writes.
//!
//! In: nothing but the types of the scene. Out: one table for each place where the extension may stand.
//! Every key is optional: what is left out stays as glTF says it. Numbers are doubles, since JSON has no
//! singles; angles are radians and lengths metres of the node's own space, as everywhere in glTF.
//! Doc comments here are what the JSON Schema says.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::text::Word;
use super::{AreaShape, FovAxis, Sides, SpotFalloff, ToneCurve};

/// Name of the extension.
pub(crate) const NAME: &str = "EPSILUX_scene";
/// Its version.
pub(crate) const VERSION: u32 = 1;

/// The glTF extension EPSILUX_scene. It stands at five places, and holds something else at each.
#[derive(JsonSchema)]
#[schemars(title = "EPSILUX_scene", deny_unknown_fields)]
#[expect(dead_code, reason = "only its schema is of use")]
struct Places {
    /// In the glTF file's own `extensions`.
    root: Option<Root>,
    /// In `scenes[i].extensions`.
    scene: Option<SceneTable>,
    /// In `nodes[i].extensions`.
    node: Option<NodeTable>,
    /// In `materials[i].extensions`.
    material: Option<MaterialTable>,
    /// In `cameras[i].extensions`.
    camera: Option<CameraTable>,
}

/// The file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Root {
    /// Version of the extension; a reader refuses a newer one than it knows.
    #[schemars(extend("const" = 1))]
    pub(crate) version: u32,
}

/// A scene: what surrounds it, and how its author would like it rendered.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SceneTable {
    /// One line for people; the scene's name where left out.
    pub(crate) title: Option<String>,
    /// What is seen where nothing is hit; black where left out.
    pub(crate) environment: Option<EnvironmentTable>,
    /// How the author would like it rendered.
    pub(crate) film: Option<FilmTable>,
}

/// What is seen where nothing is hit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct EnvironmentTable {
    /// For people.
    pub(crate) name: Option<String>,
    /// Radiance from every direction, W sr^-1 m^-2, linear Rec. 709; a factor where there is a picture.
    /// White of one where left out.
    pub(crate) radiance: Option<[f64; 3]>,
    /// A picture of all directions (longitude and latitude, top row straight up): an index into the
    /// file's `images`.
    #[schemars(with = "Option<u32>")]
    pub(crate) image: Option<f64>,
    /// Instead: a picture in a file of its own, which may be .hdr or .exr; relative to the glTF file.
    pub(crate) uri: Option<String>,
    /// By how much the picture is turned about +Y, counter-clockwise seen from above, radians; 0 where
    /// left out. Without a turn its middle is seen along -Z, and +X to the right of it.
    pub(crate) rotation: Option<f64>,
    /// Whether the camera sees it; true where left out. It always lights.
    pub(crate) visible: Option<bool>,
}

/// How the author would like the scene rendered; options of the command line win.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct FilmTable {
    /// Width and height in pixels.
    #[schemars(with = "Option<[u32; 2]>")]
    pub(crate) size: Option<[f64; 2]>,
    /// Exposure in stops, for pictures for a screen.
    pub(crate) exposure: Option<f64>,
    /// Tone curve, for pictures for a screen.
    pub(crate) tone: Option<Word<ToneCurve>>,
    /// Samples per pixel.
    #[schemars(with = "Option<u32>")]
    pub(crate) spp: Option<f64>,
    /// Cap on the number of times that light scatters; none where left out.
    #[schemars(with = "Option<u32>")]
    pub(crate) max_depth: Option<f64>,
    /// Factor on light that diffuse or rough surfaces scattered more than once; one where left out, as physics has it.
    pub(crate) indirect_gain: Option<f64>,
}

/// A node: an exact sphere, a light, and who sees them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct NodeTable {
    /// An exact sphere instead of the node's mesh, with the material of the mesh's first primitive. The
    /// node may be turned, moved and scaled evenly.
    pub(crate) sphere: Option<SphereTable>,
    /// A light, or what `KHR_lights_punctual` on the same node leaves out.
    pub(crate) light: Option<LightTable>,
    /// Who sees what stands at the node.
    pub(crate) visibility: Option<VisibilityTable>,
    /// The node's matrix (16 numbers, column by column) in double precision, for writers whose
    /// transforms lose digits in single precision. It takes the place of the node's own transform.
    pub(crate) matrix: Option<[f64; 16]>,
}

/// An exact sphere about the node's origin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct SphereTable {
    /// Metres, the node's own space, above 0.
    pub(crate) radius: Option<f64>,
}

/// A light, which shines along the node's own -Z with +Y up. Beside `KHR_lights_punctual`, keys that are
/// left out are taken from there.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct LightTable {
    /// Which kind; that of `KHR_lights_punctual` where left out.
    #[serde(rename = "type")]
    pub(crate) kind: Option<LightType>,
    /// Point and spot: radiant intensity, W/sr, for a spot on its axis; linear Rec. 709.
    pub(crate) intensity: Option<[f64; 3]>,
    /// Sun: irradiance on a plane that faces it, W/m^2; linear Rec. 709.
    pub(crate) irradiance: Option<[f64; 3]>,
    /// Area: radiance, W sr^-1 m^-2; linear Rec. 709.
    pub(crate) radiance: Option<[f64; 3]>,
    /// Point and spot: above zero, it is a sphere of this radius with the same intensity; metres, the
    /// node's own space.
    pub(crate) radius: Option<f64>,
    /// Sun: full angle of its disk, radians.
    pub(crate) angle: Option<f64>,
    /// Spot: half angle where the falloff begins, radians.
    pub(crate) inner: Option<f64>,
    /// Spot: half angle where the light ends, radians, up to a quarter turn.
    pub(crate) outer: Option<f64>,
    /// Spot: the curve between the two.
    pub(crate) falloff: Option<Word<SpotFalloff>>,
    /// Area: its outline; a rectangle where left out.
    pub(crate) shape: Option<Word<AreaShape>>,
    /// Area: full extent along the node's x and y, metres, the node's own space.
    pub(crate) size: Option<[f64; 2]>,
}

/// The kinds of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum LightType {
    /// Shines equally in all directions.
    Point,
    /// Shines into a cone.
    Spot,
    /// Parallel light from far away.
    Sun,
    /// A flat surface that shines to one side, and blocks no ray.
    Area,
}

/// Who sees what stands at a node.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct VisibilityTable {
    /// Whether the camera sees it directly; reflections, refractions and shadows always do. Left out,
    /// the camera sees surfaces and does not see lights.
    pub(crate) camera: Option<bool>,
}

/// A material: one of diffuse, mirror, glass and light in place of what glTF says, or principled, which
/// changes single values of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct MaterialTable {
    /// Lambert's reflector: its reflectance, 0 to 1.
    pub(crate) diffuse: Option<[f64; 3]>,
    /// A perfect mirror: its reflectance, 0 to 1.
    pub(crate) mirror: Option<[f64; 3]>,
    /// A smooth dielectric that encloses a volume.
    pub(crate) glass: Option<GlassTable>,
    /// A black surface that emits this radiance, W sr^-1 m^-2.
    pub(crate) light: Option<[f64; 3]>,
    /// Which sides of a light emit; "front" where left out.
    pub(crate) sides: Option<Word<Sides>>,
    /// Values that take the place of glTF's.
    pub(crate) principled: Option<PrincipledTable>,
}

/// A smooth dielectric; `{}` is clear glass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct GlassTable {
    /// Index of refraction; 1.5 where left out.
    pub(crate) ior: Option<f64>,
    /// Factor on each refraction, 0 to 1; white where left out.
    pub(crate) tint: Option<[f64; 3]>,
    /// What the inside absorbs.
    pub(crate) absorption: Option<AbsorptionTable>,
    /// Where bodies overlap or touch, the one of the highest priority is there, 0 to 255. Where left out,
    /// the surface is an interface against whatever is outside.
    #[schemars(with = "Option<u8>")]
    pub(crate) priority: Option<f64>,
}

/// Absorption along the way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct AbsorptionTable {
    /// What is left of white light after `distance`, above 0 and up to 1.
    pub(crate) color: Option<[f64; 3]>,
    /// Metres, above 0.
    pub(crate) distance: Option<f64>,
}

/// Values of a material that take the place of what glTF says; textures stay.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct PrincipledTable {
    /// Diffuse reflectance, or the metal's seen straight on, 0 to 1.
    pub(crate) base_color: Option<[f64; 3]>,
    /// 0 dielectric, 1 metal.
    pub(crate) metallic: Option<f64>,
    /// 0 polished to 1 matt.
    pub(crate) roughness: Option<f64>,
    /// Index of refraction, at least 1.
    pub(crate) ior: Option<f64>,
    /// Strength of the dielectric's reflection, 0 to 1.
    pub(crate) specular: Option<f64>,
    /// Tint of the dielectric's reflection, 0 or more.
    pub(crate) specular_color: Option<[f64; 3]>,
    /// Share of light that passes instead of scattering, 0 to 1.
    pub(crate) transmission: Option<f64>,
    /// Factor on each refraction, 0 to 1; glTF has none, and takes the base colour.
    pub(crate) transmission_tint: Option<[f64; 3]>,
    /// True for a sheet that encloses no volume and does not bend light.
    pub(crate) thin: Option<bool>,
    /// What the inside absorbs.
    pub(crate) absorption: Option<AbsorptionTable>,
    /// Where bodies overlap or touch, the one of the highest priority is there, 0 to 255. Where left out,
    /// the surface is an interface against whatever is outside.
    #[schemars(with = "Option<u8>")]
    pub(crate) priority: Option<f64>,
    /// Emitted radiance on both sides, W sr^-1 m^-2.
    pub(crate) emission: Option<[f64; 3]>,
    /// Coverage, 0 to 1, where the alpha mode looks at it.
    pub(crate) alpha: Option<f64>,
    /// Weight of a clear coat, 0 to 1.
    pub(crate) coat: Option<f64>,
    /// Roughness of the coat, 0 to 1.
    pub(crate) coat_roughness: Option<f64>,
    /// Index of refraction of the coat, at least 1; glTF has none, and takes 1.5.
    pub(crate) coat_ior: Option<f64>,
    /// Reflectance of a layer of fibres, 0 to 1.
    pub(crate) sheen_color: Option<[f64; 3]>,
    /// Roughness of the fibres, 0 to 1.
    pub(crate) sheen_roughness: Option<f64>,
}

/// A camera: what glTF's cannot say.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct CameraTable {
    /// Shift of the picture to the right and up, in units of the side named by `fov_axis`.
    pub(crate) shift: Option<[f64; 2]>,
    /// Depth of field.
    pub(crate) lens: Option<LensTable>,
    /// Perspective: full angle over the side named by `fov_axis`, radians.
    pub(crate) fov: Option<f64>,
    /// Orthographic: full extent of the side named by `fov_axis`, metres.
    pub(crate) extent: Option<f64>,
    /// The side that `fov`, `extent` and `shift` speak of; "vertical" where left out, as in glTF.
    pub(crate) fov_axis: Option<Word<FovAxis>>,
    /// Width over height, used where no size is given. Beside `extent`, none where left out.
    pub(crate) aspect: Option<f64>,
}

/// A thin lens.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct LensTable {
    /// Radius of the aperture, metres, above 0.
    pub(crate) radius: Option<f64>,
    /// Distance of what is sharp, along the view axis, metres, above 0.
    pub(crate) focus: Option<f64>,
}

/// The JSON Schema of the extension: an object with one property for each place where it stands.
#[must_use]
pub(crate) fn schema() -> Value {
    schemars::schema_for!(Places).to_value()
}

/// A table as JSON, without the keys that are left out.
pub(crate) fn to_json(table: &impl Serialize) -> Value {
    let mut value = serde_json::to_value(table).unwrap_or_default();
    strip(&mut value);
    value
}

fn strip(value: &mut Value) {
    if let Value::Object(map) = value {
        map.retain(|_, v| !v.is_null());
        map.values_mut().for_each(strip);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Editors and other programs read the schema from the file; it must be that of the types.
    #[test]
    fn the_schema_in_the_repository_is_that_of_the_types() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/EPSILUX_scene.schema.json");
        let mut expected = serde_json::to_string_pretty(&schema()).unwrap();
        expected.push('\n');
        let found = std::fs::read_to_string(path).unwrap_or_default();
        assert!(found == expected, "write it again: epsilux schema --extension > {path}");
    }

    /// What is left out is not written as null, which readers would take for a mistake.
    #[test]
    fn keys_that_are_left_out_are_not_written() {
        let node = NodeTable { sphere: Some(SphereTable { radius: Some(2.0) }), ..NodeTable::default() };
        assert_eq!(to_json(&node).to_string(), r#"{"sphere":{"radius":2.0}}"#);
        assert_eq!(to_json(&SceneTable::default()).to_string(), "{}");
    }
}

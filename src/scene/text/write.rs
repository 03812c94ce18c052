//! The canonical text of a scene, in TOML and JSON.
//!
//! In: a valid scene. Out: text that reads back as the same scene, bit for bit. The scene first becomes
//! a tree of tables ([`tree`]), with every number in its shortest exact decimal form; then the tree is
//! laid out in one of the two syntaxes. Coordinates are the scene's own, +Y up; what a constructor made
//! is written as the mesh that it became; values that equal the default are left out.

use std::collections::HashSet;

use glam::{DAffine3, DMat3, DMat4};

use super::VERSION;
use super::names::{AlphaWord, Vocabulary};
use crate::color::Rgb;
use crate::scene::{
    Absorption, AlphaMode, AreaShape, Camera, Channel, Environment, Filter, FovAxis, Image, ImageId, Light,
    LightKind, Material, MaterialKind, Mesh, NormalTexture, Object, Principled, Projection, ScalarTexture,
    Scene, Settings, Shape, Sides, SpotFalloff, Texture, Wrap,
};

/// A value of the text form.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    /// A number or a truth value, as it is written.
    Raw(String),
    /// Text, not yet quoted.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// A table, in order.
    Table(Table),
}

/// Keys and values, in order.
pub(super) type Table = Vec<(String, Node)>;

/// A table under construction.
#[derive(Default)]
struct Keys(Table);

impl Keys {
    fn put(mut self, key: &str, value: impl Into<Node>) -> Self {
        self.0.push((key.to_owned(), value.into()));
        self
    }

    fn some<T: Into<Node>>(self, key: &str, value: Option<T>) -> Self {
        match value {
            Some(value) => self.put(key, value),
            None => self,
        }
    }

    /// Leaves out what is written like the default.
    fn unless<T: Into<Node>>(self, key: &str, value: T, default: T) -> Self {
        let value = value.into();
        if value == default.into() { self } else { self.put(key, value) }
    }

    fn list(self, key: &str, items: Vec<Node>) -> Self {
        if items.is_empty() { self } else { self.put(key, Node::List(items)) }
    }

    fn table(self, key: &str, items: Table) -> Self {
        if items.is_empty() { self } else { self.put(key, Node::Table(items)) }
    }
}

impl From<Keys> for Node {
    fn from(keys: Keys) -> Self {
        Self::Table(keys.0)
    }
}

impl From<&str> for Node {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<bool> for Node {
    fn from(value: bool) -> Self {
        Self::Raw(value.to_string())
    }
}

impl From<u32> for Node {
    fn from(value: u32) -> Self {
        Self::Raw(value.to_string())
    }
}

impl From<f64> for Node {
    fn from(value: f64) -> Self {
        let whole =
            value.trunc() == value && value.abs() < 1e15 && (value != 0.0 || value.is_sign_positive());
        Self::Raw(if whole { format!("{value:.0}") } else { format!("{value:?}") })
    }
}

impl From<f32> for Node {
    /// The shortest decimal that names this single; readers go through a double, so where that would
    /// round twice to something else, the exact value.
    fn from(value: f32) -> Self {
        let short = format!("{value:?}");
        match short.parse::<f64>() {
            Ok(double) if (double as f32).to_bits() == value.to_bits() => match Self::from(double) {
                Self::Raw(whole) if !whole.contains(['.', 'e']) => Self::Raw(whole),
                _ => Self::Raw(short),
            },
            _ => Self::from(f64::from(value)),
        }
    }
}

impl<T: Into<Node> + Copy, const N: usize> From<[T; N]> for Node {
    fn from(list: [T; N]) -> Self {
        Self::List(list.iter().map(|&v| v.into()).collect())
    }
}

impl From<Rgb> for Node {
    fn from(c: Rgb) -> Self {
        c.to_array().into()
    }
}

impl From<&Absorption> for Node {
    fn from(a: &Absorption) -> Self {
        Keys::default().put("color", a.color).put("distance", a.distance).into()
    }
}

/// An angle as the shortest number of degrees that gives exactly these radians, or in radians.
fn angle(radians: f64) -> Node {
    let degrees = radians.to_degrees();
    let shorter = (0..=16).filter_map(|digits| format!("{degrees:.digits$e}").parse::<f64>().ok());
    shorter
        .chain([degrees.next_up(), degrees.next_down()])
        .find(|d| d.to_radians().to_bits() == radians.to_bits())
        .map_or_else(|| Keys::default().put("radians", radians).into(), Node::from)
}

/// The same for a single: shorter, since fewer digits tell it from its neighbours.
fn angle_single(radians: f32) -> Node {
    let degrees = f64::from(radians).to_degrees();
    (0..=16)
        .filter_map(|digits| format!("{degrees:.digits$e}").parse::<f64>().ok())
        .find(|d| (d.to_radians() as f32).to_bits() == radians.to_bits())
        .map_or_else(|| Keys::default().put("radians", f64::from(radians)).into(), Node::from)
}

/// The translation, where that is all a transform does.
fn translation_only(t: &DAffine3) -> Option<[f64; 3]> {
    let bits = |m: DMat3| m.to_cols_array().map(f64::to_bits);
    (bits(t.matrix3) == bits(DMat3::IDENTITY)).then(|| t.translation.to_array())
}

fn transform(t: &DAffine3) -> Node {
    match translation_only(t) {
        Some(by) => Keys::default().put("translate", by).into(),
        None => DMat4::from(*t).to_cols_array().into(),
    }
}

/// The tables of a scene.
pub(super) fn tree(scene: &Scene) -> Table {
    let mesh_keys = unique_keys("mesh", scene.meshes.iter().map(|m| m.name.as_str()));
    let image_keys = unique_keys("image", scene.images.iter().map(|i| i.name.as_str()));
    let images = scene.images.iter().zip(&image_keys).map(|(i, key)| (key.clone(), image(i, key)));
    let meshes = scene.meshes.iter().zip(&mesh_keys).map(|(m, key)| (key.clone(), mesh(m, key)));
    let material_name =
        |o: &Object| scene.materials.get(o.material.0 as usize).map_or("", |m| m.name.as_str());
    let objects = scene.objects.iter().map(|o| object(o, material_name(o), &mesh_keys));
    Keys::default()
        .put("epsilux", VERSION)
        .unless("title", scene.title.as_str(), "")
        .table("render", settings(&scene.settings))
        .table("camera", scene.cameras.iter().map(|c| (c.name.clone(), camera(c))).collect())
        .table("image", images.collect())
        .table(
            "material",
            scene.materials.iter().map(|m| (m.name.clone(), material(m, &image_keys))).collect(),
        )
        .table("mesh", meshes.collect())
        .list("object", objects.collect())
        .list("light", scene.lights.iter().map(light).collect())
        .some("environment", scene.environment.as_ref().map(|e| environment(e, &image_keys)))
        .0
}

/// A key for each name: the name itself, or with a number where it is empty or taken.
fn unique_keys<'a>(what: &str, names: impl Iterator<Item = &'a str> + Clone) -> Vec<String> {
    let names_in_use: HashSet<&str> = names.clone().collect();
    let mut used = HashSet::new();
    names
        .enumerate()
        .map(|(i, name)| {
            let mut key = name.to_owned();
            let mut number = i;
            while key.is_empty()
                || used.contains(&key)
                || (key != name && names_in_use.contains(key.as_str()))
            {
                number += 1;
                key = format!("{} {number}", if name.is_empty() { what } else { name });
            }
            used.insert(key.clone());
            key
        })
        .collect()
}

fn settings(s: &Settings) -> Table {
    Keys::default()
        .some("size", s.size)
        .some("spp", s.spp)
        .some("exposure", s.exposure)
        .some("tone", s.tone.map(Vocabulary::word))
        .some("max_depth", s.max_depth)
        .some("indirect_gain", s.indirect_gain)
        .0
}

fn camera(c: &Camera) -> Node {
    let keys = Keys::default().put("transform", transform(&c.transform));
    let (keys, axis) = match c.projection {
        Projection::Perspective { fov, axis } => (keys.put("fov", angle(fov)), axis),
        Projection::Orthographic { extent, axis } => (keys.put("orthographic", extent), axis),
    };
    let lens = c.lens.map(|l| Keys::default().put("radius", l.radius).put("focus", l.focus_distance));
    keys.unless("fov_axis", axis.word(), FovAxis::default().word())
        .unless("shift", c.shift, [0.0; 2])
        .some("lens", lens)
        .some("aspect", c.aspect)
        .into()
}

fn material(m: &Material, images: &[String]) -> Node {
    let keys = Keys::default();
    match &m.kind {
        MaterialKind::Diffuse { color } => keys.put("diffuse", *color),
        MaterialKind::Mirror { color } => keys.put("mirror", *color),
        MaterialKind::Light { radiance, sides } => {
            keys.put("light", *radiance).unless("sides", sides.word(), Sides::default().word())
        }
        MaterialKind::Glass(g) => {
            let glass = Keys::default()
                .put("ior", g.ior)
                .unless("tint", g.tint, Rgb::WHITE)
                .some("absorption", g.absorption.as_ref())
                .some("priority", g.priority.map(u32::from));
            keys.put("glass", glass)
        }
        MaterialKind::Principled(p) => keys.put("principled", principled(p, images)),
    }
    .into()
}

/// A picture by its file; where the scene's own file held it, somebody has to give it one first.
fn image(i: &Image, key: &str) -> Node {
    let file = i.file.as_deref().unwrap_or_default();
    if i.name == key {
        return file.into();
    }
    Keys::default().put("name", i.name.as_str()).put("file", file).into()
}

fn environment(e: &Environment, images: &[String]) -> Keys {
    let keys = Keys::default().unless("name", e.name.as_str(), "environment");
    let keys = match e.image {
        None => keys.put("radiance", e.radiance),
        Some(image) => keys
            .unless("radiance", e.radiance, Rgb::WHITE)
            .put("image", key_of(image.image, images))
            .unless("rotation", angle(image.rotation), angle(0.0)),
    };
    keys.unless("visible_to_camera", e.visible_to_camera, true)
}

fn key_of(id: ImageId, images: &[String]) -> &str {
    images.get(id.0 as usize).map_or("", String::as_str)
}

/// A texture and what its slot adds: the name of its picture, where that is all there is to say.
fn texture(t: &Texture, images: &[String], more: Keys) -> Node {
    let image = key_of(t.image, images);
    let pair = |same: bool, one: Node, both: Node| if same { one } else { both };
    let [u, v] = t.scale;
    let scale = pair(u.to_bits() == v.to_bits(), u.into(), t.scale.into());
    let [x, y] = t.wrap.map(Vocabulary::word);
    let wrap = pair(x == y, x.into(), [x, y].into());
    let mut keys = Keys::default()
        .put("image", image)
        .unless("uv_set", u32::from(t.uv_set), 0)
        .unless("offset", t.offset, [0.0; 2])
        .unless("rotation", angle_single(t.rotation), angle_single(0.0))
        .unless("scale", scale, 1.0f32.into())
        .unless("wrap", wrap, Wrap::default().word().into())
        .unless("filter", t.filter.word(), Filter::default().word());
    keys.0.extend(more.0);
    if keys.0.len() == 1 { image.into() } else { keys.into() }
}

fn principled(p: &Principled, images: &[String]) -> Keys {
    let color = |t: Option<Texture>| t.map(|t| texture(&t, images, Keys::default()));
    let number = |t: Option<ScalarTexture>, default: Channel| {
        t.map(|t| {
            texture(&t.texture, images, Keys::default().unless("channel", t.channel.word(), default.word()))
        })
    };
    let scalar = |t| number(t, Channel::R);
    let normal = |t: Option<NormalTexture>| {
        t.map(|t| texture(&t.texture, images, Keys::default().unless("strength", t.scale, 1.0)))
    };
    let t = &p.textures;
    // Where alpha is mentioned, its mode is too: what would be meant without depends on what is there.
    let alpha = Node::from(p.alpha) != Node::from(1.0f32) || t.alpha.is_some();
    let (mode, cutoff) = match p.alpha_mode {
        AlphaMode::Opaque => (AlphaWord::Opaque, None),
        AlphaMode::Mask { cutoff } => (AlphaWord::Mask, Some(cutoff)),
        AlphaMode::Blend => (AlphaWord::Blend, None),
    };
    let default = Principled::default();
    Keys::default()
        .unless("base_color", p.base_color, default.base_color)
        .unless("metallic", p.metallic, default.metallic)
        .unless("roughness", p.roughness, default.roughness)
        .unless("ior", p.ior, default.ior)
        .unless("specular", p.specular, default.specular)
        .unless("specular_color", p.specular_color, default.specular_color)
        .unless("transmission", p.transmission, default.transmission)
        .unless("transmission_tint", p.transmission_tint, default.transmission_tint)
        .unless("thin", p.thin, default.thin)
        .some("absorption", p.absorption.as_ref())
        .some("priority", p.priority.map(u32::from))
        .unless("emission", p.emission, default.emission)
        .unless("alpha", p.alpha, default.alpha)
        .some("alpha_mode", (alpha || mode != AlphaWord::Opaque).then(|| mode.word()))
        .some("cutoff", cutoff)
        .unless("coat", p.coat, default.coat)
        .unless("coat_roughness", p.coat_roughness, default.coat_roughness)
        .unless("coat_ior", p.coat_ior, default.coat_ior)
        .unless("sheen_color", p.sheen_color, default.sheen_color)
        .unless("sheen_roughness", p.sheen_roughness, default.sheen_roughness)
        .some("base_color_texture", color(t.base_color))
        .some("alpha_texture", number(t.alpha, Channel::A))
        .some("metallic_texture", scalar(t.metallic))
        .some("roughness_texture", scalar(t.roughness))
        .some("normal_texture", normal(t.normal))
        .some("emission_texture", color(t.emission))
        .some("specular_texture", scalar(t.specular))
        .some("specular_color_texture", color(t.specular_color))
        .some("transmission_texture", scalar(t.transmission))
        .some("coat_texture", scalar(t.coat))
        .some("coat_roughness_texture", scalar(t.coat_roughness))
        .some("coat_normal_texture", normal(t.coat_normal))
        .some("sheen_color_texture", color(t.sheen_color))
        .some("sheen_roughness_texture", scalar(t.sheen_roughness))
}

fn mesh(m: &Mesh, key: &str) -> Node {
    let rows = |list: &mut dyn Iterator<Item = Node>| list.collect::<Vec<Node>>();
    Keys::default()
        .unless("name", m.name.as_str(), key)
        .put("positions", Node::List(rows(&mut m.positions.iter().map(|v| v.to_array().into()))))
        .list("normals", rows(&mut m.normals.iter().map(|v| v.to_array().into())))
        .list("tangents", rows(&mut m.tangents.iter().map(|v| v.to_array().into())))
        .list("uvs", rows(&mut m.uvs[0].iter().map(|v| v.to_array().into())))
        .list("uvs2", rows(&mut m.uvs[1].iter().map(|v| v.to_array().into())))
        .list("colors", rows(&mut m.colors.iter().map(|v| v.to_array().into())))
        .put("triangles", Node::List(rows(&mut m.triangles.iter().map(|&t| t.into()))))
        .into()
}

fn object(o: &Object, material: &str, mesh_keys: &[String]) -> Node {
    let keys = Keys::default().put("name", o.name.as_str()).put("material", material);
    let at = translation_only(&o.transform);
    let placed = |keys: Keys| match at {
        Some(by) if by.map(f64::to_bits) == [0; 3] => keys,
        _ => keys.put("transform", transform(&o.transform)),
    };
    let keys = match o.shape {
        Shape::Sphere { radius } => match at {
            Some(center) => keys.put("sphere", Keys::default().put("center", center).put("radius", radius)),
            None => placed(keys.put("sphere", Keys::default().put("radius", radius))),
        },
        Shape::Mesh(id) => placed(keys.put("mesh", mesh_keys.get(id.0 as usize).map_or("", String::as_str))),
    };
    keys.unless("visible_to_camera", o.visible_to_camera, true).into()
}

fn light(l: &Light) -> Node {
    let keys = Keys::default().put("name", l.name.as_str());
    let keys = match l.kind {
        LightKind::Point { intensity, radius } => {
            keys.put("point", Keys::default().put("intensity", intensity).unless("radius", radius, 0.0))
        }
        LightKind::Spot { intensity, inner, outer, falloff, radius } => {
            let spot = Keys::default()
                .put("intensity", intensity)
                .put("inner", angle(inner))
                .put("outer", angle(outer))
                .unless("falloff", falloff.word(), SpotFalloff::default().word())
                .unless("radius", radius, 0.0);
            keys.put("spot", spot)
        }
        LightKind::Sun { irradiance, angle: a } => {
            keys.put("sun", Keys::default().put("irradiance", irradiance).put("angle", angle(a)))
        }
        LightKind::Area { shape, size, radiance } => {
            let area = Keys::default()
                .unless("shape", shape.word(), AreaShape::default().word())
                .put("size", size)
                .put("radiance", radiance);
            keys.put("area", area)
        }
    };
    keys.put("transform", transform(&l.transform))
        .unless("visible_to_camera", l.visible_to_camera, true)
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(node: impl Into<Node>) -> String {
        match node.into() {
            Node::Raw(raw) => raw,
            other => format!("{other:?}"),
        }
    }

    #[test]
    fn numbers_are_short_and_exact() {
        assert_eq!(written(0.1f32), "0.1");
        assert_eq!(written(5.0f32), "5");
        assert_eq!(written(-0.0f32), "-0.0");
        assert_eq!(written(1e30f32), "1e30");
        assert_eq!(written(16_777_216.0f32), "16777216");
        assert_eq!(written(f32::MIN_POSITIVE), "1.1754944e-38");
        assert_eq!(written(-0.0f64), "-0.0");
        assert_eq!(written(1e15f64), "1000000000000000.0");
        assert_eq!(written(0.1f64 + 0.2), "0.30000000000000004");
    }

    #[test]
    fn angles_are_degrees_where_those_are_exact() {
        for degrees in [0.0, 0.1, 15.0, 39.307_648_661_167_2, 40.0, 90.0, 180.0] {
            assert_eq!(written(angle(f64::to_radians(degrees))), written(degrees));
        }
        // Not every number of radians is the image of some number of degrees.
        let inexact =
            (1..1000).map(|i| f64::from(i) * 0.001).filter(|&r| matches!(angle(r), Node::Table(_))).count();
        assert!(inexact > 10, "{inexact}");
    }

    #[test]
    fn meshes_of_one_name_get_keys_of_their_own() {
        let names = ["tree", "", "tree", "tree 3", ""];
        assert_eq!(unique_keys("mesh", names.into_iter()), ["tree", "mesh 2", "tree 4", "tree 3", "mesh 5"]);
    }
}

//! The JSON of a glTF file as the `gltf` crate's document types, read element by element.
//!
//! Each element is deserialised alone: an error names its place, and parts that we never read
//! (animations, skins) cannot make a valid file fail.

use std::collections::{BTreeMap, HashSet};

use gltf::json;
use json::extensions::scene::khr_lights_punctual::Light;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::super::error::Fault;
use super::vendor;

/// The parts of a glTF document that we read.
pub(super) struct Document {
    pub(super) accessors: Vec<json::Accessor>,
    pub(super) buffers: Vec<json::Buffer>,
    pub(super) views: Vec<json::buffer::View>,
    pub(super) cameras: Vec<json::Camera>,
    pub(super) lights: Vec<Light>,
    pub(super) materials: Vec<json::Material>,
    pub(super) textures: Vec<json::Texture>,
    pub(super) samplers: Vec<json::texture::Sampler>,
    pub(super) images: Vec<json::Image>,
    /// Materials that have neither `pbrMetallicRoughness` nor anything else that shades.
    pub(super) bare_materials: HashSet<usize>,
    pub(super) meshes: Vec<json::Mesh>,
    pub(super) nodes: Vec<json::Node>,
    /// Root nodes of the scene to read.
    pub(super) roots: Vec<usize>,
    /// Its name.
    pub(super) title: String,
    /// Nodes that are joints of a skin.
    pub(super) joints: HashSet<usize>,
    pub(super) animations: usize,
    pub(super) scenes: usize,
    pub(super) generator: String,
    pub(super) extensions: Extensions,
    /// What our own extension says about the whole.
    pub(super) vendor: vendor::Root,
}

/// Which extensions the file names, and where they stand.
#[derive(Default)]
pub(super) struct Extensions {
    pub(super) required: Vec<String>,
    /// By name: the first place, and the number of places.
    pub(super) found: BTreeMap<String, (String, usize)>,
}

impl Document {
    /// True for files of Blender's own exporter, whose habits differ from the specification.
    pub(super) fn is_from_blender(&self) -> bool {
        self.generator.starts_with("Khronos glTF Blender I/O")
    }

    /// True for files of this program, whose lights are in W/sr and W/m^2.
    pub(super) fn is_own(&self) -> bool {
        self.generator.starts_with("epsilux ")
    }
}

/// Parses the JSON text of a glTF file.
pub(super) fn parse(text: &[u8]) -> Result<Document, Fault> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let text = std::str::from_utf8(text).map_err(|e| {
        Fault::invalid(format!("byte {} of the JSON text", e.valid_up_to()), "an invalid sequence", "UTF-8")
    })?;
    // The parser's own bound on nesting, 128, holds for everything below.
    let root: Value = serde_json::from_str(text).map_err(|e| {
        let place = format!("line {} column {} of the JSON text", e.line(), e.column());
        let full = e.to_string();
        let reason = full.rsplit_once(" at line").map_or(&*full, |(reason, _)| reason);
        Fault::invalid(place, format!("a fault ({reason})"), "JSON")
    })?;
    let Value::Object(mut root) = root else {
        return Err(Fault::invalid("JSON text", kind(&root), "an object"));
    };
    let generator = check_asset(root.remove("asset"))?;
    let mut found = BTreeMap::new();
    for (key, value) in &root {
        find_extensions(value, key, key == "extensions", &mut found);
    }
    let extensions = Extensions { required: elements(&mut root, "extensionsRequired", "")?, found };

    let vendor = vendor::Root::of(&root)?;

    let is_bare = |v: &Value| {
        let plain = ["name", "doubleSided", "alphaMode", "extras"];
        v.as_object().is_some_and(|m| m.keys().all(|k| plain.contains(&&**k)))
    };
    let raw_materials = root.get("materials").and_then(Value::as_array).map_or(&[][..], |a| a);
    let bare_materials = (0..raw_materials.len()).filter(|&i| is_bare(&raw_materials[i])).collect();
    let mut joints = HashSet::new();
    for skin in root.get("skins").and_then(Value::as_array).into_iter().flatten() {
        let list = skin.get("joints").and_then(Value::as_array);
        joints.extend(list.into_iter().flatten().filter_map(Value::as_u64).map(|j| j as usize));
    }
    let scenes = root.get("scenes").and_then(Value::as_array).map_or(0, Vec::len);
    let lights = match root.get_mut("extensions").and_then(|e| e.get_mut("KHR_lights_punctual")) {
        Some(Value::Object(lights)) => elements(lights, "lights", "extensions.KHR_lights_punctual.")?,
        _ => Vec::new(),
    };
    let (roots, title) = scene_roots(&root)?;
    Ok(Document {
        accessors: elements(&mut root, "accessors", "")?,
        buffers: elements(&mut root, "buffers", "")?,
        views: elements(&mut root, "bufferViews", "")?,
        cameras: elements(&mut root, "cameras", "")?,
        lights,
        materials: elements(&mut root, "materials", "")?,
        textures: elements(&mut root, "textures", "")?,
        samplers: elements(&mut root, "samplers", "")?,
        images: elements(&mut root, "images", "")?,
        bare_materials,
        meshes: elements(&mut root, "meshes", "")?,
        nodes: elements(&mut root, "nodes", "")?,
        roots,
        title,
        joints,
        animations: root.get("animations").and_then(Value::as_array).map_or(0, Vec::len),
        scenes,
        generator,
        extensions,
        vendor,
    })
}

/// The generator, once the version has been found to be one we read.
fn check_asset(asset: Option<Value>) -> Result<String, Fault> {
    let Some(Value::Object(asset)) = asset else {
        return Err(Fault::invalid("asset", "nothing", "an object with `version`, as in every glTF file"));
    };
    let version = asset.get("version").and_then(Value::as_str);
    let Some(version) = version else {
        return Err(Fault::invalid("asset.version", "nothing", "\"2.0\""));
    };
    let needed = asset.get("minVersion").and_then(Value::as_str).unwrap_or("2.0");
    if !version.starts_with("2.") || needed != "2.0" {
        let newest = if needed == "2.0" { version } else { needed };
        return Err(Fault::Unsupported {
            place: "asset.version".into(),
            feature: format!("glTF {newest}"),
            help: "export as glTF 2.0".into(),
        });
    }
    Ok(asset.get("generator").and_then(Value::as_str).unwrap_or_default().to_owned())
}

/// The root nodes and the name of the default scene, else of the first. A file without scenes shows
/// every node that is nobody's child.
fn scene_roots(root: &Map<String, Value>) -> Result<(Vec<usize>, String), Fault> {
    let index = |v: &Value, place: String| match v.as_u64() {
        Some(i) => Ok(i as usize),
        None => Err(Fault::invalid(place, kind(v), "an index")),
    };
    let list = |key: &str| root.get(key).and_then(Value::as_array).map_or(&[][..], |a| a);
    let scenes = list("scenes");
    if scenes.is_empty() && root.get("scene").is_none() {
        let nodes = list("nodes");
        let mut is_child = vec![false; nodes.len()];
        for child in nodes.iter().filter_map(|n| n.get("children")?.as_array()).flatten() {
            if let Some(slot) = child.as_u64().and_then(|c| is_child.get_mut(c as usize)) {
                *slot = true;
            }
        }
        return Ok(((0..nodes.len()).filter(|&i| !is_child[i]).collect(), String::new()));
    }
    let default = root.get("scene").map_or(Ok(0), |v| index(v, "scene".into()))?;
    let Some(scene) = scenes.get(default) else {
        return Err(Fault::invalid("scene", format!("index {default}"), format!("below {}", scenes.len())));
    };
    let nodes = scene.get("nodes").and_then(Value::as_array).map_or(&[][..], |a| a);
    let roots = nodes.iter().enumerate().map(|(i, v)| index(v, format!("scenes[{default}].nodes[{i}]")));
    let title = scene.get("name").and_then(Value::as_str).unwrap_or_default();
    Ok((roots.collect::<Result<_, _>>()?, title.to_owned()))
}

/// Takes the array `key` out of `object` and reads each element as a `T`.
fn elements<T: DeserializeOwned>(
    object: &mut Map<String, Value>,
    key: &str,
    prefix: &str,
) -> Result<Vec<T>, Fault> {
    let list = match object.remove(key) {
        None => return Ok(Vec::new()),
        Some(Value::Array(list)) => list,
        Some(other) => return Err(Fault::invalid(format!("{prefix}{key}"), kind(&other), "an array")),
    };
    let read = |(i, value)| {
        serde_json::from_value(value).map_err(|e| {
            Fault::invalid(format!("{prefix}{key}[{i}]"), format!("a fault ({e})"), "what glTF 2.0 defines")
        })
    };
    list.into_iter().enumerate().map(read).collect()
}

/// Notes each key below an `extensions` object, wherever it stands. Recursion is bounded by the
/// parser's limit on nesting.
fn find_extensions(
    value: &Value,
    place: &str,
    is_extensions: bool,
    found: &mut BTreeMap<String, (String, usize)>,
) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                if !value.is_object() && !value.is_array() {
                    continue;
                }
                let below = format!("{place}.{key}");
                if is_extensions {
                    found.entry(key.clone()).or_insert_with(|| (below.clone(), 0)).1 += 1;
                }
                if key != "extras" {
                    find_extensions(value, &below, key == "extensions" && !is_extensions, found);
                }
            }
        }
        Value::Array(list) => {
            for (i, value) in list.iter().enumerate().filter(|(_, v)| v.is_object() || v.is_array()) {
                find_extensions(value, &format!("{place}[{i}]"), false, found);
            }
        }
        _ => {}
    }
}

/// What a JSON value is, for messages.
fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}

//! A scene becomes glTF 2.0, as GLB or as JSON with its buffer and pictures beside it.
//!
//! In: a valid scene. Out: files, and a note for whatever neither glTF nor the extension
//! `EPSILUX_scene` can hold. Any viewer shows the scene: spheres have meshes, and the report's materials
//! have their nearest relatives in glTF; the extension beside them says exactly what they are.
//! Invariant: [`crate::import::read`] gives back a scene that renders to the same bytes, with objects,
//! materials, lights and cameras in the same order.
//!
//! Intensities are written in W/sr and W/m^2, one scale with the emission of surfaces; see
//! `KHR_lights_punctual` for candela. Source: glTF 2.0 (Khronos, 2021) and its KHR extensions.

mod buffer;
mod camera;
mod glb;
mod light;
mod material;
mod mesh;
mod node;
mod number;
mod place;
mod sphere;
mod texture;

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

use super::{Encoded, ExportError, OutFile};
use crate::scene::extension::{self, EnvironmentTable, FilmTable, Root, SceneTable};
use crate::scene::notes::Notes;
use crate::scene::text::Word;
use crate::scene::{NoteEffect, Scene};

use buffer::Buffer;
use mesh::Meshes;
use number::{color, single};
use texture::Pictures;

/// Converts a scene; `name` is the file name that it will have.
pub(super) fn encode(scene: &Scene, name: &str, binary: bool) -> Result<Encoded, ExportError> {
    let mut document = Document::new(scene, name, binary);
    document.fill();
    let Document { buffer, used, required, notes, root, pictures, .. } = document;
    let notes = notes.finish();
    let Buffer { bytes, views, accessors } = buffer;
    let mut root = root;
    root.insert("extensionsUsed".into(), json!(used));
    put(&mut root, "extensionsRequired", required.into_iter().map(Value::from).collect());
    put(&mut root, "accessors", accessors);
    put(&mut root, "bufferViews", views);
    let mut files = pictures.finish(&mut root);
    if !bytes.is_empty() {
        let mut entry = json!({ "byteLength": bytes.len() });
        if !binary {
            let path = format!("{}.bin", stem(name));
            entry["uri"] = uri(&path).into();
            files.push(OutFile { path, bytes: bytes.clone() });
        }
        put(&mut root, "buffers", vec![entry]);
    }
    let json = Value::Object(root);
    let bytes = if binary {
        glb::pack(&json.to_string(), &bytes).ok_or_else(|| ExportError::TooLarge { name: name.to_owned() })?
    } else {
        (format!("{json:#}") + "\n").into_bytes()
    };
    files.push(OutFile { path: name.to_owned(), bytes });
    Ok(Encoded { files, notes })
}

/// A document under construction.
struct Document<'s> {
    scene: &'s Scene,
    /// File name of the whole.
    name: &'s str,
    /// Whether pictures go into the file itself.
    binary: bool,
    pictures: Pictures,
    root: Map<String, Value>,
    buffer: Buffer,
    meshes: Meshes,
    nodes: Vec<Value>,
    /// Nodes of the scene that are nobody's child.
    roots: Vec<usize>,
    /// Lights of `KHR_lights_punctual`.
    lights: Vec<Value>,
    /// Extensions that occur.
    used: BTreeSet<&'static str>,
    /// Extensions without which the file is not shown as it should be.
    required: BTreeSet<&'static str>,
    notes: Notes,
}

impl<'s> Document<'s> {
    fn new(scene: &'s Scene, name: &'s str, binary: bool) -> Self {
        Self {
            scene,
            name,
            binary,
            pictures: Pictures::default(),
            root: Map::new(),
            buffer: Buffer::default(),
            meshes: Meshes::default(),
            nodes: Vec::new(),
            roots: Vec::new(),
            lights: Vec::new(),
            used: BTreeSet::new(),
            required: BTreeSet::new(),
            notes: Notes::default(),
        }
    }

    fn fill(&mut self) {
        let generator = concat!("epsilux ", env!("CARGO_PKG_VERSION"));
        self.root.insert("asset".into(), json!({ "version": "2.0", "generator": generator }));
        let scene = self.scene;
        let materials = scene.materials.iter().enumerate().map(|(i, m)| self.material(m, i)).collect();
        put(&mut self.root, "materials", materials);
        for (i, object) in scene.objects.iter().enumerate() {
            self.object(object, i);
        }
        for light in &scene.lights {
            self.light(light);
        }
        for (i, camera) in scene.cameras.iter().enumerate() {
            self.camera(camera, i);
        }
        let cameras = scene.cameras.iter().map(|c| self.camera_entry(c)).collect();
        put(&mut self.root, "cameras", cameras);
        put(&mut self.root, "meshes", std::mem::take(&mut self.meshes.entries));
        put(&mut self.root, "nodes", std::mem::take(&mut self.nodes));

        // The scene, and what belongs to the file.
        let mut entry = Map::new();
        if !scene.title.is_empty() {
            entry.insert("name".into(), scene.title.as_str().into());
        }
        put(&mut entry, "nodes", self.roots.iter().map(|&i| i.into()).collect());
        let table = self.scene_table();
        self.extend(&mut entry, &table);
        self.root.insert("scene".into(), 0.into());
        put(&mut self.root, "scenes", vec![Value::Object(entry)]);
        let mut extensions = Map::new();
        if !self.lights.is_empty() {
            let lights = std::mem::take(&mut self.lights);
            extensions.insert(self.using("KHR_lights_punctual").into(), json!({ "lights": lights }));
        }
        let version = Root { version: extension::VERSION };
        extensions.insert(self.using(extension::NAME).into(), extension::to_json(&version));
        self.root.insert("extensions".into(), extensions.into());
        self.unused();
    }

    /// What surrounds the scene, and the hints how to render it.
    fn scene_table(&mut self) -> SceneTable {
        let settings = &self.scene.settings;
        let film = FilmTable {
            size: settings.size.map(|size| size.map(f64::from)),
            exposure: settings.exposure.map(single),
            tone: settings.tone.map(Word),
            spp: settings.spp.map(f64::from),
            max_depth: settings.max_depth.map(f64::from),
            indirect_gain: settings.indirect_gain.map(single),
        };
        let environment = self.scene.environment.as_ref().map(|e| {
            let picture = e.image.and_then(|image| self.sky(image.image));
            if e.image.is_some() && picture.is_none() {
                let message = "the picture of the environment cannot be encoded: it is left out";
                self.notes.add("texture-lost", NoteEffect::Missing, "environment.image", message);
            }
            let (image, uri) = picture.unwrap_or_default();
            EnvironmentTable {
                name: (e.name != "environment").then(|| e.name.clone()),
                radiance: Some(color(e.radiance)),
                image: image.map(|i| i as f64),
                uri,
                rotation: e.image.map(|i| i.rotation).filter(|r| *r != 0.0),
                visible: (!e.visible_to_camera).then_some(false),
            }
        });
        SceneTable { film: (film != FilmTable::default()).then_some(film), environment, title: None }
    }

    /// Notes the meshes that no object shows, since readers would not find them.
    fn unused(&mut self) {
        for (i, mesh) in self.scene.meshes.iter().enumerate() {
            if !self.meshes.is_used(i) {
                let message = format!("mesh \"{}\", which no object uses, is left out", mesh.name);
                self.notes.add("mesh-unused", NoteEffect::None, format!("meshes[{i}]"), message);
            }
        }
    }

    /// Notes that `name` is used, and returns it.
    fn using(&mut self, name: &'static str) -> &'static str {
        self.used.insert(name);
        name
    }

    /// Adds our own extension to an element, where it says anything.
    fn extend(&mut self, element: &mut Map<String, Value>, table: &impl serde::Serialize) {
        let table = extension::to_json(table);
        if table.as_object().is_some_and(|t| !t.is_empty()) {
            let name = self.using(extension::NAME);
            let extensions = element.entry("extensions").or_insert_with(|| json!({}));
            extensions[name] = table;
        }
    }
}

/// Adds a list, which glTF wants to have an element or not to be there.
fn put(object: &mut Map<String, Value>, key: &str, list: Vec<Value>) {
    if !list.is_empty() {
        object.insert(key.into(), list.into());
    }
}

/// A file name without its suffix.
fn stem(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

/// A relative path as a URI reference (RFC 3986): what is neither unreserved nor `/` is %-escaped.
fn uri(path: &str) -> String {
    let mut out = String::with_capacity(path.len());
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            out.push(byte.into());
        } else {
            out += &format!("%{byte:02X}");
        }
    }
    out
}

#[cfg(test)]
mod tests;

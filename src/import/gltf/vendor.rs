//! The extension `EPSILUX_scene`, and `extras.epsilux`, which is read as the same: see
//! [`crate::scene::extension`] for its tables. Also `EXT_lights_area`, and the spheres of
//! `KHR_implicit_shapes`.
//!
//! In: what the other readers of this folder made of the file. Out: the same, changed by what the
//! extension says. Invariant: nothing in it makes a reader fail, except a version that is not known; a
//! wrong value is left out or clamped, with a note that names its place.

mod camera;
mod check;
mod light;
mod material;
mod scene;

use std::fmt::Display;

use glam::{DAffine3, DMat3, DMat4, DVec4};
use gltf::json;
use serde::de::DeserializeOwned;
use serde_json::value::RawValue;
use serde_json::{Map, Value};

use super::super::error::Fault;
use crate::scene::extension::{LightTable, NAME, NodeTable, VERSION};
use crate::scene::notes::Notes;
use crate::scene::{MAX_LENGTH, MIN_LENGTH, NoteEffect};

pub(super) use camera::camera;
pub(super) use material::material;
pub(super) use scene::scene;

/// What stands at the root and in the scene that is read.
#[derive(Default)]
pub(super) struct Root {
    /// Place of the scene, and its extension and extras.
    scene: (String, Option<Value>, Option<Value>),
    /// Lights of `EXT_lights_area`.
    area_lights: Vec<Value>,
    /// Shapes of `KHR_implicit_shapes`.
    shapes: Vec<Value>,
}

impl Root {
    /// Takes note of what the document `root` holds.
    pub(super) fn of(root: &Map<String, Value>) -> Result<Self, Fault> {
        let extension = |name: &str| root.get("extensions").and_then(|e| e.get(name));
        if let Some(version) = extension(NAME).and_then(|e| e.get("version")) {
            // Whole numbers may come as 1.0.
            let known = version.as_f64() == Some(f64::from(VERSION));
            if !known {
                return Err(Fault::Unsupported {
                    place: format!("extensions.{NAME}.version"),
                    feature: format!("version {version} of {NAME}"),
                    help: format!(
                        "this program reads version {VERSION}: use a newer epsilux, or export for version {VERSION}"
                    ),
                });
            }
        }
        let list = |name: &str, key: &str| {
            let list = extension(name).and_then(|e| e.get(key)).and_then(Value::as_array);
            list.cloned().unwrap_or_default()
        };
        let index = root.get("scene").and_then(Value::as_u64).unwrap_or(0);
        let scene = root.get("scenes").and_then(|s| s.get(index as usize));
        let part = |key: &str, name: &str| scene.and_then(|s| s.get(key)).and_then(|e| e.get(name)).cloned();
        Ok(Self {
            scene: (format!("scenes[{index}]"), part("extensions", NAME), part("extras", "epsilux")),
            area_lights: list("EXT_lights_area", "lights"),
            shapes: list("KHR_implicit_shapes", "shapes"),
        })
    }
}

/// What the extension says about one node.
pub(super) struct Node {
    table: NodeTable,
    /// Where the table stands.
    place: String,
    /// The light of `EXT_lights_area` that the node refers to, and its place.
    area_light: Option<(Value, String)>,
    /// The sphere of `KHR_implicit_shapes` that stands for its mesh.
    shape: Option<f64>,
}

impl Node {
    /// Reads what stands at `node`, which stands at `place`.
    pub(super) fn read(node: &json::Node, place: &str, root: &Root, notes: &mut Notes) -> Self {
        let others = node.extensions.as_ref().map(|e| &e.others);
        let index = |name: &str, key: &str| others?.get(name)?.get(key)?.as_u64().map(|i| i as usize);
        let area_light = index("EXT_lights_area", "light").and_then(|i| {
            let found = root.area_lights.get(i).cloned();
            if found.is_none() {
                let place = format!("{place}.extensions.EXT_lights_area.light");
                ignored(notes, place, format!("there is no light {i}"));
            }
            Some((found?, format!("extensions.EXT_lights_area.lights[{i}]")))
        });
        let shape = index("KHR_implicit_shapes", "shape").and_then(|i| {
            let shape = root.shapes.get(i)?;
            let is_sphere = shape.get("type").and_then(Value::as_str) == Some("sphere");
            let radius = shape.get("sphere").and_then(|s| s.get("radius")).map_or(Some(0.5), Value::as_f64);
            radius.filter(|r| is_sphere && is_length(*r))
        });
        let (table, place) = table::<NodeTable>(others, &node.extras, place, notes);
        Self { table, place, area_light, shape }
    }

    /// The node's own matrix, where it is given in double precision.
    pub(super) fn matrix(&self, notes: &mut Notes) -> Option<DAffine3> {
        let m = DMat4::from_cols_array(&self.table.matrix?);
        if !m.is_finite() || m.row(3) != DVec4::W {
            ignored(notes, format!("{}.matrix", self.place), "its last row is not 0, 0, 0, 1");
            return None;
        }
        Some(DAffine3 {
            matrix3: DMat3::from_cols(m.x_axis.truncate(), m.y_axis.truncate(), m.z_axis.truncate()),
            translation: m.w_axis.truncate(),
        })
    }

    /// The radius of the sphere that stands for the node's mesh; own space.
    pub(super) fn sphere(&self, has_mesh: bool, notes: &mut Notes) -> Option<f64> {
        let Some(sphere) = &self.table.sphere else { return self.shape.filter(|_| has_mesh) };
        let radius = sphere.radius.filter(|r| is_length(*r));
        let message = match radius {
            Some(_) if has_mesh => return radius,
            Some(_) => "a sphere takes its material from the node's mesh, and there is none: it is left out",
            None => "a sphere needs a `radius` above zero: the mesh is kept",
        };
        notes.add("sphere-ignored", NoteEffect::Differs, format!("{}.sphere", self.place), message);
        None
    }

    /// Whether the camera sees the node's surfaces and lights, where the file says so.
    pub(super) fn visible_to_camera(&self) -> Option<bool> {
        self.table.visibility.as_ref()?.camera
    }

    /// True where the extension says all about a light, whatever else stands at the node.
    pub(super) fn has_whole_light(&self) -> bool {
        let whole = |l: &LightTable| {
            l.kind.is_some() && (l.intensity.is_some() || l.irradiance.is_some() || l.radiance.is_some())
        };
        self.table.light.as_ref().is_some_and(whole)
    }
}

/// True for lengths that a scene may have.
fn is_length(v: f64) -> bool {
    (MIN_LENGTH..=MAX_LENGTH).contains(&v)
}

/// The table of an element at `place`, from its extension, else from its extras; with its place.
fn table<T: DeserializeOwned + Default>(
    extensions: Option<&Map<String, Value>>,
    extras: &Option<Box<RawValue>>,
    place: &str,
    notes: &mut Notes,
) -> (T, String) {
    let extension = extensions.and_then(|e| e.get(NAME));
    let extras = extras.as_ref().and_then(|e| serde_json::from_str::<Value>(e.get()).ok());
    choose(extension, extras.as_ref().and_then(|e| e.get("epsilux")), place, notes)
}

/// The same from JSON values.
fn choose<T: DeserializeOwned + Default>(
    extension: Option<&Value>,
    extras: Option<&Value>,
    place: &str,
    notes: &mut Notes,
) -> (T, String) {
    let at_extras = format!("{place}.extras.epsilux");
    if let Some(value) = extension {
        if extras.is_some() {
            let message = format!("the extension {NAME} says it already: the extras are left out");
            notes.add("extras-ignored", NoteEffect::None, at_extras, message);
        }
        let at = format!("{place}.extensions.{NAME}");
        return (tolerant(value.clone(), &at, notes), at);
    }
    let value = match extras {
        None => return (T::default(), at_extras),
        // A custom property may be text, which is easier to type.
        Some(Value::String(text)) => match serde_json::from_str(text) {
            Ok(value) => value,
            Err(e) => {
                ignored(notes, at_extras.clone(), format!("the text is not JSON ({e})"));
                return (T::default(), at_extras);
            }
        },
        Some(value) => value.clone(),
    };
    (tolerant(value, &at_extras, notes), at_extras)
}

/// `value` as a table; what does not fit is taken out of it, with a note for each.
fn tolerant<T: DeserializeOwned + Default>(mut value: Value, place: &str, notes: &mut Notes) -> T {
    loop {
        let error = match serde_path_to_error::deserialize::<_, T>(&value) {
            Ok(table) => return table,
            Err(error) => error,
        };
        let path: Vec<String> = error.path().iter().map(ToString::to_string).collect();
        let removed = remove(&mut value, &path);
        let at = if removed.is_empty() { place.to_owned() } else { format!("{place}.{removed}") };
        ignored(notes, at, error.inner());
        if removed.is_empty() {
            return T::default();
        }
    }
}

/// Removes the innermost member of an object on `path`; returns its own path, empty where there is none.
fn remove(value: &mut Value, path: &[String]) -> String {
    let is_member = |depth: usize, value: &Value| {
        let mut at = value;
        for key in &path[..depth] {
            match at {
                Value::Object(map) => match map.get(key) {
                    Some(inner) => at = inner,
                    None => return false,
                },
                _ => return false,
            }
        }
        at.get(&path[depth]).is_some()
    };
    let Some(depth) = (0..path.len()).rev().find(|&d| is_member(d, value)) else { return String::new() };
    let mut at = value;
    for key in &path[..depth] {
        match at.get_mut(key) {
            Some(inner) => at = inner,
            None => return String::new(),
        }
    }
    match at.as_object_mut() {
        Some(map) => _ = map.remove(&path[depth]),
        None => return String::new(),
    }
    path[..=depth].join(".")
}

/// Notes a value that is left out.
fn ignored(notes: &mut Notes, place: String, why: impl Display) {
    notes.add("extension-value-ignored", NoteEffect::Differs, place, format!("{why}: it is left out"));
}

#[cfg(test)]
mod tests;

//! The extension read, from the page that explains it and from files with mistakes.

use std::path::Path;

use serde_json::{Value, json};

use super::super::super::budget::Budget;
use super::super::super::{ImportError, ReadOptions};
use crate::color::Rgb;
use crate::scene::{AreaShape, LightKind, MaterialKind, Note, Scene, Shape, ToneCurve};

fn read_text(text: &[u8]) -> Result<(Scene, Vec<Note>), ImportError> {
    let options = ReadOptions::default();
    super::super::read_json(text, Path::new("nowhere"), &options, &mut Budget::new(&options))
        .map_err(|fault| fault.at(Path::new("test.gltf")))
}

fn read(doc: &Value) -> (Scene, Vec<Note>) {
    read_text(&serde_json::to_vec(doc).unwrap()).unwrap_or_else(|e| panic!("{e}"))
}

/// A document with one node; `keys` are more of it.
fn document(node: Value, keys: &[(&str, Value)]) -> Value {
    let mut doc = json!({ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }], "nodes": [node] });
    for (key, value) in keys {
        doc[*key] = value.clone();
    }
    doc
}

/// The example that users copy says what it seems to say.
#[test]
fn the_example_of_the_guide_is_read() {
    let page = include_str!("../../../guide/extension.md");
    let example = page.split("```json").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let (scene, notes) = read_text(example.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(notes, []);
    assert_eq!(scene.objects[0].shape, Shape::Sphere { radius: 1.0 });
    let LightKind::Area { shape, size, radiance } = scene.lights[0].kind else { panic!("an area light") };
    assert_eq!((shape, size), (AreaShape::Ellipse, [2.0, 1.0]));
    assert_eq!(radiance, Rgb::from([10.0, 9.0, 8.0]));
    assert!(scene.lights[0].visible_to_camera);
    let MaterialKind::Glass(glass) = &scene.materials[0].kind else { panic!("glass") };
    assert_eq!((glass.ior, glass.tint), (1.5, Rgb::from([0.7, 0.8, 1.0])));
    let camera = &scene.cameras[0];
    assert_eq!(camera.shift, [0.1, 0.0]);
    assert_eq!(camera.lens.map(|l| (l.radius, l.focus_distance)), Some((0.05, 5.0)));
    let environment = scene.environment.unwrap();
    assert!(!environment.visible_to_camera);
    assert_eq!(environment.radiance, Rgb::from([0.1, 0.2, 0.3]));
    let settings = scene.settings;
    assert_eq!((settings.size, settings.spp), (Some([640, 480]), Some(256)));
    assert_eq!((settings.exposure, settings.tone), (Some(0.5), Some(ToneCurve::Agx)));
}

/// Every key of the schema is explained.
#[test]
fn every_key_is_named_in_the_guide() {
    let page = include_str!("../../../guide/extension.md");
    let mut keys = Vec::new();
    collect(&crate::scene::extension::schema(), &mut keys);
    assert!(keys.len() > 50, "{keys:?}");
    let named = |key: &str| page.split(|c: char| !c.is_alphanumeric() && c != '_').any(|w| w == key);
    keys.retain(|k| !named(&k.to_lowercase()) && !["root", "scene", "node", "camera"].contains(&&**k));
    assert_eq!(keys, [""; 0]);
}

fn collect(schema: &Value, keys: &mut Vec<String>) {
    match schema {
        Value::Object(map) => {
            for (key, value) in map {
                if let ("properties", Some(properties)) = (&**key, value.as_object()) {
                    keys.extend(properties.keys().cloned());
                }
                collect(value, keys);
            }
        }
        Value::Array(list) => list.iter().for_each(|v| collect(v, keys)),
        _ => {}
    }
}

/// A mistake costs the value that it is about, and names its place; nothing panics.
#[test]
fn mistakes_cost_one_value_each() {
    let node = json!({ "extensions": { "EPSILUX_scene": {
        "light": { "type": "spot", "intensity": [1, 2, 3], "outer": 9, "radius": "big", "size": [1, 1], "glow": 1 },
        "visibility": { "camera": "no" }, "matrix": [1, 2], "colour": [1],
    } } });
    let scenes = json!([{ "nodes": [0], "extras": { "epsilux": {
        "film": { "size": [0, 1e99], "spp": 2.5, "tone": "warm" }, "environment": { "radiance": [1, -1, 1] } } } }]);
    let (scene, notes) = read(&document(node, &[("scenes", scenes)]));
    let LightKind::Spot { intensity, outer, radius, .. } = scene.lights[0].kind else { panic!("a spot") };
    assert_eq!(intensity, Rgb::from([1.0, 2.0, 3.0]));
    assert_eq!((outer, radius), (std::f64::consts::FRAC_PI_2, 0.0));
    let mut places: Vec<&str> = notes.iter().map(|n| n.place.as_str()).collect();
    places.sort_unstable();
    let at = "nodes[0].extensions.EPSILUX_scene";
    let mut expected: Vec<String> =
        ["colour", "light.glow", "light.outer", "light.radius", "light.size", "matrix", "visibility.camera"]
            .map(|key| format!("{at}.{key}"))
            .into();
    let film = ["environment.radiance", "film.size", "film.size", "film.spp", "film.tone"];
    expected.extend(film.map(|key| format!("scenes[0].extras.epsilux.{key}")));
    expected.sort_unstable();
    assert_eq!(places, expected, "{notes:#?}");
}

/// Extras may be text, as Blender's custom properties are; the extension wins over them.
#[test]
fn extras_are_read_where_there_is_no_extension() {
    let light = r#"{"light": {"type": "sun", "irradiance": [1, 1, 1], "angle": 0.01}}"#;
    let (scene, notes) = read(&document(json!({ "extras": { "epsilux": light } }), &[]));
    assert_eq!(notes, []);
    assert!(matches!(scene.lights[0].kind, LightKind::Sun { angle: 0.01, .. }));
    let both = json!({ "extras": { "epsilux": light }, "extensions": { "EPSILUX_scene": {} } });
    let (scene, notes) = read(&document(both, &[]));
    assert!(scene.lights.is_empty());
    assert_eq!(notes[0].code, "extras-ignored");
}

/// A lamp of KHR_lights_punctual gets a size, and keeps its intensity.
#[test]
fn punctual_lights_are_completed() {
    let node = json!({ "extensions": { "KHR_lights_punctual": { "light": 0 },
        "EPSILUX_scene": { "light": { "radius": 0.5 } } } });
    let lights = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 7 }] } });
    let (scene, _) = read(&document(node, &[("extensions", lights)]));
    assert_eq!(scene.lights[0].kind, LightKind::Point { intensity: Rgb::grey(7.0), radius: 0.5 });
}

/// Area lights of EXT_lights_area are scaled evenly, by the largest scale.
#[test]
fn other_programs_area_lights_are_read() {
    let node = json!({ "scale": [1, 3, 2], "extensions": { "EXT_lights_area": { "light": 0 } } });
    let light = json!({ "type": "rect", "intensity": 2, "size": 0.5, "rect": { "aspect": 4 } });
    let lights = json!({ "EXT_lights_area": { "lights": [light] } });
    let (scene, notes) = read(&document(node, &[("extensions", lights)]));
    assert_eq!(notes, []);
    let light = &scene.lights[0];
    let (shape, radiance) = (AreaShape::Rectangle, Rgb::grey(2.0));
    assert_eq!(light.kind, LightKind::Area { shape, size: [2.0, 0.5], radiance });
    assert_eq!(light.transform.matrix3.x_axis.length(), 3.0);
}

/// A file from the future is refused with what helps.
#[test]
fn newer_versions_are_refused() {
    let root = json!({ "EPSILUX_scene": { "version": 2 } });
    let doc = document(json!({}), &[("extensions", root)]);
    let error = read_text(&serde_json::to_vec(&doc).unwrap()).unwrap_err().to_string();
    assert!(
        error.contains("version 2 of EPSILUX_scene is not supported; this program reads version 1"),
        "{error}"
    );
}

//! Small glTF documents for tests.

use std::path::Path;

use serde_json::{Value, json};

use super::super::super::budget::Budget;
use super::super::super::{ImportError, ReadOptions};
use crate::scene::{Note, Principled, Scene};

/// Bytes of little-endian floats.
pub(super) fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A data URI of `bytes`, %-escaped so that no test depends on base64.
pub(super) fn uri(bytes: &[u8]) -> String {
    let body: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    format!("data:application/octet-stream,{body}")
}

/// Positions of a unit square in the xy plane; its two triangles are 0 1 2 and 0 2 3.
pub(super) const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];

/// A square with 16-bit indices, on one node.
pub(super) fn square() -> Value {
    let mut bytes = floats(&SQUARE);
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "square", "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
        ],
        "buffers": [{"byteLength": 60, "uri": uri(&bytes)}],
    })
}

/// The square, with the values at `changes` set; a place is a JSON pointer, and objects grow.
pub(super) fn square_with(changes: &[(&str, Value)]) -> Value {
    let mut doc = square();
    for (pointer, value) in changes {
        set(&mut doc, pointer, value.clone());
    }
    doc
}

/// Sets what `pointer` names; the last step may add a key or an element.
pub(super) fn set(doc: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').expect("a JSON pointer");
    match doc.pointer_mut(parent) {
        Some(Value::Object(map)) => {
            map.insert(key.into(), value);
        }
        Some(Value::Array(list)) => match key.parse::<usize>() {
            Ok(i) if i < list.len() => list[i] = value,
            _ => list.push(value),
        },
        other => panic!("{parent} is {other:?}"),
    }
}

/// Reads a document with default options, or with others.
pub(super) fn read(doc: &Value) -> Result<(Scene, Vec<Note>), ImportError> {
    read_as(doc, &ReadOptions::default())
}

pub(super) fn read_as(doc: &Value, options: &ReadOptions) -> Result<(Scene, Vec<Note>), ImportError> {
    let text = serde_json::to_vec(doc).unwrap();
    read_text(&text, options)
}

pub(super) fn read_text(text: &[u8], options: &ReadOptions) -> Result<(Scene, Vec<Note>), ImportError> {
    let mut budget = Budget::new(options);
    super::super::read_json(text, Path::new("nowhere"), options, &mut budget)
        .map_err(|fault| fault.at(Path::new("test.gltf")))
}

/// The document as GLB, its first buffer as the binary chunk.
pub(super) fn glb(doc: &Value, bin: &[u8]) -> Vec<u8> {
    let mut json = serde_json::to_vec(doc).unwrap();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let word = |out: &mut Vec<u8>, n: usize| out.extend((n as u32).to_le_bytes());
    word(&mut out, 2);
    word(&mut out, 12 + 8 + json.len() + 8 + bin.len());
    word(&mut out, json.len());
    out.extend(b"JSON");
    out.extend(json);
    word(&mut out, bin.len());
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

pub(super) fn read_glb(bytes: &[u8]) -> Result<(Scene, Vec<Note>), ImportError> {
    let options = ReadOptions { max_bytes: 1 << 20, ..ReadOptions::default() };
    super::super::read_glb(bytes, Path::new("nowhere"), &options, &mut Budget::new(&options))
        .map_err(|fault| fault.at(Path::new("test.glb")))
}

/// Notes as lines: code, effect, place and message.
pub(super) fn lines(notes: &[Note]) -> String {
    notes.iter().map(|n| format!("{} ({:?}) {n}\n", n.code, n.effect)).collect()
}

/// The principled material at `index`.
pub(super) fn principled(scene: &Scene, index: usize) -> &Principled {
    match &scene.materials[index].kind {
        crate::scene::MaterialKind::Principled(p) => p,
        other => panic!("{other:?}"),
    }
}

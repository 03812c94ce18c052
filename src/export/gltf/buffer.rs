//! The one buffer, with a view for each accessor.

use serde_json::{Value, json};

use super::number::single;

/// What a view is for: vertex attributes.
const ARRAY: u32 = 34962;
/// What a view is for: indices.
const ELEMENT_ARRAY: u32 = 34963;

/// Bytes, and what lies where in them. Every view begins at a multiple of four.
#[derive(Default)]
pub(super) struct Buffer {
    pub(super) bytes: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl Buffer {
    /// Adds vertex attributes of `N` floats each, and returns their accessor. Positions need their exact
    /// bounds.
    pub(super) fn floats<const N: usize>(&mut self, list: &[[f32; N]], with_bounds: bool) -> usize {
        let bytes: Vec<u8> = list.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(ARRAY));
        let mut accessor = json!({
            "bufferView": view,
            "componentType": 5126,
            "count": list.len(),
            "type": format!("VEC{N}"),
        });
        if with_bounds {
            let fold = |f: fn(f32, f32) -> f32, start: f32| -> Vec<f64> {
                (0..N).map(|k| single(list.iter().fold(start, |m, v| f(m, v[k])))).collect()
            };
            accessor["min"] = fold(f32::min, f32::INFINITY).into();
            accessor["max"] = fold(f32::max, f32::NEG_INFINITY).into();
        }
        self.accessor(accessor)
    }

    /// Adds the indices of triangles over `vertices` vertices, as shorts where those suffice.
    pub(super) fn indices(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        // The largest value of a type means a restart, and is no index.
        let is_short = vertices <= usize::from(u16::MAX);
        let indices = triangles.iter().flatten();
        let bytes: Vec<u8> = if is_short {
            indices.flat_map(|&i| (i as u16).to_le_bytes()).collect()
        } else {
            indices.flat_map(|i| i.to_le_bytes()).collect()
        };
        let view = self.view(&bytes, Some(ELEMENT_ARRAY));
        self.accessor(json!({
            "bufferView": view,
            "componentType": if is_short { 5123 } else { 5125 },
            "count": 3 * triangles.len(),
            "type": "SCALAR",
        }))
    }

    /// Adds bytes, and returns their view.
    pub(super) fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteLength": bytes.len() });
        if !self.bytes.is_empty() {
            view["byteOffset"] = self.bytes.len().into();
        }
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    /// Adds an accessor.
    pub(super) fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

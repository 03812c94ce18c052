//! Cameras.

use std::f64::consts::PI;

use serde_json::{Map, Value, json};

use super::Document;
use crate::scene::extension::{CameraTable, LensTable, NodeTable};
use crate::scene::text::Word;
use crate::scene::{Camera, FovAxis, Projection};

/// Where viewers begin to show something, metres; rays begin at zero.
const NEAR: f64 = 0.01;
/// Where viewers that need an end stop, metres.
const FAR: f64 = 1000.0;
/// Width over height where nothing says one.
const ASPECT: f64 = 4.0 / 3.0;

impl Document<'_> {
    /// Writes the node of camera `index`.
    pub(super) fn camera(&mut self, camera: &Camera, index: usize) {
        let mut node = Map::new();
        node.insert("camera".into(), index.into());
        self.place(&camera.name, node, NodeTable::default(), &camera.transform);
    }

    /// The entry of a camera.
    pub(super) fn camera_entry(&mut self, camera: &Camera) -> Value {
        let size = self.scene.settings.size.map(|[w, h]| f64::from(w) / f64::from(h));
        let aspect = camera.aspect.or(size).unwrap_or(ASPECT);
        let mut table = CameraTable {
            shift: (camera.shift != [0.0; 2]).then_some(camera.shift),
            lens: camera.lens.map(|l| LensTable { radius: Some(l.radius), focus: Some(l.focus_distance) }),
            ..CameraTable::default()
        };
        let axis_word = |axis: FovAxis| (axis != FovAxis::Vertical).then_some(Word(axis));
        let single = |v: f64| f64::from(v as f32);
        let mut entry = match camera.projection {
            Projection::Perspective { fov, axis } => {
                let yfov = match axis {
                    FovAxis::Vertical => fov,
                    FovAxis::Horizontal => 2.0 * libm::atan(libm::tan(0.5 * fov) / aspect),
                };
                // Singles have no number just below a half turn.
                let yfov = yfov.min(PI * (1.0 - 1e-6));
                if axis != FovAxis::Vertical || single(yfov) != fov {
                    (table.fov, table.fov_axis) = (Some(fov), axis_word(axis));
                }
                let mut perspective = json!({ "yfov": yfov, "znear": NEAR });
                if let Some(a) = camera.aspect {
                    perspective["aspectRatio"] = a.into();
                    table.aspect = (single(a) != a).then_some(a);
                }
                json!({ "type": "perspective", "perspective": perspective })
            }
            Projection::Orthographic { extent, axis } => {
                let (x, y) = match axis {
                    FovAxis::Vertical => (extent * aspect, extent),
                    FovAxis::Horizontal => (extent, extent / aspect),
                };
                (table.extent, table.fov_axis) = (Some(extent), axis_word(axis));
                table.aspect = camera.aspect;
                let bounds = json!({ "xmag": 0.5 * x, "ymag": 0.5 * y, "znear": NEAR, "zfar": FAR });
                json!({ "type": "orthographic", "orthographic": bounds })
            }
        };
        if !camera.name.is_empty() {
            entry["name"] = camera.name.as_str().into();
        }
        if let Value::Object(entry) = &mut entry {
            self.extend(entry, &table);
        }
        entry
    }
}

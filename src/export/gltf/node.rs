//! Objects, and the nodes that place everything.

use serde_json::{Map, Value, json};

use super::Document;
use super::place::{Place, place};
use crate::scene::extension::{NodeTable, SphereTable, VisibilityTable};
use crate::scene::{NoteEffect, Object, Shape};

impl Document<'_> {
    /// Writes an object as a node with a mesh.
    pub(super) fn object(&mut self, object: &Object, index: usize) {
        let mut table = NodeTable::default();
        let mesh = match object.shape {
            Shape::Sphere { radius } => {
                table.sphere = Some(SphereTable { radius: Some(radius) });
                Some(self.ball(radius, object.material))
            }
            Shape::Mesh(id) => self.mesh(id, object.material),
        };
        let Some(mesh) = mesh else {
            let message = format!("object \"{}\" has no triangles: it is left out", object.name);
            self.notes.add("object-empty", NoteEffect::None, format!("objects[{index}]"), message);
            return;
        };
        if !object.visible_to_camera {
            table.visibility = Some(VisibilityTable { camera: Some(false) });
        }
        let mut node = Map::new();
        node.insert("mesh".into(), mesh.into());
        self.place(&object.name, node, table, &object.transform);
    }

    /// Adds `node`, called `name` and placed by `transform`, to the scene.
    pub(super) fn place(
        &mut self,
        name: &str,
        mut node: Map<String, Value>,
        mut table: NodeTable,
        transform: &glam::DAffine3,
    ) {
        if !name.is_empty() {
            node.insert("name".into(), name.into());
        }
        let (mut keys, matrix, parent) = match place(transform) {
            Place::One(placed) => (placed.keys, placed.matrix, None),
            Place::Two(parent, child) => (child.keys, child.matrix, Some(parent)),
        };
        node.append(&mut keys);
        table.matrix = matrix;
        self.extend(&mut node, &table);
        self.nodes.push(Value::Object(node));
        let child = self.nodes.len() - 1;
        let root = match parent {
            None => child,
            Some(parent) => {
                let mut keys = parent.keys;
                keys.insert("name".into(), format!("{name} (shear)").into());
                keys.insert("children".into(), json!([child]));
                self.extend(&mut keys, &NodeTable { matrix: parent.matrix, ..NodeTable::default() });
                self.nodes.push(Value::Object(keys));
                self.nodes.len() - 1
            }
        };
        self.roots.push(root);
    }
}

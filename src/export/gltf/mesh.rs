//! Meshes: each written once, and a glTF mesh for each material that it is seen with.

use std::collections::HashMap;

use glam::Vec4;
use serde_json::{Value, json};

use super::{Document, sphere};
use crate::scene::{MaterialId, MaterialKind, Mesh, MeshId, NoteEffect};

/// What has been written.
#[derive(Default)]
pub(super) struct Meshes {
    /// The document's `meshes`.
    pub(super) entries: Vec<Value>,
    /// Attributes and indices of the scene's meshes; `None` for those without triangles.
    geometry: HashMap<MeshId, Option<Geometry>>,
    /// The entries of the scene's meshes, by material.
    meshes: HashMap<(MeshId, MaterialId), usize>,
    /// Normals, texture coordinates and indices of all spheres.
    ball: Option<(usize, usize, usize)>,
    /// Positions of spheres, by the bits of their radius.
    positions: HashMap<u32, usize>,
    /// The entries of spheres, by radius and material.
    spheres: HashMap<(u32, MaterialId), usize>,
}

/// Accessors of a mesh.
#[derive(Clone)]
struct Geometry {
    attributes: Value,
    indices: usize,
}

impl Meshes {
    /// Whether an object shows the scene's mesh `index`.
    pub(super) fn is_used(&self, index: usize) -> bool {
        self.geometry.contains_key(&MeshId(index as u32))
    }
}

impl Document<'_> {
    /// The entry of mesh `id` with `material`; `None` where it has no triangles.
    pub(super) fn mesh(&mut self, id: MeshId, material: MaterialId) -> Option<usize> {
        if let Some(&known) = self.meshes.meshes.get(&(id, material)) {
            return Some(known);
        }
        let mesh = self.scene.meshes.get(id.0 as usize)?;
        let geometry = match self.meshes.geometry.get(&id) {
            Some(known) => known.clone(),
            None => {
                let written = self.geometry(mesh, &format!("meshes[{}]", id.0));
                self.meshes.geometry.insert(id, written.clone());
                written
            }
        }?;
        let geometry = self.with_uvs(geometry, mesh.positions.len(), material);
        let entry = self.entry(&mesh.name, geometry, material);
        self.meshes.meshes.insert((id, material), entry);
        Some(entry)
    }

    /// The entry of the mesh that stands for a sphere of `radius`.
    pub(super) fn ball(&mut self, radius: f64, material: MaterialId) -> usize {
        // Radii that singles cannot tell apart look the same.
        let radius = radius as f32;
        let bits = radius.to_bits();
        if let Some(&known) = self.meshes.spheres.get(&(bits, material)) {
            return known;
        }
        let (points, uvs) = sphere::vertices();
        let (normals, uvs, indices) = match self.meshes.ball {
            Some(known) => known,
            None => {
                let normals: Vec<_> = points.iter().map(|p| p.map(|v| v as f32)).collect();
                let normals = self.buffer.floats(&normals, false);
                let uvs = self.buffer.floats(&uvs, false);
                let indices = self.buffer.indices(&sphere::triangles(), points.len());
                *self.meshes.ball.insert((normals, uvs, indices))
            }
        };
        let positions = match self.meshes.positions.get(&bits) {
            Some(&known) => known,
            None => {
                let list: Vec<_> = points.iter().map(|p| p.map(|v| (v * f64::from(radius)) as f32)).collect();
                let written = self.buffer.floats(&list, true);
                self.meshes.positions.insert(bits, written);
                written
            }
        };
        let attributes = json!({ "POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs });
        let geometry = self.with_uvs(Geometry { attributes, indices }, points.len(), material);
        let entry = self.entry("sphere", geometry, material);
        self.meshes.spheres.insert((bits, material), entry);
        entry
    }

    /// `geometry`, with zeros for texture coordinates that the material asks for in vain: glTF wants
    /// them to be there.
    fn with_uvs(&mut self, mut geometry: Geometry, vertices: usize, material: MaterialId) -> Geometry {
        let kind = self.scene.materials.get(material.0 as usize).map(|m| &m.kind);
        let Some(MaterialKind::Principled(p)) = kind else { return geometry };
        for (_, texture) in p.textures.iter() {
            let key = format!("TEXCOORD_{}", texture.uv_set);
            if geometry.attributes.get(&key).is_none() {
                let zeros = json!({ "componentType": 5126, "count": vertices, "type": "VEC2" });
                geometry.attributes[&key] = self.buffer.accessor(zeros).into();
            }
        }
        geometry
    }

    fn entry(&mut self, name: &str, geometry: Geometry, material: MaterialId) -> usize {
        let primitive = json!({
            "attributes": geometry.attributes,
            "indices": geometry.indices,
            "material": material.0,
        });
        let mut entry = json!({ "primitives": [primitive] });
        if !name.is_empty() {
            entry["name"] = name.into();
        }
        self.meshes.entries.push(entry);
        self.meshes.entries.len() - 1
    }

    /// Writes the accessors of a mesh; `None` where it has no triangles, since glTF has no empty lists.
    fn geometry(&mut self, mesh: &Mesh, place: &str) -> Option<Geometry> {
        if mesh.triangles.is_empty() {
            return None;
        }
        let rows = |list: &[glam::Vec3]| list.iter().map(|v| v.to_array()).collect::<Vec<_>>();
        let mut attributes = json!({ "POSITION": self.buffer.floats(&rows(&mesh.positions), true) });
        if !mesh.normals.is_empty() {
            attributes["NORMAL"] = self.buffer.floats(&rows(&mesh.normals), false).into();
        }
        if !mesh.tangents.is_empty() {
            let list: Vec<_> = mesh.tangents.iter().map(|t| t.to_array()).collect();
            attributes["TANGENT"] = self.buffer.floats(&list, false).into();
        }
        for (uvs, key) in mesh.uvs.iter().zip(["TEXCOORD_0", "TEXCOORD_1"]) {
            if !uvs.is_empty() {
                let list: Vec<_> = uvs.iter().map(|uv| uv.to_array()).collect();
                attributes[key] = self.buffer.floats(&list, false).into();
            }
        }
        if !mesh.colors.is_empty() {
            let good = |c: &Vec4| c.clamp(Vec4::ZERO, Vec4::ONE);
            let over = mesh.colors.iter().filter(|c| good(c) != **c).count();
            if over > 0 {
                let message = format!("{over} vertex colours above one: glTF has them up to one");
                self.notes.add("vertex-colors-clamped", NoteEffect::Differs, place, message);
            }
            let list: Vec<_> = mesh.colors.iter().map(|c| good(c).to_array()).collect();
            attributes["COLOR_0"] = self.buffer.floats(&list, false).into();
        }
        Some(Geometry { attributes, indices: self.buffer.indices(&mesh.triangles, mesh.positions.len()) })
    }
}

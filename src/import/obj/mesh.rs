//! `tobj`'s models become meshes and objects; equal meshes become the same.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use glam::{DAffine3, Vec2, Vec3, Vec4};

use super::super::error::Fault;
use crate::scene::{MaterialId, Mesh, MeshId, Object, Scene, Shape};

/// Meshes by hash of their content.
#[derive(Default)]
pub(super) struct Shared(HashMap<u64, Vec<MeshId>>);

impl Shared {
    /// Adds an object called `name`.
    pub(super) fn add(
        &mut self,
        scene: &mut Scene,
        name: &str,
        material: MaterialId,
        model: tobj::Mesh,
    ) -> Result<(), Fault> {
        let mesh = Mesh { name: name.into(), ..convert(model)? };
        let id = self.insert(&mut scene.meshes, mesh);
        scene.objects.push(Object {
            name: name.into(),
            shape: Shape::Mesh(id),
            material,
            transform: DAffine3::IDENTITY,
            visible_to_camera: true,
        });
        Ok(())
    }

    fn insert(&mut self, list: &mut Vec<Mesh>, mesh: Mesh) -> MeshId {
        let mut hasher = DefaultHasher::new();
        mesh.triangles.hash(&mut hasher);
        for p in &mesh.positions {
            p.to_array().map(f32::to_bits).hash(&mut hasher);
        }
        let same_hash = self.0.entry(hasher.finish()).or_default();
        let equal = |id: &MeshId| {
            let other = &list[id.0 as usize];
            other.triangles == mesh.triangles
                && other.positions == mesh.positions
                && other.normals == mesh.normals
                && other.uvs == mesh.uvs
                && other.colors == mesh.colors
        };
        if let Some(&id) = same_hash.iter().find(|id| equal(id)) {
            return id;
        }
        let id = MeshId(list.len() as u32);
        same_hash.push(id);
        list.push(mesh);
        id
    }
}

/// A model with a single index for everything.
fn convert(model: tobj::Mesh) -> Result<Mesh, Fault> {
    let triples = |list: &[f32]| list.chunks_exact(3).map(Vec3::from_slice).collect::<Vec<_>>();
    let positions = triples(&model.positions);
    let normals = triples(&model.normals);
    // The file's v runs up, the scene's down.
    let uvs: Vec<_> = model.texcoords.chunks_exact(2).map(|uv| Vec2::new(uv[0], 1.0 - uv[1])).collect();
    let colors: Vec<Vec4> = triples(&model.vertex_color).into_iter().map(|c| c.extend(1.0)).collect();
    let triangles = model.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    let count = positions.len();
    for length in [normals.len(), uvs.len(), colors.len()] {
        if length != 0 && length != count {
            let found = format!("{length} attributes for {count} positions");
            return Err(Fault::invalid("the triangulated mesh", found, "one for each, or none"));
        }
    }
    Ok(Mesh { positions, normals, uvs: [uvs, Vec::new()], colors, triangles, ..Mesh::default() })
}

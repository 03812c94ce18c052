//! What the reference integrator finds at a hit beside its place: texture coordinates, colour, and the
//! frame of normal maps.

use glam::{DMat3, DVec2, DVec3, DVec4};

use super::geometry::Hit;
use crate::scene::tangents::{TangentFrames, tangent_frames};
use crate::scene::{MaterialKind, Mesh, Scene, Shape};

/// Meshes as they are, and how objects lay them.
#[derive(Debug)]
pub(super) struct Details {
    meshes: Vec<Mesh>,
    frames: Vec<[Option<TangentFrames>; 2]>,
    /// For each object of the scene: its mesh, and the rotation of normals.
    objects: Vec<Option<(usize, DMat3)>>,
}

/// What is interpolated at a hit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Detail {
    pub(super) uv: [DVec2; 2],
    /// Vertex colour with alpha; white where there is none.
    pub(super) color: DVec4,
}

impl Details {
    pub(super) fn new(scene: &Scene) -> Self {
        let mut mapped = vec![[false; 2]; scene.meshes.len()];
        for object in &scene.objects {
            if let (Shape::Mesh(id), Some(material)) =
                (object.shape, scene.materials.get(object.material.0 as usize))
                && let MaterialKind::Principled(p) = &material.kind
                && let Some(normal) = &p.textures.normal
            {
                mapped[id.0 as usize][usize::from(normal.texture.uv_set)] = true;
            }
        }
        let frames = |(mesh, mapped): (&Mesh, &[bool; 2])| {
            [0, 1].map(|set| mapped[set].then(|| tangent_frames(mesh, set)).flatten())
        };
        let objects = scene.objects.iter().map(|object| match object.shape {
            Shape::Mesh(id) => Some((id.0 as usize, object.transform.matrix3.inverse().transpose())),
            Shape::Sphere { .. } => None,
        });
        Self {
            frames: scene.meshes.iter().zip(&mapped).map(frames).collect(),
            meshes: scene.meshes.clone(),
            objects: objects.collect(),
        }
    }

    /// The values at a hit; (0, 0) and white where there are none.
    pub(super) fn at(&self, hit: &Hit) -> Detail {
        let mut detail = Detail { uv: [DVec2::ZERO; 2], color: DVec4::ONE };
        let Some((mesh, _)) = self.objects[hit.object] else { return detail };
        let mesh = &self.meshes[mesh];
        let corners = mesh.triangles[hit.triangle];
        let weighted = || corners.iter().map(|i| *i as usize).zip(hit.weights);
        for (uv, list) in detail.uv.iter_mut().zip(&mesh.uvs) {
            if !list.is_empty() {
                *uv = weighted().map(|(i, w)| w * list[i].as_dvec2()).sum();
            }
        }
        if !mesh.colors.is_empty() {
            detail.color = weighted().map(|(i, w)| w * mesh.colors[i].as_dvec4()).sum();
        }
        detail
    }

    /// World-space normal, unit, for the components `map` along tangent, bitangent and normal, which are
    /// interpolated in the mesh's own space and not made unit; none without a frame.
    pub(super) fn normal(&self, hit: &Hit, uv_set: usize, map: DVec3) -> Option<DVec3> {
        let (mesh, to_normal) = self.objects[hit.object]?;
        let frames = self.frames[mesh][uv_set].as_ref()?;
        let corners = frames.corners[hit.triangle].map(|i| i as usize);
        let n: DVec3 = corners.iter().zip(hit.weights).map(|(&i, w)| w * frames.normals[i].as_dvec3()).sum();
        let t: DVec3 =
            corners.iter().zip(hit.weights).map(|(&i, w)| w * frames.tangents[i].as_dvec4().truncate()).sum();
        let sign = f64::from(frames.tangents[corners[0]].w);
        (to_normal * (map.x * t + map.y * sign * n.cross(t) + map.z * n)).try_normalize()
    }
}

//! Frames for normal maps: those of a mesh's own tangents, else MikkTSpace's, which is what normal maps
//! are made for (M. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008).
//!
//! In: a valid mesh. Out: a normal and a tangent for each corner of each triangle, in the mesh's own
//! space; corners that agree share theirs. Both integrators use these frames, so that they differ about
//! what is done with them only.

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, Ops, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

use super::Mesh;

/// Normals and tangents of a mesh's corners, own space.
#[derive(Clone, Debug, Default)]
pub(crate) struct TangentFrames {
    /// Unit.
    pub(crate) normals: Vec<Vec3>,
    /// Unit, and in w the sign of the bitangent, which is w (normal x tangent): it points up in the picture.
    pub(crate) tangents: Vec<Vec4>,
    /// Indices into both, for each triangle of the mesh.
    pub(crate) corners: Vec<[u32; 3]>,
}

/// The frames for normal maps that lie by the texture coordinates `uv_set`; `None` where the mesh has
/// neither tangents nor these coordinates.
pub(crate) fn tangent_frames(mesh: &Mesh, uv_set: usize) -> Option<TangentFrames> {
    if !mesh.tangents.is_empty() && !mesh.normals.is_empty() {
        let (normals, tangents) = (mesh.normals.clone(), mesh.tangents.clone());
        return Some(TangentFrames { normals, tangents, corners: mesh.triangles.clone() });
    }
    let mut frames = Welded::default();
    let corner_normals: Vec<[Vec3; 3]> = mesh.triangles.iter().map(|t| normals(mesh, t)).collect();
    let corner_tangents = if mesh.tangents.is_empty() {
        let uvs = Some(&mesh.uvs[uv_set]).filter(|uvs| !uvs.is_empty())?;
        generate(mesh, uvs, &corner_normals)
    } else {
        mesh.triangles.iter().map(|t| t.map(|i| mesh.tangents[i as usize])).collect()
    };
    let corners = corner_normals.iter().zip(&corner_tangents);
    let corners = corners.map(|(n, t)| std::array::from_fn(|k| frames.index(n[k], t[k]))).collect();
    Some(TangentFrames { normals: frames.normals, tangents: frames.tangents, corners })
}

/// Normals of a triangle's corners; those of the triangle where the mesh has none.
fn normals(mesh: &Mesh, t: &[u32; 3]) -> [Vec3; 3] {
    if !mesh.normals.is_empty() {
        return t.map(|i| mesh.normals[i as usize]);
    }
    let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
    [(b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |n| n.as_vec3()); 3]
}

/// Frames that are equal, bit for bit, once.
#[derive(Default)]
struct Welded {
    normals: Vec<Vec3>,
    tangents: Vec<Vec4>,
    known: HashMap<[u32; 7], u32>,
}

impl Welded {
    fn index(&mut self, n: Vec3, t: Vec4) -> u32 {
        let key = [n.x, n.y, n.z, t.x, t.y, t.z, t.w].map(f32::to_bits);
        *self.known.entry(key).or_insert_with(|| {
            self.normals.push(n);
            self.tangents.push(t);
            self.normals.len() as u32 - 1
        })
    }
}

/// What MikkTSpace reads and writes.
struct Input<'a> {
    mesh: &'a Mesh,
    uvs: &'a [Vec2],
    normals: &'a [[Vec3; 3]],
    /// A power of two that brings lengths near one: nothing changes but that squares keep their digits.
    scale: f32,
    tangents: Vec<[Vec4; 3]>,
}

/// The same functions on every CPU.
struct Exact;

impl Ops for Exact {
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }

    fn acos(x: f32) -> f32 {
        libm::acosf(x)
    }
}

impl Geometry<Exact> for Input<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, vert: usize) -> [f32; 3] {
        (self.mesh.positions[self.mesh.triangles[face][vert] as usize] * self.scale).to_array()
    }

    fn normal(&self, face: usize, vert: usize) -> [f32; 3] {
        self.normals[face][vert].to_array()
    }

    fn tex_coord(&self, face: usize, vert: usize) -> [f32; 2] {
        // Upwards in the picture, as the green of normal maps has it; ours count downwards.
        let uv = self.uvs[self.mesh.triangles[face][vert] as usize];
        [uv.x, -uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, vert: usize) {
        if let Some(space) = space {
            self.tangents[face][vert] = Vec4::from_array(space.tangent_encoded());
        }
    }
}

/// Tangents of each triangle's corners. Zero, which maps no normal, where there is nothing to go by.
fn generate(mesh: &Mesh, uvs: &[Vec2], normals: &[[Vec3; 3]]) -> Vec<[Vec4; 3]> {
    let largest = mesh.positions.iter().map(|p| p.abs().max_element()).fold(f32::MIN_POSITIVE, f32::max);
    // 2^-floor(log2(largest)), from the exponent alone.
    let scale = libm::ldexpf(1.0, -libm::ilogbf(largest));
    let tangents = vec![[Vec4::W; 3]; mesh.triangles.len()];
    let mut input = Input { mesh, uvs, normals, scale, tangents };
    match generate_tangents(&mut input) {
        Ok(()) => input.tangents,
        Err(_) => vec![[Vec4::W; 3]; mesh.triangles.len()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two squares side by side that face +z; the second one's picture is mirrored.
    fn mirrored_pair() -> Mesh {
        let square = |x: f32| [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]];
        let positions = square(0.0).into_iter().chain(square(1.0)).map(|[x, y]| Vec3::new(x, y, 0.0));
        let uvs = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        let other = uvs.map(|[u, v]| [1.0 - u, v]);
        Mesh {
            positions: positions.collect(),
            uvs: [uvs.into_iter().chain(other).map(Vec2::from).collect(), Vec::new()],
            triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
            ..Mesh::default()
        }
    }

    /// Guards the sense of the frames: the tangent points right in the picture and the bitangent up; a
    /// mirrored picture has the other sign.
    #[test]
    fn mirrored_pictures_have_the_opposite_sign() {
        let frames = tangent_frames(&mirrored_pair(), 0).expect("texture coordinates");
        for (i, corners) in frames.corners.iter().enumerate() {
            for &c in corners {
                let (n, t) = (frames.normals[c as usize], frames.tangents[c as usize]);
                let right = if i < 2 { Vec3::X } else { -Vec3::X };
                assert!(n == Vec3::Z && t.truncate().distance(right) < 1e-6, "{i} {n} {t}");
                assert!((n.cross(t.truncate()) * t.w).distance(Vec3::Y) < 1e-6, "{i} {t}");
            }
        }
        // One frame for each square.
        assert_eq!(frames.normals.len(), 2);
    }

    /// Guards scale: frames do not depend on how large the mesh is.
    #[test]
    fn frames_do_not_depend_on_scale() {
        let mesh = mirrored_pair();
        let expected = tangent_frames(&mesh, 0).expect("frames");
        for scale in [libm::ldexpf(1.0, -40), libm::ldexpf(1.0, 40)] {
            let positions = mesh.positions.iter().map(|p| *p * scale).collect();
            let found = tangent_frames(&Mesh { positions, ..mesh.clone() }, 0).expect("frames");
            assert_eq!(found.tangents, expected.tangents);
        }
    }

    /// Guards what is taken from where: stored tangents before generated ones, and none at all without
    /// either.
    #[test]
    fn stored_tangents_win() {
        let mut mesh = mirrored_pair();
        assert!(tangent_frames(&mesh, 1).is_none());
        mesh.tangents = vec![Vec4::new(0.0, 1.0, 0.0, -1.0); 8];
        let frames = tangent_frames(&mesh, 1).expect("stored");
        assert_eq!(frames.tangents, [Vec4::new(0.0, 1.0, 0.0, -1.0)]);
        assert_eq!(frames.normals, [Vec3::Z]);
        mesh.normals = vec![Vec3::Z; 8];
        assert_eq!(tangent_frames(&mesh, 0).expect("stored").corners, mesh.triangles);
    }
}

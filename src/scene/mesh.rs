//! Triangle meshes.

use glam::{Vec2, Vec3, Vec4};

/// An indexed triangle mesh in its own space; counter-clockwise is the front.
///
/// The attribute lists are either empty or as long as `positions`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// For people and error messages.
    pub name: String,
    /// Vertex positions, metres, own space.
    pub positions: Vec<Vec3>,
    /// Shading normals, unit, own space; empty means flat shading.
    pub normals: Vec<Vec3>,
    /// Tangents, unit, own space; w is the handedness of the bitangent, +1 or -1.
    pub tangents: Vec<Vec4>,
    /// Two sets of texture coordinates; the origin is the top left of the picture, as in glTF.
    pub uvs: [Vec<Vec2>; 2],
    /// Linear vertex colours with alpha: factors on the colour of diffuse and on base colour and alpha of
    /// principled materials.
    pub colors: Vec<Vec4>,
    /// Three vertex indices a triangle.
    pub triangles: Vec<[u32; 3]>,
}

//! Normals from textures.

use glam::DVec3;

use super::detail::{Detail, Tangent};
use super::texture::Sampler;
use crate::scene::NormalTexture;

/// A tangent-space normal map.
#[derive(Clone, Debug)]
pub(crate) struct NormalMap {
    sampler: Sampler,
    scale: f32,
}

impl NormalMap {
    pub(super) fn new(n: &NormalTexture, sampler: Sampler) -> Self {
        Self { sampler, scale: n.scale }
    }

    /// The mapped normal in the mesh's own space, not unit: x t + y w (n x t) + z n with the interpolated
    /// normal and tangent as they are.
    pub(crate) fn normal(&self, detail: &Detail, tangent: &Tangent) -> DVec3 {
        let [x, y, z, _] = self.sampler.rgba(&detail.uv).map(|c| f64::from(2.0 * c - 1.0));
        let scale = f64::from(self.scale);
        let bitangent = tangent.normal.cross(tangent.tangent) * tangent.w;
        tangent.tangent * (x * scale) + bitangent * (y * scale) + tangent.normal * z
    }

    /// Which set of texture coordinates the map lies by.
    pub(crate) fn uv_set(&self) -> usize {
        self.sampler.uv_set()
    }
}

//! Alpha: where a surface is not there.

use super::detail::Detail;
use super::fold::unit;
use super::material::pixels;
use super::texture::ScalarSampler;
use crate::scene::{self, AlphaMode, Scene};

/// How much of a surface is there.
#[derive(Clone, Debug)]
pub(crate) struct Cutout {
    alpha: f32,
    texture: Option<ScalarSampler>,
    /// All of it from here on, else nothing; `None` where a share is.
    cutoff: Option<f32>,
}

impl Cutout {
    /// The alpha of a principled material that has been folded; `None` where it is solid.
    pub(super) fn new(p: &scene::Principled, scene: &Scene) -> Option<Self> {
        let cutoff = match p.alpha_mode {
            AlphaMode::Opaque => return None,
            AlphaMode::Mask { cutoff } => Some(cutoff),
            AlphaMode::Blend => None,
        };
        let texture = p.textures.alpha.as_ref();
        let texture = texture.map(|t| ScalarSampler::new(t, &pixels(scene, t.texture.image)));
        Some(Self { alpha: p.alpha, texture, cutoff })
    }

    /// The share of the surface that is there, [0, 1]; zero or one where it is a mask.
    #[must_use]
    pub(crate) fn coverage(&self, detail: &Detail) -> f32 {
        let texel = self.texture.as_ref().map_or(1.0, |t| t.value(&detail.uv));
        let alpha = unit(self.alpha * texel * detail.alpha);
        match self.cutoff {
            None => alpha,
            Some(cutoff) => f32::from(alpha >= cutoff),
        }
    }
}

//! Materials of the reference integrator that differ from point to point.
//!
//! Each texture multiplies the number of its name. Vertex colours multiply the colour of diffuse, and base
//! colour and alpha of principled materials. What has to be a fraction is clamped to [0, 1] then. The tint
//! of transmission takes part in the base colour: with the root of texel and vertex colour through a body,
//! with both themselves through a sheet.

use std::sync::Arc;

use glam::{DVec3, DVec4};

use super::albedo::Shelf;
use super::detail::Detail;
use super::material::Surface;
use super::texture::read;
use crate::color::Rgb;
use crate::scene::{
    AlphaMode, Material, MaterialKind, Pixels, Principled, ScalarTexture, Scene, Texture, Textures,
};

/// A material before anything is known of the point.
#[derive(Debug)]
pub(super) struct Varying {
    kind: MaterialKind,
    textures: Textures,
    pictures: Vec<Option<Arc<Pixels>>>,
    shelf: Shelf,
}

impl Varying {
    /// None where the material is the same at every point of every mesh.
    pub(super) fn new(material: &Material, colored: bool, scene: &Scene) -> Option<Self> {
        let (kind, textures) = match &material.kind {
            MaterialKind::Principled(p)
                if colored || !p.textures.is_empty() || p.alpha_mode != AlphaMode::Opaque =>
            {
                let plain = Principled { textures: Textures::default(), ..(**p).clone() };
                (MaterialKind::Principled(Box::new(plain)), p.textures.clone())
            }
            MaterialKind::Diffuse { .. } if colored => (material.kind.clone(), Textures::default()),
            _ => return None,
        };
        let pictures: Vec<_> = scene.images.iter().map(|i| i.pixels.clone()).collect();
        let mut varying = Self { kind, textures, pictures, shelf: Shelf::default() };
        if let MaterialKind::Principled(p) = &varying.kind {
            varying.shelf = Shelf::new(p, &varying.textures);
        }
        Some(varying)
    }

    fn texel(&self, t: &Texture, encoded: bool, at: &Detail) -> DVec4 {
        match &self.pictures[t.image.0 as usize] {
            Some(pixels) => read(t, pixels, encoded, at.uv),
            None => DVec4::ONE,
        }
    }

    fn value(&self, t: &Option<ScalarTexture>, at: &Detail) -> f64 {
        t.as_ref().map_or(1.0, |t| self.texel(&t.texture, false, at)[t.channel as usize])
    }

    fn color(&self, t: &Option<Texture>, at: &Detail) -> DVec3 {
        t.as_ref().map_or(DVec3::ONE, |t| self.texel(t, true, at).truncate())
    }

    /// The share of the surface that is there.
    pub(super) fn coverage(&self, at: &Detail) -> f64 {
        let MaterialKind::Principled(p) = &self.kind else { return 1.0 };
        let alpha = (f64::from(p.alpha) * self.value(&self.textures.alpha, at) * at.color.w).clamp(0.0, 1.0);
        match p.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask { cutoff } => f64::from(u8::from(alpha >= f64::from(cutoff))),
            AlphaMode::Blend => alpha,
        }
    }

    /// What the normal map says, and the texture coordinates that it lies by.
    pub(super) fn normal(&self, at: &Detail) -> Option<(usize, DVec3)> {
        let n = self.textures.normal.as_ref()?;
        let map = 2.0 * self.texel(&n.texture, false, at).truncate() - 1.0;
        let scale = f64::from(n.scale);
        Some((usize::from(n.texture.uv_set), map * DVec3::new(scale, scale, 1.0)))
    }

    /// The surface at a point.
    pub(super) fn at(&self, at: &Detail) -> Surface {
        let vertex = at.color.truncate();
        let unit = |v: f64| v.clamp(0.0, 1.0) as f32;
        let times = |c: Rgb, f: DVec3| {
            Rgb::new(unit(f64::from(c.r) * f.x), unit(f64::from(c.g) * f.y), unit(f64::from(c.b) * f.z))
        };
        let kind = match &self.kind {
            MaterialKind::Principled(p) => {
                let t = &self.textures;
                let base = self.color(&t.base_color, at) * vertex;
                let tint =
                    if p.thin { base } else { DVec3::new(base.x.sqrt(), base.y.sqrt(), base.z.sqrt()) };
                let scale = |v: f32, slot| unit(f64::from(v) * self.value(slot, at));
                let free = |c: Rgb, slot| {
                    let f = self.color(slot, at);
                    Rgb::new(c.r * f.x as f32, c.g * f.y as f32, c.b * f.z as f32)
                };
                MaterialKind::Principled(Box::new(Principled {
                    base_color: times(p.base_color, base),
                    metallic: scale(p.metallic, &t.metallic),
                    roughness: scale(p.roughness, &t.roughness),
                    specular: scale(p.specular, &t.specular),
                    specular_color: free(p.specular_color, &t.specular_color),
                    transmission: scale(p.transmission, &t.transmission),
                    transmission_tint: times(p.transmission_tint, tint),
                    emission: free(p.emission, &t.emission),
                    coat: scale(p.coat, &t.coat),
                    coat_roughness: scale(p.coat_roughness, &t.coat_roughness),
                    sheen_color: times(p.sheen_color, self.color(&t.sheen_color, at)),
                    sheen_roughness: scale(p.sheen_roughness, &t.sheen_roughness),
                    ..(**p).clone()
                }))
            }
            MaterialKind::Diffuse { color } => MaterialKind::Diffuse { color: times(*color, vertex) },
            other => other.clone(),
        };
        Surface::new(&kind, &mut |lobe, alpha| self.shelf.mix(lobe, alpha))
    }
}

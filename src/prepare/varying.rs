//! Materials that differ from point to point: their numbers are multiplied with textures and vertex
//! colours at the hit, and compiled there into lobes, on the stack.
//!
//! Products that have to be fractions are clamped to [0, 1]. The tint of transmission takes part in the
//! base colour: through a body each interface multiplies it with the root of the texel and of the vertex
//! colour, through a sheet with both themselves.

use std::sync::Arc;

use super::albedo::{AllTables, AtHit, Span, Tables};
use super::detail::Detail;
use super::fold::{bounded, tint_factor, unit};
use super::material::{Numbers, diffuse, has_coat, has_layers, is_diffuse, largest_root, lobes, pixels};
use super::texture::{Coordinates, Sampler, ScalarSampler};
use crate::bsdf::Bsdf;
use crate::color::Rgb;
use crate::scene::{self, Scene, Texels};

/// What to compile at a hit.
#[derive(Clone, Debug)]
pub(crate) struct Varying {
    numbers: Numbers,
    base_color: Option<Sampler>,
    metallic: Option<ScalarSampler>,
    roughness: Option<ScalarSampler>,
    specular: Option<ScalarSampler>,
    specular_color: Option<Sampler>,
    transmission: Option<ScalarSampler>,
    coat: Option<ScalarSampler>,
    coat_roughness: Option<ScalarSampler>,
    sheen_color: Option<Sampler>,
    sheen_roughness: Option<ScalarSampler>,
    /// `None` for a Lambertian reflector.
    tables: Option<Arc<Tables>>,
}

impl Varying {
    /// A Lambertian reflector with vertex colours.
    pub(super) fn diffuse(color: Rgb) -> Self {
        let p = scene::Principled { base_color: color, specular: 0.0, ..scene::Principled::default() };
        Self {
            numbers: Numbers::from(&p),
            base_color: None,
            metallic: None,
            roughness: None,
            specular: None,
            specular_color: None,
            transmission: None,
            coat: None,
            coat_roughness: None,
            sheen_color: None,
            sheen_roughness: None,
            tables: None,
        }
    }

    /// A principled material that has been folded.
    pub(super) fn new(p: &scene::Principled, scene: &Scene, tables: &mut AllTables) -> Self {
        let numbers = Numbers { fresnel: tables.fresnel, ..Numbers::from(p) };
        let color =
            |t: &Option<scene::Texture>| t.as_ref().map(|t| Sampler::new(t, &pixels(scene, t.image), true));
        let value = |t: &Option<scene::ScalarTexture>| {
            t.as_ref().map(|t| ScalarSampler::new(t, &pixels(scene, t.texture.image)))
        };
        let t = &p.textures;
        let varied = Self {
            numbers,
            base_color: color(&t.base_color),
            metallic: value(&t.metallic),
            roughness: value(&t.roughness),
            specular: value(&t.specular),
            specular_color: color(&t.specular_color),
            transmission: value(&t.transmission),
            coat: value(&t.coat),
            coat_roughness: value(&t.coat_roughness),
            sheen_color: color(&t.sheen_color),
            sheen_roughness: value(&t.sheen_roughness),
            tables: None,
        };
        if is_diffuse(&numbers) {
            return varied;
        }
        // F0 varies with the strength, and with a tint that may be above one.
        let strongest = t.specular_color.as_ref().map_or(1.0, |t| brightest(&pixels(scene, t.image).texels));
        let mut most = numbers;
        most.specular_color = bounded(most.specular_color * strongest);
        if t.specular.as_ref().is_some_and(|t| brightest(&pixels(scene, t.texture.image).texels) > 1.0) {
            most.specular = 1.0;
        }
        let root = largest_root(&most);
        let varies =
            t.specular.is_some() || (t.specular_color.is_some() && most.specular_color.max_channel() > 1.0);
        let solid =
            (numbers.transmission > 0.0 && !numbers.thin && numbers.ior != 1.0).then_some(numbers.ior);
        let roughness = t.roughness.is_none().then_some(numbers.roughness);
        let span = Span::new(roughness, [if varies { 0.0 } else { root }, root], solid);
        let constant = |slot: &Option<scene::ScalarTexture>, v: f32| slot.is_none().then_some(v);
        let mut span = span;
        if has_coat(&numbers) {
            span = span.coat(numbers.coat_ior, constant(&t.coat_roughness, numbers.coat_roughness));
        }
        if !numbers.sheen_color.is_black() {
            span = span.sheen(constant(&t.sheen_roughness, numbers.sheen_roughness));
        }
        Self { tables: Some(tables.get(span)), ..varied }
    }

    /// The base colour, and the factor on it that the tint of transmission shares.
    fn base(&self, detail: &Detail) -> (Rgb, Rgb) {
        let texel = self.base_color.as_ref().map_or(Rgb::WHITE, |t| t.rgb(&detail.uv));
        let factor = texel * detail.color;
        ((self.numbers.base_color * factor).map(unit), factor)
    }

    /// Whether a coat or a sheen may be on top.
    pub(crate) fn has_layers(&self) -> bool {
        has_layers(&self.numbers)
    }

    /// What the albedo feature shows.
    pub(crate) fn albedo(&self, detail: &Detail) -> Rgb {
        self.base(detail).0
    }

    /// The lobes at a point that is seen under the cosine `mu`, [0, 1], to the shading normal.
    #[must_use]
    pub(crate) fn bsdf(&self, detail: &Detail, mu: f32) -> Bsdf {
        let (base, factor) = self.base(detail);
        let Some(tables) = &self.tables else { return diffuse(base) };
        let at: &Coordinates = &detail.uv;
        let times = |value: f32, slot: &Option<ScalarSampler>| {
            slot.as_ref().map_or(value, |t| unit(value * t.value(at)))
        };
        let n = &self.numbers;
        let p = Numbers {
            base_color: base,
            metallic: times(n.metallic, &self.metallic),
            roughness: times(n.roughness, &self.roughness),
            specular: times(n.specular, &self.specular),
            specular_color: match &self.specular_color {
                Some(t) => bounded(n.specular_color * t.rgb(at)),
                None => n.specular_color,
            },
            transmission: times(n.transmission, &self.transmission),
            transmission_tint: if n.transmission > 0.0 {
                (n.transmission_tint * tint_factor(factor, n.thin)).map(unit)
            } else {
                n.transmission_tint
            },
            coat: times(n.coat, &self.coat),
            coat_roughness: times(n.coat_roughness, &self.coat_roughness),
            sheen_color: match &self.sheen_color {
                Some(t) => (n.sheen_color * t.rgb(at)).map(unit),
                None => n.sheen_color,
            },
            sheen_roughness: times(n.sheen_roughness, &self.sheen_roughness),
            ..*n
        };
        Bsdf::Principled(lobes(&p, &mut AtHit { tables, mu: mu.clamp(0.0, 1.0) }))
    }
}

/// The largest value that a picture's colours may have.
fn brightest(texels: &Texels) -> f32 {
    match texels {
        Texels::Byte(_) | Texels::Short(_) => 1.0,
        Texels::Float(t) => t.iter().flatten().fold(1.0, |m, &c| m.max(c)),
    }
}

//! glTF materials become [`Principled`] ones.
//!
//! Where files of Blender's exporter mean something else than the specification says, they get what
//! Cycles renders: transmission without a volume is solid glass, not a sheet, and each refraction is
//! tinted by the square root of the base colour. The simplest material that renders the same is found
//! later, by `prepare`.

use gltf::json;
use json::validation::Checked;
use serde::Deserialize;
use serde_json::Map;

use super::super::error::Fault;
use super::accessor::Reader;
use super::document::Document;
use super::texture::{Info, Textures, extension};
use crate::color::Rgb;
use crate::scene::notes::Notes;
use crate::scene::{
    self, Absorption, AlphaMode, Channel, MAX_RADIANCE, MaterialKind, NormalTexture, NoteEffect, Principled,
    ScalarTexture, Texture,
};

/// `KHR_materials_clearcoat`, which the crate does not know yet.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<json::texture::Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<json::texture::Info>,
    clearcoat_normal_texture: Option<json::material::NormalTexture>,
}

/// `KHR_materials_sheen`, likewise.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Sheen {
    sheen_color_factor: [f32; 3],
    sheen_color_texture: Option<json::texture::Info>,
    sheen_roughness_factor: f32,
    sheen_roughness_texture: Option<json::texture::Info>,
}

/// What glTF shows where a primitive has no material: white, metallic, rough.
pub(super) fn default_kind() -> MaterialKind {
    let p = Principled { metallic: 1.0, roughness: 1.0, ..Principled::default() };
    MaterialKind::Principled(Box::new(p))
}

/// Material `index` of the document.
pub(super) fn convert(
    doc: &Document,
    index: usize,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
    notes: &mut Notes,
) -> Result<MaterialKind, Fault> {
    let material = &doc.materials[index];
    let mut from = Factors { place: format!("materials[{index}]"), notes, textures, reader };
    let blender = doc.is_from_blender();
    if blender && doc.bare_materials.contains(&index) {
        let message = "a material without any property: Blender writes it where the nodes hold no \
                       Principled BSDF, and it shows as white metal";
        from.note("material-lost", NoteEffect::Missing, "", message);
    }

    // The core.
    let mut slots = scene::Textures::default();
    let pbr = &material.pbr_metallic_roughness;
    let [r, g, b, alpha] = pbr.base_color_factor.0;
    let base_color = from.color("pbrMetallicRoughness.baseColorFactor", [r, g, b], 1.0);
    let metallic = from.number("pbrMetallicRoughness.metallicFactor", pbr.metallic_factor.0, 0.0, 1.0);
    let roughness = from.number("pbrMetallicRoughness.roughnessFactor", pbr.roughness_factor.0, 0.0, 1.0);
    slots.base_color = from.texture("pbrMetallicRoughness.baseColorTexture", &pbr.base_color_texture)?;
    let both =
        from.texture("pbrMetallicRoughness.metallicRoughnessTexture", &pbr.metallic_roughness_texture)?;
    slots.roughness = scalar(both, Channel::G);
    slots.metallic = scalar(both, Channel::B);
    slots.normal = from.normal("normalTexture", &material.normal_texture)?;
    if material.occlusion_texture.is_some() {
        let message = "occlusion is found by tracing: the texture is not used";
        from.note("occlusion-ignored", NoteEffect::None, "occlusionTexture", message);
    }
    let (alpha, alpha_mode) = from.alpha(material, alpha);
    if alpha_mode != AlphaMode::Opaque {
        slots.alpha = scalar(slots.base_color, Channel::A);
    }

    // Extensions; a default leaves the core as it is.
    let extensions = material.extensions.clone().unwrap_or_default();
    let strength = extensions.emissive_strength.unwrap_or_default().emissive_strength.0;
    let strength =
        from.number("extensions.KHR_materials_emissive_strength.emissiveStrength", strength, 0.0, f32::MAX);
    let mut emission = from.color("emissiveFactor", material.emissive_factor.0, f32::MAX) * strength;
    if !(emission.is_finite() && emission.max_channel() <= MAX_RADIANCE) {
        let most = emission.map(|v| v.min(MAX_RADIANCE)).to_array();
        emission = from.clamped("emissiveFactor", "an emission above 1e30", most).into();
    }
    slots.emission = from.texture("emissiveTexture", &material.emissive_texture)?;
    if material.emissive_texture.is_some() && slots.emission.is_none() {
        // The factor alone would make the whole surface shine.
        emission = Rgb::BLACK;
    }
    let transmission = extensions.transmission.unwrap_or_default();
    let at = "extensions.KHR_materials_transmission";
    let texture = from.texture(&format!("{at}.transmissionTexture"), &transmission.transmission_texture)?;
    slots.transmission = scalar(texture, Channel::R);
    let transmission =
        from.number(&format!("{at}.transmissionFactor"), transmission.transmission_factor.0, 0.0, 1.0);
    let ior = match extensions.ior.unwrap_or_default().ior.0 {
        0.0 => from.clamped("extensions.KHR_materials_ior.ior", "0, a compatibility mode", 1.5),
        ior => from.number("extensions.KHR_materials_ior.ior", ior, 1.0, 1e3),
    };
    let specular = extensions.specular.unwrap_or_default();
    let at = "extensions.KHR_materials_specular";
    let texture = from.texture(&format!("{at}.specularTexture"), &specular.specular_texture)?;
    slots.specular = scalar(texture, Channel::A);
    slots.specular_color =
        from.texture(&format!("{at}.specularColorTexture"), &specular.specular_color_texture)?;
    let specular_color =
        from.color(&format!("{at}.specularColorFactor"), specular.specular_color_factor.0, f32::MAX);
    let specular = from.number(&format!("{at}.specularFactor"), specular.specular_factor.0, 0.0, 1.0);

    // Volume: with a thickness the surface bounds a solid, without it is a sheet.
    let volume = extensions.volume.unwrap_or_default();
    let at = "extensions.KHR_materials_volume";
    if volume.thickness_texture.is_some() {
        let message = "thickness is that of the geometry: the texture is not used";
        from.note("thickness-ignored", NoteEffect::None, &format!("{at}.thicknessTexture"), message);
    }
    let solid = blender || volume.thickness_factor.0 > 0.0;
    let absorption = if solid {
        let distance = volume.attenuation_distance.0;
        let color = from.color(&format!("{at}.attenuationColor"), volume.attenuation_color.0, 1.0);
        from.absorption(at, color, distance)
    } else {
        None
    };
    if blender && transmission > 0.0 && volume.thickness_factor.0 <= 0.0 {
        let message = "transmission without a volume is taken as solid glass, as Blender renders it";
        from.note("solid-glass", NoteEffect::None, "extensions.KHR_materials_transmission", message);
    }

    let mut p = Principled {
        base_color,
        metallic,
        roughness,
        ior,
        specular,
        specular_color,
        transmission,
        transmission_tint: if blender { base_color.map(f32::sqrt) } else { base_color },
        thin: !solid && transmission > 0.0,
        absorption,
        emission,
        alpha,
        alpha_mode,
        textures: slots,
        ..Principled::default()
    };
    from.coat(&mut p, &extensions.others)?;
    from.sheen(&mut p, &extensions.others)?;
    if extensions.unlit.is_some() {
        let message = "an unlit material is rendered as a black one that emits its base colour";
        from.note("unlit-emits", NoteEffect::Differs, "extensions.KHR_materials_unlit", message);
        p = Principled {
            base_color: Rgb::BLACK,
            emission: base_color,
            specular: 0.0,
            roughness: 1.0,
            alpha,
            alpha_mode,
            textures: scene::Textures {
                emission: p.textures.base_color,
                alpha: p.textures.alpha,
                ..scene::Textures::default()
            },
            ..Principled::default()
        };
    }
    Ok(MaterialKind::Principled(Box::new(p)))
}

/// One channel of a texture.
fn scalar(texture: Option<Texture>, channel: Channel) -> Option<ScalarTexture> {
    texture.map(|texture| ScalarTexture { texture, channel })
}

/// Reads the factors and textures of one material, and notes what is wrong with them.
struct Factors<'n, 'd, 'r> {
    place: String,
    notes: &'n mut Notes,
    textures: &'n mut Textures<'d>,
    reader: &'n mut Reader<'r>,
}

impl Factors<'_, '_, '_> {
    fn note(&mut self, code: &'static str, effect: NoteEffect, key: &str, message: &str) {
        let dot = if key.is_empty() { "" } else { "." };
        self.notes.add(code, effect, format!("{}{dot}{key}", self.place), message);
    }

    /// `value`, with a note that it stands for what was `found`.
    fn clamped<T: std::fmt::Debug>(&mut self, key: &str, found: &str, value: T) -> T {
        self.note("value-clamped", NoteEffect::Differs, key, &format!("{found}: taken as {value:?}"));
        value
    }

    /// `value` within [min, max].
    fn number(&mut self, key: &str, value: f32, min: f32, max: f32) -> f32 {
        if value >= min && value <= max {
            return value;
        }
        self.clamped(key, &value.to_string(), value.clamp(min, max))
    }

    /// `value` with each channel within [0, max].
    fn color(&mut self, key: &str, value: [f32; 3], max: f32) -> Rgb {
        let color = Rgb::from(value);
        let good = color.map(|v| v.clamp(0.0, max));
        if good == color { color } else { self.clamped(key, &format!("{value:?}"), good.to_array()).into() }
    }

    /// Absorption, where the inside absorbs anything.
    fn absorption(&mut self, at: &str, color: Rgb, distance: f32) -> Option<Absorption> {
        if distance == f32::INFINITY || color == Rgb::WHITE {
            return None;
        }
        if distance <= 0.0 {
            let (key, none) = (format!("{at}.attenuationDistance"), f32::INFINITY);
            self.clamped(&key, &distance.to_string(), none);
            return None;
        }
        // Zero would be an infinite coefficient, and infinity times a path of length zero is no number.
        let least = 1e-6;
        let color = if color.min_channel() < least {
            let key = format!("{at}.attenuationColor");
            let least = color.map(|v| v.max(least)).to_array();
            self.clamped(&key, &format!("{:?}", color.to_array()), least).into()
        } else {
            color
        };
        Some(Absorption { color, distance })
    }

    /// The texture in the slot `key`, where there is one that can be used.
    fn texture(&mut self, key: &str, info: &Option<json::texture::Info>) -> Result<Option<Texture>, Fault> {
        let Some(info) = info else { return Ok(None) };
        let place = format!("{}.{key}", self.place);
        self.textures.get(&Info::from(info), &place, self.reader, self.notes)
    }

    /// The normal texture in the slot `key`.
    fn normal(
        &mut self,
        key: &str,
        info: &Option<json::material::NormalTexture>,
    ) -> Result<Option<NormalTexture>, Fault> {
        let Some(normal) = info else { return Ok(None) };
        let place = format!("{}.{key}", self.place);
        let scale = self.number(&format!("{key}.scale"), normal.scale, -1e6, 1e6);
        let info = Info::of_normal(normal, &place)?;
        let texture = self.textures.get(&info, &place, self.reader, self.notes)?;
        Ok(texture.map(|texture| NormalTexture { texture, scale }))
    }

    /// Coverage, and what is done with it.
    fn alpha(&mut self, material: &json::Material, alpha: f32) -> (f32, AlphaMode) {
        let mode = match material.alpha_mode {
            Checked::Valid(json::material::AlphaMode::Opaque) => return (1.0, AlphaMode::Opaque),
            Checked::Valid(json::material::AlphaMode::Blend) => AlphaMode::Blend,
            Checked::Valid(json::material::AlphaMode::Mask) => {
                let cutoff = material.alpha_cutoff.map_or(0.5, |c| c.0);
                AlphaMode::Mask { cutoff: self.number("alphaCutoff", cutoff, 0.0, 1.0) }
            }
            Checked::Invalid => {
                let message = "an unknown mode: the surface is opaque";
                self.note("alpha-ignored", NoteEffect::Missing, "alphaMode", message);
                return (1.0, AlphaMode::Opaque);
            }
        };
        (self.number("pbrMetallicRoughness.baseColorFactor", alpha, 0.0, 1.0), mode)
    }

    /// `KHR_materials_clearcoat`, where it is there.
    fn coat(&mut self, p: &mut Principled, others: &Map<String, serde_json::Value>) -> Result<(), Fault> {
        let at = "extensions.KHR_materials_clearcoat";
        let Some(coat) = extension::<Clearcoat>(others, "KHR_materials_clearcoat", &self.place)? else {
            return Ok(());
        };
        p.coat = self.number(&format!("{at}.clearcoatFactor"), coat.clearcoat_factor, 0.0, 1.0);
        let key = format!("{at}.clearcoatRoughnessFactor");
        p.coat_roughness = self.number(&key, coat.clearcoat_roughness_factor, 0.0, 1.0);
        let texture = self.texture(&format!("{at}.clearcoatTexture"), &coat.clearcoat_texture)?;
        p.textures.coat = scalar(texture, Channel::R);
        let key = format!("{at}.clearcoatRoughnessTexture");
        p.textures.coat_roughness =
            scalar(self.texture(&key, &coat.clearcoat_roughness_texture)?, Channel::G);
        let key = format!("{at}.clearcoatNormalTexture");
        p.textures.coat_normal = self.normal(&key, &coat.clearcoat_normal_texture)?;
        Ok(())
    }

    /// `KHR_materials_sheen`, where it is there.
    fn sheen(&mut self, p: &mut Principled, others: &Map<String, serde_json::Value>) -> Result<(), Fault> {
        let at = "extensions.KHR_materials_sheen";
        let Some(sheen) = extension::<Sheen>(others, "KHR_materials_sheen", &self.place)? else {
            return Ok(());
        };
        p.sheen_color = self.color(&format!("{at}.sheenColorFactor"), sheen.sheen_color_factor, 1.0);
        let key = format!("{at}.sheenRoughnessFactor");
        p.sheen_roughness = self.number(&key, sheen.sheen_roughness_factor, 0.0, 1.0);
        p.textures.sheen_color =
            self.texture(&format!("{at}.sheenColorTexture"), &sheen.sheen_color_texture)?;
        let texture = self.texture(&format!("{at}.sheenRoughnessTexture"), &sheen.sheen_roughness_texture)?;
        p.textures.sheen_roughness = scalar(texture, Channel::A);
        Ok(())
    }
}

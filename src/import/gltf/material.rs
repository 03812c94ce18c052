//! glTF materials become [`Principled`] ones.
//!
//! Where files of Blender's exporter mean something else than the specification says, they get what
//! Cycles renders: transmission without a volume is solid glass, not a sheet, and each refraction is
//! tinted by the square root of the base colour. The simplest material that renders the same is found
//! later, by `prepare`.

use gltf::json;
use json::material::AlphaMode;
use json::validation::Checked;

use super::super::notes::Notes;
use super::document::Document;
use crate::color::Rgb;
use crate::scene::{Absorption, MaterialKind, NoteEffect, Principled};

/// What glTF shows where a primitive has no material: white, metallic, rough.
pub(super) fn default_kind() -> MaterialKind {
    let p = Principled { metallic: 1.0, roughness: 1.0, ..Principled::default() };
    MaterialKind::Principled(Box::new(p))
}

/// Material `index` of the document.
pub(super) fn convert(doc: &Document, index: usize, notes: &mut Notes) -> MaterialKind {
    let material = &doc.materials[index];
    let mut from = Factors { place: format!("materials[{index}]"), notes };
    let blender = doc.is_from_blender();
    if blender && doc.bare_materials.contains(&index) {
        let message = "a material without any property: Blender writes it where the nodes hold no \
                       Principled BSDF, and it shows as white metal";
        from.note("material-lost", NoteEffect::Missing, "", message);
    }

    // The core.
    let pbr = &material.pbr_metallic_roughness;
    let [r, g, b, alpha] = pbr.base_color_factor.0;
    let base_color = from.color("pbrMetallicRoughness.baseColorFactor", [r, g, b], 1.0);
    let metallic = from.number("pbrMetallicRoughness.metallicFactor", pbr.metallic_factor.0, 0.0, 1.0);
    let roughness = from.number("pbrMetallicRoughness.roughnessFactor", pbr.roughness_factor.0, 0.0, 1.0);
    from.texture("pbrMetallicRoughness.baseColorTexture", pbr.base_color_texture.is_some());
    from.texture("pbrMetallicRoughness.metallicRoughnessTexture", pbr.metallic_roughness_texture.is_some());
    from.texture("normalTexture", material.normal_texture.is_some());
    from.alpha(&material.alpha_mode, alpha);

    // Extensions; a default leaves the core as it is.
    let extensions = material.extensions.clone().unwrap_or_default();
    let strength = extensions.emissive_strength.unwrap_or_default().emissive_strength.0;
    let strength =
        from.number("extensions.KHR_materials_emissive_strength.emissiveStrength", strength, 0.0, f32::MAX);
    let mut emission = from.color("emissiveFactor", material.emissive_factor.0, f32::MAX) * strength;
    if material.emissive_texture.is_some() && !emission.is_black() {
        // The factor alone would make the whole surface shine.
        let message = "textures are not rendered yet: the surface does not emit";
        from.note("texture-ignored", NoteEffect::Missing, "emissiveTexture", message);
        emission = Rgb::BLACK;
    }
    if !emission.is_finite() {
        emission = from.clamped("emissiveFactor", "an infinite emission", [0.0; 3]).into();
    }
    let transmission = extensions.transmission.unwrap_or_default();
    let at = "extensions.KHR_materials_transmission";
    from.texture(&format!("{at}.transmissionTexture"), transmission.transmission_texture.is_some());
    let transmission =
        from.number(&format!("{at}.transmissionFactor"), transmission.transmission_factor.0, 0.0, 1.0);
    let ior = match extensions.ior.unwrap_or_default().ior.0 {
        0.0 => from.clamped("extensions.KHR_materials_ior.ior", "0, a compatibility mode", 1.5),
        ior => from.number("extensions.KHR_materials_ior.ior", ior, 1.0, 1e3),
    };
    let specular = extensions.specular.unwrap_or_default();
    let at = "extensions.KHR_materials_specular";
    from.texture(&format!("{at}.specularTexture"), specular.specular_texture.is_some());
    from.texture(&format!("{at}.specularColorTexture"), specular.specular_color_texture.is_some());
    let specular_color =
        from.color(&format!("{at}.specularColorFactor"), specular.specular_color_factor.0, f32::MAX);
    let specular = from.number(&format!("{at}.specularFactor"), specular.specular_factor.0, 0.0, 1.0);

    // Volume: with a thickness the surface bounds a solid, without it is a sheet.
    let volume = extensions.volume.unwrap_or_default();
    let at = "extensions.KHR_materials_volume";
    from.texture(&format!("{at}.thicknessTexture"), volume.thickness_texture.is_some());
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
        ..Principled::default()
    };
    if extensions.unlit.is_some() {
        let message = "an unlit material is rendered as a black one that emits its base colour";
        from.note("unlit-emits", NoteEffect::Differs, "extensions.KHR_materials_unlit", message);
        p = Principled {
            base_color: Rgb::BLACK,
            emission: base_color,
            specular: 0.0,
            roughness: 1.0,
            ..Principled::default()
        };
    }
    MaterialKind::Principled(Box::new(p))
}

/// Reads the factors of one material, and notes what is wrong with them.
struct Factors<'n> {
    place: String,
    notes: &'n mut Notes,
}

impl Factors<'_> {
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

    fn texture(&mut self, key: &str, is_there: bool) {
        if is_there {
            let message = "textures are not rendered yet: the factor alone is used";
            self.note("texture-ignored", NoteEffect::Missing, key, message);
        }
    }

    fn alpha(&mut self, mode: &Checked<AlphaMode>, alpha: f32) {
        let message = match mode {
            Checked::Valid(AlphaMode::Opaque) => return,
            Checked::Valid(AlphaMode::Blend) if alpha >= 1.0 => return,
            Checked::Valid(AlphaMode::Blend) => "transparency is not rendered yet: the surface is opaque",
            Checked::Valid(AlphaMode::Mask) => "cut-outs are not rendered yet: the surface is opaque",
            Checked::Invalid => "an unknown mode: the surface is opaque",
        };
        self.note("alpha-ignored", NoteEffect::Missing, "alphaMode", message);
    }
}

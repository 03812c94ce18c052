//! Materials as MTL statements, as far as those go.
//!
//! In: materials of the scene under unique names, and where their pictures lie. Out: the text of a
//! material library, in the statements of the format and of its "PBR extension" (Pr, Pm, Ps, Pc, Pcr,
//! norm), and for each material whether [`crate::import`] reads exactly the same from it. What it does not
//! read so goes into the sidecar too, and the library holds the nearest thing for other programs.

use std::fmt::Write;

use super::number;
use crate::color::Rgb;
use crate::scene::{
    AlphaMode, Channel, Filter, Glass, Material, MaterialKind, Principled, ScalarTexture, Sides, Texture,
    Wrap,
};

/// The largest index of refraction that readers of the format take at its word.
const MAX_IOR: f32 = 1e3;

/// A material library under construction.
pub(super) struct Library<'a> {
    pub(super) text: String,
    /// Where each picture of the scene lies, from the folder of the library.
    pub(super) pictures: &'a [String],
}

impl Library<'_> {
    /// Adds a material called `name`; true where the statements say all of it.
    pub(super) fn add(&mut self, name: &str, material: &Material) -> bool {
        let _ = writeln!(self.text, "\nnewmtl {name}");
        match &material.kind {
            MaterialKind::Diffuse { color } => {
                self.color("Kd", *color);
                self.color("Ks", Rgb::BLACK);
                self.line("illum", "1");
                // A reader cannot tell it from a principled material without its highlight.
                false
            }
            MaterialKind::Mirror { color } => {
                self.color("Kd", Rgb::BLACK);
                self.color("Ks", *color);
                self.line("Ns", "1000");
                self.line("illum", "3");
                !color.is_black()
            }
            MaterialKind::Glass(glass) => self.glass(glass),
            MaterialKind::Light { radiance, sides } => {
                self.color("Kd", Rgb::BLACK);
                self.color("Ke", *radiance);
                self.line("illum", "0");
                *sides == Sides::Both && !radiance.is_black()
            }
            MaterialKind::Principled(p) if p.transmission > 0.5 => {
                let through = p.base_color;
                self.glass(&Glass { ior: p.ior, tint: through, absorption: None, priority: None });
                self.value("Pr", p.roughness);
                false
            }
            MaterialKind::Principled(p) => self.principled(p),
        }
    }

    fn glass(&mut self, glass: &Glass) -> bool {
        self.color("Kd", Rgb::BLACK);
        self.color("Ks", Rgb::WHITE);
        self.color("Tf", glass.tint);
        self.value("Ni", glass.ior);
        self.line("Ns", "1000");
        self.line("illum", "7");
        glass.absorption.is_none()
            && glass.priority.is_none()
            && glass.ior > 1.0
            && glass.ior <= MAX_IOR
            && !glass.tint.is_black()
    }

    fn principled(&mut self, p: &Principled) -> bool {
        self.color("Kd", p.base_color);
        self.color("Ks", p.specular_color.map(|c| (0.5 * p.specular * c).min(1.0)));
        self.color("Ke", p.emission);
        self.value("Ni", p.ior);
        let coverage = if p.alpha_mode == AlphaMode::Opaque { 1.0 } else { p.alpha };
        self.value("d", coverage);
        self.line("illum", "2");
        self.value("Pr", p.roughness);
        self.value("Pm", p.metallic);
        for (key, value) in [("Ps", p.sheen_color.max_channel()), ("Pc", p.coat), ("Pcr", p.coat_roughness)] {
            if value > 0.0 {
                self.value(key, value);
            }
        }
        let t = &p.textures;
        let mut maps = true;
        maps &= self.map("map_Kd", t.base_color, None, None);
        maps &= self.map("map_Ke", t.emission, None, None);
        let scalar = |t: Option<ScalarTexture>| (t.map(|t| t.texture), t.map(|t| t.channel));
        let (roughness, channel) = scalar(t.roughness);
        maps &= self.map("map_Pr", roughness, channel, None);
        let (metallic, channel) = scalar(t.metallic);
        maps &= self.map("map_Pm", metallic, channel, None);
        if p.alpha_mode != AlphaMode::Opaque {
            let (alpha, channel) = scalar(t.alpha);
            maps &= self.map("map_d", alpha, channel, None);
        }
        maps &= self.map("norm", t.normal.map(|n| n.texture), None, t.normal.map(|n| n.scale));
        maps && is_exact(p)
    }

    /// A map statement; true where its options say all of the texture.
    fn map(
        &mut self,
        key: &str,
        texture: Option<Texture>,
        channel: Option<Channel>,
        strength: Option<f32>,
    ) -> bool {
        let Some(t) = texture else { return true };
        let Some(file) = self.pictures.get(t.image.0 as usize) else { return false };
        let mut options = String::new();
        // The format's v runs up and is scaled first: v' = s v + (1 - s - o).
        let up = |offset: f32| 1.0 - t.scale[1] - offset;
        let offset = [t.offset[0], up(t.offset[1])];
        if t.offset != [0.0; 2] || offset[1] != 0.0 {
            let _ = write!(options, "-o {} {} 0 ", number(offset[0]), number(offset[1]));
        }
        if t.scale != [1.0; 2] {
            let _ = write!(options, "-s {} {} 1 ", number(t.scale[0]), number(t.scale[1]));
        }
        if t.wrap == [Wrap::Clamp; 2] {
            options.push_str("-clamp on ");
        }
        if let Some(channel) = channel {
            let letter = match channel {
                Channel::R => 'r',
                Channel::G => 'g',
                Channel::B => 'b',
                Channel::A => 'm',
            };
            let _ = write!(options, "-imfchan {letter} ");
        }
        if let Some(strength) = strength.filter(|&s| s != 1.0) {
            let _ = write!(options, "-bm {} ", number(strength));
        }
        let _ = writeln!(self.text, "{key} {options}{file}");
        t.uv_set == 0
            && t.rotation.to_bits() == 0
            && t.filter == Filter::Linear
            && (t.wrap == [Wrap::Clamp; 2] || t.wrap == [Wrap::Repeat; 2])
            && t.offset[1].to_bits() == up(offset[1]).to_bits()
    }

    fn color(&mut self, key: &str, color: Rgb) {
        let [r, g, b] = color.to_array().map(number);
        let _ = writeln!(self.text, "{key} {r} {g} {b}");
    }

    fn value(&mut self, key: &str, value: f32) {
        let _ = writeln!(self.text, "{key} {}", number(value));
    }

    fn line(&mut self, key: &str, value: &str) {
        let _ = writeln!(self.text, "{key} {value}");
    }
}

/// Whether the statements for a principled material, its maps aside, say all of it.
fn is_exact(p: &Principled) -> bool {
    let default = Principled::default();
    let t = &p.textures;
    let spoken = [
        t.base_color.is_some(),
        t.emission.is_some(),
        t.roughness.is_some(),
        t.metallic.is_some(),
        t.alpha.is_some() && p.alpha_mode != AlphaMode::Opaque,
        t.normal.is_some(),
    ];
    // Readers take black under a picture as a factor that was forgotten.
    let black_under_picture = p.base_color.is_black() && t.base_color.is_some()
        || p.emission.is_black() && t.emission.is_some()
        || p.alpha == 0.0 && t.alpha.is_some();
    let alpha = match p.alpha_mode {
        AlphaMode::Opaque => p.alpha == 1.0,
        AlphaMode::Blend => p.alpha < 1.0 || t.alpha.is_some(),
        AlphaMode::Mask { .. } => false,
    };
    let sheen = p.sheen_color;
    p.specular == default.specular
        && p.specular_color == default.specular_color
        && p.transmission == default.transmission
        && p.transmission_tint == default.transmission_tint
        && p.thin == default.thin
        && p.absorption.is_none()
        && p.priority.is_none()
        && p.coat_ior == default.coat_ior
        && p.sheen_roughness == default.sheen_roughness
        && sheen.min_channel() == sheen.max_channel()
        && p.ior <= MAX_IOR
        && alpha
        && !black_under_picture
        && t.iter().count() == spoken.iter().filter(|s| **s).count()
}

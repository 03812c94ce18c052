//! MTL materials become the scene's; the table is `src/guide/from-obj.md`.
//!
//! MTL is older than any of the models that read it, so a material means what its writer meant: files of
//! Blender (told by their header) follow its exporter, all others the illumination models of the format.
//! Phong's exponent becomes a GGX width by alpha^2 = 2 / (Ns + 2), which matches the lobes near their
//! middles (Walter et al. 2007, section 5.1, for Beckmann); perceptual roughness is the root of alpha.

use super::log::Log;
use super::mtl::Source;
use super::texture::Loader;
use crate::color::Rgb;
use crate::scene::{
    AlphaMode, Glass, MaterialKind, NormalTexture, NoteEffect, Principled, ScalarTexture, Sides, Texture,
};

/// What a face without a material, or with one that is not defined, looks like; Blender's default too.
pub(super) fn default_kind() -> MaterialKind {
    MaterialKind::Principled(Box::new(Principled { base_color: Rgb::grey(0.8), ..Principled::default() }))
}

/// Reads one material.
pub(super) fn convert(source: &Source, loader: &mut Loader<'_>, log: &mut Log) -> MaterialKind {
    let mut from = Reader { source, loader, log };
    from.unused();
    if source.blender.is_some() { from.blender() } else { from.phong() }
}

/// Reads the statements of one material, and notes what is wrong with them.
struct Reader<'r, 'b> {
    source: &'r Source,
    loader: &'r mut Loader<'b>,
    log: &'r mut Log,
}

impl Reader<'_, '_> {
    /// A material of Blender's exporter.
    fn blender(&mut self) -> MaterialKind {
        let source = self.source;
        let (ns, ni) = (self.number("Ns"), self.number("Ni"));
        let plain = source.color("Kd") == Some([0.8; 3]) && source.color("Ks") == Some([0.5; 3]);
        if plain && ni == Some(1.0) && ns.is_some_and(|n| (n - 360.0).abs() < 0.5) {
            let message =
                "Kd 0.8, Ks 0.5, Ns 360, Ni 1: Blender writes this where the nodes hold no Principled BSDF";
            self.note("material-lost", NoteEffect::Missing, "newmtl", message);
        }
        let illum = self.number("illum").unwrap_or(2.0);
        // Before version 3.1 another exporter, with another factor, wrote a header without a version.
        let shine = if source.blender.as_deref() == Some("") { 900.0 } else { 1000.0 };
        let level = source.color("Ks").map_or(0.5, |ks| self.grey("Ks", ks));
        let coat = self.number("Pc").unwrap_or(0.0) / 4.0;
        let mut p = Principled {
            roughness: self.number("Pr").or(ns.map(|n| 1.0 - (n / shine).min(1.0).sqrt())).unwrap_or(0.5),
            metallic: match (self.number("Pm"), illum as u8, source.color("Ka")) {
                (Some(metallic), ..) => metallic,
                // Where a material is metallic, its exporter puts that into Ka.
                (None, 3 | 6, Some(ka)) => ka[0].clamp(0.0, 1.0),
                _ => 0.0,
            },
            ior: ni.unwrap_or(1.5).max(1.0),
            coat: self.fraction("Pc", coat),
            transmission: source.color("Tf").map_or(0.0, |tf| self.grey("Tf", tf).min(1.0)),
            ..self.common()
        };
        (p.specular, p.specular_color) = specular_level(Rgb::grey(level));
        p.transmission_tint = p.base_color.map(f32::sqrt);
        if p.transmission > 0.0 && ni.is_none() {
            p.ior = 1.45;
        }

        // Where a picture is linked, the exporter writes no factor.
        let factor = |p: &mut f32, given: bool| {
            if !given {
                *p = 1.0;
            }
        };
        if let Some(t) = self.scalar("map_Pr").or_else(|| self.scalar("map_Ns")) {
            factor(&mut p.roughness, source.map("map_Pr").is_some() && self.number("Pr").is_some());
            p.textures.roughness = Some(t);
        }
        if let Some(t) =
            self.scalar("map_Pm").or_else(|| self.scalar("map_refl")).or_else(|| self.scalar("refl"))
        {
            factor(&mut p.metallic, self.number("Pm").is_some());
            p.textures.metallic = Some(t);
        }
        if let Some(t) = self.scalar("map_Ks") {
            (p.specular, p.specular_color) = (1.0, Rgb::grey(2.0));
            p.textures.specular = Some(t);
        }
        MaterialKind::Principled(Box::new(p))
    }

    /// A material of any other program.
    fn phong(&mut self) -> MaterialKind {
        let source = self.source;
        let physical = self.number("Pr").is_some()
            || self.number("Pm").is_some()
            || ["map_Pr", "map_Pm"].iter().any(|k| source.map(k).is_some());
        let (ns, ni) = (self.number("Ns"), self.number("Ni"));
        let illum = self.number("illum").map(|i| i as u8);
        let ks = source.color("Ks").map(|c| self.color("Ks", c, 1.0));
        let ke = source.color("Ke").map_or(Rgb::BLACK, |c| self.color("Ke", c, f32::MAX));
        let mut p = self.common();
        let kd = source.color("Kd").map_or(p.base_color, |c| Rgb::from(c).map(|v| v.clamp(0.0, 1.0)));
        let textured = !p.textures.is_empty();
        let shiny = ks.is_some_and(|ks| !ks.is_black()) && !matches!(illum, Some(0 | 1));

        // A lamp: a surface that emits and reflects nothing.
        if !ke.is_black() && kd.is_black() && !shiny && !textured && p.alpha == 1.0 && !physical {
            return MaterialKind::Light { radiance: p.emission, sides: Sides::Both };
        }
        if let Some(kind) = self.glass(illum, ni, &p) {
            return kind;
        }
        p.ior = ni.map_or(1.5, |ni| ni.max(1.0));
        if physical {
            p.roughness = self.number("Pr").unwrap_or(if source.map("map_Pr").is_some() { 1.0 } else { 0.5 });
            p.metallic = self.number("Pm").unwrap_or(if source.map("map_Pm").is_some() { 1.0 } else { 0.0 });
            p.textures.roughness = self.scalar("map_Pr");
            p.textures.metallic = self.scalar("map_Pm");
            let coat = self.number("Pc").unwrap_or(0.0);
            p.coat = self.fraction("Pc", coat);
            return MaterialKind::Principled(Box::new(p));
        }
        // Ni 1 is what many programs write for anything opaque.
        if p.ior == 1.0 {
            p.ior = 1.5;
        }
        // Reflection by ray tracing: Ks is what a mirror reflects, and not the strength of a highlight.
        let mirrors = matches!(illum, Some(3 | 5 | 8)) && shiny;
        let ks = ks.unwrap_or(Rgb::BLACK);
        let sharp = ns.is_none_or(|ns| ns >= 1000.0);
        if mirrors && kd.is_black() && !textured && p.emission.is_black() && p.alpha == 1.0 {
            if sharp {
                return MaterialKind::Mirror { color: ks };
            }
            let roughness = phong_roughness(ns.unwrap_or(0.0));
            let p = Principled { base_color: ks, metallic: 1.0, roughness, ..p };
            return MaterialKind::Principled(Box::new(p));
        }
        p.roughness = if mirrors && sharp { 0.0 } else { phong_roughness(ns.unwrap_or(0.0)) };
        if !shiny && source.map("map_Ks").is_none() {
            p.specular = 0.0;
        } else if mirrors {
            // The reflectance at normal incidence of the dielectric, and the factor that makes it Ks.
            let root = (p.ior - 1.0) / (p.ior + 1.0);
            (p.specular, p.specular_color) = (1.0, ks / (root * root).max(1e-4));
        } else {
            let ks = if ks.is_black() { Rgb::WHITE } else { ks };
            (p.specular, p.specular_color) = specular_level(ks);
            p.textures.specular_color = self.texture("map_Ks");
        }
        if source.map("map_Ns").is_some() {
            let message = "`map_Ns` holds exponents: not read";
            self.note("texture-ignored", NoteEffect::Differs, "map_Ns", message);
        }
        MaterialKind::Principled(Box::new(p))
    }

    /// Solid glass: where the illumination model refracts, or light passes and is bent. Programs write
    /// `illum 4` and `Tf 1 1 1` for opaque materials too, then without an index of refraction above 1.
    fn glass(&mut self, illum: Option<u8>, ni: Option<f32>, p: &Principled) -> Option<MaterialKind> {
        let tf = self.source.color("Tf");
        let passes = tf.is_some_and(|tf| tf.iter().any(|&v| v > 0.0));
        let bends = ni.is_some_and(|ni| ni > 1.0);
        let refracts = match illum {
            Some(6 | 7) => true,
            Some(4) => bends && (passes || p.alpha < 1.0),
            Some(9) => bends && passes,
            Some(_) => false,
            None => bends && passes,
        };
        if !refracts || !p.emission.is_black() {
            return None;
        }
        let ior = ni.filter(|_| bends).unwrap_or(1.5);
        if !bends {
            let message = "an illumination model that refracts, without an `Ni` above 1: taken as 1.5";
            self.note("ior-assumed", NoteEffect::Differs, "illum", message);
        }
        let tint = tf.filter(|_| passes).map_or(Rgb::WHITE, |tf| self.color("Tf", tf, 1.0));
        let roughness = self.number("Pr").unwrap_or(0.0);
        if roughness == 0.0 {
            return Some(MaterialKind::Glass(Glass { ior, tint, absorption: None, priority: None }));
        }
        Some(MaterialKind::Principled(Box::new(Principled {
            base_color: tint,
            roughness,
            ior,
            transmission: 1.0,
            transmission_tint: tint,
            ..Principled::default()
        })))
    }

    /// What files of all programs share.
    fn common(&mut self) -> Principled {
        let source = self.source;
        let mut p = Principled::default();
        p.textures.base_color = self.texture("map_Kd");
        p.base_color = match source.color("Kd") {
            // A factor of zero would hide the picture; its exporters mean none.
            Some([0.0, 0.0, 0.0]) if p.textures.base_color.is_some() => {
                let message = "`Kd` is black under a `map_Kd`: taken as white";
                self.note("factor-ignored", NoteEffect::None, "Kd", message);
                Rgb::WHITE
            }
            Some(kd) => self.color("Kd", kd, 1.0),
            None if p.textures.base_color.is_some() => Rgb::WHITE,
            None => Rgb::grey(0.8),
        };
        p.emission = source.color("Ke").map_or(Rgb::BLACK, |ke| self.color("Ke", ke, f32::MAX));
        p.textures.emission = self.texture("map_Ke");
        if p.textures.emission.is_some() && p.emission.is_black() {
            p.emission = Rgb::WHITE;
        } else if source.map("map_Ke").is_some() && p.textures.emission.is_none() {
            // The factor alone would make the whole surface shine.
            p.emission = Rgb::BLACK;
        }

        // Coverage: d is what is there, Tr what is not.
        p.alpha = match (self.number("d"), self.number("Tr")) {
            (Some(d), _) => d,
            (None, Some(1.0)) => {
                let message =
                    "`Tr 1` would make the surface invisible; some programs mean the opposite: opaque";
                self.note("alpha-ignored", NoteEffect::Differs, "Tr", message);
                1.0
            }
            (None, Some(tr)) => 1.0 - tr,
            (None, None) => 1.0,
        };
        if let Some((texture, map)) = self.loader.texture(source, "map_d", self.log) {
            let channel = self.loader.channel(&texture, &map, true);
            if p.alpha == 0.0 {
                p.alpha = 1.0;
            }
            p.textures.alpha = Some(ScalarTexture { texture, channel });
        }
        if p.alpha < 1.0 || p.textures.alpha.is_some() {
            p.alpha_mode = AlphaMode::Blend;
        }

        p.textures.normal = self.normal();
        p.coat_roughness = self.number("Pcr").unwrap_or(0.0);
        let sheen = self.number("Ps").unwrap_or(0.0);
        p.sheen_color = Rgb::grey(self.fraction("Ps", sheen));
        p
    }

    fn normal(&mut self) -> Option<NormalTexture> {
        let blender = self.source.blender.is_some();
        if let Some((texture, map)) = self.loader.texture(self.source, "norm", self.log) {
            return Some(NormalTexture { texture, scale: map.strength.unwrap_or(1.0) });
        }
        let (texture, map) = self.loader.texture(self.source, "map_Bump", self.log)?;
        if blender || self.loader.is_normal_map(texture.image) {
            return Some(NormalTexture { texture, scale: map.strength.unwrap_or(1.0) });
        }
        let message = "a map of heights (its colours are not those of normals) is not rendered";
        self.note("bump-ignored", NoteEffect::Missing, "map_Bump", message);
        None
    }

    /// Notes statements that nothing above reads.
    fn unused(&mut self) {
        let ignored = [
            ("disp", "displacement is not rendered"),
            ("decal", "decals are not rendered"),
            ("map_Tr", "`map_Tr` is not read: use `map_d`"),
            ("map_Tf", "`map_Tf` is not read"),
            ("map_Ps", "textures of sheen are not read from MTL"),
            ("map_Pc", "textures of coat are not read from MTL"),
            ("map_Pcr", "textures of coat are not read from MTL"),
        ];
        for (key, message) in ignored {
            if self.source.map(key).is_some() {
                self.note("texture-ignored", NoteEffect::Missing, key, message);
            }
        }
        if self.source.blender.is_none()
            && (self.source.map("refl").or(self.source.map("map_refl"))).is_some()
        {
            let message = "reflection maps are not read: surfaces reflect the scene";
            self.note("texture-ignored", NoteEffect::None, "refl", message);
        }
        if self.source.map("map_Ka").is_some() {
            self.note("texture-ignored", NoteEffect::None, "map_Ka", "ambient light has no meaning here");
        }
        if self.number("aniso").is_some_and(|v| v != 0.0) {
            let message = "anisotropy is not rendered";
            self.note("anisotropy-ignored", NoteEffect::Differs, "aniso", message);
        }
    }

    fn note(&mut self, code: &'static str, effect: NoteEffect, key: &str, message: &str) {
        self.log.add(code, effect, self.source.place(key), message);
    }

    fn number(&mut self, key: &str) -> Option<f32> {
        self.source.number(key, self.log)
    }

    /// `value`, derived from `key`, within [0, 1].
    fn fraction(&mut self, key: &str, value: f32) -> f32 {
        if value > 1.0 {
            let message = format!("`{key}` of more than the whole: taken as 1");
            self.note("value-clamped", NoteEffect::Differs, key, &message);
        }
        value.min(1.0)
    }

    /// `value` with each channel within [0, max].
    fn color(&mut self, key: &str, value: [f32; 3], max: f32) -> Rgb {
        let color = Rgb::from(value);
        let good = color.map(|v| v.clamp(0.0, max.min(1e30)));
        if good != color {
            let message = format!("`{key}` {value:?}: taken as {:?}", good.to_array());
            self.note("value-clamped", NoteEffect::Differs, key, &message);
        }
        good
    }

    /// A colour that stands for a number.
    fn grey(&mut self, key: &str, value: [f32; 3]) -> f32 {
        let c = self.color(key, value, f32::MAX);
        (c.r + c.g + c.b) / 3.0
    }

    fn texture(&mut self, key: &str) -> Option<Texture> {
        self.loader.texture(self.source, key, self.log).map(|(t, _)| t)
    }

    fn scalar(&mut self, key: &str) -> Option<ScalarTexture> {
        let (texture, map) = self.loader.texture(self.source, key, self.log)?;
        let channel = self.loader.channel(&texture, &map, false);
        Some(ScalarTexture { texture, channel })
    }
}

/// Blender's specular level: 1/2 is what the index of refraction gives, the factor on F0 is twice it.
fn specular_level(level: Rgb) -> (f32, Rgb) {
    let factor = level * 2.0;
    let strength = factor.max_channel();
    if strength <= 1.0 && factor.min_channel() == strength { (strength, Rgb::WHITE) } else { (1.0, factor) }
}

/// Perceptual roughness of Phong's exponent.
fn phong_roughness(ns: f32) -> f32 {
    (2.0 / (ns + 2.0)).sqrt().sqrt()
}

//! Materials: glTF's metallic-roughness with its extensions, and beside it what that cannot say.

use serde_json::{Map, Value, json};

use super::Document;
use super::number::{color, single};
use crate::color::Rgb;
use crate::scene::extension::{AbsorptionTable, GlassTable, MaterialTable, PrincipledTable};
use crate::scene::text::Word;
use crate::scene::{Absorption, AlphaMode, Material, MaterialKind, Principled, Sides};

impl Document<'_> {
    /// The entry of a material.
    pub(super) fn material(&mut self, material: &Material, index: usize) -> Value {
        let matt = |base_color: Rgb, emission: Rgb| Principled {
            base_color,
            emission,
            roughness: 1.0,
            specular: 0.0,
            ..Principled::default()
        };
        let mut table = MaterialTable::default();
        let mut is_double = true;
        let look = match &material.kind {
            MaterialKind::Diffuse { color: c } => {
                table.diffuse = Some(color(*c));
                matt(*c, Rgb::BLACK)
            }
            MaterialKind::Mirror { color: c } => {
                table.mirror = Some(color(*c));
                Principled { base_color: *c, metallic: 1.0, roughness: 0.0, ..Principled::default() }
            }
            MaterialKind::Glass(g) => {
                table.glass = Some(GlassTable {
                    ior: Some(single(g.ior)),
                    tint: (g.tint != Rgb::WHITE).then(|| color(g.tint)),
                    absorption: g.absorption.as_ref().map(absorption),
                    priority: g.priority.map(f64::from),
                });
                is_double = false;
                Principled {
                    base_color: g.tint,
                    transmission: 1.0,
                    roughness: 0.0,
                    ior: g.ior.max(1.0),
                    absorption: g.absorption,
                    ..Principled::default()
                }
            }
            MaterialKind::Light { radiance, sides } => {
                table.light = Some(color(*radiance));
                is_double = *sides == Sides::Both;
                table.sides = is_double.then_some(Word(*sides));
                matt(Rgb::BLACK, *radiance)
            }
            MaterialKind::Principled(p) => {
                is_double = p.thin || p.transmission == 0.0;
                (**p).clone()
            }
        };
        let mut entry = Map::new();
        if !material.name.is_empty() {
            entry.insert("name".into(), material.name.as_str().into());
        }
        if is_double {
            entry.insert("doubleSided".into(), true.into());
        }
        let read = self.principled(&look, &mut entry, index);
        if let MaterialKind::Principled(p) = &material.kind {
            let differs = difference(p, &read);
            table.principled = (differs != PrincipledTable::default()).then_some(differs);
        }
        self.extend(&mut entry, &table);
        Value::Object(entry)
    }

    /// Writes `p` as glTF's material, and returns what a reader makes of that.
    fn principled(&mut self, p: &Principled, entry: &mut Map<String, Value>, index: usize) -> Principled {
        let mut read = p.clone();
        let mut pbr = Map::new();
        let [r, g, b] = color(p.base_color);
        if p.base_color != Rgb::WHITE || p.alpha != 1.0 {
            pbr.insert("baseColorFactor".into(), json!([r, g, b, single(p.alpha)]));
        }
        for (key, value) in [("metallicFactor", p.metallic), ("roughnessFactor", p.roughness)] {
            if value != 1.0 {
                pbr.insert(key.into(), single(value).into());
            }
        }
        entry.insert("pbrMetallicRoughness".into(), pbr.into());
        match p.alpha_mode {
            AlphaMode::Opaque => {}
            AlphaMode::Blend => _ = entry.insert("alphaMode".into(), "BLEND".into()),
            AlphaMode::Mask { cutoff } => {
                entry.insert("alphaMode".into(), "MASK".into());
                entry.insert("alphaCutoff".into(), single(cutoff).into());
            }
        }

        let mut extensions = Map::new();
        let mut add = |name: &'static str, value: Value| {
            extensions.insert(self.using(name).into(), value);
        };
        if !p.emission.is_black() {
            let strength = p.emission.max_channel().max(1.0);
            let factor = p.emission.map(|v| v / strength);
            entry.insert("emissiveFactor".into(), json!(color(factor)));
            if strength > 1.0 {
                add("KHR_materials_emissive_strength", json!({ "emissiveStrength": single(strength) }));
            }
            read.emission = factor * strength;
        }
        if p.transmission > 0.0 {
            add("KHR_materials_transmission", json!({ "transmissionFactor": single(p.transmission) }));
        }
        if p.ior != 1.5 {
            add("KHR_materials_ior", json!({ "ior": single(p.ior) }));
        }
        let mut specular = Map::new();
        if p.specular != 1.0 {
            specular.insert("specularFactor".into(), single(p.specular).into());
        }
        if p.specular_color != Rgb::WHITE {
            specular.insert("specularColorFactor".into(), json!(color(p.specular_color)));
        }
        if !specular.is_empty() {
            add("KHR_materials_specular", specular.into());
        }
        // A thickness says that there is a volume; how thick it is, rays find out themselves.
        let is_solid = p.transmission > 0.0 && !p.thin;
        if is_solid {
            let mut volume = json!({ "thicknessFactor": 1.0 });
            if let Some(a) = &p.absorption {
                volume["attenuationColor"] = json!(color(a.color));
                volume["attenuationDistance"] = single(a.distance).into();
            }
            add("KHR_materials_volume", volume);
        }
        if p.coat > 0.0 || p.coat_roughness > 0.0 {
            let mut coat = json!({ "clearcoatFactor": single(p.coat) });
            if p.coat_roughness > 0.0 {
                coat["clearcoatRoughnessFactor"] = single(p.coat_roughness).into();
            }
            add("KHR_materials_clearcoat", coat);
        }
        let default = Principled::default();
        if !p.sheen_color.is_black() || p.sheen_roughness != default.sheen_roughness {
            let mut sheen = json!({ "sheenColorFactor": color(p.sheen_color) });
            sheen["sheenRoughnessFactor"] = single(p.sheen_roughness).into();
            add("KHR_materials_sheen", sheen);
        }
        if !extensions.is_empty() {
            entry.insert("extensions".into(), extensions.into());
        }

        self.textures(p, entry, &format!("materials[{index}]"));

        read.transmission_tint = p.base_color;
        read.thin = !is_solid && p.transmission > 0.0;
        read.absorption = p.absorption.filter(|a| is_solid && a.color != Rgb::WHITE);
        read.coat_ior = default.coat_ior;
        read.priority = None;
        read
    }
}

fn absorption(a: &Absorption) -> AbsorptionTable {
    AbsorptionTable { color: Some(color(a.color)), distance: Some(single(a.distance)) }
}

/// What `p` has that `read` lacks. Only these keys can differ: the rest is written as it is.
fn difference(p: &Principled, read: &Principled) -> PrincipledTable {
    PrincipledTable {
        transmission_tint: (p.transmission_tint != read.transmission_tint)
            .then(|| color(p.transmission_tint)),
        thin: (p.thin != read.thin).then_some(p.thin),
        absorption: p.absorption.filter(|_| p.absorption != read.absorption).as_ref().map(absorption),
        emission: (p.emission != read.emission).then(|| color(p.emission)),
        priority: p.priority.filter(|_| p.priority != read.priority).map(f64::from),
        coat_ior: (p.coat_ior != read.coat_ior).then(|| single(p.coat_ior)),
        ..PrincipledTable::default()
    }
}

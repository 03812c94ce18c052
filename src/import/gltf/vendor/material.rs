//! Materials: the kinds that glTF does not have, and values that it cannot say.

use gltf::json;

use super::check::Check;
use super::table;
use crate::color::Rgb;
use crate::scene::extension::{AbsorptionTable, MaterialTable, PrincipledTable};
use crate::scene::notes::Notes;
use crate::scene::{Absorption, Glass, MaterialKind, Principled};

/// `kind` as the extension of `source`, at `place`, changes it.
pub(in super::super) fn material(
    source: &json::Material,
    kind: MaterialKind,
    place: &str,
    notes: &mut Notes,
) -> MaterialKind {
    let others = source.extensions.as_ref().map(|e| &e.others);
    let (t, place) = table::<MaterialTable>(others, &source.extras, place, notes);
    let mut check = Check { place, notes };
    let given = [
        ("diffuse", t.diffuse.is_some()),
        ("mirror", t.mirror.is_some()),
        ("glass", t.glass.is_some()),
        ("light", t.light.is_some()),
        ("principled", t.principled.is_some()),
    ];
    let mut given = given.iter().filter(|(_, is_given)| *is_given).map(|(key, _)| *key);
    let first = given.next();
    for other in given {
        check.ignore(
            other,
            "a material is one of diffuse, mirror, glass, light and principled, and more are given",
        );
    }
    if t.sides.is_some() && first != Some("light") {
        check.ignore("sides", "only a `light` has sides");
    }
    match (first, t) {
        (Some("diffuse"), MaterialTable { diffuse: Some(c), .. }) => {
            MaterialKind::Diffuse { color: check.color("diffuse", c, 1.0) }
        }
        (Some("mirror"), MaterialTable { mirror: Some(c), .. }) => {
            MaterialKind::Mirror { color: check.color("mirror", c, 1.0) }
        }
        (Some("glass"), MaterialTable { glass: Some(glass), .. }) => {
            let ior = check.number("glass.ior", glass.ior.unwrap_or(1.5), 1e-3, 1e3) as f32;
            let tint = glass.tint.map_or(Rgb::WHITE, |c| check.color("glass.tint", c, 1.0));
            let absorption = glass.absorption.and_then(|a| absorption(&a, "glass.absorption", &mut check));
            let priority = glass.priority.map(|v| priority("glass.priority", v, &mut check));
            MaterialKind::Glass(Glass { ior, tint, absorption, priority })
        }
        (Some("light"), MaterialTable { light: Some(c), sides, .. }) => {
            let radiance = check.emitted("light", c);
            MaterialKind::Light { radiance, sides: sides.map_or_else(Default::default, |word| word.0) }
        }
        (Some("principled"), MaterialTable { principled: Some(values), .. }) => match kind {
            MaterialKind::Principled(mut p) => {
                principled(&values, &mut p, &mut check);
                MaterialKind::Principled(p)
            }
            other => other,
        },
        _ => kind,
    }
}

fn principled(t: &PrincipledTable, p: &mut Principled, check: &mut Check<'_>) {
    let key = |key: &str| format!("principled.{key}");
    let mut color = |to: &mut Rgb, name: &str, value: Option<[f64; 3]>, max: f32| {
        if let Some(value) = value {
            *to = check.color(&key(name), value, max);
        }
    };
    color(&mut p.base_color, "base_color", t.base_color, 1.0);
    color(&mut p.specular_color, "specular_color", t.specular_color, f32::MAX);
    color(&mut p.transmission_tint, "transmission_tint", t.transmission_tint, 1.0);
    color(&mut p.emission, "emission", t.emission, crate::scene::MAX_RADIANCE);
    color(&mut p.sheen_color, "sheen_color", t.sheen_color, 1.0);
    let mut number = |to: &mut f32, name: &str, value: Option<f64>, min: f64, max: f64| {
        if let Some(value) = value {
            *to = check.number(&key(name), value, min, max) as f32;
        }
    };
    number(&mut p.metallic, "metallic", t.metallic, 0.0, 1.0);
    number(&mut p.roughness, "roughness", t.roughness, 0.0, 1.0);
    number(&mut p.ior, "ior", t.ior, 1.0, 1e3);
    number(&mut p.specular, "specular", t.specular, 0.0, 1.0);
    number(&mut p.transmission, "transmission", t.transmission, 0.0, 1.0);
    number(&mut p.alpha, "alpha", t.alpha, 0.0, 1.0);
    number(&mut p.coat, "coat", t.coat, 0.0, 1.0);
    number(&mut p.coat_roughness, "coat_roughness", t.coat_roughness, 0.0, 1.0);
    number(&mut p.coat_ior, "coat_ior", t.coat_ior, 1.0, 1e3);
    number(&mut p.sheen_roughness, "sheen_roughness", t.sheen_roughness, 0.0, 1.0);
    if let Some(thin) = t.thin {
        p.thin = thin;
    }
    if let Some(value) = t.priority {
        p.priority = Some(priority(&key("priority"), value, check));
    }
    if let Some(a) = &t.absorption {
        p.absorption = absorption(a, &key("absorption"), check);
    }
}

/// A whole number from 0 to 255.
fn priority(key: &str, value: f64, check: &mut Check<'_>) -> u8 {
    check.number(key, value.round(), 0.0, 255.0) as u8
}

fn absorption(a: &AbsorptionTable, key: &str, check: &mut Check<'_>) -> Option<Absorption> {
    let (Some(color), Some(distance)) = (a.color, a.distance) else {
        check.ignore(key, "absorption needs `color` and `distance`");
        return None;
    };
    let distance = check.length(&format!("{key}.distance"), distance)? as f32;
    // Zero would be an infinite coefficient.
    let color = check.color(&format!("{key}.color"), color, 1.0);
    if color.min_channel() > 0.0 {
        return Some(Absorption { color, distance });
    }
    let good = color.map(|v| v.max(1e-6));
    check.clamped(&format!("{key}.color"), "a channel of 0", &format!("{:?}", good.to_array()));
    Some(Absorption { color: good, distance })
}

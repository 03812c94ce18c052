//! Lights of the extension, alone or on top of `KHR_lights_punctual`, and those of `EXT_lights_area`.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DAffine3, DMat3};
use serde_json::Value;

use super::check::Check;
use super::{Node, ignored};
use crate::color::Rgb;
use crate::scene::extension::{LightTable, LightType};
use crate::scene::notes::Notes;
use crate::scene::{AreaShape, Light, LightKind, MAX_RADIANCE, SpotFalloff};

/// The widest sun: just below half a turn.
const MAX_ANGLE: f64 = PI * (1.0 - f64::EPSILON);

impl Node {
    /// The light at this node: `punctual` as the extension changes it, or one of its own. `nits` is what
    /// the luminances of `EXT_lights_area` are multiplied with to become radiances.
    pub(in super::super) fn light(
        &self,
        punctual: Option<Light>,
        name: &str,
        world: DAffine3,
        nits: f64,
        notes: &mut Notes,
    ) -> Option<Light> {
        let base = punctual.or_else(|| {
            let (light, place) = self.area_light.as_ref()?;
            Some(area_light(light, name, world, nits, place, notes))
        });
        let mut light = match (&self.table.light, base) {
            (None, base) => base?,
            (Some(table), base) => {
                let mut check = Check { place: format!("{}.light", self.place), notes };
                let kind = kind(table, base.as_ref().map(|l| &l.kind), &mut check);
                match (kind, base) {
                    (Some(kind), Some(base)) => Light { kind, ..base },
                    (Some(kind), None) => {
                        Light { name: name.to_owned(), kind, transform: world, visible_to_camera: false }
                    }
                    (None, base) => base?,
                }
            }
        };
        if world.matrix3.determinant() == 0.0 {
            ignored(notes, self.place.clone(), "a light whose node has no size");
            return None;
        }
        light.visible_to_camera = self.visible_to_camera().unwrap_or(light.visible_to_camera);
        Some(light)
    }
}

/// The kind of light that `table` describes on top of `base`.
fn kind(table: &LightTable, base: Option<&LightKind>, check: &mut Check<'_>) -> Option<LightKind> {
    use LightType::{Area, Point, Spot, Sun};
    let base_type = base.map(|kind| match kind {
        LightKind::Point { .. } => Point,
        LightKind::Spot { .. } => Spot,
        LightKind::Sun { .. } => Sun,
        LightKind::Area { .. } => Area,
    });
    let Some(wanted) = table.kind.or(base_type) else {
        check.ignore("type", "a light needs a `type`, or KHR_lights_punctual at the same node");
        return None;
    };
    // The other kinds' values are of no use.
    let keys: [(&str, bool, &[LightType]); 10] = [
        ("intensity", table.intensity.is_some(), &[Point, Spot]),
        ("irradiance", table.irradiance.is_some(), &[Sun]),
        ("radiance", table.radiance.is_some(), &[Area]),
        ("radius", table.radius.is_some(), &[Point, Spot]),
        ("angle", table.angle.is_some(), &[Sun]),
        ("inner", table.inner.is_some(), &[Spot]),
        ("outer", table.outer.is_some(), &[Spot]),
        ("falloff", table.falloff.is_some(), &[Spot]),
        ("shape", table.shape.is_some(), &[Area]),
        ("size", table.size.is_some(), &[Area]),
    ];
    for (key, _, _) in keys.iter().filter(|(_, given, of)| *given && !of.contains(&wanted)) {
        check.ignore(key, &format!("a {} light has no `{key}`", name(wanted)));
    }
    let base = base.filter(|_| base_type == Some(wanted));
    let power = |key: &str, given: Option<[f64; 3]>, base: Option<Rgb>, check: &mut Check<'_>| {
        let found = given.map(|v| check.emitted(key, v)).or(base);
        if found.is_none() {
            check.ignore(key, &format!("a {} light needs its `{key}`", name(wanted)));
        }
        found
    };
    match wanted {
        Point => {
            let (at, base_radius) = match base {
                Some(LightKind::Point { intensity, radius }) => (Some(*intensity), *radius),
                _ => (None, 0.0),
            };
            let intensity = power("intensity", table.intensity, at, check)?;
            Some(LightKind::Point { intensity, radius: radius(table, base_radius, intensity, check) })
        }
        Spot => {
            let (at, mut inner, mut outer, mut falloff, base_radius) = match base {
                Some(LightKind::Spot { intensity, inner, outer, falloff, radius }) => {
                    (Some(*intensity), *inner, *outer, *falloff, *radius)
                }
                _ => (None, 0.0, PI / 4.0, SpotFalloff::Gltf, 0.0),
            };
            let intensity = power("intensity", table.intensity, at, check)?;
            if let Some(v) = table.outer {
                outer = check.number("outer", v, 1e-3, FRAC_PI_2);
            }
            if let Some(v) = table.inner {
                inner = check.number("inner", v, 0.0, outer);
            }
            if let Some(word) = table.falloff {
                falloff = word.0;
            }
            let radius = radius(table, base_radius, intensity, check);
            Some(LightKind::Spot { intensity, inner: inner.min(outer), outer, falloff, radius })
        }
        Sun => {
            let (at, base_angle) = match base {
                Some(LightKind::Sun { irradiance, angle }) => (Some(*irradiance), *angle),
                _ => (None, 0.0),
            };
            let irradiance = power("irradiance", table.irradiance, at, check)?;
            let angle = table.angle.map_or(base_angle, |v| check.number("angle", v, 0.0, MAX_ANGLE));
            Some(LightKind::Sun { irradiance, angle })
        }
        Area => {
            let (at, shape, base_size) = match base {
                Some(LightKind::Area { radiance, shape, size }) => (Some(*radiance), *shape, Some(*size)),
                _ => (None, AreaShape::default(), None),
            };
            let radiance = power("radiance", table.radiance, at, check)?;
            let shape = table.shape.map_or(shape, |word| word.0);
            let size = match table.size {
                Some([x, y]) => [check.length("size", x)?, check.length("size", y)?],
                None if base_size.is_none() => {
                    check.ignore("size", "an area light needs its `size`");
                    return None;
                }
                None => base_size?,
            };
            Some(LightKind::Area { shape, size, radiance })
        }
    }
}

fn name(kind: LightType) -> &'static str {
    match kind {
        LightType::Point => "point",
        LightType::Spot => "spot",
        LightType::Sun => "sun",
        LightType::Area => "area",
    }
}

/// Zero, or a radius at which the sphere's radiance is in range.
fn radius(table: &LightTable, base: f64, intensity: Rgb, check: &mut Check<'_>) -> f64 {
    let Some(given) = table.radius else { return base };
    if given == 0.0 {
        return 0.0;
    }
    let Some(radius) = check.length("radius", given) else { return base };
    if f64::from(intensity.max_channel()) / (PI * radius * radius) > f64::from(MAX_RADIANCE) {
        check.ignore("radius", &format!("{radius} is so small that the light would be too bright"));
        return base;
    }
    radius
}

/// A light of `EXT_lights_area`, with the defaults of its specification. Its size is scaled evenly, by
/// the node's largest scale.
fn area_light(
    light: &Value,
    name: &str,
    world: DAffine3,
    nits: f64,
    place: &str,
    notes: &mut Notes,
) -> Light {
    let mut check = Check { place: place.to_owned(), notes };
    let mut number = |value: Option<&Value>, key: &str, default: f64, min: f64, max: f64| match value {
        None => default,
        Some(value) => match value.as_f64() {
            Some(v) => check.number(key, v, min, max),
            None => {
                check.ignore(key, "it is no number");
                default
            }
        },
    };
    let intensity = number(light.get("intensity"), "intensity", 1000.0, 0.0, MAX_RADIANCE.into());
    let size = number(light.get("size"), "size", 1.0, 1e-9, 1e9);
    let aspect = light.get("rect").and_then(|r| r.get("aspect"));
    let aspect = number(aspect, "rect.aspect", 1.0, 1e-5, 1e5);
    let color: Option<[f64; 3]> = light.get("color").and_then(|c| serde_json::from_value(c.clone()).ok());
    let radiance = color.unwrap_or([1.0; 3]).map(|v| v * intensity * nits);
    let radiance = check.emitted("color", radiance);
    let is_disk = match light.get("type").and_then(Value::as_str) {
        Some("disk") => true,
        Some("rect") => false,
        _ => {
            check.ignore("type", "it is neither rect nor disk, so a rect is taken");
            false
        }
    };
    let kind = if is_disk {
        LightKind::Area { shape: AreaShape::Ellipse, size: [size; 2], radiance }
    } else {
        LightKind::Area { shape: AreaShape::Rectangle, size: [size * aspect, size], radiance }
    };
    let m = world.matrix3;
    let largest = m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
    let even = |axis: glam::DVec3| axis.normalize_or_zero() * largest;
    let matrix3 = DMat3::from_cols(even(m.x_axis), even(m.y_axis), even(m.z_axis));
    let transform = DAffine3 { matrix3, translation: world.translation };
    Light { name: name.to_owned(), kind, transform, visible_to_camera: false }
}

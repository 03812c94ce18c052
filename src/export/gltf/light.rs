//! Lights: `KHR_lights_punctual` for those that it has, and all of them exactly in the extension.

use serde_json::{Map, Value, json};

use super::Document;
use super::number::{color, single};
use crate::color::Rgb;
use crate::scene::extension::{LightTable, LightType, NodeTable, VisibilityTable};
use crate::scene::text::Word;
use crate::scene::{Light, LightKind};

/// The narrowest cone that glTF's singles can tell from none.
const LEAST_CONE: f64 = 1e-6;

impl Document<'_> {
    /// Writes a light as a node.
    pub(super) fn light(&mut self, light: &Light) {
        let (table, punctual) = match light.kind {
            LightKind::Point { intensity, radius } => {
                let table = LightTable {
                    kind: Some(LightType::Point),
                    intensity: Some(color(intensity)),
                    radius: (radius != 0.0).then_some(radius),
                    ..LightTable::default()
                };
                (table, Some(punctual("point", intensity)))
            }
            LightKind::Spot { intensity, inner, outer, falloff, radius } => {
                let table = LightTable {
                    kind: Some(LightType::Spot),
                    intensity: Some(color(intensity)),
                    radius: (radius != 0.0).then_some(radius),
                    inner: Some(inner),
                    outer: Some(outer),
                    falloff: Some(Word(falloff)),
                    ..LightTable::default()
                };
                let mut spot = punctual("spot", intensity);
                // glTF wants the inner cone to be smaller than the outer one.
                let outer = outer.max(LEAST_CONE);
                let inner = inner.min(outer * (1.0 - LEAST_CONE));
                spot["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
                (table, Some(spot))
            }
            LightKind::Sun { irradiance, angle } => {
                let table = LightTable {
                    kind: Some(LightType::Sun),
                    irradiance: Some(color(irradiance)),
                    angle: (angle != 0.0).then_some(angle),
                    ..LightTable::default()
                };
                (table, Some(punctual("directional", irradiance)))
            }
            LightKind::Area { shape, size, radiance } => {
                let table = LightTable {
                    kind: Some(LightType::Area),
                    radiance: Some(color(radiance)),
                    shape: Some(Word(shape)),
                    size: Some(size),
                    ..LightTable::default()
                };
                (table, None)
            }
        };
        let mut node = Map::new();
        if let Some(mut entry) = punctual {
            if !light.name.is_empty() {
                entry["name"] = light.name.as_str().into();
            }
            self.lights.push(entry);
            let name = self.using("KHR_lights_punctual");
            node.insert("extensions".into(), json!({ name: { "light": self.lights.len() - 1 } }));
        }
        let visibility = light.visible_to_camera.then_some(VisibilityTable { camera: Some(true) });
        let table = NodeTable { light: Some(table), visibility, ..NodeTable::default() };
        self.place(&light.name, node, table, &light.transform);
    }
}

/// A punctual light of this power: a colour up to one, times an intensity.
fn punctual(kind: &str, power: Rgb) -> Value {
    let strength = power.max_channel();
    let tint = if strength > 0.0 { power.map(|v| v / strength) } else { Rgb::WHITE };
    json!({ "type": kind, "color": color(tint), "intensity": single(strength) })
}

//! `KHR_lights_punctual`: point, spot and sun, in watts.
//!
//! The extension speaks of candela and lux, which say nothing about power until a spectrum is fixed;
//! see [`LightUnits`] for what they are taken for.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DAffine3;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as GltfLight, Type};
use gltf::json::validation::Checked;

use super::super::LightUnits;
use super::super::error::Fault;
use super::super::notes::Notes;
use crate::color::Rgb;
use crate::scene::{Light, LightKind, NoteEffect, SpotFalloff};

/// Converts the lights of one document.
pub(super) struct Lights {
    units: LightUnits,
    auto: bool,
    blender: bool,
}

impl Lights {
    /// For a document by Blender's exporter or by another.
    pub(super) fn new(units: LightUnits, blender: bool) -> Self {
        let auto = units == LightUnits::Auto;
        let units = match units {
            LightUnits::Auto if blender => LightUnits::BlenderSpec,
            LightUnits::Auto => LightUnits::Unitless,
            other => other,
        };
        Self { units, auto, blender }
    }

    /// `light`, that stands at `place`, under `name` and with `transform`.
    pub(super) fn convert(
        &self,
        light: &GltfLight,
        name: String,
        transform: DAffine3,
        place: &str,
        notes: &mut Notes,
    ) -> Result<Light, Fault> {
        let Checked::Valid(kind) = light.type_ else {
            return Err(Fault::invalid(
                format!("{place}.type"),
                "an unknown value",
                "directional, point or spot",
            ));
        };
        self.note_units(notes);
        if light.range.is_some() {
            let message = "a range is ignored: light follows the inverse square";
            notes.add("light-range-ignored", NoteEffect::None, format!("{place}.range"), message);
        }
        let is_sun = kind == Type::Directional;
        let scale = match self.units {
            LightUnits::BlenderSpec => 1.0 / 683.0,
            LightUnits::Raw if !is_sun => 0.25 / PI,
            LightUnits::Auto | LightUnits::Unitless | LightUnits::Raw => 1.0,
        };
        let strength = (f64::from(light.intensity) * scale) as f32;
        let power = Rgb::from(light.color) * strength;
        let clamped = power.map(|v| if v.is_finite() { v.max(0.0) } else { 0.0 });
        if clamped != power {
            let message =
                format!("{:?} is no intensity: taken as {:?}", power.to_array(), clamped.to_array());
            notes.add("value-clamped", NoteEffect::Differs, place, message);
        }
        let (intensity, radius) = (clamped, 0.0);
        let kind = match kind {
            Type::Directional => LightKind::Sun { irradiance: clamped, angle: 0.0 },
            Type::Point => LightKind::Point { intensity, radius },
            Type::Spot => {
                let spot = light.spot.clone().unwrap_or_default();
                // The default outer angle is that of the JSON, not that of the type.
                let outer = if light.spot.is_some() { f64::from(spot.outer_cone_angle) } else { PI / 4.0 };
                let inner = f64::from(spot.inner_cone_angle);
                // An f32 can exceed the half circle by its rounding.
                let good = outer.clamp(1e-3, FRAC_PI_2);
                let good_inner = inner.clamp(0.0, good);
                if (good - outer).abs() > 1e-6 || (good_inner - inner).abs() > 1e-6 {
                    let message =
                        format!("cone angles {inner} and {outer}: taken as {good_inner} and {good}");
                    notes.add("value-clamped", NoteEffect::Differs, format!("{place}.spot"), message);
                }
                let falloff = if self.blender { SpotFalloff::Blender } else { SpotFalloff::Gltf };
                LightKind::Spot { intensity, inner: good_inner, outer: good, falloff, radius }
            }
        };
        // Blender hides lights from its camera; without an extent there is nothing to see anyway.
        Ok(Light { name, kind, transform, visible_to_camera: false })
    }

    /// What luminances are multiplied with to become radiances.
    pub(super) fn nits(&self) -> f64 {
        if self.units == LightUnits::BlenderSpec { 1.0 / 683.0 } else { 1.0 }
    }

    fn note_units(&self, notes: &mut Notes) {
        let place = "extensions.KHR_lights_punctual";
        if self.auto {
            let (message, effect) = match self.units {
                LightUnits::BlenderSpec => (
                    "lights are taken as exported with Blender's \"Standard\" lighting: divided by 683",
                    NoteEffect::None,
                ),
                _ => ("candela and lux are taken as W/sr and W/m^2", NoteEffect::Differs),
            };
            notes.add_many("light-units", effect, place, message, 0);
        }
        if self.blender {
            let message = "the sizes of lights are not in the file: their shadows are sharp";
            notes.add_many("light-size-lost", NoteEffect::Differs, place, message, 0);
        }
    }
}

//! Compiling materials: the fewest lobes that render each.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::bsdf::dielectric::RoughDielectric;
use crate::bsdf::fresnel::{dielectric, f0_of_ior, ior_of_f0};
use crate::bsdf::tables::{self, AlbedoRow};
use crate::bsdf::{Bsdf, Charlie, Coat, Diffuse, Glass, Mirror, Principled, SMOOTH_ALPHA, Sheen, Specular};
use crate::color::Rgb;
use crate::math;
use crate::scene::{self, Absorption, MaterialKind, Scene};

/// A material as the integrator reads it.
#[derive(Clone, Debug)]
pub struct PreparedMaterial {
    /// What it does to light.
    pub bsdf: Bsdf,
    /// What the inside does to light that was refracted into it; `None` where it does nothing.
    pub interior: Option<Interior>,
    /// Whether light that is transmitted enters or leaves a volume; false for sheets.
    pub encloses: bool,
    /// What the albedo feature shows.
    pub albedo: Rgb,
}

/// An absorbing medium.
#[derive(Clone, Copy, Debug)]
pub struct Interior {
    /// ln of the transmittance per distance, times the distance: transmittance is
    /// exp(log * length / distance). Kept apart so that lengths only ever appear as a ratio.
    log: Rgb,
    /// Metres.
    distance: f32,
}

impl Interior {
    fn new(a: &Absorption) -> Option<Self> {
        (a.color != Rgb::WHITE)
            .then(|| Self { log: a.color.map(|c| math::ln(c.max(1e-30))), distance: a.distance })
    }

    /// Share of light left after `length` metres (Beer and Lambert).
    #[inline]
    #[must_use]
    pub fn transmittance(&self, length: f32) -> Rgb {
        let x = length / self.distance;
        // Lengths without bound leave nothing of what is absorbed at all.
        self.log.map(|l| if l == 0.0 { 1.0 } else { math::exp(l * x) })
    }
}

/// Rows of albedo tables, each computed once for the parameters that define it.
#[derive(Default)]
struct Rows {
    rows: BTreeMap<(u8, u32, u32), Arc<AlbedoRow>>,
}

impl Rows {
    fn get(&mut self, kind: u8, alpha: f32, eta: f32, albedo: impl Fn(f32) -> f32) -> Arc<AlbedoRow> {
        let key = (kind, alpha.to_bits(), eta.to_bits());
        Arc::clone(self.rows.entry(key).or_insert_with(|| Arc::new(AlbedoRow::new(albedo))))
    }

    fn white(&mut self, alpha: f32) -> Arc<AlbedoRow> {
        self.get(0, alpha, 0.0, |mu| tables::reflected(mu, alpha, |_| 1.0))
    }

    fn total(&mut self, alpha: f32, eta: f32) -> Arc<AlbedoRow> {
        self.get(1, alpha, eta, |mu| tables::dielectric_total(mu, alpha, eta))
    }
}

/// All materials of a scene.
pub(super) fn compile(scene: &Scene) -> Vec<PreparedMaterial> {
    let mut rows = Rows::default();
    scene.materials.iter().map(|m| compile_one(&m.kind, &mut rows)).collect()
}

fn compile_one(kind: &MaterialKind, rows: &mut Rows) -> PreparedMaterial {
    let plain = |bsdf, albedo| PreparedMaterial { bsdf, interior: None, encloses: false, albedo };
    match kind {
        MaterialKind::Diffuse { color } => plain(diffuse(*color), *color),
        MaterialKind::Mirror { color } => plain(Bsdf::Mirror(Mirror { color: *color }), *color),
        MaterialKind::Light { .. } => plain(Bsdf::Black, Rgb::BLACK),
        MaterialKind::Glass(g) => PreparedMaterial {
            bsdf: Bsdf::Glass(Glass { ior: g.ior, tint: g.tint, thin: false }),
            interior: g.absorption.as_ref().and_then(Interior::new),
            encloses: true,
            albedo: g.tint,
        },
        MaterialKind::Principled(p) => PreparedMaterial {
            bsdf: principled(p, rows),
            interior: p.absorption.as_ref().filter(|_| !p.thin).and_then(Interior::new),
            encloses: !p.thin,
            albedo: p.base_color,
        },
    }
}

fn diffuse(color: Rgb) -> Bsdf {
    if color.is_black() { Bsdf::Black } else { Bsdf::Diffuse(Diffuse { color }) }
}

/// Whether transmission leaves light on its way, whatever the roughness: a body of index one.
fn is_straight(p: &scene::Principled) -> bool {
    p.ior == 1.0 && !p.thin
}

/// Whether the material is nothing but a smooth dielectric.
pub(super) fn is_smooth_glass(p: &scene::Principled) -> bool {
    let smooth = p.roughness * p.roughness < SMOOTH_ALPHA || is_straight(p);
    smooth && p.metallic == 0.0 && p.transmission == 1.0 && !has_layers(p)
}

/// Whether there is a coat that reflects, or a sheen.
pub(super) fn has_layers(p: &scene::Principled) -> bool {
    has_coat(p) || !p.sheen_color.is_black()
}

fn has_coat(p: &scene::Principled) -> bool {
    p.coat > 0.0 && p.coat_ior != 1.0
}

/// The principled material, or what it reduces to exactly.
fn principled(p: &scene::Principled, rows: &mut Rows) -> Bsdf {
    let alpha = p.roughness * p.roughness;
    let smooth = alpha < SMOOTH_ALPHA;
    let dielectric_share = 1.0 - p.metallic;
    let transmits = dielectric_share * p.transmission > 0.0;
    let opaque = dielectric_share * (1.0 - p.transmission) > 0.0;
    let glass = Glass { ior: p.ior, tint: p.transmission_tint, thin: p.thin };
    if is_smooth_glass(p) {
        return Bsdf::Glass(glass);
    }
    let specular = if opaque { specular(p, alpha, rows) } else { None };
    if specular.is_none() && p.metallic == 0.0 && p.transmission == 0.0 && !has_layers(p) {
        return diffuse(p.base_color);
    }
    let needs_white = !smooth && (p.metallic > 0.0 || specular.is_some());
    let rough = (!smooth && transmits && !is_straight(p)).then(|| {
        let total = if p.thin {
            let white = rows.white(alpha);
            [Arc::clone(&white), white]
        } else {
            [rows.total(alpha, p.ior), rows.total(alpha, 1.0 / p.ior)]
        };
        RoughDielectric { alpha, ior: p.ior, tint: p.transmission_tint, thin: p.thin, total }
    });
    Bsdf::Principled(Box::new(Principled {
        alpha: if smooth { 0.0 } else { alpha },
        metal: p.metallic,
        transmission: p.transmission,
        base: p.base_color,
        specular,
        white: needs_white.then(|| rows.white(alpha)),
        rough,
        smooth: glass,
        coat: has_coat(p).then(|| coat(p, rows)),
        sheen: (!p.sheen_color.is_black()).then(|| sheen(p, rows)),
    }))
}

fn coat(p: &scene::Principled, rows: &mut Rows) -> Coat {
    let (alpha, ior) = (p.coat_roughness * p.coat_roughness, p.coat_ior);
    let smooth = alpha < SMOOTH_ALPHA;
    let albedo = |mu| tables::reflected(mu, alpha, |cos| dielectric(cos, ior).0);
    Coat {
        weight: p.coat,
        alpha: if smooth { 0.0 } else { alpha },
        ior,
        albedo: (!smooth).then(|| rows.get(3, alpha, ior, albedo)),
    }
}

fn sheen(p: &scene::Principled, rows: &mut Rows) -> Sheen {
    let lobe = Charlie::new(p.sheen_roughness);
    let albedo = rows.get(4, p.sheen_roughness, 0.0, |mu| lobe.albedo(mu));
    Sheen { color: p.sheen_color, lobe, albedo }
}

/// The dielectric layer; `None` where it reflects nothing.
fn specular(p: &scene::Principled, alpha: f32, rows: &mut Rows) -> Option<Specular> {
    let strongest = p.specular_color.max_channel();
    let f0 = f0_of_ior(p.ior) * p.specular;
    // A tint above one is strength: as in Cycles it raises the index, and what is left is the tint.
    let (f0, tint) = if strongest > 1.0 {
        ((f0 * strongest).min(0.99), p.specular_color / strongest)
    } else {
        (f0, p.specular_color)
    };
    if f0 <= 0.0 {
        return None;
    }
    let eta = ior_of_f0(f0);
    let mut s = Specular { f0, tint, eta, grazing: None, average: Rgb::BLACK };
    let share = |mu: f32| ((dielectric(mu, eta).0 - f0) / (1.0 - f0)).clamp(0.0, 1.0);
    let average = AlbedoRow::new(share).average();
    s.average = (tint * f0).lerp(Rgb::WHITE, average);
    if alpha >= SMOOTH_ALPHA {
        s.grazing = Some(rows.get(2, alpha, eta, |mu| tables::reflected(mu, alpha, share)));
    }
    Some(s)
}

//! Compiling materials: the fewest lobes that render each.
//!
//! What is the same everywhere on a surface is compiled once; what a texture or vertex colours vary is
//! compiled again at each hit, by the same functions, in [`super::varying`].

use std::borrow::Cow;
use std::sync::Arc;

use super::albedo::{Albedos, AllTables, Rows};
use super::cutout::Cutout;
use super::detail::Detail;
use super::fold::{Folded, Uses};
use super::glow::Glow;
use super::normal::NormalMap;
use super::texture::Sampler;
use super::varying::Varying;
use crate::bsdf::dielectric::RoughDielectric;
use crate::bsdf::fresnel::{Fresnel, f0_of_ior, ior_of_f0};
use crate::bsdf::{Bsdf, Charlie, Coat, Diffuse, Glass, Mirror, Principled, SMOOTH_ALPHA, Sheen, Specular};
use crate::color::Rgb;
use crate::math;
use crate::scene::{self, Absorption, ImageId, MaterialKind, Pixels, Scene};

/// GGX widths from here on are wide: a roughness of 0.71, whose lobe is at most five times as high as a mean.
const WIDE_ALPHA: f32 = 0.5;

/// GGX widths below this are narrow: a roughness below 0.32. Light that such a surface throws onto something
/// else is a caustic, if photons look for it.
pub(super) const NARROW_ALPHA: f32 = 0.1;

/// A material as the integrator reads it.
#[derive(Clone, Debug)]
pub struct PreparedMaterial {
    /// What it does to light.
    pub bsdf: Bsdf,
    /// What the inside does to light that was refracted into it; `None` where it does nothing.
    pub interior: Option<Interior>,
    /// Whether light that is transmitted enters or leaves a volume; false for sheets.
    pub encloses: bool,
    /// Whether it has lobes with a spread, and all of them are narrow: what it does counts as thrown, as what a lobe
    /// does that has no spread.
    pub(crate) narrow: bool,
    /// Whether what it does is so far from spreading light everywhere that the few photons around a point would show it
    /// as dots ([`is_peaked`]).
    pub(crate) peaked: bool,
    /// What the albedo feature shows, where nothing varies.
    pub albedo: Rgb,
    /// Whether any of the following is there.
    pub(crate) detailed: bool,
    /// What has to be compiled at the hit instead of `bsdf`.
    pub(crate) varying: Option<Box<Varying>>,
    /// Where the surface is not there.
    pub(crate) cutout: Option<Box<Cutout>>,
    /// Normals from a texture.
    pub(crate) normal: Option<Box<NormalMap>>,
    /// What is emitted where a picture varies it.
    pub(crate) emission: Option<Box<Glow>>,
}

/// The numbers and colours of a principled material at one point of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers {
    pub(super) base_color: Rgb,
    pub(super) metallic: f32,
    pub(super) roughness: f32,
    pub(super) ior: f32,
    pub(super) specular: f32,
    pub(super) specular_color: Rgb,
    pub(super) transmission: f32,
    pub(super) transmission_tint: Rgb,
    pub(super) thin: bool,
    pub(super) coat: f32,
    pub(super) coat_roughness: f32,
    pub(super) coat_ior: f32,
    pub(super) sheen_color: Rgb,
    pub(super) sheen_roughness: f32,
    pub(super) fresnel: Fresnel,
}

impl From<&scene::Principled> for Numbers {
    fn from(p: &scene::Principled) -> Self {
        Self {
            base_color: p.base_color,
            metallic: p.metallic,
            roughness: p.roughness,
            ior: p.ior,
            specular: p.specular,
            specular_color: p.specular_color,
            transmission: p.transmission,
            transmission_tint: p.transmission_tint,
            thin: p.thin,
            coat: p.coat,
            coat_roughness: p.coat_roughness,
            coat_ior: p.coat_ior,
            sheen_color: p.sheen_color,
            sheen_roughness: p.sheen_roughness,
            fresnel: Fresnel::Exact,
        }
    }
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

impl PreparedMaterial {
    /// The lobes at a point that is seen, or lit, under the cosine `mu`, [0, 1], to the shading normal.
    #[inline]
    #[must_use]
    pub(crate) fn bsdf_at(&self, detail: &Detail, mu: f32) -> Cow<'_, Bsdf> {
        match &self.varying {
            Some(varying) => Cow::Owned(varying.bsdf(detail, mu)),
            None => Cow::Borrowed(&self.bsdf),
        }
    }

    /// What layers on top leave of light that the surface emits at the cosine `mu`, [0, 1], to its geometric
    /// normal; one where there are none.
    #[inline]
    #[must_use]
    pub(crate) fn emission_scale(&self, detail: &Detail, mu: f32) -> f32 {
        match &self.varying {
            None => self.bsdf.emission_scale(mu),
            Some(varying) if varying.has_layers() => varying.bsdf(detail, mu).emission_scale(mu),
            Some(_) => 1.0,
        }
    }
}

/// The pixels of a picture; white where it has not been read.
pub(super) fn pixels(scene: &Scene, image: ImageId) -> Arc<Pixels> {
    let read = scene.images.get(image.0 as usize).and_then(|i| i.pixels.clone());
    read.unwrap_or_else(|| {
        Arc::new(Pixels { width: 1, height: 1, texels: scene::Texels::Float(vec![[1.0; 3]]) })
    })
}

/// Compiles materials, and keeps the tables that several of them read.
pub(super) struct Compiler<'a> {
    scene: &'a Scene,
    fresnel: Fresnel,
    rows: Rows,
    tables: AllTables,
}

impl<'a> Compiler<'a> {
    /// For materials whose dielectrics reflect by that curve.
    pub(super) fn new(scene: &'a Scene, fresnel: Fresnel) -> Self {
        Self { scene, fresnel, rows: Rows::new(fresnel), tables: AllTables::new(fresnel) }
    }

    /// All materials of the scene.
    pub(super) fn all(&mut self, folded: &Folded<'_>) -> Vec<PreparedMaterial> {
        folded.kinds.iter().zip(&folded.uses).map(|(kind, uses)| self.material(kind, uses)).collect()
    }

    /// A material that has been folded.
    pub(super) fn material(&mut self, kind: &MaterialKind, uses: &Uses) -> PreparedMaterial {
        let m = self.compile(kind, uses);
        let detailed =
            m.varying.is_some() || m.cutout.is_some() || m.normal.is_some() || m.emission.is_some();
        PreparedMaterial { detailed, ..m }
    }

    fn compile(&mut self, kind: &MaterialKind, uses: &Uses) -> PreparedMaterial {
        let plain = |bsdf, albedo| PreparedMaterial {
            bsdf,
            interior: None,
            encloses: false,
            narrow: false,
            peaked: false,
            albedo,
            detailed: false,
            varying: None,
            cutout: None,
            normal: None,
            emission: None,
        };
        let colored = uses.colored.is_some();
        match kind {
            MaterialKind::Diffuse { color } => PreparedMaterial {
                varying: colored.then(|| Box::new(Varying::diffuse(*color))),
                ..plain(diffuse(*color), *color)
            },
            MaterialKind::Mirror { color } => plain(Bsdf::Mirror(Mirror { color: *color }), *color),
            MaterialKind::Light { .. } => plain(Bsdf::Black, Rgb::BLACK),
            MaterialKind::Glass(g) => PreparedMaterial {
                interior: interior(kind),
                encloses: true,
                ..plain(
                    Bsdf::Glass(Glass { ior: g.ior, tint: g.tint, thin: false, fresnel: self.fresnel }),
                    g.tint,
                )
            },
            MaterialKind::Principled(p) => {
                let varies = varies(p, colored);
                let read =
                    |t: &scene::Texture, encoded| Sampler::new(t, &pixels(self.scene, t.image), encoded);
                let emission =
                    p.textures.emission.as_ref().map(|t| Box::new(Glow::new(read(t, true), p.emission)));
                let normal = p.textures.normal.as_ref();
                let normal = normal.map(|n| Box::new(NormalMap::new(n, read(&n.texture, false))));
                // Where everything is compiled at the hit, nothing needs to be compiled here.
                let numbers = Numbers { fresnel: self.fresnel, ..Numbers::from(&**p) };
                let bsdf = if varies { Bsdf::Black } else { principled(&numbers, &mut self.rows) };
                PreparedMaterial {
                    interior: interior(kind),
                    encloses: !p.thin && p.transmission > 0.0,
                    narrow: is_narrow(kind),
                    peaked: is_peaked(p),
                    varying: varies.then(|| Box::new(Varying::new(p, self.scene, &mut self.tables))),
                    cutout: Cutout::new(p, self.scene).map(Box::new),
                    normal,
                    emission,
                    ..plain(bsdf, p.base_color)
                }
            }
        }
    }
}

/// Whether what scatters differs from point to point.
pub(super) fn varies(p: &scene::Principled, colored: bool) -> bool {
    let t = &p.textures;
    let scalars = [
        &t.metallic,
        &t.roughness,
        &t.specular,
        &t.transmission,
        &t.coat,
        &t.coat_roughness,
        &t.sheen_roughness,
    ];
    colored
        || t.base_color.is_some()
        || t.specular_color.is_some()
        || t.sheen_color.is_some()
        || scalars.iter().any(|slot| slot.is_some())
}

pub(super) fn diffuse(color: Rgb) -> Bsdf {
    if color.is_black() { Bsdf::Black } else { Bsdf::Diffuse(Diffuse { color }) }
}

/// Whether transmission leaves light on its way, whatever the roughness: a body of index one.
fn is_straight(p: &Numbers) -> bool {
    p.ior == 1.0 && !p.thin
}

/// Whether the material is nothing but a smooth dielectric.
pub(super) fn is_smooth_glass(p: &Numbers) -> bool {
    let smooth = p.roughness * p.roughness < SMOOTH_ALPHA || is_straight(p);
    smooth && p.metallic == 0.0 && p.transmission == 1.0 && !has_layers(p)
}

/// Whether there is a coat that reflects, or a sheen.
pub(super) fn has_layers(p: &Numbers) -> bool {
    has_coat(p) || !p.sheen_color.is_black()
}

pub(super) fn has_coat(p: &Numbers) -> bool {
    p.coat > 0.0 && p.coat_ior != 1.0
}

/// Whether the material is nothing but a Lambertian reflector.
pub(super) fn is_diffuse(p: &Numbers) -> bool {
    let plain = p.metallic == 0.0 && p.transmission == 0.0 && reflectance(p).0 <= 0.0;
    plain && !has_layers(p)
}

/// Whether any lobe of a folded material has a spread, so that lights can be sampled at it.
pub(super) fn spreads(kind: &MaterialKind) -> bool {
    match kind {
        MaterialKind::Diffuse { color } => !color.is_black(),
        MaterialKind::Mirror { .. } | MaterialKind::Glass(_) | MaterialKind::Light { .. } => false,
        MaterialKind::Principled(p) => {
            let n = Numbers::from(&**p);
            let t = &p.textures;
            let rough = |r: f32| r * r >= SMOOTH_ALPHA;
            let opaque = (n.metallic < 1.0 || t.metallic.is_some())
                && (n.transmission < 1.0 || t.transmission.is_some())
                && !n.base_color.is_black();
            let lobes =
                n.metallic > 0.0 || reflectance(&n).0 > 0.0 || (n.transmission > 0.0 && !is_straight(&n));
            opaque
                || (rough(n.roughness) && lobes)
                || (has_coat(&n) && rough(n.coat_roughness))
                || !n.sheen_color.is_black()
        }
    }
}

/// Whether all lobes of a folded material are narrow, wherever it is looked at.
pub(super) fn is_narrow(kind: &MaterialKind) -> bool {
    let MaterialKind::Principled(p) = kind else { return false };
    let (n, t) = (Numbers::from(&**p), &p.textures);
    let narrow = |roughness: f32| roughness * roughness < NARROW_ALPHA;
    let varies = [&t.metallic, &t.roughness, &t.transmission, &t.coat, &t.coat_roughness];
    let opaque = n.metallic < 1.0 && n.transmission < 1.0;
    !opaque
        && narrow(n.roughness)
        && (!has_coat(&n) || narrow(n.coat_roughness))
        && n.sheen_color.is_black()
        && t.sheen_color.is_none()
        && varies.iter().all(|slot| slot.is_none())
}

/// Whether most of what a folded material does may be done by the lobes of a metal or of rough glass, and these are not
/// wide. Those of GGX reach 1 / (pi alpha^4), hundreds of times the mean, where light comes and goes at grazing angles,
/// as it does within rough glass.
fn is_peaked(p: &scene::Principled) -> bool {
    let n = Numbers::from(p);
    n.metallic.max(n.transmission) > 0.5 && n.roughness * n.roughness < WIDE_ALPHA
}

/// Whether light may pass to the other side of a folded material.
pub(super) fn may_transmit(p: &scene::Principled) -> bool {
    p.transmission > 0.0 && (p.metallic < 1.0 || p.textures.metallic.is_some())
}

/// What the inside of a folded material does to light that gets there; `None` where that is nothing.
pub(super) fn interior(kind: &MaterialKind) -> Option<Interior> {
    let absorption = match kind {
        MaterialKind::Glass(g) => g.absorption.as_ref(),
        MaterialKind::Principled(p) => p.absorption.as_ref().filter(|_| !p.thin && may_transmit(p)),
        MaterialKind::Diffuse { .. } | MaterialKind::Mirror { .. } | MaterialKind::Light { .. } => None,
    };
    absorption.and_then(Interior::new)
}

/// The smallest value that a texture has anywhere, at most one.
pub(super) fn darkest(scene: &Scene, t: &scene::ScalarTexture) -> f32 {
    super::texture::darkest_channel(&pixels(scene, t.texture.image), t.channel)
}

fn smooth_glass(p: &Numbers) -> Glass {
    Glass { ior: p.ior, tint: p.transmission_tint, thin: p.thin, fresnel: p.fresnel }
}

/// The principled material, or what it reduces to exactly.
fn principled(p: &Numbers, rows: &mut Rows) -> Bsdf {
    if is_smooth_glass(p) {
        return Bsdf::Glass(smooth_glass(p));
    }
    let lobes = lobes(p, rows);
    if lobes.specular.is_none() && p.metallic == 0.0 && p.transmission == 0.0 && !has_layers(p) {
        return diffuse(p.base_color);
    }
    Bsdf::Principled(lobes)
}

/// All lobes of the principled material.
pub(super) fn lobes(p: &Numbers, rows: &mut impl Albedos) -> Principled {
    let alpha = p.roughness * p.roughness;
    let smooth = alpha < SMOOTH_ALPHA;
    let dielectric_share = 1.0 - p.metallic;
    let transmits = dielectric_share * p.transmission > 0.0;
    let opaque = dielectric_share * (1.0 - p.transmission) > 0.0;
    let specular = if opaque { specular(p, alpha, rows) } else { None };
    let needs_white = !smooth && (p.metallic > 0.0 || specular.is_some());
    let rough = (!smooth && transmits && !is_straight(p)).then(|| {
        let total = if p.thin {
            let white = rows.white(alpha);
            [white.clone(), white]
        } else {
            rows.dielectric(alpha, p.ior)
        };
        let Glass { ior, tint, thin, fresnel } = smooth_glass(p);
        RoughDielectric { alpha, ior, tint, thin, fresnel, total }
    });
    Principled {
        alpha: if smooth { 0.0 } else { alpha },
        metal: p.metallic,
        transmission: p.transmission,
        base: p.base_color,
        specular,
        white: needs_white.then(|| rows.white(alpha)),
        rough,
        smooth: smooth_glass(p),
        coat: has_coat(p).then(|| coat(p, rows)),
        sheen: (!p.sheen_color.is_black()).then(|| sheen(p, rows)),
    }
}

fn coat(p: &Numbers, rows: &mut impl Albedos) -> Coat {
    let (alpha, ior) = (p.coat_roughness * p.coat_roughness, p.coat_ior);
    let smooth = alpha < SMOOTH_ALPHA;
    Coat {
        weight: p.coat,
        alpha: if smooth { 0.0 } else { alpha },
        ior,
        fresnel: p.fresnel,
        albedo: (!smooth).then(|| rows.coat(alpha, ior)),
    }
}

fn sheen(p: &Numbers, rows: &mut impl Albedos) -> Sheen {
    let lobe = Charlie::new(p.sheen_roughness);
    Sheen { color: p.sheen_color, lobe, albedo: rows.sheen(p.sheen_roughness) }
}

/// F0 of the dielectric layer, and its tint. A tint above one is strength: as in Cycles it raises the
/// index, and what is left is the tint.
fn reflectance(p: &Numbers) -> (f32, Rgb) {
    let strongest = p.specular_color.max_channel();
    let f0 = f0_of_ior(p.ior) * p.specular;
    if strongest > 1.0 {
        ((f0 * strongest).min(0.99), p.specular_color / strongest)
    } else {
        (f0, p.specular_color)
    }
}

/// Root of the largest F0 that a layer has whose numbers are at most these.
pub(super) fn largest_root(p: &Numbers) -> f32 {
    reflectance(p).0.sqrt()
}

/// The dielectric layer; `None` where it reflects nothing.
fn specular(p: &Numbers, alpha: f32, rows: &mut impl Albedos) -> Option<Specular> {
    let (f0, tint) = reflectance(p);
    if f0 <= 0.0 {
        return None;
    }
    let eta = ior_of_f0(f0);
    let mut s = Specular { f0, tint, eta, fresnel: p.fresnel, grazing: None, average: Rgb::BLACK };
    s.average = (tint * f0).lerp(Rgb::WHITE, rows.grazing_average(eta, f0));
    if alpha >= SMOOTH_ALPHA {
        s.grazing = Some(rows.grazing(alpha, eta, f0));
    }
    Some(s)
}

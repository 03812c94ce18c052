//! Materials without what is not there: constant textures become numbers, and alpha that lets nothing
//! pass is forgotten, so that only what is needed is simulated.
//!
//! In: a scene, and the effects that tables are built for. Out: its materials, each with the fewest textures,
//! and with nothing that those effects leave out. A texture whose texels are all equal and the number that it
//! stands for give the same material, bit for bit.

use std::borrow::Cow;
use std::collections::BTreeMap;

use glam::Vec4;

use super::analyse::scattering;
use super::plan::{Effect, Effects};
use super::texture::{constant_channel, constant_color};
use crate::color::Rgb;
use crate::scene::{
    AlphaMode, MAX_RADIANCE, MaterialKind, Object, Pixels, Principled, ScalarTexture, Scene, Shape, Sides,
    Texture, Textures,
};

/// What the objects of a material ask of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Uses {
    /// Whether any surface has it.
    pub(super) used: bool,
    /// Whether the mesh of one of them has the first, or the second set of texture coordinates.
    pub(super) laid: [bool; 2],
    /// The first object whose mesh has vertex colours other than white.
    pub(super) colored: Option<usize>,
    /// Whether one of them has an alpha other than one.
    pub(super) faded: bool,
}

/// The materials of a scene, folded, and what is asked of each.
pub(super) struct Folded<'a> {
    pub(super) kinds: Vec<Cow<'a, MaterialKind>>,
    pub(super) uses: Vec<Uses>,
    /// The effects that they may call for.
    pub(super) effects: Effects,
}

/// Whether vertex colours do anything to a material.
pub(super) fn takes_colors(kind: &MaterialKind) -> bool {
    matches!(kind, MaterialKind::Diffuse { .. } | MaterialKind::Principled(_))
}

/// Whether there is anything of an object to be seen: a mesh may have lost all of its triangles.
pub(super) fn has_surface(scene: &Scene, object: &Object) -> bool {
    match object.shape {
        Shape::Mesh(m) => !scene.meshes[m.0 as usize].triangles.is_empty(),
        Shape::Sphere { .. } => true,
    }
}

/// Folds the materials of a scene, and takes from them what is not among `tables`.
pub(super) fn fold(scene: &Scene, tables: Effects) -> Folded<'_> {
    let mut uses = vec![Uses::default(); scene.materials.len()];
    let white: Vec<bool> = scene.meshes.iter().map(|m| m.colors.iter().all(|&c| c == Vec4::ONE)).collect();
    for (i, object) in scene.objects.iter().enumerate().filter(|(_, o)| has_surface(scene, o)) {
        let material = object.material.0 as usize;
        uses[material].used = true;
        let Shape::Mesh(m) = object.shape else { continue };
        for (laid, set) in uses[material].laid.iter_mut().zip(&scene.meshes[m.0 as usize].uvs) {
            *laid |= !set.is_empty();
        }
        if tables.has(Effect::VertexColors)
            && !white[m.0 as usize]
            && takes_colors(&scene.materials[material].kind)
        {
            let uses = &mut uses[material];
            uses.colored.get_or_insert(i);
            uses.faded |= scene.meshes[m.0 as usize].colors.iter().any(|c| c.w != 1.0);
        }
    }
    let mut constants = Constants { scene, known: BTreeMap::new() };
    let fold_one = |(m, uses): (&'_ crate::scene::Material, &Uses)| match &m.kind {
        MaterialKind::Principled(p) if !p.textures.is_empty() || p.alpha_mode != AlphaMode::Opaque => {
            Some(principled(p, uses, &mut constants))
        }
        _ => None,
    };
    let folded: Vec<Option<Principled>> = scene.materials.iter().zip(&uses).map(fold_one).collect();
    let mut kinds: Vec<Cow<'_, MaterialKind>> = (scene.materials.iter().zip(folded))
        .map(|(m, folded)| match folded {
            Some(p) => Cow::Owned(MaterialKind::Principled(Box::new(p))),
            None => Cow::Borrowed(&m.kind),
        })
        .collect();
    if tables != Effects::EVERYTHING {
        kinds.iter_mut().zip(&uses).for_each(|(kind, uses)| reduce(kind, uses, tables));
    }
    Folded { kinds, uses, effects: tables }
}

/// Takes from a material what is not among the effects of `tables`. Where those are what a scene calls for,
/// that is nothing from a material in use, and all from one that no surface has.
fn reduce(kind: &mut Cow<'_, MaterialKind>, uses: &Uses, tables: Effects) {
    const BLACK: MaterialKind = MaterialKind::Light { radiance: Rgb::BLACK, sides: Sides::Front };
    if !uses.used {
        *kind = Cow::Owned(BLACK);
        return;
    }
    let lacks = |effect| !tables.has(effect);
    if lacks(Effect::AreaLights) && kind.emission().is_some() {
        match kind.to_mut() {
            MaterialKind::Light { radiance, .. } => *radiance = Rgb::BLACK,
            MaterialKind::Principled(p) => (p.emission, p.textures.emission) = (Rgb::BLACK, None),
            _ => {}
        }
    }
    match &**kind {
        MaterialKind::Glass(g) if lacks(Effect::Absorption) && g.absorption.is_some() => {
            if let MaterialKind::Glass(g) = kind.to_mut() {
                g.absorption = None;
            }
        }
        MaterialKind::Principled(p) => {
            let mut p = p.clone();
            if lacks(Effect::Textures) {
                let t = p.textures;
                p.textures = Textures { normal: t.normal, alpha: t.alpha, ..Textures::default() };
            }
            if lacks(Effect::Cutouts) {
                (p.alpha_mode, p.textures.alpha) = (AlphaMode::Opaque, None);
            }
            if lacks(Effect::NormalMaps) {
                p.textures.normal = None;
            }
            if lacks(Effect::Absorption) {
                p.absorption = None;
            }
            *kind = Cow::Owned(MaterialKind::Principled(p));
        }
        _ => {}
    }
    if scattering(kind, uses).is_some_and(lacks) {
        *kind = Cow::Owned(match &**kind {
            // What is left emits, and is there or not there.
            MaterialKind::Principled(p) => MaterialKind::Principled(Box::new(Principled {
                base_color: Rgb::BLACK,
                specular: 0.0,
                emission: p.emission,
                alpha: p.alpha,
                alpha_mode: p.alpha_mode,
                textures: Textures {
                    emission: p.textures.emission,
                    alpha: p.textures.alpha,
                    ..Textures::default()
                },
                ..Principled::default()
            })),
            _ => BLACK,
        });
    }
}

/// Constant pictures, each looked at once.
struct Constants<'a> {
    scene: &'a Scene,
    known: BTreeMap<(u32, u8), Option<[f32; 3]>>,
}

impl Constants<'_> {
    fn get(
        &mut self,
        image: u32,
        what: u8,
        find: impl FnOnce(&Pixels) -> Option<[f32; 3]>,
    ) -> Option<[f32; 3]> {
        let pixels = self.scene.images.get(image as usize).and_then(|i| i.pixels.as_ref());
        // What has not been read counts as white.
        *self.known.entry((image, what)).or_insert_with(|| pixels.map_or(Some([1.0; 3]), |p| find(p)))
    }

    fn color(&mut self, t: &Texture) -> Option<Rgb> {
        self.get(t.image.0, 4, |p| constant_color(p, true).map(Rgb::to_array)).map(Rgb::from)
    }

    fn value(&mut self, t: &ScalarTexture) -> Option<f32> {
        self.get(t.texture.image.0, t.channel as u8, |p| constant_channel(p, t.channel).map(|v| [v; 3]))
            .map(|[v, ..]| v)
    }

    /// Takes a texture that is constant, or that multiplies zero.
    fn take_value(&mut self, slot: &mut Option<ScalarTexture>, value: &mut f32) {
        let constant = slot.as_ref().and_then(|t| self.value(t));
        if let Some(v) = constant {
            *value = unit(*value * v);
        }
        if constant.is_some() || *value == 0.0 {
            *slot = None;
        }
    }
}

/// A product that has to be a fraction.
#[inline]
pub(super) fn unit(v: f32) -> f32 {
    v.clamp(0.0, 1.0)
}

/// The factor on the tint of transmission where the base colour has the factor `f`: light passes two
/// interfaces of a body, and one sheet.
#[inline]
pub(super) fn tint_factor(f: Rgb, thin: bool) -> Rgb {
    if thin { f } else { f.map(f32::sqrt) }
}

/// The largest product of a colour without bound and a texel.
#[inline]
pub(super) fn bounded(c: Rgb) -> Rgb {
    c.map(|v| v.min(MAX_RADIANCE))
}

fn principled(p: &Principled, uses: &Uses, constants: &mut Constants<'_>) -> Principled {
    let (mut p, faded) = (p.clone(), uses.faded);
    let t = &mut p.textures;
    if let Some(c) = t.base_color.as_ref().and_then(|t| constants.color(t)) {
        p.base_color = (p.base_color * c).map(unit);
        p.transmission_tint = (p.transmission_tint * tint_factor(c, p.thin)).map(unit);
        t.base_color = None;
    }
    constants.take_value(&mut t.metallic, &mut p.metallic);
    constants.take_value(&mut t.roughness, &mut p.roughness);
    constants.take_value(&mut t.specular, &mut p.specular);
    constants.take_value(&mut t.transmission, &mut p.transmission);
    if let Some(c) = t.specular_color.as_ref().and_then(|t| constants.color(t)) {
        p.specular_color = bounded(p.specular_color * c);
        t.specular_color = None;
    }
    constants.take_value(&mut t.coat, &mut p.coat);
    constants.take_value(&mut t.coat_roughness, &mut p.coat_roughness);
    constants.take_value(&mut t.sheen_roughness, &mut p.sheen_roughness);
    if let Some(c) = t.sheen_color.as_ref().and_then(|t| constants.color(t)) {
        p.sheen_color = (p.sheen_color * c).map(unit);
        t.sheen_color = None;
    }
    if p.coat == 0.0 || p.coat_ior == 1.0 {
        (t.coat, t.coat_roughness) = (None, None);
    }
    if p.sheen_color.is_black() {
        (t.sheen_color, t.sheen_roughness) = (None, None);
    }
    // Not rendered: a note of validation says so.
    t.coat_normal = None;
    // A map lies by coordinates, and where a surface has none it says nothing.
    t.normal = t.normal.filter(|n| uses.laid[usize::from(n.texture.uv_set.min(1))]);
    if p.base_color.is_black() && p.transmission == 0.0 {
        t.base_color = None;
    }
    if p.specular == 0.0 || p.ior == 1.0 {
        (t.specular, t.specular_color) = (None, None);
    }
    if let Some(c) = t.emission.as_ref().and_then(|t| constants.color(t)) {
        p.emission = bounded(p.emission * c);
        t.emission = None;
    }
    if p.emission.is_black() {
        t.emission = None;
    }
    if p.alpha_mode == AlphaMode::Opaque {
        t.alpha = None;
    }
    constants.take_value(&mut t.alpha, &mut p.alpha);
    let solid = match p.alpha_mode {
        AlphaMode::Opaque => true,
        AlphaMode::Mask { cutoff } => cutoff == 0.0 || (t.alpha.is_none() && !faded && p.alpha >= cutoff),
        AlphaMode::Blend => t.alpha.is_none() && !faded && p.alpha == 1.0,
    };
    if solid {
        (p.alpha_mode, t.alpha) = (AlphaMode::Opaque, None);
    }
    p
}

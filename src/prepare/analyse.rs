//! Analysis: which effects a scene calls for, each with a witness, and why the others cannot matter.
//!
//! In: a valid scene. Out: its [`Plan`]. Whatever provably changes no bit of the picture calls for nothing:
//! a material on no surface, a constant picture, a light without power, an interior that absorbs nothing.
//! The invariant is one-sided: an effect may be asked for in vain, but none is left out that a sample could
//! meet, and tests forget each to see the picture change. Lights are told apart by what they are compiled to,
//! so that analysis and compilation cannot disagree.

use glam::Vec4;

use super::algorithm::{Caustics, Indirect, caustics, indirect};
use super::choices::{ROULETTE_START, casters, choices, reuse, unseen};
use super::fold::{Folded, Uses, fold, has_surface};
use super::lights::{self, effect_of};
use super::material::{self, Numbers};
use super::plan::{ASKED_FOR, Effect, Effects, LeftOut, Need, Plan};
use super::{Options, replications};
use crate::color::Rgb;
use crate::scene::{AlphaMode, Camera, MaterialKind, Principled, Scene, Shape};

/// Collects needs (the first witness of each effect, and the number of those who ask), and the first thing of
/// each effect that asks for nothing.
#[derive(Default)]
struct Collector {
    needs: [Option<Need>; Effect::ALL.len()],
    idle: [Option<String>; Effect::ALL.len()],
}

impl Collector {
    fn ask(&mut self, effect: Effect, witness: impl FnOnce() -> String) {
        let slot = &mut self.needs[effect as usize];
        match slot {
            Some(need) => need.count += 1,
            None => *slot = Some(Need { effect, witness: witness(), count: 1 }),
        }
    }

    fn idle(&mut self, effect: Effect, reason: impl FnOnce() -> String) {
        self.idle[effect as usize].get_or_insert_with(reason);
    }

    /// The same without some effects, where `all` is what the whole scene calls for.
    fn without(mut self, omitted: Effects, all: Self) -> Self {
        let effects = Effect::ALL.into_iter().zip(all.needs).zip(all.idle);
        for ((effect, asked), idle) in effects.filter(|((effect, _), _)| omitted.has(*effect)) {
            self.needs[effect as usize] = None;
            self.idle[effect as usize] = if asked.is_some() { Some(ASKED_FOR.to_owned()) } else { idle };
        }
        self
    }

    fn left_out(&mut self) -> Vec<LeftOut> {
        let absent = Effect::ALL.into_iter().filter(|&e| self.needs[e as usize].is_none());
        let reason = |e: Effect| match &self.idle[e as usize] {
            Some(reason) => reason.clone(),
            None => e.reason_absent().to_owned(),
        };
        absent.map(|effect| LeftOut { effect, reason: reason(effect) }).collect()
    }
}

/// Finds what the scene calls for, and chooses how it is rendered: what was not asked for, without looking how
/// noisy the scene is.
#[must_use]
pub fn analyse(scene: &Scene, camera: &Camera, options: &Options) -> Plan {
    let omitted = options.shortcuts.without;
    let mut folded = fold(scene, Effects::EVERYTHING);
    let mut found = collect(scene, camera, &folded);
    if omitted.effects != Effects::default() {
        // Materials may call for something else without them: what is pictured for all of its lobes, what is left
        // of it for few.
        folded = fold(scene, Effects::EVERYTHING.minus(omitted.effects));
        found = collect(scene, camera, &folded).without(omitted.effects, found);
    }
    let left_out = found.left_out();
    let needs: Vec<Need> = found.needs.into_iter().flatten().collect();
    let casters = casters(scene, &folded);
    let algorithms = &options.algorithms;
    let caustics =
        if omitted.caustics { Caustics::Path } else { caustics(scene, &folded, &casters, algorithms) };
    let (indirect, why) = match indirect(scene, &folded, &options.algorithms) {
        (Indirect::Photon, _) if omitted.indirect => (Indirect::Path, ASKED_FOR),
        found => found,
    };
    let pixels = u64::from(options.size[0]) * u64::from(options.size[1]);
    let mut plan = Plan {
        choices: choices(scene, &folded, &casters, caustics, algorithms, pixels),
        needs,
        left_out,
        unseen: unseen(scene, &folded, &casters, caustics),
        caustics,
        indirect,
        light_samples: algorithms.light_samples.unwrap_or(1),
        split: algorithms.split.unwrap_or(1),
        roulette: algorithms.roulette.unwrap_or(ROULETTE_START),
        shortcuts: options.shortcuts_taken(),
        tables: Effects::default(),
        kernel: 0,
        replications: replications(pixels),
    };
    if omitted.caustics {
        plan.unseen.retain(|u| u.what != "caustics");
        for choice in plan.choices.iter_mut().filter(|c| c.about == "caustics" && c.chosen != "none") {
            (choice.chosen, choice.reason) = ("none".to_owned(), ASKED_FOR.to_owned());
        }
    }
    if options.algorithms.indirect == Indirect::Photon {
        plan.choices.push(reuse(indirect, why));
    }
    plan.run_by(options.effects, omitted.effects);
    plan
}

/// Collects what a scene with these materials calls for.
fn collect(scene: &Scene, camera: &Camera, folded: &Folded<'_>) -> Collector {
    let mut found = Collector::default();
    for object in scene.objects.iter().filter(|o| has_surface(scene, o)) {
        let Shape::Mesh(m) = object.shape else { continue };
        let mesh = &scene.meshes[m.0 as usize];
        if !mesh.normals.is_empty() {
            found.ask(Effect::SmoothNormals, || format!("object \"{}\"", object.name));
        }
        if mesh.colors.iter().any(|&c| c != Vec4::ONE) {
            // Where a material takes them, it asks for them below.
            let material = &scene.materials[object.material.0 as usize];
            found.idle(Effect::VertexColors, || {
                format!("material \"{}\" takes no colours of vertices", material.name)
            });
        } else if !mesh.colors.is_empty() {
            found.idle(Effect::VertexColors, || {
                format!("the vertices of object \"{}\" are white", object.name)
            });
        }
    }
    materials(scene, folded, &mut found);
    for light in &scene.lights {
        match lights::free(light) {
            Some(emitter) => found.ask(effect_of(&emitter), || format!("light \"{}\"", light.name)),
            None => found.idle(lights::intended(light), || {
                format!("light \"{}\" has no {}", light.name, lights::lack(light))
            }),
        }
    }
    if let Some(e) = &scene.environment {
        if lights::is_dark(scene, e) {
            found.idle(Effect::Environment, || format!("environment \"{}\" is black", e.name));
        } else {
            found.ask(Effect::Environment, || format!("environment \"{}\"", e.name));
        }
    }
    if camera.lens.is_some_and(|l| l.radius > 0.0) {
        found.ask(Effect::Lens, || format!("camera \"{}\"", camera.name));
    }
    #[cfg(epsilux_dummy_effect)]
    if super::dummy::Dummy::asked().is_some() {
        found.ask(Effect::Dummy, || "the environment".to_owned());
    }
    found
}

fn materials(scene: &Scene, folded: &Folded<'_>, found: &mut Collector) {
    for (i, material) in scene.materials.iter().enumerate() {
        let (kind, uses) = (&*folded.kinds[i], &folded.uses[i]);
        let needs = material_needs(kind, uses);
        if !uses.used {
            let reason = || format!("no surface has the material \"{}\"", material.name);
            needs.into_iter().for_each(|effect| found.idle(effect, reason));
            continue;
        }
        for (effect, what) in idle(&material.kind, kind, uses) {
            found.idle(effect, || format!("material \"{}\" {what}", material.name));
        }
        if material.kind.body().is_some() {
            found.ask(Effect::Nesting, || format!("material \"{}\"", material.name));
        }
        for effect in needs {
            match uses.colored {
                Some(object) if effect == Effect::VertexColors => {
                    found.ask(effect, || format!("object \"{}\"", scene.objects[object].name));
                }
                _ => found.ask(effect, || format!("material \"{}\"", material.name)),
            }
        }
    }
}

/// What a folded material on surfaces such as `uses` calls for.
pub(super) fn material_needs(kind: &MaterialKind, uses: &Uses) -> Vec<Effect> {
    let mut needs = Vec::new();
    needs.extend(scattering(kind, uses));
    if material::interior(kind).is_some() {
        needs.push(Effect::Absorption);
    }
    if kind.emission().is_some() {
        needs.push(Effect::AreaLights);
    }
    if uses.colored.is_some() {
        needs.push(Effect::VertexColors);
    }
    if let MaterialKind::Principled(p) = kind {
        let t = &p.textures;
        if material::varies(p, false) || t.emission.is_some() {
            needs.push(Effect::Textures);
        }
        if p.alpha_mode != AlphaMode::Opaque {
            needs.push(Effect::Cutouts);
        }
        if t.normal.is_some() {
            needs.push(Effect::NormalMaps);
        }
    }
    needs
}

/// The effect that scatters light at a folded material: the one of what it compiles to.
pub(super) fn scattering(kind: &MaterialKind, uses: &Uses) -> Option<Effect> {
    match kind {
        MaterialKind::Diffuse { color } => (!color.is_black()).then_some(Effect::Diffuse),
        MaterialKind::Mirror { color } => (!color.is_black()).then_some(Effect::Mirror),
        MaterialKind::Glass(_) => Some(Effect::Refraction),
        MaterialKind::Light { .. } => None,
        MaterialKind::Principled(p) => {
            let numbers = Numbers::from(&**p);
            // What varies is compiled at the hit, to all of its lobes.
            let varies = material::varies(p, uses.colored.is_some());
            if material::is_diffuse(&numbers) {
                (!p.base_color.is_black()).then_some(Effect::Diffuse)
            } else if material::is_smooth_glass(&numbers) && !varies {
                Some(Effect::Refraction)
            } else {
                Some(Effect::Glossy)
            }
        }
    }
}

/// What a material seems to call for and does not, once folded; to be read after its name.
fn idle(original: &MaterialKind, folded: &MaterialKind, uses: &Uses) -> Vec<(Effect, &'static str)> {
    let mut idle = Vec::new();
    match original {
        MaterialKind::Diffuse { color } if color.is_black() => {
            idle.push((Effect::Diffuse, "is black"));
        }
        MaterialKind::Mirror { color } if color.is_black() => idle.push((Effect::Mirror, "is black")),
        MaterialKind::Glass(g) if g.absorption.is_some() => {
            idle.push((Effect::Absorption, "absorbs nothing: its interior is white"));
        }
        _ => {}
    }
    let (MaterialKind::Principled(before), MaterialKind::Principled(after)) = (original, folded) else {
        return idle;
    };
    let pictured = |p: &Principled| material::varies(p, false) || p.textures.emission.is_some();
    if pictured(before) && !pictured(after) {
        idle.push((Effect::Textures, "has pictures that are constant, or that multiply zero"));
    }
    if before.alpha_mode != AlphaMode::Opaque {
        idle.push((Effect::Cutouts, "has an alpha, but is solid everywhere"));
    }
    if before.textures.normal.is_some() && uses.laid == [false; 2] {
        idle.push((Effect::NormalMaps, "has a map of normals, but no surface has coordinates for it"));
    } else if before.textures.normal.is_some() {
        idle.push((Effect::NormalMaps, "has a map of normals for coordinates that no surface has"));
    }
    if let Some(a) = &before.absorption {
        let why = if before.thin {
            "absorbs nothing: it is a sheet, without an inside"
        } else if !material::may_transmit(after) {
            "has an interior that no light enters"
        } else if a.color == Rgb::WHITE {
            "absorbs nothing: its interior is white"
        } else {
            return idle;
        };
        idle.push((Effect::Absorption, why));
    }
    idle
}

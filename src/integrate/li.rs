//! Radiance along a camera ray: unidirectional path tracing with next-event estimation.
//!
//! At each vertex one light is sampled, and one direction; both ways of finding a light are weighted
//! against each other (Veach and Guibas, SIGGRAPH 1995). Nothing is clamped and no depth is cut
//! unless asked for: paths end by roulette. The walk is a loop over [`step`], so that paths could as
//! well be advanced side by side.
//!
//! Where the camera sees clear glass, and in mirrors and glass what lies beyond, paths take both ways on, each with its
//! share of the light ([`BothWays`]): which one is taken is no matter of chance that would make noise.
//!
//! Two choices of the plan make one sample of more than one: at the first vertex that spreads light, several samples
//! of lights (of the same density, so that n of them weigh as one of n times the density; Veach, thesis, section
//! 9.2), and where the first thing that the camera sees is a mirror or clear glass, several ways on from there.
//!
//! `FX` is the set of effects that a kernel simulates; what is not in it is not compiled. One kernel looks at
//! run time (`Effects::AT_RUN_TIME`), and serves every set.

use glam::Vec3;

use super::both_ways::BothWays;
use super::direct::direct_light;
use super::path::{Counters, FAR_CAP, NOWHERE, Parts, PathState, Vertex};
use super::photon::{Maps, Place, gathered};
use super::{roulette, scatter};
use crate::accel::{Hit, PrimitiveId, RayKind};
use crate::bsdf::{Bsdf, BsdfSample, Transport};
use crate::color::Rgb;
use crate::light::LightContext;
use crate::mutants::planted;
use crate::prepare::{Caustics, Detail, Effect, Effects, Medium, Prepared, PreparedMaterial, Surface};
use crate::sampling::{Address, Purpose};
use crate::shape::{Ray, offset_origin};

enum Next {
    Continue,
    /// The path is to go on in several ways from here, each of which begins at this hit anew.
    Fork(Hit),
    Done,
}

/// Radiance that arrives along `ray` from a scene, W sr^-1 m^-2.
pub(super) fn li<const FX: u32>(
    scene: &Prepared,
    address: Address,
    ray: Ray,
    counters: &mut Counters,
) -> Rgb {
    walk::<FX, false>(scene, None, address, ray, counters).0
}

/// The same radiance, and the parts that it consists of; where there are maps, the path gathers the photons of
/// its pass.
pub(super) fn li_in_layers<const FX: u32>(
    scene: &Prepared,
    maps: Option<&Maps>,
    address: Address,
    ray: Ray,
    counters: &mut Counters,
) -> (Rgb, Parts) {
    walk::<FX, true>(scene, maps, address, ray, counters)
}

/// From the camera to the end.
#[inline(always)]
fn walk<const FX: u32, const LAYERS: bool>(
    scene: &Prepared,
    maps: Option<&Maps>,
    address: Address,
    ray: Ray,
    counters: &mut Counters,
) -> (Rgb, Parts) {
    let mut path = PathState::new(scene, ray);
    path.widened = maps.map_or(0.0, |m| m.widened(&address));
    let mut both_ways = BothWays::default();
    loop {
        match step::<FX, LAYERS>(scene, maps, &address, None, &mut path, &mut both_ways, counters) {
            Next::Continue => {}
            Next::Fork(hit) => return ways::<FX>(scene, maps, address, &path, hit, counters),
            Next::Done if takes_both_ways(scene.simulated::<FX>()) && both_ways.go_on(&mut path) => {}
            Next::Done => return (path.radiance, path.parts),
        }
    }
}

/// The mean over several ways on from where a path first meets a mirror or clear glass; way j has the numbers of
/// branch j of the sample.
#[inline(never)]
fn ways<const FX: u32>(
    scene: &Prepared,
    maps: Option<&Maps>,
    address: Address,
    arrived: &PathState,
    hit: Hit,
    counters: &mut Counters,
) -> (Rgb, Parts) {
    let n = scene.plan.split;
    let (mut radiance, mut parts) = (Rgb::BLACK, Parts::default());
    for j in 0..n {
        let mut path = PathState { forks: false, ..arrived.clone() };
        let (address, mut at, mut both_ways) = (address.split(n, j), Some(hit), BothWays::default());
        while matches!(
            step::<FX, true>(scene, maps, &address, at.take(), &mut path, &mut both_ways, counters),
            Next::Continue
        ) || both_ways.go_on(&mut path)
        {}
        radiance += path.radiance;
        parts.layers.iter_mut().zip(path.parts.layers).for_each(|(sum, part)| *sum += part);
        parts.widening += path.parts.widening;
    }
    let share = 1.0 / n as f32;
    let layers = parts.layers.map(|sum| sum * share);
    (radiance * share, Parts { layers, widening: parts.widening * share })
}

/// From one vertex to the next, or from one that the path has arrived `at`, on; photons of `maps` are gathered where
/// there are any.
#[inline(always)]
fn step<const FX: u32, const LAYERS: bool>(
    scene: &Prepared,
    maps: Option<&Maps>,
    address: &Address,
    at: Option<Hit>,
    path: &mut PathState,
    both_ways: &mut BothWays,
    counters: &mut Counters,
) -> Next {
    let fx = scene.simulated::<FX>();
    let arrives = at.is_none();
    let Some(hit) = at.or_else(|| next_hit::<FX, LAYERS>(scene, path, counters)) else {
        // Light from infinitely far away.
        if fx.has(Effect::Environment) {
            distant_lights::<LAYERS>(scene, path, counters);
        }
        return Next::Done;
    };
    let mut surface = scene.surface(&path.ray, &hit, fx.has(Effect::SmoothNormals));
    let wo = -path.ray.d;
    if fx.has(Effect::SmoothNormals) && surface.ns.dot(wo) * surface.ng.dot(wo) <= 0.0 {
        // Interpolated normals can face away from a visible surface.
        surface.ns = surface.ng;
    }

    // What varies over the surface, and whether it is there at all.
    let material = scene.material_of(surface.object);
    let mut prepared = &scene.materials[material as usize];
    let detail =
        if varies(fx) && prepared.detailed { scene.detail(surface.object, &hit) } else { Detail::NONE };
    let mut there =
        !arrives || !fx.has(Effect::Cutouts) || is_there(prepared, &detail, address, path.depth, path.passed);
    let met = if fx.has(Effect::Nesting) { scene.meet(&surface, path.ray.d, path.medium) } else { None };
    let leaving = [surface.id, met.map_or(PrimitiveId::NONE, |m| m.with)];
    if let Some(met) = &met {
        // Within a body that is there anyway, nothing begins or ends.
        there &= met.interface.is_some();
        prepared = met.interface.unwrap_or(prepared);
        if met.flipped {
            (surface.ng, surface.ns) = (-surface.ng, -surface.ns);
        }
    }
    if !there {
        path.medium = met.map_or(path.medium, |m| m.beyond);
        return pass(path, &surface, leaving, counters);
    }

    // Emission met by chance: full weight after the camera and delta lobes, a share otherwise.
    if fx.has(Effect::AreaLights)
        && arrives
        && let Some(light) = scene.lights.of_surface(surface.id)
    {
        let mut le = scene.lights.emitted(light, wo, surface.ng);
        if fx.has(Effect::Textures)
            && let Some(glow) = &prepared.emission
        {
            le = glow.radiance(&detail.uv);
        }
        if fx.has(Effect::Glossy) {
            le *= prepared.emission_scale(&detail, wo.dot(surface.ng).abs());
        }
        let weight = match &path.sampled {
            None => 1.0,
            Some(s) => s.weight(scene.lights.pdf(&s.context, light, surface.p, surface.ng)),
        };
        let found = path.beta * planted!(light_energy(le)) * weight;
        path.count(scene, found, light, counters);
        path.meet::<LAYERS>(found, &scene.kept);
    }
    // Whatever else arrives where the path was last, photons have brought.
    if path.supplied {
        return Next::Done;
    }
    if scene.max_depth.is_some_and(|cap| path.depth >= planted!(depth_off_by_one(cap))) {
        return Next::Done;
    }
    if path.depth >= FAR_CAP {
        counters.capped += 1;
        return Next::Done;
    }

    // Direct light: one light, by what it could contribute; several where a path first spreads, if that pays.
    if fx.has(Effect::NormalMaps) {
        surface.ns = mapped_normal(scene, prepared, &surface, &hit, &detail, wo);
    }
    let frame = scatter::Frame::new(&surface, wo);
    let compiled;
    let bsdf = match &prepared.varying {
        Some(varying) if fx.has(Effect::Textures) || fx.has(Effect::VertexColors) => {
            compiled = varying.bsdf(&detail, frame.cos());
            &compiled
        }
        _ => &prepared.bsdf,
    };
    let context = surface.lit(wo, bsdf.transmits());
    let beyond = match met {
        Some(met) => met.beyond,
        None if fx.has(Effect::Absorption) => medium_beyond(scene, path.medium, material, &context),
        None => path.medium,
    };
    let takes_both = takes_both_ways(fx);
    let branch = if takes_both { path.branch() } else { 0 };
    // One of both ways that carries little ends by chance, once what it meets has been seen.
    if takes_both && path.share < 1.0 && !bsdf.is_delta() {
        path.eta_scale *= path.share;
        if path.share < 0.5 {
            let u = address.block(path.depth, Purpose::Light, branch, 0);
            match roulette::survive(path.beta, path.eta_scale, 0, 0, u[3]) {
                Some(scale) => path.beta *= scale,
                None => return Next::Done,
            }
        }
        path.share = 1.0;
    }
    // What photons supply is not sampled here either.
    let left = prepared.narrow && path.spread > 0 && path.caustics.by_photons(path.linked);
    // What would be spread once more counts for nothing where indirect light is left out.
    let over = !prepared.narrow && scene.kept.ends_after(path.spread);
    // From the second vertex on that spreads a path, photons may say what arrives there.
    let maps = maps.filter(|_| !prepared.narrow);
    let ends = path.spread > 0 && !prepared.peaked && maps.is_some_and(|m| m.indirect.is_some());
    let mut lights = 1.0;
    if !bsdf.is_delta() && !left && !over {
        let media = [path.medium, beyond];
        let samples = if path.spread == 0 { scene.plan.light_samples } else { 1 };
        let before = counters.rays;
        let u = || address.block(path.depth, Purpose::Light, branch, 0);
        let narrow = prepared.narrow;
        if samples > 1 {
            lights = samples as f32;
            let found = many_lights::<FX>(
                scene,
                path,
                bsdf,
                &frame,
                &context,
                media,
                (address, samples, narrow),
                counters,
            );
            path.lit::<LAYERS>(narrow, found, &scene.kept);
        } else if let Some(lit) = direct_light::<FX>(scene, bsdf, &frame, &context, media, u(), 1.0, counters)
        {
            let found = path.beta * lit.radiance;
            path.count_lit(scene, narrow, found, &lit, counters);
            if lit.arrives {
                path.lit::<LAYERS>(narrow, found, &scene.kept);
            }
        }
        if LAYERS {
            counters.layer_rays[path.samples(narrow) as usize] += counters.rays - before;
        }
        if let Some(maps) = maps {
            gather(scene, maps, path, bsdf, &frame, &context, (media, ends), counters);
        }
    } else if path.forks && path.depth == 0 {
        return Next::Fork(hit);
    }

    // Continue the path in a direction chosen by the BSDF.
    let u = address.block(path.depth, Purpose::Bsdf, branch, 0);
    let vertex =
        Vertex { surface: &surface, context, beyond, ids: leaving, narrow: prepared.narrow, ends, lights };
    let leave = |path: &mut PathState, wi: Vec3, sample: &BsdfSample| path.leave(fx, &vertex, wi, sample);
    let both = if takes_both && path.spread == 0 && bsdf.is_delta() {
        both_ways.take(path, fx, bsdf, &frame, leave)
    } else {
        None
    };
    let one = || scatter::sample(fx, bsdf, &frame, [u[0], u[1], u[2]], Transport::Radiance);
    let Some((wi, sample)) = both.or_else(one) else {
        return Next::Done;
    };
    if over && !sample.delta {
        return Next::Done;
    }
    path.leave(fx, &vertex, wi, &sample);

    // Roulette on throughput, corrected for what refraction will give back.
    match roulette::survive(path.beta, path.eta_scale, path.depth, scene.plan.roulette, u[3]) {
        Some(scale) => path.beta *= scale,
        None => return Next::Done,
    }
    Next::Continue
}

/// What a ray meets next, and what it passes on its way there: free lights, which block nothing, so that each is found
/// where it stands, and what absorbs.
#[inline(always)]
fn next_hit<const FX: u32, const LAYERS: bool>(
    scene: &Prepared,
    path: &mut PathState,
    counters: &mut Counters,
) -> Option<Hit> {
    let fx = scene.simulated::<FX>();
    let kind = if path.depth == 0 { RayKind::Camera } else { RayKind::Other };
    counters.rays += 1;
    if LAYERS {
        counters.layer_rays[path.meets() as usize] += 1;
    }
    let hit = scene.accel.closest_between(&path.ray, path.from, kind);
    let t = hit.map_or(f32::INFINITY, |h| h.t);
    if fx.has(Effect::FreeLights) {
        free_lights::<FX, LAYERS>(scene, path, t, counters);
    }
    if fx.has(Effect::Absorption)
        && let Some(medium) = path.medium.absorbs
    {
        path.beta *= interior(scene, medium, t);
    }
    #[cfg(epsilux_dummy_effect)]
    if fx.has(Effect::Dummy)
        && let Some(dummy) = scene.dummy
    {
        path.beta *= dummy.transmittance(t);
    }
    hit
}

/// Radiance that several samples of lights at a vertex add to the path of an address, whose material may be narrow.
#[inline(never)]
fn many_lights<const FX: u32>(
    scene: &Prepared,
    path: &PathState,
    bsdf: &Bsdf,
    frame: &scatter::Frame,
    context: &LightContext,
    media: [Medium; 2],
    (address, samples, narrow): (&Address, u32, bool),
    counters: &mut Counters,
) -> Rgb {
    let n = samples as f32;
    let share = 1.0 / n;
    let mut sum = Rgb::BLACK;
    for j in 0..samples {
        let u = address.split(samples, j).block(path.depth, Purpose::Light, path.branch(), 0);
        if let Some(lit) = direct_light::<FX>(scene, bsdf, frame, context, media, u, n, counters) {
            path.count_lit(scene, narrow, path.beta * lit.radiance * share, &lit, counters);
            if lit.arrives {
                sum += lit.radiance;
            }
        }
    }
    path.beta * (sum * share)
}

/// Adds the light of the photons around a vertex, but of those that reach the camera from here without this path; that
/// of indirect light where the path `ends` here.
#[inline(never)]
fn gather(
    scene: &Prepared,
    maps: &Maps,
    path: &mut PathState,
    bsdf: &Bsdf,
    frame: &scatter::Frame,
    context: &LightContext,
    (media, ends): ([Medium; 2], bool),
    counters: &mut Counters,
) {
    let linked = path.linked && path.thrown;
    let place = Place { depth: path.depth, spread: path.spread > 0, linked: true, widened: path.widened };
    if let Some(map) = maps.caustics.as_ref().filter(|_| path.depth > 0 && !linked) {
        let found = gathered(scene, map, bsdf, frame, context, media, place, counters);
        path.gather(&found, &scene.kept, counters);
    }
    if let Some(map) = maps.indirect.as_ref().filter(|_| ends) {
        let place = Place { linked: !(linked && path.caustics != Caustics::Path), ..place };
        let found = gathered(scene, map, bsdf, frame, context, media, place, counters);
        path.gather(&found, &scene.kept, counters);
    }
}

/// Whether a path may take both ways on: smooth glass that textures vary is glossy to a plan.
const fn takes_both_ways(fx: Effects) -> bool {
    fx.has(Effect::Refraction) || fx.has(Effect::Glossy)
}

/// Whether textures or vertex colours may vary anything.
const fn varies(fx: Effects) -> bool {
    fx.has(Effect::Textures)
        || fx.has(Effect::Cutouts)
        || fx.has(Effect::NormalMaps)
        || fx.has(Effect::VertexColors)
}

/// Whether a surface is there for a path: by chance where a share of it is.
#[inline]
pub(super) fn is_there(
    material: &PreparedMaterial,
    detail: &Detail,
    address: &Address,
    depth: u32,
    passed: u32,
) -> bool {
    let Some(cutout) = &material.cutout else { return true };
    let coverage = cutout.coverage(detail);
    coverage >= 1.0 || (coverage > 0.0 && address.block(depth, Purpose::Alpha, 0, passed)[0] < coverage)
}

/// Straight on through a surface that is not there: nothing is counted but the surface.
fn pass(path: &mut PathState, surface: &Surface, leaving: [PrimitiveId; 2], counters: &mut Counters) -> Next {
    path.passed += 1;
    if path.passed >= FAR_CAP {
        counters.capped += 1;
        return Next::Done;
    }
    let d = path.ray.d;
    path.ray = Ray::new(offset_origin(surface.p, surface.p_err, surface.ng, d), d);
    path.from = leaving;
    Next::Continue
}

/// The normal of a material's map, where it has one and `wo` sees it on the side of the surface that it
/// sees; else the interpolated one.
#[inline]
fn mapped_normal(
    scene: &Prepared,
    material: &PreparedMaterial,
    surface: &Surface,
    hit: &Hit,
    detail: &Detail,
    wo: Vec3,
) -> Vec3 {
    let Some(map) = &material.normal else { return surface.ns };
    let mapped = scene.mapped_normal(map, surface.object, hit, detail);
    mapped.filter(|n| n.dot(wo) * surface.ng.dot(wo) > 0.0).unwrap_or(surface.ns)
}

/// The first surface that a camera ray meets and that is there, as the path of the same address sees it,
/// with its shading normal, its material and what the albedo feature shows.
pub(super) fn first_surface(scene: &Prepared, address: &Address, ray: Ray) -> Option<(Surface, u32, Rgb)> {
    let (mut ray, mut from, mut medium) = (ray, NOWHERE, scene.start);
    for passed in 0..FAR_CAP {
        let hit = scene.accel.closest_between(&ray, from, RayKind::Camera)?;
        let mut surface = scene.surface(&ray, &hit, true);
        let material = scene.material_of(surface.object);
        let prepared = &scene.materials[material as usize];
        let detail = if prepared.detailed { scene.detail(surface.object, &hit) } else { Detail::NONE };
        let met = scene.meet(&surface, ray.d, medium);
        if met.is_none_or(|m| m.interface.is_some()) && is_there(prepared, &detail, address, 0, passed) {
            surface.ns = mapped_normal(scene, prepared, &surface, &hit, &detail, -ray.d);
            let albedo = prepared.varying.as_ref().map_or(prepared.albedo, |v| v.albedo(&detail));
            return Some((surface, material, albedo));
        }
        ray = Ray::new(offset_origin(surface.p, surface.p_err, surface.ng, ray.d), ray.d);
        from = [surface.id, met.map_or(PrimitiveId::NONE, |m| m.with)];
        medium = met.map_or(medium, |m| m.beyond);
    }
    None
}

/// The medium on the other side of a surface of `material`, where that on the side of `wo` is `medium`:
/// the interior from the front, what bodies around absorb from the back, and the same where nothing is
/// enclosed.
pub(super) fn medium_beyond(
    scene: &Prepared,
    medium: Medium,
    material: u32,
    context: &LightContext,
) -> Medium {
    let m = &scene.materials[material as usize];
    if !m.encloses {
        return medium;
    }
    let absorbs = if context.wo.dot(context.ng) > 0.0 {
        m.interior.is_some().then_some(material)
    } else {
        scene.absorbs_around(medium.inside)
    };
    Medium { absorbs, ..medium }
}

/// Share of light that the interior of a material leaves after `length` metres.
pub(super) fn interior(scene: &Prepared, material: u32, length: f32) -> Rgb {
    scene.materials[material as usize].interior.as_ref().map_or(Rgb::WHITE, |i| i.transmittance(length))
}

#[inline(never)]
fn free_lights<const FX: u32, const LAYERS: bool>(
    scene: &Prepared,
    path: &mut PathState,
    t_max: f32,
    counters: &mut Counters,
) {
    let camera = path.depth == 0;
    let mut sum = Rgb::BLACK;
    scene.lights.free_hits(&path.ray, t_max, |hit| {
        if camera && !hit.visible_to_camera {
            return;
        }
        let weight = match &path.sampled {
            None => 1.0,
            Some(s) => s.weight(scene.lights.pdf(&s.context, hit.light, hit.p, hit.n)),
        };
        let mut beta = path.beta;
        if scene.simulated::<FX>().has(Effect::Absorption)
            && let Some(medium) = path.medium.absorbs
        {
            beta *= interior(scene, medium, Vec3::distance(hit.p, path.ray.o));
        }
        let found = beta * planted!(light_energy(hit.radiance)) * weight;
        path.count(scene, found, hit.light, counters);
        sum += found;
    });
    path.meet::<LAYERS>(sum, &scene.kept);
}

fn distant_lights<const LAYERS: bool>(scene: &Prepared, path: &mut PathState, counters: &mut Counters) {
    let camera = path.depth == 0;
    let mut sum = Rgb::BLACK;
    let context = path.sampled.as_ref().map(|s| &s.context);
    scene.lights.distant(path.ray.d, context, |light, radiance, visible, pdf| {
        if camera && (!visible || scene.transparent) {
            return;
        }
        let weight = path.sampled.as_ref().map_or(1.0, |s| s.weight(pdf));
        let found = path.beta * radiance * weight;
        path.count(scene, found, light, counters);
        sum += found;
    });
    path.meet::<LAYERS>(sum, &scene.kept);
}

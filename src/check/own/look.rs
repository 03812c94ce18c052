//! What is often wrong with a scene, and what its author should know of it.

use std::collections::BTreeSet;

use glam::{DVec3, Vec3};

use super::{Finding, Says, say};
use crate::check::random::Random;
use crate::prepare::Prepared;
use crate::scene::{MaterialKind, Mesh, Object, Scene, Shape};

/// Points of an object's surface that are looked up in the others, at most.
const POINTS: usize = 256;

pub(super) fn triangles(scene: &Scene) -> Finding {
    let degenerate = |m: &Mesh| {
        let flat = |t: &&[u32; 3]| {
            let [a, b, c] = t.map(|i| m.positions.get(i as usize).copied().unwrap_or(Vec3::NAN).as_dvec3());
            let area: DVec3 = (b - a).cross(c - a);
            let square = area.length_squared();
            square.is_nan() || square <= 0.0
        };
        m.triangles.iter().filter(flat).count()
    };
    let n: usize = scene.meshes.iter().map(degenerate).sum();
    if n == 0 {
        return say("triangles", Says::Holds, "every triangle has an area");
    }
    say("triangles", Says::Look, format!("{n} triangles have no area; they are never hit"))
}

pub(super) fn lights(scene: &Scene) -> Finding {
    let dark = |m: &crate::scene::Material| matches!(&m.kind, MaterialKind::Light { radiance, .. } if radiance.is_black());
    let used = |(i, m): (usize, &crate::scene::Material)| {
        let here = scene.objects.iter().any(|o| o.material.0 as usize == i);
        (here && dark(m)).then(|| m.name.clone())
    };
    let names: Vec<String> = scene.materials.iter().enumerate().filter_map(used).collect();
    if names.is_empty() {
        return say("lights", Says::Holds, "every lamp shines");
    }
    say("lights", Says::Look, format!("lamps without power: {}", names.join(", ")))
}

/// What the camera is in.
pub(super) fn camera(scene: &Scene, camera: usize, prepared: &Prepared) -> Finding {
    let Some(camera) = scene.cameras.get(camera) else {
        return say("camera", Says::Skipped, "there is no camera");
    };
    let names: Vec<String> = prepared
        .around(scene, camera.transform.translation)
        .iter()
        .map(|&i| format!("\"{}\"", scene.objects[i].name))
        .collect();
    if names.is_empty() {
        return say("camera", Says::Holds, "the camera stands in the open");
    }
    let message = format!("the camera stands inside of {}: is it meant to?", names.join(", "));
    say("camera", Says::Look, message)
}

/// Bodies of which one reaches into another, where no order says which of them is there.
pub(super) fn overlaps(scene: &Scene, prepared: &Prepared) -> Finding {
    let mut random = Random::of("overlaps");
    let mut pairs: BTreeSet<[usize; 2]> = BTreeSet::new();
    let has_order = |i: usize| scene.materials[scene.objects[i].material.0 as usize].kind.body().is_some();
    for (i, object) in scene.objects.iter().enumerate() {
        if !prepared.materials[object.material.0 as usize].encloses {
            continue;
        }
        for p in surface(scene, object, &mut random) {
            let others = prepared.around(scene, p).into_iter().filter(|&j| j != i);
            pairs.extend(others.filter(|&j| !(has_order(i) && has_order(j))).map(|j| [i.min(j), i.max(j)]));
        }
    }
    let Some(&[a, b]) = pairs.first() else {
        return say("bodies", Says::Holds, "no body of glass lies in another without an order of priorities");
    };
    let [a, b] = [a, b].map(|i| scene.objects[i].name.as_str());
    let more =
        if pairs.len() > 1 { format!(", and {} more pairs do", pairs.len() - 1) } else { String::new() };
    say(
        "bodies",
        Says::Look,
        format!(
            "\"{a}\" and \"{b}\" overlap, or one lies in the other{more}: each surface reflects as against air. \
             Give both materials a `priority`, and the one that is there is the higher"
        ),
    )
}

/// Points on the surface of an object, world space.
fn surface(scene: &Scene, object: &Object, random: &mut Random) -> Vec<DVec3> {
    let place = |v: DVec3| object.transform.transform_point3(v);
    match object.shape {
        Shape::Sphere { radius } => {
            (0..POINTS).map(|_| place(radius * random.direction().as_dvec3())).collect()
        }
        Shape::Mesh(id) => {
            let positions = scene.meshes.get(id.0 as usize).map_or(&[][..], |m| &m.positions[..]);
            let step = positions.len().div_ceil(POINTS).max(1);
            positions.iter().step_by(step).map(|v| place(v.as_dvec3())).collect()
        }
    }
}

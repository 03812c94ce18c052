//! Triangles without an area: N17 and N18.

use glam::{DAffine3, DVec3, Vec3};

use crate::accel::{PrimitiveId, RayKind};
use crate::check::random::Random;
use crate::check::surfaces::{
    aimed, any_triangle, at, barycentric, lamp, material, mesh, prepared, refused, square,
};
use crate::check::{Effort, Figure};
use crate::light::{Emitter, LightContext};
use crate::prepare::Prepared;
use crate::scene::{Mesh, Scene, validate};
use crate::shape::Ray;
use crate::shape::triangle::{Shear, normal};

/// Edges at the bottom of single precision.
const TINY: f32 = 1e-38;

/// A lamp of one sound triangle among some that are not, each sort of which gets its own vertices.
fn mixed() -> Mesh {
    let p = Vec3::new(0.1, 0.3, 0.7);
    let sorts = [
        [Vec3::ZERO, Vec3::X, Vec3::Y],
        [p; 3],
        [p, p, Vec3::X],
        [Vec3::ZERO, p, p * 2.0],
        [Vec3::ZERO, Vec3::X, Vec3::new(0.0, f32::NAN, 0.0)],
        [Vec3::ZERO, Vec3::X, Vec3::new(0.0, f32::INFINITY, 0.0)],
        [Vec3::ZERO, Vec3::X * TINY, Vec3::Y * TINY],
    ];
    let triangles = (0..sorts.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { positions: sorts.into_iter().flatten().collect(), triangles, ..Mesh::default() }
}

/// A scene of one mesh that emits.
fn glowing(shape: Mesh) -> Scene {
    let mut scene = Scene::default();
    let light = material(&mut scene, lamp(1.0));
    mesh(&mut scene, shape, light);
    scene
}

/// N17.
pub(super) fn no_area(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N17");
    let mut figures = repaired();
    figures.extend(never_met(&mut r, effort.trials(20_000)));
    let n = effort.trials(20_000);
    // Three of the seven have no area, two are not finite; the tiny one has an area in double precision.
    match prepared(glowing(mixed()), DVec3::Z, None) {
        None => figures.push(refused("a mesh with triangles without area")),
        Some(scene) => figures.extend(lit_and_hit(&mut r, &scene, n, "one sound triangle of seven")),
    }
    // Sound in its own space, and without an area where it is placed: 1e6 m away numbers are 0.06 m apart.
    let mut positions = Vec::new();
    for _ in 0..500 {
        positions.extend(any_triangle(&mut r, 0.1, DVec3::ZERO));
    }
    let triangles = (0..500).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mut scene = glowing(Mesh { positions, triangles, ..Mesh::default() });
    scene.objects[0].transform = DAffine3::from_translation(DVec3::new(1e6, 2e6, -1e6));
    match prepared(scene, DVec3::Z, None) {
        None => figures.push(refused("a mesh that collapses where it is placed")),
        Some(scene) => {
            figures.extend(lit_and_hit(&mut r, &scene, n, "500 triangles of 0.1 m that collapse 1e6 m away"));
        }
    }
    figures
}

/// What validation makes of the mixed mesh, and of an index out of range.
fn repaired() -> Vec<Figure> {
    let mut scene = glowing(mixed());
    let notes = validate(&mut scene).unwrap_or_default();
    let counted = |code: &str, count: &str| {
        notes.iter().filter(|n| n.code == code && n.message.starts_with(count)).count() as f64
    };
    let mut wrong = mixed();
    wrong.triangles[0][1] = wrong.positions.len() as u32;
    let accepted = validate(&mut glowing(wrong)).is_ok();
    let kept = scene.meshes[0].triangles.len() as f64;
    vec![
        Figure::exactly("triangles kept of 7: a sound one, and one with edges of 1e-38 m", kept, 2.0),
        Figure::exactly(
            "notes that count 2 of 7 as not finite",
            counted("non-finite-triangles", "2 of 7 "),
            1.0,
        ),
        Figure::exactly(
            "notes that count 3 of 7 as without area",
            counted("degenerate-triangles", "3 of 7 "),
            1.0,
        ),
        Figure::exactly("meshes accepted with an index out of range", f64::from(u8::from(accepted)), 0.0),
    ]
}

/// Rays at triangles that never reach the renderer: the test itself refuses them.
fn never_met(r: &mut Random, n: u64) -> Vec<Figure> {
    let (mut rays, mut hits) = (0u64, 0u64);
    for _ in 0..n {
        let [a, b, _] = any_triangle(r, 1.0, DVec3::ZERO);
        let o = (r.direction().as_dvec3() * r.between(0.5, 3.0)).as_vec3();
        let Some(ray) = aimed(o, at([a, b, b], barycentric(r))) else { continue };
        let shear = Shear::new(&ray);
        let nan = Vec3::new(a.x, f32::NAN, a.z);
        let infinite = Vec3::new(f32::NEG_INFINITY, b.y, b.z);
        let tiny = [Vec3::X, Vec3::Y, Vec3::Z].map(|e| e * TINY);
        let sorts = [[a; 3], [b; 3], [a, b, b], [a, a, b], [a, b, a], [a, b, nan], [infinite, a, b], tiny];
        rays += sorts.len() as u64;
        hits += sorts.iter().filter(|v| shear.intersect(v[0], v[1], v[2]).is_some()).count() as u64;
        let to_tiny =
            aimed(o, DVec3::ZERO).and_then(|ray| Shear::new(&ray).intersect(tiny[0], tiny[1], tiny[2]));
        hits += u64::from(to_tiny.is_some());
    }
    vec![Figure::exactly(
        format!("hits of {rays} rays on equal points, infinite, undefined and tiny triangles"),
        hits as f64,
        0.0,
    )]
}

/// Rays and light samples on what is left of a lamp.
fn lit_and_hit(r: &mut Random, scene: &Prepared, n: u64, what: &str) -> Vec<Figure> {
    let g = scene.accel.geometry(0);
    let middle = g.vertices(0)[0].as_dvec3();
    let size = g.positions.iter().map(|p| (p.as_dvec3() - middle).length()).fold(0.0, f64::max);
    let no_area = |e: &&Emitter| match e {
        Emitter::Triangle { shape, .. } => normal(shape.v).is_none(),
        _ => false,
    };
    let lights_without = scene.lights.emitters().iter().filter(no_area).count();
    let [mut hits, mut bad_hits, mut samples, mut bad_samples] = [0u64; 4];
    for _ in 0..n {
        let o = (middle + r.direction().as_dvec3() * (size * r.between(1.0, 3.0))).as_vec3();
        let v = g.vertices((r.unit() * g.triangles.len() as f64) as u32);
        if let Some(ray) = aimed(o, at(v, barycentric(r)))
            && let Some(hit) = scene.accel.closest(&ray, PrimitiveId::NONE, RayKind::Other)
        {
            hits += 1;
            let s = scene.surface(&ray, &hit, true);
            let sound = hit.t.is_finite() && s.p.is_finite() && s.p_err.is_finite() && s.ng.is_normalized();
            bad_hits += u64::from(!sound);
        }
        let n = r.direction();
        let context = LightContext {
            p: o,
            p_err: o.abs() * f32::EPSILON,
            from: PrimitiveId::NONE,
            ng: n,
            ns: n,
            wo: n,
            transmits: true,
        };
        if let Some(s) = scene.lights.sample(&context, [r.unit_f32(), r.unit_f32(), r.unit_f32()]) {
            samples += 1;
            let sound = s.wi.is_normalized() && s.weight.is_finite() && s.pdf > 0.0 && s.pdf.is_finite();
            bad_samples += u64::from(!sound);
        }
    }
    vec![
        Figure::exactly(format!("lights without an area, {what}"), lights_without as f64, 0.0),
        Figure::at_least(format!("hits of {n} rays, {what}"), hits as f64, 1.0),
        Figure::exactly(format!("of {hits} hits not finite, {what}"), bad_hits as f64, 0.0),
        Figure::at_least(format!("samples of light at {n} points, {what}"), samples as f64, 1.0),
        Figure::exactly(format!("of {samples} samples of light not finite, {what}"), bad_samples as f64, 0.0),
    ]
}

/// N18: the numbers are pbrt's `Triangle.BadCases`. There the test refuses the triangle; here the test alone may
/// meet it, by the rounding of its shear, and validation drops it, so that no ray ever gets to try. A square
/// beside it is kept.
pub(super) fn on_a_line(_: Effort) -> Vec<Figure> {
    let corner = |y: f32| Vec3::new(-1_113.454_6, y, -56.243_19);
    let line = [corner(-79.049_614), corner(-87.092_27), corner(-79.209_015)];
    let o = Vec3::new(-1_081.479_3, 99.999_954, 87.770_11);
    let d = Vec3::new(-32.107_3, -183.355_87, -144.607_64);
    let beside = square(DVec3::new(-2000.0, 0.0, 0.0), 10.0, false);
    let mut positions = beside.positions;
    positions.extend(line);
    let mut figures = Vec::new();
    for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
        let mut triangles = beside.triangles.clone();
        triangles.push(order.map(|i| i + 4));
        let shape = Mesh { positions: positions.clone(), triangles, ..Mesh::default() };
        let what = format!("vertices {order:?}");
        let Some(scene) = prepared(glowing(shape), DVec3::Z, None) else {
            figures.push(refused(&what));
            continue;
        };
        let ray = Ray { t_max: 0.9999, ..Ray::new(o, d) };
        let hit = scene.accel.closest(&ray, PrimitiveId::NONE, RayKind::Other);
        let blocked = scene.accel.occluded(&ray, [PrimitiveId::NONE; 2]);
        let kept = scene.accel.geometry(0).triangles.len();
        figures.push(Figure::exactly(
            format!("hits, {what}"),
            f64::from(u8::from(hit.is_some() || blocked)),
            0.0,
        ));
        figures.push(Figure::exactly(format!("triangles kept of 3, {what}"), kept as f64, 2.0));
    }
    figures
}

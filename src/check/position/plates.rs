//! Two parallel plates, very near: N04.

use glam::{DMat3, DVec3, Vec3};

use crate::accel::{Accel, Geometry, PrimitiveId, RayKind};
use crate::check::random::Random;
use crate::check::surfaces::{Departure, barycentric, rotation, tilted};
use crate::check::{Effort, Figure};

/// Two unit squares around the origin, `gap` apart, turned by `turn` and scaled by a power of two; triangles
/// 0 and 1 are the lower one.
fn plates(turn: &DMat3, gap: f64, scale: f32) -> Geometry {
    let mut g = Geometry::default();
    for z in [0.0, gap] {
        let first = g.positions.len() as u32;
        let corner =
            |[x, y]: [f64; 2]| (*turn * DVec3::new(x - 0.5, y - 0.5, z - 0.5 * gap)).as_vec3() * scale;
        g.positions.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(corner));
        g.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    g
}

/// What leaves the lower plate.
struct Start {
    triangle: u32,
    b: [f32; 2],
    w: Vec3,
}

/// Points away from the rim, and directions that meet the upper plate before its rim.
fn starts(r: &mut Random, turn: &DMat3, n: u64) -> Vec<Start> {
    (0..n)
        .map(|i| {
            let middle = barycentric(r).map(|b| (0.9 * b + 0.1 / 3.0) as f32);
            let cos = libm::pow(10.0, r.between(-2.0, 0.0));
            Start { triangle: (i % 2) as u32, b: middle, w: tilted(r, (*turn * DVec3::Z).as_vec3(), cos) }
        })
        .collect()
}

/// N04. The same rays at every scale, so that distances must be the same numbers, scaled.
pub(super) fn near_plates(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N04");
    let n = effort.trials(400);
    let turns = [0; 8].map(|_| rotation(&mut r));
    let mut figures = Vec::new();
    let mut largest = 0.0f64;
    for gap in [1e-5, 1e-6] {
        let (mut rays, mut skipped, mut different) = (0u64, 0u64, 0u64);
        for turn in &turns {
            let starts = starts(&mut r, turn, n);
            let mut first: Vec<Option<f32>> = Vec::new();
            for k in -13..=23 {
                let scale = libm::exp2(f64::from(k)) as f32;
                let accel = Accel::new(plates(turn, gap, scale), Vec::new(), &[]);
                for (i, s) in starts.iter().enumerate() {
                    let (t, step) = up(&accel, s);
                    rays += 1;
                    skipped += u64::from(t.is_none());
                    largest = largest.max(step / f64::from(scale));
                    let t = t.map(|t| t / scale);
                    match first.get(i) {
                        Some(f) => different += u64::from(*f != t),
                        None => first.push(t),
                    }
                }
            }
        }
        let place = format!("of {rays} rays, plates {gap:e} of their edge apart, edges of 2^-13 to 2^23 m");
        figures.push(Figure::exactly(format!("upper plate missed {place}"), skipped as f64, 0.0));
        figures.push(Figure::exactly(format!("distances that do not scale {place}"), different as f64, 0.0));
    }
    // What a second plate must be away: documented as a millionth of the edge, for plates at the origin.
    figures.push(Figure::at_most("largest step off the lower plate, edges", largest, 1e-6));
    figures
}

/// The distance to the upper plate where that is met, and the length of the step off the lower one.
fn up(accel: &Accel, s: &Start) -> (Option<f32>, f64) {
    let Some(left) = Departure::new(accel.geometry(0).vertices(s.triangle), s.b, |_| s.w) else {
        return (None, 0.0);
    };
    let from = PrimitiveId { instance: 0, primitive: s.triangle };
    let hit = accel.closest(&left.ray, from, RayKind::Other);
    (hit.filter(|h| h.id.primitive >= 2).map(|h| h.t), left.displacement())
}

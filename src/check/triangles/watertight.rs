//! Closed meshes: N13.

use glam::{DVec3, Vec3};

use crate::accel::{Accel, Geometry, PrimitiveId, RayKind};
use crate::check::random::Random;
use crate::check::surfaces::{aimed, at, barycentric, closed};
use crate::check::{Effort, Figure};
use crate::shape::triangle::Shear;

/// What rays are aimed at.
const TARGETS: [&str; 3] = ["vertices", "points of edges", "points of faces"];

/// N13: 1e6 rays, or 1e8. Brute force takes ten times as long as the tree, and usually tries every sixteenth of them;
/// nightly it tries all.
pub(super) fn closed_mesh(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N13");
    // Three targets in three places.
    let n = effort.trials(112_000);
    let share = if effort == Effort::Nightly { 1 } else { 16 };
    let mut figures = Vec::new();
    for offset in [Vec3::ZERO, Vec3::splat(1e3), Vec3::new(148_376.0, 1234.0, -223_423.0)] {
        let mut star = Random::of("N13 star");
        let (positions, triangles) = closed(16, offset, || star.between(1.0, 6.0));
        let accel = Accel::new(Geometry { positions, triangles, ..Geometry::default() }, Vec::new(), &[]);
        for (kind, target) in TARGETS.into_iter().enumerate() {
            let [mut through_tree, mut past_all, mut unshadowed] = [0u64; 3];
            for i in 0..n {
                let Some((o, target)) = aim(&mut r, accel.geometry(0), offset, kind) else { continue };
                let Some(ray) = aimed(o, target) else { continue };
                let hit = accel.closest(&ray, PrimitiveId::NONE, RayKind::Other);
                through_tree += u64::from(hit.is_none());
                unshadowed += u64::from(!accel.occluded(&ray, [PrimitiveId::NONE; 2]));
                if i % share == 0 {
                    past_all += u64::from(!met_by_any(accel.geometry(0), &Shear::new(&ray)));
                }
            }
            let place = format!("rays aimed at {target}, star at {offset}");
            let count = |what: &str, n: u64, value: u64| {
                Figure::exactly(format!("leaks {what} of {n} {place}"), value as f64, 0.0)
            };
            figures.push(count("through the tree", n, through_tree));
            figures.push(count("of shadow rays", n, unshadowed));
            figures.push(count("past every triangle", n.div_ceil(share), past_all));
        }
    }
    figures
}

/// An origin near the middle of the star, inside of it, and a point of it.
fn aim(r: &mut Random, star: &Geometry, offset: Vec3, kind: usize) -> Option<(Vec3, DVec3)> {
    let inner = r.direction().as_dvec3() * (0.5 * r.unit());
    let triangle = (r.unit() * star.triangles.len() as f64) as u32;
    let v = star.vertices(triangle);
    let b = match kind {
        0 => [0.0, 0.0],
        1 => [r.unit(), 0.0],
        _ => barycentric(r),
    };
    Some(((offset.as_dvec3() + inner).as_vec3(), at(v, b)))
}

/// Whether the ray meets any triangle.
fn met_by_any(g: &Geometry, shear: &Shear) -> bool {
    (0..g.triangles.len() as u32).any(|i| {
        let [a, b, c] = g.vertices(i);
        shear.intersect(a, b, c).is_some()
    })
}

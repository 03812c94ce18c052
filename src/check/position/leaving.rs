//! Leaving triangles: N01 to N03.

use glam::{DMat3, DVec3, Vec3};

use crate::accel::{Accel, Geometry, PrimitiveId, RayKind};
use crate::check::random::Random;
use crate::check::stage::U;
use crate::check::surfaces::{Departure, Plane, aimed, any_triangle, at, barycentric, largest, tilted};
use crate::check::{Effort, Figure};
use crate::shape::triangle::Shear;

/// What happened to many rays that left triangles.
#[derive(Default)]
struct Tally {
    rays: u64,
    /// Met the triangle again in a tree that knew which one they left, of every fourth ray.
    again: u64,
    /// Met it again where nothing told the test which one they left.
    unaware: u64,
    /// Began on the wrong side of the exact plane, or on it.
    wrong_side: u64,
    /// The largest displacement, in units of rounding of the largest coordinate.
    displaced: f64,
}

impl Tally {
    /// Rays from `n` hits of triangles of `size`, `away` from the origin.
    fn of(r: &mut Random, size: f64, away: f64, n: u64) -> Self {
        let mut tally = Self::default();
        // Some rays miss by rounding; a test that finds no hits must end all the same.
        for _ in 0..4 * n {
            if tally.rays == n {
                break;
            }
            tally.one(r, size, away);
        }
        tally
    }

    fn one(&mut self, r: &mut Random, size: f64, away: f64) -> Option<()> {
        let place = r.direction().as_dvec3() * away;
        let v = any_triangle(r, size, place);
        let plane = Plane::of(v)?;
        let target = at(v, barycentric(r));
        let o = (target + r.direction().as_dvec3() * (size * r.between(0.5, 3.0))).as_vec3();
        let hit = Shear::new(&aimed(o, target)?).intersect(v[0], v[1], v[2])?;
        let w = r.direction();
        let left = Departure::new(v, [hit.b1, hit.b2], |_| w)?;
        self.rays += 1;
        self.unaware += u64::from(Shear::new(&left.ray).intersect(v[0], v[1], v[2]).is_some());
        if self.rays.is_multiple_of(4) {
            let alone = Geometry { positions: v.to_vec(), triangles: vec![[0, 1, 2]], ..Geometry::default() };
            let from = PrimitiveId { instance: 0, primitive: 0 };
            let hit = Accel::new(alone, Vec::new(), &[]).closest(&left.ray, from, RayKind::Other);
            self.again += u64::from(hit.is_some());
        }
        self.wrong_side += u64::from(left.clearance(&plane) <= 0.0);
        self.displaced = self.displaced.max(left.displacement() / (U * largest(v).max(away)));
        Some(())
    }

    /// The figures; `displacement` is the most that is allowed, in units of rounding.
    fn figures(&self, n: u64, place: &str, displacement: f64) -> [Figure; 5] {
        let count = |what: &str, n: u64, v: u64| {
            Figure::exactly(format!("{what} of {n} rays, {place}"), v as f64, 0.0)
        };
        [
            Figure::at_least(format!("rays that left, {place}"), self.rays as f64, n as f64),
            count("self-hits", n / 4, self.again),
            // A triangle seen edge-on has a determinant of nothing but rounding: a few rays in 1e5 would meet it
            // again. That is why the one that is left is known by its number; no displacement would do.
            Figure::at_most(
                format!("share of {n} rays that would hit without knowing what they left, {place}"),
                self.unaware as f64 / n as f64,
                2e-4,
            ),
            count("origins on the wrong side", n, self.wrong_side),
            Figure::at_most(
                format!("largest displacement, units of rounding of the largest coordinate, {place}"),
                self.displaced,
                displacement,
            ),
        ]
    }
}

/// N01. The table measures displacements by the coordinates projected on the normal; in a plane in which a
/// coordinate vanishes that is nothing, and the renderer takes a share of the largest one (see
/// `shape::triangle::point`), so the unit here is that of the largest coordinate.
pub(super) fn any_size(effort: Effort) -> Vec<Figure> {
    let (mut r, n) = (Random::of("N01"), effort.trials(60_000));
    let sizes = [1e-4, 1e-2, 1.0, 1e2, 1e4, 1e7];
    sizes
        .into_iter()
        .flat_map(|s| Tally::of(&mut r, s, 0.0, n).figures(n, &format!("edges of {s:e} m"), 32.0))
        .collect()
}

/// N02.
pub(super) fn far_away(effort: Effort) -> Vec<Figure> {
    let (mut r, n) = (Random::of("N02"), effort.trials(60_000));
    [(1.0, 1e3), (1.0, 1e5), (1e-2, 1e3), (1e3, 1e6)]
        .into_iter()
        .flat_map(|(s, t)| {
            let place = format!("edges of {s:e} m, {t:e} m away");
            Tally::of(&mut r, s, t, n).figures(n, &place, 64.0)
        })
        .collect()
}

/// Cells along one side of the plane of N03, whose edge is as many metres.
const CELLS: u32 = 100;

/// A square of two triangles a cell, with edges of one metre, turned by `turn`.
fn grid(turn: DMat3) -> Geometry {
    let mut g = Geometry::default();
    let half = f64::from(CELLS) / 2.0;
    for z in 0..=CELLS {
        for x in 0..=CELLS {
            g.positions.push((turn * DVec3::new(f64::from(x) - half, 0.0, half - f64::from(z))).as_vec3());
        }
    }
    for z in 0..CELLS {
        for x in 0..CELLS {
            let a = z * (CELLS + 1) + x;
            let (b, c, d) = (a + 1, a + CELLS + 1, a + CELLS + 2);
            g.triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    g
}

/// N03. Neighbours are coplanar but for the rounding of their vertices, and are not skipped.
pub(super) fn meshed_plane(effort: Effort) -> Vec<Figure> {
    let (mut r, n) = (Random::of("N03"), effort.trials(40_000));
    let turned = DMat3::from_axis_angle(DVec3::new(4.0, 7.0, -1.0).normalize(), 4.34);
    let mut figures = Vec::new();
    for (name, turn) in [("turned plane", turned), ("plane y = 0", DMat3::IDENTITY)] {
        let accel = Accel::new(grid(turn), Vec::new(), &[]);
        let up = (turn * DVec3::Y).as_vec3();
        for (range, low, high) in [("1e-3 to 1", 1e-3, 1.0), ("1e-4 to 1e-3", 1e-4, 1e-3)] {
            let mut hits = 0;
            for _ in 0..n {
                let id = (r.unit() * f64::from(2 * CELLS * CELLS)) as u32;
                let cos = low * libm::pow(high / low, r.unit());
                hits += u64::from(meets(&accel, &mut r, id, up, cos));
            }
            let what = format!("hits of {n} rays from a {name} of 20000 triangles at cosines of {range}");
            // The table allows 1e-6 of the flattest rays; at this many that is none.
            figures.push(Figure::at_most(what, hits as f64, if low < 1e-3 { 1e-6 * n as f64 } else { 0.0 }));
        }
    }
    figures
}

/// Whether a ray from a triangle to the side `up`, at a cosine, meets anything else.
fn meets(accel: &Accel, r: &mut Random, id: u32, up: Vec3, cos: f64) -> bool {
    let v = accel.geometry(0).vertices(id);
    let b = barycentric(r).map(|x| x as f32);
    let Some(left) = Departure::new(v, b, |ng| tilted(r, ng * 1.0f32.copysign(ng.dot(up)), cos)) else {
        return false;
    };
    let from = PrimitiveId { instance: 0, primitive: id };
    accel.closest(&left.ray, from, RayKind::Other).is_some()
}

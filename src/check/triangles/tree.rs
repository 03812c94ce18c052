//! The tree against brute force over the same triangle test: N14 and N15.

use glam::{DVec3, Vec3};

use crate::accel::{Accel, Geometry, Hit, PrimitiveId, RayKind};
use crate::check::random::Random;
use crate::check::surfaces::{aimed, any_triangle, at, barycentric};
use crate::check::{Effort, Figure};
use crate::shape::Ray;
use crate::shape::triangle::Shear;

/// The first hit by trying all triangles.
fn brute_force(g: &Geometry, ray: &Ray) -> Option<Hit> {
    let shear = Shear::new(ray);
    let mut best: Option<Hit> = None;
    for primitive in 0..g.triangles.len() as u32 {
        let [a, b, c] = g.vertices(primitive);
        let Some(h) = shear.intersect(a, b, c) else { continue };
        // In the order of their numbers: the first of equals stays.
        if h.t <= ray.t_max && best.is_none_or(|o| h.t < o.t) {
            best = Some(Hit { t: h.t, id: PrimitiveId { instance: 0, primitive }, b: [h.b1, h.b2] });
        }
    }
    best
}

/// A tree, walked by the kernel of this machine and by the portable one.
pub(super) struct Trees {
    own: Accel,
    portable: Accel,
}

/// What was compared.
#[derive(Default)]
pub(super) struct Compared {
    rays: u64,
    found: u64,
    different: u64,
    different_portable: u64,
    different_shadows: u64,
}

impl Trees {
    pub(super) fn over(geometry: Geometry) -> Self {
        let own = Accel::new(geometry, Vec::new(), &[]);
        Self { portable: own.clone().portable(), own }
    }

    pub(super) fn geometry(&self) -> &Geometry {
        self.own.geometry(0)
    }
}

impl Compared {
    pub(super) fn add(&mut self, trees: &Trees, ray: &Ray) {
        let expected = brute_force(trees.geometry(), ray);
        let closest = |a: &Accel| a.closest(ray, PrimitiveId::NONE, RayKind::Other);
        let shadow = expected.is_some_and(|h| h.t < ray.t_max);
        self.rays += 1;
        self.found += u64::from(expected.is_some());
        self.different += u64::from(closest(&trees.own) != expected);
        self.different_portable += u64::from(closest(&trees.portable) != expected);
        self.different_shadows += u64::from(trees.own.occluded(ray, [PrimitiveId::NONE; 2]) != shadow);
    }

    pub(super) fn figures(&self, what: &str, least: f64) -> Vec<Figure> {
        let n = self.rays;
        let count = |who: &str, v: u64| {
            Figure::exactly(format!("{who} other than by brute force, {n} rays, {what}"), v as f64, 0.0)
        };
        vec![
            count("hits", self.different),
            count("hits by the portable kernel", self.different_portable),
            count("shadows", self.different_shadows),
            Figure::at_least(
                format!("share of {n} rays that hit, {what}"),
                self.found as f64 / n as f64,
                least,
            ),
        ]
    }
}

/// Cells of the lattice of N14 along each axis.
const LATTICE: f64 = 4.0;

/// Axis-parallel unit squares of two triangles on the planes of a lattice: their boxes are flat.
fn flat_squares(r: &mut Random, n: u32) -> Geometry {
    let mut g = Geometry::default();
    for i in 0..n {
        let corner = DVec3::from_array([0; 3].map(|_| (r.unit() * LATTICE).floor())).as_vec3();
        let (a, b) = [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)][i as usize % 3];
        let first = g.positions.len() as u32;
        g.positions.extend([corner, corner + a, corner + a + b, corner + b]);
        g.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    g
}

/// N14. Origins lie on corners, edges and faces of the boxes, in them and between them; directions have each of
/// -1, -0, 0 and 1 along every axis.
pub(super) fn axis_parallel(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N14");
    let signs = [-1.0, -0.0, 0.0, 1.0f32];
    let directions: Vec<Vec3> = (0..64)
        .filter_map(|k: usize| Vec3::new(signs[k & 3], signs[k >> 2 & 3], signs[k >> 4]).try_normalize())
        .collect();
    let mut compared = Compared::default();
    for _ in 0..8 {
        let trees = Trees::over(flat_squares(&mut r, 60));
        for i in 0..effort.trials(10_000) {
            let place = |r: &mut Random| 0.5 * (r.unit() * (2.0 * LATTICE + 3.0)).floor() - 0.5;
            let mut o = DVec3::from_array([0; 3].map(|_| place(&mut r))).as_vec3();
            if i % 8 == 0 {
                // Zero of the other sign.
                o = Vec3::from_array(o.to_array().map(|x| if x == 0.0 { -0.0 } else { x }));
            }
            let mut ray = Ray::new(o, directions[i as usize % directions.len()]);
            if i % 5 == 0 {
                // Ends that coincide with planes.
                ray.t_max = (1.0 + (r.unit() * 3.0).floor()) as f32;
            }
            compared.add(&trees, &ray);
        }
    }
    compared.figures("56 axis-parallel and diagonal directions, 120 triangles", 0.2)
}

/// N15. Sizes of 1e-3 to 1e3 m in a cube of 100 m; half of the rays are aimed at a triangle.
pub(super) fn soup(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N15");
    let mut g = Geometry::default();
    for i in 0..10_000u32 {
        let middle = DVec3::from_array([0; 3].map(|_| r.between(-50.0, 50.0)));
        let size = libm::pow(10.0, r.between(-3.0, 3.0));
        // The large ones would hide all others from every ray: few of them.
        let size = if size > 10.0 && i % 50 != 0 { size * 1e-3 } else { size };
        g.positions.extend(any_triangle(&mut r, size, middle));
        g.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let trees = Trees::over(g);
    let mut compared = Compared::default();
    for i in 0..effort.trials(1_800) {
        let o = DVec3::from_array([0; 3].map(|_| r.between(-75.0, 75.0))).as_vec3();
        let v = trees.geometry().vertices((r.unit() * 10_000.0) as u32);
        let target = at(v, barycentric(&mut r));
        let ray = if i % 2 == 0 { aimed(o, target) } else { Some(Ray::new(o, r.direction())) };
        let Some(mut ray) = ray else { continue };
        if i % 3 == 0 {
            ray.t_max = (r.unit() * 40.0) as f32 + 1e-3;
        }
        compared.add(&trees, &ray);
    }
    compared.figures("10000 triangles with edges of 1e-3 to 1e3 m", 0.2)
}

//! The accelerator against brute force over the same triangle test.

use glam::{DAffine3, DVec3, Vec3};

use super::*;
use crate::sampling::{Address, Purpose, warp::square_to_sphere};
use crate::shape::triangle::Shear;

/// Uniform numbers named by a test and an index.
fn numbers(test: u64, i: u32, k: u32) -> [f32; 4] {
    Address::new(test, 0, 0, i).block(0, Purpose::Test, 0, k)
}

fn soup(n: u32, seed: u64) -> Geometry {
    let mut g = Geometry::default();
    for i in 0..n {
        let (a, b, c) = (numbers(seed, i, 0), numbers(seed, i, 1), numbers(seed, i, 2));
        // Sizes over six decades.
        let size = crate::math::pow(10.0, 6.0 * a[3] - 3.0) * 0.1;
        let center = Vec3::new(a[0], a[1], a[2]) * 20.0 - 10.0;
        let vertex = |u: [f32; 2]| center + square_to_sphere(u) * size;
        let first = g.positions.len() as u32;
        g.positions.extend([vertex([b[0], b[1]]), vertex([b[2], b[3]]), vertex([c[0], c[1]])]);
        g.triangles.push([first, first + 1, first + 2]);
    }
    for i in 0..n / 50 {
        let a = numbers(seed, i, 3);
        g.spheres.push((Vec3::new(a[0], a[1], a[2]) * 20.0 - 10.0, 0.01 + a[3]));
    }
    g
}

fn brute_force(g: &Geometry, ray: &Ray, from: u32) -> Option<Hit> {
    let shear = Shear::new(ray);
    let mut best: Option<Hit> = None;
    let mut offer = |t: f32, primitive: usize, b: [f32; 2]| {
        let hit = Hit { t, id: PrimitiveId { instance: 0, primitive: primitive as u32 }, b };
        if t <= ray.t_max && best.is_none_or(|o| (hit.t, hit.id) < (o.t, o.id)) {
            best = Some(hit);
        }
    };
    for i in 0..g.triangles.len() {
        let [a, b, c] = g.vertices(i as u32);
        if i as u32 != from
            && let Some(h) = shear.intersect(a, b, c)
        {
            offer(h.t, i, [h.b1, h.b2]);
        }
    }
    for (i, &(c, r)) in g.spheres.iter().enumerate() {
        let i = g.triangles.len() + i;
        if let Some(t) = crate::shape::sphere::first_hit(ray, c, r, i as u32 == from) {
            offer(t, i, [0.0; 2]);
        }
    }
    best
}

/// N15: the same primitive and the same bits as brute force, on triangles of all sizes; the any-hit
/// query agrees, and so does the portable twin of the kernel.
#[test]
fn agrees_with_brute_force_to_the_bit() {
    let g = soup(1500, 1);
    let accel = Accel::new(g.clone(), Vec::new(), &[]);
    let portable = accel.clone().portable();
    let mut found = 0;
    for i in 0..6000 {
        let u = numbers(2, i, 0);
        let v = numbers(2, i, 1);
        let mut ray = Ray::new(Vec3::new(u[0], u[1], u[2]) * 30.0 - 15.0, square_to_sphere([v[0], v[1]]));
        if i % 3 == 0 {
            ray.t_max = 5.0 * v[2];
        }
        let from = PrimitiveId { instance: 0, primitive: i % 1500 };
        let expected = brute_force(&g, &ray, from.primitive);
        assert_eq!(accel.closest(&ray, from, RayKind::Other), expected);
        assert_eq!(portable.closest(&ray, from, RayKind::Other), expected);
        let blocked = accel.occluded(&ray, [from, PrimitiveId::NONE]);
        assert_eq!(blocked, expected.is_some_and(|h| h.t < ray.t_max));
        assert_eq!(portable.occluded(&ray, [from, PrimitiveId::NONE]), blocked);
        found += u32::from(expected.is_some());
    }
    assert!(found > 500, "the test must hit things: {found}");
}

/// N14: axis-parallel rays with zeros of both signs, starting on faces, edges and corners of boxes.
#[test]
fn axis_parallel_rays_agree_with_brute_force() {
    let mut g = Geometry::default();
    for z in [-1.0f32, 0.0, 1.0] {
        let first = g.positions.len() as u32;
        g.positions
            .extend([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(x, y, z)));
        g.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    g.spheres.push((Vec3::new(4.0, 0.0, 0.0), 1.0));
    let accel = Accel::new(g.clone(), Vec::new(), &[]);
    let signs = [-1.0, -0.0, 0.0, 1.0f32];
    let places = [-2.0, -1.0, -0.5, 0.0, 1.0, 2.0f32];
    for k in 0..64 {
        let d = Vec3::new(signs[k & 3], signs[k >> 2 & 3], signs[k >> 4]);
        let Some(d) = d.try_normalize() else { continue };
        for k in 0..216 {
            let ray = Ray::new(Vec3::new(places[k % 6], places[k / 6 % 6], places[k / 36]), d);
            let hit = accel.closest(&ray, PrimitiveId::NONE, RayKind::Other);
            assert_eq!(hit, brute_force(&g, &ray, u32::MAX), "{ray:?}");
        }
    }
}

/// N13: a closed mesh has no holes, however exactly rays aim at its vertices and edges, and however far
/// from the origin it stands.
#[test]
fn closed_meshes_do_not_leak() {
    let n = 16u32;
    for offset in [Vec3::ZERO, Vec3::splat(1e3), Vec3::new(148_376.0, 1234.0, -223_423.0)] {
        let mut g = Geometry::default();
        for row in 0..=n {
            for column in 0..n {
                let u = numbers(3, row * n + column, 0);
                let (s, c) = crate::math::sin_cos_turn(column as f32 / n as f32);
                let (st, ct) = crate::math::sin_cos_turn(0.5 * row as f32 / n as f32);
                // The poles are one vertex, repeated.
                let radius = if row == 0 || row == n { 3.0 } else { 1.0 + 5.0 * u[0] };
                let ring = if row == 0 || row == n {
                    Vec3::new(0.0, 0.0, ct.signum())
                } else {
                    Vec3::new(st * c, st * s, ct)
                };
                g.positions.push(offset + ring * radius);
            }
        }
        for row in 0..n {
            for column in 0..n {
                let at = |r: u32, c: u32| r * n + c % n;
                let (a, b, c, d) =
                    (at(row, column), at(row, column + 1), at(row + 1, column), at(row + 1, column + 1));
                g.triangles.extend([[a, c, b], [b, c, d]]);
            }
        }
        let accel = Accel::new(g.clone(), Vec::new(), &[]);
        for i in 0..60_000u32 {
            let u = numbers(4, i, 0);
            let v = numbers(4, i, 1);
            let o = offset + Vec3::new(u[0], u[1], u[2]) - 0.5;
            let [p, q, r] = g.vertices((u[3] * g.triangles.len() as f32) as u32);
            let target = match i % 3 {
                0 => p,
                1 => p + (q - p) * v[0],
                _ => p + (q - p) * (v[0] * 0.5) + (r - p) * (v[1] * 0.5),
            };
            let Some(d) = (target - o).try_normalize() else { continue };
            let ray = Ray::new(o, d);
            assert!(accel.closest(&ray, PrimitiveId::NONE, RayKind::Other).is_some(), "leak at ray {i}");
            assert!(accel.occluded(&ray, [PrimitiveId::NONE; 2]), "shadow leak at ray {i}");
        }
    }
}

/// N21: where surfaces coincide, the lower id wins, and instances come after the world.
#[test]
fn ties_go_to_the_lower_id() {
    let square = |z: f32| Geometry {
        positions: vec![Vec3::new(-1.0, -1.0, z), Vec3::new(1.0, -1.0, z), Vec3::new(0.0, 1.0, z)],
        triangles: vec![[0, 1, 2], [0, 1, 2]],
        ..Geometry::default()
    };
    let placement = Placement { mesh: 0, to_world: DAffine3::IDENTITY, hidden: false };
    let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), -Vec3::Z);
    let world = Accel::new(square(0.0), vec![square(0.0)], std::slice::from_ref(&placement));
    let hit = world.closest(&ray, PrimitiveId::NONE, RayKind::Other).expect("a hit");
    assert_eq!(hit.id, PrimitiveId { instance: 0, primitive: 0 });
    let nearer = Accel::new(square(0.0), vec![square(1.0)], &[placement.clone(), placement]);
    let hit = nearer.closest(&ray, PrimitiveId::NONE, RayKind::Other).expect("a hit");
    assert_eq!(hit.id, PrimitiveId { instance: 1, primitive: 0 });
}

/// Instances under rotation, shear and mirroring hit where the transformed triangles are.
#[test]
fn instances_hit_where_their_triangles_are() {
    let mesh = soup(200, 5);
    let mesh = Geometry { spheres: Vec::new(), ..mesh };
    let transforms = [
        DAffine3::from_scale_rotation_translation(
            DVec3::new(0.5, 2.0, -1.5),
            glam::DQuat::from_xyzw(0.5, 0.5, 0.5, 0.5),
            DVec3::new(3.0, -2.0, 1.0),
        ),
        DAffine3::from_translation(DVec3::new(-25.0, 3.0, 2.0)),
    ];
    let placements = transforms.map(|to_world| Placement { mesh: 0, to_world, hidden: false });
    let accel = Accel::new(Geometry::default(), vec![mesh.clone()], &placements);
    let mut flat = Geometry::default();
    for m in &transforms {
        let base = flat.positions.len() as u32;
        flat.positions.extend(mesh.positions.iter().map(|p| m.transform_point3(p.as_dvec3()).as_vec3()));
        flat.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + base)));
    }
    let (mut both, mut apart) = (0, 0);
    for i in 0..4000 {
        let u = numbers(6, i, 0);
        let v = numbers(6, i, 1);
        let ray = Ray::new(Vec3::new(u[0], u[1], u[2]) * 60.0 - 35.0, square_to_sphere([v[0], v[1]]));
        let a = accel.closest(&ray, PrimitiveId::NONE, RayKind::Other);
        let b = brute_force(&flat, &ray, u32::MAX);
        match (a, b) {
            (Some(a), Some(b)) if (a.t - b.t).abs() <= 1e-4 * b.t.max(1.0) => both += 1,
            (None, None) => {}
            _ => apart += 1,
        }
    }
    // Rounding may decide differently only at the very edge of a triangle.
    assert!(both > 300 && apart <= 2, "{both} {apart}");
}

//! Surfaces that coincide: N21.

use glam::{DAffine3, DVec3};

use crate::accel::{Accel, Geometry, Hit, Placement, PrimitiveId, RayKind};
use crate::check::random::Random;
use crate::check::surfaces::{aimed, any_triangle, at, barycentric, lamp, material, mesh, prepared, refused};
use crate::check::{Effort, Figure};
use crate::integrate::{Quiet, RenderOptions, render};
use crate::scene::{Mesh, Scene};

/// Triangles of N21, each given twice.
const PAIRS: u32 = 40;

/// Every triangle twice, the second time after all of the first, in the order of `again`; `others` triangles
/// far away stand between the two and make the tree another one.
fn twice(first: &[[glam::Vec3; 3]], again: &[u32], others: &[[glam::Vec3; 3]]) -> Geometry {
    let mut g = Geometry::default();
    let mut push = |v: [glam::Vec3; 3]| {
        let base = g.positions.len() as u32;
        g.positions.extend(v);
        g.triangles.push([base, base + 1, base + 2]);
    };
    first.iter().copied().for_each(&mut push);
    others.iter().copied().for_each(&mut push);
    again.iter().for_each(|&i| push(first[i as usize]));
    g
}

/// A random order.
fn shuffled(r: &mut Random, n: u32) -> Vec<u32> {
    let mut order: Vec<u32> = (0..n).collect();
    for i in (1..n as usize).rev() {
        order.swap(i, (r.unit() * (i + 1) as f64) as usize);
    }
    order
}

/// N21.
pub(super) fn first_wins(effort: Effort) -> Vec<Figure> {
    let mut r = Random::of("N21");
    let n = effort.trials(4_000);
    let first: Vec<_> = (0..PAIRS)
        .map(|_| {
            let middle = DVec3::from_array([0; 3].map(|_| r.between(-1.0, 1.0)));
            any_triangle(&mut r, 1.0, middle)
        })
        .collect();
    let alone = Accel::new(twice(&first, &[], &[]), Vec::new(), &[]);
    let [mut second, mut other, mut instance, mut rays] = [0u64; 4];
    for layout in [0u32, 1, 10, 300] {
        let others: Vec<_> = (0..layout)
            .map(|_| {
                let away = r.direction().as_dvec3() * 50.0;
                any_triangle(&mut r, 1.0, away)
            })
            .collect();
        let again = shuffled(&mut r, PAIRS);
        let both = Accel::new(twice(&first, &again, &others), Vec::new(), &[]);
        let portable = both.clone().portable();
        let placement = Placement { mesh: 0, to_world: DAffine3::IDENTITY, hidden: false };
        let repeated =
            Accel::new(twice(&first, &[], &others), vec![twice(&first, &again, &[])], &[placement]);
        for _ in 0..n {
            let target = at(first[(r.unit() * f64::from(PAIRS)) as usize], barycentric(&mut r));
            let Some(ray) = aimed((r.direction().as_dvec3() * 4.0).as_vec3(), target) else { continue };
            let hit = |a: &Accel| a.closest(&ray, PrimitiveId::NONE, RayKind::Other);
            let expected = hit(&alone);
            // The triangles that stand apart may hide the others from an origin near them; none is that near.
            rays += 1;
            second += u64::from(hit(&both).is_none_or(|h| h.id.primitive >= PAIRS) && expected.is_some());
            other += u64::from(hit(&both) != expected || hit(&portable) != expected);
            let of_world = |h: Hit| h.id.instance == 0;
            instance += u64::from(hit(&repeated) != expected || !expected.is_none_or(of_world));
        }
    }
    let what = format!("of {rays} rays on {PAIRS} triangles given twice, 4 trees");
    let mut figures = vec![
        Figure::exactly(format!("the second is seen {what}"), second as f64, 0.0),
        Figure::exactly(format!("other hits than without it {what}"), other as f64, 0.0),
        Figure::exactly(format!("the one of a repeated mesh is seen {what}"), instance as f64, 0.0),
    ];
    figures.extend(threads(&first));
    figures
}

/// Two lamps of different radiance in the same place: the first is seen, and the picture is the same for any
/// number of threads.
fn threads(shape: &[[glam::Vec3; 3]]) -> Vec<Figure> {
    let mut scene = Scene::default();
    let soup = twice(shape, &[], &[]);
    for radiance in [1.0, 3.0] {
        let of = material(&mut scene, lamp(radiance));
        let positions = soup.positions.clone();
        mesh(&mut scene, Mesh { positions, triangles: soup.triangles.clone(), ..Mesh::default() }, of);
    }
    let Some(scene) = prepared(scene, DVec3::new(0.0, 0.0, 5.0), None) else { return vec![refused("N21")] };
    let image = |threads: usize| {
        let options = RenderOptions { threads, ..RenderOptions::passes(0..4) };
        render(&scene, &options, &Quiet).ok().map(|o| o.film.to_image())
    };
    let images = [1, 2, 3, 8].map(image);
    let different = images.iter().filter(|i| i.is_none() || **i != images[0]).count();
    let brightest = images[0].iter().flat_map(|i| &i.rgb).map(|c| c.max_channel()).fold(0.0, f32::max);
    vec![
        Figure::exactly("pictures that differ, with 1, 2, 3 and 8 threads", different as f64, 0.0),
        Figure::exactly(
            "brightest pixel of two coincident lamps, the first of radiance 1",
            brightest.into(),
            1.0,
        ),
    ]
}

//! Polygons cover their own area, whatever their shape and however they are turned.

use std::fmt::Write;
use std::time::{Duration, Instant};

use glam::{DQuat, DVec3};
use proptest::prelude::*;

use super::*;

/// The area that a file of one polygon shows, and the notes.
fn shown(corners: &[DVec3]) -> (f64, Vec<&'static str>) {
    let mut obj = String::new();
    for p in corners {
        writeln!(obj, "v {} {} {}", p.x, p.y, p.z).unwrap();
    }
    let indices: Vec<String> = (1..=corners.len()).map(|i| i.to_string()).collect();
    writeln!(obj, "f {}", indices.join(" ")).unwrap();
    let (scene, notes) = load(&obj);
    (scene.meshes.iter().map(area).sum(), codes(&notes))
}

fn flat(list: &[[f64; 2]]) -> Vec<DVec3> {
    list.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect()
}

fn shoelace(list: &[[f64; 2]]) -> f64 {
    let sum: f64 = (0..list.len())
        .map(|i| {
            let ([ax, ay], [bx, by]) = (list[i], list[(i + 1) % list.len()]);
            ax * by - bx * ay
        })
        .sum();
    sum.abs() / 2.0
}

/// Known shapes: what a fan gets wrong by up to thirteen times.
#[test]
fn concave_polygons_keep_their_area() {
    let check = |list: &[[f64; 2]]| {
        for (mirror, shift) in [(1.0, 0), (-1.0, 1), (1.0, 2)] {
            let mut list: Vec<[f64; 2]> = list.iter().map(|&[x, y]| [mirror * x, y]).collect();
            list.rotate_left(shift);
            let (found, notes) = shown(&flat(&list));
            let expected = shoelace(&list);
            assert!((found / expected - 1.0).abs() < 1e-6, "{list:?}: {found}, expected {expected}");
            assert_eq!(notes, ["material-missing"], "{list:?}");
        }
    };
    // An arrow head: a quadrilateral that only one diagonal splits.
    check(&[[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]]);
    // L, U, and a comb.
    check(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
    check(&[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]]);
    let comb: Vec<[f64; 2]> = (0..40)
        .map(|i| [f64::from(i), if i % 2 == 0 { 1.0 } else { 9.0 }])
        .chain([[39.0, 0.0], [0.0, 0.0]])
        .collect();
    check(&comb);
    // Corners on a straight edge.
    check(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]]);
    check(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 2.0]]);
    // A square with a slit to a square hole: corners that are used twice.
    check(&[
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ]);
}

/// A polygon that is not flat covers what is seen of it along its normal: the area to which its own area
/// vector adds up, at least.
#[test]
fn bent_polygons_are_covered() {
    let ring: Vec<DVec3> = (0..12)
        .map(|i| {
            let t = f64::from(i) / 12.0 * std::f64::consts::TAU;
            let r = if i % 2 == 0 { 1.0 } else { 0.4 };
            DVec3::new(r * libm::cos(t), r * libm::sin(t), 0.05 * libm::cos(3.0 * t))
        })
        .collect();
    let projected = 12.0 * 0.5 * 0.4 * libm::sin(std::f64::consts::TAU / 12.0);
    let (found, notes) = shown(&ring);
    assert!(found >= projected * 0.999 && found < projected * 1.3, "{found}, expected about {projected}");
    assert_eq!(notes, ["material-missing"]);
}

/// Guards against ear clipping that takes the square of the number of corners.
#[test]
fn a_star_of_twenty_thousand_corners_takes_seconds() {
    let corner = |i: u32| {
        let t = f64::from(i) / 20_000.0 * std::f64::consts::TAU;
        let r = if i.is_multiple_of(2) { 100.0 } else { 60.0 };
        [r * libm::cos(t), r * libm::sin(t)]
    };
    let star: Vec<[f64; 2]> = (0..20_000).map(corner).collect();
    let start = Instant::now();
    let (found, notes) = shown(&flat(&star));
    assert!((found / shoelace(&star) - 1.0).abs() < 2e-3, "{found}, expected {}", shoelace(&star));
    assert_eq!(notes, ["material-missing"]);
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    /// Random polygons that do not cross themselves (seen from inside, corner after corner), turned at
    /// random, at sizes from a millimetre to kilometres.
    #[test]
    fn random_polygons_keep_their_area(
        radii in prop::collection::vec(0.05f64..1.0, 3..60),
        axis in (-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0),
        angle in 0.0f64..6.3,
        exponent in -3i32..4,
    ) {
        let size = (0..exponent.abs()).fold(1.0, |s, _| if exponent > 0 { s * 10.0 } else { s / 10.0 });
        let n = radii.len() as f64;
        let list: Vec<[f64; 2]> = radii.iter().enumerate().map(|(i, r)| {
            let t = i as f64 / n * std::f64::consts::TAU;
            [size * r * libm::cos(t), size * r * libm::sin(t)]
        }).collect();
        let axis = DVec3::from(<[f64; 3]>::from(axis)).try_normalize().unwrap_or(DVec3::Y);
        let turn = DQuat::from_axis_angle(axis, angle);
        let turned: Vec<DVec3> = flat(&list).into_iter().map(|p| turn * p).collect();
        let (found, notes) = shown(&turned);
        let expected = shoelace(&list);
        prop_assert!((found / expected - 1.0).abs() < 2e-3, "{} {}", found, expected);
        prop_assert_eq!(notes, ["material-missing"]);
    }
}

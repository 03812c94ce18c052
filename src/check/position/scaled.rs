//! One room at many scales and in many places: N07 and N08.

use glam::{DVec3, Vec3};

use crate::check::surfaces::{ball, cube, lamp, material, mesh, prepared, refused, square};
use crate::check::{Effort, Figure};
use crate::color::Rgb;
use crate::film::Image;
use crate::integrate::{Quiet, RenderOptions, render};
use crate::scene::{Glass, MaterialKind, Mesh, Scene};

/// A closed room of 2 m with balls of glass, of mirror and of light, and lamps of one and of two triangles; moved
/// by `shift` and then scaled.
fn room(scale: f64, shift: DVec3, passes: u32) -> Option<Image> {
    let at = |p: [f64; 3]| (DVec3::from_array(p) + shift) * scale;
    let mut scene = Scene::default();
    let wall = material(&mut scene, MaterialKind::Diffuse { color: Rgb::new(0.7, 0.6, 0.5) });
    let mirror = material(&mut scene, MaterialKind::Mirror { color: Rgb::grey(0.9) });
    let clear = Glass { ior: 1.5, tint: Rgb::WHITE, absorption: None, priority: None };
    let glass = material(&mut scene, MaterialKind::Glass(clear));
    let lights = [5.0, 3.0, 8.0].map(|radiance| material(&mut scene, lamp(radiance)));
    mesh(&mut scene, cube(at([0.0; 3]), 2.0 * scale), wall);
    mesh(&mut scene, square(at([0.1, 0.9, -0.2]), 0.5 * scale, true), lights[0]);
    let triangle = [[-0.9, -0.2, -0.7], [-0.7, -0.2, -0.9], [-0.8, 0.3, -0.8]].map(|p| at(p).as_vec3());
    mesh(&mut scene, one_triangle(triangle), lights[1]);
    ball(&mut scene, at([-0.35, -0.7, -0.3]), 0.3 * scale, glass);
    ball(&mut scene, at([0.4, -0.65, -0.5]), 0.35 * scale, mirror);
    ball(&mut scene, at([0.7, 0.4, -0.6]), 0.1 * scale, lights[2]);
    let scene = prepared(scene, at([0.0, 0.0, 0.95]), None)?;
    let options = RenderOptions { threads: 1, ..RenderOptions::passes(0..passes) };
    render(&scene, &options, &Quiet).ok().map(|o| o.film.to_image())
}

fn one_triangle(v: [Vec3; 3]) -> Mesh {
    Mesh { positions: v.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() }
}

/// N07.
pub(super) fn powers_of_two(_: Effort) -> Vec<Figure> {
    let Some(expected) = room(1.0, DVec3::ZERO, 8) else { return vec![refused("at scale 1")] };
    let scales = [-20, -10, -1, 1, 10, 20];
    let same = |k: &i32| room(libm::exp2(f64::from(*k)), DVec3::ZERO, 8).as_ref() == Some(&expected);
    let different = scales.iter().filter(|k| !same(k)).count();
    vec![
        Figure::exactly(
            "pictures that are not the same bits, lengths times 2^-20, 2^-10, 1/2, 2, 2^10, 2^20",
            different as f64,
            0.0,
        ),
        Figure::at_least("mean radiance of the picture", mean(&expected), 0.1),
    ]
}

fn mean(image: &Image) -> f64 {
    image.rgb.iter().map(|c| f64::from(c.luminance())).sum::<f64>() / image.rgb.len().max(1) as f64
}

/// Side of a tile of N08, pixels.
const TILE: u32 = 8;

/// The sum of luminances and of their variances over the pixels of a tile with sides of `side`.
fn tile(image: &Image, side: u32, x: u32, y: u32) -> (f64, f64) {
    let inside = |i: usize| {
        let i = i as u32;
        (i % image.width) / side == x && (i / image.width) / side == y
    };
    let sum = |pixels: &[Rgb]| -> f64 {
        (0..pixels.len()).filter(|&i| inside(i)).map(|i| f64::from(pixels[i].luminance())).sum()
    };
    (sum(&image.rgb), image.variance.as_deref().map_or(0.0, sum))
}

/// N08. Both pictures are made from the same random numbers, so that only paths which rounding sends elsewhere
/// differ, and the error that is compared with is too large by far.
pub(super) fn anywhere(effort: Effort) -> Vec<Figure> {
    let passes = effort.trials(32).min(1_600) as u32;
    // The table has 0.1 %. Far away the paths that rounding sends elsewhere are many, and their noise at few samples
    // is more than that.
    let bound = if effort == Effort::Nightly { 1e-3 } else { 1e-2 };
    let Some(expected) = room(1.0, DVec3::ZERO, passes) else { return vec![refused("at scale 1")] };
    let far = DVec3::new(1e3, -5e2, 250.0);
    let mut figures = Vec::new();
    for (what, scale, shift) in [
        ("lengths times 1e-6", 1e-6, DVec3::ZERO),
        ("lengths times 1e6", 1e6, DVec3::ZERO),
        ("(1000, -500, 250) times its half size away", 1.0, far),
        ("the same, and lengths times 1e-6", 1e-6, far),
        ("the same, and lengths times 1e6", 1e6, far),
    ] {
        let Some(image) = room(scale, shift, passes) else {
            figures.push(refused(what));
            continue;
        };
        let relative = (mean(&image) / mean(&expected) - 1.0).abs();
        let whole = expected.width.max(expected.height);
        let z = |side: u32, x: u32, y: u32| {
            let (a, b) = (tile(&image, side, x, y), tile(&expected, side, x, y));
            (a.0 - b.0).abs() / (a.1 + b.1).sqrt().max(1e-6 * b.0)
        };
        figures.push(Figure::at_most(format!("relative difference of the means, {what}"), relative, bound));
        figures.push(Figure::at_most(format!("|z| of the mean, {what}"), z(whole, 0, 0), 4.5));
        let mut worst = 0.0f64;
        for y in 0..image.height / TILE {
            for x in 0..image.width / TILE {
                worst = worst.max(z(TILE, x, y));
            }
        }
        figures.push(Figure::at_most(format!("largest |z| of 16 tiles, {what}"), worst, 4.5));
    }
    figures
}

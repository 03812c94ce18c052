//! The same bits, however a render is done.

use std::ops::Range;

use glam::{DAffine3, DVec3};

use crate::check::stage::{camera, cuboid, diffuse, emitter, glass, prepared, quad, sphere};
use crate::check::{Effort, Figure};
use crate::color::Rgb;
use crate::film::Film;
use crate::integrate::{Quiet, RenderOptions, render};
use crate::prepare::Prepared;
use crate::scene::{Lens, MaterialKind, Scene};

/// A room with a lamp, a mirror, a glass ball and a box, seen through a lens.
fn room() -> Scene {
    let mut scene = Scene::default();
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    quad(&mut scene, DVec3::new(0.0, -1.0, 0.0), 2.0 * z, 2.0 * x, diffuse(0.7));
    quad(&mut scene, DVec3::new(0.0, 1.0, 0.0), 2.0 * x, 2.0 * z, diffuse(0.7));
    quad(&mut scene, DVec3::new(0.0, 0.0, -1.0), 2.0 * x, 2.0 * y, diffuse(0.7));
    let red = MaterialKind::Diffuse { color: Rgb::new(0.6, 0.1, 0.1) };
    quad(&mut scene, DVec3::new(-1.0, 0.0, 0.0), 2.0 * y, 2.0 * z, red);
    let mirror = MaterialKind::Mirror { color: Rgb::grey(0.9) };
    quad(&mut scene, DVec3::new(1.0, 0.0, 0.0), 2.0 * z, 2.0 * y, mirror);
    quad(&mut scene, DVec3::new(0.0, 0.99, 0.0), 0.5 * x, 0.5 * z, emitter(8.0));
    sphere(&mut scene, DVec3::new(0.4, -0.6, 0.2), 0.4, glass(1.5));
    cuboid(&mut scene, DVec3::new(-0.7, -1.0, -0.6), DVec3::new(-0.2, 0.1, -0.1), diffuse(0.5));
    let lens = Some(Lens { radius: 0.05, focus_distance: 3.0 });
    scene.cameras.push(camera(DAffine3::from_translation(3.4 * z), 40.0, lens));
    scene
}

fn film(scene: &Prepared, passes: Range<u32>, threads: usize) -> Option<Film> {
    let options = RenderOptions { threads, features: true, layers: true, ..RenderOptions::passes(passes) };
    render(scene, &options, &Quiet).ok().map(|outcome| outcome.film)
}

pub(super) fn same_bits(_: Effort) -> Vec<Figure> {
    const PASSES: u32 = 12;
    let scene = prepared(room(), "N67", [72, 50]);
    let film = |passes, threads| scene.as_ref().and_then(|scene| film(scene, passes, threads));
    let reference = film(0..PASSES, 1);
    let differs = |film: Option<Film>| f64::from(u8::from(film.is_none() || film != reference));
    let mut figures: Vec<Figure> = [1, 2, 3, 8]
        .into_iter()
        .map(|threads| {
            let what = format!("films of {threads} threads that differ from that of one, of 1");
            Figure::exactly(what, differs(film(0..PASSES, threads)), 0.0)
        })
        .collect();
    // Two ranges, in either order, and one pass at a time, in reverse.
    for ranges in
        [vec![0..5, 5..PASSES], vec![5..PASSES, 0..5], (0..PASSES).rev().map(|p| p..p + 1).collect()]
    {
        let parts = ranges.len();
        let merged = ranges.into_iter().map(|range| film(range, 2)).reduce(|whole, part| {
            let mut whole = whole?;
            whole.merge(part?).ok()?;
            Some(whole)
        });
        let what = format!("films merged of {parts} ranges of passes that differ from the whole, of 1");
        figures.push(Figure::exactly(what, differs(merged.flatten()), 0.0));
    }
    let samples = |film: &Film| film.to_image().count.iter().flatten().map(|&n| f64::from(n)).sum::<f64>();
    let taken = reference.as_ref().map_or(f64::NAN, samples);
    figures.push(Figure::exactly("samples of the film", taken, f64::from(72 * 50 * PASSES)));
    figures
}

//! Very dark and very bright scenes.

use glam::{DAffine3, DVec3, Vec3};

use crate::check::stage::{camera, diffuse, emitter, picture, quad, sphere};
use crate::check::{Effort, Figure};
use crate::color::Rgb;
use crate::film::Image;
use crate::output::{self, Format, WriteOptions};
use crate::scene::{Scene, validate};
use crate::shape::{Ray, sphere as shape, triangle};

/// An emitting sphere between two surfaces of reflectance `rho`, on the right of a camera.
fn scene(le: f32, rho: f32) -> Scene {
    let mut scene = Scene::default();
    sphere(&mut scene, DVec3::new(1.0, 0.0, -4.0), 0.7, emitter(le));
    quad(&mut scene, DVec3::new(0.0, -1.0, -4.0), 4.0 * DVec3::Z, 6.0 * DVec3::X, diffuse(rho));
    sphere(&mut scene, DVec3::new(-1.0, 0.0, -4.0), 0.7, diffuse(rho));
    scene.cameras.push(camera(DAffine3::IDENTITY, 60.0, None));
    scene
}

/// Pixels that are not finite or negative, samples refused, and the relative error of the brightest pixel.
fn figures(what: &str, seen: Option<&(Image, u64)>, le: f32) -> Vec<Figure> {
    let (bad, refused, off) = seen.map_or((f64::NAN, f64::NAN, f64::NAN), |(image, refused)| {
        let bad = image.rgb.iter().filter(|c| !(c.is_finite() && c.min_channel() >= 0.0)).count();
        let brightest = image.rgb.iter().map(|c| c.max_channel()).fold(0.0, f32::max);
        (bad as f64, *refused as f64, (f64::from(brightest) / f64::from(le) - 1.0).abs())
    });
    vec![
        Figure::exactly(format!("{what}: pixels that are not finite, or negative"), bad, 0.0),
        Figure::exactly(format!("{what}: samples refused"), refused, 0.0),
        // Whole pixels see the emitter, and nothing is brighter than it.
        Figure::at_most(format!("{what}: relative error of the emitter itself"), off, 1e-6),
    ]
}

/// Whether processors flush denormals to zero cannot be set without unsafe code, so it is not varied; and no
/// clock is read, so that this case says nothing about how slow denormals are.
pub(super) fn denormal(_: Effort) -> Vec<Figure> {
    let mut all = Vec::new();
    for (le, rho) in [(1e-38, 0.5), (1e-38, 1e-39), (1.0, 1e-39), (1e-44f32, 1.0f32)] {
        let seen = picture(scene(le, rho), "N65", [48, 32], 16);
        all.extend(figures(&format!("radiance {le:e}, reflectance {rho:e}"), seen.as_ref(), le));
    }
    // Distances that no scene can have: whatever is found is a distance.
    let mut wrong = 0u32;
    let mut check = |t: Option<f32>| wrong += u32::from(t.is_some_and(|t| !(t > 0.0 && t.is_finite())));
    for h in [1e-36, 1e-40, 1e-44, f32::from_bits(1)] {
        for d in [Vec3::NEG_Z, Vec3::new(0.6, 0.0, -0.8), Vec3::new(h, h, -1.0), Vec3::new(1.0, 0.0, -h)] {
            let ray = Ray::new(Vec3::new(0.0, 0.0, h), d);
            for size in [1.0, h] {
                let (a, b) = (Vec3::new(-size, -size, 0.0), Vec3::new(size, -size, 0.0));
                let hit = triangle::Shear::new(&ray).intersect(a, b, Vec3::new(0.0, size, 0.0));
                check(hit.map(|hit| hit.t));
                check(shape::first_hit(&ray, Vec3::ZERO, size, false));
                check(shape::first_hit(&ray, Vec3::new(0.0, 0.0, -size), size, false));
            }
        }
    }
    all.push(Figure::exactly("hits at denormal distances that are no distance", f64::from(wrong), 0.0));
    all
}

pub(super) fn bright(_: Effort) -> Vec<Figure> {
    let mut all = Vec::new();
    for le in [1e20, 1e30f32] {
        let seen = picture(scene(le, 0.8), "N66", [48, 32], 16);
        all.extend(figures(&format!("radiance {le:e}"), seen.as_ref(), le));
        // Files hold single precision or a shared exponent; pictures for a screen are white at most.
        for format in Format::ALL {
            let written = seen.as_ref().map_or(f64::NAN, |(image, _)| {
                let bytes = output::encode(image, format, &WriteOptions::default());
                let read = bytes.and_then(|bytes| output::decode(&bytes));
                let bad = |image: Image| image.rgb.iter().filter(|c| !c.is_finite()).count() as f64;
                read.map_or(f64::NAN, bad)
            });
            let what = format!("radiance {le:e}: pixels of a .{} that are not finite", format.suffix());
            all.push(Figure::exactly(what, written, 0.0));
        }
    }
    // Radiance only scales a picture: by a power of two, to the last bit.
    let one = picture(scene(1.0, 0.8), "N66", [48, 32], 16);
    for exponent in [-90, 90] {
        let scale = f32::from_bits(((127i32 + exponent) as u32) << 23);
        let other = picture(scene(scale, 0.8), "N66", [48, 32], 16);
        let differ = one.as_ref().zip(other.as_ref()).map_or(f64::NAN, |((one, _), (other, _))| {
            let pairs = one.rgb.iter().zip(&other.rgb);
            pairs.filter(|&(&a, &b)| a * scale != b).count() as f64
        });
        let what =
            format!("pixels at a radiance of 2^{exponent} that are not 2^{exponent} times those at one");
        all.push(Figure::exactly(what, differ, 0.0));
    }
    let taken = |le: f32| f64::from(u8::from(validate(&mut scene(le, 0.8)).is_ok()));
    let taken_of = |les: &[f32]| les.iter().map(|&le| taken(le)).sum::<f64>();
    let above = [1.0001e30, 3e38, f32::INFINITY, f32::NAN, -1.0];
    all.push(Figure::exactly(
        "scenes taken with a radiance above 1e30, or that is none",
        taken_of(&above),
        0.0,
    ));
    let channel = {
        let mut one = scene(1.0, 0.8);
        one.environment = Some(crate::check::stage::sky(0.0));
        if let Some(sky) = &mut one.environment {
            sky.radiance = Rgb::new(0.0, 2e30, 0.0);
        }
        f64::from(u8::from(validate(&mut one).is_ok()))
    };
    all.push(Figure::exactly("scenes taken with one channel of the sky above 1e30", channel, 0.0));
    all
}

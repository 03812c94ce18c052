//! Hard cases about cameras, and about the transforms that place things.

mod transforms;

use glam::{DAffine3, DMat3, DVec3, Vec2};

use super::random::Random;
use super::stage::{U, camera, emitter, facing, larger, picture, prepared, quad, sum_agrees, weighted};
use super::{Case, Class, Effort, Figure};
use crate::accel::{PrimitiveId, RayKind};
use crate::film::Image;
use crate::prepare::CameraRays;
use crate::sampling::warp::square_to_disk;
use crate::scene::{Camera, FovAxis, Lens, Projection, Scene};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N71",
        class: Class::Statistical,
        guards: "Rays go where the picture says: from a thousandth of a degree to 170, and a thousand kilometres far.",
        run: rays,
    },
    Case {
        id: "N72",
        class: Class::Statistical,
        guards: "A lens blurs what is out of focus by the thin lens's circle, and neither adds nor takes light.",
        run: lens,
    },
    Case {
        id: "N74",
        class: Class::Unit,
        guards: "Scaled, mirrored, sheared and deeply nested transforms put things where their product says, \
                 with the front outside.",
        run: transforms::run,
    },
];

/// The direction of a point of the picture, in `f64`: `at` counts from its middle, in halves of its sides.
fn exact(camera: &Camera, size: [u32; 2], at: [f64; 2]) -> DVec3 {
    let Projection::Perspective { fov, axis } = camera.projection else { return DVec3::NAN };
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let half = libm::tan(0.5 * fov);
    let [x, y] = match axis {
        FovAxis::Horizontal => [half, half / aspect],
        FovAxis::Vertical => [half * aspect, half],
    };
    (camera.transform.matrix3 * DVec3::new(at[0] * x, at[1] * y, -1.0)).normalize()
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b))
}

fn rays(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N71");
    let trials = effort.trials(40_000);
    let (mut off, mut edge, mut rays) = (0.0f64, 0.0f64, 0u64);
    for degrees in [1e-3, 0.1, 10.0, 40.0, 90.0, 170.0] {
        for (size, axis) in [
            ([640, 480], FovAxis::Horizontal),
            ([1920, 1080], FovAxis::Vertical),
            ([300, 4000], FovAxis::Vertical),
        ] {
            let z = random.direction().as_dvec3().normalize();
            let mut one = camera(facing(DVec3::new(1e6, -3e5, 2e5), z), degrees, None);
            one.projection = Projection::Perspective { fov: degrees.to_radians(), axis };
            let made = CameraRays::new(&one, size);
            for _ in 0..trials / 10 {
                let pixel = size.map(|n| (random.unit() * f64::from(n)) as u32);
                let offset = [random.unit_f32(), random.unit_f32()];
                let ray = made.ray(pixel, offset, || Vec2::ZERO);
                let at =
                    |i: usize| 2.0 * (f64::from(pixel[i]) + f64::from(offset[i])) / f64::from(size[i]) - 1.0;
                off = larger(off, angle(ray.d.as_dvec3(), exact(&one, size, [at(0), -at(1)])));
                rays += 1;
            }
            // Straight ahead small components keep all their digits, so that small angles do.
            one.transform = DAffine3::IDENTITY;
            let made = CameraRays::new(&one, size);
            let (pixel, expected) = match axis {
                FovAxis::Horizontal => ([0, size[1] / 2], 0.5 * degrees.to_radians()),
                FovAxis::Vertical => ([size[0] / 2, 0], 0.5 * degrees.to_radians()),
            };
            let ray = made.ray(pixel, [0.0; 2], || Vec2::ZERO);
            edge = larger(edge, (angle(ray.d.as_dvec3(), DVec3::NEG_Z) / expected - 1.0).abs());
        }
    }
    let what = format!("{rays} rays of 0.001 to 170 degrees");
    let mut figures = vec![
        Figure::at_most(format!("{what}: angle to the exact direction, rad"), off, 2.0 * U),
        Figure::at_most("relative error of the angle at the edge of the picture", edge, 4.0 * U),
    ];
    figures.push(far_hits(&mut random, trials));
    // O18: a unit square at distance six, and one of ten metres from a thousand kilometres.
    figures.extend(coverage("O18", 1.0, 6.0, 40.0, Some(0.052_421_057), effort));
    figures.extend(coverage("far", 10.0, 1e6, 1e-3, None, effort));
    figures
}

/// Where rays from a thousand kilometres meet a wall of a hundred metres.
fn far_hits(random: &mut Random, trials: u64) -> Figure {
    let distance = 1e6;
    let mut scene = Scene::default();
    quad(&mut scene, DVec3::ZERO, 100.0 * DVec3::X, 100.0 * DVec3::Y, emitter(1.0));
    let one = camera(DAffine3::from_translation(distance * DVec3::Z), 5e-3, None);
    scene.cameras.push(one.clone());
    let (mut off, size) = (f64::NAN, [512, 512]);
    if let Some(scene) = prepared(scene, "N71", size) {
        off = 0.0;
        for _ in 0..trials {
            let pixel = size.map(|n| (random.unit() * f64::from(n)) as u32);
            let offset = [random.unit_f32(), random.unit_f32()];
            let ray = scene.camera.ray(pixel, offset, || Vec2::ZERO);
            let at = |i: usize| 2.0 * (f64::from(pixel[i]) + f64::from(offset[i])) / f64::from(size[i]) - 1.0;
            let d = exact(&one, size, [at(0), -at(1)]);
            let expected = d * (distance / -d.z);
            let hit = scene.accel.closest(&ray, PrimitiveId::NONE, RayKind::Camera);
            off = larger(
                off,
                hit.map_or(f64::NAN, |hit| {
                    let p = scene.surface(&ray, &hit, false).p.as_dvec3();
                    (p.truncate() - expected.truncate()).length()
                }),
            );
        }
    }
    // The picture shows 87 metres, a pixel 0.17 of them. Small components of a direction keep 24 bits of their
    // own, so that what is left is rounding of coordinates of up to a hundred metres.
    Figure::at_most(format!("{trials} hits a thousand kilometres away: error, metres"), off, 32.0 * U * 100.0)
}

/// The share of a picture that a square of side `side` at `distance` covers.
fn coverage(
    what: &str,
    side: f64,
    distance: f64,
    degrees: f64,
    listed: Option<f64>,
    effort: Effort,
) -> Vec<Figure> {
    let pixels = 256u32;
    let passes = effort.trials(16);
    let mut scene = Scene::default();
    quad(&mut scene, DVec3::ZERO, side * DVec3::X, side * DVec3::Y, emitter(1.0));
    // Turned about the view axis, so that edges cross pixels.
    let (s, c) = libm::sincos(0.3);
    let turn = DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z);
    let at = DAffine3::from_mat3_translation(turn, distance * DVec3::Z);
    scene.cameras.push(camera(at, degrees, None));
    let share = side / (2.0 * distance * libm::tan(0.5 * degrees.to_radians()));
    let expected = share * share;
    let image = picture(scene, "N71", [pixels; 2], passes);
    let count = f64::from(pixels * pixels);
    let sum = image.map_or((f64::NAN, f64::NAN), |(image, _)| weighted(&image, |_, _| 1.0 / count));
    let samples = u64::from(pixels * pixels) * passes;
    let mut figures = sum_agrees(&format!("coverage, {what}"), samples, sum, (expected, 1e-3));
    if let Some(listed) = listed {
        let what = format!("coverage, {what}: closed form against the list");
        figures.push(Figure::at_most(what, (expected - listed).abs(), 6e-10));
    }
    figures
}

/// Aperture, focus and object of O19: half of the aperture's radius is left at the plane in focus.
const APERTURE: f64 = 0.05;
const FOCUS: f64 = 2.0;
const OBJECT: f64 = 4.0;

fn lens(effort: Effort) -> Vec<Figure> {
    let mut figures = rays_of_a_lens(effort);
    // Pictures of a small square, with and without the lens.
    let (side, passes, degrees, width) = (128u32, effort.trials(256), 5.0, 0.04);
    let samples = u64::from(side * side) * passes;
    let seen = |lens: Option<Lens>| -> Option<Image> {
        let mut scene = Scene::default();
        quad(&mut scene, DVec3::ZERO, width * DVec3::X, width * DVec3::Y, emitter(1.0));
        scene.cameras.push(camera(DAffine3::from_translation(OBJECT * DVec3::Z), degrees, lens));
        picture(scene, "N72", [side; 2], passes).map(|(image, _)| image)
    };
    // Widths in pixels of the picture.
    let pixel = 2.0 * libm::tan(0.5 * degrees.to_radians()) / f64::from(side);
    let square = width / OBJECT / pixel;
    let blur = 0.025 / FOCUS / pixel;
    let area = square * square;
    let none = (f64::NAN, f64::NAN);
    let blurred = seen(Some(Lens { radius: APERTURE, focus_distance: FOCUS }));
    for (what, image) in [("in focus", &seen(None)), ("out of focus", &blurred)] {
        let sum = image.as_ref().map_or(none, |image| weighted(image, |_, _| 1.0));
        figures.extend(sum_agrees(&format!("light of a square {what}"), samples, sum, (area, 0.01)));
    }
    // The blurred square is its outline convolved with the circle: their second moments add up, to w^2 / 6
    // and r^2 / 2; sorting into pixels adds 1/12 for each axis (Sheppard's correction).
    let moment = blurred.as_ref().map_or(none, |image| weighted(image, |x, y| (x * x + y * y) / area));
    let square_of_radius = (2.0 * (moment.0 - area / 6.0 - 1.0 / 6.0), 4.0 * moment.1);
    // One per cent of the square is half a per cent of the radius.
    let what = "square of the radius of the blur (O19)";
    figures.extend(sum_agrees(what, samples, square_of_radius, (blur * blur, 0.01)));
    figures
}

/// Where the rays of a lens go, one by one.
fn rays_of_a_lens(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N72");
    let trials = effort.trials(100_000);
    let size = [64, 48];
    let z = random.direction().as_dvec3().normalize();
    let at = facing(DVec3::new(3.0, -2.0, 5.0), z);
    let to_camera = at.inverse();
    let focus = |radius, focus_distance| Some(Lens { radius, focus_distance });
    let made = |lens| CameraRays::new(&camera(at, 40.0, lens), size);
    let (pinhole, thin) = (made(None), made(focus(APERTURE, FOCUS)));
    let closed = [0.7, 2.0, 13.3].map(|distance| made(focus(0.0, distance)));
    let (mut differ, mut unfocused, mut largest, mut squares) = (0u64, 0.0f64, 0.0f64, 0.0f64);
    for i in 0..trials {
        let pixel = size.map(|n| (random.unit() * f64::from(n)) as u32);
        let offset = [random.unit_f32(), random.unit_f32()];
        let on_lens = square_to_disk([random.unit_f32(), random.unit_f32()]);
        let through = |rays: &CameraRays| rays.ray(pixel, offset, || on_lens);
        let straight = through(&pinhole);
        let same = through(&closed[i as usize % closed.len()]);
        differ += u64::from(same.o != straight.o || same.d != straight.d);
        // Where two rays pass planes in front of the camera.
        let blurred = through(&thin);
        let passes = |ray: &crate::shape::Ray, depth: f64| {
            let o = to_camera.transform_point3(ray.o.as_dvec3());
            let d = to_camera.transform_vector3(ray.d.as_dvec3());
            o + d * ((-depth - o.z) / d.z)
        };
        unfocused = larger(unfocused, (passes(&blurred, FOCUS) - passes(&straight, FOCUS)).length());
        // The circle as it lies in the plane that is in focus.
        let off = (passes(&blurred, OBJECT) - passes(&straight, OBJECT)).length() * FOCUS / OBJECT;
        largest = larger(largest, off);
        squares += off * off;
    }
    let mean = squares / trials as f64;
    let what = format!("{trials} rays of a lens");
    vec![
        Figure::exactly(format!("{what}: of aperture zero that differ from a pinhole's"), differ as f64, 0.0),
        // Origins keep 24 bits of five metres.
        Figure::at_most(
            format!("{what}: distance from the point in focus, metres"),
            unfocused,
            16.0 * U * 5.0,
        ),
        Figure::at_most(
            format!("{what}: relative error of the blur's radius, .025 (O19)"),
            (largest / 0.025 - 1.0).abs(),
            5e-3,
        ),
        // A uniform disk: the mean square of the radius is half its square, with a deviation of 1 / sqrt(3 n).
        Figure::at_most(
            format!("{what}: |z| of the mean square of the distance"),
            (2.0 * mean / (0.025 * 0.025) - 1.0).abs() * (3.0 * trials as f64).sqrt(),
            4.5,
        ),
    ]
}

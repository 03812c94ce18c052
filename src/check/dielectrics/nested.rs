//! Bodies in contact with each other, within each other, and around the camera.

use glam::{DAffine3, DQuat, DVec3};

use crate::check::closed_forms::{fresnel, layers_transmittance, slab_transmittance};
use crate::check::stage::{Stage, body, cuboid, emitter, glass, object, quad, sphere};
use crate::check::{Effort, Figure};
use crate::color::Rgb;
use crate::scene::{Absorption, MaterialKind, Scene, Shape};

/// Half the width of slabs with interreflections, metres.
const WIDE: f64 = 50.0;
/// And of those that are passed straight. Where a ray goes on is known to a millionth of the coordinates, and
/// so is what is absorbed.
const NARROW: f64 = 1.0;

/// Layers one above the other, each from a height to another, over something that emits one.
fn layers(slabs: &[(f64, f64, MaterialKind)], side: f64, turned: Option<DAffine3>) -> Scene {
    let mut scene = Scene::default();
    for (low, high, kind) in slabs {
        cuboid(&mut scene, DVec3::new(-side, -side, *low), DVec3::new(side, side, *high), kind.clone());
    }
    quad(&mut scene, DVec3::new(0.0, 0.0, -4.0), 1e5 * DVec3::X, 1e5 * DVec3::Y, emitter(1.0));
    if let Some(turned) = turned {
        scene.objects.iter_mut().for_each(|o| o.transform = turned);
    }
    scene
}

/// A ray down at an angle, degrees, to a point on top of everything.
fn down(degrees: f64, turned: Option<DAffine3>) -> [DVec3; 2] {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let d = DVec3::new(sin, 0.0, -cos);
    let ray = [DVec3::new(0.13, 0.21, 3.0) - d, d];
    let Some(turned) = turned else { return ray };
    [turned.transform_point3(ray[0]), turned.transform_vector3(ray[1])]
}

/// Nothing along the axes, nothing at the origin.
fn askew() -> DAffine3 {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.7).normalize(), 0.83);
    DAffine3::from_rotation_translation(turn, DVec3::new(12.3, -4.56, 78.9))
}

struct Passes<'a> {
    what: &'a str,
    slabs: &'a [(f64, f64, MaterialKind)],
    side: f64,
    turned: Option<DAffine3>,
}

impl Passes<'_> {
    fn agrees(&self, degrees: f64, expected: f64, effort: Effort) -> Vec<Figure> {
        let ray = down(degrees, self.turned);
        let stage = Stage::seen_from(ray[0], layers(self.slabs, self.side, self.turned), self.what);
        let what = format!("{} at {degrees} degrees", self.what);
        stage.agrees(&what, ray, (expected, 3e-3), (effort, 1 << 13))
    }
}

pub(super) fn slabs(effort: Effort) -> Vec<Figure> {
    let one = |p: u8| body(1.5, p, None);
    let gap = [(0.0, 1.0, glass(1.5)), (1.0001, 2.0, glass(1.5))];
    let gap_of_bodies = [(0.0, 1.0, one(0)), (1.0001, 2.0, one(0))];
    let contact = [(0.0, 1.0, one(0)), (1.0, 2.0, one(0))];
    let higher = [(0.0, 1.0, one(7)), (1.0, 2.0, one(200))];
    let overlap = [(0.0, 1.1, one(3)), (0.9, 2.0, one(2))];
    let merged = [(0.0, 2.0, glass(1.5))];
    let cases: [(&str, &[_], Option<DAffine3>, f64); 8] = [
        ("two slabs with a gap of 1e-4", &gap, None, 2.0),
        ("two bodies with a gap of 1e-4", &gap_of_bodies, None, 2.0),
        ("two bodies in contact", &contact, None, 1.0),
        ("two bodies in contact, askew", &contact, Some(askew()), 1.0),
        ("two bodies of different priorities in contact, askew", &higher, Some(askew()), 1.0),
        ("two bodies that overlap", &overlap, None, 1.0),
        ("two bodies that overlap, askew", &overlap, Some(askew()), 1.0),
        ("one slab", &merged, None, 1.0),
    ];
    let mut figures = Vec::new();
    for (what, slabs, turned, plates) in cases {
        for degrees in [0.0, 50.0] {
            let expected = slab_transmittance(f64::to_radians(degrees), 1.5, plates);
            figures.extend(Passes { what, slabs, side: WIDE, turned }.agrees(degrees, expected, effort));
        }
    }
    figures
}

pub(super) fn water_in_glass(effort: Effort) -> Vec<Figure> {
    const GLASS: f32 = 1.5;
    const WATER: f32 = 1.33;
    let glass_body = || body(GLASS, 2, None);
    let water = || body(WATER, 1, None);
    let contact = [(0.0, 1.0, glass_body()), (1.0, 2.0, water()), (2.0, 3.0, glass_body())];
    // A hundredth of its thickness into the glass on either side.
    let overlap = [(0.0, 1.0, glass_body()), (0.99, 2.01, water()), (2.0, 3.0, glass_body())];
    // The water is there where both are.
    let displaced = [
        (0.0, 1.0, body(GLASS, 1, None)),
        (0.99, 2.01, body(WATER, 2, None)),
        (2.0, 3.0, body(GLASS, 1, None)),
    ];
    let gaps = [(0.0, 1.0, glass(GLASS)), (1.0001, 1.9999, glass(WATER)), (2.0, 3.0, glass(GLASS))];
    let (g, w) = (f64::from(GLASS), f64::from(WATER));
    let together: &[f64] = &[g, w, g];
    let cases: [(&str, &[_], Option<DAffine3>, &[f64]); 6] = [
        ("water in contact with glass", &contact, None, together),
        ("water in contact with glass, askew", &contact, Some(askew()), together),
        ("water that overlaps glass", &overlap, None, together),
        ("water that overlaps glass, askew", &overlap, Some(askew()), together),
        ("water that displaces glass", &displaced, None, together),
        ("water with a gap to glass", &gaps, None, &[g, 1.0, w, 1.0, g]),
    ];
    let mut figures = Vec::new();
    for (what, slabs, turned, indices) in cases {
        for degrees in [0.0, 60.0] {
            let expected = layers_transmittance(f64::to_radians(degrees), indices);
            figures.extend(Passes { what, slabs, side: WIDE, turned }.agrees(degrees, expected, effort));
        }
    }
    // Index one, so that nothing but absorption shows: a tenth of the dye is displaced by glass.
    let dye = Absorption { color: Rgb::grey(0.25), distance: 1.0 };
    let dyed = [(0.0, 1.0, body(1.0, 2, None)), (0.9, 2.0, body(1.0, 1, Some(dye)))];
    let what = "dye that overlaps glass";
    figures.extend(Passes { what, slabs: &dyed, side: NARROW, turned: None }.agrees(0.0, 0.25, effort));
    let dyed = [(0.0, 1.0, body(1.0, 1, None)), (0.9, 2.0, body(1.0, 2, Some(dye)))];
    let expected = libm::pow(0.25, 1.1);
    let what = "dye that displaces glass";
    figures.extend(Passes { what, slabs: &dyed, side: NARROW, turned: None }.agrees(0.0, expected, effort));
    figures
}

/// What a camera sees from within: absorption from the first metre on, and the bodies that it is in.
pub(super) fn around_the_camera(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    let mut see = |what: &str, scene: Scene, eye: DVec3, expected: f64| {
        let stage = Stage::seen_from(eye, scene, what);
        figures.extend(stage.agrees(what, [eye, DVec3::Z], (expected, 3e-3), (effort, 1 << 10)));
    };
    let dye = Some(Absorption { color: Rgb::grey(0.5), distance: 1.0 });
    let dyed = |priority: Option<u8>| match body(1.0, 0, dye) {
        MaterialKind::Glass(g) => MaterialKind::Glass(crate::scene::Glass { priority, ..g }),
        other => other,
    };
    let eye = DVec3::new(0.1, -0.2, 0.3);
    for (what, priority) in [("dye", None), ("a body of dye", Some(3))] {
        // An emitter two metres ahead, in the same medium.
        let scene = |within: fn(&mut Scene, MaterialKind)| {
            let mut scene = Scene::default();
            within(&mut scene, dyed(priority));
            quad(&mut scene, DVec3::new(0.0, 0.0, 2.3), DVec3::Y, DVec3::X, emitter(1.0));
            scene
        };
        see(&format!("from a ball of {what}"), scene(|s, kind| sphere(s, DVec3::ZERO, 5.0, kind)), eye, 0.25);
        let boxed = scene(|s, kind| cuboid(s, DVec3::splat(-5.0), DVec3::splat(5.0), kind));
        see(&format!("from a box of {what}"), boxed, eye, 0.25);
        let mirrored = scene(|s, kind| {
            let turned = DAffine3::from_scale(DVec3::new(1.0, -2.0, 1.0));
            cuboid(s, DVec3::splat(-5.0), DVec3::splat(5.0), kind);
            s.objects[0].transform = turned;
        });
        see(&format!("from a mirrored box of {what}"), mirrored, eye, 0.25);
        // Air around the camera, in dye: one of the two metres.
        let bubble = scene(|s, kind| {
            sphere(s, DVec3::ZERO, 5.0, kind.clone());
            let air = match &kind {
                MaterialKind::Glass(g) if g.priority.is_some() => body(1.0, 9, None),
                _ => glass(1.0),
            };
            object(
                s,
                Shape::Sphere { radius: 1.0 },
                DAffine3::from_translation(DVec3::new(0.1, -0.2, 0.3)),
                air,
            );
        });
        // A surface without a priority leads into nothing: what is behind it absorbs only under an order.
        let expected = if priority.is_some() { 0.5 } else { 1.0 };
        see(&format!("from a bubble in {what}"), bubble, eye, expected);
        let mut outside = Scene::default();
        sphere(&mut outside, DVec3::new(9.0, 0.0, 0.0), 5.0, dyed(priority));
        quad(&mut outside, DVec3::new(0.0, 0.0, 2.3), DVec3::Y, DVec3::X, emitter(1.0));
        see(&format!("beside a ball of {what}"), outside, eye, 1.0);
    }
    // Under water, over the bottom of a glass that the water overlaps: an interface of glass against water.
    let mut scene = Scene::default();
    cuboid(&mut scene, DVec3::new(-9.0, -9.0, -9.0), DVec3::new(9.0, 9.0, 2.02), body(1.33, 1, None));
    cuboid(&mut scene, DVec3::new(-9.0, -9.0, 2.0), DVec3::new(9.0, 9.0, 3.0), body(1.5, 2, None));
    quad(&mut scene, DVec3::new(0.0, 0.0, 4.0), 9.0 * DVec3::Y, 9.0 * DVec3::X, emitter(1.0));
    // Radiance in water is n^2 times what it is in air; what the interfaces above send back comes again from
    // the bottom.
    let n = f64::from(1.33f32);
    let above = {
        let [r, s] = [fresnel(0.0, 1.5 / n), fresnel(0.0, 1.5)];
        1.0 / (1.0 + r / (1.0 - r) + s / (1.0 - s))
    };
    let expected = n * n * above / (1.0 - (1.0 - above) * fresnel(0.0, n));
    see("from water, through glass that it overlaps", scene, eye, expected);
    figures
}

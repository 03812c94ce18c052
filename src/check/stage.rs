//! Small scenes, single rays into them, and pictures of them.
//!
//! A scene that is refused is seen as NaN, which no bound holds: nothing here panics, and nothing passes
//! because it was not measured.

use glam::{DAffine3, DMat3, DVec3};

use super::{Effort, Figure};
use crate::color::Rgb;
use crate::film::Image;
use crate::integrate::{Counters, Kernel, Quiet, RenderOptions, kernel, render};
use crate::prepare::{Algorithms, EffectsMode, Options, Prepared, Shortcuts, prepare};
use crate::sampling::Address;
use crate::scene::{
    Absorption, Camera, Environment, FovAxis, Glass, Lens, Material, MaterialId, MaterialKind, Mesh, MeshId,
    Object, Projection, Scene, Shape, Sides, validate,
};
use crate::shape::Ray;
use crate::stats::{Moments, normal_quantile, student_two_sided};

/// Independent sequences of samples along a ray; their means give the error of their mean.
const REPLICATIONS: u32 = 16;
/// Rounding of single precision along a path, relative; statistics do not excuse it, and need not see it.
const ROUNDING: f64 = 4e-6;
/// Largest |z| that passes: two-sided 7e-6.
const Z: f64 = 4.5;

/// Half a unit in the last place of single precision, relative.
pub(super) const U: f64 = 5.960_464_477_539_063e-8;

/// The larger of a figure and the size of another; infinite where that is not a number.
pub(super) fn larger(most: f64, value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { most.max(value.abs()) }
}

pub(super) fn diffuse(rho: f32) -> MaterialKind {
    MaterialKind::Diffuse { color: Rgb::grey(rho) }
}

pub(super) fn emitter(radiance: f32) -> MaterialKind {
    MaterialKind::Light { radiance: Rgb::grey(radiance), sides: Sides::Front }
}

pub(super) fn glass(ior: f32) -> MaterialKind {
    MaterialKind::Glass(Glass { ior, tint: Rgb::WHITE, absorption: None, priority: None })
}

/// Glass that is there where nothing of a higher priority is.
pub(super) fn body(ior: f32, priority: u8, absorption: Option<Absorption>) -> MaterialKind {
    MaterialKind::Glass(Glass { ior, tint: Rgb::WHITE, absorption, priority: Some(priority) })
}

pub(super) fn sky(radiance: f32) -> Environment {
    Environment { name: "sky".into(), radiance: Rgb::grey(radiance), image: None, visible_to_camera: true }
}

/// Places a shape.
pub(super) fn object(scene: &mut Scene, shape: Shape, transform: DAffine3, kind: MaterialKind) {
    let material = MaterialId(scene.materials.len() as u32);
    scene.materials.push(Material { name: format!("material {}", material.0), kind });
    let name = format!("object {}", scene.objects.len());
    scene.objects.push(Object { name, shape, material, transform, visible_to_camera: true });
}

pub(super) fn sphere(scene: &mut Scene, center: DVec3, radius: f64, kind: MaterialKind) {
    object(scene, Shape::Sphere { radius }, DAffine3::from_translation(center), kind);
}

/// A mesh as it stands in the world.
pub(super) fn mesh(scene: &mut Scene, positions: &[DVec3], triangles: &[[u32; 3]], kind: MaterialKind) {
    let id = MeshId(scene.meshes.len() as u32);
    let positions = positions.iter().map(|p| p.as_vec3()).collect();
    scene.meshes.push(Mesh { positions, triangles: triangles.to_vec(), ..Mesh::default() });
    object(scene, Shape::Mesh(id), DAffine3::IDENTITY, kind);
}

/// A parallelogram whose front is where `u` x `v` points.
pub(super) fn quad(scene: &mut Scene, center: DVec3, u: DVec3, v: DVec3, kind: MaterialKind) {
    let corners = [-u - v, u - v, u + v, v - u].map(|c| center + 0.5 * c);
    mesh(scene, &corners, &[[0, 1, 2], [0, 2, 3]], kind);
}

/// A box along the axes, front outside.
pub(super) fn cuboid(scene: &mut Scene, low: DVec3, high: DVec3, kind: MaterialKind) {
    let pick = |i: usize, axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
    let corners: [DVec3; 8] = std::array::from_fn(|i| DVec3::new(pick(i, 0), pick(i, 1), pick(i, 2)));
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<_> = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh(scene, &corners, &triangles, kind);
}

/// A rotation whose local +Z is the unit vector `z`, at `position`.
pub(super) fn facing(position: DVec3, z: DVec3) -> DAffine3 {
    let x = z.any_orthonormal_vector();
    DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), position)
}

/// A camera that looks along its own -Z.
pub(super) fn camera(transform: DAffine3, degrees: f64, lens: Option<Lens>) -> Camera {
    let projection = Projection::Perspective { fov: degrees.to_radians(), axis: FovAxis::Horizontal };
    Camera { name: "camera".into(), transform, projection, shift: [0.0; 2], lens, aspect: None }
}

/// A seed that nobody picks.
pub(super) fn seed(id: &str) -> u64 {
    super::random::Random::of(id).bits()
}

/// Validates and prepares a scene; one without a camera gets one.
pub(super) fn prepared(mut scene: Scene, id: &str, size: [u32; 2]) -> Option<Prepared> {
    validate(&mut scene).ok()?;
    if scene.cameras.is_empty() {
        scene.cameras.push(camera(DAffine3::IDENTITY, 40.0, None));
    }
    let effects = EffectsMode::Auto;
    let options = Options {
        camera: None,
        size,
        seed: seed(id),
        effects,
        max_depth: None,
        shortcuts: Shortcuts::default(),
        transparent: false,
        algorithms: Algorithms::PATHS,
    };
    prepare(&scene, &options).ok()
}

/// A picture of the scene's first camera, and how many of its samples the film refused.
pub(super) fn picture(scene: Scene, id: &str, size: [u32; 2], passes: u64) -> Option<(Image, u64)> {
    let passes = u32::try_from(passes).unwrap_or(u32::MAX);
    let outcome = render(&prepared(scene, id, size)?, &RenderOptions::passes(0..passes), &Quiet).ok()?;
    Some((outcome.film.to_image(), outcome.film.refused_total()))
}

/// The sum of weight times green over the pixels of a picture, and the variance of that sum. `weight` is
/// given the middle of a pixel from the middle of the picture, in pixels, up and to the right.
pub(super) fn weighted(image: &Image, weight: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    let (mut sum, mut variance) = (0.0, 0.0);
    let variances = image.variance.as_deref().unwrap_or_default();
    for (i, (c, v)) in image.rgb.iter().zip(variances).enumerate() {
        let (column, row) = (i as u32 % image.width, i as u32 / image.width);
        let x = f64::from(column) + 0.5 - 0.5 * f64::from(image.width);
        let y = 0.5 * f64::from(image.height) - 0.5 - f64::from(row);
        let w = weight(x, y);
        sum += w * f64::from(c.g);
        variance += w * w * f64::from(v.g);
    }
    if variances.is_empty() { (f64::NAN, f64::NAN) } else { (sum, variance) }
}

/// A scene, ready for single rays.
pub(super) struct Stage(Option<(Prepared, Kernel)>);

impl Stage {
    pub(super) fn new(scene: Scene, id: &str) -> Self {
        Self(prepared(scene, id, [1, 1]).map(|scene| {
            let kernel = kernel(&scene.plan);
            (scene, kernel)
        }))
    }

    /// The same, with the camera at `eye`, which decides what rays start in.
    pub(super) fn seen_from(eye: DVec3, mut scene: Scene, id: &str) -> Self {
        scene.cameras.insert(0, camera(DAffine3::from_translation(eye), 40.0, None));
        Self::new(scene, id)
    }

    /// Green of one sample along a ray.
    pub(super) fn radiance(&self, origin: DVec3, direction: DVec3, replication: u32, index: u32) -> f64 {
        let Some((scene, kernel)) = &self.0 else { return f64::NAN };
        let ray = Ray::new(origin.as_vec3(), direction.normalize().as_vec3());
        let address = Address::new(scene.seed, 0, replication, index);
        f64::from((kernel.li)(scene, address, ray, &mut Counters::default()).g)
    }

    /// Sees whether samples along a ray agree with the radiance `expected`, each replication having
    /// `samples` of them, a power of two. Three figures: how many standard errors the two are apart, by
    /// which share, and the standard error as a share, without which the others would say nothing.
    pub(super) fn agrees(
        &self,
        what: &str,
        ray: [DVec3; 2],
        (expected, tolerance): (f64, f64),
        (effort, samples): (Effort, u64),
    ) -> Vec<Figure> {
        let samples = effort.trials(samples) as u32;
        let mean = |replication| {
            (0..samples).map(|i| self.radiance(ray[0], ray[1], replication, i)).sum::<f64>()
                / f64::from(samples)
        };
        let moments: Moments = (0..REPLICATIONS).map(mean).collect();
        let error = moments.variance_of_mean().sqrt();
        let off = beyond_rounding(moments.mean, expected);
        let p = if off == 0.0 { 1.0 } else { student_two_sided(off / error, f64::from(REPLICATIONS - 1)) };
        let n = u64::from(samples) * u64::from(REPLICATIONS);
        figures(what, n, off, error, -normal_quantile(0.5 * p), (expected, tolerance))
    }
}

/// Whether a sum with a known variance agrees with what is expected.
pub(super) fn sum_agrees(
    what: &str,
    samples: u64,
    (sum, variance): (f64, f64),
    (expected, tolerance): (f64, f64),
) -> Vec<Figure> {
    let off = beyond_rounding(sum, expected);
    let z = if off == 0.0 { 0.0 } else { off / variance.sqrt() };
    figures(what, samples, off, variance.sqrt(), z, (expected, tolerance))
}

/// How far two numbers are apart, beyond what rounding may do; NaN stays NaN.
fn beyond_rounding(found: f64, expected: f64) -> f64 {
    let off = (found - expected).abs();
    if off <= ROUNDING * expected { 0.0 } else { off }
}

fn figures(
    what: &str,
    samples: u64,
    off: f64,
    error: f64,
    z: f64,
    (expected, tolerance): (f64, f64),
) -> Vec<Figure> {
    let what = format!("{what}, {samples} samples");
    vec![
        Figure::at_most(format!("{what}: |z|"), z.abs(), Z),
        Figure::at_most(format!("{what}: relative error"), off / expected, tolerance),
        Figure::at_most(format!("{what}: standard error, relative"), error / expected, 0.5 * tolerance),
    ]
}

//! Small scenes for hard cases, single rays through them, and what a mean of many rays is beside what it should be.
//!
//! Samples of one replication are one low-discrepancy sequence, so that their own variance says nothing about the
//! error of their mean; the means of sixteen replications do.

use glam::{DAffine3, DVec3};

use super::Figure;
use super::random::Random;
use crate::bsdf::Bsdf;
use crate::color::Rgb;
use crate::integrate::{Counters, LiFn, kernel};
use crate::prepare::{Algorithms, EffectsMode, Options, Prepared, Shortcuts, prepare};
use crate::sampling::Address;
use crate::scene::{
    Environment, Glass, Light, LightKind, Material, MaterialId, MaterialKind, Mesh, MeshId, Object,
    Principled, Scene, Shape, Sides, complete, validate,
};
use crate::shape::Ray;
use crate::stats::{Moments, normal_quantile, student_two_sided, welch};

/// Independent replications of a mean.
const REPLICATIONS: u32 = 16;

pub(super) fn diffuse(rho: f32) -> MaterialKind {
    MaterialKind::Diffuse { color: Rgb::grey(rho) }
}

pub(super) fn mirror(color: f32) -> MaterialKind {
    MaterialKind::Mirror { color: Rgb::grey(color) }
}

pub(super) fn glass(ior: f32) -> MaterialKind {
    MaterialKind::Glass(Glass { ior, tint: Rgb::WHITE, absorption: None, priority: None })
}

/// Black, and emits from its front.
pub(super) fn emitter(radiance: f32) -> MaterialKind {
    MaterialKind::Light { radiance: Rgb::grey(radiance), sides: Sides::Front }
}

/// Reflects diffusely, and emits on both sides.
pub(super) fn glowing(rho: f32, radiance: f32) -> MaterialKind {
    principled(|p| {
        p.base_color = Rgb::grey(rho);
        p.specular = 0.0;
        p.emission = Rgb::grey(radiance);
    })
}

pub(super) fn principled(change: impl FnOnce(&mut Principled)) -> MaterialKind {
    let mut p = Principled::default();
    change(&mut p);
    MaterialKind::Principled(Box::new(p))
}

/// The same radiance from everywhere.
pub(super) fn sky(radiance: f32) -> Option<Environment> {
    let radiance = Rgb::grey(radiance);
    Some(Environment { name: "sky".into(), radiance, image: None, visible_to_camera: true })
}

/// A scene that grows.
pub(super) trait Build {
    fn object(&mut self, shape: Shape, transform: DAffine3, kind: MaterialKind) -> &mut Self;
    fn sphere(&mut self, center: DVec3, radius: f64, kind: MaterialKind) -> &mut Self;
    fn mesh(&mut self, positions: &[DVec3], triangles: Vec<[u32; 3]>, kind: MaterialKind) -> &mut Self;
    /// A parallelogram with its front where `u` x `v` points.
    fn quad(&mut self, center: DVec3, u: DVec3, v: DVec3, kind: MaterialKind) -> &mut Self;
    /// A square whose front looks along `n`.
    fn square(&mut self, center: DVec3, n: DVec3, side: f64, kind: MaterialKind) -> &mut Self;
    /// A right prism about +Z with a regular polygon of `sides` sides, between two heights; its front is outside.
    fn prism(&mut self, sides: u32, radius: f64, heights: [f64; 2], kind: MaterialKind) -> &mut Self;
    fn light(&mut self, kind: LightKind, transform: DAffine3) -> &mut Self;
}

impl Build for Scene {
    fn object(&mut self, shape: Shape, transform: DAffine3, kind: MaterialKind) -> &mut Self {
        let number = self.materials.len() as u32;
        self.materials.push(Material { name: format!("material {number}"), kind });
        let (name, material) = (format!("object {number}"), MaterialId(number));
        self.objects.push(Object { name, shape, material, transform, visible_to_camera: true });
        self
    }

    fn sphere(&mut self, center: DVec3, radius: f64, kind: MaterialKind) -> &mut Self {
        self.object(Shape::Sphere { radius }, DAffine3::from_translation(center), kind)
    }

    fn mesh(&mut self, positions: &[DVec3], triangles: Vec<[u32; 3]>, kind: MaterialKind) -> &mut Self {
        let positions = positions.iter().map(|p| p.as_vec3()).collect();
        self.meshes.push(Mesh { positions, triangles, ..Mesh::default() });
        let mesh = MeshId(self.meshes.len() as u32 - 1);
        self.object(Shape::Mesh(mesh), DAffine3::IDENTITY, kind)
    }

    fn quad(&mut self, center: DVec3, u: DVec3, v: DVec3, kind: MaterialKind) -> &mut Self {
        let corners = [-u - v, u - v, u + v, v - u].map(|c| center + 0.5 * c);
        self.mesh(&corners, vec![[0, 1, 2], [0, 2, 3]], kind)
    }

    fn square(&mut self, center: DVec3, n: DVec3, side: f64, kind: MaterialKind) -> &mut Self {
        let u = n.any_orthonormal_vector();
        self.quad(center, side * u, side * n.cross(u), kind)
    }

    fn prism(&mut self, sides: u32, radius: f64, heights: [f64; 2], kind: MaterialKind) -> &mut Self {
        let turn = std::f64::consts::TAU / f64::from(sides);
        let corner = |i: u32| {
            let angle = turn * (f64::from(i % sides) + 0.5);
            DVec3::new(radius * libm::cos(angle), radius * libm::sin(angle), heights[(i / sides) as usize])
        };
        let corners: Vec<DVec3> = (0..2 * sides).map(corner).collect();
        let mut triangles = Vec::new();
        for i in 0..sides {
            let k = (i + 1) % sides;
            triangles.extend([[i, k, k + sides], [i, k + sides, i + sides]]);
            if i > 0 && k > 0 {
                triangles.extend([[0, k, i], [sides, i + sides, k + sides]]);
            }
        }
        self.mesh(&corners, triangles, kind)
    }

    fn light(&mut self, kind: LightKind, transform: DAffine3) -> &mut Self {
        self.lights.push(Light { name: "light".into(), kind, transform, visible_to_camera: true });
        self
    }
}

/// A camera ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    origin: DVec3,
    direction: DVec3,
}

impl Probe {
    pub(super) fn ray(&self) -> Ray {
        Ray::new(self.origin.as_vec3(), self.direction.as_vec3())
    }
}

pub(super) fn probe(origin: DVec3, direction: DVec3) -> Probe {
    Probe { origin, direction: direction.normalize() }
}

/// A ray that looks straight down at `point` of a surface of normal `n`, from a little above.
pub(super) fn look_at(point: DVec3, n: DVec3, height: f64) -> Probe {
    probe(point + height * n, -n)
}

/// A scene, ready for single rays.
pub(super) struct Shooter {
    pub(super) prepared: Prepared,
    li: LiFn,
}

impl Shooter {
    /// `None` where the scene is not valid, which a case reports as a figure that is not a number.
    pub(super) fn new(id: &str, scene: &Scene, max_depth: Option<u32>) -> Option<Self> {
        let mut scene = scene.clone();
        validate(&mut scene).ok()?;
        // For its camera; a scene without light stays dark.
        let (lights, environment) = (scene.lights.clone(), scene.environment.clone());
        complete(&mut scene);
        (scene.lights, scene.environment) = (lights, environment);
        let seed = Random::of(id).bits();
        let effects = EffectsMode::Auto;
        let options = Options {
            camera: None,
            size: [1, 1],
            seed,
            effects,
            max_depth,
            shortcuts: Shortcuts::default(),
            transparent: false,
            algorithms: Algorithms::PATHS,
        };
        let prepared = prepare(&scene, &options).ok()?;
        let li = kernel(&prepared.plan).li;
        Some(Self { prepared, li })
    }

    /// One sample along a ray.
    pub(super) fn radiance(&self, probe: &Probe, pixel: u64, replication: u32, index: u32) -> Rgb {
        let address = Address::new(self.prepared.seed, pixel, replication, index);
        (self.li)(&self.prepared, address, probe.ray(), &mut Counters::default())
    }

    /// The mean over all probes of at least `samples` samples in all replications together; the scenes are grey.
    pub(super) fn mean(&self, probes: &[Probe], samples: u64) -> Moments {
        let each = (samples / u64::from(REPLICATIONS)).div_ceil(probes.len() as u64).next_power_of_two();
        let replication = |r| {
            let one = |(i, p)| {
                (0..each as u32).map(|k| f64::from(self.radiance(p, i as u64, r, k)[1])).sum::<f64>()
            };
            probes.iter().enumerate().map(one).sum::<f64>() / (probes.len() as f64 * each as f64)
        };
        (0..REPLICATIONS).map(replication).collect()
    }
}

/// The compiled form of a material.
pub(super) fn compile(kind: MaterialKind) -> Option<Bsdf> {
    compile_all(vec![kind])?.pop()
}

/// The same of many, which share their tables.
pub(super) fn compile_all(kinds: Vec<MaterialKind>) -> Option<Vec<Bsdf>> {
    let mut scene = Scene::default();
    // A material on no surface is not compiled.
    for kind in kinds {
        scene.sphere(DVec3::ZERO, 1.0, kind);
    }
    let shooter = Shooter::new("", &scene, None)?;
    Some(shooter.prepared.materials.iter().map(|m| m.bsdf.clone()).collect())
}

/// Of a mean: how far it is from `expected`, relative, and in standard errors, as normal ones that are as improbable.
/// Rounding along the path, `rounding`, is no error.
pub(super) fn beside(
    what: &str,
    mean: Option<Moments>,
    expected: f64,
    rounding: f64,
    most: f64,
) -> [Figure; 2] {
    let (off, z) = mean.map_or((f64::NAN, f64::NAN), |m| {
        let off = (m.mean - expected).abs();
        let beyond = (off - rounding * expected).max(0.0);
        (off / expected, z_score(beyond, &m))
    });
    [
        Figure::at_most(format!("{what}: relative error"), off, most),
        Figure::at_most(format!("{what}: standard errors off"), z, 4.5),
    ]
}

/// How many standard errors of a normal mean are as improbable as `off` is for a mean of few replications.
pub(super) fn z_score(off: f64, mean: &Moments) -> f64 {
    if off == 0.0 {
        return 0.0;
    }
    let t = off / mean.variance_of_mean().sqrt();
    normal_score(student_two_sided(t, (mean.n - 1) as f64), t)
}

/// How many standard errors apart two means are, in the same measure.
pub(super) fn apart(a: &Moments, b: &Moments) -> f64 {
    welch(a, b).map_or(f64::NAN, |w| normal_score(w.p, w.t.abs()))
}

/// The normal number that is as improbable as `p`; where that is below every number, `t` is far beyond every bound.
fn normal_score(p: f64, t: f64) -> f64 {
    if p > 0.0 { -normal_quantile(0.5 * p) } else { t }
}

/// The largest of some figures; not a number where one of them is not.
pub(super) fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) })
}

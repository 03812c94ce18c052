//! Two ways to find a light, each alone and both together.

use glam::{DVec3, Vec3};

use super::super::build::{Build, Probe, Shooter, emitter, principled, probe, z_score};
use super::super::{Effort, Figure};
use crate::accel::{PrimitiveId, RayKind};
use crate::bsdf::{Bsdf, Transport};
use crate::color::Rgb;
use crate::integrate::mis_weight;
use crate::light::LightContext;
use crate::math::Frame;
use crate::prepare::Prepared;
use crate::sampling::{Address, Purpose};
use crate::scene::{MaterialKind, Scene};
use crate::shape::{Ray, offset_origin};
use crate::stats::Moments;

const WAYS: [&str; 5] = ["light alone", "direction alone", "both, balance", "both, power", "the renderer"];

/// Where a ray meets the receiver.
struct Vertex<'a> {
    scene: &'a Prepared,
    bsdf: &'a Bsdf,
    frame: Frame,
    context: LightContext,
}

impl<'a> Vertex<'a> {
    fn new(scene: &'a Prepared, probe: &Probe) -> Option<Self> {
        let ray = probe.ray();
        let hit = scene.accel.closest(&ray, PrimitiveId::NONE, RayKind::Camera)?;
        let surface = scene.surface(&ray, &hit, false);
        let bsdf = &scene.materials[scene.material_of(surface.object) as usize].bsdf;
        let context = surface.lit(-ray.d, false);
        Some(Self { scene, bsdf, frame: Frame::from_z(surface.ns), context })
    }

    /// What a sampled light brings, and the densities of both ways to find it.
    fn light(&self, u: [f32; 3]) -> Option<(f64, f32, f32)> {
        let light = self.scene.lights.sample(&self.context, u)?;
        let [wo, wi] = [self.context.wo, light.wi].map(|w| self.frame.to_local(w));
        let (f, pdf) = self.bsdf.f_and_pdf(wo, wi, Transport::Radiance);
        let hidden = self.scene.accel.occluded(&light.shadow_ray, [self.context.from, light.target]);
        let brought = (f * light.weight).g * wi.z.max(0.0);
        Some((if hidden { 0.0 } else { f64::from(brought) }, light.pdf, pdf))
    }

    /// The same of a sampled direction.
    fn direction(&self, u: [f32; 3]) -> Option<(f64, f32, f32)> {
        let sample = self.bsdf.sample(self.frame.to_local(self.context.wo), u, Transport::Radiance)?;
        let c = &self.context;
        let wi = self.frame.to_world(sample.wi).normalize();
        let ray = Ray::new(offset_origin(c.p, c.p_err, c.ng, wi), wi);
        let hit = self.scene.accel.closest(&ray, c.from, RayKind::Other)?;
        let surface = self.scene.surface(&ray, &hit, false);
        let light = self.scene.lights.of_surface(surface.id)?;
        let le: Vec3 = self.scene.lights.emitted(light, -wi, surface.ng).to_array().into();
        let pdf = self.scene.lights.pdf(c, light, surface.p, surface.ng);
        Some((f64::from(sample.weight.g * le.y), sample.pdf, pdf))
    }

    /// One sample of each way but the renderer's.
    fn ways(&self, u: [f32; 4], v: [f32; 4]) -> [f64; 4] {
        let balance = |own: f32, other: f32| f64::from(own) / (f64::from(own) + f64::from(other));
        let power = |own, other| f64::from(mis_weight(own, other));
        let mut sums = [0.0; 4];
        let found = [self.light([u[0], u[1], u[2]]), self.direction([v[0], v[1], v[2]])];
        for (way, (brought, own, other)) in found.into_iter().enumerate().filter_map(|(i, f)| Some((i, f?))) {
            sums[way] += brought;
            sums[2] += brought * balance(own, other);
            sums[3] += brought * power(own, other);
        }
        sums
    }
}

/// A small receiver under a square lamp and a ball lamp.
fn scene(kind: MaterialKind) -> Scene {
    let mut scene = Scene::default();
    scene.square(DVec3::ZERO, DVec3::Z, 1e-2, kind);
    scene.quad(DVec3::new(1.0, 0.2, 1.2), DVec3::new(0.0, 1.2, 0.0), DVec3::new(0.8, 0.0, 0.8), emitter(1.0));
    scene.sphere(DVec3::new(-1.0, -0.5, 1.4), 0.6, emitter(2.0));
    scene
}

/// Means of sixteen replications of every way, together.
fn replications(shooter: &Shooter, ray: &Probe, samples: u64) -> Option<Vec<[f64; 5]>> {
    let vertex = Vertex::new(&shooter.prepared, ray)?;
    let each = (samples / 16) as u32;
    let one = |r: u32| {
        let mut sums = [0.0; 5];
        for i in 0..each {
            let address = Address::new(shooter.prepared.seed, 1, r, i);
            let block = |k| address.block(0, Purpose::Test, 0, k);
            let [a, b, c, d] = vertex.ways(block(0), block(1));
            let rendered = f64::from(shooter.radiance(ray, 0, r, i)[1]);
            for (sum, x) in sums.iter_mut().zip([a, b, c, d, rendered]) {
                *sum += x / f64::from(each);
            }
        }
        sums
    };
    Some((0..16).map(one).collect())
}

/// N55. The renderer weighs by power, always; the other ways are put together here from its own lights and materials.
pub(super) fn ways(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    let kinds = [
        ("plastic", principled(|p| (p.base_color, p.roughness) = (Rgb::grey(0.4), 0.5))),
        ("metal", principled(|p| (p.metallic, p.roughness) = (1.0, 0.45))),
    ];
    for (name, kind) in kinds {
        let ray = probe(DVec3::new(-0.5e-3, 1e-3, 1e-2), DVec3::new(0.5, 0.2, -1.0));
        let shooter = Shooter::new(&format!("N55 {name}"), &scene(kind), Some(1));
        let found = shooter.and_then(|s| replications(&s, &ray, effort.trials(1 << 19)));
        let found = found.unwrap_or(vec![[f64::NAN; 5]; 2]);
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 3), (2, 3), (3, 4)] {
            let difference: Moments = found.iter().map(|r| r[i] - r[j]).collect();
            let mean: Moments = found.iter().map(|r| r[3]).collect();
            let off = difference.mean.abs();
            let what = format!("{name}: {} and {}", WAYS[i], WAYS[j]);
            figures.push(Figure::at_most(format!("{what}: relative difference"), off / mean.mean, 0.003));
            let beyond = (off - 4e-6 * mean.mean).max(0.0);
            let z = if off.is_nan() { f64::NAN } else { z_score(beyond, &difference) };
            figures.push(Figure::at_most(format!("{what}: standard errors apart"), z, 4.5));
        }
    }
    figures
}

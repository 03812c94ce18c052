//! Reciprocity.

use glam::Vec3;

use super::super::build::{compile, diffuse, principled, worst};
use super::super::random::Random;
use super::super::{Effort, Figure};
use crate::bsdf::{Bsdf, Transport};

/// What compensation for multiple scattering divides the value by. It depends on one direction alone and is, as the
/// material's documentation says, what is not reciprocal about rough lobes; without it they must be.
fn albedo(bsdf: &Bsdf, wo: Vec3) -> f64 {
    let Bsdf::Principled(p) = bsdf else { return 1.0 };
    let mu = wo.z.abs();
    let found = match (&p.rough, &p.white) {
        (Some(rough), _) => rough.total[usize::from(wo.z < 0.0)].at(mu),
        (None, Some(white)) => white.at(mu),
        _ => 1.0,
    };
    f64::from(found)
}

/// Whether the facet that makes one direction of the other is seen close to total reflection, or grazing beyond it: there
/// the share that passes hangs on the last bits of the directions, which the two ways round differently.
fn critical(a: Vec3, b: Vec3, ior: f64) -> bool {
    let index = |w: Vec3| if w.z > 0.0 { 1.0 } else { ior };
    let m = (a.as_dvec3() * index(a) + b.as_dvec3() * index(b)).normalize();
    let cos2 = [a, b].map(|w| w.as_dvec3().dot(m) * w.as_dvec3().dot(m));
    let total = 1.0 - 1.0 / (ior * ior);
    let near = [(a, cos2[0]), (b, cos2[1])].into_iter().any(|(w, c)| w.z < 0.0 && (c - total).abs() < 0.02);
    near || cos2[0].min(cos2[1]) < 0.01
}

/// N44.
pub(super) fn pairs(effort: Effort) -> Vec<Figure> {
    let ior = 1.5f64;
    let mut figures = Vec::new();
    let mut list = vec![("diffuse".to_owned(), diffuse(0.7))];
    for alpha in [0.1, 0.25, 0.5, 1.0f32] {
        for (name, metal) in [("metal", 1.0), ("glass", 0.0)] {
            let kind = principled(|p| {
                (p.metallic, p.transmission, p.roughness) = (metal, 1.0 - metal, alpha.sqrt());
            });
            list.push((format!("{name} of width {alpha}"), kind));
        }
    }
    for (name, kind) in list {
        let mut random = Random::of(&format!("N44 {name}"));
        let Some(bsdf) = compile(kind) else { return vec![Figure::exactly("compiled", f64::NAN, 1.0)] };
        let f =
            |a: Vec3, b: Vec3| f64::from(bsdf.f_and_pdf(a, b, Transport::Radiance).0.g) * albedo(&bsdf, a);
        let transmits = bsdf.transmits();
        let mut off = 0f64;
        let pairs = effort.trials(100_000);
        for _ in 0..pairs {
            let (a, b) = (random.direction(), random.direction());
            if transmits && critical(a, b, ior) {
                continue;
            }
            // Radiance grows by the square of the index of the medium that it enters.
            let index2 = |w: Vec3| if w.z > 0.0 { 1.0 } else { ior * ior };
            let (one, other) = (f(a, b) / index2(a), f(b, a) / index2(b));
            let size = one.max(other);
            if size > 0.0 {
                off = worst([off, (one - other).abs() / size]);
            }
        }
        // Fresnel's terms, from two sides of the glass, agree to some more roundings than the table's 1e-5 has.
        let most = if transmits { 2e-5 } else { 1e-5 };
        figures.push(Figure::at_most(format!("{name}, {pairs:e} pairs: relative difference"), off, most));
    }
    figures
}

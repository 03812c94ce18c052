//! What `sample` does, beside what `f_and_pdf` says.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::super::build::{compile, compile_all, principled, worst};
use super::super::lights::chi_square_p;
use super::super::random::Random;
use super::super::{Effort, Figure};
use super::facets::{Rough, cell_of, normals, single_scattering, visible};
use super::{direction, facets};
use crate::bsdf::{Bsdf, Transport};
use crate::color::Rgb;
use crate::scene::{MaterialKind, Principled};
use crate::stats::sidak;

const RINGS: usize = 40;
const SECTORS: usize = 40;

/// From straight to grazing, seen from above.
const COSINES: [f32; 5] = [1.0, 0.7, 0.1, 0.01, 1e-3];

const WIDTHS: [f32; 5] = [1e-3, 1e-2, 0.1, 0.5, 1.0];

/// Each width's metal from above and glass from above and below, at each cosine.
fn lobes() -> Vec<(Rough, Vec<Vec3>)> {
    let with_directions = |rough: Rough| {
        let above = COSINES.map(direction);
        let below = above.map(|w| Vec3::new(w.x, w.y, -w.z));
        let directions = if rough.transmits() { [above, below].concat() } else { above.to_vec() };
        (rough, directions)
    };
    WIDTHS.into_iter().flat_map(Rough::metal_and_glass).map(with_directions).collect()
}

fn pdf(bsdf: &Bsdf, wo: Vec3, wi: Vec3) -> f64 {
    f64::from(bsdf.f_and_pdf(wo, wi, Transport::Radiance).1)
}

/// N41. The table's grid of 80 x 160 directions cannot hold lobes a thousandth wide; here the cells are those of the
/// normals that make the directions, 40 x 40 for each side, where lobes of every width fill many cells evenly.
pub(super) fn samples(effort: Effort) -> Vec<Figure> {
    // Nightly the table's 1e6, and cells that are summed finely enough for that.
    let (samples, n) = match effort {
        Effort::Usual => (40_000, 6),
        Effort::Nightly => (1_000_000, 32),
    };
    let (mut smallest, mut name, mut count, mut stray, mut all) = (1f64, String::new(), 0, 0.0, 0.0);
    for (rough, directions) in lobes() {
        for wo in directions {
            if f64::from(wo.z.abs()) * rough.alpha < 5e-6 {
                // The normal that two directions in single precision have between them is off by 6e-8 over the cosine
                // and falls on a grid as coarse: three hundredths of the lobe for the narrowest and most grazing one.
                continue;
            }
            let mut expected = vec![0.0; 2 * RINGS * SECTORS];
            normals(rough.alpha, RINGS * n, SECTORS * n, |i, k, m, solid_angle| {
                for (side, (direction, _)) in rough.directions(wo, m).into_iter().enumerate() {
                    if let Some((wi, factor)) = direction.filter(|&(_, factor)| factor > 0.0) {
                        let cell = (side * RINGS + i / n) * SECTORS + k / n;
                        expected[cell] += pdf(&rough.bsdf, wo, wi) * factor * solid_angle;
                    }
                }
            });
            let mut counts = vec![0u32; expected.len()];
            let id = format!("{}, cosine {}", rough.name, wo.z);
            let mut random = Random::of(&format!("N41 {id}"));
            for _ in 0..samples {
                let u = [random.unit_f32(), random.unit_f32(), random.unit_f32()];
                if let Some(s) = rough.bsdf.sample(wo, u, Transport::Radiance) {
                    let side = usize::from(s.wi.z * wo.z < 0.0);
                    let [i, k] = cell_of(rough.normal(wo, s.wi), rough.alpha, RINGS, SECTORS);
                    counts[(side * RINGS + i) * SECTORS + k] += 1;
                    all += 1.0;
                }
            }
            let p = chi_square_p(&expected, &counts);
            let outside = strays(&expected, &counts);
            (count, stray) = (count + 1, stray + f64::from(outside));
            if p.is_nan() || p < smallest {
                (smallest, name) = (p, id);
            }
        }
    }
    vec![
        Figure::at_least(format!("p of the worst of {count} lobes ({name})"), sidak(smallest, count), 0.01),
        Figure::at_most("share of samples in cells where none belong", stray / all, 1e-5),
    ]
}

/// How many samples lie in cells where nothing belongs, nor around them: rounding may take a sample over the border of a
/// cell, and the sum over a cell may miss a sliver of the lobe.
fn strays(expected: &[f64], counts: &[u32]) -> u32 {
    let empty = |cell: usize| {
        let (side, i, k) = (cell / (RINGS * SECTORS), cell / SECTORS % RINGS, cell % SECTORS);
        let rows = i.saturating_sub(1)..=(i + 1).min(RINGS - 1);
        rows.flat_map(|i| [SECTORS - 1, 0, 1].map(|by| (side * RINGS + i) * SECTORS + (k + by) % SECTORS))
            .all(|cell| expected[cell] == 0.0)
    };
    counts
        .iter()
        .enumerate()
        .filter(|&(cell, &count)| count > 0 && empty(cell))
        .map(|(_, &count)| count)
        .sum()
}

/// N42. Sampling rejects a direction that leaves to the wrong side of its normal: light that single scattering loses.
pub(super) fn integrals(effort: Effort) -> Vec<Figure> {
    let (mut off, mut surprise, mut count) = (0f64, 0f64, 0);
    let n = effort.trials(10_000);
    for (rough, directions) in lobes() {
        for wo in directions {
            let up = Vec3::new(wo.x, wo.y, wo.z.abs()).as_dvec3();
            let (mut sum, mut rejected) = (0.0, 0.0);
            normals(rough.alpha, 300, 200, |_, _, m, solid_angle| {
                if up.dot(m) <= 0.0 {
                    return;
                }
                for (direction, share) in rough.directions(wo, m) {
                    match direction {
                        Some((wi, factor)) => sum += pdf(&rough.bsdf, wo, wi) * factor * solid_angle,
                        None => rejected += visible(up, m, rough.alpha) * share * solid_angle,
                    }
                }
            });
            off = worst([off, (sum + rejected - 1.0).abs()]);
            let mut random = Random::of(&format!("N42 {} {}", rough.name, wo.z));
            let none = |_: &u64| {
                let u = [random.unit_f32(), random.unit_f32(), random.unit_f32()];
                rough.bsdf.sample(wo, u, Transport::Radiance).is_none()
            };
            let found = (0..n).filter(none).count() as f64 / n as f64;
            let deviation = (rejected * (1.0 - rejected) / n as f64).max(0.0).sqrt();
            surprise = worst([surprise, ((found - rejected).abs() - 4.5 * deviation).max(0.0)]);
            count += 1;
        }
    }
    let layered = [
        ("diffuse", principled(|p| (p.specular, p.roughness) = (0.0, 0.5))),
        ("smooth coat", principled(|p| (p.specular, p.coat, p.coat_ior) = (0.0, 1.0, 1.8))),
        (
            "sheen",
            principled(|p| (p.specular, p.sheen_color, p.sheen_roughness) = (0.0, Rgb::grey(0.8), 0.4)),
        ),
    ];
    let mut layers_off = 0f64;
    for (_, kind) in layered {
        let Some(bsdf) = compile(kind) else { return vec![Figure::exactly("compiled", f64::NAN, 1.0)] };
        for mu in [1.0, 0.7, 0.3, 0.1f32] {
            layers_off = worst([layers_off, (whole(&bsdf, direction(mu)) - 1.0).abs()]);
        }
    }
    vec![
        Figure::at_most(format!("density and what is rejected, {count} lobes: less one"), off, 1e-4),
        Figure::at_most(
            format!("share of {n:e} samples rejected, the worst lobe: off, beyond 4.5 standard deviations"),
            surprise,
            1e-4,
        ),
        Figure::at_most(
            "density and delta lobe of layers over diffuse, 12 lobes: less one",
            layers_off,
            1e-4,
        ),
    ]
}

/// Integral of a wide density over the upper side, and the probability of a delta lobe.
fn whole(bsdf: &Bsdf, wo: Vec3) -> f64 {
    let (rings, sectors) = (300, 64);
    let mut sum = 0.0;
    for i in 0..rings {
        let z = (f64::from(i) + 0.5) / f64::from(rings);
        let r = (1.0 - z * z).sqrt();
        for k in 0..sectors {
            let (s, c) = libm::sincos(f64::from(k) / f64::from(sectors) * 2.0 * PI);
            sum += pdf(bsdf, wo, DVec3::new(r * c, r * s, z).as_vec3());
        }
    }
    let choices = (0..100).map(|i| (i as f32 + 0.5) / 100.0);
    let delta = choices.filter_map(|u| bsdf.sample(wo, [u, 0.5, 0.5], Transport::Radiance)).find(|s| s.delta);
    sum * 2.0 * PI / f64::from(rings * sectors) + delta.map_or(0.0, |s| f64::from(s.pdf))
}

/// Materials with all kinds of lobes.
fn mixtures() -> Option<Vec<Bsdf>> {
    let mut kinds = vec![MaterialKind::Diffuse { color: Rgb::grey(0.7) }];
    for roughness in [0.05, 0.3, 1.0] {
        let mut add = |change: fn(&mut Principled)| {
            kinds.push(principled(|p| {
                p.roughness = roughness;
                change(p);
            }));
        };
        add(|p| p.metallic = 1.0);
        add(|_| ());
        add(|p| p.transmission = 1.0);
        add(|p| (p.transmission, p.thin) = (1.0, true));
        add(|p| (p.metallic, p.transmission) = (0.3, 0.6));
        add(|p| (p.coat, p.coat_roughness) = (0.8, p.roughness));
        add(|p| (p.sheen_color, p.sheen_roughness) = (Rgb::grey(0.6), p.roughness));
    }
    compile_all(kinds)
}

/// N43.
pub(super) fn weights(effort: Effort) -> Vec<Figure> {
    let (mut weight, mut density, mut length, mut count) = (0f64, 0f64, 0f64, 0);
    let mut random = Random::of("N43");
    let Some(materials) = mixtures() else { return vec![Figure::exactly("compiled", f64::NAN, 1.0)] };
    for bsdf in materials {
        for wo in COSINES.into_iter().flat_map(|mu| [direction(mu), -direction(mu)]) {
            for _ in 0..effort.trials(200) {
                let u = [random.unit_f32(), random.unit_f32(), random.unit_f32()];
                let Some(s) = bsdf.sample(wo, u, Transport::Radiance).filter(|s| !s.delta) else { continue };
                let (f, pdf) = bsdf.f_and_pdf(wo, s.wi, Transport::Radiance);
                let expected = f * (s.wi.z.abs() / pdf);
                weight = worst([weight, f64::from((s.weight.g / expected.g - 1.0).abs())]);
                density = worst([density, f64::from((s.pdf / pdf - 1.0).abs())]);
                length = worst([length, f64::from((s.wi.length() - 1.0).abs())]);
                count += 1;
            }
        }
    }
    let [closed, largest] = closed_weights(effort);
    vec![
        Figure::at_most(format!("weight, {count} samples of 22 materials: relative error"), weight, 1e-4),
        Figure::at_most("density: relative error", density, 1e-4),
        Figure::at_most("length of the direction: less one", length, 1e-6),
        Figure::at_most("weight of white metal beside G2 / (G1 E) in f64: relative error", closed, 2e-3),
        Figure::at_most("largest weight of white metal before compensation", largest, 1.0 + 2e-3),
    ]
}

/// White metal's weights against the closed form, which the sampler's own value and density do not enter: G2 / G1 of
/// the direction over the lobe's albedo. And the largest of them, times the albedo.
fn closed_weights(effort: Effort) -> [f64; 2] {
    let (mut off, mut largest) = (0f64, 0f64);
    let mut random = Random::of("N43 closed");
    for rough in [0.05, 0.1, 0.25, 0.5, 1.0].into_iter().flat_map(Rough::metal_and_glass) {
        if rough.transmits() {
            continue;
        }
        for mu in [1.0, 0.7, 0.3, 0.1f32] {
            let wo = direction(mu);
            let albedo = single_scattering(f64::from(mu), rough.alpha);
            let lambda_o = facets::lambda(wo.as_dvec3(), rough.alpha);
            for _ in 0..effort.trials(1000) {
                let u = [random.unit_f32(), random.unit_f32(), random.unit_f32()];
                let Some(s) = rough.bsdf.sample(wo, u, Transport::Radiance) else { continue };
                let lambda_i = facets::lambda(s.wi.as_dvec3(), rough.alpha);
                let expected = (1.0 + lambda_o) / (1.0 + lambda_o + lambda_i) / albedo;
                off = worst([off, (f64::from(s.weight.g) / expected - 1.0).abs()]);
                largest = worst([largest, f64::from(s.weight.g) * albedo]);
            }
        }
    }
    [off, largest]
}

//! Hard cases about materials.

mod density;
mod energy;
mod facets;
mod reciprocity;

use glam::{DVec3, Vec3};

use super::build::{Build, Probe, Shooter, compile, diffuse, glass, mirror, principled, probe, sky, worst};
use super::random::Random;
use super::{Case, Class, Effort, Figure};
use crate::bsdf::{Bsdf, Transport, fresnel};
use crate::color::Rgb;
use crate::scene::{MaterialKind, Scene};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N38",
        class: Class::Unit,
        guards: "Energy, path by path: under a white sky each path off perfect white materials brings exactly one.",
        run: furnace,
    },
    Case {
        id: "N39",
        class: Class::Statistical,
        guards: "Rough reflection: single scattering loses what theory says, and compensation gives it back, no more.",
        run: energy::furnace,
    },
    Case {
        id: "N40",
        class: Class::Unit,
        guards: "Distribution and shadowing of microfacets belong together: visible normals are a density.",
        run: energy::weak_furnace,
    },
    Case {
        id: "N41",
        class: Class::Statistical,
        guards: "Sampled directions follow their stated density, from straight to grazing, from mirror-like to rough.",
        run: density::samples,
    },
    Case {
        id: "N42",
        class: Class::Unit,
        guards: "Densities integrate to one, together with delta lobes and with what sampling is known to reject.",
        run: density::integrals,
    },
    Case {
        id: "N43",
        class: Class::Unit,
        guards: "The weight of a sample is value times cosine over density of the direction that it returns.",
        run: density::weights,
    },
    Case {
        id: "N44",
        class: Class::Unit,
        guards: "Helmholtz: light takes the same share of a path both ways, with the indices' squares at refraction.",
        run: reciprocity::pairs,
    },
    Case {
        id: "N45",
        class: Class::Unit,
        guards: "Ever narrower lobes end in the mirror and in smooth glass, without a number that is none.",
        run: mirror_limit,
    },
    Case {
        id: "N46",
        class: Class::Unit,
        guards: "Glass reflects by Fresnel's equations; Schlick's curve, known to be off, is as far off as it is said to be.",
        run: schlick,
    },
];

/// N38.
fn furnace(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    let count = effort.trials(1000) as u32;
    let each = |name: &str, scene: &Scene, probes: &[Probe], count: u32| {
        let off = Shooter::new(&format!("N38 {name}"), scene, None).map_or(f64::NAN, |shooter| {
            let one = |i: usize, k| {
                let found = shooter.radiance(&probes[i], i as u64, 0, k);
                worst(found.to_array().map(|c| (f64::from(c) - 1.0).abs()))
            };
            worst((0..probes.len()).flat_map(|i| (0..count).map(move |k| (i, k))).map(|(i, k)| one(i, k)))
        });
        Figure::at_most(format!("{name}: largest error of {} paths", probes.len() as u32 * count), off, 2e-5)
    };
    let down = |b: f64| probe(DVec3::new(b, 0.0, 3.0), -DVec3::Z);
    let across = [0.0, 0.5, 0.85, 0.98, 0.999].map(down);
    let balls: [(&str, MaterialKind); 4] = [
        ("diffuse ball", diffuse(1.0)),
        ("mirror ball", mirror(1.0)),
        ("glass ball", glass(1.5)),
        ("bubble", glass(0.7)),
    ];
    for (name, kind) in balls {
        let mut scene = Scene { environment: sky(1.0), ..Scene::default() };
        scene.sphere(DVec3::ZERO, 1.0, kind);
        figures.push(each(name, &scene, &across, count));
    }
    let mut plates = Scene { environment: sky(1.0), ..Scene::default() };
    for i in 0..8 {
        let z = -0.3 * f64::from(i);
        plates.prism(4, 2.0, [z - 0.2, z], glass(1.5));
    }
    let slanted =
        [0.0, 0.5, 2.0, 6.0].map(|x| probe(DVec3::new(0.1 - x, 0.2, 1.0), DVec3::new(x, 0.0, -1.0)));
    figures.push(each("eight plates of glass", &plates, &slanted, count));
    let rows: Vec<Figure> = (1..=64)
        .map(|n| {
            let mut scene = Scene { environment: sky(1.0), ..Scene::default() };
            let length = f64::from(n);
            let (u, v) = (length * DVec3::X, 2.0 * DVec3::Y);
            scene.quad(DVec3::new(0.5 * length, 0.0, 0.0), u, v, mirror(1.0));
            scene.quad(DVec3::new(0.5 * length, 0.0, 1.0), u, -v, mirror(1.0));
            let ray = probe(DVec3::new(-0.25, 0.0, 0.5), DVec3::new(1.0, 0.0, 1.0));
            each("", &scene, &[ray], 1)
        })
        .collect();
    let off = worst(rows.iter().map(|f| f.value));
    figures.push(Figure::at_most(
        "1 to 64 reflections between mirrors: largest error of 64 paths",
        off,
        2e-5,
    ));
    figures
}

/// The cosine `mu` in some plane.
fn direction(mu: f32) -> Vec3 {
    let r = ((1.0 - mu) * (1.0 + mu)).sqrt();
    Vec3::new(0.6 * r, -0.8 * r, mu)
}

/// N45. Widths below `SMOOTH_ALPHA`, 1e-4, are delta lobes; just above it they are lobes still.
fn mirror_limit(effort: Effort) -> Vec<Figure> {
    let (mut bad, mut lobe, mut weight, mut sharp, mut kind) = (0.0, 0f64, 0f64, 0f64, 0.0);
    let mut random = Random::of("N45");
    let n = effort.trials(10_000);
    for alpha in [1e-2, 1e-3, 1.01e-4, 0.99e-4, 0.0f32] {
        for transmission in [0.0, 1.0] {
            let material = principled(|p| {
                (p.metallic, p.transmission, p.roughness) = (1.0 - transmission, transmission, alpha.sqrt());
            });
            let Some(bsdf) = compile(material) else {
                return vec![Figure::exactly("compiled", f64::NAN, 1.0)];
            };
            let smooth = alpha < 1e-4;
            kind += f64::from(bsdf.is_delta() != smooth);
            for mu in [1.0, 0.5, 0.1] {
                let wo = direction(mu);
                let (_, cos_t) = fresnel::dielectric(mu, 1.5);
                let ideal = [Vec3::new(-wo.x, -wo.y, wo.z), fresnel::refract(wo, Vec3::Z, mu, cos_t, 1.5)];
                let (mut sums, mut counts, mut brought) = ([DVec3::ZERO; 2], [0.0; 2], 0.0);
                for _ in 0..n {
                    let u = [random.unit_f32(), random.unit_f32(), random.unit_f32()];
                    let Some(s) = bsdf.sample(wo, u, Transport::Importance) else { continue };
                    let fine = s.wi.is_finite() && s.weight.is_finite() && s.pdf.is_finite();
                    bad += f64::from(!fine);
                    kind += f64::from(s.delta != smooth);
                    let side = usize::from(s.wi.z < 0.0);
                    sums[side] += s.wi.as_dvec3();
                    counts[side] += 1.0;
                    brought += f64::from(s.weight.g);
                }
                for side in 0..2 {
                    if counts[side] > 100.0 {
                        let off = (sums[side] / counts[side] - ideal[side].as_dvec3()).length();
                        let so_far = if smooth { &mut sharp } else { &mut lobe };
                        *so_far = worst([off, *so_far]);
                    }
                }
                weight = worst([weight, (brought / n as f64 - 1.0).abs()]);
            }
        }
    }
    vec![
        Figure::exactly(format!("samples that are not numbers, widths 1e-2 to 0, of {:e}", 30 * n), bad, 0.0),
        Figure::exactly("lobes above width 1e-4 that are delta lobes, or the reverse", kind, 0.0),
        Figure::at_most(
            "mean direction of lobes of widths 1e-2 to 1e-4: off mirror and refraction",
            lobe,
            1e-2,
        ),
        Figure::at_most("directions of narrower lobes: off mirror and refraction", sharp, 4e-7),
        Figure::at_most("mean weight of white metal and glass: less one", weight, 1e-2),
    ]
}

/// Fresnel's equations for a dielectric, in `f64`: reflectance and the cosine beyond.
pub(super) fn exact(cos: f64, eta: f64) -> (f64, f64) {
    let s2 = (1.0 - cos) * (1.0 + cos) / (eta * eta);
    if s2 >= 1.0 {
        return (1.0, 0.0);
    }
    let t = (1.0 - s2).sqrt();
    let (a, b) = ((eta * cos - t) / (eta * cos + t), (cos - eta * t) / (cos + eta * t));
    (0.5 * (a * a + b * b), t)
}

/// N46. There is no option that makes glass reflect by Schlick's formula: only metals, whose colour is all that is known
/// of them, and `--method report` do.
fn schlick(_: Effort) -> Vec<Figure> {
    let f0 = Rgb::grey(fresnel::f0_of_ior(1.5));
    let n = 20_000;
    let (mut most, mut at, mut averages, mut glass_off) = (0.0, 0.0, [0.0; 2], 0.0);
    let Some(bsdf) = compile(glass(1.5)) else { return vec![Figure::exactly("compiled", f64::NAN, 1.0)] };
    for i in 0..n {
        let mu = (f64::from(i) + 0.5) / f64::from(n);
        let curve = f64::from(fresnel::schlick(f0, mu as f32).g);
        let (r, _) = exact(mu, 1.5);
        if (curve - r).abs() > most {
            (most, at) = ((curve - r).abs(), mu);
        }
        let weight = 2.0 * mu / f64::from(n);
        averages = [averages[0] + weight * curve, averages[1] + weight * r];
        // The first lobe that a number chooses is the reflection, whose density is its probability.
        let found = reflects(&bsdf, mu as f32);
        glass_off = worst([glass_off, (found - exact(f64::from(mu as f32), 1.5).0).abs()]);
    }
    vec![
        Figure::at_most("share that glass reflects, at 2e4 angles: off Fresnel", glass_off, 4e-6),
        Figure::at_most("Schlick's largest error at index 1.5: less 0.0357", (most - 0.0357).abs(), 5e-5),
        Figure::at_most("cosine where it is: less 0.0875", (at - 0.0875).abs(), 1e-3),
        Figure::at_most(
            "Schlick's mean reflectance: less 0.04 + 0.96/21",
            (averages[0] - (0.04 + 0.96 / 21.0)).abs(),
            1e-6,
        ),
        Figure::at_most(
            "exact mean reflectance (O11): less 0.091777959",
            (averages[1] - 0.091_777_959).abs(),
            1e-6,
        ),
    ]
}

fn reflects(bsdf: &Bsdf, mu: f32) -> f64 {
    let sample = bsdf.sample(direction(mu), [0.0; 3], Transport::Radiance);
    sample.filter(|s| s.wi.z > 0.0).map_or(f64::NAN, |s| f64::from(s.pdf))
}

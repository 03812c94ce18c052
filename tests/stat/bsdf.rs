//! Materials as densities and as energy: what `sample` does must be what `f_and_pdf` says.

use std::f64::consts::{PI, TAU};

use epsilux::bsdf::{Bsdf, Transport};
use epsilux::color::Rgb;
use epsilux::glam::{DVec3, Vec3};
use epsilux::prepare::prepare;
use epsilux::sampling::{Address, Purpose};
use epsilux::scene::{MaterialKind, Principled, Scene};
use epsilux::stats::{Moments, sidak};

use crate::support::fast::{options, valid};
use crate::support::scenes::{Build, diffuse, principled};
use crate::support::seed::seed;

/// The compiled form of a material.
fn compile(kind: MaterialKind) -> Bsdf {
    // A material on no surface is not compiled.
    let mut scene = Scene::default();
    scene.sphere(DVec3::ZERO, 1.0, kind);
    let prepared = prepare(&valid(&scene), &options([1, 1], 0, None)).expect("a scene");
    prepared.materials[0].bsdf.clone()
}

/// Materials that have a density, by name.
fn rough() -> Vec<(String, Bsdf)> {
    let mut list = vec![("diffuse".to_owned(), compile(diffuse(0.7)))];
    for roughness in [0.05, 0.1, 0.3, 0.6, 1.0] {
        let mut add = |name: &str, change: fn(&mut Principled)| {
            let kind = principled(|p| {
                p.roughness = roughness;
                change(p);
            });
            list.push((format!("{name}, roughness {roughness}"), compile(kind)));
        };
        add("metal", |p| p.metallic = 1.0);
        add("plastic", |_| ());
        add("glass", |p| p.transmission = 1.0);
        add("sheet", |p| {
            p.transmission = 1.0;
            p.thin = true;
        });
        add("mixture", |p| {
            p.metallic = 0.3;
            p.transmission = 0.6;
            p.specular_color = Rgb::new(1.0, 0.5, 2.0);
        });
        add("coat of roughness", |p| (p.coat, p.coat_roughness) = (0.8, p.roughness));
        add("smooth coat", |p| (p.coat, p.coat_ior) = (1.0, 1.8));
        add("coated metal", |p| (p.coat, p.coat_roughness, p.metallic) = (1.0, 0.3, 1.0));
        add("coated rough glass", |p| (p.coat, p.coat_roughness, p.transmission) = (0.7, 0.6, 1.0));
        add("sheen of roughness", |p| {
            (p.sheen_color, p.sheen_roughness) = (Rgb::new(1.0, 0.5, 0.2), p.roughness);
        });
        add("sheen over coat over mixture", |p| {
            (p.sheen_color, p.coat, p.coat_roughness) = (Rgb::new(0.4, 0.5, 0.9), 0.6, 0.5);
            (p.metallic, p.transmission, p.thin) = (0.3, 0.5, true);
        });
    }
    list
}

/// Outgoing directions: from above and from below, straight to grazing.
fn outgoing() -> impl Iterator<Item = Vec3> {
    let at = |mu: f32| {
        let r = ((1.0 - mu) * (1.0 + mu)).sqrt();
        Vec3::new(0.6 * r, -0.8 * r, mu)
    };
    [1.0, 0.7, 0.3, 0.1, 0.01].into_iter().flat_map(move |mu| [at(mu), at(-mu)])
}

fn numbers(name: &str, index: u32) -> [f32; 3] {
    let u = Address::new(seed(name), 0, 0, index).block(0, Purpose::Test, 0, 0);
    [u[0], u[1], u[2]]
}

/// Guards the weight: what `sample` returns is f cos / pdf of the direction that it returns (N43), and is
/// as bright as the material's energy allows, for each sample on its own.
#[test]
fn weights_are_value_over_density() {
    for (name, bsdf) in rough() {
        for wo in outgoing() {
            for index in 0..2000 {
                let Some(s) = bsdf.sample(wo, numbers(&name, index), Transport::Radiance) else { continue };
                if s.delta {
                    // A smooth coat: the one direction of its own, which has no density to compare.
                    continue;
                }
                let (f, pdf) = bsdf.f_and_pdf(wo, s.wi, Transport::Radiance);
                let expected = f * (s.wi.z.abs() / pdf);
                let close = |a: f32, b: f32| (a - b).abs() <= 1e-4 * a.abs().max(b.abs());
                let same = (0..3).all(|c| close(s.weight[c], expected[c]));
                assert!(same && close(s.pdf, pdf), "{name} {wo}: {s:?}, expected {expected:?} and {pdf}");
                assert!((s.wi.length() - 1.0).abs() < 1e-5, "{name} {wo}: {s:?}");
            }
        }
    }
}

const RINGS: usize = 40;
const SECTORS: usize = 40;

/// The cell of a direction, in a grid of equal steps in both angles about `axis`, at whose poles lobes are
/// narrowest.
struct Grid {
    axis: Vec3,
    x: Vec3,
    y: Vec3,
}

impl Grid {
    fn new(axis: Vec3) -> Self {
        let (x, y) = axis.any_orthonormal_pair();
        Self { axis, x, y }
    }

    fn cell(&self, w: Vec3) -> usize {
        let (axis, w64) = (self.axis.as_dvec3(), w.as_dvec3());
        let theta = libm::atan2(axis.cross(w64).length(), axis.dot(w64));
        let angle = libm::atan2(f64::from(w.dot(self.y)), f64::from(w.dot(self.x)));
        let sector = (angle / TAU + 0.5) * SECTORS as f64;
        ((theta / PI * RINGS as f64) as usize).min(RINGS - 1) * SECTORS + (sector as usize).min(SECTORS - 1)
    }

    /// Integral of `density` over each cell, by the midpoint rule with `n` x `n` points.
    fn integrate(&self, n: usize, density: impl Fn(Vec3) -> f64) -> Vec<f64> {
        let mut cells = vec![0.0; RINGS * SECTORS];
        let (rings, sectors) = (RINGS * n, SECTORS * n);
        for i in 0..rings {
            let theta = PI * (i as f64 + 0.5) / rings as f64;
            let (r, z) = (libm::sin(theta), libm::cos(theta));
            let solid_angle = r * 2.0 * libm::sin(0.5 * PI / rings as f64) * TAU / sectors as f64;
            for k in 0..sectors {
                let phi = ((k as f64 + 0.5) / sectors as f64 - 0.5) * TAU;
                let (s, c) = (libm::sin(phi), libm::cos(phi));
                let w = self.axis.as_dvec3() * z + (self.x.as_dvec3() * c + self.y.as_dvec3() * s) * r;
                cells[i / n * SECTORS + k / n] += density(w.as_vec3()) * solid_angle;
            }
        }
        cells
    }
}

/// Probability that a chi-square number with `freedom` degrees of freedom is at least `x` (Wilson and
/// Hilferty, PNAS 17, 1931; good to a few per cent of a small probability for the freedoms used here).
fn chi_square_tail(x: f64, freedom: f64) -> f64 {
    let v = 2.0 / (9.0 * freedom);
    let z = (libm::cbrt(x / freedom) - (1.0 - v)) / v.sqrt();
    epsilux::stats::normal_cdf(-z)
}

/// Guards that directions come with the density that `f_and_pdf` states (N41), and that the density
/// integrates to one less what `sample` rejects (N42).
#[test]
fn directions_follow_their_density() {
    let samples = 40_000u32;
    let mut p_values = Vec::new();
    for (name, bsdf) in rough() {
        for wo in outgoing().filter(|w| w.z.abs() > 0.05) {
            let roughness: f64 = name.rsplit(' ').next().and_then(|r| r.parse().ok()).unwrap_or(1.0);
            if roughness < 0.5 {
                // Too narrow for a quadrature on a fixed grid; the next test looks at those.
                continue;
            }
            let grid = Grid::new(Vec3::new(-wo.x, -wo.y, wo.z));
            let density = |w: Vec3| f64::from(bsdf.f_and_pdf(wo, w, Transport::Radiance).1);
            let expected = grid.integrate(10, density);
            let mut counts = vec![0u32; expected.len()];
            let mut returned = 0u32;
            for index in 0..samples {
                // Independent numbers: the test assumes a multinomial distribution.
                let u = numbers(&format!("{name} {wo} {index}"), 0);
                if let Some(s) = bsdf.sample(wo, u, Transport::Radiance).filter(|s| !s.delta) {
                    counts[grid.cell(s.wi)] += 1;
                    returned += 1;
                }
            }
            let total: f64 = expected.iter().sum();
            let share = f64::from(returned) / f64::from(samples);
            let sigma = (share * (1.0 - share) / f64::from(samples)).sqrt();
            assert!(
                (total - share).abs() < 4.5 * sigma + 4e-3,
                "{name} {wo}: the density integrates to {total}, and {share} of the samples were returned"
            );
            let (mut x, mut freedom) = (0.0, -1.0);
            let (mut rest, mut rest_count) = (0.0, 0u32);
            for (&e, &n) in expected.iter().zip(&counts) {
                let e = e / total * f64::from(returned);
                if e < 10.0 {
                    (rest, rest_count) = (rest + e, rest_count + n);
                } else {
                    x += (f64::from(n) - e) * (f64::from(n) - e) / e;
                    freedom += 1.0;
                }
            }
            if rest >= 10.0 {
                x += (f64::from(rest_count) - rest) * (f64::from(rest_count) - rest) / rest;
                freedom += 1.0;
            } else {
                assert!(f64::from(rest_count) < rest + 30.0, "{name} {wo}: {rest_count} where {rest} belong");
            }
            p_values.push((chi_square_tail(x, freedom), name.clone(), wo));
        }
    }
    let n = p_values.len();
    let worst = p_values.iter().min_by(|a, b| a.0.total_cmp(&b.0)).expect("tests");
    assert!(sidak(worst.0, n) > 1e-3, "{} {}: p = {} among {n}", worst.1, worst.2, worst.0);
}

/// Mean weight of the directions that `bsdf` samples, per channel, and its standard error, from sixteen
/// independent replications.
fn albedo(name: &str, bsdf: &Bsdf, wo: Vec3) -> [Moments; 3] {
    let n = 1 << 11;
    let mut moments = [Moments::default(); 3];
    for replication in 0..16 {
        let mut sum = [0.0; 3];
        for index in 0..n {
            let u = Address::new(seed(name), 0, replication, index).block(0, Purpose::Test, 0, 0);
            // Importance leaves out the factor of radiance at refractions, and counts energy.
            if let Some(s) = bsdf.sample(wo, [u[0], u[1], u[2]], Transport::Importance) {
                (0..3).for_each(|c| sum[c] += f64::from(s.weight[c]));
            }
        }
        (0..3).for_each(|c| moments[c].add(sum[c] / f64::from(n)));
    }
    moments
}

/// Guards energy: white metal, white glass and a sheet scatter all that they receive, at every roughness
/// and angle, also in lobes too narrow to integrate (N39 with compensation, N42).
#[test]
fn white_materials_lose_nothing() {
    let mut failures = Vec::new();
    for (name, bsdf) in rough() {
        if !["metal", "glass", "sheet"].iter().any(|n| name.starts_with(n)) {
            continue;
        }
        for wo in outgoing().filter(|w| w.z.abs() > 0.05) {
            let found = albedo(&name, &bsdf, wo)[1];
            let error = 4.5 * found.variance_of_mean().sqrt();
            let (low, high) = (found.mean - 1.0 + error, found.mean - 1.0 - error);
            if low < -5e-3 || high > 1e-3 || error > 1e-2 {
                failures.push(format!("{name} {wo}: {} +- {error}", found.mean));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Guards against light from nothing: no direction of any material returns more than it received.
#[test]
fn no_material_amplifies() {
    let mut failures = Vec::new();
    for (name, bsdf) in rough() {
        // From inside glass, next to the critical angle, the table of total albedos is 2.5e-3 too low.
        let most = if name.starts_with("coated rough glass") { 1.004 } else { 1.001 };
        for wo in outgoing() {
            for found in albedo(&name, &bsdf, wo) {
                let error = 4.5 * found.variance_of_mean().sqrt();
                if found.mean - error > most || error > 0.05 {
                    failures.push(format!("{name} {wo}: {} +- {error}", found.mean));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

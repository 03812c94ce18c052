//! Energy of rough reflection.

use super::super::build::{beside, compile, principled, worst, z_score};
use super::super::random::Random;
use super::super::{Effort, Figure};
use super::{direction, facets};
use crate::bsdf::{Transport, ggx};
use crate::math::reflect;
use crate::sampling::{Address, Purpose};
use crate::stats::Moments;

/// The mean of `value` over sixteen sequences of uniform numbers.
fn mean(id: &str, samples: u64, value: impl Fn([f32; 3]) -> f64) -> Moments {
    let seed = Random::of(id).bits();
    let each = (samples / 16) as u32;
    let replication = |r| {
        let one = |i| {
            let u = Address::new(seed, 0, r, i).block(0, Purpose::Test, 0, 0);
            value([u[0], u[1], u[2]])
        };
        (0..each).map(one).sum::<f64>() / f64::from(each)
    };
    (0..16).map(replication).collect()
}

/// N39. White metal is the lobe with compensation; the lobe alone has the weight G2 / G1.
pub(super) fn furnace(effort: Effort) -> Vec<Figure> {
    let mut figures = Vec::new();
    // O15; the list has none for the narrowest lobe.
    let listed: [(f32, [Option<f64>; 3]); 5] = [
        (0.01, [None; 3]),
        (0.1, [0.988_304, 0.969_205, 0.883_455].map(Some)),
        (0.25, [0.915_812, 0.857_263, 0.891_622].map(Some)),
        (0.5, [0.687_849, 0.698_251, 0.860_105].map(Some)),
        (1.0, [0.306_853, 0.450_694, 0.760_210].map(Some)),
    ];
    let (mut oracle, mut single, mut single_z) = (0f64, 0f64, 0f64);
    let (mut white, mut bright) = (0f64, 0f64);
    for (alpha, values) in listed {
        let metal = compile(principled(|p| (p.metallic, p.roughness) = (1.0, alpha.sqrt())));
        for (mu, value) in [1.0, 0.5, 0.1f32].into_iter().zip(values) {
            let wo = direction(mu);
            let expected = facets::single_scattering(f64::from(mu), f64::from(alpha));
            if let Some(value) = value {
                oracle = worst([oracle, (expected - value).abs()]);
            }
            let id = format!("N39 {alpha} {mu}");
            let samples = effort.trials(1 << 16);
            let lambda_o = ggx::lambda(wo, alpha);
            let found = mean(&id, samples, |u| {
                let wi = reflect(wo, ggx::sample_visible_normal(wo, alpha, [u[0], u[1]]));
                let weight = (1.0 + lambda_o) * ggx::g2(lambda_o, ggx::lambda(wi, alpha));
                if wi.z > 0.0 { f64::from(weight) } else { 0.0 }
            });
            single = worst([single, (found.mean / expected - 1.0).abs()]);
            // The oracle's own error is not noise.
            single_z = worst([single_z, z_score(((found.mean - expected).abs() - 5e-6).max(0.0), &found)]);
            let Some(metal) = &metal else { return vec![Figure::exactly("compiled", f64::NAN, 1.0)] };
            let found = mean(&id, samples, |u| {
                metal.sample(wo, u, Transport::Radiance).map_or(0.0, |s| f64::from(s.weight.g))
            });
            let [error, _] = beside("", Some(found), 1.0, 0.0, 0.0);
            white = worst([white, error.value]);
            bright = bright.max(found.mean - 4.5 * found.variance_of_mean().sqrt());
        }
    }
    figures.extend([
        Figure::at_most("single scattering in closed form and list (O15), 12 lobes", oracle, 5e-6),
        Figure::at_most("single scattering, 15 lobes: relative error", single, 2e-3),
        Figure::at_most("single scattering, 15 lobes: standard errors off", single_z, 4.5),
        Figure::at_most("white metal, 15 lobes: mean weight less one", white, 5e-3),
        Figure::at_most("white metal, 15 lobes: brightest, less 4.5 standard errors", bright, 1.001),
    ]);
    figures
}

/// N40.
pub(super) fn weak_furnace(_: Effort) -> Vec<Figure> {
    let mut off = 0f64;
    for alpha in [0.01, 0.05, 0.1, 0.25, 0.5, 1.0f32] {
        for mu in [1.0, 0.5, 0.1f32] {
            let wo = direction(mu);
            let lambda_o = ggx::lambda(wo, alpha);
            let mut sum = 0.0;
            facets::normals(f64::from(alpha), 1500, 256, |_, _, m, solid_angle| {
                sum += f64::from(ggx::visible_normal_pdf(wo, m.as_vec3(), alpha, lambda_o)) * solid_angle;
            });
            off = worst([off, (sum - 1.0).abs()]);
        }
    }
    vec![Figure::at_most("integral over visible normals, 18 lobes: less one", off, 1e-6)]
}

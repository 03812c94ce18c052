//! The faults: what each mutant makes of the value at its place.
//!
//! In: the sound value first, then what the fault needs to know. Out: the sound value, unless this mutant is
//! planted. Faults are as small as the mistakes that they stand for, since a gate proves most by a small one.

use std::sync::OnceLock;

use glam::Vec3;

use super::Mutant;
use crate::color::{Rgb, linear_to_srgb};

/// Names the mutant to plant; absent or empty for none.
const VARIABLE: &str = "EPSILUX_MUTANT";

/// `sound`, or `faulty(sound)` where `mutant` is planted.
#[inline]
fn spoil<T>(mutant: Mutant, sound: T, faulty: impl FnOnce(T) -> T) -> T {
    static PLANTED: OnceLock<Option<Mutant>> = OnceLock::new();
    if *PLANTED.get_or_init(chosen) == Some(mutant) { faulty(sound) } else { sound }
}

/// The mutant that the environment asks for. A name that is none must not pass for the sound program, and
/// nobody but the referee of the tests gets here, so it ends the program.
fn chosen() -> Option<Mutant> {
    let name = std::env::var_os(VARIABLE).filter(|name| !name.is_empty())?;
    let found = Mutant::ALL.into_iter().find(|m| name == m.name());
    assert!(
        found.is_some(),
        "{VARIABLE} is {name:?}, expected one of: {}",
        Mutant::ALL.map(Mutant::name).join(", ")
    );
    found
}

/// Emitted radiance.
#[inline]
pub(crate) fn light_energy(le: Rgb) -> Rgb {
    spoil(Mutant::LightEnergy, le, |le| le * 1.01)
}

/// The cosine at the surface that is lit.
#[inline]
pub(crate) fn cosine_dropped(cos: f32) -> f32 {
    spoil(Mutant::CosineDropped, cos, |_| 1.0)
}

/// The weight of a sampled direction. Delta lobes have no density that could be wrong.
#[inline]
pub(crate) fn bsdf_pdf(weight: Rgb, delta: bool) -> Rgb {
    spoil(Mutant::BsdfPdf, weight, |weight| if delta { weight } else { weight / 0.97 })
}

/// The density per solid angle at `p` of the point `q` of a light with unit normal `n`.
#[inline]
pub(crate) fn mis_measure(pdf: f32, p: Vec3, q: Vec3, n: Vec3) -> f32 {
    spoil(Mutant::MisMeasure, pdf, |pdf| {
        let d = q - p;
        pdf * n.dot(d.normalize()).abs() / d.length_squared()
    })
}

/// The index of a chosen light, with its probability, out of `lights`.
#[inline]
pub(crate) fn light_dropped(choice: Option<(usize, f32)>, lights: usize) -> Option<(usize, f32)> {
    spoil(Mutant::LightDropped, choice, |choice| choice.filter(|(i, _)| lights == 1 || i + 1 < lights))
}

/// The factor on a path that survived.
#[inline]
pub(crate) fn roulette_uncompensated(factor: f32) -> f32 {
    spoil(Mutant::RouletteUncompensated, factor, |_| 1.0)
}

/// The factor on transmission for the quantity that is transported.
#[inline]
pub(crate) fn eta_squared(scale: f32, eta: f32) -> f32 {
    spoil(Mutant::EtaSquared, scale, |scale| scale * eta * eta)
}

/// Whether reflection is total, where the sine of the transmitted direction would be `sin_t`.
#[inline]
pub(crate) fn fresnel_angle(total: bool, sin_t: f64, eta: f32) -> bool {
    let eta = f64::from(eta);
    spoil(Mutant::FresnelAngle, total, |total| total || sin_t * eta * eta >= 1.0)
}

/// The step off a surface, metres.
#[inline]
pub(crate) fn origin_offset(step: f32) -> f32 {
    spoil(Mutant::OriginOffset, step, |_| 0.04)
}

/// The most scattering events.
#[inline]
pub(crate) fn depth_off_by_one(cap: u32) -> u32 {
    spoil(Mutant::DepthOffByOne, cap, |cap| cap.saturating_add(1))
}

/// The density of a reflected direction by way of the visible normal `m`, given `lambda_o` of `wo`.
#[inline]
pub(crate) fn ndf_pdf(pdf: f32, wo: Vec3, m: Vec3, lambda_o: f32) -> f32 {
    spoil(Mutant::NdfPdf, pdf, |pdf| pdf * m.z * (1.0 + lambda_o) * wo.z / wo.dot(m))
}

/// The number of a replication.
#[inline]
pub(crate) fn same_seed(replication: u32) -> u32 {
    spoil(Mutant::SameSeed, replication, |replication| replication & !1)
}

/// What a path adds to its radiance at one vertex.
#[inline]
pub(crate) fn clamp(radiance: Rgb) -> Rgb {
    spoil(Mutant::Clamp, radiance, |radiance| radiance.map(|v| v.min(10.0)))
}

/// Where in its pixel a camera ray passes, along one axis.
#[inline]
pub(crate) fn filter_shift(offset: f32) -> f32 {
    spoil(Mutant::FilterShift, offset, |offset| offset + 0.5)
}

/// A display-encoded colour.
#[inline]
pub(crate) fn gamma_twice(encoded: Rgb) -> Rgb {
    spoil(Mutant::GammaTwice, encoded, |encoded| encoded.map(linear_to_srgb))
}

/// Whether a light is so small that it is sampled by area.
#[inline]
pub(crate) fn area_sampling(small: bool) -> bool {
    spoil(Mutant::AreaSampling, small, |_| true)
}

/// The channels of a sample.
#[inline]
pub(crate) fn nan_black(channels: [f32; 3]) -> [f32; 3] {
    spoil(Mutant::NanBlack, channels, |c| if c.iter().any(|v| v.is_nan()) { [0.0; 3] } else { c })
}

/// The step off a surface, metres.
#[inline]
pub(crate) fn fixed_epsilon(step: f32) -> f32 {
    spoil(Mutant::FixedEpsilon, step, |_| 1e-4)
}

/// Where a ray along z meets a triangle of projected vertices; a distance of one is `1 / scale` along z.
#[inline]
pub(crate) fn moeller_trumbore<H>(
    found: Option<H>,
    vertices: [[f32; 3]; 3],
    scale: f32,
    hit: impl FnOnce([f32; 3]) -> H,
) -> Option<H> {
    spoil(Mutant::MoellerTrumbore, found, |_| {
        let [v0, v1, v2] = vertices.map(Vec3::from_array);
        let (e1, e2) = (v1 - v0, v2 - v0);
        let p = Vec3::Z.cross(e2);
        let q = (-v0).cross(e1);
        let [t, u, v] = [q.dot(e2) * scale, p.dot(-v0), q.z].map(|x| x / p.dot(e1));
        (t > 0.0 && t < f32::INFINITY && u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| hit([t, u, v]))
    })
}

/// Where the line of a ray from `o` along `d` meets the sphere.
#[inline]
pub(crate) fn sphere_pq(
    found: Option<(f64, f64)>,
    o: Vec3,
    d: Vec3,
    center: Vec3,
    radius: f32,
) -> Option<(f64, f64)> {
    spoil(Mutant::SpherePq, found, |_| {
        let m = o - center;
        let half_p = d.dot(m);
        let root = (half_p * half_p - (m.dot(m) - radius * radius)).sqrt();
        (root >= 0.0).then(|| (f64::from(-half_p - root), f64::from(-half_p + root)))
    })
}

/// Reflectance of a dielectric.
#[inline]
pub(crate) fn schlick_inside(r: f32, cos_i: f32, eta: f32) -> f32 {
    spoil(Mutant::SchlickInside, r, |_| {
        let f0 = (eta - 1.0) / (eta + 1.0);
        let rest = 1.0 - cos_i;
        f0 * f0 + (1.0 - f0 * f0) * (rest * rest) * (rest * rest) * rest
    })
}

/// The sum of the `n` samples of a cell, of which the last one made it from `before`.
#[inline]
pub(crate) fn running_mean(sum: i128, before: i128, n: u32) -> i128 {
    spoil(Mutant::RunningMean, sum, |sum| {
        let mean = if n > 1 { (before / i128::from(n - 1)) as f32 } else { 0.0 };
        let mean = mean + ((sum - before) as f32 - mean) / n as f32;
        (mean as i128).saturating_mul(i128::from(n))
    })
}

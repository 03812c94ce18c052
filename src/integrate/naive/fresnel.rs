//! Fresnel reflectance.

/// Unpolarised reflectance of a smooth dielectric: `cos` of the incident angle, [0, 1];
/// `eta` = n_transmitted / n_incident. One where nothing is transmitted.
pub(super) fn exact(cos: f64, eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    let Some(cos_t) = refracted_cos(cos, eta) else { return 1.0 };
    let perpendicular = (cos - eta * cos_t) / (cos + eta * cos_t);
    let parallel = (eta * cos - cos_t) / (eta * cos + cos_t);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// Cosine of the refracted angle by Snell's law; none under total reflection.
pub(super) fn refracted_cos(cos: f64, eta: f64) -> Option<f64> {
    let cos2 = 1.0 - (1.0 - cos) * (1.0 + cos) / (eta * eta);
    (cos2 > 0.0).then(|| cos2.sqrt())
}

/// Schlick's interpolation from `f0` to one.
pub(super) fn schlick(f0: glam::DVec3, cos: f64) -> glam::DVec3 {
    let c = (1.0 - cos).clamp(0.0, 1.0);
    f0 + (1.0 - f0) * (c * c * c * c * c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the formula at normal incidence, Brewster's angle, grazing, total reflection and just
    /// before it (values: closed form, n = 1.5).
    #[test]
    fn known_reflectances() {
        let check = |cos: f64, eta: f64, expected: f64| {
            let r = exact(cos, eta);
            assert!((r - expected).abs() < 1e-6, "{cos} {eta}: {r}, expected {expected}");
        };
        check(1.0, 1.5, 0.04);
        check(1.0, 1.0 / 1.5, 0.04);
        check(0.5, 1.0, 0.0);
        check(0.0, 1.5, 1.0);
        let brewster = libm::atan(1.5);
        let perpendicular = -libm::cos(2.0 * brewster);
        check(libm::cos(brewster), 1.5, 0.5 * perpendicular * perpendicular);
        let critical = libm::asin(1.0 / 1.5);
        check(libm::cos(critical - 0.1), 1.0 / 1.5, 0.100_282);
        check(libm::cos(critical - 0.0001), 1.0 / 1.5, 0.917_238);
        check(libm::cos(critical + 0.0001), 1.0 / 1.5, 1.0);
    }
}

//! Radiometry that can be written down: the values that integrators are measured against, in f64.

use std::f64::consts::PI;

use glam::DVec3;

/// Irradiance at the origin, normal `n`, from a convex polygon of radiance one (Lambert's formula),
/// whose part below the horizon is cut off.
#[must_use]
pub fn polygon_irradiance(corners: &[DVec3], n: DVec3) -> f64 {
    let mut visible = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (height_a, height_b) = (a.dot(n), b.dot(n));
        if height_a >= 0.0 {
            visible.push(a);
        }
        if height_a * height_b < 0.0 {
            visible.push(a + (b - a) * (height_a / (height_a - height_b)));
        }
    }
    let edge = |i: usize| {
        let (a, b) = (visible[i], visible[(i + 1) % visible.len()]);
        let cross = a.cross(b);
        let angle = libm::atan2(cross.length(), a.dot(b));
        cross.try_normalize().map_or(0.0, |axis| angle * axis.dot(n))
    };
    0.5 * (0..visible.len()).map(edge).sum::<f64>().abs()
}

/// Irradiance on the axis of a disk of radiance one that the receiver faces.
#[must_use]
pub fn disk_irradiance(radius: f64, distance: f64) -> f64 {
    PI * radius * radius / (radius * radius + distance * distance)
}

/// Irradiance from a sphere of radiance one whose centre is `distance` away, `tilt` radians off the
/// receiver's normal; the horizon may cut it (J. M. Snyder, "Area Light Sources for Real-Time
/// Graphics", Microsoft Research, 1996).
#[must_use]
pub fn sphere_irradiance(radius: f64, distance: f64, tilt: f64) -> f64 {
    let h = distance / radius;
    let (sin, cos) = (libm::sin(tilt), libm::cos(tilt));
    if cos * h >= 1.0 {
        return PI * cos / (h * h);
    }
    if cos * h <= -1.0 {
        return 0.0;
    }
    let x = (h * h - 1.0).sqrt();
    let y = (-x * cos / sin).clamp(-1.0, 1.0);
    let s = sin * (1.0 - y * y).sqrt();
    (cos * libm::acos(y) - x * s) / (h * h) + libm::atan(s / x)
}

/// Radiance of a room that emits `le` and reflects `rho` everywhere, after at most `depth` events.
#[must_use]
pub fn room_radiance(le: f64, rho: f64, depth: Option<u32>) -> f64 {
    let lost = depth.map_or(0.0, |k| (0..=k).fold(1.0, |p, _| p * rho));
    le * (1.0 - lost) / (1.0 - rho)
}

/// Radiance of a spherical shell of reflectance `rho` around a concentric sphere that emits `le` and
/// reflects `rho_emitter`; `ratio` is the radius of the emitter over that of the shell.
#[must_use]
pub fn shell_radiance(ratio: f64, le: f64, rho: f64, rho_emitter: f64) -> f64 {
    let x = ratio * ratio;
    rho * x * le / (1.0 - rho * (1.0 - x) - rho * rho_emitter * x)
}

/// Form factor between two unit squares that face each other at distance one (Howell, C-11).
#[must_use]
pub fn parallel_squares() -> f64 {
    let root = libm::sqrt(2.0);
    2.0 / PI * (0.5 * libm::log(4.0 / 3.0) + 2.0 * root * libm::atan(1.0 / root) - 0.5 * PI)
}

/// Form factor between two unit squares that share an edge at a right angle (Howell, C-14).
#[must_use]
pub fn perpendicular_squares() -> f64 {
    let root = libm::sqrt(2.0);
    (0.5 * PI - root * libm::atan(1.0 / root) + 0.25 * libm::log(0.75)) / PI
}

/// Reflectance of a smooth dielectric from the angle of incidence in radians, by Fresnel's sine and tangent
/// laws; `eta` = n_transmitted / n_incident.
#[must_use]
pub fn fresnel(angle: f64, eta: f64) -> f64 {
    let sin_t = libm::sin(angle) / eta;
    if sin_t >= 1.0 {
        return 1.0;
    }
    let t = libm::asin(sin_t);
    let (sum, difference) = (angle + t, angle - t);
    if sum < 1e-6 {
        let r = (eta - 1.0) / (eta + 1.0);
        return r * r;
    }
    let s = libm::sin(difference) / libm::sin(sum);
    let p = libm::tan(difference) / libm::tan(sum);
    0.5 * (s * s + p * p)
}

/// Transmittance of `plates` parallel slabs of index `n`, all interreflections included.
#[must_use]
pub fn slab_transmittance(angle: f64, n: f64, plates: f64) -> f64 {
    let r = fresnel(angle, n);
    (1.0 - r) / (1.0 + (2.0 * plates - 1.0) * r)
}

/// Transmittance of thick parallel layers with these indices, in vacuum, all interreflections included: what
/// two interfaces let pass obeys 1/T - 1 = R1/(1-R1) + R2/(1-R2), and so do any number.
#[must_use]
pub fn layers_transmittance(angle: f64, indices: &[f64]) -> f64 {
    let sin = libm::sin(angle);
    let at = |i: usize| if i == 0 || i > indices.len() { 1.0 } else { indices[i - 1] };
    let resistance = |i: usize| {
        let r = fresnel(libm::asin(sin / at(i)), at(i + 1) / at(i));
        r / (1.0 - r)
    };
    1.0 / (1.0 + (0..=indices.len()).map(resistance).sum::<f64>())
}

/// Deflection of a ray that passes a ball of radius one and index `n` at impact parameter `b`, radians.
#[must_use]
pub fn ball_deflection(b: f64, n: f64) -> f64 {
    2.0 * (libm::asin(b) - libm::asin(b / n))
}

/// Radiance seen at impact parameter `b` of a glass ball of radius one around a concentric sphere that
/// reflects `rho` diffusely and emits `le`, under a sky of radiance `sky`; the ray meets the core.
///
/// Light that leaves the core meets the ball's surface, and what is reflected there returns to the core:
/// the core's radiance is L = le + rho (n^2 (1 - R) sky + R L), R the cosine-weighted mean reflectance.
#[must_use]
pub fn ball_with_core(b: f64, n: f64, core_radius: f64, rho: f64, le: f64, sky: f64) -> f64 {
    // The substitution s = sin^2 of the angle at the core makes the weight uniform.
    let steps = 100_000;
    let mean: f64 = (0..steps)
        .map(|i| {
            let s = (f64::from(i) + 0.5) / f64::from(steps);
            fresnel(libm::asin(core_radius * s.sqrt()), 1.0 / n)
        })
        .sum::<f64>()
        / f64::from(steps);
    let core = (le + rho * n * n * (1.0 - mean) * sky) / (1.0 - rho * mean);
    let r = fresnel(libm::asin(b), n);
    r * sky + (1.0 - r) * core / (n * n)
}

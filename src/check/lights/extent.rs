//! The extent of lights as a point sees it.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::super::build::worst;
use super::super::random::Random;
use super::super::{Effort, Figure};
use crate::light::{Rectangle, TriangleLight};
use crate::stats::{normal_cdf, sidak};

/// Solid angle of a triangle (Van Oosterom and Strackee, 1983), from differences of its corners.
fn triangle_solid_angle(v: [Vec3; 3], p: Vec3) -> f64 {
    let [a, b, c] = v.map(|v| v.as_dvec3() - p.as_dvec3());
    let volume = a.dot((b - a).cross(c - a)).abs();
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    2.0 * libm::atan2(volume, la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
}

/// The same as the sum of cos / d^2 over the middles of n^2 equal parts.
fn triangle_by_parts(v: [Vec3; 3], p: Vec3, n: u32) -> f64 {
    let [a, b, c] = v.map(|v| v.as_dvec3() - p.as_dvec3());
    let normal = (b - a).cross(c - a);
    let part = |i: u32, k: u32, third: f64| {
        let (s, t) = ((f64::from(i) + third) / f64::from(n), (f64::from(k) + third) / f64::from(n));
        let q = a + (b - a) * s + (c - a) * t;
        normal.dot(q).abs() / (q.length_squared() * q.length())
    };
    let mut sum = 0.0;
    for i in 0..n {
        for k in 0..n - i {
            sum += part(i, k, 1.0 / 3.0);
            if i + k + 1 < n {
                sum += part(i, k, 2.0 / 3.0);
            }
        }
    }
    sum * 0.5 / (f64::from(n) * f64::from(n))
}

/// A triangle with edges of about `edge`, at distance one along +Z, whose plane is `tilt` radians off the ray to it.
fn random_triangle(random: &mut Random, edge: f64, tilt: f64) -> [Vec3; 3] {
    let turn = random.between(0.0, TAU);
    let (s, c) = libm::sincos(tilt);
    // Seen from the front the plane is spanned by x and y; edge-on, one axis points away.
    let (x, y) = (DVec3::X, DVec3::new(0.0, s, c));
    let (st, ct) = libm::sincos(turn);
    let (x, y) = (x * ct + y * st, y * ct - x * st);
    let corner = |i: u32, random: &mut Random| {
        let (s, c) = libm::sincos(f64::from(i) * TAU / 3.0);
        let r = 0.577 * edge * random.between(0.6, 1.0);
        (DVec3::Z + (x * c + y * s) * r).as_vec3()
    };
    [corner(0, random), corner(1, random), corner(2, random)]
}

/// Relative error of the mean of 1 / density over samples, which is the solid angle: below a millionth of a steradian
/// the density is that of a uniform point, and varies a little over the triangle.
fn triangle_error(v: [Vec3; 3], expected: f64) -> f64 {
    let Some(light) = TriangleLight::new(v) else { return f64::NAN };
    let (n, mut sum) = (6u32, 0.0);
    for i in 0..n * n {
        let u = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
        let Some(s) = light.sample(Vec3::ZERO, u) else { return f64::NAN };
        let pdf = light.pdf(Vec3::ZERO, s.p);
        // Where it varies it does so with the point as rounded.
        if (pdf / s.pdf - 1.0).abs() > 1e-5 {
            return f64::NAN;
        }
        sum += 1.0 / f64::from(pdf);
    }
    (sum / f64::from(n * n) / expected - 1.0).abs()
}

/// N47.
pub(super) fn triangles(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N47");
    let count = effort.trials(20_000);
    let mut errors = [[0f64; 2]; 2];
    let mut oracle = 0f64;
    let frontal = (0.5 * PI, [4e-5, 4e-9]);
    let grazing = (1f64.to_radians(), [7e-5, 7e-7]);
    for (error, (tilt, floors)) in errors.iter_mut().zip([frontal, grazing]) {
        for i in 0..count {
            // Edges from 100 to 1e-4; a plane seen edge-on must not reach around the eye.
            let most = if tilt < 1.0 { 0.5 } else { 100.0 };
            let edge = libm::exp(random.between(libm::log(1e-4), libm::log(most)));
            let v = random_triangle(&mut random, edge, tilt);
            let expected = triangle_solid_angle(v, Vec3::ZERO);
            if let Some(class) = floors.iter().position(|&floor| expected >= floor) {
                error[class] = worst([error[class], triangle_error(v, expected)]);
            }
            if i % 100 == 0 && edge < 0.3 {
                oracle = worst([oracle, (triangle_by_parts(v, Vec3::ZERO, 100) / expected - 1.0).abs()]);
            }
        }
    }
    let [[front, front_small], [edge_on, edge_on_small]] = errors;
    vec![
        Figure::at_most("oracle against a sum over 1e4 parts, relative", oracle, 1e-4),
        Figure::at_most(
            format!("solid angle, frontal, 4e-5 sr and more, of {count:e} triangles: relative error"),
            front,
            2e-5,
        ),
        Figure::at_most("solid angle, frontal, 4e-9 to 4e-5 sr: relative error", front_small, 5e-4),
        Figure::at_most("solid angle, 1 degree, 7e-5 sr and more: relative error", edge_on, 5e-5),
        Figure::at_most("solid angle, 1 degree, 7e-7 to 7e-5 sr: relative error", edge_on_small, 6e-4),
    ]
}

/// Solid angle of a rectangle, from its four corners in its own axes.
fn rectangle_solid_angle(x: [f64; 2], y: [f64; 2], z: f64) -> f64 {
    let corner = |x: f64, y: f64| libm::atan2(x * y, z * (x * x + y * y + z * z).sqrt());
    corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0])
}

/// N48.
pub(super) fn rectangles(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N48");
    let (mut error, mut same, mut bad) = (0f64, 0f64, 0.0);
    let count = effort.trials(20_000);
    for _ in 0..count {
        // Edges between 1e-2 and 100 at distance one from the plane, beside the point by up to three edges.
        let edge = |r: &mut Random| libm::exp(r.between(libm::log(1e-2), libm::log(100.0))) as f32;
        let (a, b) = (edge(&mut random), edge(&mut random));
        let corner =
            Vec3::new(a * random.between(-3.0, 3.0) as f32, b * random.between(-3.0, 3.0) as f32, 1.0);
        let Some(light) = Rectangle::new(corner, [Vec3::X * a, Vec3::Y * b]) else {
            bad += 1.0;
            continue;
        };
        let u = [random.unit_f32(), random.unit_f32()];
        let Some(s) = light.sample(Vec3::ZERO, u) else {
            bad += 1.0;
            continue;
        };
        let [x, y] = [(corner.x, a), (corner.y, b)].map(|(o, e)| [f64::from(o), f64::from(o) + f64::from(e)]);
        let expected = rectangle_solid_angle(x, y, 1.0);
        // The corner formula cancels where the rectangle looks small.
        if expected > 1e-6 {
            error = worst([error, (f64::from(s.pdf) * expected - 1.0).abs()]);
        }
        same = worst([same, (f64::from(light.pdf(Vec3::ZERO, s.p) / s.pdf) - 1.0).abs()]);
        bad += f64::from(!light.contains(s.p) && !next_to(&light, s.p));
    }
    vec![
        Figure::at_most(
            format!("density times solid angle, edges 1e-2..100, {count:e} rectangles: less one"),
            error,
            2e-5,
        ),
        Figure::at_most("density of a sample and of its point: relative difference", same, 1e-5),
        Figure::exactly("samples that failed or left the rectangle", bad, 0.0),
        Figure::at_least(
            "chi-square of samples, 6 views of 256 cells, p of the worst",
            chi_square(effort),
            1e-3,
        ),
    ]
}

/// Whether a point is outside by rounding only.
fn next_to(light: &Rectangle, p: Vec3) -> bool {
    let corners = light.corners();
    let middle = (corners[0] + corners[3]) * 0.5;
    light.contains(middle + (p - middle) * (1.0 - 16.0 * f32::EPSILON))
}

/// Samples on a unit square in cells of 1/16: as many as the cells' solid angles have it. Where the square is large and
/// close the cells are very unequal; those that expect fewer than five share a class.
fn chi_square(effort: Effort) -> f64 {
    let n = 16usize;
    let samples = effort.trials(100_000);
    let views = [
        [0.5, 0.5, 1.0],
        [0.5, 0.5, 0.01],
        [0.0, 0.0, 0.1],
        [3.0, 1.0, 0.5],
        [1.0, 0.5, 0.05],
        [-20.0, 4.0, 9.0],
    ];
    let one = |[x, y, z]: [f64; 3]| {
        let corner = Vec3::new(-x as f32, -y as f32, z as f32);
        let Some(light) = Rectangle::new(corner, [Vec3::X, Vec3::Y]) else { return f64::NAN };
        let mut random = Random::of(&format!("N48 {x} {y} {z}"));
        let mut counts = vec![0u32; n * n];
        for _ in 0..samples {
            let Some(s) = light.sample(Vec3::ZERO, [random.unit_f32(), random.unit_f32()]) else {
                return f64::NAN;
            };
            let cell = |v: f32| ((f64::from(v) * n as f64) as usize).min(n - 1);
            counts[cell(s.p.x - corner.x) * n + cell(s.p.y - corner.y)] += 1;
        }
        let at = |o: f64, i: usize| [o + i as f64 / n as f64, o + (i + 1) as f64 / n as f64];
        let expected: Vec<f64> =
            (0..n * n).map(|i| rectangle_solid_angle(at(-x, i / n), at(-y, i % n), z)).collect();
        chi_square_p(&expected, &counts)
    };
    sidak(
        views.into_iter().map(one).fold(1.0, |a: f64, b| if b.is_nan() { b } else { a.min(b) }),
        views.len(),
    )
}

/// Probability of counts at least as far from `expected`, up to a factor. Cells that expect fewer than five share a class. The tail is that of Wilson and Hilferty (PNAS 17, 1931).
pub(in super::super) fn chi_square_p(expected: &[f64], counts: &[u32]) -> f64 {
    let total: f64 = expected.iter().sum();
    let n = f64::from(counts.iter().sum::<u32>());
    let (mut x, mut freedom) = (0.0, -1.0);
    let (mut rest, mut rest_count) = (0.0, 0.0);
    let mut add = |e: f64, count: f64| {
        x += (count - e) * (count - e) / e;
        freedom += 1.0;
    };
    for (&e, &count) in expected.iter().zip(counts) {
        let e = e / total * n;
        if e >= 5.0 {
            add(e, f64::from(count));
        } else {
            (rest, rest_count) = (rest + e, rest_count + f64::from(count));
        }
    }
    if rest >= 5.0 {
        add(rest, rest_count);
    }
    if freedom < 1.0 {
        return f64::NAN;
    }
    let v = 2.0 / (9.0 * freedom);
    normal_cdf(-(libm::cbrt(x / freedom) - (1.0 - v)) / v.sqrt())
}

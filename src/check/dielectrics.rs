//! Hard cases about dielectrics: Fresnel's equations, refraction, slabs, balls with a core, and what is inside.

mod nested;
mod scenes;

use glam::{DVec3, Vec3};

use super::closed_forms::fresnel;
use super::random::Random;
use super::stage::larger;
use super::{Case, Class, Effort, Figure};
use crate::bsdf::fresnel::{Fresnel, dielectric, refract};
use crate::bsdf::{Glass, Transport};
use crate::color::Rgb;
use crate::math::{Frame, ONE_MINUS_EPSILON};
use crate::shape::{Ray, offset_origin, sphere};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N27",
        class: Class::Unit,
        guards: "Reflectances are Fresnel's, what is not reflected is transmitted, and nothing reflects where \
                 the index does not change.",
        run: reflectances,
    },
    Case {
        id: "N28",
        class: Class::Unit,
        guards: "Reflectance rises to total reflection without a step, and no cosine makes it leave [0, 1].",
        run: critical_angle,
    },
    Case {
        id: "N29",
        class: Class::Unit,
        guards: "No ray that entered a solid ball from outside is reflected totally inside.",
        run: solid_balls,
    },
    Case { id: "N30", class: Class::Unit, guards: "Refraction in and back is the identity.", run: reversal },
    Case {
        id: "N31",
        class: Class::Statistical,
        guards: "A slab transmits what the series of its inner reflections adds up to, at grazing incidence too.",
        run: scenes::slabs,
    },
    Case {
        id: "N33",
        class: Class::Statistical,
        guards: "A diffuse core in a glass ball looks as bright as the balance of its light says.",
        run: scenes::diffuse_cores,
    },
    Case {
        id: "N34",
        class: Class::Statistical,
        guards: "Light that leaves glass loses the square of the index; a furnace would not notice.",
        run: scenes::emissive_cores,
    },
    Case {
        id: "N35",
        class: Class::Statistical,
        guards: "A gap between two slabs reflects twice, however thin; slabs that touch or overlap under an order \
                 of priorities are one.",
        run: nested::slabs,
    },
    Case {
        id: "N36",
        class: Class::Statistical,
        guards: "Water in glass reflects what the step of the index between them says, whether it touches the \
                 glass or overlaps it, and absorbs where it is.",
        run: nested::water_in_glass,
    },
    Case {
        id: "N37",
        class: Class::Statistical,
        guards: "Cameras and lights inside glass, and air inside glass, see and give what they should.",
        run: scenes::inside,
    },
];

fn reflectances(effort: Effort) -> Vec<Figure> {
    let count = effort.trials(100_000);
    let mut figures = Vec::new();
    for eta in [1.0 + 1e-6, 1.33, 1.5, 2.4, 1.0 / 1.5, 0.5, 4.0f32] {
        let n = f64::from(eta);
        let critical = if n < 1.0 { libm::asin(n) } else { f64::INFINITY };
        let (mut off, mut sum) = (0.0f64, 0.0f64);
        for i in 0..=count {
            let mu = (i as f64 / count as f64) as f32;
            let (r, cos_t) = dielectric(mu, eta);
            let angle = libm::acos(f64::from(mu));
            if (angle - critical).abs() > 1e-4 {
                off = larger(off, f64::from(r) - fresnel(angle, n));
            }
            // What is transmitted, from the amplitudes of both polarisations.
            let (mu, cos_t) = (f64::from(mu), f64::from(cos_t));
            if mu > 0.0 {
                let (s, p) = (2.0 * mu / (mu + n * cos_t), 2.0 * mu / (n * mu + cos_t));
                sum = larger(sum, f64::from(r) + 0.5 * n * cos_t / mu * (s * s + p * p) - 1.0);
            }
        }
        let what = format!("index {eta}, {count} cosines");
        figures.push(Figure::at_most(format!("{what}: error of the reflectance"), off, 4e-6));
        figures.push(Figure::at_most(format!("{what}: R + T - 1"), sum, 4e-6));
        // At Brewster's angle the parallel part vanishes, so that all of R is half of the other one.
        let mu = libm::cos(libm::atan(n)) as f32;
        let m = f64::from(mu);
        let cos_t = (1.0 - (1.0 - m * m) / (n * n)).sqrt();
        let s = (m - n * cos_t) / (m + n * cos_t);
        let parallel = 2.0 * f64::from(dielectric(mu, eta).0) - s * s;
        figures.push(Figure::at_most(format!("index {eta}: R_p at Brewster's angle"), parallel.abs(), 1e-7));
    }
    let mut same = 0.0f64;
    for i in 0..=count {
        let mu = (i as f64 / count as f64) as f32;
        let (r, cos_t) = dielectric(mu, 1.0);
        same = larger(same, f64::from(r)).max(f64::from((cos_t - mu).abs()));
    }
    figures.push(Figure::exactly(format!("index 1, {count} cosines: reflectance, and bending"), same, 0.0));
    figures
}

fn critical_angle(effort: Effort) -> Vec<Figure> {
    let critical = libm::asin(1.0 / 1.5);
    let at = |angle: f64| f64::from(dielectric(libm::cos(angle) as f32, 1.0 / 1.5).0);
    let mut figures = Vec::new();
    for (before, listed) in [(0.1, 0.100_282), (0.01, 0.439_576), (1e-3, 0.763_641), (1e-4, 0.917_238)] {
        let angle = critical - before;
        let name = format!("{before} rad before the critical angle");
        figures.push(Figure::at_most(format!("{name}: error of R"), (at(angle) - listed).abs(), 2e-3));
    }
    for before in [1e-5, 1e-6] {
        let off = (at(critical - before) - fresnel(critical - before, 1.0 / 1.5)).abs();
        figures.push(Figure::at_most(
            format!("{before} rad before the critical angle: error of R"),
            off,
            2e-3,
        ));
    }
    figures.push(Figure::at_least("R 1e-4 rad before the critical angle", at(critical - 1e-4), 0.9));
    let after = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1].map(|d| at(critical + d));
    let least = after.into_iter().fold(1.0, f64::min);
    figures.push(Figure::exactly("least R from 1e-6 to 0.1 rad after the critical angle", least, 1.0));

    let steps = effort.trials(200_000);
    let (mut last, mut fall) = (0.0, 0.0f64);
    for i in 0..=steps {
        let r = at(critical * i as f64 / steps as f64);
        fall = larger(fall, (last - r).max(0.0));
        last = r;
    }
    let what = format!("largest fall of R in {steps} steps to the critical angle");
    // Near normal incidence R grows with the fourth power of the angle only, so that rounding shows.
    figures.push(Figure::at_most(what, fall, 1e-6));

    let mut random = Random::of("N28");
    let trials = effort.trials(2_000_000);
    let mut wrong = 0u64;
    for i in 0..trials {
        let cos = match i {
            0 => 0.0,
            1 => 1.0,
            2 => 1.0 + f32::EPSILON,
            3 => f32::from_bits(1),
            4 => ONE_MINUS_EPSILON,
            // Half of them around the critical cosine of whatever index comes.
            _ => random.unit_f32(),
        };
        let eta = (0.4 + 2.2 * random.unit_f32()).max(0.4);
        let near = (1.0 - eta * eta).max(0.0).sqrt() * (1.0 + 1e-5 * (random.unit_f32() - 0.5));
        let (r, cos_t) = dielectric(if i > 4 && i % 2 == 0 { near } else { cos }, eta);
        wrong += u64::from(!((0.0..=1.0).contains(&r) && (0.0..=1.0).contains(&cos_t)));
    }
    figures.push(Figure::exactly(format!("R or cosine outside [0, 1], of {trials}"), wrong as f64, 0.0));
    figures
}

/// The transmitted direction at a point of a sphere, where light is not reflected whatever the chance; in
/// world space.
fn transmitted(ior: f32, n: Vec3, d: Vec3) -> Option<Vec3> {
    let frame = Frame::from_z(n);
    let wo = frame.to_local(-d);
    let glass = Glass { ior, tint: Rgb::WHITE, thin: false, fresnel: Fresnel::Exact };
    let sample = glass.sample(wo, ONE_MINUS_EPSILON, Transport::Radiance)?;
    (sample.wi.z * wo.z < 0.0).then(|| frame.to_world(sample.wi).normalize())
}

fn solid_balls(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N29");
    let trials = effort.trials(1_000_000);
    let (mut met, mut total, mut lost, mut angle) = (0u64, 0u64, 0u64, 0.0f64);
    for i in 0..trials {
        // Half of the rays uniform over the disc, half close to its rim.
        let b = if i % 2 == 0 {
            (1.0 - 1e-6) * random.unit().sqrt()
        } else {
            1.0 - libm::exp(random.between(libm::log(1e-6), 0.0))
        };
        let d = random.direction();
        let (x, _) = d.as_dvec3().normalize().any_orthonormal_pair();
        let ray = Ray::new((x * b - d.as_dvec3() * 3.0).as_vec3(), d);
        let Some(t) = sphere::first_hit(&ray, Vec3::ZERO, 1.0, false) else { continue };
        met += 1;
        let (p, p_err, n) = sphere::point(&ray, t, Vec3::ZERO, 1.0);
        let Some(wi) = transmitted(1.5, n, d) else {
            lost += 1;
            continue;
        };
        let inside = Ray::new(offset_origin(p, p_err, n, wi), wi);
        let Some(t) = sphere::first_hit(&inside, Vec3::ZERO, 1.0, true) else {
            lost += 1;
            continue;
        };
        let (_, _, n) = sphere::point(&inside, t, Vec3::ZERO, 1.0);
        match transmitted(1.5, n, wi) {
            None => total += 1,
            Some(out) if b <= 0.9 => {
                // The ray is turned at both points by the difference of its angles.
                let expected = 2.0 * (libm::asin(b) - libm::asin(b / 1.5));
                let (a, c) = (d.as_dvec3(), out.as_dvec3());
                angle = larger(angle, libm::atan2(a.cross(c).length(), a.dot(c)) - expected);
            }
            Some(_) => {}
        }
    }
    let what = format!("{met} rays at impact parameters up to 1 - 1e-6");
    vec![
        Figure::exactly(format!("{what}: total reflections inside"), total as f64, 0.0),
        Figure::exactly(format!("{what}: rays that do not come in, or never out"), lost as f64, 0.0),
        Figure::at_most(format!("{what}: error of the deflection up to 0.9, rad"), angle, 4e-6),
    ]
}

fn reversal(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N30");
    let trials = effort.trials(300_000);
    let mut figures = Vec::new();
    for eta in [1.33, 1.5, 2.4f32] {
        let mut magnified = 0.0f64;
        for _ in 0..trials {
            let mu = random.between(1e-2, 1.0);
            let (s, c) = libm::sincos(std::f64::consts::TAU * random.unit());
            let r = ((1.0 - mu) * (1.0 + mu)).sqrt();
            let wo = DVec3::new(r * c, r * s, mu).as_vec3();
            let (_, cos_t) = dielectric(wo.z, eta);
            let inside = refract(wo, Vec3::Z, wo.z, cos_t, eta).normalize();
            let (_, cos_back) = dielectric(-inside.z, 1.0 / eta);
            let back = refract(inside, -Vec3::Z, -inside.z, cos_back, 1.0 / eta).normalize().as_dvec3();
            let out = wo.as_dvec3();
            let angle = libm::atan2(back.cross(out).length(), back.dot(out));
            magnified = larger(magnified, angle * mu / f64::from(eta));
        }
        // The list asks for 4e-7 of the angle itself. The direction inside is rounded, whatever the arithmetic,
        // and from n sin_t = sin_o its rounding comes out n cos_t / mu times as large: what can be bounded is
        // the angle over n / mu.
        let what = format!("index n = {eta}, {trials} directions: angle * mu / n for mu >= 0.01, rad");
        figures.push(Figure::at_most(what, magnified, 4e-7));
    }
    figures
}

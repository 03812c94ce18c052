//! Light as it leaves: where photons start, which way, and with how much power.
//!
//! In: eight uniform numbers. Out: a ray from a light that is aimed at what throws light on ([`Aim`]), and the
//! power that it carries so that the mean over all photons is the light of all lights. A light is chosen by
//! the flux that it sends to the targets, a place on it uniformly, and a direction by [`Aim`]; from infinitely
//! far away the direction comes first, and the place is one on a disk around a target.

use glam::Vec3;

use super::aim::Aim;
use super::set::sun_radiance;
use super::{Emitter, LightId, LightSet, Spot, SurfaceSample};
use crate::accel::PrimitiveId;
use crate::color::Rgb;
use crate::math::{Frame, gamma};
use crate::mutants::planted;
use crate::sampling::Discrete;
use crate::sampling::warp::{
    SQUARE_TO_SPHERE_PDF, square_to_cone, square_to_cone_pdf, square_to_sphere, square_to_triangle,
};
use crate::shape::{Ray, offset_origin};

/// A photon that leaves a light.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Which light.
    pub light: LightId,
    /// Its way.
    pub ray: Ray,
    /// The primitive that it leaves.
    pub from: PrimitiveId,
    /// Power over density, W: the mean over photons is the flux of all lights towards the targets.
    pub power: Rgb,
    /// Where on the light it starts.
    pub p: Vec3,
    /// Cosine at which it leaves a surface, (0, 1]; one where it leaves none.
    pub cos: f32,
}

/// Everything that photons start from, and what they are aimed at.
#[derive(Clone, Debug)]
pub struct PhotonLights {
    aim: Aim,
    choice: Discrete,
    /// Every point of the scene is nearer to every target's middle than this, metres.
    reach: f32,
}

impl PhotonLights {
    /// The lights of `lights`, aimed at `aim` in a scene that a ball of `scene_radius` holds.
    #[must_use]
    pub fn new(lights: &LightSet, aim: Aim, scene_radius: f64) -> Self {
        let weights: Vec<f64> = lights.emitters().iter().map(|e| flux(e, &aim)).collect();
        let largest = aim.targets().iter().map(|t| t.ball.radius).fold(0.0, f32::max);
        Self { choice: Discrete::new(&weights), reach: 2.5 * scene_radius as f32 + largest, aim }
    }

    /// What is aimed at.
    #[must_use]
    pub fn aim(&self) -> &Aim {
        &self.aim
    }

    /// A photon; `None` where the numbers give none, which counts as one without power.
    #[must_use]
    pub fn emit(&self, lights: &LightSet, u: [f32; 4], v: [f32; 4]) -> Option<Emission> {
        let (i, pmf, _) = self.choice.sample(u[0])?;
        let light = LightId(i as u32);
        let (uv, aim) = ([u[1], u[2]], [v[0], v[1], v[2]]);
        let area =
            |s: SurfaceSample, area: f64, radiance, both: bool, spot: Option<&Spot>, ids: PrimitiveId| {
                let chance = f64::from(pmf) / area;
                self.leaving_surface(s, radiance, chance, both.then_some(v[3]), spot, (light, ids), aim)
            };
        let none = PrimitiveId::NONE;
        match &lights.emitters()[i] {
            Emitter::Triangle { shape, radiance, both_sides, primitive } => {
                let s = shape.at(square_to_triangle(uv), 1.0);
                area(s, shape.area(), *radiance, *both_sides, None, *primitive)
            }
            Emitter::Rectangle { shape, radiance, both_sides, primitives, .. } => {
                let s = shape.at(uv[0], uv[1], 1.0);
                let from = primitives.map_or(none, |p| p[usize::from(shape.in_second_half(s.p))]);
                area(s, shape.area(), *radiance, *both_sides, None, from)
            }
            Emitter::Ellipse { shape, radiance, .. } => {
                area(shape.at(uv, 1.0), shape.area(), *radiance, false, None, none)
            }
            Emitter::Sphere { shape, radiance, both_sides, spot, primitive, .. } => {
                let n = square_to_sphere(uv);
                let p_err = (shape.center.abs() + Vec3::splat(shape.radius)) * gamma(5);
                let s = SurfaceSample { p: shape.center + n * shape.radius, p_err, n, pdf: 1.0 };
                let from = primitive.unwrap_or(none);
                area(s, shape.area(), *radiance, *both_sides, spot.as_ref(), from)
            }
            Emitter::Point { position, intensity, spot } => {
                let (w, pdf) = self.aim.direction(*position, None, aim)?;
                let factor = spot.as_ref().map_or(1.0, |s| s.factor(w));
                let power = *intensity * (factor / (pdf * pmf));
                lit(Emission {
                    light,
                    ray: Ray::new(*position, w),
                    from: none,
                    power,
                    p: *position,
                    cos: 1.0,
                })
            }
            Emitter::Sun { towards, irradiance, one_minus_cos, .. } => {
                if *one_minus_cos == 0.0 {
                    return self.arriving(light, *towards, *irradiance / pmf, aim);
                }
                let w = Frame::from_z(*towards).to_world(square_to_cone(uv, *one_minus_cos)).normalize();
                let radiance = sun_radiance(*irradiance, *one_minus_cos);
                self.arriving(light, w, radiance / (square_to_cone_pdf(*one_minus_cos) * pmf), aim)
            }
            Emitter::Environment { radiance, .. } => {
                self.arriving(light, square_to_sphere(uv), *radiance / (SQUARE_TO_SPHERE_PDF * pmf), aim)
            }
            Emitter::Panorama { map, .. } => {
                let w = map.sample(uv)?;
                self.arriving(light, w, map.radiance(w) / (map.pdf(w) * pmf), aim)
            }
        }
    }

    /// From the point `s` of a surface that was chosen with a density of `chance` per area; `side` is a
    /// uniform number that chooses one where both emit.
    fn leaving_surface(
        &self,
        s: SurfaceSample,
        radiance: Rgb,
        chance: f64,
        side: Option<f32>,
        spot: Option<&Spot>,
        (light, from): (LightId, PrimitiveId),
        aim: [f32; 3],
    ) -> Option<Emission> {
        let (n, sides) = match side {
            Some(u) => (if u < 0.5 { s.n } else { -s.n }, 2.0),
            None => (s.n, 1.0),
        };
        let (w, pdf) = self.aim.direction(s.p, Some(n), aim)?;
        let cos = w.dot(n).min(1.0);
        let factor = spot.map_or(1.0, |spot| spot.factor(w)) * cos;
        let scale = f64::from(factor) * sides / (chance * f64::from(pdf));
        let power = planted!(light_energy(radiance)) * scale as f32;
        let ray = Ray::new(offset_origin(s.p, s.p_err, s.n, w), w);
        lit(Emission { light, ray, from, power, p: s.p, cos })
    }

    /// From the direction `towards`; `radiance` is over the density per solid angle.
    fn arriving(&self, light: LightId, towards: Vec3, radiance: Rgb, aim: [f32; 3]) -> Option<Emission> {
        let (p, pdf) = self.aim.across(towards, aim)?;
        let o = p + towards * self.reach;
        let power = radiance * (1.0 / pdf) as f32;
        lit(Emission { light, ray: Ray::new(o, -towards), from: PrimitiveId::NONE, power, p: o, cos: 1.0 })
    }
}

/// A photon that carries something.
fn lit(e: Emission) -> Option<Emission> {
    (e.power.is_finite() && !e.power.is_black()).then_some(e)
}

/// The flux of a light towards all targets, roughly, W; positive wherever there may be any.
fn flux(emitter: &Emitter, aim: &Aim) -> f64 {
    let luminance = |c: Rgb| f64::from(c.luminance());
    // What the horizon of one place hides another may see, so a small part counts as if there were none.
    let surface = |radiance: Rgb, area: f64, places: &[(Vec3, Vec3)], both: bool| {
        let seen = |&(p, n): &(Vec3, Vec3)| {
            let back = if both { aim.flux(p, Some(-n)) } else { 0.0 };
            f64::from(aim.flux(p, Some(n)) + back + 0.01 * aim.flux(p, None))
        };
        luminance(radiance) * area * places.iter().map(seen).sum::<f64>() / places.len() as f64
    };
    let flat = |corners: &[Vec3], n: Vec3| corners.iter().map(|&p| (p, n)).collect::<Vec<_>>();
    match emitter {
        Emitter::Triangle { shape, radiance, both_sides, .. } => {
            surface(*radiance, shape.area(), &flat(&shape.v, shape.normal()), *both_sides)
        }
        Emitter::Rectangle { shape, radiance, both_sides, .. } => {
            surface(*radiance, shape.area(), &flat(&shape.corners(), shape.normal()), *both_sides)
        }
        Emitter::Ellipse { shape, radiance, .. } => {
            surface(*radiance, shape.area(), &flat(&emitter.corners(), shape.n), false)
        }
        Emitter::Sphere { shape, radiance, both_sides, .. } => {
            let axes = [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
            let places = axes.map(|n| (shape.center + n * shape.radius, n));
            surface(*radiance, shape.area(), &places, *both_sides)
        }
        Emitter::Point { position, intensity, .. } => {
            luminance(*intensity) * f64::from(aim.flux(*position, None))
        }
        Emitter::Sun { irradiance, .. } => luminance(*irradiance) * aim.area(),
        Emitter::Environment { radiance, .. } => {
            4.0 * std::f64::consts::PI * luminance(*radiance) * aim.area()
        }
        Emitter::Panorama { map, .. } => 4.0 * std::f64::consts::PI * luminance(map.mean()) * aim.area(),
    }
}

//! Lights of the reference integrator that are not surfaces.
//!
//! A light with an extent is met by chance: a segment that crosses its front gathers its radiance and
//! goes on, since lights never block. A light without one (a point, a spot, a sun of angle zero)
//! cannot be met, and is added at each vertex by a shadow ray.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::geometry::sphere;
use super::medium::{Medium, transmittance};
use super::rgb;
use crate::color::srgb_to_linear;
use crate::scene::{AreaShape, Environment, LightKind, Pixels, Scene, SpotFalloff, Texels};

/// All lights of a scene, and its environment.
#[derive(Debug)]
pub(super) struct Lights {
    extended: Vec<(bool, Extended)>,
    /// Lights that only a shadow ray reaches.
    pub(super) delta: Vec<Delta>,
    environment: Option<Environment>,
    /// The environment's picture, and its rotation.
    picture: Option<(Arc<Pixels>, f64)>,
}

/// A light that rays can meet.
#[derive(Debug)]
enum Extended {
    /// A flat emitter in the xy plane of its own space, shining towards -z there.
    Flat { to_local: DAffine3, shape: AreaShape, half: [f64; 2], radiance: DVec3 },
    /// A sphere that emits outwards.
    Ball { center: DVec3, radius: f64, radiance: DVec3, cone: Option<Cone> },
    /// A disk infinitely far away.
    Disk { towards: DVec3, sin_half: f64, radiance: DVec3 },
}

/// A light that rays cannot meet.
#[derive(Debug)]
pub(super) enum Delta {
    /// All intensity comes from one point.
    Point { position: DVec3, intensity: DVec3, cone: Option<Cone> },
    /// All light comes from one direction.
    Direction { towards: DVec3, irradiance: DVec3 },
}

/// How a spot light depends on the direction it shines in.
#[derive(Debug)]
pub(super) struct Cone {
    axis: DVec3,
    inner: f64,
    outer: f64,
    falloff: SpotFalloff,
}

/// What a delta light sends to a point.
#[derive(Debug)]
pub(super) struct Arrival {
    /// Unit, towards the light.
    pub(super) wi: DVec3,
    /// Metres; infinite for a direction.
    pub(super) distance: f64,
    /// Irradiance on a plane that faces the light, W m^-2.
    pub(super) irradiance: DVec3,
}

impl Lights {
    pub(super) fn new(scene: &Scene) -> Self {
        let (mut extended, mut delta) = (Vec::new(), Vec::new());
        for light in &scene.lights {
            let matrix = light.transform.matrix3;
            let (Some(z), det) = (matrix.z_axis.try_normalize(), matrix.determinant()) else { continue };
            let position = light.transform.translation;
            let scale = libm::cbrt(det.abs());
            let mut ball_or_point = |intensity, radius: f64, cone| {
                let radius = radius * scale;
                if radius > 0.0 {
                    let radiance = rgb(intensity) / (PI * radius * radius);
                    let ball = Extended::Ball { center: position, radius, radiance, cone };
                    extended.push((light.visible_to_camera, ball));
                } else {
                    delta.push(Delta::Point { position, intensity: rgb(intensity), cone });
                }
            };
            match light.kind {
                LightKind::Point { intensity, radius } => ball_or_point(intensity, radius, None),
                LightKind::Spot { intensity, inner, outer, falloff, radius } => {
                    ball_or_point(intensity, radius, Some(Cone { axis: -z, inner, outer, falloff }));
                }
                LightKind::Sun { irradiance, angle } if angle > 0.0 => {
                    let sin_half = libm::sin(0.5 * angle);
                    let radiance = rgb(irradiance) / (PI * sin_half * sin_half);
                    extended
                        .push((light.visible_to_camera, Extended::Disk { towards: z, sin_half, radiance }));
                }
                LightKind::Sun { irradiance, .. } => {
                    delta.push(Delta::Direction { towards: z, irradiance: rgb(irradiance) });
                }
                LightKind::Area { shape, size, radiance } if det != 0.0 => {
                    let flat = Extended::Flat {
                        to_local: light.transform.inverse(),
                        shape,
                        half: size.map(|s| 0.5 * s),
                        radiance: rgb(radiance),
                    };
                    extended.push((light.visible_to_camera, flat));
                }
                LightKind::Area { .. } => {}
            }
        }
        let environment = scene.environment.clone();
        let image = environment.as_ref().and_then(|e| e.image);
        let picture = image.and_then(|i| {
            let pixels = scene.images.get(i.image.0 as usize)?.pixels.as_ref()?;
            Some((Arc::clone(pixels), i.rotation))
        });
        Self { extended, delta, environment, picture }
    }

    /// Radiance that a segment of `length` metres gathers at its start `o`: of the lights that it
    /// crosses, and, where the segment is infinite, of what lies behind everything.
    pub(super) fn along(
        &self,
        o: DVec3,
        d: DVec3,
        length: f64,
        from_camera: bool,
        medium: Option<Medium>,
    ) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for (visible_to_camera, light) in &self.extended {
            if from_camera && !visible_to_camera {
                continue;
            }
            if let Some((t, radiance)) = light.meet(o, d)
                && (t < length || (t.is_infinite() && length.is_infinite()))
            {
                sum += transmittance(medium, t) * radiance;
            }
        }
        if let Some(environment) = &self.environment
            && length.is_infinite()
            && (!from_camera || environment.visible_to_camera)
        {
            let texel = self.picture.as_ref().map_or(DVec3::ONE, |(p, rotation)| seen(p, *rotation, d));
            sum += transmittance(medium, length) * rgb(environment.radiance) * texel;
        }
        sum
    }
}

/// What a picture of all directions shows along the unit direction `d`: four texels about it, weighted
/// by how near their middles are.
fn seen(picture: &Pixels, rotation: f64, d: DVec3) -> DVec3 {
    // The picture was turned counter-clockwise; turning the direction back says where it was before.
    let before = DAffine3::from_rotation_y(-rotation).transform_vector3(d);
    let longitude = 0.5 + libm::atan2(before.x, -before.z) / TAU;
    let latitude = libm::acos(before.y.clamp(-1.0, 1.0)) / PI;
    let (w, h) = (i64::from(picture.width), i64::from(picture.height));
    let (x, y) = (longitude * w as f64 - 0.5, latitude * h as f64 - 0.5);
    let mut sum = DVec3::ZERO;
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let (i, j) = (x.floor() as i64 + dx, y.floor() as i64 + dy);
        let weight = (1.0 - (x - i as f64).abs()) * (1.0 - (y - j as f64).abs());
        let at = (j.clamp(0, h - 1) * w + i.rem_euclid(w)) as usize;
        let decode = |c: f32| f64::from(srgb_to_linear(c));
        let texel = match &picture.texels {
            Texels::Byte(t) => [0, 1, 2].map(|c| decode(f32::from(t[at][c]) / 255.0)),
            Texels::Short(t) => [0, 1, 2].map(|c| decode(f32::from(t[at][c]) / 65535.0)),
            Texels::Float(t) => t[at].map(f64::from),
        };
        sum += weight * DVec3::from_array(texel);
    }
    sum
}

impl Extended {
    /// Distance and radiance where the ray meets the front of the light.
    fn meet(&self, o: DVec3, d: DVec3) -> Option<(f64, DVec3)> {
        match self {
            Self::Flat { to_local, shape, half, radiance } => {
                let (o, d) = (to_local.transform_point3(o), to_local.transform_vector3(d));
                // The front looks towards -z, so rays that see it travel towards +z.
                if d.z <= 0.0 {
                    return None;
                }
                let t = -o.z / d.z;
                let (x, y) = ((o.x + t * d.x) / half[0], (o.y + t * d.y) / half[1]);
                let inside = match shape {
                    AreaShape::Rectangle => x.abs() <= 1.0 && y.abs() <= 1.0,
                    AreaShape::Ellipse => x * x + y * y <= 1.0,
                };
                (t > 0.0 && inside).then_some((t, *radiance))
            }
            Self::Ball { center, radius, radiance, cone } => {
                let t = sphere(o - center, d, *radius, false)?;
                let meets_front = (o + t * d - center).dot(d) < 0.0;
                let factor = cone.as_ref().map_or(1.0, |cone| cone.factor(-d));
                meets_front.then_some((t, factor * radiance))
            }
            Self::Disk { towards, sin_half, radiance } => {
                let inside = d.dot(*towards) > 0.0 && d.cross(*towards).length() <= *sin_half;
                inside.then_some((f64::INFINITY, *radiance))
            }
        }
    }
}

impl Delta {
    /// What arrives at `point` if nothing is between.
    pub(super) fn arrive(&self, point: DVec3) -> Option<Arrival> {
        match self {
            Self::Point { position, intensity, cone } => {
                let way = position - point;
                let wi = way.try_normalize()?;
                let factor = cone.as_ref().map_or(1.0, |cone| cone.factor(-wi));
                let irradiance = factor * intensity / way.length_squared();
                Some(Arrival { wi, distance: way.length(), irradiance })
            }
            Self::Direction { towards, irradiance } => {
                Some(Arrival { wi: *towards, distance: f64::INFINITY, irradiance: *irradiance })
            }
        }
    }
}

impl Cone {
    /// Share of the axial intensity in the unit direction `w`, which leaves the light.
    fn factor(&self, w: DVec3) -> f64 {
        let cos = w.dot(self.axis);
        let cos_outer = libm::cos(self.outer);
        let ramp = |width: f64| {
            if width > 0.0 {
                ((cos - cos_outer) / width).clamp(0.0, 1.0)
            } else {
                f64::from(cos >= cos_outer)
            }
        };
        match self.falloff {
            SpotFalloff::Gltf => {
                let t = ramp(libm::cos(self.inner) - cos_outer);
                t * t
            }
            SpotFalloff::Blender => {
                let t = ramp((1.0 - cos_outer) * (1.0 - self.inner / self.outer));
                t * t * (3.0 - 2.0 * t)
            }
        }
    }
}

//! All lights of a scene: choosing one, and finding those that a ray meets.

use std::sync::Arc;

use glam::Vec3;

use super::pick::Pick;
use super::{Ellipse, LightContext, Panorama, Rectangle, SphereLight, SurfaceSample, TriangleLight};
use crate::accel::PrimitiveId;
use crate::color::Rgb;
use crate::math::Frame;
use crate::mutants::planted;
use crate::rare::rarely;
use crate::sampling::warp::{
    SQUARE_TO_SPHERE_PDF, square_to_cone, square_to_cone_pdf, square_to_cosine_hemisphere,
    square_to_cosine_hemisphere_pdf, square_to_sphere,
};
use crate::shape::{Ray, offset_origin, sphere};

/// Index of an emitter in its [`LightSet`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightId(pub u32);

/// The cone of a spot light.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// Unit direction of its axis, away from the light.
    pub axis: Vec3,
    /// How the intensity falls from the axis.
    pub curve: SpotCurve,
    /// Cosine of the half angle where the fall begins.
    pub cos_inner: f32,
    /// Cosine of the half angle where the light ends.
    pub cos_outer: f32,
}

/// How a spot light fades between its two angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpotCurve {
    /// Square of the ramp in the cosine.
    Square,
    /// Smoothstep of the ramp in the cosine.
    Smoothstep,
}

impl Spot {
    /// Factor on the intensity in the unit direction `w` away from the light.
    #[must_use]
    pub fn factor(&self, w: Vec3) -> f32 {
        let above = w.dot(self.axis) - self.cos_outer;
        let ramp = self.cos_inner - self.cos_outer;
        if above <= 0.0 {
            return 0.0;
        }
        let t = if above >= ramp { 1.0 } else { above / ramp };
        match self.curve {
            SpotCurve::Square => t * t,
            SpotCurve::Smoothstep => t * t * (3.0 - 2.0 * t),
        }
    }
}

/// One light. Surfaces know the primitives that they are; free lights are not surfaces.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// An emissive triangle.
    Triangle {
        /// Shape.
        shape: TriangleLight,
        /// W sr^-1 m^-2.
        radiance: Rgb,
        /// Whether the clockwise side emits as well.
        both_sides: bool,
        /// The primitive that it is.
        primitive: PrimitiveId,
    },
    /// Two emissive triangles that form a rectangle.
    Rectangle {
        /// Shape.
        shape: Rectangle,
        /// W sr^-1 m^-2.
        radiance: Rgb,
        /// Whether the back emits as well.
        both_sides: bool,
        /// The primitives that it is; `None` for a free light.
        primitives: Option<[PrimitiveId; 2]>,
        /// Whether camera rays see it, where it is free.
        visible_to_camera: bool,
    },
    /// A free ellipse.
    Ellipse {
        /// Shape.
        shape: Ellipse,
        /// W sr^-1 m^-2.
        radiance: Rgb,
        /// Whether camera rays see it.
        visible_to_camera: bool,
    },
    /// A sphere: an emissive surface, or a free light with a radius.
    Sphere {
        /// Shape.
        shape: SphereLight,
        /// W sr^-1 m^-2.
        radiance: Rgb,
        /// Whether the inside emits as well.
        both_sides: bool,
        /// A cone that limits it.
        spot: Option<Spot>,
        /// The primitive that it is; `None` for a free light.
        primitive: Option<PrimitiveId>,
        /// Whether camera rays see it, where it is free.
        visible_to_camera: bool,
    },
    /// A point.
    Point {
        /// World space.
        position: Vec3,
        /// W sr^-1.
        intensity: Rgb,
        /// A cone that limits it.
        spot: Option<Spot>,
    },
    /// Parallel light from one direction, or from a disk at infinity.
    Sun {
        /// Unit direction towards the light.
        towards: Vec3,
        /// Irradiance on a plane that faces it, W m^-2.
        irradiance: Rgb,
        /// 1 - cos of the half angle of its disk; zero for a single direction.
        one_minus_cos: f32,
        /// Whether camera rays see it.
        visible_to_camera: bool,
    },
    /// The same radiance from every direction.
    Environment {
        /// W sr^-1 m^-2.
        radiance: Rgb,
        /// Whether camera rays see it.
        visible_to_camera: bool,
    },
    /// A picture of all directions.
    Panorama {
        /// The picture.
        map: Arc<Panorama>,
        /// Whether camera rays see it.
        visible_to_camera: bool,
    },
}

/// A direction towards a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Which light.
    pub light: LightId,
    /// Unit direction from the point that is lit.
    pub wi: Vec3,
    /// Radiance that arrives along it when nothing is in the way, divided by `pdf`.
    pub weight: Rgb,
    /// Density per solid angle, choice of the light included; for a delta light, the probability of
    /// its choice.
    pub pdf: f32,
    /// True where no other way finds this light.
    pub delta: bool,
    /// A ray to test for what is in the way.
    pub shadow_ray: Ray,
    /// The primitive that the ray ends on.
    pub target: PrimitiveId,
    /// Cosine at which the light leaves a surface, [0, 1]; one where it leaves none.
    pub cos: f32,
}

/// A free light that a ray meets.
#[derive(Clone, Copy, Debug)]
pub struct FreeHit {
    /// Which.
    pub light: LightId,
    /// Radiance along the ray.
    pub radiance: Rgb,
    /// Where.
    pub p: Vec3,
    /// Unit normal there.
    pub n: Vec3,
    /// Whether camera rays see it.
    pub visible_to_camera: bool,
}

/// All lights of a scene.
#[derive(Clone, Debug, Default)]
pub struct LightSet {
    emitters: Vec<Emitter>,
    pick: Pick,
    /// Light of each world primitive, `u32::MAX` for none; empty where no surface emits.
    of_primitive: Vec<u32>,
    free: Vec<u32>,
    distant: Vec<u32>,
}

/// Density per solid angle at `p` of a point `q` that was chosen uniformly from a surface of `area` with
/// unit normal `n`; zero edge-on.
#[must_use]
pub(super) fn area_pdf(p: Vec3, q: Vec3, n: Vec3, area: f64) -> f32 {
    let d = q.as_dvec3() - p.as_dvec3();
    let d2 = d.length_squared();
    let cos = n.as_dvec3().dot(d).abs() / d2.sqrt();
    if cos > 0.0 { (d2 / (cos * area)) as f32 } else { 0.0 }
}

impl LightSet {
    /// The set over the lights in `groups` (the emissive primitives of one object, or one light each);
    /// `primitives` is the number of primitives of the world and `scene_radius` the radius of a sphere
    /// around everything, which distant lights shine on.
    #[must_use]
    pub fn new(groups: Vec<Vec<Emitter>>, primitives: usize, scene_radius: f64) -> Self {
        let sizes: Vec<usize> = groups.iter().map(Vec::len).collect();
        let emitters: Vec<Emitter> = groups.into_iter().flatten().collect();
        let mut set = Self { pick: Pick::new(&emitters, &sizes, scene_radius), ..Self::default() };
        for (i, emitter) in emitters.iter().enumerate() {
            let i = i as u32;
            let mut own = |ids: &[PrimitiveId]| {
                set.of_primitive.resize(primitives, u32::MAX);
                for id in ids {
                    set.of_primitive[id.primitive as usize] = i;
                }
            };
            match emitter {
                Emitter::Triangle { primitive, .. } => own(&[*primitive]),
                Emitter::Rectangle { primitives: Some(ids), .. } => own(ids),
                Emitter::Sphere { primitive: Some(id), .. } => own(&[*id]),
                Emitter::Rectangle { .. } | Emitter::Sphere { .. } | Emitter::Ellipse { .. } => {
                    set.free.push(i);
                }
                Emitter::Sun { .. } | Emitter::Environment { .. } | Emitter::Panorama { .. } => {
                    set.distant.push(i);
                }
                Emitter::Point { .. } => {}
            }
        }
        set.emitters = emitters;
        set
    }

    /// The lights.
    #[must_use]
    pub fn emitters(&self) -> &[Emitter] {
        &self.emitters
    }

    /// The light that a surface is.
    #[inline]
    #[must_use]
    pub fn of_surface(&self, id: PrimitiveId) -> Option<LightId> {
        if id.instance != 0 {
            return None;
        }
        self.of_primitive.get(id.primitive as usize).copied().filter(|&i| i != u32::MAX).map(LightId)
    }

    /// Radiance that a surface which is a light emits into the unit direction `wo`, where its geometric
    /// normal is `ng`.
    #[inline]
    #[must_use]
    pub fn emitted(&self, light: LightId, wo: Vec3, ng: Vec3) -> Rgb {
        match self.emitters[light.0 as usize] {
            Emitter::Triangle { radiance, both_sides, .. }
            | Emitter::Rectangle { radiance, both_sides, .. }
            | Emitter::Sphere { radiance, both_sides, .. }
                if both_sides || wo.dot(ng) > 0.0 =>
            {
                radiance
            }
            _ => Rgb::BLACK,
        }
    }

    /// The radiance that a surface which is a light was given: what it emits, but where a picture varies
    /// that.
    #[inline]
    #[must_use]
    pub fn nominal(&self, light: LightId) -> Rgb {
        match self.emitters[light.0 as usize] {
            Emitter::Triangle { radiance, .. }
            | Emitter::Rectangle { radiance, .. }
            | Emitter::Sphere { radiance, .. } => radiance,
            _ => Rgb::BLACK,
        }
    }

    /// Density, choice of the light included, with which [`Self::sample`] would have found the point `q`
    /// with normal `n` of a light.
    #[inline]
    #[must_use]
    pub fn pdf(&self, ctx: &LightContext, light: LightId, q: Vec3, n: Vec3) -> f32 {
        let emitter = &self.emitters[light.0 as usize];
        if emitter.is_flat_under(ctx.from) {
            return 0.0;
        }
        let density = match emitter {
            Emitter::Triangle { shape, .. } => shape.pdf(ctx.p, q),
            Emitter::Rectangle { shape, .. } => shape.pdf(ctx.p, q),
            Emitter::Ellipse { shape, .. } => shape.pdf(ctx.p, q),
            Emitter::Sphere { shape, primitive, .. } => shape.pdf(ctx.p, *primitive == Some(ctx.from), q, n),
            Emitter::Point { .. }
            | Emitter::Sun { .. }
            | Emitter::Environment { .. }
            | Emitter::Panorama { .. } => 0.0,
        };
        planted!(mis_measure(density, ctx.p, q, n)) * self.pick.pmf(ctx.p, light.0 as usize)
    }

    /// One light, by what it could contribute (`u[0]`), and a direction towards it.
    #[must_use]
    pub fn sample(&self, ctx: &LightContext, u: [f32; 3]) -> Option<LightSample> {
        let (i, pmf) = planted!(light_dropped(self.pick.sample(ctx.p, u[0]), self.emitters.len()))?;
        let uv = [u[1], u[2]];
        let emitter = &self.emitters[i];
        if emitter.is_flat_under(ctx.from) {
            return None;
        }
        let light = LightId(i as u32);
        let surface = |s: SurfaceSample, radiance: Rgb, both_sides: bool, spot: Option<&Spot>, target| {
            surface(ctx, (light, pmf), s, radiance, both_sides, spot, target)
        };
        let distant =
            |wi: Vec3, weight: Rgb, pdf: f32, delta: bool| distant(ctx, light, wi, weight, pdf, delta);
        match emitter {
            Emitter::Triangle { shape, radiance, both_sides, primitive } => {
                surface(shape.sample(ctx.p, uv)?, *radiance, *both_sides, None, *primitive)
            }
            Emitter::Rectangle { shape, radiance, both_sides, primitives, .. } => {
                let s = shape.sample(ctx.p, uv)?;
                // The ray ends on one of the two; it must not meet that one at its very end.
                let target =
                    primitives.map_or(PrimitiveId::NONE, |p| p[usize::from(shape.in_second_half(s.p))]);
                surface(s, *radiance, *both_sides, None, target)
            }
            Emitter::Ellipse { shape, radiance, .. } => {
                surface(shape.sample(ctx.p, uv)?, *radiance, false, None, PrimitiveId::NONE)
            }
            Emitter::Sphere { shape, radiance, both_sides, spot, primitive, .. } => {
                let target = primitive.unwrap_or(PrimitiveId::NONE);
                let s = shape.sample(ctx.p, *primitive == Some(ctx.from), uv)?;
                surface(s, *radiance, *both_sides, spot.as_ref(), target)
            }
            Emitter::Point { position, intensity, spot } => {
                let d = *position - ctx.p;
                let d2 = d.length_squared();
                let wi = d.try_normalize()?;
                let factor = spot.as_ref().map_or(1.0, |s| s.factor(-wi));
                let origin = offset_origin(ctx.p, ctx.p_err, ctx.ng, wi);
                let to = *position - origin;
                let shadow_ray = Ray { o: origin, d: to.try_normalize()?, t_max: to.length() };
                let weight = *intensity * (factor / (d2 * pmf));
                Some(LightSample {
                    light,
                    wi,
                    weight,
                    pdf: pmf,
                    delta: true,
                    shadow_ray,
                    target: PrimitiveId::NONE,
                    cos: 1.0,
                })
            }
            Emitter::Sun { towards, irradiance, one_minus_cos, .. } => {
                if *one_minus_cos == 0.0 {
                    return Some(distant(*towards, *irradiance / pmf, pmf, true));
                }
                let wi = Frame::from_z(*towards).to_world(square_to_cone(uv, *one_minus_cos)).normalize();
                let pdf = square_to_cone_pdf(*one_minus_cos) * pmf;
                Some(distant(wi, sun_radiance(*irradiance, *one_minus_cos) / pdf, pdf, false))
            }
            Emitter::Environment { radiance, .. } => {
                let wi = if ctx.transmits {
                    square_to_sphere(uv)
                } else {
                    let n = if ctx.wo.dot(ctx.ns) < 0.0 { -ctx.ns } else { ctx.ns };
                    Frame::from_z(n).to_world(square_to_cosine_hemisphere(uv))
                };
                let pdf = environment_pdf(ctx, wi) * pmf;
                (pdf > 0.0).then(|| distant(wi, *radiance / pdf, pdf, false))
            }
            Emitter::Panorama { map, .. } => {
                // The density is looked up for the direction as rounded, as it is for one found by chance.
                let wi = map.sample(uv)?;
                let pdf = map.pdf(wi) * pmf;
                (pdf > 0.0).then(|| distant(wi, map.radiance(wi) / pdf, pdf, false))
            }
        }
    }

    /// Every free light that `ray` meets before `t_max`, through `found`. They do not block each other.
    #[inline]
    pub fn free_hits(&self, ray: &Ray, t_max: f32, mut found: impl FnMut(FreeHit)) {
        for &i in &self.free {
            let light = LightId(i);
            let flat = |corner: Vec3, n: Vec3, inside: &dyn Fn(Vec3) -> bool| {
                let (n64, d) = (n.as_dvec3(), ray.d.as_dvec3());
                let t = n64.dot(corner.as_dvec3() - ray.o.as_dvec3()) / n64.dot(d);
                let p = (ray.o.as_dvec3() + d * t).as_vec3();
                (t > 0.0 && t < f64::from(t_max) && ray.d.dot(n) < 0.0 && inside(p)).then_some(p)
            };
            match &self.emitters[i as usize] {
                Emitter::Rectangle { shape, radiance, visible_to_camera, .. } => {
                    let n = shape.normal();
                    if let Some(p) = flat(shape.corner(), n, &|p| shape.contains(p)) {
                        found(FreeHit {
                            light,
                            radiance: *radiance,
                            p,
                            n,
                            visible_to_camera: *visible_to_camera,
                        });
                    }
                }
                Emitter::Ellipse { shape, radiance, visible_to_camera } => {
                    let n = shape.n;
                    if let Some(p) = flat(shape.center, n, &|p| shape.contains(p)) {
                        found(FreeHit {
                            light,
                            radiance: *radiance,
                            p,
                            n,
                            visible_to_camera: *visible_to_camera,
                        });
                    }
                }
                Emitter::Sphere { shape, radiance, spot, visible_to_camera, .. } => {
                    let Some((t, _)) = sphere::intersect(ray, shape.center, shape.radius) else { continue };
                    if t > 0.0 && t < f64::from(t_max) {
                        let (p, _, n) = sphere::point(ray, t as f32, shape.center, shape.radius);
                        let radiance = *radiance * spot.as_ref().map_or(1.0, |s| s.factor(-ray.d));
                        found(FreeHit { light, radiance, p, n, visible_to_camera: *visible_to_camera });
                    }
                }
                _ => {}
            }
        }
    }

    /// What a ray in direction `d` that leaves the scene meets, through `found`: which light, its radiance, whether
    /// camera rays see it, and the density with which [`Self::sample`] would have found it (given the
    /// context it would have been sampled from).
    #[inline]
    pub fn distant(
        &self,
        d: Vec3,
        ctx: Option<&LightContext>,
        mut found: impl FnMut(LightId, Rgb, bool, f32),
    ) {
        for &i in &self.distant {
            let light = LightId(i);
            let pmf = ctx.map_or(0.0, |c| self.pick.pmf(c.p, i as usize));
            match &self.emitters[i as usize] {
                &Emitter::Environment { radiance, visible_to_camera } => {
                    found(
                        light,
                        radiance,
                        visible_to_camera,
                        ctx.map_or(0.0, |c| environment_pdf(c, d)) * pmf,
                    );
                }
                Emitter::Panorama { map, visible_to_camera } => {
                    let pdf = if ctx.is_some() { map.pdf(d) } else { 0.0 };
                    found(light, map.radiance(d), *visible_to_camera, pdf * pmf);
                }
                // 1 - cos of the angle between unit vectors, from their chord.
                &Emitter::Sun { towards, irradiance, one_minus_cos, visible_to_camera }
                    if 0.5 * (d - towards).length_squared() < one_minus_cos =>
                {
                    let radiance = sun_radiance(irradiance, one_minus_cos);
                    found(light, radiance, visible_to_camera, square_to_cone_pdf(one_minus_cos) * pmf);
                }
                _ => {}
            }
        }
    }
}

impl Emitter {
    /// Whether the light is flat and `from` a part of it: it then does not light what lies on it, though
    /// rounding may put that a little beside its plane, from where it would fill half of all directions.
    #[inline]
    fn is_flat_under(&self, from: PrimitiveId) -> bool {
        match self {
            Self::Triangle { primitive, .. } => *primitive == from,
            Self::Rectangle { primitives: Some(ids), .. } => ids.contains(&from),
            _ => false,
        }
    }

    /// Points whose bounding box holds the light, where it has a place.
    pub(super) fn corners(&self) -> Vec<Vec3> {
        match self {
            Self::Triangle { shape, .. } => shape.v.to_vec(),
            Self::Rectangle { shape, .. } => shape.corners().to_vec(),
            Self::Ellipse { shape, .. } => {
                let [a, b] = shape.half_axes;
                [a + b, a - b, b - a, -a - b].map(|o| shape.center + o).to_vec()
            }
            Self::Sphere { shape, .. } => {
                let r = Vec3::splat(shape.radius);
                vec![shape.center - r, shape.center + r]
            }
            Self::Point { position, .. } => vec![*position],
            Self::Sun { .. } | Self::Environment { .. } | Self::Panorama { .. } => Vec::new(),
        }
    }

    /// Radiant intensity in the direction where it is largest, W sr^-1; zero for distant lights.
    pub(super) fn peak_intensity(&self) -> f64 {
        let flat = |radiance: Rgb, area: f64| f64::from(radiance.luminance()) * area;
        match self {
            Self::Triangle { shape, radiance, .. } => flat(*radiance, shape.area()),
            Self::Rectangle { shape, radiance, .. } => flat(*radiance, shape.area()),
            Self::Ellipse { shape, radiance, .. } => flat(*radiance, shape.area()),
            Self::Sphere { shape, radiance, .. } => flat(*radiance, 0.25 * shape.area()),
            Self::Point { intensity, .. } => f64::from(intensity.luminance()),
            Self::Sun { .. } | Self::Environment { .. } | Self::Panorama { .. } => 0.0,
        }
    }

    /// Radiant power, W, averaged over colour; for distant lights what falls on a sphere of `scene_radius`.
    #[must_use]
    pub fn power(&self, scene_radius: f64) -> f64 {
        use std::f64::consts::PI;
        let disk = PI * scene_radius * scene_radius;
        let flat = |radiance: Rgb, area: f64, sides: f64| f64::from(radiance.luminance()) * area * PI * sides;
        let sides = |both: bool| if both { 2.0 } else { 1.0 };
        let cone = |spot: &Option<Spot>| match spot {
            // The cone with half of its ramp.
            Some(s) => 0.5 * (1.0 - 0.5 * f64::from(s.cos_inner + s.cos_outer)),
            None => 1.0,
        };
        match self {
            Self::Triangle { shape, radiance, both_sides, .. } => {
                flat(*radiance, shape.area(), sides(*both_sides))
            }
            Self::Rectangle { shape, radiance, both_sides, .. } => {
                flat(*radiance, shape.area(), sides(*both_sides))
            }
            Self::Ellipse { shape, radiance, .. } => flat(*radiance, shape.area(), 1.0),
            Self::Sphere { shape, radiance, both_sides, spot, .. } => {
                flat(*radiance, shape.area(), sides(*both_sides)) * cone(spot)
            }
            Self::Point { intensity, spot, .. } => f64::from(intensity.luminance()) * 4.0 * PI * cone(spot),
            Self::Sun { irradiance, .. } => f64::from(irradiance.luminance()) * disk,
            Self::Environment { radiance, .. } => f64::from(radiance.luminance()) * PI * 4.0 * disk,
            Self::Panorama { map, .. } => f64::from(map.mean().luminance()) * PI * 4.0 * disk,
        }
    }
}

/// Radiance of a sun's disk: irradiance over pi sin^2 of its half angle.
pub(super) fn sun_radiance(irradiance: Rgb, one_minus_cos: f32) -> Rgb {
    irradiance / (crate::math::PI * one_minus_cos * (2.0 - one_minus_cos))
}

fn environment_pdf(ctx: &LightContext, wi: Vec3) -> f32 {
    if ctx.transmits {
        SQUARE_TO_SPHERE_PDF
    } else {
        let cos = wi.dot(ctx.ns);
        square_to_cosine_hemisphere_pdf(if ctx.wo.dot(ctx.ns) < 0.0 { -cos } else { cos })
    }
}

/// A sample of a surface or of a free light with an extent, which was chosen with a probability.
fn surface(
    ctx: &LightContext,
    (light, pmf): (LightId, f32),
    s: SurfaceSample,
    radiance: Rgb,
    both_sides: bool,
    spot: Option<&Spot>,
    target: PrimitiveId,
) -> Option<LightSample> {
    let wi = (s.p - ctx.p).try_normalize()?;
    if !both_sides && wi.dot(s.n) >= 0.0 {
        return None;
    }
    let factor = spot.map_or(1.0, |spot| spot.factor(-wi));
    let pdf = s.pdf * pmf;
    // Both ends leave their surfaces, so that neither needs an epsilon.
    let from = offset_origin(ctx.p, ctx.p_err, ctx.ng, wi);
    let to = offset_origin(s.p, s.p_err, s.n, -wi);
    let d = to - from;
    let shadow_ray = Ray { o: from, d: d.try_normalize()?, t_max: d.length() };
    let weight = planted!(light_energy(radiance)) * (factor / pdf);
    let unusable = rarely!(1e-5, !pdf.is_finite());
    (factor > 0.0 && !unusable).then_some(LightSample {
        light,
        wi,
        weight,
        pdf,
        delta: false,
        shadow_ray,
        target,
        cos: wi.dot(s.n).abs().min(1.0),
    })
}

fn distant(ctx: &LightContext, light: LightId, wi: Vec3, weight: Rgb, pdf: f32, delta: bool) -> LightSample {
    let shadow_ray = Ray::new(offset_origin(ctx.p, ctx.p_err, ctx.ng, wi), wi);
    LightSample { light, wi, weight, pdf, delta, shadow_ray, target: PrimitiveId::NONE, cos: 1.0 }
}

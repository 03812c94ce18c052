//! Collecting lights: emissive primitives, free lights and the environment.

use std::cmp::Ordering;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::PreparedMaterial;
use super::detail::Details;
use super::fold::Folded;
use super::geometry::Flat;
use super::glow::Brightness;
use super::plan::{Effect, Effects};
use crate::accel::PrimitiveId;
use crate::color::Rgb;
use crate::film::LIGHTS_APART;
use crate::light::{
    Ellipse, Emitter, LightId, Panorama, Rectangle, SphereLight, Spot, SpotCurve, TriangleLight,
    from_triangles,
};
use crate::scene::{
    AreaShape, Environment, EnvironmentImage, Light, LightKind, Pixels, Scene, Sides, SpotFalloff, Texels,
};

/// Lights that are chosen together: the emissive primitives of one object, or one light.
pub(super) struct Group {
    /// What people call it.
    pub(super) name: String,
    pub(super) emitters: Vec<Emitter>,
}

/// Everything that emits and belongs to one of the effects in `tables`, in the order of objects, lights,
/// environment; the primitives of an object are one group.
pub(super) fn collect(
    scene: &Scene,
    folded: &Folded<'_>,
    flat: &Flat,
    details: &Details,
    materials: &[PreparedMaterial],
    tables: Effects,
) -> Vec<Group> {
    let mut groups = Vec::new();
    for (i, (object, range)) in scene.objects.iter().zip(&flat.range).enumerate() {
        let emission = folded.kinds[object.material.0 as usize].emission();
        if let (Some((radiance, sides)), &Some((first, count))) = (emission, range) {
            let glow = materials[object.material.0 as usize].emission.as_deref();
            let brightness = glow.map(Brightness::new);
            // The radiance that a light of these primitives is given; none where they are black.
            let nominal = |primitives: &[PrimitiveId]| match &brightness {
                None => Some(radiance),
                Some(b) => {
                    let corners = |id: &PrimitiveId| details.corners(i as u32, *id);
                    b.nominal(&primitives.iter().map(corners).collect::<Vec<_>>())
                }
            };
            let mut emitters = Vec::new();
            surfaces(flat, first, count, &nominal, sides == Sides::Both, &mut emitters);
            groups.push(Group { name: format!("light {:?}", object.name), emitters });
        }
    }
    groups.extend(scene.lights.iter().filter_map(|light| {
        Some(Group { name: format!("light {:?}", light.name), emitters: vec![free(light)?] })
    }));
    let environment = |e| Group { name: "the environment".into(), emitters: vec![e] };
    if let Some(e) = &scene.environment
        && !e.radiance.is_black()
        && tables.has(Effect::Environment)
    {
        let visible_to_camera = e.visible_to_camera;
        match picture(scene, e) {
            Some((image, pixels)) => {
                let map = Panorama::new(Arc::clone(pixels), e.radiance, image.rotation);
                if !map.is_black() {
                    groups.push(environment(Emitter::Panorama { map: Arc::new(map), visible_to_camera }));
                }
            }
            None => {
                groups.push(environment(Emitter::Environment { radiance: e.radiance, visible_to_camera }));
            }
        }
    }
    groups.retain(|g| g.emitters.first().is_some_and(|e| tables.has(effect_of(e))));
    groups
}

/// Which lights are told apart where photons are compared with paths.
#[derive(Clone, Debug, Default)]
pub(crate) struct Apart {
    /// For each emitter its number, below [`LIGHTS_APART`].
    of: Vec<u8>,
    /// What people call each.
    pub(crate) names: Vec<String>,
}

impl Apart {
    /// The most powerful groups, and all others together; `scene_radius` is that of a ball around everything.
    pub(super) fn new(groups: &[Group], scene_radius: f64) -> Self {
        let power = |g: &Group| g.emitters.iter().map(|e| e.power(scene_radius)).sum::<f64>();
        let mut order: Vec<(f64, usize)> = groups.iter().map(power).zip(0..).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut number = vec![0u8; groups.len()];
        let mut names = Vec::new();
        for (rank, &(_, group)) in order.iter().enumerate() {
            number[group] = rank.min(LIGHTS_APART - 1) as u8;
            match rank.cmp(&(LIGHTS_APART - 1)) {
                Ordering::Less => names.push(groups[group].name.clone()),
                Ordering::Equal if groups.len() == LIGHTS_APART => names.push(groups[group].name.clone()),
                Ordering::Equal => names.push(format!("{} weaker lights", groups.len() - rank)),
                Ordering::Greater => {}
            }
        }
        let of = groups.iter().zip(&number).flat_map(|(g, &n)| std::iter::repeat_n(n, g.emitters.len()));
        Self { of: of.collect(), names }
    }

    /// The number of a light.
    #[inline]
    pub(crate) fn number(&self, light: LightId) -> u8 {
        self.of[light.0 as usize]
    }
}

/// The effect that an emitter is a part of.
pub(super) fn effect_of(emitter: &Emitter) -> Effect {
    match emitter {
        Emitter::Triangle { .. }
        | Emitter::Rectangle { primitives: Some(_), .. }
        | Emitter::Sphere { primitive: Some(_), .. } => Effect::AreaLights,
        Emitter::Rectangle { .. } | Emitter::Ellipse { .. } | Emitter::Sphere { .. } => Effect::FreeLights,
        Emitter::Point { .. } => Effect::DeltaLights,
        Emitter::Sun { one_minus_cos, .. } if *one_minus_cos <= 0.0 => Effect::DeltaLights,
        Emitter::Sun { .. } | Emitter::Environment { .. } | Emitter::Panorama { .. } => Effect::Environment,
    }
}

/// The effect that a light which emits nothing was meant for.
pub(super) fn intended(light: &Light) -> Effect {
    match light.kind {
        LightKind::Point { radius, .. } | LightKind::Spot { radius, .. } if radius > 0.0 => {
            Effect::FreeLights
        }
        LightKind::Sun { angle, .. } if angle > 0.0 => Effect::Environment,
        LightKind::Point { .. } | LightKind::Spot { .. } | LightKind::Sun { .. } => Effect::DeltaLights,
        LightKind::Area { .. } => Effect::FreeLights,
    }
}

/// What a light that emits nothing lacks.
pub(super) fn lack(light: &Light) -> &'static str {
    match light.kind {
        LightKind::Point { intensity: color, .. }
        | LightKind::Spot { intensity: color, .. }
        | LightKind::Sun { irradiance: color, .. }
        | LightKind::Area { radiance: color, .. }
            if color.is_black() =>
        {
            "power"
        }
        _ => "size",
    }
}

/// The picture of an environment, where it has one that was read.
fn picture<'a>(scene: &'a Scene, e: &Environment) -> Option<(EnvironmentImage, &'a Arc<Pixels>)> {
    let image = e.image?;
    Some((image, scene.images.get(image.image.0 as usize)?.pixels.as_ref()?))
}

/// Whether an environment sends no light at all.
pub(super) fn is_dark(scene: &Scene, e: &Environment) -> bool {
    let black = |(_, pixels): (_, &Arc<Pixels>)| match &pixels.texels {
        Texels::Byte(t) => t.iter().all(|&[r, g, b, _]| [r, g, b] == [0; 3]),
        Texels::Short(t) => t.iter().all(|&[r, g, b, _]| [r, g, b] == [0; 3]),
        Texels::Float(t) => t.iter().flatten().all(|&c| c == 0.0),
    };
    e.radiance.is_black() || picture(scene, e).is_some_and(black)
}

/// The emissive primitives of one object; neighbouring triangles that form a rectangle become one.
fn surfaces(
    flat: &Flat,
    first: u32,
    count: u32,
    nominal: &dyn Fn(&[PrimitiveId]) -> Option<Rgb>,
    both_sides: bool,
    emitters: &mut Vec<Emitter>,
) {
    let id = |primitive: u32| PrimitiveId { instance: 0, primitive };
    if count == 0 {
        // A mesh of which nothing but degenerate triangles was left; it stands where the next object begins.
        return;
    }
    let triangles = flat.world.triangles.len() as u32;
    if first >= triangles {
        let Some(radiance) = nominal(&[id(first)]) else { return };
        let (center, radius) = flat.world.spheres[(first - triangles) as usize];
        emitters.push(Emitter::Sphere {
            shape: SphereLight { center, radius },
            radiance,
            both_sides,
            spot: None,
            primitive: Some(id(first)),
            visible_to_camera: true,
        });
        return;
    }
    let mut i = first;
    while i < first + count {
        let v = flat.world.vertices(i);
        if i + 1 < first + count
            && let Some(shape) = from_triangles(v, flat.world.vertices(i + 1))
        {
            let primitives = [id(i), id(i + 1)];
            if let Some(radiance) = nominal(&primitives) {
                let primitives = Some(primitives);
                let visible_to_camera = true;
                emitters.push(Emitter::Rectangle {
                    shape,
                    radiance,
                    both_sides,
                    primitives,
                    visible_to_camera,
                });
            }
            i += 2;
            continue;
        }
        if let Some(shape) = TriangleLight::new(v)
            && let Some(radiance) = nominal(&[id(i)])
        {
            emitters.push(Emitter::Triangle { shape, radiance, both_sides, primitive: id(i) });
        }
        i += 1;
    }
}

/// A light that is not a surface; `None` where it has no power or no extent to have it on.
pub(super) fn free(light: &Light) -> Option<Emitter> {
    let m = &light.transform;
    let position = m.translation.as_vec3();
    let forward = -m.matrix3.z_axis.try_normalize()?;
    let visible_to_camera = light.visible_to_camera;
    let scale = libm::cbrt(m.matrix3.determinant().abs());
    let ball = |intensity: Rgb, radius: f64, spot: Option<Spot>| {
        let radius = radius * scale;
        if radius > 0.0 {
            let radiance = intensity / (std::f64::consts::PI * radius * radius) as f32;
            let shape = SphereLight { center: position, radius: radius as f32 };
            Emitter::Sphere { shape, radiance, both_sides: false, spot, primitive: None, visible_to_camera }
        } else {
            Emitter::Point { position, intensity, spot }
        }
    };
    let emitter = match light.kind {
        LightKind::Point { intensity, radius } => ball(intensity, radius, None),
        LightKind::Spot { intensity, inner, outer, falloff, radius } => {
            ball(intensity, radius, Some(spot(forward, inner, outer, falloff)))
        }
        LightKind::Sun { irradiance, angle } => {
            // 1 - cos(x) = 2 sin^2(x / 2)
            let s = libm::sin(angle / 4.0);
            Emitter::Sun {
                towards: (-forward).as_vec3(),
                irradiance,
                one_minus_cos: (2.0 * s * s) as f32,
                visible_to_camera,
            }
        }
        LightKind::Area { shape, size, radiance } => {
            let (x, y) = (m.matrix3.x_axis * size[0], m.matrix3.y_axis * size[1]);
            area(shape, m.translation, x, y, forward, radiance, visible_to_camera)?
        }
    };
    (emitter.power(1.0) > 0.0).then_some(emitter)
}

fn spot(axis: DVec3, inner: f64, outer: f64, falloff: SpotFalloff) -> Spot {
    let cos_outer = libm::cos(outer);
    let (cos_inner, curve) = match falloff {
        SpotFalloff::Gltf => (libm::cos(inner), SpotCurve::Square),
        // The ramp covers the share 1 - inner / outer of 1 - cos(outer).
        SpotFalloff::Blender => {
            let blend = if outer > 0.0 { 1.0 - inner / outer } else { 0.0 };
            (cos_outer + (1.0 - cos_outer) * blend, SpotCurve::Smoothstep)
        }
    };
    Spot { axis: axis.as_vec3(), curve, cos_inner: cos_inner as f32, cos_outer: cos_outer as f32 }
}

fn area(
    shape: AreaShape,
    center: DVec3,
    x: DVec3,
    y: DVec3,
    forward: DVec3,
    radiance: Rgb,
    visible_to_camera: bool,
) -> Option<Emitter> {
    // Edges in the order that makes the normal point to the side of own -Z, of mirrored lights too.
    let (x, y) = if y.cross(x).dot(forward) < 0.0 { (y, x) } else { (x, y) };
    match shape {
        AreaShape::Rectangle => {
            let corner = (center - 0.5 * x - 0.5 * y).as_vec3();
            let shape = Rectangle::new(corner, [y.as_vec3(), x.as_vec3()])?;
            Some(Emitter::Rectangle {
                shape,
                radiance,
                both_sides: false,
                primitives: None,
                visible_to_camera,
            })
        }
        AreaShape::Ellipse => {
            let n = y.cross(x).try_normalize()?.as_vec3();
            let (a, b) = principal_axes(0.5 * x, 0.5 * y);
            let half_axes = [a.as_vec3(), b.as_vec3()];
            let shape = Ellipse { center: center.as_vec3(), half_axes, n };
            Some(Emitter::Ellipse { shape, radiance, visible_to_camera })
        }
    }
}

/// The perpendicular half axes of the ellipse a cos(t) + b sin(t): those at t and t + pi/2 with
/// tan(2 t) = 2 a.b / (a^2 - b^2).
fn principal_axes(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let skew = 2.0 * a.dot(b);
    if skew.abs() <= 1e-12 * a.length() * b.length() {
        return (a, b);
    }
    let t = 0.5 * libm::atan2(skew, a.length_squared() - b.length_squared());
    let (s, c) = (libm::sin(t), libm::cos(t));
    (a * c + b * s, b * c - a * s)
}

/// The magnitude of radiance that the film is made for: the brightest emitter, where a point counts
/// as seen from as far away as `camera` is: what a picture shows is not much nearer to it or farther from
/// it than that, however large the scene may be. At least the smallest normal number.
pub(super) fn brightest(groups: &[Group], camera: DVec3, scene_radius: f64) -> f32 {
    let irradiance = |position: Vec3, intensity: Rgb| {
        let d = position.as_dvec3().distance(camera);
        // A light that the camera carries says nothing about the distance to what it lights.
        let across = if scene_radius > 0.0 { scene_radius } else { 1.0 };
        let d = if d > 0.0 { d } else { across };
        intensity.map(|i| (f64::from(i) / (d * d)).min(f64::from(f32::MAX)) as f32)
    };
    let radiance = |e: &Emitter| match e {
        Emitter::Triangle { radiance, .. }
        | Emitter::Rectangle { radiance, .. }
        | Emitter::Ellipse { radiance, .. }
        | Emitter::Sphere { radiance, .. }
        | Emitter::Environment { radiance, .. } => *radiance,
        Emitter::Panorama { map, .. } => map.brightest(),
        Emitter::Sun { irradiance, .. } => *irradiance,
        Emitter::Point { position, intensity, .. } => irradiance(*position, *intensity),
    };
    groups
        .iter()
        .flat_map(|g| &g.emitters)
        .map(|e| radiance(e).max_channel())
        .fold(f32::MIN_POSITIVE, f32::max)
}

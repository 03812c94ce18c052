//! What throws light: the objects that photons are aimed at.
//!
//! A material throws light where one of its lobes has no spread, or where all of them are narrow. Flat objects with few faces are aimed at face
//! by face, everything else by a ball around it.

use glam::{DVec3, Vec2, Vec3};

use super::camera::CameraRays;
use super::fold::Folded;
use super::geometry::Flat;
use super::material::{Numbers, darkest, has_coat, is_narrow};
use crate::accel::{Accel, PrimitiveId, RayKind};
use crate::bsdf::SMOOTH_ALPHA;
use crate::light::{
    Aim, LightSet, PhotonLights, Rectangle, SphereLight, Target, TargetShape, TriangleLight, ball_around,
    from_triangles,
};
use crate::math::{gamma, sqr};
use crate::scene::{MaterialKind, Principled, ScalarTexture, Scene};

/// Objects with more triangles than this are aimed at as one ball.
const MOST_FACES: u32 = 32;

/// Photons: where they start, and which way.
#[derive(Clone, Debug)]
pub(crate) struct Photons {
    /// Towards what throws light.
    pub(crate) casting: Casting,
    /// Towards everything.
    pub(crate) everywhere: PhotonLights,
    /// Radius of a ball around most of what is in view, metres.
    pub(crate) view: f32,
    /// Middle and radius of a ball around everything.
    all: (DVec3, f64),
}

/// Rows and columns of the camera rays that tell what is in view.
const LOOKS: u32 = 16;

/// What is farther away than this many times the median of what is in view is not aimed at.
const FAR: f32 = 4.0;

impl Photons {
    /// Beside a ball around everything (its middle and radius), photons are aimed at what is in view, or few of those of a sun
    /// would meet it.
    pub(super) fn new(
        casting: Casting,
        lights: &LightSet,
        all: (DVec3, f64),
        accel: &Accel,
        camera: &CameraRays,
        size: [u32; 2],
    ) -> Self {
        let everywhere = PhotonLights::new(lights, Aim::default(), all.1);
        let mut photons = Self { casting, everywhere, view: 0.0, all };
        photons.aim(lights, accel, camera, size);
        photons
    }

    /// Aims those that go everywhere at what a camera sees.
    pub(super) fn aim(&mut self, lights: &LightSet, accel: &Accel, camera: &CameraRays, size: [u32; 2]) {
        let (middle, radius) = (self.all.0.as_vec3(), self.all.1);
        let rounding = f64::from(middle.abs().max_element()) * f64::from(gamma(8));
        // From inside of a target that holds everything, light leaves as it is emitted.
        let all = (radius * 1.000_01 + rounding) as f32;
        let mut targets = vec![Target::ball(middle, all, 1.0)];
        let view = view(accel, camera, size).filter(|b| b.radius > 0.0 && b.radius < all);
        // As many of those that are parallel go to both.
        targets.extend(view.map(|b| Target::ball(b.center, b.radius, sqr(all / b.radius))));
        self.view = view.map_or(all, |b| b.radius);
        self.everywhere = PhotonLights::new(lights, Aim::new(targets), radius);
    }
}

/// A ball around most of what the camera sees.
fn view(accel: &Accel, camera: &CameraRays, size: [u32; 2]) -> Option<SphereLight> {
    let mut seen = Vec::new();
    for i in 0..LOOKS * LOOKS {
        let at = |i: u32, n: u32| (u64::from(2 * i + 1) * u64::from(n) / u64::from(2 * LOOKS)) as u32;
        let pixel = [at(i % LOOKS, size[0]), at(i / LOOKS, size[1])];
        let ray = camera.ray(pixel, [0.5, 0.5], || Vec2::ZERO);
        if let Some(hit) = accel.closest(&ray, PrimitiveId::NONE, RayKind::Camera) {
            seen.push((hit.t, ray.at(hit.t)));
        }
    }
    seen.sort_by(|a, b| a.0.total_cmp(&b.0));
    let far = FAR * seen.get(seen.len() / 2)?.0;
    let near = seen.iter().filter(|(t, _)| *t <= far).map(|(_, p)| *p);
    Some(ball_around(near))
}

/// Where photons start that are aimed at what throws light, and which materials throw them on.
#[derive(Clone, Debug)]
pub(crate) struct Casting {
    pub(crate) lights: PhotonLights,
    /// For each material, whether it throws light ([`throws`]).
    pub(crate) casts: Vec<bool>,
}

impl Casting {
    pub(super) fn new(scene: &Scene, folded: &Folded<'_>, flat: &Flat, lights: &LightSet) -> Self {
        let strength: Vec<_> = folded.kinds.iter().map(|k| throws(scene, k)).collect();
        let mut targets = Vec::new();
        for (object, range) in scene.objects.iter().zip(&flat.range) {
            if let (Some(s), &Some((first, count))) = (strength[object.material.0 as usize], range) {
                in_world(flat, first, count, s, &mut targets);
            }
        }
        for (place, placed) in flat.placements.iter().zip(&flat.attributes.placed) {
            let object = &scene.objects[placed.object as usize];
            if let Some(s) = strength[object.material.0 as usize] {
                let mesh = &flat.meshes[place.mesh as usize];
                let world = |p: &Vec3| place.to_world.transform_point3(p.as_dvec3()).as_vec3();
                let ball = ball_around(mesh.positions.iter().map(world));
                targets.push(Target::ball(ball.center, ball.radius, s));
            }
        }
        let lights = PhotonLights::new(lights, Aim::new(targets), flat.radius);
        Self { lights, casts: strength.iter().map(Option::is_some).collect() }
    }
}

/// The targets of an object whose primitives are the `count` ones from `first`.
fn in_world(flat: &Flat, first: u32, count: u32, strength: f32, targets: &mut Vec<Target>) {
    let triangles = flat.world.triangles.len() as u32;
    if count == 0 {
        return;
    }
    if first >= triangles {
        let (center, radius) = flat.world.spheres[(first - triangles) as usize];
        targets.push(Target::ball(center, radius, strength));
        return;
    }
    if count > MOST_FACES {
        let corners = (first..first + count).flat_map(|i| flat.world.vertices(i));
        let ball = ball_around(corners);
        targets.push(Target::ball(ball.center, ball.radius, strength));
        return;
    }
    let mut i = first;
    while i < first + count {
        let v = flat.world.vertices(i);
        let pair = (i + 1 < first + count).then(|| from_triangles(v, flat.world.vertices(i + 1))).flatten();
        if let Some(r) = pair {
            targets.push(face(&r, strength));
            i += 2;
            continue;
        }
        if let Some(t) = TriangleLight::new(v) {
            targets.push(Target::flat(TargetShape::Triangle(t), &v, strength));
        }
        i += 1;
    }
}

fn face(r: &Rectangle, strength: f32) -> Target {
    Target::flat(TargetShape::Rectangle(*r), &r.corners(), strength)
}

/// The share of light that a material throws on where photons look for it, roughly, (0, 1]; `None` where none of its
/// lobes can be without spread, and one is wide.
pub(super) fn throws(scene: &Scene, kind: &MaterialKind) -> Option<f32> {
    let share = |p: &Principled| {
        let metal = Numbers::from(p).metallic * p.base_color.max_channel();
        (metal + (1.0 - p.metallic) * p.transmission).clamp(LEAST, 1.0)
    };
    casts(scene, kind).or_else(|| match kind {
        MaterialKind::Principled(p) if is_narrow(kind) => Some(share(p)),
        _ => None,
    })
}

/// The share of light that a material throws on without spread, roughly, (0, 1]; `None` where none of its lobes can be
/// without spread.
pub(super) fn casts(scene: &Scene, kind: &MaterialKind) -> Option<f32> {
    match kind {
        MaterialKind::Diffuse { .. } | MaterialKind::Light { .. } => None,
        MaterialKind::Mirror { color } => (!color.is_black()).then(|| color.max_channel().clamp(LEAST, 1.0)),
        MaterialKind::Glass(_) => Some(1.0),
        MaterialKind::Principled(p) => principled(scene, p),
    }
}

/// No share counts as less: what is thrown at grazing angles, or by a texel, may be all.
const LEAST: f32 = 0.06;

fn principled(scene: &Scene, p: &Principled) -> Option<f32> {
    let numbers = Numbers::from(p);
    let t = &p.textures;
    // Textures multiply, so that they may make smoother what is rough.
    let smooth = |roughness: f32, texture: &Option<ScalarTexture>| {
        let least = roughness * texture.as_ref().map_or(1.0, |t| darkest(scene, t));
        least * least < SMOOTH_ALPHA
    };
    let metallic = if numbers.metallic > 0.0 { numbers.metallic } else { 0.0 };
    let transmits = if metallic < 1.0 || t.metallic.is_some() { numbers.transmission } else { 0.0 };
    let mut share: Option<f32> = None;
    let mut add = |s: f32| share = Some(share.unwrap_or(0.0) + s);
    if smooth(numbers.roughness, &t.roughness) {
        if metallic > 0.0 {
            add(metallic * p.base_color.max_channel());
        }
        if transmits > 0.0 {
            add((1.0 - metallic) * transmits);
        }
        if numbers.specular > 0.0 && numbers.ior != 1.0 {
            add(LEAST);
        }
    } else if transmits > 0.0 && numbers.ior == 1.0 && !numbers.thin {
        // A body of index one lets light pass straight, however rough it is.
        add((1.0 - metallic) * transmits);
    }
    if has_coat(&numbers) && smooth(numbers.coat_roughness, &t.coat_roughness) {
        add(LEAST * numbers.coat);
    }
    share.map(|s| s.clamp(LEAST, 1.0))
}

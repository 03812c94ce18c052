//! Flattening: objects become world-space primitives, or placements of repeated meshes.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::fold::Folded;
use crate::accel::{Geometry, Placement, PrimitiveId};
use crate::scene::{Camera, Mesh, Object, Scene, Shape};

/// Meshes with fewer triangles than this are cheaper to copy than to instance.
const SMALLEST_INSTANCE: usize = 16;

/// What shading needs to know of primitives, beside the geometry in the accelerator.
#[derive(Clone, Debug, Default)]
pub(super) struct Attributes {
    /// Object of each world primitive.
    pub(super) object: Vec<u32>,
    /// Vertex normals of each space, parallel to its positions; empty where all of a space is flat,
    /// and zero at vertices of flat meshes.
    pub(super) normals: Vec<Vec<Vec3>>,
    /// Of each placement: its object, own space to world space, and the rotation of normals.
    pub(super) placed: Vec<Placed>,
}

#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) object: u32,
    pub(super) to_world: DAffine3,
    pub(super) normal: DMat3,
}

impl Attributes {
    #[inline]
    pub(super) fn object_of(&self, id: PrimitiveId) -> u32 {
        if id.instance == 0 {
            self.object[id.primitive as usize]
        } else {
            self.placed[id.instance as usize - 1].object
        }
    }
}

/// Flattened geometry.
#[derive(Debug, Default)]
pub(super) struct Flat {
    pub(super) world: Geometry,
    pub(super) meshes: Vec<Geometry>,
    pub(super) placements: Vec<Placement>,
    pub(super) attributes: Attributes,
    /// World primitives in all.
    pub(super) primitives: usize,
    /// Of each object that is in the world: its first primitive and their number.
    pub(super) range: Vec<Option<(u32, u32)>>,
    /// Middle of a sphere around everything, world space.
    pub(super) middle: DVec3,
    /// Its radius, metres; zero for an empty scene.
    pub(super) radius: f64,
}

impl Flat {
    /// An upper bound on coordinates and distances of what `camera` sees, metres.
    pub(super) fn reach(&self, camera: &Camera) -> f64 {
        let largest = |g: &Geometry| g.positions.iter().map(|p| p.abs().max_element()).fold(0.0f32, f32::max);
        let mut reach = f64::from(largest(&self.world));
        for &(c, r) in &self.world.spheres {
            reach = reach.max(f64::from(c.abs().max_element() + r));
        }
        for p in &self.placements {
            let r = f64::from(largest(&self.meshes[p.mesh as usize]));
            reach = reach
                .max(p.to_world.matrix3.abs_max() * 3.0 * r + p.to_world.translation.abs().max_element());
        }
        (reach + camera.transform.translation.abs().max_element()) * 4.0
    }
}

trait AbsMax {
    fn abs_max(&self) -> f64;
}

impl AbsMax for DMat3 {
    fn abs_max(&self) -> f64 {
        [self.x_axis, self.y_axis, self.z_axis].iter().map(|c| c.abs().max_element()).fold(0.0, f64::max)
    }
}

/// True where a mesh is repeated often and large enough to be shared; emitters are lights, and each
/// needs primitives of its own.
fn shared(scene: &Scene, folded: &Folded<'_>) -> Vec<bool> {
    let mut uses = vec![0usize; scene.meshes.len()];
    let mut emits = vec![false; scene.meshes.len()];
    for o in &scene.objects {
        if let Shape::Mesh(m) = o.shape {
            uses[m.0 as usize] += 1;
            emits[m.0 as usize] |= folded.kinds[o.material.0 as usize].emission().is_some();
        }
    }
    (0..scene.meshes.len())
        .map(|i| uses[i] >= 2 && scene.meshes[i].triangles.len() >= SMALLEST_INSTANCE && !emits[i])
        .collect()
}

/// All meshes that are repeated keep their own space; everything else is copied to the world. Where `smooth` is
/// false, the normals of vertices are left out.
pub(super) fn flatten(scene: &Scene, folded: &Folded<'_>, smooth: bool) -> Flat {
    let shared = shared(scene, folded);
    let mut flat = Flat { range: vec![None; scene.objects.len()], ..Flat::default() };
    let mut world_normals = Vec::new();
    // World triangles come before world spheres, so spheres wait.
    for (i, object) in scene.objects.iter().enumerate() {
        if let Shape::Mesh(id) = object.shape
            && !shared[id.0 as usize]
        {
            let first = flat.world.triangles.len() as u32;
            let mesh = &scene.meshes[id.0 as usize];
            add_mesh(&mut flat.world, &mut world_normals, mesh, &object.transform, smooth);
            let count = flat.world.triangles.len() as u32 - first;
            flat.attributes.object.extend(std::iter::repeat_n(i as u32, count as usize));
            flat.range[i] = Some((first, count));
        }
    }
    for (i, object) in scene.objects.iter().enumerate() {
        if let Shape::Sphere { radius } = object.shape {
            let first = (flat.world.triangles.len() + flat.world.spheres.len()) as u32;
            let scale = object.transform.matrix3.x_axis.length();
            let center = object.transform.translation.as_vec3();
            flat.world.spheres.push((center, (radius * scale) as f32));
            flat.attributes.object.push(i as u32);
            flat.range[i] = Some((first, 1));
        }
    }
    flat.primitives = flat.attributes.object.len();
    flat.attributes.normals.push(tidy_normals(world_normals));
    if scene.objects.iter().any(|o| !o.visible_to_camera) {
        let hidden = |&o: &u32| !scene.objects[o as usize].visible_to_camera;
        flat.world.hidden = flat.attributes.object.iter().map(hidden).collect();
    }
    place_shared(scene, &shared, &mut flat, smooth);
    (flat.middle, flat.radius) = ball(scene, &flat);
    flat
}

fn place_shared(scene: &Scene, shared: &[bool], flat: &mut Flat, smooth: bool) {
    let mut index = vec![u32::MAX; scene.meshes.len()];
    for (i, object) in scene.objects.iter().enumerate() {
        let Object { shape: Shape::Mesh(id), transform, visible_to_camera, .. } = object else { continue };
        let id = id.0 as usize;
        if !shared[id] {
            continue;
        }
        if index[id] == u32::MAX {
            index[id] = flat.meshes.len() as u32;
            let (mut geometry, mut normals) = (Geometry::default(), Vec::new());
            add_mesh(&mut geometry, &mut normals, &scene.meshes[id], &DAffine3::IDENTITY, smooth);
            flat.meshes.push(geometry);
            flat.attributes.normals.push(tidy_normals(normals));
        }
        flat.placements.push(Placement { mesh: index[id], to_world: *transform, hidden: !visible_to_camera });
        flat.attributes.placed.push(Placed {
            object: i as u32,
            to_world: *transform,
            normal: transform.matrix3.inverse().transpose(),
        });
    }
}

/// No normals at all where every one is zero.
fn tidy_normals(normals: Vec<Vec3>) -> Vec<Vec3> {
    if normals.iter().all(|&n| n == Vec3::ZERO) { Vec::new() } else { normals }
}

/// Appends a mesh in the space that `to_space` leads to; mirrored ones keep their front in front.
fn add_mesh(
    geometry: &mut Geometry,
    normals: &mut Vec<Vec3>,
    mesh: &Mesh,
    to_space: &DAffine3,
    smooth: bool,
) {
    let base = geometry.positions.len() as u32;
    let flips = to_space.matrix3.determinant() < 0.0;
    geometry
        .positions
        .extend(mesh.positions.iter().map(|p| to_space.transform_point3(p.as_dvec3()).as_vec3()));
    if mesh.normals.is_empty() || !smooth {
        normals.resize(geometry.positions.len(), Vec3::ZERO);
    } else {
        let m = to_space.matrix3.inverse().transpose();
        let turn = |n: &Vec3| (m * n.as_dvec3()).try_normalize().unwrap_or(DVec3::ZERO).as_vec3();
        normals.extend(mesh.normals.iter().map(turn));
    }
    let wind = |&[a, b, c]: &[u32; 3]| {
        if flips { [base + a, base + c, base + b] } else { [base + a, base + b, base + c] }
    };
    geometry.triangles.extend(mesh.triangles.iter().map(wind));
}

/// Middle of the bounding box of everything, and radius of a sphere around it that holds the box.
fn ball(scene: &Scene, flat: &Flat) -> (DVec3, f64) {
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut include = |p: DVec3| {
        lo = lo.min(p);
        hi = hi.max(p);
    };
    flat.world.positions.iter().for_each(|p| include(p.as_dvec3()));
    for &(c, r) in &flat.world.spheres {
        include(c.as_dvec3() - f64::from(r));
        include(c.as_dvec3() + f64::from(r));
    }
    for p in &flat.placements {
        for v in &flat.meshes[p.mesh as usize].positions {
            include(p.to_world.transform_point3(v.as_dvec3()));
        }
    }
    for l in &scene.lights {
        include(l.transform.translation);
    }
    if lo.x > hi.x { (DVec3::ZERO, 0.0) } else { (0.5 * (lo + hi), 0.5 * (hi - lo).length()) }
}

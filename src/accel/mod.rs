//! Which surface a ray meets first.
//!
//! In: world-space triangles and spheres, and meshes with the transforms that repeat them. Out: the
//! closest [`Hit`], or whether anything is in the way. The interface is narrow on purpose: builder,
//! tree and kernel can be replaced behind it.
//!
//! The closest hit is the lexicographic minimum of (t, instance, primitive), and boxes only ever skip
//! what lies beyond the best t so far; so the answer does not depend on the builder, on the width of
//! the tree, or on the order in which it is walked.

mod build;
mod lanes;
mod packet;
mod simd;
mod traverse;
mod tree;

use glam::{DAffine3, Mat3, Vec3};

use crate::shape::Ray;
use tree::Tree;

/// A triangle or sphere of one instance; what a ray leaves, and must not meet again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PrimitiveId {
    /// 0 is the world; repeated meshes follow.
    pub instance: u32,
    /// Triangles first, then spheres.
    pub primitive: u32,
}

impl PrimitiveId {
    /// No primitive: for rays that start in empty space.
    pub const NONE: Self = Self { instance: u32::MAX, primitive: u32::MAX };
}

/// Where a ray meets a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, metres.
    pub t: f32,
    /// What was hit.
    pub id: PrimitiveId,
    /// Barycentric coordinates of a triangle's second and third vertex; zero for a sphere.
    pub b: [f32; 2],
}

/// Triangles and spheres in one space.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Vertex positions, metres.
    pub positions: Vec<Vec3>,
    /// Three vertex indices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Centre and radius, metres.
    pub spheres: Vec<(Vec3, f32)>,
    /// For each primitive, whether camera rays pass through it; empty where none do.
    pub hidden: Vec<bool>,
}

impl Geometry {
    /// The vertices of a triangle.
    #[inline]
    #[must_use]
    pub fn vertices(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|i| self.positions[i as usize])
    }
}

/// A repeated mesh placed in the world.
#[derive(Clone, Debug)]
pub struct Placement {
    /// Index into the meshes given to [`Accel::new`].
    pub mesh: u32,
    /// Own space to world space.
    pub to_world: DAffine3,
    /// Whether camera rays pass through it.
    pub hidden: bool,
}

#[derive(Clone, Debug)]
struct Instance {
    mesh: u32,
    linear: Mat3,
    translation: Vec3,
    hidden: bool,
}

/// Everything that blocks light.
#[derive(Clone, Debug)]
pub struct Accel {
    /// Space 0 is the world, the others are the repeated meshes.
    spaces: Vec<Tree>,
    instances: Vec<Instance>,
    top: Option<Tree>,
    any_hidden: bool,
    features: simd::Features,
}

/// Which rays a query is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the camera: some objects are hidden from it.
    Camera,
    /// Every other ray.
    Other,
}

impl Accel {
    /// Builds the trees over `world` and over `meshes`, which `placements` repeat; the placement with
    /// index i is instance i + 1.
    #[must_use]
    pub fn new(world: Geometry, meshes: Vec<Geometry>, placements: &[Placement]) -> Self {
        let any_hidden = world.hidden.iter().any(|&h| h) || placements.iter().any(|p| p.hidden);
        let spaces: Vec<Tree> = std::iter::once(world).chain(meshes).map(Tree::over_geometry).collect();
        let instances: Vec<Instance> = placements
            .iter()
            .map(|p| {
                let inverse = p.to_world.inverse();
                Instance {
                    mesh: p.mesh + 1,
                    linear: inverse.matrix3.as_mat3(),
                    translation: inverse.translation.as_vec3(),
                    hidden: p.hidden,
                }
            })
            .collect();
        let top = (!placements.is_empty()).then(|| {
            let boxes =
                placements.iter().map(|p| spaces[p.mesh as usize + 1].bounds.transformed(&p.to_world));
            Tree::over_boxes(&boxes.collect::<Vec<_>>())
        });
        Self { spaces, instances, top, any_hidden, features: simd::Features::detect() }
    }

    /// The same, walked by the portable kernel: the twin that tests compare with.
    #[must_use]
    pub fn portable(mut self) -> Self {
        self.features = simd::Features::PORTABLE;
        self
    }

    /// The first surface that `ray` meets, other than the primitive `from` that it leaves.
    #[inline]
    #[must_use]
    pub fn closest(&self, ray: &Ray, from: PrimitiveId, kind: RayKind) -> Option<Hit> {
        self.closest_between(ray, [from, PrimitiveId::NONE], kind)
    }

    /// The first surface that `ray` meets, other than the two primitives of `between`.
    #[inline]
    #[must_use]
    pub fn closest_between(&self, ray: &Ray, between: [PrimitiveId; 2], kind: RayKind) -> Option<Hit> {
        simd::closest(self, ray, between, kind == RayKind::Camera && self.any_hidden)
    }

    /// Whether anything but the two primitives of `between` is in the way before `ray.t_max`.
    #[inline]
    #[must_use]
    pub fn occluded(&self, ray: &Ray, between: [PrimitiveId; 2]) -> bool {
        simd::occluded(self, ray, between)
    }

    /// Whether camera rays pass through a primitive.
    #[must_use]
    pub fn is_hidden(&self, id: PrimitiveId) -> bool {
        if id.instance == 0 {
            self.spaces[0].geometry.hidden.get(id.primitive as usize).copied().unwrap_or(false)
        } else {
            self.instances[id.instance as usize - 1].hidden
        }
    }

    /// The geometry of a space: 0 the world, i + 1 the repeated mesh i.
    #[must_use]
    pub fn geometry(&self, space: u32) -> &Geometry {
        &self.spaces[space as usize].geometry
    }

    /// The space of an instance.
    #[inline]
    #[must_use]
    pub fn space_of(&self, instance: u32) -> u32 {
        if instance == 0 { 0 } else { self.instances[instance as usize - 1].mesh }
    }
}

#[cfg(test)]
mod tests;

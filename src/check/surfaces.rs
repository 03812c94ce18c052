//! Surfaces and small scenes that several hard cases share.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::Figure;
use super::random::Random;
use crate::color::Rgb;
use crate::prepare::{Algorithms, EffectsMode, Options, Prepared, Shortcuts, prepare};
use crate::scene::{
    Camera, FovAxis, Material, MaterialId, MaterialKind, Mesh, MeshId, Object, Projection, Scene, Shape,
    Sides, validate,
};
use crate::shape::{Ray, triangle};

/// Any rotation.
pub(super) fn rotation(r: &mut Random) -> DMat3 {
    DMat3::from_axis_angle(
        r.direction().as_dvec3().normalize(),
        r.between(-std::f64::consts::PI, std::f64::consts::PI),
    )
}

/// A triangle with edges of about `size` around `at`.
pub(super) fn any_triangle(r: &mut Random, size: f64, at: DVec3) -> [Vec3; 3] {
    [0; 3].map(|_| {
        let v = DVec3::new(r.between(-0.5, 0.5), r.between(-0.5, 0.5), r.between(-0.5, 0.5));
        (at + v * size).as_vec3()
    })
}

/// Barycentric coordinates of the second and third vertex, uniform over the triangle.
pub(super) fn barycentric(r: &mut Random) -> [f64; 2] {
    let (a, b) = (r.unit(), r.unit());
    if a + b > 1.0 { [1.0 - a, 1.0 - b] } else { [a, b] }
}

/// The point of a triangle at barycentric coordinates.
pub(super) fn at(v: [Vec3; 3], [b1, b2]: [f64; 2]) -> DVec3 {
    let v = v.map(|p| p.as_dvec3());
    v[0] + (v[1] - v[0]) * b1 + (v[2] - v[0]) * b2
}

/// The ray from `o` through `target`; `None` where they coincide.
pub(super) fn aimed(o: Vec3, target: DVec3) -> Option<Ray> {
    let d = (target - o.as_dvec3()).try_normalize()?.as_vec3();
    Some(Ray::new(o, d.try_normalize()?))
}

/// A unit vector at a given cosine to the unit vector `n`.
pub(super) fn tilted(r: &mut Random, n: Vec3, cos: f64) -> Vec3 {
    let n = n.as_dvec3();
    let t = n.cross(r.direction().as_dvec3()).try_normalize().unwrap_or(n.any_orthonormal_vector());
    (n * cos + t * ((1.0 - cos) * (1.0 + cos)).sqrt()).as_vec3().normalize()
}

/// The largest absolute coordinate.
pub(super) fn largest(v: [Vec3; 3]) -> f64 {
    f64::from(v.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max))
}

/// The plane of a triangle, in double precision.
pub(super) struct Plane {
    /// A point of it.
    pub(super) p: DVec3,
    /// Unit normal.
    pub(super) n: DVec3,
}

impl Plane {
    /// Through three points; `None` where they lie on a line.
    pub(super) fn of(v: [Vec3; 3]) -> Option<Self> {
        let [a, b, c] = v.map(|p| p.as_dvec3());
        Some(Self { p: a, n: (b - a).cross(c - a).try_normalize()? })
    }

    /// Height of a point above it.
    pub(super) fn height(&self, p: Vec3) -> f64 {
        (p.as_dvec3() - self.p).dot(self.n)
    }
}

/// A closed surface around `center`: `n` rings of `n` vertices, joined at two poles, with radii from `radius`.
pub(super) fn closed(n: u32, center: Vec3, mut radius: impl FnMut() -> f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut point = |theta: f64, phi: f64| {
        let ((s, c), (sp, cp)) = (libm::sincos(theta), libm::sincos(phi));
        center + (DVec3::new(s * cp, s * sp, c) * radius()).as_vec3()
    };
    for ring in 1..=n {
        for column in 0..n {
            let theta = std::f64::consts::PI * f64::from(ring) / f64::from(n + 1);
            positions.push(point(theta, std::f64::consts::TAU * f64::from(column) / f64::from(n)));
        }
    }
    let poles = [n * n, n * n + 1];
    positions.push(point(0.0, 0.0));
    positions.push(point(std::f64::consts::PI, 0.0));
    let index = |ring: u32, column: u32| ring * n + column % n;
    for c in 0..n {
        triangles.push([poles[0], index(0, c), index(0, c + 1)]);
        triangles.push([poles[1], index(n - 1, c + 1), index(n - 1, c)]);
        for ring in 0..n - 1 {
            let (a, b) = (index(ring, c), index(ring, c + 1));
            let (d, e) = (index(ring + 1, c), index(ring + 1, c + 1));
            triangles.extend([[a, d, b], [b, d, e]]);
        }
    }
    (positions, triangles)
}

/// A square around `center` with edges of `size`, facing +Y, or -Y where `down`.
pub(super) fn square(center: DVec3, size: f64, down: bool) -> Mesh {
    let h = 0.5 * size;
    let corner = |[x, z]: [f64; 2]| (center + DVec3::new(x * h, 0.0, z * h)).as_vec3();
    let positions = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(corner).to_vec();
    let triangles = if down { vec![[0, 2, 1], [0, 3, 2]] } else { vec![[0, 1, 2], [0, 2, 3]] };
    Mesh { positions, triangles, ..Mesh::default() }
}

/// A closed box around `center`, facing outwards.
pub(super) fn cube(center: DVec3, size: f64) -> Mesh {
    let corner = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 0 { -0.5 * size } else { 0.5 * size };
        (center + DVec3::new(side(0), side(1), side(2))).as_vec3()
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() }
}

/// Adds a material and returns its id.
pub(super) fn material(scene: &mut Scene, kind: MaterialKind) -> MaterialId {
    let id = scene.materials.len() as u32;
    scene.materials.push(Material { name: format!("m{id}"), kind });
    MaterialId(id)
}

/// A surface that emits `radiance` to its front.
pub(super) fn lamp(radiance: f32) -> MaterialKind {
    MaterialKind::Light { radiance: Rgb::grey(radiance), sides: Sides::Front }
}

/// Adds a mesh as an object.
pub(super) fn mesh(scene: &mut Scene, mesh: Mesh, material: MaterialId) {
    let id = MeshId(scene.meshes.len() as u32);
    scene.meshes.push(mesh);
    object(scene, Shape::Mesh(id), material, DVec3::ZERO);
}

/// Adds a sphere.
pub(super) fn ball(scene: &mut Scene, center: DVec3, radius: f64, material: MaterialId) {
    object(scene, Shape::Sphere { radius }, material, center);
}

fn object(scene: &mut Scene, shape: Shape, material: MaterialId, place: DVec3) {
    scene.objects.push(Object {
        name: String::new(),
        shape,
        material,
        transform: DAffine3::from_translation(place),
        visible_to_camera: true,
    });
}

/// The figure of a case whose scene is refused: it fails.
pub(super) fn refused(what: &str) -> Figure {
    Figure::exactly(format!("scenes that are refused, {what}"), 1.0, 0.0)
}

/// Validates and prepares a scene for a small picture by a camera that looks along -Z from `eye`; `None`
/// where it is refused.
pub(super) fn prepared(mut scene: Scene, eye: DVec3, max_depth: Option<u32>) -> Option<Prepared> {
    scene.cameras.push(Camera {
        name: "camera".into(),
        transform: DAffine3::from_translation(eye),
        projection: Projection::Perspective { fov: 0.7, axis: FovAxis::Horizontal },
        shift: [0.0; 2],
        lens: None,
        aspect: None,
    });
    validate(&mut scene).ok()?;
    let options = Options {
        camera: None,
        size: [32, 32],
        seed: 1,
        effects: EffectsMode::Auto,
        max_depth,
        shortcuts: Shortcuts::default(),
        transparent: false,
        algorithms: Algorithms::PATHS,
    };
    prepare(&scene, &options).ok()
}

/// A ray that left a triangle.
pub(super) struct Departure {
    /// Normal of the triangle.
    pub(super) ng: Vec3,
    /// The point as found by a ray.
    pub(super) p: Vec3,
    /// The ray that leaves.
    pub(super) ray: Ray,
}

impl Departure {
    /// Along `w` from the point of the triangle `v` at barycentric coordinates `b`; `None` without a normal.
    pub(super) fn new(v: [Vec3; 3], b: [f32; 2], w: impl FnOnce(Vec3) -> Vec3) -> Option<Self> {
        let (p, p_err) = triangle::point(v, b[0], b[1]);
        let ng = triangle::normal(v)?;
        let w = w(ng);
        Some(Self { ng, p, ray: Ray::new(crate::shape::offset_origin(p, p_err, ng, w), w) })
    }

    /// How far the origin lies above the exact plane, on the side that the ray leaves to; below zero on the
    /// other side.
    pub(super) fn clearance(&self, plane: &Plane) -> f64 {
        plane.height(self.ray.o) * f64::from(1.0f32.copysign(self.ray.d.dot(self.ng)))
    }

    /// How far the origin was moved from the point, along the normal.
    pub(super) fn displacement(&self) -> f64 {
        (self.ray.o.as_dvec3() - self.p.as_dvec3()).dot(self.ng.as_dvec3()).abs()
    }
}

//! Surfaces of the reference integrator: every triangle and sphere in world space, tried in turn.
//!
//! In: a scene. Out: the closest hit of a ray. There is no acceleration structure; an object whose
//! bounding sphere the ray misses is skipped, and that is all. The primitive that a ray starts on is
//! skipped by its number: a triangle is flat and cannot be met again, a sphere only from inside.

use glam::{DMat3, DVec3};

use super::nesting::{Crossing, NEAR};
use crate::scene::{Mesh, Scene, Shape};

/// All surfaces of a scene, in the order of its objects, so that the first of two coincident surfaces wins.
#[derive(Debug)]
pub(super) struct Geometry {
    objects: Vec<Object>,
}

#[derive(Debug)]
struct Object {
    /// Index in the scene.
    number: usize,
    material: usize,
    visible_to_camera: bool,
    /// World space.
    center: DVec3,
    /// Of the bounding sphere, or of the sphere itself.
    radius: f64,
    shape: Solid,
}

#[derive(Debug)]
enum Solid {
    Sphere,
    Triangles(Vec<Triangle>),
}

#[derive(Debug)]
struct Triangle {
    /// Index in the mesh.
    number: usize,
    corner: DVec3,
    edges: [DVec3; 2],
    /// Geometric normal, unit; the front is where it points.
    ng: DVec3,
    /// Shading normals of the corners; `ng` where the mesh has none.
    ns: [DVec3; 3],
}

/// Number of a primitive: its object, and the triangle in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Primitive {
    object: usize,
    triangle: usize,
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Metres from the ray's origin.
    pub(super) t: f64,
    /// World space.
    pub(super) point: DVec3,
    /// Geometric normal, unit, on the front side.
    pub(super) ng: DVec3,
    /// Shading normal, unit.
    pub(super) ns: DVec3,
    /// Index of the material in the scene.
    pub(super) material: usize,
    /// What was hit.
    pub(super) primitive: Primitive,
    /// Index of the object in the scene, and of the triangle in its mesh.
    pub(super) object: usize,
    pub(super) triangle: usize,
    /// Weights of the triangle's corners.
    pub(super) weights: [f64; 3],
}

/// What a ray starts on: a primitive, and another that touches it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Source {
    primitive: Option<Primitive>,
    touching: Option<Primitive>,
    /// Metres; nothing of the object that touches is met nearer than this.
    near: f64,
}

/// An object around a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// Index in the scene.
    pub(super) material: usize,
    /// Half the diagonal of its bounding box, metres.
    pub(super) extent: f64,
}

impl Source {
    /// What a ray starts on that goes on from a hit.
    pub(super) fn of(hit: &Hit, crossing: Option<&Crossing>) -> Self {
        let touching = crossing.and_then(|c| c.with);
        Self { primitive: Some(hit.primitive), touching, near: NEAR * hit.point.abs().max_element() }
    }
}

impl Geometry {
    /// Flattens a scene into world space. Objects that name no mesh or whose transform has no
    /// inverse, and triangles without area, are left out.
    pub(super) fn new(scene: &Scene) -> Self {
        let objects = scene.objects.iter().enumerate().filter_map(|(number, object)| {
            let matrix = object.transform.matrix3;
            let det = matrix.determinant();
            if det == 0.0 || !det.is_finite() {
                return None;
            }
            let (center, radius, shape) = match object.shape {
                Shape::Sphere { radius } => {
                    (object.transform.translation, radius * libm::cbrt(det.abs()), Solid::Sphere)
                }
                Shape::Mesh(id) => {
                    let mesh = scene.meshes.get(id.0 as usize)?;
                    let place = |p: glam::Vec3| object.transform.transform_point3(p.as_dvec3());
                    let triangles = flatten(mesh, place, matrix);
                    let (center, radius) = bounding_sphere(&triangles);
                    (center, radius, Solid::Triangles(triangles))
                }
            };
            let material = object.material.0 as usize;
            let visible_to_camera = object.visible_to_camera;
            Some(Object { number, material, visible_to_camera, center, radius, shape })
        });
        Self { objects: objects.collect() }
    }

    /// The closest hit of the ray from `o` along the unit vector `d`, nearer than `limit`.
    ///
    /// `source` is the primitive that the ray starts on; camera rays do not see what hides from them.
    pub(super) fn closest(
        &self,
        o: DVec3,
        d: DVec3,
        limit: f64,
        source: Source,
        from_camera: bool,
    ) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        for (index, object) in self.objects.iter().enumerate() {
            if from_camera && !object.visible_to_camera {
                continue;
            }
            let nearest = best.as_ref().map_or(limit, |hit| hit.t);
            let on = |p: Option<Primitive>| p.is_some_and(|p| p.object == index);
            let least = if on(source.touching) { source.near } else { 0.0 };
            match &object.shape {
                Solid::Sphere => {
                    let t = sphere(
                        o - object.center,
                        d,
                        object.radius,
                        on(source.primitive) || on(source.touching),
                    );
                    let Some(t) = t.filter(|t| *t < nearest) else { continue };
                    let n = (o + t * d - object.center).normalize();
                    best = Some(object.hit_on_sphere(t, n, Primitive { object: index, triangle: 0 }));
                }
                Solid::Triangles(triangles) => {
                    if misses(o - object.center, d, object.radius) {
                        continue;
                    }
                    for (number, triangle) in triangles.iter().enumerate() {
                        let primitive = Primitive { object: index, triangle: number };
                        if source.primitive == Some(primitive) {
                            continue;
                        }
                        let nearest = best.as_ref().map_or(limit, |hit| hit.t);
                        let Some((t, weights)) = triangle.intersect(o, d) else { continue };
                        if t < nearest && t > least {
                            best = Some(Hit {
                                object: object.number,
                                ..triangle.hit(t, weights, object.material, primitive)
                            });
                        }
                    }
                }
            }
        }
        best
    }

    /// A surface of another object that lies on that of a hit along `d`, parallel to it; of an object whose
    /// material `counts`.
    pub(super) fn touching(&self, hit: &Hit, d: DVec3, counts: &dyn Fn(usize) -> bool) -> Option<Hit> {
        let near = NEAR * hit.point.abs().max_element() / hit.ng.dot(d).abs();
        if !near.is_finite() {
            return None;
        }
        // From a little before the hit to a little behind.
        let o = hit.point - near * d;
        let others = self.objects.iter().enumerate();
        let others = others.filter(|(i, object)| *i != hit.primitive.object && counts(object.material));
        others
            .filter_map(|(index, object)| object.first(index, o, d, 2.0 * near))
            .find(|other| other.ng.dot(hit.ng).abs() > 0.999)
    }

    /// The objects around a point, of those whose material `counts`: a ray leaves them once more often than it
    /// enters them.
    pub(super) fn around(&self, p: DVec3, counts: &dyn Fn(usize) -> bool) -> Vec<Around> {
        // Any direction would do that meets no edge.
        let d = DVec3::new(0.531_867, 0.709_203, 0.462_911).normalize();
        let contains = |object: &Object| match &object.shape {
            Solid::Sphere => p.distance(object.center) < object.radius,
            Solid::Triangles(triangles) => {
                let met = triangles.iter().filter(|t| t.intersect(p, d).is_some());
                met.map(|t| if t.ng.dot(d) > 0.0 { 1 } else { -1 }).sum::<i32>() > 0
            }
        };
        let objects = self.objects.iter().filter(|o| counts(o.material) && contains(o));
        objects.map(|o| Around { material: o.material, extent: o.extent() }).collect()
    }
}

impl Object {
    /// The first hit of the ray from `o` along the unit vector `d`, nearer than `limit`; of object `index`.
    fn first(&self, index: usize, o: DVec3, d: DVec3, limit: f64) -> Option<Hit> {
        let alone = |number: usize| Primitive { object: index, triangle: number };
        match &self.shape {
            Solid::Sphere => {
                let t = sphere(o - self.center, d, self.radius, false).filter(|t| *t < limit)?;
                let n = (o + t * d - self.center).normalize();
                Some(self.hit_on_sphere(t, n, alone(0)))
            }
            Solid::Triangles(triangles) => {
                let hits = triangles.iter().enumerate().filter_map(|(number, triangle)| {
                    let (t, weights) = triangle.intersect(o, d).filter(|(t, _)| *t < limit)?;
                    Some(Hit {
                        object: self.number,
                        ..triangle.hit(t, weights, self.material, alone(number))
                    })
                });
                hits.min_by(|a, b| a.t.total_cmp(&b.t))
            }
        }
    }

    fn hit_on_sphere(&self, t: f64, n: DVec3, primitive: Primitive) -> Hit {
        Hit {
            t,
            point: self.center + self.radius * n,
            ng: n,
            ns: n,
            material: self.material,
            primitive,
            object: self.number,
            triangle: 0,
            weights: [1.0, 0.0, 0.0],
        }
    }

    /// Half the diagonal of its bounding box, metres.
    fn extent(&self) -> f64 {
        match &self.shape {
            Solid::Sphere => self.radius * libm::sqrt(3.0),
            Solid::Triangles(triangles) => {
                let (low, high) = bounds(triangles);
                0.5 * low.distance(high)
            }
        }
    }
}

/// World-space triangles of a mesh. A mirroring transform turns the winding over, so that the front
/// stays the front; normals go with the inverse transpose, which keeps the side by itself.
fn flatten(mesh: &Mesh, place: impl Fn(glam::Vec3) -> DVec3, matrix: DMat3) -> Vec<Triangle> {
    let mirrored = matrix.determinant() < 0.0;
    let to_normal = matrix.inverse().transpose();
    let triangle = |(number, indices): (usize, &[u32; 3])| {
        let [i, j, k] = indices.map(|i| i as usize);
        let [a, b, c] = [i, j, k].map(|i| mesh.positions.get(i).copied().map(&place));
        let (a, b, c) = (a?, b?, c?);
        let edges = [b - a, c - a];
        let cross = edges[0].cross(edges[1]) * if mirrored { -1.0 } else { 1.0 };
        let ng = cross.try_normalize()?;
        let ns = [i, j, k].map(|i| {
            mesh.normals.get(i).and_then(|n| (to_normal * n.as_dvec3()).try_normalize()).unwrap_or(ng)
        });
        Some(Triangle { number, corner: a, edges, ng, ns })
    };
    mesh.triangles.iter().enumerate().filter_map(triangle).collect()
}

/// A sphere around all corners: centre of the bounding box, farthest corner, and a little more.
fn bounding_sphere(triangles: &[Triangle]) -> (DVec3, f64) {
    let (low, high) = bounds(triangles);
    let center = 0.5 * (low + high);
    let radius = corners(triangles).fold(0.0, |r: f64, p| r.max(p.distance(center)));
    (center, radius * (1.0 + 1e-6))
}

fn corners(triangles: &[Triangle]) -> impl Iterator<Item = DVec3> {
    triangles.iter().flat_map(|t| [t.corner, t.corner + t.edges[0], t.corner + t.edges[1]])
}

fn bounds(triangles: &[Triangle]) -> (DVec3, DVec3) {
    corners(triangles)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// Whether the ray surely misses the sphere of `radius`, whose centre the ray starts `o` away from.
fn misses(o: DVec3, d: DVec3, radius: f64) -> bool {
    let outside = o.length_squared() > radius * radius;
    outside && (o.dot(d) > 0.0 || o.cross(d).length() > radius)
}

/// Distance along the unit vector `d` to a sphere about the origin, strictly ahead.
///
/// `on_surface`: the ray starts on the sphere itself, so that the near root is its own origin.
pub(super) fn sphere(o: DVec3, d: DVec3, radius: f64, on_surface: bool) -> Option<f64> {
    let b = -o.dot(d);
    if on_surface {
        return (b > 0.0).then_some(2.0 * b);
    }
    // The distance between line and centre, without subtracting squares of large numbers.
    let closest = o + b * d;
    let discriminant = radius * radius - closest.length_squared();
    if discriminant < 0.0 {
        return None;
    }
    let root = discriminant.sqrt();
    // c / q is the root that cancellation would spoil.
    let c = (o.length() - radius) * (o.length() + radius);
    let q = if b > 0.0 { b + root } else { b - root };
    if q == 0.0 {
        return None;
    }
    let (near, far) = if b > 0.0 { (c / q, q) } else { (q, c / q) };
    [near, far].into_iter().find(|t| *t > 0.0)
}

impl Triangle {
    /// Distance and weights of the second and third corner (Moeller and Trumbore, JGT 2(1), 1997).
    fn intersect(&self, o: DVec3, d: DVec3) -> Option<(f64, [f64; 2])> {
        let [e1, e2] = self.edges;
        let p = d.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            return None;
        }
        let s = o - self.corner;
        let u = s.dot(p) / det;
        let q = s.cross(e1);
        let v = d.dot(q) / det;
        let t = e2.dot(q) / det;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, [u, v]))
    }

    fn hit(&self, t: f64, [u, v]: [f64; 2], material: usize, primitive: Primitive) -> Hit {
        let ns = (1.0 - u - v) * self.ns[0] + u * self.ns[1] + v * self.ns[2];
        Hit {
            t,
            point: self.corner + u * self.edges[0] + v * self.edges[1],
            ng: self.ng,
            ns: ns.try_normalize().unwrap_or(self.ng),
            material,
            primitive,
            object: primitive.object,
            triangle: self.number,
            weights: [1.0 - u - v, u, v],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the sphere's roots: outside, inside, behind, from the surface, and far away.
    #[test]
    fn sphere_distances() {
        let check = |o: DVec3, d: DVec3, on_surface: bool, expected: Option<f64>| {
            let t = sphere(o, d, 1.0, on_surface);
            match (t, expected) {
                (Some(t), Some(e)) => assert!((t - e).abs() <= 1e-12 * e.max(1.0), "{t} {e}"),
                _ => assert_eq!(t, expected),
            }
        };
        check(DVec3::new(0.0, 0.0, 3.0), -DVec3::Z, false, Some(2.0));
        check(DVec3::new(0.0, 0.0, 3.0), DVec3::Z, false, None);
        check(DVec3::ZERO, DVec3::Z, false, Some(1.0));
        check(DVec3::new(0.0, 0.0, 0.5), -DVec3::Z, false, Some(1.5));
        check(DVec3::Z, DVec3::Z, true, None);
        check(DVec3::Z, DVec3::new(0.6, 0.0, -0.8), true, Some(1.6));
        check(DVec3::new(0.0, 0.6, 1e6), -DVec3::Z, false, Some(1e6 - 0.8));
        check(DVec3::new(0.0, 1.01, 3.0), -DVec3::Z, false, None);
    }
}

//! From a hit to a point that can be shaded.

use glam::Vec3;

use super::normal::NormalMap;
use super::{Detail, Prepared, PreparedMaterial};
use crate::accel::{Hit, PrimitiveId};
use crate::light::LightContext;
use crate::shape::{Ray, sphere, triangle};

/// A point on a surface, world space.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The point.
    pub p: Vec3,
    /// Bound on the error of each of its coordinates.
    pub p_err: Vec3,
    /// Geometric normal: unit, towards the front.
    pub ng: Vec3,
    /// Shading normal: unit.
    pub ns: Vec3,
    /// Index of the object.
    pub object: u32,
    /// The primitive.
    pub id: PrimitiveId,
}

impl Surface {
    /// The point as lights see it, from which light goes to `wo` (unit); `transmits` says whether it may come from
    /// the other side.
    #[inline]
    #[must_use]
    pub(crate) fn lit(&self, wo: Vec3, transmits: bool) -> LightContext {
        LightContext { p: self.p, p_err: self.p_err, from: self.id, ng: self.ng, ns: self.ns, wo, transmits }
    }
}

impl Prepared {
    /// The surface that `ray` meets at `hit`. With `smooth` false the shading normals of meshes are
    /// not looked at, which changes nothing where no mesh has any.
    #[inline]
    #[must_use]
    pub fn surface(&self, ray: &Ray, hit: &Hit, smooth: bool) -> Surface {
        let id = hit.id;
        let object = self.geometry.object_of(id);
        let geometry = self.accel.geometry(self.accel.space_of(id.instance));
        let count = geometry.triangles.len() as u32;
        if id.primitive >= count {
            let (center, radius) = geometry.spheres[(id.primitive - count) as usize];
            let (p, p_err, n) = sphere::point(ray, hit.t, center, radius);
            return Surface { p, p_err, ng: n, ns: n, object, id };
        }
        let v = geometry.vertices(id.primitive);
        let (p, p_err) = triangle::point(v, hit.b[0], hit.b[1]);
        // A hit has a determinant, and with it an area, but for rounding: vertices that were placed so far away
        // that they lie on a line can still be met.
        let ng = triangle::normal(v).unwrap_or(Vec3::Y);
        let mut ns = ng;
        let normals = &self.geometry.normals[self.accel.space_of(id.instance) as usize];
        if smooth && !normals.is_empty() {
            let [i, j, k] = geometry.triangles[id.primitive as usize];
            let [n0, n1, n2] = [i, j, k].map(|i| normals[i as usize]);
            let b0 = 1.0 - hit.b[0] - hit.b[1];
            ns = (n0 * b0 + n1 * hit.b[0] + n2 * hit.b[1]).try_normalize().unwrap_or(ng);
        }
        let local = Surface { p, p_err, ng, ns, object, id };
        if id.instance == 0 { local } else { self.to_world(local) }
    }

    /// What varies over the mesh, at a hit.
    #[inline]
    #[must_use]
    pub(crate) fn detail(&self, object: u32, hit: &Hit) -> Detail {
        self.details.at(object, hit.id, hit.b)
    }

    /// The normal that a map gives at a hit, unit; `None` where the mesh has no frame for it, or it none.
    #[inline]
    #[must_use]
    pub(crate) fn mapped_normal(
        &self,
        map: &NormalMap,
        object: u32,
        hit: &Hit,
        detail: &Detail,
    ) -> Option<Vec3> {
        let (tangent, turn) = self.details.tangent(object, hit.id, hit.b, map.uv_set())?;
        (*turn * map.normal(detail, &tangent)).try_normalize().map(|n| n.as_vec3())
    }

    /// The material of a primitive, and its object.
    #[inline]
    #[must_use]
    pub(crate) fn material_at(&self, id: PrimitiveId) -> (&PreparedMaterial, u32) {
        let object = self.geometry.object_of(id);
        (&self.materials[self.material_of(object) as usize], object)
    }

    /// The share of the surface that is there at a hit, [0, 1].
    #[inline]
    #[must_use]
    pub(crate) fn coverage(&self, hit: &Hit) -> f32 {
        let object = self.geometry.object_of(hit.id);
        let material = &self.materials[self.material_of(object) as usize];
        material.cutout.as_ref().map_or(1.0, |c| c.coverage(&self.detail(object, hit)))
    }

    /// Whether there is a surface that light may pass without being scattered.
    #[inline]
    #[must_use]
    pub(crate) fn has_cutouts(&self) -> bool {
        self.cutouts
    }

    /// Where the point `p` of a triangle of the world lies on it: a hit whose distance means nothing.
    #[must_use]
    pub(crate) fn hit_at(&self, id: PrimitiveId, p: Vec3) -> Hit {
        let geometry = self.accel.geometry(self.accel.space_of(id.instance));
        if id.primitive as usize >= geometry.triangles.len() {
            return Hit { t: 0.0, id, b: [0.0; 2] };
        }
        let [a, b, c] = geometry.vertices(id.primitive).map(|v| v.as_dvec3());
        let (e, f, d) = (b - a, c - a, p.as_dvec3() - a);
        let n = e.cross(f);
        let n2 = n.length_squared();
        let b1 = (d.cross(f).dot(n) / n2).clamp(0.0, 1.0);
        let b2 = (e.cross(d).dot(n) / n2).clamp(0.0, 1.0 - b1);
        Hit { t: 0.0, id, b: [b1 as f32, b2 as f32] }
    }

    /// Takes a surface from the space of its instance to the world, in `f64`.
    fn to_world(&self, s: Surface) -> Surface {
        let placed = &self.geometry.placed[s.id.instance as usize - 1];
        let m = placed.to_world.matrix3;
        let p = placed.to_world.transform_point3(s.p.as_dvec3()).as_vec3();
        // The error of the point goes through the absolute matrix; rounding the ray into the space and
        // the point out of it adds a few units in the last place of everything that was added up.
        let spread = |v: Vec3| {
            let v = v.as_dvec3();
            (m.x_axis.abs() * v.x + m.y_axis.abs() * v.y + m.z_axis.abs() * v.z).as_vec3()
        };
        let rounding =
            (spread(s.p.abs()) + placed.to_world.translation.abs().as_vec3()) * crate::math::gamma(8);
        let p_err = spread(s.p_err) + rounding + p.abs() * crate::math::gamma(1);
        // The inverse transpose keeps the front in front, of mirroring transforms too.
        let turn = |n: Vec3| (placed.normal * n.as_dvec3()).normalize().as_vec3();
        Surface { p, p_err, ng: turn(s.ng), ns: turn(s.ns), ..s }
    }
}

//! Small builders.

use epsilux::color::Rgb;
use epsilux::glam::{DAffine3, DMat3, DVec3};
use epsilux::scene::{
    Absorption, Environment, Glass, Light, LightKind, Material, MaterialId, MaterialKind, Mesh, MeshId,
    Object, Principled, Scene, Shape, Sides,
};

use super::Probe;

/// A ray from `origin` along `direction`.
pub(crate) fn probe(origin: DVec3, direction: DVec3) -> Probe {
    Probe { origin, direction: direction.normalize() }
}

/// A ray that looks straight down at `point` of a surface of normal `n`, from a little above.
pub(crate) fn look_at(point: DVec3, n: DVec3, height: f64) -> Probe {
    probe(point + height * n, -n)
}

pub(crate) fn diffuse(rho: f32) -> MaterialKind {
    MaterialKind::Diffuse { color: Rgb::grey(rho) }
}

pub(crate) fn mirror(color: f32) -> MaterialKind {
    MaterialKind::Mirror { color: Rgb::grey(color) }
}

pub(crate) fn emitter(radiance: f32) -> MaterialKind {
    MaterialKind::Light { radiance: Rgb::grey(radiance), sides: Sides::Front }
}

pub(crate) fn glass(ior: f32) -> MaterialKind {
    MaterialKind::Glass(Glass { ior, tint: Rgb::WHITE, absorption: None, priority: None })
}

/// A glass that only absorbs.
pub(crate) fn absorber(color: f32, distance: f32) -> MaterialKind {
    let absorption = Some(Absorption { color: Rgb::grey(color), distance });
    MaterialKind::Glass(Glass { ior: 1.0, tint: Rgb::WHITE, absorption, priority: None })
}

/// A surface that reflects diffusely and emits on both sides.
pub(crate) fn glowing(rho: f32, radiance: f32) -> MaterialKind {
    principled(|p| {
        p.base_color = Rgb::grey(rho);
        p.specular = 0.0;
        p.emission = Rgb::grey(radiance);
    })
}

pub(crate) fn principled(change: impl FnOnce(&mut Principled)) -> MaterialKind {
    let mut p = Principled::default();
    change(&mut p);
    MaterialKind::Principled(Box::new(p))
}

/// The same radiance from everywhere.
pub(crate) fn sky(radiance: f32) -> Option<Environment> {
    Some(Environment {
        name: "sky".into(),
        radiance: Rgb::grey(radiance),
        image: None,
        visible_to_camera: true,
    })
}

/// Rotation whose local +Z is the unit vector `z`, at `position`.
pub(crate) fn facing(position: DVec3, z: DVec3) -> DAffine3 {
    let x = z.any_orthonormal_vector();
    DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), position)
}

/// A scene that grows.
pub(crate) trait Build {
    fn object(&mut self, shape: Shape, transform: DAffine3, kind: MaterialKind) -> &mut Self;
    fn sphere(&mut self, center: DVec3, radius: f64, kind: MaterialKind) -> &mut Self;
    /// A parallelogram with its front where `u` x `v` points.
    fn quad(&mut self, center: DVec3, u: DVec3, v: DVec3, kind: MaterialKind) -> &mut Self;
    /// A square of side `side` whose front looks along `n`.
    fn square(&mut self, center: DVec3, n: DVec3, side: f64, kind: MaterialKind) -> &mut Self;
    /// A box along the axes, front outside.
    fn cuboid(&mut self, low: DVec3, high: DVec3, kind: MaterialKind) -> &mut Self;
    fn light(&mut self, kind: LightKind, transform: DAffine3) -> &mut Self;
}

impl Build for Scene {
    fn object(&mut self, shape: Shape, transform: DAffine3, kind: MaterialKind) -> &mut Self {
        let number = self.materials.len() as u32;
        self.materials.push(Material { name: format!("material {number}"), kind });
        self.objects.push(Object {
            name: format!("object {number}"),
            shape,
            material: MaterialId(number),
            transform,
            visible_to_camera: true,
        });
        self
    }

    fn sphere(&mut self, center: DVec3, radius: f64, kind: MaterialKind) -> &mut Self {
        self.object(Shape::Sphere { radius }, DAffine3::from_translation(center), kind)
    }

    fn quad(&mut self, center: DVec3, u: DVec3, v: DVec3, kind: MaterialKind) -> &mut Self {
        let corners = [-u - v, u - v, u + v, v - u].map(|c| (center + 0.5 * c).as_vec3());
        self.meshes.push(Mesh {
            positions: corners.to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        });
        let mesh = MeshId(self.meshes.len() as u32 - 1);
        self.object(Shape::Mesh(mesh), DAffine3::IDENTITY, kind)
    }

    fn square(&mut self, center: DVec3, n: DVec3, side: f64, kind: MaterialKind) -> &mut Self {
        let u = n.any_orthonormal_vector();
        self.quad(center, side * u, side * n.cross(u), kind)
    }

    fn cuboid(&mut self, low: DVec3, high: DVec3, kind: MaterialKind) -> &mut Self {
        let corner = |i: usize| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
            DVec3::new(pick(0), pick(1), pick(2)).as_vec3()
        };
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        self.meshes.push(Mesh {
            positions: (0..8).map(corner).collect(),
            triangles: faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
            ..Mesh::default()
        });
        let mesh = MeshId(self.meshes.len() as u32 - 1);
        self.object(Shape::Mesh(mesh), DAffine3::IDENTITY, kind)
    }

    fn light(&mut self, kind: LightKind, transform: DAffine3) -> &mut Self {
        let light = Light { name: "light".into(), kind, transform, visible_to_camera: true };
        self.lights.push(light);
        self
    }
}

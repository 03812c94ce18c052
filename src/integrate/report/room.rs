//! A scene as the report's method sees it: lists of triangles and spheres, of triangles that emit, and the
//! report's materials.
//!
//! In: a valid [`Scene`]. Out: a [`Room`], with a note for what it shows otherwise than the scene has it.

use glam::{DAffine3, Vec3};

use super::{MOST_LIGHTS, MOST_TRIANGLES, ReportError};
use crate::color::Rgb;
use crate::scene::{Material, MaterialKind, Note, NoteEffect, Scene, Shape, Sides, Textures};
use crate::shape::triangle;

/// A scene, flattened into world space.
#[derive(Debug)]
pub(super) struct Room {
    pub(super) objects: Vec<Object>,
    pub(super) lights: Vec<Light>,
    pub(super) environment: Rgb,
    pub(super) sees_environment: bool,
    pub(super) notes: Vec<Note>,
}

#[derive(Debug)]
pub(super) struct Object {
    pub(super) surface: Surface,
    pub(super) hidden_from_camera: bool,
    /// A sphere around it: centre and radius.
    pub(super) around: (Vec3, f32),
    pub(super) solid: Solid,
}

#[derive(Debug)]
pub(super) enum Solid {
    Sphere { c: Vec3, r: f32 },
    Triangles(Vec<([Vec3; 3], Vec3)>),
}

/// A triangle that emits.
#[derive(Debug)]
pub(super) struct Light {
    pub(super) v: [Vec3; 3],
    pub(super) n: Vec3,
    pub(super) area: f32,
    pub(super) radiance: Rgb,
    pub(super) both_sides: bool,
}

/// A material, reduced to what the report knows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    pub(super) emission: Rgb,
    pub(super) both_sides: bool,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Black,
    Diffuse { rho: Rgb },
    Mirror { color: Rgb },
    Glass { ior: f32, tint: Rgb, interior: Option<(Rgb, f32)> },
}

impl Room {
    /// Flattens a scene into world space, and reduces its materials.
    ///
    /// # Errors
    /// Where the scene holds what the report's method cannot do, or too much of what it can.
    pub(super) fn new(scene: &Scene) -> Result<Self, ReportError> {
        if let Some(light) = scene.lights.first() {
            return Err(ReportError::Light { name: light.name.clone() });
        }
        let mut notes = Vec::new();
        let surfaces: Vec<_> = scene.materials.iter().map(|m| reduce(m, &mut notes)).collect();
        let (mut objects, mut lights, mut found) = (Vec::new(), Vec::new(), 0);
        for object in &scene.objects {
            let Some(&surface) = surfaces.get(object.material.0 as usize) else { continue };
            let volume = object.transform.matrix3.determinant();
            if volume == 0.0 || !volume.is_finite() {
                continue;
            }
            let hidden_from_camera = !object.visible_to_camera;
            let (around, solid) = match object.shape {
                Shape::Sphere { radius } => {
                    let scale = libm::cbrt(volume.abs());
                    let (c, r) = (object.transform.translation.as_vec3(), (radius * scale) as f32);
                    ((c, r), Solid::Sphere { c, r })
                }
                Shape::Mesh(id) => {
                    let Some(mesh) = scene.meshes.get(id.0 as usize) else { continue };
                    found += mesh.triangles.len();
                    if found > MOST_TRIANGLES {
                        continue;
                    }
                    if !mesh.normals.is_empty() {
                        notes.push(note("report-normals", &object.name, "is rendered with flat triangles"));
                    }
                    let triangles = flatten(&mesh.positions, &mesh.triangles, &object.transform);
                    (ball_around(&triangles), Solid::Triangles(triangles))
                }
            };
            if let (Solid::Triangles(triangles), false) = (&solid, surface.emission.is_black()) {
                let Surface { emission: radiance, both_sides, .. } = surface;
                let light = |&(v, n): &([Vec3; 3], Vec3)| {
                    let area = triangle::area(v) as f32;
                    Light { v, n, area, radiance, both_sides }
                };
                lights.extend(triangles.iter().map(light));
            }
            objects.push(Object { surface, hidden_from_camera, around, solid });
        }
        if found > MOST_TRIANGLES {
            return Err(ReportError::Triangles { found });
        }
        if lights.len() > MOST_LIGHTS {
            return Err(ReportError::Lights { found: lights.len() });
        }
        let environment = scene.environment.as_ref();
        if let Some(e) = environment.filter(|e| e.image.is_some()) {
            notes.push(note("report-environment", &e.name, "is rendered without its picture"));
        }
        Ok(Self {
            objects,
            lights,
            environment: environment.map_or(Rgb::BLACK, |e| e.radiance),
            sees_environment: environment.is_some_and(|e| e.visible_to_camera),
            notes,
        })
    }
}

/// A sphere around triangles, with room for rounding.
fn ball_around(triangles: &[([Vec3; 3], Vec3)]) -> (Vec3, f32) {
    let corners = || triangles.iter().flat_map(|(v, _)| *v);
    let low = corners().fold(Vec3::INFINITY, Vec3::min);
    let high = corners().fold(Vec3::NEG_INFINITY, Vec3::max);
    let c = 0.5 * (low + high);
    let magnitude = low.abs().max(high.abs()).max_element();
    (c, corners().fold(0.0, |r: f32, p| r.max(p.distance(c))) + 1e-4 * magnitude)
}

/// World-space triangles with their normals; those without area are left out.
fn flatten(positions: &[Vec3], triangles: &[[u32; 3]], to_world: &DAffine3) -> Vec<([Vec3; 3], Vec3)> {
    let mirrored = to_world.matrix3.determinant() < 0.0;
    let place = |i: u32| positions.get(i as usize).map(|p| to_world.transform_point3(p.as_dvec3()).as_vec3());
    let one = |&[i, j, k]: &[u32; 3]| {
        // Winding decides where the front is, and a mirroring transform turns it over.
        let (j, k) = if mirrored { (k, j) } else { (j, k) };
        let v = [place(i)?, place(j)?, place(k)?];
        Some((v, triangle::normal(v)?))
    };
    triangles.iter().filter_map(one).collect()
}

fn note(code: &'static str, name: &str, what: &str) -> Note {
    Note { code, place: String::new(), message: format!("\"{name}\" {what}"), effect: NoteEffect::Differs }
}

/// The nearest of the report's four materials.
fn reduce(material: &Material, notes: &mut Vec<Note>) -> Surface {
    let kind = match &material.kind {
        MaterialKind::Diffuse { color } => Kind::Diffuse { rho: *color },
        MaterialKind::Mirror { color } => Kind::Mirror { color: *color },
        MaterialKind::Glass(g) => {
            let interior = g.absorption.map(|a| (a.color, a.distance));
            Kind::Glass { ior: g.ior, tint: g.tint, interior }
        }
        MaterialKind::Light { .. } => Kind::Black,
        MaterialKind::Principled(p) => {
            let (name, kind) = if p.metallic > 0.5 {
                ("a mirror", Kind::Mirror { color: p.base_color })
            } else if p.transmission > 0.5 {
                let interior = p.absorption.map(|a| (a.color, a.distance));
                ("glass", Kind::Glass { ior: p.ior, tint: p.transmission_tint, interior })
            } else {
                ("diffuse", Kind::Diffuse { rho: p.base_color })
            };
            let bare = if p.textures == Textures::default() { "" } else { " without its textures" };
            let what = format!("is principled and is rendered as {name}{bare}");
            notes.push(note("report-material", &material.name, &what));
            kind
        }
    };
    let (emission, sides) = material.kind.emission().unwrap_or_default();
    Surface { emission, both_sides: sides == Sides::Both, kind }
}

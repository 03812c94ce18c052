//! What the camera is in.
//!
//! In: the objects of a scene, and a point. Out: the medium there. An object contains a point where its surface
//! winds around it: the solid angles of its triangles add up to 4 pi, whatever holes of measure zero it has
//! (A. Jacobson, L. Kavan and O. Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized Winding
//! Numbers", SIGGRAPH 2013), each by A. van Oosterom and J. Strackee, IEEE TBME 30(2), 1983. No ray is sent,
//! so none can slip through an edge.

use std::f64::consts::TAU;

use glam::DVec3;

use super::material::PreparedMaterial;
use super::nesting::{Medium, Nesting};
use crate::scene::{Mesh, Object, Scene, Shape};

/// The medium at the point `p`, world space.
pub(super) fn medium(
    scene: &Scene,
    materials: &[PreparedMaterial],
    nesting: Option<&Nesting>,
    p: DVec3,
) -> Medium {
    let around: Vec<u32> = around(scene, materials, p).iter().map(|&i| scene.objects[i].material.0).collect();
    let is_body = |m: u32| scene.materials[m as usize].kind.body().is_some();
    let inside = nesting.map(|n| n.inside(around.iter().copied())).unwrap_or_default();
    // Whoever went there entered the innermost last.
    let there = match around.last() {
        Some(&m) if !is_body(m) => Some(m),
        _ => nesting.and_then(|n| n.there(inside)),
    };
    Medium { absorbs: there.filter(|&m| materials[m as usize].interior.is_some()), inside }
}

/// The objects around the point `p`, world space, that enclose a volume: by index, the outermost first.
pub(super) fn around(scene: &Scene, materials: &[PreparedMaterial], p: DVec3) -> Vec<usize> {
    let objects = scene.objects.iter().enumerate();
    let enclosing = objects.filter(|(_, o)| materials[o.material.0 as usize].encloses);
    let mut around: Vec<(f64, usize)> =
        enclosing.filter_map(|(i, o)| contains(scene, o, p).map(|extent| (extent, i))).collect();
    around.sort_by(|a, b| b.0.total_cmp(&a.0));
    around.into_iter().map(|(_, i)| i).collect()
}

/// Half the diagonal of an object's bounds, metres, where it contains the point `p`, and else `None`.
fn contains(scene: &Scene, object: &Object, p: DVec3) -> Option<f64> {
    let to_world = &object.transform;
    match object.shape {
        Shape::Sphere { radius } => {
            let radius = radius * to_world.matrix3.x_axis.length();
            (p.distance(to_world.translation) < radius).then_some(radius * libm::sqrt(3.0))
        }
        Shape::Mesh(id) => {
            let mesh = &scene.meshes[id.0 as usize];
            let place = |v: &glam::Vec3| to_world.transform_point3(v.as_dvec3());
            let (lo, hi) = mesh
                .positions
                .iter()
                .map(place)
                .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
            let within = lo.cmple(p).all() && p.cmple(hi).all();
            // A mirroring transform turns the winding over; the front stays the front.
            let side = to_world.matrix3.determinant().signum();
            let times = || winding(mesh, |i| place(&mesh.positions[i as usize]) - p);
            (within && side * times() > 0.5).then(|| 0.5 * (hi - lo).length())
        }
    }
}

/// How often a mesh winds around the origin of `corner`: the sum of its signed solid angles over 4 pi.
fn winding(mesh: &Mesh, corner: impl Fn(u32) -> DVec3) -> f64 {
    let solid_angle = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| corner(i).normalize_or_zero());
        2.0 * libm::atan2(a.dot(b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    };
    mesh.triangles.iter().map(solid_angle).sum::<f64>() / (2.0 * TAU)
}

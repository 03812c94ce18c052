//! Bodies that overlap or touch, for the reference integrator, and what a path is in.
//!
//! [`crate::scene::Body`] states the rule. A path carries the list of bodies that it is inside; at a surface of
//! a body it compares what is there before and behind. Two surfaces of bodies that are parallel and nearer than
//! [`NEAR`] of their coordinates touch: they are crossed as one.

use std::borrow::Cow;
use std::collections::HashMap;

use glam::DVec3;

use super::albedo::{Lobe, Mix};
use super::geometry::{Geometry, Hit, Primitive};
use super::material::Surface;
use super::medium::Medium;
use super::varying::Varying;
use crate::scene::{Body, Material, MaterialKind, Scene};

/// Distance of surfaces that touch, relative to their largest coordinate.
pub(super) const NEAR: f64 = 1e-6;

/// What a path is in.
#[derive(Clone, Debug, Default)]
pub(super) struct Place {
    /// Materials of the bodies around, one entry for each time that one was entered.
    bodies: Vec<usize>,
    /// What absorbs.
    pub(super) medium: Option<Medium>,
}

impl Place {
    /// The same bodies around, and something else that absorbs.
    pub(super) fn with(&self, medium: Option<Medium>) -> Self {
        Self { bodies: self.bodies.clone(), medium }
    }
}

/// What a surface of a body is to a path.
pub(super) struct Crossing {
    /// Material and relative index of the interface; `None` where nothing changes at the surface.
    pub(super) interface: Option<(usize, u32)>,
    /// Behind it.
    pub(super) beyond: Place,
    /// The surface of another body that is crossed with it.
    pub(super) with: Option<Primitive>,
    /// Whether the interface is that surface, and its front on the other side.
    pub(super) flipped: bool,
}

/// The bodies of a scene, by material.
#[derive(Debug)]
pub(super) struct Nesting {
    bodies: Vec<Option<Body>>,
    /// Each body's material with each relative index that it may have, by the bits of that.
    interfaces: HashMap<(usize, u32), (Surface, Option<Varying>)>,
}

impl Nesting {
    pub(super) fn new(scene: &Scene, colored: &[bool], curve: &mut dyn FnMut(Lobe, f64) -> Mix) -> Self {
        let bodies: Vec<Option<Body>> = scene.materials.iter().map(|m| m.kind.body()).collect();
        let mut interfaces = HashMap::new();
        for (i, body) in bodies.iter().enumerate() {
            let Some(body) = body else { continue };
            let others =
                bodies.iter().enumerate().filter(|(j, _)| *j != i).filter_map(|(_, b)| Some((*b)?.ior));
            for eta in std::iter::once(1.0).chain(others).map(|other| body.ior / other) {
                interfaces.entry((i, eta.to_bits())).or_insert_with(|| {
                    let kind = with_index(&scene.materials[i].kind, eta);
                    let surface = Surface::new(&kind, curve);
                    let material = Material { name: String::new(), kind };
                    (surface, Varying::new(&material, colored[i], scene))
                });
            }
        }
        Self { bodies, interfaces }
    }

    /// What is at the point `p`: bodies, and else the innermost surface that encloses something.
    pub(super) fn at(&self, p: DVec3, geometry: &Geometry, surfaces: &[Surface]) -> Place {
        let mut around = geometry.around(p, &|material| surfaces[material].encloses());
        around.sort_by(|a, b| b.extent.total_cmp(&a.extent));
        let bodies: Vec<usize> =
            around.iter().map(|a| a.material).filter(|&m| self.bodies[m].is_some()).collect();
        let medium = match around.last() {
            Some(last) if self.bodies[last.material].is_none() => surfaces[last.material].absorption(),
            _ => self.absorption(&bodies),
        };
        Place { bodies, medium }
    }

    /// The material of the body that is there.
    fn there(&self, bodies: &[usize]) -> Option<usize> {
        bodies.iter().copied().max_by_key(|&m| (self.bodies[m].map(|b| b.priority), m))
    }

    fn index(&self, bodies: &[usize]) -> f32 {
        self.there(bodies).and_then(|m| self.bodies[m]).map_or(1.0, |b| b.ior)
    }

    /// What the body that is there absorbs.
    fn absorption(&self, bodies: &[usize]) -> Option<Medium> {
        self.there(bodies).and_then(|m| self.bodies[m]?.absorption).map(Medium::from)
    }

    /// The medium behind a surface without a priority that leads out of what it encloses.
    pub(super) fn medium_around(&self, place: &Place) -> Option<Medium> {
        self.absorption(&place.bodies)
    }

    /// What a surface is to a path that comes to `hit` along `d`; `None` where it is not that of a body.
    pub(super) fn meet(&self, geometry: &Geometry, hit: &Hit, d: DVec3, place: &Place) -> Option<Crossing> {
        self.bodies[hit.material]?;
        let before = &place.bodies;
        let enters = hit.ng.dot(d) < 0.0;
        let mut after = across(before, hit.material, enters);
        let touching = geometry.touching(hit, d, &|material| self.bodies[material].is_some());
        let mut candidates = vec![(hit.material, enters)];
        if let Some(other) = &touching {
            let enters = other.ng.dot(d) < 0.0;
            after = across(&after, other.material, enters);
            candidates.push((other.material, enters));
        }
        let with = touching.map(|other| other.primitive);
        let (here, there) = (self.there(before), self.there(&after));
        if here == there {
            let beyond = Place { bodies: after, medium: place.medium };
            return Some(Crossing { interface: None, beyond, with, flipped: false });
        }
        // A surface parts what is there from something else where it bounds one of the two.
        let bounds =
            |&(material, enters): &(usize, bool)| (if enters { there } else { here }) == Some(material);
        let (material, into) = candidates.into_iter().find(bounds)?;
        let [inner, outer] = if into { [&after, before] } else { [before, &after] };
        let eta = self.index(inner) / self.index(outer);
        let medium = self.absorption(&after);
        let beyond = Place { bodies: after, medium };
        let interface = Some((material, eta.to_bits()));
        Some(Crossing { interface, beyond, with, flipped: into != enters })
    }

    /// The surface of an interface, and what varies it.
    pub(super) fn interface(&self, key: (usize, u32)) -> Option<(Cow<'_, Surface>, Option<&Varying>)> {
        let (surface, varying) = self.interfaces.get(&key)?;
        Some((Cow::Borrowed(surface), varying.as_ref()))
    }
}

/// The list after a surface of the body of `material`.
fn across(bodies: &[usize], material: usize, enters: bool) -> Vec<usize> {
    let mut bodies = bodies.to_vec();
    if enters {
        bodies.push(material);
    } else if let Some(i) = bodies.iter().position(|&b| b == material) {
        bodies.remove(i);
    }
    bodies
}

fn with_index(kind: &MaterialKind, ior: f32) -> MaterialKind {
    match kind {
        MaterialKind::Glass(g) => MaterialKind::Glass(crate::scene::Glass { ior, ..g.clone() }),
        MaterialKind::Principled(p) => {
            MaterialKind::Principled(Box::new(crate::scene::Principled { ior, ..(**p).clone() }))
        }
        other => other.clone(),
    }
}

//! Bodies that overlap, touch, or lie within each other.
//!
//! In: the materials that have a [`Body`]. Out: what a ray is in, and what a surface of a body is to it: not
//! there, or an interface between what is on its two sides. [`Body`] states the rule (after Schmidt and
//! Budge, JGT 7(2), 2002). The order of bodies is total, so what is there does not depend on the way there.

use glam::Vec3;

use super::fold::Folded;
use super::material::Compiler;
use super::{Prepared, PreparedMaterial, Surface};
use crate::accel::{PrimitiveId, RayKind};
use crate::scene::{MAX_BODIES, MaterialKind, Scene};
use crate::shape::{Ray, offset_origin};

/// Cosine between the normals of two surfaces that touch, at least: elsewhere one just ends at the other.
const PARALLEL: f32 = 0.999;

/// How often a ray is inside each body: eight bits for each, the higher in the order the higher up.
///
/// Counts stop at 0 and at 255: whoever leaves a body that it never entered was not in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inside(u128);

impl Inside {
    /// The same, one surface of the body of `rank` later.
    #[inline]
    #[must_use]
    fn across(self, rank: u8, enters: bool) -> Self {
        let one = 1u128 << (8 * rank);
        match (enters, (self.0 >> (8 * rank)) as u8) {
            (true, u8::MAX) | (false, 0) => self,
            (true, _) => Self(self.0 + one),
            (false, _) => Self(self.0 - one),
        }
    }

    /// Rank of the body that is there; `None` in vacuum.
    #[inline]
    #[must_use]
    fn top(self) -> Option<u8> {
        (self.0 != 0).then(|| (self.0.ilog2() / 8) as u8)
    }
}

/// What a ray is in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Medium {
    /// The material whose interior absorbs.
    pub absorbs: Option<u32>,
    /// The bodies around.
    pub inside: Inside,
}

/// What a surface of a body is to a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met<'a> {
    /// What scatters; `None` where the surface is not there, since the same is on both sides.
    pub(crate) interface: Option<&'a PreparedMaterial>,
    /// The medium behind it.
    pub(crate) beyond: Medium,
    /// A surface of another body that lies on it, and is crossed with it.
    pub(crate) with: PrimitiveId,
    /// Whether the interface is that of the other body, whose front is on the other side.
    pub(crate) flipped: bool,
}

/// The bodies of a scene, in their order.
#[derive(Clone, Debug)]
pub(super) struct Nesting {
    /// Of each material: the rank of its body.
    ranks: Vec<Option<u8>>,
    /// Of each rank: material, and index of refraction.
    bodies: Vec<(u32, f32)>,
    /// Of each rank: its material against whatever may be on the other side, by relative index.
    relative: Vec<Vec<(f32, PreparedMaterial)>>,
    /// Whether there are surfaces of several objects, which may touch.
    touching: bool,
}

impl Nesting {
    /// `None` where no object is a body.
    pub(super) fn new(scene: &Scene, folded: &Folded<'_>, compiler: &mut Compiler<'_>) -> Option<Self> {
        let mut objects = vec![0usize; scene.materials.len()];
        scene.objects.iter().for_each(|o| objects[o.material.0 as usize] += 1);
        let used = scene.materials.iter().enumerate().filter(|(i, _)| objects[*i] > 0);
        let mut order: Vec<_> =
            used.filter_map(|(i, m)| m.kind.body().map(|b| (b.priority, i, b.ior))).collect();
        order.sort_unstable_by_key(|&(priority, i, _)| (priority, i));
        debug_assert!(order.len() <= MAX_BODIES, "validation counts them");
        let mut ranks = vec![None; scene.materials.len()];
        for (rank, &(_, i, _)) in order.iter().enumerate() {
            ranks[i] = Some(rank as u8);
        }
        let relative = order.iter().map(|&(_, i, ior)| {
            let mut against: Vec<(f32, PreparedMaterial)> = Vec::new();
            let others = order.iter().filter(|b| b.1 != i).map(|b| b.2);
            for eta in std::iter::once(1.0).chain(others).map(|other| ior / other) {
                if against.iter().all(|(known, _)| *known != eta) {
                    let kind = with_ior(&folded.kinds[i], eta);
                    against.push((eta, compiler.material(&kind, &folded.uses[i])));
                }
            }
            against
        });
        (!order.is_empty()).then(|| Self {
            relative: relative.collect(),
            bodies: order.iter().map(|&(_, i, ior)| (i as u32, ior)).collect(),
            touching: order.iter().map(|&(_, i, _)| objects[i]).sum::<usize>() > 1,
            ranks,
        })
    }

    /// The bodies around, where those of these materials are.
    pub(super) fn inside(&self, materials: impl Iterator<Item = u32>) -> Inside {
        materials
            .filter_map(|m| self.ranks[m as usize])
            .fold(Inside::default(), |inside, rank| inside.across(rank, true))
    }

    /// The material of the body that is there.
    pub(super) fn there(&self, inside: Inside) -> Option<u32> {
        inside.top().map(|rank| self.bodies[usize::from(rank)].0)
    }

    fn ior(&self, inside: Inside) -> f32 {
        inside.top().map_or(1.0, |rank| self.bodies[usize::from(rank)].1)
    }

    /// The material of `rank` as an interface against something of the index `outside`.
    fn interface(&self, rank: u8, outside: f32) -> Option<&PreparedMaterial> {
        let rank = usize::from(rank);
        let eta = self.bodies[rank].1 / outside;
        self.relative[rank].iter().find(|(known, _)| *known == eta).map(|(_, m)| m)
    }
}

/// The same material with another index of refraction.
fn with_ior(kind: &MaterialKind, ior: f32) -> MaterialKind {
    let mut kind = kind.clone();
    match &mut kind {
        MaterialKind::Glass(g) => g.ior = ior,
        MaterialKind::Principled(p) => p.ior = ior,
        MaterialKind::Diffuse { .. } | MaterialKind::Mirror { .. } | MaterialKind::Light { .. } => {}
    }
    kind
}

impl Prepared {
    /// Whether bodies have an order, so that [`Self::meet`] has something to say.
    #[inline]
    pub(crate) fn has_nesting(&self) -> bool {
        self.nesting.is_some()
    }

    /// What a surface is to a ray along `d` in `medium`; `None` where it is not that of a body.
    pub(crate) fn meet(&self, surface: &Surface, d: Vec3, medium: Medium) -> Option<Met<'_>> {
        let nesting = self.nesting.as_ref()?;
        let own = nesting.ranks[self.material_of(surface.object) as usize]?;
        let before = medium.inside;
        let enters = surface.ng.dot(d) < 0.0;
        let mut after = before.across(own, enters);
        let mut with = PrimitiveId::NONE;
        let (mut rank, mut into) = (own, enters);
        if nesting.touching
            && let Some((id, other, enters_other)) = self.touching(nesting, surface, d)
        {
            (with, after) = (id, after.across(other, enters_other));
            // The interface is that of the body which is there on one side, and of the two that touch the one that
            // was met first.
            if (if enters { after } else { before }).top() != Some(own) {
                (rank, into) = (other, enters_other);
            }
        }
        if after.top() == before.top() {
            let beyond = Medium { inside: after, ..medium };
            return Some(Met { interface: None, beyond, with, flipped: false });
        }
        let outside = nesting.ior(if into { before } else { after });
        Some(Met {
            interface: nesting.interface(rank, outside),
            beyond: Medium { inside: after, absorbs: self.absorbs_around(after) },
            with,
            flipped: into != enters,
        })
    }

    /// What absorbs where these bodies are around, and nothing without a priority is.
    #[inline]
    pub(crate) fn absorbs_around(&self, inside: Inside) -> Option<u32> {
        let around = self.nesting.as_ref()?.there(inside);
        around.filter(|&m| self.materials[m as usize].interior.is_some())
    }

    /// The surface of another body that lies on this one, nearer than both are known: its primitive, its rank,
    /// and whether a ray along `d` enters there.
    fn touching(&self, nesting: &Nesting, surface: &Surface, d: Vec3) -> Option<(PrimitiveId, u8, bool)> {
        let near = offset_origin(surface.p, surface.p_err, surface.ng, -d);
        let far = offset_origin(surface.p, surface.p_err, surface.ng, d);
        let t_max = (near - far).length() / surface.ng.dot(d).abs();
        if !(t_max > 0.0 && t_max.is_finite()) {
            return None;
        }
        let ray = Ray { t_max, ..Ray::new(near, d) };
        let hit = self.accel.closest_between(&ray, [surface.id, PrimitiveId::NONE], RayKind::Other)?;
        let other = self.surface(&ray, &hit, false);
        let rank = nesting.ranks[self.material_of(other.object) as usize]?;
        let parallel = other.ng.dot(surface.ng).abs() >= PARALLEL;
        (hit.t < t_max && other.object != surface.object && parallel)
            .then(|| (other.id, rank, other.ng.dot(d) < 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the counting: what is there is the highest that was entered more often than left, counts stop at
    /// their ends, and ranks do not run into each other.
    #[test]
    fn the_highest_body_that_was_entered_is_there() {
        let inside = Inside::default();
        assert_eq!(inside.top(), None);
        assert_eq!(inside.across(3, false), inside);
        let two = inside.across(1, true).across(15, true);
        assert_eq!(two.top(), Some(15));
        assert_eq!(two.across(0, true).across(15, false).top(), Some(1));
        assert_eq!(two.across(15, false).across(1, false), inside);
        let many = (0..300).fold(inside, |i, _| i.across(7, true));
        assert_eq!((many.top(), many.across(7, true)), (Some(7), many));
        let left = (0..255).fold(many, |i, _| i.across(7, false));
        assert_eq!(left, inside);
    }
}

//! What varies over a mesh beside its shape: texture coordinates, vertex colours, tangents.
//!
//! In: a scene. Out: for a hit, the values interpolated there. Attributes stay in the mesh's own space and
//! are kept once for each mesh, however often it is placed and whether or not it is copied to the world.

use glam::{DMat3, DVec3, Vec2, Vec4};

use super::fold::{Folded, takes_colors};
use super::geometry::Flat;
use super::texture::Coordinates;
use crate::accel::PrimitiveId;
use crate::color::Rgb;
use crate::scene::tangents::{TangentFrames, tangent_frames};
use crate::scene::{MaterialKind, Mesh, Scene, Shape};

/// What textures and vertex colours need to know of a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Detail {
    pub(crate) uv: Coordinates,
    /// Vertex colour, and its alpha.
    pub(crate) color: Rgb,
    pub(crate) alpha: f32,
}

impl Detail {
    /// Where nothing varies.
    pub(crate) const NONE: Self = Self { uv: [[0.0; 2]; 2], color: Rgb::WHITE, alpha: 1.0 };
}

/// An interpolated frame in the mesh's own space, not unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent {
    pub(crate) normal: DVec3,
    pub(crate) tangent: DVec3,
    /// Sign of the bitangent.
    pub(crate) w: f64,
}

/// Attributes of one mesh; lists that nothing needs are empty.
#[derive(Clone, Debug, Default)]
struct Attributes {
    triangles: Vec<[u32; 3]>,
    uvs: [Vec<Vec2>; 2],
    colors: Vec<Vec4>,
    /// Frames of normal maps by each set of texture coordinates.
    frames: [Option<TangentFrames>; 2],
}

/// An object whose mesh has attributes.
#[derive(Clone, Debug)]
struct Laid {
    attributes: u32,
    /// Its first primitive in the world; zero where it is an instance.
    first: u32,
    /// Whether its triangles wind the other way round in the world.
    flips: bool,
    /// The rotation of normals.
    normal: DMat3,
}

/// Attributes of all objects.
#[derive(Clone, Debug, Default)]
pub(super) struct Details {
    attributes: Vec<Attributes>,
    /// Of each object; empty where none has any.
    laid: Vec<Option<Laid>>,
}

/// What the materials of a mesh's objects ask for.
#[derive(Clone, Copy, Debug, Default)]
struct Wanted {
    uvs: [bool; 2],
    colors: bool,
    frames: [bool; 2],
}

impl Details {
    /// What the materials of `scene` ask of its meshes; no colours of vertices unless `colors`.
    pub(super) fn new(scene: &Scene, folded: &Folded<'_>, flat: &Flat, colors: bool) -> Self {
        let mut wanted = vec![Wanted::default(); scene.meshes.len()];
        for object in &scene.objects {
            if let Shape::Mesh(m) = object.shape {
                wanted[m.0 as usize].add(&folded.kinds[object.material.0 as usize]);
            }
        }
        let mut details = Self::default();
        let index: Vec<Option<u32>> = scene
            .meshes
            .iter()
            .zip(&wanted)
            .map(|(mesh, wanted)| {
                let wanted = Wanted { colors: wanted.colors && colors, ..*wanted };
                let attributes = Attributes::new(mesh, wanted)?;
                details.attributes.push(attributes);
                Some(details.attributes.len() as u32 - 1)
            })
            .collect();
        if details.attributes.is_empty() {
            return details;
        }
        let laid = scene.objects.iter().zip(&flat.range).map(|(object, range)| {
            let Shape::Mesh(m) = object.shape else { return None };
            let matrix = object.transform.matrix3;
            Some(Laid {
                attributes: index[m.0 as usize]?,
                first: range.map_or(0, |(first, _)| first),
                // Instances keep their own winding.
                flips: range.is_some() && matrix.determinant() < 0.0,
                normal: matrix.inverse().transpose(),
            })
        });
        details.laid = laid.collect();
        details
    }

    /// The attributes of an object, the triangle of its mesh that the primitive is, and the weights of its
    /// corners.
    #[inline]
    fn find(
        &self,
        object: u32,
        id: PrimitiveId,
        b: [f32; 2],
    ) -> Option<(&Attributes, &Laid, usize, [f64; 3])> {
        let laid = self.laid.get(object as usize)?.as_ref()?;
        let attributes = &self.attributes[laid.attributes as usize];
        let [b1, b2] = b.map(f64::from);
        let [b1, b2] = if laid.flips { [b2, b1] } else { [b1, b2] };
        Some((attributes, laid, (id.primitive - laid.first) as usize, [1.0 - b1 - b2, b1, b2]))
    }

    /// Texture coordinates of the corners of a primitive.
    pub(super) fn corners(&self, object: u32, id: PrimitiveId) -> [Coordinates; 3] {
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|b| self.at(object, id, b).uv)
    }

    /// The values at a hit.
    #[inline]
    pub(super) fn at(&self, object: u32, id: PrimitiveId, b: [f32; 2]) -> Detail {
        let mut detail = Detail::NONE;
        let Some((attributes, _, triangle, w)) = self.find(object, id, b) else { return detail };
        let corners = attributes.triangles[triangle].map(|i| i as usize);
        for (uv, list) in detail.uv.iter_mut().zip(&attributes.uvs) {
            if !list.is_empty() {
                let [p, q, r] = corners.map(|i| list[i].as_dvec2());
                *uv = (p * w[0] + q * w[1] + r * w[2]).to_array();
            }
        }
        if !attributes.colors.is_empty() {
            let [p, q, r] = corners.map(|i| attributes.colors[i]);
            let c = p * w[0] as f32 + q * w[1] as f32 + r * w[2] as f32;
            (detail.color, detail.alpha) = (Rgb::new(c.x, c.y, c.z), c.w);
        }
        detail
    }

    /// The frame of normal maps at a hit, and the rotation of normals to the world.
    #[inline]
    pub(super) fn tangent(
        &self,
        object: u32,
        id: PrimitiveId,
        b: [f32; 2],
        uv_set: usize,
    ) -> Option<(Tangent, &DMat3)> {
        let (attributes, laid, triangle, w) = self.find(object, id, b)?;
        let frames = attributes.frames[uv_set].as_ref()?;
        let corners = frames.corners[triangle].map(|i| i as usize);
        let [n0, n1, n2] = corners.map(|i| frames.normals[i].as_dvec3());
        let [t0, t1, t2] = corners.map(|i| frames.tangents[i].truncate().as_dvec3());
        let tangent = Tangent {
            normal: n0 * w[0] + n1 * w[1] + n2 * w[2],
            tangent: t0 * w[0] + t1 * w[1] + t2 * w[2],
            w: f64::from(frames.tangents[corners[0]].w),
        };
        Some((tangent, &laid.normal))
    }
}

impl Wanted {
    fn add(&mut self, kind: &MaterialKind) {
        self.colors |= takes_colors(kind);
        let MaterialKind::Principled(p) = kind else { return };
        for (_, t) in p.textures.iter() {
            self.uvs[usize::from(t.uv_set.min(1))] = true;
        }
        if let Some(n) = &p.textures.normal {
            self.frames[usize::from(n.texture.uv_set.min(1))] = true;
        }
    }
}

impl Attributes {
    /// What is wanted of a mesh; `None` where it has nothing of it.
    fn new(mesh: &Mesh, wanted: Wanted) -> Option<Self> {
        let colored = wanted.colors && mesh.colors.iter().any(|&c| c != Vec4::ONE);
        let take = |i: usize| if wanted.uvs[i] { mesh.uvs[i].clone() } else { Vec::new() };
        let frames = [0, 1].map(|i| if wanted.frames[i] { tangent_frames(mesh, i) } else { None });
        let attributes = Self {
            triangles: Vec::new(),
            uvs: [take(0), take(1)],
            colors: if colored { mesh.colors.clone() } else { Vec::new() },
            frames,
        };
        let any = colored
            || attributes.uvs.iter().any(|uvs| !uvs.is_empty())
            || attributes.frames.iter().any(Option::is_some);
        any.then(|| Self { triangles: mesh.triangles.clone(), ..attributes })
    }
}

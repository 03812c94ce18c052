//! A glTF primitive becomes a [`Mesh`]; equal ones become the same.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use glam::{DVec3, Vec2, Vec3, Vec4};
use gltf::json;
use json::accessor::Type;
use json::mesh::{Mode, MorphTarget, Primitive, Semantic};
use json::validation::Checked;

use super::super::error::Fault;
use super::super::notes::Notes;
use super::accessor::Reader;
use super::triangles;
use crate::scene::{Mesh, MeshId, NoteEffect};

/// Converts primitives once each, and finds those with equal content.
#[derive(Default)]
pub(super) struct Meshes {
    pub(super) list: Vec<Mesh>,
    /// By accessors and mode; `None` where a primitive has nothing to show.
    known: HashMap<Vec<Option<usize>>, Option<MeshId>>,
    /// By hash of the content: exporters write modified duplicates again and again.
    content: HashMap<u64, Vec<MeshId>>,
}

impl Meshes {
    /// The mesh of `primitive`, its targets morphed by `weights`; `None` where it shows no triangles.
    pub(super) fn get(
        &mut self,
        primitive: &Primitive,
        weights: &[f32],
        name: &str,
        place: &str,
        reader: &mut Reader<'_>,
        notes: &mut Notes,
    ) -> Result<Option<MeshId>, Fault> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err(Fault::invalid(format!("{place}.mode"), "an unknown value", "0 to 6"));
        };
        let attribute = |s| primitive.attributes.get(&Checked::Valid(s)).map(|i| i.value());
        let mut key = vec![
            Some(mode as usize),
            primitive.indices.map(|i| i.value()),
            attribute(Semantic::Positions),
            attribute(Semantic::Normals),
            attribute(Semantic::Tangents),
            attribute(Semantic::TexCoords(0)),
            attribute(Semantic::TexCoords(1)),
            attribute(Semantic::Colors(0)),
        ];
        let targets = primitive.targets.iter().flatten();
        let morphs: Vec<_> = targets.zip(weights.iter().copied()).filter(|(_, w)| *w != 0.0).collect();
        for (target, weight) in &morphs {
            let index = |i: Option<json::Index<json::Accessor>>| i.map(|i| i.value());
            key.push(Some(weight.to_bits() as usize));
            key.extend([index(target.positions), index(target.normals), index(target.tangents)]);
        }
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let converted = convert(primitive, mode, &key, &morphs, place, reader, notes)?;
        let id = converted.map(|mesh| self.insert(Mesh { name: name.into(), ..mesh }));
        self.known.insert(key, id);
        Ok(id)
    }

    fn insert(&mut self, mesh: Mesh) -> MeshId {
        let mut hasher = DefaultHasher::new();
        mesh.triangles.hash(&mut hasher);
        for p in &mesh.positions {
            p.to_array().map(f32::to_bits).hash(&mut hasher);
        }
        let same_hash = self.content.entry(hasher.finish()).or_default();
        let equal = |id: &MeshId| {
            let other = &self.list[id.0 as usize];
            other.triangles == mesh.triangles
                && other.positions == mesh.positions
                && other.normals == mesh.normals
                && other.tangents == mesh.tangents
                && other.uvs == mesh.uvs
                && other.colors == mesh.colors
        };
        if let Some(&id) = same_hash.iter().find(|id| equal(id)) {
            return id;
        }
        let id = MeshId(self.list.len() as u32);
        same_hash.push(id);
        self.list.push(mesh);
        id
    }
}

/// Reads and repairs one primitive; `key` holds its accessors in the order of [`Meshes::get`].
fn convert(
    primitive: &Primitive,
    mode: Mode,
    key: &[Option<usize>],
    morphs: &[(&MorphTarget, f32)],
    place: &str,
    reader: &mut Reader<'_>,
    notes: &mut Notes,
) -> Result<Option<Mesh>, Fault> {
    let compressed =
        primitive.extensions.as_ref().is_some_and(|e| e.others.contains_key("KHR_draco_mesh_compression"));
    let attributes = format!("{place}.attributes");
    let Some(positions) = key[2] else {
        let hint = if compressed { " (it is Draco-compressed)" } else { "" };
        let message = format!("a primitive without POSITION has nothing to show{hint}");
        notes.add("primitive-ignored", NoteEffect::Missing, attributes, message);
        return Ok(None);
    };
    if triangles::count(mode, 0).is_none() {
        let message = "points and lines are not rendered";
        notes.add("primitive-ignored", NoteEffect::Missing, place, message);
        return Ok(None);
    }

    // Positions, and triangles over them.
    let vertices = reader.count(positions, &format!("{attributes}.POSITION"))?;
    let mut positions =
        reader.floats::<3>(positions, &[Type::Vec3], 0.0, &format!("{attributes}.POSITION"))?;
    morph(&mut positions, morphs, |t| t.positions, &format!("{place}.targets"), reader)?;
    let positions: Vec<Vec3> = positions.into_iter().map(Vec3::from).collect();
    if let Some(i) = positions.iter().position(|p| !p.is_finite()) {
        let found = format!("{} as element {i}", positions[i]);
        return Err(Fault::invalid(format!("{attributes}.POSITION"), found, "finite numbers"));
    }
    let drawn = match key[1] {
        Some(i) => reader.count(i, &format!("{place}.indices"))?,
        None => vertices,
    };
    let count = triangles::count(mode, drawn).unwrap_or(0);
    reader.budget.charge_triangles(count, place)?;
    if vertices > u64::from(u32::MAX) {
        return Err(Fault::invalid(attributes, format!("{vertices} vertices"), "at most 2^32 - 1"));
    }
    let indices = match key[1] {
        Some(i) => reader.indices(i, vertices, &format!("{place}.indices"))?,
        None => {
            reader.budget.charge_bytes(vertices, 4, place)?;
            (0..vertices as u32).collect()
        }
    };
    reader.budget.charge_bytes(count, 12, place)?;
    let triangles = triangles::list(mode, &indices);
    if mode == Mode::Triangles && indices.len() % 3 != 0 {
        let message = "the number of indices is no multiple of three: the last ones are left out";
        notes.add("indices-repaired", NoteEffect::None, place, message);
    }
    if triangles.is_empty() {
        notes.add("primitive-ignored", NoteEffect::None, place, "a primitive has no triangles");
        return Ok(None);
    }

    // Attributes that may be missing; a broken one is repaired or dropped.
    let mut mesh = Mesh { positions, triangles, ..Mesh::default() };
    let optional = |slot: usize, name: &str, reader: &Reader<'_>| -> Result<Option<(usize, String)>, Fault> {
        let Some(index) = key[slot] else { return Ok(None) };
        let place = format!("{attributes}.{name}");
        match reader.count(index, &place)? {
            n if n == vertices => Ok(Some((index, place))),
            n => Err(Fault::invalid(place, format!("{n} elements"), format!("{vertices}, as of POSITION"))),
        }
    };
    if let Some((index, place)) = optional(3, "NORMAL", reader)? {
        let mut raw = reader.floats::<3>(index, &[Type::Vec3], 0.0, &place)?;
        morph(&mut raw, morphs, |t| t.normals, &place, reader)?;
        let broken = normals(&mut mesh, &raw);
        if broken > 0 {
            let message = format!("{broken} normals are zero or not finite: taken from the faces");
            notes.add("normals-repaired", NoteEffect::Differs, place, message);
        }
    }
    if let Some((index, place)) = optional(4, "TANGENT", reader)? {
        let mut raw = reader.floats::<4>(index, &[Type::Vec4], 1.0, &place)?;
        morph(&mut raw, morphs, |t| t.tangents, &place, reader)?;
        let unit = |&[x, y, z, w]: &[f32; 4]| {
            Some(unit(Vec3::new(x, y, z))?.extend(if w < 0.0 { -1.0 } else { 1.0 }))
        };
        match raw.iter().map(unit).collect() {
            Some(tangents) => mesh.tangents = tangents,
            None => dropped(notes, "tangents", place),
        }
    }
    for (set, name) in ["TEXCOORD_0", "TEXCOORD_1"].into_iter().enumerate() {
        if let Some((index, place)) = optional(5 + set, name, reader)? {
            let uvs: Vec<_> =
                reader.floats::<2>(index, &[Type::Vec2], 0.0, &place)?.into_iter().map(Vec2::from).collect();
            if uvs.iter().all(|uv| uv.is_finite()) {
                mesh.uvs[set] = uvs;
            } else {
                dropped(notes, "texture coordinates", place);
            }
        }
    }
    if let Some((index, place)) = optional(7, "COLOR_0", reader)? {
        let widths = [Type::Vec3, Type::Vec4];
        let colors: Vec<_> =
            reader.floats::<4>(index, &widths, 1.0, &place)?.into_iter().map(Vec4::from).collect();
        if !colors.iter().all(|c| c.is_finite()) {
            dropped(notes, "vertex colours", place);
        } else if colors.iter().any(|c| *c != Vec4::ONE) {
            // Unused colour layers come out as plain white, which changes nothing.
            let clamped: Vec<_> = colors.iter().map(|c| c.clamp(Vec4::ZERO, Vec4::ONE)).collect();
            if clamped != colors {
                let message = "vertex colours are taken as from 0 to 1";
                notes.add("value-clamped", NoteEffect::Differs, place, message);
            }
            mesh.colors = clamped;
        }
    }
    Ok(Some(mesh))
}

/// Adds the displacements of morph targets, each times its weight.
fn morph<const N: usize>(
    values: &mut [[f32; N]],
    morphs: &[(&MorphTarget, f32)],
    which: impl Fn(&MorphTarget) -> Option<json::Index<json::Accessor>>,
    place: &str,
    reader: &mut Reader<'_>,
) -> Result<(), Fault> {
    for (target, weight) in morphs {
        let Some(index) = which(target).map(|i| i.value()) else { continue };
        let count = reader.count(index, place)?;
        if count != values.len() as u64 {
            let expected = format!("{}, as of the base shape", values.len());
            return Err(Fault::invalid(format!("accessors[{index}]"), format!("{count} elements"), expected));
        }
        let shifts = reader.floats::<3>(index, &[Type::Vec3], 0.0, place)?;
        for (value, shift) in values.iter_mut().zip(shifts) {
            value.iter_mut().zip(shift).for_each(|(v, s)| *v += weight * s);
        }
    }
    Ok(())
}

/// Notes an attribute that holds numbers which are not finite.
fn dropped(notes: &mut Notes, what: &str, place: String) {
    let message = format!("{what} that are not finite, or zero, are left out");
    notes.add("attribute-dropped", NoteEffect::Differs, place, message);
}

/// `v` at unit length, or nothing where it has no direction.
fn unit(v: Vec3) -> Option<Vec3> {
    // What is unit already stays, so that writing and reading it again changes no digit.
    if (v.length_squared() - 1.0).abs() <= 4.0 * f32::EPSILON {
        return Some(v);
    }
    v.as_dvec3().try_normalize().map(|n| n.as_vec3())
}

/// Sets unit normals, and the mean of the adjacent faces, weighted by area, where there is none.
/// Returns how many had to be made.
fn normals(mesh: &mut Mesh, raw: &[[f32; 3]]) -> usize {
    let given: Vec<_> = raw.iter().map(|&n| unit(n.into())).collect();
    let broken = given.iter().filter(|n| n.is_none()).count();
    let mut sums = vec![DVec3::ZERO; if broken > 0 { raw.len() } else { 0 }];
    for t in mesh.triangles.iter().filter(|_| broken > 0) {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        let n = (b - a).cross(c - a);
        t.iter().for_each(|&i| sums[i as usize] += n);
    }
    let made = |i: usize| sums[i].try_normalize().unwrap_or(DVec3::Y).as_vec3();
    mesh.normals = given.into_iter().enumerate().map(|(i, n)| n.unwrap_or_else(|| made(i))).collect();
    broken
}

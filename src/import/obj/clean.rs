//! Checked faces become an OBJ text that the `tobj` crate reads right, and its models.
//!
//! In: [`Parsed`]. Out: one `tobj` model for each section, welded by index. What tobj does not do happens
//! before: faces become triangles that cover the polygon's area (it fans), every corner of a section gets
//! texture coordinates and a normal if one has them (it would shift the others), smoothing groups become
//! normals (it ignores them), and what has no finite corner goes. The text holds positions, texture
//! coordinates and normals as shortest decimals that read back to the same bits, and sections by number, so
//! no name needs quoting.

use std::collections::HashMap;
use std::fmt::Write;

use glam::{DVec3, Vec2, Vec3};

use super::super::budget::Budget;
use super::super::error::Fault;
use super::log::{Log, line};
use super::parse::{Corner, Face, NONE, Parsed};
use super::polygon::{Cover, MAX_CORNERS, Triangulator, area_vector};
use crate::scene::{MAX_LENGTH, NoteEffect};

/// Bytes that a triangle takes at most on its way through the text and tobj: its line, its face there, and
/// three new vertices with their entries in a hash table.
const TRIANGLE_BYTES: u64 = 384;
/// The same for a position, texture coordinate or normal: its line, and its numbers.
const VERTEX_BYTES: u64 = 64;

/// A triangle with all that becomes of it.
struct Triangle {
    corners: [Corner; 3],
    section: u32,
    smoothing: u32,
}

/// The models of all sections that show anything, each with the number of its section.
pub(super) fn models(
    parsed: &Parsed,
    budget: &mut Budget,
    log: &mut Log,
) -> Result<Vec<(u32, tobj::Mesh)>, Fault> {
    let mut triangles = triangulate(parsed, budget, log)?;
    if triangles.is_empty() {
        return Ok(Vec::new());
    }
    // Sections in order of their first face, and each in one piece.
    triangles.sort_by_key(|t| t.section);
    let vertices = parsed.positions.len() + parsed.uvs.len() + parsed.normals.len();
    budget.charge_bytes(vertices as u64, VERTEX_BYTES, "vertices")?;
    let text = write(parsed, triangles, log);
    read(&text)
}

fn triangulate(parsed: &Parsed, budget: &mut Budget, log: &mut Log) -> Result<Vec<Triangle>, Fault> {
    let mut triangulator = Triangulator::default();
    let (mut triangles, mut cover) = (Vec::new(), Vec::new());
    let (mut used, mut points): (Vec<Corner>, Vec<DVec3>) = (Vec::new(), Vec::new());
    let limit = Vec3::splat(MAX_LENGTH as f32);
    for (i, face) in parsed.faces.iter().enumerate() {
        let end = parsed.faces.get(i + 1).map_or(parsed.corners.len(), |next| next.start);
        let corners = &parsed.corners[face.start..end];
        let place = || line(face.line);

        // Corners in one place count once.
        used.clear();
        points.clear();
        let mut finite = true;
        for c in corners {
            let p = parsed.positions[c.v as usize];
            // Written so that NaN fails too.
            finite &= p.abs().cmple(limit).all();
            if points.last() != Some(&p.as_dvec3()) {
                used.push(*c);
                points.push(p.as_dvec3());
            }
        }
        while points.len() > 1 && points.last() == points.first() {
            points.pop();
            used.pop();
        }
        if !finite {
            let message = "a face with a corner that is not finite, or beyond 1e15: dropped";
            log.add("non-finite-triangles", NoteEffect::Missing, place(), message);
            continue;
        }
        let n = used.len() as u64;
        budget.charge_triangles(n.saturating_sub(2), &place())?;
        budget.charge_bytes(n.saturating_sub(2), TRIANGLE_BYTES, &place())?;
        match triangulator.cover(&points, &mut cover) {
            Cover::Whole => {}
            Cover::Empty => {
                let message = "a face has no area: dropped";
                log.add("degenerate-faces", NoteEffect::None, place(), message);
            }
            Cover::Crossing => {
                let message = "the outline of a face crosses itself: its area is a guess";
                log.add("crossing-face", NoteEffect::Differs, place(), message);
            }
            Cover::TooLarge => {
                let message = format!(
                    "a face that is not convex has more than {MAX_CORNERS} corners, or such faces have too many in all: dropped"
                );
                log.add("faces-dropped", NoteEffect::Missing, place(), message);
            }
        }
        let Face { section, smoothing, .. } = *face;
        triangles.extend(cover.iter().map(|t| {
            let corners = t.map(|k| used[k as usize]);
            Triangle { corners, section, smoothing }
        }));
    }
    Ok(triangles)
}

/// The text for tobj.
fn write(parsed: &Parsed, mut triangles: Vec<Triangle>, log: &mut Log) -> String {
    let mut uvs = parsed.uvs.clone();
    let mut normals = parsed.normals.clone();
    repair(&mut triangles, &mut uvs, &mut normals, log);
    smooth(parsed, &mut triangles, &mut normals);
    complete(parsed, &mut triangles, &mut uvs, &mut normals, log);

    let mut text = String::new();
    // Writing to a string cannot fail.
    for (i, p) in parsed.positions.iter().enumerate() {
        let p = if p.is_finite() { *p } else { Vec3::ZERO };
        let _ = write!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z);
        if let Some(c) = parsed.colors.get(i) {
            let _ = write!(text, " {:?} {:?} {:?}", c.x, c.y, c.z);
        }
        text.push('\n');
    }
    for uv in &uvs {
        let _ = writeln!(text, "vt {:?} {:?}", uv.x, uv.y);
    }
    for n in &normals {
        let _ = writeln!(text, "vn {:?} {:?} {:?}", n.x, n.y, n.z);
    }
    let mut section = None;
    for t in &triangles {
        if section != Some(t.section) {
            section = Some(t.section);
            let _ = writeln!(text, "o {}", t.section);
        }
        text.push('f');
        for c in &t.corners {
            let _ = match (c.vt, c.vn) {
                (NONE, NONE) => write!(text, " {}", c.v + 1),
                (vt, NONE) => write!(text, " {}/{}", c.v + 1, vt + 1),
                (NONE, vn) => write!(text, " {}//{}", c.v + 1, vn + 1),
                (vt, vn) => write!(text, " {}/{}/{}", c.v + 1, vt + 1, vn + 1),
            };
        }
        text.push('\n');
    }
    text
}

/// Forgets texture coordinates and normals that are no numbers, and gives the others unit length.
fn repair(triangles: &mut [Triangle], uvs: &mut [Vec2], normals: &mut [Vec3], log: &mut Log) {
    let bad_uvs: Vec<bool> = uvs.iter().map(|uv| !uv.is_finite()).collect();
    let unit: Vec<Option<Vec3>> =
        normals.iter().map(|n| n.as_dvec3().try_normalize().map(|n| n.as_vec3())).collect();
    let (mut lost_uvs, mut lost_normals) = (0, 0);
    for c in triangles.iter_mut().flat_map(|t| &mut t.corners) {
        if c.vt != NONE && bad_uvs[c.vt as usize] {
            (c.vt, lost_uvs) = (NONE, lost_uvs + 1);
        }
        if c.vn != NONE && unit[c.vn as usize].is_none() {
            (c.vn, lost_normals) = (NONE, lost_normals + 1);
        }
    }
    if lost_uvs > 0 {
        let message = format!("{lost_uvs} corners have texture coordinates that are not finite: zero");
        log.add("attribute-dropped", NoteEffect::Differs, "vt", message);
    }
    if lost_normals > 0 {
        let message = format!("{lost_normals} corners have normals that are zero or not finite: made anew");
        log.add("normals-repaired", NoteEffect::Differs, "vn", message);
    }
    uvs.iter_mut().filter(|uv| !uv.is_finite()).for_each(|uv| *uv = Vec2::ZERO);
    normals.iter_mut().zip(unit).for_each(|(n, unit)| *n = unit.unwrap_or(Vec3::Z));
}

fn corner_points(parsed: &Parsed, t: &Triangle) -> [DVec3; 3] {
    t.corners.map(|c| parsed.positions[c.v as usize].as_dvec3())
}

/// Corners without a normal in a smoothing group get the mean of the faces around them in that group,
/// weighted by angle (Thürmer and Wüthrich 1998), so that the split of a polygon does not matter.
fn smooth(parsed: &Parsed, triangles: &mut [Triangle], normals: &mut Vec<Vec3>) {
    let lacks = |t: &Triangle| t.smoothing != 0 && t.corners.iter().any(|c| c.vn == NONE);
    if !triangles.iter().any(lacks) {
        return;
    }
    let mut sums: HashMap<(u32, u32), DVec3> = HashMap::new();
    for t in triangles.iter().filter(|t| t.smoothing != 0) {
        let p = corner_points(parsed, t);
        let Some(n) = area_vector(&p).try_normalize() else { continue };
        for i in 0..3 {
            let (e, f) = (p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
            let angle = libm::atan2(e.cross(f).length(), e.dot(f));
            *sums.entry((t.smoothing, t.corners[i].v)).or_default() += n * angle;
        }
    }
    let mut indices: HashMap<(u32, u32), u32> = HashMap::new();
    for t in triangles.iter_mut().filter(|t| lacks(t)) {
        let smoothing = t.smoothing;
        for c in t.corners.iter_mut().filter(|c| c.vn == NONE) {
            let key = (smoothing, c.v);
            let Some(n) = sums.get(&key).and_then(|n| n.try_normalize()) else { continue };
            c.vn = *indices.entry(key).or_insert_with(|| {
                normals.push(n.as_vec3());
                normals.len() as u32 - 1
            });
        }
    }
}

/// Where some corners of a section have texture coordinates or a normal, all get them.
fn complete(
    parsed: &Parsed,
    triangles: &mut [Triangle],
    uvs: &mut Vec<Vec2>,
    normals: &mut Vec<Vec3>,
    log: &mut Log,
) {
    let (mut filled, mut origin) = (0, NONE);
    for section in triangles.chunk_by_mut(|a, b| a.section == b.section) {
        let corners = || section.iter().flat_map(|t| t.corners);
        let (any_uv, any_normal) = (corners().any(|c| c.vt != NONE), corners().any(|c| c.vn != NONE));
        for t in section {
            if any_uv {
                for c in t.corners.iter_mut().filter(|c| c.vt == NONE) {
                    if origin == NONE {
                        origin = uvs.len() as u32;
                        uvs.push(Vec2::ZERO);
                    }
                    (c.vt, filled) = (origin, filled + 1);
                }
            }
            if any_normal && t.corners.iter().any(|c| c.vn == NONE) {
                let n = area_vector(&corner_points(parsed, t)).try_normalize().unwrap_or(DVec3::Y);
                let index = normals.len() as u32;
                normals.push(n.as_vec3());
                t.corners.iter_mut().filter(|c| c.vn == NONE).for_each(|c| c.vn = index);
            }
        }
    }
    if filled > 0 {
        let message =
            format!("{filled} corners lack texture coordinates that others of their mesh have: zero");
        log.add("uvs-partial", NoteEffect::None, "vt", message);
    }
}

/// What tobj makes of the text.
fn read(text: &str) -> Result<Vec<(u32, tobj::Mesh)>, Fault> {
    let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let fault = |found: String| Fault::invalid("the triangulated mesh", found, "a mesh that tobj reads");
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials)
        .map_err(|e| fault(format!("a fault ({e})")))?;
    let number = |m: tobj::Model| match m.name.parse() {
        Ok(section) => Ok((section, m.mesh)),
        Err(_) => Err(fault(format!("a model {:?}", m.name))),
    };
    models.into_iter().map(number).collect()
}

//! A scene becomes Wavefront OBJ: NAME.obj, NAME.mtl, and NAME.epsilux.toml for what they cannot say.
//!
//! In: a valid scene. Out: the three files, pictures beside them, and notes. Objects are placed, since OBJ
//! knows no transforms: shared meshes are written once for each use. The sidecar is a scene in the text
//! form: cameras, lights, spheres, environment, settings, what the camera does not see, and the materials that MTL cannot
//! hold exactly, each under the name that it has in NAME.mtl. It is always written, so that none from an
//! earlier conversion lies beside the new files. Invariant: [`crate::import::read`] gives back the same
//! counts, bounds, area, materials, lights and cameras, but for what a note says.

mod mtl;

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use glam::{DAffine3, DMat3, DVec3};

use super::files::{pictures, stem_of};
use super::text::with_paths;
use super::{Encoded, ExportError, OutFile};
use crate::color::linear_to_srgb;
use crate::scene::notes::Notes;
use crate::scene::{
    Material, MaterialId, MaterialKind, Mesh, MeshId, NoteEffect, Object, Scene, Shape, text,
};

/// Converts a scene; `name` is the file name that it will have.
pub(super) fn encode(scene: &Scene, name: &str) -> Result<Encoded, ExportError> {
    let stem = stem_of(name);
    let found = pictures(&scene.images, stem)?;
    let mut notes = Notes::default();
    let materials = material_names(scene, &mut notes);

    // Materials that something in the OBJ file uses; the others live in the sidecar alone.
    let mut used = vec![false; scene.materials.len()];
    for (object, _) in meshes(scene) {
        used[object.material.0 as usize] = true;
    }
    let mut library = mtl::Library { text: "# Materials of epsilux\n".to_owned(), pictures: &found.paths };
    let mut beside = vec![true; scene.materials.len()];
    for (i, material) in scene.materials.iter().enumerate().filter(|(i, _)| used[*i]) {
        beside[i] = !library.add(&materials[i], material);
        if beside[i] {
            let message = format!(
                "MTL has no words for all of the material: {stem}.epsilux.toml has it, other programs see \
                 something near it"
            );
            notes.add("material-in-sidecar", NoteEffect::None, format!("materials[{i}]"), message);
        }
    }
    let library = library.text;
    let geometry = geometry(scene, &materials, &format!("{stem}.mtl"), &mut notes);
    let sidecar = sidecar(scene, stem, &materials, &beside, found.paths, &mut notes);

    let mut files = found.files;
    let mut add = |path: String, text: String| files.push(OutFile { path, bytes: text.into_bytes() });
    add(format!("{stem}.mtl"), library);
    add(format!("{stem}.epsilux.toml"), sidecar);
    add(name.to_owned(), geometry);
    Ok(Encoded { files, notes: notes.finish() })
}

/// Whether OBJ cannot hold an object: spheres, and what the camera does not see.
fn is_beside(object: &Object) -> bool {
    matches!(object.shape, Shape::Sphere { .. }) || !object.visible_to_camera
}

/// Objects that OBJ can hold and that have triangles, and their meshes.
fn meshes(scene: &Scene) -> impl Iterator<Item = (&Object, &Mesh)> {
    scene.objects.iter().filter(|o| !is_beside(o)).filter_map(|o| match o.shape {
        Shape::Mesh(id) => {
            scene.meshes.get(id.0 as usize).filter(|m| !m.triangles.is_empty()).map(|m| (o, m))
        }
        Shape::Sphere { .. } => None,
    })
}

/// A number in its shortest form that reads back to the same bits.
fn number(v: f32) -> String {
    let text = format!("{v:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

/// The names of materials in the files, and a note where they had to be others.
fn material_names(scene: &Scene, notes: &mut Notes) -> Vec<String> {
    let mut names = LineNames::default();
    scene
        .materials
        .iter()
        .enumerate()
        .map(|(i, material)| {
            let name = names.unique(&material.name, "material");
            if name != material.name {
                let message = format!("the name {:?} does not fit into a line: `{name}`", material.name);
                notes.add("name-changed", NoteEffect::None, format!("materials[{i}]"), message);
            }
            name
        })
        .collect()
}

/// Names that are the rest of a line: without control characters, blanks around them, or the `\` that
/// continues a line; each once.
#[derive(Default)]
struct LineNames(HashSet<String>);

impl LineNames {
    fn unique(&mut self, wanted: &str, what: &str) -> String {
        let safe = |c: char| if c.is_control() || c == '\\' { '_' } else { c };
        let base: String = wanted.chars().map(safe).collect();
        let base = match base.trim() {
            "" => what,
            // Readers take these group and file names for something else.
            "default" | "off" | "(null)" => &format!("{what} {}", base.trim()),
            trimmed => trimmed,
        };
        let mut name = base.to_owned();
        let mut number = 1;
        while !self.0.insert(name.clone()) {
            number += 1;
            name = format!("{base}.{number}");
        }
        name
    }
}

/// The text of the OBJ file.
fn geometry(scene: &Scene, materials: &[String], library: &str, notes: &mut Notes) -> String {
    let mut text = format!("# A scene of epsilux\nmtllib {library}\n");
    let mut names = LineNames::default();
    // Where some vertices have colours, readers want one for each.
    let colored = meshes(scene).any(|(_, m)| !m.colors.is_empty());
    let mut first = Indices { v: 1, vt: 1, vn: 1 };
    let mut uses = vec![0_u64; scene.meshes.len()];
    let mut again = Again::default();
    for (i, object) in scene.objects.iter().enumerate() {
        let place = format!("objects[{i}]");
        let Shape::Mesh(MeshId(id)) = object.shape else { continue };
        if is_beside(object) {
            continue;
        }
        let Some(mesh) = scene.meshes.get(id as usize) else { continue };
        if mesh.triangles.is_empty() {
            let message = "an object without triangles: left out";
            notes.add("object-empty", NoteEffect::None, place, message);
            continue;
        }
        let start = text.len();
        let _ = writeln!(text, "o {}", names.unique(&object.name, "object"));
        vertices(&mut text, mesh, &object.transform, colored);
        let _ = writeln!(text, "usemtl {}", materials[object.material.0 as usize]);
        faces(&mut text, mesh, first, object.transform.matrix3.determinant() < 0.0);
        first.v += mesh.positions.len();
        first.vt += mesh.uvs[0].len();
        first.vn += mesh.normals.len();

        uses[id as usize] += 1;
        if uses[id as usize] > 1 {
            again.objects += 1;
            again.triangles += mesh.triangles.len() as u64;
            again.bytes += (text.len() - start) as u64;
        }
        lost(scene, object, mesh, &place, notes);
    }
    if again.objects > 0 {
        let message = format!(
            "OBJ has no instances: shared meshes are written once for each use ({} more objects, {} more triangles, \
             {} more bytes)",
            again.objects, again.triangles, again.bytes
        );
        notes.add("instances-flattened", NoteEffect::None, "objects", message);
    }
    text
}

/// The next number of each kind of vertex.
#[derive(Clone, Copy)]
struct Indices {
    v: usize,
    vt: usize,
    vn: usize,
}

/// What writing shared meshes again takes.
#[derive(Default)]
struct Again {
    objects: u64,
    triangles: u64,
    bytes: u64,
}

fn vertices(text: &mut String, mesh: &Mesh, transform: &DAffine3, colored: bool) {
    // Exact where there is nothing to do.
    let placed = *transform != DAffine3::IDENTITY;
    for (i, &p) in mesh.positions.iter().enumerate() {
        let p = if placed { transform.transform_point3(p.as_dvec3()).as_vec3() } else { p };
        let white = [1.0; 3];
        let color = mesh.colors.get(i).map_or(white, |c| c.truncate().to_array());
        let encoded = color.map(|c| if c >= 1.0 { 1.0 } else { linear_to_srgb(c.max(0.0)) });
        row(text, "v", &[&p.to_array(), if colored { &encoded } else { &[] }]);
    }
    for uv in &mesh.uvs[0] {
        row(text, "vt", &[&[uv.x, 1.0 - uv.y]]);
    }
    let turn = normal_matrix(transform.matrix3);
    for &n in &mesh.normals {
        let turned = if placed { (turn * n.as_dvec3()).try_normalize() } else { None };
        row(text, "vn", &[&turned.map_or(n, DVec3::as_vec3).to_array()]);
    }
}

/// A statement with numbers.
fn row(text: &mut String, key: &str, numbers: &[&[f32]]) {
    text.push_str(key);
    for &n in numbers.iter().copied().flatten() {
        text.push(' ');
        // Adding zero turns negative zeros, which help nobody, into zeros.
        text.push_str(&number(n + 0.0));
    }
    text.push('\n');
}

/// Normals go by the inverse transpose, which the cofactors are up to a factor; its sign is that of the
/// determinant.
fn normal_matrix(m: DMat3) -> DMat3 {
    let cofactors =
        DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let largest = cofactors.to_cols_array().into_iter().fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
    cofactors * (m.determinant().signum() / largest)
}

/// Triangles, turned round where the transform mirrors, so that the front stays the front.
fn faces(text: &mut String, mesh: &Mesh, first: Indices, mirrored: bool) {
    for &[a, b, c] in &mesh.triangles {
        text.push('f');
        for i in if mirrored { [a, c, b] } else { [a, b, c] } {
            let i = i as usize;
            let _ = write!(text, " {}", first.v + i);
            let _ = match (mesh.uvs[0].is_empty(), mesh.normals.is_empty()) {
                (true, true) => Ok(()),
                (false, true) => write!(text, "/{}", first.vt + i),
                (true, false) => write!(text, "//{}", first.vn + i),
                (false, false) => write!(text, "/{}/{}", first.vt + i, first.vn + i),
            };
        }
        text.push('\n');
    }
}

/// Notes what the OBJ file does not hold of an object.
fn lost(scene: &Scene, object: &Object, mesh: &Mesh, place: &str, notes: &mut Notes) {
    let textures = match scene.materials.get(object.material.0 as usize).map(|m| &m.kind) {
        Some(MaterialKind::Principled(p)) => Some(&p.textures),
        _ => None,
    };
    let effect = |concerns: bool| if concerns { NoteEffect::Differs } else { NoteEffect::None };
    if !mesh.tangents.is_empty() {
        let mapped = textures.is_some_and(|t| t.normal.is_some() || t.coat_normal.is_some());
        let message = "OBJ has no tangents: they are made anew from the texture coordinates";
        notes.add("tangents-lost", effect(mapped), place, message);
    }
    if !mesh.uvs[1].is_empty() {
        let asked = textures.is_some_and(|t| t.iter().any(|(_, t)| t.uv_set == 1));
        let message = "OBJ has one set of texture coordinates: the second is lost";
        notes.add("uvs2-lost", effect(asked), place, message);
    }
    let mut colors = mesh.colors.iter();
    if colors.clone().any(|c| c.w < 1.0) {
        let message = "colours of vertices have no alpha in OBJ: it is lost";
        notes.add("vertex-alpha-lost", NoteEffect::Differs, place, message);
    }
    if colors.any(|c| c.truncate().max_element() > 1.0) {
        let message = "colours of vertices end at 1 in OBJ: brighter ones are cut";
        notes.add("value-clamped", NoteEffect::Differs, place, message);
    }
}

/// The text of the sidecar: the scene without what the OBJ file holds, and with the materials that are
/// marked in `beside`.
fn sidecar(
    scene: &Scene,
    stem: &str,
    names: &[String],
    beside: &[bool],
    paths: Vec<String>,
    notes: &mut Notes,
) -> String {
    let mut new_ids = vec![None; scene.materials.len()];
    let mut materials = Vec::new();
    // Objects name their material, so it has to be there.
    let objects = || scene.objects.iter().filter(|o| is_beside(o));
    let of_objects: HashSet<MaterialId> = objects().map(|o| o.material).collect();
    for (i, material) in scene.materials.iter().enumerate() {
        let id = MaterialId(i as u32);
        if beside[i] || of_objects.contains(&id) {
            new_ids[i] = Some(MaterialId(materials.len() as u32));
            materials.push(Material { name: names[i].clone(), kind: material.kind.clone() });
        }
    }
    let mut meshes: Vec<Mesh> = Vec::new();
    let mut mesh_ids = HashMap::new();
    let mut hidden = 0;
    let mut object = |o: &Object| {
        let shape = match o.shape {
            Shape::Mesh(id) => {
                hidden += 1;
                Shape::Mesh(*mesh_ids.entry(id).or_insert_with(|| {
                    meshes.extend(scene.meshes.get(id.0 as usize).cloned());
                    MeshId(meshes.len() as u32 - 1)
                }))
            }
            sphere @ Shape::Sphere { .. } => sphere,
        };
        let material = new_ids[o.material.0 as usize]?;
        Some(Object { material, shape, ..o.clone() })
    };
    let objects: Vec<Object> = objects().filter_map(&mut object).collect();

    let mut held = Vec::new();
    let mut hold = |count: usize, one: &str, many: &str| match count {
        0 => {}
        1 => held.push(format!("1 {one}")),
        n => held.push(format!("{n} {many}")),
    };
    hold(objects.len() - hidden, "sphere", "spheres");
    hold(hidden, "object that the camera does not see", "objects that the camera does not see");
    hold(scene.cameras.len(), "camera", "cameras");
    hold(scene.lights.len(), "light", "lights");
    hold(usize::from(scene.environment.is_some()), "environment", "");
    if !held.is_empty() {
        let message = format!(
            "OBJ cannot hold {}: {stem}.epsilux.toml has what it cannot, other programs do not see it",
            held.join(", ")
        );
        notes.add("in-sidecar", NoteEffect::None, "", message);
    }
    let textured = |m: &Material| matches!(&m.kind, MaterialKind::Principled(p) if !p.textures.is_empty());
    let pictured =
        materials.iter().any(textured) || scene.environment.as_ref().is_some_and(|e| e.image.is_some());
    let rest = Scene {
        title: scene.title.clone(),
        materials,
        // All of them: textures count them by number.
        images: if pictured { scene.images.clone() } else { Vec::new() },
        meshes,
        objects,
        lights: scene.lights.clone(),
        cameras: scene.cameras.clone(),
        environment: scene.environment.clone(),
        settings: scene.settings,
    };
    let rest = with_paths(&rest, if pictured { paths } else { Vec::new() });
    format!("# What the OBJ file of this name cannot say.\n{}", text::to_toml(&rest))
}

#[cfg(test)]
mod tests;

//! Wavefront OBJ with its material libraries becomes a scene.
//!
//! The `tobj` crate parses OBJ and MTL; a layer of ours around it makes its input safe and complete, since
//! it fans polygons, takes lines for faces, and gives up on much that is common. In: bytes. Through: `lines`
//! (text), `parse` (checked statements), `polygon` (triangles), `clean` (text for tobj, and its models),
//! `mtl` (the same for materials), `material` and `texture`. Out: a scene, completed by a sidecar
//! (`sidecar`) with what OBJ cannot hold. Coordinates are taken as they are: +Y up, metres.

mod clean;
mod lines;
mod log;
mod material;
mod mesh;
mod mtl;
mod parse;
mod polygon;
mod sidecar;
mod texture;

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::budget::Budget;
use super::error::Fault;
use super::file;
use super::names::Names;
use super::picture::Pictures;
use crate::scene::{Material, MaterialId, Note, NoteEffect, Scene};

use log::{Log, line, quoted};
use mtl::Source;
use sidecar::Sidecar;
use texture::Loader;

/// Reads the OBJ file whose content is `bytes`; `path` says where the files that it names lie.
pub(crate) fn read(bytes: &[u8], path: &Path, budget: &mut Budget) -> Result<(Scene, Vec<Note>), Fault> {
    let mut log = Log::default();
    let (text, latin1) = lines::decode(bytes, budget)?;
    if latin1 {
        log.add("latin-1", NoteEffect::None, "", "the file is not UTF-8: its names are taken as Latin-1");
    }
    let parsed = parse::parse(&text, budget, &mut log)?;
    let models = clean::models(&parsed, budget, &mut log)?;
    if models.is_empty() {
        log.add("no-faces", NoteEffect::Missing, "", "the file has no face with an area");
    }

    let folder = path.parent().unwrap_or(Path::new(""));
    let sidecar = Sidecar::read(path, budget, &mut log)?;
    let libraries = libraries(&parsed, folder, budget, &mut log)?;
    let mut loader = Loader { pictures: Pictures::new(folder), budget };
    let mut scene = Scene::default();
    let mut used =
        Used { libraries, sidecar: sidecar.as_ref(), ids: HashMap::new(), names: Names::default() };
    let mut shared = mesh::Shared::default();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    for (number, model) in models {
        let Some(section) = parsed.sections.get(number as usize) else { continue };
        let asked = section.material.and_then(|m| parsed.materials.get(m as usize));
        let material = used.get(asked, &mut scene, &mut loader, &mut log);
        let name = if section.name.is_empty() { &*stem } else { &section.name };
        shared.add(&mut scene, name, material, model)?;
    }
    scene.images = loader.pictures.finish();
    if let Some(sidecar) = sidecar {
        sidecar.add_to(&mut scene, &mut log);
    }
    Ok((scene, log.finish()))
}

/// Reads every material library that the file names. Where one cannot be read, the scene goes without.
fn libraries(
    parsed: &parse::Parsed,
    folder: &Path,
    budget: &mut Budget,
    log: &mut Log,
) -> Result<HashMap<String, Source>, Fault> {
    let mut sources: HashMap<String, Source> = HashMap::new();
    let mut tried = 0;
    let wanted: HashSet<&str> = parsed.materials.iter().map(|(name, _)| &**name).collect();
    for (named, number) in &parsed.libraries {
        for name in library_names(named, folder) {
            let place = line(*number);
            tried += 1;
            if tried > parse::MAX_LIBRARIES {
                let message =
                    format!("more than {} material libraries: the others are not read", parse::MAX_LIBRARIES);
                log.add("mtllib-ignored", NoteEffect::Missing, place, message);
                return Ok(sources);
            }
            let text = match library(&name, folder, &place, budget) {
                Ok(text) => text,
                Err(fault) => {
                    let message =
                        format!("the material library {} {}", quoted(&name), texture::reason(&fault));
                    log.add("mtllib-missing", NoteEffect::Differs, place, message);
                    continue;
                }
            };
            mtl::read(&text, &name, &wanted, &mut sources, budget, log)?;
        }
    }
    Ok(sources)
}

/// The text of the library `name`; where its path leads nowhere, as one of another machine does, that of
/// the file of its name beside the scene.
fn library(name: &str, folder: &Path, place: &str, budget: &mut Budget) -> Result<String, Fault> {
    let base = name.rsplit('/').next().unwrap_or(name);
    let found = file::below(folder, name, place);
    let path = found.or_else(|fault| file::below(folder, base, place).map_err(|_| fault))?;
    let bytes = file::read_regular(&path, budget)?;
    Ok(lines::decode(&bytes, budget)?.0.into_owned())
}

/// The files that one `mtllib` statement names: one whose name has blanks, where there is such a file, else
/// several.
fn library_names(named: &str, folder: &Path) -> Vec<String> {
    let named = named.trim_matches('"').replace('\\', "/");
    let named = named.strip_prefix("./").unwrap_or(&named).to_owned();
    let several: Vec<String> = lines::words(&named).map(str::to_owned).collect();
    if several.len() < 2 || file::below(folder, &named, "mtllib").is_ok() {
        return vec![named];
    }
    // `my room.mtl` that is missing is one file, `a.mtl b.mtl` are two.
    let is_library = |s: &String| s.to_ascii_lowercase().ends_with(".mtl");
    if several.iter().all(is_library) { several } else { vec![named] }
}

/// Materials of the scene by the name that the file asks for.
struct Used<'s> {
    libraries: HashMap<String, Source>,
    sidecar: Option<&'s Sidecar>,
    /// `None` for faces without a material.
    ids: HashMap<Option<String>, MaterialId>,
    names: Names,
}

impl Used<'_> {
    fn get(
        &mut self,
        asked: Option<&(String, usize)>,
        scene: &mut Scene,
        loader: &mut Loader<'_>,
        log: &mut Log,
    ) -> MaterialId {
        let key = asked.map(|(name, _)| name.clone());
        if let Some(&known) = self.ids.get(&key) {
            return known;
        }
        let name = self.names.unique(key.as_deref().unwrap_or("default"));
        let kind = match asked {
            // The sidecar's comes in its place.
            _ if self.sidecar.is_some_and(|s| s.defines(&name)) => material::default_kind(),
            None => {
                let message = "faces without a material are grey";
                log.add("material-missing", NoteEffect::Differs, "usemtl", message);
                material::default_kind()
            }
            Some((asked, number)) => match self.libraries.get(asked) {
                Some(source) => material::convert(source, loader, log),
                None => {
                    let message =
                        format!("the material {} is defined nowhere: its faces are grey", quoted(asked));
                    log.add("material-missing", NoteEffect::Differs, line(*number), message);
                    material::default_kind()
                }
            },
        };
        let id = MaterialId(scene.materials.len() as u32);
        scene.materials.push(Material { name, kind });
        self.ids.insert(key, id);
        id
    }
}

#[cfg(test)]
mod tests;

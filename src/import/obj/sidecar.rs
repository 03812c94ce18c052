//! `NAME.epsilux.toml` beside `NAME.obj`: what OBJ cannot hold.
//!
//! In: a scene in the text form. Out: its cameras, lights, objects, environment and settings in the scene
//! of the OBJ file, and its materials in place of those of the same name. The coordinates of the OBJ file
//! stay as they are, +Y up and in metres; `up` in the sidecar is about the sidecar's own numbers. A mistake
//! in it is an error with its own file and line, since the picture would be another without it.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::Path;

use super::super::budget::Budget;
use super::super::error::Fault;
use super::super::{file, text};
use super::log::{Log, quoted};
use crate::scene::text::Syntax;
use crate::scene::{MaterialId, MaterialKind, NoteEffect, Scene, Shape};

/// A sidecar, read.
pub(super) struct Sidecar {
    /// Its name, for places of notes.
    name: String,
    scene: Scene,
    names: HashSet<String>,
}

impl Sidecar {
    /// Whether it says what the material `name` is.
    pub(super) fn defines(&self, name: &str) -> bool {
        self.names.contains(name)
    }

    /// Reads the sidecar of the OBJ file at `path`, where there is one.
    pub(super) fn read(path: &Path, budget: &mut Budget, log: &mut Log) -> Result<Option<Self>, Fault> {
        let path = path.with_extension("epsilux.toml");
        // A link that leads nowhere is there, and an error.
        if fs::symlink_metadata(&path).is_err() {
            return Ok(None);
        }
        let (scene, name) =
            read(&path, budget, log).map_err(|fault| Fault::Elsewhere(Box::new(fault.at(&path))))?;
        let names = scene.materials.iter().map(|m| m.name.clone()).collect();
        Ok(Some(Self { name, scene, names }))
    }

    /// Adds it to the scene of the OBJ file.
    pub(super) fn add_to(self, scene: &mut Scene, log: &mut Log) {
        let Self { name, scene: mut extra, .. } = self;
        let (images, meshes) = (scene.images.len() as u32, scene.meshes.len() as u32);
        let used: HashSet<MaterialId> = extra.objects.iter().map(|o| o.material).collect();
        let known: HashMap<String, usize> =
            scene.materials.iter().enumerate().map(|(i, m)| (m.name.clone(), i)).collect();
        let mut ids = Vec::with_capacity(extra.materials.len());
        for (i, mut material) in extra.materials.into_iter().enumerate() {
            if let MaterialKind::Principled(p) = &mut material.kind {
                p.textures.iter_mut().for_each(|t| t.image.0 += images);
            }
            if let Some(&of_obj) = known.get(&material.name) {
                ids.push(MaterialId(of_obj as u32));
                scene.materials[of_obj].kind = material.kind;
                continue;
            }
            ids.push(MaterialId(scene.materials.len() as u32));
            if used.contains(&MaterialId(i as u32)) {
                scene.materials.push(material);
            } else {
                let message = format!(
                    "neither the OBJ file nor the sidecar uses the material {}",
                    quoted(&material.name)
                );
                let place = format!("{name}: material.{}", material.name);
                log.add("material-unused", NoteEffect::None, place, message);
            }
        }
        for mut object in extra.objects {
            object.material = ids[object.material.0 as usize];
            if let Shape::Mesh(id) = &mut object.shape {
                id.0 += meshes;
            }
            scene.objects.push(object);
        }
        if let Some(image) = extra.environment.as_mut().and_then(|e| e.image.as_mut()) {
            image.image.0 += images;
        }
        scene.images.append(&mut extra.images);
        scene.meshes.append(&mut extra.meshes);
        scene.lights.append(&mut extra.lights);
        scene.cameras.append(&mut extra.cameras);
        scene.environment = extra.environment;
        scene.settings = extra.settings;
        scene.title = extra.title;
    }
}

fn read(path: &Path, budget: &mut Budget, log: &mut Log) -> Result<(Scene, String), Fault> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let folder = path.parent().unwrap_or(Path::new(""));
    // As any file that the scene consists of, it may not be a link that leads outside.
    let real = file::below(folder, &name, "sidecar")?;
    let bytes = file::read_regular(&real, budget)?;
    let (scene, notes) = text::read(bytes, Syntax::Toml, folder, budget)?;
    for note in notes {
        log.add(note.code, note.effect, format!("{name}: {}", note.place), note.message);
    }
    Ok((scene, name))
}

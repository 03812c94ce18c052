//! glTF 2.0, as JSON or as GLB, becomes a scene.
//!
//! The document types are the `gltf` crate's; accessors are read by our own checked reader, since the
//! crate's iterators panic on broken files. Nodes are walked without recursion. Source: the glTF 2.0
//! specification (Khronos, 2021) and its KHR extensions; where Blender's exporter means something else
//! than the specification says, its meaning is followed for its files (see `material` and `light`).

mod accessor;
mod document;
mod extension;
mod glb;
mod instancing;
mod light;
mod material;
mod mesh;
mod node;
mod sphere;
mod texture;
mod triangles;
mod vendor;

use std::path::Path;

use super::ReadOptions;
use super::budget::Budget;
use super::error::Fault;
use super::notes::Notes;
use crate::scene::{Note, NoteEffect, Scene};

pub(crate) use glb::GLB_MAGIC;

/// Reads a GLB file; `folder` is where the files that it names lie.
pub(crate) fn read_glb(
    bytes: &[u8],
    folder: &Path,
    options: &ReadOptions,
    budget: &mut Budget,
) -> Result<(Scene, Vec<Note>), Fault> {
    let glb = glb::split(bytes)?;
    read(glb.json, glb.bin, folder, options, budget)
}

/// Reads the JSON form.
pub(crate) fn read_json(
    text: &[u8],
    folder: &Path,
    options: &ReadOptions,
    budget: &mut Budget,
) -> Result<(Scene, Vec<Note>), Fault> {
    read(text, None, folder, options, budget)
}

fn read(
    text: &[u8],
    bin: Option<&[u8]>,
    folder: &Path,
    options: &ReadOptions,
    budget: &mut Budget,
) -> Result<(Scene, Vec<Note>), Fault> {
    let doc = document::parse(text)?;
    let mut notes = Notes::default();
    extension::check(&doc.extensions, &mut notes)?;
    if doc.scenes > 1 {
        let message = format!("one of {} scenes is read", doc.scenes);
        notes.add("scenes-ignored", NoteEffect::None, "scenes", message);
    }
    if doc.animations > 0 {
        let message = format!("{} animations are not played: static pose", doc.animations);
        notes.add("animation-ignored", NoteEffect::Differs, "animations", message);
    }
    let reader = accessor::Reader::new(&doc, bin, folder, budget)?;
    let scene = node::build(&doc, reader, folder, options, &mut notes)?;
    Ok((scene, notes.finish()))
}

#[cfg(test)]
mod tests;

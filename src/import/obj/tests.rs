//! Tests of the OBJ reader, as a user calls it: files in, scene and notes out.

mod area;
mod geometry;
mod hostile;
mod materials;
mod room;
mod sidecar;

use std::fs;
use std::path::Path;

use glam::DVec3;

use super::super::{ImportError, ReadOptions, read};
use crate::scene::{Mesh, Note, Scene};

/// Reads `scene.obj` from a folder that holds `files`.
fn try_load(files: &[(&str, &[u8])]) -> Result<(Scene, Vec<Note>), ImportError> {
    let dir = tempfile::tempdir().unwrap();
    for (name, content) in files {
        let path = dir.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }
    load_from(dir.path())
}

fn load_from(dir: &Path) -> Result<(Scene, Vec<Note>), ImportError> {
    read(&dir.join("scene.obj"), &ReadOptions::default())
}

fn load(obj: &str) -> (Scene, Vec<Note>) {
    try_load(&[("scene.obj", obj.as_bytes())]).unwrap()
}

fn load_with(obj: &str, mtl: &str) -> (Scene, Vec<Note>) {
    try_load(&[("scene.obj", obj.as_bytes()), ("scene.mtl", mtl.as_bytes())]).unwrap()
}

fn error(obj: &str) -> String {
    let e = try_load(&[("scene.obj", obj.as_bytes())]).unwrap_err().to_string();
    e.split_once("scene.obj: ").unwrap().1.to_owned()
}

/// Codes of the notes, in order.
fn codes(notes: &[Note]) -> Vec<&'static str> {
    notes.iter().map(|n| n.code).collect()
}

/// Area of a mesh in double precision.
fn area(mesh: &Mesh) -> f64 {
    let of = |t: &[u32; 3]| {
        let [a, b, c]: [DVec3; 3] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        (b - a).cross(c - a).length() / 2.0
    };
    mesh.triangles.iter().map(of).sum()
}

//! Files become a [`Scene`] and notes.
//!
//! In: a path and [`ReadOptions`]. Out: a scene in this crate's conventions, and a [`Note`] for
//! whatever was ignored, repaired or assumed. A file is untrusted: every count in it is checked in
//! 64-bit arithmetic against the bytes that are there before anything is allocated, no reference
//! leaves the scene's folder, and no input makes a reader panic, recurse without bound, or wait.
//!
//! Winding: a transform of negative determinant is kept as it is, and triangles keep the order of the
//! file. `prepare` flips the winding of such objects, so that the front stays the front.

mod budget;
mod error;
mod file;
mod gltf;
mod names;
mod notes;

use std::path::Path;

use crate::scene::{Note, Scene};

use budget::Budget;
use error::Fault;
pub use error::ImportError;

/// How to read a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// What the intensities of glTF's punctual lights mean.
    pub light_units: LightUnits,
    /// Most triangles that a file may hold, instances not counted.
    pub max_triangles: u64,
    /// Most bytes that a file, with the files it names and what is decoded from them, may take.
    pub max_bytes: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { light_units: LightUnits::Auto, max_triangles: 1 << 28, max_bytes: 4 << 30 }
    }
}

/// What the intensities of glTF's punctual lights mean; the modes of Blender's exporter by name.
///
/// Watts out: the exporter multiplies by 683 lm/W in its standard mode, and a path tracer that also
/// renders emissive materials has to undo that, since those are written without it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LightUnits {
    /// `BlenderSpec` where the generator is Blender's exporter, else `Unitless`.
    #[default]
    Auto,
    /// Candela and lux at 683 lm/W ("Standard", the exporter's default): divided by 683.
    BlenderSpec,
    /// W/sr and W/m^2, as is ("Unitless").
    Unitless,
    /// Point and spot lights in watts over the whole sphere, divided by 4 pi; suns as is ("Raw").
    Raw,
}

/// Reads the scene in the file at `path`, by its content and suffix.
///
/// # Errors
/// A file that cannot be read, contradicts its format, or needs what is not supported; the error names
/// the file, the place in it, what was found and what was expected.
pub fn read(path: &Path, options: &ReadOptions) -> Result<(Scene, Vec<Note>), ImportError> {
    read_file(path, options).map_err(|fault| fault.at(path))
}

fn read_file(path: &Path, options: &ReadOptions) -> Result<(Scene, Vec<Note>), Fault> {
    let suffix = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let mut budget = Budget::new(options);
    let folder = path.parent().unwrap_or(Path::new(""));
    let known = ["gltf", "glb", "json", "toml"].contains(&&*suffix);
    let bytes = file::read_regular(path, &mut budget)?;
    if bytes.starts_with(gltf::GLB_MAGIC) || suffix == "glb" {
        return gltf::read_glb(&bytes, folder, options, &mut budget);
    }
    if !known {
        return Err(Fault::Unsupported {
            place: "suffix".into(),
            feature: if suffix.is_empty() { "a file without a suffix".into() } else { format!(".{suffix}") },
            help: "readable are .gltf and .glb (glTF 2.0), and .toml and .json with the key `epsilux`".into(),
        });
    }
    if suffix == "gltf" {
        return gltf::read_json(&bytes, folder, options, &mut budget);
    }
    Err(Fault::Unsupported {
        place: "suffix".into(),
        feature: format!("the text form in .{suffix}"),
        help: "convert it to glTF".into(),
    })
}

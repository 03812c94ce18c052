//! A [`Scene`] becomes files of other formats, and notes.
//!
//! In: a scene that [`crate::scene::validate`] has passed. Out: files in memory, and a [`Note`] for
//! whatever the format cannot hold; a caller that refuses notes has then written nothing. `convert`
//! is [`crate::import::read`] followed by [`encode`] and [`write()`].

mod files;
mod gltf;
mod obj;
mod text;

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::output::write_bytes;
use crate::scene::text::Syntax;
use crate::scene::{Note, Scene};

/// What a scene can be written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// epsilux's own text form as TOML.
    Toml,
    /// The same as JSON.
    Json,
    /// glTF 2.0 as JSON, with its buffer and pictures beside it.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
    /// Wavefront OBJ, with materials, and a sidecar for what it cannot say.
    Obj,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Toml, Self::Json, Self::Gltf, Self::Glb, Self::Obj];

    /// Suffix without its dot.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Toml => "toml",
            Self::Json => "json",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Obj => "obj",
        }
    }

    /// The format that a path's suffix asks for, in any case.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let suffix = path.extension()?.to_str()?;
        Self::ALL.into_iter().find(|f| f.suffix().eq_ignore_ascii_case(suffix))
    }
}

/// A file that belongs to a converted scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutFile {
    /// Relative to the folder of the scene, with `/` between folders.
    pub path: String,
    /// All of it.
    pub bytes: Vec<u8>,
}

/// A converted scene in memory.
#[derive(Clone, Debug, Default)]
pub struct Encoded {
    /// The scene's own file comes last, so that it never names files that are not there.
    pub files: Vec<OutFile>,
    /// What the format cannot hold.
    pub notes: Vec<Note>,
}

/// Why a converted scene was not written.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The file system said no.
    #[error("{}: cannot be written: {source}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What was said.
        source: io::Error,
    },
    /// A picture is none.
    #[error("the picture \"{name}\" cannot be written: {reason}")]
    Picture {
        /// Its name.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The format cannot hold so much.
    #[error("{name}: the scene needs more than 4 GiB, which a GLB file cannot hold; write .gltf instead")]
    TooLarge {
        /// The file.
        name: String,
    },
}

/// Converts a scene; `name` is the file name that it will have, on which the names of other files are
/// based.
///
/// # Errors
/// See [`ExportError`].
pub fn encode(scene: &Scene, format: Format, name: &str) -> Result<Encoded, ExportError> {
    match format {
        Format::Toml => text::encode(scene, Syntax::Toml, name),
        Format::Json => text::encode(scene, Syntax::Json, name),
        Format::Gltf => gltf::encode(scene, name, false),
        Format::Glb => gltf::encode(scene, name, true),
        Format::Obj => obj::encode(scene, name),
    }
}

/// Writes the files below `folder`, each whole or not at all.
///
/// # Errors
/// Where the file system says no; files written before stay.
pub fn write(files: &[OutFile], folder: &Path) -> Result<(), ExportError> {
    for file in files {
        let path = folder.join(&file.path);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)
                .map_err(|source| ExportError::Write { path: parent.to_path_buf(), source })?;
        }
        write_bytes(&path, &file.bytes)
            .map_err(|source| ExportError::Write { path: path.clone(), source })?;
    }
    Ok(())
}

//! A [`Scene`] becomes files of other formats, and notes.
//!
//! In: a scene that [`crate::scene::validate`] has passed. Out: files in memory, and a [`Note`] for
//! whatever the format cannot hold; a caller that refuses notes has then written nothing. `convert`
//! is [`crate::import::read`] followed by [`encode`] and [`write`].

mod gltf;

use std::io;
use std::path::{Path, PathBuf};

use crate::output::write_bytes;
use crate::scene::{Note, Scene, text};

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
}

impl Format {
    /// The format that a path's suffix asks for.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match &*path.extension()?.to_string_lossy().to_ascii_lowercase() {
            "toml" => Some(Self::Toml),
            "json" => Some(Self::Json),
            "gltf" => Some(Self::Gltf),
            "glb" => Some(Self::Glb),
            _ => None,
        }
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
    let own = |bytes: String| Encoded {
        files: vec![OutFile { path: name.to_owned(), bytes: bytes.into_bytes() }],
        notes: Vec::new(),
    };
    Ok(match format {
        Format::Toml => own(text::to_toml(scene)),
        Format::Json => own(text::to_json(scene)),
        Format::Gltf => gltf::encode(scene, name, false)?,
        Format::Glb => gltf::encode(scene, name, true)?,
    })
}

/// Writes the files below `folder`, each whole or not at all.
///
/// # Errors
/// Where the file system says no; files written before stay.
pub fn write(files: &[OutFile], folder: &Path) -> Result<(), ExportError> {
    for file in files {
        let path = folder.join(&file.path);
        write_bytes(&path, &file.bytes)
            .map_err(|source| ExportError::Write { path: path.clone(), source })?;
    }
    Ok(())
}

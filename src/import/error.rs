//! Why a file could not be read: the file system, an invalid file, or an unsupported feature.

use std::path::{Path, PathBuf};

use crate::scene::text::TextError;

/// Why a file could not be read. Each variant is somebody else's turn: the caller's (`File`), the
/// author's of the file (`Invalid`, `Text`), or ours (`Unsupported`).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImportError {
    /// The file system has no such file, or does not let us read it.
    #[error("{}: {reason}", path.display())]
    File {
        /// The file that was to be read.
        path: PathBuf,
        /// What stood in the way, as a clause.
        reason: String,
    },
    /// The file contradicts its format.
    #[error("{}: {place}: found {found}, expected {expected}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Path inside the file, such as `accessors[3].bufferView`, or a line and column.
        place: String,
        /// What is there.
        found: String,
        /// What the format asks for.
        expected: String,
    },
    /// The text form of a scene has a mistake.
    #[error("{}: {error}", path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// What is wrong, and which part of `text` it is about.
        error: Box<TextError>,
        /// The content of the file, to show that part of.
        text: String,
    },
    /// The file is well formed and needs something that is not implemented, or allowed by the limits.
    #[error("{}: {place}: {feature} is not supported; {help}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Path inside the file.
        place: String,
        /// What it needs.
        feature: String,
        /// What the user can do about it.
        help: String,
    },
}

/// An [`ImportError`] that does not know its file yet: what the readers below `read` return.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// Becomes [`ImportError::File`]; the path may be another file than the one that named it.
    File { path: PathBuf, reason: String },
    /// Becomes [`ImportError::Invalid`].
    Invalid { place: String, found: String, expected: String },
    /// Becomes [`ImportError::Text`].
    Text { error: Box<TextError>, text: String },
    /// Becomes [`ImportError::Unsupported`].
    Unsupported { place: String, feature: String, help: String },
    /// About another file than the one that is read, which it names itself.
    Elsewhere(Box<ImportError>),
}

impl Fault {
    /// The file contradicts its format.
    pub(crate) fn invalid(
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Invalid { place: place.into(), found: found.into(), expected: expected.into() }
    }

    /// What is wrong, as part of a note; files are named from `folder`.
    pub(crate) fn reason(&self, folder: &Path) -> String {
        match self {
            Self::File { path, reason } => {
                format!("{}: {reason}", path.strip_prefix(folder).unwrap_or(path).display())
            }
            Self::Invalid { place, .. } | Self::Unsupported { place, .. } => {
                format!("{place}: {}", self.clause())
            }
            Self::Text { .. } | Self::Elsewhere(_) => self.clause(),
        }
    }

    /// What is wrong, as a clause, for whoever says the place in a way of their own.
    pub(crate) fn clause(&self) -> String {
        match self {
            Self::File { path, reason } => format!("{}: {reason}", path.display()),
            Self::Invalid { found, expected, .. } => format!("found {found}, expected {expected}"),
            Self::Text { error, .. } => error.to_string(),
            Self::Unsupported { feature, help, .. } => format!("{feature} is not supported; {help}"),
            Self::Elsewhere(error) => error.to_string(),
        }
    }

    /// Names the file.
    pub(crate) fn at(self, file: &Path) -> ImportError {
        match self {
            Self::File { path, reason } => ImportError::File { path, reason },
            Self::Invalid { place, found, expected } => {
                ImportError::Invalid { path: file.into(), place, found, expected }
            }
            Self::Text { error, text } => ImportError::Text { path: file.into(), error, text },
            Self::Unsupported { place, feature, help } => {
                ImportError::Unsupported { path: file.into(), place, feature, help }
            }
            Self::Elsewhere(error) => *error,
        }
    }
}

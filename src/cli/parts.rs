//! Files of parts: reading one, and a checkpoint with its former generation.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use crate::output;
use crate::part::{Part, PartError};

/// A part from a file.
pub(super) fn read(path: &Path) -> Result<Part, Failure> {
    let bytes = std::fs::read(path).map_err(|e| Failure::load(format!("{}: {e}", path.display())))?;
    Part::from_bytes(&bytes).map_err(|e| {
        let failure = Failure::load(format!("{}: {e}", path.display()));
        match e {
            PartError::NotAPart => failure.help("`render --passes A..B --checkpoint FILE` writes parts"),
            PartError::Damaged => failure.help("render its passes again"),
            _ => failure,
        }
    })
}

/// Writes a part; an older file of the name is whole until the new one is.
pub(super) fn write(path: &Path, part: &Part) -> Result<(), Failure> {
    output::write_bytes(path, &part.to_bytes())
        .map_err(|e| Failure::write(format!("{}: {e}", path.display())))
}

/// A checkpoint: a part that grows, with the generation before it as FILE.old.
pub(super) struct Checkpoint {
    path: PathBuf,
    former: PathBuf,
}

/// What a checkpoint holds, and what was wrong with the newer generation where the older one was taken.
pub(super) struct Found {
    pub(super) part: Part,
    pub(super) warning: Option<String>,
}

impl Checkpoint {
    pub(super) fn new(path: &Path) -> Self {
        let mut former = path.as_os_str().to_owned();
        former.push(".old");
        Self { path: path.to_owned(), former: former.into() }
    }

    /// Where it is kept.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// What was saved, where there is anything.
    pub(super) fn read(&self) -> Result<Option<Found>, Failure> {
        // Between the two renames of a write only the former generation has a name.
        match (self.path.exists(), self.former.exists()) {
            (false, false) => return Ok(None),
            (false, true) => return Ok(Some(Found { part: read(&self.former)?, warning: None })),
            (true, _) => {}
        }
        let bytes =
            std::fs::read(&self.path).map_err(|e| Failure::load(format!("{}: {e}", self.path.display())))?;
        match Part::from_bytes(&bytes) {
            Ok(part) => Ok(Some(Found { part, warning: None })),
            // Only what was a checkpoint once may be replaced by one.
            Err(e @ PartError::NotAPart) => Err(Failure::load(format!("{}: {e}", self.path.display()))
                .help("the file would be overwritten; name another one")),
            Err(e) if self.former.exists() => {
                let warning =
                    format!("{}: {e}; going on from {}", self.path.display(), self.former.display());
                Ok(Some(Found { part: read(&self.former)?, warning: Some(warning) }))
            }
            Err(e) => {
                Err(Failure::load(format!("{}: {e}", self.path.display()))
                    .help("remove the file to begin anew"))
            }
        }
    }

    /// Saves a part; what was saved before becomes the former generation.
    pub(super) fn write(&self, part: &Part) -> Result<(), Failure> {
        let failed = |e: std::io::Error| Failure::write(format!("{}: {e}", self.path.display()));
        // The new file is whole under a name of its own before the old one moves.
        let mut next = self.path.as_os_str().to_owned();
        next.push(".new");
        let next = PathBuf::from(next);
        output::write_bytes(&next, &part.to_bytes()).map_err(failed)?;
        if self.path.exists() {
            std::fs::rename(&self.path, &self.former).map_err(failed)?;
        }
        std::fs::rename(&next, &self.path).map_err(failed)
    }
}

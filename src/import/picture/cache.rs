//! Pictures by where they lie: each is read and decoded once, and shared by whoever names it.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::super::budget::Budget;
use super::super::error::Fault;
use super::super::file;
use super::{Decoded, decode};
use crate::scene::notes::Notes;
use crate::scene::{Encoded, Image, ImageId, NoteEffect};

/// The pictures of one scene, in the order in which they were asked for.
///
/// A picture that is missing or broken is a fault each time that it is named, and read only once; whether
/// that ends the reading or becomes a note is the caller's decision.
pub(crate) struct Pictures {
    folder: PathBuf,
    images: Vec<Image>,
    /// By canonical path.
    by_file: HashMap<PathBuf, Result<ImageId, Fault>>,
    /// By hash of the encoded bytes: exporters embed the same picture again and again.
    by_bytes: HashMap<u64, Vec<ImageId>>,
}

impl Pictures {
    /// None yet; `folder` is where the scene's file lies.
    pub(crate) fn new(folder: &Path) -> Self {
        let folder = folder.to_path_buf();
        Self { folder, images: Vec::new(), by_file: HashMap::new(), by_bytes: HashMap::new() }
    }

    /// The picture that the relative URI `uri` names, with %-escapes; it has to lie below the scene's folder.
    pub(crate) fn uri(
        &mut self,
        uri: &str,
        place: &str,
        budget: &mut Budget,
        notes: &mut Notes,
    ) -> Result<ImageId, Fault> {
        let relative = file::relative(uri, place)?;
        self.file(&relative, place, budget, notes)
    }

    /// The picture in the file `relative`, a path from the scene's folder with `/` between names, which
    /// must not lead outside.
    pub(crate) fn file(
        &mut self,
        relative: &str,
        place: &str,
        budget: &mut Budget,
        notes: &mut Notes,
    ) -> Result<ImageId, Fault> {
        let path = file::below(&self.folder, relative, place)?;
        let key = path.canonicalize().unwrap_or_else(|_| path.clone());
        if let Some(known) = self.by_file.get(&key) {
            return known.clone();
        }
        let result = self.read(&path, relative, place, budget, notes);
        self.by_file.insert(key, result.clone());
        result
    }

    fn read(
        &mut self,
        path: &Path,
        relative: &str,
        place: &str,
        budget: &mut Budget,
        notes: &mut Notes,
    ) -> Result<ImageId, Fault> {
        let bytes = file::read_named(path, place, budget)?;
        let place = format!("{place}: {relative}");
        let decoded = decode(&bytes, &place, budget)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Ok(self.push(&name, Some(file::tidy(relative)), bytes.into(), decoded, &place, notes))
    }

    /// The picture in `bytes`, which the scene's file holds itself.
    pub(crate) fn embedded(
        &mut self,
        name: &str,
        bytes: &[u8],
        place: &str,
        budget: &mut Budget,
        notes: &mut Notes,
    ) -> Result<ImageId, Fault> {
        let mut hasher = DefaultHasher::new();
        bytes.hash(&mut hasher);
        let hash = hasher.finish();
        let encoded = |id: &&ImageId| self.images[id.0 as usize].encoded.as_ref();
        let same = |id: &&ImageId| encoded(id).is_some_and(|e| *e.bytes == *bytes);
        if let Some(&id) = self.by_bytes.get(&hash).and_then(|ids| ids.iter().find(same)) {
            return Ok(id);
        }
        let decoded = decode(bytes, place, budget)?;
        budget.charge_bytes(bytes.len() as u64, 1, place)?;
        let id = self.push(name, None, bytes.into(), decoded, place, notes);
        self.by_bytes.entry(hash).or_default().push(id);
        Ok(id)
    }

    fn push(
        &mut self,
        name: &str,
        file: Option<String>,
        bytes: Arc<[u8]>,
        decoded: Decoded,
        place: &str,
        notes: &mut Notes,
    ) -> ImageId {
        if decoded.repaired > 0 {
            let message = format!(
                "{} texels are negative or not finite: taken as the nearest that a picture can have",
                decoded.repaired
            );
            notes.add("texels-repaired", NoteEffect::Differs, place, message);
        }
        let id = ImageId(self.images.len() as u32);
        self.images.push(Image {
            name: name.to_owned(),
            file,
            encoded: Some(Encoded { format: decoded.format, bytes }),
            pixels: Some(Arc::new(decoded.pixels)),
        });
        id
    }

    /// What has been decoded so far: an id is an index into it.
    pub(crate) fn images(&self) -> &[Image] {
        &self.images
    }

    /// All pictures, for [`crate::scene::Scene::images`].
    pub(crate) fn finish(self) -> Vec<Image> {
        self.images
    }
}

//! The files beside a converted scene: pictures, each once, under names that every system can hold.
//!
//! In: the pictures of a scene. Out: files in a folder of their own, and for each picture the path that
//! the scene's file names. A picture that came from a file is copied byte for byte; one that was made in
//! memory becomes PNG or OpenEXR, which lose nothing.

use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

use super::{ExportError, OutFile};
use crate::output::encode_pixels;
use crate::scene::{Encoded, Image, Pixels};

/// The longest name of a picture's file, without folder and suffix.
const LONGEST: usize = 60;

/// The pictures of one scene, as files.
pub(super) struct PictureFiles {
    /// In order of first use.
    pub(super) files: Vec<OutFile>,
    /// For each picture of the scene where it lies, from the scene's folder.
    pub(super) paths: Vec<String>,
}

/// Puts every picture of `images` into the folder `STEM.images`.
pub(super) fn pictures(images: &[Image], stem: &str) -> Result<PictureFiles, ExportError> {
    let mut names = FileNames::default();
    let mut found = PictureFiles { files: Vec::new(), paths: Vec::new() };
    for (i, image) in images.iter().enumerate() {
        if let Some(same) = images[..i].iter().position(|other| is_same(other, image)) {
            found.paths.push(found.paths[same].clone());
            continue;
        }
        let encoded = match (&image.encoded, &image.pixels) {
            (Some(Encoded { format, bytes }), _) => Ok((*format, bytes.to_vec())),
            (None, Some(pixels)) => encode_pixels(pixels),
            (None, None) => Err("it has not been read".to_owned()),
        };
        let (format, bytes) =
            encoded.map_err(|reason| ExportError::Picture { name: image.name.clone(), reason })?;
        let wanted = image.file.as_deref().map_or(&*image.name, stem_of);
        let path = format!("{stem}.images/{}", names.unique(wanted, format.suffix()));
        found.files.push(OutFile { path: path.clone(), bytes });
        found.paths.push(path);
    }
    Ok(found)
}

/// Whether two pictures would be the same file. (Their names may differ.)
fn is_same(a: &Image, b: &Image) -> bool {
    match (&a.encoded, &b.encoded) {
        (Some(a), Some(b)) => a.format == b.format && (Arc::ptr_eq(&a.bytes, &b.bytes) || a == b),
        (None, None) => {
            let shared = |a: &Arc<Pixels>, b: &Arc<Pixels>| Arc::ptr_eq(a, b);
            a.pixels.as_ref().zip(b.pixels.as_ref()).is_some_and(|(a, b)| shared(a, b))
        }
        _ => false,
    }
}

/// A file's name without folders and suffix.
pub(super) fn stem_of(file: &str) -> &str {
    let name = file.rsplit('/').next().unwrap_or(file);
    Path::new(name).file_stem().and_then(|s| s.to_str()).unwrap_or(name)
}

/// Names of files, unique even where case does not count.
#[derive(Default)]
struct FileNames(HashSet<String>);

impl FileNames {
    /// A name like `wanted`, of letters, digits, `-` and `_`.
    fn unique(&mut self, wanted: &str, suffix: &str) -> String {
        let safe = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
        let base: String = wanted.chars().take(LONGEST).map(safe).collect();
        // Names without a letter help nobody, and Windows reserves some short ones for devices.
        let device = ["con", "prn", "aux", "nul"].contains(&&*base.to_ascii_lowercase())
            || (base.len() == 4
                && ["com", "lpt"].iter().any(|d| base.to_ascii_lowercase().starts_with(d))
                && base.ends_with(|c: char| c.is_ascii_digit()));
        let base = if device || !base.contains(|c: char| c.is_ascii_alphanumeric()) {
            format!("picture{}{base}", if base.is_empty() { "" } else { "_" })
        } else {
            base
        };
        let mut name = base.clone();
        let mut number = 1;
        while !self.0.insert(format!("{name}.{suffix}").to_ascii_lowercase()) {
            number += 1;
            name = format!("{base}_{number}");
        }
        format!("{name}.{suffix}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ImageFormat, Texels};

    fn image(name: &str, file: Option<&str>, encoded: Option<&[u8]>) -> Image {
        let texels = Texels::Byte(vec![[1, 2, 3, 255]]);
        Image {
            name: name.into(),
            file: file.map(str::to_owned),
            encoded: encoded.map(|b| Encoded { format: ImageFormat::Jpeg, bytes: b.into() }),
            pixels: Some(Arc::new(Pixels { width: 1, height: 1, texels })),
        }
    }

    /// Each picture has one file; names are unique without regard to case, and free of what systems refuse.
    #[test]
    fn pictures_get_safe_unique_names() {
        let images = [
            image("Wood", Some("../a b/Wood.PNG"), Some(b"one")),
            image("wood", Some("wood.jpg"), Some(b"two")),
            image("other name", Some("elsewhere.jpg"), Some(b"one")),
            image("../../etc/passwd", None, None),
            image("CON", None, None),
            image("", None, None),
            image("äöü", None, None),
        ];
        let found = pictures(&images, "my scene").unwrap();
        let expected = [
            "my scene.images/Wood.jpg",
            "my scene.images/wood_2.jpg",
            "my scene.images/Wood.jpg",
            "my scene.images/______etc_passwd.png",
            "my scene.images/picture_CON.png",
            "my scene.images/picture.png",
            "my scene.images/picture____.png",
        ];
        assert_eq!(found.paths, expected);
        assert_eq!(found.files.len(), 6);
        assert_eq!(found.files[0].bytes, b"one", "what was in the file is copied as it is");
        assert!(found.files[2].bytes.starts_with(b"\x89PNG"));
        let unread = Image { pixels: None, ..image("unread", Some("x.png"), None) };
        let said = pictures(&[unread], "s").err().unwrap().to_string();
        assert_eq!(said, "the picture \"unread\" cannot be written: it has not been read");
    }
}

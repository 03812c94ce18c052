//! The text form of a scene, TOML or JSON, read from a file together with its pictures.

use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::budget::Budget;
use super::error::Fault;
use super::picture::Pictures;
use crate::scene::notes::Notes;
use crate::scene::text::{self, Syntax};
use crate::scene::{Note, Scene};

/// Parses the text in `bytes`. Its pictures lie below `folder`; one that is missing or broken is a mistake
/// in the text, on the line that names it.
pub(super) fn read(
    bytes: Vec<u8>,
    syntax: Syntax,
    folder: &Path,
    budget: &mut Budget,
) -> Result<(Scene, Vec<Note>), Fault> {
    let text = utf8(bytes)?;
    let (mut pictures, mut notes) = (Pictures::new(folder), Notes::default());
    let parsed = text::parse_with(&text, syntax, &mut |image, place| {
        let file = image.file.as_deref().unwrap_or_default();
        let id = pictures.file(file, place, budget, &mut notes).map_err(|fault| match fault {
            Fault::File { .. } => fault.clause(),
            _ => format!("{file}: {}", fault.clause().replace(", or a data: URI", "")),
        })?;
        let read = &pictures.images()[id.0 as usize];
        (image.encoded, image.pixels) = (read.encoded.clone(), read.pixels.clone());
        Ok(())
    });
    let (scene, found) = parsed.map_err(|error| Fault::Text { error: Box::new(error), text })?;
    let mut notes = notes.finish();
    notes.extend(found);
    Ok((scene, notes))
}

/// True for JSON that is glTF by its keys: `asset` and not `epsilux`.
pub(super) fn is_gltf(bytes: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct Keys {
        asset: Option<IgnoredAny>,
        epsilux: Option<IgnoredAny>,
    }
    serde_json::from_slice::<Keys>(bytes).is_ok_and(|k| k.asset.is_some() && k.epsilux.is_none())
}

fn utf8(bytes: Vec<u8>) -> Result<String, Fault> {
    String::from_utf8(bytes).map_err(|e| {
        let place = format!("byte {}", e.utf8_error().valid_up_to());
        Fault::invalid(place, "an invalid sequence", "UTF-8")
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::import::ReadOptions;
    use crate::scene::{ImageId, MaterialKind, Texels};

    /// A folder with `wood.png`, one grey pixel, and what reading this TOML beside it says.
    fn read_beside_wood(toml: &str) -> Result<Scene, String> {
        let dir = tempfile::tempdir().unwrap();
        let mut png = Vec::new();
        let mut encoder = png::Encoder::new(&mut png, 1, 1);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.write_header().unwrap().write_image_data(&[7]).unwrap();
        fs::create_dir(dir.path().join("scene")).unwrap();
        fs::write(dir.path().join("scene/wood.png"), &png).unwrap();
        fs::write(dir.path().join("scene/cut.png"), &png[..png.len() - 20]).unwrap();
        fs::write(dir.path().join("scene/note.png"), "a note").unwrap();
        fs::write(dir.path().join("secret.png"), &png).unwrap();
        let mut budget = Budget::new(&ReadOptions::default());
        let text = format!("epsilux = 1\n{toml}\n").into_bytes();
        let result = read(text, Syntax::Toml, &dir.path().join("scene"), &mut budget);
        let dir = dir.path().to_string_lossy().into_owned();
        result.map(|(scene, _)| scene).map_err(|fault| fault.clause().replace(&dir, "DIR"))
    }

    /// Each picture is decoded once, keeps its bytes, and its own name where the text gives it one.
    #[test]
    fn pictures_are_read_with_the_text() {
        let scene = read_beside_wood(
            "image.a = \"wood.png\"
            image.b = { file = \"./wood.png\", name = \"oak\" }
            material.m = { principled = { base_color_texture = \"b\", coat_texture = { file = \"wood.png\" } } }",
        )
        .unwrap();
        let names: Vec<&str> = scene.images.iter().map(|i| i.name.as_str()).collect();
        assert_eq!(names, ["a", "oak"], "a file that is named in a slot is the picture that has it already");
        for image in &scene.images {
            assert_eq!(image.pixels.as_ref().unwrap().texels, Texels::Byte(vec![[7, 7, 7, 255]]));
            assert!(image.encoded.as_ref().unwrap().bytes.starts_with(b"\x89PNG"));
        }
        let MaterialKind::Principled(p) = &scene.materials[0].kind else { panic!() };
        assert_eq!(p.textures.base_color.unwrap().image, ImageId(1));
        assert_eq!(p.textures.coat.unwrap().texture.image, ImageId(0));
    }

    /// A picture that cannot be had is a mistake in the text: its line, what was found, what was expected.
    #[test]
    fn pictures_that_cannot_be_read_name_their_line() {
        let cases = [
            "[image]\nwood = \"wood.jpg\"",
            "[image.wood]\nname = \"x\"\nfile = \"note.png\"",
            "[image]\nwood = \"cut.png\"",
            "[image]\nwood = \"../secret.png\"",
            "[environment]\nimage = { file = \"sky.hdr\" }",
            "[material.m.principled]\nnormal_texture = { file = \"bumps.png\", strength = 2 }",
        ];
        let said: String = cases.map(|toml| read_beside_wood(toml).unwrap_err() + "\n").concat();
        insta::assert_snapshot!(said);
    }
}

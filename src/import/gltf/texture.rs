//! glTF textures: a picture, a sampler, and how they lie on the surface.
//!
//! In: texture infos of materials. Out: [`Texture`]s whose pictures are decoded once each. What is wrong
//! with the document (an index out of range, a view that overruns) is a fault; what is wrong with a picture
//! is a note, and the material goes without. Source: glTF 2.0, section 3.8, `KHR_texture_transform`,
//! `EXT_texture_webp`.

use std::path::Path;

use gltf::json;
use json::extensions::texture::TextureTransform;
use json::texture::{MagFilter, MinFilter, WrappingMode};
use json::validation::Checked;
use serde_json::{Map, Value};

use super::super::error::Fault;
use super::super::file;
use super::super::picture::Pictures;
use super::accessor::{Reader, get};
use super::document::Document;
use crate::scene::notes::Notes;
use crate::scene::{Filter, Image, ImageId, NoteEffect, Texture, Wrap};

/// The largest offset, scale and angle that a texture may have.
const MAX_UV: f32 = 1e6;
/// What stands for "no source" in the `gltf` crate's type.
const NO_SOURCE: usize = u32::MAX as usize;

/// Which texture, and how it lies: what the texture infos of all slots have in common.
pub(super) struct Info {
    index: usize,
    uv_set: u32,
    transform: TextureTransform,
}

impl From<&json::texture::Info> for Info {
    fn from(info: &json::texture::Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone());
        Self { index: info.index.value(), uv_set: info.tex_coord, transform: transform.unwrap_or_default() }
    }
}

impl Info {
    /// The info of a normal texture, whose transform the crate leaves as it is.
    pub(super) fn of_normal(info: &json::material::NormalTexture, place: &str) -> Result<Self, Fault> {
        let none = Map::new();
        let others = info.extensions.as_ref().map_or(&none, |e| &e.others);
        let transform = extension(others, "KHR_texture_transform", place)?.unwrap_or_default();
        Ok(Self { index: info.index.value(), uv_set: info.tex_coord, transform })
    }
}

/// The extension `name` among those that the crate does not know.
pub(super) fn extension<T: serde::de::DeserializeOwned>(
    others: &Map<String, Value>,
    name: &str,
    place: &str,
) -> Result<Option<T>, Fault> {
    let Some(value) = others.get(name) else { return Ok(None) };
    serde_json::from_value(value.clone()).map(Some).map_err(|e| {
        let found = format!("a fault ({e})");
        Fault::invalid(format!("{place}.extensions.{name}"), found, "what the extension defines")
    })
}

/// Reads the textures of one document.
pub(super) struct Textures<'d> {
    doc: &'d Document,
    folder: &'d Path,
    pictures: Pictures,
    /// By index into the document's images: the picture, or why there is none.
    known: Vec<Option<Result<ImageId, String>>>,
}

impl<'d> Textures<'d> {
    /// Nothing is read yet; `folder` is where the pictures lie that the document names.
    pub(super) fn new(doc: &'d Document, folder: &'d Path) -> Self {
        Self { doc, folder, pictures: Pictures::new(folder), known: vec![None; doc.images.len()] }
    }

    /// The pictures that textures use, for the scene.
    pub(super) fn finish(self) -> Vec<Image> {
        self.pictures.finish()
    }

    /// The picture in the file that `uri` names, which the document does not list, or why there is none.
    pub(super) fn file(
        &mut self,
        uri: &str,
        place: &str,
        reader: &mut Reader<'_>,
        notes: &mut Notes,
    ) -> Result<ImageId, String> {
        let found = self.pictures.uri(uri, place, reader.budget, notes);
        found.map_err(|fault| fault.reason(self.folder))
    }

    /// The texture of a slot at `place`; `None`, with a note, where it has no picture.
    pub(super) fn get(
        &mut self,
        info: &Info,
        place: &str,
        reader: &mut Reader<'_>,
        notes: &mut Notes,
    ) -> Result<Option<Texture>, Fault> {
        let texture = get(&self.doc.textures, info.index, &format!("{place}.index"))?;
        let sampler = match texture.sampler {
            Some(i) => {
                let sampler_place = format!("textures[{}].sampler", info.index);
                Some(get(&self.doc.samplers, i.value(), &sampler_place)?)
            }
            None => None,
        };
        let image = match self.picture(info.index, texture, reader, notes)? {
            Ok(image) => image,
            Err(reason) => {
                let message = format!("the texture is left out: {reason}");
                notes.add("texture-missing", NoteEffect::Missing, place, message);
                return Ok(None);
            }
        };
        let uv_set = info.transform.tex_coord.unwrap_or(info.uv_set);
        if uv_set > 1 {
            let message =
                format!("the texture is left out: it lies on TEXCOORD_{uv_set}, and 0 and 1 are read");
            notes.add("texture-missing", NoteEffect::Missing, place, message);
            return Ok(None);
        }
        if sampler.is_some_and(is_odd) {
            let message = "an unknown mode: the picture repeats, and is filtered linearly";
            let place = format!("textures[{}].sampler", info.index);
            notes.add("sampler-repaired", NoteEffect::Differs, place, message);
        }
        let mut clamp = |key: &str, v: f32| {
            if v.abs() <= MAX_UV {
                return v;
            }
            let good = v.clamp(-MAX_UV, MAX_UV);
            let place = format!("{place}.extensions.KHR_texture_transform.{key}");
            notes.add("value-clamped", NoteEffect::Differs, place, format!("{v:?}: taken as {good:?}"));
            good
        };
        let transform = &info.transform;
        Ok(Some(Texture {
            image,
            uv_set: uv_set as u8,
            offset: transform.offset.0.map(|v| clamp("offset", v)),
            rotation: clamp("rotation", transform.rotation.0),
            scale: transform.scale.0.map(|v| clamp("scale", v)),
            wrap: sampler.map_or([Wrap::Repeat; 2], |s| [wrap(s.wrap_s), wrap(s.wrap_t)]),
            filter: sampler.map_or(Filter::Linear, filter),
        }))
    }

    /// The first picture of `texture` that can be used, or why there is none.
    fn picture(
        &mut self,
        index: usize,
        texture: &json::Texture,
        reader: &mut Reader<'_>,
        notes: &mut Notes,
    ) -> Result<Result<ImageId, String>, Fault> {
        let place = format!("textures[{index}]");
        let none = Map::new();
        let others = texture.extensions.as_ref().map_or(&none, |e| &e.others);
        let webp = match others.get("EXT_texture_webp").and_then(|e| e.get("source")) {
            None => None,
            Some(source) => Some(source.as_u64().ok_or_else(|| {
                let place = format!("{place}.extensions.EXT_texture_webp.source");
                Fault::invalid(place, source.to_string(), "an index")
            })? as usize),
        };
        let plain = Some(texture.source.value()).filter(|&i| i != NO_SOURCE);
        let mut reason = match others.keys().find(|k| *k != "EXT_texture_webp") {
            Some(name) => format!("{place} has only a picture that is not read ({name})"),
            None => format!("{place} has no picture"),
        };
        for (source, key) in [(webp, "extensions.EXT_texture_webp.source"), (plain, "source")] {
            let Some(source) = source else { continue };
            match self.image(source, &format!("{place}.{key}"), reader, notes)? {
                Ok(id) => return Ok(Ok(id)),
                Err(found) => reason = found,
            }
        }
        Ok(Err(reason))
    }

    /// The picture at `index` of the document's images, or why there is none; `place` names it.
    pub(super) fn image(
        &mut self,
        index: usize,
        place: &str,
        reader: &mut Reader<'_>,
        notes: &mut Notes,
    ) -> Result<Result<ImageId, String>, Fault> {
        let image = get(&self.doc.images, index, place)?;
        if let Some(known) = &self.known[index] {
            return Ok(known.clone());
        }
        let place = format!("images[{index}]");
        let name = image.name.clone().unwrap_or_else(|| format!("image {index}"));
        let pictures = &mut self.pictures;
        let result = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                let place = format!("{place}.uri");
                match file::data_uri(uri, &place) {
                    Some(bytes) => {
                        bytes.and_then(|b| pictures.embedded(&name, &b, &place, reader.budget, notes))
                    }
                    None => pictures.uri(uri, &place, reader.budget, notes),
                }
            }
            (None, Some(view)) => {
                let bytes = reader.view(view.value(), &format!("{place}.bufferView"))?.to_vec();
                // The same bytes may be asked for again and again.
                reader.budget.charge_bytes(bytes.len() as u64, 1, &place)?;
                pictures.embedded(&name, &bytes, &place, reader.budget, notes)
            }
            (None, None) => Err(Fault::invalid(place, "neither a uri nor a bufferView", "one of them")),
        };
        let result = result.map_err(|fault| fault.reason(self.folder));
        self.known[index] = Some(result.clone());
        Ok(result)
    }
}

/// Whether a sampler has a mode that glTF does not define.
fn is_odd(sampler: &json::texture::Sampler) -> bool {
    matches!(sampler.wrap_s, Checked::Invalid)
        || matches!(sampler.wrap_t, Checked::Invalid)
        || matches!(sampler.mag_filter, Some(Checked::Invalid))
        || matches!(sampler.min_filter, Some(Checked::Invalid))
}

/// An unknown mode repeats, as the default does.
fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}

/// What a picture looks like from near decides; without, the first word of what it does from afar.
fn filter(sampler: &json::texture::Sampler) -> Filter {
    let near = |filter| match filter {
        MinFilter::Nearest | MinFilter::NearestMipmapNearest | MinFilter::NearestMipmapLinear => {
            Filter::Nearest
        }
        MinFilter::Linear | MinFilter::LinearMipmapNearest | MinFilter::LinearMipmapLinear => Filter::Linear,
    };
    match (sampler.mag_filter, sampler.min_filter) {
        (Some(Checked::Valid(MagFilter::Nearest)), _) => Filter::Nearest,
        (Some(Checked::Valid(MagFilter::Linear)), _) => Filter::Linear,
        (_, Some(Checked::Valid(min))) => near(min),
        _ => Filter::Linear,
    }
}

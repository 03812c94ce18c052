//! Textures and pictures.
//!
//! In: textures of the scene. Out: texture infos. A picture in a format that glTF knows is copied byte
//! for byte. glTF fixes which channel of a picture is what; a scene does not, so where its channels
//! differ a new picture is put together from them.

use std::collections::HashMap;

use serde_json::{Map, Value, json};

use super::number::single;
use super::{Document, OutFile, put, stem, uri};
use crate::color::linear_to_srgb;
use crate::output::encode_pixels;
use crate::scene::{
    AlphaMode, Channel, Filter, Image, ImageFormat, ImageId, NormalTexture, NoteEffect, Pixels, Principled,
    ScalarTexture, Texels, Texture, Wrap,
};

/// What has been written.
#[derive(Default)]
pub(super) struct Pictures {
    /// Pictures beside the file.
    pub(super) files: Vec<OutFile>,
    images: Vec<Value>,
    textures: Vec<Value>,
    samplers: Vec<Value>,
    /// Images by what they are made of: of one, four times the same.
    known: HashMap<[Source; 4], Option<(usize, ImageFormat)>>,
    names: std::collections::HashSet<String>,
}

/// Where a channel of a picture comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Source {
    /// Everywhere one.
    One,
    /// A channel of a picture of the scene.
    Of(ImageId, Channel),
}

/// The channels in order.
const RGBA: [Channel; 4] = [Channel::R, Channel::G, Channel::B, Channel::A];

impl Pictures {
    /// Adds the lists to the document, and returns the files.
    pub(super) fn finish(self, root: &mut Map<String, Value>) -> Vec<OutFile> {
        put(root, "images", self.images);
        put(root, "textures", self.textures);
        put(root, "samplers", self.samplers);
        self.files
    }
}

impl Document<'_> {
    /// Writes the textures of a material into its entry, which has its extensions already.
    pub(super) fn textures(&mut self, p: &Principled, entry: &mut Map<String, Value>, place: &str) {
        let t = &p.textures;
        if t.is_empty() {
            return;
        }
        let base = self.base(p, place);
        let both = self.metallic_roughness(p, place);
        let normal = self.normal(t.normal.as_ref());
        let emission = t.emission.as_ref().and_then(|t| self.whole(t, place));
        let mut own = |name: &str, key: &str, value: Option<Value>| {
            let Some(value) = value else { return };
            match name {
                "" => _ = entry.insert(key.into(), value),
                "pbrMetallicRoughness" => entry.entry(name).or_insert_with(|| json!({}))[key] = value,
                _ => entry.entry("extensions").or_insert_with(|| json!({}))[name][key] = value,
            }
        };
        own("pbrMetallicRoughness", "baseColorTexture", base);
        own("pbrMetallicRoughness", "metallicRoughnessTexture", both);
        own("", "normalTexture", normal);
        own("", "emissiveTexture", emission);
        let specular = self.scalar(t.specular.as_ref(), Channel::A, place);
        let specular_color = t.specular_color.as_ref().and_then(|t| self.whole(t, place));
        let transmission = self.scalar(t.transmission.as_ref(), Channel::R, place);
        let coat = self.scalar(t.coat.as_ref(), Channel::R, place);
        let coat_roughness = self.scalar(t.coat_roughness.as_ref(), Channel::G, place);
        let coat_normal = self.normal(t.coat_normal.as_ref());
        let sheen_color = t.sheen_color.as_ref().and_then(|t| self.whole(t, place));
        let sheen_roughness = self.scalar(t.sheen_roughness.as_ref(), Channel::A, place);
        let list = [
            ("KHR_materials_specular", "specularTexture", specular),
            ("KHR_materials_specular", "specularColorTexture", specular_color),
            ("KHR_materials_transmission", "transmissionTexture", transmission),
            ("KHR_materials_clearcoat", "clearcoatTexture", coat),
            ("KHR_materials_clearcoat", "clearcoatRoughnessTexture", coat_roughness),
            ("KHR_materials_clearcoat", "clearcoatNormalTexture", coat_normal),
            ("KHR_materials_sheen", "sheenColorTexture", sheen_color),
            ("KHR_materials_sheen", "sheenRoughnessTexture", sheen_roughness),
        ];
        for (name, key, value) in list {
            if value.is_some() {
                self.using(name);
            }
            let Some(value) = value else { continue };
            entry.entry("extensions").or_insert_with(|| json!({}))[name][key] = value;
        }
    }

    /// Base colour, with alpha where the alpha mode looks at it.
    fn base(&mut self, p: &Principled, place: &str) -> Option<Value> {
        let alpha = p.textures.alpha.filter(|_| p.alpha_mode != AlphaMode::Opaque);
        let (layout, alpha) = match (p.textures.base_color, alpha) {
            (None, None) => return None,
            (Some(base), Some(alpha)) if !alike(&base, &alpha.texture) => {
                self.lost("alpha", "it lies differently from that of the base colour", place);
                (base, None)
            }
            (Some(base), alpha) => (base, alpha),
            (None, Some(alpha)) => (alpha.texture, Some(alpha)),
        };
        let color = |channel| p.textures.base_color.map_or(Source::One, |t| Source::Of(t.image, channel));
        let alpha = match alpha {
            Some(a) => Source::Of(a.texture.image, a.channel),
            // Nobody looks.
            None if p.alpha_mode == AlphaMode::Opaque => color(Channel::A),
            None => Source::One,
        };
        let sources = [color(Channel::R), color(Channel::G), color(Channel::B), alpha];
        self.info(&layout, sources, place)
    }

    /// Roughness in green, metallic in blue.
    fn metallic_roughness(&mut self, p: &Principled, place: &str) -> Option<Value> {
        let (roughness, mut metallic) = (p.textures.roughness, p.textures.metallic);
        let layout = roughness.or(metallic)?.texture;
        if metallic.is_some_and(|m| !alike(&layout, &m.texture)) {
            self.lost("metallic", "it lies differently from that of the roughness", place);
            metallic = None;
        }
        let of = |t: Option<ScalarTexture>| t.map_or(Source::One, |t| Source::Of(t.texture.image, t.channel));
        let (green, mut blue) = (of(roughness), of(metallic));
        if let (Source::One, Source::Of(image, _), 0.0) = (blue, green, p.metallic) {
            // Of no effect, and the picture can stay as it is.
            blue = Source::Of(image, Channel::B);
        }
        let sources = match (green, blue) {
            (Source::Of(a, Channel::G), Source::Of(b, Channel::B)) if a == b => {
                RGBA.map(|c| Source::Of(a, c))
            }
            _ => [Source::One, green, blue, Source::One],
        };
        self.info(&layout, sources, place)
    }

    /// All channels of a picture as they are.
    fn whole(&mut self, t: &Texture, place: &str) -> Option<Value> {
        self.info(t, RGBA.map(|c| Source::Of(t.image, c)), place)
    }

    /// One channel, in the place where glTF wants it.
    fn scalar(&mut self, t: Option<&ScalarTexture>, wanted: Channel, place: &str) -> Option<Value> {
        let t = t?;
        let image = t.texture.image;
        let sources = if self.is_same(image, t.channel, wanted) {
            RGBA.map(|c| Source::Of(image, c))
        } else {
            RGBA.map(|c| if c == wanted { Source::Of(image, t.channel) } else { Source::One })
        };
        self.info(&t.texture, sources, place)
    }

    fn normal(&mut self, t: Option<&NormalTexture>) -> Option<Value> {
        let t = t?;
        let mut info = self.whole(&t.texture, "")?;
        if t.scale != 1.0 {
            info["scale"] = single(t.scale).into();
        }
        Some(info)
    }

    /// Whether two channels of a picture hold the same.
    fn is_same(&self, image: ImageId, a: Channel, b: Channel) -> bool {
        if a == b {
            return true;
        }
        let (a, b) = (position(a), position(b));
        match self.scene.images.get(image.0 as usize).and_then(|i| i.pixels.as_deref()).map(|p| &p.texels) {
            Some(Texels::Byte(t)) => t.iter().all(|t| t[a] == t[b]),
            Some(Texels::Short(t)) => t.iter().all(|t| t[a] == t[b]),
            _ => false,
        }
    }

    /// The info of a texture that lies as `layout` says.
    fn info(&mut self, layout: &Texture, sources: [Source; 4], place: &str) -> Option<Value> {
        let (image, format) = self.picture(sources, place)?;
        let mut texture = json!({});
        if format == ImageFormat::Webp {
            let name = self.using("EXT_texture_webp");
            self.required.insert(name);
            texture["extensions"] = json!({ name: { "source": image } });
        } else {
            texture["source"] = image.into();
        }
        if layout.wrap != [Wrap::Repeat; 2] || layout.filter != Filter::Linear {
            let [s, t] = layout.wrap.map(|w| match w {
                Wrap::Repeat => 10497,
                Wrap::Mirror => 33648,
                Wrap::Clamp => 33071,
            });
            let (near, far) = if layout.filter == Filter::Nearest { (9728, 9984) } else { (9729, 9987) };
            let sampler = json!({ "magFilter": near, "minFilter": far, "wrapS": s, "wrapT": t });
            texture["sampler"] = insert(&mut self.pictures.samplers, sampler).into();
        }
        let mut info = json!({ "index": insert(&mut self.pictures.textures, texture) });
        if layout.uv_set != 0 {
            info["texCoord"] = layout.uv_set.into();
        }
        let mut transform = Map::new();
        if layout.offset != [0.0; 2] {
            transform.insert("offset".into(), json!(layout.offset.map(single)));
        }
        if layout.rotation != 0.0 {
            transform.insert("rotation".into(), single(layout.rotation).into());
        }
        if layout.scale != [1.0; 2] {
            transform.insert("scale".into(), json!(layout.scale.map(single)));
        }
        if !transform.is_empty() {
            let name = self.using("KHR_texture_transform");
            info["extensions"] = json!({ name: transform });
        }
        Some(info)
    }

    /// The picture that has these channels: an index into the document's images, and its format.
    fn picture(&mut self, sources: [Source; 4], place: &str) -> Option<(usize, ImageFormat)> {
        if let Some(&known) = self.pictures.known.get(&sources) {
            return known;
        }
        let written = self.make(sources, place);
        self.pictures.known.insert(sources, written);
        written
    }

    fn make(&mut self, sources: [Source; 4], place: &str) -> Option<(usize, ImageFormat)> {
        let first = sources.iter().find_map(|s| match s {
            Source::Of(id, _) => Some(*id),
            Source::One => None,
        })?;
        let scene = self.scene;
        let image = scene.images.get(first.0 as usize)?;
        // Where only alpha is to be one, and is, the picture itself will do.
        let is_one = |c: usize| match image.pixels.as_deref().map(|p| &p.texels) {
            Some(Texels::Byte(t)) => t.iter().all(|t| t[c] == u8::MAX),
            Some(Texels::Short(t)) => t.iter().all(|t| t[c] == u16::MAX),
            _ => true,
        };
        let is_whole = (0..4).all(|c| match sources[c] {
            Source::Of(id, channel) => id == first && self.is_same(id, channel, RGBA[c]),
            Source::One => is_one(c),
        });
        if is_whole
            && let Some(e) = &image.encoded
            && matches!(e.format, ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Webp)
        {
            return Some((self.add(image, e.format, &e.bytes), e.format));
        }
        let pixels = match self.compose(sources) {
            Ok(pixels) => pixels,
            Err(reason) => {
                self.lost("texture", &reason, place);
                return None;
            }
        };
        match encode_pixels(&pixels) {
            Ok((format, bytes)) => Some((self.add(image, format, &bytes), format)),
            Err(reason) => {
                self.lost("texture", &reason, place);
                None
            }
        }
    }

    /// Puts a picture together, of pictures of one size.
    fn compose(&mut self, sources: [Source; 4]) -> Result<Pixels, String> {
        let mut size: Option<(u32, u32)> = None;
        let mut is_short = false;
        let mut lists: HashMap<ImageId, Vec<[u16; 4]>> = HashMap::new();
        for source in sources {
            let Source::Of(id, _) = source else { continue };
            let image = self.scene.images.get(id.0 as usize).and_then(|i| i.pixels.as_deref());
            let pixels = image.ok_or("a picture that is not there")?;
            let own = (pixels.width, pixels.height);
            if *size.get_or_insert(own) != own {
                return Err("its channels are pictures of different sizes, which glTF wants in one".into());
            }
            is_short |= matches!(pixels.texels, Texels::Short(_));
            if lists.contains_key(&id) {
                continue;
            }
            let list = match &pixels.texels {
                Texels::Byte(t) => t.iter().map(|t| t.map(|v| u16::from(v) * 257)).collect(),
                Texels::Short(t) => t.clone(),
                Texels::Float(t) => {
                    let message = "a picture of floats is written as sRGB: what is above one is cut";
                    self.notes.add(
                        "texture-clipped",
                        NoteEffect::Differs,
                        format!("images[{}]", id.0),
                        message,
                    );
                    let encode = |t: &[f32; 3]| {
                        let [r, g, b] = t.map(|v| (linear_to_srgb(v.min(1.0)) * 65535.0).round() as u16);
                        [r, g, b, u16::MAX]
                    };
                    t.iter().map(encode).collect()
                }
            };
            lists.insert(id, list);
        }
        let (width, height) = size.ok_or("a picture without a source")?;
        let texel = |i: usize| {
            sources.map(|source| match source {
                Source::One => u16::MAX,
                Source::Of(id, channel) => lists[&id][i][position(channel)],
            })
        };
        let count = width as usize * height as usize;
        let texels = if is_short {
            Texels::Short((0..count).map(texel).collect())
        } else {
            Texels::Byte((0..count).map(|i| texel(i).map(|v| (v / 257) as u8)).collect())
        };
        Ok(Pixels { width, height, texels })
    }

    /// Adds a picture to the document.
    fn add(&mut self, image: &Image, format: ImageFormat, bytes: &[u8]) -> usize {
        let mut entry = json!({});
        if !image.name.is_empty() {
            entry["name"] = image.name.as_str().into();
        }
        if self.binary {
            entry["bufferView"] = self.buffer.view(bytes, None).into();
            entry["mimeType"] = match format {
                ImageFormat::Jpeg => "image/jpeg",
                ImageFormat::Webp => "image/webp",
                _ => "image/png",
            }
            .into();
        } else {
            entry["uri"] = uri(&self.beside(image, format, bytes)).into();
        }
        self.pictures.images.push(entry);
        self.pictures.images.len() - 1
    }

    /// Writes a picture into a file of its own, and returns its path.
    fn beside(&mut self, image: &Image, format: ImageFormat, bytes: &[u8]) -> String {
        let own = image.file.as_deref().and_then(|f| f.rsplit('/').next()).map_or(&*image.name, stem);
        let plain: String =
            own.chars().map(|c| if c.is_alphanumeric() || "-_. ".contains(c) { c } else { '_' }).collect();
        let prefix = format!("{}-", stem(self.name));
        let base = if plain.starts_with(&prefix) { plain } else { format!("{prefix}{plain}") };
        let mut path = format!("{base}.{}", format.suffix());
        for number in 2.. {
            if self.pictures.names.insert(path.clone()) {
                break;
            }
            path = format!("{base}.{number}.{}", format.suffix());
        }
        self.pictures.files.push(OutFile { path: path.clone(), bytes: bytes.to_vec() });
        path
    }

    /// The picture of the environment: an index, or a path where glTF does not know its format.
    pub(super) fn sky(&mut self, id: ImageId) -> Option<(Option<usize>, Option<String>)> {
        let image = self.scene.images.get(id.0 as usize)?;
        let in_memory;
        let (format, bytes) = match &image.encoded {
            Some(e) => (e.format, &*e.bytes),
            None => {
                in_memory = encode_pixels(image.pixels.as_deref()?).ok()?;
                (in_memory.0, &*in_memory.1)
            }
        };
        if matches!(format, ImageFormat::Png | ImageFormat::Jpeg) {
            let index = self.picture(RGBA.map(|c| Source::Of(id, c)), "environment.image")?.0;
            return Some((Some(index), None));
        }
        let path = self.beside(image, format, bytes);
        Some((None, Some(uri(&path))))
    }

    fn lost(&mut self, what: &str, why: &str, place: &str) {
        let message = format!("the {what} texture is left out: {why}");
        self.notes.add("texture-lost", NoteEffect::Missing, place, message);
    }
}

/// Whether two textures lie in the same way.
fn alike(a: &Texture, b: &Texture) -> bool {
    Texture { image: a.image, ..*b } == *a
}

fn position(channel: Channel) -> usize {
    match channel {
        Channel::R => 0,
        Channel::G => 1,
        Channel::B => 2,
        Channel::A => 3,
    }
}

/// The index of `entry` in `list`, added where it is not there.
fn insert(list: &mut Vec<Value>, entry: Value) -> usize {
    list.iter().position(|e| *e == entry).unwrap_or_else(|| {
        list.push(entry);
        list.len() - 1
    })
}

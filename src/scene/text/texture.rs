//! Pictures and textures of a file become those of the scene.
//!
//! In: the table `image`, and the keys `SLOT_texture` of principled materials. Out: [`Image`]s that know
//! their file and not yet their pixels, each with its place in the text, and [`Textures`]. A picture may
//! be named, or given by its file where it is used; equal files are then one picture.

use std::collections::HashMap;

use super::error::{Fault, TextErrorKind};
use super::model::{FileTable, ImageTable, PrincipledTable, TextureTable};
use super::names::AlphaWord;
use super::place::Place;
use super::value::NameOr;
use crate::scene::{
    AlphaMode, Channel, Image, ImageId, NormalTexture, ScalarTexture, Texture, Textures, Wrap,
};

/// The pictures of a file.
#[derive(Default)]
pub(super) struct Pictures {
    pub(super) images: Vec<Image>,
    /// Where each is named in the text.
    pub(super) places: Vec<Place>,
    names: HashMap<String, ImageId>,
    files: HashMap<String, ImageId>,
}

impl Pictures {
    /// Adds an entry of the table `image`.
    pub(super) fn define(&mut self, key: String, entry: NameOr<ImageTable>) -> Result<(), Fault> {
        let place = Place::top("image").key(&key);
        let (name, file, place) = match entry {
            NameOr::Name(file) => (None, file, place),
            NameOr::Inline(table) => (table.name, table.file, place.key("file")),
        };
        let id = self.add(name.unwrap_or_else(|| key.clone()), file, place)?;
        self.names.insert(key, id);
        Ok(())
    }

    /// The picture of an environment.
    pub(super) fn of_environment(
        &mut self,
        given: NameOr<FileTable>,
        place: &Place,
    ) -> Result<ImageId, Fault> {
        match given {
            NameOr::Name(name) => self.named(&name, place.clone()),
            NameOr::Inline(FileTable { file }) => self.file(file, place.key("file")),
        }
    }

    fn add(&mut self, name: String, file: String, place: Place) -> Result<ImageId, Fault> {
        if file.is_empty() {
            let fault = Fault::new(TextErrorKind::Picture, place, "the name of the picture's file is empty");
            return Err(fault.expecting("a file below the scene's folder, such as `wood.png`"));
        }
        let id = ImageId(self.images.len() as u32);
        self.files.entry(file.clone()).or_insert(id);
        self.images.push(Image { name, file: Some(file), encoded: None, pixels: None });
        self.places.push(place);
        Ok(id)
    }

    fn file(&mut self, file: String, place: Place) -> Result<ImageId, Fault> {
        match self.files.get(&file) {
            Some(&id) => Ok(id),
            None => self.add(stem(&file).to_owned(), file, place),
        }
    }

    fn named(&self, name: &str, place: Place) -> Result<ImageId, Fault> {
        self.names.get(name).copied().ok_or_else(|| {
            let mut names: Vec<&str> = self.names.keys().map(String::as_str).collect();
            names.sort_unstable();
            let mut fault = Fault::unknown_name(place, "image", name, &names);
            // Whoever writes a file's name here has not seen that pictures have names.
            if fault.nearest.is_none() && name.contains('.') {
                fault.expected =
                    Some(format!("the name of an image; for a file write {{ file = \"{name}\" }}"));
            }
            fault
        })
    }

    /// The textures of a principled material at `place`.
    pub(super) fn textures(&mut self, p: &PrincipledTable, place: &Place) -> Result<Textures, Fault> {
        let mut slot = |key: &str, given: &Option<NameOr<TextureTable>>, kind: Kind| {
            let place = place.key(&format!("{key}_texture"));
            given.as_ref().map(|given| self.texture(given, kind, &place)).transpose()
        };
        let color = |found: Option<Found>| found.map(|f| f.texture);
        let scalar =
            |found: Option<Found>| found.map(|f| ScalarTexture { texture: f.texture, channel: f.channel });
        let normal =
            |found: Option<Found>| found.map(|f| NormalTexture { texture: f.texture, scale: f.strength });
        let number = Kind::Number(Channel::R);
        Ok(Textures {
            base_color: color(slot("base_color", &p.base_color_texture, Kind::Color)?),
            alpha: scalar(slot("alpha", &p.alpha_texture, Kind::Number(Channel::A))?),
            metallic: scalar(slot("metallic", &p.metallic_texture, number)?),
            roughness: scalar(slot("roughness", &p.roughness_texture, number)?),
            normal: normal(slot("normal", &p.normal_texture, Kind::Normal)?),
            emission: color(slot("emission", &p.emission_texture, Kind::Color)?),
            specular: scalar(slot("specular", &p.specular_texture, number)?),
            specular_color: color(slot("specular_color", &p.specular_color_texture, Kind::Color)?),
            transmission: scalar(slot("transmission", &p.transmission_texture, number)?),
            coat: scalar(slot("coat", &p.coat_texture, number)?),
            coat_roughness: scalar(slot("coat_roughness", &p.coat_roughness_texture, number)?),
            coat_normal: normal(slot("coat_normal", &p.coat_normal_texture, Kind::Normal)?),
            sheen_color: color(slot("sheen_color", &p.sheen_color_texture, Kind::Color)?),
            sheen_roughness: scalar(slot("sheen_roughness", &p.sheen_roughness_texture, number)?),
        })
    }

    fn texture(&mut self, given: &NameOr<TextureTable>, kind: Kind, place: &Place) -> Result<Found, Fault> {
        let default = match kind {
            Kind::Number(channel) => channel,
            Kind::Color | Kind::Normal => Channel::R,
        };
        let table = match given {
            NameOr::Inline(table) => table,
            NameOr::Name(name) => {
                let texture = Texture::new(self.named(name, place.clone())?);
                return Ok(Found { texture, channel: default, strength: 1.0 });
            }
        };
        let image = match (&table.image, &table.file) {
            (Some(name), None) => self.named(name, place.key("image"))?,
            (None, Some(file)) => self.file(file.clone(), place.key("file"))?,
            (Some(_), Some(_)) => {
                let fault = Fault::value(place.key("file"), "a texture with both `image` and `file`");
                return Err(fault.expecting("one of them"));
            }
            (None, None) => {
                let fault =
                    Fault::new(TextErrorKind::MissingKey, place.clone(), "a texture without a picture");
                return Err(fault.expecting("`image` or `file`"));
            }
        };
        if table.channel.is_some() && !matches!(kind, Kind::Number(_)) {
            let message = "`channel` chooses a number out of a picture, and this slot takes a whole colour";
            return Err(Fault::value(place.key("channel"), message));
        }
        if table.strength.is_some() && !matches!(kind, Kind::Normal) {
            return Err(Fault::value(place.key("strength"), "`strength` is that of a normal map"));
        }
        let texture = Texture {
            image,
            uv_set: table.uv_set,
            offset: table.offset.unwrap_or_default(),
            rotation: table.rotation.map_or(0.0, |a| a.radians as f32),
            scale: table.scale.map_or([1.0; 2], |s| s.0),
            wrap: table.wrap.map_or([Wrap::default(); 2], |w| w.0.map(|w| w.0)),
            filter: table.filter.0,
        };
        let channel = table.channel.map_or(default, |c| c.0);
        Ok(Found { texture, channel, strength: table.strength.unwrap_or(1.0) })
    }
}

/// What a slot takes from a picture.
#[derive(Clone, Copy)]
enum Kind {
    Color,
    /// One channel; this one where none is given.
    Number(Channel),
    Normal,
}

struct Found {
    texture: Texture,
    channel: Channel,
    strength: f32,
}

/// What alpha does, from the three keys about it.
pub(super) fn alpha_mode(p: &PrincipledTable, place: &Place) -> Result<AlphaMode, Fault> {
    let word = p.alpha_mode.map_or_else(
        || match (p.cutoff, p.alpha.is_some() || p.alpha_texture.is_some()) {
            (Some(_), _) => AlphaWord::Mask,
            (None, true) => AlphaWord::Blend,
            (None, false) => AlphaWord::Opaque,
        },
        |w| w.0,
    );
    match (word, p.cutoff) {
        (AlphaWord::Mask, cutoff) => Ok(AlphaMode::Mask { cutoff: cutoff.unwrap_or(0.5) }),
        (_, Some(_)) => {
            let message = "`cutoff` belongs to `alpha_mode = \"mask\"`, and this is another mode";
            Err(Fault::value(place.key("cutoff"), message))
        }
        (AlphaWord::Opaque, None) => Ok(AlphaMode::Opaque),
        (AlphaWord::Blend, None) => Ok(AlphaMode::Blend),
    }
}

/// A file's name without folders and suffix.
fn stem(file: &str) -> &str {
    let name = file.rsplit('/').next().unwrap_or(file);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

//! A map statement of an MTL file becomes a texture.
//!
//! In: what stands behind the keyword: options, and a file name that may hold blanks. Out: a [`Texture`]
//! over a picture that was decoded once, or a note. Placement: the format scales texture coordinates by
//! `-s` and then moves them by `-o`, with v running up; the scene's v runs down, so that v' = s v + o
//! becomes v' = s v + (1 - s - o).

use super::super::budget::Budget;
use super::super::error::Fault;
use super::super::picture::Pictures;
use super::lines::words;
use super::log::{Log, quoted};
use super::mtl::Source;
use crate::scene::{Channel, ImageId, NoteEffect, Texels, Texture, Wrap};

/// Beyond this a single has no digits left for the place within a picture.
const MAX_UV: f32 = 1e6;

/// A map statement, taken apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// As written, with `/` between folders.
    pub(super) file: String,
    /// `-s`, u and v.
    pub(super) scale: [f32; 2],
    /// `-o`, u and v.
    pub(super) offset: [f32; 2],
    /// `-bm`.
    pub(super) strength: Option<f32>,
    /// `-imfchan`: one of `r g b m l z`.
    pub(super) channel: Option<char>,
    /// `-clamp on`.
    pub(super) clamp: bool,
    /// Options that are not followed, as written.
    pub(super) ignored: Vec<String>,
}

/// Options, and the most values that follow each.
const OPTIONS: [(&str, usize); 14] = [
    ("-blendu", 1),
    ("-blendv", 1),
    ("-boost", 1),
    ("-bm", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-colorspace", 1),
    ("-imfchan", 1),
    ("-mm", 2),
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-texres", 1),
    ("-type", 1),
];

/// Takes a map statement apart. Options stand before the name; some programs write them behind it.
pub(super) fn parse_map(text: &str) -> Map {
    let mut map = Map {
        file: String::new(),
        scale: [1.0; 2],
        offset: [0.0; 2],
        strength: None,
        channel: None,
        clamp: false,
        ignored: Vec::new(),
    };
    let rest = options(text, &mut map);
    // From the first option behind the name on.
    let mut name = rest;
    for (at, _) in rest.match_indices(" -") {
        let word = words(&rest[at..]).next().unwrap_or_default();
        if OPTIONS.iter().any(|(o, _)| *o == word) {
            name = &rest[..at];
            options(&format!("{} x", &rest[at..]), &mut map);
            break;
        }
    }
    map.file = name.trim().trim_matches('"').replace('\\', "/");
    map
}

/// Reads options from the beginning, and returns what is left; the last word is never a value.
fn options<'t>(text: &'t str, map: &mut Map) -> &'t str {
    let mut rest = text.trim_start();
    loop {
        let Some((option, most)) = OPTIONS.into_iter().find(|(o, _)| words(rest).next() == Some(o)) else {
            return rest;
        };
        let mut after = rest[option.len()..].trim_start();
        let mut values = Vec::new();
        while values.len() < most {
            let Some(word) = words(after).next() else { break };
            let is_last = word.len() == after.trim_end().len();
            let is_value = !matches!(option, "-mm" | "-o" | "-s" | "-t") || word.parse::<f32>().is_ok();
            if is_last || !is_value {
                break;
            }
            values.push(word);
            after = after[word.len()..].trim_start();
        }
        let number = |i: usize| -> Option<f32> {
            let v: f32 = values.get(i)?.parse().ok()?;
            (v.abs() <= MAX_UV).then_some(v)
        };
        match option {
            "-s" => map.scale = [number(0).unwrap_or(1.0), number(1).unwrap_or(1.0)],
            "-o" => map.offset = [number(0).unwrap_or(0.0), number(1).unwrap_or(0.0)],
            "-bm" => map.strength = number(0),
            "-clamp" => map.clamp = values.first() == Some(&"on"),
            "-imfchan" => map.channel = values.first().and_then(|v| v.chars().next()),
            // What these ask for is what happens anyway.
            "-blendu" | "-blendv" | "-texres" | "-cc" => {}
            "-mm" if number(0) == Some(0.0) && matches!(number(1), Some(1.0) | None) => {}
            "-t" if values.iter().all(|v| v.parse() == Ok(0.0_f32)) => {}
            _ => map.ignored.push(format!("{option} {}", values.join(" "))),
        }
        // An option at the very end has no name behind it; nor does it move on.
        rest = after;
    }
}

/// Reads pictures for one scene.
pub(super) struct Loader<'a> {
    pub(super) pictures: Pictures,
    pub(super) budget: &'a mut Budget,
}

impl Loader<'_> {
    /// The texture that the statement `key` of `source` describes, and its options.
    pub(super) fn texture(&mut self, source: &Source, key: &str, log: &mut Log) -> Option<(Texture, Map)> {
        let map = parse_map(source.map(key)?);
        let place = source.place(key);
        for option in &map.ignored {
            let message = format!("the option {} of a map is not followed", quoted(option));
            log.add("map-option-ignored", NoteEffect::Differs, &*place, message);
        }
        let image = match self.image(source, &map.file, &place, log) {
            Ok(image) => image,
            Err(fault) => {
                let message =
                    format!("the picture {} of `{key}` {fault}: rendered without it", quoted(&map.file));
                log.add("texture-missing", NoteEffect::Missing, place, message);
                return None;
            }
        };
        let [su, sv] = map.scale;
        let wrap = if map.clamp { [Wrap::Clamp; 2] } else { [Wrap::Repeat; 2] };
        let offset = [map.offset[0], (1.0 - sv - map.offset[1]).clamp(-MAX_UV, MAX_UV)];
        Some((Texture { scale: [su, sv], offset, wrap, ..Texture::new(image) }, map))
    }

    /// The picture in `file`, from the folder of the material library; where it is not there, the file of
    /// that name beside the library or the scene, since paths are often those of another machine.
    fn image(&mut self, source: &Source, file: &str, place: &str, log: &mut Log) -> Result<ImageId, String> {
        let base = file.rsplit('/').next().unwrap_or(file);
        let beside =
            [format!("{}{file}", source.folder), format!("{}{base}", source.folder), base.to_owned()];
        let mut first = None;
        for (i, relative) in beside.iter().enumerate() {
            // A name that begins with `/` is absolute even behind a folder.
            let relative = if i == 0 && file.starts_with('/') { file } else { relative };
            match self.pictures.file(relative, place, self.budget, log.notes()) {
                Ok(image) => {
                    if i > 0 && base != file {
                        let message =
                            "a picture's path leads elsewhere: the file of its name beside the scene is used";
                        log.add("path-shortened", NoteEffect::None, place, message);
                    }
                    return Ok(image);
                }
                Err(fault) => {
                    first.get_or_insert_with(|| reason(&fault));
                }
            }
        }
        Err(first.unwrap_or_default())
    }

    fn texels(&self, image: ImageId) -> Option<&Texels> {
        self.pictures.images().get(image.0 as usize)?.pixels.as_ref().map(|p| &p.texels)
    }

    /// The channel that holds a single number: as the statement says, else alpha where a picture uses it.
    pub(super) fn channel(&self, texture: &Texture, map: &Map, prefer_alpha: bool) -> Channel {
        match map.channel {
            Some('r') => Channel::R,
            Some('g') => Channel::G,
            Some('b') => Channel::B,
            Some('m') => Channel::A,
            None if prefer_alpha && self.uses_alpha(texture.image) => Channel::A,
            _ => Channel::R,
        }
    }

    fn uses_alpha(&self, image: ImageId) -> bool {
        match self.texels(image) {
            Some(Texels::Byte(t)) => t.iter().any(|t| t[3] != u8::MAX),
            Some(Texels::Short(t)) => t.iter().any(|t| t[3] != u16::MAX),
            _ => false,
        }
    }

    /// Whether a picture holds normals: its mean is near the colour of a flat one, (1/2, 1/2, 1). Heights
    /// are grey.
    pub(super) fn is_normal_map(&self, image: ImageId) -> bool {
        let mean = match self.texels(image) {
            Some(Texels::Byte(t)) => mean(t, 255.0),
            Some(Texels::Short(t)) => mean(t, 65535.0),
            _ => return false,
        };
        (mean[0] - 0.5).abs() < 0.2
            && (mean[1] - 0.5).abs() < 0.2
            && mean[2] > mean[0] + 0.15
            && mean[2] > 0.6
    }
}

/// The mean of red, green and blue.
fn mean<T: Copy + Into<f64>>(texels: &[[T; 4]], one: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for t in texels {
        sum.iter_mut().zip(t).for_each(|(s, &v)| *s += v.into());
    }
    sum.map(|s| s / (one * texels.len().max(1) as f64))
}

/// A fault as a clause behind a name.
pub(super) fn reason(fault: &Fault) -> String {
    match fault {
        Fault::File { reason, .. } => {
            let reason = reason.split(" (").next().unwrap_or_default();
            format!("cannot be read ({reason})")
        }
        Fault::Invalid { found, expected, .. } => {
            format!("cannot be read (found {found}, expected {expected})")
        }
        Fault::Unsupported { feature, .. } => format!("cannot be read ({feature} is not supported)"),
        Fault::Text { .. } | Fault::Elsewhere(_) => "cannot be read".to_owned(),
    }
}

//! Statements of an MTL file become materials of the `tobj` crate, with typed values.
//!
//! In: the text of a material library. Out: one [`Source`] for each material. tobj loses every material of a
//! file over one statement that it does not know how to read, so each is checked and written anew before:
//! colours get three numbers, options such as `-halo` go, and what cannot be understood becomes a note. What
//! tobj keeps as text (`unknown_param`) is numbers and maps of programs since; its accessors here type them.
//!
//! Source: "MTL material format (Lightwave, OBJ)", Paul Bourke's copy of Wavefront's text, and the "PBR
//! extension" of clara.io, which Blender writes.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use super::super::budget::Budget;
use super::super::error::Fault;
use super::lines::{Statements, blender_header, words};
use super::log::{Log, quoted};
use crate::scene::NoteEffect;

/// A material as its file has it.
pub(super) struct Source {
    /// As written, trimmed.
    pub(super) name: String,
    /// Version of the Blender that wrote the file, see [`blender_header`].
    pub(super) blender: Option<String>,
    /// Name of the file and its line, for the material itself.
    pub(super) place: String,
    /// Folder of the file from the scene's, with `/` at its end; empty where they are the same.
    pub(super) folder: String,
    material: tobj::Material,
    /// Line of each statement.
    lines: HashMap<&'static str, usize>,
    file: String,
}

/// Statements with a colour.
const COLORS: [&str; 5] = ["Ka", "Kd", "Ks", "Ke", "Tf"];
/// Statements with a number, and the range that makes sense.
const NUMBERS: [(&str, f32, f32); 13] = [
    ("Ns", 0.0, 1e6),
    ("Ni", 0.0, 1e3),
    ("d", 0.0, 1.0),
    ("Tr", 0.0, 1.0),
    ("Pr", 0.0, 1.0),
    ("Pm", 0.0, 1.0),
    // Blender writes four times the weight; its reader divides.
    ("Ps", 0.0, 1e3),
    ("Pc", 0.0, 1e3),
    ("Pcr", 0.0, 1.0),
    ("aniso", -1.0, 1.0),
    ("anisor", -1e3, 1e3),
    ("sharpness", 0.0, 1e6),
    ("illum", 0.0, 255.0),
];
/// Statements with a picture; `map_Bump` is written in several ways.
const MAPS: [(&str, &str); 24] = [
    ("map_ka", "map_Ka"),
    ("map_kd", "map_Kd"),
    ("map_ks", "map_Ks"),
    ("map_ke", "map_Ke"),
    ("map_ns", "map_Ns"),
    ("map_d", "map_d"),
    ("map_opacity", "map_d"),
    ("map_tr", "map_Tr"),
    ("map_bump", "map_Bump"),
    ("bump", "map_Bump"),
    ("norm", "norm"),
    ("map_norm", "norm"),
    ("map_kn", "norm"),
    ("map_pr", "map_Pr"),
    ("map_pm", "map_Pm"),
    ("map_ps", "map_Ps"),
    ("map_pc", "map_Pc"),
    ("map_pcr", "map_Pcr"),
    ("map_tf", "map_Tf"),
    ("map_refl", "map_refl"),
    ("refl", "refl"),
    ("disp", "disp"),
    ("map_disp", "disp"),
    ("decal", "decal"),
];

/// Bytes that a material takes here and in tobj, about.
const MATERIAL_BYTES: u64 = 4096;

/// Whose statements are read.
enum Owner {
    Nobody,
    /// A material that no face uses, or that is defined before.
    Skipped,
    /// The last of the list.
    Last,
}

/// Adds the materials of the library in `file`, a path from the scene's folder, to `sources`: those that
/// are `wanted`, each by its first definition, as the format has it.
pub(super) fn read(
    text: &str,
    file: &str,
    wanted: &HashSet<&str>,
    known: &mut HashMap<String, Source>,
    budget: &mut Budget,
    log: &mut Log,
) -> Result<(), Fault> {
    let blender = blender_header(text).map(str::to_owned);
    let folder = file.rfind('/').map_or("", |at| &file[..=at]);
    let mut sources: Vec<Source> = Vec::new();
    let mut clean = String::new();
    let mut owner = Owner::Nobody;
    let mut names = HashSet::new();
    for statement in Statements::new(text) {
        let place = format!("{file} line {}", statement.line);
        let (keyword, rest) = statement.split();
        if keyword.eq_ignore_ascii_case("newmtl") {
            owner = Owner::Skipped;
            if rest.is_empty() {
                log.add("material-unnamed", NoteEffect::Differs, place, "`newmtl` without a name: left out");
                owner = Owner::Nobody;
            } else if known.contains_key(rest) || names.contains(rest) {
                let message = format!("{} is defined before: the first definition counts", quoted(rest));
                log.add("material-redefined", NoteEffect::None, place, message);
            } else if wanted.contains(rest) {
                budget.charge_bytes(1, MATERIAL_BYTES, &place)?;
                owner = Owner::Last;
                names.insert(rest.to_owned());
                // By number, since tobj trims and joins names in its own way. Writing to a string cannot fail.
                let _ = writeln!(clean, "newmtl {}", sources.len());
                sources.push(Source {
                    name: rest.to_owned(),
                    blender: blender.clone(),
                    place,
                    folder: folder.to_owned(),
                    material: tobj::Material::default(),
                    lines: HashMap::new(),
                    file: file.to_owned(),
                });
            }
            continue;
        }
        let source = match owner {
            Owner::Skipped => continue,
            Owner::Last => sources.last_mut(),
            Owner::Nobody => None,
        };
        let Some(source) = source else {
            let message = "a statement outside any named material: ignored";
            log.add("statement-ignored", NoteEffect::None, place, message);
            continue;
        };
        if let Some((key, value)) = rewrite(keyword, rest, &place, log) {
            source.lines.insert(key, statement.line);
            let _ = writeln!(clean, "{key} {value}");
        }
    }
    // By construction tobj reads the text; if it should not, the materials keep their defaults and say so.
    match tobj::load_mtl_buf(&mut clean.as_bytes()) {
        Ok((materials, _)) if materials.len() == sources.len() => {
            for (source, material) in sources.iter_mut().zip(materials) {
                source.material = material;
            }
        }
        _ => {
            let message = "the material library could not be read: its materials look like default ones";
            log.add("mtllib-unreadable", NoteEffect::Differs, file, message);
        }
    }
    known.extend(sources.into_iter().map(|s| (s.name.clone(), s)));
    Ok(())
}

/// The statement in the form that tobj reads, or nothing and a note.
fn rewrite(keyword: &str, rest: &str, place: &str, log: &mut Log) -> Option<(&'static str, String)> {
    let lower = keyword.to_ascii_lowercase();
    if let Some(key) = COLORS.into_iter().find(|k| k.eq_ignore_ascii_case(keyword)) {
        let list: Option<Vec<f32>> = words(rest).take_while(|w| !w.starts_with('#')).map(number).collect();
        return match list.as_deref() {
            Some([]) | None => {
                let message = format!("`{key} {}` is no colour of one or three numbers", shown(rest));
                ignored(message, place, log)
            }
            // The format: the others are as the first.
            Some([r]) => Some((key, format!("{r:?} {r:?} {r:?}"))),
            Some([r, g]) => Some((key, format!("{r:?} {g:?} {g:?}"))),
            Some([r, g, b, ..]) => Some((key, format!("{r:?} {g:?} {b:?}"))),
        };
    }
    if let Some((key, ..)) = NUMBERS.into_iter().find(|(k, ..)| k.eq_ignore_ascii_case(keyword)) {
        let mut list = words(rest);
        let mut first = list.next().unwrap_or_default();
        if key == "d" && first == "-halo" {
            let message = "`d -halo` depends on the view: taken as `d`";
            log.add("halo-ignored", NoteEffect::Differs, place, message);
            first = list.next().unwrap_or_default();
        }
        return match number(first) {
            // tobj reads it as a byte.
            Some(v) if key == "illum" => Some((key, format!("{}", v.clamp(0.0, 255.0) as u8))),
            Some(v) => Some((key, format!("{v:?}"))),
            None => ignored(format!("`{key} {}` is no number", shown(rest)), place, log),
        };
    }
    if let Some((_, key)) = MAPS.into_iter().find(|(k, _)| *k == lower) {
        if rest.is_empty() {
            return ignored(format!("`{key}` names no picture"), place, log);
        }
        return Some((key, rest.to_owned()));
    }
    let message = format!("unknown statement {}", quoted(keyword));
    log.add("statement-ignored", NoteEffect::None, place, message);
    None
}

fn ignored<T>(what: String, place: &str, log: &mut Log) -> Option<T> {
    log.add("statement-ignored", NoteEffect::Differs, place, format!("{what}: ignored"));
    None
}

/// A number that is one: not NaN, and not beyond what a single holds.
fn number(word: &str) -> Option<f32> {
    word.parse().ok().filter(|v: &f32| v.is_finite())
}

/// The beginning of what stands behind a keyword.
fn shown(rest: &str) -> String {
    rest.chars().take(40).collect()
}

impl Source {
    /// File and line of a statement.
    pub(super) fn place(&self, key: &str) -> String {
        match self.lines.get(key) {
            Some(line) => format!("{} line {line}", self.file),
            None => self.place.clone(),
        }
    }

    /// A colour, as it stands.
    pub(super) fn color(&self, key: &str) -> Option<[f32; 3]> {
        let m = &self.material;
        match key {
            "Ka" => m.ambient,
            "Kd" => m.diffuse,
            "Ks" => m.specular,
            "Ke" => m.emissive,
            _ => {
                let mut list = words(m.unknown_param.get(key)?).map(number);
                Some([list.next()??, list.next()??, list.next()??])
            }
        }
    }

    /// A number within the range that makes sense, with a note where it had to be moved there.
    pub(super) fn number(&self, key: &str, log: &mut Log) -> Option<f32> {
        let m = &self.material;
        let value = match key {
            "Ns" => m.shininess,
            "Ni" => m.optical_density,
            "d" => m.dissolve,
            "illum" => m.illumination_model.map(f32::from),
            _ => number(m.unknown_param.get(key)?),
        }?;
        let (_, low, high) = NUMBERS.into_iter().find(|(k, ..)| *k == key)?;
        let good = value.clamp(low, high);
        if good != value {
            let message = format!("`{key} {value}`: taken as {good}");
            log.add("value-clamped", NoteEffect::Differs, self.place(key), message);
        }
        Some(good)
    }

    /// What stands behind the statement of a picture.
    pub(super) fn map(&self, key: &str) -> Option<&str> {
        let m = &self.material;
        let text = match key {
            "map_Ka" => &m.ambient_texture,
            "map_Kd" => &m.diffuse_texture,
            "map_Ks" => &m.specular_texture,
            "map_Ns" => &m.shininess_texture,
            "map_d" => &m.dissolve_texture,
            "map_Bump" => &m.normal_texture,
            _ => return m.unknown_param.get(key).map(String::as_str),
        };
        text.as_deref()
    }
}

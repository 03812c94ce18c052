//! Statements of an OBJ file become checked lists of vertices and faces.
//!
//! In: the text. Out: [`Parsed`]: finite or marked numbers, absolute indices counted from zero that point
//! at something, and faces that know their section (object and material), smoothing group and line.
//! Whatever is not read is a note; a statement that contradicts the format is an error with its line.
//! Invariant: memory is charged in proportion to what is there; nothing is executed (`csh`, `call`).
//!
//! Source: "Object Files (.obj)", Wavefront Technologies, version 3.0, and what programs made of it since:
//! colours after the coordinates, and names with blanks.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::super::budget::Budget;
use super::super::error::Fault;
use super::lines::{Statement, Statements, words};
use super::log::{Log, line, quoted};
use crate::color::srgb_to_linear;
use crate::scene::NoteEffect;

/// Stands for an index that is not given.
pub(super) const NONE: u32 = u32::MAX;
/// The most vertices of a kind: indices are `u32`, and [`NONE`] is taken.
const MAX_VERTICES: usize = u32::MAX as usize - 1;
/// The most material libraries that one file may name.
pub(super) const MAX_LIBRARIES: usize = 256;

/// A corner of a face: indices of position, texture coordinates and normal, the last two maybe [`NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) v: u32,
    pub(super) vt: u32,
    pub(super) vn: u32,
}

/// A polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Its corners are from here to the next face's `start`.
    pub(super) start: usize,
    /// Index into [`Parsed::sections`].
    pub(super) section: u32,
    /// 0 is flat.
    pub(super) smoothing: u32,
    /// Of its statement.
    pub(super) line: usize,
}

/// What becomes one mesh: the faces of one object with one material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Section {
    /// Of the object, else of the group; empty where the file names neither.
    pub(super) name: String,
    /// Index into [`Parsed::materials`].
    pub(super) material: Option<u32>,
}

/// An OBJ file, checked.
#[derive(Default)]
pub(super) struct Parsed {
    /// Not finite where the file's number is not.
    pub(super) positions: Vec<Vec3>,
    /// Linear; empty, or one for each position.
    pub(super) colors: Vec<Vec3>,
    /// As in the file: v runs up.
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    pub(super) sections: Vec<Section>,
    /// Names that `usemtl` asks for, and the line that did so first.
    pub(super) materials: Vec<(String, usize)>,
    /// What `mtllib` names, one statement after the other, and their lines.
    pub(super) libraries: Vec<(String, usize)>,
}

/// Charges small amounts in large pieces.
struct Meter<'b> {
    budget: &'b mut Budget,
    pending: u64,
}

impl Meter<'_> {
    fn add(&mut self, bytes: usize, statement: &Statement<'_>) -> Result<(), Fault> {
        self.pending += bytes as u64;
        if self.pending >= 1 << 20 {
            self.budget.charge_bytes(self.pending, 1, &line(statement.line))?;
            self.pending = 0;
        }
        Ok(())
    }
}

/// Where in the file the reader is.
#[derive(Default)]
struct State {
    object: String,
    group: String,
    material: Option<u32>,
    smoothing: u32,
    /// Section of the four above; `None` after one of them changed.
    section: Option<u32>,
    known_sections: HashMap<(String, Option<u32>), u32>,
    known_materials: HashMap<String, u32>,
    /// Positions without a colour, where some have one.
    plain: usize,
    /// Whether there was any statement of the format.
    is_obj: bool,
}

/// Reads all statements.
pub(super) fn parse(text: &str, budget: &mut Budget, log: &mut Log) -> Result<Parsed, Fault> {
    let mut parsed = Parsed::default();
    let mut state = State::default();
    let mut meter = Meter { budget, pending: 0 };
    let mut first = None;
    for statement in Statements::new(text) {
        let (keyword, rest) = statement.split();
        parsed.statement(keyword, rest, &statement, &mut state, &mut meter, log)?;
        if first.is_none() {
            first = Some((statement.line, keyword.to_owned()));
        }
    }
    if let (false, Some((number, keyword))) = (state.is_obj, first) {
        let expected = "a statement of OBJ, such as `v` or `f`, somewhere in the file";
        return Err(Fault::invalid(line(number), quoted(&keyword), expected));
    }
    parsed.check_indices()?;
    if !parsed.colors.is_empty() && state.plain > 0 {
        let message = format!("{} vertices have no colour though others do: white", state.plain);
        log.add("vertex-colors-partial", NoteEffect::Differs, "v", message);
    }
    Ok(parsed)
}

impl Parsed {
    fn statement(
        &mut self,
        keyword: &str,
        rest: &str,
        statement: &Statement<'_>,
        state: &mut State,
        meter: &mut Meter<'_>,
        log: &mut Log,
    ) -> Result<(), Fault> {
        let at = || line(statement.line);
        let is_obj = state.is_obj;
        state.is_obj = true;
        match keyword {
            "v" => self.position(rest, statement, state, meter, log)?,
            "vt" => {
                let ([u, v, _], count) = numbers::<3>(rest, statement, "vt")?;
                require(count, 1, statement, "one to three numbers")?;
                push(&mut self.uvs, Vec2::new(u, v), statement, meter)?;
            }
            "vn" => {
                let (n, count) = numbers::<3>(rest, statement, "vn")?;
                require(count, 3, statement, "three numbers")?;
                push(&mut self.normals, Vec3::from(n), statement, meter)?;
            }
            "f" | "fo" => self.face(rest, statement, state, meter, log)?,
            "l" => log.add("lines-ignored", NoteEffect::Missing, at(), "polylines are not rendered"),
            "p" => log.add("points-ignored", NoteEffect::Missing, at(), "points are not rendered"),
            "o" => {
                state.object = rest.to_owned();
                state.group.clear();
                state.section = None;
            }
            "g" => {
                state.group = if matches!(rest, "default" | "off" | "(null)") { "" } else { rest }.to_owned();
                state.section = None;
            }
            "s" => {
                state.smoothing = match rest {
                    "off" | "" => 0,
                    "on" => 1,
                    number => number.parse().unwrap_or(1),
                };
            }
            "usemtl" => {
                state.material = (!rest.is_empty()).then(|| {
                    *state.known_materials.entry(rest.to_owned()).or_insert_with(|| {
                        self.materials.push((rest.to_owned(), statement.line));
                        self.materials.len() as u32 - 1
                    })
                });
                state.section = None;
            }
            "mtllib" => {
                if rest.is_empty() || self.libraries.iter().any(|(l, _)| l == rest) {
                } else if self.libraries.len() < MAX_LIBRARIES {
                    self.libraries.push((rest.to_owned(), statement.line));
                } else {
                    let message =
                        format!("more than {MAX_LIBRARIES} material libraries: the others are not read");
                    log.add("mtllib-ignored", NoteEffect::Missing, at(), message);
                }
            }
            "csh" | "call" => {
                let message = format!("`{keyword}` would run or include another file: never done");
                log.add("command-ignored", NoteEffect::Missing, at(), message);
            }
            "vp" | "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim"
            | "hole" | "scrv" | "sp" | "end" | "con" | "ctech" | "stech" | "bsp" | "bzp" | "cdc" | "cdp"
            | "res" => {
                let message = "free-form curves and surfaces are not rendered";
                log.add("free-form-ignored", NoteEffect::Missing, at(), message);
            }
            "usemap" | "maplib" => {
                let message = format!("`{keyword}` is not read: textures come from the material library");
                log.add("texture-ignored", NoteEffect::Missing, at(), message);
            }
            "mg" | "bevel" | "c_interp" | "d_interp" | "lod" | "shadow_obj" | "trace_obj" => {
                let message = format!("`{keyword}` is not read");
                log.add("statement-ignored", NoteEffect::None, at(), message);
            }
            other => {
                state.is_obj = is_obj;
                let message = format!("unknown statement {}", quoted(other));
                log.add("statement-ignored", NoteEffect::Differs, at(), message);
            }
        }
        Ok(())
    }

    /// `v x y z`, maybe with a weight or a colour behind it.
    fn position(
        &mut self,
        rest: &str,
        statement: &Statement<'_>,
        state: &mut State,
        meter: &mut Meter<'_>,
        log: &mut Log,
    ) -> Result<(), Fault> {
        let (n, count) = numbers::<7>(rest, statement, "v")?;
        require(count, 3, statement, "three numbers, and maybe a weight or a colour")?;
        push(&mut self.positions, Vec3::new(n[0], n[1], n[2]), statement, meter)?;
        // Seven numbers are a colour with alpha, or a weight before a colour: only the first is written.
        let color = match count {
            6 | 7 => Some([n[3], n[4], n[5]]),
            4 if n[3] != 1.0 => {
                let message = "a weight of a vertex belongs to rational curves: ignored";
                log.add("weight-ignored", NoteEffect::None, line(statement.line), message);
                None
            }
            5 => {
                let message = "five numbers for a vertex: the last two are ignored";
                log.add("vertex-repaired", NoteEffect::None, line(statement.line), message);
                None
            }
            _ => None,
        };
        let Some(color) = color else {
            state.plain += 1;
            if !self.colors.is_empty() {
                push(&mut self.colors, Vec3::ONE, statement, meter)?;
            }
            return Ok(());
        };
        if self.colors.is_empty() {
            // Those before it are white.
            let before = self.positions.len() - 1;
            meter.add(before * size_of::<Vec3>(), statement)?;
            self.colors.resize(before, Vec3::ONE);
        }
        let sound = color.iter().all(|c| (0.0..=1.0).contains(c));
        if !sound {
            let message = "a vertex colour outside 0 to 1: clamped";
            log.add("value-clamped", NoteEffect::Differs, line(statement.line), message);
        }
        // What is not a number is black.
        let linear = color.map(|c| if c.is_nan() { 0.0 } else { srgb_to_linear(c.clamp(0.0, 1.0)) });
        push(&mut self.colors, Vec3::from(linear), statement, meter)
    }

    fn face(
        &mut self,
        rest: &str,
        statement: &Statement<'_>,
        state: &mut State,
        meter: &mut Meter<'_>,
        log: &mut Log,
    ) -> Result<(), Fault> {
        let start = self.corners.len();
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        for word in words(rest).take_while(|w| !w.starts_with('#')) {
            let corner = corner(word, counts).map_err(|expected| {
                Fault::invalid(line(statement.line), format!("the corner {}", quoted(word)), expected)
            })?;
            push(&mut self.corners, corner, statement, meter)?;
        }
        if self.corners.len() - start < 3 {
            self.corners.truncate(start);
            let message = "a face of fewer than three corners has no area: dropped";
            log.add("faces-dropped", NoteEffect::None, line(statement.line), message);
            return Ok(());
        }
        let section = match state.section {
            Some(section) => section,
            None => self.section(state, statement, meter)?,
        };
        state.section = Some(section);
        let face = Face { start, section, smoothing: state.smoothing, line: statement.line };
        push(&mut self.faces, face, statement, meter)
    }

    /// The section of the current object, group and material.
    fn section(
        &mut self,
        state: &mut State,
        statement: &Statement<'_>,
        meter: &mut Meter<'_>,
    ) -> Result<u32, Fault> {
        let name = match (&*state.object, &*state.group) {
            ("", group) => group.to_owned(),
            (object, group) if group.is_empty() || group == object => object.to_owned(),
            (object, group) => format!("{object}/{group}"),
        };
        let key = (name, state.material);
        if let Some(&known) = state.known_sections.get(&key) {
            return Ok(known);
        }
        // Its name is held a few times, and it will be a mesh and an object.
        meter.add(1024 + 4 * key.0.len(), statement)?;
        self.sections.push(Section { name: key.0.clone(), material: key.1 });
        let section = self.sections.len() as u32 - 1;
        state.known_sections.insert(key, section);
        Ok(section)
    }

    /// Indices may point forward, so they are checked once everything is read.
    fn check_indices(&self) -> Result<(), Fault> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let within = |index: u32, count: usize| index == NONE || (index as usize) < count;
        let bad = self
            .corners
            .iter()
            .position(|c| !(within(c.v, counts[0]) && within(c.vt, counts[1]) && within(c.vn, counts[2])));
        let Some(bad) = bad else { return Ok(()) };
        let corner = self.corners[bad];
        let face = self.faces.partition_point(|f| f.start <= bad).saturating_sub(1);
        let place = self.faces.get(face).map_or(String::new(), |f| line(f.line));
        let kinds = [(corner.v, "v"), (corner.vt, "vt"), (corner.vn, "vn")];
        let (index, kind, count) = kinds
            .into_iter()
            .zip(counts)
            .find(|&((index, _), count)| !within(index, count))
            .map_or((0, "v", 0), |((index, kind), count)| (index, kind, count));
        let found = format!("an index {} of `{kind}`", u64::from(index) + 1);
        let expected = if count == 0 {
            format!("none, since the file has no `{kind}`")
        } else {
            format!("at most {count}, the number of `{kind}` in the file")
        };
        Err(Fault::invalid(place, found, expected))
    }
}

/// Adds to a list that stays countable by `u32`, and pays for it.
fn push<T>(
    list: &mut Vec<T>,
    value: T,
    statement: &Statement<'_>,
    meter: &mut Meter<'_>,
) -> Result<(), Fault> {
    if list.len() >= MAX_VERTICES {
        return Err(Fault::Unsupported {
            place: line(statement.line),
            feature: "a file of more than 4294967294 vertices, corners or faces".into(),
            help: "split it".into(),
        });
    }
    meter.add(size_of::<T>(), statement)?;
    list.push(value);
    Ok(())
}

/// Up to `N` numbers, and how many there are (those beyond `N` are neither read nor counted).
fn numbers<const N: usize>(
    rest: &str,
    statement: &Statement<'_>,
    keyword: &str,
) -> Result<([f32; N], usize), Fault> {
    let mut list = [0.0; N];
    let mut count = 0;
    for (slot, word) in list.iter_mut().zip(words(rest)) {
        // Some programs write remarks behind the numbers.
        if word.starts_with('#') {
            break;
        }
        *slot = word.parse().map_err(|_| {
            Fault::invalid(line(statement.line), format!("{} after `{keyword}`", quoted(word)), "a number")
        })?;
        count += 1;
    }
    Ok((list, count))
}

fn require(count: usize, least: usize, statement: &Statement<'_>, expected: &str) -> Result<(), Fault> {
    if count >= least {
        return Ok(());
    }
    Err(Fault::invalid(line(statement.line), format!("{count} numbers"), expected))
}

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative ones count back from the vertices read so far.
fn corner(word: &str, counts: [usize; 3]) -> Result<Corner, &'static str> {
    let mut parts = word.split('/');
    let mut indices = [NONE; 3];
    for (slot, count) in indices.iter_mut().zip(counts) {
        let part = parts.next().unwrap_or_default();
        if part.is_empty() {
            continue;
        }
        let number: i64 = part.parse().map_err(|_| "`v`, `v/vt`, `v//vn` or `v/vt/vn` in whole numbers")?;
        let index = match number {
            0 => return Err("indices that count from 1, or back from -1"),
            1.. => number - 1,
            _ => count as i64 + number,
        };
        if index < 0 {
            return Err("a negative index that stays within the vertices before the face");
        }
        *slot = u32::try_from(index).ok().filter(|&i| i != NONE).ok_or("an index below 2^32")?;
    }
    if parts.next().is_some() || indices[0] == NONE {
        return Err("`v`, `v/vt`, `v//vn` or `v/vt/vn` in whole numbers");
    }
    Ok(Corner { v: indices[0], vt: indices[1], vn: indices[2] })
}

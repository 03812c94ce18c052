//! Notes for people and for programs.

use serde::Serialize;

use super::console::Console;
use super::failure::Failure;
use crate::scene::{Note, NoteEffect};

/// A note as JSON has it.
#[derive(Serialize)]
pub(super) struct NoteJson<'a> {
    code: &'a str,
    place: &'a str,
    message: &'a str,
    effect: &'a str,
}

/// Notes as JSON has them.
pub(super) fn json(notes: &[Note]) -> Vec<NoteJson<'_>> {
    notes.iter().map(NoteJson::from).collect()
}

impl<'a> From<&'a Note> for NoteJson<'a> {
    fn from(n: &'a Note) -> Self {
        Self { code: n.code, place: &n.place, message: &n.message, effect: effect_name(n.effect) }
    }
}

/// What a note means for the picture, in a word.
pub(super) fn effect_name(effect: NoteEffect) -> &'static str {
    match effect {
        NoteEffect::None => "none",
        NoteEffect::Differs => "differs",
        NoteEffect::Missing => "missing",
    }
}

/// Prints the notes that concern the picture; all of them where `verbose`.
pub(super) fn show(notes: &[Note], verbose: bool, console: &Console) {
    const SHOWN: usize = 10;
    let wanted: Vec<_> = notes.iter().filter(|n| verbose || n.effect != NoteEffect::None).collect();
    let shown = if verbose { wanted.len() } else { wanted.len().min(SHOWN) };
    for note in &wanted[..shown] {
        console.message(&format!("note: {note}"));
    }
    if wanted.len() > shown {
        console.message(&format!("note: {} more; -v shows all", wanted.len() - shown));
    }
}

/// What a render does with a scene that `--strict` refuses.
pub(super) const RENDERED: &str = "without --strict the scene is rendered as far as it is understood";

/// Refuses a scene with notes that concern the picture.
///
/// `help` says what happens without `--strict`.
pub(super) fn refuse(notes: &[Note], help: &str) -> Result<(), Failure> {
    let mut serious = notes.iter().filter(|n| n.effect != NoteEffect::None);
    match (serious.next(), serious.count()) {
        (None, _) => Ok(()),
        (Some(first), 0) => Err(Failure::strict(format!("refused by --strict: {first}"))),
        (Some(first), more) => {
            Err(Failure::strict(format!("refused by --strict: {first} (and {more} more)")).help(help))
        }
    }
}

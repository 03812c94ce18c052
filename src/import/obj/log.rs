//! Notes of the OBJ reader: as many as a reader can take, however many a file asks for.

use std::collections::{HashMap, HashSet};

use super::super::notes::Notes;
use crate::scene::{Note, NoteEffect};

/// How many different messages of one kind are kept; the others are counted.
const MOST_OF_A_KIND: usize = 24;

/// Collects notes.
#[derive(Default)]
pub(super) struct Log {
    notes: Notes,
    said: HashMap<&'static str, HashSet<String>>,
}

impl Log {
    /// Adds a note, or counts it where it has been said before.
    pub(super) fn add(
        &mut self,
        code: &'static str,
        effect: NoteEffect,
        place: impl Into<String>,
        message: impl Into<String>,
    ) {
        let mut message = message.into();
        let said = self.said.entry(code).or_default();
        if !said.contains(&message) {
            if said.len() >= MOST_OF_A_KIND {
                message = format!("more notes `{code}`, about other names");
            } else {
                said.insert(message.clone());
            }
        }
        self.notes.add(code, effect, place, message);
    }

    /// For readers that are not particular to OBJ.
    pub(super) fn notes(&mut self) -> &mut Notes {
        &mut self.notes
    }

    /// The notes; merged ones end in the number of their places.
    pub(super) fn finish(self) -> Vec<Note> {
        self.notes.finish()
    }
}

/// Where a statement of the OBJ file itself stands.
pub(super) fn line(number: usize) -> String {
    format!("line {number}")
}

/// `name` in quotes, cut where it is too long for a message.
pub(super) fn quoted(name: &str) -> String {
    let short: String = name.chars().take(80).collect();
    if short.len() < name.len() { format!("{:?}..", short) } else { format!("{short:?}") }
}

//! Collects notes, and merges those that say the same about different places.

use std::collections::HashMap;

use super::{Note, NoteEffect};

/// Notes in order of first appearance; ten thousand equal ones become one with a count.
#[derive(Default)]
pub(crate) struct Notes {
    list: Vec<(Note, usize)>,
    index: HashMap<(&'static str, String), usize>,
}

impl Notes {
    /// Adds a note, or counts it where `code` and `message` have been said before.
    pub(crate) fn add(
        &mut self,
        code: &'static str,
        effect: NoteEffect,
        place: impl Into<String>,
        message: impl Into<String>,
    ) {
        self.add_many(code, effect, place, message, 1);
    }

    /// Adds a note that stands for `count` places, of which `place` is the first.
    pub(crate) fn add_many(
        &mut self,
        code: &'static str,
        effect: NoteEffect,
        place: impl Into<String>,
        message: impl Into<String>,
        count: usize,
    ) {
        let message = message.into();
        if let Some(&i) = self.index.get(&(code, message.clone())) {
            self.list[i].1 += count;
        } else {
            self.index.insert((code, message.clone()), self.list.len());
            self.list.push((Note { code, place: place.into(), message, effect }, count));
        }
    }

    /// The notes; a merged one ends in the number of its places.
    pub(crate) fn finish(self) -> Vec<Note> {
        let merge = |(mut note, count): (Note, usize)| {
            if count > 1 {
                note.message = format!("{} (here and in {} more)", note.message, count - 1);
            }
            note
        };
        self.list.into_iter().map(merge).collect()
    }
}

//! Places in a scene file: a path of keys and numbers, and where in the text it stands.
//!
//! In: a path such as `object[3].sphere.radius` and the text of a file that parses. Out: the bytes
//! of the deepest part of the path that the text spells out, so that an error about a default, or
//! about something a constructor made, points at the table it comes from.

use std::fmt;
use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::Syntax;

/// One step of a [`Place`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Into a table, by key.
    Key(String),
    /// Into a list, from zero.
    Index(usize),
}

/// A path into a scene file; empty is the whole file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Place(pub(super) Vec<Step>);

impl Place {
    /// The place of a key at the top.
    pub(super) fn top(key: &str) -> Self {
        Self::default().key(key)
    }

    /// The place of `key` in the table at this place.
    pub(super) fn key(&self, key: &str) -> Self {
        self.with(Step::Key(key.to_owned()))
    }

    /// The place of item `index` in the list at this place.
    pub(super) fn index(&self, index: usize) -> Self {
        self.with(Step::Index(index))
    }

    /// This place, and further steps from there.
    pub(super) fn join(&self, steps: &[Step]) -> Self {
        Self([&self.0, steps].concat())
    }

    fn with(&self, step: Step) -> Self {
        let mut steps = self.0.clone();
        steps.push(step);
        Self(steps)
    }

    /// Reads what [`fmt::Display`] writes, for keys without dots and brackets.
    pub(super) fn parse(path: &str) -> Self {
        let mut steps = Vec::new();
        for part in path.split(['.', '[']).filter(|p| !p.is_empty()) {
            steps.push(match part.strip_suffix(']').and_then(|n| n.parse().ok()) {
                Some(index) => Step::Index(index),
                None => Step::Key(part.trim_end_matches(']').to_owned()),
            });
        }
        Self(steps)
    }

    /// The bytes in `source` of the deepest part of this path that is there.
    pub(super) fn locate(&self, source: &str, syntax: Syntax) -> Range<usize> {
        match syntax {
            Syntax::Toml => self.locate_toml(source),
            Syntax::Json => JsonScan { text: source.as_bytes(), at: 0 }.locate(&self.0),
        }
    }

    fn locate_toml(&self, source: &str) -> Range<usize> {
        let Ok(root) = DeTable::parse(source) else { return 0..0 };
        let mut span = 0..0;
        let mut steps = self.0.iter();
        let Some(Step::Key(first)) = steps.next() else { return span };
        let mut here = match root.get_ref().iter().find(|(k, _)| k.get_ref() == first) {
            Some((_, value)) => value,
            None => return span,
        };
        loop {
            // A table that was only implied by the headers of its parts has no bytes of its own.
            if !here.span().is_empty() {
                span = here.span();
            }
            let next = match (steps.next(), here.get_ref()) {
                (Some(Step::Key(key)), DeValue::Table(table)) => {
                    table.iter().find(|(k, _)| k.get_ref() == key).map(|(_, v)| v)
                }
                (Some(Step::Index(i)), DeValue::Array(array)) => array.get(*i),
                _ => None,
            };
            match next {
                Some(value) => here = value,
                None => return span,
            }
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, step) in self.0.iter().enumerate() {
            match step {
                Step::Key(key) if i == 0 => f.write_str(key)?,
                Step::Key(key) => write!(f, ".{key}")?,
                Step::Index(index) => write!(f, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// A walk over JSON text that is known to be well formed.
struct JsonScan<'a> {
    text: &'a [u8],
    at: usize,
}

impl JsonScan<'_> {
    fn locate(mut self, steps: &[Step]) -> Range<usize> {
        self.skip_space();
        let mut start = self.at;
        for step in steps {
            if !self.enter(step) {
                break;
            }
            start = self.at;
        }
        self.at = start;
        self.skip_value();
        start..self.at
    }

    /// Moves from the start of a value to the start of one of its parts; false where it has no such part.
    fn enter(&mut self, step: &Step) -> bool {
        let open = self.peek();
        if !matches!((open, step), (b'{', Step::Key(_)) | (b'[', Step::Index(_))) {
            return false;
        }
        self.at += 1;
        let mut count = 0;
        loop {
            self.skip_space();
            if matches!(self.peek(), b'}' | b']' | 0) {
                return false;
            }
            let found = match step {
                Step::Index(index) => count == *index,
                Step::Key(key) => {
                    let start = self.at;
                    self.skip_value();
                    let name = serde_json::from_slice::<String>(&self.text[start..self.at]);
                    self.skip_space();
                    self.at += 1; // the colon
                    self.skip_space();
                    name.is_ok_and(|n| n == *key)
                }
            };
            if found {
                return true;
            }
            count += 1;
            self.skip_value();
            self.skip_space();
            if self.peek() == b',' {
                self.at += 1;
            }
        }
    }

    fn skip_value(&mut self) {
        let mut depth = 0usize;
        loop {
            match self.peek() {
                0 => return,
                b'"' => self.skip_string(),
                b'{' | b'[' => {
                    depth += 1;
                    self.at += 1;
                }
                b'}' | b']' => {
                    depth = depth.saturating_sub(1);
                    self.at += 1;
                }
                c if c.is_ascii_whitespace() || matches!(c, b',' | b':') => self.at += 1,
                _ => {
                    while !matches!(self.peek(), 0 | b',' | b'}' | b']' | b':' | b' ' | b'\n' | b'\r' | b'\t')
                    {
                        self.at += 1;
                    }
                }
            }
            if depth == 0 {
                return;
            }
        }
    }

    fn skip_string(&mut self) {
        self.at += 1;
        while !matches!(self.peek(), b'"' | 0) {
            self.at += if self.peek() == b'\\' { 2 } else { 1 };
        }
        self.at = (self.at + 1).min(self.text.len());
    }

    fn skip_space(&mut self) {
        while self.peek().is_ascii_whitespace() {
            self.at += 1;
        }
    }

    fn peek(&self) -> u8 {
        self.text.get(self.at).copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `path` points at, in both syntaxes.
    fn check(path: &str, toml: &str, json: &str) {
        let place = Place::parse(path);
        let source = "a = { b = [1, 22, { c = 'x' }] }\n[t]\n'q' = 7\n";
        assert_eq!(&source[place.locate(source, Syntax::Toml)], toml, "{path} in TOML");
        let source = r#"{ "a": {"b" : [1,22 , {"c":"x]\""}]}, "t":{ "q": 7 } }"#;
        assert_eq!(&source[place.locate(source, Syntax::Json)], json, "{path} in JSON");
    }

    #[test]
    fn a_place_points_at_the_deepest_part_that_is_there() {
        check("a.b[1]", "22", "22");
        check("a.b[2].c", "'x'", r#""x]\"""#);
        check("a.b[2].missing", "{ c = 'x' }", r#"{"c":"x]\""}"#);
        check("t.q", "7", "7");
        check("a.b[9]", "[1, 22, { c = 'x' }]", r#"[1,22 , {"c":"x]\""}]"#);
        check("t.q[0].deeper", "7", "7");
    }

    #[test]
    fn places_read_as_they_are_written() {
        let place = Place::top("object").index(3).key("sphere").key("radius");
        assert_eq!(place.to_string(), "object[3].sphere.radius");
        assert_eq!(Place::parse(&place.to_string()), place);
    }
}

//! Errors in a scene file: what is wrong, where, what was expected, and what may have been meant.
//!
//! In: an error of the TOML or JSON reader, or a [`Fault`] at a place. Out: a [`TextError`] with line
//! and column. The readers give sentences; [`from_sentence`] sorts them into kinds and picks the names
//! they list, so that a typo is answered with the nearest valid key.

use std::ops::Range;

use super::Syntax;
use super::place::Place;

/// Why a text is not a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {message}{}", self.hint())]
pub struct TextError {
    /// What sort of mistake it is.
    pub kind: TextErrorKind,
    /// What was found.
    pub message: String,
    /// What would have been right, where there is more to say than the message does.
    pub expected: Option<Box<str>>,
    /// The valid name nearest to the one that was found.
    pub nearest: Option<Box<str>>,
    /// Path of keys, such as `object[3].sphere.radius`; empty where only the position is known.
    pub place: String,
    /// Line, from one.
    pub line: usize,
    /// Column in characters, from one.
    pub column: usize,
    /// The bytes of the text that it is about.
    pub span: Range<usize>,
}

/// The sorts of mistake in a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextErrorKind {
    /// Neither TOML nor JSON.
    Syntax,
    /// Not marked as a scene, or of a later version of the form.
    Version,
    /// A key that means nothing where it stands.
    UnknownKey,
    /// A key that has to be there.
    MissingKey,
    /// A value of the wrong type or shape.
    WrongType,
    /// A name of a material, mesh or choice that does not exist.
    UnknownName,
    /// A value that makes no scene, such as a negative radius.
    Value,
    /// A picture that is missing, or cannot be decoded.
    Picture,
}

impl TextError {
    fn hint(&self) -> String {
        let mut hint = String::new();
        if let Some(expected) = &self.expected {
            hint.push_str("; expected ");
            hint.push_str(expected);
        }
        if let Some(nearest) = &self.nearest {
            hint.push_str("; did you mean `");
            hint.push_str(nearest);
            hint.push_str("`?");
        }
        hint
    }

    /// An error about the bytes `span` of `source`.
    fn at(source: &str, span: Range<usize>, fault: Fault) -> Self {
        let start = span.start.min(source.len());
        let before = &source.as_bytes()[..start];
        let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        Self {
            line: before.iter().filter(|&&b| b == b'\n').count() + 1,
            column: String::from_utf8_lossy(&before[line_start..]).chars().count() + 1,
            span,
            kind: fault.kind,
            message: fault.message,
            expected: fault.expected.map(String::into_boxed_str),
            nearest: fault.nearest.map(String::into_boxed_str),
            place: fault.place.to_string(),
        }
    }
}

/// A mistake at a place, before it is found in the text.
#[derive(Clone, Debug)]
pub(super) struct Fault {
    pub(super) kind: TextErrorKind,
    pub(super) place: Place,
    pub(super) message: String,
    pub(super) expected: Option<String>,
    pub(super) nearest: Option<String>,
}

impl Fault {
    pub(super) fn new(kind: TextErrorKind, place: Place, message: impl Into<String>) -> Self {
        Self { kind, place, message: message.into(), expected: None, nearest: None }
    }

    /// A value that makes no scene.
    pub(super) fn value(place: Place, message: impl Into<String>) -> Self {
        Self::new(TextErrorKind::Value, place, message)
    }

    pub(super) fn expecting(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// A name that is none of `valid`.
    pub(super) fn unknown_name(place: Place, what: &str, name: &str, valid: &[&str]) -> Self {
        let mut fault = Self::new(TextErrorKind::UnknownName, place, format!("there is no {what} `{name}`"));
        fault.nearest = nearest(name, valid.iter().copied());
        if fault.nearest.is_none() {
            fault.expected = Some(match valid {
                [] if what.starts_with(['a', 'e', 'i', 'o', 'u']) => format!("an {what} to be defined"),
                [] => format!("a {what} to be defined"),
                _ => one_of(valid),
            });
        }
        fault
    }

    pub(super) fn locate(self, source: &str, syntax: Syntax) -> TextError {
        TextError::at(source, self.place.locate(source, syntax), self)
    }
}

/// An error of the TOML reader.
pub(super) fn from_toml(source: &str, error: &toml::de::Error) -> TextError {
    TextError::at(source, error.span().unwrap_or(0..0), from_sentence(error.message()))
}

/// An error of the JSON reader.
pub(super) fn from_json(source: &str, error: &serde_json::Error) -> TextError {
    let sentence = error.to_string();
    let position = format!(" at line {} column {}", error.line(), error.column());
    let fault = from_sentence(sentence.strip_suffix(&position).unwrap_or(&sentence));
    // The reader stands on the last byte it has read; columns count bytes.
    let line_start: usize =
        source.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    let mut at = (line_start + error.column().saturating_sub(1)).min(source.len());
    while !source.is_char_boundary(at) {
        at -= 1;
    }
    // Point at the word itself where the sentence quotes one that stands just before.
    let mut span = at..at;
    if let Some(word) = quoted(&fault.message).next()
        && matches!(fault.kind, TextErrorKind::UnknownKey | TextErrorKind::UnknownName)
    {
        let head = &source[..source.ceil_char_boundary(at + 1)];
        let spelled = format!("\"{word}\"");
        if let Some(start) = head.rfind(&spelled) {
            span = start..start + spelled.len();
        }
    }
    TextError::at(source, span, fault)
}

/// Sorts a sentence of serde's into a kind, and answers typos.
fn from_sentence(sentence: &str) -> Fault {
    use TextErrorKind as Kind;
    let (head, expected) = match sentence.split_once(", expected ") {
        Some((head, expected)) => (head, Some(expected)),
        None => (sentence, None),
    };
    let starts = |prefix: &str| head.starts_with(prefix);
    let kind = if starts("unknown field") {
        Kind::UnknownKey
    } else if starts("unknown variant") {
        Kind::UnknownName
    } else if starts("missing field") {
        Kind::MissingKey
    } else if starts("invalid type") || starts("invalid length") {
        Kind::WrongType
    } else if starts("invalid value") {
        Kind::Value
    } else {
        Kind::Syntax
    };
    let message = match kind {
        Kind::UnknownKey => head.replacen("unknown field", "unknown key", 1),
        Kind::UnknownName => head.replacen("unknown variant", "unknown name", 1),
        Kind::MissingKey => head.replacen("missing field", "missing key", 1),
        Kind::WrongType => {
            head.replacen("invalid type: ", "found ", 1).replacen("invalid length ", "found a list of ", 1)
        }
        Kind::Value => head.replacen("invalid value: ", "", 1),
        _ => sentence.trim().replace('\n', ", "),
    };
    let mut fault = Fault::new(kind, Place::default(), message);
    if kind == Kind::Syntax {
        return fault;
    }
    if let Some(expected) = expected {
        if let Some(word) = quoted(head).next()
            && matches!(kind, Kind::UnknownKey | Kind::UnknownName)
        {
            fault.nearest = nearest(word, quoted(expected));
        }
        if fault.nearest.is_none() {
            fault.expected = Some(plain_type(expected).replace("an array of length", "a list of"));
        }
    }
    fault
}

/// The names in backticks.
fn quoted(sentence: &str) -> impl Iterator<Item = &str> {
    sentence.split('`').skip(1).step_by(2)
}

/// Rust's names of types, in words.
fn plain_type(expected: &str) -> &str {
    match expected {
        "f32" | "f64" => "a number",
        "u8" | "u32" | "u64" | "usize" => "a whole number that is not negative",
        "a boolean" => "true or false",
        other => other,
    }
}

/// "`a`", "`a` or `b`", "one of `a`, `b`, `c`".
pub(super) fn one_of(names: &[&str]) -> String {
    match names {
        [only] => format!("`{only}`"),
        [a, b] => format!("`{a}` or `{b}`"),
        _ => format!("one of `{}`", names.join("`, `")),
    }
}

/// The name that a typo most likely stands for.
fn nearest<'a>(word: &str, valid: impl Iterator<Item = &'a str>) -> Option<String> {
    let word = word.to_lowercase();
    valid
        .map(|name| (strsim::damerau_levenshtein(&word, &name.to_lowercase()), name))
        .filter(|&(distance, name)| distance <= 1 + word.len().max(name.len()) / 4)
        .min()
        .map(|(_, name)| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typos_are_answered_and_other_words_are_not() {
        let check = |word, expected: Option<&str>| {
            assert_eq!(nearest(word, ["radius", "center", "ior"].into_iter()).as_deref(), expected, "{word}");
        };
        check("radus", Some("radius"));
        check("centre", Some("center"));
        check("Radius", Some("radius"));
        check("oir", Some("ior"));
        check("wavelength", None);
        check("", None);
    }
}

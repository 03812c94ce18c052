//! The text of an OBJ or MTL file becomes logical lines with their numbers.
//!
//! In: bytes as exporters of four decades write them: UTF-8 with or without a mark, Latin-1, lines that
//! end in LF, CR LF or CR, and lines that `\` continues. Out: statements as `(line, keyword, rest)`,
//! trimmed, without comments and without blank lines. Invariant: a line's number is that of its first
//! part in the file, counted from one. Lines may be of any length; none is copied unless it is continued.

use std::borrow::Cow;

use super::super::budget::Budget;
use super::super::error::Fault;

/// The text in `bytes`, and whether it had to be taken as Latin-1.
pub(super) fn decode<'b>(bytes: &'b [u8], budget: &mut Budget) -> Result<(Cow<'b, str>, bool), Fault> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(Fault::invalid("line 1", "UTF-16", "UTF-8 or Latin-1; save the file as UTF-8"));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Ok((Cow::Borrowed(text), false));
    }
    budget.charge_bytes(bytes.len() as u64, 2, "text")?;
    Ok((Cow::Owned(bytes.iter().map(|&b| char::from(b)).collect()), true))
}

/// One statement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Statement<'t> {
    /// Of its first part, from one.
    pub(super) line: usize,
    /// The whole of it, trimmed; never empty.
    pub(super) text: Cow<'t, str>,
}

impl Statement<'_> {
    /// The first word, and what follows it, trimmed.
    pub(super) fn split(&self) -> (&str, &str) {
        let at = self.text.find(is_blank).unwrap_or(self.text.len());
        let (keyword, rest) = self.text.split_at(at);
        (keyword, rest.trim_matches(is_blank))
    }
}

/// What separates words: ASCII alone, so that Latin-1 names keep their no-break spaces.
pub(super) fn is_blank(c: char) -> bool {
    matches!(c, ' ' | '\t' | '\u{b}' | '\u{c}')
}

/// The words of a statement's rest.
pub(super) fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split(is_blank).filter(|w| !w.is_empty())
}

/// All statements of a text.
pub(super) struct Statements<'t> {
    rest: &'t str,
    line: usize,
}

impl<'t> Statements<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self { rest: text, line: 0 }
    }

    /// The next line as it stands in the file, without its end.
    fn physical(&mut self) -> Option<&'t str> {
        if self.rest.is_empty() {
            return None;
        }
        self.line += 1;
        let end = self.rest.bytes().position(|b| b == b'\n' || b == b'\r');
        let Some(end) = end else {
            return Some(std::mem::take(&mut self.rest));
        };
        let (line, rest) = self.rest.split_at(end);
        self.rest = rest.strip_prefix("\r\n").unwrap_or(&rest[1..]);
        Some(line)
    }
}

impl<'t> Iterator for Statements<'t> {
    type Item = Statement<'t>;

    fn next(&mut self) -> Option<Statement<'t>> {
        loop {
            let text = self.physical()?;
            let line = self.line;
            let text = text.trim_matches(is_blank);
            // A comment may end in the `\` of a Windows path, which continues nothing.
            if text.is_empty() || text.starts_with('#') {
                continue;
            }
            let Some(head) = text.strip_suffix('\\') else {
                return Some(Statement { line, text: Cow::Borrowed(text) });
            };
            let mut whole = head.to_owned();
            while let Some(next) = self.physical() {
                let next = next.trim_matches(is_blank);
                let part = next.strip_suffix('\\');
                whole.push(' ');
                whole.push_str(part.unwrap_or(next));
                if part.is_none() {
                    break;
                }
            }
            let whole = whole.trim_matches(is_blank);
            if !whole.is_empty() && !whole.starts_with('#') {
                return Some(Statement { line, text: Cow::Owned(whole.to_owned()) });
            }
        }
    }
}

/// The version in a header such as `# Blender 5.0.1`, or an empty one for Blender's older exporter
/// (`# Blender MTL File`); `None` for files of other programs. Only comments before the first statement
/// count.
pub(super) fn blender_header(text: &str) -> Option<&str> {
    let comments = text.split(['\n', '\r']).map(str::trim).take_while(|l| l.is_empty() || l.starts_with('#'));
    let mut named =
        comments.take(16).filter_map(|l| l.trim_start_matches(['#', ' ']).strip_prefix("Blender"));
    let rest = named.next()?;
    let version = rest.trim_start_matches([' ', 'v']).split(' ').next().unwrap_or_default();
    Some(if version.starts_with(|c: char| c.is_ascii_digit()) { version } else { "" })
}

#[cfg(test)]
mod tests {
    use super::super::super::ReadOptions;
    use super::*;

    /// Guards the line numbers of every message, and that no way to end or continue a line loses one.
    #[test]
    fn lines_end_and_continue_in_every_way() {
        let check = |text: &str, expected: &[(usize, &str)]| {
            let found: Vec<_> = Statements::new(text).map(|s| (s.line, s.text.into_owned())).collect();
            let expected: Vec<_> = expected.iter().map(|&(l, t)| (l, t.to_owned())).collect();
            assert_eq!(found, expected, "{text:?}");
        };
        check("", &[]);
        check("v 1\nv 2", &[(1, "v 1"), (2, "v 2")]);
        check("v 1\r\nv 2\rv 3\n\rv 4", &[(1, "v 1"), (2, "v 2"), (3, "v 3"), (5, "v 4")]);
        check("  # c\n\n \t v\t1 \n", &[(3, "v\t1")]);
        check("f 1 \\\n 2 \\\r\n 3\nv 1", &[(1, "f 1  2  3"), (4, "v 1")]);
        check("# C:\\dir\\\nv 1", &[(2, "v 1")]);
        check("f 1 2 \\", &[(1, "f 1 2")]);
        check("\\\n\\\n\\", &[]);
        check("o a\u{a0}b", &[(1, "o a\u{a0}b")]);
    }

    /// Guards that text which is not UTF-8 still loads, and that UTF-16 is named instead of misread.
    #[test]
    fn encodings_are_told_apart() {
        let mut budget = Budget::new(&ReadOptions::default());
        let mut text = |b: &[u8]| decode(b, &mut budget).map(|(t, l)| (t.into_owned(), l)).ok();
        assert_eq!(text(b"\xef\xbb\xbfo a"), Some(("o a".into(), false)));
        assert_eq!(text("o é".as_bytes()), Some(("o é".into(), false)));
        assert_eq!(text(b"o \xe9"), Some(("o é".into(), true)));
        assert_eq!(text(b"\xff\xfeo\0"), None);
    }

    #[test]
    fn blenders_header_is_found_above_the_first_statement_only() {
        assert_eq!(blender_header("# Blender 5.0.1\n# www\n"), Some("5.0.1"));
        assert_eq!(blender_header("# Blender v2.93.4 OBJ File: ''\n"), Some("2.93.4"));
        assert_eq!(blender_header("# Blender MTL File: 'a.blend'\r\n"), Some(""));
        assert_eq!(blender_header("# made by hand\n\n# Blender 4.2 MTL File: 'x'\n"), Some("4.2"));
        assert_eq!(blender_header("v 1 2 3\n# Blender 5.0.1\n"), None);
        assert_eq!(blender_header("# 3ds Max\nv 1 2 3"), None);
    }
}

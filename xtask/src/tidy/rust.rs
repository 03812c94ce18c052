//! Paths in Rust source, found without a compiler: enough of the language to tell code from comments
//! and text, and to follow `use` groups, `super` and inline modules.
//!
//! In: a file and the module it is. Out: every path that starts at the crate, at a parent module or at
//! an external name. It works badly on paths that a macro puts together; there are none here.

/// A path in source: `[accel, PrimitiveId]` of the crate, or `[serde, Serialize]` of a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PathUse {
    pub(crate) line: usize,
    pub(crate) root: Root,
    pub(crate) segments: Vec<String>,
    /// True inside of `#[cfg(test)]`.
    pub(crate) test: bool,
}

/// Where a path starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Root {
    /// At the root of this crate.
    Crate,
    /// At a name that is no local module: the first segment is a package.
    External,
}

/// The words and marks of a source text, each with its line counted from one; comments and the insides
/// of literals are left out.
pub(crate) fn tokens(text: &str) -> Vec<(usize, &str)> {
    let (bytes, mut at, mut line, mut found) = (text.as_bytes(), 0, 1, Vec::new());
    while at < bytes.len() {
        let rest = &text[at..];
        let length = match bytes[at] {
            _ if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            _ if rest.starts_with("/*") => block_comment(rest),
            _ if raw_string(rest).is_some() => raw_string(rest).unwrap_or(1),
            b'"' => quoted(rest, '"'),
            b'\'' => character_or_lifetime(rest),
            c if c.is_ascii_alphabetic() || c == b'_' => {
                let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                found.push((line, &rest[..end]));
                end
            }
            _ if rest.starts_with("::") => {
                found.push((line, "::"));
                2
            }
            c if c.is_ascii_graphic() => {
                found.push((line, &rest[..1]));
                1
            }
            _ => rest.chars().next().map_or(1, char::len_utf8),
        };
        line += rest[..length].matches('\n').count();
        at += length;
    }
    found
}

/// Length of a block comment, which may hold others.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0usize, 0);
    while at < text.len() {
        if text[at..].starts_with("/*") {
            depth += 1;
            at += 2;
        } else if text[at..].starts_with("*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += text[at..].chars().next().map_or(1, char::len_utf8);
        }
    }
    at
}

/// Length of a raw string that starts here, such as `r#".."#`.
fn raw_string(text: &str) -> Option<usize> {
    let after = text.strip_prefix("br").or_else(|| text.strip_prefix('r'))?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    let body = after[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let start = text.len() - body.len();
    Some(body.find(&end).map_or(text.len(), |i| start + i + end.len()))
}

/// Length of a literal between marks, of which a backslash takes the meaning.
fn quoted(text: &str, mark: char) -> usize {
    let mut escaped = false;
    for (i, c) in text.char_indices().skip(1) {
        if !escaped && c == mark {
            return i + c.len_utf8();
        }
        escaped = !escaped && c == '\\';
    }
    text.len()
}

/// Length of `'x'`, `'\n'` or the mark of `'a`.
fn character_or_lifetime(text: &str) -> usize {
    let mut chars = text.char_indices().skip(1);
    match (chars.next(), chars.next()) {
        (Some((_, '\\')), _) | (Some(_), Some((_, '\''))) => quoted(text, '\''),
        _ => 1,
    }
}

/// Every path in a file that starts at the crate (`crate::`, `epsilux::`, `super::` that gets so far) or
/// at a name that nothing in the file declares. `module` is the path of the file's module.
pub(crate) fn paths(text: &str, module: &[String]) -> Vec<PathUse> {
    let tokens = tokens(text);
    let mut reader =
        Reader { tokens: &tokens, at: 0, module: module.to_vec(), local: Vec::new(), found: Vec::new() };
    reader.local = reader.declared();
    reader.run();
    let local = std::mem::take(&mut reader.local);
    reader.found.retain(|p| p.root == Root::Crate || !local.contains(&p.segments[0].as_str()));
    reader.found
}

struct Reader<'a> {
    tokens: &'a [(usize, &'a str)],
    at: usize,
    module: Vec<String>,
    /// Names that the file declares, so that they are no packages.
    local: Vec<&'a str>,
    found: Vec<PathUse>,
}

impl<'a> Reader<'a> {
    fn peek(&self, ahead: usize) -> &'a str {
        self.tokens.get(self.at + ahead).map_or("", |t| t.1)
    }

    /// Names after `mod`, and what `use` brings in from this crate.
    fn declared(&self) -> Vec<&'a str> {
        let mut names = Vec::new();
        for (i, window) in self.tokens.windows(2).enumerate() {
            if window[0].1 == "mod" {
                names.push(window[1].1);
            }
            if window[0].1 == "use" && ["crate", "super", "self"].contains(&window[1].1) {
                let tree = self.tokens[i..].iter().map(|t| t.1).take_while(|t| *t != ";");
                let tree: Vec<_> = tree.collect();
                let ends = |next: Option<&&str>| next.is_none_or(|n| [",", "}"].contains(n));
                let leaf = |i: usize, t: &str| is_name(t) && ends(tree.get(i + 1));
                names.extend(tree.iter().enumerate().filter(|(i, t)| leaf(*i, t)).map(|(_, t)| *t));
            }
        }
        names
    }

    fn run(&mut self) {
        // For each open brace, whether it is an inline module, and whether it opened a test.
        let (mut braces, mut test_next): (Vec<(bool, bool)>, bool) = (Vec::new(), false);
        while self.at < self.tokens.len() {
            let test = test_next || braces.iter().any(|b| b.1);
            match self.peek(0) {
                "#" if ["[", "cfg", "(", "test", ")"].iter().zip(1..).all(|(t, i)| self.peek(i) == *t) => {
                    test_next = true;
                    self.at += 6;
                    continue;
                }
                "mod" if self.peek(2) == "{" => {
                    self.module.push(self.peek(1).to_owned());
                    braces.push((true, std::mem::take(&mut test_next)));
                    self.at += 3;
                    continue;
                }
                "{" => braces.push((false, std::mem::take(&mut test_next))),
                "}" if braces.pop().is_some_and(|b| b.0) => _ = self.module.pop(),
                ";" => test_next = false,
                _ => {}
            }
            let before = if self.at == 0 { "" } else { self.tokens[self.at - 1].1 };
            let starts = is_name(self.peek(0)) && before != "." && before != "::";
            let imported = before == "use" && [";", "as"].contains(&self.peek(1));
            if starts && (self.peek(1) == "::" || imported) {
                self.tree(Vec::new(), test);
            } else {
                self.at += 1;
            }
        }
    }

    /// Reads a path, and the group that it may end in; leaves `at` behind it.
    fn tree(&mut self, mut path: Vec<String>, test: bool) {
        let mut line = self.tokens[self.at].0;
        loop {
            let token = self.peek(0);
            if token == "{" {
                self.at += 1;
                while self.at < self.tokens.len() && self.peek(0) != "}" {
                    if is_name(self.peek(0)) {
                        self.tree(path.clone(), test);
                    } else {
                        self.at += 1;
                    }
                }
                self.at += 1;
                return;
            }
            if !is_name(token) {
                break;
            }
            line = self.tokens[self.at].0;
            path.push(token.to_owned());
            self.at += 1;
            if self.peek(0) != "::" {
                break;
            }
            self.at += 1;
        }
        if self.peek(0) == "as" {
            self.at += 2;
        }
        self.report(line, &path, test);
    }

    fn report(&mut self, line: usize, path: &[String], test: bool) {
        let (root, segments) = match path[0].as_str() {
            "crate" | "epsilux" => (Root::Crate, path[1..].to_vec()),
            "self" | "super" => {
                let ups = path.iter().take_while(|s| *s == "super" || *s == "self");
                let (ups, names) = (ups.clone().filter(|s| *s == "super").count(), &path[ups.count()..]);
                let kept = self.module.len().saturating_sub(ups);
                (Root::Crate, self.module[..kept].iter().chain(names).cloned().collect())
            }
            "Self" | "std" | "core" | "alloc" => return,
            _ => (Root::External, path.to_vec()),
        };
        if !segments.is_empty() {
            self.found.push(PathUse { line, root, segments, test });
        }
    }
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: &[&str]) {
        let module = ["light".to_owned(), "sphere".to_owned()];
        let show = |p: PathUse| {
            let root = if p.root == Root::Crate { "crate " } else { "" };
            let test = if p.test { " in a test" } else { "" };
            format!("{}: {root}{}{test}", p.line, p.segments.join("::"))
        };
        let found: Vec<_> = paths(text, &module).into_iter().map(show).collect();
        assert_eq!(found, expected, "{text}");
    }

    /// Each way in which a path can be written, and what merely looks like one.
    #[test]
    fn paths_are_found() {
        check("use crate::math;", &["1: crate math"]);
        check(
            "use crate::{math::{sin, cos},\n accel::Hit as H};",
            &["1: crate math::sin", "1: crate math::cos", "2: crate accel::Hit"],
        );
        check(
            "fn f() { let x = crate::math::sin(1.0) * epsilux::math::PI; }",
            &["1: crate math::sin", "1: crate math::PI"],
        );
        check("use super::{LightId};", &["1: crate light::LightId"]);
        check("use super::super::accel::Hit;", &["1: crate accel::Hit"]);
        check(
            "mod inner { use super::super::super::accel; }\nuse super::set;",
            &["1: crate accel", "2: crate light::set"],
        );
        check("pub(crate) fn f() {} pub(in crate::light) struct X;", &["1: crate light"]);
        check("use serde::Deserialize; use glam;", &["1: serde::Deserialize", "1: glam"]);
        check("#[derive(Debug, thiserror::Error)] struct E;", &["1: thiserror::Error"]);
        check("let x: std::vec::Vec<f32> = Self::new(); a.b::<f32>();", &[]);
        check("// crate::a\n/* crate::b /* crate::c */ crate::d */ /// [`crate::e`]\n", &[]);
        check(
            r##"let a = "crate::a \" crate::b"; let b = r#"crate::c "d""#; let c = '"'; crate::math::f"##,
            &["1: crate math::f"],
        );
        check("fn f<'a>(x: &'a str) -> exr::X<'a> {}", &["1: exr::X"]);
    }

    /// A module may have the name of a package; then the name is no package there.
    #[test]
    fn local_names_are_no_packages() {
        check("mod image;\npub use image::{Image, Layer};", &[]);
        check("use super::exr;\nfn f() { exr::write() }", &["1: crate light::exr"]);
        check("fn f() { exr::write() }", &["1: exr::write"]);
    }

    /// What stands inside of `#[cfg(test)]` is known to be a test, and no more than that.
    #[test]
    fn tests_are_told_apart() {
        check(
            "#[cfg(test)]\nmod tests { use crate::a::B; }\nuse crate::c::D;",
            &["2: crate a::B in a test", "3: crate c::D"],
        );
        check("#[cfg(test)] mod tests;\nuse crate::c::D;", &["2: crate c::D"]);
        check(
            "#[cfg(test)] use crate::a::B;\nuse crate::c::D;",
            &["1: crate a::B in a test", "2: crate c::D"],
        );
    }
}

//! Tables laid out as TOML or JSON.
//!
//! In: the tree of `write`. Out: text a person can read: one table or entry a line, long lists filled up
//! to a width. Only TOML 1.0 is used, so that any reader and editor understands it.

use super::write::{Node, Table};

/// Lists longer than this are broken into lines.
const WIDTH: usize = 100;

/// The tree of a scene as TOML.
pub(super) fn toml(root: &Table) -> String {
    let mut out = String::new();
    let (tables, entries): (Vec<_>, Vec<_>) = root.iter().partition(|(key, value)| is_section(key, value));
    entries.iter().for_each(|(key, value)| entry(&mut out, key, value));
    for (key, value) in tables {
        match (key.as_str(), value) {
            // Each camera and mesh has several entries; so it has a header of its own.
            ("camera" | "mesh", Node::Table(named)) => {
                named
                    .iter()
                    .for_each(|(name, v)| section(&mut out, &format!("[{key}.{}]", toml_key(name)), v));
            }
            // One line for each material; where one is too long for that, a header for each.
            ("material", Node::Table(named)) if named.iter().any(|(_, v)| toml_flat(v).len() > WIDTH) => {
                named.iter().for_each(|(name, v)| {
                    let name = toml_key(name);
                    match only_table(v) {
                        Some((kind, parts)) => section(&mut out, &format!("[material.{name}.{kind}]"), parts),
                        None => section(&mut out, &format!("[material.{name}]"), v),
                    }
                });
            }
            (_, Node::List(items)) => items.iter().for_each(|v| section(&mut out, &format!("[[{key}]]"), v)),
            _ => section(&mut out, &format!("[{key}]"), value),
        }
    }
    out
}

/// The one entry of a table, where it is a table itself.
fn only_table(value: &Node) -> Option<(&str, &Node)> {
    match value {
        Node::Table(entries) => match &entries[..] {
            [(key, inner @ Node::Table(_))] => Some((key, inner)),
            _ => None,
        },
        _ => None,
    }
}

fn is_section(key: &str, value: &Node) -> bool {
    matches!(value, Node::Table(_)) || matches!(key, "object" | "light")
}

fn section(out: &mut String, header: &str, value: &Node) {
    out.push_str(&format!("\n{header}\n"));
    if let Node::Table(entries) = value {
        entries.iter().for_each(|(key, value)| entry(out, key, value));
    }
}

fn entry(out: &mut String, key: &str, value: &Node) {
    out.push_str(&toml_key(key));
    out.push_str(" = ");
    filled(out, value, 0, &toml_flat);
    out.push('\n');
}

fn toml_flat(node: &Node) -> String {
    inline(node, &toml_key, " = ")
}

/// The tree of a scene as JSON.
pub(super) fn json(root: &Table) -> String {
    let mut out = String::new();
    json_value(&mut out, &Node::Table(root.clone()), 0);
    out.push('\n');
    out
}

fn json_value(out: &mut String, value: &Node, indent: usize) {
    let flat = |node: &Node| inline(node, &quoted, ": ");
    let pad = "  ".repeat(indent + 1);
    let is_structure = |node: &Node| matches!(node, Node::Table(_));
    match value {
        Node::Table(entries) if indent == 0 || flat(value).len() > WIDTH => {
            out.push('{');
            for (i, (key, value)) in entries.iter().enumerate() {
                out.push_str(if i == 0 { "\n" } else { ",\n" });
                out.push_str(&format!("{pad}{}: ", quoted(key)));
                json_value(out, value, indent + 1);
            }
            out.push_str(&format!("\n{}}}", "  ".repeat(indent)));
        }
        Node::List(items) if items.iter().any(is_structure) => {
            out.push('[');
            for (i, item) in items.iter().enumerate() {
                out.push_str(if i == 0 { "\n" } else { ",\n" });
                out.push_str(&pad);
                json_value(out, item, indent + 1);
            }
            out.push_str(&format!("\n{}]", "  ".repeat(indent)));
        }
        _ => filled(out, value, indent, &flat),
    }
}

/// A value on one line, or a list whose items fill several.
fn filled(out: &mut String, value: &Node, indent: usize, flat: &dyn Fn(&Node) -> String) {
    let Node::List(items) = value else {
        out.push_str(&flat(value));
        return;
    };
    let items: Vec<String> = items.iter().map(flat).collect();
    if items.iter().map(|i| i.len() + 2).sum::<usize>() <= WIDTH {
        out.push_str(&format!("[{}]", items.join(", ")));
        return;
    }
    let pad = "  ".repeat(indent + 1);
    out.push('[');
    let mut column = WIDTH;
    for (i, item) in items.iter().enumerate() {
        if i > 0 {
            out.push(',');
        }
        if column + item.len() + 2 > WIDTH {
            out.push_str(&format!("\n{pad}"));
            column = pad.len();
        } else {
            out.push(' ');
        }
        out.push_str(item);
        column += item.len() + 2;
    }
    out.push_str(&format!("\n{}]", "  ".repeat(indent)));
}

fn inline(value: &Node, key_of: &dyn Fn(&str) -> String, sign: &str) -> String {
    match value {
        Node::Raw(raw) => raw.clone(),
        Node::Text(text) => quoted(text),
        Node::List(items) => {
            let items: Vec<String> = items.iter().map(|i| inline(i, key_of, sign)).collect();
            format!("[{}]", items.join(", "))
        }
        Node::Table(entries) if entries.is_empty() => "{}".to_owned(),
        Node::Table(entries) => {
            let entry = |(key, value): &(String, Node)| {
                format!("{}{sign}{}", key_of(key), inline(value, key_of, sign))
            };
            format!("{{ {} }}", entries.iter().map(entry).collect::<Vec<_>>().join(", "))
        }
    }
}

fn toml_key(key: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !key.is_empty() && key.chars().all(bare) { key.to_owned() } else { quoted(key) }
}

/// Text in quotes, escaped so that both TOML and JSON read it.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            c if c.is_control() => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

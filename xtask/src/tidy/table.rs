//! The tables of ARCHITECTURE.md and the dependencies of a Cargo.toml, as plain text.

/// A row of a table: the line it stands on, counted from one, and its cells without backquotes.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) line: usize,
    pub(crate) cells: Vec<String>,
}

impl Row {
    /// The words of a cell, which are separated by commas or spaces.
    pub(crate) fn words(&self, cell: usize) -> impl Iterator<Item = &str> {
        let text = self.cells.get(cell).map_or("", String::as_str);
        text.split([',', ' ']).filter(|w| !w.is_empty())
    }
}

/// The rows of the Markdown table whose header cells begin with `header`; `None` where there is no such
/// table.
pub(crate) fn table(markdown: &str, header: &[&str]) -> Option<Vec<Row>> {
    let mut lines = markdown.lines().zip(1..).map(|(text, line)| (cells(text), line));
    lines.find(|(cells, _)| {
        cells.as_ref().is_some_and(|c| c.iter().zip(header).all(|(a, b)| a == b) && c.len() >= header.len())
    })?;
    let body = lines.map_while(|(cells, line)| Some(Row { line, cells: cells? }));
    // The line under the header holds nothing but dashes.
    Some(body.filter(|row| !row.cells.iter().all(|c| c.chars().all(|c| "-:".contains(c)))).collect())
}

fn cells(line: &str) -> Option<Vec<String>> {
    let inner = line.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(|cell| cell.replace('`', "").trim().to_owned()).collect())
}

/// A package that a Cargo.toml asks for.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Dependency {
    pub(crate) line: usize,
    pub(crate) name: String,
}

/// The names under `[dependencies]`, `[dev-dependencies]` and `[build-dependencies]`.
pub(crate) fn dependencies(manifest: &str) -> Vec<Dependency> {
    let mut found: Vec<Dependency> = Vec::new();
    let (mut inside, mut open) = (false, 0usize);
    for (text, line) in manifest.lines().zip(1..) {
        let text = text.split('#').next().unwrap_or_default();
        if open == 0 && text.starts_with('[') {
            inside = text.trim_matches(['[', ']', ' ']).ends_with("dependencies");
        } else if let (true, 0, Some((name, _))) = (inside, open, text.split_once(['=', '.'])) {
            let name = name.trim().trim_matches('"').to_owned();
            if found.iter().all(|d| d.name != name) {
                found.push(Dependency { line, name });
            }
        }
        // A value may go on over several lines.
        let opened = text.matches(['[', '{']).count();
        open = (open + opened).saturating_sub(text.matches([']', '}']).count());
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The right table is found by its header, and ends where the text goes on.
    #[test]
    fn a_table_is_found_by_its_header() {
        let text = "| a | b |\n|---|---|\n| 1 | 2 |\n\n| module | may use | |\n|---|:-:|--|\n\
                    | `math` | | named |\n| `scene` | `math`, `color` | plain |\nText | not a row\n";
        let rows = table(text, &["module", "may use"]).expect("it is there");
        assert_eq!(rows.iter().map(|r| r.line).collect::<Vec<_>>(), [7, 8]);
        assert_eq!(rows[0].words(1).count(), 0);
        assert_eq!(rows[1].words(1).collect::<Vec<_>>(), ["math", "color"]);
        assert_eq!(table(text, &["package"]), None);
    }

    /// Values over several lines and other sections do not confuse the list of packages.
    #[test]
    fn packages_are_read_from_a_manifest() {
        let text = "[package]\nname = \"x\"\n[features]\ncli = [\"dep:clap\"]\n[dependencies]\nexr = \"1\"\n\
                    gltf = { version = \"1\", features = [\n    \"names\", \"extras\",\n] } # glTF\n\
                    serde.workspace = true\n[dev-dependencies]\ninsta = \"1\"\nexr = \"1\"\n[lints]\nw = true\n";
        let found = dependencies(text);
        let names: Vec<_> = found.iter().map(|d| (d.line, d.name.as_str())).collect();
        assert_eq!(names, [(6, "exr"), (7, "gltf"), (10, "serde"), (12, "insta")]);
    }
}

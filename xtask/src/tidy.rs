//! `cargo xtask tidy`: what the repository promises about itself, checked.
//!
//! In: the files that git tracks or would track. Out: one line for each broken promise, with its place
//! and what was expected. ARCHITECTURE.md is the source of the rules about modules and packages: its
//! tables are read here, so that they cannot grow stale.

mod rust;
mod table;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use rust::{PathUse, Root};
use sha2::{Digest, Sha256};
use table::Row;

const ARCHITECTURE: &str = "ARCHITECTURE.md";
const MANIFESTS: [&str; 2] = ["Cargo.toml", "xtask/Cargo.toml"];
/// The one file that may say `unsafe`.
const UNSAFE: &str = "src/accel/simd.rs";
/// Lines of a file in src, beyond which it is more than one subject.
const LONGEST: usize = 700;
/// The page whose table of costs is checked.
const README: &str = "README.md";
/// What scenes are expected to render to, and why.
const GOLDENS: &str = "fixtures/golden/";
const BLESSINGS: &str = "fixtures/golden/BLESSINGS.md";
/// Bytes of fixtures/golden, all together.
const GOLDEN: u64 = 20_000_000;
/// Beginnings of paths that exist on one machine only.
const MACHINE_PATHS: [&str; 4] =
    [concat!("/", "work/"), concat!("/", "tmp/"), concat!("/", "home/"), concat!("/", "root/")];

/// Check the repository's promises: module and package tables of ARCHITECTURE.md, file sizes, and more.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Root of the repository [default: where xtask was built]
    #[arg(value_name = "DIR")]
    root: Option<PathBuf>,
}

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let built = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    let findings = check(&read(arguments.root.as_deref().unwrap_or(built))?);
    if findings.is_empty() {
        return Ok(());
    }
    let mut message = String::from("the repository is not tidy\n");
    for finding in &findings {
        let _ = writeln!(message, "  {finding}");
    }
    Err(message)
}

/// A file of the repository; binary files have no text.
struct File {
    path: String,
    bytes: u64,
    text: String,
}

/// The files that git tracks, or would track if they were added.
fn read(root: &Path) -> Result<Vec<File>, String> {
    let listed = Command::new("git")
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .current_dir(root)
        .output()
        .map_err(|e| format!("git could not be started: {e}"))?;
    if !listed.status.success() {
        return Err(format!("git ls-files: {}", String::from_utf8_lossy(&listed.stderr).trim()));
    }
    let names = String::from_utf8_lossy(&listed.stdout).into_owned();
    let mut files = Vec::new();
    for path in names.split('\0').filter(|p| !p.is_empty()) {
        // What git knows may have been deleted since.
        if let Ok(bytes) = std::fs::read(root.join(path)) {
            let size = bytes.len() as u64;
            let text = String::from_utf8(bytes).unwrap_or_default();
            files.push(File { path: path.to_owned(), bytes: size, text });
        }
    }
    Ok(files)
}

/// Everything that is wrong, sorted by place.
fn check(files: &[File]) -> Vec<String> {
    let mut findings = Findings::default();
    sizes(files, &mut findings);
    blessings(files, &mut findings);
    words(files, &mut findings);
    headers(files, &mut findings);
    costs(files, &mut findings);
    let uses: Vec<Used> = files.iter().filter(|f| f.path.ends_with(".rs")).flat_map(used).collect();
    match files.iter().find(|f| f.path == ARCHITECTURE) {
        Some(file) => {
            modules(&file.text, files, &uses, &mut findings);
            packages(&file.text, files, &uses, &mut findings);
        }
        None => findings.add(ARCHITECTURE, 0, "missing, expected its tables of modules and packages"),
    }
    findings.0.into_iter().map(|(path, line, what)| format!("{path}:{line}: {what}")).collect()
}

#[derive(Default)]
struct Findings(BTreeSet<(String, usize, String)>);

impl Findings {
    fn add(&mut self, path: &str, line: usize, what: impl Into<String>) {
        self.0.insert((path.to_owned(), line, what.into()));
    }
}

/// A path in code, with the place it stands in.
struct Used<'a> {
    file: &'a str,
    /// The top-level module, or `lib`, `main`, `tests`, `examples`, `xtask`.
    place: String,
    path: PathUse,
}

fn used(file: &File) -> Vec<Used<'_>> {
    let (place, module, test_file) = locate(&file.path);
    let found = rust::paths(&file.text, &module).into_iter().map(|mut path| {
        path.test |= test_file;
        Used { file: &file.path, place: place.clone(), path }
    });
    found.collect()
}

/// Where a source file belongs: its place, the path of its module, and whether all of it is a test.
fn locate(path: &str) -> (String, Vec<String>, bool) {
    let parts: Vec<&str> = path.trim_end_matches(".rs").split('/').collect();
    let test = parts.iter().any(|p| *p == "tests" || p.ends_with("_test"));
    match parts.as_slice() {
        ["src", rest @ ..] => {
            let end = if rest.last() == Some(&"mod") { rest.len() - 1 } else { rest.len() };
            let module: Vec<String> = rest[..end].iter().map(|s| (*s).to_owned()).collect();
            let root = matches!(module.as_slice(), [one] if one == "lib" || one == "main");
            let place = module.first().cloned().unwrap_or_default();
            (place, if root { Vec::new() } else { module }, test)
        }
        [first, ..] => ((*first).to_owned(), vec![(*first).to_owned()], test),
        [] => (String::new(), Vec::new(), test),
    }
}

/// The top-level modules that there are.
fn modules_of(files: &[File]) -> BTreeSet<String> {
    let sources = files.iter().filter(|f| f.path.starts_with("src/") && f.path.ends_with(".rs"));
    sources.map(|f| locate(&f.path).0).filter(|m| m != "lib" && m != "main").collect()
}

/// Paths of this crate against the table "module | may use".
fn modules(architecture: &str, files: &[File], uses: &[Used<'_>], findings: &mut Findings) {
    let Some(rows) = table::table(architecture, &["module", "may use"]) else {
        return findings.add(ARCHITECTURE, 0, "no table begins with \"module | may use\"");
    };
    let mut above: Vec<&str> = Vec::new();
    let mut may: BTreeMap<&str, (&Row, Vec<&str>)> = BTreeMap::new();
    for row in &rows {
        for name in row.words(1).filter(|name| !above.contains(name)) {
            let what = format!("{} may use {name}, expected only modules of rows above it", row.cells[0]);
            findings.add(ARCHITECTURE, row.line, what);
        }
        may.insert(&row.cells[0], (row, above.clone()));
        above.push(&row.cells[0]);
    }
    let exist = modules_of(files);
    for row in rows.iter().filter(|r| !exist.contains(&r.cells[0])) {
        findings.add(ARCHITECTURE, row.line, format!("src has no module {}", row.cells[0]));
    }
    for name in exist.iter().filter(|m| !above.contains(&m.as_str())) {
        findings.add(ARCHITECTURE, 0, format!("module {name} is missing in the table \"module | may use\""));
    }
    let mut needed: BTreeSet<(&str, &str)> = BTreeSet::new();
    for Used { file, place, path } in uses.iter().filter(|u| u.path.root == Root::Crate) {
        let target = path.segments[0].as_str();
        let Some((row, above)) = may.get(place.as_str()).filter(|_| target != place) else { continue };
        if !exist.contains(target) {
            findings.add(file, path.line, format!("crate::{target}, expected a module of the table"));
        } else if path.test && !above.contains(&target) {
            let what = format!("a test in {place} uses {target}, expected a module above {place}");
            findings.add(file, path.line, what);
        } else if !path.test && row.words(1).all(|name| name != target) {
            let what = format!("{place} uses {target}, expected one of: {}", row.cells[1]);
            findings.add(file, path.line, what);
        }
        if !path.test {
            needed.insert((place, target));
        }
    }
    for row in &rows {
        for name in row.words(1).filter(|name| !needed.contains(&(row.cells[0].as_str(), *name))) {
            findings.add(ARCHITECTURE, row.line, format!("{} may use {name}, but does not", row.cells[0]));
        }
    }
}

/// Packages in manifests and in code against the table "package | where it is used".
fn packages(architecture: &str, files: &[File], uses: &[Used<'_>], findings: &mut Findings) {
    let Some(rows) = table::table(architecture, &["package", "where it is used", "for"]) else {
        let what = "no table begins with \"package | where it is used | for\"";
        return findings.add(ARCHITECTURE, 0, what);
    };
    let mut asked: BTreeSet<String> = BTreeSet::new();
    for file in files.iter().filter(|f| MANIFESTS.contains(&f.path.as_str())) {
        for dependency in table::dependencies(&file.text) {
            if rows.iter().all(|r| r.cells[0] != dependency.name) {
                let what = format!("package {}, expected a row for it in {ARCHITECTURE}", dependency.name);
                findings.add(&file.path, dependency.line, what);
            }
            asked.insert(dependency.name);
        }
    }
    for row in &rows {
        let package = row.cells[0].as_str();
        if !asked.contains(package) {
            findings.add(ARCHITECTURE, row.line, format!("no Cargo.toml asks for the package {package}"));
            continue;
        }
        let name = package.replace('-', "_");
        let mut needed: BTreeSet<&str> = BTreeSet::new();
        let here = uses.iter().filter(|u| u.path.root == Root::External && u.path.segments[0] == name);
        for Used { file, place, path } in here {
            // A test within a module may use what the module may, and what tests may.
            let places = [place.as_str(), if path.test { "tests" } else { place.as_str() }];
            match row.words(1).find(|w| places.contains(w)) {
                Some(word) => _ = needed.insert(word),
                None => {
                    let what = format!("{package} in {}, expected it only in: {}", places[1], row.cells[1]);
                    findings.add(file, path.line, what);
                }
            }
        }
        for word in row.words(1).filter(|w| !needed.contains(w)) {
            findings.add(ARCHITECTURE, row.line, format!("nothing in {word} uses {package}"));
        }
    }
}

/// Long files, and the size of all golden images.
fn sizes(files: &[File], findings: &mut Findings) {
    let architecture = files.iter().find(|f| f.path == ARCHITECTURE).map_or("", |f| f.text.as_str());
    let long = table::table(architecture, &["long file", "why"]).unwrap_or_default();
    for file in files.iter().filter(|f| f.path.starts_with("src/") && f.path.ends_with(".rs")) {
        let lines = file.text.lines().count();
        let excepted = long.iter().any(|row| row.cells[0] == file.path);
        if lines > LONGEST && !excepted && !locate(&file.path).2 {
            let what = format!(
                "{lines} lines, expected at most {LONGEST}, or a row in the table \"long file | why\" of {ARCHITECTURE}"
            );
            findings.add(&file.path, LONGEST + 1, what);
        }
    }
    for row in long.iter().filter(|row| files.iter().all(|f| f.path != row.cells[0])) {
        findings.add(ARCHITECTURE, row.line, format!("there is no file {}", row.cells[0]));
    }
    let golden: u64 = files.iter().filter(|f| f.path.starts_with(GOLDENS)).map(|f| f.bytes).sum();
    if golden > GOLDEN {
        findings.add("fixtures/golden", 0, format!("{golden} bytes, expected at most {GOLDEN}"));
    }
}

/// Every recorded reference has a reason: a line in the file of blessings that names it by its content.
fn blessings(files: &[File], findings: &mut Findings) {
    let reasons = files.iter().find(|f| f.path == BLESSINGS).map_or("", |f| f.text.as_str());
    let references =
        files.iter().filter(|f| f.path.starts_with(GOLDENS) && f.path.ends_with("/reference.json"));
    for file in references {
        let hash = content_hash(&file.text);
        if !reasons.contains(&hash) {
            let what = format!(
                "{hash}, expected a section in {BLESSINGS} that names it; `cargo xtask golden bless` writes one"
            );
            findings.add(&file.path, 0, what);
        }
    }
}

/// What a text is named by: the beginning of its SHA-256, hexadecimal.
pub(crate) fn content_hash(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().take(8).map(|b| format!("{b:02x}")).collect()
}

/// The table of costs was made from the scenes as they are.
fn costs(files: &[File], findings: &mut Findings) {
    let Some(readme) = files.iter().find(|f| f.path == README) else { return };
    let Some((line, number)) = readme.text.lines().zip(1..).find(|(l, _)| l.starts_with(crate::cost::BEGIN))
    else {
        return findings.add(README, 0, "no table of costs, expected the one that `cargo xtask cost` writes");
    };
    let table: Vec<&str> =
        readme.text.lines().skip(number).take_while(|l| !l.starts_with(crate::cost::END)).collect();
    for file in files.iter().filter(|f| f.path.starts_with("scenes/") && f.path.ends_with(".toml")) {
        let name = &file.path["scenes/".len()..];
        let expected = format!("{name} {}", content_hash(&file.text));
        if !line.contains(&expected) {
            let what = format!("costs of another version of {name}; `cargo xtask cost` measures them again");
            findings.add(README, number, what);
        }
        let row = format!("| {} |", name.trim_end_matches(".toml"));
        if !table.iter().any(|l| l.starts_with(&row)) {
            let what = format!("no costs of {name}; `cargo xtask cost` measures them");
            findings.add(README, number, what);
        }
    }
}

/// Words that may not stand in any file, or in one only.
fn words(files: &[File], findings: &mut Findings) {
    for file in files {
        for (line, number) in file.text.lines().zip(1..) {
            for word in MACHINE_PATHS {
                // Within a longer path it is a folder like any other.
                let starts =
                    |at: usize| !line[..at].ends_with(|c: char| c.is_alphanumeric() || "_-.})".contains(c));
                if line.match_indices(word).any(|(at, _)| starts(at)) {
                    findings.add(&file.path, number, format!("{word}, expected no path of one machine"));
                }
            }
        }
        if file.path.ends_with(".rs") && file.path != UNSAFE {
            for (line, _) in rust::tokens(&file.text).into_iter().filter(|(_, word)| *word == "unsafe") {
                findings.add(&file.path, line, format!("unsafe, expected only in {UNSAFE}"));
            }
        }
    }
}

/// Every scene begins by saying what it shows; a JSON Schema says so in itself.
fn headers(files: &[File], findings: &mut Findings) {
    let scenes = files.iter().filter(|f| f.path.starts_with("scenes/") && !f.path.ends_with(".schema.json"));
    for file in scenes {
        let mut comment = file.text.lines().take_while(|l| l.starts_with('#'));
        if comment.all(|l| l.starts_with("#:") || l.trim_matches(['#', ' ']).is_empty()) {
            findings.add(&file.path, 1, "no comment, expected one that says what the scene shows");
        }
    }
}

#[cfg(test)]
mod tests;

//! Each rule is broken once, and must be heard.

use super::*;

const TABLES: &str = "\
| module | may use |
|---|---|
| math | |
| color | math |
| scene | color |

| package | where it is used | for |
|---|---|---|
| libm | math | functions |
| insta | tests | snapshots |
";

/// A repository in which all is well, with `extra` added or put in the place of files of that name.
fn findings(extra: &[(&str, &str)]) -> Vec<String> {
    let mut files: BTreeMap<&str, &str> = BTreeMap::from([
        ("ARCHITECTURE.md", TABLES),
        ("Cargo.toml", "[dependencies]\nlibm = \"1\"\n[dev-dependencies]\ninsta = \"1\"\n"),
        ("src/lib.rs", "pub mod math;"),
        ("src/math/mod.rs", "pub fn sin(x: f32) -> f32 { libm::sinf(x) }"),
        ("src/color.rs", "use crate::math;\n#[cfg(test)]\nmod tests { use insta::assert_snapshot; }"),
        ("src/scene/mod.rs", "use crate::color::Rgb;\n#[cfg(test)]\nmod tests { use crate::math; }"),
        ("scenes/room.toml", "#:schema x.json\n#\n# A room.\nepsilux = 1"),
    ]);
    files.extend(extra.iter().copied());
    let file = |(path, text): (&&str, &&str)| File {
        path: (*path).to_owned(),
        bytes: text.len() as u64,
        text: (*text).to_owned(),
    };
    check(&files.iter().map(file).collect::<Vec<_>>())
}

/// What is expected to be found where one file is replaced.
fn check_file(path: &str, text: &str, expected: &[&str]) {
    assert_eq!(findings(&[(path, text)]), expected, "{path}: {text}");
}

#[test]
fn a_tidy_repository_has_no_findings() {
    assert_eq!(findings(&[]), [""; 0]);
}

/// Modules use only what their row names, however the path is written.
#[test]
fn modules_keep_to_their_row() {
    let base = "pub fn sin(x: f32) -> f32 { libm::sinf(x) }\n";
    for path in ["use crate::{scene::{Mesh}};", "use super::scene::Mesh;", "mod a { use crate::scene; }"] {
        let found = ["src/math/mod.rs:2: math uses scene, expected one of: "];
        check_file("src/math/mod.rs", &format!("{base}{path}"), &found);
    }
    let skipped = "use crate::color::Rgb;\nfn f() { crate::math::sin(1.0); }";
    check_file("src/scene/mod.rs", skipped, &["src/scene/mod.rs:2: scene uses math, expected one of: color"]);
    let found = ["src/scene/deep/file.rs:1: scene uses math, expected one of: color"];
    check_file("src/scene/deep/file.rs", "use super::super::super::math;", &found);
    check_file(
        "src/color.rs",
        "use crate::math;\n#[cfg(test)]\nmod t { use crate::scene::S; use insta::s; }",
        &["src/color.rs:3: a test in color uses scene, expected a module above color"],
    );
    check_file(
        "src/scene/mod.rs",
        "use crate::color; use crate::nothing::X;",
        &["src/scene/mod.rs:1: crate::nothing, expected a module of the table"],
    );
}

/// The table says what is, in an order without cycles.
#[test]
fn the_table_of_modules_is_the_truth() {
    let found = ["ARCHITECTURE.md:0: module light is missing in the table \"module | may use\""];
    check_file("src/light.rs", "pub struct Light;", &found);
    check_file(
        "src/color.rs",
        "#[cfg(test)] use insta::x;",
        &["ARCHITECTURE.md:4: color may use math, but does not"],
    );
    check_file(
        "ARCHITECTURE.md",
        &TABLES.replace("| math | |", "| math | color |\n| film | |"),
        &[
            "ARCHITECTURE.md:3: math may use color, but does not",
            "ARCHITECTURE.md:3: math may use color, expected only modules of rows above it",
            "ARCHITECTURE.md:4: src has no module film",
        ],
    );
    check_file(
        "ARCHITECTURE.md",
        "Text only",
        &[
            "ARCHITECTURE.md:0: no table begins with \"module | may use\"",
            "ARCHITECTURE.md:0: no table begins with \"package | where it is used | for\"",
        ],
    );
}

/// Packages stand in a manifest, in the table and in the modules that the table names, or in none.
#[test]
fn packages_keep_to_their_row() {
    let manifest = "[dependencies]\nlibm = \"1\"\nexr = \"1\"\n[dev-dependencies]\ninsta = \"1\"\n";
    let found = ["Cargo.toml:3: package exr, expected a row for it in ARCHITECTURE.md"];
    check_file("Cargo.toml", manifest, &found);
    check_file(
        "Cargo.toml",
        "[dependencies]\nlibm = \"1\"\n",
        &["ARCHITECTURE.md:10: no Cargo.toml asks for the package insta"],
    );
    check_file(
        "xtask/Cargo.toml",
        "[dependencies]\nclap = \"4\"\n",
        &["xtask/Cargo.toml:2: package clap, expected a row for it in ARCHITECTURE.md"],
    );
    check_file(
        "src/scene/mod.rs",
        "use crate::color;\nfn f() { libm::sin(1.0) }",
        &["src/scene/mod.rs:2: libm in scene, expected it only in: math"],
    );
    check_file(
        "tests/it/main.rs",
        "fn f() { libm::sin(1.0) }",
        &["tests/it/main.rs:1: libm in tests, expected it only in: math"],
    );
    check_file("src/math/mod.rs", "", &["ARCHITECTURE.md:9: nothing in math uses libm"]);
}

#[test]
fn long_files_need_a_reason() {
    let long = "\n".repeat(701);
    let found = [
        "src/math/table.rs:701: 701 lines, expected at most 700, or a row in the table \"long file | why\" of ARCHITECTURE.md",
    ];
    check_file("src/math/table.rs", &long, &found);
    check_file("src/math/table.rs", &long[1..], &[]);
    check_file("src/math/tests.rs", &long, &[]);
    let tables = format!("{TABLES}\n| long file | why |\n|---|---|\n| `src/math/table.rs` | data |\n");
    assert_eq!(findings(&[("ARCHITECTURE.md", &tables), ("src/math/table.rs", &long)]), [""; 0]);
    check_file("ARCHITECTURE.md", &tables, &["ARCHITECTURE.md:14: there is no file src/math/table.rs"]);
}

#[test]
fn golden_images_stay_small() {
    let file = |bytes| File { path: "fixtures/golden/a/mean.exr".to_owned(), bytes, text: String::new() };
    let mut found = Findings::default();
    sizes(&[file(GOLDEN)], &mut found);
    assert!(found.0.is_empty());
    sizes(&[file(GOLDEN), file(1)], &mut found);
    assert_eq!(found.0.len(), 1);
}

/// `unsafe` has one home; the word in a comment or as part of another is none.
#[test]
fn unsafe_has_one_home() {
    let math = "// unsafe\n#![deny(unsafe_code)]\nconst A: &str = \"unsafe\";\nuse libm::sin;";
    check_file("src/math/mod.rs", math, &[]);
    let found = ["tests/it/main.rs:2: unsafe, expected only in src/accel/simd.rs"];
    check_file("tests/it/main.rs", "fn f() {\n unsafe { g() } }", &found);
    let mut findings = Findings::default();
    words(&[File { path: UNSAFE.to_owned(), bytes: 0, text: "unsafe {}".to_owned() }], &mut findings);
    assert!(findings.0.is_empty());
}

#[test]
fn paths_of_one_machine_are_found() {
    for word in MACHINE_PATHS {
        let found = format!("notes.md:2: {word}, expected no path of one machine");
        check_file("notes.md", &format!("\nIt lies in `{word}x`."), &[&found]);
        check_file("notes.md", &format!("https://example.org{word}x, a{word}b, ${{X}}{word}"), &[]);
    }
}

#[test]
fn scenes_say_what_they_show() {
    let found = ["scenes/b.toml:1: no comment, expected one that says what the scene shows"];
    check_file("scenes/b.toml", "#:schema x.json\n\nepsilux = 1", &found);
    check_file("scenes/b.schema.json", "{}", &[]);
}

/// Guards that no golden reference changes without a reason that is kept.
#[test]
fn references_need_a_reason() {
    let reference = ("fixtures/golden/room/reference.json", "{}");
    // The first digits of the SHA-256 of `{}`.
    let found = "fixtures/golden/room/reference.json:0: 44136fa355b3678a, expected a section in fixtures/golden/BLESSINGS.md that names it; `cargo xtask golden bless` writes one";
    assert_eq!(findings(&[reference]), [found]);
    let reason = ("fixtures/golden/BLESSINGS.md", "## room\n\nreference.json 44136fa355b3678a.");
    assert_eq!(findings(&[reference, reason]), [""; 0]);
}

/// A scene that changes makes the table of costs stale, and a scene without a row has no costs.
#[test]
fn the_table_of_costs_is_that_of_the_scenes() {
    let scene = "#:schema x.json\n#\n# A room.\nepsilux = 1";
    let table = |hash: &str, row: &str| {
        format!("# x\n<!-- cost: all; room.toml {hash} -->\n\n{row}\n<!-- /cost -->\n| room | elsewhere |\n")
    };
    let (hash, row) = (content_hash(scene), "| room | 1200 |");
    check_file("README.md", &table(&hash, row), &[]);
    let found =
        ["README.md:2: costs of another version of room.toml; `cargo xtask cost` measures them again"];
    check_file("README.md", &table("0123456789abcdef", row), &found);
    let found = ["README.md:2: no costs of room.toml; `cargo xtask cost` measures them"];
    check_file("README.md", &table(&hash, "| hall | 1200 |"), &found);
    let found = ["README.md:0: no table of costs, expected the one that `cargo xtask cost` writes"];
    check_file("README.md", "# x\n", &found);
}

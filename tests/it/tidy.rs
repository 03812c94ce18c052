//! The repository keeps the promises that ARCHITECTURE.md makes.

use std::path::Path;
use std::process::Command;

/// Guards module and package tables, file sizes and the like; `cargo xtask tidy` says what is wrong. Works
/// from a git checkout only, so a copy without history has nothing to check.
#[test]
fn the_repository_is_tidy() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    if !root.join(".git").exists() {
        return;
    }
    let run = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--package", "xtask", "--", "tidy"])
        .current_dir(root)
        .output()
        .expect("cargo starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

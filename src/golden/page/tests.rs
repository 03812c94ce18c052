//! What a page promises.

use super::*;

fn about() -> About {
    About {
        title: "Golden tests".into(),
        command: "epsilux golden verify golden.toml --page golden.html".into(),
        significance: 1e-3,
        facts: vec![("Version".into(), "0.1.0".into()), ("Machine".into(), "2 cores, x86-64".into())],
    }
}

/// Writes the page into the folder for temporary files, for whoever works on its looks.
#[test]
#[ignore = "writes a file to look at"]
fn writes_a_page_to_look_at() {
    let path = std::env::temp_dir().join("epsilux-golden-page.html");
    std::fs::write(path, page(&made::verifications(), &about())).unwrap();
}

//! `epsilux cost`: a page, figures, and what is said where it goes wrong.

use crate::command::Folder;

/// Sizes for tests: a moment each.
const SMALL: &str = "--spp 8 --seeds 2 --width 16 --size 64x64";

/// Guards that one command makes a page and figures, and that figures but seconds are the same for any number of
/// threads.
#[test]
fn writes_a_page_and_figures() {
    let folder = Folder::with_room();
    let said = folder.done(&format!("cost room.toml {SMALL} --json a.json -o a.html"));
    assert_eq!(said.out, "a.html\na.json\n");
    assert!(said.err.starts_with("1 % costs "), "{}", said.err);
    let page = String::from_utf8(folder.read("a.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<h2>What would I give up?</h2>"));
    folder.done(&format!("cost room.toml {SMALL} --json b.json -q --threads 3"));
    assert_eq!(folder.names(), ["a.html", "a.json", "b.json", "room.toml"]);
    let figures = |name: &str| {
        let json: serde_json::Value = serde_json::from_slice(&folder.read(name)).unwrap();
        assert_eq!(json["schema"], "epsilux.cost/1");
        let ways = json["switches"].as_array().unwrap();
        let of =
            |w: &serde_json::Value| (w["name"].clone(), w["rays_per_sample"].clone(), w["points"].clone());
        (json["scene_sha256"].clone(), json["layers"].clone(), ways.iter().map(of).collect::<Vec<_>>())
    };
    assert_eq!(figures("a.json"), figures("b.json"));
}

/// Guards that mistakes are said before the work, and that nothing is written then.
#[test]
fn mistakes_are_said_first() {
    let folder = Folder::with_room();
    let fails = |line: &str, code: i32, says: &str| {
        let said = folder.run(line);
        assert_eq!(said.code, Some(code), "{line}: {}", said.err);
        assert!(said.err.contains(says), "{line}: {}", said.err);
    };
    fails("cost room.toml -o missing/a.html", 6, "missing/a.html: the folder missing does not exist");
    fails("cost room.toml --camera none", 2, "expected one of: near, far");
    fails("cost room.toml --spp 8 --budget 1s", 2, "cannot be used with");
    fails("cost none.toml", 4, "no such file");
    assert_eq!(folder.names(), ["room.toml"]);
}

//! Comparing image files from the command line.

use epsilux::output::read;
use serde_json::Value;

use crate::command::Folder;

/// Two seeds differ by noise only (0); other light is another picture (1); a file and itself are
/// identical (0).
#[test]
fn exit_codes() {
    let folder = Folder::with_room();
    let room = String::from_utf8(folder.read("room.toml")).unwrap();
    folder.write("brighter.toml", room.replace("light = [14, 14, 14]", "light = [16, 16, 16]"));
    for (name, scene, seed) in [("a", "room", 1), ("b", "room", 2), ("c", "brighter", 3)] {
        folder.done(&format!(
            "render {scene}.toml --size 48x48 --spp 64 --max-depth 3 -q --seed {seed} -o {name}.exr -o {name}.png"
        ));
    }
    for (line, code, verdict) in [
        ("compare a.exr a.exr", 0, "identical"),
        ("compare a.exr b.exr", 0, "no significant difference"),
        ("compare a.exr c.exr", 1, "differs"),
        ("compare a.png b.png", 1, "differs"),
        ("compare a.png a.png", 0, "identical"),
    ] {
        let said = folder.run(line);
        assert_eq!(said.code, Some(code), "{line}: {}{}", said.out, said.err);
        assert!(said.out.contains(&format!("verdict   {verdict}")), "{line}: {}", said.out);
    }
    let said = folder.run("compare a.exr c.exr --json --map map.png");
    let json: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!((&json["schema"], &json["verdict"]), (&"epsilux.compare/1".into(), &"differs".into()));
    let map = read(&folder.path("map.png")).unwrap();
    assert!(map.rgb.iter().any(|c| c.luminance() > 0.0));
}

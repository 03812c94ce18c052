//! `epsilux golden`: from a list of scenes to verdicts, pages and blessings.

use std::fmt::Write;

use crate::command::Folder;

const ROOM: &str = "epsilux = 1
[camera]
front = { eye = [0, 1, 4], target = [0, 1, 0], fov = 40 }
[material]
floor = { diffuse = [0.7, 0.6, 0.5] }
lamp = { light = [8, 7, 6] }
[[object]]
name = \"floor\"
material = \"floor\"
rect = { corner = [-3, 0, 3], edges = [[6, 0, 0], [0, 0, -6]] }
[[object]]
name = \"ball\"
material = \"floor\"
sphere = { center = [0, 0.8, 0], radius = 0.8 }
[[object]]
name = \"lamp\"
material = \"lamp\"
rect = { corner = [1, 3, 1], edges = [[1, 0, 0], [0, 0, 1]], facing = [0, 0, 0] }
";

const SUITE: &str = "golden = 1

[[scene]]
name = \"room\"
file = \"room.toml\"
size = [16, 16]
spp = 32
guards = \"a lamp & a shadow\"
";

fn with_suite() -> Folder {
    let folder = Folder::new();
    folder.write("room.toml", ROOM);
    folder.write("golden.toml", SUITE);
    folder
}

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).expect("text")
}

/// The whole life of a golden: recorded, verified, edited, refused with the culprit's name, blessed, and verified
/// again; with the files that machines and people read.
#[test]
fn a_golden_lives() {
    let folder = with_suite();
    let said = folder.done("golden record");
    assert!(said.err.contains("room: 16x16, files about"), "{}", said.err);
    assert_eq!(folder.names(), ["BLESSINGS.md", "golden.toml", "room", "room.toml"]);
    assert!(text(&folder, "BLESSINGS.md").contains("## room: recorded, 20"));
    let reference = folder.read("room/reference.json");

    // What is recorded is left alone.
    let again = folder.done("golden record");
    assert!(again.err.contains("recorded already, left alone: room"), "{}", again.err);
    assert_eq!(folder.read("room/reference.json"), reference);

    let said = folder.done("golden verify --junit out.xml --html out.html");
    assert!(said.out.starts_with("passed    room"), "{}", said.out);
    assert!(said.out.contains("1 scene: 1 passed"), "{}", said.out);
    assert!(!text(&folder, "out.xml").contains("<failure"));
    let page = text(&folder, "out.html");
    assert!(page.contains("a lamp &amp; a shadow") && !page.contains("http://"), "the page is whole");
    let bytes = folder.done("golden verify --json");
    assert!(bytes.out.contains("the picture is the recorded one, bit for bit"), "{}", bytes.out);

    // A lamp a tenth brighter.
    folder.write("room.toml", ROOM.replace("[8, 7, 6]", "[8.8, 7.7, 6.6]"));
    let said = folder.run("golden verify --junit out.xml");
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.out.contains("scene: the scene has changed"), "{}", said.out);
    let said = folder.run("golden verify --edited --junit out.xml --json");
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.out.contains("direct light +10") || said.out.contains("direct light +9"), "{}", said.out);
    assert!(text(&folder, "out.xml").contains("<failure message="));
    let json: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(json["scenes"][0]["verdict"], "refused");
    let replay = json["scenes"][0]["replay"].as_str().expect("a command").replace("epsilux ", "");
    folder.done(&replay);

    // Blessing says what changed, and why.
    let said = folder.run("golden bless golden.toml room --reason= ");
    assert_eq!(said.code, Some(2), "{}", said.err);
    let said = folder
        .command("golden bless golden.toml room --allow-dirty")
        .args(["--reason", "a warmer lamp"])
        .output()
        .expect("it runs");
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    let blessings = text(&folder, "BLESSINGS.md");
    assert!(blessings.contains("Reason: a warmer lamp"), "{blessings}");
    assert!(blessings.contains("## room: the mean changed, 20"), "{blessings}");
    assert!(blessings.contains("| direct | +10") || blessings.contains("| direct | +9"), "{blessings}");
    folder.done("golden verify");

    // The picture of a render is judged without its noise.
    folder.done("render room.toml -o other.exr --size 16x16 --spp 256 --seed 7 -q");
    let said = folder.done("golden verify --image room=other.exr --json");
    assert!(said.out.contains("noise and layers are not judged"), "{}", said.out);
    let power = folder.done("golden power");
    assert!(power.out.contains("room") && power.out.contains("all light"), "{}", power.out);
}

/// Every mistake says what was found, where, and what was expected.
#[test]
fn mistakes_about_goldens_are_explained() {
    let folder = with_suite();
    folder.write("version.toml", SUITE.replace("golden = 1", "golden = 2"));
    folder.write("key.toml", SUITE.replace("guards", "gaurds"));
    folder.write("spp.toml", SUITE.replace("spp = 32", "spp = 33"));
    folder.write("size.toml", SUITE.replace("[16, 16]", "[16, 4096]"));
    folder.write("file.toml", SUITE.replace("room.toml", "rom.toml"));
    folder.write("camera.toml", SUITE.to_owned() + "camera = \"back\"\n");
    folder.write("black.toml", SUITE.replace("room.toml", "dark.toml"));
    folder.write("dark.toml", ROOM.replace("[8, 7, 6]", "[0, 0, 0]"));
    folder.write("text.toml", "golden");
    std::fs::create_dir(folder.path("broken")).expect("a folder");
    folder.write("broken/reference.json", "{ \"schema\": \"epsilux.golden/9\" }");
    folder.write("broken.toml", SUITE.replace("name = \"room\"", "name = \"broken\""));
    let mut transcript = String::new();
    for (line, code) in [
        ("golden verify nothing.toml", 4),
        ("golden verify text.toml", 4),
        ("golden verify version.toml", 4),
        ("golden verify key.toml", 4),
        ("golden verify spp.toml", 4),
        ("golden verify size.toml", 4),
        ("golden verify", 4),
        ("golden verify --scene rom", 2),
        ("golden verify --image room", 2),
        ("golden verify --image rom=a.exr", 2),
        ("golden verify --html missing/page.html", 6),
        ("golden verify broken.toml", 4),
        ("golden record file.toml", 4),
        ("golden record camera.toml", 2),
        ("golden record --runs 10", 2),
    ] {
        let said = folder.run(line);
        assert_eq!((said.code, said.out.as_str()), (Some(code), ""), "{line}: {}", said.err);
        writeln!(transcript, "$ epsilux {line}\n{}[exit code {code}]\n", said.err).expect("a string");
    }
    insta::assert_snapshot!(transcript);
}

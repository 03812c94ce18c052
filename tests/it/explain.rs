//! What `explain` says: every scene and every fixture, and the pictures that carry it.

use std::path::Path;

use epsilux::output::read_exr;
use serde_json::Value;

use crate::command::Folder;
use crate::roundtrip::{read, sources};

/// The plan of each file that is a scene and whose name begins with `folder`, as a user reads it.
fn plans(folder: &str, flags: &str) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut said = String::new();
    for path in sources() {
        let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
        if !name.starts_with(folder) || read(&path).is_none() {
            continue;
        }
        let mut command = Folder::new().command(&format!("explain {name}{flags}"));
        let output = command.current_dir(root).output().unwrap();
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        said += &format!("$ epsilux explain {name}{flags}\n{}\n", String::from_utf8(output.stdout).unwrap());
    }
    said
}

/// What is simulated of each scene that a user would render, and what a pilot chooses, read by eye for truth.
#[test]
fn scenes() {
    insta::assert_snapshot!(plans("scenes/", ""));
}

/// The same of what Blender exported, and of pictures in the text form, without a pilot.
#[test]
fn fixtures() {
    insta::assert_snapshot!(plans("fixtures/blender/", " --spp 8") + &plans("fixtures/text/", " --spp 8"));
}

/// The same of the golden scenes.
#[test]
fn goldens() {
    insta::assert_snapshot!(plans("fixtures/golden/", " --spp 8"));
}

/// What a scene can have and not call for: each thing that cannot matter is named as the reason.
const IDLE: &str = r#"
epsilux = 1
material.floor = { diffuse = [0.5, 0.5, 0.5] }
material.brass = { principled = { metallic = 1.0 } }
material.lamp = { light = [5, 5, 5] }
material.void = { mirror = [0, 0, 0] }
material.water = { glass = { ior = 1.33, absorption = { color = [1, 1, 1], distance = 1.0 } } }
environment = { radiance = [0, 0, 0] }
camera.a = { eye = [0, 1, 5], target = [0, 0, 0], fov = 40 }
[[object]]
material = "floor"
rect = { corner = [-2, 0, -2], edges = [[0, 0, 4], [4, 0, 0]] }
[[object]]
material = "void"
sphere = { radius = 1 }
[[object]]
material = "water"
sphere = { center = [2, 1, 0], radius = 1 }
[[object]]
material = "lamp"
sphere = { center = [0, 5, 0], radius = 1 }
[[light]]
name = "fill"
point = { intensity = [0, 0, 0] }
position = [0, 3, 0]
[[light]]
name = "panel"
area = { size = [1, 1], radiance = [0, 0, 0] }
position = [0, 3, 0]
direction = [0, -1, 0]
"#;

/// What cannot matter counts as absent, and is said to be the reason.
#[test]
fn what_cannot_matter_is_named() {
    let folder = Folder::new();
    folder.write("idle.toml", IDLE);
    insta::assert_snapshot!(folder.done("explain idle.toml --spp 8").out);
}

/// Points behind glass: what path tracing does not find is said, and only where there is such light.
#[test]
fn light_that_no_path_finds_is_said() {
    let folder = Folder::new();
    let unseen = |name: &str, light: &str, material: &str| {
        let scene = format!(
            "epsilux = 1
material.ball = {material}
material.floor = {{ diffuse = [0.5, 0.5, 0.5] }}
camera.a = {{ eye = [0, 1, 5], target = [0, 0, 0], fov = 40 }}
[[light]]
{light}
[[object]]
material = \"ball\"
sphere = {{ radius = 1 }}
[[object]]
material = \"floor\"
rect = {{ corner = [-2, -1, -2], edges = [[0, 0, 4], [4, 0, 0]] }}
"
        );
        folder.write(name, scene);
        let by_photons = folder.done(&format!("explain {name} --spp 8")).out;
        assert!(!by_photons.contains("not modelled"), "{by_photons}");
        let out = folder.done(&format!("explain {name} --spp 8 --algorithm caustics=path")).out;
        out.lines().find(|l| l.starts_with("not modelled")).map(str::to_owned)
    };
    let point = "name = \"bulb\"\npoint = { intensity = [9, 9, 9] }\nposition = [0, 3, 0]";
    let ball = "point = { intensity = [9, 9, 9], radius = 0.1 }\nposition = [0, 3, 0]";
    let sun = "name = \"noon\"\nsun = { irradiance = [9, 9, 9], angle = 0 }\ndirection = [0, -1, 0]";
    let said = [
        unseen("a.toml", point, "{ glass = { ior = 1.5 } }"),
        unseen("b.toml", sun, "{ mirror = [0.9, 0.9, 0.9] }"),
        unseen("c.toml", sun, "{ principled = { coat = 1.0 } }"),
    ];
    insta::assert_snapshot!(said.map(Option::unwrap_or_default).join("\n"));
    for (light, material) in [
        (ball, "{ glass = { ior = 1.5 } }"),
        (point, "{ principled = { metallic = 1.0, roughness = 0.2 } }"),
        (point, "{ mirror = [0, 0, 0] }"),
    ] {
        assert_eq!(unseen("d.toml", light, material), None, "{light} {material}");
    }
}

/// The picture carries the plan: the facts of `explain --json` but for the kernel, and their hash.
#[test]
fn the_picture_carries_its_plan() {
    let folder = Folder::with_room();
    folder.done("render room.toml --size 8x6 --spp 1 -q -o a.exr");
    folder.done("render room.toml --size 8x6 --spp 1 -q -o b.exr --camera far");
    let attribute = |file: &str, name: &str| {
        let image = read_exr(&folder.path(file)).unwrap();
        image.attributes.into_iter().find(|(n, _)| n == name).unwrap().1
    };
    let json = |line: &str| -> Value { serde_json::from_str(&folder.done(line).out).unwrap() };
    let mut explained = json("explain room.toml --json --spp 1");
    let carried: Value = serde_json::from_str(&attribute("a.exr", "plan")).unwrap();
    assert_eq!(explained["plan_sha256"], attribute("a.exr", "plan_sha256"));
    assert_eq!(explained["plan_sha256"].as_str().unwrap().len(), 64);
    let report: Value = serde_json::from_slice(&folder.read("a.report.json")).unwrap();
    assert_eq!(report["plan_sha256"], explained["plan_sha256"]);
    assert_eq!(report["plan"]["kernel"]["name"], "report");
    let facts = explained.as_object_mut().unwrap();
    for key in ["schema", "file", "camera", "notes", "plan_sha256", "kernel"] {
        assert!(facts.remove(key).is_some(), "{key}");
    }
    assert_eq!(carried, explained);
    // The same plan from another place, another one for another scene.
    assert_eq!(attribute("b.exr", "plan"), attribute("a.exr", "plan"));
    let all = json("explain room.toml --json --effects all --spp 1");
    assert_eq!((&all["kernel"]["name"], &all["plan_sha256"]), (&"everything".into(), &report["plan_sha256"]));
    folder.write("idle.toml", IDLE);
    assert_ne!(json("explain idle.toml --json --spp 1")["plan_sha256"], report["plan_sha256"]);
}

/// A pilot's plan is the same whoever makes it: `explain`, a render on any number of threads, and a part; and the
/// picture carries it.
#[test]
fn pilots_agree() {
    let folder = Folder::new();
    std::fs::copy(crate::command::scene("caustic.toml"), folder.path("c.toml")).expect("a copy");
    let size = "--size 128x96";
    folder.done(&format!("render c.toml {size} --spp 64 --threads 1 -q -o a.exr"));
    folder.done(&format!("render c.toml {size} --passes 0..1 --threads 3 -q -o b.exr"));
    let plan = |file: &str| {
        let image = read_exr(&folder.path(file)).unwrap();
        image.attributes.into_iter().filter(|(n, _)| n.starts_with("plan")).collect::<Vec<_>>()
    };
    let (a, b) = (plan("a.exr"), plan("b.exr"));
    assert_eq!(a, b);
    assert!(a.iter().any(|(_, text)| text.contains("\"pilot\"")), "{a:?}");
    let explained: Value =
        serde_json::from_str(&folder.done(&format!("explain c.toml {size} --json")).out).unwrap();
    assert!(a.contains(&("plan_sha256".to_owned(), explained["plan_sha256"].as_str().unwrap().to_owned())));
}

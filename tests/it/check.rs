//! `epsilux check`: the catalogue and its figures, and invariants on a scene of the user's.

use crate::command::Folder;

/// The report's room holds to everything; what is asked for as JSON is JSON.
#[test]
fn a_sound_scene_holds() {
    let folder = Folder::with_room();
    let said = folder.done("check --scene room.toml");
    for line in
        ["holds    samples", "holds    threads", "holds    kernels", "holds    scale", "holds    camera"]
    {
        assert!(said.out.contains(line), "{line}: {}", said.out);
    }
    let json = folder.done("check --scene room.toml --json");
    let json: serde_json::Value = serde_json::from_str(&json.out).expect("JSON");
    assert_eq!(json["schema"], "epsilux.check-scene/1");
}

/// What is wrong with a scene is said: a camera in glass, a lamp without power, a triangle without area, light
/// without a length.
#[test]
fn what_is_wrong_with_a_scene_is_said() {
    let folder = Folder::new();
    folder.write(
        "odd.toml",
        "epsilux = 1
environment = { radiance = [1, 1, 1] }
camera.eye = { eye = [0, 0, 0.1], target = [0, 0, -1], fov = 40 }
material.clear = { glass = { ior = 1.5 } }
material.off = { light = [0, 0, 0] }
material.white = { diffuse = [0.5, 0.5, 0.5] }
[[object]]
material = \"clear\"
sphere = { radius = 1 }
[[object]]
material = \"off\"
sphere = { center = [0, 3, 0], radius = 1 }
[[object]]
material = \"white\"
mesh = { positions = [[0, 0, -3], [1, 0, -3], [0, 1, -3], [2, 0, -3]], triangles = [[0, 1, 2], [0, 1, 3]] }
",
    );
    let said = folder.done("check --scene odd.toml");
    assert!(said.out.contains("the camera stands inside of \"sphere 1\""), "{}", said.out);
    assert!(said.out.contains("lamps without power: off"), "{}", said.out);
}

/// Glass that reaches into other glass is said, where no order says which of them is there.
#[test]
fn bodies_without_an_order_are_said() {
    let folder = Folder::new();
    let scene = |priority: &str| {
        format!(
            "epsilux = 1
environment = {{ radiance = [1, 1, 1] }}
camera.eye = {{ eye = [0, 0, 9], target = [0, 0, 0], fov = 40 }}
material.glass = {{ glass = {{ ior = 1.5{priority} }} }}
material.water = {{ glass = {{ ior = 1.33{priority} }} }}
[[object]]
name = \"bowl\"
material = \"glass\"
sphere = {{ radius = 1 }}
[[object]]
name = \"lake\"
material = \"water\"
box = {{ center = [0, -1, 0], size = [3, 1, 3] }}
"
        )
    };
    folder.write("loose.toml", scene(""));
    let said = folder.done("check --scene loose.toml");
    assert!(said.out.contains("look     bodies     \"bowl\" and \"lake\" overlap"), "{}", said.out);
    folder.write("ordered.toml", scene(", priority = 1"));
    let said = folder.done("check --scene ordered.toml");
    assert!(said.out.contains("holds    bodies"), "{}", said.out);
}

/// What is not in the catalogue is refused with what is.
#[test]
fn unknown_cases_are_refused() {
    let said = Folder::new().run("check N999");
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("found \"N999\", expected some of: N"), "{}", said.err);
}

//! What lies beside the OBJ file.

use super::*;
use crate::color::Rgb;
use crate::scene::{MaterialKind, Shape, complete, validate};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 2\n";

fn with(sidecar: &str) -> Result<(Scene, Vec<Note>), ImportError> {
    let text = format!("epsilux = 1\n{sidecar}");
    try_load(&[("scene.obj", OBJ.as_bytes()), ("scene.epsilux.toml", text.as_bytes())])
}

/// Guards that a sidecar completes the scene, and that its materials win.
#[test]
fn it_adds_what_obj_cannot_hold() {
    let (mut scene, notes) = with(
        "title = \"a test\"
        render = { size = [64, 48], spp = 4 }
        camera.front = { eye = [0, 0, 5], target = [0, 0, 0], fov = 40 }
        environment = { radiance = [0.1, 0.2, 0.3] }
        [material]
        red = { diffuse = [1, 0, 0] }
        ball = { mirror = [0.5, 0.5, 0.5] }
        spare = { mirror = [1, 1, 1] }
        [[object]]
        name = \"ball\"
        material = \"ball\"
        sphere = { radius = 0.5 }
        [[object]]
        name = \"floor\"
        material = \"red\"
        rect = { corner = [0, 0, 0], edges = [[1, 0, 0], [0, 0, 1]] }
        [[light]]
        name = \"sun\"
        sun = { irradiance = [3, 3, 3] }",
    )
    .unwrap();
    assert_eq!(codes(&notes), ["material-missing", "material-unused"]);
    assert!(notes[1].place.starts_with("scene.epsilux.toml: material.spare"), "{}", notes[1]);
    let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["red", "blue", "ball"]);
    assert_eq!(scene.materials[0].kind, MaterialKind::Diffuse { color: Rgb::new(1.0, 0.0, 0.0) });
    let placed: Vec<_> = scene.objects.iter().map(|o| (o.name.as_str(), o.material.0)).collect();
    assert_eq!(placed, [("scene", 0), ("scene", 1), ("ball", 2), ("floor", 0)]);
    let Shape::Mesh(floor) = scene.objects[3].shape else { panic!() };
    assert_eq!(scene.meshes[floor.0 as usize].triangles.len(), 2);
    assert_eq!((scene.lights.len(), scene.cameras[0].name.as_str()), (1, "front"));
    assert_eq!((scene.settings.size, scene.title.as_str()), (Some([64, 48]), "a test"));
    assert!(validate(&mut scene).is_ok() && complete(&mut scene).is_empty());
}

/// Guards that the pictures of a sidecar stay its own beside those of the material library.
#[test]
fn its_pictures_stand_behind_those_of_the_materials() {
    let obj = format!("mtllib scene.mtl\n{OBJ}");
    let mtl = "newmtl red\nKd 1 1 1\nnewmtl blue\nmap_Kd first.png\n";
    let sidecar = "epsilux = 1\n[image]\nown = \"second.png\"\n\
        [material]\nred = { principled = { base_color_texture = \"own\", normal_texture = \"own\", \
        roughness_texture = \"own\" } }\n\
        [environment]\nradiance = [1, 1, 1]\nimage = \"own\"\n";
    let (scene, _) = try_load(&[
        ("scene.obj", obj.as_bytes()),
        ("scene.mtl", mtl.as_bytes()),
        ("scene.epsilux.toml", sidecar.as_bytes()),
        ("first.png", &materials::png(|_| [1; 4])),
        ("second.png", &materials::png(|_| [2; 4])),
    ])
    .unwrap();
    let file = |image: crate::scene::ImageId| scene.images[image.0 as usize].file.clone().unwrap_or_default();
    let files = |name: &str| -> Vec<String> {
        let material = scene.materials.iter().find(|m| m.name == name).unwrap();
        let MaterialKind::Principled(p) = &material.kind else { panic!("{name}") };
        p.textures.iter().map(|(_, t)| file(t.image)).collect()
    };
    assert_eq!(files("blue"), ["first.png"]);
    assert_eq!(files("red"), ["second.png"; 3]);
    let sky = scene.environment.as_ref().and_then(|e| e.image).unwrap();
    assert_eq!(file(sky.image), "second.png");
}

/// Guards that the scene's own defaults still come where neither says anything.
#[test]
fn an_empty_one_changes_nothing() {
    let (mut scene, notes) = with("").unwrap();
    assert_eq!(codes(&notes), ["material-missing", "material-missing"]);
    assert_eq!(complete(&mut scene).len(), 2);
}

/// Guards that a mistake names the sidecar and not the OBJ file.
#[test]
fn mistakes_name_its_file_and_line() {
    let check = |sidecar: &str, expected: &str| {
        let e = with(sidecar).unwrap_err().to_string();
        let (_, said) = e.split_once("scene.epsilux.toml: ").unwrap_or(("", &e));
        assert!(said.starts_with(expected), "{e}");
    };
    check("objct = 1", "line 2, column 1: unknown key");
    check("[[object]]\nmaterial = 'gone'\nsphere = { radius = 1 }", "line 3");
    check("[material.m.principled]\nbase_color_texture = { file = 'gone.png' }", "line 3");
    check("[environment]\nimage = { file = '../../etc/passwd' }", "line 3");
    check("render = { spp = nan }", "line 2");
}

//! `epsilux convert`: what it writes, what it says, and what it refuses.

use std::fmt::Write;

use crate::command::Folder;

/// A scene with a picture.
const TEXTURED: &str = "epsilux = 1
image.wood = \"pictures/wood.png\"
material.table.principled = { base_color_texture = \"wood\" }
[[object]]
material = \"table\"
mesh = { positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], uvs = [[0, 1], [1, 1], [0, 0]], triangles = [[0, 1, 2]] }
";

fn with_pictures() -> Folder {
    let folder = Folder::with_room();
    folder.write("textured.toml", TEXTURED);
    std::fs::create_dir(folder.path("pictures")).unwrap();
    let wood = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/text/pictures/wood.png");
    std::fs::copy(wood, folder.path("pictures/wood.png")).unwrap();
    folder
}

/// One line of result, notes on the other stream, and files that read back.
#[test]
fn what_is_written_is_said_in_one_line() {
    let folder = with_pictures();
    let mut transcript = String::new();
    for line in [
        "convert room.toml room.json",
        "convert room.json again.toml --strict",
        "convert textured.toml copy.toml",
        "convert room.toml room.obj",
        "convert room.toml ROOM2.OBJ --strict",
        "info copy.toml",
    ] {
        let said = folder.done(line);
        writeln!(transcript, "$ epsilux {line}\n{}{}", said.err, said.out).unwrap();
    }
    insta::assert_snapshot!(transcript);
    let expected = [
        "ROOM2.OBJ",
        "ROOM2.epsilux.toml",
        "ROOM2.mtl",
        "again.toml",
        "copy.images",
        "copy.toml",
        "pictures",
        "room.epsilux.toml",
        "room.json",
        "room.mtl",
        "room.obj",
        "room.toml",
        "textured.toml",
    ];
    assert_eq!(folder.names(), expected);
    assert_eq!(folder.read("copy.images/wood.png"), folder.read("pictures/wood.png"));
    let json: serde_json::Value = serde_json::from_slice(&folder.read("room.json")).unwrap();
    assert_eq!(json["epsilux"], 1);
    // The canonical form of the canonical form is itself.
    folder.done("convert again.toml thrice.toml");
    assert_eq!(folder.read("again.toml"), folder.read("thrice.toml"));
}

/// The report's room through GLB, spheres and all, renders to the same picture, bit for bit.
#[test]
fn the_room_through_glb_renders_to_the_same_bytes() {
    let folder = Folder::with_room();
    folder.done("convert room.toml glb.glb");
    folder.done("convert glb.glb back.toml");
    let picture = |name: &str| {
        folder.done(&format!("render {name} -o {name}.exr --size 32x32 --spp 4"));
        epsilux::output::read_exr(&folder.path(&format!("{name}.exr"))).unwrap()
    };
    let room = picture("room.toml");
    assert!(room.rgb.iter().any(|c| c.max_channel() > 0.1));
    for name in ["glb.glb", "back.toml"] {
        let other = picture(name);
        let bits = |image: &epsilux::film::Image| -> Vec<[u32; 3]> {
            image.rgb.iter().map(|c| c.to_array().map(f32::to_bits)).collect()
        };
        assert!(bits(&room) == bits(&other), "{name}");
    }
}

/// What is refused is refused before anything is written.
#[test]
fn what_cannot_be_converted_is_refused() {
    let folder = with_pictures();
    let clear = TEXTURED.replace("uvs =", "colors = [[1, 1, 1, 0.5], [1, 1, 1, 1], [1, 1, 1, 1]], uvs =");
    folder.write("clear.toml", clear);
    folder.write("copy.epsilux.toml", TEXTURED);
    folder.write("taken.mtl", "# by hand");
    folder.write("missing.toml", TEXTURED.replace("wood.png", "oak.png"));
    // Its own picture lies where the picture of another one would go.
    std::fs::create_dir(folder.path("odd.images")).unwrap();
    std::fs::write(folder.path("odd.images/wood.png"), [0]).unwrap();
    std::fs::copy(
        concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/text/pictures/leaf.png"),
        folder.path("odd.images/wood.png"),
    )
    .unwrap();
    folder.write(
        "odd.toml",
        format!("{TEXTURED}[environment]\nimage = {{ file = \"odd.images/wood.png\" }}\n"),
    );
    let before = folder.names();
    let mut transcript = String::new();
    for (line, code) in [
        ("convert room.toml", 2),
        ("convert room.toml room.ply", 2),
        ("convert room.toml room", 2),
        ("convert room.toml room.toml", 2),
        ("convert room.toml ./room.toml", 2),
        ("convert copy.epsilux.toml copy.obj", 2),
        ("convert odd.toml odd.json", 2),
        ("convert textured.toml taken.obj", 2),
        ("convert nothing.toml room.json", 4),
        ("convert missing.toml room.json", 4),
        ("convert clear.toml clear.obj --strict", 5),
        ("convert room.toml missing/room.json", 6),
        ("convert room.toml pictures/../odd.images/deeper/room.json", 6),
    ] {
        let said = folder.run(line);
        writeln!(transcript, "$ epsilux {line}\n{}[exit code {}]\n", said.err, said.code.unwrap()).unwrap();
        assert_eq!((said.code, said.out.as_str()), (Some(code), ""), "{line}: {}", said.err);
    }
    assert_eq!(folder.names(), before, "nothing was written");
    insta::assert_snapshot!(transcript);
}

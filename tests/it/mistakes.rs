//! Bad input: message and exit code.

use std::fmt::Write;

use crate::command::{DARK, Folder};

/// Every mistake says what was found, where, and what was expected, and ends in the code that the help
/// lists. Nothing is written.
#[test]
fn mistakes_are_explained() {
    let folder = Folder::with_room();
    let room = String::from_utf8(folder.read("room.toml")).unwrap();
    folder.write("typo.toml", room.replace("radius = 1.5", "radus = 1.5"));
    folder.write("type.toml", room.replace("radius = 1.5", "radius = \"big\""));
    folder.write("broken.toml", room.replace("[camera]", "[camera"));
    folder.write("material.toml", room.replace("material = \"orange\"", "material = \"ornage\""));
    folder.write("cut.glb", b"glTF\x02\0\0\0\xff\0\0\0\x10\0\0\0JSON{");
    folder.write("needs.gltf", r#"{"asset":{"version":"2.0"},"extensionsRequired":["VENDOR_unheard_of"]}"#);
    folder.write("dark.toml", DARK);
    folder.write(
        "lamp.toml",
        DARK.to_owned() + "[[light]]\nname = \"lamp\"\npoint = { intensity = [1, 1, 1] }\n",
    );
    folder.write(
        "rough.toml",
        room.replace(
            "mirror = { mirror = [1, 1, 1] }",
            "mirror = { principled = { metallic = 1, roughness = 0.2 } }",
        ),
    );
    folder.write("room.blend", "BLENDER-v500");
    folder.write("bytes.toml", b"\xff\xfe");
    folder.write("text.png", "no picture");
    let before = folder.names();
    let mut transcript = String::new();
    for (line, code) in [
        ("render nothing.toml", 4),
        ("render nothing.glb", 4),
        ("render cut.glb", 4),
        ("render needs.gltf", 4),
        ("render room.blend", 4),
        ("render typo.toml", 4),
        ("info type.toml", 4),
        ("explain broken.toml", 4),
        ("info material.toml", 4),
        ("info bytes.toml", 4),
        ("render room.toml -o missing/room.png", 6),
        ("render room.toml -o room.jpg", 6),
        ("render room.toml --size 0x0", 2),
        ("render room.toml --size 800", 2),
        ("render room.toml --camera nera", 2),
        ("render room.toml --crop 790,790,20,20 --spp 1", 2),
        ("render room.toml --crop 0,0,0,5", 2),
        ("render room.toml --time soon", 2),
        ("render room.toml --spp 0", 2),
        ("render room.toml --exposure bright", 2),
        ("render room.toml --tone filmic", 2),
        ("render room.toml -o room.png --aov normal", 2),
        ("render room.toml --method reference --time 3s", 2),
        ("render room.toml --method report --time 3s", 2),
        ("render room.toml --as-printed", 2),
        ("render room.toml --method report --as-printed=shlick", 2),
        ("render lamp.toml --method report", 4),
        ("render rough.toml --method report --strict", 5),
        ("render room.toml --sppp 3", 2),
        ("render dark.toml --strict", 5),
        ("compare nothing.exr nothing.exr", 4),
        ("compare text.png text.png", 4),
        ("compare room.png room.png --map-kind flip", 2),
        ("rendr room.toml", 2),
    ] {
        let said = folder.run(line);
        writeln!(transcript, "$ epsilux {line}\n{}[exit code {}]\n", said.err, said.code.unwrap()).unwrap();
        assert_eq!((said.code, said.out.as_str()), (Some(code), ""), "{line}: {}", said.err);
    }
    assert_eq!(folder.names(), before, "nothing was written");
    insta::assert_snapshot!(transcript);
}

//! Hostile OBJ, MTL and sidecars. What contents alone cannot show (memory, a wait for a pipe, a stack that
//! overflows) needs the program; many more cases run inside the library's own tests.

use super::{Case, transcript};

const TRIANGLE: &str = "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

fn obj(name: &str, text: impl Into<Vec<u8>>) -> Case {
    Case::new(name, "scene.obj", text)
}

fn mtl(name: &str, text: impl Into<Vec<u8>>) -> Case {
    obj(name, TRIANGLE).with("scene.mtl", text)
}

fn sidecar(name: &str, text: &str) -> Case {
    mtl(name, "newmtl m\n").with("scene.epsilux.toml", format!("epsilux = 1\n{text}"))
}

/// Runs the cases; those named in `refused` end in an error, the others load.
#[track_caller]
fn check(cases: Vec<Case>, refused: &[&str]) {
    let told = transcript(cases);
    let (mut name, mut found) = ("", Vec::new());
    for line in told.lines() {
        name = line.strip_prefix("# ").unwrap_or(name);
        if line == "[exit code 4]" {
            found.push(name);
        }
    }
    assert_eq!(found, refused, "{told}");
}

/// A million small things, or one large one, on every sort of line.
#[test]
fn obj_files_that_ask_for_too_much() {
    let lines = |f: fn(u32) -> String| (0..1_000_000).map(f).collect::<String>();
    let cases = vec![
        obj("a million libraries", lines(|i| format!("mtllib {i}.mtl\n")) + "v 0 0 0\n"),
        obj("a million objects", lines(|i| format!("o {i}\n")) + TRIANGLE),
        obj("a million continuations", "\\\n".repeat(1_000_000) + "v 0 0 0\n"),
        obj("a polygon of a million corners", format!("{TRIANGLE}f{}", " 1 2 3 2 1".repeat(200_000))),
        obj("a word of eight million digits", format!("v 0 0 {}", "9".repeat(8_000_000))),
        obj("a hundred million bytes of nothing", " ".repeat(100_000_000) + "\nv 0 0 0"),
        mtl("a million options", format!("newmtl m\nmap_Kd {}t.png", "-s 1 1 1 ".repeat(1_000_000))),
        mtl("a million materials", lines(|i| format!("newmtl {}\nKd 1 1 1\n", i % 1000))),
    ];
    check(cases, &[]);
}

/// Numbers and indices that are none.
#[test]
fn obj_files_that_contradict_themselves() {
    let cases = vec![
        obj("index 0", "v 0 0 0\nf 0 1 1"),
        obj("index beyond the vertices", "v 0 0 0\nf 1 1 2"),
        obj("index of 2^64", "v 0 0 0\nf 1 1 18446744073709551616"),
        obj("index before the first vertex", "v 0 0 0\nf -1 -2 -1"),
        obj("coordinates that are no numbers", "v nan inf 1e400\nv 1 0 0\nv 0 1 0\nf 1 2 3"),
        obj("one corner", "v 0 0 0\nf 1"),
        obj("cut", "v 0 0 0\nv 1 0"),
        obj("zeros", vec![0; 10_000]),
        obj("every byte", (0..=255).cycle().take(100_000).collect::<Vec<u8>>()),
        obj("UTF-16", b"\xff\xfev\0 \x001\0".to_vec()),
        mtl("numbers of a material", "newmtl m\nKd nan inf 1e400\nNs -1e30\nd 9e9\nKe 1e38 0 0\nTr x"),
        mtl("a material of every byte", (0..=255).cycle().take(100_000).collect::<Vec<u8>>()),
        sidecar("a radius that is no number", "[[object]]\nmaterial = 'm'\nsphere = { radius = nan }"),
        sidecar("a material that is nowhere", "[[object]]\nmaterial = 'gone'\nsphere = { radius = 1 }"),
        mtl("a sidecar that is not UTF-8", "newmtl m")
            .with("scene.epsilux.toml", b"epsilux = 1 # \xe9".to_vec()),
    ];
    let refused = [
        "index 0",
        "index beyond the vertices",
        "index of 2^64",
        "index before the first vertex",
        "cut",
        "zeros",
        "every byte",
        "UTF-16",
        "a radius that is no number",
        "a material that is nowhere",
        "a sidecar that is not UTF-8",
    ];
    check(cases, &refused);
}

/// Names that lead outside, to themselves, or to what is no file.
#[test]
fn obj_files_that_reach_out() {
    let outside = "../secret.bin";
    let mut cases = vec![
        obj(
            "libraries outside",
            format!("mtllib {outside}\nmtllib /etc/passwd\nmtllib file:///etc/passwd\n{TRIANGLE}"),
        ),
        obj("a library of itself", format!("mtllib scene.obj\n{TRIANGLE}")),
        obj("libraries that are folders", format!("mtllib .\nmtllib ..\n{TRIANGLE}")),
        obj("commands", format!("call scene.obj\ncsh touch ../touched\n{TRIANGLE}")),
        mtl(
            "pictures outside",
            format!("newmtl m\nmap_Kd {outside}\nmap_Ks /etc/passwd\nmap_Ke ..\\..\\x\nmap_d .\n"),
        ),
        mtl("pictures that are none", "newmtl m\nmap_Kd scene.mtl\nnorm scene.obj"),
        sidecar("a sidecar's picture outside", &format!("[image]\na = \"{outside}\"")),
    ];
    #[cfg(unix)]
    cases.push(mtl("pipes and links", "newmtl m\nmap_Kd pipe\nmap_Ks link\n").prepared(|folder| {
        let made = std::process::Command::new("mkfifo").arg(folder.join("pipe")).status();
        assert!(made.is_ok_and(|s| s.success()));
        std::os::unix::fs::symlink("../secret.bin", folder.join("link")).unwrap();
    }));
    #[cfg(unix)]
    cases.push(obj("a sidecar that is a pipe", TRIANGLE).prepared(|folder| {
        let made = std::process::Command::new("mkfifo").arg(folder.join("scene.epsilux.toml")).status();
        assert!(made.is_ok_and(|s| s.success()));
    }));
    check(
        cases,
        &["a sidecar's picture outside", "a sidecar that is a pipe"][..if cfg!(unix) { 2 } else { 1 }],
    );
}

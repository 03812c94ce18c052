//! Files that somebody broke or made to break us: an error or notes, and never a panic or a wait.

use std::time::{Duration, Instant};

use super::*;
use crate::scene::validate;

const TRIANGLE: &str = "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl m\n\
    f 1/1/1 2/2/1 3/1/1\n";
const SIDECAR: &str = "epsilux = 1\n";

/// What became of a hostile file.
fn outcome(files: &[(&str, &[u8])]) -> String {
    let start = Instant::now();
    let said = match try_load(files) {
        Ok((mut scene, notes)) => match validate(&mut scene) {
            Ok(_) => {
                let triangles: usize = scene.meshes.iter().map(|m| m.triangles.len()).sum();
                format!("{triangles} triangles{}", counted(&notes))
            }
            Err(e) => format!("invalid: {e}"),
        },
        Err(e) => {
            let e = e.to_string();
            let at = e.find("scene.").unwrap_or(0);
            let shown: String = e[at..].chars().take(150).collect();
            format!("refused: {shown}")
        }
    };
    assert!(start.elapsed() < Duration::from_secs(20), "{said}: took {:?}", start.elapsed());
    said
}

/// Codes of notes, each with how many there are.
fn counted(notes: &[Note]) -> String {
    let mut list: Vec<(&str, usize)> = Vec::new();
    for code in codes(notes) {
        match list.iter_mut().find(|(c, _)| *c == code) {
            Some((_, n)) => *n += 1,
            None => list.push((code, 1)),
        }
    }
    list.iter().map(|(code, n)| if *n == 1 { format!(", {code}") } else { format!(", {n} {code}") }).collect()
}

/// Guards every case of the list: what is refused says why, what loads says what is missing.
#[test]
fn hostile_files_are_refused_or_loaded_with_notes() {
    let obj = |text: &str| outcome(&[("scene.obj", text.as_bytes())]);
    let mtl = |text: &str| outcome(&[("scene.obj", TRIANGLE.as_bytes()), ("scene.mtl", text.as_bytes())]);
    let toml = |text: &str| {
        outcome(&[
            ("scene.obj", TRIANGLE.as_bytes()),
            ("scene.mtl", b"newmtl m\n"),
            ("scene.epsilux.toml", format!("{SIDECAR}{text}").as_bytes()),
        ])
    };
    let cases: Vec<(&str, String)> = vec![
        ("truncated in a number", obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1")),
        ("truncated in a face", obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2")),
        ("truncated in a corner", obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3/")),
        ("index 0", obj("v 0 0 0\nf 0 0 0")),
        ("huge index", obj("v 0 0 0\nf 1 1 4294967296")),
        ("index of 2^32 - 1", obj("v 0 0 0\nf 1 1 4294967295")),
        ("index of -2^63", obj("v 0 0 0\nf 1 1 -9223372036854775808")),
        ("index beyond i64", obj("v 0 0 0\nf 1 1 18446744073709551616")),
        ("normal without normals", obj("v 0 0 0\nf 1//1 1//1 1//1")),
        ("NaN", obj("v nan NaN -nan\nv 1 0 0\nv 0 1 0\nf 1 2 3")),
        ("1e400", obj("v 1e400 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")),
        ("one vertex", obj("v 0 0 0\nf 1")),
        ("corners in one place", obj("v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3 4")),
        (
            "line of a million corners",
            obj(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf{}", " 1 2 3".repeat(300_000))),
        ),
        ("word of four million bytes", obj(&format!("v 0 0 {}", "1".repeat(4_000_000)))),
        (
            "name of a million bytes",
            obj(&format!("o {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "n".repeat(1_000_000))),
        ),
        ("a million continuations", obj(&"\\\n".repeat(1_000_000))),
        (
            "a million libraries",
            obj(&(0..1_000_000).map(|i| format!("mtllib {i}.mtl\n")).collect::<String>()),
        ),
        (
            "many unknown statements",
            obj(&((0..100_000).map(|i| format!("x{i}\n")).collect::<String>() + "v 0 0 0\n")),
        ),
        (
            "many missing materials",
            obj(&(0..20_000)
                .map(|i| format!("v {i} 0 0\nv 0 1 0\nv 0 0 1\nusemtl m{i}\nf -1 -2 -3\n"))
                .collect::<String>()),
        ),
        ("deep call", obj("call scene.obj\ncsh touch harm\nv 0 0 0\n")),
        ("library of itself", obj("mtllib scene.obj\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")),
        ("library outside", obj("mtllib ../../../../etc/passwd\nmtllib /etc/passwd\nv 0 0 0")),
        ("library is a folder", obj("mtllib .\nmtllib ..\nv 0 0 0")),
        ("library with NUL", obj("mtllib a\0b.mtl\nv 0 0 0")),
        ("binary", outcome(&[("scene.obj", &(0..=255).cycle().take(10_000).collect::<Vec<u8>>())])),
        ("zeros", outcome(&[("scene.obj", &[0; 10_000])])),
        ("UTF-16", outcome(&[("scene.obj", b"\xff\xfev\0 \x001\0")])),
        ("a picture as OBJ", outcome(&[("scene.obj", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR")])),
        ("crossing star", obj(&star(2_001, 1_000))),
        ("MTL: binary", outcome(&[("scene.obj", TRIANGLE.as_bytes()), ("scene.mtl", &[0xfe; 1000])])),
        ("MTL: no names", mtl("newmtl\nnewmtl \nKd 1 1 1\nmap_Kd\n")),
        (
            "MTL: numbers",
            mtl("newmtl m\nKd nan inf 1e400\nNs -1e30\nNi -1\nd 9e9\nKe -1 1e38 0\nillum 1e10\nTr x"),
        ),
        (
            "MTL: maps outside",
            mtl("newmtl m\nmap_Kd ../../etc/passwd\nmap_Ks /etc/passwd\nmap_d file:///x\nmap_Ke ."),
        ),
        ("MTL: map of itself", mtl("newmtl m\nmap_Kd scene.mtl\nmap_Bump scene.obj")),
        (
            "MTL: options alone",
            mtl("newmtl m\nmap_Kd -s\nmap_Ks -s 1 1 1 -o -bm\nmap_d -mm -t\nbump -imfchan"),
        ),
        ("MTL: long options", mtl(&format!("newmtl m\nmap_Kd {}x.png", "-s 1 1 1 ".repeat(100_000)))),
        (
            "MTL: many materials",
            mtl(&(0..100_000).map(|i| format!("newmtl {i}\nKd 1 1 1\n")).collect::<String>()),
        ),
        ("MTL: one name often", mtl(&"newmtl m\nKd 1 1 1\n".repeat(100_000))),
        ("TOML: deep", toml(&format!("a = {}", "[".repeat(100_000)))),
        ("TOML: deep tables", toml(&format!("[{}a]", "a.".repeat(50_000)))),
        (
            "TOML: giant array",
            toml(&format!("[mesh]\nm = {{ positions = [{}], triangles = [] }}", "[0,0,0],".repeat(100_000))),
        ),
        (
            "TOML: NaN",
            toml(
                "[[object]]\nmaterial = 'm'\nsphere = { radius = nan }\n[material]\nm = { mirror = [1, 1, 1] }",
            ),
        ),
        ("TOML: outside", toml("[image]\na = '../../../etc/passwd'")),
        (
            "TOML: not UTF-8",
            outcome(&[("scene.obj", TRIANGLE.as_bytes()), ("scene.epsilux.toml", b"epsilux = 1 # \xe9")]),
        ),
        ("TOML: empty", outcome(&[("scene.obj", TRIANGLE.as_bytes()), ("scene.epsilux.toml", b"")])),
    ];
    let said: String = cases.iter().map(|(name, said)| format!("{name}: {said}\n")).collect();
    insta::assert_snapshot!(said);
}

/// A star polygon that crosses itself everywhere.
fn star(corners: usize, step: usize) -> String {
    let at = |i: usize| i as f64 / corners as f64 * std::f64::consts::TAU;
    let mut obj: String =
        (0..corners).map(|i| format!("v {} {} 0\n", libm::cos(at(i)), libm::sin(at(i)))).collect();
    let order: Vec<String> = (0..corners).map(|i| (i * step % corners + 1).to_string()).collect();
    obj += &format!("f {}\n", order.join(" "));
    obj
}

/// A pipe beside the scene would make the reader wait for ever.
#[cfg(unix)]
#[test]
fn pipes_and_links_are_not_followed() {
    use std::os::unix::fs::symlink;
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("scene");
    fs::create_dir(&folder).unwrap();
    fs::write(dir.path().join("secret.mtl"), "newmtl m\n").unwrap();
    fs::write(
        folder.join("scene.obj"),
        "mtllib pipe\nmtllib link.mtl\nmtllib scene.mtl\n".to_owned() + TRIANGLE,
    )
    .unwrap();
    fs::write(folder.join("scene.mtl"), "newmtl m\nmap_Kd pipe\n").unwrap();
    let made = std::process::Command::new("mkfifo").arg(folder.join("pipe")).status();
    assert!(made.is_ok_and(|s| s.success()));
    symlink(dir.path().join("secret.mtl"), folder.join("link.mtl")).unwrap();
    let (_, notes) = load_from(&folder).unwrap();
    assert_eq!(codes(&notes), ["mtllib-missing", "mtllib-missing", "texture-missing"]);
    symlink(dir.path().join("secret.mtl"), folder.join("scene.epsilux.toml")).unwrap();
    let e = load_from(&folder).unwrap_err().to_string();
    assert!(e.contains("scene.epsilux.toml") && e.contains("leads outside"), "{e}");
}

/// Random damage to files that load: whatever comes of it, no panic, and what loads can be validated.
#[test]
fn damaged_files_never_panic() {
    let base: [(&str, &str); 3] = [
        (
            "scene.obj",
            "# test\nmtllib scene.mtl\no A b\nv 0 0 0 1 0.5 0\nv 1 0 0\nv 1 1 0 0 0 1\nv 0 1 0\nv 0.5 2 0.25\nvt 0 0\nvt 1 \
             0.5\nvn 0 0 1\nvn 0 1 0\nusemtl m\ns 1\nf 1/1/1 2/2/1 3/1/2 5//1 4\ng side\ns off\nusemtl n\nf -1 -2 -3\nf 1 2 \\\n \
             4\nl 1 2 3\np 1\n",
        ),
        (
            "scene.mtl",
            "# Blender 5.0.1\nnewmtl m\nNs 250\nKd 0.8 0.5 0.2\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 0.5\nillum 9\nPr 0.5\nPc \
             2\nTf 1 1 1\nmap_Kd -s 2 2 2 -o 0.5 0 0 t.png\nmap_Bump -bm 0.5 n.png\nnewmtl n\nKd 1 1 1\nillum 7\nTr 0.5\n",
        ),
        (
            "scene.epsilux.toml",
            "epsilux = 1\ncamera.a = { eye = [0, 0, 5], target = [0, 0, 0], fov = 40 }\n[material]\nm = { mirror = [1, 1, 1] \
             }\n[[object]]\nmaterial = \"m\"\nsphere = { radius = 0.5 }\n",
        ),
    ];
    // From the test's name (FNV-1a), and moved on by xorshift (Marsaglia 2003).
    let mut seed = "damaged_files_never_panic"
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
    let mut below = |n: usize| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed % n as u64) as usize
    };
    let dir = tempfile::tempdir().unwrap();
    let words: [&[u8]; 12] = [
        b"nan",
        b"1e400",
        b"-1",
        b"0",
        b"99999999999",
        b"\\",
        b"\r",
        b"\xff",
        b"/",
        b"-s",
        b"f 1 2 3 ",
        b"newmtl ",
    ];
    let (mut loaded, mut refused) = (0, 0);
    for _ in 0..3000 {
        let broken = below(3);
        for (i, (name, text)) in base.iter().enumerate() {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..if i == broken { 1 + below(6) } else { 0 } {
                let at = below(bytes.len().max(1)).min(bytes.len().saturating_sub(1));
                match below(5) {
                    _ if bytes.is_empty() => {}
                    0 => bytes[at] = below(256) as u8,
                    1 => bytes[at] ^= 1 << below(8),
                    2 => bytes.truncate(at),
                    3 => {
                        let end = (at + 1 + below(20)).min(bytes.len());
                        bytes.drain(at..end);
                    }
                    _ => {
                        let word = words[below(words.len())];
                        bytes.splice(at..at, word.iter().copied());
                    }
                }
            }
            fs::write(dir.path().join(name), bytes).unwrap();
        }
        match load_from(dir.path()) {
            Ok((mut scene, _)) => {
                validate(&mut scene).unwrap();
                loaded += 1;
            }
            Err(_) => refused += 1,
        }
    }
    assert!(loaded > 500 && refused > 500, "{loaded} loaded, {refused} refused");
}

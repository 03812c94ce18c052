//! `--checkpoint`, `--passes`, `merge` and `--error`: nothing is lost, and parts are the whole.

use std::process::Stdio;
use std::time::Duration;

use crate::command::Folder;

/// Size and samples of the pictures here.
const SMALL: &str = "--size 40x30 -q";

/// The pictures that one uninterrupted render makes.
fn whole(folder: &Folder, spp: u32) -> [Vec<u8>; 2] {
    folder.done(&format!("render room.toml --spp {spp} {SMALL} -o whole.exr -o whole.png"));
    ["whole.exr", "whole.png"].map(|name| folder.read(name))
}

fn same(folder: &Folder, name: &str, expected: &[Vec<u8>; 2]) {
    for (suffix, bytes) in ["exr", "png"].iter().zip(expected) {
        assert!(folder.read(&format!("{name}.{suffix}")) == *bytes, "{name}.{suffix} differs");
    }
}

/// Seven uneven parts, merged in any order, are the uninterrupted render, byte for byte; so is the part that
/// holds them all.
#[test]
fn parts_merged_in_any_order_are_the_whole() {
    let folder = Folder::with_room();
    let expected = whole(&folder, 23);
    folder.done(&format!("render room.toml --spp 23 {SMALL} -o t.png --checkpoint whole.part"));
    let ends = [0, 1, 4, 9, 10, 16, 21, 23];
    for (i, range) in ends.windows(2).enumerate() {
        let passes = format!("--passes {}..{} --threads {}", range[0], range[1], 1 + i % 3);
        folder.done(&format!("render room.toml {passes} {SMALL} -o {i}.png --checkpoint {i}.part"));
    }
    for (n, order) in ["3 0 6 5 1 4 2", "6 5 4 3 2 1 0"].iter().enumerate() {
        let parts: Vec<String> = order.split(' ').map(|i| format!("{i}.part")).collect();
        let said =
            folder.done(&format!("merge {} -o m.exr -o m.png --checkpoint m{n}.part", parts.join(" ")));
        assert!(said.err.contains("23 samples per pixel of 7 parts"), "{}", said.err);
        same(&folder, "m", &expected);
        assert_eq!(folder.read("m0.part"), folder.read("whole.part"));
    }
    // What is missing is said, and what is there twice refused.
    let said = folder.done("merge 0.part 3.part 6.part -o gaps.png");
    assert!(said.err.contains("passes 1..9 are missing"), "{}", said.err);
    assert!(said.err.contains("passes 10..21 are missing"), "{}", said.err);
    let said = folder.run("merge 0.part 1.part 0.part -o twice.png");
    assert_eq!(said.code, Some(4));
    assert!(said.err.contains("passes 0..1 are there twice"), "{}", said.err);
    assert!(!folder.path("twice.png").exists());
}

/// Parts of other renders are refused, with what differs; files that are no parts, too.
#[test]
fn strangers_are_refused() {
    let folder = Folder::with_room();
    let part = |flags: &str, name: &str| {
        folder.done(&format!("render room.toml {SMALL} {flags} -o t.png --checkpoint {name}"));
    };
    part("--passes 0..2", "a.part");
    part("--passes 2..4 --seed 7", "seed.part");
    part("--passes 2..4 --max-depth 3", "depth.part");
    for (other, says) in [
        ("seed.part", "seed is 0 in one and 7 in the other"),
        ("depth.part", "max_depth is none in one and 3 in the other"),
    ] {
        let said = folder.run(&format!("merge a.part {other} -o m.png"));
        assert_eq!(said.code, Some(4));
        assert!(said.err.contains(says), "{}", said.err);
    }
    folder.write("no.part", "not a part");
    let said = folder.run("merge a.part no.part -o m.png");
    assert!(said.err.contains("no.part: this is not a part of a render"), "{}", said.err);
    assert!(said.err.contains("--checkpoint FILE` writes parts"), "{}", said.err);
    // A checkpoint of something else is not overwritten.
    let before = folder.read("seed.part");
    let said = folder.run(&format!("render room.toml --spp 4 {SMALL} -o t.png --checkpoint seed.part"));
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("seed is 7 in one and 0 in the other"), "{}", said.err);
    let said = folder.run(&format!("render room.toml --spp 4 {SMALL} -o t.png --checkpoint room.toml"));
    assert_eq!(said.code, Some(4));
    assert_eq!(folder.read("seed.part"), before);
}

/// Samples are added to a finished render, and a checkpoint that was cut short gives way to the one before.
#[test]
fn renders_go_on_from_their_checkpoint() {
    let folder = Folder::with_room();
    let expected = whole(&folder, 20);
    let render = |spp: u32| {
        folder.done(&format!("render room.toml --spp {spp} {SMALL} -o r.exr -o r.png --checkpoint r.part"))
    };
    render(5);
    render(12);
    render(20);
    same(&folder, "r", &expected);
    // Nothing is left to do.
    render(20);
    same(&folder, "r", &expected);
    // FILE.old is the generation before: the same passes here, since the last render added none.
    let mut cut = folder.read("r.part");
    cut.truncate(cut.len() / 2);
    folder.write("r.part", &cut);
    let line = "render room.toml --spp 20 --size 40x30 -o r.exr -o r.png --checkpoint r.part";
    let said = folder.done(line);
    assert!(said.err.contains("r.part: it is damaged or cut short"), "{}", said.err);
    same(&folder, "r", &expected);
    let said = folder.run(&format!("render room.toml --spp 8 {SMALL} -o t.png --checkpoint r.part"));
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("it holds passes 0..20, and 0..8 were asked for"), "{}", said.err);
}

/// Whatever moment a render is killed at, by a signal that it hears or by one that it does not, going on from its
/// checkpoint makes the picture of an uninterrupted render.
#[cfg(unix)]
#[test]
fn killed_renders_lose_nothing_but_time() {
    let folder = Folder::with_room();
    let expected = whole(&folder, 48);
    let line = format!(
        "render room.toml --spp 48 {SMALL} -o k.exr -o k.png --checkpoint k.part --checkpoint-every 1ms"
    );
    let mut interrupted = 0;
    for (i, signal) in ["KILL", "TERM"].iter().cycle().take(12).enumerate() {
        let mut child =
            folder.command(&line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("a process");
        std::thread::sleep(Duration::from_millis(20 + 13 * i as u64));
        let _ = std::process::Command::new("kill").args(["-s", signal, &child.id().to_string()]).status();
        interrupted += u32::from(!child.wait().expect("an end").success());
        // Every generation that has a name is whole.
        for name in ["k.part", "k.part.old"].iter().filter(|n| folder.path(n).exists()) {
            folder.done(&format!("merge {name} -o any.png"));
        }
    }
    assert!(interrupted > 0, "no render was interrupted");
    folder.done(&line);
    same(&folder, "k", &expected);
}

/// An error that was asked for ends the render at a number of samples that can be repeated; a budget that ends
/// before has an exit code of its own.
#[test]
fn an_error_can_be_asked_for() {
    let folder = Folder::new();
    std::fs::copy(crate::command::scene("cornell.toml"), folder.path("room.toml")).expect("a copy");
    let said = folder.done("render room.toml --error 5% --size 40x40 -o e.exr -o e.png");
    let line = said.err.lines().find(|l| l.contains("repeats this picture")).expect("a line").to_owned();
    let spp: u32 = line.split(' ').nth(1).and_then(|n| n.parse().ok()).expect("a number");
    assert!(spp >= 8 && said.err.contains("95 % sure"), "{}", said.err);
    folder.done(&format!("render room.toml --spp {spp} --size 40x40 -q --threads 1 -o s.exr -o s.png"));
    same(&folder, "e", &["s.exr", "s.png"].map(|name| folder.read(name)));
    // In parts, too.
    let (flags, checkpoint) = ("--size 40x40 -q -o p.exr -o p.png", "--checkpoint p.part");
    folder.done(&format!("render room.toml --spp 8 {flags} {checkpoint}"));
    for _ in 0..2 {
        folder.done(&format!("render room.toml --error 5% {flags} {checkpoint}"));
        same(&folder, "p", &["s.exr", "s.png"].map(|name| folder.read(name)));
    }
    let said = folder.run("render room.toml --error 0.1% --spp 16 --size 40x40 -o e.png");
    assert_eq!(said.code, Some(3), "{}", said.err);
    assert!(said.err.contains("0.100 % was asked for"), "{}", said.err);
    let said = folder.run("render room.toml --error 120% -o e.png");
    assert_eq!(said.code, Some(2));
}

/// A render goes on by the choices that it began with, whatever a plan would now say; who asks for others is refused.
#[test]
fn renders_go_on_by_their_own_choices() {
    let folder = Folder::with_room();
    let flags = "--algorithm light-samples=3 --algorithm split=2 --algorithm roulette=2";
    folder.done(&format!("render room.toml --spp 16 {SMALL} {flags} -o whole.exr -o whole.png"));
    let expected = ["whole.exr", "whole.png"].map(|name| folder.read(name));
    folder.done(&format!("render room.toml --spp 8 {SMALL} {flags} -o r.exr --checkpoint r.part"));
    let said = folder
        .run(&format!("render room.toml --spp 16 {SMALL} --algorithm split=3 -o r.exr --checkpoint r.part"));
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("split is 2 in one and 3 in the other"), "{}", said.err);
    folder.done(&format!("render room.toml --spp 16 {SMALL} -o r.exr -o r.png --checkpoint r.part"));
    same(&folder, "r", &expected);
}

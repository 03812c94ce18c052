//! Rendering from the command line to files.

use epsilux::output::read_exr;
use serde_json::Value;

use crate::command::{DARK, Folder};

const SMALL: &str = "render room.toml --size 40x30 --spp 8";

/// The first command that a newcomer types: two pictures and one report, named on standard output, and
/// no colour codes in what a pipe receives.
#[test]
fn the_default_outputs() {
    let folder = Folder::with_room();
    let said = folder.done(SMALL);
    assert_eq!(said.out, "room.png\nroom.exr\n");
    assert_eq!(folder.names(), ["room.exr", "room.png", "room.report.json", "room.toml"]);
    assert!(!said.err.contains('\u{1b}'), "{}", said.err);
    let report: Value = serde_json::from_slice(&folder.read("room.report.json")).unwrap();
    assert_eq!(report["schema"], "epsilux.report/1");
    assert_eq!(report["passes"], serde_json::json!([0, 8]));
    assert_eq!(report["samples_refused"], 0);
    assert!(
        report["rays"].as_u64().unwrap() > 40 * 30 * 8 && report["seconds"]["render"].as_f64().unwrap() > 0.0
    );
    assert_eq!(report["command"].as_str().unwrap().split_once(' ').unwrap().1, SMALL);
}

/// Equal scenes, settings and samples make equal files: whatever the threads, the kernel, and what else
/// is written.
#[test]
fn equal_renders_are_equal_files() {
    let folder = Folder::with_room();
    let flags = ["--threads 1", "--threads 2", "--threads 5", "--effects all", "--tone agx --exposure 1"];
    for (i, flag) in flags.iter().enumerate() {
        folder.done(&format!("{SMALL} -q -o {i}.exr {flag}"));
        assert!(folder.read(&format!("{i}.exr")) == folder.read("0.exr"), "{flag}");
    }
    folder.done(&format!("{SMALL} -q -o seed.exr --seed 1"));
    assert!(folder.read("seed.exr") != folder.read("0.exr"), "another seed is another picture");
}

/// The report's method makes equal files too. It takes a ray in each quarter of the pixel, and as printed
/// its room is black.
#[test]
fn the_method_of_the_report() {
    let folder = Folder::with_room();
    let report = "render room.toml --size 40x30 --method report";
    for threads in [1, 2] {
        let said = folder.done(&format!("{report} --spp 6 -o {threads}.exr --threads {threads}"));
        assert!(said.err.contains("8 samples per pixel"), "{}", said.err);
    }
    assert!(folder.read("1.exr") == folder.read("2.exr"));
    let image = read_exr(&folder.path("1.exr")).unwrap();
    assert_eq!(image.count.unwrap(), [8; 1200]);
    let attributes = |image: &epsilux::film::Image, name: &str| {
        image.attributes.iter().find(|(n, _)| n == name).map(|(_, value)| value.clone())
    };
    folder.done(&format!("{report} --spp 1 -o printed.exr --as-printed"));
    let printed = read_exr(&folder.path("printed.exr")).unwrap();
    assert!(printed.rgb.iter().all(|c| c.is_black()));
    assert_eq!(attributes(&printed, "slips").unwrap().split(", ").count(), 8);
    folder.done(&format!("{report} --spp 4 -o line.exr --as-printed=schlick,area"));
    let line = read_exr(&folder.path("line.exr")).unwrap();
    assert_eq!(attributes(&line, "slips").as_deref(), Some("area, schlick"));
    assert!(line.rgb.iter().any(|c| !c.is_black()));
}

/// A crop is that part of the whole picture, and knows where it lies.
#[test]
fn a_crop_is_a_part() {
    let folder = Folder::with_room();
    folder.done(&format!("{SMALL} -o whole.exr"));
    folder.done(&format!("{SMALL} -o part.exr --crop 7,5,20,10"));
    let (whole, part) =
        (read_exr(&folder.path("whole.exr")).unwrap(), read_exr(&folder.path("part.exr")).unwrap());
    assert_eq!((part.origin, part.full_size, [part.width, part.height]), ([7, 5], [40, 30], [20, 10]));
    for y in 0..10 {
        let row = &whole.rgb[(y + 5) * 40 + 7..][..20];
        assert_eq!(&part.rgb[y * 20..][..20], row, "row {y}");
    }
}

/// The layers that were asked for are in the EXR, under the names that other programs expect, and the
/// colour is the same as without them.
#[test]
fn layers() {
    let folder = Folder::with_room();
    folder.done(&format!("{SMALL} -o plain.exr"));
    folder.done(&format!("{SMALL} -o layers.exr --aov albedo,normal,depth,object"));
    let (plain, layers) =
        (read_exr(&folder.path("plain.exr")).unwrap(), read_exr(&folder.path("layers.exr")).unwrap());
    assert_eq!(plain.rgb, layers.rgb);
    assert!(plain.layers.is_empty());
    let names: Vec<_> = layers.layers.iter().flat_map(|l| &l.channels).map(|(n, _)| n.as_str()).collect();
    assert_eq!(names, ["N.X", "N.Y", "N.Z", "Z", "albedo.B", "albedo.G", "albedo.R", "objectId"]);
    let depth = &layers.layers[1].channels[0].1;
    assert!(depth.iter().all(|z| (1.0..20.0).contains(z)), "the room is 13 metres deep");
}

/// A time limit stops at whole samples, and says how to repeat the picture; repeated, it is the same.
#[test]
fn a_time_limit_can_be_repeated() {
    let folder = Folder::with_room();
    let said = folder.done("render room.toml --size 40x30 --time 300ms -o timed.exr");
    let line = said.err.lines().find(|l| l.starts_with("--spp ")).unwrap_or_else(|| panic!("{}", said.err));
    let flag = line.trim_end_matches(" repeats this picture");
    folder.done(&format!("render room.toml --size 40x30 {flag} -o repeated.exr"));
    assert!(folder.read("timed.exr") == folder.read("repeated.exr"), "{line}");
}

/// Progress for programs: a line of JSON each, the last of which says 100 %.
#[test]
fn progress_as_json() {
    let folder = Folder::with_room();
    let said = folder.done(&format!("{SMALL} -q --progress json"));
    assert_eq!(said.out, "");
    let lines: Vec<Value> = said.err.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let last = lines.last().unwrap();
    assert_eq!((&last["schema"], &last["percent"]), (&"epsilux.progress/1".into(), &100.0.into()));
}

/// Nothing shines: a default light is added, the note comes first, and the picture is not black.
#[test]
fn a_scene_without_light() {
    let folder = Folder::new();
    folder.write("dark.toml", DARK);
    let said = folder.done("render dark.toml --size 16x16 --spp 4");
    insta::assert_snapshot!(
        said.err.lines().take_while(|l| l.starts_with("note")).collect::<Vec<_>>().join("\n")
    );
    let image = read_exr(&folder.path("dark.exr")).unwrap();
    assert!(image.rgb.iter().any(|c| c.luminance() > 0.0));
}

/// Two methods that share nothing but the scene agree.
#[test]
fn the_reference_method_agrees() {
    let folder = Folder::with_room();
    folder.done("render room.toml --size 32x24 --spp 64 --max-depth 3 -o default.exr");
    folder.done("render room.toml --size 32x24 --spp 64 --max-depth 3 -o reference.exr --method reference");
    let said = folder.run("compare default.exr reference.exr");
    assert_eq!(said.code, Some(0), "{}", said.out);
}

/// The picture that needs no file.
#[test]
fn demo() {
    let folder = Folder::new();
    let said = folder.done("demo --size 20x20 --spp 1");
    assert_eq!(said.out, "hexroom.png\n");
    assert_eq!(folder.names(), ["hexroom.png", "hexroom.report.json"]);
}

/// What programs read about a scene names its form.
#[test]
fn facts_as_json() {
    let folder = Folder::with_room();
    for (command, expected) in [("info", "epsilux.info/1"), ("explain", "epsilux.explain/1")] {
        let facts: Value =
            serde_json::from_str(&folder.done(&format!("{command} room.toml --json")).out).unwrap();
        assert_eq!(facts["schema"], expected);
    }
    insta::assert_snapshot!(folder.done("explain room.toml").out);
}

/// One sample alone is the one that the picture is made of.
#[test]
fn a_sample_can_be_traced_alone() {
    let folder = Folder::with_room();
    folder.done("render room.toml --size 24x16 --spp 1 -o one.exr -q");
    let image = read_exr(&folder.path("one.exr")).unwrap();
    for (x, y) in [(0, 0), (11, 7), (23, 15)] {
        let said = folder.done(&format!("render room.toml --size 24x16 --replay {x},{y},0"));
        let numbers: Vec<f32> = said.out.split_whitespace().map(|n| n.parse().unwrap()).collect();
        assert_eq!(numbers, image.rgb[y * 24 + x].to_array());
    }
    let said = folder.run("render room.toml --size 24x16 --replay 24,0,0");
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("found pixel 24,0 and pass 0, expected at most 23,15"), "{}", said.err);
    assert!(!folder.names().iter().any(|n| n.starts_with("room.") && n != "room.toml"), "no picture");
}

/// A signal ends the render early, the picture is saved, and the exit code says so.
#[cfg(unix)]
#[test]
fn signals_save_the_picture() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let folder = Folder::with_room();
        let line = "render room.toml --size 64x64 --time 1h -o long.exr --progress json";
        let mut child = folder.command(line).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        lines.next().unwrap().unwrap();
        let sent = Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
        assert!(sent.success());
        let rest: Vec<_> = lines.map(Result::unwrap).collect();
        assert_eq!(child.wait().unwrap().code(), Some(code), "{rest:?}");
        assert!(read_exr(&folder.path("long.exr")).unwrap().count.unwrap()[0] > 0);
    }
}

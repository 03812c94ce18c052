//! Scenes through formats: what was read, written and read again is what it was, or a note says what is not.
//!
//! Every scene of `scenes` and every fixture that can be read goes through every format, and through every
//! pair of formats; large ones through every format that shares meshes, alone.

mod compare;

use std::path::{Path, PathBuf};

use epsilux::export::{Format, encode};
use epsilux::import::{self, ReadOptions};
use epsilux::scene::{Note, Scene, validate};

use compare::{Held, differences};

/// Triangles, instances counted each, of a scene that takes seconds to write as OBJ.
const LARGE: u64 = 50_000;

/// Scenes, and fixtures of every format that is read, in a fixed order.
pub(crate) fn sources() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    let mut folders = vec![root.join("scenes"), root.join("fixtures")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let suffix = path.extension().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() {
                folders.push(path);
            } else if ["toml", "json", "gltf", "glb", "obj"].contains(&&*suffix) {
                files.push(path);
            }
        }
    }
    files.sort();
    // A sidecar belongs to its OBJ file, and a schema is no scene.
    files.retain(|f| {
        let name = f.file_name().unwrap().to_string_lossy();
        !name.ends_with(".epsilux.toml") && !name.ends_with(".schema.json")
    });
    files
}

pub(crate) fn read(path: &Path) -> Option<(Scene, Vec<Note>)> {
    let (mut scene, mut notes) = import::read(path, &ReadOptions::default()).ok()?;
    notes.extend(validate(&mut scene).ok()?);
    Some((scene, notes))
}

/// Writes `scene` and reads it again; what the notes of both say.
fn through(scene: &Scene, format: Format, folder: &Path) -> (Scene, Vec<Note>) {
    let name = format!("scene.{}", format.suffix());
    let encoded = encode(scene, format, &name).unwrap();
    assert_eq!(encoded.files.last().unwrap().path, name, "the scene's own file comes last");
    // Not `export::write`, which waits for the disk.
    for file in &encoded.files {
        let path = folder.join(&file.path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, &file.bytes).unwrap();
    }
    let mut notes = encoded.notes;
    let (again, found) = read(&folder.join(&name)).unwrap_or_else(|| {
        let error = import::read(&folder.join(&name), &ReadOptions::default()).map(|_| "not valid");
        panic!("{}: {error:?}", folder.join(&name).display())
    });
    notes.extend(found);
    (again, notes)
}

/// What a format keeps of numbers.
fn held(format: Format) -> Held {
    match format {
        Format::Toml | Format::Json => Held::Exactly,
        _ => Held::InSingles,
    }
}

/// Guards that no format loses anything in silence, alone or after another one.
#[test]
fn every_scene_survives_every_pair_of_formats() {
    let mut count = 0;
    let mut failures = Vec::new();
    for source in sources() {
        let Some((scene, _)) = read(&source) else { continue };
        let name = source.file_name().unwrap().to_string_lossy().into_owned();
        let placed = epsilux::report::inventory(&scene).triangles;
        let is_large = placed > LARGE;
        for first in Format::ALL {
            if is_large && first == Format::Obj {
                continue;
            }
            let folder = tempfile::tempdir().unwrap();
            let (once, notes) = through(&scene, first, folder.path());
            let mut check = |before: &Scene, after: &Scene, notes: &[Note], held, through: &str| {
                count += 1;
                failures.extend(
                    differences(before, after, notes, held).map(|d| format!("{name} through {through}: {d}")),
                );
            };
            check(&scene, &once, &notes, held(first), first.suffix());
            for second in Format::ALL.into_iter().filter(|_| !is_large) {
                let folder = tempfile::tempdir().unwrap();
                let (twice, notes) = through(&once, second, folder.path());
                let route = format!("{}, {}", first.suffix(), second.suffix());
                check(&once, &twice, &notes, held(second), &route);
            }
        }
    }
    assert!(failures.is_empty(), "{} differences:\n{}", failures.len(), failures.join("\n"));
    assert!(count >= 7 * Format::ALL.len() * (1 + Format::ALL.len()), "{count} ways");
}

/// The comparison sees what it should: each change of a scene is a difference, unless a note names it.
#[test]
fn the_comparison_sees_changes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (scene, _) = read(&root.join("fixtures/text/textures.toml")).unwrap();
    let check = |change: &dyn Fn(&mut Scene), aspect: &str| {
        let mut changed = scene.clone();
        change(&mut changed);
        let found: Vec<String> = differences(&scene, &changed, &[], Held::InSingles).collect();
        match aspect {
            "" => assert!(found.is_empty(), "{found:?}"),
            _ => assert!(found.iter().any(|d| d.starts_with(aspect)), "{aspect}: {found:?}"),
        }
    };
    check(&|_| (), "");
    check(&|s| s.meshes[0].triangles[0].swap(0, 1), "object");
    check(&|s| s.meshes[0].uvs[0][0].x += 0.01, "object");
    check(&|s| s.meshes[0].positions[0].x += 0.01, "object");
    check(&|s| s.objects[1].transform.translation.x += 0.01, "object");
    check(&|s| s.objects[1].visible_to_camera = false, "object");
    check(&|s| s.objects[1].material.0 = 0, "object");
    check(&|s| s.objects.truncate(1), "object");
    check(&|s| s.materials[4].kind = s.materials[0].kind.clone(), "material");
    check(&|s| s.materials[4].name.push('x'), "material");
    check(&|s| s.lights[0].visible_to_camera = false, "light");
    check(&|s| s.lights[0].transform.translation.y *= 1.001, "light");
    check(&|s| s.cameras[0].shift = [0.1, 0.0], "camera");
    check(&|s| s.environment.as_mut().unwrap().radiance.r = 0.5, "environment");
    check(&|s| s.settings.spp = None, "settings");
    check(&|s| s.title.clear(), "title");
    // Another picture under the same number.
    check(&|s| s.images.swap(0, 1), "material");
    check(&|s| s.images.iter_mut().for_each(|i| i.name.clear()), "");
    let mut hidden = scene.clone();
    hidden.objects[1].visible_to_camera = false;
    let note = |code| Note {
        code,
        place: "objects[1]".into(),
        message: String::new(),
        effect: epsilux::scene::NoteEffect::Differs,
    };
    let said = |code| differences(&scene, &hidden, &[note(code)], Held::InSingles).count();
    assert_eq!((said("visibility-lost"), said("tangents-lost")), (0, 2), "only the note about it excuses it");
}

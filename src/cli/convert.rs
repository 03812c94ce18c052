//! `epsilux convert`

use std::path::{Path, PathBuf};

use super::args::ConvertArgs;
use super::console::Console;
use super::failure::Failure;
use super::{Code, load, notes};
use crate::export::{self, Encoded, ExportError, Format, OutFile};
use crate::report::{Inventory, inventory};
use crate::scene::Scene;

pub(super) fn run(args: &ConvertArgs, console: &Console) -> Result<Code, Failure> {
    let out = &args.output;
    let format = Format::of(out).ok_or_else(|| unknown_suffix(out))?;
    let name = out.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let folder = folder_of(out);
    // What can be known before the work is said before the work.
    if !folder.is_dir() {
        let message = format!("{}: the folder {} does not exist", out.display(), folder.display());
        return Err(Failure::write(message));
    }
    if out.is_dir() {
        return Err(Failure::write(format!("{}: is a folder, expected a file name", out.display())));
    }

    let (scene, mut found) = load::read(&args.scene)?;
    let encoded = export::encode(&scene, format, &name).map_err(|e| {
        let mut failure = Failure::write(format!("{}: {e}", out.display()));
        if let ExportError::Write { .. } = e {
            failure = Failure::write(e.to_string());
        }
        failure
    })?;
    let Encoded { files, notes } = encoded;
    found.extend(notes);
    if args.strict {
        notes::refuse(&found, "without --strict, what is understood is written")?;
    }
    keep_the_input(&args.scene.scene, &scene, &files, folder)?;
    notes::show(&found, true, console);
    export::write(&files, folder).map_err(|e| Failure::write(e.to_string()))?;
    console.result(&summary(out, &inventory(&scene), &files))?;
    Ok(Code::Done)
}

/// The folder that a file lies in.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn unknown_suffix(out: &Path) -> Failure {
    let found =
        out.extension().map_or_else(|| "no suffix".to_owned(), |s| format!(".{}", s.to_string_lossy()));
    let known = Format::ALL.map(|f| format!(".{}", f.suffix()));
    let (last, first) = known.split_last().map_or(("", &known[..]), |(l, f)| (l.as_str(), f));
    let expected = format!("{} or {last}", first.join(", "));
    Failure::usage(format!("{}: found {found}, expected a name that ends in {expected}", out.display()))
}

/// Refuses to replace the scene that is read, a picture of it by another one, or a file that belongs to
/// neither: files beside OUT are OUT's own only where OUT is there already.
fn keep_the_input(input: &Path, scene: &Scene, files: &[OutFile], folder: &Path) -> Result<(), Failure> {
    let real = |path: PathBuf| path.canonicalize().ok();
    let scene_file = real(input.to_path_buf());
    let pictures = scene.images.iter().filter_map(|i| i.file.as_ref());
    let pictures: Vec<PathBuf> = pictures.filter_map(|f| real(folder_of(input).join(f))).collect();
    let is_new = files.last().is_some_and(|own| !folder.join(&own.path).exists());
    for (i, file) in files.iter().enumerate() {
        let path = folder.join(&file.path);
        let Some(target) = real(path.clone()) else { continue };
        if scene_file.as_ref() == Some(&target) {
            let message = format!("{}: this would replace the scene that is read", path.display());
            return Err(Failure::usage(message).help("choose another name"));
        }
        let is_beside = i + 1 < files.len();
        if !is_beside || std::fs::read(&target).is_ok_and(|bytes| bytes == file.bytes) {
            continue;
        }
        if pictures.contains(&target) {
            let message = format!("{}: this would replace a picture of the scene by another", path.display());
            return Err(Failure::usage(message).help("choose another folder"));
        }
        if is_new {
            let message = format!("{}: is there already, and belongs to something else", path.display());
            return Err(Failure::usage(message).help("choose another name, or remove it"));
        }
    }
    Ok(())
}

/// One line: what was written, and what it holds.
fn summary(out: &Path, held: &Inventory, files: &[OutFile]) -> String {
    let count = |n: u64, one: &str| format!("{n} {one}{}", if n == 1 { "" } else { "s" });
    let parts = [
        count(held.triangles, "triangle"),
        count(held.spheres as u64, "sphere"),
        count(held.materials.len() as u64, "material"),
        count(held.lights.len() as u64, "light"),
        count(held.cameras.len() as u64, "camera"),
    ];
    let bytes = size(files.iter().map(|f| f.bytes.len() as u64).sum());
    let beside = match files.len().saturating_sub(1) {
        0 => String::new(),
        n => format!(" with {} beside it", count(n as u64, "file")),
    };
    format!("{}: {}; {bytes}{beside}", out.display(), parts.join(", "))
}

/// Bytes for people.
fn size(bytes: u64) -> String {
    match bytes {
        0..10_000 => format!("{bytes} bytes"),
        10_000..10_000_000 => format!("{:.1} kB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

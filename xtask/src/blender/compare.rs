//! Ours against Cycles: pictures of the same scene by both, figures, contact sheets.
//!
//! In: the exported files, which epsilux renders, and the scripts, which Cycles renders with two seeds. Out: a
//! table in Markdown, a contact sheet for each file (ours, Cycles, signed difference), and one of all.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;

use image::codecs::jpeg::JpegEncoder;

use super::picture::{Blocks, Picture};
use super::{Blender, Fixture, execute, say, size};

const SEEDS: [u32; 2] = [0, 1];

/// Compares all files of these fixtures; a file that epsilux cannot render is named, and left out.
pub(super) fn run(blender: &Blender<'_>, fixtures: &[&Fixture], out: &Path) -> Result<(), String> {
    let mut table = String::from(
        "| file | mean ratio (R, G, B) | blocks: median | 90 % | max | noise: median | 90 % | max |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let mut rows = Vec::new();
    let mut failures = Vec::new();
    for &fixture in fixtures {
        let [first, second] = SEEDS.map(|seed| reference(blender, fixture, out, seed));
        let (first, second) = (first?, second?);
        let cycles = first.mix(0.5, &second, 0.5);
        // Half the difference of two seeds has the variance of their mean.
        let noise = cycles.mix(0.5, &first, 0.5).block_differences(&cycles.mix(0.5, &second, 0.5));
        for file in fixture.files {
            let ours = match render(blender, fixture, file, out) {
                Ok(ours) => ours,
                Err(message) => {
                    failures.push(format!("{file}: {message}"));
                    continue;
                }
            };
            if (ours.width, ours.height) != (cycles.width, cycles.height) {
                return Err(format!("{file}: epsilux and Cycles made pictures of different sizes"));
            }
            let (a, r) = (ours.mean(), cycles.mean());
            let ratio = [0, 1, 2].map(|c| format!("{:.3}", a[c] / r[c])).join(", ");
            let blocks = ours.block_differences(&cycles);
            table += &format!("| {file} | {ratio} | {} | {} |\n", percent(blocks), percent(noise));
            let row = [ours.to_bytes(), cycles.to_bytes(), ours.signed_difference(&cycles)];
            let path = out.join(format!("{file}.png"));
            beside(&row).save(&path).map_err(|e| format!("{}: {e}", path.display()))?;
            rows.push(beside(&row));
        }
    }
    if !rows.is_empty() {
        sheet(&rows, &out.join("sheet.jpg"))?;
    }
    say(&format!("\n{table}\nours, Cycles and the signed difference: {}", out.join("sheet.jpg").display()))?;
    if failures.is_empty() { Ok(()) } else { Err(failures.join("\n")) }
}

fn percent(b: Blocks) -> String {
    [b.median, b.tenth, b.max].map(|v| format!("{:.1} %", 100.0 * v)).join(" | ")
}

/// Cycles' picture, rendered where there is none that is newer than its scripts.
fn reference(blender: &Blender<'_>, fixture: &Fixture, out: &Path, seed: u32) -> Result<Picture, String> {
    let path = out.join(format!("{}-cycles-{}-{}-{seed}.exr", fixture.name, size(fixture), blender.spp));
    let scripts = [blender.script(fixture), blender.folder().join("common.py")];
    let fresh = changed(&path).is_some_and(|t| scripts.iter().all(|s| changed(s) < Some(t)));
    if !fresh {
        blender.cycles(fixture, &path, seed)?;
    }
    Picture::read(&path)
}

fn changed(path: &Path) -> Option<SystemTime> {
    path.metadata().and_then(|m| m.modified()).ok()
}

/// Our picture, by the release build.
fn render(blender: &Blender<'_>, fixture: &Fixture, file: &str, out: &Path) -> Result<Picture, String> {
    let spp = blender.spp * SEEDS.len() as u32;
    say(&format!("{file}: epsilux, {spp} samples"))?;
    let path = out.join(format!("{file}.exr"));
    let cargo = std::env::var_os("CARGO").map_or_else(|| "cargo".into(), PathBuf::from);
    let mut command = Command::new(cargo);
    command.current_dir(blender.root).args([
        "run",
        "--release",
        "--quiet",
        "--bin",
        "epsilux",
        "--",
        "render",
    ]);
    command.arg(blender.folder().join(file)).arg("--output");
    command.arg(std::path::absolute(&path).map_err(|e| e.to_string())?);
    command.args(["--quiet", "--size", &size(fixture)]);
    for (flag, value) in [("--spp", spp), ("--threads", blender.threads)] {
        command.args([flag, &value.to_string()]);
    }
    execute(&mut command)?;
    Picture::read(&path)
}

/// Pictures of one height in a row, with a gap of two pixels.
fn beside(pictures: &[image::RgbImage]) -> image::RgbImage {
    let width = pictures.iter().map(|p| p.width() + 2).sum::<u32>() - 2;
    let mut all = image::RgbImage::from_pixel(width, pictures[0].height(), image::Rgb([255; 3]));
    let mut x = 0;
    for picture in pictures {
        image::imageops::replace(&mut all, picture, x, 0);
        x += i64::from(picture.width()) + 2;
    }
    all
}

/// All rows below each other in one JPEG, each in the middle.
fn sheet(rows: &[image::RgbImage], path: &Path) -> Result<(), String> {
    let failed = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let width = rows.iter().map(image::RgbImage::width).max().unwrap_or(0);
    let height = rows.iter().map(|r| r.height() + 2).sum::<u32>() - 2;
    let mut all = image::RgbImage::from_pixel(width, height, image::Rgb([255; 3]));
    let mut y = 0;
    for row in rows {
        image::imageops::replace(&mut all, row, i64::from((width - row.width()) / 2), y);
        y += i64::from(row.height()) + 2;
    }
    let file = std::fs::File::create(path).map_err(|e| failed(&e))?;
    JpegEncoder::new_with_quality(file, 85).encode_image(&all).map_err(|e| failed(&e))
}

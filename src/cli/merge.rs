//! `epsilux merge`

use super::Code;
use super::args::MergeArgs;
use super::compare::unusable;
use super::console::Console;
use super::failure::Failure;
use super::parts;
use super::render::check_outputs;
use super::stated::Stated;
use crate::output::{self, Tone, WriteOptions};
use crate::scene::ToneCurve;

pub(super) fn run(args: &MergeArgs, console: &Console) -> Result<Code, Failure> {
    check_outputs(&args.output)?;
    let mut files = args.parts.iter();
    // clap asks for one at least.
    let Some(first) = files.next() else { return Err(Failure::usage("no part was given")) };
    let mut whole = parts::read(first)?;
    for file in files {
        let part = parts::read(file)?;
        whole.add(part).map_err(|e| {
            Failure::load(format!("{} and {}: {e}", first.display(), file.display()))
                .help("parts of one render have the same scene, settings and plan, and other passes")
        })?;
    }
    for gap in whole.gaps() {
        console.message(&format!("note: passes {}..{} are missing", gap.start, gap.end));
    }
    let mut image = whole.film.to_image();
    // As `render` names them.
    let lights = whole.identity.0.iter().find(|(name, _)| name == "lights");
    let lights: Vec<String> =
        lights.and_then(|(_, json)| serde_json::from_str(json).ok()).unwrap_or_default();
    let stated = Stated::of(&whole.film, whole.passes.clone(), false, &lights);
    image.attributes = stated.attributes(&whole.identity);
    let (curve, exposure) = &whole.screen;
    let tone = Tone {
        curve: args.tone.map_or_else(|| ToneCurve::named(curve).unwrap_or_default(), Into::into),
        exposure: args.exposure.unwrap_or(*exposure),
    };
    for path in &args.output {
        output::write(&image, path, &WriteOptions { tone }).map_err(|e| unusable(&e))?;
    }
    if let Some(path) = &args.checkpoint {
        parts::write(path, &whole)?;
    }
    console.message(&format!("{} samples per pixel of {} parts", whole.count(), args.parts.len()));
    if let Some(line) = stated.error_line() {
        console.message(&line);
    }
    let names = args.output.iter().map(|p| p.display().to_string()).collect::<Vec<_>>();
    console.result(&names.join("\n"))?;
    Ok(Code::Done)
}

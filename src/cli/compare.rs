//! `epsilux compare`

use super::Code;
use super::args::{CompareArgs, MapKind};
use super::console::Console;
use super::failure::Failure;
use super::schema::to_json;
use crate::output::{self, Tone, WriteError, WriteOptions};
use crate::report::{self, Verdict};
use crate::scene::ToneCurve;

pub(super) fn run(args: &CompareArgs, console: &Console) -> Result<Code, Failure> {
    if let Some(map) = &args.map {
        output::check_path(map).map_err(|e| unusable(&e))?;
    }
    let read = |path| output::read(path).map_err(|e| Failure::load(e.to_string()));
    let (image, reference) = (read(&args.image)?, read(&args.reference)?);
    let incomparable = |e: report::CompareError| {
        Failure::load(format!("{} and {}: {e}", args.image.display(), args.reference.display()))
    };
    let comparison = report::compare(&image, &reference).map_err(incomparable)?;
    if args.json {
        console.result(&to_json(&comparison)?)?;
    } else {
        console.result(&comparison.to_string())?;
    }
    if let Some(path) = &args.map {
        let map = match args.map_kind {
            MapKind::Flip => report::flip_map(&image, &reference),
            MapKind::Difference => report::difference_map(&image, &reference),
        };
        // The map's values are display-encoded already.
        let options = WriteOptions { tone: Tone { curve: ToneCurve::Linear, exposure: 0.0 } };
        output::write(&map.map_err(incomparable)?, path, &options).map_err(|e| unusable(&e))?;
    }
    Ok(match comparison.verdict {
        Verdict::Identical | Verdict::NoSignificantDifference => Code::Done,
        Verdict::Differs => Code::Differs,
    })
}

/// An output that cannot be written.
pub(super) fn unusable(error: &WriteError) -> Failure {
    let failure = Failure::write(error.to_string());
    match error {
        WriteError::NoFolder { folder, .. } => failure.help(format!("mkdir -p {}", folder.display())),
        _ => failure,
    }
}

//! `epsilux schema`

use super::Code;
use super::args::SchemaArgs;
use super::console::Console;
use super::failure::Failure;
use crate::scene::{extension, text};

pub(super) fn run(args: &SchemaArgs, console: &Console) -> Result<Code, Failure> {
    let schema = if args.extension { extension::schema() } else { text::schema() };
    console.result(&to_json(&schema)?)?;
    Ok(Code::Done)
}

/// JSON on one line, for attributes.
pub(super) fn to_json_line(value: &(impl serde::Serialize + ?Sized)) -> Result<String, Failure> {
    serde_json::to_string(value).map_err(|e| Failure::write(format!("cannot write JSON: {e}")))
}

/// JSON for a result.
pub(super) fn to_json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map_err(|e| Failure::write(format!("cannot write JSON: {e}")))
}

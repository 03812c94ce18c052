//! `epsilux schema`

use super::Code;
use super::console::Console;
use super::failure::Failure;
use crate::scene::text;

pub(super) fn run(console: &Console) -> Result<Code, Failure> {
    console.result(&to_json(&text::schema())?)?;
    Ok(Code::Done)
}

/// JSON for a result.
pub(super) fn to_json(value: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(value).map_err(|e| Failure::write(format!("cannot write JSON: {e}")))
}

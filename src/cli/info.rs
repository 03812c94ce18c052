//! `epsilux info`

use serde::Serialize;

use super::args::InfoArgs;
use super::console::Console;
use super::failure::Failure;
use super::notes::{self, NoteJson};
use super::schema::to_json;
use super::{Code, load};
use crate::report::{Inventory, inventory};

#[derive(Serialize)]
struct InfoJson<'a> {
    schema: &'static str,
    file: String,
    #[serde(flatten)]
    inventory: &'a Inventory,
    notes: Vec<NoteJson<'a>>,
}

pub(super) fn run(args: &InfoArgs, console: &Console) -> Result<Code, Failure> {
    let loaded = load::load(&args.scene)?;
    let inventory = inventory(&loaded.scene);
    if args.json {
        let info = InfoJson {
            schema: "epsilux.info/1",
            file: args.scene.scene.display().to_string(),
            inventory: &inventory,
            notes: notes::json(&loaded.notes),
        };
        console.result(&to_json(&info)?)?;
    } else {
        let notes = loaded.notes.iter().map(|n| format!("{:<14}{n}\n", "note"));
        console.result(&(inventory.to_string() + &notes.collect::<String>()))?;
    }
    Ok(Code::Done)
}

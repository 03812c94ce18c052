//! `epsilux explain`

use serde::Serialize;

use super::args::ExplainArgs;
use super::console::Console;
use super::failure::Failure;
use super::machine::PlanJson;
use super::notes::{self, NoteJson};
use super::schema::to_json;
use super::{Code, load, render};
use crate::prepare::{Options, analyse};
use crate::scene::NoteEffect;

#[derive(Serialize)]
struct ExplainJson<'a> {
    schema: &'static str,
    file: String,
    camera: &'a str,
    #[serde(flatten)]
    plan: PlanJson<'a>,
    notes: Vec<NoteJson<'a>>,
}

pub(super) fn run(args: &ExplainArgs, console: &Console) -> Result<Code, Failure> {
    let loaded = load::load(&args.scene)?;
    let camera = render::camera(&loaded.scene, args.camera.as_deref())?;
    let options = Options {
        camera: args.camera.clone(),
        size: render::picture_size(&loaded.scene, camera, None),
        seed: 0,
        effects: args.effects.into(),
        max_depth: loaded.scene.settings.max_depth,
        transparent: false,
        algorithms: args.algorithms.meant(),
    };
    let plan = analyse(&loaded.scene, camera, &options);
    if args.json {
        let explained = ExplainJson {
            schema: "epsilux.explain/1",
            file: args.scene.scene.display().to_string(),
            camera: &camera.name,
            plan: (&plan).into(),
            notes: notes::json(&loaded.notes),
        };
        console.result(&to_json(&explained)?)?;
    } else {
        let differing = loaded.notes.iter().filter(|n| n.effect != NoteEffect::None);
        let notes = differing.map(|n| {
            let word = if n.effect == NoteEffect::Missing { "not modelled" } else { "assumed" };
            format!("{word:<14}{n}\n")
        });
        console.result(&format!("{}{plan}", notes.collect::<String>()))?;
    }
    Ok(Code::Done)
}

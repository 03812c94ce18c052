//! `epsilux explain`

use serde::Serialize;
use sha2::{Digest as _, Sha256};

use super::args::ExplainArgs;
use super::console::Console;
use super::failure::Failure;
use super::notes::{self, NoteJson};
use super::schema::{to_json, to_json_line};
use super::shortcuts::{self, PricedJson};
use super::{Code, load, render};
use crate::integrate::Quiet;
use crate::pilot::{self, Asked};
use crate::prepare::{Options, Plan, Shortcuts, shortcuts_of};
use crate::report::{Explanation, PlanFacts};

#[derive(Serialize)]
struct ExplainJson<'a> {
    schema: &'static str,
    file: String,
    camera: &'a str,
    #[serde(flatten)]
    plan: PlanFacts<'a>,
    plan_sha256: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    prices: Vec<PricedJson>,
    notes: Vec<NoteJson<'a>>,
}

pub(super) fn run(args: &ExplainArgs, console: &Console) -> Result<Code, Failure> {
    let loaded = load::load(&args.scene)?;
    let camera = render::camera(&loaded.scene, args.camera.as_deref())?;
    let mut options = Options {
        camera: args.camera.clone(),
        size: render::picture_size(&loaded.scene, camera, args.size),
        seed: args.seed,
        effects: args.effects.into(),
        max_depth: loaded.scene.settings.max_depth,
        shortcuts: Shortcuts::of(&loaded.scene.settings),
        transparent: false,
        algorithms: args.algorithms.meant(),
    };
    args.shortcuts.take(&mut options);
    let usual = args.error.is_none().then(|| render::default_samples(&loaded.scene));
    let asked = Asked { samples: args.spp.or(usual), error: args.error, threads: 0 };
    let plan = pilot::plan(&loaded.scene, &options, &asked).map_err(|e| Failure::usage(e.to_string()))?;
    let prices = match (args.price, plan.shortcuts.is_empty()) {
        (false, _) => None,
        (true, false) => shortcuts::prices(&loaded.scene, &options, 0, &Quiet)?,
        (true, true) => {
            let sets: Vec<_> = shortcuts_of(&loaded.scene, &plan).into_iter().map(|s| vec![s]).collect();
            shortcuts::prices_of(&loaded.scene, &options, &sets, 0, &Quiet)?
        }
    };
    let prices = prices.unwrap_or_default();
    if args.json {
        let explained = ExplainJson {
            schema: "epsilux.explain/1",
            file: args.scene.scene.display().to_string(),
            camera: &camera.name,
            plan: (&plan).into(),
            plan_sha256: record(&plan)?.sha256,
            prices: prices.iter().map(PricedJson::of_run).collect(),
            notes: notes::json(&loaded.notes),
        };
        console.result(&to_json(&explained)?)?;
    } else {
        let explanation = Explanation::new(&plan, &loaded.notes);
        let text = if console.result_colours() { explanation.coloured() } else { explanation.to_string() };
        let lines = std::iter::once(text).chain(prices.iter().map(ToString::to_string));
        console.result(&lines.collect::<Vec<_>>().join("\n"))?;
    }
    Ok(Code::Done)
}

/// A plan as a picture carries it.
pub(super) struct Record {
    /// The facts of `explain --json`, but for the kernel, which changes no picture.
    pub(super) json: String,
    /// Of that text, hexadecimal: equal plans have equal ones.
    pub(super) sha256: String,
}

/// What a picture says of the plan that made it.
pub(super) fn record(plan: &Plan) -> Result<Record, Failure> {
    let facts = PlanFacts::from(plan).of_picture();
    let json = to_json_line(&facts)?;
    let sha256 = Sha256::digest(&json).iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(Record { json, sha256 })
}

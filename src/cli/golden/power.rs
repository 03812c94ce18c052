//! `epsilux golden power`

use std::fmt::Write as _;

use serde::Serialize;

use super::args::PowerArgs;
use super::files;
use crate::cli::Code;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::schema::to_json;
use crate::golden::{self, Power, SIGNIFICANCE};
use crate::stats;

#[derive(Serialize)]
struct Json {
    schema: &'static str,
    runs: u32,
    significance: f64,
    scenes: Vec<SceneJson>,
}

#[derive(Serialize)]
struct SceneJson {
    name: String,
    spp: u32,
    notices: Vec<NoticesJson>,
}

#[derive(Serialize)]
struct NoticesJson {
    statistic: String,
    shift: f64,
}

pub(super) fn run(args: &PowerArgs, console: &Console) -> Result<Code, Failure> {
    let all = files::guarded(&args.suite)?;
    let share = stats::sidak_each(SIGNIFICANCE, all.len());
    let mut rows: Vec<(String, u32, Vec<Power>)> = Vec::new();
    for guarded in &all {
        let reference = guarded.reference()?;
        let power = golden::power_of(&reference, args.runs as usize, share);
        rows.push((guarded.entry.name.clone(), reference.settings.spp, power));
    }
    if args.json {
        let scene = |(name, spp, power): (String, u32, Vec<Power>)| SceneJson {
            name,
            spp,
            notices: power
                .into_iter()
                .map(|p| NoticesJson { statistic: p.statistic, shift: p.shift })
                .collect(),
        };
        let json = Json {
            schema: "epsilux.golden-power/1",
            runs: args.runs,
            significance: SIGNIFICANCE,
            scenes: rows.into_iter().map(scene).collect(),
        };
        console.result(&to_json(&json)?)?;
    } else {
        console.result(&table(&rows, args.runs))?;
    }
    Ok(Code::Done)
}

/// Columns: a heading, and the statistic under it.
const COLUMNS: [(&str, &str); 7] = [
    ("all light", "matched, luminance"),
    ("direct", "matched, direct"),
    ("indirect", "matched, indirect"),
    ("caustic", "matched, caustic"),
    ("glass", "matched, glass"),
    ("emitted", "matched, emitted"),
    ("variance", "noise"),
];

fn table(rows: &[(String, u32, Vec<Power>)], runs: u32) -> String {
    let mut text = format!(
        "Smallest relative change that verify --runs {runs} notices with a probability of 99 %,\nwhere one verification of all scenes in {:.0} is refused by chance:\n\n",
        1.0 / SIGNIFICANCE
    );
    let _ = write!(text, "{:<18} {:>5}", "scene", "spp");
    for (heading, _) in COLUMNS {
        let _ = write!(text, " {heading:>9}");
    }
    text.push('\n');
    for (name, spp, power) in rows {
        let _ = write!(text, "{name:<18} {spp:>5}");
        for (_, statistic) in COLUMNS {
            let cell = power.iter().find(|p| p.statistic == statistic).map_or_else(
                || "-".to_owned(),
                |p| match 100.0 * p.shift {
                    s if s >= 1000.0 => "blind".to_owned(),
                    s if s >= 10.0 => format!("{s:.0} %"),
                    s if s >= 0.01 => format!("{s:.2} %"),
                    _ => "< 0.01 %".to_owned(),
                },
            );
            let _ = write!(text, " {cell:>9}");
        }
        text.push('\n');
    }
    text
}

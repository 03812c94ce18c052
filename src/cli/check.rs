//! `epsilux check`

use std::path::Path;
use std::time::Instant;

use serde::Serialize;

use super::args::{CheckArgs, LightUnitsArg, SceneArgs};
use super::console::Console;
use super::failure::Failure;
use super::schema::to_json;
use super::signal::Stop;
use super::units::show_time;
use super::{Code, load, render};
use crate::check::{self, Bound, Case, Effort, Figure, Finding, Says, cases, check_scene};
use crate::integrate::RunError;

#[derive(Serialize)]
struct CheckJson {
    schema: &'static str,
    cases: Vec<CaseJson>,
}

#[derive(Serialize)]
struct CaseJson {
    id: &'static str,
    guards: &'static str,
    holds: bool,
    seconds: f64,
    figures: Vec<FigureJson>,
}

#[derive(Serialize)]
struct FigureJson {
    what: String,
    value: f64,
    /// `exactly`, `at-most` or `at-least`.
    bound: &'static str,
    threshold: f64,
    holds: bool,
}

#[derive(Serialize)]
struct SceneJson {
    schema: &'static str,
    scene: String,
    camera: String,
    findings: Vec<FindingJson>,
}

#[derive(Serialize)]
struct FindingJson {
    name: &'static str,
    /// `holds`, `fails`, `look` or `skipped`.
    verdict: &'static str,
    message: String,
}

#[derive(Serialize)]
struct PriceJson {
    choice: &'static str,
    twin: &'static str,
    ns: f64,
    twin_ns: f64,
    prevents: &'static str,
    figure: f64,
    twin_figure: f64,
}

/// What accuracy costs.
fn prices(json: bool, console: &Console) -> Result<Code, Failure> {
    let all = check::prices();
    if json {
        let row = |p: &check::Price| PriceJson {
            choice: p.choice,
            twin: p.twin,
            ns: p.ns[0],
            twin_ns: p.ns[1],
            prevents: p.prevents,
            figure: p.figures[0],
            twin_figure: p.figures[1],
        };
        console.result(&to_json(&all.iter().map(row).collect::<Vec<_>>())?)?;
        return Ok(Code::Done);
    }
    for p in all {
        console.result(&format!(
            "{}: {:.1} ns\n  instead of {}: {:.1} ns\n  {}: {} against {}",
            p.choice,
            p.ns[0],
            p.twin,
            p.ns[1],
            p.prevents,
            number(p.figures[0]),
            number(p.figures[1])
        ))?;
    }
    Ok(Code::Done)
}

/// Pictures of a scene of one's own are this wide.
const WIDTH: u32 = 64;

/// What must hold of any scene.
fn own(args: &CheckArgs, path: &Path, console: &Console) -> Result<Code, Failure> {
    let scene = SceneArgs { scene: path.to_path_buf(), light_units: LightUnitsArg::Auto };
    let loaded = load::load(&scene)?;
    let camera = render::camera(&loaded.scene, args.camera.as_deref())?;
    let name = camera.name.clone();
    let [w, h] = render::picture_size(&loaded.scene, camera, None);
    let size =
        [WIDTH, (u64::from(WIDTH) * u64::from(h) / u64::from(w)).clamp(1, 4 * u64::from(WIDTH)) as u32];
    let index = loaded.scene.cameras.iter().position(|c| c.name == name).unwrap_or(0);
    let stop = Stop::listen();
    let findings = check_scene(&loaded.scene, index, size, &stop).map_err(|e| match (e, stop.code()) {
        (RunError::Cancelled, Some(code)) => Failure::stopped(code, "stopped"),
        (e, _) => Failure::load(format!("{}: {e}", path.display())),
    })?;
    let fails = findings.iter().any(|f| f.verdict == Says::Fails);
    let word = |says: Says| match says {
        Says::Holds => "holds",
        Says::Fails => "fails",
        Says::Look => "look",
        Says::Skipped => "skipped",
    };
    if args.json {
        let finding = |f: Finding| FindingJson { name: f.name, verdict: word(f.verdict), message: f.message };
        let json = SceneJson {
            schema: "epsilux.check-scene/1",
            scene: path.display().to_string(),
            camera: name,
            findings: findings.into_iter().map(finding).collect(),
        };
        console.result(&to_json(&json)?)?;
    } else {
        let line = |f: &Finding| format!("{:<8} {:<10} {}", word(f.verdict), f.name, f.message);
        console.result(&findings.iter().map(line).collect::<Vec<_>>().join("\n"))?;
    }
    Ok(if fails { Code::Differs } else { Code::Done })
}

pub(super) fn run(args: &CheckArgs, console: &Console) -> Result<Code, Failure> {
    if let Some(path) = &args.scene {
        return own(args, path, console);
    }
    if args.prices {
        return prices(args.json, console);
    }
    let all = cases();
    let known = |id: &String| all.iter().any(|c| c.id.eq_ignore_ascii_case(id));
    if let Some(unknown) = args.cases.iter().find(|id| !known(id)) {
        let ids = all.iter().map(|c| c.id).collect::<Vec<_>>().join(", ");
        return Err(Failure::usage(format!("found {unknown:?}, expected some of: {ids}")));
    }
    let chosen =
        |c: &&&Case| args.cases.is_empty() || args.cases.iter().any(|id| c.id.eq_ignore_ascii_case(id));
    let effort = if args.nightly { Effort::Nightly } else { Effort::Usual };
    let mut done = Vec::new();
    for case in all.iter().filter(chosen) {
        let begin = Instant::now();
        let figures = (case.run)(effort);
        let seconds = begin.elapsed().as_secs_f64();
        let holds = figures.iter().all(Figure::holds);
        if !args.json {
            console.result(&section(case, &figures, seconds, args.figures))?;
        }
        let figures = figures.into_iter().map(FigureJson::new).collect();
        done.push(CaseJson { id: case.id, guards: case.guards, holds, seconds, figures });
    }
    let broken = done.iter().filter(|c| !c.holds).map(|c| c.id).collect::<Vec<_>>();
    let code = if broken.is_empty() { Code::Done } else { Code::Differs };
    let count = done.len();
    if args.json {
        console.result(&to_json(&CheckJson { schema: "epsilux.check/1", cases: done })?)?;
    } else if broken.is_empty() {
        console.result(&format!("{count} cases hold"))?;
    } else {
        console.result(&format!("{} of {count} cases do not hold: {}", broken.len(), broken.join(", ")))?;
    }
    Ok(code)
}

/// A case for people; of its figures those that do not hold, or all.
fn section(case: &Case, figures: &[Figure], seconds: f64, all: bool) -> String {
    let holds = figures.iter().all(Figure::holds);
    let verdict = if holds { "holds" } else { "FAILS" };
    let mut text = format!("{} {verdict}  {} ({})", case.id, case.guards, show_time(seconds));
    for f in figures.iter().filter(|f| all || !f.holds()) {
        let bound = match f.bound {
            Bound::Exactly(v) => format!("expected {}", number(v)),
            Bound::AtMost(v) => format!("at most {}", number(v)),
            Bound::AtLeast(v) => format!("at least {}", number(v)),
        };
        let mark = if f.holds() { " " } else { "!" };
        text += &format!("\n    {mark} {}: {}, {bound}", f.what, number(f.value));
    }
    text
}

/// A number with as many digits as mean something.
fn number(v: f64) -> String {
    let plain = v == 0.0 || (v.fract() == 0.0 && v.abs() < 1e7);
    if plain {
        format!("{v}")
    } else if (1e-3..1e5).contains(&v.abs()) {
        format!("{v:.6}").trim_end_matches('0').to_owned()
    } else {
        format!("{v:.2e}")
    }
}

impl FigureJson {
    fn new(f: Figure) -> Self {
        let (bound, threshold) = match f.bound {
            Bound::Exactly(v) => ("exactly", v),
            Bound::AtMost(v) => ("at-most", v),
            Bound::AtLeast(v) => ("at-least", v),
        };
        let holds = f.holds();
        Self { what: f.what, value: f.value, bound, threshold, holds }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (v, text) in
            [(0.0, "0"), (1e6, "1000000"), (0.5, "0.5"), (1.25e-7, "1.25e-7"), (0.923_077, "0.923077")]
        {
            assert_eq!(number(v), text);
        }
    }
}

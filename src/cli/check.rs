//! `epsilux check`

use std::time::Instant;

use serde::Serialize;

use super::Code;
use super::args::CheckArgs;
use super::console::Console;
use super::failure::Failure;
use super::schema::to_json;
use super::units::show_time;
use crate::check::{Bound, Case, Effort, Figure, cases};

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

pub(super) fn run(args: &CheckArgs, console: &Console) -> Result<Code, Failure> {
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

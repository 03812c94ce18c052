//! `epsilux golden verify` and `epsilux golden report`

use std::path::Path;

use serde::Serialize;

use super::args::{JudgeArgs, ReportArgs, VerifyArgs};
use super::judge::{Judged, judge};
use super::junit;
use crate::cli::Code;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::schema::to_json;
use crate::cli::units::show_time;
use crate::golden::{self, Verdict, Verification};
use crate::output;
use crate::report::probability;

pub(super) fn run(args: &VerifyArgs, console: &Console) -> Result<Code, Failure> {
    for path in [&args.junit, &args.html].into_iter().flatten() {
        check_folder(path)?;
    }
    let tell = |v: &Verification| if args.json { Ok(()) } else { console.result(&line(v)) };
    let judged = judge(&args.judge, console, &tell)?;
    if let Some(path) = &args.junit {
        write(path, &junit::xml(&judged.verifications))?;
    }
    if let Some(path) = &args.html {
        write(path, &page(&judged, &args.judge))?;
    }
    if args.json {
        console.result(&to_json(&Json::new(&judged))?)?;
    } else {
        console.result(&summary(&judged))?;
    }
    Ok(code(&judged, &args.judge))
}

pub(super) fn report(args: &ReportArgs, console: &Console) -> Result<Code, Failure> {
    check_folder(&args.output)?;
    let judged = judge(&args.judge, console, &|v| console.result(&line(v)))?;
    write(&args.output, &page(&judged, &args.judge))?;
    console.result(&summary(&judged))?;
    console.result(&args.output.display().to_string())?;
    Ok(code(&judged, &args.judge))
}

fn code(judged: &Judged, args: &JudgeArgs) -> Code {
    let fails = |v: &Verification| match v.verdict {
        Verdict::Refused => true,
        Verdict::Improved => args.strict,
        Verdict::Passed => false,
    };
    if judged.verifications.iter().any(fails) { Code::Differs } else { Code::Done }
}

fn page(judged: &Judged, args: &JudgeArgs) -> String {
    let suites = args.suite.suites.iter().map(|p| p.display().to_string()).collect::<Vec<_>>();
    let about = golden::About {
        title: "Golden tests".to_owned(),
        command: format!("epsilux golden verify {}", suites.join(" ")),
        significance: judged.significance,
        facts: vec![("Version".to_owned(), env!("CARGO_PKG_VERSION").to_owned())],
    };
    golden::page(&judged.verifications, &about)
}

/// Before hours of rendering.
fn check_folder(path: &Path) -> Result<(), Failure> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if folder.is_dir() {
        return Ok(());
    }
    Err(Failure::write(format!("{}: the folder {} does not exist", path.display(), folder.display()))
        .help(format!("mkdir -p {}", folder.display())))
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    output::write_bytes(path, text.as_bytes())
        .map_err(|e| Failure::write(format!("{}: cannot write: {e}", path.display())))
}

/// A scene in one line; more where it did not pass.
fn line(v: &Verification) -> String {
    let p = v.outcome.as_ref().map_or_else(|| "-".to_owned(), |o| probability(o.p));
    let notices =
        golden::notices(&v.power).map_or_else(String::new, |s| format!("notices {:.2} %", 100.0 * s));
    let mut text =
        format!("{:<9} {:<18} p {p:<7} {notices:<15} {}", v.verdict.word(), v.name, show_time(v.seconds));
    for reason in v.reasons.iter().take(4) {
        text += &format!("\n          {}: {}", reason.gate, reason.message);
    }
    if v.reasons.len() > 4 {
        text += &format!("\n          and {} more", v.reasons.len() - 4);
    }
    if v.verdict != Verdict::Passed {
        if !v.replay.is_empty() {
            text += &format!("\n          replay: {}", v.replay);
        }
        text += &format!("\n          bless:  {}", v.bless);
    }
    text
}

fn summary(judged: &Judged) -> String {
    let count = |verdict| judged.verifications.iter().filter(|v| v.verdict == verdict).count();
    let n = judged.verifications.len();
    let counts = [Verdict::Passed, Verdict::Improved, Verdict::Refused].map(|v| (v.word(), count(v)));
    let counts = counts.into_iter().filter(|(_, n)| *n > 0).map(|(word, n)| format!("{n} {word}"));
    format!("{n} {}: {}", if n == 1 { "scene" } else { "scenes" }, counts.collect::<Vec<_>>().join(", "))
}

#[derive(Serialize)]
struct Json<'a> {
    schema: &'static str,
    significance: f64,
    scenes: Vec<SceneJson<'a>>,
}

#[derive(Serialize)]
struct SceneJson<'a> {
    name: &'a str,
    guards: &'a str,
    truth: &'a str,
    verdict: &'static str,
    /// Of the family of statistics.
    p: Option<f64>,
    refused_below: f64,
    reasons: Vec<ReasonJson<'a>>,
    checks: Vec<CheckJson<'a>>,
    findings: Vec<FindingJson>,
    notices: Vec<NoticesJson<'a>>,
    curve: Vec<CurveJson>,
    seeds: &'a [u64],
    replay: &'a str,
    bless: &'a str,
    seconds: f64,
}

#[derive(Serialize)]
struct ReasonJson<'a> {
    gate: &'a str,
    message: &'a str,
    better: bool,
}

#[derive(Serialize)]
struct CheckJson<'a> {
    name: &'a str,
    holds: bool,
    message: &'a str,
}

#[derive(Serialize)]
struct FindingJson {
    statistic: String,
    shift: f64,
    standard_error: f64,
    z: f64,
    p: f64,
}

#[derive(Serialize)]
struct NoticesJson<'a> {
    statistic: &'a str,
    shift: f64,
}

#[derive(Serialize)]
struct CurveJson {
    spp: u32,
    error: f64,
    expected: f64,
}

/// Findings that are worth their bytes.
const TOLD: usize = 20;

impl<'a> Json<'a> {
    fn new(judged: &'a Judged) -> Self {
        let scenes = judged.verifications.iter().map(SceneJson::new).collect();
        Self { schema: "epsilux.golden-verify/1", significance: judged.significance, scenes }
    }
}

impl<'a> SceneJson<'a> {
    fn new(v: &'a Verification) -> Self {
        let reason =
            |r: &'a golden::Reason| ReasonJson { gate: &r.gate, message: &r.message, better: r.better };
        let check = |c: &'a golden::Check| CheckJson { name: c.name, holds: c.holds, message: &c.message };
        let finding = |f: &crate::stats::gate::Finding| FindingJson {
            statistic: f.statistic.to_string(),
            shift: f.shift,
            standard_error: f.error,
            z: f.z,
            p: f.p,
        };
        let curve = |c: &golden::CurvePoint| CurveJson { spp: c.spp, error: c.error, expected: c.expected };
        Self {
            name: &v.name,
            guards: &v.guards,
            truth: &v.truth,
            verdict: v.verdict.word(),
            p: v.outcome.as_ref().map(|o| o.p),
            refused_below: v.significance,
            reasons: v.reasons.iter().map(reason).collect(),
            checks: v.checks.iter().map(check).collect(),
            findings: v.outcome.iter().flat_map(|o| o.findings.iter().take(TOLD)).map(finding).collect(),
            notices: v
                .power
                .iter()
                .map(|p| NoticesJson { statistic: &p.statistic, shift: p.shift })
                .collect(),
            curve: v.curve.iter().map(curve).collect(),
            seeds: &v.seeds,
            replay: &v.replay,
            bless: &v.bless,
            seconds: v.seconds,
        }
    }
}

//! `cargo xtask calibrate --quotes E`: what was quoted, and what came.

use std::fmt;

use serde_json::{Value, json};

use super::cases::Case;
use super::table::{median, share};
use super::{Bench, SIZE, read_json, seed};
use crate::golden::println_line;

/// What is wanted of nine quotes in ten: to be so near, relative.
const SAMPLES: f64 = 0.15;
const SECONDS: f64 = 0.20;

/// A quote, and the render that it was for.
pub(super) struct Quoted {
    /// Samples and seconds, and the interval of the samples.
    quoted: Option<(f64, f64, [f64; 2])>,
    /// The same of the render.
    came: (f64, f64),
    /// Whether it reached the error.
    reached: bool,
}

impl Quoted {
    fn from_json(v: &Value) -> Option<Self> {
        let quote = &v["quote"];
        let pair = |v: &Value| Some((v["samples"].as_f64()?, v["seconds"].as_f64()?));
        let ends = || Some([quote["samples_interval"][0].as_f64()?, quote["samples_interval"][1].as_f64()?]);
        let quoted = pair(quote).zip(ends()).map(|((samples, seconds), ends)| (samples, seconds, ends));
        Some(Self { quoted, came: pair(&v["came"])?, reached: v["reached"].as_bool()? })
    }
}

/// What the quotes of a case come to, over the runs that reached the error, and those that took more than was quoted and did
/// not: these are as far off, at least, as where they ended.
pub(super) struct Quotes {
    name: &'static str,
    runs: usize,
    /// Runs that reached the error.
    reached: usize,
    /// Runs for which there was a quote.
    given: usize,
    /// Medians of quoted over actual samples and seconds, and of half the width of the interval over the quote.
    samples: f64,
    seconds: f64,
    width: f64,
    /// Quotes whose interval held the samples, and those that were as near as is wanted.
    held: usize,
    near: [usize; 2],
}

impl Quotes {
    pub(super) fn new(name: &'static str, runs: &[Quoted]) -> Self {
        let counts = |r: &&Quoted| r.reached || r.quoted.is_some_and(|q| r.came.0 > q.0);
        let pairs: Vec<_> = runs.iter().filter(counts).filter_map(|r| Some((r.came, r.quoted?))).collect();
        let ratios: Vec<[f64; 2]> = pairs.iter().map(|(c, q)| [q.0 / c.0, q.1 / c.1]).collect();
        let middle = |i: usize| median(ratios.iter().map(|r| r[i]).collect());
        let within = |i: usize, most: f64| ratios.iter().filter(|r| (r[i] - 1.0).abs() <= most).count();
        Self {
            name,
            runs: runs.len(),
            reached: runs.iter().filter(|r| r.reached).count(),
            given: pairs.len(),
            samples: middle(0),
            seconds: middle(1),
            width: median(pairs.iter().map(|(_, (n, _, [low, high]))| 0.5 * (high - low) / n).collect()),
            held: pairs.iter().filter(|(c, q)| (q.2[0]..=q.2[1]).contains(&c.0)).count(),
            near: [within(0, SAMPLES), within(1, SECONDS)],
        }
    }
}

pub(super) fn header() -> String {
    format!(
        "{:<20} {:>4} {:>7} {:>6} {:>10} {:>6} {:>6} {:>11} {:>10} {:>11}",
        "scene",
        "runs",
        "reached",
        "quotes",
        "x samples",
        "+-",
        "held",
        "within 15 %",
        "x seconds",
        "within 20 %"
    )
}

impl fmt::Display for Quotes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:<20} {:>4} {:>7} {:>6} {:>10.2} {:>4.0} % {:>4.0} % {:>9.0} % {:>10.2} {:>9.0} %",
            self.name,
            self.runs,
            self.reached,
            self.given,
            self.samples,
            100.0 * self.width,
            share(self.held, self.given),
            share(self.near[0], self.given),
            self.seconds,
            share(self.near[1], self.given),
        )
    }
}

/// Over all cases.
pub(super) fn totals(rows: &[Quotes]) -> String {
    let sum = |of: fn(&Quotes) -> usize| rows.iter().map(of).sum::<usize>();
    let given = sum(|r| r.given);
    format!(
        "{given} quotes of {} renders: {} intervals hold ({:.1} %), {} samples within 15 % ({:.1} %), {} times within 20 % ({:.1} %)",
        sum(|r| r.runs),
        sum(|r| r.held),
        share(sum(|r| r.held), given),
        sum(|r| r.near[0]),
        share(sum(|r| r.near[0]), given),
        sum(|r| r.near[1]),
        share(sum(|r| r.near[1]), given),
    )
}

impl Bench<'_> {
    /// Quotes an error, renders to it with the same seed, and keeps both.
    pub(super) fn quoted(&self, case: &Case, i: u32, error: f64, key: &str) -> Result<Value, String> {
        let (target, seed) = (format!("{}%", 100.0 * error), seed(case, i).to_string());
        let mut quote = std::process::Command::new(&self.program);
        quote.arg("quote").arg(self.root.join(case.scene)).args(case.flags).args(["--size", SIZE, "--json"]);
        quote.args(["--error", &target, "--seed", &seed]).current_dir(self.root);
        let said = crate::golden::json(&mut quote)?;
        let picture = self.picture();
        self.render(case, case.scene, &picture, &["--error", &target, "--seed", &seed, "--time", "5min"])?;
        let report = read_json(&picture.with_extension("report.json"))?;
        let stated = &report["error"];
        let reached = stated["trusted"] == true && stated["error"].as_f64().is_some_and(|e| e <= error);
        let came = json!({ "samples": report["passes"][1], "seconds": report["seconds"]["render"] });
        let (quote, pilot) = (&said["quotes"][0], &said["pilot"]);
        self.keep(json!({ "key": key, "quote": quote, "pilot": pilot, "came": came, "reached": reached }))
    }
}

/// Quotes and renders cases under some seeds each; `known` are former results.
pub(super) fn run(
    bench: &Bench<'_>,
    cases: &[&Case],
    seeds: u32,
    error: f64,
    mut known: std::collections::BTreeMap<String, Value>,
) -> Result<(), String> {
    println_line(&header());
    let mut rows = Vec::new();
    for case in cases {
        let mut runs = Vec::new();
        for i in 0..seeds {
            let key = format!("quoted {}/{i}/{error}/{}", case.name, bench.version);
            let found = match known.remove(&key) {
                Some(found) => found,
                None => bench.quoted(case, i, error, &key)?,
            };
            runs.push(Quoted::from_json(&found).ok_or_else(|| format!("{key}: the result cannot be read"))?);
        }
        let row = Quotes::new(case.name, &runs);
        println_line(&row.to_string());
        rows.push(row);
    }
    println_line(&totals(&rows));
    Ok(())
}

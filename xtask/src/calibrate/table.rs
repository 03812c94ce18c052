//! Runs as rows, and what is wanted of them.

use std::fmt;

use serde_json::Value;

use super::cases::{Case, Kind};

/// Shares of intervals that hold the truth: over everything, and of each scene.
const OVERALL: [f64; 2] = [0.92, 0.98];
const EACH: f64 = 0.85;
/// Half the width of the interval over E, at most, as the median of the runs of honest scenes from [`MANY`] samples on.
const WIDTH: f64 = 0.10;
const MANY: f64 = 64.0;
/// Share of the runs of honest scenes that may be called not trustworthy.
const DOUBTED: f64 = 0.05;
/// Share of the wrong errors of misleading scenes that have to be.
const FLAGGED: f64 = 0.95;

/// What one render stated, and the truth.
pub(super) struct Run {
    samples: f64,
    error: f64,
    interval: [f64; 2],
    trusted: bool,
    truth: f64,
}

impl Run {
    pub(super) fn from_json(v: &Value) -> Option<Self> {
        let stated = &v["error"];
        Some(Self {
            samples: v["samples"].as_f64()?,
            error: stated["error"].as_f64()?,
            interval: [stated["interval"][0].as_f64()?, stated["interval"][1].as_f64()?],
            trusted: stated["trusted"].as_bool()?,
            truth: v["truth"].as_f64()?,
        })
    }

    fn holds(&self) -> bool {
        (self.interval[0]..=self.interval[1]).contains(&self.truth)
    }
}

/// What the runs of a case come to.
pub(super) struct Row {
    name: &'static str,
    kind: Kind,
    runs: usize,
    held: usize,
    doubted: usize,
    wrong: usize,
    wrong_and_doubted: usize,
    samples: f64,
    truth: f64,
    /// Median of stated over true E.
    ratio: f64,
    width: f64,
}

impl Row {
    pub(super) fn new(case: &Case, runs: &[Run]) -> Self {
        let count = |of: &dyn Fn(&Run) -> bool| runs.iter().filter(|r| of(r)).count();
        let middle = |of: &dyn Fn(&Run) -> f64| median(runs.iter().map(of).collect());
        Self {
            name: case.name,
            kind: case.kind,
            runs: runs.len(),
            held: count(&Run::holds),
            doubted: count(&|r| !r.trusted),
            wrong: count(&|r| !r.holds()),
            wrong_and_doubted: count(&|r| !r.holds() && !r.trusted),
            samples: middle(&|r| r.samples),
            truth: middle(&|r| r.truth),
            ratio: middle(&|r| r.error / r.truth),
            width: middle(&|r| 0.5 * (r.interval[1] - r.interval[0]) / r.error),
        }
    }

    fn honest(&self) -> bool {
        self.kind != Kind::Misleading
    }
}

pub(super) fn header() -> String {
    format!(
        "{:<18} {:<10} {:>4} {:>7} {:>7} {:>7} {:>6} {:>6} {:>8} {:>8}",
        "scene", "kind", "runs", "samples", "true E", "stated", "+-", "held", "doubted", "wrong and doubted"
    )
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            Kind::Tuned => "tuned",
            Kind::Unseen => "unseen",
            Kind::Hard => "hard",
            Kind::Misleading => "misleading",
        };
        write!(
            f,
            "{:<18} {kind:<10} {:>4} {:>7.0} {:>5.2} % {:>6.2}x {:>4.1} % {:>4.0} % {:>6.0} % {:>4} of {}",
            self.name,
            self.runs,
            self.samples,
            100.0 * self.truth,
            self.ratio,
            100.0 * self.width,
            share(self.held, self.runs),
            share(self.doubted, self.runs),
            self.wrong_and_doubted,
            self.wrong,
        )
    }
}

/// Over all honest scenes, and over those that nothing was tuned on.
pub(super) fn totals(rows: &[Row]) -> String {
    let of = |name: &str, kinds: &[Kind]| {
        let rows: Vec<&Row> = rows.iter().filter(|r| kinds.contains(&r.kind)).collect();
        let sum = |of: fn(&Row) -> usize| rows.iter().map(|r| of(r)).sum::<usize>();
        let (held, runs) = (sum(|r| r.held), sum(|r| r.runs));
        format!("{name}: {held} of {runs} intervals hold the truth, {:.1} %", share(held, runs))
    };
    let honest = [Kind::Tuned, Kind::Unseen, Kind::Hard];
    [of("all honest scenes", &honest), of("those not tuned on", &[Kind::Unseen])].join("\n")
}

/// What is wanted and is not so.
pub(super) fn broken(rows: &[Row]) -> Vec<String> {
    let mut broken = Vec::new();
    let honest: Vec<&Row> = rows.iter().filter(|r| r.honest()).collect();
    for row in &honest {
        if share(row.held, row.runs) < 100.0 * EACH {
            broken.push(format!("{}: {} of {} intervals hold the truth", row.name, row.held, row.runs));
        }
        if row.kind == Kind::Hard {
            continue;
        }
        if row.samples >= MANY && row.width > WIDTH {
            broken.push(format!("{}: the interval is +-{:.1} % wide", row.name, 100.0 * row.width));
        }
        if share(row.doubted, row.runs) > 100.0 * DOUBTED {
            broken.push(format!("{}: {} of {} runs are doubted", row.name, row.doubted, row.runs));
        }
    }
    let (held, runs) = honest.iter().fold((0, 0), |(h, n), r| (h + r.held, n + r.runs));
    // Two scenes of forty runs cannot tell 92 % from 89 %: three standard errors are granted.
    let grant = 3.0 * (0.95 * 0.05 / runs.max(1) as f64).sqrt();
    let few = runs < 300;
    let (low, high) = if few { (0.95 - grant, 1.0) } else { (OVERALL[0], OVERALL[1]) };
    let held = held as f64 / runs.max(1) as f64;
    if runs > 0 && !(low..=high).contains(&held) {
        broken.push(format!("{:.1} % of all intervals hold the truth", 100.0 * held));
    }
    for row in rows.iter().filter(|r| !r.honest()) {
        if (row.wrong_and_doubted as f64) < FLAGGED * row.wrong as f64 {
            broken.push(format!(
                "{}: {} of {} wrong errors are trusted",
                row.name,
                row.wrong - row.wrong_and_doubted,
                row.wrong
            ));
        }
    }
    broken
}

pub(super) fn share(n: usize, of: usize) -> f64 {
    100.0 * n as f64 / of.max(1) as f64
}

pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

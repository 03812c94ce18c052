//! What changed between a reference and what is to replace it, for the file of blessings.

use std::fmt::Write as _;

use super::run::scalar;
use super::verdict::Verification;
use super::words::percent;
use crate::stats::gate::{Finding, Kind};

/// Whether noise differs by more than the brightness of the picture explains.
fn noise_is_another(findings: &[&Finding]) -> bool {
    const DEVIATIONS: f64 = 5.0;
    let find = |kind: Kind, of: &str| {
        findings.iter().find(|f| f.statistic.kind == kind && f.statistic.of == of).copied()
    };
    let (Some(noise), Some(light)) =
        (find(Kind::Scalar, scalar::NOISE), find(Kind::Matched, super::PLANES[0]))
    else {
        return false;
    };
    let explained = 2.0 * libm::log1p(light.shift.max(-0.99));
    (noise.shift - explained).abs() > DEVIATIONS * noise.error
}

/// The kind of change (of noise only, of the mean, of both, or none that is seen), and a table: each layer's light
/// with its 95 % interval, and noise.
#[must_use]
pub fn account(done: &Verification) -> (String, String) {
    let findings = || done.outcome.iter().flat_map(|o| &o.findings);
    let significant: Vec<&Finding> =
        done.outcome.iter().flat_map(|o| o.significant(done.significance)).collect();
    let mean = significant.iter().any(|f| f.statistic.kind != Kind::Scalar);
    let scalar = significant.iter().any(|f| f.statistic.kind == Kind::Scalar);
    // Where the picture is brighter as a whole, so is its noise, and the distance from the old mean says nothing.
    let noise = scalar && (!mean || noise_is_another(&findings().collect::<Vec<_>>()));
    let kind = match (mean, noise) {
        (true, true) => "mean and noise changed",
        (true, false) => "the mean changed",
        (false, true) => "noise changed, the mean did not",
        (false, false) => "no change is seen",
    };
    let mut text = String::from("| | change |\n|---|---|\n");
    for plane in super::PLANES {
        let of = |f: &&Finding| f.statistic.kind == Kind::Matched && f.statistic.of == plane;
        if let Some(f) = findings().find(of) {
            let _ = writeln!(text, "| {plane} | {} +- {:.2} % |", percent(f.shift), 196.0 * f.error);
        }
    }
    for (name, statistic) in [("variance of pixels", scalar::NOISE), ("error", scalar::ERROR)] {
        let of = |f: &&Finding| f.statistic.kind == Kind::Scalar && f.statistic.of == statistic;
        if let Some(f) = findings().find(of) {
            let change = percent(libm::expm1(f.shift));
            let _ = writeln!(text, "| {name} | {change} +- {:.1} % |", 196.0 * f.error);
        }
    }
    (kind.to_owned(), text)
}

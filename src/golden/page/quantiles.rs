//! Plot of p-values: those that were found against those that noise alone would give.
//!
//! Where nothing is wrong, p-values are uniform, and the k-th smallest of n is about (k - 1/2) / n: dots lie
//! along the diagonal. (Statistics share pixels, so the dots move together, and may leave it for a while.)
//! Wholes and parts of pictures share the significance separately, as [`Outcome`] says, so they are two rows of
//! dots, each with its threshold. What lies above its threshold is not chance.

use super::plot::{Area, Plot};
use super::text::{power_of_ten, probability};
use crate::stats::gate::{Finding, Kind, Outcome};

/// Dots of each row that say what they are where a pointer rests on them; the others are noise.
const NAMED: usize = 24;
/// A p-value of zero has no logarithm; this is the smallest that there is.
const SMALLEST: f64 = f64::MIN_POSITIVE;

/// The probability below which the least of `n` is improbable with `significance`: Šidák's correction, inverted.
fn threshold(significance: f64, n: usize) -> f64 {
    -libm::expm1(libm::log1p(-significance.clamp(0.0, 1.0)) / n.max(1) as f64)
}

/// Tiles and waves; the others look at a whole.
fn is_part(finding: &Finding) -> bool {
    matches!(finding.statistic.kind, Kind::Tile { .. } | Kind::Wave { .. })
}

/// One row of dots: least probable first.
struct Row<'a> {
    name: &'static str,
    class: &'static str,
    findings: Vec<&'a Finding>,
    /// What each p-value must be below to be no chance.
    threshold: f64,
}

/// Wholes and parts, each where there are some.
fn rows(outcome: &Outcome, significance: f64) -> Vec<Row<'_>> {
    let each = threshold(significance, 2);
    let row = |parts: bool, name, class| {
        let findings: Vec<&Finding> = outcome.findings.iter().filter(|f| is_part(f) == parts).collect();
        Row { name, class, threshold: threshold(each, findings.len()), findings }
    };
    let rows = [row(true, "tiles and waves", "part"), row(false, "wholes", "whole")];
    rows.into_iter().filter(|r| !r.findings.is_empty()).collect()
}

/// `None` where nothing was found.
pub(super) fn plot(outcome: &Outcome, significance: f64) -> Option<String> {
    let worst = outcome.findings.first()?;
    let rows = rows(outcome, significance);
    let observed = |p: f64| -libm::log10(if p > SMALLEST { p } else { SMALLEST });
    let limit = rows.iter().map(|r| observed(r.threshold)).fold(1.0, f64::max);
    let least = outcome.findings.iter().map(|f| observed(f.p)).fold(0.0, f64::max);
    // One gross error must not press everything else into the corner.
    let top = least.clamp(1.25 * limit, 2.2 * limit);
    let longest = rows.iter().map(|r| r.findings.len()).max().unwrap_or(1);
    let right = libm::log10(2.0 * longest as f64) * 1.04;
    let area = Area { x: [0.0, right], y: [0.0, top * 1.04] };
    let expected = |k: usize, row: &Row<'_>| -libm::log10((k as f64 + 0.5) / row.findings.len() as f64);

    let end = right.min(top);
    let mut marks = area.line("guide", [[0.0, 0.0], [end, end]]);
    for row in &rows {
        let y = observed(row.threshold);
        marks += &area.line("limit", [[0.0, y], [right, y]]);
    }
    for row in &rows {
        for (k, finding) in row.findings.iter().enumerate().rev() {
            let beyond = finding.p < row.threshold;
            let class = format!("dot {}{}", row.class, if beyond { " beyond" } else { "" });
            let says = format!("{}: p = {}", finding.statistic, probability(finding.p));
            let says = (k < NAMED).then_some(says.as_str());
            let at = [expected(k, row), observed(finding.p).min(top)];
            marks += &area.dot(&class, at, if beyond { 4.5 } else { 3.0 }, says);
        }
    }
    let highest = |row: &Row<'_>| rows.iter().all(|r| r.threshold >= row.threshold);
    for row in &rows {
        // Two thresholds are near each other: one has its name above, the other below.
        let by = [6.0, if highest(row) { -6.0 } else { 14.0 }];
        let name = format!("threshold of {}", row.name);
        marks += &area.label("limit", [0.0, observed(row.threshold)], by, "start", &name);
    }
    let beyond = outcome.significant(significance).count();
    if beyond > 0
        && let Some(row) = rows.iter().find(|r| r.findings.first().is_some_and(|f| std::ptr::eq(*f, worst)))
    {
        let off = if observed(worst.p) > top { " (off the scale)" } else { "" };
        let name = format!("{}{off}", worst.statistic);
        let at = [expected(0, row), observed(worst.p).min(top)];
        let room = at[0] > 0.5 * right;
        let (by, anchor) = if room { ([5.0, -9.0], "end") } else { ([-5.0, -9.0], "start") };
        marks += &area.label("beyond", at, by, anchor, &name);
    }
    let ticks = |to: f64, step: usize| -> Vec<(f64, String)> {
        (0..=to as usize).step_by(step).map(|i| (i as f64, power_of_ten(-(i as i32)))).collect()
    };
    let title = format!(
        "P-values found against p-values expected of noise, {} statistics; the worst is {}, p = {}; {beyond} beyond \
         the threshold",
        outcome.findings.len(),
        worst.statistic,
        probability(worst.p),
    );
    let plot = Plot {
        title: &title,
        area,
        x_ticks: ticks(area.x[1], 1),
        y_ticks: ticks(area.y[1], if area.y[1] < 7.0 { 1 } else { 2 }),
        x_label: "p expected of noise alone",
        y_label: "p found",
        marks,
    };
    Some(plot.to_svg())
}

#[cfg(test)]
mod tests {
    use super::{rows, threshold};
    use crate::golden::page::made;
    use crate::stats::sidak;

    /// The threshold is where the shared p-value is the significance.
    #[test]
    fn threshold_inverts_sidak() {
        for n in [1, 7, 200] {
            for significance in [1e-6, 1e-3, 0.05] {
                assert!((sidak(threshold(significance, n), n) / significance - 1.0).abs() < 1e-9);
            }
        }
    }

    /// The plot's thresholds are those that decide: as many dots lie beyond as are significant.
    #[test]
    fn thresholds_are_those_of_the_outcome() {
        let mut seen = 0;
        for v in made::verifications() {
            let outcome = v.outcome.expect("made with one");
            for significance in [1e-9, 1e-4, 0.05, 0.9] {
                let beyond: usize = rows(&outcome, significance)
                    .iter()
                    .map(|r| r.findings.iter().filter(|f| f.p < r.threshold).count())
                    .sum();
                assert_eq!(beyond, outcome.significant(significance).count());
                seen += beyond;
            }
        }
        assert!(seen > 10, "{seen}");
    }
}

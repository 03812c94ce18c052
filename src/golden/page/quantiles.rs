//! Plot of p-values: those that were found against those that noise alone would give.
//!
//! Where nothing is wrong, p-values are uniform, and the k-th smallest of n is about (k - 1/2) / n: dots lie
//! along the diagonal. (Statistics share pixels, so the dots move together, and may leave it for a while.)
//! What lies above the threshold is not chance.

use super::plot::{Area, Plot};
use super::text::{power_of_ten, probability};
use crate::stats::gate::Outcome;

/// Dots that say what they are where a pointer rests on them; the others are noise.
const NAMED: usize = 24;
/// A p-value of zero has no logarithm; this is the smallest that there is.
const SMALLEST: f64 = f64::MIN_POSITIVE;

/// The probability below which one of `n` findings alone refuses a scene: Šidák's correction, inverted.
pub(super) fn threshold(significance: f64, n: usize) -> f64 {
    -libm::expm1(libm::log1p(-significance.clamp(0.0, 1.0)) / n.max(1) as f64)
}

/// `None` where nothing was found.
pub(super) fn plot(outcome: &Outcome, significance: f64) -> Option<String> {
    let n = outcome.findings.len();
    let worst = outcome.findings.first()?;
    let observed = |p: f64| -libm::log10(if p > SMALLEST { p } else { SMALLEST });
    let limit = observed(threshold(significance, n)).max(1.0);
    // One gross error must not press everything else into the corner.
    let top = observed(worst.p).clamp(1.2 * limit, 2.2 * limit);
    let right = libm::log10(2.0 * n as f64) * 1.04;
    let area = Area { x: [0.0, right], y: [0.0, top * 1.04] };
    let end = right.min(top);
    let mut marks = area.line("guide", [[0.0, 0.0], [end, end]]);
    marks += &area.line("limit", [[0.0, limit], [right, limit]]);
    marks += &area.label("limit", [0.0, limit], [6.0, -6.0], "start", "threshold");
    for (k, finding) in outcome.findings.iter().enumerate().rev() {
        let expected = -libm::log10((k as f64 + 0.5) / n as f64);
        let y = observed(finding.p);
        let class = if y > limit { "dot beyond" } else { "dot" };
        let says = format!("{}: p = {}", finding.statistic, probability(finding.p));
        let says = (k < NAMED).then_some(says.as_str());
        marks += &area.dot(class, [expected, y.min(top)], if y > limit { 4.5 } else { 3.0 }, says);
    }
    let beyond = observed(worst.p) > limit;
    if beyond {
        let at = [-libm::log10(0.5 / n as f64), observed(worst.p).min(top)];
        let off = if observed(worst.p) > top { " (off the scale)" } else { "" };
        let name = format!("{}{off}", worst.statistic);
        marks += &area.label("beyond", at, [5.0, -9.0], "end", &name);
    }
    let ticks = |to: f64, step: usize| -> Vec<(f64, String)> {
        (0..=to as usize).step_by(step).map(|i| (i as f64, power_of_ten(-(i as i32)))).collect()
    };
    let title = format!(
        "P-values found against p-values expected of noise, {n} statistics; the smallest is {}, of {}; {}",
        probability(worst.p),
        worst.statistic,
        if beyond { "it lies beyond the threshold" } else { "none lies beyond the threshold" }
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
    use super::threshold;
    use crate::stats::sidak;

    /// The threshold is where the family's p-value is the significance.
    #[test]
    fn threshold_inverts_sidak() {
        for n in [1, 7, 200] {
            for significance in [1e-6, 1e-3, 0.05] {
                assert!((sidak(threshold(significance, n), n) / significance - 1.0).abs() < 1e-9);
            }
        }
    }
}

//! Tables of what the statistics found.

use super::text::{Text, change, probability, signed};
use crate::golden::run::scalar;
use crate::stats::gate::{Finding, Kind, Outcome};

/// Rows of the table of the least probable.
const WORST: usize = 8;
/// Deviations at the ends of a bar.
const MOST: f64 = 6.0;

/// Two tables: the least probable findings, and the least probable of each kind.
pub(super) fn tables(outcome: &Outcome, significance: f64) -> String {
    let worst: Vec<&Finding> = outcome.findings.iter().take(WORST).collect();
    let significant: Vec<&Finding> = outcome.significant(significance).collect();
    let first = table("Least probable", &worst, &significant);
    first + &table("Least probable of each kind", &of_each_kind(outcome), &significant)
}

/// Of the image, of each layer by matched filter, of tiles of each size, of waves, and of each scalar; kinds in
/// this order.
fn of_each_kind(outcome: &Outcome) -> Vec<&Finding> {
    fn group(f: &Finding) -> (u8, usize, &str) {
        match &f.statistic.kind {
            Kind::Image => (0, 0, ""),
            Kind::Matched => (1, 0, &f.statistic.of),
            Kind::Tile { side, .. } => (2, *side, ""),
            Kind::Wave { .. } => (3, 0, ""),
            Kind::Scalar => (4, 0, &f.statistic.of),
        }
    }
    let mut best: Vec<&Finding> = Vec::new();
    for finding in &outcome.findings {
        if best.iter().all(|b| group(b) != group(finding)) {
            best.push(finding);
        }
    }
    // Findings come least probable first, and the sort keeps that order within a kind.
    best.sort_by_key(|f| (group(f).0, group(f).1));
    best
}

/// The shift as people read it; most scalars are logarithms, and changes of what they are logarithms of.
pub(super) fn shift(finding: &Finding) -> String {
    match (&finding.statistic.kind, finding.statistic.of.as_str()) {
        (Kind::Scalar, scalar::NOISE | scalar::ERROR | scalar::PEAKS) => change(libm::expm1(finding.shift)),
        (Kind::Scalar, _) => signed(finding.shift, 3),
        _ => change(finding.shift),
    }
}

/// A bar from the middle, to the left in blue and to the right in orange.
fn bar(z: f64) -> String {
    let length = if z.is_nan() { 0.0 } else { (z / MOST).clamp(-1.0, 1.0) * 30.0 };
    let class = if length < 0.0 { "less" } else { "more" };
    let (x, width) = (30.0 + length.min(0.0), length.abs());
    format!(
        "<svg class=\"bar\" viewBox=\"0 0 60 10\" aria-hidden=\"true\"><rect class=\"{class}\" x=\"{x:.1}\" \
         y=\"1\" width=\"{width:.1}\" height=\"8\"/><path class=\"axis\" d=\"M30 0V10\"/></svg>"
    )
}

fn table(caption: &str, findings: &[&Finding], significant: &[&Finding]) -> String {
    let row = |f: &&Finding| {
        format!(
            "<tr{}><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td>\
             <td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            if significant.iter().any(|s| std::ptr::eq(*s, *f)) { " class=\"beyond\"" } else { "" },
            Text(&f.statistic.to_string()),
            Text(&shift(f)),
            Text(&signed(f.z, 1)),
            bar(f.z),
            Text(&probability(f.p)),
            Text(&probability(f.shared))
        )
    };
    let rows: String = findings.iter().map(row).collect();
    format!(
        "<div class=\"scroll\"><table class=\"findings\"><caption>{}</caption>\n<thead><tr>\
         <th scope=\"col\">Statistic</th><th scope=\"col\" class=\"n\">Shift</th>\
         <th scope=\"col\" class=\"n\"><i>z</i></th><td></td><th scope=\"col\" class=\"n\"><i>p</i></th>\
         <th scope=\"col\" class=\"n\">shared</th></tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>\n",
        Text(caption)
    )
}

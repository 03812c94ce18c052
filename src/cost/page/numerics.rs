//! The second price list: robust numerics beside what would be cheaper.

use super::words::{round, thousands};
use crate::check::Price;
use crate::cost::report::CostReport;
use crate::page::text::{Text, change, probability};

/// A table, and what double precision would cost; empty where neither was measured.
pub(super) fn prices(report: &CostReport, prices: &[Price]) -> String {
    let mut html = String::new();
    if !prices.is_empty() {
        let rows: String = prices.iter().map(row).collect();
        html += &format!(
            "<p class=\"note\">Each choice of the renderer beside its cheap twin: nanoseconds a call on this machine, and what the \
             twin loses. This is the same for every scene.</p>\n<div class=\"scroll\"><table class=\"numerics\">\n<thead><tr>\
             <th scope=\"col\">Choice, and its twin</th><th scope=\"col\" class=\"n\">Costs</th><th scope=\"col\">What it prevents</th>\
             <th scope=\"col\" class=\"n\">With</th><th scope=\"col\" class=\"n\">Without</th></tr></thead>\n<tbody>\n{rows}</tbody>\
             </table></div>\n"
        );
    }
    if let Some(d) = &report.double {
        let may_be_zero = d.difference.may_be_zero();
        let word = if may_be_zero { "differs by no more than noise" } else { "differs" };
        html += &format!(
            "<p>The reference integrator, brute force in double precision, takes <b>{} times</b> as long a sample. Its light {word} \
             from that of single precision: {} \u{b1} {} ({} samples at {}\u{d7}{}).</p>\n",
            round(d.time_ratio),
            Text(&change(d.difference.value)),
            Text(change(d.difference.within()).trim_start_matches('+')),
            d.spp,
            d.size[0],
            d.size[1],
        );
    }
    html
}

fn row(p: &Price) -> String {
    let [own, twin] = p.ns;
    format!(
        "<tr><th scope=\"row\">{}<span class=\"what\">instead of: {}</span></th><td class=\"n\">{:.0} ns<span class=\"what\">instead of \
         {:.0} ns</span></td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        Text(p.choice),
        Text(p.twin),
        own,
        twin,
        Text(p.prevents),
        figure(p.figures[0]),
        figure(p.figures[1]),
    )
}

/// A figure, two digits.
fn figure(v: f64) -> String {
    match v.abs() {
        a if (0.01..10.0).contains(&a) => format!("{v:.2}"),
        a if a >= 10.0 => thousands(v),
        // Written as small probabilities are.
        _ => probability(v),
    }
}

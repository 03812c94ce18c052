//! The answers at the top, the table of all switches, and what is said beforehand.

use super::words::{Words, brightness, capital, percent_of_target, round, signed, thousands};
use crate::cost::report::{CostReport, MAIN, Measured, Until};
use crate::cost::switches::Kind;
use crate::page::text::{Text, percent};

/// Rows of the short lists.
const SHORT: usize = 5;

/// Three answers: the price list, the price of effects, and what one would give up.
pub(super) fn answers(report: &CostReport, words: &Words<'_>) -> String {
    let cards = [
        ("What does an error cost?", price_list(words)),
        ("What does each effect cost?", effects(words)),
        ("What would I give up?", given_up(report, words)),
    ];
    let card = |(name, body): &(&str, String)| {
        if body.is_empty() {
            return String::new();
        }
        format!("<section class=\"card\">\n<h2>{name}</h2>\n{body}</section>\n")
    };
    format!("<div class=\"answers\">\n{}</div>\n", cards.iter().map(card).collect::<String>())
}

fn price_list(words: &Words<'_>) -> String {
    let Some(full) = words.full().filter(|f| !f.prices.is_empty()) else { return String::new() };
    let row = |p: &crate::cost::report::Price| {
        let main = if p.error == MAIN { " class=\"main\"" } else { "" };
        let mark =
            if p.measured { "" } else { "<span class=\"muted\" title=\"beyond what was measured\">*</span>" };
        format!(
            "<tr{main}><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\"><b>{}</b>{mark}</td></tr>\n",
            percent_of_target(p.error),
            thousands(p.samples.value),
            Text(&words.time(p.seconds.value)),
        )
    };
    let rows: String = full.prices.iter().map(row).collect();
    let note = if full.prices.iter().all(|p| p.measured) {
        ""
    } else {
        "<p class=\"note\">* beyond what was measured; half the error is four times the price</p>\n"
    };
    format!(
        "<table class=\"list\">\n<thead><tr><th scope=\"col\">Error</th><th scope=\"col\" class=\"n\">Samples</th>\
         <th scope=\"col\" class=\"n\">Time</th></tr></thead>\n<tbody>\n{rows}</tbody></table>\n{note}"
    )
}

/// Share of the price that each effect has, as bars.
fn effects(words: &Words<'_>) -> String {
    let shares = words.shares();
    let row = |(share, m): &(f64, &Measured)| {
        format!(
            "<li><span class=\"name\">{}</span> <span class=\"number\">{}</span>{}</li>\n",
            Text(&capital(&m.gives_up)),
            Text(&percent(share.max(0.0))),
            bar(*share, "blue"),
        )
    };
    let rows: String = shares.iter().take(SHORT).map(row).collect();
    if rows.is_empty() {
        return String::new();
    }
    let target = percent_of_target(MAIN);
    format!(
        "<ul class=\"bars\">\n{rows}</ul>\n<p class=\"note\">of the time to {target}: what rendering without it saves. \
         Shares overlap, and do not add up.</p>\n"
    )
}

/// What a picture without something costs, and lacks; those first that stay the better choice the longest.
fn given_up(report: &CostReport, words: &Words<'_>) -> String {
    let mut shortcuts: Vec<&Measured> = super::of_kind(report, Kind::Shortcut).map(|(_, m)| m).collect();
    let error = |m: &Measured| match m.until {
        Until::Seconds { error, .. } => error,
        Until::NotSeen => 0.0,
        Until::Never | Until::NotKnown | Until::NoShortcut => f64::INFINITY,
    };
    shortcuts.retain(|m| error(m).is_finite());
    shortcuts.sort_by(|a, b| error(a).total_cmp(&error(b)));
    let row = |m: &&Measured| {
        let takes = m.price(MAIN).map_or_else(String::new, |p| words.time(p.seconds.value));
        let floor = if m.floor.low > 0.0 {
            format!(", error above {}", percent(m.floor.value))
        } else {
            String::new()
        };
        let worth = match m.until {
            Until::Seconds { error, .. } => format!("; worth it for errors above {}", percent(error)),
            _ => "; what it lacks did not show in what was measured".into(),
        };
        format!(
            "<li><span class=\"name\">{}</span> <span class=\"number\">{}</span><span class=\"what\">{}{}{}</span></li>\n",
            Text(&capital(&m.name)),
            Text(&takes),
            Text(&brightness(m)),
            Text(&floor),
            Text(&worth),
        )
    };
    let rows: String = shortcuts.iter().take(SHORT - 1).map(row).collect();
    if rows.is_empty() {
        return "<p>Nothing that was tried is worth it: without it the same noise costs as much.</p>\n"
            .into();
    }
    let target = percent_of_target(MAIN);
    format!(
        "<ul class=\"bars\">\n{rows}</ul>\n<p class=\"note\">Times are those to a noise of {target}.</p>\n"
    )
}

/// A horizontal bar of a share in [0, 1].
pub(super) fn bar(share: f64, class: &str) -> String {
    let width = 100.0 * share.clamp(0.0, 1.0);
    format!(
        "<svg class=\"share\" viewBox=\"0 0 100 6\" preserveAspectRatio=\"none\" aria-hidden=\"true\">\
         <rect class=\"rest\" width=\"100\" height=\"6\"/><rect class=\"{class}\" width=\"{width:.1}\" height=\"6\"/></svg>"
    )
}

/// All switches, a row each.
pub(super) fn table(report: &CostReport, words: &Words<'_>) -> String {
    let row = |m: &Measured| {
        let unknown = || if m.does_not_converge() { "not converging" } else { "unknown" }.to_owned();
        let time = m.price(MAIN).map_or_else(unknown, |p| words.time(p.seconds.value));
        let unbiased = m.kind != Kind::Shortcut;
        let change = if m.kind == Kind::Full { "\u{2013}".into() } else { signed(m) };
        let floor = match (unbiased, m.floor.low > 0.0) {
            (true, _) => "\u{2013}".into(),
            (false, true) => percent(m.floor.value),
            (false, false) => format!("below {}", percent(m.floor.high)),
        };
        let efficiency = m
            .efficiency
            .map_or_else(|| "unknown".into(), |e| if e < 9.95 { format!("{e:.2}") } else { round(e) });
        format!(
            "<tr><th scope=\"row\">{}<span class=\"what\">{}{}</span></th><td class=\"n\" data-is=\"takes\">{}</td>\
             <td class=\"n\" data-is=\"efficiency\">{}{}</td><td class=\"n\" data-is=\"rays a sample\">{:.1}</td>{}{}{}</tr>\n",
            Text(&capital(&m.name)),
            Text(&m.what),
            flag(m),
            Text(&time),
            Text(&efficiency),
            efficiency_bar(m.efficiency),
            m.rays_per_sample,
            cell("light", &change),
            cell("error floor", &floor),
            cell("better until", &words.until(&m.until)),
        )
    };
    let mut rows = String::new();
    for (kind, name) in [
        (Kind::Full, ""),
        (Kind::Algorithm, "Other ways to the same picture"),
        (Kind::Shortcut, "Shortcuts: another picture"),
    ] {
        let of: String = super::of_kind(report, kind).map(|(_, m)| row(m)).collect();
        if !of.is_empty() && !name.is_empty() {
            rows += &format!("<tr class=\"group\"><th colspan=\"7\" scope=\"rowgroup\">{name}</th></tr>\n");
        }
        rows += &of;
    }
    format!(
        "<div class=\"scroll\"><table class=\"switches\">\n<thead><tr><th scope=\"col\">Way</th>\
         <th scope=\"col\" class=\"n\">Noise {}</th><th scope=\"col\" class=\"n\">Efficiency</th>\
         <th scope=\"col\" class=\"n\">Rays a sample</th><th scope=\"col\" class=\"n\">Light</th>\
         <th scope=\"col\" class=\"n\">Error floor</th><th scope=\"col\" class=\"n\">Better until (E)</th></tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>\n",
        percent_of_target(MAIN)
    )
}

/// A cell of HTML; narrow screens leave out those with nothing in them.
fn cell(name: &str, html: &str) -> String {
    let none = if html == "\u{2013}" { " none" } else { "" };
    format!("<td class=\"n{none}\" data-is=\"{name}\">{html}</td>")
}

/// How it is typed.
fn flag(m: &Measured) -> String {
    if m.flag.is_empty() { String::new() } else { format!(" <code>{}</code>", Text(&m.flag)) }
}

/// A bar from one, to the right where it is more; a hundred times is the whole half.
fn efficiency_bar(efficiency: Option<f64>) -> String {
    let Some(e) = efficiency.filter(|e| *e > 0.0 && e.is_finite()) else { return String::new() };
    let length = (0.5 * libm::log10(e)).clamp(-1.0, 1.0) * 40.0;
    let (x, class) = if length < 0.0 { (40.0 + length, "orange") } else { (40.0, "blue") };
    format!(
        "<svg class=\"efficiency\" viewBox=\"0 0 80 8\" aria-hidden=\"true\"><rect class=\"{class}\" x=\"{x:.1}\" y=\"1\" \
         width=\"{:.1}\" height=\"6\"/><path class=\"axis\" d=\"M40 0V8\"/></svg>",
        length.abs()
    )
}

/// What the squared error of each way consists of, at the most samples that were measured.
pub(super) fn consists(report: &CostReport) -> String {
    let reference = report.reference_error * report.reference_error;
    let row = |m: &Measured| {
        let last = m.points.last()?;
        let parts = [last.noise * last.noise, last.bias_squared.value.max(0.0), reference];
        let all: f64 = parts.iter().sum();
        let mut from = 0.0;
        let mut bars = String::new();
        for (part, class) in parts.iter().zip(["blue", "green", "grey"]) {
            let width = 100.0 * part / all.max(f64::MIN_POSITIVE);
            bars += &format!("<rect class=\"{class}\" x=\"{from:.1}\" width=\"{width:.1}\" height=\"10\"/>");
            from += width;
        }
        Some(format!(
            "<li><span class=\"name\">{}</span> <span class=\"number\">{}</span><svg class=\"stack\" viewBox=\"0 0 100 10\" \
             preserveAspectRatio=\"none\" role=\"img\"><title>noise {}, bias {}, noise of the reference {}</title>{bars}</svg></li>\n",
            Text(&capital(&m.name)),
            Text(&percent(last.error.value)),
            Text(&percent(parts[0].sqrt())),
            Text(&percent(parts[1].sqrt())),
            Text(&percent(report.reference_error)),
        ))
    };
    let rows: String = report.switches.iter().filter_map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        "<p class=\"note\">Shares of E\u{b2} after the most samples that were measured, for about the same time each: \
         <span class=\"key expected\">noise</span> <span class=\"key floor\">bias</span> <span class=\"key reference\">noise of the \
         reference, which is subtracted</span></p>\n<ul class=\"bars stacks\">\n{rows}</ul>\n"
    )
}

/// What a quote said of the samples, and how many it took.
pub(super) fn beforehand(report: &CostReport) -> String {
    let mut html = String::new();
    if let Some(p) = &report.prediction {
        let of = if p.every > 1 { format!(" at one pixel in {}", p.every) } else { String::new() };
        let said = match p.samples {
            Some(s) => format!(
                "<b>{} samples</b><span class=\"what\">{} to {}</span>",
                thousands(s.value),
                thousands(s.low),
                thousands(s.high)
            ),
            None => "no quote<span class=\"what\">too little was seen</span>".into(),
        };
        html += &format!(
            "<table class=\"list narrow\">\n<tbody>\n<tr><th scope=\"row\">After {} samples{of} <code>epsilux quote</code> says that \
             an error of {} takes</th><td class=\"n\">{said}</td></tr>\n<tr class=\"main\"><th scope=\"row\">It took</th>\
             <td class=\"n\"><b>{} samples</b></td></tr>\n</tbody></table>\n",
            p.after,
            Text(&percent(p.error)),
            thousands(f64::from(p.came)),
        );
    }
    let [held, of] = report.stated;
    if of > 0 {
        html += &format!(
            "<p class=\"note\">Each picture states its own error with a 95\u{a0}% interval, without a reference: {held} of {of} \
             held the error that was measured.</p>\n"
        );
    }
    html
}

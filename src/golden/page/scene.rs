//! One scene of a page: what it guards, how it fared and why, pictures, plots, tables, commands.

use super::pictures::{self, Square};
use super::text::{Text, count, percent, probability, seconds, signed};
use super::{badge, curve, findings, quantiles};
use crate::golden::{Check, Power, Reason, Verdict, Verification};
use crate::page::picture;
use crate::stats::gate::{Finding, Kind, Outcome};

/// Tiles that are outlined, at most.
const OUTLINED: usize = 6;

/// The section of a scene; `id` is what links lead to.
pub(super) fn section(v: &Verification, id: &str) -> String {
    let open = if v.verdict == Verdict::Passed { "" } else { " open" };
    format!(
        "<section class=\"scene {}\">\n<details{open}>\n<summary><h2>{}</h2> {} <span class=\"gist\">{}</span>\
         </summary>\n<div class=\"body\" id=\"{id}\">\n{}{}{}{}{}<div class=\"tables\">\n{}{}</div>\n{}</div>\n</details>\n</section>\n",
        v.verdict.word(),
        Text(&v.name),
        badge(v.verdict),
        Text(&gist(v)),
        reasons(v),
        pictures_of(v),
        layers(v),
        plots(v),
        tables(v),
        facts(v),
        checks(v),
        commands(v)
    )
}

/// The one thing to know about how a scene fared.
pub(super) fn gist(v: &Verification) -> String {
    if let Some(first) = v.reasons.first() {
        let more = v.reasons.len() - 1;
        let more = if more > 0 { format!(" (and {more} more)") } else { String::new() };
        return first.message.clone() + &more;
    }
    let least = v.outcome.as_ref().and_then(|o| o.findings.first());
    let says =
        |f: &Finding| format!("{} {}, shared p = {}", f.statistic, findings::shift(f), probability(f.shared));
    least.map_or_else(String::new, says)
}

/// The smallest shift that would be noticed, and by what: of the whole picture's light where that is told, as a
/// part of the light that hardly varies would promise too much.
pub(super) fn notices(v: &Verification) -> Option<(String, &str)> {
    let known = || v.power.iter().filter(|p| p.shift.is_finite());
    let whole = known().find(|p| p.statistic == "matched, luminance");
    let told = whole.or_else(|| known().min_by(|a, b| a.shift.total_cmp(&b.shift)))?;
    Some((percent(told.shift), &told.statistic))
}

fn reasons(v: &Verification) -> String {
    let item = |r: &Reason| {
        let class = if r.better { "better" } else { "worse" };
        let gate = if r.message.contains(&r.gate) { "" } else { r.gate.as_str() };
        format!("<li class=\"{class}\"><b>{}</b> <span>{}</span></li>\n", Text(&r.message), Text(gate))
    };
    let mut html = format!("<p class=\"guards\">{}</p>\n", Text(&v.guards));
    if !v.reasons.is_empty() {
        html += &format!(
            "<h3>{}</h3>\n<ul class=\"reasons\">\n{}</ul>\n",
            if v.verdict == Verdict::Refused { "Why it is refused" } else { "What is better" },
            v.reasons.iter().map(item).collect::<String>()
        );
    }
    html
}

fn checks(v: &Verification) -> String {
    if v.checks.is_empty() {
        return String::new();
    }
    let item = |c: &Check| {
        let (word, mark) = if c.holds { ("holds", '\u{2713}') } else { ("fails", '\u{2717}') };
        format!(
            "<li class=\"{word}\"><span class=\"mark\" role=\"img\" aria-label=\"{word}\">{mark}</span> \
             <span><b>{}</b> {}</span></li>\n",
            Text(c.name),
            Text(&c.message)
        )
    };
    let items: String = v.checks.iter().map(item).collect();
    format!("<div>\n<h3>Checks</h3>\n<ul class=\"checks\">\n{items}</ul>\n</div>\n")
}

fn pictures_of(v: &Verification) -> String {
    let stops = picture::exposure(&v.reference.rgb);
    let stops_said = format!("shown at {} stops", signed(f64::from(stops), 1));
    let alt = format!("{}: reference", v.name);
    let mut html = pictures::radiance(&v.reference, stops, "Reference", &stops_said, &alt);
    match &v.image {
        Some(image) => {
            let detail = match v.seeds.len() {
                0 => "as it was given".to_owned(),
                n => format!("{} of {} spp", count(n, "run"), v.spp),
            };
            html += &pictures::radiance(image, stops, "Render", &detail, &format!("{}: render", v.name));
        }
        None => html += &pictures::missing("Render", "nothing could be rendered"),
    }
    let squares = v.outcome.as_ref().map_or_else(Vec::new, |o| refused_tiles(o, v.significance));
    let maps = pictures::differences(&v.z, v.reference.width as usize, &squares, &v.name);
    let legend = if maps.is_empty() { String::new() } else { pictures::legend(!squares.is_empty()) };
    format!("<h3>Pictures</h3>\n<div class=\"pictures\">\n{html}{maps}</div>\n{legend}")
}

/// Tiles that alone would refuse the scene, least probable first; of those that overlap, the first.
fn refused_tiles(outcome: &Outcome, significance: f64) -> Vec<Square> {
    let mut squares: Vec<Square> = Vec::new();
    for finding in outcome.significant(significance) {
        let Kind::Tile { side, at: [x, y] } = finding.statistic.kind else { continue };
        let apart = |&[left, top, other]: &Square| {
            x + side <= left || left + other <= x || y + side <= top || top + other <= y
        };
        if squares.len() < OUTLINED && squares.iter().all(apart) {
            squares.push([x, y, side]);
        }
    }
    squares
}

fn layers(v: &Verification) -> String {
    let strips = pictures::layers(&v.reference, v.image.as_ref(), &v.name);
    if strips.is_empty() {
        return String::new();
    }
    format!(
        "<h3>Parts of the light</h3>\n<p class=\"note\">Reference on the left, render on the right; each part has its \
         own exposure. Below: its share of the reference, and the change of its sum.</p>\n<div class=\"layers\">\n{strips}</div>\n"
    )
}

fn plots(v: &Verification) -> String {
    let quantiles = v.outcome.as_ref().and_then(|o| quantiles::plot(o, v.significance)).map(|svg| {
        format!(
            "<figure>{svg}<figcaption><b>p-values</b> Along the dashed diagonal lies what noise alone gives; filled dots are wholes, open ones tiles and waves.\
             </figcaption></figure>\n"
        )
    });
    let curve = curve::plot(&v.curve).map(|svg| {
        format!(
            "<figure>{svg}<figcaption><b>Error over samples</b> <span class=\"key found\">this render</span> \
             <span class=\"key expected\">the reference\u{2019}s runs, two thirds of them in the band</span> \
             <span class=\"key guide\">slope \u{2212}\u{bd}</span></figcaption></figure>\n"
        )
    });
    match (quantiles, curve) {
        (None, None) => String::new(),
        (a, b) => format!(
            "<h3>Plots</h3>\n<div class=\"plots\">\n{}{}</div>\n",
            a.unwrap_or_default(),
            b.unwrap_or_default()
        ),
    }
}

fn tables(v: &Verification) -> String {
    let Some(outcome) = v.outcome.as_ref().filter(|o| !o.findings.is_empty()) else { return String::new() };
    format!(
        "<h3>Statistics</h3>\n<div class=\"tables\">\n{}</div>\n",
        findings::tables(outcome, v.significance)
    )
}

fn facts(v: &Verification) -> String {
    let mut rows = vec![("Truth", Text(&v.truth).to_string())];
    let seeds = v.seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    let word = if v.seeds.len() == 1 { "seed" } else { "seeds" };
    if !v.seeds.is_empty() {
        let runs = format!("{} samples a pixel, {word} <span class=\"seeds\">{}</span>", v.spp, Text(&seeds));
        rows.push(("Runs", runs));
    }
    if let Some(outcome) = &v.outcome {
        let family = format!(
            "p = {} over {}, threshold {}",
            probability(outcome.p),
            count(outcome.findings.len(), "statistic"),
            probability(v.significance)
        );
        rows.push(("Together", family));
    }
    if !v.power.is_empty() {
        let item = |p: &Power| format!("<li>{} {}</li>", percent(p.shift), Text(&p.statistic));
        let items: String = v.power.iter().map(item).collect();
        rows.push(("Notices", format!("<ul class=\"power\">{items}</ul> with a probability of 99\u{a0}%")));
    }
    rows.push(("Time", seconds(v.seconds)));
    let rows: String =
        rows.iter().map(|(term, what)| format!("<div><dt>{term}</dt><dd>{what}</dd></div>\n")).collect();
    format!("<div>\n<h3>About this test</h3>\n<dl class=\"facts\">\n{rows}</dl>\n</div>\n")
}

fn commands(v: &Verification) -> String {
    let command = |what: &str, command: &str| {
        if command.is_empty() {
            return String::new();
        }
        format!("<p>{what}</p>\n<pre><code>{}</code></pre>\n", Text(command))
    };
    let replay = command("Render it again with the seed that was used:", &v.replay);
    // Nobody blesses what has not changed.
    let bless = match v.verdict {
        Verdict::Passed => String::new(),
        _ => command("Accept what was rendered as the new reference, and say why:", &v.bless),
    };
    format!("<div class=\"commands\">\n<h3>Commands</h3>\n{replay}{bless}</div>\n")
}

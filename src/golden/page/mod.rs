//! A page about a run of golden tests, for whoever wants to know why it was refused.
//!
//! In: [`Verification`]s. Out: one HTML document. Invariants: it needs nothing beside itself (no script, no
//! picture, font or style from elsewhere), equal verifications make equal pages, and foreign text in it is
//! escaped. It is made for a screen of any width, in light and dark, and for paper, where every section is
//! unfolded.

mod curve;
mod findings;
mod pictures;
mod quantiles;
mod scene;

#[cfg(test)]
mod made;
#[cfg(test)]
mod tests;

use std::cmp::Reverse;

use super::{Verdict, Verification};
use crate::page::{self, plot, text};
use text::{Text, probability, seconds};

/// What a page says about the run as a whole.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// Heading, such as `Golden tests`.
    pub title: String,
    /// The command that made the page.
    pub command: String,
    /// Probability that one of the scenes, or more, is refused by chance where nothing is wrong.
    pub significance: f64,
    /// Further facts, each with its name, such as the version or the processor.
    pub facts: Vec<(String, String)>,
}

/// The page, a whole HTML document in UTF-8. Refused scenes come first and are unfolded, as improved ones are;
/// otherwise scenes keep their order.
#[must_use]
pub fn page(verifications: &[Verification], about: &About) -> String {
    let mut scenes: Vec<&Verification> = verifications.iter().collect();
    scenes.sort_by_key(|v| Reverse(v.verdict));
    let ids = ids(&scenes);
    let sections: String = scenes.iter().zip(&ids).map(|(v, id)| scene::section(v, id)).collect();
    let outcome = outcome(verifications);
    let body = format!(
        "<header>\n<p class=\"title\">{title}</p>\n<h1 class=\"{word}\">{outcome}</h1>\n</header>\n\
         <main>\n{table}{sections}</main>\n{footer}",
        title = Text(&about.title),
        outcome = Text(&outcome),
        word = verifications.iter().map(|v| v.verdict).max().unwrap_or(Verdict::Passed).word(),
        table = table(&scenes, &ids),
        footer = footer(about),
    );
    page::document(&format!("{}: {outcome}", about.title), include_str!("style.css"), &body, "")
}

/// `17 scenes: 15 passed, 1 improved, 1 refused`.
fn outcome(verifications: &[Verification]) -> String {
    let n = verifications.len();
    let scenes = if n == 1 { "scene" } else { "scenes" };
    let parts = [Verdict::Passed, Verdict::Improved, Verdict::Refused].map(|verdict| {
        let n = verifications.iter().filter(|v| v.verdict == verdict).count();
        (n > 0).then(|| format!("{n} {}", verdict.word()))
    });
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    if parts.is_empty() {
        "no scene was verified".into()
    } else {
        format!("{n} {scenes}: {}", parts.join(", "))
    }
}

/// A verdict as a mark and a word.
fn badge(verdict: Verdict) -> String {
    let mark = match verdict {
        Verdict::Passed => '\u{2713}',
        Verdict::Improved => '\u{2191}',
        Verdict::Refused => '\u{2717}',
    };
    let word = verdict.word();
    format!("<span class=\"badge {word}\"><span aria-hidden=\"true\">{mark}</span> {word}</span>")
}

/// What links to scenes lead to: names as far as they can be part of a link, each once.
fn ids(scenes: &[&Verification]) -> Vec<String> {
    let mut ids: Vec<String> = Vec::new();
    for v in scenes {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        let mut id: String = v.name.chars().map(plain).collect();
        if id.is_empty() || ids.contains(&id) {
            id += &format!("-{}", ids.len() + 1);
        }
        ids.push(id);
    }
    ids
}

/// All scenes, a row each.
fn table(scenes: &[&Verification], ids: &[String]) -> String {
    if scenes.is_empty() {
        return String::new();
    }
    let row = |(v, id): (&&Verification, &String)| {
        let notices = scene::notices(v).map_or_else(
            || "\u{2013}".to_owned(),
            |(shift, by)| format!("<span title=\"{}\">{}</span>", Text(by), Text(&shift)),
        );
        format!(
            "<tr class=\"{}\"><th scope=\"row\"><a href=\"#{id}\">{}</a></th><td class=\"verdict\">{}</td>\
             <td class=\"gist\">{}</td><td class=\"n notices\">{notices}</td><td class=\"n time\">{}</td></tr>\n",
            v.verdict.word(),
            Text(&v.name),
            badge(v.verdict),
            Text(&scene::gist(v)),
            Text(&seconds(v.seconds))
        )
    };
    let rows: String = scenes.iter().zip(ids).map(row).collect();
    format!(
        "<div class=\"overview\"><table>\n<thead><tr><th scope=\"col\">Scene</th><th scope=\"col\">Verdict</th>\
         <th scope=\"col\">Worst finding</th><th scope=\"col\" class=\"n\">Notices</th>\
         <th scope=\"col\" class=\"n\">Time</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
    )
}

/// How to read the page, and where it came from.
fn footer(about: &About) -> String {
    let origin = page::origin(&about.facts, &about.command);
    format!(
        "<footer>\n<h2>How to read this page</h2>\n\
         <p>Each scene is rendered with seeds that its reference did not use, and sums over its pixels are compared with \
         what they are over many independent runs of the reference. <b>z</b> is the difference in standard errors, <b>p</b> the \
         probability of as large a difference where nothing is wrong, for that statistic alone; <b>shared</b> is that \
         of the least probable of all statistics like it (wholes, or tiles and waves), and decides. If nothing is wrong \
         anywhere, that happens to one scene or more with a probability of {}.</p>\n\
         <p><b>Notices</b> is the smallest shift of all light that would be refused with a probability of 99\u{a0}%. Pictures of \
         differences help the eye; they decide nothing.</p>\n{origin}</footer>\n",
        Text(&probability(about.significance))
    )
}

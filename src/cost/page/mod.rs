//! The page about what a scene costs, for whoever wants to know before the next render.
//!
//! In: a [`CostReport`], [`Pictures`], prices of numerical accuracy. Out: one HTML document that stands alone, and is
//! read without its script too (sliders are then pictures side by side). What comes first answers: what does 1 %
//! cost, what does each effect cost, what would I give up. All seconds on it are processor seconds over the number
//! of threads: what a clock on the wall shows where nothing else runs.

mod made_of;
mod numerics;
mod plots;
mod prices;
mod shots;
mod words;

use super::pictures::Pictures;
use super::report::{CostReport, Measured};
use super::switches::Kind;
use crate::check;
use crate::page::{self, document, picture, text};
use text::Text;
use words::Words;

/// What a page says beside what was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// The command that made the page.
    pub command: String,
    /// Further facts, each with its name, such as the version or the processor.
    pub facts: Vec<(String, String)>,
}

/// The page, a whole HTML document in UTF-8; `prices` are those of [`check::prices`], and may be none.
#[must_use]
pub fn page(report: &CostReport, pictures: &Pictures, prices: &[check::Price], about: &About) -> String {
    let words = Words::new(report);
    let title = format!("What accuracy costs: {}", report.scene);
    let body = format!(
        "{}<main>\n{}{}{}{}{}{}{}{}</main>\n{}",
        header(report, pictures, &words),
        prices::answers(report, &words),
        section("switches", "Every switch", &prices::table(report, &words)),
        section("plots", "Error over time", &plots::all(report, &words)),
        section("consists", "What the error consists of", &prices::consists(report)),
        section("pictures", "Seen side by side", &shots::all(report, pictures, &words)),
        section("parts", "What the picture is made of", &made_of::layers(report, pictures)),
        section("beforehand", "Said beforehand, and what came", &prices::beforehand(report)),
        section("numerics", "What numerical accuracy costs", &numerics::prices(report, prices)),
        footer(report, about, &words),
    );
    let style = format!("{}{}", include_str!("style.css"), shots::style(pictures));
    document(&title, &style, &body, include_str!("slider.js"))
}

/// What comes first on the page, as text of a few lines.
#[must_use]
pub fn summary(report: &CostReport) -> String {
    let words = Words::new(report);
    let sentences = std::iter::once(words.headline()).chain(words.lead());
    sentences.map(|s| words::plain(&s)).collect::<Vec<_>>().join("\n")
}

/// A part of the page; none where there is nothing in it.
fn section(id: &str, name: &str, body: &str) -> String {
    if body.is_empty() {
        return String::new();
    }
    format!("<section id=\"{id}\">\n<h2>{}</h2>\n{body}</section>\n", Text(name))
}

/// The answer, and the picture that it is about.
fn header(report: &CostReport, pictures: &Pictures, words: &Words<'_>) -> String {
    let size = pictures.size.map(|v| v as usize);
    let whole = if pictures.whole.is_empty() {
        String::new()
    } else {
        let alt = format!("{}, {} samples a pixel", report.scene, pictures.spp);
        let img = picture::img(size, pictures.whole.clone(), pictures.tone, &alt);
        format!("<figure class=\"whole\">{img}</figure>\n")
    };
    format!(
        "<header class=\"top\">\n<div>\n<p class=\"title\">What accuracy costs: {}</p>\n<h1>{}</h1>\n{}</div>\n{whole}</header>\n",
        Text(&report.scene),
        words::html(&words.headline()),
        words
            .lead()
            .iter()
            .map(|s| format!("<p class=\"lead\">{}</p>\n", words::html(s)))
            .collect::<String>(),
    )
}

/// The ways of one kind, with their place in the report.
fn of_kind(report: &CostReport, kind: Kind) -> impl Iterator<Item = (usize, &Measured)> {
    report.switches.iter().enumerate().filter(move |(_, m)| m.kind == kind)
}

/// How it was measured, and where the page came from.
fn footer(report: &CostReport, about: &About, words: &Words<'_>) -> String {
    let origin = page::origin(&about.facts, &about.command);
    format!("<footer>\n<h2>How this was measured</h2>\n{}{origin}</footer>\n", words.method(report))
}

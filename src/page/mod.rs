//! Parts of pages in HTML that stand alone.
//!
//! In: numbers, pictures, words. Out: one document, and what it consists of: plots, pictures, text. The invariants:
//! a page needs nothing beside itself (no picture, font or style from elsewhere), and foreign text in it is
//! escaped ([`text::Text`]). `style.css` is what all pages look like: a screen of any width, light and dark, paper.

mod base64;
pub(crate) mod picture;
pub(crate) mod plot;
pub(crate) mod text;

use text::Text;

/// A whole document in UTF-8: its title, what its style adds to that of all pages, its body, and a script that it can
/// be read without; empty where there is none.
pub(crate) fn document(title: &str, style: &str, body: &str, script: &str) -> String {
    let script = if script.is_empty() { String::new() } else { format!("<script>\n{script}</script>\n") };
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{}</title>\n<style>\n{}{style}</style>\n</head>\n<body>\n{body}{script}</body>\n</html>\n",
        Text(title),
        include_str!("style.css"),
    )
}

/// Where a page came from: facts, each with its name, and the command that made it; what there is none of is left out.
pub(crate) fn origin(facts: &[(String, String)], command: &str) -> String {
    let row = |(name, what): &(String, String)| {
        format!("<div><dt>{}</dt><dd>{}</dd></div>\n", Text(name), Text(what))
    };
    let facts: String = facts.iter().map(row).collect();
    let facts = if facts.is_empty() { facts } else { format!("<dl class=\"facts\">\n{facts}</dl>\n") };
    let command = if command.is_empty() {
        String::new()
    } else {
        format!("<pre><code>{}</code></pre>\n", Text(command))
    };
    facts + &command
}

/// Fails where an element does not end where it should, or an id occurs twice.
#[cfg(test)]
pub(crate) fn is_well_formed(html: &str) {
    use std::collections::BTreeSet;
    const EMPTY: [&str; 4] = ["meta", "img", "br", "input"];
    let mut open: Vec<&str> = Vec::new();
    let mut ids = BTreeSet::new();
    for tag in html.split('<').skip(2).map(|s| s.split_once('>').expect("a tag ends").0) {
        let word = tag.split([' ', '\n', '/']).find(|w| !w.is_empty()).expect("a tag has a name");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(word), "</{word}> ends something else");
        } else if !tag.ends_with('/') && !EMPTY.contains(&word) {
            open.push(word);
        }
        if let Some((_, rest)) = tag.split_once(" id=\"") {
            let id = rest.split('"').next().expect("an id ends");
            assert!(ids.insert(id), "id {id} occurs twice");
        }
    }
    assert!(open.is_empty(), "{open:?} are not closed");
}

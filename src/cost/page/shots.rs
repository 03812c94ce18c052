//! Pictures side by side, with a slider between them.
//!
//! The full method's picture is beside every other one; so it is in the page once, as a background of the style
//! sheet.

use super::words::{Words, capital};
use crate::cost::pictures::{EqualError, Pictures};
use crate::cost::report::CostReport;
use crate::cost::switches::Kind;
use crate::page::picture::{data, img};
use crate::page::text::{Text, count, percent};

/// The rule that holds the full method's picture.
pub(super) fn style(pictures: &Pictures) -> String {
    let [w, h] = pictures.size;
    let Some(full) = pictures.switches.first() else { return String::new() };
    match data([w as usize, h as usize], full.equal_time.clone(), pictures.tone) {
        Ok(data) => format!(".shot.full {{ aspect-ratio: {w} / {h}; background-image: url({data}); }}\n"),
        Err(_) => String::new(),
    }
}

/// All pairs, folded but for the first of each kind.
pub(super) fn all(report: &CostReport, pictures: &Pictures, words: &Words<'_>) -> String {
    let Some(full) = pictures.switches.first() else { return String::new() };
    let size = pictures.size.map(|v| v as usize);
    let error = report.switches[0]
        .points
        .last()
        .map_or(0.0, |p| p.error.value * (f64::from(p.spp) / f64::from(full.spp.max(1))).sqrt());
    let first = |kind| report.switches.iter().position(|m| m.kind == kind);
    let mut html = String::new();
    let pairs = report.switches.iter().zip(&pictures.switches).enumerate().skip(1);
    for (i, (way, shots)) in pairs {
        let left = format!("full: {}", count(full.spp as usize, "sample"));
        let alt = |how: &str| format!("{}: {} at {how}", report.scene, way.name);
        let time = pair(
            &format!("the same time, {}", words.time(full.seconds)),
            &left,
            &format!("{}: {}", way.name, count(shots.spp as usize, "sample")),
            &img(size, shots.equal_time.clone(), pictures.tone, &alt("equal time")),
        );
        let same = format!("the same error, about {}", percent(error));
        let equal = match &shots.equal_error {
            EqualError::Own => String::new(),
            EqualError::Never => {
                missing(&same, &format!("It has none: its bias alone is {}.", percent(way.floor.value)))
            }
            EqualError::TooLong(s) => missing(
                &same,
                &format!("It would take {} instead of {}.", words.time(*s), words.time(full.seconds)),
            ),
            EqualError::Picture(rgb, spp, s) => pair(
                &same,
                &format!("full: {}", words.time(full.seconds)),
                &format!("{}: {} ({})", way.name, words.time(*s), count(*spp as usize, "sample")),
                &img(size, rgb.clone(), pictures.tone, &alt("equal error")),
            ),
        };
        let open =
            if Some(i) == first(Kind::Algorithm) || Some(i) == first(Kind::Shortcut) { " open" } else { "" };
        html += &format!(
            "<details class=\"pairs\"{open}>\n<summary><b>{}</b> <span class=\"what\">{}</span></summary>\n\
             <div class=\"two\">\n{time}{equal}</div>\n</details>\n",
            Text(&capital(&way.name)),
            Text(&way.what)
        );
    }
    html
}

/// Two pictures and the slider; the full method's is on the left.
fn pair(how: &str, left: &str, right: &str, other: &str) -> String {
    format!(
        "<figure><figcaption><b>At {}</b></figcaption><div class=\"compare\"><div class=\"shot full\" role=\"img\" aria-label=\"{}\">\
         </div><div class=\"shot other\">{other}</div><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" step=\"0.5\" \
         aria-label=\"how much of the left picture is shown\"></div><p class=\"sides\"><span>{}</span><span>{}</span></p></figure>\n",
        Text(how),
        Text(left),
        Text(left),
        Text(right)
    )
}

fn missing(how: &str, why: &str) -> String {
    format!(
        "<figure><figcaption><b>At {}</b></figcaption><p class=\"missing\">{}</p></figure>\n",
        Text(how),
        Text(why)
    )
}

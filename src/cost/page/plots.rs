//! Plots of the error over time, both logarithmic, and of efficiencies.

use super::of_kind;
use super::words::{Words, capital, percent_of_target, time};
use crate::cost::report::{CostReport, MAIN, Measured, Until};
use crate::cost::switches::Kind;
use crate::page::plot::{Area, Plot, log_ticks};
use crate::page::text::{Text, percent, signed};

/// Points of a curve.
const STEPS: usize = 48;

/// All of them: the full method with other ways to the same picture, then each shortcut beside the full method.
pub(super) fn all(report: &CostReport, words: &Words<'_>) -> String {
    let Some(full) = words.full().filter(|f| f.fit.is_some()) else { return String::new() };
    let mut figures = figure(&[], full, words);
    for (_, other) in of_kind(report, Kind::Algorithm).chain(of_kind(report, Kind::Shortcut)) {
        figures += &figure(&[full], other, words);
    }
    format!(
        "<p class=\"note\"><span class=\"key found\">this way</span> <span class=\"key expected\">the full method</span> \
         <span class=\"key guide\">slope \u{2212}\u{bd}: four times the time, half the error</span> \
         <span class=\"key floor\">bias, which no time takes away</span></p>\n<div class=\"plots three\">\n{figures}</div>\n"
    )
}

/// A way as it is plotted: what it is at each time.
struct Curve<'a> {
    way: &'a Measured,
    /// Common logarithms of wall-clock seconds and errors of its points.
    points: Vec<[f64; 2]>,
}

impl<'a> Curve<'a> {
    fn new(way: &'a Measured, words: &Words<'_>) -> Self {
        let at = |p: &crate::cost::report::Point| {
            let (x, y) = (words.wall(f64::from(p.spp) * way.seconds_per_pass), p.error.value);
            [x, y].map(libm::log10)
        };
        let points = way.points.iter().map(at).filter(|[x, y]| x.is_finite() && y.is_finite()).collect();
        Self { way, points }
    }

    /// Common logarithm of the error at the common logarithm of a time.
    fn error(&self, x: f64, words: &Words<'_>) -> Option<f64> {
        let fit = self.way.fit.as_ref()?;
        let samples = libm::pow(10.0, x) / words.wall(self.way.seconds_per_pass).max(1e-12);
        let (noise, bias) = (fit.error(samples)?, self.bias());
        Some(0.5 * libm::log10(noise * noise + bias * bias)).filter(|y| y.is_finite())
    }

    /// The bias that is proved; that of another way to the same picture is in the line.
    fn bias(&self) -> f64 {
        let proved = self.way.kind == Kind::Shortcut && self.way.floor.low > 0.0;
        if proved { self.way.floor.value } else { 0.0 }
    }

    fn line(&self, [from, to]: [f64; 2], words: &Words<'_>) -> Vec<[f64; 2]> {
        let x = |k: usize| from + (to - from) * k as f64 / STEPS as f64;
        (0..=STEPS).filter_map(|k| Some([x(k), self.error(x(k), words)?])).collect()
    }
}

/// A plot of one way, beside others.
fn figure(beside: &[&Measured], way: &Measured, words: &Words<'_>) -> String {
    let own = Curve::new(way, words);
    let others: Vec<Curve<'_>> = beside.iter().map(|m| Curve::new(m, words)).collect();
    let all = || std::iter::once(&own).chain(&others).flat_map(|c| c.points.iter().copied());
    if all().count() < 2 {
        return String::new();
    }
    let crossing = match way.until {
        Until::Seconds { seconds, error } => Some([words.wall(seconds.value), error].map(libm::log10)),
        _ => None,
    };
    // The price that the page is about, where it is not too far away.
    let price = way.price(MAIN).filter(|_| way.kind != Kind::Shortcut);
    let price = price.map(|p| [words.wall(p.seconds.value), MAIN].map(libm::log10));
    let ends = |i: usize| {
        let marks = || crossing.iter().chain(price.iter()).map(move |p| p[i]);
        let low = all().map(|p| p[i]).chain(marks()).fold(f64::INFINITY, f64::min);
        let high = all().map(|p| p[i]).chain(marks()).fold(f64::NEG_INFINITY, f64::max);
        [low, high]
    };
    let ([left, right], [low, high]) = (ends(0), ends(1));
    let margin = 0.04 * (right - left).max(0.5);
    let mut area = Area { x: [left - margin, right + margin], y: [low - 0.12, high + 0.12] };
    if own.bias() > 0.0 {
        area.y[0] = area.y[0].min(libm::log10(way.floor.low.max(1e-6)) - 0.05);
    }
    let mut marks = floor(&own, &area);
    let first = all().fold([f64::INFINITY, f64::NEG_INFINITY], |a, p| if p[0] < a[0] { p } else { a });
    // Beside the line, which may have the same slope.
    let start = [first[0], first[1] - 0.06 * (area.y[1] - area.y[0])];
    let run = (area.x[1] - start[0]).min(2.0 * (start[1] - area.y[0])).max(0.0);
    marks += &area.line("guide", [start, [start[0] + run, start[1] - 0.5 * run]]);
    for other in &others {
        marks += &curve(other, &area, "expected", words);
    }
    let class = if way.kind == Kind::Full { "expected" } else { "found" };
    marks += &curve(&own, &area, class, words);
    marks += &points(&own, &area, class, words);
    if let Some([x, y]) = crossing {
        let says = format!("until {} it is the better choice", time(libm::pow(10.0, x)));
        marks += &area.dot("ring", [x, y], 6.0, Some(&says));
    }
    if let (Some(at), Some(p)) = (price, way.price(MAIN)) {
        let says = format!("{} in {}", percent_of_target(MAIN), words.time(p.seconds.value));
        marks += &area.dot("ring", at, 5.0, Some(&says));
        marks += &area.label("price", at, [-8.0, -8.0], "end", &says);
    }
    let tick = |t: f64| (t, short(libm::pow(10.0, t)));
    let plot = Plot {
        title: &title(way),
        area,
        x_ticks: ticks(area.x).into_iter().map(tick).collect(),
        y_ticks: log_ticks(area.y).into_iter().map(|t| (t, percent(libm::pow(10.0, t)))).collect(),
        x_label: "time",
        y_label: "error E",
        marks,
    };
    format!(
        "<figure>{}<figcaption><b>{}</b> {}</figcaption></figure>\n",
        plot.to_svg(),
        Text(&capital(&way.name)),
        Text(&caption(way))
    )
}

/// For those who cannot see the plot.
fn title(way: &Measured) -> String {
    let last = way
        .points
        .last()
        .map_or_else(String::new, |p| format!("; after {} samples it is {}", p.spp, percent(p.error.value)));
    format!("{}: error over time{last}", way.name)
}

fn caption(way: &Measured) -> String {
    let slope = way.fit.as_ref().map_or_else(String::new, |f| {
        let of = if way.kind == Kind::Shortcut { "noise falls" } else { "falls" };
        format!("{of} with power {} \u{b1} {:.2} of time", signed(-f.slope.value, 2), f.slope.within())
    });
    let floor = match way.kind == Kind::Shortcut && way.floor.low > 0.0 {
        true => format!(", to a bias of {}", percent(way.floor.value)),
        false => String::new(),
    };
    slope + &floor
}

/// The line of a way: as far as it was measured, and beyond that dashed.
fn curve(curve: &Curve<'_>, area: &Area, class: &str, words: &Words<'_>) -> String {
    let (Some(first), Some(last)) = (curve.points.first(), curve.points.last()) else { return String::new() };
    let mut svg = area.line(class, curve.line([first[0], last[0]], words));
    let within = |p: &[f64; 2]| p[1] >= area.y[0] && p[1] <= area.y[1];
    if area.x[1] > last[0] {
        let beyond: Vec<[f64; 2]> =
            curve.line([last[0], area.x[1]], words).into_iter().filter(within).collect();
        svg += &area.line(&format!("{class} beyond"), beyond);
    }
    svg
}

/// Points with their intervals.
fn points(curve: &Curve<'_>, area: &Area, class: &str, words: &Words<'_>) -> String {
    let mut svg = String::new();
    for p in &curve.way.points {
        let x = libm::log10(words.wall(f64::from(p.spp) * curve.way.seconds_per_pass));
        let y = libm::log10(p.error.value);
        if !x.is_finite() || !y.is_finite() {
            continue;
        }
        let clamp = |v: f64| if v.is_nan() { y } else { v.clamp(area.y[0], area.y[1]) };
        let [low, high] = [p.error.low, p.error.high].map(|v| clamp(libm::log10(v)));
        svg += &area.line(&format!("whisker {class}"), [[x, low], [x, high]]);
        let says = format!(
            "{} samples: E = {} ({} to {}), noise {}",
            p.spp,
            percent(p.error.value),
            percent(p.error.low),
            percent(p.error.high),
            percent(p.noise)
        );
        svg += &area.dot(&format!("dot {class}"), [x, y], 3.5, Some(&says));
    }
    svg
}

/// The bias and its interval, across the plot.
fn floor(curve: &Curve<'_>, area: &Area) -> String {
    if curve.bias() <= 0.0 {
        return String::new();
    }
    let floor = curve.way.floor;
    let y = |v: f64| libm::log10(v).clamp(area.y[0], area.y[1]);
    let [left, right] = area.x;
    let (low, high) = (y(floor.low), y(floor.high));
    area.polygon("floor-band", [[left, low], [right, low], [right, high], [left, high]])
        + &area.line("floor", [[left, y(floor.value)], [right, y(floor.value)]])
}

/// Times that people name, seconds: those that stand for a power of ten, and what is between them.
const NAMED: [f64; 13] =
    [1e-3, 1e-2, 0.1, 1.0, 10.0, 60.0, 600.0, 3600.0, 36_000.0, 86_400.0, 864_000.0, 8.64e6, 8.64e7];
const BETWEEN: [f64; 16] = [
    0.002, 0.005, 0.02, 0.05, 0.2, 0.5, 2.0, 5.0, 30.0, 120.0, 300.0, 1800.0, 7200.0, 18_000.0, 172_800.0,
    432_000.0,
];

/// Where a time axis has numbers.
fn ticks([from, to]: [f64; 2]) -> Vec<f64> {
    const MOST: usize = 6;
    let within = |t: &f64| (from..=to).contains(&libm::log10(*t));
    let mut ticks: Vec<f64> = NAMED.into_iter().filter(within).collect();
    if ticks.len() < 3 {
        ticks.extend(BETWEEN.into_iter().filter(within));
        ticks.sort_by(f64::total_cmp);
    }
    let every = ticks.len().div_ceil(MOST).max(1);
    ticks.into_iter().step_by(every).map(libm::log10).collect()
}

/// One of these times in as few letters as possible.
fn short(s: f64) -> String {
    let (unit, name) = match s {
        s if s < 0.0995 => (1e-3, "ms"),
        s if s < 59.5 => (1.0, "s"),
        s if s < 3599.0 => (60.0, "min"),
        s if s < 86_399.0 => (3600.0, "h"),
        _ => (86_400.0, "d"),
    };
    let number = (s / unit * 10.0).round() / 10.0;
    format!("{number}\u{a0}{name}")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever an axis spans, two to six times that people name.
    #[test]
    fn times_on_an_axis() {
        let said = |from: f64, to: f64| {
            let all = ticks([from, to].map(libm::log10));
            all.into_iter()
                .map(|t| short(libm::pow(10.0, t)).replace('\u{a0}', " "))
                .collect::<Vec<_>>()
                .join(", ")
        };
        assert_eq!(said(0.5, 200.0), "1 s, 10 s, 1 min");
        assert_eq!(said(0.9, 30.0), "1 s, 2 s, 5 s, 10 s, 30 s");
        assert_eq!(said(0.04, 1e6), "0.1 s, 10 s, 10 min, 10 h, 10 d");
    }
}

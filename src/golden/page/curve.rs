//! Plot of the error over samples: the render under test within the band of the reference's runs.

use super::plot::{Area, Plot, log_ticks};
use super::text::percent;
use crate::golden::CurvePoint;

/// `None` where fewer than two points have an error that can be drawn.
pub(super) fn plot(curve: &[CurvePoint]) -> Option<String> {
    let drawable = |v: f64| v.is_finite() && v > 0.0;
    let points: Vec<CurvePoint> = curve
        .iter()
        .filter(|c| c.spp > 0 && [c.error, c.expected, c.spread].into_iter().all(drawable))
        .copied()
        .collect();
    let ([first, ..], [.., last]) = (&points[..], &points[..]) else { return None };
    if first.spp >= last.spp {
        return None;
    }
    let log = libm::log10;
    let x = |c: &CurvePoint| log(f64::from(c.spp));
    let band = |c: &CurvePoint| {
        let (y, by) = (log(c.expected), log(c.spread).abs());
        [y - by, y + by]
    };
    let ys = || points.iter().flat_map(|c| [log(c.error), band(c)[0], band(c)[1]]);
    let (low, high) = (ys().fold(f64::INFINITY, f64::min), ys().fold(f64::NEG_INFINITY, f64::max));
    let (left, right) = (x(first), x(last));
    let margin = 0.04 * (right - left);
    let area = Area { x: [left - margin, right + margin], y: [low - 0.06, high + 0.06] };

    let lower = points.iter().map(|c| [x(c), band(c)[0]]);
    let upper = points.iter().rev().map(|c| [x(c), band(c)[1]]);
    let mut marks = area.polygon("band", lower.chain(upper));
    // The guide starts where the expectation does and ends at the plot's lower edge.
    let start = log(first.expected);
    let run = (right - left).min(2.0 * (start - area.y[0]));
    marks += &area.line("guide", [[left, start], [left + run, start - 0.5 * run]]);
    marks += &area.line("expected", points.iter().map(|c| [x(c), log(c.expected)]));
    marks += &area.line("found", points.iter().map(|c| [x(c), log(c.error)]));
    for c in &points {
        let says = format!("{} spp: {}, expected {}", c.spp, percent(c.error), percent(c.expected));
        marks += &area.dot("dot found", [x(c), log(c.error)], 4.0, Some(&says));
    }
    let title = format!(
        "Relative error over samples a pixel; at {} samples it is {}, expected {}",
        last.spp,
        percent(last.error),
        percent(last.expected)
    );
    let number = |t: f64| (t, percent(libm::pow(10.0, t)));
    let plot = Plot {
        title: &title,
        area,
        x_ticks: points.iter().map(|c| (x(c), c.spp.to_string())).collect(),
        y_ticks: log_ticks(area.y).into_iter().map(number).collect(),
        x_label: "samples a pixel",
        y_label: "relative error",
        marks,
    };
    Some(plot.to_svg())
}

#[cfg(test)]
mod tests {
    use super::plot;
    use crate::golden::CurvePoint;

    fn point(spp: u32, error: f64) -> CurvePoint {
        CurvePoint { spp, error, expected: 0.1 / f64::from(spp).sqrt(), spread: 1.1 }
    }

    /// A curve is drawn from two points on, and what has no logarithm is left out.
    #[test]
    fn draws_what_can_be_drawn() {
        assert_eq!(plot(&[]), None);
        assert_eq!(plot(&[point(4, 0.05), point(8, f64::NAN), point(16, 0.0)]), None);
        let svg = plot(&[point(4, 0.05), point(8, f64::INFINITY), point(16, 0.025)]).unwrap();
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}

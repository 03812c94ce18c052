//! Axes, ticks and frame of a plot, as SVG inside a page.
//!
//! In: what the axes span, and marks in plot units. Out: an `svg` element with a title, coloured by the page's
//! style sheet, so that it follows light, dark and print.

use super::text::Text;

/// Size of a plot, SVG units.
const WIDTH: f64 = 400.0;
const HEIGHT: f64 = 290.0;
/// Edges of the area between the axes.
const LEFT: f64 = 50.0;
const RIGHT: f64 = 388.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 246.0;

/// What a plot spans: x and y of its corners, in the numbers that are plotted (logarithms, where an axis is
/// logarithmic).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Area {
    /// From, to.
    pub(crate) x: [f64; 2],
    /// From, to.
    pub(crate) y: [f64; 2],
}

impl Area {
    /// SVG units of a point.
    pub(crate) fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let share = |v: f64, [from, to]: [f64; 2]| (v - from) / (to - from).max(1e-12);
        [LEFT + share(x, self.x) * (RIGHT - LEFT), BOTTOM - share(y, self.y) * (BOTTOM - TOP)]
    }

    /// A line through points; `class` names its style.
    pub(crate) fn line(&self, class: &str, points: impl IntoIterator<Item = [f64; 2]>) -> String {
        format!("<polyline class=\"{class}\" points=\"{}\"/>", self.points(points))
    }

    /// An area within points.
    pub(crate) fn polygon(&self, class: &str, points: impl IntoIterator<Item = [f64; 2]>) -> String {
        format!("<polygon class=\"{class}\" points=\"{}\"/>", self.points(points))
    }

    /// A dot, with what it says where a pointer rests on it.
    pub(crate) fn dot(&self, class: &str, [x, y]: [f64; 2], radius: f64, says: Option<&str>) -> String {
        let [cx, cy] = self.at(x, y);
        let open = format!("<circle class=\"{class}\" cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"{radius}\"");
        match says {
            Some(says) => format!("{open}><title>{}</title></circle>", Text(says)),
            None => open + "/>",
        }
    }

    /// Text beside a point, moved by SVG units; `anchor` is `start`, `middle` or `end`.
    pub(crate) fn label(
        &self,
        class: &str,
        [x, y]: [f64; 2],
        by: [f64; 2],
        anchor: &str,
        says: &str,
    ) -> String {
        let [x, y] = self.at(x, y);
        let (x, y) = (x + by[0], y + by[1]);
        format!(
            "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>",
            Text(says)
        )
    }

    fn points(&self, points: impl IntoIterator<Item = [f64; 2]>) -> String {
        let text = |[x, y]: [f64; 2]| {
            let [x, y] = self.at(x, y);
            format!("{x:.1},{y:.1}")
        };
        points.into_iter().map(text).collect::<Vec<_>>().join(" ")
    }
}

/// A whole plot.
pub(crate) struct Plot<'a> {
    /// For those who cannot see it: what it shows and what comes out.
    pub(crate) title: &'a str,
    /// What it spans.
    pub(crate) area: Area,
    /// Where an axis has a number, and the number.
    pub(crate) x_ticks: Vec<(f64, String)>,
    /// The same.
    pub(crate) y_ticks: Vec<(f64, String)>,
    /// What is along it.
    pub(crate) x_label: &'a str,
    /// The same, written above the axis's upper end, where it is read without turning one's head.
    pub(crate) y_label: &'a str,
    /// What stands between the axes, as SVG.
    pub(crate) marks: String,
}

impl Plot<'_> {
    /// The `svg` element.
    pub(crate) fn to_svg(&self) -> String {
        let mut svg = format!(
            "<svg class=\"plot\" role=\"img\" viewBox=\"0 0 {WIDTH} {HEIGHT}\"><title>{}</title>\n",
            Text(self.title)
        );
        let mut add = |text: String| {
            svg += &text;
            svg.push('\n');
        };
        for (x, number) in &self.x_ticks {
            let [x, _] = self.area.at(*x, 0.0);
            add(format!("<path class=\"grid\" d=\"M{x:.1} {TOP}V{BOTTOM}\"/>"));
            let y = BOTTOM + 18.0;
            add(format!("<text x=\"{x:.1}\" y=\"{y}\" text-anchor=\"middle\">{}</text>", Text(number)));
        }
        for (y, number) in &self.y_ticks {
            let [_, y] = self.area.at(0.0, *y);
            add(format!("<path class=\"grid\" d=\"M{LEFT} {y:.1}H{RIGHT}\"/>"));
            let (x, y) = (LEFT - 7.0, y + 4.0);
            add(format!("<text x=\"{x}\" y=\"{y:.1}\" text-anchor=\"end\">{}</text>", Text(number)));
        }
        add(format!("<path class=\"axis\" d=\"M{LEFT} {TOP}V{BOTTOM}H{RIGHT}\"/>"));
        add(self.marks.clone());
        let (x, y) = ((LEFT + RIGHT) / 2.0, HEIGHT - 8.0);
        add(format!(
            "<text class=\"name\" x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{}</text>",
            Text(self.x_label)
        ));
        add(format!("<text class=\"name\" x=\"2\" y=\"{}\">{}</text>", TOP - 14.0, Text(self.y_label)));
        svg + "</svg>\n"
    }
}

/// Where a logarithmic axis from `from` to `to` (common logarithms) has numbers: at powers of ten, or at as
/// many multiples as are needed for three.
pub(crate) fn log_ticks([from, to]: [f64; 2]) -> Vec<f64> {
    const STEPS: [&[f64]; 3] = [&[1.0], &[1.0, 2.0, 5.0], &[1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0]];
    let (first, last) = (from.floor() as i32, to.ceil() as i32);
    let ticks = |steps: &[f64]| -> Vec<f64> {
        (first..=last)
            .flat_map(|decade| steps.iter().map(move |s| f64::from(decade) + libm::log10(*s)))
            .filter(|t| (from - 1e-9..=to + 1e-9).contains(t))
            .collect()
    };
    let [coarse, middle, fine] = STEPS.map(ticks);
    [coarse, middle].into_iter().find(|t| t.len() >= 3).unwrap_or(fine)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up is up, and corners lie in the corners.
    #[test]
    fn corners() {
        let area = Area { x: [1.0, 3.0], y: [-2.0, 2.0] };
        assert_eq!(area.at(1.0, -2.0), [LEFT, BOTTOM]);
        assert_eq!(area.at(3.0, 2.0), [RIGHT, TOP]);
        assert_eq!(area.at(2.0, 0.0), [(LEFT + RIGHT) / 2.0, (TOP + BOTTOM) / 2.0]);
    }

    /// A few numbers whatever the span.
    #[test]
    fn ticks_are_few() {
        assert_eq!(log_ticks([0.0, 1.0]).len(), 4, "1 2 5 10");
        assert_eq!(log_ticks([-3.0, 3.0]).len(), 7);
        assert_eq!(log_ticks([0.31, 0.68]).len(), 3, "2.5, 3 and 4 between 2.05 and 4.8");
    }
}

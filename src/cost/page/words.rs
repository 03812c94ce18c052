//! The sentences of the page.

use super::of_kind;
use crate::cost::fit::Interval;
use crate::cost::report::{CostReport, MAIN, Measured, Price, Until};
use crate::cost::switches::Kind;
use crate::page::text::{Text, change, count, percent, seconds};

/// Whatever needs the report as a whole to be said.
pub(super) struct Words<'a> {
    report: &'a CostReport,
    threads: f64,
}

impl<'a> Words<'a> {
    pub(super) fn new(report: &'a CostReport) -> Self {
        Self { report, threads: report.threads.max(1) as f64 }
    }

    /// Wall-clock seconds of processor seconds.
    pub(super) fn wall(&self, processor: f64) -> f64 {
        processor / self.threads
    }

    pub(super) fn full(&self) -> Option<&'a Measured> {
        self.report.switches.first()
    }

    /// The price of the full picture that the first sentence is about.
    pub(super) fn main(&self) -> Option<&'a Price> {
        self.full()?.price(MAIN)
    }

    /// A time for people.
    pub(super) fn time(&self, processor: f64) -> String {
        seconds(self.wall(processor))
    }

    /// `3 s to 5 s`, where that is known.
    pub(super) fn range(&self, processor: Interval) -> String {
        if processor.high.is_finite() {
            format!("{} to {}", self.time(processor.low), self.time(processor.high))
        } else {
            "not known better".into()
        }
    }

    /// `1 % costs 19 s at 800×800`, as HTML.
    pub(super) fn headline(&self) -> String {
        let [w, h] = self.report.size;
        match self.main() {
            Some(price) => format!(
                "{} costs <b>{}</b> at {w}\u{d7}{h}",
                percent_of_target(MAIN),
                Text(&self.time(price.seconds.value))
            ),
            None => "too few samples to tell a price".into(),
        }
    }

    /// What the headline rests on.
    pub(super) fn lead(&self) -> String {
        let (Some(full), Some(price)) = (self.full(), self.main()) else { return String::new() };
        let mut html = format!(
            "<p class=\"lead\">{} a pixel, on {}; {} with 95\u{a0}% confidence. {}</p>\n",
            count_of_samples(price.samples.value),
            count(self.report.threads, "core"),
            Text(&self.range(price.seconds)),
            self.continued(full, price),
        );
        for sentence in self.others() {
            html += &format!("<p class=\"lead\">{sentence}</p>\n");
        }
        html
    }

    /// Whether the price is measured or continued.
    fn continued(&self, full: &Measured, price: &Price) -> String {
        let Some(last) = full.points.last() else { return String::new() };
        if price.measured {
            return "Measured, not extrapolated.".into();
        }
        format!(
            "Measured down to {}; from there the line is continued, {} times as far in time.",
            Text(&percent(last.error.value)),
            round(price.samples.value / f64::from(last.spp)),
        )
    }

    /// What another estimator, the dearest effect and the best shortcut come to.
    fn others(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        for (_, other) in of_kind(self.report, Kind::Algorithm) {
            let Some(factor) = other.efficiency else { continue };
            let (factor, word) = if factor >= 1.0 { (factor, "cheaper") } else { (1.0 / factor, "dearer") };
            sentences.push(format!("With <b>{}</b> it is {} times {word}.", Text(&other.name), round(factor)));
        }
        if let Some((share, dearest)) = self.shares().into_iter().find(|(share, m)| *share >= 0.05 && m.differs()) {
            let given = dearest.price(MAIN).map_or_else(String::new, |p| self.time(p.seconds.value));
            sentences.push(format!(
                "<b>{}</b> costs {} of that: without, the noise of {} takes {}, and the picture {}.",
                Text(&capital(&dearest.gives_up)),
                Text(&percent(share)),
                percent_of_target(MAIN),
                Text(&given),
                Text(&becomes(dearest)),
            ));
        }
        sentences
    }

    /// Shortcuts with the share of the price that they save, the largest first.
    pub(super) fn shares(&self) -> Vec<(f64, &'a Measured)> {
        let full = self.main().map(|p| p.seconds.value);
        let share = |m: &'a Measured| Some((1.0 - m.price(MAIN)?.seconds.value / full?, m));
        let mut all: Vec<_> = of_kind(self.report, Kind::Shortcut).filter_map(|(_, m)| share(m)).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        all
    }

    /// Until when a shortcut is the better choice, as HTML.
    pub(super) fn until(&self, until: &Until) -> String {
        match until {
            Until::NoShortcut => "\u{2013}".into(),
            Until::Never => "never".into(),
            Until::NotSeen => "no bias seen".into(),
            Until::Seconds { seconds, error } => format!(
                "<span title=\"{}\">{}</span> <span class=\"muted\">({})</span>",
                Text(&self.range(*seconds)),
                Text(&self.time(seconds.value)),
                Text(&percent(*error))
            ),
        }
    }

    /// How it was measured.
    pub(super) fn method(&self, report: &CostReport) -> String {
        let [w, h] = report.measured;
        let best = report.switches.iter().filter_map(|m| m.points.last()).map(|p| p.spp);
        format!(
            "<p>Each way is rendered {} times at {w}\u{d7}{h}, with other seeds, up to {} samples a pixel, and compared with \
             the mean of a long render ({} samples, {}), whose own error of {} is subtracted. <b>E</b> is the root of \
             the mean over pixels of (I\u{a0}\u{2212}\u{a0}R)\u{b2} / (R\u{b2} + (0.1 mean R)\u{b2}), in luminance. \
             <b>Noise</b> is what of it differs from seed to seed, <b>bias</b> what does not. Error bars and ranges \
             are 95\u{a0}% intervals.</p>\n\
             <p>Times are processor time of this machine in one run, all ways in turn, median over the seeds; divided \
             by {}, as on an otherwise idle machine. A pixel\u{2019}s noise hardly depends on the size of the picture, and \
             time is in proportion to it: prices are those of {}\u{d7}{}. Compare times with each other, not with \
             those of another machine.</p>\n\
             <p><b>Efficiency</b> is 1 over variance times time. A shortcut is <b>better until</b> its bias alone is as \
             large as the error that the full method has by then; the error in brackets is what both have at that time.</p>\n",
            report.seeds,
            best.max().unwrap_or(0),
            report.reference_spp,
            report.reference_way,
            Text(&percent(report.reference_error)),
            count(report.threads, "thread"),
            report.size[0],
            report.size[1],
        )
    }
}

/// `1 %`, `0.5 %`: no digits that mean nothing.
pub(super) fn percent_of_target(error: f64) -> String {
    format!("{}\u{a0}%", (error * 1e4).round() / 100.0)
}

/// `220 samples`.
fn count_of_samples(n: f64) -> String {
    format!("{} samples", thousands(n))
}

/// A number of samples, two or three digits, with spaces between thousands.
pub(super) fn thousands(n: f64) -> String {
    if !n.is_finite() {
        return "unknown".into();
    }
    let step = libm::pow(10.0, (libm::log10(n.max(1.0)).floor() - 2.0).max(0.0));
    let digits = format!("{:.0}", (n / step).round() * step);
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(c);
    }
    text
}

/// A factor, two digits.
pub(super) fn round(factor: f64) -> String {
    match factor {
        f if !f.is_finite() => "unknown".into(),
        f if f < 9.95 => format!("{f:.1}"),
        f => thousands(f),
    }
}

/// What a shortcut does to the picture.
pub(super) fn becomes(m: &Measured) -> String {
    let proved = m.change.low > 0.0 || m.change.high < 0.0;
    let word = if m.change.value < 0.0 { "darker" } else { "brighter" };
    let light = if proved { format!("is {} {word}", percent(m.change.value.abs())) } else { "is as bright".into() };
    if m.floor.low > 0.0 {
        format!("{light} and never nearer than {} to the right one", percent(m.floor.value))
    } else {
        format!("{light}; no bias was seen in single pixels")
    }
}

/// The change of all light, with its sign.
pub(super) fn signed(m: &Measured) -> String {
    if m.change.value.is_finite() { change(m.change.value) } else { "unknown".into() }
}

/// With a capital letter.
pub(super) fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |c| c.to_uppercase().chain(chars).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (n, text) in [(3.2, "3"), (220.4, "220"), (12_345.0, "12\u{202f}300"), (1e6, "1\u{202f}000\u{202f}000")] {
            assert_eq!(thousands(n), text);
        }
        assert_eq!([percent_of_target(0.01), percent_of_target(0.005)], ["1\u{a0}%", "0.5\u{a0}%"]);
        assert_eq!([round(1.26), round(1234.0)], ["1.3", "1\u{202f}230"]);
        assert_eq!(capital("mirror"), "Mirror");
    }
}

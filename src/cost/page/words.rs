//! The sentences of the page.

use super::of_kind;
use crate::cost::report::{CostReport, MAIN, Measured, Price, Until};
use crate::cost::switches::Kind;
use crate::page::text::{Text, change, count, percent};
use crate::stats::Interval;

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
        time(self.wall(processor))
    }

    /// `3 s to 5 s`, where that is known.
    pub(super) fn range(&self, processor: Interval) -> String {
        if processor.high.is_finite() {
            format!("{} to {}", self.time(processor.low), self.time(processor.high))
        } else {
            "not known better".into()
        }
    }

    /// `1 % costs *19 s* at 800×800`.
    pub(super) fn headline(&self) -> String {
        let [w, h] = self.report.size;
        let Some(price) = self.main() else {
            let diverges = self.full().is_some_and(Measured::does_not_converge);
            let why = if diverges {
                "It does not converge yet: no price can be told"
            } else {
                "Too few samples to tell a price"
            };
            return why.into();
        };
        let time = self.time(price.seconds.value);
        format!("{} costs *{time}* at {w}\u{d7}{h}", percent_of_target(MAIN))
    }

    /// What the headline rests on, and what comes next.
    pub(super) fn lead(&self) -> Vec<String> {
        let (Some(full), Some(price)) = (self.full(), self.main()) else { return Vec::new() };
        let first = format!(
            "{} samples a pixel, on {}; {} with 95\u{a0}% confidence. {}",
            thousands(price.samples.value),
            count(self.report.threads, "core"),
            self.range(price.seconds),
            continued(full, price),
        );
        std::iter::once(first).chain(self.dearest()).chain(self.estimator()).collect()
    }

    /// The other estimator that matters most: the cheapest where one is surely cheaper, else one that does not converge, else
    /// the dearest that surely is.
    fn estimator(&self) -> Option<String> {
        let full = self.main()?.seconds;
        let target = percent_of_target(MAIN);
        let mut unknown = of_kind(self.report, Kind::Algorithm).filter(|(_, m)| m.does_not_converge());
        let ways =
            of_kind(self.report, Kind::Algorithm).filter_map(|(_, m)| Some((m.price(MAIN)?.seconds, m)));
        let mut sure: Vec<_> = ways.filter(|(s, _)| s.high < full.low || s.low > full.high).collect();
        sure.sort_by(|a, b| a.0.value.total_cmp(&b.0.value));
        let cheaper = sure.first().filter(|(s, _)| s.high < full.low);
        if let (None, Some((_, m))) = (cheaper, unknown.next()) {
            let last = m.points.last()?;
            return Some(format!(
                "With *{}* it does not converge as far as was measured, with an error of {} after {} samples: when that will be \
                 {target} cannot be told.",
                m.name,
                percent(last.error.value),
                last.spp,
            ));
        }
        let (seconds, m) = cheaper.or(sure.last())?;
        let ratio = seconds.value / full.value;
        let (factor, word) = if ratio <= 1.0 { (1.0 / ratio, "cheaper") } else { (ratio, "dearer") };
        Some(format!(
            "With *{}* it takes {}: {} times {word}.",
            m.name,
            self.time(seconds.value),
            round(factor)
        ))
    }

    /// What the dearest effect costs, and what the picture is without it.
    fn dearest(&self) -> Option<String> {
        let (share, m) = self.shares().into_iter().find(|(share, m)| *share >= 0.05 && m.differs())?;
        Some(format!(
            "{} of that goes into *{}*: without, the picture takes {} to as little noise, and {}.",
            percent(share),
            m.gives_up,
            self.time(m.price(MAIN)?.seconds.value),
            becomes(m),
        ))
    }

    /// Shortcuts with the share of the price that they save, the largest first: effects before caps and the like.
    pub(super) fn shares(&self) -> Vec<(f64, &'a Measured)> {
        let full = self.main().map(|p| p.seconds.value);
        let share = |m: &'a Measured| Some((1.0 - m.price(MAIN)?.seconds.value / full?, m));
        let mut all: Vec<_> = of_kind(self.report, Kind::Shortcut).filter_map(|(_, m)| share(m)).collect();
        let effect = |m: &Measured| m.flag.starts_with("--without");
        all.sort_by(|a, b| effect(b.1).cmp(&effect(a.1)).then(b.0.total_cmp(&a.0)));
        all
    }

    /// Until when a shortcut is the better choice, as HTML.
    pub(super) fn until(&self, until: &Until) -> String {
        match until {
            Until::NoShortcut => "\u{2013}".into(),
            Until::Never => "never".into(),
            Until::NotSeen => "no bias seen".into(),
            Until::NotKnown => "unknown".into(),
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

/// A time with no more digits than can be known.
pub(super) fn time(s: f64) -> String {
    let whole = |unit: f64| (s / unit + 0.5) as u64;
    match s {
        _ if !s.is_finite() || s < 0.0 => "unknown".into(),
        _ if s < 0.0995 => format!("{:.0}\u{a0}ms", s * 1e3),
        _ if s < 9.95 => format!("{s:.1}\u{a0}s"),
        _ if s < 99.5 => format!("{s:.0}\u{a0}s"),
        _ if s < 599.5 => format!("{}\u{a0}min {:02}\u{a0}s", whole(1.0) / 60, whole(1.0) % 60),
        _ if s < 5970.0 => format!("{}\u{a0}min", whole(60.0)),
        _ if s < 35_970.0 => format!("{}\u{a0}h {:02}\u{a0}min", whole(60.0) / 60, whole(60.0) % 60),
        _ if s < 171_000.0 => format!("{}\u{a0}h", whole(3600.0)),
        _ => format!("{}\u{a0}days", thousands(s / 86_400.0)),
    }
}

/// Whether a price is measured or continued.
fn continued(full: &Measured, price: &Price) -> String {
    match full.points.last() {
        Some(last) if !price.measured => format!(
            "Measured down to {}; from there the line is continued, to {} times the samples.",
            percent(last.error.value),
            round(price.samples.value / f64::from(last.spp)),
        ),
        _ => "Measured, not extrapolated.".into(),
    }
}

/// A sentence as HTML: what stands between two asterisks is emphasised.
pub(super) fn html(sentence: &str) -> String {
    let parts = sentence.split('*').enumerate();
    let emphasised = |(i, part): (usize, &str)| match i % 2 {
        0 => Text(part).to_string(),
        _ => format!("<b>{}</b>", Text(part)),
    };
    parts.map(emphasised).collect()
}

/// A sentence for a terminal.
pub(super) fn plain(sentence: &str) -> String {
    sentence.replace('*', "").replace(['\u{a0}', '\u{202f}'], " ")
}

/// `1 %`, `0.5 %`: no digits that mean nothing.
pub(super) fn percent_of_target(error: f64) -> String {
    format!("{}\u{a0}%", (error * 1e4).round() / 100.0)
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

/// How bright a picture is beside the full one: `2.8 % darker`.
pub(super) fn brightness(m: &Measured) -> String {
    let word = if m.change.value < 0.0 { "darker" } else { "brighter" };
    if m.change.may_be_zero() {
        "as bright".into()
    } else {
        format!("{} {word}", percent(m.change.value.abs()))
    }
}

/// What a shortcut does to the picture.
fn becomes(m: &Measured) -> String {
    let light = format!("is {}", brightness(m));
    if m.floor.low > 0.0 {
        format!("{light}, and its error never falls below {}", percent(m.floor.value))
    } else {
        format!("{light}, and no bias was seen in single pixels")
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
        for (n, text) in
            [(3.2, "3"), (220.4, "220"), (12_345.0, "12\u{202f}300"), (1e6, "1\u{202f}000\u{202f}000")]
        {
            assert_eq!(thousands(n), text);
        }
        assert_eq!([percent_of_target(0.01), percent_of_target(0.005)], ["1\u{a0}%", "0.5\u{a0}%"]);
        assert_eq!([round(1.26), round(1234.0)], ["1.3", "1\u{202f}230"]);
        let times = [0.02, 0.44, 42.0, 200.0, 1715.0, 6862.0, 42_900.0, 2.6e5];
        let said = ["20 ms", "0.4 s", "42 s", "3 min 20 s", "29 min", "1 h 54 min", "12 h", "3 days"];
        assert_eq!(times.map(|s| plain(&time(s))), said);
        assert_eq!(capital("mirror"), "Mirror");
        let sentence = "a*b<*c\u{a0}%";
        assert_eq!([html(sentence), plain(sentence)], ["a<b>b&lt;</b>c\u{a0}%", "ab<c %"]);
    }
}

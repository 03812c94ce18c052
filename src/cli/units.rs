//! Words that stand for sizes, times and rectangles.

use std::time::Duration;

/// `WIDTHxHEIGHT` in pixels, each from 1 to 65536.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let parsed = text.split_once(['x', 'X']).and_then(|(w, h)| Some([number(w)?, number(h)?]));
    parsed
        .filter(|[w, h]| (1..=65_536).contains(w) && (1..=65_536).contains(h))
        .ok_or_else(|| "expected WIDTHxHEIGHT in pixels, each from 1 to 65536, such as 800x600".into())
}

/// `X,Y,WIDTH,HEIGHT` in pixels of the whole picture, from its top left corner.
pub(super) fn crop(text: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(number).collect();
    numbers.and_then(|n| <[u32; 4]>::try_from(n).ok()).filter(|[_, _, w, h]| *w > 0 && *h > 0).ok_or_else(
        || "expected X,Y,WIDTH,HEIGHT in pixels from the top left corner, such as 0,0,64,64".into(),
    )
}

/// A time with its unit: `500ms`, `30s`, `5min`, `2h`; a bare number is seconds.
pub(super) fn time(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let unit_at = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(unit_at);
    let seconds = match unit {
        "ms" => Some(0.001),
        "" | "s" => Some(1.0),
        "m" | "min" => Some(60.0),
        "h" => Some(3600.0),
        _ => None,
    };
    let seconds = seconds.and_then(|s| Some(s * number.trim().parse::<f64>().ok()?));
    seconds
        .filter(|s| *s > 0.0)
        .and_then(|s| Duration::try_from_secs_f64(s).ok())
        .filter(|d| !d.is_zero())
        .ok_or_else(|| "expected a time above zero, such as 500ms, 30s, 5min or 2h".into())
}

/// A share above zero and below one, in percent or as a number: `1%`, `0.01`.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let parsed = match text.strip_suffix('%') {
        Some(percent) => percent.trim().parse::<f64>().ok().map(|p| p / 100.0),
        None => text.parse().ok(),
    };
    parsed
        .filter(|s| *s > 0.0 && *s < 1.0)
        .ok_or_else(|| "expected a share between 0 and 100 %, such as 1% or 0.01".into())
}

/// `X,Y,PASS`: a pixel of the whole picture, and a pass.
pub(super) fn sample(text: &str) -> Result<[u32; 3], String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(number).collect();
    numbers.and_then(|n| n.try_into().ok()).ok_or_else(|| {
        "expected X,Y,PASS: a pixel from the top left corner, and a pass, such as 17,42,9".into()
    })
}

/// `A..B`, half open.
pub(super) fn passes(text: &str) -> Result<std::ops::Range<u32>, String> {
    let range = text.split_once("..").and_then(|(a, b)| Some(number(a)?..number(b)?));
    range
        .filter(|r| r.start < r.end && r.end <= super::args::MAX_SAMPLES)
        .ok_or_else(|| "expected A..B, the first pass and the one after the last, such as 0..64".into())
}

/// Passes as they are typed: `0..64`, with commas between several ranges.
pub(super) fn show_passes(passes: &[std::ops::Range<u32>]) -> String {
    passes.iter().map(|r| format!("{}..{}", r.start, r.end)).collect::<Vec<_>>().join(", ")
}

/// A share for people, in percent with three digits.
pub(super) fn show_share(share: f64) -> String {
    let percent = 100.0 * share;
    let digits =
        if percent <= 0.0 { 0 } else { (2.0 - libm::log10(percent).floor()).clamp(0.0, 6.0) as usize };
    format!("{percent:.digits$} %")
}

/// Stops of exposure.
pub(super) fn stops(text: &str) -> Result<f32, String> {
    let parsed = text.trim().parse::<f32>().ok().filter(|v| v.abs() <= 100.0);
    parsed.ok_or_else(|| "expected a number of stops from -100 to 100, such as 1.5".into())
}

/// An error that was asked for, without the last bits of a product.
pub(super) fn show_error(error: f64) -> String {
    format!("{} %", (1e8 * error).round() / 1e6)
}

/// A time for people: `0.4 s`, `12 s`, `3 min 20 s`, `2 h 5 min`.
pub(super) fn show_time(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0..10 => format!("{:.1} s", seconds.max(0.0)),
        10..120 => format!("{whole} s"),
        120..7200 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

/// Two times for people, from the first to the second.
pub(super) fn show_range([from, to]: [f64; 2]) -> String {
    let (from, to) = (show_time(from), show_time(to));
    // One unit is enough where both have the same.
    match (from.strip_suffix(" s"), to.strip_suffix(" s")) {
        (Some(short), Some(_)) if !from.contains("min") && !to.contains("min") => format!("{short} to {to}"),
        _ => format!("{from} to {to}"),
    }
}

/// Digits alone: no sign, no space.
fn number(text: &str) -> Option<u32> {
    text.bytes().all(|b| b.is_ascii_digit()).then(|| text.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        for (text, expected) in [
            ("800x600", Some([800, 600])),
            ("1X1", Some([1, 1])),
            ("0x0", None),
            ("800", None),
            ("-8x6", None),
            ("+8x6", None),
            ("65537x1", None),
            ("99999999999x1", None),
            ("x", None),
        ] {
            assert_eq!(size(text).ok(), expected, "{text}");
        }
    }

    #[test]
    fn crops() {
        for (text, expected) in [
            ("1,2,3,4", Some([1, 2, 3, 4])),
            ("1,2,3", None),
            ("1,2,0,4", None),
            ("1,2,3,4,5", None),
            ("", None),
        ] {
            assert_eq!(crop(text).ok(), expected, "{text}");
        }
    }

    #[test]
    fn times() {
        for (text, seconds) in [
            ("30s", Some(30.0)),
            ("30", Some(30.0)),
            ("0.5min", Some(30.0)),
            ("250ms", Some(0.25)),
            ("1 h", Some(3600.0)),
            ("0s", None),
            ("-3s", None),
            ("1e-12s", None),
            ("1e300h", None),
            ("NaN", None),
            ("5 days", None),
        ] {
            assert_eq!(time(text).ok().map(|d| d.as_secs_f64()), seconds, "{text}");
        }
    }

    #[test]
    fn shown_times() {
        for (seconds, expected) in
            [(0.44, "0.4 s"), (59.6, "60 s"), (200.0, "3 min 20 s"), (7500.0, "2 h 5 min"), (-1.0, "0.0 s")]
        {
            assert_eq!(show_time(seconds), expected);
        }
    }
}

//! Words and numbers as a page shows them.
//!
//! In: what a verification says. Out: text. The invariant: [`Text`] is the only way of foreign text into a
//! page, and it can neither open nor close an element or attribute.

use std::fmt;

/// Foreign text, escaped for elements and for attributes in double quotes. Characters that HTML does not allow
/// become replacement characters.
pub(crate) struct Text<'a>(pub(crate) &'a str);

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use fmt::Write as _;
        for c in self.0.chars() {
            match c {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                '\'' => f.write_str("&#39;")?,
                '\n' | '\t' => f.write_char(c)?,
                _ if c.is_control() => f.write_char(char::REPLACEMENT_CHARACTER)?,
                _ => f.write_char(c)?,
            }
        }
        Ok(())
    }
}

/// A minus sign where programs write a hyphen, and no sign before a zero.
fn typeset(number: &str) -> String {
    if number.bytes().any(|b| matches!(b, b'1'..=b'9')) {
        number.replace('-', "\u{2212}")
    } else {
        number.trim_start_matches(['+', '-']).to_owned()
    }
}

/// What is not finite, in words.
fn odd(v: f64) -> Option<String> {
    if v.is_nan() {
        Some("not a number".into())
    } else if v.is_infinite() {
        Some(if v > 0.0 { "+\u{221e}" } else { "\u{2212}\u{221e}" }.into())
    } else {
        None
    }
}

/// A number with its sign.
pub(crate) fn signed(v: f64, decimals: usize) -> String {
    odd(v).unwrap_or_else(|| typeset(&format!("{v:+.decimals$}")))
}

/// A relative change: 0.01 is `+1.00 %`. Decimals are the same for all, so that columns align.
pub(crate) fn change(v: f64) -> String {
    let percent = v * 100.0;
    signed(percent, if percent.abs() < 100.0 { 2 } else { 0 }) + "\u{a0}%"
}

/// A share or an error: 0.0123 is `1.2 %`, two digits.
pub(crate) fn percent(v: f64) -> String {
    let percent = v * 100.0;
    let decimals = match percent.abs() {
        p if p >= 9.95 => 0,
        p if p >= 0.995 => 1,
        p if p >= 0.0995 => 2,
        _ => 3,
    };
    odd(v).unwrap_or_else(|| typeset(&format!("{percent:.decimals$}"))) + "\u{a0}%"
}

/// A probability, one or two digits: `0.21`, `0.004`, `3×10⁻⁹`.
pub(crate) fn probability(p: f64) -> String {
    match p {
        _ if !p.is_finite() => "not a number".into(),
        _ if p >= 0.0095 => format!("{p:.2}"),
        _ if p >= 0.00095 => format!("{p:.3}"),
        _ if p > 0.0 => {
            let text = format!("{p:.0e}");
            let (digit, power) = text.split_once('e').unwrap_or((&text, "0"));
            let digit = if digit == "1" { String::new() } else { format!("{digit}\u{d7}") };
            format!("{digit}10{}", power.chars().map(superscript).collect::<String>())
        }
        _ => "0".into(),
    }
}

/// Powers of ten.
fn superscript(c: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match c.to_digit(10) {
        Some(d) => DIGITS[d as usize],
        None if c == '-' => '⁻',
        None => c,
    }
}

/// Ten to the power of a whole number.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".into(),
        -2 => "0.01".into(),
        -1 => "0.1".into(),
        _ => format!("10{}", exponent.to_string().chars().map(superscript).collect::<String>()),
    }
}

/// Wall-clock time.
pub(crate) fn seconds(s: f64) -> String {
    match s {
        _ if !s.is_finite() || s < 0.0 => "unknown".into(),
        _ if s < 9.95 => format!("{s:.1}\u{a0}s"),
        _ if s < 99.5 => format!("{s:.0}\u{a0}s"),
        _ => {
            let whole = (s + 0.5) as u64;
            format!("{}\u{a0}min {:02}\u{a0}s", whole / 60, whole % 60)
        }
    }
}

/// `1 seed`, `2 seeds`.
pub(crate) fn count(n: usize, one: &str) -> String {
    format!("{n}\u{a0}{one}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing in foreign text ends an element or an attribute.
    #[test]
    fn foreign_text_is_inert() {
        let text = Text("</p><b a=\"x\" c='y'>&amp;\0\u{1b}é").to_string();
        let expected =
            "&lt;/p&gt;&lt;b a=&quot;x&quot; c=&#39;y&#39;&gt;&amp;amp;\u{fffd}\u{fffd}é".to_owned();
        assert_eq!(text, expected);
    }

    /// Numbers are short, have a true minus sign, and say so where they are none.
    #[test]
    fn numbers() {
        assert_eq!(change(-0.041), "−4.10\u{a0}%");
        assert_eq!(change(-0.000_001), "0.00\u{a0}%");
        assert_eq!(change(2.5), "+250\u{a0}%");
        assert_eq!(percent(0.001_23), "0.12\u{a0}%");
        assert_eq!(percent(0.5), "50\u{a0}%");
        assert_eq!(signed(-9.04, 1), "−9.0");
        assert_eq!(signed(f64::NEG_INFINITY, 1), "−∞");
        assert_eq!(signed(f64::NAN, 1), "not a number");
        assert_eq!(seconds(7.26), "7.3\u{a0}s");
        assert_eq!(seconds(125.2), "2\u{a0}min 05\u{a0}s");
    }

    /// Probabilities keep one or two digits down to the smallest.
    #[test]
    fn probabilities() {
        let cases = [
            (1.0, "1.00"),
            (0.213, "0.21"),
            (0.0042, "0.004"),
            (3.2e-9, "3×10⁻⁹"),
            (1e-12, "10⁻¹²"),
            (0.0, "0"),
        ];
        for (p, expected) in cases {
            assert_eq!(probability(p), expected);
        }
    }
}

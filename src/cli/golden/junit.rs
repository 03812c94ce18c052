//! JUnit XML, as CI systems show test results.

use std::fmt::Write as _;

use crate::golden::{Verdict, Verification};

/// One test case for each scene.
pub(super) fn xml(verifications: &[Verification]) -> String {
    let failures = verifications.iter().filter(|v| v.verdict == Verdict::Refused).count();
    let seconds: f64 = verifications.iter().map(|v| v.seconds).sum();
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(
        text,
        "<testsuites>\n<testsuite name=\"epsilux golden\" tests=\"{}\" failures=\"{failures}\" time=\"{seconds:.3}\">",
        verifications.len()
    );
    for v in verifications {
        let _ = writeln!(
            text,
            "<testcase classname=\"golden\" name=\"{}\" time=\"{:.3}\">",
            escape(&v.name),
            v.seconds
        );
        let lines: Vec<String> = v.reasons.iter().map(|r| format!("{}: {}", r.gate, r.message)).collect();
        match v.verdict {
            Verdict::Passed => {}
            Verdict::Improved => {
                let _ = writeln!(
                    text,
                    "<system-out>{}</system-out>",
                    escape(&format!("improved\n{}\nbless: {}", lines.join("\n"), v.bless))
                );
            }
            Verdict::Refused => {
                let first = lines.first().map_or("", String::as_str);
                let body = format!("{}\nreplay: {}\nbless: {}", lines.join("\n"), v.replay, v.bless);
                let _ = writeln!(text, "<failure message=\"{}\">{}</failure>", escape(first), escape(&body));
            }
        }
        text += "</testcase>\n";
    }
    text + "</testsuite>\n</testsuites>\n"
}

/// Text between tags and in attributes; characters that XML cannot hold are left out.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '&' => out += "&amp;",
            '"' => out += "&quot;",
            c if c.is_control() && c != '\n' && c != '\t' => {}
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        assert_eq!(escape("a<b & \"c\"\u{1}\n"), "a&lt;b &amp; &quot;c&quot;\n");
    }
}

//! What a command ends in when it does not end well: a message, a help, an exit code.

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, NamedSource, SourceSpan};

use super::Code;
use crate::scene::text::TextError;

/// A command that did not do what was asked.
#[derive(Debug)]
pub(super) struct Failure {
    pub(super) code: Code,
    what: What,
}

#[derive(Debug)]
enum What {
    /// One line, and what to do about it.
    Message { message: String, help: Option<String> },
    /// A mistake in a text, shown with its line.
    Text(Box<TextMistake>),
}

#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{message}")]
struct TextMistake {
    message: String,
    #[help]
    help: Option<String>,
    #[source_code]
    source_code: NamedSource<String>,
    #[label("{label}")]
    span: SourceSpan,
    label: String,
}

impl Failure {
    fn new(code: Code, message: impl Into<String>) -> Self {
        Self { code, what: What::Message { message: message.into(), help: None } }
    }

    /// The flags do not make sense together.
    pub(super) fn usage(message: impl Into<String>) -> Self {
        Self::new(Code::Usage, message)
    }

    /// An input cannot be loaded.
    pub(super) fn load(message: impl Into<String>) -> Self {
        Self::new(Code::Load, message)
    }

    /// Refused because of `--strict`.
    pub(super) fn strict(message: impl Into<String>) -> Self {
        Self::new(Code::Strict, message)
    }

    /// Compared, and something differs.
    pub(super) fn differs(message: impl Into<String>) -> Self {
        Self::new(Code::Differs, message)
    }

    /// Ended by a signal.
    pub(super) fn stopped(code: Code, message: impl Into<String>) -> Self {
        Self::new(code, message)
    }

    /// An output cannot be written.
    pub(super) fn write(message: impl Into<String>) -> Self {
        Self::new(Code::Write, message)
    }

    /// A mistake in the text of the file `name`.
    pub(super) fn text(name: &str, text: String, error: &TextError) -> Self {
        let help = [
            error.expected.as_ref().map(|e| format!("expected {e}")),
            error.nearest.as_ref().map(|n| format!("did you mean `{n}`?")),
        ];
        let help = help.into_iter().flatten().collect::<Vec<_>>().join("; ");
        let mistake = TextMistake {
            message: format!("{name}, line {}: {}", error.line, error.message),
            help: (!help.is_empty()).then_some(help),
            source_code: NamedSource::new(name, text),
            span: error.span.clone().into(),
            label: if error.place.is_empty() { "here".into() } else { error.place.clone() },
        };
        Self { code: Code::Load, what: What::Text(Box::new(mistake)) }
    }

    /// What the user can do about it.
    pub(super) fn help(mut self, text: impl Into<String>) -> Self {
        if let What::Message { help, .. } = &mut self.what {
            *help = Some(text.into());
        }
        self
    }

    /// The whole message, over several lines.
    pub(super) fn render(&self, colours: bool) -> String {
        match &self.what {
            What::Message { message, help } => {
                let help = help.as_ref().map_or(String::new(), |h| format!("\n  help: {h}"));
                let label = if colours { "\u{1b}[1;31merror:\u{1b}[0m" } else { "error:" };
                format!("{label} {message}{help}")
            }
            What::Text(mistake) => {
                let theme =
                    if colours { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
                let mut text = String::new();
                let handler = GraphicalReportHandler::new_themed(theme).with_width(100);
                match handler.render_report(&mut text, mistake.as_ref()) {
                    Ok(()) => text,
                    Err(_) => mistake.message.clone(),
                }
            }
        }
    }
}

//! Standard output and standard error, and whether people look at them.

use std::io::{self, ErrorKind, IsTerminal, Write};

use super::failure::Failure;

/// Where results and messages go.
pub(super) struct Console {
    colours: bool,
    result_colours: bool,
}

impl Console {
    pub(super) fn new() -> Self {
        let no_color = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
        Self {
            colours: io::stderr().is_terminal() && !no_color,
            result_colours: io::stdout().is_terminal() && !no_color,
        }
    }

    /// Whether messages may be coloured, and bars drawn.
    pub(super) fn colours(&self) -> bool {
        self.colours
    }

    /// Whether results may be coloured.
    pub(super) fn result_colours(&self) -> bool {
        self.result_colours
    }

    /// A result, on standard output, with a line break after it. A reader that has gone away ends the
    /// program's talking and is no mistake.
    pub(super) fn result(&self, text: &str) -> Result<(), Failure> {
        let mut out = io::stdout().lock();
        match writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()) {
            Err(e) if e.kind() != ErrorKind::BrokenPipe => {
                Err(Failure::write(format!("standard output: {e}")))
            }
            _ => Ok(()),
        }
    }

    /// A message, on standard error, with a line break after it.
    pub(super) fn message(&self, text: &str) {
        // There is nobody left to tell where this fails.
        let _ = writeln!(io::stderr().lock(), "{}", text.trim_end());
    }
}

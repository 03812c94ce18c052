//! The command line: arguments in, exit code out.
//!
//! In: words as typed. Out: files, results on standard output, messages on standard error, and an exit
//! code (`Code`). `args` holds flags as typed; each subcommand turns them into options as meant in
//! one step and calls the library, which sees only options. Nothing else in the crate prints.

mod adopt;
mod advice;
mod algorithm;
mod args;
mod check;
mod compare;
mod console;
mod convert;
mod cost;
mod demo;
mod doubt;
mod explain;
mod failure;
mod forecast;
mod golden;
mod info;
mod load;
mod machine;
mod merge;
mod notes;
mod parts;
mod progress;
mod quote;
mod render;
mod rendered;
mod saver;
mod schema;
mod shortcuts;
mod signal;
mod stated;
mod units;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};
use console::Console;
use failure::Failure;

/// Exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Code {
    /// Done.
    Done = 0,
    /// Compared, and the images differ.
    Differs = 1,
    /// Wrong usage.
    Usage = 2,
    /// The budget ended before the error was reached; what was written is whole.
    Short = 3,
    /// An input cannot be loaded.
    Load = 4,
    /// Refused by `--strict`.
    Strict = 5,
    /// An output cannot be written.
    Write = 6,
    /// Saved after an interrupt.
    Interrupted = 130,
    /// Saved after a request to terminate.
    Terminated = 143,
}

/// Runs the program with `arguments`, the first of which is its own name.
#[must_use]
pub fn run(arguments: Vec<OsString>) -> ExitCode {
    let console = Console::new();
    let result = match Arguments::try_parse_from(&arguments) {
        Ok(parsed) => dispatch(parsed.command, &arguments, &console),
        Err(error) => {
            // Help and version go to standard output, mistakes to standard error; clap knows which.
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { Code::Usage as u8 } else { Code::Done as u8 });
        }
    };
    let code = result.unwrap_or_else(|failure| {
        console.message(&failure.render(console.colours()));
        failure.code
    });
    ExitCode::from(code as u8)
}

fn dispatch(command: Command, arguments: &[OsString], console: &Console) -> Result<Code, Failure> {
    match command {
        Command::Render(args) => render::run(&args, arguments, console),
        Command::Explain(args) => explain::run(&args, console),
        Command::Info(args) => info::run(&args, console),
        Command::Convert(args) => convert::run(&args, console),
        Command::Compare(args) => compare::run(&args, console),
        Command::Merge(args) => merge::run(&args, console),
        Command::Quote(args) => quote::run(&args, console),
        Command::Check(args) => check::run(&args, console),
        Command::Cost(args) => cost::run(&args, arguments, console),
        Command::Golden(args) => golden::run(&args, console),
        Command::Demo(args) => demo::run(&args, arguments, console),
        Command::Schema(args) => schema::run(&args, console),
    }
}

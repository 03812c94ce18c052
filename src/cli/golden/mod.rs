//! `epsilux golden`

mod args;
mod bless;
mod date;
mod files;
mod judge;
mod junit;
mod power;
mod progress;
mod record;
mod verify;

pub(super) use args::GoldenArgs;
use args::GoldenCommand;

use super::Code;
use super::console::Console;
use super::failure::Failure;

pub(super) fn run(args: &GoldenArgs, console: &Console) -> Result<Code, Failure> {
    match &args.command {
        GoldenCommand::Record(args) => record::run(args, console),
        GoldenCommand::Verify(args) => verify::run(args, console),
        GoldenCommand::Bless(args) => bless::run(args, console),
        GoldenCommand::Report(args) => verify::report(args, console),
        GoldenCommand::Power(args) => power::run(args, console),
    }
}

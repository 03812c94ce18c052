//! Repository chores: `cargo xtask --help` lists them; each is a subcommand in a file of its own.

mod blender;
mod calibrate;
mod cost;
mod gltf;
mod golden;
mod hard;
mod instructions;
mod report_plot;
mod tidy;

use std::io::Write as _;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Repository chores of epsilux.
#[derive(Parser)]
#[command(name = "cargo xtask", max_term_width = 100)]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    Blender(blender::Arguments),
    Calibrate(calibrate::Arguments),
    Cost(cost::Arguments),
    GltfValidate(gltf::Arguments),
    Golden(golden::Arguments),
    Hard(hard::Arguments),
    Instructions(instructions::Arguments),
    ReportPlot(report_plot::Arguments),
    Tidy(tidy::Arguments),
}

fn main() -> ExitCode {
    let done = match Arguments::parse().chore {
        Chore::Blender(arguments) => blender::run(&arguments),
        Chore::Calibrate(arguments) => calibrate::run(&arguments),
        Chore::Cost(arguments) => cost::run(&arguments),
        Chore::GltfValidate(arguments) => gltf::run(&arguments),
        Chore::Golden(arguments) => golden::run(&arguments),
        Chore::Hard(arguments) => hard::run(&arguments),
        Chore::Instructions(arguments) => instructions::run(&arguments),
        Chore::ReportPlot(arguments) => report_plot::run(&arguments),
        Chore::Tidy(arguments) => tidy::run(&arguments),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            // Nothing is left to do where not even the message can be written.
            let _ = writeln!(std::io::stderr(), "error: {message}");
            ExitCode::FAILURE
        }
    }
}

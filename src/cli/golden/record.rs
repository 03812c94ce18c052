//! `epsilux golden record`

use super::args::RecordArgs;
use super::date::today;
use super::files::{self, Guarded};
use super::progress::Bar;
use crate::cli::Code;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::units::show_time;
use crate::golden::{self, Forecast, PILOTS, RecordError, Reference, Step, Watch};

pub(super) fn run(args: &RecordArgs, console: &Console) -> Result<Code, Failure> {
    let all = files::guarded(&args.suite)?;
    let (old, new): (Vec<Guarded>, Vec<Guarded>) = all.into_iter().partition(|g| g.text_path().exists());
    if !old.is_empty() {
        let names = old.iter().map(|g| g.entry.name.as_str()).collect::<Vec<_>>().join(", ");
        console.message(&format!("note: recorded already, left alone: {names} (`golden bless` replaces)"));
    }
    let bar = Bar::new(new.len() as u32 * (PILOTS + args.runs), console);
    for guarded in &new {
        bar.scene(&guarded.entry.name);
        let reference = record(guarded, args.runs, &bar, console)?;
        let hash = guarded.write(&reference)?;
        guarded.tell(&format!(
            "## {}: recorded, {}\n\nreference.json {hash}. {}.",
            guarded.entry.name,
            today(),
            reference.truth.statement
        ))?;
        bar.suspend(|| {
            let files = [guarded.image_path(), guarded.text_path()].map(|p| p.display().to_string());
            console.result(&format!("{}\n{}", files[0], files[1]))
        })?;
    }
    bar.clear();
    Ok(Code::Done)
}

/// Records a scene; says what it will cost before the long part begins.
pub(super) fn record(
    guarded: &Guarded,
    runs: u32,
    bar: &Bar,
    console: &Console,
) -> Result<Reference, Failure> {
    let name = &guarded.entry.name;
    let subject = guarded.subject()?;
    let told = |step: &Step| {
        bar.told(step);
        if let Step::Forecast(forecast) = step {
            // Messages cannot fail.
            let _ = bar.suspend(|| {
                console.message(&forecast_line(name, subject.settings.size, forecast));
                Ok(())
            });
        }
    };
    let software = format!("epsilux {}", env!("CARGO_PKG_VERSION"));
    let watch = Watch { control: bar, told: &told };
    golden::record(&guarded.entry, &subject, runs, &software, &watch).map_err(|e| match e {
        RecordError::Run(error) => bar.failure(name, &error),
        RecordError::Untrue(statement) => {
            Failure::differs(format!("{name}: is not what it should be: {statement}"))
                .help("either the renderer is wrong, or `truth` in golden.toml")
        }
        other => Failure::load(format!("{name}: {other}")),
    })
}

fn forecast_line(name: &str, [w, h]: [u32; 2], forecast: &Forecast) -> String {
    let notices = golden::notices(&forecast.power).map_or_else(String::new, |shift| {
        // Four runs, as `verify` takes, against one.
        let four = shift * (0.25f64 + 1.0 / 64.0).sqrt() / (1.0f64 + 1.0 / 64.0).sqrt();
        format!(", notices {:.2} % more or less light (99 % sure)", 100.0 * four)
    });
    format!(
        "{name}: {w}x{h}, files about {} KB; a verification of 4 runs takes {} here{notices}",
        forecast.bytes / 1000,
        show_time(4.0 * forecast.seconds_per_run)
    )
}

//! `epsilux golden bless`

use std::path::Path;
use std::process::Command;

use super::args::BlessArgs;
use super::date::today;
use super::files::{self, Guarded};
use super::judge::one;
use super::progress::Bar;
use super::record::record;
use crate::cli::Code;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::golden::{PILOTS, Reference, SIGNIFICANCE, VerifyOptions, account};
use crate::report;

/// Runs that are compared with the old reference, to say what changed.
const COMPARED: u32 = 16;

pub(super) fn run(args: &BlessArgs, console: &Console) -> Result<Code, Failure> {
    if args.reason.trim().is_empty() {
        return Err(Failure::usage("--reason: found nothing, expected why the reference changes"));
    }
    let all = files::guarded(&super::args::SuiteArgs {
        suites: vec![args.suite.clone()],
        scenes: args.scenes.clone(),
    })?;
    if !args.allow_dirty {
        clean(&args.suite)?;
    }
    let bar = Bar::new(all.len() as u32 * (COMPARED + PILOTS + args.runs), console);
    for guarded in &all {
        bar.scene(&guarded.entry.name);
        let section = bless(guarded, args, &bar, console)?;
        bar.suspend(|| console.result(&section))?;
    }
    bar.clear();
    Ok(Code::Done)
}

fn bless(guarded: &Guarded, args: &BlessArgs, bar: &Bar, console: &Console) -> Result<String, Failure> {
    let old = if guarded.text_path().exists() { Some(guarded.reference()) } else { None };
    let account = match &old {
        Some(Ok(old)) => Some(changes(guarded, old, bar)?),
        _ => None,
    };
    let new = record(guarded, args.runs, bar, console)?;
    let account = match (&old, account) {
        (Some(Ok(old)), Some((kind, lines))) => {
            let flip = report::compare(&new.image, &old.image).map_or(f64::NAN, |c| c.flip);
            format!("{kind}\n\n{lines}\nFLIP {flip:.4}.")
        }
        (Some(Err(_)), _) => "the old one cannot be read any more".to_owned(),
        _ => "there was none".to_owned(),
    };
    let (kind, lines) = account.split_once("\n\n").unwrap_or((&account, ""));
    let hash = guarded.write(&new)?;
    let section = format!(
        "## {}: {kind}, {}\n\nReason: {}\n\n{}reference.json {hash}. {}.",
        guarded.entry.name,
        today(),
        args.reason.trim(),
        if lines.is_empty() { String::new() } else { format!("{lines}\n\n") },
        new.truth.statement
    );
    guarded.tell(&section)?;
    Ok(section)
}

/// What kind of change it is, and a table of it.
fn changes(guarded: &Guarded, old: &Reference, bar: &Bar) -> Result<(String, String), Failure> {
    let options = VerifyOptions { runs: COMPARED, fresh: 0, significance: SIGNIFICANCE, check_scene: false };
    let comparable = guarded.subject()?.settings == old.settings;
    if !comparable {
        return Ok(("other settings".to_owned(), String::new()));
    }
    let done = one(guarded, None, &options, bar)?;
    if let Some(broken) = done.checks.iter().find(|c| !c.holds) {
        let message =
            format!("{}: the gate {} does not hold: {}", guarded.entry.name, broken.name, broken.message);
        return Err(Failure::differs(message).help("a reference can only be made of runs that are sound"));
    }
    Ok(account(&done))
}

/// Refuses where git sees changes besides those that blessing makes.
fn clean(suite: &Path) -> Result<(), Failure> {
    const OWN: [&str; 3] = ["reference.exr", "reference.json", ".md"];
    let folder = suite.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let said = Command::new("git").args(["status", "--porcelain"]).current_dir(folder).output();
    // Without git, or outside of a repository, there is nothing to ask.
    let Some(said) = said.ok().filter(|o| o.status.success()) else { return Ok(()) };
    let text = String::from_utf8_lossy(&said.stdout).into_owned();
    let others: Vec<&str> =
        text.lines().filter(|l| !OWN.iter().any(|own| l.trim_end_matches('"').ends_with(own))).collect();
    if others.is_empty() {
        return Ok(());
    }
    let more = if others.len() > 3 { format!(" and {} more", others.len() - 3) } else { String::new() };
    let names = others.iter().take(3).map(|l| l.get(3..).unwrap_or(l)).collect::<Vec<_>>().join(", ");
    Err(Failure::differs(format!("git sees changes that are not committed: {names}{more}"))
        .help("commit them, so that the blessing says what it blesses, or add --allow-dirty"))
}

//! `cargo xtask cost`: what accuracy costs in every scene of `scenes/`.
//!
//! In: the release program and the scenes. Out: a page and figures for each in `target/cost`, and the table of
//! README.md between its two marks. The table holds what is counted (samples, rays), and no seconds: whoever runs
//! this again gets the same. Its first mark names the scenes by their contents, and `cargo xtask tidy` checks that.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::golden::{array, println_line, text};
use crate::tidy::content_hash;

/// Measure what accuracy costs in every scene, and write the table of README.md.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Scenes, such as hexroom; the table is written only where all are measured [default: all]
    #[arg(value_name = "NAME")]
    scenes: Vec<String>,
    /// Samples a pixel of everything, a power of two
    #[arg(long, value_name = "N", default_value_t = 32)]
    spp: u32,
    /// Width of the pictures that are measured
    #[arg(long, value_name = "N", default_value_t = 48)]
    width: u32,
    /// The program to measure with [default: target/release/epsilux, which is built first]
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// The marks around the table.
pub(crate) const BEGIN: &str = "<!-- cost:";
pub(crate) const END: &str = "<!-- /cost -->";
/// The error whose price the table tells.
const ERROR: f64 = 0.01;
/// Effects that are named for each scene, at most.
const NAMED: usize = 3;
/// What is named has less than this share of the full price, or is another way and takes more than so many of it: what
/// lies between is within the noise of few seeds, or does not matter.
const CHEAPER: f64 = 0.8;
const DEARER: f64 = 2.0;

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    let program = match &arguments.program {
        Some(program) => program.clone(),
        None => built(root)?,
    };
    let all = scenes(root)?;
    let known = |name: &String| all.iter().any(|(n, _)| n == name);
    if let Some(unknown) = arguments.scenes.iter().find(|n| !known(n)) {
        let names = all.iter().map(|(n, _)| n.as_str()).collect::<Vec<_>>().join(", ");
        return Err(format!("{unknown}: expected some of: {names}"));
    }
    let folder = root.join("target/cost");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut rows = Vec::new();
    for (name, _) in all.iter().filter(|(n, _)| arguments.scenes.is_empty() || arguments.scenes.contains(n)) {
        let [page, json] = ["html", "json"].map(|suffix| folder.join(format!("{name}.{suffix}")));
        let mut command = Command::new(&program);
        command.arg("cost").arg(format!("scenes/{name}.toml")).current_dir(root);
        command.args(["--spp", &arguments.spp.to_string(), "--width", &arguments.width.to_string()]);
        let status = command.arg("-o").arg(&page).arg("--json").arg(&json).status();
        if !status.map_err(|e| format!("epsilux could not be started: {e}"))?.success() {
            return Err(format!("epsilux cost {name} did not succeed"));
        }
        let read = std::fs::read_to_string(&json).map_err(|e| format!("{}: {e}", json.display()))?;
        let report: Value = serde_json::from_str(&read).map_err(|e| format!("{}: {e}", json.display()))?;
        rows.push(row(name, &report));
    }
    if arguments.scenes.is_empty() {
        write_table(root, arguments, &all, &rows)
    } else {
        rows.iter().for_each(|row| println_line(row));
        Ok(())
    }
}

/// The release program, built.
fn built(root: &Path) -> Result<PathBuf, String> {
    let build =
        Command::new(env!("CARGO")).args(["build", "--release", "--quiet"]).current_dir(root).status();
    if !build.map_err(|e| format!("cargo could not be started: {e}"))?.success() {
        return Err("the program could not be built".to_owned());
    }
    Ok(root.join("target/release/epsilux"))
}

/// Names and texts of the scenes, by name.
fn scenes(root: &Path) -> Result<Vec<(String, String)>, String> {
    let folder = root.join("scenes");
    let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
    let mut all = Vec::new();
    for entry in std::fs::read_dir(&folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|e| e == "toml") {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            all.push((name, std::fs::read_to_string(&path).map_err(failed)?));
        }
    }
    all.sort();
    Ok(all)
}

/// Samples to the error of the table, and rays: both for a pixel.
fn price(way: &Value) -> Option<[f64; 2]> {
    let price = array(way, "prices").iter().find(|p| p["error"] == ERROR)?;
    let samples = price["samples"]["value"].as_f64()?;
    Some([samples, samples * way["rays_per_sample"].as_f64()?])
}

/// A row of the table: the full picture, other ways to it, and what noise costs without the dearest effects.
fn row(name: &str, report: &Value) -> String {
    let ways = array(report, "switches");
    let Some([samples, rays]) = ways.first().and_then(price) else {
        let known = ways.first().is_some_and(|w| !w["fit"].is_null());
        return format!("| {name} |{} | | | |", if known { " not converging" } else { "" });
    };
    let ratio = |way: &Value| price(way).map(|[_, other]| other / rays);
    let of = |kind: &str| -> Vec<(&Value, f64)> {
        ways.iter().filter(|w| text(w, "kind") == kind).filter_map(|w| Some((w, ratio(w)?))).collect()
    };
    let mut others = of("algorithm");
    others.retain(|(_, r)| *r < CHEAPER || *r > DEARER);
    let untold =
        ways.iter().filter(|w| text(w, "kind") == "algorithm" && !w["fit"].is_null() && price(w).is_none());
    let others: Vec<String> = others
        .iter()
        .map(|(w, r)| format!("{} {}", text(w, "name"), digits(*r)))
        .chain(untold.map(|w| format!("{}: not converging", text(w, "name"))))
        .collect();
    let mut shortcuts = of("shortcut");
    shortcuts.retain(|(_, r)| *r < CHEAPER);
    shortcuts.sort_by(|a, b| a.1.total_cmp(&b.1));
    let named = shortcuts.iter().take(NAMED).map(|(w, r)| format!("{} {}", text(w, "gives_up"), digits(*r)));
    let shortcuts = named.collect::<Vec<_>>().join(", ");
    format!("| {name} | {} | {} | {} | {shortcuts} |", digits(samples), digits(rays), others.join(", "))
}

/// Two digits, or all before the point as far as they mean something.
#[expect(clippy::disallowed_methods, reason = "two digits are the same everywhere")]
fn digits(v: f64) -> String {
    if v < 0.995 {
        return format!("{v:.2}");
    }
    if v < 9.95 {
        return format!("{v:.1}");
    }
    let step = 10f64.powf((v.log10().floor() - 1.0).max(0.0));
    format!("{:.0}", (v / step).round() * step)
}

/// Puts the table between its marks.
fn write_table(
    root: &Path,
    arguments: &Arguments,
    scenes: &[(String, String)],
    rows: &[String],
) -> Result<(), String> {
    let path = root.join("README.md");
    let failed = |e: std::io::Error| format!("{}: {e}", path.display());
    let readme = std::fs::read_to_string(&path).map_err(failed)?;
    let place = readme.split_once(BEGIN).and_then(|(before, rest)| Some((before, rest.split_once(END)?.1)));
    let Some((before, after)) = place else {
        return Err(format!("{}: expected a line that begins with {BEGIN}, and {END}", path.display()));
    };
    let from: Vec<String> =
        scenes.iter().map(|(name, text)| format!("{name}.toml {}", content_hash(text))).collect();
    let table = format!(
        "{BEGIN} cargo xtask cost --spp {} --width {}; {} -->\nWhat 1 % of error takes, counted, since seconds are those of \
         one machine:\n\n| scene | samples a pixel | rays a pixel | another way | without |\n|---|---|---|---|---|\n{}\n\n*Another way* and *without* are prices over the full \
         one, in rays to the same noise; without an effect the picture is another one, and the page says by how \
         much.\n{END}",
        arguments.spp,
        arguments.width,
        from.join(", "),
        rows.join("\n")
    );
    std::fs::write(&path, format!("{before}{table}{after}")).map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Prices are told by rays, the dearest effect first, and what makes no difference is not named.
    #[test]
    fn rows_are_ratios_of_rays() {
        let way = |name: &str, kind: &str, gives_up: &str, samples: f64, rays: f64| {
            serde_json::json!({ "name": name, "kind": kind, "gives_up": gives_up, "rays_per_sample": rays,
                "prices": [{ "error": 0.01, "samples": { "value": samples } }] })
        };
        let report = serde_json::json!({ "switches": [
            way("full", "full", "", 1234.0, 8.0),
            way("caustics by photons", "algorithm", "", 100.0, 12.0),
            way("4 light samples", "algorithm", "", 1000.0, 12.0),
            way("split 4 ways", "algorithm", "", 1000.0, 24.0),
            serde_json::json!({ "name": "caustics by paths", "kind": "algorithm", "fit": { "slope": 0.1 }, "prices": [] }),
            serde_json::json!({ "name": "too little", "kind": "algorithm", "fit": null, "prices": [] }),
            way("without mirror", "shortcut", "mirror", 600.0, 8.0),
            way("at most 4 events", "shortcut", "light after 4 events", 1000.0, 4.0),
            way("at most 8 events", "shortcut", "light after 8 events", 1230.0, 8.0),
        ] });
        let expected = "| room | 1200 | 9900 | caustics by photons 0.12, split 4 ways 2.4, caustics by paths: not converging | light after 4 events 0.41, mirror 0.49 |";
        assert_eq!(row("room", &report), expected);
        assert_eq!(row("room", &Value::Null), "| room | | | | |");
    }
}

//! How often soundness is called a fault: verifications with fresh seeds of what was recorded.

use super::{Bench, array, json, println_line, text};

/// Verify sound scenes with fresh seeds, and say how often they are refused.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Scenes [default: all]
    #[arg(value_name = "NAME")]
    scenes: Vec<String>,
    /// Verifications of each scene.
    #[arg(long, value_name = "N", default_value_t = 50)]
    trials: u64,
    /// Runs under test of each.
    #[arg(long, value_name = "N", default_value_t = 2)]
    runs: u32,
    /// Number of the first seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    first: u64,
}

/// Significances that alarms are counted at.
const LEVELS: [f64; 3] = [0.1, 0.01, 0.001];

/// Runs the chore; an error is a message for people.
pub(super) fn run(bench: &Bench, arguments: &Arguments) -> Result<(), String> {
    let suites = bench.suites_of(&arguments.scenes)?;
    let mut trials: Vec<(String, f64, String)> = Vec::new();
    for seed in arguments.first..arguments.first + arguments.trials {
        let mut verify = bench.golden(&["verify", "--json"]);
        verify.args(&suites).args(["--runs", &arguments.runs.to_string(), &format!("--fresh={seed}")]);
        let said = json(&mut verify)?;
        for scene in array(&said, "scenes") {
            let p = scene["p"].as_f64().unwrap_or(0.0);
            let first = array(scene, "findings").first().map_or("", |f| text(f, "statistic"));
            trials.push((text(scene, "name").to_owned(), p, first.to_owned()));
        }
    }
    let n = trials.len();
    for level in LEVELS {
        let alarms = trials.iter().filter(|(_, p, _)| *p < level).count();
        let [low, high] = interval(alarms, n);
        println_line(&format!(
            "at {level}: {alarms} of {n} refused, {:.4} (95 % interval {low:.4} to {high:.4})",
            alarms as f64 / n.max(1) as f64
        ));
    }
    trials.sort_by(|a, b| a.1.total_cmp(&b.1));
    for (name, p, statistic) in trials.iter().take(10) {
        println_line(&format!("  p {p:.1e}  {name}: {statistic}"));
    }
    Ok(())
}

/// Wilson's interval for a share (Journal of the American Statistical Association 22, 1927).
fn interval(hits: usize, n: usize) -> [f64; 2] {
    const Z: f64 = 1.96;
    let (n, p) = (n.max(1) as f64, hits as f64 / n.max(1) as f64);
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let half = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    [(middle - half).max(0.0), middle + half]
}

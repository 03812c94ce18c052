//! `cargo xtask report-plot`: the error over seconds of the report's method and of the default one.
//!
//! In: the release binary and `scenes/hexroom.toml`. Out: `src/guide/img/report-plot.svg`. Both methods
//! render the room with more and more rays, and `compare` measures the error E of each picture against a
//! long render by the default method with another seed. Seconds are the processor's, for the whole run of
//! the program, so that other work on the machine does not count; Linux tells them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Plot the error of --method report and of the default method over their seconds.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Samples per pixel of the reference.
    #[arg(long, default_value_t = 4096)]
    reference: u32,
    /// Samples per pixel of the pictures.
    #[arg(long, value_delimiter = ',', default_value = "1,4,16,64,256")]
    spp: Vec<u32>,
    /// Width and height of the pictures.
    #[arg(long, default_value_t = 128)]
    size: u32,
    /// The program to measure [default: target/release/epsilux, which is built first]
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

/// A picture: samples per pixel, seconds, error.
struct Point {
    spp: u32,
    seconds: f64,
    error: f64,
}

const METHODS: [(&str, &str, &str); 2] =
    [("report", "--method report", "#c2410c"), ("default", "default method", "#1d4ed8")];

/// Runs the chore; an error is a message for people.
pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository");
    let folder = root.join("target/report-plot");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let program = match &arguments.program {
        Some(program) => program.clone(),
        None => {
            output(Command::new(env!("CARGO")).args(["build", "--release"]).current_dir(root))?;
            root.join("target/release/epsilux")
        }
    };
    let render = |name: &str, method: &str, spp: u32, seed: u32| -> Result<PathBuf, String> {
        let image = folder.join(format!("{name}.exr"));
        let size = format!("{0}x{0}", arguments.size);
        let mut command = Command::new(&program);
        command.arg("render").arg(root.join("scenes/hexroom.toml")).arg("-q").arg("-o").arg(&image);
        command.args(["--method", method, "--size", &size, "--spp", &spp.to_string()]);
        command.args(["--seed", &seed.to_string(), "--threads", "1"]);
        output(&mut command).map(|_| image)
    };
    let reference = render("reference", "default", arguments.reference, 1)?;
    let mut curves = Vec::new();
    for (method, ..) in METHODS {
        let mut points = Vec::new();
        for &spp in &arguments.spp {
            // Short runs are repeated, since the system counts in hundredths of a second.
            let (mut runs, begin) = (0, children_seconds()?);
            let (image, seconds) = loop {
                let image = render(&format!("{method}-{spp}"), method, spp, 0)?;
                runs += 1;
                let seconds = children_seconds()? - begin;
                if seconds >= 0.5 || runs >= 10 {
                    break (image, seconds.max(0.01) / f64::from(runs));
                }
            };
            let mut compare = Command::new(&program);
            let said = compare.arg("compare").arg(&image).arg(&reference).arg("--json");
            points.push(Point { spp, seconds, error: number(&output(said)?, "error")? });
        }
        curves.push(points);
    }
    let svg = plot(&curves, arguments);
    let path = root.join("src/guide/img/report-plot.svg");
    std::fs::write(&path, svg).map_err(|e| format!("{}: {e}", path.display()))
}

/// What a command prints. That `compare` finds a difference, and so ends with 1, is no failure.
fn output(command: &mut Command) -> Result<String, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let said = command.output().map_err(|e| format!("{name} could not be started: {e}"))?;
    match said.status.code() {
        Some(0 | 1) => Ok(String::from_utf8_lossy(&said.stdout).into_owned()),
        _ => Err(format!("{name} ended with {}\n{}", said.status, String::from_utf8_lossy(&said.stderr))),
    }
}

/// Processor time of all commands that have ended, seconds.
fn children_seconds() -> Result<f64, String> {
    let path = "/proc/self/stat";
    let text = std::fs::read_to_string(path).map_err(|e| format!("{path}: {e}; this chore needs Linux"))?;
    // The name before it may hold anything; of what follows, numbers 14 and 15 are user and system time
    // of children in hundredths of a second.
    let fields: Vec<&str> = text.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |i: usize| fields.get(i).and_then(|f| f.parse::<f64>().ok());
    match (ticks(13), ticks(14)) {
        (Some(user), Some(system)) => Ok((user + system) / 100.0),
        _ => Err(format!("{path}: found {text:?}, expected at least 17 fields")),
    }
}

/// The first number that JSON has under a key.
fn number(json: &str, key: &str) -> Result<f64, String> {
    let missing = || format!("no number under {key:?} in {json}");
    let (_, rest) = json.split_once(&format!("\"{key}\":")).ok_or_else(missing)?;
    let end = rest.find([',', '}', '\n']).unwrap_or(rest.len());
    rest[..end].trim().parse().map_err(|_| missing())
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 72.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 48.0;
const BOTTOM: f64 = 56.0;

/// Both axes are logarithmic: a straight line downwards with slope -1/2 is noise that halves with four
/// times the time.
#[expect(clippy::disallowed_methods, reason = "the last bit does not matter in a plot")]
fn plot(curves: &[Vec<Point>], arguments: &Arguments) -> String {
    let range = |value: fn(&Point) -> f64| {
        let all = || curves.iter().flatten().map(value);
        (all().fold(f64::INFINITY, f64::min) / 1.4, all().fold(0.0, f64::max) * 1.4)
    };
    let ((t0, t1), (e0, e1)) = (range(|p| p.seconds), range(|p| p.error));
    let x = |t: f64| LEFT + (WIDTH - LEFT - RIGHT) * (t / t0).ln() / (t1 / t0).ln();
    let y = |e: f64| TOP + (HEIGHT - TOP - BOTTOM) * (e1 / e).ln() / (e1 / e0).ln();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"13\" fill=\"#222\">\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n"
    );
    let text = |svg: &mut String, x: f64, y: f64, anchor: &str, more: &str, words: &str| {
        let _ =
            writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {more}>{words}</text>");
    };
    let line = |svg: &mut String, [x1, y1, x2, y2]: [f64; 4], color: &str| {
        let _ =
            writeln!(svg, "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" stroke=\"{color}\" fill=\"none\"/>");
    };
    for decade in -4..5 {
        for digit in [1.0, 2.0, 5.0] {
            let value = digit * 10f64.powi(decade);
            if value > t0 && value < t1 {
                line(&mut svg, [x(value), TOP, x(value), HEIGHT - BOTTOM], "#ddd");
                text(&mut svg, x(value), HEIGHT - BOTTOM + 18.0, "middle", "", &format!("{value}"));
            }
            if value > e0 && value < e1 {
                line(&mut svg, [LEFT, y(value), WIDTH - RIGHT, y(value)], "#ddd");
                let percent = format!("{:.0} %", 100.0 * value);
                text(&mut svg, LEFT - 8.0, y(value) + 4.0, "end", "", &percent);
            }
        }
    }
    let middle = 0.5 * (LEFT + WIDTH - RIGHT);
    let seconds = "processor seconds of the whole run";
    text(&mut svg, middle, HEIGHT - 14.0, "middle", "", seconds);
    let vertical = format!("transform=\"rotate(-90 18 {0})\"", 0.5 * HEIGHT);
    text(&mut svg, 18.0, 0.5 * HEIGHT, "middle", &vertical, "error E");
    let title = format!("The hexagonal room, {0}x{0}; numbers are rays per pixel", arguments.size);
    text(&mut svg, middle, 22.0, "middle", "font-size=\"15\"", &title);
    for (points, (_, name, color)) in curves.iter().zip(METHODS) {
        let path: Vec<_> = points.iter().map(|p| format!("{:.1} {:.1}", x(p.seconds), y(p.error))).collect();
        let _ = writeln!(
            svg,
            "<path d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
            path.join("L")
        );
        let above = name.starts_with("--");
        for p in points {
            let (cx, cy) = (x(p.seconds), y(p.error));
            let _ = writeln!(svg, "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"4\" fill=\"{color}\"/>");
            let (dx, dy, anchor) = if above { (7.0, -7.0, "start") } else { (-7.0, 16.0, "end") };
            text(
                &mut svg,
                cx + dx,
                cy + dy,
                anchor,
                &format!("fill=\"{color}\" font-size=\"12\""),
                &p.spp.to_string(),
            );
        }
        let row = if above { 0.0 } else { 20.0 };
        let (lx, ly) = (WIDTH - RIGHT - 150.0, TOP + 22.0 + row);
        let _ = writeln!(
            svg,
            "<path d=\"M{lx} {0}h24\" stroke=\"{color}\" stroke-width=\"2\" fill=\"none\"/>",
            ly - 4.0
        );
        text(&mut svg, lx + 32.0, ly, "start", "", name);
    }
    svg + "</svg>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers come out of the JSON that the program writes, and their absence is said.
    #[test]
    fn numbers_are_found() {
        let json = "{\"size\": [1], \"rmse\": 1.25e-2\n, \"error\": 0.5}";
        assert_eq!((number(json, "rmse"), number(json, "error")), (Ok(0.0125), Ok(0.5)));
        assert!(number(json, "err").is_err());
    }
}

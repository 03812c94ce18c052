//! `epsilux quote`

use std::fmt::Write as _;

use clap::Args;
use serde::Serialize;

use super::advice::{self, Alternative, AlternativeJson, Other};
use super::algorithm::AlgorithmArgs;
use super::args::{SceneArgs, Size};
use super::console::Console;
use super::failure::Failure;
use super::machine::{ErrorJson, Machine};
use super::schema::to_json;
use super::shortcuts::ShortcutArgs;
use super::signal::Stop;
use super::stated::error_line;
use super::units::{self, show_error, show_range, show_time};
use super::{Code, load, render};
use crate::integrate::RenderOptions;
use crate::pilot::{self as pilots, Asked};
use crate::prepare::{Caustics, CausticsMode, Prepared};
use crate::quote::{EffectShare, Length, Pilot, Quote, RAYS, pilot};
use crate::scene::{Camera, Scene};

/// Errors that are quoted where none is asked for.
const ERRORS: [f64; 5] = [0.10, 0.05, 0.02, 0.01, 0.005];
/// The error that advice is about where none is asked for.
const ADVISED: f64 = 0.01;
/// Rays of the pilot over those that each alternative may take.
const OVER_ALTERNATIVE: u64 = 2;

/// Say what a render will cost before it is made: samples and seconds for an error, and where they go
///
/// Takes the first samples of the render at some of its pixels, for a second or two. Intervals hold in 95 of 100
/// renders; seconds are those of this machine as busy as it is now. Nothing is written.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  epsilux quote scenes/hexroom.toml
      10, 5, 2, 1 and 0.5 %, and which part of the light is to blame
  epsilux quote scenes/hexroom.toml --error 1% --size 400x400 --json")]
pub(super) struct QuoteArgs {
    #[command(flatten)]
    scene: SceneArgs,

    /// The error to quote (1%, 0.5%), as --error of render means it; may repeat [default: 10%, 5%, 2%, 1%, 0.5%]
    #[arg(long, value_name = "E", value_parser = units::share)]
    error: Vec<f64>,

    /// Width and height of the picture in pixels [default: the scene's, else 800 wide in the camera's
    /// aspect, else 800x600]
    #[arg(long, value_name = "WxH", value_parser = units::size)]
    size: Option<Size>,

    /// Camera by name [default: the scene's first]
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,

    #[command(flatten)]
    algorithms: AlgorithmArgs,

    #[command(flatten)]
    shortcuts: ShortcutArgs,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Threads; 0 is one for each core
    #[arg(long, value_name = "N", default_value_t = 0)]
    threads: usize,

    /// Rays that the pilot takes, about; up to four times as many where the quote would not be within 20 %, or not clear
    #[arg(long, value_name = "N", default_value_t = RAYS, value_parser = clap::value_parser!(u64).range(1..))]
    rays: u64,

    /// Print JSON (epsilux.quote/1)
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct QuoteJson<'a> {
    schema: &'static str,
    file: String,
    camera: &'a str,
    size: [u32; 2],
    seed: u64,
    caustics: &'static str,
    pilot: PilotJson,
    seconds_per_sample: f64,
    quotes: Vec<PriceJson>,
    parts: Vec<PartJson>,
    alternatives: Vec<AlternativeJson>,
    advice: Vec<String>,
    machine: Machine,
}

#[derive(Serialize)]
struct PilotJson {
    samples: u32,
    every: u32,
    rays: u64,
    seconds: f64,
    threads: usize,
    error: Option<ErrorJson>,
}

/// What an error costs; nothing but the error where it cannot be foreseen.
#[derive(Serialize)]
pub(super) struct PriceJson {
    error: f64,
    samples: Option<u32>,
    samples_interval: Option<[u32; 2]>,
    seconds: Option<f64>,
    seconds_interval: Option<[f64; 2]>,
}

impl PriceJson {
    pub(super) fn new(error: f64, quote: Option<Quote>) -> Self {
        Self {
            error,
            samples: quote.map(|q| q.samples),
            samples_interval: quote.map(|q| q.samples_interval),
            seconds: quote.map(|q| q.seconds),
            seconds_interval: quote.map(|q| q.seconds_interval),
        }
    }
}

#[derive(Serialize)]
struct PartJson {
    name: &'static str,
    light: f64,
    noise: f64,
    rays: f64,
}

pub(super) fn run(args: &QuoteArgs, console: &Console) -> Result<Code, Failure> {
    let loaded = load::load(&args.scene)?;
    let camera = render::camera(&loaded.scene, args.camera.as_deref())?;
    let stop = Stop::listen();
    let look = |prepared: &Prepared, length: Length| -> Result<Pilot, Failure> {
        let options = RenderOptions { threads: args.threads, ..RenderOptions::passes(0..1) };
        pilot(prepared, &options, length, &stop).map_err(|e| Failure::usage(e.to_string()))
    };
    let asked = args.algorithms.meant();
    let prepared = prepare(&loaded.scene, camera, args, None)?;
    let advised = args.error.last().copied().unwrap_or(ADVISED);
    let pilot = look(&prepared, Length { rays: args.rays, narrow: Some(advised) })?;
    let mut alternatives = Vec::new();
    for other in Other::worth_a_try(&prepared.plan, asked, &pilot) {
        let prepared = prepare(&loaded.scene, camera, args, Some(other))?;
        // The plan has no photons where nothing throws light.
        if !matches!(other, Other::Photons) || prepared.plan.caustics != Caustics::Path {
            let length = Length { rays: args.rays / OVER_ALTERNATIVE, narrow: None };
            let quote = look(&prepared, length)?.quote(advised);
            alternatives.push(Alternative { other, quote });
        }
    }
    if let Some(code) = stop.code() {
        return Ok(code);
    }
    let errors = if args.error.is_empty() { ERRORS.to_vec() } else { args.error.clone() };
    let prices: Vec<(f64, Option<Quote>)> = errors.into_iter().map(|e| (e, pilot.quote(e))).collect();
    let advice = advice::lines(&prepared.plan, &pilot, &alternatives, advised);
    if args.json {
        let part =
            |p: &EffectShare| PartJson { name: p.layer.name(), light: p.light, noise: p.noise, rays: p.rays };
        let json = QuoteJson {
            schema: "epsilux.quote/1",
            file: args.scene.scene.display().to_string(),
            camera: &camera.name,
            size: prepared.size,
            seed: args.seed,
            caustics: prepared.plan.caustics.name(),
            pilot: PilotJson {
                samples: pilot.passes,
                every: pilot.one_in(),
                rays: pilot.rays,
                seconds: pilot.elapsed.as_secs_f64(),
                threads: pilot.threads,
                error: pilot.error.map(|e| ErrorJson::new(&e, &[])),
            },
            seconds_per_sample: pilot.pass_seconds,
            quotes: prices.into_iter().map(|(error, quote)| PriceJson::new(error, quote)).collect(),
            parts: pilot.parts.iter().map(part).collect(),
            alternatives: alternatives.iter().map(|a| a.json(advised)).collect(),
            advice,
            machine: Machine::this(),
        };
        console.result(&to_json(&json)?)?;
    } else {
        let [width, height] = prepared.size;
        let mut text = format!("{}, camera {}, {width}x{height}\n", args.scene.scene.display(), camera.name);
        write_pilot(&mut text, &pilot);
        write_prices(&mut text, &prices);
        write_parts(&mut text, &pilot.parts);
        text.push('\n');
        advice.iter().for_each(|line| text += &format!("{line}\n"));
        console.result(&text)?;
    }
    Ok(Code::Done)
}

fn prepare(
    scene: &Scene,
    camera: &Camera,
    args: &QuoteArgs,
    instead: Option<Other>,
) -> Result<Prepared, Failure> {
    let job = render::Job::new(&args.scene.scene.display().to_string(), scene, camera, {
        render::picture_size(scene, camera, args.size)
    });
    let mut options = job.prepare;
    options.seed = args.seed;
    options.algorithms = args.algorithms.meant();
    args.shortcuts.take(&mut options);
    match instead {
        Some(Other::Photons) => options.algorithms.caustics = CausticsMode::Photon,
        Some(Other::Without(omission, _)) => options.shortcuts.without.insert(omission),
        None => {}
    }
    let asked = Asked { threads: args.threads, ..Asked::default() };
    pilots::prepare(scene, &options, &asked)
        .map_err(|e| Failure::load(format!("{}: {e}", args.scene.scene.display())))
}

fn write_pilot(text: &mut String, pilot: &Pilot) {
    let where_ = match pilot.one_in() {
        1 => "of each pixel".to_owned(),
        n => format!("of one pixel in {n}"),
    };
    let seconds = show_time(pilot.elapsed.as_secs_f64());
    let _ =
        writeln!(text, "pilot: {} samples {where_} in {seconds} on {} threads", pilot.passes, pilot.threads);
    match pilot.error.as_ref().map(|e| error_line(e, &[])) {
        Some(line) => text.push_str(&format!("       {line}\n")),
        None => text.push_str("       the picture is black, or its error cannot be estimated\n"),
    }
}

fn write_prices(text: &mut String, prices: &[(f64, Option<Quote>)]) {
    let _ = writeln!(text, "\n{:>7}  {:>28}  {:>32}", "error", "samples per pixel", "time");
    for (error, quote) in prices {
        let error = show_error(*error);
        let _ = match quote {
            None => writeln!(text, "{error:>7}  {:>28}  {:>32}", "not known", "not known"),
            Some(q) => {
                let [low, high] = q.samples_interval;
                let samples = format!("{} ({low} to {high})", q.samples);
                let [soon, late] = q.seconds_interval;
                let time = format!("{} ({})", show_time(q.seconds), show_range([soon, late]));
                writeln!(text, "{error:>7}  {samples:>28}  {time:>32}")
            }
        };
    }
}

fn write_parts(text: &mut String, parts: &[EffectShare]) {
    let _ = writeln!(text, "\n{:<10} {:>7} {:>7} {:>7}", "part", "light", "noise", "rays");
    let percent = |share: f64| format!("{:.1} %", 100.0 * share.max(0.0));
    for p in parts.iter().filter(|p| p.light > 0.0 || p.rays > 0.0) {
        let (light, noise, rays) = (percent(p.light), percent(p.noise), percent(p.rays));
        let _ = writeln!(text, "{:<10} {light:>7} {noise:>7} {rays:>7}", p.layer.name());
    }
}

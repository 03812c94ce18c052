//! What a render says of itself: what the picture is of, the report beside it, and the lines on the screen.

use std::ffi::OsString;

use super::Code;
use super::adopt::{choices, flags};
use super::args::Method;
use super::console::Console;
use super::explain::{self, Record};
use super::failure::Failure;
use super::forecast::Quoted;
use super::machine::{ErrorJson, Machine, RefusedJson, Report, Seconds, command_line, report_path};
use super::notes;
use super::render::Job;
use super::schema::{to_json, to_json_line};
use super::shortcuts::PricedJson;
use super::stated::Stated;
use super::units::{show_share, show_time};
use crate::film::{Doubt, Image, Refusal};
use crate::integrate::report::Slips;
use crate::integrate::{BadSample, Counters, Outcome};
use crate::output;
use crate::part::Identity;
use crate::pilot;
use crate::prepare::{Caustics, Plan};
use crate::price::Priced;
use crate::scene::Note;

/// What a method made.
pub(super) struct Rendered {
    pub(super) image: Image,
    pub(super) stated: Stated,
    pub(super) plan: Plan,
    /// What its shortcuts cost.
    pub(super) prices: Vec<Priced>,
    /// Passes that this run added.
    pub(super) added: u32,
    /// Whether the error that was asked for is reached.
    pub(super) reached: bool,
    pub(super) threads: usize,
    pub(super) counters: Option<Counters>,
    pub(super) refused: u64,
    pub(super) bad: Vec<BadSample>,
    /// What was foreseen of it.
    pub(super) quoted: Option<Quoted>,
}

impl Rendered {
    /// From a render whose film held the passes from `first` on before.
    pub(super) fn new(
        outcome: Outcome,
        first: u32,
        plan: Plan,
        lights: &[String],
        prices: Vec<Priced>,
    ) -> Self {
        Self {
            image: outcome.film.to_image(),
            stated: Stated::of_outcome(&outcome, first, lights),
            plan,
            prices,
            added: outcome.passes.end - outcome.passes.start,
            reached: outcome.reached,
            threads: outcome.threads,
            counters: Some(outcome.counters),
            refused: outcome.film.refused_total(),
            bad: outcome.bad,
            quoted: None,
        }
    }
}

impl Job {
    /// What the picture is of: all that samples depend on. The kernel is not among it, since it never changes the
    /// picture.
    pub(super) fn identity(
        &self,
        plan: &Plan,
        lights: &[String],
        hash: &str,
        prices: &[Priced],
    ) -> Result<Identity, Failure> {
        let effects = plan.needs.iter().map(|n| n.effect.name()).collect::<Vec<_>>().join(", ");
        let mut list = vec![
            ("software", software()),
            ("scene_sha256", hash.to_owned()),
            ("camera", self.camera.clone()),
            ("method", self.method_name().to_owned()),
            ("seed", self.prepare.seed.to_string()),
            ("max_depth", self.prepare.max_depth.map_or("none".to_owned(), |d| d.to_string())),
            ("effects", effects),
        ];
        if self.method == Method::Default {
            list.extend(choices(plan));
        }
        if self.method != Method::Reference {
            list.push(("replications", plan.replications.to_string()));
        }
        if self.method == Method::Report && self.slips != Slips::NONE {
            list.push(("slips", self.slips.names().join(", ")));
        }
        if !prices.is_empty() {
            let prices: Vec<_> = prices.iter().map(PricedJson::of_picture).collect();
            list.push(("shortcuts", to_json_line(&prices)?));
        }
        if self.method == Method::Default {
            let Record { json, sha256 } = explain::record(plan)?;
            list.extend([("plan", json), ("plan_sha256", sha256), ("lights", to_json_line(lights)?)]);
        }
        Ok(Identity(list.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()))
    }

    pub(super) fn method_name(&self) -> &'static str {
        match self.method {
            Method::Default => "default",
            Method::Reference => "reference",
            Method::Report => "report",
        }
    }

    pub(super) fn report<'a>(
        &'a self,
        rendered: &'a Rendered,
        hash: &'a str,
        seconds: Seconds,
        stopped_by_signal: bool,
        notes: &'a [Note],
        arguments: &[OsString],
    ) -> Result<Report<'a>, Failure> {
        let rays = rendered.counters.map(|c| c.rays);
        let refused =
            |b: &BadSample| RefusedJson { pixel: b.pixel, pass: b.pass, reason: reason(b.reason).into() };
        Ok(Report {
            schema: "epsilux.report/1",
            software: software(),
            command: command_line(arguments),
            scene: &self.scene_name,
            scene_sha256: hash,
            outputs: self.outputs.iter().map(|p| p.display().to_string()).collect(),
            method: self.method_name(),
            camera: &self.camera,
            size: self.prepare.size,
            seed: self.prepare.seed,
            passes: rendered.stated.passes.first().map_or([0, 0], |r| [r.start, r.end]),
            partial: rendered.stated.partial,
            error: rendered.stated.error.map(|e| ErrorJson::new(&e, &rendered.stated.lights)),
            quoted: rendered.quoted,
            stopped_by_signal,
            seconds,
            threads: rendered.threads,
            rays,
            rays_per_second: rays.map(|r| r as f64 / seconds.render.max(1e-9)),
            samples_refused: rendered.refused,
            refused: rendered.bad.iter().map(refused).collect(),
            paths_cut: rendered.counters.map_or(0, |c| c.capped),
            shortcuts: rendered.prices.iter().map(PricedJson::of_run).collect(),
            plan: (&rendered.plan).into(),
            plan_sha256: explain::record(&rendered.plan)?.sha256,
            notes: notes::json(notes),
            machine: Machine::this(),
        })
    }

    /// One report for each name: `a.png` and `a.exr` share theirs.
    pub(super) fn write_report(&self, report: &Report<'_>) -> Result<(), Failure> {
        let text = to_json(report)? + "\n";
        let mut paths: Vec<_> = self.outputs.iter().map(|p| report_path(p)).collect();
        paths.sort();
        paths.dedup();
        paths.iter().try_for_each(|path| {
            output::write_bytes(path, text.as_bytes())
                .map_err(|e| Failure::write(format!("{}: cannot write: {e}", path.display())))
        })
    }

    pub(super) fn summarise(
        &self,
        rendered: &Rendered,
        seconds: Seconds,
        stopped: Option<Code>,
        console: &Console,
    ) {
        let samples = rendered.added;
        let all: u32 = rendered.stated.passes.iter().map(|r| r.end - r.start).sum();
        let mut line = format!("{} per pixel in {}", many(samples, "sample"), show_time(seconds.render));
        if let Some(c) = rendered.counters {
            let mrays = c.rays as f64 / seconds.render.max(1e-9) / 1e6;
            line += &format!(", {mrays:.2} Mrays/s on {}", many(rendered.threads as u64, "thread"));
        }
        console.message(&line);
        if all != samples {
            console.message(&format!("{} per pixel with those of the checkpoint", many(all, "sample")));
        }
        if let Some(mut line) = rendered.stated.error_line() {
            if let Some(target) = self.error.filter(|_| !rendered.reached) {
                line += &format!("; {} was asked for", show_share(target));
            }
            console.message(&line);
        }
        let doubt = rendered.stated.error.and_then(|e| e.doubt);
        if matches!(doubt, Some(Doubt::LightNotFound { caustic: true, .. }))
            && rendered.plan.caustics == Caustics::Path
        {
            console.message("help: --algorithm caustics=photon finds it");
        }
        if let Some(quoted) = rendered.quoted.filter(|_| rendered.reached) {
            console.message(&quoted.beside(seconds.render));
        }
        if rendered.stated.partial {
            console.message("note: not one sample of every pixel is done; the picture is partial");
        } else if self.first + all != self.passes {
            // With so many samples, or without an error, a pilot might choose otherwise.
            let piloted = rendered.plan.choices.iter().any(|c| c.about == "pilot");
            let other = piloted && (all < pilot::LEAST_SAMPLES || self.error.is_some());
            let flags = if other { flags(&rendered.plan) } else { String::new() };
            console.message(&format!("--spp {all}{flags} repeats this picture"));
        }
        if stopped.is_some() {
            console.message("stopped by a signal; what was done is saved");
        }
        if let Some(bad) = rendered.bad.first() {
            let [x, y] = bad.pixel;
            let why = reason(bad.reason);
            let n = many(rendered.refused, "sample");
            console.message(&format!(
                "note: {n} refused, the first at pixel {x},{y} in pass {pass}: {why}; --replay {x},{y},{pass} traces \
                 it alone",
                pass = bad.pass
            ));
        }
        if let Some(cut) = rendered.counters.map(|c| c.capped).filter(|&n| n > 0) {
            console.message(&format!("note: {} cut by the safety cap on length", many(cut, "path")));
        }
    }
}

/// A number of things.
fn many(n: impl Into<u64>, thing: &str) -> String {
    match n.into() {
        1 => format!("1 {thing}"),
        n => format!("{n} {thing}s"),
    }
}

fn software() -> String {
    format!("epsilux {}", env!("CARGO_PKG_VERSION"))
}

fn reason(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::NotANumber => "not a number",
        Refusal::Overflow => "infinite, or too large",
        Refusal::Negative => "negative",
    }
}

//! Renders whose time and error are measured.

use super::measure::Observer;
use crate::film::{ErrorEstimate, Film, Image};
use crate::integrate::{Control, Counters, Progress, RenderOptions, RunError, layout, render_onto};
use crate::prepare::Prepared;
use crate::quote::{self, Length, Pilot};
use crate::stats;

/// How far the whole measurement is, in units of work that were estimated beforehand.
pub(super) struct Work<'a> {
    pub(super) observer: &'a dyn Observer,
    pub(super) threads: usize,
    pub(super) total: f64,
    pub(super) done: f64,
    pub(super) doing: String,
}

/// Passes on how far one render is.
struct Step<'a> {
    work: &'a Work<'a>,
    span: f64,
}

impl Control for Step<'_> {
    fn progress(&self, progress: &Progress) {
        let done = self.work.done + self.span * progress.share();
        self.work.observer.progress((done / self.work.total.max(1e-9)).min(1.0), &self.work.doing);
    }

    fn cancelled(&self) -> bool {
        self.work.observer.cancelled()
    }
}

/// What a render that was measured gave.
pub(super) struct Run {
    /// Luminance after each number of samples.
    pub(super) luminance: Vec<Vec<f64>>,
    /// What the picture says of its own error, after each.
    pub(super) stated: Vec<Option<ErrorEstimate>>,
    /// Processor time of all of it.
    pub(super) seconds: f64,
    pub(super) rays: u64,
}

/// What a render gave.
pub(super) struct Rendered {
    pub(super) film: Film,
    /// Processor time.
    pub(super) seconds: f64,
    pub(super) counters: Counters,
}

impl Work<'_> {
    /// Renders up to the last of some ascending numbers of samples, and looks at the picture at each; `unit` is the
    /// work of a pass.
    pub(super) fn run(&mut self, prepared: &Prepared, levels: &[u32], unit: f64) -> Result<Run, RunError> {
        let mut run = Run { luminance: Vec::new(), stated: Vec::new(), seconds: 0.0, rays: 0 };
        let mut options = RenderOptions { threads: self.threads, ..RenderOptions::passes(0..0) };
        let mut film = Film::new(layout(prepared, &options));
        for &level in levels {
            options.passes = options.passes.end..level;
            let next = self.step(prepared, film, &options, unit)?;
            film = next.film;
            run.seconds += next.seconds;
            run.rays += next.counters.rays;
            run.luminance.push(luminance(&film.to_image()));
            run.stated.push(film.error());
        }
        Ok(run)
    }

    /// Renders so many passes; where `layers`, with the parts of the light and their noise.
    pub(super) fn film(
        &mut self,
        prepared: &Prepared,
        passes: u32,
        layers: bool,
        unit: f64,
    ) -> Result<Rendered, RunError> {
        let options = RenderOptions {
            threads: self.threads,
            layers,
            layer_noise: layers,
            ..RenderOptions::passes(0..passes)
        };
        self.step(prepared, Film::new(layout(prepared, &options)), &options, unit)
    }

    /// The pilot of a quote that takes about so many rays.
    pub(super) fn pilot(&self, prepared: &Prepared, rays: u64) -> Result<Pilot, RunError> {
        let options = RenderOptions { threads: self.threads, ..RenderOptions::passes(0..0) };
        let length = Length { rays, narrow: None };
        let pilot = quote::pilot(prepared, &options, length, &Step { work: self, span: 0.0 })?;
        if self.observer.cancelled() { Err(RunError::Cancelled) } else { Ok(pilot) }
    }

    fn step(
        &mut self,
        prepared: &Prepared,
        film: Film,
        options: &RenderOptions,
        unit: f64,
    ) -> Result<Rendered, RunError> {
        let span = unit * f64::from(options.passes.end - options.passes.start);
        let begin = self.observer.seconds();
        let outcome = render_onto(prepared, film, options, &Step { work: self, span })?;
        let seconds = self.observer.seconds() - begin;
        self.done += span;
        if outcome.cancelled {
            return Err(RunError::Cancelled);
        }
        Ok(Rendered { film: outcome.film, seconds, counters: outcome.counters })
    }
}

/// Luminance of each pixel, as the error has it.
pub(super) fn luminance(image: &Image) -> Vec<f64> {
    image.rgb.iter().map(|&c| stats::luminance(c)).collect()
}

//! The decisions of a pilot, one after the other: caustics first, since what they cost decides what else pays.

use super::caustics::{Bias, least_variance};
use super::judge::{Gain, Several, WORTH, mean, relative};
use super::trial::{Trial, WIDTHS, narrowed};
use super::{LEAST_SAMPLES, PASSES, Pilot, percent, times};
use crate::integrate::photons;
use crate::prepare::{Algorithms, CausticsMode, MOST_BRANCHES, PrepareError, ROULETTE_START};

/// The least error that a photon map's bias is held against where none is asked for.
const LEAST_ERROR: f64 = 0.01;

/// Share of the error that the bias of a photon map may be.
const SHARE_OF_BIAS: f64 = 0.25;

/// Samples of a part that are tried.
const SEVERAL: u32 = 4;

/// Other events that roulette may start from.
const ROULETTE_STARTS: [u32; 2] = [2, 8];

/// Splitting is not tried where fewer samples see a mirror or clear glass first.
const LEAST_THROUGH: f64 = 0.01;

/// More samples than any render is expected to take.
const MOST_SAMPLES: u32 = 1 << 20;

/// Rays of the photons that show a map's bias, at most: about a second.
const MOST_RAYS_OF_PHOTONS: f64 = 4e6;

/// Work of trying all changes once more, in trials without them.
const AGAIN: f64 = 3.0;

/// A way to find caustics that was tried.
struct Candidate {
    algorithms: Algorithms,
    name: &'static str,
    trial: Trial,
    /// Its relative variance, and whether that is a bound rather than what was seen.
    variance: f64,
    bounded: bool,
}

impl Candidate {
    /// Of a trial in which paths should have met the caustics `light`.
    fn new(algorithms: Algorithms, name: &'static str, trial: Trial, light: &[f64], weights: &[f64]) -> Self {
        let seen = mean(&relative(&trial.all, weights));
        let least = least_variance(&trial, light, weights);
        Self { algorithms, name, trial, variance: seen.max(least), bounded: least > seen }
    }

    fn work(&self) -> f64 {
        self.variance * self.trial.rays
    }

    /// Work of another one over that of this one.
    fn gain_over(&self, other: &Self) -> f64 {
        if self.work() > 0.0 { other.work() / self.work() } else { 1.0 }
    }

    /// Whether it is to be preferred to another one.
    fn beats(&self, other: &Self, weights: &[f64]) -> bool {
        self.gain_over(other) > WORTH
            && (other.bounded || Gain::new(&other.trial, &self.trial, weights).is_sure())
    }
}

/// A change that a trial promises to gain something.
struct Promise {
    about: &'static str,
    chosen: String,
    /// What is chosen where the promise is not kept.
    otherwise: String,
    gain: f64,
    /// What it makes of the rays of a pass, as a factor.
    rays: f64,
}

/// Something of which there may be several.
#[derive(Clone, Copy)]
struct More {
    about: &'static str,
    /// What one is called, and two.
    otherwise: &'static str,
    two: &'static str,
    /// Work of a trial of two, at most, in trials of one.
    trials: f64,
    /// Asks for so many, and says it.
    set: fn(&mut Algorithms, u32),
    words: fn(u32) -> String,
}

impl Pilot<'_> {
    /// Decides how caustics are found, and gives the trial by what is chosen.
    pub(super) fn caustics(&mut self) -> Result<Trial, PrepareError> {
        let unbiased = self.chosen.unbiased;
        let path = self.chosen;
        let traced = Algorithms { caustics: CausticsMode::Photon, unbiased: true, ..path };
        let photon = Algorithms { caustics: CausticsMode::Photon, ..path };
        let open = self.options.algorithms.caustics == CausticsMode::Auto && self.throws;
        let forced = open && !self.plan_by(path)?.unseen.is_empty();
        if !open || forced {
            // Nothing is to be decided, or photons are all that finds the light.
            self.chosen = if forced { photon } else { path };
            let trial = self.try_out(self.chosen, 0)?;
            self.take(&trial);
            if forced
                && !unbiased
                && let Some(weights) = self.truth.weights()
            {
                let bias = self.bias(&trial, &weights)?;
                let known = self.plan_by(self.options.algorithms)?;
                if let Some(choice) = known.choices.into_iter().find(|c| c.about == "caustics") {
                    self.decide("caustics", choice.chosen, format!("{}; {}", choice.reason, bias.said));
                }
            }
            return Ok(trial);
        }

        let paths = self.try_out(path, 0)?;
        self.take(&paths);
        let tracing = self.try_out(traced, 0)?;
        let photons = if unbiased { None } else { Some(self.try_out(photon, 0)?) };
        let Some(weights) = self.truth.weights() else { return Ok(paths) };
        // The caustics that there are, and those that light tracing leaves to paths.
        let none = vec![0.0; paths.pixels()];
        let (all, left) = match &photons {
            Some(p) => ((0..p.pixels()).map(|i| p.caustics(i)).collect(), p.met.clone()),
            None => (tracing.thrown.clone(), none.clone()),
        };
        let paths = Candidate::new(path, "paths", paths, &all, &weights);
        let tracing = Candidate::new(traced, "light tracing", tracing, &left, &weights);
        let photons = photons.map(|trial| Candidate::new(photon, "photons", trial, &none, &weights));
        let least = if paths.bounded { "at least " } else { "" };
        let gain = times(tracing.gain_over(&paths));
        let mut reason =
            format!("for the same error paths take {least}{gain} times the work of light tracing");
        if let Some(photons) = &photons {
            reason += &format!(", {} times that of photons", times(photons.gain_over(&paths)));
        }
        let mut best = 0;
        let mut candidates = vec![paths, tracing];
        candidates.extend(photons);
        for i in 1..candidates.len() {
            if !candidates[i].beats(&candidates[best], &weights) {
                continue;
            }
            // Of the candidates only photons have a map, which is off a little.
            if i == 2 {
                let bias = self.bias(&candidates[2].trial, &weights)?;
                reason += &format!("; {}", bias.said);
                if !bias.fits {
                    continue;
                }
            }
            best = i;
        }
        let pass = candidates[best].trial.rays / candidates[0].trial.rays;
        if best > 0 {
            reason += &format!("; a pass takes {} times the work", times(pass));
        }
        let best = candidates.swap_remove(best);
        self.chosen = best.algorithms;
        self.take(&best.trial);
        self.decide("caustics", best.name, reason);
        Ok(best.trial)
    }

    /// Whether the bias of a photon map, with which `trial` was made, is small beside the error that is asked for.
    fn bias(&mut self, trial: &Trial, weights: &[f64]) -> Result<Verdict, PrepareError> {
        // Of one sample by this map.
        let variance = mean(&relative(&trial.all, weights)) * f64::from(trial.passes);
        let Limit { limit, said: held_against } = Limit::new(self.asked.error, variance);
        // As many photons as there are in a pass, or as what is left of the pilot's share allows.
        let paths = trial.rays * f64::from(PASSES) * (WIDTHS.len() + 2) as f64;
        let least = trial.pixels() as f64;
        let of_photons = f64::from(PASSES) * trial.rays_of_photon;
        let room = (self.left() - paths).min(MOST_RAYS_OF_PHOTONS) / of_photons;
        if room < least {
            return Ok(Verdict {
                fits: false,
                said: "the pilot has no room to see how far the map is off".into(),
            });
        }
        let photons = room.min(f64::from(photons(self.pixels()))) as u32;
        // How long the render will be.
        let samples = match self.asked.error {
            None => LEAST_SAMPLES,
            Some(error) => {
                let most = self.asked.samples.unwrap_or(MOST_SAMPLES).min(MOST_SAMPLES);
                ((variance / (error * error)) as u32).clamp(LEAST_SAMPLES, most.max(LEAST_SAMPLES))
            }
        };
        let algorithms = Algorithms { caustics: CausticsMode::Photon, ..self.chosen };
        self.ready(algorithms, 0)?;
        let pixel = (trial.pixels() as f64 / self.pixels() as f64).sqrt() as f32;
        let (narrowed, spent) = narrowed(&self.prepared, PASSES, photons, pixel);
        self.spent += spent;
        self.trials += WIDTHS.len() as u32;
        let found = Bias::new(&narrowed, weights, samples);
        // A figure that noise may have made says nothing.
        let fits = found.estimate <= limit && found.most <= 2.0 * limit;
        let verdict = if fits {
            "within"
        } else if found.estimate <= limit {
            "too unsure for"
        } else {
            "above"
        };
        let said = format!(
            "the map is off by {}, at most {}, {verdict} the {} allowed, {held_against}",
            percent(found.estimate),
            percent(found.most),
            percent(limit)
        );
        Ok(Verdict { fits, said })
    }

    /// Decides everything but caustics; `base` is a trial of what is chosen so far.
    pub(super) fn others(&mut self, base: &Trial) -> Result<(), PrepareError> {
        let mut wanted = self.chosen;
        let mut promises = Vec::new();
        promises.extend(self.light_samples(base, &mut wanted)?);
        promises.extend(self.splitting(base, &mut wanted)?);
        promises.extend(self.roulette(base, &mut wanted)?);
        if promises.is_empty() {
            return Ok(());
        }
        let rays: f64 = promises.iter().map(|p| p.rays).product();
        if !self.affords(base, 1.0 + rays) {
            for Promise { about, otherwise, .. } in promises {
                self.decide(about, otherwise, NOT_TRIED);
            }
            return Ok(());
        }
        // All of them together, with other numbers.
        let (before, after) = (self.try_out(self.chosen, 1)?, self.try_out(wanted, 1)?);
        let Some(weights) = self.truth.weights() else { return Ok(()) };
        let gain = Gain::new(&before, &after, &weights);
        let kept = gain.bears_out();
        for Promise { about, chosen, otherwise, gain: promised, .. } in promises {
            let (promised, all) = (times(promised), times(gain.factor));
            if kept {
                let reason = format!(
                    "{promised} times less work for the same error; all changes, tried again: {all} times"
                );
                self.decide(about, chosen, reason);
            } else {
                let reason = format!(
                    "{chosen} promised {promised} times less work; all changes, tried again, gave {all} times"
                );
                self.decide(about, otherwise, reason);
            }
        }
        if kept {
            self.chosen = wanted;
            self.take(&after);
        }
        Ok(())
    }

    fn light_samples(
        &mut self,
        base: &Trial,
        wanted: &mut Algorithms,
    ) -> Result<Option<Promise>, PrepareError> {
        if self.options.algorithms.light_samples.is_some() {
            return Ok(None);
        }
        const ABOUT: &str = "light samples";
        if self.prepared.lights.emitters().is_empty() {
            self.decide(ABOUT, "1", "there is no light");
            return Ok(None);
        }
        let more = More {
            about: ABOUT,
            otherwise: "1",
            two: "two",
            trials: 1.0,
            set: |algorithms, n| algorithms.light_samples = Some(n),
            words: |n| n.to_string(),
        };
        self.more(base, wanted, &more)
    }

    fn splitting(&mut self, base: &Trial, wanted: &mut Algorithms) -> Result<Option<Promise>, PrepareError> {
        if self.options.algorithms.split.is_some() || base.through == 0.0 {
            return Ok(None);
        }
        const ABOUT: &str = "splitting";
        if base.through < LEAST_THROUGH {
            let share = percent(base.through);
            self.decide(
                ABOUT,
                "none",
                format!("{share} of the samples see light in a mirror or through clear glass"),
            );
            return Ok(None);
        }
        let more = More {
            about: ABOUT,
            otherwise: "none",
            two: "two ways",
            trials: 2.0,
            set: |algorithms, n| algorithms.split = Some(n),
            words: |n| format!("{n} ways"),
        };
        self.more(base, wanted, &more)
    }

    /// Tries several of something instead of one, and promises what as many as pay would gain.
    fn more(
        &mut self,
        base: &Trial,
        wanted: &mut Algorithms,
        more: &More,
    ) -> Result<Option<Promise>, PrepareError> {
        let More { about, otherwise, two, trials, set, words } = *more;
        if !self.affords(base, trials + AGAIN) {
            self.decide(about, otherwise, NOT_TRIED);
            return Ok(None);
        }
        let mut algorithms = self.chosen;
        set(&mut algorithms, SEVERAL);
        let trial = self.try_out(algorithms, 0)?;
        let Some(weights) = self.truth.weights() else { return Ok(None) };
        let found = Several::new(base, &trial, SEVERAL, MOST_BRANCHES, &weights);
        if !found.is_worth() {
            self.decide(about, otherwise, found.not_worth(two));
            return Ok(None);
        }
        set(wanted, found.count);
        let (chosen, otherwise) = (words(found.count), otherwise.into());
        Ok(Some(Promise { about, chosen, otherwise, gain: found.gain, rays: found.rays }))
    }

    fn roulette(&mut self, base: &Trial, wanted: &mut Algorithms) -> Result<Option<Promise>, PrepareError> {
        if self.options.algorithms.roulette.is_some() {
            return Ok(None);
        }
        const ABOUT: &str = "roulette";
        let from = |event: u32| format!("from event {event}");
        let usual = from(ROULETTE_START);
        let mut best: Option<(u32, f64, f64)> = None;
        let mut said = Vec::new();
        for start in ROULETTE_STARTS {
            if !self.affords(base, 1.0 + AGAIN) {
                continue;
            }
            let trial = self.try_out(Algorithms { roulette: Some(start), ..self.chosen }, 0)?;
            let Some(weights) = self.truth.weights() else { return Ok(None) };
            let gain = Gain::new(base, &trial, &weights);
            said.push(format!("{} {}", from(start), times(1.0 / gain.factor)));
            if gain.is_sure() && best.is_none_or(|(_, known, _)| gain.factor > known) {
                best = Some((start, gain.factor, trial.rays / base.rays));
            }
        }
        if let Some((start, gain, rays)) = best {
            wanted.roulette = Some(start);
            return Ok(Some(Promise { about: ABOUT, chosen: from(start), otherwise: usual, gain, rays }));
        }
        let reason = match said.len() {
            0 => NOT_TRIED.to_owned(),
            _ => format!("{} times the work for the same error", said.join(", ")),
        };
        self.decide(ABOUT, usual, reason);
        Ok(None)
    }
}

impl Several {
    /// Why one is enough; `two` is what two would be.
    fn not_worth(&self, two: &str) -> String {
        if self.gain_of_two >= 1.0 {
            format!(
                "{two} would gain less than a tenth, or not surely: {} times less work",
                times(self.gain_of_two)
            )
        } else {
            format!("{two} would take {} times the work for the same error", times(1.0 / self.gain_of_two))
        }
    }
}

/// What the bias of a photon map may be.
struct Limit {
    limit: f64,
    /// Of what it is a share.
    said: String,
}

impl Limit {
    /// Of the error that is asked for, or else of that of the fewest samples for which a pilot runs: a map is refused
    /// for its bias only where that would be seen in the picture. More samples than those change nothing, or a picture
    /// and its parts would not have one plan. `variance` is that of one sample.
    fn new(asked: Option<f64>, variance: f64) -> Self {
        let noise = (variance / f64::from(LEAST_SAMPLES)).sqrt();
        let said = match asked {
            Some(error) => format!("a quarter of the error asked for, {}", percent(error)),
            None if noise > LEAST_ERROR => {
                format!("a quarter of the error of {LEAST_SAMPLES} samples, {}", percent(noise))
            }
            None => format!(
                "a quarter of {}, since the error of {LEAST_SAMPLES} samples, {}, is not above that",
                percent(LEAST_ERROR),
                percent(noise)
            ),
        };
        Self { limit: SHARE_OF_BIAS * asked.unwrap_or(noise.max(LEAST_ERROR)), said }
    }
}

/// Whether a photon map will do, and why.
struct Verdict {
    fits: bool,
    said: String,
}

/// Why something is as it is without a pilot.
const NOT_TRIED: &str = "not tried: the pilot has taken its share";

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards what bias is held against: the error asked for, else that of 64 samples, but 1 % at least.
    #[test]
    fn bias_may_be_a_quarter_of_the_error() {
        let of = |asked, noise: f64| Limit::new(asked, noise * noise * f64::from(LEAST_SAMPLES));
        for (asked, noise, limit, said) in [
            (Some(0.02), 0.3, 0.005, "a quarter of the error asked for, 2.0 %"),
            (None, 0.04, 0.01, "a quarter of the error of 64 samples, 4.0 %"),
            (
                None,
                0.004,
                0.0025,
                "a quarter of 1.0 %, since the error of 64 samples, 0.40 %, is not above that",
            ),
        ] {
            let found = of(asked, noise);
            assert!(
                (found.limit - limit).abs() < 1e-12 && found.said == said,
                "{} {}",
                found.limit,
                found.said
            );
        }
    }
}

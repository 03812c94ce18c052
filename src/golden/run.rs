//! One run: a render of a scene with a seed of its own, and the numbers that gates look at.

use super::suite::Settings;
use crate::film::{Film, Image, LightLayer};
use crate::integrate::{self, BadSample, Control, RenderOptions, RunError};
use crate::math::{fnv1a, mix64};
use crate::prepare::{self, EffectsMode};
use crate::scene::Scene;
use crate::stats::gate::{Planes, Profile, floor};
use crate::stats::slope;

/// A scene, and how it is rendered.
#[derive(Clone, Debug)]
pub struct Subject {
    /// A valid scene with light and camera.
    pub scene: Scene,
    /// How.
    pub settings: Settings,
}

/// What a seed is for: runs under test, pilots and null runs share none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Chooses statistics and weights.
    Pilot,
    /// Says what statistics do when nothing is wrong.
    Null,
    /// Renders with the reference integrator.
    Truth,
    /// Is judged; the number tells fresh seeds apart, and is zero for the fixed ones.
    Test(u64),
}

/// The seed of run `i` of a scene: a function of its name, so that nobody picks one that passes.
#[must_use]
pub fn seed(name: &str, role: Role, i: u32) -> u64 {
    let (tag, fresh) = match role {
        Role::Pilot => ("pilot", 0),
        Role::Null => ("null", 0),
        Role::Truth => ("truth", 0),
        Role::Test(fresh) => ("test", fresh),
    };
    let hash = fnv1a(name.bytes().chain([0]).chain(tag.bytes()));
    mix64(mix64(hash ^ fresh).wrapping_add(u64::from(i)))
}

/// A finished run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Its seed.
    pub seed: u64,
    /// Mean, variance, count and light layers.
    pub image: Image,
    /// Luminance after an eighth, a quarter, half and all of the samples, with that number of samples.
    pub stages: Vec<(u32, Vec<f32>)>,
    /// Samples that the film refused.
    pub refused: u64,
    /// Some of them.
    pub bad: Vec<BadSample>,
    /// Paths that were cut by the far cap.
    pub capped: u64,
    /// Rays traced.
    pub rays: u64,
}

impl Subject {
    /// Renders the scene with a seed.
    ///
    /// # Errors
    /// The scene cannot be rendered, or `control` cancels.
    pub fn run(&self, seed: u64, control: &dyn Control) -> Result<Run, RunError> {
        let prepared = prepare::prepare(&self.scene, &self.options(seed))?;
        let spp = self.settings.spp;
        let mut whole: Option<Film> = None;
        let (mut stages, mut bad, mut capped, mut rays) = (Vec::new(), Vec::new(), 0, 0);
        let mut begin = 0;
        for end in [spp / 8, spp / 4, spp / 2, spp] {
            let options = RenderOptions { layers: true, ..RenderOptions::passes(begin..end) };
            let outcome = integrate::render(&prepared, &options, control)?;
            if outcome.cancelled || outcome.passes.end != end {
                return Err(RunError::Cancelled);
            }
            bad.extend(outcome.bad);
            capped += outcome.counters.capped;
            rays += outcome.counters.rays;
            let film = match whole.take() {
                None => outcome.film,
                Some(mut film) => match film.merge(outcome.film) {
                    Ok(()) => film,
                    // Both are films of one prepared scene.
                    Err(_) => return Err(RunError::Cancelled),
                },
            };
            stages.push((end, luminance(&film.to_image())));
            whole = Some(film);
            begin = end;
        }
        let Some(film) = whole else { return Err(RunError::Cancelled) };
        Ok(Run { seed, refused: film.refused_total(), image: film.to_image(), stages, bad, capped, rays })
    }

    /// The first passes of a run, with a number of threads: the same film whatever that is.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub(super) fn first_passes(&self, seed: u64, passes: u32, threads: usize) -> Result<Film, RunError> {
        let prepared = prepare::prepare(&self.scene, &self.options(seed))?;
        let options = RenderOptions { threads, layers: true, ..RenderOptions::passes(0..passes) };
        Ok(integrate::render(&prepared, &options, &integrate::Quiet)?.film)
    }

    fn options(&self, seed: u64) -> prepare::Options {
        prepare::Options {
            camera: Some(self.settings.camera.clone()),
            size: self.settings.size,
            seed,
            effects: EffectsMode::Auto,
            max_depth: self.settings.max_depth,
            shortcuts: prepare::Shortcuts::of(&self.scene.settings),
            transparent: false,
            algorithms: self.settings.caustics.algorithms(),
        }
    }
}

/// Luminance of each pixel.
pub(super) fn luminance(image: &Image) -> Vec<f32> {
    image.rgb.iter().map(|c| c.luminance()).collect()
}

/// The plane that tiles and waves look at, as [`gate`](crate::stats::gate) names it.
pub(super) const LUMINANCE: &str = "luminance";

/// Luminance of a light layer, where the image has it.
pub(super) fn layer(image: &Image, layer: LightLayer) -> Option<Vec<f32>> {
    let find = |c: &str| {
        let name = format!("{}.{c}", layer.name());
        image.layers.iter().flat_map(|l| &l.channels).find(|(n, _)| *n == name).map(|(_, v)| v)
    };
    let (r, g, b) = (find("R")?, find("G")?, find("B")?);
    let pixel = |((&r, &g), &b): ((&f32, &f32), &f32)| crate::color::Rgb::new(r, g, b).luminance();
    Some(r.iter().zip(g).zip(b).map(pixel).collect())
}

/// The brightest sample of each pixel, where the image has it.
pub(super) fn brightest(image: &Image) -> Option<&[f32]> {
    let mut channels = image.layers.iter().flat_map(|l| &l.channels);
    channels.find(|(name, _)| name == "brightest").map(|(_, v)| v.as_slice())
}

/// Luminance, channels, and the light layers that there are.
pub(super) fn planes(image: &Image) -> Planes {
    let channel = |c: usize| image.rgb.iter().map(|p| p[c]).collect();
    let mut planes = vec![
        (LUMINANCE.to_owned(), luminance(image)),
        ("red".to_owned(), channel(0)),
        ("green".to_owned(), channel(1)),
        ("blue".to_owned(), channel(2)),
    ];
    let layers = LightLayer::ALL.into_iter();
    planes.extend(layers.filter_map(|l| layer(image, l).map(|v| (l.name().to_owned(), v))));
    Planes { width: image.width as usize, height: image.height as usize, planes, scalars: Vec::new() }
}

/// What the scalars of a run are called.
pub(super) mod scalar {
    /// Mean over pixels of the logarithm of the relative variance of a pixel's mean, from its replications: what the
    /// render itself says of its noise.
    pub(crate) const NOISE: &str = "noise";
    /// Mean over pixels of the logarithm of the relative error against the pilots' mean: noise as it is.
    pub(crate) const ERROR: &str = "error";
    /// Slope of that error over samples, both as logarithms: -1/2 for independent samples.
    pub(crate) const SLOPE: &str = "slope";
    /// Mean over pixels of the logarithm of the brightest sample relative to the pixel: how far bright samples stick out.
    pub(crate) const PEAKS: &str = "peaks";
    /// All of them.
    pub(crate) const ALL: [&str; 4] = [NOISE, ERROR, SLOPE, PEAKS];
}

/// What errors are measured against: the pilots' mean, so that neither null runs nor runs under test have a
/// part in it.
pub(super) struct Baseline {
    mean: Vec<f32>,
    /// One over the mean plus the floor, squared.
    weights: Vec<f64>,
    floor: f64,
    /// A small part of the usual relative variance, so that its logarithm is one of a number above zero.
    least: f64,
}

impl Baseline {
    /// `None` where all is black.
    pub(super) fn new(profile: &Profile) -> Option<Self> {
        const SMALL: f64 = 1e-3;
        let mean = profile.mean(LUMINANCE)?.to_vec();
        let floor = floor(&mean)?;
        let weight = |&m: &f32| {
            let m = f64::from(m) + floor;
            1.0 / (m * m)
        };
        let weights: Vec<f64> = mean.iter().map(weight).collect();
        let (_, _, variance) = profile.planes.iter().find(|(name, ..)| name == LUMINANCE)?;
        let mut relative: Vec<f64> = variance.iter().zip(&weights).map(|(&v, w)| w * f64::from(v)).collect();
        relative.sort_by(f64::total_cmp);
        let least = (SMALL * relative[relative.len() / 2]).max(1e-16);
        Some(Self { weights, mean, floor, least })
    }

    /// Relative root mean square error of a plane of luminance.
    pub(super) fn error(&self, plane: &[f32]) -> f64 {
        (self.squares(plane).sum::<f64>() / plane.len().max(1) as f64).sqrt()
    }

    /// Relative squared error of each pixel.
    fn squares(&self, plane: &[f32]) -> impl Iterator<Item = f64> {
        plane.iter().zip(&self.mean).zip(&self.weights).map(|((&v, &m), w)| {
            let d = f64::from(v) - f64::from(m);
            d * d * w
        })
    }

    /// Mean logarithm of a relative variance: a few pixels with rare bright samples do not decide.
    fn mean_log(&self, relative: impl Iterator<Item = f64>) -> f64 {
        relative.map(|v| libm::log(v + self.least)).sum::<f64>() / self.mean.len().max(1) as f64
    }

    fn noise(&self, image: &Image) -> f64 {
        let variances = image.variance.iter().flatten().zip(&self.weights);
        self.mean_log(variances.map(|(v, w)| w * f64::from(v.r + v.g + v.b) / 3.0))
    }

    fn peaks(&self, image: &Image) -> f64 {
        let term = |(&v, &m): (&f32, &f32)| libm::log1p(f64::from(v) / (f64::from(m) + self.floor));
        brightest(image).unwrap_or_default().iter().zip(&self.mean).map(term).sum::<f64>()
            / self.mean.len().max(1) as f64
    }

    /// The planes of a run with its scalars.
    pub(super) fn planes(&self, run: &Run) -> Planes {
        let mut planes = planes(&run.image);
        let error = |plane: &[f32]| 0.5 * self.mean_log(self.squares(plane));
        let errors: Vec<(f64, f64)> =
            run.stages.iter().map(|(n, plane)| (libm::log(f64::from(*n)), error(plane))).collect();
        let values = [
            self.noise(&run.image),
            errors.last().map_or(0.0, |e| e.1),
            slope(&errors),
            self.peaks(&run.image),
        ];
        planes.scalars = scalar::ALL.iter().map(|s| (*s).to_owned()).zip(values).collect();
        planes
    }
}

/// The planes of a pilot: its scalars have names, and no values yet.
pub(super) fn pilot_planes(run: &Run) -> Planes {
    let scalars = scalar::ALL.iter().map(|s| ((*s).to_owned(), 0.0)).collect();
    Planes { scalars, ..planes(&run.image) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards that pilots, null runs and tests share no seed, and that fresh seeds are others.
    #[test]
    fn seeds_differ_by_role() {
        let roles = [Role::Pilot, Role::Null, Role::Test(0), Role::Test(1)];
        let mut all: Vec<u64> =
            roles.iter().flat_map(|&r| (0..100).map(move |i| seed("room", r, i))).collect();
        all.extend((0..100).map(|i| seed("rooms", Role::Null, i)));
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}

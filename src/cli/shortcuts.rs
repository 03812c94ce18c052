//! Shortcuts as typed, and what they cost as pictures and reports say it.

use clap::{Args, ValueEnum};
use serde::Serialize;

use super::failure::Failure;
use crate::integrate::{Control, RunError, StopOnly};
use crate::prepare::{Fresnel, Omission, Options, Shortcut};
use crate::price::{self, Better, Budget, Price, Priced};
use crate::scene::Scene;
use crate::stats::Interval;

/// What is left out or approximated on purpose. None by default; a picture lists each with the bias that it has.
#[derive(Args, Debug)]
#[command(next_help_heading = "Shortcuts, listed in the picture with the bias that each has")]
pub(super) struct ShortcutArgs {
    /// Leave something out; may repeat. caustics: what mirrors and glass throw onto something else; indirect: light
    /// that was spread more than once. An effect of `explain`: area-lights, free-lights, point-lights, environment
    /// (lights are off); diffuse, mirror, refraction, glossy (surfaces are black); absorption, smooth-normals, lens,
    /// textures, cut-outs, normal-maps, vertex-colours, nested-bodies (as if nothing asked for it)
    #[arg(long, value_name = "WHAT", value_parser = omission, value_delimiter = ',')]
    without: Vec<Omission>,

    /// Cap on scattering events; 0 shows emission only [default: the scene's, else none]
    #[arg(long, value_name = "N")]
    max_depth: Option<u32>,

    /// Scale each contribution of light that took two events or more down to this radiance, W sr^-1 m^-2
    #[arg(long, value_name = "L")]
    clamp: Option<f32>,

    /// How glass, coats and plastics reflect
    #[arg(long, value_enum, default_value_t, value_name = "CURVE")]
    fresnel: FresnelArg,

    /// Factor on light that was spread more than once [default: the scene's, else 1, as physics has it]
    #[arg(long, value_name = "X")]
    indirect_gain: Option<f32>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum FresnelArg {
    /// By Fresnel's equations
    #[default]
    Exact,
    /// By Schlick's approximation
    Schlick,
}

impl ShortcutArgs {
    /// Takes the shortcuts that were asked for, beside those of the scene.
    pub(super) fn take(&self, options: &mut Options) {
        self.without.iter().for_each(|&omission| options.shortcuts.without.insert(omission));
        options.max_depth = self.max_depth.or(options.max_depth);
        options.shortcuts.clamp = self.clamp;
        options.shortcuts.fresnel = match self.fresnel {
            FresnelArg::Exact => Fresnel::Exact,
            FresnelArg::Schlick => Fresnel::Schlick,
        };
        options.shortcuts.indirect_gain = self.indirect_gain.unwrap_or(options.shortcuts.indirect_gain);
    }

    /// The first flag that only the default method knows.
    pub(super) fn of_the_default_method(&self) -> Option<&'static str> {
        let given = [
            ("--without", !self.without.is_empty()),
            ("--clamp", self.clamp.is_some()),
            ("--fresnel", self.fresnel != FresnelArg::Exact),
            ("--indirect-gain", self.indirect_gain.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(flag, _)| flag)
    }
}

fn omission(word: &str) -> Result<Omission, String> {
    Omission::of_word(word).ok_or_else(|| {
        let words: Vec<_> = Omission::all().map(Omission::word).collect();
        format!("expected one of: {}", words.join(", "))
    })
}

/// Prices the shortcuts that `options` take, each alone and all together; `None` where `control` cancels.
pub(super) fn prices(
    scene: &Scene,
    options: &Options,
    threads: usize,
    control: &dyn Control,
) -> Result<Option<Vec<Priced>>, Failure> {
    let sets = price::alone_and_together(&options.shortcuts_taken());
    prices_of(scene, options, &sets, threads, control)
}

/// Prices sets of shortcuts; `None` where `control` cancels.
pub(super) fn prices_of(
    scene: &Scene,
    options: &Options,
    sets: &[Vec<Shortcut>],
    threads: usize,
    control: &dyn Control,
) -> Result<Option<Vec<Priced>>, Failure> {
    let budget = Budget { threads, ..Budget::default() };
    match price::price(scene, options, sets, &budget, &StopOnly(control)) {
        Ok(priced) => Ok(Some(priced)),
        Err(RunError::Cancelled) => Ok(None),
        Err(e) => Err(Failure::usage(e.to_string())),
    }
}

/// What some shortcuts cost; every figure is relative, with four digits that count.
#[derive(Clone, Debug, Serialize)]
pub(super) struct PricedJson {
    /// What was taken, as flags.
    shortcuts: Vec<String>,
    /// Why it changes nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    idle: Option<String>,
    #[serde(flatten)]
    price: Option<PriceJson>,
}

#[derive(Clone, Debug, Serialize)]
struct PriceJson {
    /// Of the mean luminance.
    bias: f64,
    bias_interval: [f64; 2],
    /// Of the parts of the light.
    bias_of_layers: Vec<LayerJson>,
    /// Root of the mean squared bias of pixels.
    error: f64,
    error_interval: [f64; 2],
    rays: f64,
    variance: f64,
    /// never, unknown, until, always.
    better: &'static str,
    /// Samples per pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    better_until: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    better_until_interval: Option<[Option<f64>; 2]>,
    /// Of the full and of the short render; measured, and in no picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<[f64; 2]>,
}

#[derive(Clone, Debug, Serialize)]
struct LayerJson {
    layer: &'static str,
    bias: f64,
    bias_interval: [f64; 2],
}

impl PricedJson {
    /// With the seconds that were measured.
    pub(super) fn of_run(priced: &Priced) -> Self {
        let seconds = priced.price.as_ref().ok().map(|p| p.elapsed.map(|t| t.as_secs_f64()));
        let mut json = Self::of_picture(priced);
        if let Some(price) = &mut json.price {
            price.seconds = seconds;
        }
        json
    }

    /// A function of scene and settings.
    pub(super) fn of_picture(priced: &Priced) -> Self {
        Self {
            shortcuts: priced.shortcuts.iter().map(Shortcut::flag).collect(),
            idle: priced.price.as_ref().err().cloned(),
            price: priced.price.as_ref().ok().map(PriceJson::from),
        }
    }
}

impl From<&Price> for PriceJson {
    fn from(price: &Price) -> Self {
        let finite = |x: f64| x.is_finite().then(|| rounded(x));
        let both = |e: &Interval| (rounded(e.value), e.ends().map(rounded));
        let (bias, bias_interval) = both(&price.bias);
        let (error, error_interval) = both(&price.error);
        let layers = price.layers.iter().map(|(layer, bias)| {
            let (bias, bias_interval) = both(bias);
            LayerJson { layer: layer.name(), bias, bias_interval }
        });
        let (better, until) = match price.better {
            Better::Never => ("never", None),
            Better::Unknown => ("unknown", None),
            Better::Until(until) if until.low.is_finite() => ("until", Some(until)),
            Better::Until(_) => ("always", None),
        };
        Self {
            bias,
            bias_interval,
            bias_of_layers: layers.collect(),
            error,
            error_interval,
            rays: rounded(price.work),
            variance: rounded(price.variance),
            better,
            better_until: until.and_then(|e| finite(e.value)),
            better_until_interval: until.map(|e| e.ends().map(finite)),
            seconds: None,
        }
    }
}

/// A number with four digits that count; JSON knows no infinity.
fn rounded(x: f64) -> f64 {
    format!("{x:.3e}").parse().ok().filter(|x: &f64| x.is_finite()).unwrap_or(f64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards the help: whatever may be left out is named in it.
    #[test]
    fn help_names_every_omission() {
        let command = ShortcutArgs::augment_args(clap::Command::new("test"));
        let flag = command.get_arguments().find(|a| a.get_id() == "without").expect("the flag");
        let help = flag.get_help().expect("help").to_string();
        for omission in Omission::all().filter(|o| o.name() != "dummy") {
            assert!(help.contains(&omission.word()), "{}", omission.word());
        }
    }

    #[test]
    fn numbers_are_rounded() {
        assert_eq!([0.123_456, -98_764.0, 0.0].map(rounded), [0.1235, -98_760.0, 0.0]);
        assert_eq!(rounded(f64::INFINITY), f64::MAX);
    }
}

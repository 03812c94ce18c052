//! `--algorithm NAME=VALUE`: estimators as typed.

use clap::Args;

use crate::prepare::{Algorithms, CausticsMode, Indirect, MOST_BRANCHES};

/// Which estimators run.
#[derive(Args, Debug)]
pub(super) struct AlgorithmArgs {
    /// Choose what a pilot would; may repeat. caustics=path (light in mirrors' and glasses' light is met by chance),
    /// caustics=photon (photons from the lights) or caustics=auto; indirect=photon (where a path is spread for the second
    /// time, but on rough metal and glass, it ends, and photons say what light arrives there) or indirect=path;
    /// light-samples=N (at the first hit that spreads light); split=N (ways on where the camera sees a mirror or clear
    /// glass first); roulette=N (scattering events before it starts) [default: a pilot decides from 64 samples on; below it
    /// is caustics=path unless only photons find the light, light-samples=1, split=1, roulette=4; indirect=path]
    #[arg(long, value_name = "NAME=VALUE", value_parser = one)]
    pub(super) algorithm: Vec<One>,

    /// No estimator whose error does not vanish on average: photons are then traced to what the camera sees directly,
    /// and no photon map is kept
    #[arg(long)]
    pub(super) unbiased: bool,
}

/// One choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum One {
    Caustics(CausticsMode),
    Indirect(Indirect),
    LightSamples(u32),
    Split(u32),
    Roulette(u32),
}

impl AlgorithmArgs {
    /// As meant; the last of several choices counts.
    pub(super) fn meant(&self) -> Algorithms {
        let mut meant = Algorithms { unbiased: self.unbiased, ..Algorithms::default() };
        for &one in &self.algorithm {
            match one {
                One::Caustics(mode) => meant.caustics = mode,
                One::Indirect(how) => meant.indirect = how,
                One::LightSamples(n) => meant.light_samples = Some(n),
                One::Split(n) => meant.split = Some(n),
                One::Roulette(n) => meant.roulette = Some(n),
            }
        }
        meant
    }
}

/// Events before roulette that may be asked for, at most.
const LATEST_ROULETTE: u32 = 1000;

fn one(text: &str) -> Result<One, String> {
    let number = |value: &str, least: u32, most: u32| {
        let found = value.parse().ok().filter(|n| (least..=most).contains(n));
        found.ok_or_else(|| format!("expected a number from {least} to {most}"))
    };
    match text.split_once('=') {
        Some(("caustics", "auto")) => Ok(One::Caustics(CausticsMode::Auto)),
        Some(("caustics", "path")) => Ok(One::Caustics(CausticsMode::Path)),
        Some(("caustics", "photon")) => Ok(One::Caustics(CausticsMode::Photon)),
        Some(("caustics", _)) => Err("expected caustics=auto, caustics=path or caustics=photon".to_owned()),
        Some(("indirect", "path")) => Ok(One::Indirect(Indirect::Path)),
        Some(("indirect", "photon")) => Ok(One::Indirect(Indirect::Photon)),
        Some(("indirect", _)) => Err("expected indirect=path or indirect=photon".to_owned()),
        Some(("light-samples", n)) => number(n, 1, MOST_BRANCHES).map(One::LightSamples),
        Some(("split", n)) => number(n, 1, MOST_BRANCHES).map(One::Split),
        Some(("roulette", n)) => number(n, 0, LATEST_ROULETTE).map(One::Roulette),
        _ => Err("expected caustics=.., indirect=.., light-samples=.., split=.. or roulette=..".to_owned()),
    }
}

//! Both ways on at clear glass.
//!
//! In: a path that has met nothing since the camera but mirrors, clear glass and what is nearly as smooth, at a surface that
//! reflects and refracts.
//! Out: the path on its greater way, and the lesser one, which waits. Each carries its share of the light, so that both
//! together are the mean over a choice by chance, without the noise of that choice: a lamp that is fourteen times as bright
//! as its room makes a highlight on glass in which one sample in twenty-five would carry nearly all light. (Splitting; Arvo
//! and Kirk, "Particle Transport and Image Synthesis", SIGGRAPH 1990.)
//!
//! Each way is followed up to what it meets first that spreads light, which shows it each lamp that it sees; whether one
//! that carries little goes on from there is then decided by roulette. So the lesser way costs a few rays at most.

use glam::Vec3;

use super::path::PathState;
use super::scatter::{Frame, lobes};
use crate::bsdf::{Bsdf, BsdfSample, Transport};
use crate::prepare::Effects;

/// What the lesser way has to carry for both to be taken, in terms of what a path carries at the camera: below, chance
/// costs less.
const LEAST: f32 = 0.03;

/// How often a path may have taken both ways. On seven scenes with glass more gained little where it gained anything, and
/// cost most where glass stands in glass.
const MOST_TURNS: u32 = 2;

/// The ways of a path that wait until the one before has ended.
#[derive(Default)]
pub(super) struct BothWays {
    waiting: Vec<PathState>,
}

impl BothWays {
    /// The greater of two ways on, weighted by its share, where both are to be taken; the other one waits. `leave` sends
    /// a path on its way.
    #[inline(never)]
    pub(super) fn take(
        &mut self,
        path: &mut PathState,
        fx: Effects,
        bsdf: &Bsdf,
        frame: &Frame,
        leave: impl Fn(&mut PathState, Vec3, &BsdfSample),
    ) -> Option<(Vec3, BsdfSample)> {
        if path.turns >> MOST_TURNS != 0 {
            return None;
        }
        let [first, last] = lobes(fx, bsdf, frame, Transport::Radiance)?;
        let [(greater, most), (lesser, least)] = {
            let carries = |(_, s): &(Vec3, BsdfSample)| {
                (path.beta * s.weight).max_channel() * path.eta_scale * s.eta * s.eta * path.share
            };
            let mut both = [first, last].map(|way| (way, carries(&way)));
            both.sort_by(|a, b| b.1.total_cmp(&a.1));
            both
        };
        if least < LEAST {
            return None;
        }
        path.turns <<= 1;
        let mut other = PathState { turns: path.turns | 1, ..path.clone() };
        for (way, carries) in [(&mut *path, most), (&mut other, least)] {
            way.eta_scale *= way.share / carries;
            way.share = carries;
        }
        leave(&mut other, lesser.0, &lesser.1);
        self.waiting.push(other);
        Some(greater)
    }

    /// Whether a way waited: it goes on, with what the path that has ended gathered.
    #[inline(always)]
    pub(super) fn go_on(&mut self, path: &mut PathState) -> bool {
        let Some(next) = self.waiting.pop() else { return false };
        *path = PathState { radiance: path.radiance, parts: path.parts, ..next };
        true
    }
}

#[cfg(test)]
mod tests {
    use crate::integrate::{Quiet, RenderOptions, render};
    use crate::prepare::{Algorithms, EffectsMode, Options, Prepared, Shortcuts, prepare};
    use crate::scene::text::parse_toml;
    use crate::scene::{complete, validate};

    /// A lamp of radiance 100 above a face of glass in the dark, seen in it at 45 degrees.
    const HIGHLIGHT: &str = r#"
epsilux = 1
camera.front = { eye = [0, 2, 2], target = [0, 0, 0], fov = 8 }
[material]
glass = { glass = { ior = 1.5 } }
lamp = { light = [100, 100, 100] }
[[object]]
material = "glass"
rect = { corner = [-1, 0, -1], edges = [[2, 0, 0], [0, 0, 2]], facing = [0, 5, 0] }
[[object]]
material = "lamp"
rect = { corner = [-2, 1, -4], edges = [[4, 0, 0], [0, 4, 0]], facing = [0, 2, 5] }
"#;

    fn prepared(effects: EffectsMode) -> Prepared {
        let mut scene = parse_toml(HIGHLIGHT).expect("a scene").0;
        validate(&mut scene).expect("a valid scene");
        complete(&mut scene);
        let options = Options {
            camera: None,
            size: [6, 6],
            seed: 1,
            effects,
            max_depth: None,
            shortcuts: Shortcuts::default(),
            transparent: false,
            algorithms: Algorithms::PATHS,
        };
        prepare(&scene, &options).expect("a camera")
    }

    /// By Fresnel's formulas glass of index 1.5 reflects 5.0 % at 45 degrees. Guards that each sample says so: by chance
    /// one in twenty would show the whole lamp. And that the loop of everything splits in the same way.
    #[test]
    fn a_highlight_has_no_noise() {
        for effects in [EffectsMode::Auto, EffectsMode::All] {
            let scene = prepared(effects);
            let film = render(&scene, &RenderOptions::passes(0..1), &Quiet).expect("a pass").film;
            for rgb in film.to_image().rgb {
                // 41 to 49 degrees are in view.
                assert!((4.4..5.9).contains(&rgb.luminance()), "{rgb:?}");
            }
        }
    }
}

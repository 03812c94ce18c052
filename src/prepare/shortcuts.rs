//! Shortcuts: what a render may leave out or approximate on purpose, to save work or noise.
//!
//! In: what was asked for. Out: the effects that are not simulated, and what is kept of each contribution of light.
//! None is taken by default. A picture lists those that were, and `price` measures what each of them costs: its
//! bias, with a sign. A shortcut means the same whether paths or photons find the light.
//!
//! Ways of light are written as in [`LightLayer`](crate::film::LightLayer): S is an event without spread or a
//! narrow one, D any other.

use std::fmt;

use super::casters::throws;
use super::fold::fold;
use super::material::spreads;
use super::plan::{Effect, Effects, Plan};
use super::{Options, PrepareError};
use crate::bsdf::fresnel::Fresnel;
use crate::color::Rgb;
use crate::scene::{MAX_INDIRECT_GAIN, Scene, Settings};

/// What a picture may lack on purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Omission {
    /// `E (D|S)* D S+ L`: what mirrors and glass throw onto something else.
    Caustics,
    /// `E (D|S)* D (D|S)* D S* L`: light that was spread more than once.
    Indirect,
    /// An effect: lights of that kind are dark, surfaces that scatter in that way are black, and whatever else asks
    /// for it is as if it did not.
    Effect(Effect),
}

impl Omission {
    /// All of them, in report order.
    pub fn all() -> impl Iterator<Item = Self> {
        [Self::Caustics, Self::Indirect].into_iter().chain(Effect::ALL.map(Self::Effect))
    }

    /// What people call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Caustics => "caustics",
            Self::Indirect => "indirect light",
            Self::Effect(effect) => effect.name(),
        }
    }

    /// Its name as one word, as it is typed: `smooth-normals`.
    #[must_use]
    pub fn word(self) -> String {
        match self {
            Self::Indirect => "indirect".to_owned(),
            _ => self.name().replace(' ', "-"),
        }
    }

    /// What has this [`word`](Self::word).
    #[must_use]
    pub fn of_word(word: &str) -> Option<Self> {
        Self::all().find(|o| o.word() == word)
    }
}

/// A set of [`Omission`]s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Omissions {
    /// Effects that are not simulated.
    pub effects: Effects,
    /// Whether caustics lack.
    pub caustics: bool,
    /// Whether indirect light lacks.
    pub indirect: bool,
}

impl Omissions {
    /// Whether something is in the set.
    #[must_use]
    pub fn has(&self, omission: Omission) -> bool {
        match omission {
            Omission::Caustics => self.caustics,
            Omission::Indirect => self.indirect,
            Omission::Effect(effect) => self.effects.has(effect),
        }
    }

    /// Puts something into the set.
    pub fn insert(&mut self, omission: Omission) {
        match omission {
            Omission::Caustics => self.caustics = true,
            Omission::Indirect => self.indirect = true,
            Omission::Effect(effect) => self.effects = self.effects.union(Effects::of(&[effect])),
        }
    }
}

/// The shortcuts of a render, but for its cap on depth ([`Options::max_depth`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortcuts {
    /// What the picture lacks.
    pub without: Omissions,
    /// Most radiance of one contribution of light that took two events or more, in its brightest channel,
    /// W sr^-1 m^-2, (0, inf); what is above is scaled down to it. `None` keeps all.
    pub clamp: Option<f32>,
    /// How dielectrics reflect. Metals and tints reflect by Schlick's curve anyway: that defines them.
    pub fresnel: Fresnel,
    /// Factor on light that was spread more than once, 0 to [`MAX_INDIRECT_GAIN`].
    pub indirect_gain: f32,
}

impl Shortcuts {
    /// Those that a scene takes itself.
    #[must_use]
    pub fn of(settings: &Settings) -> Self {
        Self { indirect_gain: settings.indirect_gain.unwrap_or(1.0), ..Self::default() }
    }
}

impl Default for Shortcuts {
    /// None.
    fn default() -> Self {
        let fresnel = Fresnel::Exact;
        Self { without: Omissions::default(), clamp: None, fresnel, indirect_gain: 1.0 }
    }
}

/// One shortcut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shortcut {
    /// Something is left out.
    Without(Omission),
    /// Paths end after so many events: [`Options::max_depth`].
    MaxDepth(u32),
    /// [`Shortcuts::clamp`].
    Clamp(f32),
    /// Dielectrics reflect by Schlick's approximation.
    Schlick,
    /// [`Shortcuts::indirect_gain`].
    IndirectGain(f32),
}

/// As people read it: `without caustics`.
impl fmt::Display for Shortcut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Without(omission) => write!(f, "without {}", omission.name()),
            Self::MaxDepth(0) => write!(f, "emission only"),
            Self::MaxDepth(1) => write!(f, "at most 1 event"),
            Self::MaxDepth(most) => write!(f, "at most {most} events"),
            Self::Clamp(most) => write!(f, "clamped to {most}"),
            Self::Schlick => write!(f, "Schlick's reflectance"),
            Self::IndirectGain(gain) => write!(f, "indirect light times {gain}"),
        }
    }
}

impl Shortcut {
    /// The flag that takes it: `--without caustics`.
    #[must_use]
    pub fn flag(&self) -> String {
        match self {
            Self::Without(omission) => format!("--without {}", omission.word()),
            Self::MaxDepth(most) => format!("--max-depth {most}"),
            Self::Clamp(most) => format!("--clamp {most}"),
            Self::Schlick => "--fresnel schlick".to_owned(),
            Self::IndirectGain(gain) => format!("--indirect-gain {gain}"),
        }
    }

    /// Why it changes nothing in a scene; `None` where it may. `plan` is that of a render without shortcuts.
    #[must_use]
    pub fn idle(&self, scene: &Scene, plan: &Plan) -> Option<String> {
        let folded = fold(scene, Effects::EVERYTHING);
        let any =
            |is: &dyn Fn(usize) -> bool| (0..scene.materials.len()).any(|i| folded.uses[i].used && is(i));
        let spread = any(&|i| spreads(&folded.kinds[i]));
        let reason = match self {
            Self::Without(Omission::Effect(effect)) => {
                return plan.left_out.iter().find(|l| l.effect == *effect).map(|l| l.reason.clone());
            }
            Self::Without(Omission::Indirect) | Self::IndirectGain(_) if !spread => {
                "no surface spreads light"
            }
            Self::Without(Omission::Caustics) if !spread => "no surface spreads light",
            Self::Without(Omission::Caustics) if !any(&|i| throws(scene, &folded.kinds[i]).is_some()) => {
                "no surface is so smooth that it would focus light"
            }
            Self::Schlick
                if !plan.effects().has(Effect::Refraction) && !plan.effects().has(Effect::Glossy) =>
            {
                "no surface reflects as a dielectric"
            }
            _ => return None,
        };
        Some(reason.to_owned())
    }
}

/// Caps on depth that are worth a look.
const DEPTHS: [u32; 4] = [1, 2, 4, 8];

/// A clamp that is worth a look, in what a picture of the scene shows as white.
const CLAMP_OVER_WHITE: f64 = 10.0;

/// The shortcuts that make sense for a scene, in report order; `plan` is that of a render without any. Whatever
/// changes nothing is not among them, nor a gain, which saves nothing.
#[must_use]
pub fn shortcuts_of(scene: &Scene, plan: &Plan) -> Vec<Shortcut> {
    let exposure = f64::from(scene.settings.exposure.unwrap_or(0.0));
    let clamp = (CLAMP_OVER_WHITE * libm::exp2(-exposure)) as f32;
    let all = Omission::all().map(Shortcut::Without).chain(DEPTHS.map(Shortcut::MaxDepth));
    let all = all.chain([Shortcut::Clamp(clamp), Shortcut::Schlick]);
    all.filter(|s| s.check().is_ok() && s.idle(scene, plan).is_none()).collect()
}

impl Shortcut {
    /// Refuses numbers that mean nothing.
    fn check(&self) -> Result<(), PrepareError> {
        let refuse =
            |found: f32, expected| Err(PrepareError::Shortcut { shortcut: self.flag(), found, expected });
        match *self {
            Self::Clamp(most) if !(most > 0.0 && most.is_finite()) => refuse(most, "a radiance above zero"),
            Self::IndirectGain(gain) if !(0.0..=MAX_INDIRECT_GAIN).contains(&gain) => {
                refuse(gain, "a factor from 0 to a million")
            }
            _ => Ok(()),
        }
    }
}

impl Options {
    /// The shortcuts that are taken, in report order.
    #[must_use]
    pub fn shortcuts_taken(&self) -> Vec<Shortcut> {
        let Shortcuts { without, clamp, fresnel, indirect_gain } = self.shortcuts;
        let mut taken: Vec<_> = Omission::all().filter(|&o| without.has(o)).map(Shortcut::Without).collect();
        taken.extend(self.max_depth.map(Shortcut::MaxDepth));
        taken.extend(clamp.map(Shortcut::Clamp));
        taken.extend((fresnel == Fresnel::Schlick).then_some(Shortcut::Schlick));
        // Not a number is no gain of one either, and is refused.
        taken.extend((indirect_gain != 1.0).then_some(Shortcut::IndirectGain(indirect_gain)));
        taken
    }

    /// The same without any shortcut.
    #[must_use]
    pub fn without_shortcuts(&self) -> Self {
        Self { max_depth: None, shortcuts: Shortcuts::default(), ..self.clone() }
    }

    /// The same with one more shortcut; of two caps, clamps or gains the new one counts.
    #[must_use]
    pub fn with_shortcut(&self, shortcut: Shortcut) -> Self {
        let mut options = self.clone();
        let taken = &mut options.shortcuts;
        match shortcut {
            Shortcut::Without(omission) => taken.without.insert(omission),
            Shortcut::MaxDepth(most) => options.max_depth = Some(most),
            Shortcut::Clamp(most) => taken.clamp = Some(most),
            Shortcut::Schlick => taken.fresnel = Fresnel::Schlick,
            Shortcut::IndirectGain(gain) => taken.indirect_gain = gain,
        }
        options
    }

    /// Refuses shortcuts whose numbers mean nothing.
    pub(super) fn check_shortcuts(&self) -> Result<(), PrepareError> {
        self.shortcuts_taken().iter().try_for_each(Shortcut::check)
    }
}

/// What shortcuts leave of each contribution of light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kept {
    /// Whether all of everything is kept, and nothing below matters.
    all: bool,
    /// Whether caustics are kept.
    caustics: bool,
    /// Factor on light that was spread more than once.
    indirect: f32,
    /// Most radiance of light that took two events or more.
    most: f32,
}

/// The way of a contribution of light to the camera.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    /// Scattering events.
    pub(crate) events: u32,
    /// Those with a spread, and not a narrow one.
    pub(crate) spread: u32,
    /// Whether it is a caustic: the event at the light's end has no spread, and another one has.
    pub(crate) caustic: bool,
}

impl Kept {
    pub(super) fn new(shortcuts: &Shortcuts) -> Self {
        let Shortcuts { without, clamp, indirect_gain, .. } = *shortcuts;
        let kept = Self {
            all: false,
            caustics: !without.caustics,
            indirect: if without.indirect { 0.0 } else { indirect_gain },
            most: clamp.unwrap_or(f32::INFINITY),
        };
        let everything = Self { all: false, caustics: true, indirect: 1.0, most: f32::INFINITY };
        Self { all: kept == everything, ..kept }
    }

    /// What is left of light that came that way.
    #[inline(always)]
    pub(crate) fn of(&self, light: Rgb, way: impl FnOnce() -> Way) -> Rgb {
        if self.all { light } else { self.reduced(light, way()) }
    }

    #[inline(never)]
    fn reduced(&self, light: Rgb, way: Way) -> Rgb {
        if way.caustic && !self.caustics {
            return Rgb::BLACK;
        }
        let light = if way.spread > 1 { light * self.indirect } else { light };
        let brightest = light.max_channel();
        if way.events > 1 && brightest > self.most { light * (self.most / brightest) } else { light }
    }

    /// Whether bright contributions are cut, so that what a way brings on average is not known.
    pub(crate) fn clamps(&self) -> bool {
        self.most < f32::INFINITY
    }

    /// Whether nothing counts that is spread once more after it was spread `before` times.
    #[inline(always)]
    pub(crate) fn ends_after(&self, before: u32) -> bool {
        before > 0 && self.indirect == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAY: Way = Way { events: 2, spread: 1, caustic: false };

    fn kept(shortcut: Shortcut) -> Kept {
        let mut s = Shortcuts::default();
        match shortcut {
            Shortcut::Without(o) => s.without.insert(o),
            Shortcut::Clamp(most) => s.clamp = Some(most),
            Shortcut::IndirectGain(gain) => s.indirect_gain = gain,
            Shortcut::MaxDepth(_) | Shortcut::Schlick => {}
        }
        Kept::new(&s)
    }

    /// Guards what each shortcut takes: from which ways of light, and how much.
    #[test]
    fn each_takes_what_it_says() {
        let light = Rgb::new(8.0, 2.0, 1.0);
        let check = |shortcut, way: Way, expected| {
            assert_eq!(kept(shortcut).of(light, || way), expected, "{shortcut}, {way:?}");
        };
        let caustic = Way { caustic: true, ..WAY };
        let indirect = Way { spread: 2, ..WAY };
        let direct = Way { events: 1, ..WAY };
        check(Shortcut::Schlick, caustic, light);
        check(Shortcut::Without(Omission::Caustics), caustic, Rgb::BLACK);
        check(Shortcut::Without(Omission::Caustics), indirect, light);
        check(Shortcut::Without(Omission::Indirect), indirect, Rgb::BLACK);
        check(Shortcut::Without(Omission::Indirect), caustic, light);
        check(Shortcut::IndirectGain(0.5), indirect, light * 0.5);
        check(Shortcut::IndirectGain(0.5), direct, light);
        check(Shortcut::Clamp(4.0), indirect, light * 0.5);
        check(Shortcut::Clamp(4.0), direct, light);
        check(Shortcut::Clamp(9.0), indirect, light);
        assert!(kept(Shortcut::Schlick).all && !kept(Shortcut::Clamp(4.0)).all);
    }

    /// Guards that what is typed is what is meant, for every omission.
    #[test]
    fn words_name_what_they_say() {
        for omission in Omission::all() {
            let word = omission.word();
            assert_eq!(Omission::of_word(&word), Some(omission), "{word}");
            assert!(word.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{word}");
            assert_eq!(Shortcut::Without(omission).flag(), format!("--without {word}"));
        }
        assert_eq!(Omission::of_word("everything"), None);
    }
}

//! Caustics by photons from the lights.
//!
//! A caustic is `E (D|S)* D S+ L` in Heckbert's notation: from the eye E to the light L, where S is an event
//! without spread, and D any other. Paths from the camera find it only by chance; where the plan says so they
//! leave it out, and photons, aimed at what throws light ([`crate::light::Aim`]), supply it:
//!
//! * `E D (S+ D)* S+ L`, where the camera sees the last D directly and light reached each other over S+: a photon
//!   is connected to the camera from each D, and adds to the pixel in which it is seen (light tracing; Arvo 1986,
//!   Dutre et al. 1993). Unbiased.
//! * the others: the photons of the pass are kept in a [`PhotonMap`], and each other D of a path from the camera
//!   gathers those around it that came over S+ alone (Jensen, EGWR 1996). The radius of pass p follows from p alone,
//!   r_p^2 = r_0^2 prod (j + a) / (j + 1) over j = 1 .. p with a = 2/3 (Knaus and Zwicker, "Progressive Photon
//!   Mapping: A Probabilistic Approach", TOG 2011), so that passes know nothing of each other and can be
//!   made anywhere in any order. The bias vanishes as passes are added.
//!
//! The photons of a pass are a pure function of scene, seed and pass. A photon stands for the same
//! events as the path from the camera that runs the other way: one definition of what a surface does, that for
//! light towards the camera, serves both, and photons use its adjoint ([`trace`]).

mod map;
mod splat;
mod trace;

pub(super) use map::{PhotonMap, caustics_at};
pub(super) use splat::Splat;
pub(super) use trace::Photon;

use super::li::Counters;
use crate::light::SphereLight;
use crate::prepare::{Casting, Caustics, Prepared};
use crate::sampling::Address;

/// Photons of a pass, at most: what bounds the memory of a map to 70 MiB.
const MOST_PHOTONS: u64 = 1 << 20;

/// Photons that are traced together.
const CHUNK: u32 = 4096;

/// Photons of one pass of a picture of this many pixels: one for each, so that neither tracing them nor
/// looking them up outweighs the paths.
pub(crate) fn photons(pixels: u64) -> u32 {
    pixels.min(MOST_PHOTONS) as u32
}

/// How wide the disks are that photons are gathered from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Radius {
    /// Factor on the radius of the first pass.
    pub(crate) factor: f32,
    /// Width of the pixels that radii are measured in, in those of the picture.
    pub(crate) pixel: f32,
}

impl Radius {
    /// That of a pass.
    pub(crate) fn of(pass: u32) -> Self {
        Self { factor: map::radius_scale(pass), pixel: 1.0 }
    }

    /// The mean over so many passes of a power of the factor.
    pub(crate) fn mean_power(passes: u32, exponent: f64) -> f64 {
        let mut square = 1.0;
        let powers = (0..passes).map(|pass| {
            if pass > 0 {
                square *= map::shrink(pass);
            }
            libm::pow(square, 0.5 * exponent)
        });
        powers.sum::<f64>() / f64::from(passes.max(1))
    }
}

/// Traces the photons of passes.
pub(super) struct Tracer<'a> {
    scene: &'a Prepared,
    casting: &'a Casting,
    crop: [u32; 4],
    photons: u32,
}

/// What some of the photons of a pass brought.
#[derive(Default)]
pub(super) struct Traced {
    /// Those that a map needs.
    pub(super) photons: Vec<Photon>,
    /// What the camera sees of them.
    pub(super) splats: Vec<Splat>,
}

impl<'a> Tracer<'a> {
    /// For a part of a picture (left, top, width, height); `None` where the plan has no photons.
    pub(super) fn new(scene: &'a Prepared, crop: [u32; 4]) -> Option<Self> {
        let pixels = u64::from(scene.size[0]) * u64::from(scene.size[1]);
        let casting = scene.casting()?;
        Some(Self { scene, casting, crop, photons: photons(pixels) })
    }

    /// With so many photons in a pass.
    pub(super) fn with(self, photons: u32) -> Self {
        Self { photons: photons.max(1), ..self }
    }

    /// Parts that the photons of a pass are traced in.
    pub(super) fn chunks(&self) -> u32 {
        self.photons.div_ceil(CHUNK)
    }

    /// Whether paths gather photons.
    pub(super) fn maps(&self) -> bool {
        self.scene.plan.caustics == Caustics::Photon
    }

    /// Traces one part of the photons of a pass.
    pub(super) fn trace(&self, pass: u32, chunk: u32, counters: &mut Counters) -> Traced {
        let mut traced = Traced::default();
        let maps = self.maps();
        let share = 1.0 / self.photons as f32;
        let first = chunk * CHUNK;
        for i in first..(first + CHUNK).min(self.photons) {
            let address = Address::photon(self.scene.seed, pass, i);
            trace::walk(self.scene, self.casting, &address, share, counters, |landing, counters| {
                traced.splats.extend(splat::splat(self.scene, landing, &address, self.crop, counters));
                if maps && !landing.spread_before {
                    traced.photons.push(landing.photon);
                }
            });
        }
        traced
    }

    /// The map of a pass from all of its photons, part after part.
    pub(super) fn map(&self, radius: Radius, parts: Vec<Vec<Photon>>) -> PhotonMap {
        let targets = || self.casting.lights.aim().targets().iter().map(|t| t.ball);
        let least = |lengths: &mut dyn Iterator<Item = f32>| lengths.fold(f32::INFINITY, f32::min);
        // What is nearer to the camera than the nearest target gathers as from there.
        let away = |b: SphereLight| self.scene.camera.distance(b.center).max(b.radius);
        let scale = map::Scale {
            factor: radius.factor,
            pixel: radius.pixel,
            nearest: least(&mut targets().map(away)),
            smallest: least(&mut targets().map(|b| b.radius)),
        };
        PhotonMap::new(parts.concat(), scale)
    }
}

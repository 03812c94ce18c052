//! Photons from the lights: caustics by them, and a second opinion on all light.
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
//! *Indirect light*, where the plan asks for it: other photons go any way, (D|S)*, and a path that is to be spread for
//! the second time, at D2 in `E S* D1 S* D2 .. L`, gathers those around D2 that had an event, and ends: its direct light at D2 is
//! sampled as ever, and what the first vertex shows is gathered over whole paths ("final gathering"; Jensen). Where D2 is
//! a rough metal or rough glass ([`PreparedMaterial::peaked`](crate::prepare::PreparedMaterial)) the path goes on, and
//! the next one counts: such a surface makes bright dots of few photons. The radius is the same everywhere, and shrinks
//! from pass to pass in the same way. Photons that are caustics to a map above, or were
//! seen as such by the camera, do not count: every way still belongs to one estimator.
//!
//! Photons also say, beside the paths, how much light there is: [`second`].
//!
//! The photons of a pass are a pure function of scene, seed and pass. A photon stands for the same
//! events as the path from the camera that runs the other way: one definition of what a surface does, that for
//! light towards the camera, serves both, and photons use its adjoint ([`trace`]).

mod map;
mod second;
mod splat;
mod trace;

pub(super) use map::{Gathered, PhotonMap, Place, gathered};
pub(super) use second::{Second, Seen};
pub(super) use splat::Splat;
pub(super) use trace::Photon;
use trace::{Route, Walk};

use std::ops::Range;

use super::path::Counters;
use super::sparse::Sparse;
use crate::film::{LightLayer, of_widened};
use crate::light::SphereLight;
use crate::prepare::{Casting, Caustics, Indirect, Photons, Prepared};
use crate::sampling::{Address, PhotonUse, Purpose};

/// Photons of a pass, at most: what bounds the memory of a map to 70 MiB.
const MOST_PHOTONS: u64 = 1 << 20;

/// Photons that are traced together.
const CHUNK: u32 = 4096;

/// Photons of one pass of a picture of this many pixels: one for each, so that neither tracing them nor
/// looking them up outweighs the paths.
pub(crate) fn photons(pixels: u64) -> u32 {
    pixels.min(MOST_PHOTONS) as u32
}

/// Pixels for which there is one photon in each pass that looks for indirect light: it lands several times.
const INDIRECT_PIXELS: u64 = 4;

/// Photons of a pass that look for indirect light, at most: with about four landings each they take 80 MiB.
const MOST_INDIRECT: u64 = 1 << 18;

/// Radius of the disks from which indirect light is gathered in the first pass, over that of what is in view: at most.
const INDIRECT_RADIUS: f32 = 1.0 / 40.0;

/// Where there are many photons, disks are so small that they hold about this many, if photons lie everywhere alike.
const INDIRECT_GATHERED: f32 = 10.0;

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

/// Whether paths through a scene gather photons.
pub(super) fn gathers(scene: &Prepared) -> bool {
    Tracer::new(scene, [0, 0, 1, 1], None).is_some_and(|t| t.gathers())
}

/// Traces the photons of passes.
pub(super) struct Tracer<'a> {
    scene: &'a Prepared,
    photons: &'a Photons,
    crop: [u32; 4],
    sparse: Option<Sparse>,
    /// Photons of a pass that look for caustics, and that look for indirect light.
    counts: [u32; 2],
    /// Radius of the disks that indirect light is gathered from in the first pass, metres.
    fixed: f32,
    /// See [`Maps`].
    of_widened: u32,
}

/// What some of the photons of a pass brought.
pub(super) struct Traced {
    /// What they look for.
    pub(super) layer: LightLayer,
    /// Those that a map of it needs.
    pub(super) photons: Vec<Photon>,
    /// What the camera sees of them.
    pub(super) splats: Vec<Splat>,
}

/// The photon maps of a pass.
pub(super) struct Maps {
    /// Of what came over S+ alone.
    pub(super) caustics: Option<PhotonMap>,
    /// Of all that had an event, but what `caustics` holds.
    pub(super) indirect: Option<PhotonMap>,
    /// Samples of which one looks at wider disks too; zero where none does.
    of_widened: u32,
}

impl Maps {
    /// How often what wider disks show counts for the sample of an address: none for most.
    pub(super) fn widened(&self, address: &Address) -> f32 {
        let n = self.of_widened as f32;
        if n > 0.0 && address.block(0, Purpose::Widening, 0, 0)[0] * n < 1.0 { n } else { 0.0 }
    }
}

impl<'a> Tracer<'a> {
    /// For a part of a picture (left, top, width, height), or some pixels of it; `None` where the plan has no photons.
    pub(super) fn new(scene: &'a Prepared, crop: [u32; 4], sparse: Option<Sparse>) -> Option<Self> {
        let pixels = u64::from(scene.size[0]) * u64::from(scene.size[1]);
        let caustics = scene.casting().map_or(0, |_| photons(pixels));
        let indirect = match scene.plan.indirect {
            Indirect::Path => 0,
            Indirect::Photon => pixels.div_ceil(INDIRECT_PIXELS).min(MOST_INDIRECT) as u32,
        };
        let photons = scene.photons().filter(|_| caustics > 0 || indirect > 0)?;
        let fixed = photons.view * (INDIRECT_GATHERED / indirect as f32).sqrt().min(INDIRECT_RADIUS);
        let (mut counts, mut rendered) = ([caustics, indirect], pixels);
        if let Some(sparse) = &sparse {
            let [columns, rows] = sparse.grid();
            rendered = u64::from(columns) * u64::from(rows);
            counts = counts.map(|n| n.div_ceil(sparse.coarse() * sparse.coarse()));
        }
        Some(Self { scene, photons, crop, sparse, counts, fixed, of_widened: of_widened(rendered) })
    }

    /// With so many photons in a pass that look for caustics, and without wider disks.
    pub(super) fn with(self, photons: u32) -> Self {
        let [caustics, indirect] = self.counts;
        Self { counts: [if caustics > 0 { photons.max(1) } else { 0 }, indirect], of_widened: 0, ..self }
    }

    /// Parts that the photons of a pass are traced in.
    pub(super) fn chunks(&self) -> u32 {
        self.counts.iter().map(|n| n.div_ceil(CHUNK)).sum()
    }

    /// Whether paths gather photons.
    pub(super) fn gathers(&self) -> bool {
        self.maps_caustics() || self.counts[1] > 0
    }

    fn maps_caustics(&self) -> bool {
        self.scene.plan.caustics == Caustics::Photon
    }

    /// Traces one part of the photons of a pass: first those that look for caustics.
    pub(super) fn trace(&self, pass: u32, chunk: u32, counters: &mut Counters) -> Traced {
        let before = self.counts[0].div_ceil(CHUNK);
        let part = |chunk: u32, of: u32| chunk * CHUNK..((chunk + 1) * CHUNK).min(of);
        if chunk < before {
            self.trace_caustics(pass, part(chunk, self.counts[0]), counters)
        } else {
            self.trace_indirect(pass, part(chunk - before, self.counts[1]), counters)
        }
    }

    fn trace_caustics(&self, pass: u32, part: Range<u32>, counters: &mut Counters) -> Traced {
        let mut traced = Traced { layer: LightLayer::Caustic, photons: Vec::new(), splats: Vec::new() };
        let maps = self.maps_caustics();
        let share = 1.0 / self.counts[0] as f32;
        let Casting { lights, casts } = &self.photons.casting;
        let walk = Walk { scene: self.scene, lights, casts, route: Route::Thrown };
        for i in part {
            let address = Address::photon(self.scene.seed, PhotonUse::Caustics, pass, i);
            trace::walk(walk, &address, share, counters, |landing, counters| {
                let seen = splat::splat(self.scene, landing, &address, self.crop, counters);
                traced.splats.extend(seen.and_then(|splat| self.caught(splat)));
                if maps && landing.spread == 0 {
                    traced.photons.push(landing.kept());
                }
            });
        }
        traced
    }

    /// What the camera sees of a photon, on the film.
    fn caught(&self, splat: Splat) -> Option<Splat> {
        let Some(sparse) = &self.sparse else { return Some(splat) };
        let [left, top, width, _] = self.crop;
        let pixel = [left + splat.pixel % width, top + splat.pixel / width];
        let ([column, row], share) = sparse.catches(pixel)?;
        Some(Splat { pixel: row * sparse.grid()[0] + column, radiance: splat.radiance * share, ..splat })
    }

    fn trace_indirect(&self, pass: u32, part: Range<u32>, counters: &mut Counters) -> Traced {
        let mut traced = Traced { layer: LightLayer::Indirect, photons: Vec::new(), splats: Vec::new() };
        let share = 1.0 / self.counts[1] as f32;
        let Photons { everywhere, casting, .. } = self.photons;
        let walk = Walk { scene: self.scene, lights: everywhere, casts: &casting.casts, route: Route::Any };
        for i in part {
            let address = Address::photon(self.scene.seed, PhotonUse::Indirect, pass, i);
            trace::walk(walk, &address, share, counters, |landing, _| {
                // Direct light is sampled, and a caustic has a map of its own.
                let photon = &landing.photon;
                let other = self.maps_caustics() && photon.is_caustic() && landing.spread == 0;
                if photon.bounces > 0 && !other && !landing.material.peaked {
                    traced.photons.push(landing.kept());
                }
            });
        }
        traced
    }

    /// The maps of a pass from all of its photons, part after part.
    pub(super) fn maps(&self, radius: Radius, parts: Vec<(LightLayer, Vec<Photon>)>) -> Maps {
        let photons = |layer: LightLayer| {
            let own = parts.iter().filter(|(of, _)| *of == layer).map(|(_, photons)| &photons[..]);
            own.collect::<Vec<_>>().concat()
        };
        let targets = || self.photons.casting.lights.aim().targets().iter().map(|t| t.ball);
        let least = |lengths: &mut dyn Iterator<Item = f32>| lengths.fold(f32::INFINITY, f32::min);
        // What is nearer to the camera than the nearest target gathers as from there.
        let away = |b: SphereLight| self.scene.camera.distance(b.center).max(b.radius);
        // Fewer photons in wider disks are as many.
        let coarse = self.sparse.map_or(1.0, |s| s.coarse() as f32);
        let scale = map::Scale {
            factor: radius.factor * coarse,
            pixel: radius.pixel,
            nearest: least(&mut targets().map(away)),
            smallest: least(&mut targets().map(|b| b.radius)),
        };
        Maps {
            caustics: self.maps_caustics().then(|| PhotonMap::new(photons(LightLayer::Caustic), scale, None)),
            indirect: (self.counts[1] > 0)
                .then(|| PhotonMap::new(photons(LightLayer::Indirect), scale, Some(self.fixed))),
            of_widened: self.of_widened,
        }
    }
}

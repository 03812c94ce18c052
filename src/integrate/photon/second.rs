//! A second opinion: how much light photons bring to where the camera looks.
//!
//! In: a tile of a pass. Out: a few photons, and what the camera sees of them. Paths from the camera cannot tell that
//! they all miss a light; a photon that starts from it can. Photons are traced along any way and connected to the camera
//! from every surface that spreads light, which is all light of the form `E D (D|S)* L` (light tracing; Arvo 1986). The
//! film keeps what both find, in cells ([`crate::film::Doubt`]).
//!
//! Half of the photons are aimed at what throws light, where anything does, and stand for the light that meets such a
//! thing first; the others start as the light is emitted, and stand for all other light. So every way belongs to one half,
//! and small mirrors are found.
//!
//! Photons are few, one for [`PIXELS`] pixels and pass, so that they take a few per cent of the time; passes add
//! up, over parts and machines too. Their numbers come from an address of their own, and nothing of the picture depends on
//! them.

use super::splat::splat;
use super::trace::{Route, Walk, walk};
use crate::film::{Film, Glimpse};
use crate::integrate::path::Counters;
use crate::prepare::{Photons, Prepared};
use crate::sampling::{Address, PhotonUse};

/// Pixels for which there is one photon in each pass.
const PIXELS: u64 = 64;

/// Traces photons beside the paths.
pub(in crate::integrate) struct Second<'a> {
    scene: &'a Prepared,
    photons: &'a Photons,
    crop: [u32; 4],
    /// Photons of a pass.
    count: u32,
}

/// Some photons of a pass, and what the camera sees of them.
#[derive(Default)]
pub(in crate::integrate) struct Seen {
    /// How many were traced.
    pub(in crate::integrate) traced: u32,
    /// Those of one photon after each other.
    pub(in crate::integrate) glimpses: Vec<Glimpse>,
}

impl<'a> Second<'a> {
    /// For a part of a picture (left, top, width, height); `None` where no light can be traced.
    pub(in crate::integrate) fn new(scene: &'a Prepared, crop: [u32; 4]) -> Option<Self> {
        let photons = scene.second()?;
        let count = (u64::from(crop[2]) * u64::from(crop[3])).div_ceil(PIXELS) as u32;
        Some(Self { scene, photons, crop, count })
    }

    /// The photons of a tile, which is one of `tiles`, in a pass.
    pub(in crate::integrate) fn trace(
        &self,
        pass: u32,
        tile: u32,
        tiles: u32,
        counters: &mut Counters,
    ) -> Seen {
        let start = |tile: u32| (u64::from(self.count) * u64::from(tile) / u64::from(tiles)) as u32;
        let (first, end) = (start(tile), start(tile + 1));
        let k = self.scene.plan.replications;
        let mut seen = Seen { traced: end - first, glimpses: Vec::new() };
        for i in first..end {
            let index = (pass / k).wrapping_mul(self.count).wrapping_add(i);
            let (way, half, index, share) = self.way(index);
            let sequence = 2 * (pass % k) + half;
            let address = Address::photon(self.scene.seed, PhotonUse::Second, sequence, index);
            walk(way, &address, share, counters, |landing, counters| {
                let Some(splat) = splat(self.scene, landing, &address, self.crop, counters) else { return };
                seen.glimpses.push(Glimpse {
                    photon: i,
                    pixel: splat.pixel,
                    class: splat.class as u8,
                    luminance: splat.radiance.luminance(),
                });
            });
        }
        seen
    }

    /// Adds the photons of a pass to a film.
    pub(in crate::integrate) fn onto(&self, film: &mut Film, pass: u32, counters: &mut Counters) {
        let Seen { traced, glimpses } = self.trace(pass, 0, 1, counters);
        film.glimpses(traced, &glimpses);
    }

    /// The way of a photon, the half that it belongs to, its index there, and how often it counts: halves take turns,
    /// and each is a sequence of its own.
    fn way(&self, index: u32) -> (Walk<'_>, u32, u32, f32) {
        let Photons { casting, everywhere, .. } = self.photons;
        let walk = |lights, route| Walk { scene: self.scene, lights, casts: &casting.casts, route };
        if casting.lights.aim().targets().is_empty() {
            return (walk(everywhere, Route::Any), 0, index, 1.0);
        }
        match index % 2 {
            0 => (walk(everywhere, Route::First { casts: false }), 0, index / 2, 2.0),
            _ => (walk(&casting.lights, Route::First { casts: true }), 1, index / 2, 2.0),
        }
    }
}

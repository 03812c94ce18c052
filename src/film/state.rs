//! A film as bytes, and back, exactly.
//!
//! In: a film. Out: its sums as integers of the fewest bytes that hold the largest, little-endian, after one
//! byte that says how many; then counts and the like in integers of their own. What the bytes mean is in the layout, which whoever stores them keeps too.

use super::cross::{LIGHT_CLASSES, LIGHTS_APART, Level};
use super::sums::{FEATURES, Film, FilmLayout, LAYERS};
use super::tail::Octaves;

/// Why bytes are not those of a film with a layout.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StateError {
    /// There are more or fewer bytes than the layout takes.
    #[error("found {found} bytes of sums, expected {expected}")]
    Length {
        /// Bytes that there are.
        found: usize,
        /// Bytes that a film with the layout has.
        expected: u128,
    },
    /// An integer cannot have so many bytes.
    #[error("found integers of {0} bytes, expected 1 to 16")]
    Width(u8),
}

/// Bytes of one cell, one pixel, and of everything, beside the sums: counts, hits, passes and ids, refusals.
const COUNT: usize = 4;
const IDS: usize = 12;
const REFUSED: usize = 24;
/// Bytes of the number of photons.
const TRACED: usize = 8;

impl Film {
    /// Everything that the film holds but its layout.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut sums: Vec<&[i128]> = vec![self.sums.as_flattened()];
        sums.extend(self.features.iter().map(|f| f.sums.as_flattened()));
        sums.extend(self.layers.iter().map(|l| l.sums.as_flattened().as_flattened()));
        sums.extend(self.layer_cells.iter().map(|l| l.as_flattened()));
        if let Some(cross) = &self.cross {
            sums.push(cross.paths.as_flattened());
            sums.push(cross.photons.as_flattened().as_flattened());
            sums.push(cross.blocked.as_flattened());
        }
        sums.extend(self.widening.as_deref());
        let width = sums.iter().flat_map(|s| s.iter()).fold(1, |w, &v| bytes_of(v).max(w));
        let mut bytes = vec![width as u8];
        for sum in sums.into_iter().flatten() {
            bytes.extend_from_slice(&sum.to_le_bytes()[..width]);
        }
        let mut put = |v: u32| bytes.extend_from_slice(&v.to_le_bytes());
        self.counts.iter().chain(&self.hits).for_each(|&n| put(n));
        for (pass, ids) in self.features.iter().flat_map(|f| &f.ids) {
            [*pass, ids[0], ids[1]].into_iter().for_each(&mut put);
        }
        self.layers.iter().flat_map(|l| &l.brightest).for_each(|v| put(v.to_bits()));
        self.cross.iter().flat_map(|c| &c.tiles).for_each(|&n| put(n));
        bytes.extend(self.octaves.to_bytes());
        for n in self.cross.iter().map(|c| c.traced).chain(self.refused) {
            bytes.extend_from_slice(&n.to_le_bytes());
        }
        bytes
    }

    /// The film with a layout that has these bytes.
    ///
    /// # Errors
    /// The bytes are not those of a film with this layout; nothing is allocated before they are counted.
    pub fn from_bytes(layout: FilmLayout, bytes: &[u8]) -> Result<Self, StateError> {
        let pixels = u128::from(layout.crop[2]) * u128::from(layout.crop[3]);
        let cells = pixels * u128::from(layout.replications);
        let width = bytes.first().copied().unwrap_or(0);
        if !(1..=16).contains(&width) {
            return Err(StateError::Width(width));
        }
        let width = usize::from(width);
        let features = usize::from(layout.features);
        let layers = usize::from(layout.layers);
        let of_pixel = COUNT + features * (FEATURES * width + IDS) + layers * (3 * LAYERS * width + COUNT);
        let of_cross = if layout.cross { cross_bytes(&layout, width) } else { 0 };
        let sums = 3 + usize::from(layout.layer_noise) * LAYERS + usize::from(layout.widening);
        let of_cell = sums * width + COUNT;
        let rest = (Octaves::BYTES + REFUSED) as u128;
        let expected = 1 + cells * of_cell as u128 + pixels * of_pixel as u128 + of_cross + rest;
        if expected != bytes.len() as u128 {
            return Err(StateError::Length { found: bytes.len(), expected });
        }

        let mut film = Self::new(layout);
        let mut rest = &bytes[1..];
        let mut take = |n: usize| {
            let (taken, left) = rest.split_at(n);
            rest = left;
            taken
        };
        let mut sum = || signed(take(width));
        film.sums.iter_mut().flatten().for_each(|s| *s = sum());
        film.features.iter_mut().flat_map(|f| &mut f.sums).flatten().for_each(|s| *s = sum());
        film.layers.iter_mut().flat_map(|l| &mut l.sums).flatten().flatten().for_each(|s| *s = sum());
        film.layer_cells.iter_mut().flatten().flatten().for_each(|s| *s = sum());
        if let Some(cross) = &mut film.cross {
            cross.paths.as_flattened_mut().iter_mut().for_each(|s| *s = sum());
            cross.photons.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|s| *s = sum());
            cross.blocked.as_flattened_mut().iter_mut().for_each(|s| *s = sum());
        }
        film.widening.iter_mut().flatten().for_each(|s| *s = sum());
        let mut number = || u32::from_le_bytes(take(4).try_into().unwrap_or_default());
        film.counts.iter_mut().chain(&mut film.hits).for_each(|n| *n = number());
        film.features.iter_mut().flat_map(|f| &mut f.ids).for_each(|i| *i = (number(), [number(), number()]));
        film.layers.iter_mut().flat_map(|l| &mut l.brightest).for_each(|v| *v = f32::from_bits(number()));
        film.cross.iter_mut().flat_map(|c| &mut c.tiles).for_each(|n| *n = number());
        film.octaves = Octaves::from_bytes(take(Octaves::BYTES));
        let traced = film.cross.iter_mut().map(|c| &mut c.traced);
        traced
            .chain(&mut film.refused)
            .for_each(|n| *n = u64::from_le_bytes(take(8).try_into().unwrap_or_default()));
        Ok(film)
    }
}

/// Bytes of what photons say beside the paths.
fn cross_bytes(layout: &FilmLayout, width: usize) -> u128 {
    let levels = Level::all([layout.crop[2], layout.crop[3]]);
    let cells = |l: &Level| l.cells.map(u128::from).iter().product::<u128>();
    let (fine, all) = (levels.first().map_or(0, cells), levels.iter().map(cells).sum::<u128>());
    let sums = (fine + 2 * all) * (LIGHT_CLASSES * width) as u128;
    let blocked = (2 * LIGHTS_APART * width) as u128;
    sums + blocked + fine * COUNT as u128 + TRACED as u128
}

/// Bytes that hold an integer with its sign.
fn bytes_of(v: i128) -> usize {
    let bits = 129 - if v < 0 { v.leading_ones() } else { v.leading_zeros() };
    bits.div_ceil(8) as usize
}

/// An integer of up to 16 bytes.
fn signed(bytes: &[u8]) -> i128 {
    let negative = bytes.last().is_some_and(|b| b & 0x80 != 0);
    let mut whole = [if negative { 0xff } else { 0 }; 16];
    whole[..bytes.len()].copy_from_slice(bytes);
    i128::from_le_bytes(whole)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::{Features, Found, Glimpse, Sample};

    /// Guards integers at the ends of each length.
    #[test]
    fn integers_come_back() {
        for bits in 0..127 {
            for v in [1i128 << bits, (1 << bits) - 1, -(1 << bits), -(1 << bits) - 1] {
                let n = bytes_of(v);
                assert_eq!(signed(&v.to_le_bytes()[..n]), v, "{v}");
                assert!(n == 1 || signed(&v.to_le_bytes()[..n - 1]) != v, "{v} would fit into {}", n - 1);
            }
        }
        assert_eq!((bytes_of(i128::MAX), bytes_of(i128::MIN)), (16, 16));
    }

    /// Guards that a film comes back whole, with and without what it may record, and that bytes of another
    /// length, or of no film at all, are refused.
    #[test]
    fn films_come_back() {
        for [features, layers] in [[false, false], [true, false], [false, true], [true, true]] {
            let (layer_noise, cross, widening) = (features != layers, layers, features);
            let layout =
                FilmLayout { features, layers, layer_noise, cross, widening, ..FilmLayout::plain([3, 2]) };
            let mut film = Film::new(layout.clone());
            let blocked = [[2.0, 3.0], [0.0; 2], [1e30, 1e50], [1e-3, 1e-6]];
            film.found(0, &Found { by_class: [0.0, 0.5, 1.0, 2.0, 0.0, 0.0, 0.0, 1e4], blocked });
            let glimpse = |photon, pixel| Glimpse { photon, pixel, class: 5, luminance: 3.0 };
            film.glimpses(7, &[glimpse(0, 2), glimpse(3, 0), glimpse(3, 5)]);
            for pass in 0..9 {
                for pixel in 0..6 {
                    let radiance = Rgb::new(0.1, 1e4 * pixel as f32, 1e-9) * (1.0 + pass as f32);
                    let seen = Features { normal: [-0.3, 0.0, 0.9], object: 3, ..Features::default() };
                    let layers = Some([radiance * 0.2; LAYERS]);
                    let features = (pixel != 1).then_some(seen);
                    let sample = Sample { radiance, features, layers, widening: 0.5 - pixel as f32 };
                    film.add(pixel, pass, &sample).expect("a radiance");
                }
                let bad = Sample { radiance: Rgb::grey(f32::NAN), ..Sample::default() };
                film.add(0, pass, &bad).expect_err("not a radiance");
            }
            let bytes = film.to_bytes();
            assert_eq!(Film::from_bytes(layout.clone(), &bytes), Ok(film));
            for cut in (0..bytes.len()).filter(|c| *c < 200 || c % 97 == 0 || *c + 200 > bytes.len()) {
                Film::from_bytes(layout.clone(), &bytes[..cut]).expect_err("cut");
            }
            let other = FilmLayout { crop: [0, 0, u32::MAX, u32::MAX], ..layout };
            Film::from_bytes(other, &bytes).expect_err("another size");
        }
    }
}

//! Why an estimate of the error cannot be trusted.
//!
//! A picture's own samples cannot tell that light is missing which no sample found. Photons can: where they bring
//! significantly more light into view than paths found, for all light or for one class of it, the difference is an
//! error that the estimate does not know.
//!
//! *Significant.* In each cell of each level, the difference over its standard error, which counts the noise of
//! both, is compared with sqrt(2 ln(n / [`FALSE_ALARMS`])), n being the number of comparisons: a normal number exceeds
//! z with a chance below exp(-z^2 / 2), so that all together raise an alarm with a chance below [`FALSE_ALARMS`]. Sums
//! of photons are not normal but skewed, which helps: where a rare bright one raises the sum, it raises
//! the standard error as much (one photon alone never makes more than one standard error). The noise of paths is that
//! of all their light in the cell, whatever class is compared.
//!
//! *Not reached.* Light behind a pinhole is found by neither. But paths know what their samples of a light would have
//! brought, had nothing been in the way. Where all n of them were blocked, the share that is not blocked is below 3/n with
//! 95 % (Hanley and Lippman-Hand, "If nothing goes wrong, is everything all right?", JAMA 249, 1983), and so the light is
//! below 3/n of that; samples of different size count as (sum w)^2 / sum w^2. A lamp in the next room is no reason to
//! doubt by that, a million times the light behind a wall is, until more samples are blocked.
//!
//! *Material.* The light that is missing is an error of its own; what would add to the estimate by less than a thirtieth
//! is passed over.

use super::cross::{Level, blocked_formats, relative};
use super::{ErrorEstimate, Film, LIGHT_CLASSES, LIGHTS_APART};
use crate::stats::ERROR_FLOOR;

/// Chance that sound paths are doubted, at most.
const FALSE_ALARMS: f64 = 1e-4;

/// The light that is missing counts from this share of the estimated error on: squared it is added to a square.
const MATERIAL: f64 = 0.25;

/// Share of the squared error of finer cells that coarser ones show at least, where the same is missing all over.
const COARSER: f64 = 0.9;

/// Samples that may arrive, on average, where none did: with 95 %.
const OF_NONE: f64 = 3.0;

/// Standard errors that are taken from the difference, where it says how much is missing at least.
const AT_LEAST: f64 = 2.0;

/// Why an estimate of the error cannot be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// The halves of the film are too noisy to say what the picture converges to.
    TooNoisy,
    /// Few pixels carry the error, effectively; what others would carry has not shown.
    FewPixels {
        /// How many: (sum t)^2 / sum t^2.
        carry: f64,
    },
    /// Photons bring more light into view than paths found.
    LightNotFound {
        /// Where: left, top, right and bottom, half open, pixels of the whole picture.
        pixels: [u32; 4],
        /// How much at least, over what the picture shows there; infinite where that is black.
        share: f64,
        /// From which of the lights that are told apart; `None` where it is all light together.
        light: Option<u8>,
        /// Whether it is a caustic.
        caustic: bool,
    },
    /// No sample of a light arrived, and no photon of it came into view, and there is so much of it that it may matter.
    LightNotReached {
        /// How much of it there may be, over what the picture shows.
        share: f64,
        /// Which of the lights that are told apart.
        light: u8,
    },
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Shown {
    /// Luminance.
    pub(super) luminance: f64,
    /// Variance of that.
    pub(super) variance: f64,
}

/// Light that two witnesses found, W sr^-1 m^-2: sums of luminance over pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoWays {
    /// What photons bring.
    pub photons: f64,
    /// Variance of that.
    pub variance: f64,
    /// What paths found.
    pub paths: f64,
}

/// A cell of a picture: what it shows, and what two witnesses found of that; sums over its pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrossCell {
    /// How coarse it is: 0 is a tile, each next level has four times its side.
    pub level: usize,
    /// Left, top, right and bottom, half open, pixels of the whole picture.
    pub pixels: [u32; 4],
    /// Luminance of the picture, W sr^-1 m^-2.
    pub luminance: f64,
    /// Variance of that: no less than that of what paths found.
    pub variance: f64,
    /// The light that both can see, by class ([`light_class`](super::light_class)).
    pub by_class: [TwoWays; LIGHT_CLASSES],
}

impl CrossCell {
    /// The light of a class, or of all together.
    #[must_use]
    pub fn light(&self, class: Option<usize>) -> TwoWays {
        let add = |a: TwoWays, b: &TwoWays| TwoWays {
            photons: a.photons + b.photons,
            variance: a.variance + b.variance,
            paths: a.paths + b.paths,
        };
        class.map_or_else(|| self.by_class.iter().fold(TwoWays::default(), add), |k| self.by_class[k])
    }
}

impl Film {
    /// What paths and photons found of the same light, in cells of every level, from fine to one for everything;
    /// empty where no photons were traced, or where a pixel has samples of fewer than two replications.
    #[must_use]
    pub fn cross_cells(&self) -> Vec<CrossCell> {
        let Some(cross) = self.cross.as_ref().filter(|x| x.traced > 0) else { return Vec::new() };
        let shown = self.shown();
        if shown.is_empty() {
            return Vec::new();
        }
        let [left, top, width, height] = self.layout.crop;
        let size = [width, height];
        let (fine, traced) = (Level::fine(size), cross.traced as f64);
        // Photons are kept as what they add to the mean of the picture, over the scale.
        let whole = self.pixels() as f64 * f64::from(self.layout.radiance.scale());
        let mut tiles = vec![Shown::default(); fine.len()];
        for (y, row) in (0..).zip(shown.chunks(width as usize)) {
            for (x, s) in (0..).zip(row) {
                let tile = &mut tiles[fine.cell(x, y)];
                tile.luminance += s.luminance;
                tile.variance += s.variance;
            }
        }
        let mut all = Vec::new();
        for (i, level) in Level::all(size).iter().enumerate() {
            let photons = |sums: &[i128; 2]| {
                let [mean, square] = sums.map(|sum| relative().mean(sum, 1) / traced);
                let variance = (square - mean * mean).max(0.0) / traced * (whole * whole);
                TwoWays { photons: mean * whole, variance, paths: 0.0 }
            };
            let cell = |cell: usize| {
                let [x0, y0, x1, y1] = level.bounds(cell, size);
                CrossCell {
                    level: i,
                    pixels: [left + x0, top + y0, left + x1, top + y1],
                    luminance: 0.0,
                    variance: 0.0,
                    by_class: std::array::from_fn(|k| photons(&cross.photons[level.first + cell][k])),
                }
            };
            let mut cells: Vec<CrossCell> = (0..level.len()).map(cell).collect();
            for (tile, (shown, (paths, &n))) in
                tiles.iter().zip(cross.paths.iter().zip(&cross.tiles)).enumerate()
            {
                let [x, y, ..] = fine.bounds(tile, size);
                let cell = &mut cells[level.cell(x, y)];
                cell.luminance += shown.luminance;
                cell.variance += shown.variance;
                for (way, &sum) in cell.by_class.iter_mut().zip(paths) {
                    way.paths += self.layout.radiance.mean(sum, n);
                }
            }
            all.extend(cells);
        }
        all
    }

    /// Light that is missing beside an estimate of the picture's error, or may be: what the estimate cannot know.
    #[must_use]
    pub fn missing_light(&self, error: f64) -> Option<Doubt> {
        self.light_not_found(error).or_else(|| self.light_not_reached(error))
    }

    /// Light of which nothing arrived, beside the estimate of the picture's error.
    fn light_not_reached(&self, error: f64) -> Option<Doubt> {
        let cross = self.cross.as_ref()?;
        let samples: f64 = self.counts.iter().map(|&n| f64::from(n)).sum();
        let [one, two] = blocked_formats();
        // The most that the picture may lack, over the scale of the film.
        let bound = |light: usize| {
            let [sum, squares] = cross.blocked[light];
            let (sum, squares) = (one.mean(sum, 1), two.mean(squares, 1));
            (sum > 0.0).then(|| OF_NONE * squares / (sum * samples))
        };
        let blocked = (0..LIGHTS_APART).filter(|&l| !cross.reached(l));
        let found = blocked.filter_map(|l| Some((bound(l)?, l as u8))).max_by(|a, b| a.0.total_cmp(&b.0));
        let (bound, light) = found?;
        let whole: f64 = self.shown().iter().map(|s| s.luminance).sum();
        let share = bound / (whole / (self.pixels() as f64 * f64::from(self.layout.radiance.scale())));
        let bearable = error.min(ErrorEstimate::NOISIEST);
        (share > MATERIAL * bearable).then_some(Doubt::LightNotReached { share, light })
    }

    /// Light that photons bring and paths did not find, beside the estimate of the picture's error.
    fn light_not_found(&self, error: f64) -> Option<Doubt> {
        let cells = self.cross_cells();
        let c = ERROR_FLOOR * cells.last()?.luminance / self.pixels() as f64;
        let seen = |&k: &usize| cells.iter().any(|c| c.by_class[k].photons > 0.0);
        let classes: Vec<usize> = (0..LIGHT_CLASSES).filter(seen).collect();
        let tests = (cells.len() * (classes.len() + 1)) as f64;
        let limit = (2.0 * libm::log(tests / FALSE_ALARMS)).sqrt();
        // Where noise is so large that nobody knows how large, that is no reason to keep quiet.
        let bearable = error.min(ErrorEstimate::NOISIEST);
        // The squared error that is missing, the level, and what is said of it.
        let mut worst: Option<(f64, usize, Doubt)> = None;
        for level in cells.chunk_by(|a, b| a.level == b.level) {
            for class in classes.iter().map(|&k| Some(k)).chain([None]) {
                // The squared error that is missing in significant cells, and that in the worst of them.
                let (mut squares, mut most) = (0.0, 0.0);
                let mut doubt = None;
                for cell in level {
                    let light = cell.light(class);
                    let missing = light.photons - light.paths;
                    let sigma = (light.variance + cell.variance).sqrt();
                    if missing <= limit * sigma {
                        continue;
                    }
                    let [x0, y0, x1, y1] = cell.pixels;
                    let n = f64::from((x1 - x0) * (y1 - y0));
                    let (r, d) = ((cell.luminance + missing) / n, missing / n);
                    let square = d * d / (r * r + c * c) * n / self.pixels() as f64;
                    squares += square;
                    if square > most {
                        most = square;
                        let least = missing - AT_LEAST * sigma;
                        let share = if cell.luminance > 0.0 { least / cell.luminance } else { f64::INFINITY };
                        let light = class.map(|k| (k / 2) as u8);
                        let caustic = class.is_some_and(|k| k % 2 == 1);
                        doubt = Some(Doubt::LightNotFound { pixels: cell.pixels, share, light, caustic });
                    }
                }
                // In fine cells noise adds to it, so that coarser ones may show a little less of the same.
                let coarser = |l: usize| class.is_some() && level[0].level > l;
                let more = |w: f64, l| squares > w * if coarser(l) { COARSER } else { 1.0 };
                if squares.sqrt() > MATERIAL * bearable && worst.is_none_or(|(w, l, _)| more(w, l)) {
                    worst = doubt.map(|d| (squares, level[0].level, d));
                }
            }
        }
        worst.map(|(.., doubt)| doubt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::{FilmLayout, Found, Glimpse, Sample, light_class};
    use crate::math::mix64;

    const SIDE: u32 = 32;

    fn unit(i: u64) -> f64 {
        (mix64(i + 1) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A picture of ones with some noise, whose paths found one lamp; and `photons`, of which one in four is seen, of a
    /// class and within some columns, so that together they bring a luminance of `light` to those.
    fn film(noise: f64, photons: u32, class: usize, columns: u32, light: f64) -> Film {
        let layout = FilmLayout { cross: true, ..FilmLayout::plain([SIDE; 2]) };
        let mut film = Film::new(layout);
        for pass in 0..16 {
            for pixel in 0..SIDE * SIDE {
                let radiance = Rgb::grey((1.0 + noise * (unit(u64::from(pass << 16 | pixel)) - 0.5)) as f32);
                film.add(pixel as usize, pass, &Sample { radiance, ..Sample::default() })
                    .expect("a radiance");
            }
            for tile in 0..4 {
                let mut found = Found::default();
                found.by_class[0] = 256.0;
                film.found(tile, &found);
            }
        }
        // All light of the picture in one photon, as `Glimpse` has it.
        let luminance = (4.0 * light * f64::from(columns * SIDE)) as f32;
        let seen = |i: u32| Glimpse {
            photon: i,
            pixel: (unit(u64::from(i) << 20) * f64::from(SIDE)) as u32 * SIDE
                + (unit(u64::from(i) << 20 | 1) * f64::from(columns)) as u32,
            class: class as u8,
            luminance,
        };
        let seen: Vec<Glimpse> = (0..photons).step_by(4).map(seen).collect();
        film.glimpses(photons, &seen);
        film
    }

    fn doubt(film: &Film) -> Option<Doubt> {
        film.error().expect("an estimate").doubt
    }

    /// Guards pictures that photons agree with, and photons that are too few to say anything.
    #[test]
    fn agreement_is_no_doubt() {
        assert_eq!(doubt(&film(0.2, 40_000, 0, SIDE, 1.0)), None);
        assert_eq!(doubt(&film(0.2, 40_000, 0, SIDE, 0.5)), None);
        assert_eq!(doubt(&film(0.2, 40, 1, SIDE, 0.5)), None);
    }

    /// Guards what is said: how much at least, where, of which light.
    #[test]
    fn what_is_missing_is_said() {
        let class = light_class(2, true);
        match doubt(&film(0.2, 40_000, class, SIDE, 0.5)) {
            Some(Doubt::LightNotFound { pixels, share, light: Some(2), caustic: true }) => {
                assert_eq!(pixels, [0, 0, SIDE, SIDE]);
                assert!((0.45..0.5).contains(&share), "{share}");
            }
            other => panic!("{other:?}"),
        }
        // In the left half alone.
        match doubt(&film(0.2, 40_000, class, SIDE / 2, 0.5)) {
            Some(Doubt::LightNotFound { pixels: [0, _, right, _], light: Some(2), .. }) => {
                assert!(right <= SIDE, "{right}");
            }
            other => panic!("{other:?}"),
        }
        // More of what paths did find.
        let found = doubt(&film(0.2, 40_000, 0, SIDE, 1.5));
        assert!(matches!(found, Some(Doubt::LightNotFound { caustic: false, .. })), "{found:?}");
    }

    /// Guards what is said of looks between those that look for light: what is missing before all, what may be after the rest.
    #[test]
    fn missing_light_is_remembered() {
        let film = film(0.2, 40_000, light_class(2, true), SIDE, 0.5);
        let squares = film.error_squares().expect("squares");
        let missing = film.missing_light(squares.estimate().error);
        assert!(matches!(missing, Some(Doubt::LightNotFound { .. })), "{missing:?}");
        assert_eq!(film.error_beside(&squares, missing), film.error_of(&squares));
        assert!(film.error_beside(&squares, None).trusted);
        let few = crate::film::Squares { of_pixels: vec![1e-4; 4], ..squares };
        assert_eq!(film.error_beside(&few, missing).doubt, missing);
        let may_be = Some(Doubt::LightNotReached { share: 1.0, light: 0 });
        assert!(matches!(film.error_beside(&few, may_be).doubt, Some(Doubt::FewPixels { .. })));
    }

    /// Guards the bound of light that never arrived. By hand: of the 16 passes over 1024 pixels that are ones, each fourth
    /// sample is blocked from a light that would bring 500; three more than none would bring 3 * 500 of 16384. And that one
    /// that arrived, or one photon, ends the doubt, and that the share matters.
    #[test]
    fn light_that_never_arrives_has_a_bound() {
        let with = |size: f64, found: Option<f64>| {
            let mut film = film(0.2, 40, 0, SIDE, 0.0);
            for _ in 0..16 * 4 {
                let mut of = Found { blocked: [[0.0; 2]; LIGHTS_APART], ..Found::default() };
                of.blocked[1] = [64.0 * size, 64.0 * size * size];
                film.found(0, &of);
            }
            if let Some(light) = found {
                let mut of = Found::default();
                of.by_class[light_class(1, true)] = light;
                film.found(0, &of);
            }
            doubt(&film)
        };
        match with(500.0, None) {
            Some(Doubt::LightNotReached { share, light: 1 }) => {
                assert!((share / (3.0 * 500.0 / 16384.0) - 1.0).abs() < 0.02, "{share}");
            }
            other => panic!("{other:?}"),
        }
        assert_eq!(with(500.0, Some(1e-3)), None);
        assert_eq!(with(5.0, None), None);
    }

    /// Guards that little is passed over where noise is large, and only there.
    #[test]
    fn what_does_not_matter_is_not_said() {
        let class = light_class(1, false);
        assert_eq!(doubt(&film(1.2, 400_000, class, SIDE, 0.01)), None);
        assert!(doubt(&film(0.02, 400_000, class, SIDE, 0.01)).is_some());
    }
}

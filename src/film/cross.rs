//! Sums that tell what two witnesses find of the same light: paths from the camera, and photons from the lights.
//!
//! In: for each tile of a pass, what its paths found, and what photons of the pass brought into view. Out: the same
//! light in square cells of the picture, twice. Only light is compared that both can see, `E D (D|S)* L` in
//! Heckbert's notation: a photon cannot be connected to the camera from a mirror. It falls into classes, by the
//! lights that it comes from and by whether it is a caustic, `E D (D|S)* S L`: what is missing is rarely a little of
//! everything.
//!
//! Cells are the tiles of the picture, and for photons also squares of 4 x 4, 16 x 16, .. of them up to the whole,
//! since a photon that is seen in several cells does not count as several. All sums are integers, as the film's are.

use super::FixedPoint;

/// Side of a cell, pixels; the tiles that pictures are rendered in are the same.
pub const CELL: u32 = 16;

/// Lights that are told apart: the most powerful ones, and all others together as the last one.
pub const LIGHTS_APART: usize = 4;

/// Classes of light: see [`light_class`].
pub const LIGHT_CLASSES: usize = 2 * LIGHTS_APART;

/// The class of light from a light, below [`LIGHTS_APART`], that is a caustic or not.
#[inline]
#[must_use]
pub fn light_class(light: u8, caustic: bool) -> usize {
    2 * usize::from(light) + usize::from(caustic)
}

/// What the paths of a tile found in one pass, and what was in their way: sums of luminance over its pixels,
/// W sr^-1 m^-2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Light by class.
    pub by_class: [f64; LIGHT_CLASSES],
    /// From each light that is told apart: what its samples would have brought that were blocked, had nothing been in
    /// their way; and the sum of the squares.
    pub blocked: [[f64; 2]; LIGHTS_APART],
}

/// A photon that the camera sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glimpse {
    /// Which of the photons that are added together; one is seen from each place where it lands.
    pub photon: u32,
    /// Pixel of the crop, row-major.
    pub pixel: u32,
    /// See [`light_class`]: the same wherever the photon is seen.
    pub class: u8,
    /// What it adds to the luminance of the pixel if it stands for all light, W sr^-1 m^-2.
    pub luminance: f32,
}

/// Sums of what both found.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CrossSums {
    /// Tiles of passes that were added, by cell.
    pub(super) tiles: Vec<u32>,
    /// What their paths found, by cell and class.
    pub(super) paths: Vec<[i128; LIGHT_CLASSES]>,
    /// What photons brought, by cell of every level from fine to coarse, and class: the sum over photons of what each
    /// adds to the mean of the picture, and of its square.
    pub(super) photons: Vec<[[i128; 2]; LIGHT_CLASSES]>,
    /// From each light that is told apart, what was blocked, over the scale of the film, and the squares of it.
    pub(super) blocked: [[i128; 2]; LIGHTS_APART],
    /// Photons that were traced.
    pub(super) traced: u64,
}

/// A grid of cells over a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Level {
    /// Side of a cell, pixels.
    pub(super) side: u32,
    /// Columns and rows.
    pub(super) cells: [u32; 2],
    /// Index of its first cell among those of all levels.
    pub(super) first: usize,
}

impl Level {
    /// The one whose cells are tiles.
    pub(super) fn fine(size: [u32; 2]) -> Self {
        Self { side: CELL, cells: size.map(|n| n.div_ceil(CELL)), first: 0 }
    }

    /// Those of a picture of `size` pixels, from fine to one cell for everything.
    pub(super) fn all(size: [u32; 2]) -> Vec<Self> {
        let (mut levels, mut side, mut first) = (Vec::new(), CELL, 0);
        loop {
            let cells = size.map(|n| n.div_ceil(side));
            levels.push(Self { side, cells, first });
            first += cells[0] as usize * cells[1] as usize;
            if cells[0] <= 1 && cells[1] <= 1 {
                return levels;
            }
            side = side.saturating_mul(4);
        }
    }

    /// Number of cells.
    pub(super) fn len(&self) -> usize {
        self.cells[0] as usize * self.cells[1] as usize
    }

    /// The cell of a pixel, counted from the first of this level.
    pub(super) fn cell(&self, x: u32, y: u32) -> usize {
        (y / self.side * self.cells[0] + x / self.side) as usize
    }

    /// Left, top, right and bottom of a cell in a picture of `size` pixels, half open.
    pub(super) fn bounds(&self, cell: usize, size: [u32; 2]) -> [u32; 4] {
        let (x, y) = (cell as u32 % self.cells[0] * self.side, cell as u32 / self.cells[0] * self.side);
        let end = |at: u32, size: u32| at.saturating_add(self.side).min(size);
        [x, y, end(x, size[0]), end(y, size[1])]
    }
}

impl CrossSums {
    /// Empty ones for a picture of `size` pixels.
    pub(super) fn new(size: [u32; 2]) -> Self {
        let levels = Level::all(size);
        let fine = levels.first().map_or(0, Level::len);
        let all = levels.last().map_or(0, |l| l.first + l.len());
        Self {
            tiles: vec![0; fine],
            paths: vec![[0; LIGHT_CLASSES]; fine],
            photons: vec![[[0; 2]; LIGHT_CLASSES]; all],
            blocked: [[0; 2]; LIGHTS_APART],
            traced: 0,
        }
    }

    /// Adds what the paths of a tile found; what is not finite is left out.
    pub(super) fn found(&mut self, tile: usize, found: &Found, format: FixedPoint) {
        self.tiles[tile] += 1;
        for (sum, &v) in self.paths[tile].iter_mut().zip(&found.by_class) {
            let v = v as f32;
            if format.holds(v) {
                *sum += format.encode(v);
            }
        }
        let scale = f64::from(format.scale());
        for (sums, [sum, squares]) in self.blocked.iter_mut().zip(found.blocked) {
            let added = blocked([sum / scale, squares / (scale * scale)]);
            sums.iter_mut().zip(added).for_each(|(sum, v)| *sum = sum.saturating_add(v));
        }
    }

    /// Adds what another estimator supplied of a class that paths leave to it, to a pixel in `cell`.
    pub(super) fn supplied(&mut self, cell: usize, class: usize, luminance: f32, format: FixedPoint) {
        if format.holds(luminance) {
            self.paths[cell][class] += format.encode(luminance);
        }
    }

    /// Adds `traced` photons, of which `seen` are the glimpses, those of one photon after each other.
    pub(super) fn photons(
        &mut self,
        traced: u32,
        seen: &[Glimpse],
        [width, height]: [u32; 2],
        format: FixedPoint,
    ) {
        self.traced += u64::from(traced);
        let levels = Level::all([width, height]);
        let share = 1.0 / (f64::from(width) * f64::from(height));
        // What one photon adds to each cell of a level.
        let mut cells: Vec<(usize, f64)> = Vec::new();
        for photon in seen.chunk_by(|a, b| a.photon == b.photon) {
            let class = usize::from(photon[0].class);
            for level in &levels {
                cells.clear();
                for glimpse in photon {
                    let own = level.first + level.cell(glimpse.pixel % width, glimpse.pixel / width);
                    let luminance = f64::from(glimpse.luminance);
                    match cells.iter_mut().find(|(cell, _)| *cell == own) {
                        Some((_, sum)) => *sum += luminance,
                        None => cells.push((own, luminance)),
                    }
                }
                for &(cell, sum) in &cells {
                    let sums = &mut self.photons[cell][class];
                    let added = moments(sum * share / f64::from(format.scale()));
                    sums.iter_mut().zip(added).for_each(|(sum, v)| *sum += v);
                }
            }
        }
    }

    /// Adds what others hold.
    pub(super) fn merge(&mut self, other: &Self) {
        self.tiles.iter_mut().zip(&other.tiles).for_each(|(n, other)| *n += other);
        let own = self.paths.iter_mut().flatten().zip(other.paths.iter().flatten());
        own.for_each(|(sum, other)| *sum += other);
        let (own, other_sums) = (self.photons.as_flattened_mut(), other.photons.as_flattened());
        let own = own.iter_mut().flatten().zip(other_sums.iter().flatten());
        own.for_each(|(sum, other)| *sum += other);
        let own = self.blocked.iter_mut().flatten().zip(other.blocked.iter().flatten());
        own.for_each(|(sum, other)| *sum = sum.saturating_add(*other));
        self.traced += other.traced;
    }

    /// Whether paths or photons found some light from the one of this number.
    pub(super) fn reached(&self, light: usize) -> bool {
        let of = [false, true].map(|caustic| light_class(light as u8, caustic));
        of.iter().any(|&k| self.paths.iter().any(|p| p[k] != 0) || self.photons.iter().any(|p| p[k][0] != 0))
    }
}

/// The format of [`moments`]: what photons bring, over the scale of the film.
pub(super) fn relative() -> FixedPoint {
    FixedPoint::around(1.0)
}

/// The formats of what was blocked over the scale of the film, and of its squares. The scale is that of the brightest
/// light, from which little arrives that is as bright: squares need digits.
pub(super) fn blocked_formats() -> [FixedPoint; 2] {
    [FixedPoint::around(1.0), FixedPoint::around(1.0 / 1024.0)]
}

/// A sum and a sum of squares as integers. Where numbers are too large, they all count as so many times smaller.
fn blocked([sum, squares]: [f64; 2]) -> [i128; 2] {
    const LARGEST: f64 = 32_768.0; // 2^15: its square is held
    if !(sum > 0.0 && sum < f64::INFINITY && squares < f64::INFINITY) {
        return [0; 2];
    }
    let shrink = (LARGEST / sum).min(1.0);
    let [one, two] = blocked_formats();
    [one.encode((sum * shrink) as f32), two.encode((squares * shrink * shrink) as f32)]
}

/// A number and its square as integers. What is too large to be squared counts as the largest that is not, which makes
/// photons find less, never more.
fn moments(x: f64) -> [i128; 2] {
    const LARGEST: f64 = 1_048_576.0; // 2^20
    let x = if x.is_nan() { 0.0 } else { x.clamp(0.0, LARGEST) };
    let format = relative();
    [x as f32, (x * x) as f32].map(|v| format.encode(v))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glimpse(photon: u32, pixel: u32, luminance: f32) -> Glimpse {
        Glimpse { photon, pixel, class: 3, luminance }
    }

    /// Guards the grids: each pixel lies in the bounds of its cell, and the last level is one cell.
    #[test]
    fn levels_tile_the_picture() {
        for size in [[1, 1], [16, 16], [17, 3], [200, 70]] {
            let levels = Level::all(size);
            assert_eq!(levels.last().map(|l| l.cells), Some([1, 1]));
            for l in &levels {
                for (x, y) in [(0, 0), (size[0] - 1, size[1] - 1), (size[0] / 2, size[1] / 3)] {
                    let [left, top, right, bottom] = l.bounds(l.cell(x, y), size);
                    assert!((left..right).contains(&x) && (top..bottom).contains(&y));
                    assert!(l.cell(x, y) < l.len());
                }
            }
        }
    }

    /// Guards squares: a photon that is seen twice in a cell is one number there, and two in two cells.
    #[test]
    fn a_photon_is_one_number_in_each_cell() {
        let size = [32, 16];
        let mut sums = CrossSums::new(size);
        let format = FixedPoint::around(2.0);
        let seen = [glimpse(0, 0, 512.0), glimpse(0, 1, 512.0), glimpse(0, 20, 1024.0), glimpse(2, 0, 512.0)];
        sums.photons(5, &seen, size, format);
        let mean = |cell: usize, k: usize| relative().mean(sums.photons[cell][3][k], 1);
        // Over 512 pixels and a scale of two: a luminance of 1024 is one.
        assert_eq!([mean(0, 0), mean(0, 1)], [1.5, 1.25]);
        assert_eq!([mean(1, 0), mean(1, 1)], [1.0, 1.0]);
        assert_eq!([mean(2, 0), mean(2, 1)], [2.5, 4.25]);
        assert_eq!(sums.traced, 5);
        let mut twice = sums.clone();
        twice.merge(&sums);
        assert_eq!(twice.photons[2][3][0], 2 * sums.photons[2][3][0]);
        // Seen very often, in one place and in many.
        let often: Vec<Glimpse> = (0..200).map(|i| glimpse(0, i % 3 * 16 % 32, 1.0)).collect();
        let mut sums = CrossSums::new(size);
        sums.photons(1, &often, size, format);
        let total: f64 = (0..2).map(|c| relative().mean(sums.photons[c][3][0], 1)).sum();
        assert!((total - 200.0 / 1024.0).abs() < 1e-6, "{total}");
    }
}

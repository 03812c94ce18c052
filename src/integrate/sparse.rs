//! Some of a picture's pixels, which stand for all of them: a small picture that costs what a small picture costs, and is
//! as noisy as the large one.
//!
//! In: a picture, or a part of it. Out: a grid of blocks, in each of which one pixel is rendered, by the very samples
//! that the picture has there. Photons light all pixels, so that fewer pixels would not need fewer of them. Therefore
//! they are those of a picture whose pixels are [`coarse`](Sparse::coarse) times as wide: fewer photons, disks as much
//! wider, and what the camera sees of them directly averaged over as many pixels. Each pixel then has as many
//! photons, and the noise that these make, as it has in the picture; only what is finer than that is blurred.

use super::photon::photons;
use crate::math::mix64;

/// Some of the pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sparse {
    /// Left, top, width and height of what the grid covers, pixels of the whole picture.
    crop: [u32; 4],
    /// Columns and rows of blocks.
    grid: [u32; 2],
    coarse: u32,
}

impl Sparse {
    /// About `pixels` of those of `crop` (left, top, width, height; at least 1x1) in a picture of `size`, with the photons
    /// of a picture of `photons_of` pixels, or more where blocks are small; `None` where that would be all of them.
    #[must_use]
    pub fn new(size: [u32; 2], crop: [u32; 4], pixels: u64, photons_of: u64) -> Option<Self> {
        let [.., width, height] = crop;
        let wide = (f64::from(width) * f64::from(height) / pixels.max(1) as f64).sqrt();
        if wide <= 1.0 {
            return None;
        }
        // The shorter side first: the longer one makes up for its rounding.
        let shorter = usize::from(height < width);
        let mut grid = [width, height];
        grid[shorter] = ((f64::from(grid[shorter]) / wide).round() as u32).max(1);
        let rest = (pixels as f64 / f64::from(grid[shorter])).round() as u32;
        grid[1 - shorter] = rest.clamp(1, grid[1 - shorter]);
        if grid == [width, height] {
            return None;
        }
        let all = photons(u64::from(size[0]) * u64::from(size[1]));
        let coarse = (f64::from(all) / photons_of.max(1) as f64).sqrt() as u32;
        // What is averaged lies within a block.
        let smallest = (width / grid[0]).min(height / grid[1]);
        Some(Self { crop, grid, coarse: coarse.clamp(1, smallest) })
    }

    /// Whether it covers this part of a picture, which is inside of it.
    pub(super) fn is_of(&self, size: [u32; 2], crop: [u32; 4]) -> bool {
        let end = |axis: usize| u64::from(crop[axis]) + u64::from(crop[2 + axis]);
        self.crop == crop && (0..2).all(|axis| end(axis) <= u64::from(size[axis]))
    }

    /// Columns and rows of the pixels that are rendered.
    #[must_use]
    pub fn grid(&self) -> [u32; 2] {
        self.grid
    }

    /// Pixels for each one that is rendered.
    #[must_use]
    pub fn every(&self) -> f64 {
        let pixels = |[a, b]: [u32; 2]| f64::from(a) * f64::from(b);
        pixels([self.crop[2], self.crop[3]]) / pixels(self.grid)
    }

    /// Width of the pixels that photons are traced for, in those of the picture.
    #[must_use]
    pub fn coarse(&self) -> u32 {
        self.coarse
    }

    /// The pixel of the whole picture that is rendered in a block.
    #[must_use]
    pub fn pixel(&self, block: [u32; 2]) -> [u32; 2] {
        let chance = mix64(u64::from(block[1]) << 32 | u64::from(block[0]));
        let halves = [chance >> 32, chance & 0xffff_ffff];
        std::array::from_fn(|i| {
            let (begin, end) = self.bounds(i, block[i]);
            begin + ((halves[i] * u64::from(end - begin)) >> 32) as u32
        })
    }

    /// Where light goes that reaches a pixel of the whole picture, and how much of it: to the pixel of its block, in columns
    /// and rows of the grid, where it is near that.
    pub(super) fn catches(&self, pixel: [u32; 2]) -> Option<([u32; 2], f32)> {
        let block = std::array::from_fn(|i| {
            let (n, at) = (u64::from(self.grid[i]), u64::from(pixel[i] - self.crop[i]));
            (((at + 1) * n - 1) / u64::from(self.crop[2 + i])) as u32
        });
        let own = self.pixel(block);
        let near = (0..2).all(|i| {
            let (begin, end) = self.bounds(i, block[i]);
            let first = own[i].saturating_sub(self.coarse / 2).clamp(begin, end - self.coarse);
            (first..first + self.coarse).contains(&pixel[i])
        });
        near.then(|| (block, 1.0 / (self.coarse * self.coarse) as f32))
    }

    /// The first column (axis 0) or row (axis 1) of the whole picture that belongs to a block, and the first one beyond.
    fn bounds(&self, axis: usize, block: u32) -> (u32, u32) {
        let begin = |b: u32| {
            let at = u64::from(b) * u64::from(self.crop[2 + axis]) / u64::from(self.grid[axis]);
            self.crop[axis] + at as u32
        };
        (begin(block), begin(block + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards that each block has its pixel, all pixels have a block, and light of one goes all to the pixels of the grid:
    /// each of these catches that of as many pixels as photons are coarse.
    #[test]
    fn blocks_tile_a_picture() {
        for (size, crop, pixels) in
            [([800, 600], [0, 0, 800, 600], 4096), ([97, 61], [3, 5, 90, 50], 200), ([9, 1], [0, 0, 9, 1], 4)]
        {
            let sparse = Sparse::new(size, crop, pixels, 2 * pixels).expect("fewer");
            let [columns, rows] = sparse.grid();
            let rendered = u64::from(columns * rows);
            assert!((pixels * 9 / 10..=pixels * 11 / 10).contains(&rendered), "{sparse:?}");
            let mut caught = vec![0.0; (columns * rows) as usize];
            let [left, top, width, height] = crop;
            for (x, y) in (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y))) {
                if let Some(([column, row], share)) = sparse.catches([x, y]) {
                    caught[(row * columns + column) as usize] += share;
                }
            }
            assert!(caught.iter().all(|&c: &f32| (c - 1.0).abs() < 1e-5), "{sparse:?}");
            for block in (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row])) {
                assert_eq!(sparse.catches(sparse.pixel(block)).map(|c| c.0), Some(block), "{sparse:?}");
            }
        }
        assert_eq!(Sparse::new([64, 64], [0, 0, 64, 64], 4096, 4096), None);
        assert_eq!(Sparse::new([72, 57], [0, 0, 72, 57], 4096, 4096), None);
        // 800x800: blocks of 12.5 pixels; photons as for 8192 pixels of 8 wide.
        let hexroom = Sparse::new([800, 800], [0, 0, 800, 800], 4096, 8192).expect("fewer");
        assert_eq!((hexroom.grid(), hexroom.coarse()), ([64, 64], 8));
        assert!((hexroom.every() - 156.25).abs() < 1e-9);
    }
}

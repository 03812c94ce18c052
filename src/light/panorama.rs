//! An environment that is a picture of all directions.
//!
//! In: the picture, a factor and a turn, as [`crate::scene::EnvironmentImage`] has them. Out: radiance
//! along a direction (bilinear between texels, around the sides, clamped at top and bottom), and
//! directions in proportion to it. The density is constant in each cell of a grid, which is as fine as
//! the picture up to [`MOST_CELLS`]; a cell weighs what the bilinear lookup has in it, so that whatever
//! shines can be found. Within a cell directions are uniform by solid angle: a picture of one colour is
//! sampled as a uniform sphere.

use std::sync::Arc;

use glam::Vec3;

use crate::color::{Rgb, srgb_to_linear};
use crate::math::{self, PI, safe_sqrt, sin_cos_turn};
use crate::sampling::Grid;
use crate::scene::{Pixels, Texels};

/// Cells of the grid of directions, at most; a finer picture has several texels in each.
const MOST_CELLS: u64 = 1 << 22;

/// A picture of all directions.
#[derive(Clone, Debug)]
pub struct Panorama {
    pixels: Arc<Pixels>,
    /// Linear value of each integer; empty for pictures that are linear.
    decoded: Vec<f32>,
    /// W sr^-1 m^-2 for a texel of one.
    factor: Rgb,
    /// Turns about +Y, counter-clockwise from above, [0, 1).
    turn: f32,
    grid: Grid,
    /// Texels along the sides of a cell.
    side: usize,
    /// Cosines of the polar angles between rows of cells, from one to minus one.
    cosines: Vec<f64>,
    /// Inverse of the solid angle of a cell of full width, for each row.
    densities: Vec<f32>,
    irradiance: f32,
    mean: Rgb,
    brightest: Rgb,
}

impl Panorama {
    /// A picture times `factor`, turned by `rotation` radians.
    #[must_use]
    pub fn new(pixels: Arc<Pixels>, factor: Rgb, rotation: f64) -> Self {
        Self::with_cells(pixels, factor, rotation, MOST_CELLS)
    }

    fn with_cells(pixels: Arc<Pixels>, factor: Rgb, rotation: f64, most: u64) -> Self {
        use std::f64::consts::{PI, TAU};
        let (w, h) = (pixels.width as usize, pixels.height as usize);
        let side = (1..)
            .find(|&k| pixels.width.div_ceil(k) as u64 * u64::from(pixels.height.div_ceil(k)) <= most)
            .unwrap_or(1) as usize;
        let decode = |steps: u32| (0..=steps).map(|i| srgb_to_linear(i as f32 / steps as f32)).collect();
        let decoded: Vec<f32> = match &pixels.texels {
            Texels::Byte(_) => decode(255),
            Texels::Short(_) => decode(65_535),
            Texels::Float(_) => Vec::new(),
        };
        let rows = h.div_ceil(side);
        let edge = |j: usize| libm::cos(PI * (j * side).min(h) as f64 / h as f64);
        let mut cosines: Vec<f64> = (0..=rows).map(edge).collect();
        cosines[rows] = -1.0;
        let solid = |j: usize| TAU * side as f64 / w as f64 * (cosines[j] - cosines[j + 1]);
        let densities = (0..rows).map(|j| (1.0 / solid(j)) as f32).collect();
        let turn = rotation / TAU;
        let mut map = Self {
            decoded,
            factor,
            turn: (turn - turn.floor()) as f32,
            grid: Grid::default(),
            side,
            densities,
            irradiance: 0.0,
            mean: Rgb::BLACK,
            brightest: Rgb::BLACK,
            cosines,
            pixels,
        };
        map.distribute(w, h, rows);
        map
    }

    /// Fills in the distribution, and the sums over all directions.
    fn distribute(&mut self, w: usize, h: usize, rows: usize) {
        use std::f64::consts::{PI, TAU};
        let (columns, side) = (w.div_ceil(self.side), self.side);
        let mut brightest = Rgb::BLACK;
        for y in 0..h {
            for x in 0..w {
                let t = self.texel(x, y);
                brightest = Rgb::new(brightest.r.max(t.r), brightest.g.max(t.g), brightest.b.max(t.b));
            }
        }
        // The integral of the lookup over one texel is 1/8, 3/4 and 1/8 of its neighbours along each side.
        let spread = |before: f64, own: f64, after: f64| 0.125 * (before + after) + 0.75 * own;
        let line = |y: usize| -> Vec<f64> {
            let own: Vec<f64> = (0..w).map(|x| f64::from(self.texel(x, y).luminance())).collect();
            (0..w).map(|x| spread(own[(x + w - 1) % w], own[x], own[(x + 1) % w])).collect()
        };
        let angle = |i: usize, n: usize| PI * i as f64 / n as f64;
        // What a texel's width leaves of the sum of its directions.
        let widening = libm::sin(angle(1, w)) / angle(1, w);
        let (mut total, mut flow) = (0.0, [0.0f64; 3]);
        // The lines above, at and below the current row of texels.
        let first = line(0);
        let mut lines = [first.clone(), first, line(1.min(h - 1))];
        let mut y = 0;
        let grid = Grid::new(
            columns,
            rows,
            |j| self.cosines[j] - self.cosines[j + 1],
            |_, out| {
                for _ in 0..side.min(h - y) {
                    let (top, bottom) = (libm::cos(angle(y, h)), libm::cos(angle(y + 1, h)));
                    let solid = TAU / w as f64 * (top - bottom);
                    let z = 0.5 * (top + bottom);
                    let r = widening * (1.0 - z * z).sqrt();
                    for x in 0..w {
                        let weight = spread(lines[0][x], lines[1][x], lines[2][x]) * solid;
                        out[x / side] += weight;
                        let phi = 2.0 * angle(x, w) + angle(1, w);
                        total += weight;
                        let way = [r * libm::sin(phi), z, -r * libm::cos(phi)];
                        flow.iter_mut().zip(way).for_each(|(f, c)| *f += weight * c);
                    }
                    y += 1;
                    lines.rotate_left(1);
                    if y < h {
                        lines[2] = if y + 1 < h { line(y + 1) } else { lines[1].clone() };
                    }
                }
            },
        );
        // Irradiance on a plane is half of the integral of L |cos| and half of that of L cos; the first is
        // taken for that of light from everywhere.
        let net = flow.iter().map(|f| f * f).sum::<f64>().sqrt();
        self.irradiance = (0.25 * total + 0.5 * net) as f32;
        self.mean = Rgb::grey((total / (4.0 * PI)) as f32);
        self.grid = grid;
        self.brightest = brightest;
    }

    /// A texel times the factor.
    #[inline]
    fn texel(&self, x: usize, y: usize) -> Rgb {
        let i = y * self.pixels.width as usize + x;
        let [r, g, b] = match &self.pixels.texels {
            Texels::Byte(t) => [t[i][0], t[i][1], t[i][2]].map(|c| self.decoded[usize::from(c)]),
            Texels::Short(t) => [t[i][0], t[i][1], t[i][2]].map(|c| self.decoded[usize::from(c)]),
            Texels::Float(t) => t[i],
        };
        Rgb::new(r, g, b) * self.factor
    }

    /// Where a direction lies in the picture, texels from its upper left corner.
    #[inline]
    fn locate(&self, d: Vec3) -> [f32; 2] {
        let u = 0.5 + math::atan2(d.x, -d.z) / (2.0 * PI) + self.turn;
        let v = math::atan2((d.x * d.x + d.z * d.z).sqrt(), d.y) / PI;
        [(u - u.floor()) * self.pixels.width as f32, v * self.pixels.height as f32]
    }

    /// Radiance from the unit direction `d`, W sr^-1 m^-2.
    #[must_use]
    pub fn radiance(&self, d: Vec3) -> Rgb {
        let (w, h) = (self.pixels.width as usize, self.pixels.height as usize);
        let [x, y] = self.locate(d).map(|c| c - 0.5);
        let (x0, y0) = (x.floor(), y.floor());
        let (tx, ty) = (x - x0, y - y0);
        // -1 is the last column, and `w` the first.
        let column = |i: i64| i.rem_euclid(w as i64) as usize;
        let row = |i: i64| i.clamp(0, h as i64 - 1) as usize;
        let [left, right] = [column(x0 as i64), column(x0 as i64 + 1)];
        let along = |y: usize| self.texel(left, y) * (1.0 - tx) + self.texel(right, y) * tx;
        along(row(y0 as i64)) * (1.0 - ty) + along(row(y0 as i64 + 1)) * ty
    }

    /// Density per solid angle with which [`Self::sample`] finds the unit direction `d`.
    #[must_use]
    pub fn pdf(&self, d: Vec3) -> f32 {
        let (w, h) = (self.pixels.width as usize, self.pixels.height as usize);
        let [x, y] = self.locate(d);
        let (column, row) = ((x as usize).min(w - 1) / self.side, (y as usize).min(h - 1) / self.side);
        // The last column may be narrower.
        let texels = self.side.min(w - column * self.side);
        self.grid.pmf(row, column) * self.densities[row] * (self.side as f32 / texels as f32)
    }

    /// A direction, in proportion to what comes from there; `None` where nothing does.
    #[must_use]
    pub fn sample(&self, u: [f32; 2]) -> Option<Vec3> {
        let w = self.pixels.width as usize;
        let cell = self.grid.sample(u)?;
        let [top, bottom] = [cell.row, cell.row + 1].map(|j| self.cosines[j]);
        let y = top + (bottom - top) * f64::from(cell.within[0]);
        let r = safe_sqrt(((1.0 - y) * (1.0 + y)) as f32);
        let first = cell.column * self.side;
        let texels = self.side.min(w - first);
        let x = (first as f32 + texels as f32 * cell.within[1]) / w as f32;
        let (s, c) = sin_cos_turn(x - 0.5 - self.turn);
        Vec3::new(r * s, y as f32, -r * c).try_normalize()
    }

    /// True where it is black.
    #[must_use]
    pub fn is_black(&self) -> bool {
        self.grid.is_empty()
    }

    /// Luminance of the mean over all directions, as a grey.
    #[must_use]
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// Luminance of about the irradiance on a plane that faces where most comes from, W m^-2.
    #[must_use]
    pub fn irradiance(&self) -> f32 {
        self.irradiance
    }

    /// The largest value of each channel, W sr^-1 m^-2.
    #[must_use]
    pub fn brightest(&self) -> Rgb {
        self.brightest
    }
}

#[cfg(test)]
mod tests;

//! What is looked at: the choice of statistics from pilots.

use super::statistic::{Kind, Statistic};
use crate::stats::Moments;

/// A run as planes of numbers, all of one size; row-major, top row first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planes {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Names such as `luminance`, `red` or `caustic`, each with one number a pixel.
    pub planes: Vec<(String, Vec<f32>)>,
    /// Numbers about the run as a whole, such as the logarithm of its noise, by name.
    pub scalars: Vec<(String, f64)>,
}

/// What pilots look like: all that the choice of statistics and weights rests on.
///
/// Numbers are kept to eight binary digits. Weights need no more, and files that hold a profile are small.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profile {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Of each plane its name, and the mean and the variance of each pixel over pilots.
    pub planes: Vec<(String, Vec<f32>, Vec<f32>)>,
    /// Names of the scalars.
    pub scalars: Vec<String>,
}

impl Profile {
    /// `None` where there are fewer than two pilots, or they differ in size or planes.
    #[must_use]
    pub fn new(pilots: &[Planes]) -> Option<Self> {
        let first = pilots.first().filter(|_| pilots.len() >= 2)?;
        if !pilots.iter().all(|p| p.is_like(first)) {
            return None;
        }
        let plane = |(k, (name, _)): (usize, &(String, Vec<f32>))| {
            let of = |i: usize| Moments::from_iter(pilots.iter().map(|r| f64::from(r.planes[k].1[i])));
            let pixels = (0..first.width * first.height).map(of);
            let (mean, variance) = pixels.map(|m| (eight_bits(m.mean), eight_bits(m.variance()))).unzip();
            (name.clone(), mean, variance)
        };
        Some(Self {
            width: first.width,
            height: first.height,
            planes: first.planes.iter().enumerate().map(plane).collect(),
            scalars: first.scalars.iter().map(|(name, _)| name.clone()).collect(),
        })
    }

    /// Mean over pilots of the plane of this name.
    #[must_use]
    pub fn mean(&self, plane: &str) -> Option<&[f32]> {
        self.planes.iter().find(|(name, ..)| name == plane).map(|(_, mean, _)| mean.as_slice())
    }
}

/// Rounds towards zero to a float with eight digits of its mantissa.
fn eight_bits(v: f64) -> f32 {
    f32::from_bits((v as f32).to_bits() & 0xffff_8000)
}

/// Share of the median that is added to a pixel's mean before it divides, so that dark pixels do not decide;
/// `None` where the plane is black.
#[must_use]
pub fn floor(mean: &[f32]) -> Option<f64> {
    let mut positive: Vec<f32> = mean.iter().copied().filter(|&v| v > 0.0).collect();
    positive.sort_by(f32::total_cmp);
    positive.get(positive.len() / 2).map(|&m| FLOOR * f64::from(m))
}

/// All statistics that a run is judged by.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// They share the significance.
    pub statistics: Vec<Statistic>,
    width: usize,
    height: usize,
}

/// See [`floor`].
const FLOOR: f64 = 0.05;
/// Sides of tiles, pixels; each size is laid twice, the second time shifted by half a tile.
const SIDES: [usize; 2] = [8, 16];
/// Waves have fewer half waves than this along each side.
const WAVES: usize = 6;
/// Name of the plane that tiles and waves look at.
const LUMINANCE: &str = "luminance";

impl Family {
    /// Chooses statistics and weights for runs whose pilots had this profile: for every plane that is not black
    /// the whole image and the matched filter, for `luminance` tiles and waves, and every scalar.
    #[must_use]
    pub fn design(profile: &Profile) -> Self {
        let (width, height) = (profile.width, profile.height);
        let mut statistics = Vec::new();
        for (name, mean, variance) in &profile.planes {
            let Some(floor) = floor(mean) else { continue };
            let mean: Vec<f32> = mean.iter().map(|m| m.max(0.0)).collect();
            let relative: Vec<f64> = mean.iter().map(|&m| 1.0 / (f64::from(m) + floor)).collect();
            let mut add = |kind, area: [usize; 4], weight: &dyn Fn(usize, usize) -> f64| {
                let [left, top, w, h] = area;
                let at = |i: usize| weight(left + i % w, top + i / w) as f32;
                let weights: Vec<f32> = (0..w * h).map(at).collect();
                statistics.push(Statistic::new(kind, name, area, weights, width, &mean, variance));
            };
            let all = [0, 0, width, height];
            let here = |x: usize, y: usize| relative[y * width + x];
            add(Kind::Image, all, &here);
            let noise = smooth(variance, width, height);
            add(Kind::Matched, all, &|x, y| {
                let i = y * width + x;
                let mean = f64::from(mean[i]);
                if noise[i] > 0.0 { mean / noise[i] } else { mean }
            });
            if name == LUMINANCE {
                for side in SIDES {
                    for at in tiles(width, height, side) {
                        let [x, y] = at;
                        let area = [x, y, side.min(width - x), side.min(height - y)];
                        add(Kind::Tile { side, at }, area, &here);
                    }
                }
                for half_waves in waves(width, height) {
                    let [u, v] = half_waves;
                    add(Kind::Wave { half_waves }, all, &|x, y| {
                        here(x, y) * half_wave(u, x, width) * half_wave(v, y, height)
                    });
                }
            }
        }
        for name in &profile.scalars {
            statistics.push(Statistic::scalar(name));
        }
        Self { statistics, width, height }
    }

    /// Whether a run has the size of the pilots.
    pub(super) fn fits(&self, run: &Planes) -> bool {
        (run.width, run.height) == (self.width, self.height)
    }

    /// The value of every statistic for one run; `None` where the run is of another size or lacks a plane.
    #[must_use]
    pub fn values(&self, run: &Planes) -> Option<Vec<f64>> {
        if !self.fits(run) {
            return None;
        }
        self.statistics.iter().map(|s| s.value(run)).collect()
    }
}

impl Planes {
    fn is_like(&self, other: &Self) -> bool {
        let names = |p: &Self| -> Vec<String> { p.planes.iter().map(|(n, _)| n.clone()).collect() };
        let scalars = |p: &Self| -> Vec<String> { p.scalars.iter().map(|(n, _)| n.clone()).collect() };
        let whole = |p: &Self| p.planes.iter().all(|(_, v)| v.len() == p.width * p.height);
        (self.width, self.height) == (other.width, other.height)
            && names(self) == names(other)
            && scalars(self) == scalars(other)
            && whole(self)
            && whole(other)
    }
}

/// Means over 5x5 pixels, with a share of the mean of all: a pixel's variance from a few pilots is
/// rough, and one that came out too small would get a weight that is far too large.
fn smooth(variance: &[f32], width: usize, height: usize) -> Vec<f64> {
    const REACH: usize = 2;
    const SHARE: f64 = 0.05;
    let all = variance.iter().map(|&v| f64::from(v)).sum::<f64>() / variance.len().max(1) as f64;
    let around = |i: usize| {
        let (x, y) = (i % width, i / width);
        let columns = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
        let rows = y.saturating_sub(REACH)..(y + REACH + 1).min(height);
        let n = columns.len() * rows.len();
        let sum: f64 = rows
            .flat_map(|r| columns.clone().map(move |c| r * width + c))
            .map(|j| f64::from(variance[j]))
            .sum();
        sum / n as f64 + SHARE * all
    };
    (0..variance.len()).map(around).collect()
}

/// Corners of tiles of one size: a grid, and the grid shifted by half a tile, whole tiles only there.
fn tiles(width: usize, height: usize, side: usize) -> Vec<[usize; 2]> {
    let grid = |from: usize, whole: bool| {
        let fits = move |end: usize, at: usize| !whole || at + side <= end;
        (from..height).step_by(side).filter(move |&y| fits(height, y)).flat_map(move |y| {
            (from..width).step_by(side).filter(move |&x| fits(width, x)).map(move |x| [x, y])
        })
    };
    grid(0, false).chain(grid(side / 2, true)).collect()
}

fn waves(width: usize, height: usize) -> Vec<[usize; 2]> {
    let (across, down) = (WAVES.min(width), WAVES.min(height));
    (0..down).flat_map(|v| (0..across).map(move |u| [u, v])).filter(|w| *w != [0, 0]).collect()
}

/// The cosine of the discrete cosine transform (Ahmed, Natarajan and Rao, IEEE Trans. Computers, 1974).
fn half_wave(n: usize, at: usize, length: usize) -> f64 {
    libm::cos(std::f64::consts::PI * n as f64 * (at as f64 + 0.5) / length as f64)
}

//! What is looked at: weighted sums over the pixels of a run.

use std::fmt;

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

/// Which part of a run a statistic looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// All pixels, each relative to its brightness.
    Image,
    /// All pixels, weighted so that a plane that is brighter or darker as a whole shows best.
    Matched,
    /// A square of this side, its left and top.
    Tile {
        /// Pixels.
        side: usize,
        /// Pixels from the left and from the top.
        at: [usize; 2],
    },
    /// A slow change across the picture: periods in half waves along x and y.
    Wave {
        /// Half waves along the width and along the height; not both zero.
        half_waves: [usize; 2],
    },
    /// A number of [`Planes::scalars`].
    Scalar,
}

/// A statistic: a weighted sum over a plane, or a scalar.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistic {
    /// What it looks at.
    pub kind: Kind,
    /// Name of the plane or scalar.
    pub of: String,
    /// Left, top, width, height of the part that `weights` covers; empty for a scalar.
    area: [usize; 4],
    weights: Vec<f32>,
}

impl fmt::Display for Statistic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            Kind::Image => write!(f, "image, {}", self.of),
            Kind::Matched => write!(f, "matched, {}", self.of),
            Kind::Tile { side, at: [x, y] } => write!(f, "tile {side}x{side} at {x},{y}, {}", self.of),
            Kind::Wave { half_waves: [u, v] } => write!(f, "wave {u},{v}, {}", self.of),
            Kind::Scalar => f.write_str(&self.of),
        }
    }
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
            let mean: Vec<f64> = mean.iter().map(|&m| f64::from(m.max(0.0))).collect();
            let relative: Vec<f64> = mean.iter().map(|m| 1.0 / (m + floor)).collect();
            let mut add = |kind, area: [usize; 4], weight: &dyn Fn(usize, usize) -> f64| {
                let [left, top, w, h] = area;
                let at = |i: usize| weight(left + i % w, top + i / w) as f32;
                let weights = (0..w * h).map(at).collect();
                statistics.push(Statistic { kind, of: name.clone(), area, weights });
            };
            let all = [0, 0, width, height];
            let here = |x: usize, y: usize| relative[y * width + x];
            add(Kind::Image, all, &here);
            let noise = smooth(variance, width, height);
            add(Kind::Matched, all, &|x, y| {
                let i = y * width + x;
                if noise[i] > 0.0 { mean[i] / noise[i] } else { mean[i] }
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
            statistics.push(Statistic {
                kind: Kind::Scalar,
                of: name.clone(),
                area: [0; 4],
                weights: Vec::new(),
            });
        }
        Self { statistics, width, height }
    }

    /// The value of one statistic of the family; `None` where the run is of another size or lacks its plane.
    pub(super) fn value(&self, statistic: &Statistic, run: &Planes) -> Option<f64> {
        ((run.width, run.height) == (self.width, self.height)).then(|| statistic.value(run))?
    }

    /// The value of every statistic for one run; `None` where the run is of another size or lacks a plane.
    #[must_use]
    pub fn values(&self, run: &Planes) -> Option<Vec<f64>> {
        if (run.width, run.height) != (self.width, self.height) {
            return None;
        }
        self.statistics.iter().map(|s| s.value(run)).collect()
    }
}

impl Statistic {
    fn value(&self, run: &Planes) -> Option<f64> {
        if self.kind == Kind::Scalar {
            return run.scalars.iter().find(|(name, _)| *name == self.of).map(|&(_, v)| v);
        }
        let (_, plane) = run.planes.iter().find(|(name, _)| *name == self.of)?;
        let [left, top, w, _] = self.area;
        let rows = self.weights.chunks_exact(w).enumerate();
        let dot = |(y, weights): (usize, &[f32])| -> f64 {
            let start = (top + y) * run.width + left;
            weights.iter().zip(&plane[start..start + w]).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum()
        };
        Some(rows.map(dot).sum())
    }

    /// What the statistic would be if its weights had no signs: what a shift of it is relative to. One for a
    /// scalar.
    pub(super) fn scale(&self, runs: &[Planes]) -> f64 {
        if self.kind == Kind::Scalar {
            return 1.0;
        }
        let absolute = Self { weights: self.weights.iter().map(|w| w.abs()).collect(), ..self.clone() };
        runs.iter().filter_map(|r| absolute.value(r)).sum::<f64>() / runs.len().max(1) as f64
    }

    /// The variance of the statistic where pixels are independent and have the variances in `planes`; `None`
    /// for a scalar, and where the plane is missing.
    pub(super) fn variance(&self, planes: &Planes) -> Option<f64> {
        if self.kind == Kind::Scalar {
            return None;
        }
        let squares = Self { weights: self.weights.iter().map(|w| w * w).collect(), ..self.clone() };
        squares.value(planes)
    }

    /// Third central moment of the statistic over runs if pixels were independent: the sum over pixels of
    /// weight^3 times their own. Zero for a scalar.
    pub(super) fn third_moment(&self, runs: &[Planes]) -> f64 {
        let n = runs.len() as f64;
        let planes: Vec<&[f32]> =
            runs.iter().filter_map(|r| r.planes.iter().find(|(k, _)| *k == self.of)).map(|p| &*p.1).collect();
        let [left, top, w, _] = self.area;
        if planes.len() != runs.len() || runs.len() < 3 || w == 0 {
            return 0.0;
        }
        let unbiased = n / ((n - 1.0) * (n - 2.0));
        let mut sum = 0.0;
        for (i, &weight) in self.weights.iter().enumerate() {
            let at = (top + i / w) * runs[0].width + left + i % w;
            let mean = planes.iter().map(|p| f64::from(p[at])).sum::<f64>() / n;
            let cubes: f64 = planes.iter().map(|p| f64::from(p[at]) - mean).map(|d| d * d * d).sum();
            let weight = f64::from(weight);
            sum += weight * weight * weight * cubes * unbiased;
        }
        sum
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

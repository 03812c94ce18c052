//! A statistic: a weighted sum over pixels, none of which may decide alone.

use std::fmt;

use super::Planes;

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

/// A sum over pixels of weight times distance from the pilots' mean, where no term goes beyond a bound of about
/// one deviation of the whole sum; or a scalar.
///
/// The bound does not matter to noise that many pixels share. A path that one run in a hundred meets, however
/// bright, moves the sum by no more than a deviation; and a change of everything moves it as if there were no
/// bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistic {
    /// What it looks at.
    pub kind: Kind,
    /// Name of the plane or scalar.
    pub of: String,
    /// Left, top, width, height of the part that `weights` covers; empty for a scalar.
    area: [usize; 4],
    weights: Vec<f32>,
    /// The pilots' mean, pixel by pixel.
    centres: Vec<f32>,
    bound: f64,
}

/// A share of a statistic's pixels, those with the most noise, is left out of the deviation that bounds the terms:
/// a pilot that met something rare must not widen the bound for it.
const RAREST: f64 = 1.0 / 64.0;
/// A bound is never smaller than this share of the sum without signs.
const LEAST_BOUND: f64 = 4e-6;

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

impl Statistic {
    /// Over `area` (left, top, width, height) of pictures `width` wide, whose pilots had these means and
    /// variances.
    pub(super) fn new(
        kind: Kind,
        of: &str,
        area: [usize; 4],
        weights: Vec<f32>,
        width: usize,
        mean: &[f32],
        variance: &[f32],
    ) -> Self {
        let [left, top, w, h] = area;
        let pixels = || (0..w * h).map(|i| (top + i / w) * width + left + i % w);
        let centres: Vec<f32> = pixels().map(|p| mean[p]).collect();
        let term =
            |(p, &weight): (usize, &f32)| f64::from(weight) * f64::from(weight) * f64::from(variance[p]);
        let mut terms: Vec<f64> = pixels().zip(&weights).map(term).collect();
        terms.sort_by(f64::total_cmp);
        let kept = terms.len() - (RAREST * terms.len() as f64).ceil() as usize;
        let deviation = terms[..kept].iter().sum::<f64>().sqrt();
        let magnitude: f64 = centres.iter().zip(&weights).map(|(&c, &w)| f64::from(c * w.abs())).sum();
        let bound = deviation.max(LEAST_BOUND * magnitude);
        Self { kind, of: of.to_owned(), area, weights, centres, bound }
    }

    /// A number of the run as a whole.
    pub(super) fn scalar(of: &str) -> Self {
        Self {
            kind: Kind::Scalar,
            of: of.to_owned(),
            area: [0; 4],
            weights: Vec::new(),
            centres: Vec::new(),
            bound: 0.0,
        }
    }

    /// The sum over pixels of `term(weight, pixel, centre)`; `None` where the plane is missing.
    fn sum(&self, planes: &Planes, term: impl Fn(f64, f64, f64) -> f64) -> Option<f64> {
        let (_, plane) = planes.planes.iter().find(|(name, _)| *name == self.of)?;
        let [left, top, w, _] = self.area;
        let mut sum = 0.0;
        for (y, weights) in self.weights.chunks_exact(w).enumerate() {
            let start = (top + y) * planes.width + left;
            let centres = &self.centres[y * w..(y + 1) * w];
            for ((&weight, &x), &c) in weights.iter().zip(&plane[start..start + w]).zip(centres) {
                sum += term(f64::from(weight), f64::from(x), f64::from(c));
            }
        }
        Some(sum)
    }

    /// The value for a run; `None` where it lacks the plane or scalar.
    pub(super) fn value(&self, run: &Planes) -> Option<f64> {
        if self.kind == Kind::Scalar {
            return run.scalars.iter().find(|(name, _)| *name == self.of).map(|&(_, v)| v);
        }
        self.sum(run, |w, x, c| (w * (x - c)).clamp(-self.bound, self.bound))
    }

    /// The value without a bound on terms.
    pub(super) fn linear(&self, run: &Planes) -> Option<f64> {
        if self.kind == Kind::Scalar {
            return self.value(run);
        }
        self.sum(run, |w, x, c| w * (x - c))
    }

    /// The sum without signs and without a centre: what a shift is a share of. One for a scalar.
    pub fn magnitude(&self, run: &Planes) -> Option<f64> {
        if self.kind == Kind::Scalar {
            return Some(1.0);
        }
        self.sum(run, |w, x, _| w.abs() * x)
    }

    /// What a small change of all light, as a share, makes of the value, bound and all: how sensitive it is. Where
    /// signs cancel it is the sum without them, and one for a scalar.
    pub(super) fn scale(&self, runs: &[Planes]) -> f64 {
        const CHANGE: f64 = 0.01;
        let mean = |of: &dyn Fn(&Planes) -> Option<f64>| {
            runs.iter().filter_map(of).sum::<f64>() / runs.len().max(1) as f64
        };
        let bounded = |d: f64| d.clamp(-self.bound, self.bound);
        match self.kind {
            Kind::Scalar => 1.0,
            Kind::Wave { .. } => mean(&|run| self.magnitude(run)),
            _ => {
                let more = |w: f64, x: f64, c: f64| {
                    bounded(w * ((1.0 + CHANGE) * x - c)) - bounded(w * ((1.0 - CHANGE) * x - c))
                };
                mean(&|run| self.sum(run, more)) / (2.0 * CHANGE)
            }
        }
    }

    /// The variance of the value without bound where pixels are independent and have the variances in `planes`;
    /// `None` for a scalar, and where the plane is missing.
    pub(super) fn variance(&self, planes: &Planes) -> Option<f64> {
        if self.kind == Kind::Scalar {
            return None;
        }
        self.sum(planes, |w, v, _| w * w * v)
    }

    /// Third central moment of the statistic over runs if pixels were independent: the sum over pixels of
    /// that of their terms. Zero for a scalar.
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
        for (i, (&weight, &centre)) in self.weights.iter().zip(&self.centres).enumerate() {
            let at = (top + i / w) * runs[0].width + left + i % w;
            let term = |p: &&[f32]| {
                (f64::from(weight) * (f64::from(p[at]) - f64::from(centre))).clamp(-self.bound, self.bound)
            };
            let mean = planes.iter().map(term).sum::<f64>() / n;
            let cubes: f64 = planes.iter().map(term).map(|t| t - mean).map(|d| d * d * d).sum();
            sum += cubes * unbiased;
        }
        sum
    }
}

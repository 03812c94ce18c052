//! Distributions over the cells of a grid.

use super::Discrete;
use crate::math::ONE_MINUS_EPSILON;

/// Share of the mean below which no positive row, and no positive cell of a row, falls: uniform numbers
/// have 24 bits, which have to reach every cell, and within it.
const FLOOR: f64 = 1.0 / 256.0;

/// Picks a cell of a grid with probability proportional to a weight, or nearly so where it is small.
/// Takes four bytes for each cell.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    columns: usize,
    rows: Discrete,
    /// For each row, the probability of a column at most i; the last positive one is one.
    cdf: Vec<f32>,
}

/// A cell that was picked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Its row.
    pub row: usize,
    /// Its column.
    pub column: usize,
    /// The two uniform numbers, stretched to [0, 1) within it.
    pub within: [f32; 2],
}

impl Grid {
    /// The distribution over rows of `columns` weights each, finite and non-negative, which `row(i)`
    /// writes for `rows` rows; `share(i)` is what row i would have if all cells were alike. A cell can
    /// be picked where its weight is positive, and nowhere else.
    #[must_use]
    pub fn new(
        columns: usize,
        rows: usize,
        share: impl Fn(usize) -> f64,
        mut row: impl FnMut(usize, &mut [f64]),
    ) -> Self {
        let mut cdf = vec![0.0f32; columns * rows];
        let mut weights = vec![0.0; columns];
        let mut sums = Vec::with_capacity(rows);
        for (i, out) in cdf.chunks_exact_mut(columns).enumerate() {
            weights.fill(0.0);
            row(i, &mut weights);
            let sum: f64 = weights.iter().sum();
            sums.push(sum);
            if sum <= 0.0 {
                continue;
            }
            let least = FLOOR * sum / columns as f64;
            weights.iter_mut().filter(|w| **w > 0.0).for_each(|w| *w = w.max(least));
            let total: f64 = weights.iter().sum();
            let mut below = 0.0;
            for (o, w) in out.iter_mut().zip(&weights) {
                below += w;
                *o = (below / total) as f32;
            }
            let end = weights.iter().rposition(|&w| w > 0.0).unwrap_or(0);
            out[end..].fill(1.0);
        }
        let (all, shares) = (sums.iter().sum::<f64>(), (0..rows).map(&share).sum::<f64>());
        for (i, sum) in sums.iter_mut().enumerate().filter(|(_, s)| **s > 0.0) {
            *sum = sum.max(FLOOR * all * share(i) / shares);
        }
        Self { columns, rows: Discrete::new(&sums), cdf }
    }

    /// True where nothing can be picked.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Probability of a cell.
    #[inline]
    #[must_use]
    pub fn pmf(&self, row: usize, column: usize) -> f32 {
        let cdf = &self.cdf[row * self.columns..][..self.columns];
        let below = if column == 0 { 0.0 } else { cdf[column - 1] };
        self.rows.pmf(row) * (cdf[column] - below)
    }

    /// The cell that `u` falls on.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: [f32; 2]) -> Option<Cell> {
        let (row, _, v) = self.rows.sample(u[0])?;
        let cdf = &self.cdf[row * self.columns..][..self.columns];
        let column = cdf.partition_point(|&c| c <= u[1]);
        let below = if column == 0 { 0.0 } else { cdf[column - 1] };
        let end = *cdf.get(column)?;
        let h = ((u[1] - below) / (end - below)).min(ONE_MINUS_EPSILON);
        Some(Cell { row, column, within: [v, h] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards probabilities: they sum to one, are what is sampled, zero weights are never picked, and a
    /// positive one next to a weight 1e9 times as large still is.
    #[test]
    fn cells_are_picked_as_often_as_they_say() {
        let weights = [[0.0, 2.0, 1.0], [1e9, 0.0, 1.0], [0.0; 3], [1.0, 1.0, 0.0]];
        let grid = Grid::new(3, 4, |_| 1.0, |i, out| out.copy_from_slice(&weights[i]));
        let n = 1024;
        let mut hits = [[0u32; 3]; 4];
        for k in 0..n * n {
            let u = [(k % n) as f32 + 0.5, (k / n) as f32 + 0.5].map(|x| x / n as f32);
            let cell = grid.sample(u).expect("a cell");
            assert!(cell.within.iter().all(|x| (0.0..1.0).contains(x)), "{cell:?}");
            hits[cell.row][cell.column] += 1;
        }
        let mut sum = 0.0;
        for (row, line) in weights.iter().enumerate() {
            for (column, weight) in line.iter().enumerate() {
                let (pmf, found) = (grid.pmf(row, column), hits[row][column] as f32 / (n * n) as f32);
                sum += pmf;
                assert_eq!(*weight > 0.0, found > 0.0, "{row} {column}");
                assert!((pmf - found).abs() < 2e-3, "{row} {column}: {pmf} {found}");
            }
        }
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        assert!(Grid::new(2, 2, |_| 1.0, |_, _| ()).is_empty());
    }
}

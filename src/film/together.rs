//! How far the errors of neighbouring pixels go together, as they do where one photon lights several.
//!
//! In: for each pixel the deviations d_r of its K replication means from their mean, with the pixel's weight. Out: how
//! many times the variance of a sum over pixels of squared errors is what independent pixels would give it.
//!
//! Let C_pq be the covariance of the errors of two pixels. Squares of normal errors then have the covariance 2 C_pq^2,
//! and so have, but for a factor that all share, their estimates from replications. So the factor is the sum of C_pq^2
//! over all pairs over that of v_p^2 over pixels, v_p = C_pp. With m = K - 1, c_pq = sum over r of d_pr d_qr / m and v_p
//! estimated by c_pp, the second moments of a Wishart matrix give
//!
//! E c_pq^2 = C_pq^2 (1 + 1/m) + v_p v_q / m,   E c_pp c_qq = v_p v_q + 2 C_pq^2 / m,
//!
//! so that (c_pq^2 - c_pp c_qq / m) / (1 + 1/m - 2/m^2) is C_pq^2 without bias (Muirhead, "Aspects of Multivariate
//! Statistical Theory", 1982, section 3.2). Over all pairs within a block of pixels the sum of c_pq^2 is that of the
//! squares of a K x K matrix, the products of the deviations summed over the block: it takes as long as there are pixels.
//! Blocks are squares of eight pixels, then of sixteen and so on, up to a quarter of the picture.
//!
//! What blocks show beyond single pixels counts where it is sure, by what blocks vary by among themselves; noise of
//! independent pixels leaves the factor at one. Pixels that are far apart and go together, as in a mirror, are not seen.
//! Two replications say nothing of this.

/// Side of the smallest blocks, pixels.
const SIDE: usize = 8;
/// Blocks of a level, at least: fewer do not say how sure they are.
const FEWEST_BLOCKS: usize = 12;
/// Standard errors that an excess has to be above none.
const SURE: f64 = 2.0;

/// Sums over the pixels of each block.
pub(super) struct Blocks {
    replications: usize,
    /// Blocks of a row, and rows.
    size: [usize; 2],
    /// Of each block: products of deviations, row by row, then the sum of the squares of the pixels' own.
    sums: Vec<f64>,
}

impl Blocks {
    /// Of a picture of `size` pixels, with nothing in it.
    pub(super) fn new(size: [usize; 2], replications: usize) -> Self {
        let size = size.map(|n| n.div_ceil(SIDE).max(1));
        Self { replications, size, sums: vec![0.0; size[0] * size[1] * (replications * replications + 1)] }
    }

    fn stride(&self) -> usize {
        self.replications * self.replications + 1
    }

    /// Adds the deviations of the pixel at column and row, times the root of its weight.
    pub(super) fn add(&mut self, [x, y]: [usize; 2], deviations: &[f64]) {
        let k = self.replications;
        debug_assert_eq!(deviations.len(), k);
        let begin = (y / SIDE * self.size[0] + x / SIDE) * self.stride();
        let sums = &mut self.sums[begin..=begin + k * k];
        // Where lengths are known, as of four replications, it takes a third of the instructions.
        match (<&mut [f64; 17]>::try_from(&mut *sums), <&[f64; 4]>::try_from(deviations)) {
            (Ok(sums), Ok(deviations)) => add_products(sums, deviations),
            _ => add_products(sums, deviations),
        }
    }

    /// Blocks of twice the side.
    fn doubled(&self) -> Self {
        let size = self.size.map(|n| n.div_ceil(2));
        let stride = self.stride();
        let mut sums = vec![0.0; size[0] * size[1] * stride];
        for (i, own) in self.sums.chunks(stride).enumerate() {
            let begin = (i / self.size[0] / 2 * size[0] + i % self.size[0] / 2) * stride;
            sums[begin..begin + stride].iter_mut().zip(own).for_each(|(sum, x)| *sum += x);
        }
        Self { replications: self.replications, size, sums }
    }

    /// How many times the variance of a sum of squared errors is that of independent pixels: one and more.
    pub(super) fn factor(&self) -> f64 {
        if self.replications < 3 {
            return 1.0;
        }
        let (mut best, mut surest) = (1.0, 0.0);
        let mut found = self.excess();
        let mut larger = self.doubled();
        while let Some((excess, error)) = found {
            if excess - SURE * error > surest {
                (best, surest) = (1.0 + excess, excess - SURE * error);
            }
            found = larger.excess();
            larger = larger.doubled();
        }
        best
    }

    /// What pairs of different pixels add to the factor, and its standard error.
    fn excess(&self) -> Option<(f64, f64)> {
        let blocks = self.size[0] * self.size[1];
        if blocks < FEWEST_BLOCKS {
            return None;
        }
        let k = self.replications;
        let m = (k - 1) as f64;
        // In units of m^2; what is common to numerator and denominator is left out.
        let own = 1.0 - 1.0 / m;
        let of = |sums: &[f64]| {
            let trace: f64 = (0..k).map(|r| sums[r * k + r]).sum();
            let squares: f64 = sums[..k * k].iter().map(|x| x * x).sum();
            (squares - trace * trace / m - own * sums[k * k], own * sums[k * k])
        };
        let pairs: Vec<(f64, f64)> = self.sums.chunks(self.stride()).map(of).collect();
        let whole: f64 = pairs.iter().map(|p| p.1).sum();
        if whole.is_nan() || whole <= 0.0 {
            return None;
        }
        let excess = pairs.iter().map(|p| p.0).sum::<f64>() / whole;
        // A ratio of two sums over blocks, by the delta method.
        let squares: f64 = pairs.iter().map(|(x, y)| (x - excess * y) * (x - excess * y)).sum();
        let n = blocks as f64;
        Some((excess, (squares * n / (n - 1.0)).sqrt() / whole))
    }
}

/// Adds the products of deviations, row by row, and the square of the sum of their squares behind them.
#[inline(always)]
fn add_products(sums: &mut [f64], deviations: &[f64]) {
    let k = deviations.len();
    let mut own = 0.0;
    for (r, &a) in deviations.iter().enumerate() {
        own += a * a;
        for (sum, &b) in sums[r * k..].iter_mut().zip(deviations) {
            *sum += a * b;
        }
    }
    sums[k * k] += own * own;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mix64;

    const SIDES: usize = 64;
    const K: usize = 4;

    /// The factor of a picture whose errors are means over squares of `width` pixels of independent numbers.
    fn factor(name: u64, width: usize, draw: impl Fn(f64) -> f64) -> f64 {
        let mut state = mix64(name);
        let mut unit = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            (mix64(state) >> 11) as f64 / (1u64 << 53) as f64
        };
        let across = SIDES + width;
        let noise: Vec<f64> = (0..across * across * K).map(|_| draw(unit())).collect();
        let mut blocks = Blocks::new([SIDES; 2], K);
        for y in 0..SIDES {
            for x in 0..SIDES {
                let mean = |r: usize| -> f64 {
                    let rows = (y..y + width).flat_map(|j| (x..x + width).map(move |i| j * across + i));
                    rows.map(|i| noise[i * K + r]).sum()
                };
                let means: [f64; K] = std::array::from_fn(mean);
                let all = means.iter().sum::<f64>() / K as f64;
                blocks.add([x, y], &means.map(|m| m - all));
            }
        }
        blocks.factor()
    }

    /// The mean over pictures.
    fn mean(width: usize, draw: impl Fn(f64) -> f64) -> f64 {
        (0..40).map(|i| factor(i, width, &draw)).sum::<f64>() / 40.0
    }

    /// Guards that independent pixels, also such that are seldom lit, are hardly ever said to go together.
    #[test]
    fn independent_pixels_are_left_alone() {
        let uniform = mean(1, |u| u);
        assert!((1.0..1.03).contains(&uniform), "{uniform}");
        let rare = mean(1, |u| f64::from(u > 0.95));
        assert!((1.0..1.1).contains(&rare), "{rare}");
    }

    /// By hand: means over squares of w pixels have the correlation (1 - |i| / w) (1 - |j| / w), whose squares add up to
    /// (1 + 2 sum (1 - i / w)^2)^2: 19/9 squared for three. Blocks cut some of it.
    #[test]
    fn what_goes_together_is_counted() {
        let three = mean(3, |u| u);
        assert!((three / (361.0 / 81.0) - 1.0).abs() < 0.15, "{three}");
        let sparse = mean(3, |u| f64::from(u > 0.98));
        assert!((sparse / (361.0 / 81.0) - 1.0).abs() < 0.3, "{sparse}");
    }

    /// Guards that two replications say nothing.
    #[test]
    fn two_replications_are_too_few() {
        let mut blocks = Blocks::new([SIDES; 2], 2);
        (0..SIDES * SIDES).for_each(|i| blocks.add([i % SIDES, i / SIDES], &[1.0, -1.0]));
        assert_eq!(blocks.factor(), 1.0);
    }
}

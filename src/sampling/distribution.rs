//! Discrete distributions.

/// Picks an index with probability proportional to a weight.
#[derive(Clone, Debug, Default)]
pub struct Discrete {
    /// cdf[i] is the probability of an index at most i; the last entry is one.
    cdf: Vec<f64>,
}

impl Discrete {
    /// The distribution over `weights`, each finite and non-negative; empty where all are zero.
    #[must_use]
    pub fn new(weights: &[f64]) -> Self {
        let largest = weights.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Self::default();
        }
        // Scaled first: a sum of weights that are each representable may not be.
        let total: f64 = weights.iter().map(|w| w / largest).sum();
        let mut sum = 0.0;
        let mut cdf: Vec<f64> = weights
            .iter()
            .map(|w| {
                sum += w / largest;
                sum / total
            })
            .collect();
        // Rounding may leave the end of the last positive weight below one.
        let end = weights.iter().rposition(|&w| w > 0.0).unwrap_or(0);
        cdf[end..].fill(1.0);
        Self { cdf }
    }

    /// True where nothing can be picked.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cdf.is_empty()
    }

    /// Probability of index `i`.
    #[inline]
    #[must_use]
    pub fn pmf(&self, i: usize) -> f32 {
        let below = if i == 0 { 0.0 } else { self.cdf[i - 1] };
        (self.cdf[i] - below) as f32
    }

    /// The index that `u` in [0, 1) falls on, its probability, and `u` stretched to [0, 1) within it.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: f32) -> Option<(usize, f32, f32)> {
        if self.cdf.len() == 1 {
            return Some((0, 1.0, u));
        }
        let u64 = f64::from(u);
        let i = self.cdf.partition_point(|&c| c <= u64);
        if i >= self.cdf.len() {
            return None;
        }
        let below = if i == 0 { 0.0 } else { self.cdf[i - 1] };
        let width = self.cdf[i] - below;
        let stretched = (((u64 - below) / width) as f32).min(crate::math::ONE_MINUS_EPSILON);
        Some((i, width as f32, stretched))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// N53: probabilities sum to one, zero weights are never picked, and a weight 1e6 times as strong
    /// as ten thousand others gets its share.
    #[test]
    fn picks_in_proportion_to_weight() {
        let mut weights = vec![1.0; 10_000];
        weights[17] = 1e6;
        weights[9_999] = 0.0;
        let d = Discrete::new(&weights);
        let sum: f64 = (0..weights.len()).map(|i| f64::from(d.pmf(i))).sum();
        assert!((sum - 1.0).abs() < 1e-6);
        assert_eq!(d.pmf(9_999), 0.0);
        let n = 1 << 16;
        let mut hits = 0;
        for k in 0..n {
            let (i, pmf, inner) = d.sample((k as f32 + 0.5) / n as f32).expect("not empty");
            assert!(i != 9_999 && pmf > 0.0 && (0.0..1.0).contains(&inner));
            hits += u32::from(i == 17);
        }
        assert!((f64::from(hits) / f64::from(n) - f64::from(d.pmf(17))).abs() < 1e-4);
        assert_eq!(d.sample(crate::math::ONE_MINUS_EPSILON).map(|s| s.0), Some(9_998));
    }

    #[test]
    fn nothing_to_pick_is_none() {
        for d in [Discrete::new(&[]), Discrete::new(&[0.0, 0.0])] {
            assert!(d.is_empty() && d.sample(0.5).is_none());
        }
    }
}

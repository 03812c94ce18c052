//! What each part of the light is of a picture, and what it is of its noise.
//!
//! In: a film that recorded the parts in each replication. Out: shares that add up to one.
//!
//! *Noise.* The square of a picture's error (see [`Film::error`]) is a sum over pixels, of the variance of the
//! luminance over R^2 + c^2. The variance of a sum of parts is the sum of the covariances of each part with the
//! whole, so each part has a share of its own, though parts of one path go together. A share may be
//! negative where a part is darker when the others are brighter.

use super::sums::LAYERS;
use super::{Film, LightLayer};
use crate::stats::ERROR_FLOOR;

/// A part of the light: what it is of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerShare {
    /// The part.
    pub layer: LightLayer,
    /// Its share of the luminance, [0, 1].
    pub light: f64,
    /// Its share of the square of the picture's error, about [0, 1]; zero where there is no noise.
    pub noise: f64,
}

impl Film {
    /// The shares of all parts, in the order of [`LightLayer::ALL`]; `None` where their noise was not recorded
    /// ([`FilmLayout::layer_noise`](super::FilmLayout)), or the picture is black.
    #[must_use]
    pub fn layer_shares(&self) -> Option<[LayerShare; LAYERS]> {
        let cells = self.layer_cells.as_ref()?;
        let k = self.layout.replications as usize;
        let format = self.layout.radiance;
        // Of each pixel: for each replication that has samples, their number and the means of the parts.
        let pixels = cells.chunks(k).zip(self.counts.chunks(k)).map(|(sums, counts)| {
            let means = sums.iter().zip(counts).filter(|&(_, &n)| n > 0);
            means.map(|(s, &n)| (f64::from(n), s.map(|v| format.mean(v, n)))).collect::<Vec<_>>()
        });
        // Of a sparse render, those that are there.
        let pixels: Vec<_> = pixels.filter(|means| !means.is_empty()).collect();
        let pooled = |means: &[(f64, [f64; LAYERS])]| {
            let n: f64 = means.iter().map(|m| m.0).sum();
            let sum = |l: usize| means.iter().map(|m| m.0 * m.1[l]).sum::<f64>();
            std::array::from_fn::<f64, LAYERS, _>(|l| if n > 0.0 { sum(l) / n } else { 0.0 })
        };
        let mut light = [0.0; LAYERS];
        for means in &pixels {
            pooled(means).iter().zip(&mut light).for_each(|(v, sum)| *sum += v);
        }
        let total: f64 = light.iter().sum();
        if total <= 0.0 {
            return None;
        }
        let c = ERROR_FLOOR * total / pixels.len() as f64;
        let mut noise = [0.0; LAYERS];
        for means in pixels.iter().filter(|m| m.len() >= 2) {
            let mean = pooled(means);
            let whole: f64 = mean.iter().sum();
            let scale = 1.0 / (whole * whole + c * c);
            for (n, m) in means {
                let deviation: f64 = m.iter().sum::<f64>() - whole;
                for (sum, (v, mean)) in noise.iter_mut().zip(m.iter().zip(mean)) {
                    *sum += scale * n * deviation * (v - mean);
                }
            }
        }
        let all: f64 = noise.iter().sum();
        let share = |layer: LightLayer| LayerShare {
            layer,
            light: light[layer as usize] / total,
            noise: if all > 0.0 { noise[layer as usize] / all } else { 0.0 },
        };
        Some(LightLayer::ALL.map(share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::{FilmLayout, Sample};
    use crate::math::mix64;

    /// Guards shares against known ones: of three units of light, one that never varies, and two of which one has
    /// noise of standard deviation s and the other of 2 s, independent: no noise, a fifth, four fifths.
    #[test]
    fn shares_are_those_of_the_parts() {
        let mut film = Film::new(FilmLayout { layer_noise: true, ..FilmLayout::plain([32, 32]) });
        let mut state = 5u64;
        let mut unit = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            (mix64(state) >> 40) as f32 / 16_777_216.0
        };
        for pixel in 0..32 * 32 {
            for pass in 0..16 {
                let mut layers = [Rgb::BLACK; LightLayer::ALL.len()];
                layers[LightLayer::Emitted as usize] = Rgb::WHITE;
                layers[LightLayer::Direct as usize] = Rgb::grey(0.75 + 0.5 * unit());
                layers[LightLayer::Indirect as usize] = Rgb::grey(0.5 + unit());
                let radiance = layers.iter().fold(Rgb::BLACK, |a, &b| a + b);
                let sample = Sample { radiance, layers: Some(layers), ..Sample::default() };
                film.add(pixel, pass, &sample).expect("a radiance");
            }
        }
        let shares = film.layer_shares().expect("recorded");
        let expected = [(1.0 / 3.0, 0.2), (1.0 / 3.0, 0.8), (0.0, 0.0), (0.0, 0.0), (1.0 / 3.0, 0.0)];
        for (share, (light, noise)) in shares.iter().zip(expected) {
            // 3072 estimates of a variance: 2.5 % each, four of these.
            assert!((share.light - light).abs() < 0.005, "{share:?} {light}");
            assert!((share.noise - noise).abs() < 0.03, "{share:?} {noise}");
        }
        assert_eq!(Film::new(FilmLayout::plain([2, 2])).layer_shares(), None);
    }
}

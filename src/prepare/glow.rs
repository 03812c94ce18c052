//! Emission from pictures: the radiance of a point, and how bright a triangle is on the whole.
//!
//! A light that is a surface carries a radiance that is the same all over it. Where a picture varies what
//! it emits, that radiance is only what the choice of a light goes by: the factor times a power of two near
//! the mean of the picture over the triangle. Whoever evaluates emission asks [`Glow`].

use super::fold::bounded;
use super::texture::{Coordinates, Sampler};
use crate::color::Rgb;
use crate::math::floor_pow2;

/// Radiance that a picture varies.
#[derive(Clone, Debug)]
pub(crate) struct Glow {
    sampler: Sampler,
    factor: Rgb,
}

impl Glow {
    pub(super) fn new(sampler: Sampler, factor: Rgb) -> Self {
        Self { sampler, factor }
    }

    /// Emitted radiance at a point, W sr^-1 m^-2.
    #[inline]
    pub(crate) fn radiance(&self, at: &Coordinates) -> Rgb {
        bounded(self.factor * self.sampler.rgb(at))
    }

    /// The same as a multiple of `nominal`, the radiance that the light was given.
    #[inline]
    pub(crate) fn share(&self, nominal: Rgb, at: &Coordinates) -> Rgb {
        let r = self.radiance(at);
        let ratio = |a: f32, b: f32| if b > 0.0 { a / b } else { 0.0 };
        Rgb::new(ratio(r.r, nominal.r), ratio(r.g, nominal.g), ratio(r.b, nominal.b))
    }
}

/// Blocks along one side of a picture, at most.
const BLOCKS: u32 = 64;

/// How bright a picture is, block by block.
pub(super) struct Brightness<'a> {
    glow: &'a Glow,
    size: [u32; 2],
    blocks: [u32; 2],
    /// Sum of luminances of each block; zero only where all of it is black.
    sums: Vec<f64>,
    counts: Vec<u32>,
}

impl<'a> Brightness<'a> {
    pub(super) fn new(glow: &'a Glow) -> Self {
        let size = glow.sampler.size();
        let blocks = size.map(|n| n.min(BLOCKS));
        let mut sums = vec![0.0; (blocks[0] * blocks[1]) as usize];
        let mut counts = vec![0u32; sums.len()];
        for y in 0..size[1] {
            for x in 0..size[0] {
                let block = (block(y, size[1]) * blocks[0] + block(x, size[0])) as usize;
                let [r, g, b, _] = glow.sampler.texel(x, y);
                sums[block] += f64::from((glow.factor * Rgb::new(r, g, b)).luminance());
                counts[block] += 1;
            }
        }
        Self { glow, size, blocks, sums, counts }
    }

    /// The radiance that a light is given for its choice, whose triangles have these coordinates at their
    /// corners; `None` where the picture is black all over them.
    pub(super) fn nominal(&self, triangles: &[[Coordinates; 3]]) -> Option<Rgb> {
        let (mut sum, mut count) = (0.0, 0.0);
        for corners in triangles {
            let (low, high) = self.glow.sampler.bounds(corners);
            let [columns, rows] = [0, 1].map(|axis| self.cover(axis, low[axis], high[axis]));
            for (y, _) in rows.iter().enumerate().filter(|(_, covered)| **covered) {
                for (x, _) in columns.iter().enumerate().filter(|(_, covered)| **covered) {
                    let i = y * self.blocks[0] as usize + x;
                    sum += self.sums[i];
                    count += f64::from(self.counts[i]);
                }
            }
        }
        let factor = self.glow.factor;
        let mean = sum / (count * f64::from(factor.luminance()));
        // A product with a power of two is exact, so that it leaves no trace in what is rendered.
        (sum > 0.0).then(|| factor * floor_pow2((mean * std::f64::consts::SQRT_2).clamp(1e-6, 1e6) as f32))
    }

    /// Which blocks along an axis the texels from `low` to `high` and their neighbours are in.
    fn cover(&self, axis: usize, low: f64, high: f64) -> Vec<bool> {
        let (n, k) = (self.size[axis], self.blocks[axis]);
        let (low, high) = (low.floor() - 1.0, high.floor() + 1.0);
        if high - low >= 2.0 * f64::from(n) || low.abs().max(high.abs()) > 1e15 {
            return vec![true; k as usize];
        }
        let mut covered = vec![false; k as usize];
        // No step is longer than a block, so none is left out.
        let (mut at, high) = (low as i64, high as i64);
        loop {
            covered[block(self.glow.sampler.index(axis, at), n) as usize] = true;
            if at == high {
                return covered;
            }
            at = (at + i64::from(n / k)).min(high);
        }
    }
}

/// The block of texel `i` of `n` along a side; their sizes differ by one at most.
fn block(i: u32, n: u32) -> u32 {
    (u64::from(i) * u64::from(n.min(BLOCKS)) / u64::from(n)) as u32
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::{ImageId, Pixels, Texels, Texture, Wrap};

    /// Guards the choice of lights: a triangle on black has no light, and else the nominal radiance is
    /// within a factor of two or so of the mean. Guards exactness: shares of it are the radiance.
    #[test]
    fn nominal_radiance_is_near_the_mean() {
        // 130 x 70 texels: the right half is white, the left half black.
        let texel = |i: u32| if i % 130 < 65 { [0, 0, 0, 255] } else { [255; 4] };
        let texels = Texels::Byte((0..130 * 70).map(texel).collect());
        let pixels = Arc::new(Pixels { width: 130, height: 70, texels });
        let factor = Rgb::new(3.0, 0.0, 1.5);
        let glow = |wrap| {
            let t = Texture { wrap: [wrap; 2], ..Texture::new(ImageId(0)) };
            Glow::new(Sampler::new(&t, &pixels, true), factor)
        };
        let at = |u: f64| [[[u, 0.1], [0.0; 2]], [[u + 0.2, 0.1], [0.0; 2]], [[u, 0.9], [0.0; 2]]];
        for (wrap, u, expected) in [
            (Wrap::Repeat, 0.1, None),
            (Wrap::Repeat, 0.6, Some(1.0)),
            (Wrap::Repeat, -0.4, Some(1.0)),
            (Wrap::Repeat, 0.4, Some(0.5)),
            (Wrap::Mirror, -0.3, None),
            (Wrap::Mirror, -0.9, Some(1.0)),
            (Wrap::Clamp, -8.0, None),
            (Wrap::Clamp, 8.0, Some(1.0)),
        ] {
            let glow = glow(wrap);
            let nominal = Brightness::new(&glow).nominal(&[at(u)]);
            assert_eq!(nominal, expected.map(|m| factor * m), "{wrap:?} {u}");
            if let Some(nominal) = nominal {
                let coordinates = [[0.7, 0.5], [0.0; 2]];
                assert_eq!(nominal * glow.share(nominal, &coordinates), glow.radiance(&coordinates));
            }
        }
        let whole = glow(Wrap::Repeat);
        let everywhere = [[[-9.0, 0.0], [0.0; 2]], [[9.0, 1e30], [0.0; 2]], [[0.0, 0.0], [0.0; 2]]];
        assert_eq!(Brightness::new(&whole).nominal(&[everywhere]), Some(factor * 0.5));
    }
}

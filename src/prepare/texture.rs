//! Looking textures up.
//!
//! In: a [`Texture`] and the texture coordinates of a hit. Out: the decoded texel there. Texels stay in
//! the picture's own form, shared by every texture that uses it, and are decoded as they are read, before
//! they are filtered. Coordinates are `f64`: whatever is finite finds a texel.

use std::sync::{Arc, LazyLock};

use crate::color::{Rgb, srgb_to_linear};
use crate::scene::{Channel, Filter, Pixels, ScalarTexture, Texels, Texture, Wrap};

/// Both sets of texture coordinates of a point; (0, 0) where the mesh has none.
pub(crate) type Coordinates = [[f64; 2]; 2];

/// A texture, ready to be read.
#[derive(Clone, Debug)]
pub(crate) struct Sampler {
    pixels: Arc<Pixels>,
    /// What integers mean in the first three channels, and in the fourth.
    decode: [&'static [f32]; 2],
    uv_set: usize,
    /// Rows of the transform: factors of u and v, and what is added.
    transform: [[f64; 3]; 2],
    wrap: [Wrap; 2],
    filter: Filter,
}

/// One channel of a texture.
#[derive(Clone, Debug)]
pub(crate) struct ScalarSampler {
    sampler: Sampler,
    channel: Channel,
}

static BYTES: LazyLock<Vec<f32>> = LazyLock::new(|| (0..=255).map(|i| i as f32 / 255.0).collect());
static SHORTS: LazyLock<Vec<f32>> = LazyLock::new(|| (0..=65535).map(|i| i as f32 / 65535.0).collect());
static ENCODED_BYTES: LazyLock<Vec<f32>> =
    LazyLock::new(|| BYTES.iter().map(|&v| srgb_to_linear(v)).collect());
static ENCODED_SHORTS: LazyLock<Vec<f32>> =
    LazyLock::new(|| SHORTS.iter().map(|&v| srgb_to_linear(v)).collect());

/// What integers mean: colours are encoded, alpha and data are not.
fn decoding(texels: &Texels, encoded: bool) -> [&'static [f32]; 2] {
    let (plain, curve) = match texels {
        Texels::Byte(_) => (&BYTES, &ENCODED_BYTES),
        Texels::Short(_) => (&SHORTS, &ENCODED_SHORTS),
        Texels::Float(_) => return [&[], &[]],
    };
    [if encoded { curve } else { plain }, plain]
}

#[inline]
fn texel(texels: &Texels, decode: &[&[f32]; 2], at: usize) -> [f32; 4] {
    let [color, alpha] = decode;
    match texels {
        Texels::Byte(t) => {
            let [r, g, b, a] = t[at].map(usize::from);
            [color[r], color[g], color[b], alpha[a]]
        }
        Texels::Short(t) => {
            let [r, g, b, a] = t[at].map(usize::from);
            [color[r], color[g], color[b], alpha[a]]
        }
        Texels::Float(t) => {
            let [r, g, b] = t[at];
            [r, g, b, 1.0]
        }
    }
}

/// The texel that every other equals in the first three channels, decoded.
pub(super) fn constant_color(pixels: &Pixels, encoded: bool) -> Option<Rgb> {
    let same = match &pixels.texels {
        Texels::Byte(t) => t.iter().all(|x| x[..3] == t[0][..3]),
        Texels::Short(t) => t.iter().all(|x| x[..3] == t[0][..3]),
        Texels::Float(t) => t.iter().all(|x| x == &t[0]),
    };
    same.then(|| {
        let [r, g, b, _] = texel(&pixels.texels, &decoding(&pixels.texels, encoded), 0);
        Rgb::new(r, g, b)
    })
}

/// The same for one channel, as data.
pub(super) fn constant_channel(pixels: &Pixels, channel: Channel) -> Option<f32> {
    let c = channel as usize;
    let same = match &pixels.texels {
        Texels::Byte(t) => t.iter().all(|x| x[c] == t[0][c]),
        Texels::Short(t) => t.iter().all(|x| x[c] == t[0][c]),
        Texels::Float(t) => c == 3 || t.iter().all(|x| x[c] == t[0][c]),
    };
    same.then(|| texel(&pixels.texels, &decoding(&pixels.texels, false), 0)[c])
}

/// The smallest value of one channel, as data, at most one.
pub(super) fn darkest_channel(pixels: &Pixels, channel: Channel) -> f32 {
    let decode = decoding(&pixels.texels, false);
    let count = pixels.width as usize * pixels.height as usize;
    (0..count).map(|i| texel(&pixels.texels, &decode, i)[channel as usize]).fold(1.0, f32::min)
}

impl Sampler {
    /// The texture over its picture; `encoded` where integers are sRGB.
    pub(super) fn new(t: &Texture, pixels: &Arc<Pixels>, encoded: bool) -> Self {
        let angle = f64::from(t.rotation);
        let (s, c) = (libm::sin(angle), libm::cos(angle));
        let [sx, sy] = t.scale.map(f64::from);
        let [ox, oy] = t.offset.map(f64::from);
        Self {
            pixels: Arc::clone(pixels),
            decode: decoding(&pixels.texels, encoded),
            uv_set: usize::from(t.uv_set.min(1)),
            transform: [[c * sx, s * sy, ox], [-s * sx, c * sy, oy]],
            wrap: t.wrap,
            filter: t.filter,
        }
    }

    /// Which set of texture coordinates counts.
    pub(super) fn uv_set(&self) -> usize {
        self.uv_set
    }

    /// Width and height of the picture, texels.
    pub(super) fn size(&self) -> [u32; 2] {
        [self.pixels.width, self.pixels.height]
    }

    /// A texel, decoded.
    pub(super) fn texel(&self, x: u32, y: u32) -> [f32; 4] {
        let at = y as usize * self.pixels.width as usize + x as usize;
        texel(&self.pixels.texels, &self.decode, at)
    }

    /// The texel along an axis that stands for number `i` of it.
    pub(super) fn index(&self, axis: usize, i: i64) -> u32 {
        index(i, self.size()[axis], self.wrap[axis])
    }

    /// Where the corners of a triangle lie in the picture, in texels: lowest and highest.
    pub(super) fn bounds(&self, corners: &[Coordinates; 3]) -> ([f64; 2], [f64; 2]) {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for at in corners {
            let [u, v] = at[self.uv_set];
            for axis in 0..2 {
                let [a, b, c] = self.transform[axis];
                let x = (a * u + b * v + c) * f64::from(self.size()[axis]);
                (low[axis], high[axis]) = (low[axis].min(x), high[axis].max(x));
            }
        }
        (low, high)
    }

    /// Red, green, blue and alpha at a point.
    #[inline]
    pub(crate) fn rgba(&self, at: &Coordinates) -> [f32; 4] {
        let [u, v] = at[self.uv_set];
        let [x, y] = self.transform.map(|[a, b, c]| a * u + b * v + c);
        let (w, h) = (self.pixels.width, self.pixels.height);
        let read =
            |x: u32, y: u32| texel(&self.pixels.texels, &self.decode, y as usize * w as usize + x as usize);
        if self.filter == Filter::Nearest {
            let place =
                |x: f64, n: u32, wrap| index((reduced(x, wrap) * f64::from(n)).floor() as i64, n, wrap);
            return read(place(x, w, self.wrap[0]), place(y, h, self.wrap[1]));
        }
        let place = |x: f64, n: u32, wrap| {
            let x = reduced(x, wrap) * f64::from(n) - 0.5;
            let first = x.floor();
            let i = first as i64;
            (index(i, n, wrap), index(i + 1, n, wrap), (x - first) as f32)
        };
        let (x0, x1, s) = place(x, w, self.wrap[0]);
        let (y0, y1, t) = place(y, h, self.wrap[1]);
        let mix = |a: [f32; 4], b: [f32; 4], t: f32| std::array::from_fn(|i| a[i] * (1.0 - t) + b[i] * t);
        mix(mix(read(x0, y0), read(x1, y0), s), mix(read(x0, y1), read(x1, y1), s), t)
    }

    /// The colour at a point.
    #[inline]
    pub(crate) fn rgb(&self, at: &Coordinates) -> Rgb {
        let [r, g, b, _] = self.rgba(at);
        Rgb::new(r, g, b)
    }
}

impl ScalarSampler {
    /// The texture's channel over its picture, as data.
    pub(super) fn new(t: &ScalarTexture, pixels: &Arc<Pixels>) -> Self {
        Self { sampler: Sampler::new(&t.texture, pixels, false), channel: t.channel }
    }

    /// The value at a point.
    #[inline]
    pub(crate) fn value(&self, at: &Coordinates) -> f32 {
        self.sampler.rgba(at)[self.channel as usize]
    }
}

/// A coordinate without the whole periods in it, in pictures: where a large one keeps what digits it has.
#[inline]
fn reduced(x: f64, wrap: Wrap) -> f64 {
    match wrap {
        Wrap::Repeat => x - x.floor(),
        Wrap::Mirror => x - 2.0 * (0.5 * x).floor(),
        Wrap::Clamp => x.clamp(0.0, 1.0),
    }
}

/// The texel that stands for number `i` of a row of `n`.
#[inline]
fn index(i: i64, n: u32, wrap: Wrap) -> u32 {
    let n = i64::from(n);
    let i = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Mirror => {
            let j = i.rem_euclid(2 * n);
            j.min(2 * n - 1 - j)
        }
        Wrap::Clamp => i.clamp(0, n - 1),
    };
    i as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ImageId;

    fn checker() -> Arc<Pixels> {
        let texels = (0..12u8).map(|i| [20 * i, 255 - i, 7, 100 + i]).collect();
        Arc::new(Pixels { width: 4, height: 3, texels: Texels::Byte(texels) })
    }

    fn at(u: f64, v: f64) -> Coordinates {
        [[u, v], [9.0, 9.0]]
    }

    /// Guards where texels are: at their middles both filters give the very texel, whatever the wrap.
    #[test]
    fn middles_of_texels_are_the_texels() {
        let pixels = checker();
        let Texels::Byte(texels) = &pixels.texels else { unreachable!() };
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [Filter::Linear, Filter::Nearest] {
                let t = Texture { wrap: [wrap; 2], filter, ..Texture::new(ImageId(0)) };
                for encoded in [false, true] {
                    let sampler = Sampler::new(&t, &pixels, encoded);
                    for (i, expected) in texels.iter().enumerate() {
                        let [x, y] = [i % 4, i / 4].map(|i| i as f64 + 0.5);
                        let found = sampler.rgba(&at(x / 4.0, y / 3.0));
                        for c in 0..4 {
                            let plain = f32::from(expected[c]) / 255.0;
                            let expected = if encoded && c < 3 { srgb_to_linear(plain) } else { plain };
                            assert!((found[c] - expected).abs() < 1e-6, "{wrap:?} {filter:?} {i} {c}");
                        }
                    }
                }
            }
        }
    }

    /// Guards decoding before filtering, and the wraps beyond the edge, by hand.
    #[test]
    fn between_and_beyond() {
        let texels = Texels::Byte(vec![[0, 0, 0, 255], [255, 255, 255, 255]]);
        let pixels = Arc::new(Pixels { width: 2, height: 1, texels });
        let red = |wrap, encoded, u| {
            let t = Texture { wrap: [wrap, Wrap::Repeat], ..Texture::new(ImageId(0)) };
            Sampler::new(&t, &pixels, encoded).rgba(&at(u, 0.3))[0]
        };
        // Half way between black and white is a half of the light.
        assert_eq!(red(Wrap::Clamp, true, 0.5), 0.5);
        assert_eq!(red(Wrap::Clamp, true, 0.375), 0.25);
        for (wrap, u, expected) in [
            (Wrap::Repeat, 0.0, 0.5),
            (Wrap::Repeat, 1.125, 0.25),
            (Wrap::Repeat, -0.25, 1.0),
            (Wrap::Mirror, 0.0, 0.0),
            (Wrap::Mirror, -0.25, 0.0),
            (Wrap::Mirror, 1.25, 1.0),
            (Wrap::Mirror, 1.5, 0.5),
            (Wrap::Clamp, -7.0, 0.0),
            (Wrap::Clamp, 1.25, 1.0),
        ] {
            let found = red(wrap, false, u);
            assert!((found - expected).abs() < 1e-6, "{wrap:?} {u}: {found}, expected {expected}");
        }
    }

    /// Guards the transform: scaled, then turned as `KHR_texture_transform` turns, then moved.
    #[test]
    fn transform_is_that_of_the_extension() {
        let texels = (0..64u8).map(|i| [i, 0, 0, 255]).collect();
        let pixels = Arc::new(Pixels { width: 8, height: 8, texels: Texels::Byte(texels) });
        let t = Texture {
            scale: [2.0, 0.5],
            rotation: std::f32::consts::FRAC_PI_2,
            offset: [0.25, 0.75],
            filter: Filter::Nearest,
            ..Texture::new(ImageId(0))
        };
        // (u, v) = (0.1, 0.3) is scaled to (0.2, 0.15), turned to (0.15, -0.2), moved to (0.4, 0.55):
        // column 3, row 4.
        let found = Sampler::new(&t, &pixels, false).rgba(&at(0.1, 0.3))[0];
        assert_eq!(found, (4.0 * 8.0 + 3.0) / 255.0);
        // The second set is another place.
        let second = Texture { uv_set: 1, filter: Filter::Nearest, ..Texture::new(ImageId(0)) };
        let found = Sampler::new(&second, &pixels, false).rgba(&[[9.0, 9.0], [0.3, 0.9]])[0];
        assert_eq!(found, (7.0 * 8.0 + 2.0) / 255.0);
    }

    /// Guards against panics: whatever is finite finds a texel.
    #[test]
    fn absurd_coordinates_find_a_texel() {
        let pixels = checker();
        let big = f64::from(f32::MAX);
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for filter in [Filter::Linear, Filter::Nearest] {
                let t = Texture {
                    wrap: [wrap; 2],
                    filter,
                    scale: [1e6, -1e6],
                    rotation: 1.0,
                    ..Texture::new(ImageId(0))
                };
                let sampler = Sampler::new(&t, &pixels, true);
                for u in [0.0, -0.0, 1.0, -1e-300, 1e-300, 1e9 + 0.5, -1e9, big, -big, 1.0 - 1e-17] {
                    for v in [0.0, 1.0, -1e-17, big, -big] {
                        assert!(sampler.rgba(&at(u, v)).iter().all(|c| (0.0..=1.0).contains(c)));
                    }
                }
            }
        }
    }

    /// Guards memory: textures share the texels of their picture.
    #[test]
    fn textures_share_their_picture() {
        let pixels = checker();
        let t = Texture::new(ImageId(0));
        let (a, b) = (Sampler::new(&t, &pixels, true), Sampler::new(&t, &pixels, false));
        assert_eq!(Arc::strong_count(&pixels), 3);
        drop((a, b));
    }
}

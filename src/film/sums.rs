//! Exact sums per pixel and replication.

use super::cross::{CrossSums, Found, Glimpse, Level};
use super::tail::Octaves;
use super::{FixedPoint, Image, Layer, LightLayer};
use crate::color::Rgb;
use crate::mutants::planted;

/// What a film accumulates.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmLayout {
    /// Left, top, width and height of the part that is rendered, in pixels of the whole picture.
    pub crop: [u32; 4],
    /// Width and height of the whole picture.
    pub full_size: [u32; 2],
    /// Independent replications (K); pass p belongs to replication p mod K.
    pub replications: u32,
    /// Format of radiance sums.
    pub radiance: FixedPoint,
    /// Format of lengths, where features are recorded.
    pub length: FixedPoint,
    /// Whether to record the features of the first surface.
    pub features: bool,
    /// Whether to record the parts of the light ([`LightLayer`]) and each pixel's brightest sample.
    pub layers: bool,
    /// Whether to record the parts of the light in each replication, so that their noise is known.
    pub layer_noise: bool,
    /// Whether the background counts as transparent.
    pub transparent: bool,
    /// Whether photons say beside the paths how much light there is.
    pub cross: bool,
    /// Whether to record how far photon maps may be off ([`Sample::widening`]).
    pub widening: bool,
}

impl FilmLayout {
    /// A whole picture of radiances about one in four replications, and nothing else.
    #[must_use]
    pub fn plain([width, height]: [u32; 2]) -> Self {
        Self {
            crop: [0, 0, width, height],
            full_size: [width, height],
            replications: 4,
            radiance: FixedPoint::around(1.0),
            length: FixedPoint::around(1.0),
            features: false,
            layers: false,
            layer_noise: false,
            transparent: false,
            cross: false,
            widening: false,
        }
    }
}

/// Why a sample was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Refusal {
    /// A channel is not a number.
    NotANumber,
    /// A channel is infinite, or too large for the film.
    Overflow,
    /// A channel is negative.
    Negative,
}

/// What the first surface of a path is like.
#[derive(Clone, Copy, Debug, Default)]
pub struct Features {
    /// Reflectance of the surface, or an estimate of it, [0, 1].
    pub albedo: Rgb,
    /// Shading normal, world space, unit.
    pub normal: [f32; 3],
    /// Distance along the view axis, metres.
    pub depth: f32,
    /// World space, metres.
    pub position: [f32; 3],
    /// Index of the object plus one; zero where nothing was hit.
    pub object: u32,
    /// Index of the material plus one; zero where nothing was hit.
    pub material: u32,
}

/// One sample of a pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// Radiance towards the camera.
    pub radiance: Rgb,
    /// What was hit first; `None` for the background.
    pub features: Option<Features>,
    /// The parts of the radiance, by number of their [`LightLayer`], where they were asked for.
    pub layers: Option<[Rgb; LAYERS]>,
    /// Luminance that disks of twice the radius would bring from photon maps, less what they do; an estimate, zero for most
    /// samples.
    pub widening: f32,
}

/// Numbers of a surface's features.
pub(super) const FEATURES: usize = 10;
/// Number of light layers.
pub(super) const LAYERS: usize = LightLayer::ALL.len();

#[derive(Clone, Debug, PartialEq)]
pub(super) struct FeatureSums {
    /// Albedo, normal, depth, position; per pixel.
    pub(super) sums: Vec<[i128; FEATURES]>,
    /// Object and material of the lowest pass seen, with that pass.
    pub(super) ids: Vec<(u32, [u32; 2])>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct LayerSums {
    /// Per pixel.
    pub(super) sums: Vec<[[i128; 3]; LAYERS]>,
    /// Luminance of the brightest sample, per pixel.
    pub(super) brightest: Vec<f32>,
}

/// Exact sums of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub(super) layout: FilmLayout,
    pub(super) sums: Vec<[i128; 3]>,
    pub(super) counts: Vec<u32>,
    pub(super) hits: Vec<u32>,
    pub(super) features: Option<FeatureSums>,
    pub(super) layers: Option<LayerSums>,
    /// Luminance of the parts of the light, per cell, where their noise is asked for.
    pub(super) layer_cells: Option<Vec<[i128; LAYERS]>>,
    pub(super) cross: Option<CrossSums>,
    /// Of [`Sample::widening`], per cell, where it is asked for.
    pub(super) widening: Option<Vec<i128>>,
    /// Samples of the whole film by octave of luminance.
    pub(super) octaves: Octaves,
    pub(super) refused: [u64; 3],
}

impl Film {
    /// An empty film.
    #[must_use]
    pub fn new(layout: FilmLayout) -> Self {
        let pixels = layout.crop[2] as usize * layout.crop[3] as usize;
        let cells = pixels * layout.replications as usize;
        Self {
            sums: vec![[0; 3]; cells],
            counts: vec![0; cells],
            hits: vec![0; pixels],
            features: layout.features.then(|| FeatureSums {
                sums: vec![[0; FEATURES]; pixels],
                ids: vec![(u32::MAX, [0; 2]); pixels],
            }),
            layers: layout
                .layers
                .then(|| LayerSums { sums: vec![[[0; 3]; LAYERS]; pixels], brightest: vec![0.0; pixels] }),
            layer_cells: layout.layer_noise.then(|| vec![[0; LAYERS]; cells]),
            cross: layout.cross.then(|| CrossSums::new([layout.crop[2], layout.crop[3]])),
            widening: layout.widening.then(|| vec![0; cells]),
            octaves: Octaves::new(),
            refused: [0; 3],
            layout,
        }
    }

    /// What the film accumulates.
    #[must_use]
    pub fn layout(&self) -> &FilmLayout {
        &self.layout
    }

    /// Whether it holds no sample.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.counts.iter().all(|&n| n == 0)
    }

    /// Number of pixels.
    #[must_use]
    pub fn pixels(&self) -> usize {
        self.hits.len()
    }

    /// Adds the sample of `pass` at `pixel` (row-major within the crop).
    ///
    /// # Errors
    /// The reason, where the sample is not a radiance; it is then counted and leaves no other trace.
    pub fn add(&mut self, pixel: usize, pass: u32, sample: &Sample) -> Result<(), Refusal> {
        let c = planted!(nan_black(sample.radiance.to_array()));
        let cell = self.accumulate(pixel, pass, c)?;
        let format = self.layout.radiance;
        self.counts[cell] += 1;
        self.octaves.add(sample.radiance.luminance(), 1, format);
        if let Some(sums) = &mut self.layers {
            for (sum, part) in sums.sums[pixel].iter_mut().zip(sample.layers.unwrap_or_default()) {
                for (sum, v) in sum.iter_mut().zip(part.to_array()) {
                    *sum += format.encode(v);
                }
            }
            let brightest = &mut sums.brightest[pixel];
            *brightest = brightest.max(sample.radiance.luminance());
        }
        if let Some(cells) = &mut self.layer_cells {
            for (sum, part) in cells[cell].iter_mut().zip(sample.layers.unwrap_or_default()) {
                *sum += format.encode(part.luminance());
            }
        }
        if let Some(cells) = &mut self.widening
            && format.holds(sample.widening)
        {
            cells[cell] += format.encode(sample.widening);
        }
        let Some(f) = &sample.features else {
            return Ok(());
        };
        self.hits[pixel] += 1;
        if let Some(features) = &mut self.features {
            let unit = FixedPoint::around(1.0);
            let length = self.layout.length;
            let [r, g, b] = f.albedo.to_array().map(|v| unit.encode(v));
            let [x, y, z] = f.normal.map(|v| unit.encode(v));
            let [px, py, pz] = f.position.map(|v| length.encode(v));
            let values = [r, g, b, x, y, z, length.encode(f.depth), px, py, pz];
            for (sum, v) in features.sums[pixel].iter_mut().zip(values) {
                *sum += v;
            }
            let ids = &mut features.ids[pixel];
            if pass < ids.0 {
                *ids = (pass, [f.object, f.material]);
            }
        }
        Ok(())
    }

    /// Adds to the sample of `pass` at `pixel` what light of one layer, and of one class
    /// ([`light_class`](super::light_class)), brought there by another way; it does not count as a sample.
    ///
    /// # Errors
    /// As for [`Self::add`].
    pub fn splat(
        &mut self,
        pixel: usize,
        pass: u32,
        radiance: Rgb,
        layer: LightLayer,
        class: usize,
    ) -> Result<(), Refusal> {
        let c = radiance.to_array();
        let cell = self.accumulate(pixel, pass, c)?;
        let format = self.layout.radiance;
        self.octaves.add(radiance.luminance(), 0, format);
        if let Some(sums) = &mut self.layers {
            for (sum, v) in sums.sums[pixel][layer as usize].iter_mut().zip(c) {
                *sum += format.encode(v);
            }
        }
        if let Some(cells) = &mut self.layer_cells {
            cells[cell][layer as usize] += format.encode(radiance.luminance());
        }
        let [.., width, height] = self.layout.crop;
        if let Some(cross) = &mut self.cross {
            let (x, y) = (pixel as u32 % width, pixel as u32 / width);
            let cell = Level::fine([width, height]).cell(x, y);
            cross.supplied(cell, class, radiance.luminance(), format);
        }
        Ok(())
    }

    /// Adds what the paths of a tile found in a pass of the light that photons find too. Tiles are squares of
    /// [`CELL`](super::CELL) pixels, counted row by row from the top left of the crop.
    pub fn found(&mut self, tile: usize, found: &Found) {
        let format = self.layout.radiance;
        if let Some(cross) = &mut self.cross {
            cross.found(tile, found, format);
        }
    }

    /// Adds photons that say how much light there is: `traced` of them, of which the camera saw `seen`, those of
    /// one photon after each other.
    pub fn glimpses(&mut self, traced: u32, seen: &[Glimpse]) {
        let (format, [.., width, height]) = (self.layout.radiance, self.layout.crop);
        if let Some(cross) = &mut self.cross {
            cross.photons(traced, seen, [width, height], format);
        }
    }

    /// Adds to a sum, whose index it gives; or refuses what is no radiance, and counts that.
    fn accumulate(&mut self, pixel: usize, pass: u32, c: [f32; 3]) -> Result<usize, Refusal> {
        let format = self.layout.radiance;
        let refusal = if c.iter().any(|v| v.is_nan()) {
            Some(Refusal::NotANumber)
        } else if c.iter().any(|&v| v < 0.0) {
            Some(Refusal::Negative)
        } else if c.iter().any(|&v| !format.holds(v)) {
            Some(Refusal::Overflow)
        } else {
            None
        };
        if let Some(refusal) = refusal {
            self.refused[refusal as usize] += 1;
            return Err(refusal);
        }
        let k = self.layout.replications;
        let cell = pixel * k as usize + (pass % k) as usize;
        for (sum, v) in self.sums[cell].iter_mut().zip(c) {
            let with = *sum + format.encode(v);
            *sum = planted!(running_mean(with, *sum, self.counts[cell] + 1));
        }
        Ok(cell)
    }

    /// Adds what another film holds; the same as if its samples had been added here.
    ///
    /// # Errors
    /// Gives `other` back where the two have different layouts.
    pub fn merge(&mut self, other: Self) -> Result<(), Box<Self>> {
        if self.layout != other.layout {
            return Err(Box::new(other));
        }
        fn add<const N: usize>(sums: &mut [[i128; N]], others: &[[i128; N]]) {
            for (sum, other) in sums.iter_mut().flatten().zip(others.iter().flatten()) {
                *sum += other;
            }
        }
        add(&mut self.sums, &other.sums);
        for (n, other) in self.counts.iter_mut().zip(&other.counts) {
            *n += other;
        }
        for (n, other) in self.hits.iter_mut().zip(&other.hits) {
            *n += other;
        }
        if let (Some(own), Some(other)) = (&mut self.features, &other.features) {
            add(&mut own.sums, &other.sums);
            for (ids, &other) in own.ids.iter_mut().zip(&other.ids) {
                if other.0 < ids.0 {
                    *ids = other;
                }
            }
        }
        if let (Some(own), Some(other)) = (&mut self.cross, &other.cross) {
            own.merge(other);
        }
        if let (Some(own), Some(other)) = (&mut self.layers, &other.layers) {
            for (sums, other) in own.sums.iter_mut().zip(&other.sums) {
                add(sums, other);
            }
            for (brightest, &other) in own.brightest.iter_mut().zip(&other.brightest) {
                *brightest = brightest.max(other);
            }
        }
        if let (Some(own), Some(other)) = (&mut self.layer_cells, &other.layer_cells) {
            add(own, other);
        }
        if let (Some(own), Some(other)) = (&mut self.widening, &other.widening) {
            own.iter_mut().zip(other).for_each(|(sum, other)| *sum += other);
        }
        self.octaves.merge(&other.octaves);
        for (n, other) in self.refused.iter_mut().zip(other.refused) {
            *n += other;
        }
        Ok(())
    }

    /// Samples refused for a reason.
    #[must_use]
    pub fn refused(&self, reason: Refusal) -> u64 {
        self.refused[reason as usize]
    }

    /// Samples refused for any reason.
    #[must_use]
    pub fn refused_total(&self) -> u64 {
        self.refused.iter().sum()
    }

    /// Means over all replications, the variance of each mean, counts and features.
    #[must_use]
    pub fn to_image(&self) -> Image {
        let [x, y, width, height] = self.layout.crop;
        let cells = |pixel: usize| {
            let k = self.layout.replications as usize;
            pixel * k..(pixel + 1) * k
        };
        let mut image =
            Image { width, height, origin: [x, y], full_size: self.layout.full_size, ..Image::default() };
        let (mut variance, mut count) = (Vec::new(), Vec::new());
        for pixel in 0..self.pixels() {
            let n: u32 = self.counts[cells(pixel)].iter().sum();
            let mean = |channel: usize| {
                let sum: i128 = self.sums[cells(pixel)].iter().map(|s| s[channel]).sum();
                self.layout.radiance.mean(sum, n)
            };
            let means = [mean(0), mean(1), mean(2)];
            image.rgb.push(Rgb::from(means.map(|v| v as f32)));
            count.push(n);
            variance
                .push(Rgb::from(std::array::from_fn(|c| self.variance_of_mean(cells(pixel), c, means[c]))));
        }
        image.variance = Some(variance);
        image.count = Some(count);
        if self.layout.transparent {
            let alpha = |pixel: usize| {
                let n: u32 = self.counts[cells(pixel)].iter().sum();
                if n == 0 { 0.0 } else { self.hits[pixel] as f32 / n as f32 }
            };
            image.alpha = Some((0..self.pixels()).map(alpha).collect());
        }
        if let Some(features) = &self.features {
            image.layers = self.feature_layers(features);
        }
        if let Some(sums) = &self.layers {
            image.layers.extend(self.light_layers(sums));
        }
        image
    }

    /// Variance of the pooled mean of one channel, from the means of the replications: with n_r samples
    /// in replication r, sum n_r (m_r - m)^2 / ((R - 1) n), R being the replications that have any. It
    /// is unbiased for equal n_r, and needs at least two.
    fn variance_of_mean(&self, cells: std::ops::Range<usize>, channel: usize, mean: f64) -> f32 {
        let (mut r, mut n, mut sum) = (0u32, 0u32, 0.0);
        for cell in cells {
            let n_r = self.counts[cell];
            if n_r > 0 {
                let d = self.layout.radiance.mean(self.sums[cell][channel], n_r) - mean;
                (r, n, sum) = (r + 1, n + n_r, sum + f64::from(n_r) * d * d);
            }
        }
        if r < 2 { f32::INFINITY } else { (sum / (f64::from(r - 1) * f64::from(n))) as f32 }
    }

    fn feature_layers(&self, features: &FeatureSums) -> Vec<Layer> {
        let unit = FixedPoint::around(1.0);
        let channel = |name: &str, i: usize, format: FixedPoint| {
            let mean =
                |(pixel, sums): (usize, &[i128; FEATURES])| format.mean(sums[i], self.hits[pixel]) as f32;
            (name.to_owned(), features.sums.iter().enumerate().map(mean).collect())
        };
        let id = |name: &str, i: usize| {
            (name.to_owned(), features.ids.iter().map(|(_, ids)| ids[i] as f32).collect())
        };
        let length = self.layout.length;
        let layer = |channels| Layer { channels };
        vec![
            layer(vec![
                channel("albedo.R", 0, unit),
                channel("albedo.G", 1, unit),
                channel("albedo.B", 2, unit),
            ]),
            layer(vec![channel("N.X", 3, unit), channel("N.Y", 4, unit), channel("N.Z", 5, unit)]),
            layer(vec![channel("Z", 6, length)]),
            layer(vec![channel("P.X", 7, length), channel("P.Y", 8, length), channel("P.Z", 9, length)]),
            layer(vec![id("objectId", 0)]),
            layer(vec![id("materialId", 1)]),
        ]
    }

    /// `direct.R` and so on, and `brightest`.
    fn light_layers(&self, sums: &LayerSums) -> Vec<Layer> {
        let n = |pixel: usize| {
            let k = self.layout.replications as usize;
            self.counts[pixel * k..(pixel + 1) * k].iter().sum()
        };
        let mean = |layer: LightLayer, c: usize| {
            let of = |(pixel, sums): (usize, &[[i128; 3]; LAYERS])| {
                self.layout.radiance.mean(sums[layer as usize][c], n(pixel)) as f32
            };
            sums.sums.iter().enumerate().map(of).collect()
        };
        let layer = |of: LightLayer| {
            let channel = |(c, name)| (format!("{}.{name}", of.name()), mean(of, c));
            Layer { channels: ["R", "G", "B"].into_iter().enumerate().map(channel).collect() }
        };
        let mut layers: Vec<Layer> = LightLayer::ALL.into_iter().map(layer).collect();
        layers.push(Layer { channels: vec![("brightest".to_owned(), sums.brightest.clone())] });
        layers
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(replications: u32) -> FilmLayout {
        FilmLayout { replications, ..FilmLayout::plain([2, 1]) }
    }

    fn sample(v: f32) -> Sample {
        Sample { radiance: Rgb::new(v, 2.0 * v, 0.5), ..Sample::default() }
    }

    /// N67: the order of samples does not matter, to the last bit.
    #[test]
    fn order_does_not_matter() {
        let values: Vec<f32> = (0..1000).map(|i| 1.0 / (1.0 + i as f32 * 0.37)).collect();
        let (mut a, mut b) = (Film::new(layout(4)), Film::new(layout(4)));
        for (i, &v) in values.iter().enumerate() {
            a.add(0, i as u32, &sample(v)).expect("a radiance");
        }
        for (i, &v) in values.iter().enumerate().rev() {
            b.add(0, i as u32, &sample(v)).expect("a radiance");
        }
        assert_eq!(a, b);
        assert_eq!(a.to_image().count, Some(vec![1000, 0]));
    }

    /// Guards that the parts of a render, merged, are the render, with layers and features too.
    #[test]
    fn merged_films_are_one_film() {
        let recording = FilmLayout { features: true, layers: true, layer_noise: true, ..layout(4) };
        let full = |i: u32| {
            let radiance = Rgb::new(0.3, 0.1 * i as f32, 7.0 / (1.0 + i as f32));
            let layers = [radiance * 0.25, radiance * 0.5, Rgb::BLACK, radiance * 0.25, Rgb::BLACK];
            let features = (!i.is_multiple_of(3)).then(|| Features {
                object: i,
                depth: i as f32,
                ..Features::default()
            });
            Sample { radiance, features, layers: Some(layers), widening: 0.0 }
        };
        let mut whole = Film::new(recording.clone());
        let mut parts = [Film::new(recording.clone()), Film::new(recording)];
        for i in 0..100 {
            whole.add(i % 2, i as u32, &full(i as u32)).expect("a radiance");
            parts[usize::from(i < 37)].add(i % 2, i as u32, &full(i as u32)).expect("a radiance");
        }
        let [mut a, b] = parts;
        a.merge(b).expect("one layout");
        assert_eq!(a, whole);
        let image = a.to_image();
        for (pixel, c) in image.rgb.iter().enumerate() {
            let layers = LightLayer::ALL.map(|l| format!("{}.R", l.name()));
            let channels = image.layers.iter().flat_map(|l| &l.channels);
            let sum: f32 = channels.filter(|(n, _)| layers.contains(n)).map(|(_, v)| v[pixel]).sum();
            assert!((sum / c.r - 1.0).abs() < 1e-5, "layers add up to the picture");
        }
        assert!(a.merge(Film::new(layout(2))).is_err(), "another layout is refused");
    }

    /// N64: what is not a radiance is counted by cause, excluded from the count, and leaves the mean clean.
    #[test]
    fn bad_samples_are_refused_and_counted() {
        let mut film = Film::new(layout(4));
        for pass in 0..8 {
            film.add(0, pass, &sample(0.25)).expect("a radiance");
        }
        let bad = |r: f32| Sample { radiance: Rgb::new(0.1, r, 0.1), ..Sample::default() };
        assert_eq!(film.add(0, 8, &bad(f32::NAN)), Err(Refusal::NotANumber));
        assert_eq!(film.add(0, 9, &bad(f32::INFINITY)), Err(Refusal::Overflow));
        assert_eq!(film.add(0, 10, &bad(-1.0)), Err(Refusal::Negative));
        let image = film.to_image();
        assert_eq!((image.rgb[0], image.count.as_ref().map(|c| c[0])), (Rgb::new(0.25, 0.5, 0.5), Some(8)));
        assert_eq!(film.refused_total(), 3);
    }

    /// N63: the variance of the mean is unbiased, and equals the sample variance over n for
    /// independent samples.
    #[test]
    fn variance_of_the_mean_is_unbiased() {
        let mut film = Film::new(FilmLayout { crop: [0, 0, 400, 10], full_size: [400, 10], ..layout(4) });
        let mut state = 1u64;
        for pixel in 0..4000 {
            for pass in 0..16 {
                state = crate::math::mix64(state.wrapping_add(0x9e37_79b9_7f4a_7c15));
                let u = (state >> 40) as f32 / 16_777_216.0;
                film.add(pixel, pass, &Sample { radiance: Rgb::grey(1000.0 + u), ..Sample::default() })
                    .expect("ok");
            }
        }
        let image = film.to_image();
        let mean: f64 =
            image.variance.expect("estimated").iter().map(|v| f64::from(v.r)).sum::<f64>() / 4000.0;
        let expected = 1.0 / 12.0 / 16.0;
        assert!((mean / expected - 1.0).abs() < 0.06, "{mean} {expected}");
    }
}

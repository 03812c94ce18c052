//! Samples one by one, for whoever measures estimators instead of making a picture.
//!
//! In: a prepared scene. Out: for each pixel and pass the luminance that the sample adds, with what is known of it.
//! The samples are those of [`render`](super::render()), bit for bit.

use rayon::prelude::*;

use super::kernels::{Kernel, kernel};
use super::path::Counters;
use super::photon::{Maps, Radius, Tracer};
use super::render::sample;
use crate::film::LightLayer;
use crate::prepare::Prepared;

/// A sample of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Probed {
    /// Luminance of all that the path brought.
    pub(crate) luminance: f64,
    /// That of the caustics in it.
    pub(crate) caustics: f64,
    /// Whether some of it was seen in a mirror or through clear glass.
    pub(crate) through: bool,
    /// Rays that it took.
    pub(crate) rays: u64,
    /// Photons that it gathered.
    pub(crate) gathered: u64,
}

/// The photons of a pass.
pub(crate) struct Photons {
    maps: Option<Maps>,
    /// Pixel (row-major) and luminance of what the camera sees of them directly.
    pub(crate) splats: Vec<(u32, f64)>,
    /// Rays that they took.
    pub(crate) rays: u64,
}

/// What takes samples of a scene.
pub(crate) struct Probe<'a> {
    scene: &'a Prepared,
    kernel: Kernel,
    tracer: Option<Tracer<'a>>,
}

impl<'a> Probe<'a> {
    /// Of the whole picture of `scene`, as its plan says, with so many photons in a pass.
    pub(crate) fn new(scene: &'a Prepared, photons: u32) -> Self {
        let [width, height] = scene.size;
        let tracer = Tracer::new(scene, [0, 0, width, height], None).map(|t| t.with(photons));
        Self { scene, kernel: kernel(&scene.plan), tracer }
    }

    /// Traces the photons of a pass and keeps them in one map for each radius; none of both where the plan has none.
    pub(crate) fn photons<const N: usize>(&self, pass: u32, radii: [Radius; N]) -> [Photons; N] {
        let mut rays = 0;
        let (mut splats, mut parts) = (Vec::new(), Vec::new());
        if let Some(tracer) = &self.tracer {
            let chunk = |chunk| {
                let mut counters = Counters::default();
                let traced = tracer.trace(pass, chunk, &mut counters);
                (traced, counters.rays)
            };
            let chunks: Vec<_> = (0..tracer.chunks()).into_par_iter().map(chunk).collect();
            for (traced, took) in chunks {
                rays += took;
                splats.extend(traced.splats.iter().map(|s| (s.pixel, f64::from(s.radiance.luminance()))));
                parts.push((traced.layer, traced.photons));
            }
        }
        radii.map(|radius| {
            let tracer = self.tracer.as_ref().filter(|t| t.gathers());
            let maps = tracer.map(|t| t.maps(radius, parts.clone()));
            Photons { maps, splats: splats.clone(), rays }
        })
    }

    /// The samples of all pixels in a pass, row-major.
    pub(crate) fn pass(&self, pass: u32, photons: &Photons) -> Vec<Probed> {
        let [width, height] = self.scene.size;
        let one = |i: u32| {
            let mut counters = Counters::default();
            let pixel = [i % width, i / width];
            let maps = photons.maps.as_ref();
            let found = sample(self.scene, &self.kernel, true, pixel, pass, maps, &mut counters);
            let layers = found.layers.unwrap_or_default();
            Probed {
                luminance: f64::from(found.radiance.luminance()),
                caustics: f64::from(layers[LightLayer::Caustic as usize].luminance()),
                through: !layers[LightLayer::Glass as usize].is_black(),
                rays: counters.rays,
                gathered: counters.gathered,
            }
        };
        (0..width * height).into_par_iter().with_min_len(16).map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::photon;
    use crate::prepare::{Algorithms, CausticsMode, EffectsMode, Options, Shortcuts, prepare};
    use crate::scene::text::parse_toml;
    use crate::scene::{complete, validate};
    use crate::stats::Moments;

    /// A pane of glass, 24x24 pixels, by photons.
    fn slab() -> Prepared {
        let mut scene =
            parse_toml(include_str!("../../fixtures/golden/glass-slab/scene.toml")).expect("a scene").0;
        validate(&mut scene).expect("a valid scene");
        complete(&mut scene);
        let algorithms = Algorithms { caustics: CausticsMode::Photon, ..Algorithms::PATHS };
        let options = Options {
            camera: None,
            size: [24, 24],
            seed: 3,
            effects: EffectsMode::Auto,
            max_depth: None,
            shortcuts: Shortcuts::default(),
            transparent: false,
            algorithms,
        };
        prepare(&scene, &options).expect("a camera")
    }

    /// Guards what is said of the noise of gathered photons (see [`crate::film::MapBias`]): disks of twice the area take
    /// half of it away, and the difference to disks of twice the radius varies by 9/16 of it.
    #[test]
    fn wider_disks_tell_the_noise_of_photons() {
        const PASSES: u32 = 96;
        let prepared = slab();
        let probe = Probe::new(&prepared, photon::photons(24 * 24));
        let radii = [0.5, 0.5 * std::f32::consts::SQRT_2, 1.0].map(|factor| Radius { factor, pixel: 1.0 });
        let mut moments = vec![[Moments::default(); 3]; 24 * 24];
        for pass in 0..PASSES {
            let [own, larger, wide] = probe.photons(pass, radii).map(|photons| probe.pass(pass, &photons));
            for (i, m) in moments.iter_mut().enumerate() {
                m[0].add(own[i].luminance);
                m[1].add(larger[i].luminance);
                m[2].add(wide[i].luminance - own[i].luminance);
            }
        }
        let variance = |k: usize| moments.iter().map(|m| m[k].variance()).sum::<f64>();
        let [halved, told] = [2.0 * (variance(0) - variance(1)), 16.0 / 9.0 * variance(2)];
        assert!((told / halved - 1.0).abs() < 0.1, "{told} {halved} of {}", variance(0));
    }

    /// Guards what wider disks add, as samples record it, by pictures with either: in a picture so small that each sample
    /// looks at wider disks.
    #[test]
    fn wider_disks_add_what_they_show() {
        let prepared = slab();
        let count = photon::photons(24 * 24);
        let probe = Probe::new(&prepared, count);
        let radii = [1.0, 2.0].map(|factor| Radius { factor, pixel: 1.0 });
        let [own, wide] = probe.photons(0, radii).map(|photons| probe.pass(0, &photons));
        let tracer = Tracer::new(&prepared, [0, 0, 24, 24], None).expect("photons");
        let trace = |chunk| tracer.trace(0, chunk, &mut Counters::default());
        let parts = (0..tracer.chunks()).map(trace).map(|t| (t.layer, t.photons)).collect();
        let maps = tracer.maps(Radius::of(0), parts);
        let (mut largest, kernel) = (0.0f64, kernel(&prepared.plan));
        for (i, (own, wide)) in own.iter().zip(&wide).enumerate() {
            let pixel = [i as u32 % 24, i as u32 / 24];
            let found = sample(&prepared, &kernel, false, pixel, 0, Some(&maps), &mut Counters::default());
            assert_eq!(f64::from(found.radiance.luminance()), own.luminance);
            let expected = wide.luminance - own.luminance;
            let found = f64::from(found.widening);
            assert!(
                (found - expected).abs() <= 1e-4 * (1.0 + wide.luminance),
                "{pixel:?}: {found} {expected}"
            );
            largest = largest.max(found.abs());
        }
        assert!(largest > 0.01, "{largest}");
    }
}

//! Pictures of all ways at equal time and at equal error, and of the parts of the light.

use super::measure::{APART, CostOptions};
use super::report::{LayerShare, Measured};
use super::run::Work;
use super::switches::{Kind, Switch, reference};
use crate::color::Rgb;
use crate::film::LightLayer;
use crate::integrate::RunError;
use crate::output::Tone;
use crate::page::picture;
use crate::prepare::Options;
use crate::scene::Scene;

/// Pictures to look at, row-major, linear.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// How they are shown on a screen.
    pub tone: Tone,
    /// The full picture, as good as there was time for.
    pub whole: Vec<Rgb>,
    /// Samples a pixel of it.
    pub spp: u32,
    /// The parts of its light.
    pub layers: Vec<LayerPicture>,
    /// Each way, in the order of the report.
    pub switches: Vec<SwitchPictures>,
}

/// A part of the light.
#[derive(Clone, Debug)]
pub struct LayerPicture {
    /// Its name.
    pub name: &'static str,
    /// Its light.
    pub rgb: Vec<Rgb>,
}

/// A way to render, seen.
#[derive(Clone, Debug, Default)]
pub struct SwitchPictures {
    /// In the time of the full method's picture.
    pub equal_time: Vec<Rgb>,
    /// Samples a pixel of it.
    pub spp: u32,
    /// Processor seconds of it.
    pub seconds: f64,
    /// With the error of the full method's picture.
    pub equal_error: EqualError,
}

/// A picture with the error that the full method has in its time.
#[derive(Clone, Debug, Default)]
pub enum EqualError {
    /// It is the full method's own.
    #[default]
    Own,
    /// There is none: the bias alone is larger.
    Never,
    /// It would take so many processor seconds, and was left out.
    TooLong(f64),
    /// It took so many samples a pixel and processor seconds.
    Picture(Vec<Rgb>, u32, f64),
}

/// Pixels of all pictures together, which a page has to carry.
const PIXELS: f64 = 1.3e6;
/// Widest and narrowest picture, pixels.
const WIDTHS: [f64; 2] = [64.0, 320.0];
/// Times the full picture's time that equal error may take.
const LONGEST: f64 = 4.0;
/// A way takes at least this share of the time that its work suggests.
const LEAST_OF_WORK: f64 = 0.1;
/// A layer that holds less of the light is not shown.
const NEXT_TO_NOTHING: f64 = 1e-5;

/// Renders them, with so much work in all: also what the picture is made of.
pub(super) fn render(
    scene: &Scene,
    options: &CostOptions,
    ways: &[Switch],
    measured: &[Measured],
    units: &[f64],
    budget: f64,
    work: &mut Work<'_>,
) -> Result<(Pictures, Vec<LayerShare>), RunError> {
    let size = size(options.prepare.size, ways.len());
    let pixels = |[w, h]: [u32; 2]| f64::from(w) * f64::from(h);
    let at_size =
        Options { size, seed: options.prepare.seed.wrapping_add(2 * APART), ..options.prepare.clone() };
    // A pass of a picture is so many passes of a measured one, and takes so long.
    let larger = pixels(size) / pixels(options.measured);
    let scale = pixels(size) / pixels(options.prepare.size);
    // Clocks of processors tick slowly: what takes less than a tick does not take nothing, but as its work has it.
    let ticked: f64 = measured.iter().map(|m| m.seconds_per_pass).sum();
    let of_work = (ticked / units.iter().sum::<f64>()).max(f64::MIN_POSITIVE);
    let seconds = |i: usize| measured[i].seconds_per_pass.max(LEAST_OF_WORK * of_work * units[i]) * scale;
    let each = budget / (2 * ways.len() + 2) as f64;
    let passes = (each / (units[0] * larger)).clamp(1.0, 4096.0).floor();
    let time = passes * seconds(0);
    let square = noise(&measured[0]) / passes;
    let mut pictures = Pictures { size, tone: tone(scene), ..Pictures::default() };
    for (i, way) in ways.iter().enumerate() {
        let prepared = way.prepare(scene, &at_size)?;
        let shot = |passes: f64, work: &mut Work<'_>| -> Result<(Vec<Rgb>, u32, f64), RunError> {
            let n = passes.round().clamp(1.0, 65_536.0) as u32;
            work.doing = format!("a picture {}", way.name);
            let rendered = work.film(&prepared, n, false, units[i] * larger)?;
            Ok((rendered.film.to_image().rgb, n, f64::from(n) * seconds(i)))
        };
        let (equal_time, spp, took) = shot(time / seconds(i).max(1e-12), work)?;
        let left = square - bias(&measured[i]);
        let needed = noise(&measured[i]) / left;
        let equal_error = if way.kind == Kind::Full {
            EqualError::Own
        } else if left <= 0.0 {
            EqualError::Never
        } else if needed * seconds(i) > LONGEST * time {
            EqualError::TooLong(needed * seconds(i))
        } else {
            let (rgb, spp, seconds) = shot(needed, work)?;
            EqualError::Picture(rgb, spp, seconds)
        };
        pictures.switches.push(SwitchPictures { equal_time, spp, seconds: took, equal_error });
    }
    let passes = (2.0 * each / (units[0] * larger)) as u32;
    let layers =
        parts(scene, &ways[0], (&at_size, options.unbiased), units[0] * larger, passes, &mut pictures, work)?;
    Ok((pictures, layers))
}

/// V of one sample, or E^2 of another way to the same picture.
fn noise(way: &Measured) -> f64 {
    let Some(last) = way.points.last() else { return 0.0 };
    let square = if way.kind == Kind::Shortcut {
        last.noise * last.noise
    } else {
        last.error.value * last.error.value
    };
    square * f64::from(last.spp)
}

/// The squared bias of a shortcut, as far as it is proved.
fn bias(way: &Measured) -> f64 {
    let proved = way.kind == Kind::Shortcut && way.floor.low > 0.0;
    if proved { way.floor.value * way.floor.value } else { 0.0 }
}

/// As large as a page can carry that many of.
fn size([w, h]: [u32; 2], ways: usize) -> [u32; 2] {
    let aspect = f64::from(h) / f64::from(w);
    let width =
        (PIXELS / (2 * ways + 5) as f64 / aspect).sqrt().min(WIDTHS[1] / aspect.max(1.0)).max(WIDTHS[0]);
    let width = width.min(f64::from(w)).floor();
    [width.max(1.0) as u32, (width * aspect).round().max(1.0) as u32]
}

/// As the scene says.
fn tone(scene: &Scene) -> Tone {
    Tone { curve: scene.settings.tone.unwrap_or_default(), exposure: scene.settings.exposure.unwrap_or(0.0) }
}

/// The whole picture and its layers, as clean as the reference makes them in so many passes, which no clock may
/// decide: the shares of the light are figures of the scene. The shares of noise and rays are those of the full method.
fn parts(
    scene: &Scene,
    full: &Switch,
    (options, unbiased): (&Options, bool),
    unit: f64,
    passes: u32,
    pictures: &mut Pictures,
    work: &mut Work<'_>,
) -> Result<Vec<LayerShare>, RunError> {
    /// Passes of the full method: enough for variances.
    const PASSES: u32 = 16;
    work.doing = "the parts of the light".to_owned();
    let prepared = full.prepare(scene, options)?;
    let own = work.film(&prepared, PASSES, true, unit)?;
    let of_full = own.film.layer_shares();
    let rays: u64 = own.counters.layer_rays.iter().sum();
    let clean = reference(scene, options, unbiased)?;
    let passes = passes.clamp(PASSES, 4096);
    let image = work.film(&clean, passes, true, unit)?.film.to_image();
    let whole = picture::total(&image.rgb);
    let mut shares = Vec::new();
    for layer in LightLayer::ALL {
        let Some(rgb) = picture::layer(&image, layer.name()) else { continue };
        let light = picture::total(&rgb) / whole.max(f64::MIN_POSITIVE);
        if light > NEXT_TO_NOTHING {
            let noise = of_full.map(|all| all[layer as usize].noise);
            let rays = (rays > 0).then(|| own.counters.layer_rays[layer as usize] as f64 / rays as f64);
            shares.push(LayerShare { name: layer.name(), light, noise, rays });
            pictures.layers.push(LayerPicture { name: layer.name(), rgb });
        }
    }
    pictures.whole = image.rgb;
    pictures.spp = passes;
    Ok(shares)
}

//! What was recorded of a scene, as an image and a text, and back.
//!
//! `reference.exr` holds the mean over the null runs, the variance of that mean, counts, light layers, the
//! brightest samples, and the profile of the pilots, from which statistics and weights follow.
//! `reference.json` holds the rest: hashes, provenance, and every statistic's value in each null run.

use serde::{Deserialize, Serialize};

use super::run::{LUMINANCE, Run};
use super::suite::Settings;
use crate::color::Rgb;
use crate::film::{Image, Layer};
use crate::stats::Moments;
use crate::stats::gate::{Family, Null, NullStatistic, Profile};

/// Name and version of the text's form.
pub const SCHEMA: &str = "epsilux.golden/1";

/// What runs of a scene are like.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// SHA-256 of the scene.
    pub scene_sha256: String,
    /// How it was rendered.
    pub settings: Settings,
    /// Which program rendered it.
    pub software: String,
    /// Number of pilots.
    pub pilots: u32,
    /// What the pilots were like.
    pub profile: Profile,
    /// What is looked at; follows from the profile.
    pub family: Family,
    /// What that does when nothing is wrong.
    pub null: Null,
    /// Mean over the null runs.
    pub image: Image,
    /// Error over samples of the null runs.
    pub curve: Vec<Stage>,
    /// How it is known that it is right.
    pub truth: Found,
    /// SHA-256 of the picture of the first run with a fixed test seed.
    pub test_sha256: String,
}

/// Error of null runs after some of their samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Samples a pixel.
    pub spp: u32,
    /// Mean of the logarithm of the relative error.
    pub ln_error: f64,
    /// Deviation of it.
    pub deviation: f64,
}

/// What the reference was compared with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Found {
    /// `closed form`, `reference integrator` or `render`.
    pub kind: String,
    /// A line for people.
    pub statement: String,
    /// Probability of a difference as large where both are right.
    pub p: Option<f64>,
    /// The relative shift that would have been noticed with a probability of 99 %.
    pub notices: Option<f64>,
}

/// Why recorded files cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// The text is not JSON of this form.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// The form is another.
    #[error("found the schema {0:?}, expected {SCHEMA:?}")]
    Schema(String),
    /// The two files do not belong together, or another program chose the statistics.
    #[error("{0}; record it anew with `epsilux golden bless`")]
    Mismatch(String),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    schema: String,
    software: String,
    scene_sha256: String,
    settings: Settings,
    pilots: u32,
    runs: usize,
    truth: Found,
    test_sha256: String,
    curve: Vec<Stage>,
    statistics: Vec<StatisticText>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StatisticText {
    name: String,
    mean: f64,
    deviation: f64,
    skewness: f64,
    scale: f64,
    linear: [f64; 2],
    /// Value in each null run, in thousandths of the deviation from the mean.
    runs: Vec<i32>,
}

const PILOT_MEAN: &str = "pilot-mean.";
const PILOT_VARIANCE: &str = "pilot-variance.";

impl Reference {
    /// The image and the text of the two files.
    ///
    /// # Errors
    /// A number is not finite.
    pub fn to_files(&self) -> Result<(Image, String), ReferenceError> {
        let finite = |n: &NullStatistic| {
            [n.mean, n.deviation, n.skewness, n.scale, n.linear[0], n.linear[1]].iter().all(|v| v.is_finite())
        };
        if !self.null.statistics.iter().all(finite) {
            return Err(ReferenceError::Mismatch("a statistic of the runs is not a number".to_owned()));
        }
        let mut image = self.image.clone();
        let plane = |prefix: &str, name: &str, values: &[f32]| Layer {
            channels: vec![(format!("{prefix}{name}"), values.to_vec())],
        };
        for (name, mean, variance) in &self.profile.planes {
            image.layers.push(plane(PILOT_MEAN, name, mean));
            image.layers.push(plane(PILOT_VARIANCE, name, variance));
        }
        let statistic = |(statistic, null): (&crate::stats::gate::Statistic, &NullStatistic)| StatisticText {
            name: statistic.to_string(),
            mean: null.mean,
            deviation: null.deviation,
            skewness: null.skewness,
            scale: null.scale,
            linear: null.linear,
            runs: null
                .values
                .iter()
                .map(|v| (1000.0 * (v - null.mean) / null.deviation).round() as i32)
                .collect(),
        };
        let text = Text {
            schema: SCHEMA.to_owned(),
            software: self.software.clone(),
            scene_sha256: self.scene_sha256.clone(),
            settings: self.settings.clone(),
            pilots: self.pilots,
            runs: self.runs(),
            truth: self.truth.clone(),
            test_sha256: self.test_sha256.clone(),
            curve: self.curve.clone(),
            statistics: self.family.statistics.iter().zip(&self.null.statistics).map(statistic).collect(),
        };
        Ok((image, lines(&serde_json::to_value(&text)?)))
    }

    /// The inverse of [`to_files`](Self::to_files).
    ///
    /// # Errors
    /// The text is not of this form, or the image does not belong to it.
    pub fn from_files(mut image: Image, text: &str) -> Result<Self, ReferenceError> {
        let mismatch = |message: String| ReferenceError::Mismatch(message);
        let schema: Schema = serde_json::from_str(text)?;
        if schema.schema != SCHEMA {
            return Err(ReferenceError::Schema(schema.schema));
        }
        let text: Text = serde_json::from_str(text)?;
        let [width, height] = text.settings.size;
        if (image.width, image.height) != (width, height) {
            let found = format!("the image has {}x{} pixels", image.width, image.height);
            return Err(mismatch(format!("{found}, expected {width}x{height}")));
        }
        let (pilots, layers): (Vec<Layer>, Vec<Layer>) = std::mem::take(&mut image.layers)
            .into_iter()
            .partition(|l| l.channels.iter().all(|(name, _)| name.starts_with("pilot-")));
        image.layers = layers;
        let channels: Vec<(String, Vec<f32>)> = pilots.into_iter().flat_map(|l| l.channels).collect();
        let find = |prefix: &str, name: &str| {
            let wanted = format!("{prefix}{name}");
            channels.iter().find(|(n, _)| *n == wanted).map(|(_, v)| v.clone())
        };
        let mut planes = Vec::new();
        for name in super::PLANES {
            if let (Some(mean), Some(variance)) = (find(PILOT_MEAN, name), find(PILOT_VARIANCE, name)) {
                planes.push((name.to_owned(), mean, variance));
            }
        }
        if planes.iter().all(|(name, ..)| name != LUMINANCE) {
            return Err(mismatch("the image lacks the profile of the pilots".to_owned()));
        }
        let scalars = super::run::scalar::ALL.iter().map(|s| (*s).to_owned()).collect();
        let profile = Profile { width: width as usize, height: height as usize, planes, scalars };
        let family = Family::design(&profile);
        let same = family.statistics.len() == text.statistics.len()
            && family.statistics.iter().zip(&text.statistics).all(|(s, t)| s.to_string() == t.name);
        if !same {
            return Err(mismatch("the statistics are not those that this version chooses".to_owned()));
        }
        let means = super::run::planes(&image);
        let statistic = |(s, of): (StatisticText, &crate::stats::gate::Statistic)| NullStatistic {
            values: s.runs.iter().map(|&z| s.mean + 0.001 * f64::from(z) * s.deviation).collect(),
            mean: s.mean,
            deviation: s.deviation,
            skewness: s.skewness,
            scale: s.scale,
            linear: s.linear,
            magnitude: of.magnitude(&means).unwrap_or(1.0),
        };
        let null =
            Null { statistics: text.statistics.into_iter().zip(&family.statistics).map(statistic).collect() };
        if null
            .statistics
            .iter()
            .any(|s| s.values.len() != text.runs || !(s.deviation > 0.0 && s.scale > 0.0))
        {
            return Err(mismatch("a statistic lacks values or has no deviation".to_owned()));
        }
        Ok(Self {
            scene_sha256: text.scene_sha256,
            settings: text.settings,
            software: text.software,
            pilots: text.pilots,
            profile,
            family,
            null,
            image,
            curve: text.curve,
            truth: text.truth,
            test_sha256: text.test_sha256,
        })
    }

    /// Number of null runs.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.null.statistics.first().map_or(0, |s| s.values.len())
    }
}

#[derive(Deserialize)]
struct Schema {
    schema: String,
}

/// JSON with a line for each member of the outermost object and each statistic: a change shows where it is.
fn lines(value: &serde_json::Value) -> String {
    let mut text = String::from("{\n");
    let members = value.as_object().into_iter().flatten();
    let count = members.clone().count();
    for (i, (key, value)) in members.enumerate() {
        let comma = if i + 1 < count { "," } else { "" };
        match value.as_array().filter(|a| a.iter().any(serde_json::Value::is_object)) {
            Some(items) => {
                let items: Vec<String> = items.iter().map(|v| format!("  {v}")).collect();
                text += &format!("\"{key}\": [\n{}\n]{comma}\n", items.join(",\n"));
            }
            None => text += &format!("\"{key}\": {value}{comma}\n"),
        }
    }
    text + "}\n"
}

/// The mean of runs as an image: the variance is that of the mean, from the differences between runs.
pub(super) fn mean_image(runs: &[Run]) -> Option<Image> {
    let first = &runs.first()?.image;
    let n = runs.len() as f64;
    let pixels = first.rgb.len();
    let moments = |i: usize, c: usize| Moments::from_iter(runs.iter().map(|r| f64::from(r.image.rgb[i][c])));
    let mut image = Image { rgb: Vec::new(), variance: None, count: None, ..first.clone() };
    let mut variance = Vec::new();
    for i in 0..pixels {
        let m = [0, 1, 2].map(|c| moments(i, c));
        image.rgb.push(Rgb::from(m.map(|m| m.mean as f32)));
        variance.push(Rgb::from(m.map(|m| (m.variance() / n) as f32)));
    }
    // A single run knows its variance from its replications.
    image.variance = if runs.len() > 1 { Some(variance) } else { first.variance.clone() };
    let counts = |i: usize| runs.iter().filter_map(|r| r.image.count.as_ref()).map(|c| c[i]).sum();
    image.count = first.count.as_ref().map(|_| (0..pixels).map(counts).collect());
    for (l, layer) in image.layers.iter_mut().enumerate() {
        for (c, (name, values)) in layer.channels.iter_mut().enumerate() {
            let of = |i: usize| runs.iter().map(move |r| r.image.layers[l].channels[c].1[i]);
            for (i, value) in values.iter_mut().enumerate() {
                *value = if name == "brightest" {
                    of(i).fold(0.0, f32::max)
                } else {
                    (of(i).map(f64::from).sum::<f64>() / n) as f32
                };
            }
        }
    }
    Some(image)
}

//! Gates without statistics.

use sha2::{Digest, Sha256};

use super::reference::Reference;
use super::run::{Run, Subject};
use super::verdict::Check;
use crate::color::Rgb;
use crate::film::{Film, FilmLayout, Image, Sample};
use crate::integrate::RunError;
use crate::output::{self, Format, WriteOptions};
use crate::scene;

/// The scene is the one that was recorded.
pub(super) fn scene(subject: &Subject, reference: &Reference) -> Check {
    let (found, expected) = (scene::sha256(&subject.scene), &reference.scene_sha256);
    let holds = found == *expected;
    let message = if holds {
        "the scene is the recorded one".to_owned()
    } else {
        let short = |s: &str| s.chars().take(12).collect::<String>();
        format!("the scene has changed: found SHA-256 {}.., expected {}..", short(&found), short(expected))
    };
    Check { name: "scene", holds, message }
}

/// It is rendered as it was recorded.
pub(super) fn settings(subject: &Subject, reference: &Reference) -> Check {
    let (found, expected) = (&subject.settings, &reference.settings);
    let holds = found == expected;
    let message = if holds {
        "size, samples, camera and depth are the recorded ones".to_owned()
    } else {
        format!("found {found:?}, expected {expected:?}")
    };
    Check { name: "settings", holds, message }
}

/// Every sample is a radiance, and every pixel has its number of them.
pub(super) fn samples(runs: &[Run], spp: u32) -> Check {
    let refused: u64 = runs.iter().map(|r| r.refused).sum();
    let capped: u64 = runs.iter().map(|r| r.capped).sum();
    let full = |r: &Run| r.image.count.as_ref().is_some_and(|c| c.iter().all(|&n| n == spp));
    let message = match (runs.iter().flat_map(|r| r.bad.iter().map(move |b| (r.seed, b))).next(), refused) {
        (Some((seed, bad)), _) => format!(
            "{refused} samples were refused, the first at pixel {},{} of pass {} with seed {seed}: {:?}",
            bad.pixel[0], bad.pixel[1], bad.pass, bad.reason
        ),
        (None, 1..) => format!("{refused} samples were refused"),
        _ if !runs.iter().all(full) => format!("some pixels have fewer than {spp} samples"),
        _ if capped > 0 => format!("every sample is a radiance; {capped} paths were cut after 10000 events"),
        _ => "every sample is a radiance".to_owned(),
    };
    Check { name: "samples", holds: refused == 0 && runs.iter().all(full), message }
}

/// Threads do not matter.
pub(super) fn threads(subject: &Subject, seed: u64) -> Result<Check, RunError> {
    const PASSES: u32 = 4;
    let films = [1, 3].map(|threads| subject.first_passes(seed, PASSES, threads));
    let [one, three] = films;
    let holds = one? == three?;
    let message =
        if holds { "one thread and three make the same bytes" } else { "one thread and three differ" };
    Ok(Check { name: "threads", holds, message: message.to_owned() })
}

/// The film refuses what is not a radiance, and counts it.
pub(super) fn film() -> Check {
    let mut film = Film::new(FilmLayout::plain([1, 1]));
    let bad = [f32::NAN, f32::INFINITY, -1.0];
    let add = |v: f32| film.add(0, 0, &Sample { radiance: Rgb::new(1.0, v, 1.0), ..Sample::default() });
    let refused = bad.map(add).iter().filter(|r| r.is_err()).count();
    let holds = refused == bad.len() && film.refused_total() == bad.len() as u64;
    let message = if holds {
        "NaN, infinite and negative samples are refused and counted".to_owned()
    } else {
        format!(
            "of a NaN, an infinite and a negative sample {refused} were refused and {} counted, expected 3",
            film.refused_total()
        )
    };
    Check { name: "film", holds, message }
}

/// A picture that is written says the same when it is read: EXR exactly, PNG to half a step of eight bits.
pub(super) fn export(image: &Image) -> Check {
    let check = |holds: bool, message: &str| Check { name: "export", holds, message: message.to_owned() };
    let plain = Image { attributes: Vec::new(), layers: Vec::new(), ..image.clone() };
    let round = |format| {
        output::encode(&plain, format, &WriteOptions::default()).and_then(|bytes| output::decode(&bytes))
    };
    let (Ok(exr), Ok(png)) = (round(Format::Exr), round(Format::Png)) else {
        return check(false, "the picture could not be written and read");
    };
    if exr.rgb != plain.rgb || exr.variance != plain.variance || exr.count != plain.count {
        return check(false, "what is read from the EXR is not what was written");
    }
    // Between two values of eight bits, a linear colour is known to half of their distance.
    let steps: Vec<f32> = (0..=255).map(|i| crate::color::srgb_to_linear(i as f32 / 255.0)).collect();
    let near = |written: f32, read: f32| {
        let i = steps.partition_point(|&s| s < read).min(255);
        let (below, above) = (steps[i.saturating_sub(1)], steps[(i + 1).min(255)]);
        let v = written.clamp(0.0, 1.0);
        (below..=above).contains(&v)
    };
    let same = |(a, b): (&Rgb, &Rgb)| (0..3).all(|c| near(a[c], b[c]));
    if !plain.rgb.iter().zip(&png.rgb).all(same) {
        return check(false, "what is read from the PNG is not the sRGB picture of what was written");
    }
    check(true, "EXR and PNG say the same when they are read")
}

/// Whether the picture is the recorded one bit for bit: news, not a gate.
pub(super) fn bytes(found: &str, expected: &str) -> Check {
    let message = if found == expected {
        "the picture is the recorded one, bit for bit"
    } else {
        "the picture has other bytes than the recorded one; statistics decide"
    };
    Check { name: "bytes", holds: true, message: message.to_owned() }
}

/// SHA-256 of the picture of a run.
pub(super) fn picture_sha256(image: &Image) -> String {
    let mut hash = Sha256::new();
    for c in &image.rgb {
        for v in c.to_array() {
            hash.update(v.to_bits().to_le_bytes());
        }
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

//! Hard cases about the film, what is written of it, and the numbers that samples are made of.

mod numbers;
mod range;
mod slopes;
mod threads;

use super::random::Random;
use super::{Case, Class, Effort, Figure};
use crate::color::Rgb;
use crate::film::{Film, FilmLayout, Refusal, Sample};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N62",
        class: Class::Unit,
        guards: "The mean of many samples, most of them zero and some huge, does not drift.",
        run: means,
    },
    Case {
        id: "N63",
        class: Class::Unit,
        guards: "Variance survives a mean a thousand times as large, and merged films are the whole film.",
        run: variances,
    },
    Case {
        id: "N64",
        class: Class::Statistical,
        guards: "What is not a radiance is refused, counted by cause, and leaves no trace in the mean.",
        run: refusals,
    },
    Case {
        id: "N65",
        class: Class::Unit,
        guards: "Denormal reflectances, radiances and distances give finite pictures.",
        run: range::denormal,
    },
    Case {
        id: "N66",
        class: Class::Unit,
        guards: "The brightest radiance that is allowed stays finite in the film and in files; above it is an error.",
        run: range::bright,
    },
    Case {
        id: "N67",
        class: Class::Statistical,
        guards: "Threads and the split of a render into ranges of passes do not change a single bit.",
        run: threads::same_bits,
    },
    Case {
        id: "N68",
        class: Class::Unit,
        guards: "Uniform numbers stay below one.",
        run: numbers::below_one,
    },
    Case {
        id: "N69",
        class: Class::Unit,
        guards: "Samples fill the unit square as they promise, and are uncorrelated between uses and pixels.",
        run: numbers::uniform,
    },
    Case {
        id: "N70",
        class: Class::Unit,
        guards: "Error falls with samples as fast as it does for scrambled nets, not as for independent numbers.",
        run: slopes::convergence,
    },
];

fn film(width: u32, height: u32) -> Film {
    Film::new(FilmLayout::plain([width, height]))
}

fn sample(v: f32) -> Sample {
    Sample { radiance: Rgb::grey(v), ..Sample::default() }
}

fn means(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N62");
    let trials = effort.trials(1_000_000);
    let mut film = film(1, 1);
    let (mut sum, mut carry, mut refused) = (0.0f64, 0.0f64, 0u64);
    for pass in 0..trials {
        // A tenth of the samples, with a tail so heavy that it has no variance: P(v > x) = x^(-4/3).
        let v = if random.unit() < 0.1 { libm::pow(1.0 - random.unit(), -0.75) as f32 } else { 0.0 };
        refused += u64::from(film.add(0, pass as u32, &sample(v)).is_err());
        // Kahan's sum.
        let y = f64::from(v) - carry;
        let t = sum + y;
        carry = (t - sum) - y;
        sum = t;
    }
    let expected = sum / trials as f64;
    let image = film.to_image();
    let found = image.rgb.first().map_or(f64::NAN, |c| f64::from(c.g));
    let count = image.count.iter().flatten().map(|&n| u64::from(n)).sum::<u64>();
    vec![
        Figure::at_most(
            format!("relative error of the mean of {trials} samples"),
            (found / expected - 1.0).abs(),
            1e-6,
        ),
        Figure::exactly("samples that are missing", trials as f64 - count as f64, 0.0),
        Figure::exactly("samples refused", refused as f64, 0.0),
    ]
}

fn variances(_: Effort) -> Vec<Figure> {
    const SIDE: usize = 360;
    const PASSES: usize = 8;
    let mut random = Random::of("N63");
    // The sum of twelve uniform numbers has a variance of one.
    let mut normal = || (0..12).map(|_| random.unit()).sum::<f64>() - 6.0;
    let values: Vec<f32> = (0..SIDE * SIDE * PASSES).map(|_| (1000.0 + normal()) as f32).collect();
    let side = SIDE as u32;
    let mut refused = 0u64;
    let mut add = |film: &mut Film, i: usize| {
        let (pixel, pass) = (i / PASSES, i % PASSES);
        refused += u64::from(film.add(pixel, pass as u32, &sample(values[i])).is_err());
    };
    let mut whole = film(side, side);
    (0..values.len()).for_each(|i| add(&mut whole, i));
    let (mut merged, mut differs) = (film(side, side), 0u64);
    for part in 0..7 {
        // Every seventh sample, so that parts share pixels and replications.
        let mut film = film(side, side);
        (part..values.len()).step_by(7).for_each(|i| add(&mut film, i));
        differs += u64::from(merged.merge(film).is_err());
    }
    differs += u64::from(merged != whole);

    let image = whole.to_image();
    let estimates = image.variance.unwrap_or_default();
    let mean = estimates.iter().map(|v| f64::from(v.g)).sum::<f64>() / estimates.len() as f64;
    let what = format!("variance of {} samples around 1000, from {} pixels of 8", values.len(), SIDE * SIDE);
    vec![
        // Each pixel's estimate has three degrees of freedom; the mean of all has a standard error of 0.23 %.
        Figure::at_most(format!("{what}: relative error"), (mean * PASSES as f64 - 1.0).abs(), 0.01),
        Figure::exactly("films merged of seven that differ from the whole", differs as f64, 0.0),
        Figure::exactly("samples refused", refused as f64, 0.0),
    ]
}

fn refusals(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N64");
    let trials = effort.trials(1_000_000);
    let (mut clean, mut spoilt) = (film(4, 4), film(4, 4));
    let bad = [f32::NAN, f32::INFINITY, -1.0, 1e38];
    let reasons = [Refusal::NotANumber, Refusal::Overflow, Refusal::Negative, Refusal::Overflow];
    let (mut counted, mut wrong, mut injected) = ([0u64; 3], 0u64, 0usize);
    for i in 0..trials {
        let (pixel, pass) = ((i % 16) as usize, (i / 16) as u32);
        let good = random.unit_f32();
        if i % 10_000 == 9_999 {
            let k = injected % bad.len();
            injected += 1;
            // One channel is enough.
            let sample = Sample { radiance: Rgb::new(good, bad[k], good), ..Sample::default() };
            wrong += u64::from(spoilt.add(pixel, pass, &sample) != Err(reasons[k]));
            counted[reasons[k] as usize] += 1;
        } else {
            wrong += u64::from(spoilt.add(pixel, pass, &sample(good)).is_err());
            wrong += u64::from(clean.add(pixel, pass, &sample(good)).is_err());
        }
    }
    let miscounted = [Refusal::NotANumber, Refusal::Overflow, Refusal::Negative]
        .into_iter()
        .filter(|&r| spoilt.refused(r) != counted[r as usize])
        .count();
    let count: u64 = spoilt.to_image().count.iter().flatten().map(|&n| u64::from(n)).sum();
    let what = format!("{injected} bad of {trials} samples");
    vec![
        Figure::exactly(format!("{what}: wrongly taken or refused, or for another cause"), wrong as f64, 0.0),
        Figure::exactly(format!("{what}: causes that are miscounted"), miscounted as f64, 0.0),
        Figure::exactly(
            format!("{what}: samples in the mean that should not be, or are missing"),
            count as f64 - (trials - injected as u64) as f64,
            0.0,
        ),
        // Means, variances and counts: the refused samples leave no other trace.
        Figure::exactly(
            format!("{what}: images that differ from the clean one"),
            f64::from(u8::from(spoilt.to_image() != clean.to_image())),
            0.0,
        ),
    ]
}

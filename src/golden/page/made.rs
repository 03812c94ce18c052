//! Made-up verifications for tests: a room with a ball of glass, in three fates.

use super::super::{Check, CurvePoint, Power, Reason, Verdict, Verification};
use crate::color::Rgb;
use crate::film::{Image, Layer};
use crate::stats::gate::{FEWEST_RUNS, Family, Null, Planes, Profile};

/// Pixels along each side.
const SIDE: usize = 64;
const LAYERS: [&str; 5] = ["direct", "indirect", "caustic", "glass", "emitted"];
/// Runs that choose weights.
const PILOTS: usize = 8;
/// Deviation of a pixel of one run, relative to its mean.
const NOISE: f64 = 0.08;

/// What is wrong with a render: a factor for each layer, and one for the noise.
#[derive(Clone, Copy)]
struct Fate {
    layers: [f64; 5],
    noise: f64,
}

/// One refused (its caustic is too dark), one improved (less noise), one passed.
pub(super) fn verifications() -> Vec<Verification> {
    let right = Fate { layers: [1.0; 5], noise: 1.0 };
    vec![
        passed(verification("glossy-floor", right, 5)),
        refused(verification("caustic-ball", Fate { layers: [1.0, 1.0, 0.94, 1.0, 1.0], ..right }, 6)),
        improved(verification("many-lights", Fate { noise: 0.8, ..right }, 7)),
    ]
}

fn passed(v: Verification) -> Verification {
    v
}

fn refused(mut v: Verification) -> Verification {
    v.verdict = Verdict::Refused;
    v.reasons = vec![
        Reason {
            gate: "matched, caustic".into(),
            message: "caustic light -6.0 %, z = -12.4".into(),
            better: false,
        },
        Reason {
            gate: "tile 8x8 at 36,44, luminance".into(),
            message: "the picture from 36,44 to 43,51 -4.4 %, z = -6.9".into(),
            better: false,
        },
    ];
    v
}

fn improved(mut v: Verification) -> Verification {
    v.verdict = Verdict::Improved;
    v.reasons = vec![Reason {
        gate: "noise".into(),
        message: "variance of the pixels -36.0 %, z = -22.0".into(),
        better: true,
    }];
    v
}

/// Multiplication of a counter, good enough for made-up noise; about normal, deviation one.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            ((z ^ (z >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb) >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

/// Mean radiance of each layer at a pixel.
fn truth(x: usize, y: usize) -> [Rgb; 5] {
    let (u, v) = ((x as f64 + 0.5) / SIDE as f64, (y as f64 + 0.5) / SIDE as f64);
    let bump = |cx: f64, cy: f64, r: f64| {
        let d = ((u - cx) * (u - cx) + (v - cy) * (v - cy)) / (r * r);
        libm::exp(-d)
    };
    let within = |cx: f64, cy: f64, r: f64| ((u - cx) * (u - cx) + (v - cy) * (v - cy)).sqrt() < r;
    let ball = within(0.38, 0.55, 0.17);
    let lamp = (0.4..0.6).contains(&u) && v < 0.06;
    let floor = v > 0.62;
    let wall = if u < 0.12 {
        Rgb::new(0.6, 0.12, 0.08)
    } else if u > 0.88 {
        Rgb::new(0.1, 0.45, 0.12)
    } else {
        Rgb::grey(0.55)
    };
    let grey = |v: f64| Rgb::grey(v as f32);
    if lamp {
        return [Rgb::BLACK, Rgb::BLACK, Rgb::BLACK, Rgb::BLACK, grey(9.0)];
    }
    if ball {
        let rim = bump(0.38, 0.55, 0.12);
        return [
            Rgb::BLACK,
            Rgb::BLACK,
            Rgb::BLACK,
            grey(0.12 + 0.5 * rim + 2.0 * bump(0.33, 0.46, 0.03)),
            Rgb::BLACK,
        ];
    }
    let shade = if floor { 1.0 - 0.7 * bump(0.42, 0.74, 0.14) } else { 1.0 };
    let direct = wall * grey((0.35 + 0.9 * bump(0.5, 0.45, 0.5)) * shade);
    let indirect = wall * grey(0.25 + 0.1 * v);
    let caustic =
        if floor { Rgb::new(1.0, 0.95, 0.85) * (2.2 * bump(0.62, 0.78, 0.09)) as f32 } else { Rgb::BLACK };
    [direct, indirect, caustic, Rgb::BLACK, Rgb::BLACK]
}

/// A run: the layers of each pixel, each with noise.
fn run(seed: u64, fate: Fate) -> Vec<[Rgb; 5]> {
    let mut noise = Noise(seed << 32);
    let pixel = |i: usize| {
        let mut layers = truth(i % SIDE, i / SIDE);
        for (layer, factor) in layers.iter_mut().zip(fate.layers) {
            *layer *= (factor * (1.0 + fate.noise * NOISE * noise.next()).max(0.0)) as f32;
        }
        layers
    };
    (0..SIDE * SIDE).map(pixel).collect()
}

fn sum(layers: &[Rgb; 5]) -> Rgb {
    layers.iter().fold(Rgb::BLACK, |a, &b| a + b)
}

fn planes(run: &[[Rgb; 5]], noise: f64, seed: u64) -> Planes {
    let plane = |of: &dyn Fn(&[Rgb; 5]) -> f32| run.iter().map(of).collect::<Vec<f32>>();
    let mut planes = vec![("luminance".to_owned(), plane(&|l| sum(l).luminance()))];
    for (k, name) in ["red", "green", "blue"].into_iter().enumerate() {
        planes.push((name.into(), plane(&|l| sum(l)[k])));
    }
    for (k, name) in LAYERS.into_iter().enumerate() {
        planes.push((name.into(), plane(&|l| l[k].luminance())));
    }
    let scalar = 2.0 * libm::log(noise) + 0.02 * Noise(!seed).next();
    Planes { width: SIDE, height: SIDE, planes, scalars: vec![("noise".into(), scalar)] }
}

/// The mean of runs with its variance and layers.
fn image(runs: &[Vec<[Rgb; 5]>]) -> Image {
    let n = runs.len() as f32;
    let mean = |i: usize, k: usize| runs.iter().fold(Rgb::BLACK, |a, r| a + r[i][k]) * (1.0 / n);
    let pixels = SIDE * SIDE;
    let variance = |c: Rgb| c * c * (NOISE * NOISE) as f32 * (1.0 / n);
    let rgb: Vec<Rgb> = (0..pixels).map(|i| (0..5).fold(Rgb::BLACK, |a, k| a + mean(i, k))).collect();
    let layer = |(k, name): (usize, &str)| Layer {
        channels: [".R", ".G", ".B"]
            .into_iter()
            .enumerate()
            .map(|(c, suffix)| (format!("{name}{suffix}"), (0..pixels).map(|i| mean(i, k)[c]).collect()))
            .collect(),
    };
    Image {
        width: SIDE as u32,
        height: SIDE as u32,
        full_size: [SIDE as u32; 2],
        variance: Some(rgb.iter().map(|&c| variance(c)).collect()),
        layers: LAYERS.into_iter().enumerate().map(layer).collect(),
        rgb,
        ..Image::default()
    }
}

fn verification(name: &str, fate: Fate, seed: u64) -> Verification {
    let right = Fate { layers: [1.0; 5], noise: 1.0 };
    let runs: Vec<Vec<[Rgb; 5]>> =
        (0..(PILOTS + FEWEST_RUNS) as u64).map(|k| run(1000 * seed + k, right)).collect();
    let all: Vec<Planes> = runs.iter().enumerate().map(|(k, r)| planes(r, 1.0, k as u64)).collect();
    let (pilots, null_runs) = all.split_at(PILOTS);
    let family = Family::design(&Profile::new(pilots).expect("pilots are alike"));
    let null = Null::new(&family, null_runs).expect("enough runs");
    let tested = run(seed, fate);
    let outcome =
        null.test(&family, &[planes(&tested, fate.noise, seed)], 0.0).expect("a run like the others");
    let (reference, image) = (image(&runs), image(&[tested]));
    let luminance = |v: &Option<Vec<Rgb>>, i: usize| v.as_ref().map_or(1.0, |v| v[i].luminance());
    let z = (0..SIDE * SIDE)
        .map(|i| {
            let d = image.rgb[i].luminance() - reference.rgb[i].luminance();
            d / (luminance(&image.variance, i) + luminance(&reference.variance, i)).sqrt().max(1e-9)
        })
        .collect();
    let point = |k: u32| {
        let spp = 4 << k;
        let expected = 0.9 * libm::pow(f64::from(spp), -0.56);
        let wobble = libm::exp(0.06 * Noise(u64::from(k) + seed).next());
        CurvePoint { spp, error: expected * wobble * fate.noise, expected, spread: 1.12 }
    };
    Verification {
        name: name.into(),
        guards:
            "Light through a ball of clear glass onto a rough floor: refraction, total reflection and what \
                 they focus."
                .into(),
        truth: "Brute force over paths agrees to 0.3 % (65536 spp).".into(),
        spp: 256,
        seeds: vec![13_371_042_882_190 + seed],
        verdict: Verdict::Passed,
        reasons: Vec::new(),
        checks: vec![
            Check { name: "finite", holds: true, message: "all values are finite and not negative".into() },
            Check { name: "samples", holds: true, message: "256 in each pixel".into() },
            Check { name: "threads", holds: true, message: "one thread and two give equal bytes".into() },
        ],
        outcome: Some(outcome),
        significance: 1e-4,
        reference,
        image: Some(image),
        z,
        curve: (0..7).map(point).collect(),
        power: vec![
            Power { statistic: "matched, luminance".into(), shift: 0.0043 },
            Power { statistic: "matched, caustic".into(), shift: 0.018 },
        ],
        replay: format!(
            "epsilux golden verify golden.toml --scene {name} --seed {}",
            13_371_042_882_190 + seed
        ),
        bless: format!("epsilux golden bless golden.toml --scene {name} --reason \"why it changed\""),
        seconds: 3.2 + seed as f64,
    }
}

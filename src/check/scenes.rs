//! Hard cases of whole scenes: an empty one, what is not there, and scenes that nobody thought of.

use std::fmt::Write as _;

use super::build::worst;
use super::random::Random;
use super::{Case, Class, Effort, Figure, scaled};
use crate::color::Rgb;
use crate::film::Image;
use crate::integrate::{Outcome, Quiet, RenderOptions, render};
use crate::prepare::{Algorithms, EffectsMode, Options, Prepared, Shortcuts, prepare};
use crate::report::compare;
use crate::scene::{Scene, complete, text, validate};

pub(super) const CASES: &[Case] = &[
    Case { id: "N32", class: Class::Statistical, guards: "Glass of index one is not there.", run: no_glass },
    Case {
        id: "N73",
        class: Class::Unit,
        guards: "Under a sky of radiance one every pixel is one, at the borders of tiles, pictures and crops too.",
        run: constant,
    },
    Case {
        id: "N75",
        class: Class::Statistical,
        guards: "Random scenes of all shapes, materials and lights, at all scales, are finite and no brighter than physics allows.",
        run: random_scenes,
    },
];

/// A scene from its text, ready to be prepared; `None` where it is not one.
fn parse(toml: &str) -> Option<Scene> {
    let mut scene = text::parse(toml).ok()?.0;
    validate(&mut scene).ok()?;
    complete(&mut scene);
    Some(scene)
}

fn ready(scene: &Scene, size: [u32; 2], seed: u64) -> Option<Prepared> {
    let options = Options {
        camera: None,
        size,
        seed,
        effects: EffectsMode::Auto,
        max_depth: scene.settings.max_depth,
        shortcuts: Shortcuts::of(&scene.settings),
        transparent: false,
        algorithms: Algorithms::PATHS,
    };
    prepare(scene, &options).ok()
}

fn shoot(scene: &Scene, size: [u32; 2], spp: u32, seed: u64) -> Option<Outcome> {
    render(&ready(scene, size, seed)?, &RenderOptions::passes(0..spp), &Quiet).ok()
}

fn picture(scene: &Scene, size: [u32; 2], spp: u32, seed: u64) -> Option<Image> {
    Some(shoot(scene, size, spp, seed)?.film.to_image())
}

/// A figure that could not be measured, and so does not hold.
fn unmeasured(what: &str) -> Vec<Figure> {
    vec![Figure::exactly(what, f64::NAN, 0.0)]
}

fn constant(_: Effort) -> Vec<Figure> {
    const SIZE: [u32; 2] = [37, 23];
    const CROP: [u32; 4] = [15, 7, 18, 16];
    let Some(scene) = parse(
        "epsilux = 1\n[environment]\nradiance = [1, 1, 1]\n[camera]\nfront = { eye = [0, 0, 1], target = [0, 0, 0], fov = 90 }\n",
    ) else {
        return unmeasured("a sky");
    };
    let options = Options {
        camera: None,
        size: SIZE,
        seed: 0,
        effects: EffectsMode::Auto,
        max_depth: None,
        shortcuts: Shortcuts::default(),
        transparent: false,
        algorithms: Algorithms::PATHS,
    };
    let Ok(prepared) = prepare(&scene, &options) else { return unmeasured("a sky") };
    let shoot = |crop: Option<[u32; 4]>| {
        let options = RenderOptions { crop, ..RenderOptions::passes(0..8) };
        render(&prepared, &options, &Quiet).map(|o| o.film.to_image().rgb).unwrap_or_default()
    };
    let deviation = |pixels: &[Rgb], expected: usize| {
        let off = |c: &Rgb| worst(c.to_array().map(|v| (f64::from(v) - 1.0).abs()));
        if pixels.len() == expected { worst(pixels.iter().map(off)) } else { f64::NAN }
    };
    let (whole, crop) = (shoot(None), shoot(Some(CROP)));
    vec![
        Figure::at_most("largest deviation of 37x23 pixels", deviation(&whole, 37 * 23), 1e-6),
        Figure::at_most("largest deviation of a crop of 18x16", deviation(&crop, 18 * 16), 1e-6),
    ]
}

fn no_glass(_: Effort) -> Vec<Figure> {
    const SIZE: [u32; 2] = [32, 32];
    const SPP: u32 = 64;
    let lit = |ball: &str| {
        format!(
            "epsilux = 1
[camera]
front = {{ eye = [0, 1, 5], target = [0, 0.8, 0], fov = 40 }}
[material]
floor = {{ diffuse = [0.7, 0.5, 0.4] }}
clear = {{ glass = {{ ior = 1 }} }}
lamp = {{ light = [6, 6, 6] }}
[[object]]
material = \"floor\"
rect = {{ corner = [-4, 0, 4], edges = [[8, 0, 0], [0, 0, -8]] }}
[[object]]
material = \"lamp\"
rect = {{ corner = [-1, 3, -1], edges = [[2, 0, 0], [0, 0, 2]], facing = [0, 0, 0] }}
{ball}"
        )
    };
    let ball = "[[object]]\nmaterial = \"clear\"\nsphere = { center = [0, 0.8, 0], radius = 0.8 }\n";
    let shoot = |toml: &str, seed: u64| parse(toml).and_then(|s| picture(&s, SIZE, SPP, seed));
    let (Some(with), Some(without)) = (shoot(&lit(ball), 1), shoot(&lit(""), 2)) else {
        return unmeasured("a floor and a lamp");
    };
    let Ok(c) = compare(&with, &without) else { return unmeasured("two pictures") };
    let z = worst(c.channels.iter().map(|c| c.z.unwrap_or(f64::NAN).abs()));
    vec![
        Figure::at_most("largest z of a channel's mean, a ball of index 1 against none", z, 4.5),
        Figure::at_least("p over tiles of 16x16", c.p.unwrap_or(f64::NAN), 1e-5),
    ]
}

/// A scene of random things, and what bounds its radiance: the brightest emission, the largest reflectance and index;
/// `None` for the bound where a light has no extent, and so no radiance.
struct Made {
    toml: String,
    bound: Option<f64>,
}

fn make(random: &mut Random) -> Made {
    let mut toml = String::from(
        "epsilux = 1\n[camera]\nfront = { eye = [0.3, 1.1, 6], target = [0, 0.7, 0], fov = 45 }\n",
    );
    let (mut emission, mut reflectance, mut index, mut bounded) = (0.0f64, 0.0f64, 1.0f64, true);
    let (mut materials, mut objects) = (String::new(), String::new());
    let colour = |random: &mut Random, most: f64| {
        let c = [0, 1, 2].map(|_| random.between(0.0, most));
        (format!("[{}, {}, {}]", c[0], c[1], c[2]), worst(c))
    };
    let count = 3 + (random.bits() % 6) as usize;
    for i in 0..count {
        let (name, material) = (format!("m{i}"), random.bits() % 6);
        let text = match material {
            0 => {
                let (c, most) = colour(random, 0.9);
                reflectance = reflectance.max(most);
                format!("{{ diffuse = {c} }}")
            }
            1 => {
                let (c, most) = colour(random, 0.9);
                reflectance = reflectance.max(most);
                format!("{{ mirror = {c} }}")
            }
            2 => {
                let ior = random.between(1.05, 2.4);
                index = index.max(ior);
                // Glass takes nothing away; a tint bounds how often light goes round.
                reflectance = reflectance.max(0.9);
                format!(
                    "{{ glass = {{ ior = {ior}, tint = [0.9, 0.9, 0.9], absorption = {{ color = [0.5, 0.7, 0.9], distance = 0.5 }} }} }}"
                )
            }
            3 => {
                let (c, most) = colour(random, 8.0);
                emission = emission.max(most);
                format!("{{ light = {c} }}")
            }
            _ => {
                let (c, _) = colour(random, 0.8);
                // A dielectric reflects beside its base colour; all together stay below one.
                reflectance = reflectance.max(0.97);
                index = index.max(1.5);
                let (metallic, rough) = (random.unit().round(), random.between(0.0, 1.0));
                let transmission = if random.bits().is_multiple_of(4) { 1.0 } else { 0.0 };
                format!(
                    "{{ principled = {{ base_color = {c}, metallic = {metallic}, roughness = {rough}, transmission = {transmission} }} }}"
                )
            }
        };
        let at = [random.between(-1.5, 1.5), random.between(0.0, 1.8), random.between(-1.5, 1.5)];
        let size = random.between(0.1, 0.8);
        let shape = match random.bits() % 3 {
            0 => format!("sphere = {{ center = [{}, {}, {}], radius = {size} }}", at[0], at[1], at[2]),
            1 => format!(
                "box = {{ center = [{}, {}, {}], size = [{size}, {size}, {}] }}",
                at[0],
                at[1],
                at[2],
                2.0 * size
            ),
            _ => format!(
                "mesh = {{ positions = [[{0}, {1}, {2}], [{3}, {1}, {2}], [{0}, {4}, {2}]], triangles = [[0, 1, 2]] }}",
                at[0],
                at[1],
                at[2],
                at[0] + size,
                at[1] + size
            ),
        };
        let _ = writeln!(materials, "{name} = {text}");
        let _ = writeln!(objects, "[[object]]\nmaterial = \"{name}\"\n{shape}");
    }
    let _ = writeln!(
        toml,
        "[material]\nfloor = {{ diffuse = [0.6, 0.6, 0.6] }}\n{materials}{objects}[[object]]\nmaterial = \"floor\"\nrect = {{ corner = [-3, 0, 3], edges = [[6, 0, 0], [0, 0, -6]] }}"
    );
    reflectance = reflectance.max(0.6);
    match random.bits() % 5 {
        0 => {
            let _ = writeln!(toml, "[[light]]\npoint = {{ intensity = [5, 5, 4] }}\nposition = [1, 3, 1]");
            bounded = false;
        }
        1 => {
            let _ = writeln!(
                toml,
                "[[light]]\nsun = {{ irradiance = [2, 2, 2], angle = 0.5 }}\ndirection = [-1, -2, -1]"
            );
            bounded = false;
        }
        2 => {
            let _ = writeln!(
                toml,
                "[[light]]\narea = {{ shape = \"rectangle\", size = [1, 1], radiance = [4, 4, 4] }}\nposition = [0, 3, 0]\ndirection = [0, -1, 0]\nup = [0, 0, 1]"
            );
            emission = emission.max(4.0);
        }
        3 => {
            let _ = writeln!(
                toml,
                "[[light]]\npoint = {{ intensity = [5, 5, 5], radius = 0.3 }}\nposition = [0, 3, 1]"
            );
            emission = emission.max(5.0 / (std::f64::consts::PI * 0.09));
        }
        _ => {
            let _ = writeln!(toml, "[environment]\nradiance = [0.7, 0.9, 1.2]");
            emission = emission.max(1.2);
        }
    }
    // Where nothing else shines, there is a default dome of radiance one.
    emission = emission.max(1.0);
    let bound = index * index * emission / (1.0 - reflectance);
    Made { toml, bound: bounded.then_some(bound) }
}

fn random_scenes(effort: Effort) -> Vec<Figure> {
    const SIZE: [u32; 2] = [10, 8];
    const SPP: u32 = 4;
    let mut random = Random::of("N75");
    let scenes = effort.trials(60);
    let (mut unread, mut refused, mut broken, mut too_bright, mut bounds) = (0u32, 0u64, 0u32, 0u32, 0u32);
    for i in 0..scenes {
        let made = make(&mut random);
        let k = (random.bits() % 41) as i32 - 20;
        let Some(scene) = parse(&made.toml) else {
            unread += 1;
            continue;
        };
        let Some(outcome) = shoot(&scaled(&scene, k), SIZE, SPP, i) else {
            unread += 1;
            continue;
        };
        refused += outcome.film.refused_total();
        let image = outcome.film.to_image();
        broken += u32::from(!image.rgb.iter().all(|c| c.is_finite()));
        if let Some(bound) = made.bound {
            bounds += 1;
            let variance = image.variance.unwrap_or_default();
            let above = |(c, v): (&Rgb, &Rgb)| {
                let most = f64::from(c.max_channel());
                let error = f64::from(v.max_channel()).sqrt();
                most > bound + 4.5 * if error.is_finite() { error } else { 0.0 }
            };
            too_bright += u32::from(image.rgb.iter().zip(&variance).any(above));
        }
    }
    vec![
        Figure::exactly(format!("of {scenes} random scenes not rendered"), f64::from(unread), 0.0),
        Figure::exactly(format!("refused samples of {} pixels", scenes * 80), refused as f64, 0.0),
        Figure::exactly("pictures that are not finite", f64::from(broken), 0.0),
        Figure::exactly(
            format!("pictures of {bounds} brighter than n^2 Le / (1 - rho) + 4.5 sigma"),
            f64::from(too_bright),
            0.0,
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::replay;
    use crate::rare::{Counted, counted};

    /// What drops light without a word is as rare as it says (`rarely!`), on random scenes: an accident that takes a
    /// share of 1e-5 darkens nothing that could be seen, one of a hundredth would. Samples are traced in this thread,
    /// whose counts nobody else touches.
    #[test]
    fn accidents_are_rare() {
        const SIZE: [u32; 2] = [10, 8];
        let mut random = Random::of("rare accidents");
        for seed in 0..120 {
            let made = make(&mut random);
            let scene = parse(&made.toml).and_then(|scene| ready(&scene, SIZE, seed)).expect("a scene");
            for i in 0..SIZE[0] * SIZE[1] * 16 {
                let pixel = [i % SIZE[0], i / SIZE[0] % SIZE[1]];
                assert!(replay(&scene, pixel, i / (SIZE[0] * SIZE[1])).radiance.is_finite());
            }
        }
        let counted = counted();
        let said: Vec<String> = counted.iter().map(Counted::says).collect();
        assert!(counted.len() >= 5 && counted.iter().all(Counted::is_rare), "{}", said.join("\n"));
        // Each had the chance to be ten thousand times as frequent as claimed.
        assert!(counted.iter().all(|c| c.tried > 1000), "{}", said.join("\n"));
    }
}

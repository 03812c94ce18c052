//! The same picture, bit for bit: whatever must not matter to it does not.
//!
//! Nothing here is statistical. Pictures are small, and compared as EXR files by their SHA-256.

use epsilux::color::Rgb;
use epsilux::film::Image;
use epsilux::glam::{DAffine3, DVec3};
use epsilux::integrate::{Quiet, RenderError, RenderOptions, Sparse, render, replay};
use epsilux::output::{WriteOptions, write};
use epsilux::prepare::{
    Algorithms, Caustics, CausticsMode, EffectsMode, Indirect, Options, Plan, Prepared, prepare,
};
use epsilux::scene::text::parse_toml;
use epsilux::scene::{Absorption, LightKind, MaterialKind, Scene, SpotFalloff};
use sha2::{Digest as _, Sha256};

use crate::support::fast::{options, valid};
use crate::support::features::{self, dark_stage, round_mesh};
use crate::support::scenes::{Build, diffuse, emitter, facing, principled};
use crate::support::seed::seed;
use crate::support::textured;
use epsilux::check::scaled;

pub(crate) const SIZE: [u32; 2] = [20, 14];

/// The scenes of the project that every test here looks at.
const FILES: [(&str, &str); 6] = [
    ("hexroom", include_str!("../../scenes/hexroom.toml")),
    ("hexroom-diffuse", include_str!("../../scenes/hexroom-diffuse.toml")),
    ("cornell", include_str!("../../scenes/cornell.toml")),
    ("caustic", include_str!("../../scenes/caustic.toml")),
    ("materials", include_str!("../../scenes/materials.toml")),
    ("drink", include_str!("../../scenes/drink.toml")),
];

pub(crate) fn files() -> impl Iterator<Item = (String, Scene)> {
    FILES.iter().map(|(name, text)| (name.to_string(), parse_toml(text).expect("a scene of the project").0))
}

fn file(name: &str) -> Scene {
    files().find(|(n, _)| n == name).expect("a scene of the project").1
}

pub(crate) fn prepared(scene: &Scene, effects: EffectsMode) -> Prepared {
    let options = Options { effects, ..options(SIZE, seed("bytes"), None) };
    prepare(scene, &options).expect("a camera")
}

pub(crate) fn passes() -> RenderOptions {
    RenderOptions { threads: 1, features: true, ..RenderOptions::passes(0..8) }
}

/// The picture; no sample may be refused.
fn picture(scene: &Prepared, options: &RenderOptions) -> Image {
    let outcome = render(scene, options, &Quiet).expect("passes");
    assert_eq!(outcome.film.refused_total(), 0, "{:?}", outcome.bad);
    outcome.film.to_image()
}

/// SHA-256 of the EXR file that `output` writes.
fn sha(image: &Image) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("picture.exr");
    write(image, &path, &WriteOptions::default()).expect("a picture that can be written");
    let digest = Sha256::digest(std::fs::read(&path).expect("the file that was written"));
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

pub(crate) fn check_equal(a: &Image, b: &Image, what: &str) {
    let differ = a.rgb.iter().zip(&b.rgb).filter(|(a, b)| a != b).count();
    assert!(differ == 0, "{what}: {differ} of {} pixels differ", a.rgb.len());
    assert_eq!(sha(a), sha(b), "{what}: the files differ");
}

/// Guards the film and the scheduler: how many threads share the work changes no byte.
#[test]
fn threads_change_nothing() {
    for (name, scene) in files() {
        let scene = prepared(&scene, EffectsMode::Auto);
        let one = picture(&scene, &passes());
        for threads in [2, 5] {
            check_equal(&one, &picture(&scene, &RenderOptions { threads, ..passes() }), &name);
        }
    }
}

/// Guards addresses: a crop is that part of the whole picture, down to its variance.
#[test]
fn a_crop_is_a_part_of_the_whole() {
    for (name, scene) in files() {
        let scene = prepared(&scene, EffectsMode::Auto);
        let whole = picture(&scene, &passes());
        let [x, y, w, h] = [3u32, 5, 12, 7];
        let part = picture(&scene, &RenderOptions { crop: Some([x, y, w, h]), ..passes() });
        assert_eq!((part.width, part.height, part.origin, part.full_size), (w, h, [x, y], SIZE));
        let rows = (0..h).map(|row| ((y + row) * SIZE[0] + x) as usize);
        for (i, start) in rows.enumerate() {
            let (here, there) = (i * w as usize..(i + 1) * w as usize, start..start + w as usize);
            assert_eq!(part.rgb[here.clone()], whole.rgb[there.clone()], "{name}: row {i}");
            let variance = |image: &Image| image.variance.clone().expect("a variance");
            assert_eq!(variance(&part)[here], variance(&whole)[there], "{name}: row {i}");
        }
    }
}

/// Guards passes as the unit of work: the mean of passes 0..4 and 4..8 is that of 0..8.
#[test]
fn passes_add_up() {
    let scene = prepared(&file("hexroom"), EffectsMode::Auto);
    let run = |passes| picture(&scene, &RenderOptions { passes, ..self::passes() });
    let (first, second, all) = (run(0..4), run(4..8), run(0..8));
    for ((a, b), c) in first.rgb.iter().zip(&second.rgb).zip(&all.rgb) {
        for i in 0..3 {
            let mean = 0.5 * (f64::from(a[i]) + f64::from(b[i]));
            assert!((mean - f64::from(c[i])).abs() <= 1e-6 * mean, "{mean} {}", c[i]);
        }
    }
    assert_ne!(first.rgb, second.rgb);
}

/// A scene with each kind of light that has an extent, and with every material, lens and instances.
fn area_lights() -> Scene {
    let mut scene = features::everything();
    scene.environment = None;
    scene.lights.retain(|l| !matches!(l.kind, LightKind::Sun { .. } | LightKind::Point { .. }));
    scene.lights.retain(|l| !matches!(l.kind, LightKind::Spot { .. }));
    let color = Rgb::new(3.0, 4.0, 6.0);
    let above = DVec3::new(1.5, 4.0, 2.5);
    let aim = facing(above, above.normalize());
    scene.light(LightKind::Point { intensity: color, radius: 0.3 }, aim);
    scene.light(
        LightKind::Spot { intensity: color, inner: 0.2, outer: 0.7, falloff: SpotFalloff::Gltf, radius: 0.2 },
        aim,
    );
    let (mesh, lamp) = (round_mesh(1, false), emitter(3.0));
    scene.meshes.push(mesh);
    let id = epsilux::scene::MeshId(scene.meshes.len() as u32 - 1);
    let place =
        DAffine3::from_translation(DVec3::new(-2.0, 3.0, 1.0)) * DAffine3::from_scale(DVec3::splat(0.4));
    scene.object(epsilux::scene::Shape::Mesh(id), place, lamp);
    valid(&scene)
}

/// The materials of the project's scene under its lamps, without its sky.
fn materials_indoors() -> Scene {
    Scene { environment: None, ..file("materials") }
}

/// The caustic, with an absorbing ball.
fn tinted_caustic() -> Scene {
    let mut scene = file("caustic");
    for material in &mut scene.materials {
        if let MaterialKind::Glass(g) = &mut material.kind {
            g.absorption = Some(Absorption { color: Rgb::new(0.9, 0.8, 0.5), distance: 0.7 });
        }
    }
    scene
}

fn scenes_to_scale() -> Vec<(&'static str, Scene)> {
    vec![
        ("hexroom", file("hexroom")),
        ("caustic", tinted_caustic()),
        ("materials", materials_indoors()),
        ("drink", Scene { environment: None, ..file("drink") }),
        ("area lights", area_lights()),
    ]
}

/// Guards that layers accumulate beside the picture and never change it, and that they add up to it.
#[test]
fn layers_change_nothing_and_add_up() {
    let mut seen = std::collections::BTreeSet::new();
    for (name, scene) in [("hexroom", file("hexroom")), ("everything", valid(&features::everything()))] {
        let prepared = prepared(&scene, EffectsMode::Auto);
        let bare = picture(&prepared, &RenderOptions { features: false, ..passes() });
        let mut layered = picture(&prepared, &RenderOptions { features: false, layers: true, ..passes() });
        let layers = std::mem::take(&mut layered.layers);
        check_equal(&bare, &layered, &format!("{name} with layers"));
        for (c, channel) in ["R", "G", "B"].into_iter().enumerate() {
            let parts: Vec<&Vec<f32>> = layers
                .iter()
                .flat_map(|l| &l.channels)
                .filter(|(n, _)| n.rsplit_once('.').is_some_and(|(_, end)| end == channel))
                .map(|(_, values)| values)
                .collect();
            assert_eq!(parts.len(), 5, "{name}");
            for (pixel, rgb) in bare.rgb.iter().enumerate() {
                let sum: f32 = parts.iter().map(|p| p[pixel]).sum();
                assert!((sum - rgb[c]).abs() <= 1e-5 * rgb[c], "{name} {pixel} {channel}: {sum} {}", rgb[c]);
            }
        }
        let lit = |name: &str| {
            let mut all = layers.iter().flat_map(|l| &l.channels);
            all.any(|(n, values)| n.starts_with(name) && values.iter().any(|&v| v > 0.0))
        };
        seen.extend(
            ["direct", "indirect", "caustic", "glass", "emitted", "brightest"].into_iter().filter(|p| lit(p)),
        );
    }
    assert_eq!(seen.len(), 6, "some scene has each part: {seen:?}");
}

/// Guards the shares of the layers: each ray looks for one of them, light adds up as in the layers of the picture, and
/// what was not asked for is not counted.
#[test]
fn rays_and_light_belong_to_layers() {
    let scene = file("hexroom");
    let by_photons = with_photons(&scene, EffectsMode::Auto, false);
    for (name, prepared) in [("paths", prepared(&scene, EffectsMode::Auto)), ("photons", by_photons)] {
        let options =
            RenderOptions { features: false, layers: true, layer_noise: true, threads: 2, ..passes() };
        let outcome = render(&prepared, &options, &Quiet).expect("passes");
        let counters = outcome.counters;
        assert_eq!(counters.layer_rays.iter().sum::<u64>(), counters.rays, "{name}");
        assert!(counters.layer_rays.iter().all(|&n| n > 0), "{name}: {counters:?}");
        let shares = outcome.film.layer_shares().expect("recorded");
        let image = outcome.film.to_image();
        let sum = |name: &str| {
            let channels = image.layers.iter().flat_map(|l| &l.channels).filter(|(n, _)| n.starts_with(name));
            let weights = [0.2126, 0.7152, 0.0722];
            let of =
                |((_, v), w): (&(String, Vec<f32>), f64)| w * v.iter().map(|&v| f64::from(v)).sum::<f64>();
            channels.zip(weights).map(of).sum::<f64>()
        };
        let total: f64 = shares.iter().map(|s| sum(s.layer.name())).sum();
        for share in shares {
            let expected = sum(share.layer.name()) / total;
            assert!((share.light - expected).abs() < 1e-5, "{name}: {share:?} {expected}");
        }
        assert!((shares.iter().map(|s| s.noise).sum::<f64>() - 1.0).abs() < 1e-9, "{name}: {shares:?}");
        let plain =
            render(&prepared, &RenderOptions { features: false, ..passes() }, &Quiet).expect("passes");
        assert_eq!(plain.counters.layer_rays, [0; 5], "{name}");
        assert_eq!(plain.counters.rays, counters.rays, "{name}");
    }
}

/// A scene whose caustics are found by photons.
fn with_photons(scene: &Scene, effects: EffectsMode, unbiased: bool) -> Prepared {
    by_photons(scene, effects, Algorithms { caustics: CausticsMode::Photon, unbiased, ..Algorithms::PATHS })
}

fn by_photons(scene: &Scene, effects: EffectsMode, algorithms: Algorithms) -> Prepared {
    prepare(scene, &Options { effects, algorithms, ..options(SIZE, seed("photons"), None) })
        .expect("a camera")
}

/// Scenes with something that throws light, whose plan has a photon map.
fn scenes_with_photons() -> Vec<(String, Scene)> {
    let mut list: Vec<_> =
        files().filter(|(name, _)| ["hexroom", "caustic", "materials"].contains(&name.as_str())).collect();
    list.push(("everything".into(), valid(&features::everything())));
    list
}

/// Guards photons that look for caustics as a pure function of scene, seed and pass.
#[test]
fn photons_depend_on_nothing_but_the_pass() {
    let photon = Algorithms { caustics: CausticsMode::Photon, ..Algorithms::PATHS };
    check_passes(&scenes_with_photons(), photon, [Caustics::Photon; 2]);
    let unbiased = Algorithms { unbiased: true, ..photon };
    check_passes(&scenes_with_photons(), unbiased, [Caustics::Traced; 2]);
}

/// Guards the same of those that look for indirect light, alone and beside those.
#[test]
fn indirect_light_depends_on_nothing_but_the_pass() {
    let photon = Algorithms { indirect: Indirect::Photon, ..Algorithms::PATHS };
    let mut scenes = scenes_with_photons();
    scenes.push(("cornell".into(), file("cornell")));
    scenes.push(("everything textured".into(), valid(&textured::everything_textured())));
    check_passes(&scenes, photon, [Caustics::Path; 2]);
    let both = Algorithms { caustics: CausticsMode::Photon, ..photon };
    check_passes(&scenes, both, [Caustics::Photon, Caustics::Path]);
}

/// Checks that threads, crops, kernels, the way in which passes are shared, and recording layers change no byte; and that
/// one sample can be traced alone. `caustics` is how they are found where something throws light, and where nothing does.
fn check_passes(scenes: &[(String, Scene)], algorithms: Algorithms, caustics: [Caustics; 2]) {
    for (name, scene) in scenes {
        let prepared = by_photons(scene, EffectsMode::Auto, algorithms);
        let throws = !["cornell", "everything textured"].contains(&name.as_str());
        assert_eq!(prepared.plan.caustics, caustics[usize::from(!throws)], "{name}");
        assert_eq!(prepared.plan.indirect, algorithms.indirect, "{name}");
        let film = |options: &RenderOptions| {
            let outcome = render(&prepared, options, &Quiet).expect("passes");
            assert_eq!(outcome.film.refused_total(), 0, "{name}: {:?}", outcome.bad);
            outcome.film
        };
        let plain = || RenderOptions { features: false, ..passes() };
        let one = film(&plain());
        let image = one.to_image();
        for threads in [2, 5] {
            assert!(film(&RenderOptions { threads, ..plain() }) == one, "{name}: {threads} threads");
        }
        // Parts of the passes, in any order.
        let mut parts = film(&RenderOptions { passes: 5..8, threads: 3, ..plain() });
        parts.merge(film(&RenderOptions { passes: 0..5, ..plain() })).expect("one layout");
        assert!(parts == one, "{name}: passes");
        // A crop.
        let [x, y, w, h] = [3u32, 5, 12, 7];
        let part = film(&RenderOptions { crop: Some([x, y, w, h]), threads: 2, ..plain() }).to_image();
        for row in 0..h {
            let (here, there) = ((row * w) as usize, ((y + row) * SIZE[0] + x) as usize);
            assert_eq!(
                part.rgb[here..here + w as usize],
                image.rgb[there..there + w as usize],
                "{name}: row {row}"
            );
        }
        // The kernel that simulates everything, and layers.
        let all = by_photons(scene, EffectsMode::All, algorithms);
        check_equal(&image, &picture(&all, &plain()), name);
        let mut layered = picture(&prepared, &RenderOptions { layers: true, ..plain() });
        layered.layers.clear();
        check_equal(&image, &layered, &format!("{name} with layers"));
        // Samples alone.
        for pixel in [[9, 9], [4, 12]] {
            let sum =
                (0..8).map(|pass| replay(&prepared, pixel, pass).radiance).fold(Rgb::BLACK, |a, b| a + b);
            let found = image.rgb[(pixel[1] * SIZE[0] + pixel[0]) as usize];
            let off = (sum / 8.0 - found).map(f32::abs).max_channel();
            assert!(off <= 1e-5 * found.max_channel(), "{name}: {sum:?} {found:?}");
        }
    }
}

/// Guards photons against absolute lengths.
#[test]
fn photons_scale() {
    for (name, scene) in scenes_to_scale() {
        for shell in [false, true] {
            let radiance = |k| {
                let mut scene = scaled(&scene, k);
                if shell {
                    scene.sphere(DVec3::ZERO, 1e9, diffuse(0.0));
                }
                picture(
                    &with_photons(&scene, EffectsMode::Auto, false),
                    &RenderOptions { features: false, passes: 0..2, ..passes() },
                )
            };
            let unit = radiance(0);
            for k in [-20, 1] {
                check_equal(&unit, &radiance(k), &format!("{name} at 2^{k}, {shell}"));
            }
        }
    }
}

const SCALES: [i32; 4] = [-20, -1, 1, 20];

/// The picture alone, without features, which have lengths.
fn plain(scene: &Scene) -> Image {
    picture(&prepared(scene, EffectsMode::Auto), &RenderOptions { features: false, ..passes() })
}

fn check_scales(name: &str, scene: &Scene, change: impl Fn(Scene) -> Scene) {
    let radiance = |scene: &Scene| {
        let image = plain(scene);
        assert!(image.rgb.iter().any(|c| !c.is_black()), "{name} is black");
        image
    };
    let unit = radiance(&change(scene.clone()));
    for k in SCALES {
        check_equal(&unit, &radiance(&change(scaled(scene, k))), &format!("{name} at 2^{k}"));
    }
}

/// Guards against absolute lengths anywhere: a scene of a micrometre and one of a thousand kilometres make
/// the same picture.
#[test]
fn lengths_times_powers_of_two_change_nothing() {
    for (name, scene) in scenes_to_scale() {
        check_scales(name, &scene, |scene| scene);
    }
}

/// Guards against scale-freedom by normalising: the content grows and shrinks in a black shell that does
/// not, so that the extent of the whole scene stays what it is.
#[test]
fn lengths_in_a_shell_that_stays_change_nothing() {
    for (name, scene) in scenes_to_scale() {
        check_scales(name, &scene, |mut scene| {
            scene.sphere(DVec3::ZERO, 1e9, diffuse(0.0));
            scene
        });
    }
}

/// Guards the same for lights without an extent, whose intensity grows with the square of lengths.
#[test]
fn points_and_spots_scale_too() {
    let mut scene = dark_stage();
    scene.sphere(DVec3::Y, 1.0, principled(|p| p.roughness = 0.4));
    let above = DVec3::new(2.0, 4.0, 1.0);
    let aim = facing(above, above.normalize());
    let color = Rgb::new(30.0, 20.0, 10.0);
    scene.light(LightKind::Point { intensity: color, radius: 0.0 }, aim);
    scene.light(
        LightKind::Spot {
            intensity: color,
            inner: 0.2,
            outer: 0.7,
            falloff: SpotFalloff::Blender,
            radius: 0.0,
        },
        aim,
    );
    check_scales("points", &valid(&scene), |scene| scene);
    check_scales("points in a shell", &valid(&scene), |mut scene| {
        scene.sphere(DVec3::ZERO, 1e9, diffuse(0.0));
        scene
    });
}

/// Guards the instruction sets: the portable walk of the trees gives the same file as the one for this CPU.
#[test]
fn the_portable_kernel_agrees() {
    let scenes = files().chain([("everything".to_owned(), valid(&features::everything()))]);
    for (name, scene) in scenes {
        let scene = prepared(&scene, EffectsMode::Auto);
        let mut portable = scene.clone();
        portable.accel = portable.accel.portable();
        check_equal(&picture(&scene, &passes()), &picture(&portable, &passes()), &name);
    }
}

/// Guards repeatability: another seed makes another picture, the same one the same.
#[test]
fn the_seed_decides() {
    let scene = file("hexroom");
    let with = |seed| {
        let options = Options { seed, ..options(SIZE, 0, None) };
        picture(&prepare(&scene, &options).expect("a camera"), &passes())
    };
    check_equal(&with(1), &with(1), "the same seed");
    assert_ne!(with(1).rgb, with(2).rgb);
}

/// Guards glTF both ways: a scene that was written as GLB and read again is the same picture.
#[test]
fn a_scene_through_glb_changes_nothing() {
    use epsilux::{export, import};
    for name in ["hexroom", "materials"] {
        let scene = file(name);
        let folder = tempfile::tempdir().expect("a folder");
        let encoded = export::encode(&scene, export::Format::Glb, "scene.glb").expect("a small scene");
        export::write(&encoded.files, folder.path()).expect("a folder that can be written");
        let path = folder.path().join("scene.glb");
        let (read, _) = import::read(&path, &import::ReadOptions::default()).expect("our own file");
        let [a, b] = [&scene, &read].map(|scene| {
            let options = options([24, 24], seed("glb"), None);
            let passes = RenderOptions { passes: 0..4, ..passes() };
            picture(&prepare(scene, &options).expect("a camera"), &passes)
        });
        check_equal(&a, &b, name);
    }
}

fn textured_scenes() -> Vec<(String, Scene)> {
    let lists =
        [textured::textures(), textured::normal_maps(), textured::cutouts(), textured::vertex_colors()];
    let mut scenes: Vec<(String, Scene)> = lists.into_iter().flat_map(|l| l.into_iter().step_by(5)).collect();
    scenes.extend(textured::emissive());
    scenes.push(("everything textured".into(), textured::everything_textured()));
    scenes.into_iter().map(|(name, scene)| (name, valid(&scene))).collect()
}

/// Guards textures against all that must not matter: threads, instructions and, where the tables are at hand,
/// scale.
#[test]
fn textured_scenes_have_the_same_bytes_too() {
    for (name, scene) in textured_scenes() {
        let scene = prepared(&scene, EffectsMode::Auto);
        let expected = picture(&scene, &passes());
        check_equal(&expected, &picture(&scene, &RenderOptions { threads: 3, ..passes() }), &name);
        let mut portable = scene.clone();
        portable.accel = portable.accel.portable();
        check_equal(&expected, &picture(&portable, &passes()), &name);
    }
    check_scales("everything textured", &valid(&textured::everything_textured()), |scene| scene);
}

/// Guards that constant textures are numbers: the picture is that of the material without them, and
/// nothing is simulated for them.
#[test]
fn constant_textures_are_numbers() {
    let (mut bare, mut laid) = (features::stage(), features::stage());
    let numbers = |p: &mut epsilux::scene::Principled, factor: f32| {
        p.base_color = Rgb::new(0.5, 0.25, 1.0) * factor;
        (p.roughness, p.metallic) = (0.5 * factor, factor);
        p.emission = Rgb::grey(0.25 * factor);
    };
    bare.sphere(DVec3::Y, 1.0, principled(|p| numbers(p, 0.5)));
    let half = epsilux::scene::Texels::Float(vec![[0.5; 3]; 6]);
    let image = textured::add_image(&mut laid, 3, 2, half);
    let one = textured::add_image(&mut laid, 1, 1, epsilux::scene::Texels::Byte(vec![[255; 4]]));
    let texture = epsilux::scene::Texture::new(image);
    let scalar = Some(epsilux::scene::ScalarTexture { texture, channel: epsilux::scene::Channel::G });
    let kind = principled(|p| {
        numbers(p, 1.0);
        p.alpha_mode = epsilux::scene::AlphaMode::Blend;
        let t = &mut p.textures;
        (t.base_color, t.emission) = (Some(texture), Some(texture));
        (t.metallic, t.roughness) = (scalar, scalar);
        let texture = epsilux::scene::Texture::new(one);
        t.alpha = Some(epsilux::scene::ScalarTexture { texture, channel: epsilux::scene::Channel::A });
        t.specular_color = Some(texture);
    });
    laid.sphere(DVec3::Y, 1.0, kind);
    let (bare, laid) = (valid(&bare), valid(&laid));
    let (a, b) = (prepared(&bare, EffectsMode::Auto), prepared(&laid, EffectsMode::Auto));
    let simulated = |plan: &Plan| (plan.needs.clone(), plan.tables, plan.kernel, plan.choices.clone());
    assert_eq!(simulated(&a.plan), simulated(&b.plan));
    check_equal(&picture(&a, &passes()), &picture(&b, &passes()), "constant textures");
}

/// Guards that choices take more rays where they apply and nowhere else, and that pictures by them are functions of
/// the scene too: threads, kernels and powers of two change no byte, and a sample can be traced alone.
#[test]
fn choices_are_functions_of_the_scene() {
    let by = |scene: &Scene, effects, algorithms| {
        prepare(scene, &Options { effects, algorithms, ..options(SIZE, seed("choices"), Some(6)) })
            .expect("a camera")
    };
    let film = |prepared: &Prepared, threads| {
        let options = RenderOptions { threads, features: false, ..passes() };
        let outcome = render(prepared, &options, &Quiet).expect("passes");
        assert_eq!(outcome.film.refused_total(), 0, "{:?}", outcome.bad);
        (outcome.film, outcome.counters.rays)
    };
    let split = Algorithms { split: Some(4), ..Algorithms::PATHS };
    let lights = Algorithms { light_samples: Some(4), ..Algorithms::PATHS };
    for (name, splits) in [("hexroom", true), ("hexroom-diffuse", false)] {
        let rays = |algorithms| film(&by(&file(name), EffectsMode::Auto, algorithms), 1).1;
        let base = rays(Algorithms::PATHS);
        assert_eq!(rays(split) > base, splits, "{name}");
        assert!(rays(lights) > base, "{name}");
    }
    let all = Algorithms { light_samples: Some(3), roulette: Some(2), ..split };
    let mut scenes: Vec<_> = files().collect();
    scenes.push(("everything".into(), valid(&features::everything())));
    scenes.push(("everything textured".into(), valid(&textured::everything_textured())));
    for (name, scene) in scenes {
        let planned = by(&scene, EffectsMode::Auto, all);
        let (one, rays) = film(&planned, 1);
        assert!(film(&planned, 3) == (one.clone(), rays), "{name}: threads");
        for effects in [EffectsMode::All, EffectsMode::Exact] {
            assert!(film(&by(&scene, effects, all), 2) == (one.clone(), rays), "{name}: {effects:?}");
        }
        let pixel = [SIZE[0] / 2, SIZE[1] / 2];
        let sum = (0..8).map(|pass| f64::from(replay(&planned, pixel, pass).radiance.g)).sum::<f64>();
        let mean = f64::from(one.to_image().rgb[(pixel[1] * SIZE[0] + pixel[0]) as usize].g);
        assert!((sum / 8.0 - mean).abs() <= 1e-6 * mean, "{name}: alone");
    }
    let twice = by(&scaled(&file("hexroom"), 3), EffectsMode::Auto, all);
    let once = by(&file("hexroom"), EffectsMode::Auto, all);
    assert!(film(&twice, 1).0.to_image().rgb == film(&once, 1).0.to_image().rgb, "scaled");
}

/// Guards renders of some pixels: where they have all photons, each is as in the whole picture.
#[test]
fn some_pixels_are_those_of_all() {
    for name in ["cornell", "caustic"] {
        let algorithms = Algorithms { caustics: CausticsMode::Photon, ..Algorithms::PATHS };
        let options = Options { algorithms, ..options(SIZE, seed("some pixels"), None) };
        let scene = prepare(&file(name), &options).expect("a camera");
        let plain = || RenderOptions { features: false, ..passes() };
        let all = picture(&scene, &plain());
        let crop = [3, 2, 15, 12];
        let sparse = Sparse::new(SIZE, crop, 30, u64::MAX).expect("fewer");
        let some = picture(&scene, &RenderOptions { crop: Some(crop), sparse: Some(sparse), ..plain() });
        let other = RenderOptions { sparse: Some(sparse), ..plain() };
        assert!(matches!(render(&scene, &other, &Quiet), Err(RenderError::Sparse)), "another part");
        let [columns, rows] = sparse.grid();
        assert!(
            (columns * rows).abs_diff(30) <= 2 && some.rgb.len() == (columns * rows) as usize,
            "{sparse:?}"
        );
        for (i, rgb) in some.rgb.iter().enumerate() {
            let [x, y] = sparse.pixel([i as u32 % columns, i as u32 / columns]);
            assert!(*rgb == all.rgb[(y * SIZE[0] + x) as usize], "{name} {i}");
        }
    }
}

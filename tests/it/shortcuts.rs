//! Shortcuts: what is left out is left out by every kernel, as if the scene had it not; and what the command line says of
//! them.

use std::collections::BTreeMap;

use epsilux::color::Rgb;
use epsilux::film::Image;
use epsilux::integrate::{Quiet, render};
use epsilux::output::read_exr;
use epsilux::prepare::{
    Effect, EffectsMode, Omission, Options, Shortcut, Shortcuts, plan, prepare, shortcuts_of,
};
use epsilux::scene::{AlphaMode, LightKind, MaterialKind, Principled, Scene, Textures};
use serde_json::Value;

use crate::bytes::{SIZE, check_equal, files, passes};
use crate::command::Folder;
use crate::pruning::feature_scenes;
use crate::support::fast::{options, valid};
use crate::support::seed::seed;

fn rendered(scene: &Scene, options: &Options) -> Image {
    let prepared = prepare(scene, options).expect("a camera");
    render(&prepared, &passes(), &Quiet).expect("passes").film.to_image()
}

fn without(effect: Effect) -> Options {
    options(SIZE, seed("shortcuts"), None).with_shortcut(Shortcut::Without(Omission::Effect(effect)))
}

/// The scene as if nothing in it asked for an effect; `None` where that cannot be said by taking something from it.
fn stripped(scene: &Scene, effect: Effect) -> Option<Scene> {
    let mut scene = scene.clone();
    let is_point = |kind: &LightKind| match kind {
        LightKind::Point { radius: extent, .. }
        | LightKind::Spot { radius: extent, .. }
        | LightKind::Sun { angle: extent, .. } => *extent <= 0.0,
        LightKind::Area { .. } => false,
    };
    let is_sun = |kind: &LightKind| matches!(kind, LightKind::Sun { .. });
    let mut principled = |change: &dyn Fn(&mut Principled)| {
        for material in &mut scene.materials {
            if let MaterialKind::Principled(p) = &mut material.kind {
                change(p);
            }
        }
    };
    match effect {
        Effect::DeltaLights => scene.lights.retain(|l| !is_point(&l.kind)),
        Effect::FreeLights => scene.lights.retain(|l| is_point(&l.kind) || is_sun(&l.kind)),
        Effect::Environment => {
            scene.environment = None;
            scene.lights.retain(|l| is_point(&l.kind) || !is_sun(&l.kind));
        }
        Effect::AreaLights => {
            principled(&|p| (p.emission, p.textures.emission) = (Rgb::BLACK, None));
            for material in &mut scene.materials {
                if let MaterialKind::Light { radiance, .. } = &mut material.kind {
                    *radiance = Rgb::BLACK;
                }
            }
        }
        Effect::Mirror => {
            for material in &mut scene.materials {
                if let MaterialKind::Mirror { color } = &mut material.kind {
                    *color = Rgb::BLACK;
                }
            }
        }
        Effect::Absorption => {
            principled(&|p| p.absorption = None);
            for material in &mut scene.materials {
                if let MaterialKind::Glass(g) = &mut material.kind {
                    g.absorption = None;
                }
            }
        }
        Effect::SmoothNormals => scene.meshes.iter_mut().for_each(|m| m.normals.clear()),
        Effect::Lens => scene.cameras.iter_mut().for_each(|c| c.lens = None),
        Effect::Textures => principled(&|p| {
            let t = p.textures.clone();
            p.textures = Textures { normal: t.normal, alpha: t.alpha, ..Textures::default() };
        }),
        Effect::Cutouts => principled(&|p| (p.alpha_mode, p.textures.alpha) = (AlphaMode::Opaque, None)),
        Effect::NormalMaps => principled(&|p| p.textures.normal = None),
        Effect::VertexColors => scene.meshes.iter_mut().for_each(|m| m.colors.clear()),
        _ => return None,
    }
    Some(scene)
}

/// Guards that every kernel leaves out what is to be left out, with equal bytes; that the plan says so; that some scene
/// shows it; and that the picture is that of the scene without it.
#[test]
fn each_effect_can_be_left_out() {
    /// Scenes that are tried for each effect, at most.
    const TRIED: usize = 5;
    let scenes: Vec<_> = feature_scenes().into_iter().map(|(n, s)| (n, valid(&s))).collect();
    let full = options(SIZE, seed("shortcuts"), None);
    let mut plans: Vec<_> =
        scenes.iter().map(|(name, s)| (plan(s, &full).expect("a camera"), name, s)).collect();
    plans.sort_by_key(|(plan, ..)| plan.needs.len());
    for effect in Effect::ALL {
        let mut seen: BTreeMap<&str, bool> = BTreeMap::new();
        let asks = |(plan, ..): &&(epsilux::prepare::Plan, &String, &Scene)| plan.effects().has(effect);
        // Few effects first, and one scene that has all of them.
        let few = plans.iter().filter(asks).take(TRIED);
        for (_, name, scene) in few.chain(plans.iter().rev().filter(asks).take(1)) {
            let what = format!("{name} without {}", effect.name());
            let [auto, all, exact] =
                [EffectsMode::Auto, EffectsMode::All, EffectsMode::Exact].map(|effects| {
                    let options = Options { effects, ..without(effect) };
                    let plan = plan(scene, &options).expect("a camera");
                    assert!(!plan.effects().has(effect) && !plan.tables.has(effect), "{what}");
                    let left = plan.left_out.iter().find(|l| l.effect == effect).expect("a reason");
                    assert_eq!(left.reason, "asked for: the picture lacks it", "{what}");
                    assert_eq!(plan.shortcuts, [Shortcut::Without(Omission::Effect(effect))]);
                    rendered(scene, &options)
                });
            check_equal(&auto, &all, &format!("{what}, everything"));
            check_equal(&auto, &exact, &format!("{what}, exactly"));
            if let Some(bare) = stripped(scene, effect) {
                assert_eq!(auto.rgb, rendered(&bare, &full).rgb, "{what}: as if the scene had none");
            }
            seen.insert(name, auto.rgb != rendered(scene, &full).rgb);
        }
        assert!(seen.values().any(|&differs| differs), "{}: {seen:?}", effect.name());
    }
}

/// Guards that a shortcut which leaves out nothing leaves the bytes alone, and that none is listed where none is taken.
#[test]
fn what_is_not_there_cannot_be_left_out() {
    for (name, scene) in files() {
        let full = options(SIZE, seed("shortcuts"), None);
        let full_plan = plan(&scene, &full).expect("a camera");
        assert!(full_plan.shortcuts.is_empty() && full.shortcuts_taken().is_empty(), "{name}");
        let picture = rendered(&scene, &full);
        let sensible = shortcuts_of(&scene, &full_plan);
        for omission in Omission::all() {
            let shortcut = Shortcut::Without(omission);
            assert_eq!(sensible.contains(&shortcut), shortcut.idle(&scene, &full_plan).is_none(), "{name}");
            if !sensible.contains(&shortcut) {
                let same = rendered(&scene, &full.with_shortcut(shortcut));
                assert_eq!(same.rgb, picture.rgb, "{name} {shortcut}");
            }
        }
        let kept = full.with_shortcut(Shortcut::Clamp(1e9)).with_shortcut(Shortcut::MaxDepth(1000));
        assert_eq!(rendered(&scene, &kept).rgb, picture.rgb, "{name}: caps above all light");
        assert_eq!(kept.without_shortcuts().shortcuts, Shortcuts::default());
    }
}

/// The smallest picture that shows something of the room.
const SMALL: &str = "render room.toml --size 12x9 --spp 2";

fn attribute(folder: &Folder, name: &str, key: &str) -> Option<String> {
    let image = read_exr(&folder.path(name)).expect("a picture");
    image.attributes.into_iter().find(|(n, _)| n == key).map(|(_, value)| value)
}

/// Guards what a render says of its shortcuts: a line for each and one for all, the same in the picture and in the report,
/// and nothing where there are none.
#[test]
fn a_render_lists_its_shortcuts() {
    let folder = Folder::with_room();
    let said = folder.done(&format!("{SMALL} -o a.exr -o a.png --without caustics,lens --max-depth 2"));
    let lines: Vec<_> = said.err.lines().take(4).collect();
    assert!(lines[0].starts_with("without caustics: ") && lines[0].contains("darker"), "{}", said.err);
    assert_eq!(lines[1], "without lens: changes nothing, the camera is a pinhole");
    assert!(lines[2].starts_with("at most 2 events: ") && lines[2].contains("saves"), "{}", said.err);
    assert!(lines[3].starts_with("all of these: "), "{}", said.err);
    let list: Value =
        serde_json::from_str(&attribute(&folder, "a.exr", "shortcuts").expect("listed")).unwrap();
    assert_eq!(list[0]["shortcuts"], serde_json::json!(["--without caustics"]));
    assert_eq!(list[1]["idle"], "the camera is a pinhole");
    let (bias, interval) = (list[2]["bias"].as_f64().unwrap(), &list[2]["bias_interval"]);
    assert!(bias < 0.0 && interval[0].as_f64().unwrap() < bias && bias < interval[1].as_f64().unwrap());
    assert_eq!(list[3]["shortcuts"].as_array().map(Vec::len), Some(3));
    assert!(list[2].get("seconds").is_none(), "no picture carries a time");
    let plan: Value = serde_json::from_str(&attribute(&folder, "a.exr", "plan").expect("a plan")).unwrap();
    assert_eq!(plan["shortcuts"], list[3]["shortcuts"]);
    let report: Value = serde_json::from_slice(&folder.read("a.report.json")).unwrap();
    assert_eq!(report["shortcuts"][2]["bias"], list[2]["bias"]);
    assert!(report["shortcuts"][2]["seconds"][0].as_f64().unwrap() > 0.0);
    folder.done(&format!("{SMALL} -o b.exr -q"));
    assert_eq!(attribute(&folder, "b.exr", "shortcuts"), None);
    let report: Value = serde_json::from_slice(&folder.read("b.report.json")).unwrap();
    assert!(report.get("shortcuts").is_none() && report["plan"].get("shortcuts").is_none());
    let explained = folder.done("explain room.toml --without caustics --clamp 2");
    assert!(explained.out.contains("shortcut      without caustics"), "{}", explained.out);
    assert!(
        explained.out.contains("caustics          none: asked for: the picture lacks it"),
        "{}",
        explained.out
    );
}

/// Guards that prices are a function of scene and settings: threads change no byte, and parts are the whole.
#[test]
fn pictures_with_shortcuts_are_equal_files() {
    let folder = Folder::with_room();
    let render = |flags: &str| {
        folder.done(&format!("render room.toml --size 12x9 -q --without indirect --fresnel schlick {flags}"));
    };
    render("--spp 6 --threads 1 -o a.exr -o a.png");
    render("--spp 6 --threads 3 -o b.exr -o b.png");
    render("--passes 0..2 -o t.png --checkpoint 0.part");
    render("--passes 2..6 -o t.png --checkpoint 1.part");
    folder.done("merge 1.part 0.part -o m.exr -o m.png");
    for suffix in ["exr", "png"] {
        let expected = folder.read(&format!("a.{suffix}"));
        assert!(folder.read(&format!("b.{suffix}")) == expected, "{suffix}: threads");
        assert!(folder.read(&format!("m.{suffix}")) == expected, "{suffix}: parts");
    }
    let said = folder.run("render room.toml --size 12x9 --spp 6 -o t.png --checkpoint 0.part");
    assert_eq!(said.code, Some(2), "another render: {}", said.err);
}

/// Guards mistakes, and what other methods do not know.
#[test]
fn mistakes_about_shortcuts_are_explained() {
    let folder = Folder::with_room();
    let mistake = |flags: &str, says: &str| {
        let said = folder.run(&format!("{SMALL} -o t.png {flags}"));
        assert!(said.code == Some(2) && said.err.contains(says), "{flags}: {:?} {}", said.code, said.err);
    };
    mistake("--without fog", "expected one of: caustics, indirect, area-lights");
    mistake("--clamp 0", "--clamp 0: found 0, expected a radiance above zero");
    mistake("--clamp nan", "expected a radiance above zero");
    mistake("--indirect-gain=-1", "expected a factor from 0 to a million");
    mistake("--without caustics --method report", "--without is not available with --method report");
    mistake("--fresnel schlick --method reference", "--fresnel is not available with --method reference");
    // A scene may amplify its indirect light; who cannot do that says so.
    let room = String::from_utf8(folder.read("room.toml")).unwrap();
    folder.write("room.toml", room.replace("[render]\n", "[render]\nindirect_gain = 2\n"));
    let said = folder.done(&format!("{SMALL} -o t.png"));
    assert!(said.err.contains("indirect light times 2: "), "{}", said.err);
    let said = folder.done(&format!("{SMALL} -o t.png --method report"));
    assert!(said.err.contains("--method report does not amplify indirect light"), "{}", said.err);
    let said = folder.run(&format!("{SMALL} -o t.png --method report --strict"));
    assert_eq!(said.code, Some(5), "{}", said.err);
}

/// Guards that whoever asks for prices and for no shortcut learns what each would cost that makes sense, and only those.
#[test]
fn prices_of_all_that_makes_sense() {
    let folder = Folder::new();
    folder.write(
        "ball.toml",
        "epsilux = 1
render.size = [8, 6]
material.floor = { diffuse = [0.5, 0.5, 0.5] }
camera.a = { eye = [0, 1, 5], target = [0, 0, 0], fov = 40 }
environment = { radiance = [1, 1, 1] }
[[object]]
material = \"floor\"
sphere = { radius = 1 }
",
    );
    let said = folder.done("explain ball.toml --price --json");
    let explained: Value = serde_json::from_str(&said.out).unwrap();
    let flags: Vec<_> =
        explained["prices"].as_array().unwrap().iter().map(|p| p["shortcuts"][0].as_str().unwrap()).collect();
    assert_eq!(
        flags,
        [
            "--without indirect",
            "--without environment",
            "--without diffuse",
            "--max-depth 1",
            "--max-depth 2",
            "--max-depth 4",
            "--max-depth 8",
            "--clamp 10"
        ]
    );
    // A ball under a sky: nothing is lit twice, and the sky is all that shines.
    assert_eq!(explained["prices"][0]["bias"], 0.0);
    assert_eq!(explained["prices"][1]["bias"], -1.0);
    assert!(explained.get("shortcuts").is_none());
}

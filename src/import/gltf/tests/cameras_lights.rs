//! Cameras, and lights in watts.

use std::f64::consts::PI;

use serde_json::{Value, json};

use super::super::super::{LightUnits, ReadOptions};
use super::build::{lines, read, read_as, square_with};
use crate::color::Rgb;
use crate::scene::{FovAxis, LightKind, Projection, SpotFalloff};

const BLENDER: &str = "Khronos glTF Blender I/O v5.0.21";

#[test]
fn cameras_span_the_vertical_side() {
    let cameras = json!([
        {"type": "perspective", "perspective": {"yfov": 0.5, "aspectRatio": 1.5, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 9}},
        {"type": "perspective", "perspective": {"yfov": 0, "znear": 0.1}},
    ]);
    let nodes = json!([
        {"name": "cam", "camera": 0}, {"name": "cam", "camera": 1, "translation": [1, 2, 3]},
        {"name": "bad", "camera": 2},
    ]);
    let roots = ("/scenes/0/nodes", json!([0, 1, 2]));
    let (scene, notes) = read(&square_with(&[("/cameras", cameras), ("/nodes", nodes), roots])).unwrap();
    let axis = FovAxis::Vertical;
    let [a, b] = &scene.cameras[..] else { panic!("{:?}", scene.cameras) };
    assert_eq!((&*a.name, a.aspect), ("cam", Some(1.5)));
    assert_eq!(a.projection, Projection::Perspective { fov: 0.5, axis });
    assert_eq!((&*b.name, b.aspect), ("cam.2", Some(1.5)));
    assert_eq!(b.projection, Projection::Orthographic { extent: 4.0, axis });
    insta::assert_snapshot!(lines(&notes), @r#"
    camera-ignored (Missing) cameras[2]: a camera without a usable projection is left out
    "#);
}

fn lights(generator: &str, units: LightUnits) -> (Vec<LightKind>, String) {
    let list = json!([
        {"type": "point", "intensity": 683, "color": [1, 0.5, 0], "range": 5},
        {"type": "spot", "intensity": 683, "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.4}},
        {"type": "directional", "intensity": 683},
    ]);
    let node = |i| json!({"extensions": {"KHR_lights_punctual": {"light": i}}});
    let doc = square_with(&[
        ("/asset/generator", json!(generator)),
        ("/extensions", json!({"KHR_lights_punctual": {"lights": list}})),
        ("/nodes", json!([node(0), node(1), node(2)])),
        ("/scenes/0/nodes", json!([0, 1, 2])),
    ]);
    let options = ReadOptions { light_units: units, ..ReadOptions::default() };
    let (scene, notes) = read_as(&doc, &options).unwrap();
    (scene.lights.iter().map(|l| l.kind).collect(), lines(&notes))
}

/// The units of Blender's three modes, verified against Cycles: 683 lm/W, as is, and 4 pi.
#[test]
fn light_units_follow_the_option_and_the_generator() {
    let check = |generator, units, point: f64, sun: f64| {
        let (kinds, _) = lights(generator, units);
        let LightKind::Point { intensity, .. } = kinds[0] else { panic!("{kinds:?}") };
        let LightKind::Sun { irradiance, .. } = kinds[2] else { panic!("{kinds:?}") };
        let near = |a: f32, b: f64| (f64::from(a) / b - 1.0).abs() < 1e-6;
        assert!(near(intensity.r, point) && near(intensity.g, point / 2.0), "{intensity:?} {units:?}");
        assert!(near(irradiance.r, sun), "{irradiance:?} {units:?}");
    };
    check(BLENDER, LightUnits::Auto, 1.0, 1.0);
    check("", LightUnits::Auto, 683.0, 683.0);
    check("", LightUnits::BlenderSpec, 1.0, 1.0);
    check(BLENDER, LightUnits::Unitless, 683.0, 683.0);
    check(BLENDER, LightUnits::Raw, 683.0 / (4.0 * PI), 683.0);
}

#[test]
fn spots_fade_as_their_generator_does() {
    let check = |generator, expected| {
        let (kinds, _) = lights(generator, LightUnits::BlenderSpec);
        let LightKind::Spot { intensity, inner, outer, falloff, .. } = kinds[1] else { panic!("{kinds:?}") };
        assert_eq!((intensity, falloff), (Rgb::WHITE, expected));
        assert_eq!((inner as f32, outer as f32), (0.2, 0.4));
    };
    check("", SpotFalloff::Gltf);
    check(BLENDER, SpotFalloff::Blender);
}

#[test]
fn assumptions_about_lights_are_said() {
    insta::assert_snapshot!(lights("", LightUnits::Auto).1, @r#"
    light-units (Differs) extensions.KHR_lights_punctual: candela and lux are taken as W/sr and W/m^2
    light-range-ignored (None) extensions.KHR_lights_punctual.lights[0].range: a range is ignored: light follows the inverse square
    "#);
    insta::assert_snapshot!(lights(BLENDER, LightUnits::Auto).1, @r#"
    light-units (None) extensions.KHR_lights_punctual: lights are taken as exported with Blender's "Standard" lighting: divided by 683
    light-size-lost (Differs) extensions.KHR_lights_punctual: the sizes of lights are not in the file: their shadows are sharp
    light-range-ignored (None) extensions.KHR_lights_punctual.lights[0].range: a range is ignored: light follows the inverse square
    "#);
}

/// What cannot be an intensity or a cone is clamped, and said.
#[test]
fn impossible_lights_are_clamped() {
    let list: Value =
        json!([{"type": "spot", "intensity": -1, "spot": {"innerConeAngle": 2, "outerConeAngle": 1.6}}]);
    let doc = square_with(&[
        ("/extensions", json!({"KHR_lights_punctual": {"lights": list}})),
        ("/nodes/0/extensions", json!({"KHR_lights_punctual": {"light": 0}})),
    ]);
    let options = ReadOptions { light_units: LightUnits::Unitless, ..ReadOptions::default() };
    insta::assert_snapshot!(lines(&read_as(&doc, &options).unwrap().1), @r#"
    value-clamped (Differs) extensions.KHR_lights_punctual.lights[0]: [-1.0, -1.0, -1.0] is no intensity: taken as [0.0, 0.0, 0.0]
    value-clamped (Differs) extensions.KHR_lights_punctual.lights[0].spot: cone angles 2 and 1.600000023841858: taken as 1.5707963267948966 and 1.5707963267948966
    "#);
}

/// Stock exports drop area lights: all that is left is an empty node.
#[test]
fn empty_nodes_of_blender_may_have_been_area_lights() {
    let doc = square_with(&[
        ("/asset/generator", json!(BLENDER)),
        (
            "/nodes",
            json!([{"name": "Area"}, {"name": "Joint"}, {"name": "Group", "children": [3]}, {"name": "Area.001"}]),
        ),
        ("/scenes/0/nodes", json!([0, 1, 2])),
        ("/skins", json!([{"joints": [1]}])),
    ]);
    insta::assert_snapshot!(lines(&read(&doc).unwrap().1), @r#"
    area-light-lost (Missing) nodes[0]: an empty node: if it was an area light in Blender, its light is not in the file (here and in 1 more)
    "#);
}

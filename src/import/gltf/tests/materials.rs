//! Materials: glTF's defaults, the extensions, and what Blender means by them.

use serde_json::{Value, json};

use super::build::{lines, principled, read, square_with};
use crate::color::Rgb;
use crate::scene::{Absorption, AlphaMode, Principled};

/// Reads one material, written by `generator`.
fn material(generator: &str, value: Value) -> (Principled, String) {
    let doc = square_with(&[
        ("/asset/generator", json!(generator)),
        ("/materials", json!([value])),
        ("/meshes/0/primitives/0/material", json!(0)),
    ]);
    let (scene, notes) = read(&doc).unwrap();
    (principled(&scene, 0).clone(), lines(&notes))
}

const BLENDER: &str = "Khronos glTF Blender I/O v5.0.21";

#[test]
fn factors_and_extensions_are_read() {
    let gltf_default = Principled { metallic: 1.0, roughness: 1.0, ..Principled::default() };
    let check = |value: Value, expected: Principled| {
        let (found, notes) = material("", value);
        assert_eq!(found, expected);
        assert_eq!(notes, "");
    };
    check(json!({}), gltf_default.clone());
    check(
        json!({
            "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1], "metallicFactor": 0, "roughnessFactor": 0.25},
            "emissiveFactor": [1, 0.5, 0],
            "extensions": {
                "KHR_materials_emissive_strength": {"emissiveStrength": 8},
                "KHR_materials_ior": {"ior": 1.75},
                "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 2, 0.5]},
            },
        }),
        Principled {
            base_color: Rgb::new(0.5, 0.25, 1.0),
            roughness: 0.25,
            ior: 1.75,
            specular: 0.5,
            specular_color: Rgb::new(1.0, 2.0, 0.5),
            transmission_tint: Rgb::new(0.5, 0.25, 1.0),
            emission: Rgb::new(8.0, 4.0, 0.0),
            ..Principled::default()
        },
    );
}

/// By the specification a thickness makes a solid; for Blender's files transmission alone does.
#[test]
fn transmission_is_a_sheet_or_solid_glass() {
    let glass = |volume: Value| {
        json!({
            "pbrMetallicRoughness": {"baseColorFactor": [0.25, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 0},
            "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_volume": volume},
        })
    };
    let check = |generator, volume: Value, thin, tint: f32, absorption| {
        let (p, _) = material(generator, glass(volume));
        assert_eq!((p.transmission, p.thin, p.absorption), (1.0, thin, absorption));
        assert_eq!(p.transmission_tint, Rgb::new(tint, 1.0, 1.0));
    };
    let color = Rgb::new(0.5, 1.0, 1.0);
    let smoke = json!({"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 1, 1]});
    let absorption = Some(Absorption { color, distance: 2.0 });
    check("", json!({}), true, 0.25, None);
    check("", smoke.clone(), false, 0.25, absorption);
    check(
        "",
        json!({"thicknessFactor": 0, "attenuationDistance": 2, "attenuationColor": [0.5, 1, 1]}),
        true,
        0.25,
        None,
    );
    check(BLENDER, json!({}), false, 0.5, None);
    check(BLENDER, smoke, false, 0.5, absorption);
}

/// Everything that is ignored, assumed or clamped is said, with its place.
#[test]
fn what_is_not_rendered_is_said() {
    let value = json!({
        "pbrMetallicRoughness": {"metallicFactor": 1.5},
        "occlusionTexture": {"index": 0},
        "alphaMode": "DITHER",
        "extensions": {
            "KHR_materials_anisotropy": {"anisotropyStrength": 1},
            "KHR_materials_clearcoat": {"clearcoatFactor": 2},
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_volume": {
                "thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": [0, 1, 1],
                "thicknessTexture": {"index": 0},
            },
            "VENDOR_thing": {},
        },
    });
    let (_, said) = material("", value);
    insta::assert_snapshot!(said, @r#"
    extension-ignored (Differs) materials[0].extensions.KHR_materials_anisotropy: KHR_materials_anisotropy is not supported: highlights are round
    extension-ignored (Missing) materials[0].extensions.VENDOR_thing: VENDOR_thing is not supported: what it describes is missing
    value-clamped (Differs) materials[0].pbrMetallicRoughness.metallicFactor: 1.5: taken as 1.0
    occlusion-ignored (None) materials[0].occlusionTexture: occlusion is found by tracing: the texture is not used
    alpha-ignored (Missing) materials[0].alphaMode: an unknown mode: the surface is opaque
    thickness-ignored (None) materials[0].extensions.KHR_materials_volume.thicknessTexture: thickness is that of the geometry: the texture is not used
    value-clamped (Differs) materials[0].extensions.KHR_materials_volume.attenuationColor: [0.0, 1.0, 1.0]: taken as [1e-6, 1.0, 1.0]
    value-clamped (Differs) materials[0].extensions.KHR_materials_clearcoat.clearcoatFactor: 2: taken as 1.0
    "#);
    insta::assert_snapshot!(material(BLENDER, json!({"name": "Noise", "doubleSided": true})).1, @r#"
    material-lost (Missing) materials[0]: a material without any property: Blender writes it where the nodes hold no Principled BSDF, and it shows as white metal
    "#);
    let unlit = json!({"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 0, 1]}, "extensions": {"KHR_materials_unlit": {}}});
    let (p, said) = material("", unlit);
    assert_eq!((p.base_color, p.emission), (Rgb::BLACK, Rgb::new(0.5, 1.0, 0.0)));
    insta::assert_snapshot!(said, @r#"
    unlit-emits (Differs) materials[0].extensions.KHR_materials_unlit: an unlit material is rendered as a black one that emits its base colour
    "#);
}

/// Coverage counts where the mode looks at it, and only there.
#[test]
fn alpha_has_three_modes() {
    let check = |value: Value, alpha, mode| {
        let (p, notes) = material("", value);
        assert_eq!((p.alpha, p.alpha_mode, &*notes), (alpha, mode, ""));
    };
    let color = json!({"baseColorFactor": [1, 1, 1, 0.25]});
    check(json!({"pbrMetallicRoughness": color}), 1.0, AlphaMode::Opaque);
    check(json!({"pbrMetallicRoughness": color, "alphaMode": "BLEND"}), 0.25, AlphaMode::Blend);
    let mask = |cutoff| AlphaMode::Mask { cutoff };
    check(json!({"pbrMetallicRoughness": color, "alphaMode": "MASK"}), 0.25, mask(0.5));
    check(json!({"alphaMode": "MASK", "alphaCutoff": 0.125}), 1.0, mask(0.125));
    let glass = json!({
        "pbrMetallicRoughness": color, "alphaMode": "BLEND",
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}},
    });
    check(glass, 0.25, AlphaMode::Blend);
}

/// Coat and sheen, which the document types do not know; without the extension there is none.
#[test]
fn coat_and_sheen_are_read() {
    let (p, notes) = material(
        "",
        json!({"extensions": {
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25},
            "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0.25, 1], "sheenRoughnessFactor": 0.75},
        }}),
    );
    assert_eq!((p.coat, p.coat_roughness, p.coat_ior, &*notes), (0.5, 0.25, 1.5, ""));
    assert_eq!((p.sheen_color, p.sheen_roughness), (Rgb::new(0.5, 0.25, 1.0), 0.75));
    let (p, _) = material("", json!({"extensions": {"KHR_materials_sheen": {}}}));
    assert_eq!((p.coat, p.sheen_color, p.sheen_roughness), (0.0, Rgb::BLACK, 0.0));
    let wrong = json!({"extensions": {"KHR_materials_sheen": {"sheenColorFactor": "red"}}});
    let error = read(&square_with(&[("/materials", json!([wrong]))])).unwrap_err().to_string();
    assert!(
        error.starts_with("test.gltf: materials[0].extensions.KHR_materials_sheen: found a fault"),
        "{error}"
    );
}

#[test]
fn names_of_materials_are_unique() {
    let (scene, _) =
        read(&square_with(&[("/materials", json!([{"name": "a"}, {"name": "a"}, {}, {"name": "default"}]))]))
            .unwrap();
    let names: Vec<_> = scene.materials.iter().map(|m| &*m.name).collect();
    assert_eq!(names, ["a", "a.2", "material 2", "default", "default.2"]);
}

//! Textures: where pictures come from, how they lie, which slot reads which channel, and what is missing.

use std::fs;
use std::io::Cursor;

use serde_json::{Value, json};

use super::super::super::{ReadOptions, read as read_file};
use super::build::{floats, glb, lines, principled, read, read_glb, set, square, square_with, uri};
use crate::color::Rgb;
use crate::scene::{
    AlphaMode, Channel, Filter, ImageFormat, ImageId, NormalTexture, Principled, ScalarTexture, Scene,
    Texture, Textures, Wrap,
};

/// A picture of one pixel.
fn picture(rgba: [u8; 4], format: image::ImageFormat) -> Vec<u8> {
    let image = image::RgbaImage::from_pixel(1, 1, image::Rgba(rgba));
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn png(grey: u8) -> Vec<u8> {
    picture([grey, grey, grey, 255], image::ImageFormat::Png)
}

/// A square whose material is `material`, with the textures and images given.
fn textured(material: Value, textures: Value, images: Value) -> Value {
    square_with(&[
        ("/materials", json!([material])),
        ("/meshes/0/primitives/0/material", json!(0)),
        ("/textures", textures),
        ("/images", images),
    ])
}

fn base(info: Value) -> Value {
    json!({"pbrMetallicRoughness": {"baseColorTexture": info}})
}

fn one_image() -> Value {
    json!([{"uri": uri(&png(1))}])
}

/// What is read, for the base colour's slot.
fn base_texture(doc: &Value) -> (Option<Texture>, Scene, String) {
    let (scene, notes) = read(doc).unwrap();
    (principled(&scene, 0).textures.base_color, scene, lines(&notes))
}

/// Each slot reads the channel that the specification says.
#[test]
fn slots_read_their_channels() {
    let texture = json!({"index": 0});
    let value = json!({
        "alphaMode": "BLEND",
        "pbrMetallicRoughness": {"baseColorTexture": texture, "metallicRoughnessTexture": texture},
        "normalTexture": {"index": 0, "scale": 0.5},
        "emissiveTexture": texture, "emissiveFactor": [1, 2, 3],
        "extensions": {
            "KHR_materials_transmission": {"transmissionTexture": texture},
            "KHR_materials_specular": {"specularTexture": texture, "specularColorTexture": texture},
            "KHR_materials_clearcoat": {
                "clearcoatTexture": texture, "clearcoatRoughnessTexture": texture,
                "clearcoatNormalTexture": {"index": 0, "scale": -2},
            },
            "KHR_materials_sheen": {"sheenColorTexture": texture, "sheenRoughnessTexture": texture},
        },
    });
    let (scene, notes) = read(&textured(value, json!([{"source": 0}]), one_image())).unwrap();
    let texture = Texture::new(ImageId(0));
    let scalar = |channel| Some(ScalarTexture { texture, channel });
    let p = principled(&scene, 0);
    let expected = Textures {
        base_color: Some(texture),
        alpha: scalar(Channel::A),
        metallic: scalar(Channel::B),
        roughness: scalar(Channel::G),
        normal: Some(NormalTexture { texture, scale: 0.5 }),
        emission: Some(texture),
        specular: scalar(Channel::A),
        specular_color: Some(texture),
        transmission: scalar(Channel::R),
        coat: scalar(Channel::R),
        coat_roughness: scalar(Channel::G),
        coat_normal: Some(NormalTexture { texture, scale: -2.0 }),
        sheen_color: Some(texture),
        sheen_roughness: scalar(Channel::A),
    };
    assert_eq!(p.textures, expected);
    assert_eq!(
        (p.emission, p.alpha_mode, scene.images.len()),
        (Rgb::new(1.0, 2.0, 3.0), AlphaMode::Blend, 1)
    );
    assert_eq!(lines(&notes), "");
}

/// An opaque material's alpha is not read, and an unlit one emits its base colour's texture.
#[test]
fn opaque_and_unlit_materials_read_less() {
    let mut doc = textured(base(json!({"index": 0})), json!([{"source": 0}]), one_image());
    let (scene, _) = read(&doc).unwrap();
    assert_eq!(principled(&scene, 0).textures.alpha, None);
    set(&mut doc, "/materials/0/extensions", json!({"KHR_materials_unlit": {}}));
    set(&mut doc, "/materials/0/alphaMode", json!("MASK"));
    let (scene, _) = read(&doc).unwrap();
    let p = principled(&scene, 0);
    let texture = Texture::new(ImageId(0));
    let alpha = Some(ScalarTexture { texture, channel: Channel::A });
    assert_eq!(p.textures, Textures { emission: Some(texture), alpha, ..Textures::default() });
    assert_eq!((p.base_color, p.emission), (Rgb::BLACK, Rgb::WHITE));
}

/// Samplers, sets of texture coordinates, and transforms, on normal textures as well.
#[test]
fn textures_lie_as_they_are_told() {
    let check = |info: Value, sampler: Value, expected: Texture| {
        let value = json!({"pbrMetallicRoughness": {"baseColorTexture": info}, "normalTexture": info});
        let mut doc = textured(value, json!([{"source": 0, "sampler": 0}]), one_image());
        set(&mut doc, "/samplers", json!([sampler]));
        let (scene, notes) = read(&doc).unwrap();
        let p: &Principled = principled(&scene, 0);
        assert_eq!(p.textures.base_color, Some(expected));
        assert_eq!(p.textures.normal.unwrap().texture, expected);
        lines(&notes)
    };
    let plain = Texture::new(ImageId(0));
    let transform = |t: Value| json!({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": t}});
    let mut notes = check(json!({"index": 0}), json!({}), plain);
    notes += &check(
        json!({"index": 0, "texCoord": 1}),
        json!({"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}),
        Texture { uv_set: 1, wrap: [Wrap::Clamp, Wrap::Mirror], filter: Filter::Nearest, ..plain },
    );
    notes += &check(
        transform(json!({"offset": [0.5, -40], "rotation": 1.5, "scale": [2, 3], "texCoord": 0})),
        json!({"wrapS": 10497, "minFilter": 9986}),
        Texture { offset: [0.5, -40.0], rotation: 1.5, scale: [2.0, 3.0], filter: Filter::Nearest, ..plain },
    );
    for (sampler, filter) in [
        (json!({"minFilter": 9984}), Filter::Nearest),
        (json!({"minFilter": 9985}), Filter::Linear),
        (json!({"minFilter": 9984, "magFilter": 9729}), Filter::Linear),
        (json!({"minFilter": 1, "magFilter": 1, "wrapS": 1}), Filter::Linear),
    ] {
        notes += &check(json!({"index": 0}), sampler, Texture { filter, ..plain });
    }
    notes += &check(
        transform(json!({"offset": [1e30, 0]})),
        json!({}),
        Texture { uv_set: 1, offset: [1e6, 0.0], ..plain },
    );
    insta::assert_snapshot!(notes, @r#"
    sampler-repaired (Differs) textures[0].sampler: an unknown mode: the picture repeats, and is filtered linearly (here and in 1 more)
    value-clamped (Differs) materials[0].pbrMetallicRoughness.baseColorTexture.extensions.KHR_texture_transform.offset: 1e30: taken as 1000000.0 (here and in 1 more)
    "#);
}

/// Pictures come from data URIs, views and files; equal ones are one, unused ones are not read.
#[test]
fn pictures_come_from_everywhere() {
    let dir = tempfile::tempdir().unwrap();
    let (inside, outside) = (png(2), picture([1, 2, 3, 4], image::ImageFormat::WebP));
    fs::create_dir(dir.path().join("maps")).unwrap();
    fs::write(dir.path().join("maps/a b.webp"), &outside).unwrap();
    let texture = |i: usize| json!({"index": i});
    let value = json!({
        "pbrMetallicRoughness": {"baseColorTexture": texture(0), "metallicRoughnessTexture": texture(1)},
        "emissiveTexture": texture(2), "emissiveFactor": [1, 1, 1],
        "normalTexture": texture(3),
    });
    let mut doc = textured(
        value,
        json!([{"source": 0}, {"source": 1}, {"extensions": {"EXT_texture_webp": {"source": 2}}, "source": 3}, {"source": 4}]),
        json!([
            {"uri": uri(&png(1))},
            {"bufferView": 2, "mimeType": "image/png", "name": "inside"},
            {"uri": "maps/a%20b.webp"},
            {"uri": "never-read.png"},
            {"uri": uri(&inside)},
        ]),
    );
    set(&mut doc, "/extensionsRequired", json!(["EXT_texture_webp"]));
    set(&mut doc, "/buffers/1", json!({"byteLength": inside.len(), "uri": uri(&inside)}));
    set(&mut doc, "/bufferViews/2", json!({"buffer": 1, "byteLength": inside.len()}));
    let path = dir.path().join("scene.gltf");
    fs::write(&path, serde_json::to_vec(&doc).unwrap()).unwrap();
    let (scene, notes) = read_file(&path, &ReadOptions::default()).unwrap();
    assert_eq!(lines(&notes), "");
    let told: Vec<_> = scene.images.iter().map(|i| (&*i.name, i.file.as_deref())).collect();
    assert_eq!(told, [("image 0", None), ("inside", None), ("a b", Some("maps/a b.webp"))]);
    let formats = scene.images.iter().map(|i| i.encoded.as_ref().unwrap().format);
    assert_eq!(formats.collect::<Vec<_>>(), [ImageFormat::Png, ImageFormat::Png, ImageFormat::Webp]);
    let t = &principled(&scene, 0).textures;
    assert_eq!(t.normal.unwrap().texture.image, t.roughness.unwrap().texture.image);
    assert_eq!(t.emission.unwrap().image, ImageId(2));
}

/// A picture that cannot be had leaves its slot untextured, and the note says why; what emits goes dark.
#[test]
fn missing_pictures_are_said() {
    let check = |textures: Value, images: Value| {
        let value = json!({
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}},
            "emissiveTexture": {"index": 0}, "emissiveFactor": [1, 1, 1],
        });
        let (texture, scene, notes) = base_texture(&textured(value, textures, images));
        assert_eq!((texture, scene.images.len()), (None, 0), "{notes}");
        assert!(principled(&scene, 0).emission.is_black());
        notes
    };
    let plain = json!([{"source": 0}]);
    let mut notes = String::new();
    for uri in
        ["missing.png", "../up.png", "/etc/hostname", "file:///a.png", "http://a/b.png", "a%ffb.png", ""]
    {
        notes += &check(plain.clone(), json!([{"uri": uri}]));
    }
    for uri in ["data:;base64,!", "data:image/png;base64,", "data:image/png,hello"] {
        notes += &check(plain.clone(), json!([{"uri": uri}]));
    }
    notes += &check(plain.clone(), json!([{"uri": uri(&png(1)[..40])}]));
    notes += &check(plain.clone(), json!([{"bufferView": 0}]));
    notes += &check(plain, json!([{}]));
    notes += &check(json!([{}]), json!([]));
    notes +=
        &check(json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]), json!([{"uri": "a.ktx2"}]));
    insta::assert_snapshot!(notes);
}

/// KTX2 and WebP have fallbacks, which are used.
#[test]
fn fallbacks_are_used() {
    let check = |extensions: Value| {
        let textures = json!([{"source": 0, "extensions": extensions}]);
        let images = json!([{"uri": uri(&png(1))}, {"uri": uri(b"nothing")}]);
        let (texture, _, notes) = base_texture(&textured(base(json!({"index": 0})), textures, images));
        assert_eq!(texture, Some(Texture::new(ImageId(0))));
        notes
    };
    insta::assert_snapshot!(check(json!({"KHR_texture_basisu": {"source": 1}})), @r#"
    extension-ignored (None) textures[0].extensions.KHR_texture_basisu: KHR_texture_basisu is not supported: the PNG or JPEG beside it is used, where there is one
    "#);
    assert_eq!(check(json!({"EXT_texture_webp": {"source": 1}})), "");
}

/// Texture coordinates that are not there, or not read.
#[test]
fn missing_coordinates_are_said() {
    let doc = |set: usize| {
        textured(base(json!({"index": 0, "texCoord": set})), json!([{"source": 0}]), one_image())
    };
    assert_eq!(lines(&read(&doc(1)).unwrap().1), "", "a set that the mesh lacks is validation's to say");
    insta::assert_snapshot!(lines(&read(&doc(2)).unwrap().1), @r#"
    texture-missing (Missing) materials[0].pbrMetallicRoughness.baseColorTexture: the texture is left out: it lies on TEXCOORD_2, and 0 and 1 are read
    "#);
    let mut good = doc(0);
    let uvs = floats(&[0., 0., 1., 0., 1., 1., 0., 1.]);
    set(&mut good, "/buffers/1", json!({"byteLength": 32, "uri": uri(&uvs)}));
    set(&mut good, "/bufferViews/2", json!({"buffer": 1, "byteLength": 32}));
    set(
        &mut good,
        "/accessors/2",
        json!({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}),
    );
    set(&mut good, "/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(2));
    assert_eq!(lines(&read(&good).unwrap().1), "");
}

/// Indices that lead nowhere contradict the format: the file is refused.
#[test]
fn indices_out_of_range_are_refused() {
    let good = || textured(base(json!({"index": 0})), json!([{"source": 0, "sampler": 0}]), one_image());
    let mut errors = String::new();
    for (pointer, value) in [
        ("/materials/0/pbrMetallicRoughness/baseColorTexture/index", json!(1)),
        ("/materials/0/pbrMetallicRoughness/baseColorTexture/index", json!(-1)),
        ("/textures/0/source", json!(9)),
        ("/textures/0/sampler", json!(9)),
        ("/textures/0/extensions", json!({"EXT_texture_webp": {"source": 3}})),
        ("/textures/0/extensions", json!({"EXT_texture_webp": {"source": "a"}})),
        ("/images/0", json!({"bufferView": 9})),
        ("/images/0", json!({"uri": 3})),
        (
            "/materials/0/normalTexture",
            json!({"index": 0, "extensions": {"KHR_texture_transform": {"scale": 2}}}),
        ),
    ] {
        let mut doc = good();
        set(&mut doc, "/samplers", json!([{}]));
        set(&mut doc, pointer, value);
        errors += &(read(&doc).unwrap_err().to_string() + "\n");
    }
    let mut doc = good();
    set(&mut doc, "/samplers", json!([{}]));
    set(&mut doc, "/images/0", json!({"bufferView": 2}));
    set(&mut doc, "/bufferViews/2", json!({"buffer": 0, "byteLength": 61}));
    errors += &read(&doc).unwrap_err().to_string();
    insta::assert_snapshot!(errors);
}

/// A GLB whose picture lies in the binary chunk, as exporters write it.
fn textured_glb() -> Vec<u8> {
    let mut bin = floats(&super::build::SQUARE);
    bin.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    bin.extend(floats(&[0., 0., 1., 0., 1., 1., 0., 1.]));
    let rgb = image::RgbImage::from_fn(16, 16, |x, y| image::Rgb([x as u8 * 16, y as u8 * 16, 7]));
    let mut picture = Cursor::new(Vec::new());
    rgb.write_to(&mut picture, image::ImageFormat::Png).unwrap();
    let picture = picture.into_inner();
    bin.extend(&picture);
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut doc = square();
    for (pointer, value) in [
        ("/materials", json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}])),
        ("/meshes/0/primitives/0/material", json!(0)),
        ("/meshes/0/primitives/0/attributes/TEXCOORD_0", json!(2)),
        ("/accessors/2", json!({"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"})),
        ("/bufferViews/2", json!({"buffer": 0, "byteOffset": 60, "byteLength": 32})),
        ("/bufferViews/3", json!({"buffer": 0, "byteOffset": 92, "byteLength": picture.len()})),
        ("/textures", json!([{"source": 0, "sampler": 0}])),
        ("/samplers", json!([{"wrapS": 33071}])),
        ("/images", json!([{"bufferView": 3, "mimeType": "image/png"}])),
        ("/buffers/0", json!({"byteLength": bin.len()})),
    ] {
        set(&mut doc, pointer, value);
    }
    glb(&doc, &bin)
}

/// A textured file, cut at every 97th byte and with damage anywhere, ends in a scene or an error.
#[test]
fn damaged_textured_files_never_panic() {
    let whole = textured_glb();
    let (scene, notes) = read_glb(&whole).unwrap();
    assert_eq!((scene.images.len(), lines(&notes)), (1, String::new()));
    for length in (0..whole.len()).step_by(97) {
        assert!(read_glb(&whole[..length]).is_err(), "{length} of {} bytes", whole.len());
        let mut prefix = whole[..length].to_vec();
        if length >= 12 {
            prefix[8..12].copy_from_slice(&(length as u32).to_le_bytes());
            assert!(read_glb(&prefix).is_err(), "{length} of {} bytes", whole.len());
        }
    }
    let name = "damaged_textured_files_never_panic";
    let seed = name.bytes().fold(0, |seed, b| crate::math::mix64(seed ^ u64::from(b)));
    let (mut accepted, mut untextured) = (0, 0);
    for round in 0..4_000_u64 {
        let mut bytes = whole.clone();
        for hit in 0..=round % 4 {
            let r = crate::math::mix64(seed ^ (round * 4 + hit));
            let at = (r >> 32) as usize % bytes.len();
            bytes[at] = if r & 8 == 0 { bytes[at] ^ 1 << (r & 7) } else { b'0' + (r >> 8 & 7) as u8 };
        }
        if let Ok((scene, notes)) = read_glb(&bytes) {
            accepted += 1;
            untextured += u32::from(scene.images.is_empty());
            let is_fault = notes.iter().any(|n| n.message.contains("(a fault)"));
            assert!(!is_fault, "a decoder panicked: {}", lines(&notes));
        }
    }
    assert!(
        untextured > 100 && accepted > 500 && accepted < 3_900,
        "{accepted} read, {untextured} without picture"
    );
}

//! Hostile glTF: containers, JSON, accessors, graphs, references, pictures.

use std::io::Cursor;

use serde_json::{Value, json};

use super::{Case, transcript};

const HUGE: u64 = 1 << 60;

/// Bytes of little-endian floats.
fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A data URI of `bytes`.
fn uri(bytes: &[u8]) -> String {
    let body: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    format!("data:application/octet-stream,{body}")
}

/// The buffer of [`square`]: four corners, six indices, four texture coordinates.
fn buffer() -> Vec<u8> {
    let mut bytes = floats(&[0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.]);
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    bytes.extend(floats(&[0., 0., 1., 0., 1., 1., 0., 1.]));
    bytes
}

/// A square with a textured material; nothing is wrong with it.
fn square() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0, "sampler": 0}],
        "samplers": [{}],
        "images": [{"uri": uri(&png(2))}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 32},
        ],
        "buffers": [{"byteLength": 92, "uri": uri(&buffer())}],
    })
}

/// The square with `value` at a JSON pointer, whose last step may add a key or an element.
fn with(pointer: &str, value: Value) -> Value {
    let mut doc = square();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    match doc.pointer_mut(parent).unwrap_or_else(|| panic!("{parent}")) {
        Value::Array(list) => match key.parse::<usize>() {
            Ok(i) if i < list.len() => list[i] = value,
            _ => list.push(value),
        },
        Value::Object(map) => _ = map.insert(key.to_owned(), value),
        other => panic!("{other}"),
    }
    doc
}

fn case(name: &str, pointer: &str, value: Value) -> Case {
    Case::new(name, "scene.gltf", with(pointer, value).to_string())
}

/// A GLB file with these words in its header and its first chunk.
fn glb(json: &[u8], length: Option<u32>, chunk: Option<u32>, bin: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let whole = (12 + 8 + json.len() + 8 + bin.len()) as u32;
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend(length.unwrap_or(whole).to_le_bytes());
    out.extend(chunk.unwrap_or(json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend((bin.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

/// The square as GLB, with `changed` words.
fn square_glb(length: Option<u32>, chunk: Option<u32>) -> Vec<u8> {
    glb(with("/buffers/0", json!({"byteLength": 92})).to_string().as_bytes(), length, chunk, &buffer())
}

/// A picture of `side` squared pixels.
fn picture(side: u32, format: image::ImageFormat) -> Vec<u8> {
    let rgb = image::RgbImage::from_fn(side, side, |x, y| image::Rgb([(x * 7) as u8, (y * 5) as u8, 9]));
    let mut bytes = Cursor::new(Vec::new());
    rgb.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn png(side: u32) -> Vec<u8> {
    picture(side, image::ImageFormat::Png)
}

/// A PNG whose header says that it is `side` pixels wide and high.
fn png_bomb(side: u32) -> Vec<u8> {
    let mut bytes = png(2);
    bytes[16..20].copy_from_slice(&side.to_be_bytes());
    bytes[20..24].copy_from_slice(&side.to_be_bytes());
    let crc = bytes[12..29].iter().fold(!0_u32, |c, &b| {
        (0..8).fold(c ^ u32::from(b), |c, _| if c & 1 == 1 { c >> 1 ^ 0xedb8_8320 } else { c >> 1 })
    });
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    bytes
}

/// Headers and chunks that lie, and text in their place.
fn containers() -> Vec<Case> {
    let whole = square_glb(None, None);
    let glb = |name: &str, bytes: &[u8]| Case::new(name, "scene.glb", bytes);
    let mut version = whole.clone();
    version[4] = 1;
    let mut bin_first = whole.clone();
    bin_first[16..20].copy_from_slice(b"BIN\0");
    let text = |name: &str, bytes: &[u8]| Case::new(name, "scene.gltf", bytes);
    let nested = |open: &str, close: &str| (open.repeat(100_000) + &close.repeat(100_000)).into_bytes();
    vec![
        glb("GLB of no bytes", b""),
        glb("GLB of the magic alone", b"glTF"),
        glb("GLB that is text", b"hello, this is text"),
        glb("GLB whose length is 0", &square_glb(Some(0), None)),
        glb("GLB whose length is 2^32 - 1", &square_glb(Some(u32::MAX), None)),
        glb("GLB whose chunk has 2^32 - 1 bytes", &square_glb(None, Some(u32::MAX))),
        glb("GLB whose chunk has no bytes", &square_glb(None, Some(0))),
        glb("GLB of version 1", &version),
        glb("GLB without JSON", &bin_first),
        glb("GLB cut in its JSON", &whole[..400]),
        glb("GLB cut in its binary chunk", &whole[..whole.len() - 50]),
        Case::new("GLB with too short a binary chunk", "scene.glb", {
            glb_of(&with("/buffers/0", json!({"byteLength": 93})))
        }),
        text("JSON of no bytes", b""),
        text("JSON that breaks off", &square().to_string().as_bytes()[..300]),
        text("JSON that is not UTF-8", b"{\"asset\": {\"version\": \"2.0\", \"generator\": \"\xff\"}}"),
        text("JSON with 100000 arrays in each other", &nested("[", "]")),
        text("JSON with 100000 objects in each other", &nested("{\"a\":", "}")),
        text("JSON without an asset", b"{\"nodes\": []}"),
        case("glTF 3", "/asset/version", json!("3.0")),
        case("an unknown extension is required", "/extensionsRequired", json!(["VENDOR_x"])),
        case("nodes are no list", "/nodes", json!({"0": {}})),
    ]
}

fn glb_of(doc: &Value) -> Vec<u8> {
    glb(doc.to_string().as_bytes(), None, None, &buffer())
}

/// Numbers that promise more than the bytes hold.
fn accessors() -> Vec<Case> {
    let sparse = |count: u64, indices: Value, values: Value| json!({"count": count, "indices": indices, "values": values});
    let mut nan = buffer();
    nan[8..12].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut infinite = buffer();
    infinite[0..4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let mut far = buffer();
    far[48..50].copy_from_slice(&9_u16.to_le_bytes());
    let bytes = |bytes: &[u8]| json!({"byteLength": 92, "uri": uri(bytes)});
    let position = "/meshes/0/primitives/0/attributes/POSITION";
    let zeros = |count: u64| json!({"componentType": 5126, "count": count, "type": "VEC3"});
    vec![
        case("an accessor is one element too long", "/accessors/0/count", json!(5)),
        case("an accessor has 2^60 elements", "/accessors/0/count", json!(HUGE)),
        case("an accessor of zeros has 2^60 elements", "/accessors/0", zeros(HUGE)),
        case("an accessor of zeros would take 1.6 GB", "/accessors/0", zeros(1 << 27)),
        case("an accessor has -1 elements", "/accessors/0/count", json!(-1)),
        case("an accessor begins at 2^64 - 1", "/accessors/0/byteOffset", json!(u64::MAX)),
        case("a view is longer than its buffer", "/bufferViews/0/byteLength", json!(93)),
        case("a view begins at 2^64 - 1", "/bufferViews/1/byteOffset", json!(u64::MAX)),
        case("a stride of 2^63", "/bufferViews/0/byteStride", json!(1_u64 << 63)),
        case("a stride of 4 bytes for 12", "/bufferViews/0/byteStride", json!(4)),
        case("a buffer is longer than its data", "/buffers/0/byteLength", json!(HUGE)),
        case(
            "a sparse index is out of range",
            "/accessors/0/sparse",
            sparse(
                1,
                json!({"bufferView": 2, "byteOffset": 8, "componentType": 5125}),
                json!({"bufferView": 0}),
            ),
        ),
        case(
            "sparse indices overrun",
            "/accessors/0/sparse",
            sparse(4, json!({"bufferView": 1, "componentType": 5125}), json!({"bufferView": 0})),
        ),
        case(
            "sparse values overrun",
            "/accessors/0/sparse",
            sparse(4, json!({"bufferView": 1, "componentType": 5121}), json!({"bufferView": 1})),
        ),
        case(
            "more sparse values than elements",
            "/accessors/0/sparse",
            sparse(HUGE, json!({"bufferView": 1, "componentType": 5123}), json!({"bufferView": 0})),
        ),
        case("an index points behind the vertices", "/buffers/0", bytes(&far)),
        case("indices are floats", "/accessors/1/componentType", json!(5126)),
        case("positions are not numbers", "/buffers/0", bytes(&nan)),
        case("positions are infinite", "/buffers/0", bytes(&infinite)),
        case("positions are missing", position, json!(99)),
        case("positions are a negative index", position, json!(-1)),
        case("an unknown primitive mode", "/meshes/0/primitives/0/mode", json!(77)),
        case("a morph target of texture coordinates", "/meshes/0", {
            let primitive = json!({"attributes": {"POSITION": 0}, "targets": [{"POSITION": 2}]});
            json!({"primitives": [primitive], "weights": [1]})
        }),
        case("a morph weight overflows", "/meshes/0", {
            let primitive = json!({"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}]});
            json!({"primitives": [primitive], "weights": [1e39]})
        }),
    ]
}

/// Graphs that are no forest, chains, and transforms without an inverse.
fn graphs() -> Vec<Case> {
    let nodes = |name: &str, nodes: Value| {
        let mut doc = with("/nodes", nodes);
        doc["scenes"][0]["nodes"] = json!([0]);
        Case::new(name, "scene.gltf", doc.to_string())
    };
    let chain = |length: usize| {
        let node = |i: usize| if i + 1 < length { json!({"children": [i + 1]}) } else { json!({"mesh": 0}) };
        json!((0..length).map(node).collect::<Vec<_>>())
    };
    let mut scales: Vec<_> = (0..12).map(|i| json!({"scale": [1e38, 1, 1], "children": [i + 1]})).collect();
    scales.push(json!({"mesh": 0}));
    let instances = |count: u64| {
        let mut doc = with("/accessors/3", json!({"componentType": 5126, "count": count, "type": "VEC3"}));
        doc["nodes"][0]["extensions"] =
            json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 3}}});
        doc.to_string()
    };
    let mut long_name = with("/nodes", json!(vec![json!({"mesh": 0}); 20_000]));
    long_name["scenes"][0]["nodes"] = json!((0..20_000).collect::<Vec<_>>());
    long_name["meshes"][0]["name"] = json!("n".repeat(1 << 20));
    let mut square_of_objects = with("/nodes", json!(vec![json!({"mesh": 0}); 20_000]));
    let primitive = square_of_objects["meshes"][0]["primitives"][0].clone();
    square_of_objects["meshes"][0]["primitives"] = json!(vec![primitive; 20_000]);
    square_of_objects["scenes"][0]["nodes"] = json!((0..20_000).collect::<Vec<_>>());
    vec![
        nodes("a circle of nodes", json!([{"children": [1]}, {"children": [2]}, {"children": [1]}])),
        nodes("a circle apart from the scene", json!([{}, {"children": [2]}, {"children": [1]}])),
        nodes("a node is its own child", json!([{"children": [0]}])),
        nodes("two parents share a child", json!([{"children": [1, 2]}, {"children": [2]}, {}])),
        nodes("a child is listed twice", json!([{"children": [1, 1]}, {}])),
        nodes("a child is missing", json!([{"children": [7]}])),
        nodes("a chain of 2000 nodes", chain(2000)),
        nodes("a chain of 100000 nodes", chain(100_000)),
        nodes("a mesh is missing", json!([{"mesh": 7}])),
        nodes("a camera is missing", json!([{"camera": 0}])),
        nodes("scales whose product overflows", json!(scales)),
        nodes(
            "a matrix with 1e39",
            json!([{"mesh": 0, "matrix": [1e39, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]),
        ),
        nodes(
            "a matrix of zeros",
            json!([{"mesh": 0, "matrix": [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]}]),
        ),
        nodes("a matrix of three numbers", json!([{"mesh": 0, "matrix": [1, 2, 3]}])),
        nodes("a rotation of length zero", json!([{"mesh": 0, "rotation": [0, 0, 0, 0]}])),
        Case::new("20000 nodes that use a name of a megabyte", "scene.gltf", long_name.to_string()),
        Case::new("2^40 instances", "scene.gltf", instances(1 << 40)),
        Case::new("20000 nodes with 20000 primitives each", "scene.gltf", square_of_objects.to_string()),
        case("the scene is missing", "/scene", json!(4)),
        case("a root is missing", "/scenes/0/nodes", json!([8])),
    ]
}

/// References that lead out of the scene's folder, or to what is no file.
fn references() -> Vec<Case> {
    let buffer =
        |uri: &str| case(&format!("a buffer at {uri}"), "/buffers/0", json!({"byteLength": 92, "uri": uri}));
    let image = |uri: &str| case(&format!("a picture at {uri}"), "/images/0", json!({"uri": uri}));
    let mut cases: Vec<_> = [
        "../secret.bin",
        "%2e%2e/secret.bin",
        "a/../../secret.bin",
        "/etc/hostname",
        "file:///etc/hostname",
        "http://localhost/a.bin",
        "C:\\a.bin",
        "a%ff.bin",
        "a%00.bin",
        "missing.bin",
        "data:;base64,!!!!",
        ".",
    ]
    .map(buffer)
    .into();
    cases.extend(
        ["../secret.bin", "/etc/hostname", "http://localhost/a.png", "a%ff.png", ".", "scene.gltf"]
            .map(image),
    );
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        let renamed = |mut case: Case, name: &str| {
            case.name = name.to_owned();
            case
        };
        cases.push(renamed(buffer("link"), "a buffer is a link that leads outside").prepared(|folder| {
            symlink(folder.join("../secret.bin"), folder.join("link")).unwrap();
        }));
        cases.push(renamed(image("link"), "a picture is a link to a device").prepared(|folder| {
            symlink("/dev/zero", folder.join("link")).unwrap();
        }));
        cases.push(renamed(buffer("pipe"), "a buffer is a pipe").prepared(|folder| {
            let made = std::process::Command::new("mkfifo").arg(folder.join("pipe")).status();
            assert!(made.is_ok_and(|s| s.success()));
        }));
    }
    cases
}

/// Pictures that are none, break off, or are bombs; textures that refer to nothing.
fn pictures() -> Vec<Case> {
    let beside = |name: &str, content: &[u8]| {
        case(name, "/images/0", json!({"uri": "maps/a.png"})).with("maps/a.png", content)
    };
    let jpeg = picture(32, image::ImageFormat::Jpeg);
    let webp = picture(32, image::ImageFormat::WebP);
    let info = |key: &str, value: Value| {
        let mut texture = json!({"index": 0});
        texture[key] = value;
        json!({"baseColorTexture": texture})
    };
    let pbr = "/materials/0/pbrMetallicRoughness";
    let mut tga = [0; 18 + 26];
    tga[2] = 2;
    tga[12..18].copy_from_slice(&[0xff, 0xff, 0xff, 0xff, 32, 8]);
    tga[26..].copy_from_slice(b"TRUEVISION-XFILE.\0");
    let mut damaged = png(32);
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0x55;
    vec![
        beside("a picture of no bytes", b""),
        beside("a picture that is text", b"this is not a picture"),
        beside("a PNG that breaks off", &png(64)[..100]),
        beside("a PNG of its header alone", &png(2)[..33]),
        beside("a PNG with a damaged byte", &damaged),
        beside("a PNG of 60000 x 60000 pixels", &png_bomb(60_000)),
        beside("a PNG of 2^31 - 1 x 2^31 - 1 pixels", &png_bomb(i32::MAX as u32)),
        beside("a PNG of 0 x 0 pixels", &png_bomb(0)),
        beside("a PNG of 16000 x 16000 pixels in a few bytes", &png_bomb(16_000)),
        beside("a JPEG that breaks off in its header", &jpeg[..60]),
        beside("a JPEG that breaks off in its pixels", &jpeg[..jpeg.len() - 200]),
        beside("a WebP that breaks off", &webp[..webp.len() / 2]),
        beside("a TGA of 65535 x 65535 pixels", &tga),
        beside(
            "a BMP with a negative size",
            b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\xff\xff\xff\xff\0\0\0\x80\x01\0\x18\0\0\0\0\0",
        ),
        beside("an OpenEXR that breaks off", b"\x76\x2f\x31\x01\x02\0\0\0channels\0chlist\0"),
        beside(
            "a Radiance picture without pixels",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 20000\n",
        ),
        case("a picture without data", "/images/0", json!({})),
        case("a picture in a view that overruns", "/images/0", json!({"bufferView": 9})),
        case("a texture is missing", pbr, info("index", json!(5))),
        case("a texture is a negative index", pbr, info("index", json!(-5))),
        case("texture coordinates 7", pbr, info("texCoord", json!(7))),
        case("texture coordinates that are not there", pbr, info("texCoord", json!(1))),
        case(
            "a texture transform out of range",
            pbr,
            info("extensions", json!({"KHR_texture_transform": {"scale": [1e39, 0], "rotation": -1e38}})),
        ),
        case("a picture is missing", "/textures/0/source", json!(3)),
        case("a sampler is missing", "/textures/0/sampler", json!(3)),
        case("a sampler of unknown modes", "/samplers/0", json!({"wrapS": 1, "magFilter": 2})),
        case("a texture without a picture", "/textures/0", json!({})),
        case(
            "a WebP source is missing",
            "/textures/0/extensions",
            json!({"EXT_texture_webp": {"source": 8}}),
        ),
        case("a material out of range", "/materials/0", {
            json!({
                "pbrMetallicRoughness": {"baseColorFactor": [-1, 2, 1e39, 1], "roughnessFactor": -3},
                "emissiveFactor": [1e39, 0, 0], "alphaMode": "MASK", "alphaCutoff": -1,
                "normalTexture": {"index": 0, "scale": 1e39},
            })
        }),
    ]
}

#[test]
fn containers_that_lie() {
    insta::assert_snapshot!(transcript(containers()));
}

#[test]
fn accessors_that_overrun() {
    insta::assert_snapshot!(transcript(accessors()));
}

#[test]
fn graphs_that_are_no_forest() {
    insta::assert_snapshot!(transcript(graphs()));
}

#[test]
fn references_that_lead_outside() {
    insta::assert_snapshot!(transcript(references()));
}

#[test]
fn pictures_that_are_none() {
    insta::assert_snapshot!(transcript(pictures()));
}

/// The scene that all others are made from loads without a note.
#[test]
fn the_scene_itself_is_sound() {
    let json = Case::new("sound", "scene.gltf", square().to_string());
    let glb = Case::new("sound", "scene.glb", square_glb(None, None));
    assert_eq!(transcript(vec![json, glb]), "# sound\n[exit code 0]\n\n".repeat(2));
}

//! Broken and hostile files: an error that names the place, never a panic, never a big allocation.

use serde_json::{Value, json};

use super::super::super::ReadOptions;
use super::build::{SQUARE, floats, glb, read, read_glb, read_text, set, square, square_with};
use crate::math::mix64;

/// What each broken document is refused with.
#[test]
fn hostile_documents_are_refused_by_name() {
    let big = 1_u64 << 60;
    let scaled =
        |i: usize| json!({"scale": [1e38, 1, 1], "children": if i < 9 { vec![i + 1] } else { vec![] }});
    let huge: Vec<_> = (0..10).map(scaled).collect();
    let cases: Vec<(&str, Vec<(&str, Value)>)> = vec![
        ("no asset", vec![("/asset", Value::Null)]),
        ("old version", vec![("/asset/version", json!("1.0"))]),
        ("newer version", vec![("/asset/minVersion", json!("2.1"))]),
        ("count too large", vec![("/accessors/0/count", json!(big))]),
        (
            "count too large without view",
            vec![("/accessors/0", json!({"componentType": 5126, "count": big, "type": "VEC3"}))],
        ),
        ("one element too many", vec![("/accessors/0/count", json!(5))]),
        ("negative count", vec![("/accessors/0/count", json!(-1))]),
        ("offset overflows", vec![("/accessors/0/byteOffset", json!(u64::MAX))]),
        ("stride too small", vec![("/bufferViews/0/byteStride", json!(4))]),
        ("stride overflows", vec![("/bufferViews/0/byteStride", json!(u64::MAX))]),
        ("view overruns", vec![("/bufferViews/0/byteLength", json!(61))]),
        ("view overflows", vec![("/bufferViews/1/byteOffset", json!(u64::MAX))]),
        ("buffer too short", vec![("/buffers/0/byteLength", json!(61))]),
        ("buffer without data", vec![("/buffers/0", json!({"byteLength": 60}))]),
        ("absolute file", vec![("/buffers/0/uri", json!("/etc/hostname"))]),
        ("file scheme", vec![("/buffers/0/uri", json!("file:///etc/hostname"))]),
        ("parent folder", vec![("/buffers/0/uri", json!("../x.bin"))]),
        ("broken escape", vec![("/buffers/0/uri", json!("a%f"))]),
        ("broken base64", vec![("/buffers/0/uri", json!("data:;base64,?"))]),
        ("index out of range", vec![("/accessors/0/count", json!(3))]),
        ("indices of floats", vec![("/accessors/1/componentType", json!(5126))]),
        ("indices of vectors", vec![("/accessors/1/type", json!("VEC2")), ("/accessors/1/count", json!(3))]),
        ("positions of scalars", vec![("/accessors/0/type", json!("SCALAR"))]),
        ("unknown component", vec![("/accessors/0/componentType", json!(5124))]),
        ("accessor missing", vec![("/meshes/0/primitives/0/attributes/POSITION", json!(7))]),
        ("view missing", vec![("/accessors/0/bufferView", json!(7))]),
        ("buffer missing", vec![("/bufferViews/0/buffer", json!(7))]),
        ("mesh missing", vec![("/nodes/0/mesh", json!(7))]),
        ("material missing", vec![("/meshes/0/primitives/0/material", json!(7))]),
        ("camera missing", vec![("/nodes/0/camera", json!(7))]),
        ("node missing", vec![("/scenes/0/nodes", json!([7]))]),
        ("scene missing", vec![("/scene", json!(7))]),
        ("attribute of another length", vec![("/meshes/0/primitives/0/attributes/NORMAL", json!(1))]),
        (
            "cycle",
            vec![("/nodes", json!([{"children": [1]}, {"children": [0]}])), ("/scenes/0/nodes", json!([]))],
        ),
        ("own child", vec![("/nodes/0/children", json!([0]))]),
        ("shared child", vec![("/nodes", json!([{"children": [2]}, {"children": [2]}, {}]))]),
        ("child twice", vec![("/nodes", json!([{"children": [1, 1]}, {}]))]),
        ("root twice", vec![("/scenes/0/nodes", json!([0, 0]))]),
        ("root is a child", vec![("/nodes", json!([{}, {"children": [0]}]))]),
        ("infinite translation", vec![("/nodes/0/translation", json!([1e39, 0, 0]))]),
        ("rotation of length zero", vec![("/nodes/0/rotation", json!([0, 0, 0, 0]))]),
        ("product overflows", vec![("/nodes", json!(huge)), ("/scenes/0/nodes", json!([0]))]),
        (
            "perspective matrix",
            vec![("/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))],
        ),
        ("wrong type", vec![("/nodes", json!({}))]),
        ("wrong element", vec![("/nodes/0", json!(3))]),
        ("wrong mode", vec![("/meshes/0/primitives/0/mode", json!(9))]),
        (
            "sparse index",
            vec![(
                "/accessors/0/sparse",
                json!({"count": 1, "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5125}, "values": {"bufferView": 0}}),
            )],
        ),
        (
            "sparse count",
            vec![(
                "/accessors/0/sparse",
                json!({"count": big, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}),
            )],
        ),
        ("draco", vec![("/extensionsRequired", json!(["KHR_draco_mesh_compression"]))]),
        ("unknown extension", vec![("/extensionsRequired", json!(["KHR_materials_ior", "VENDOR_x"]))]),
    ];
    let said: String = cases
        .iter()
        .map(|(name, changes)| match read(&square_with(changes)) {
            Ok(_) => format!("{name}: ACCEPTED\n"),
            Err(e) => format!("{name}: {e}\n"),
        })
        .collect();
    insta::assert_snapshot!(said);
}

/// Text that is no glTF at all.
#[test]
fn hostile_texts_are_refused_by_name() {
    let nested = format!("{}{}", "[".repeat(1_000_000), "]".repeat(1_000_000));
    let cases: [&[u8]; 7] = [
        b"",
        b"{",
        b"[]",
        b"{\"asset\": {\"version\": \"2.0\"",
        b"\xff\xfe{}",
        b"{\"a\": 1e999}",
        nested.as_bytes(),
    ];
    let said: Vec<_> =
        cases.iter().map(|text| read_text(text, &ReadOptions::default()).unwrap_err().to_string()).collect();
    insta::assert_snapshot!(said.join("\n"), @r#"
    test.gltf: line 1 column 0 of the JSON text: found a fault (EOF while parsing a value), expected JSON
    test.gltf: line 1 column 1 of the JSON text: found a fault (EOF while parsing an object), expected JSON
    test.gltf: JSON text: found an array, expected an object
    test.gltf: line 1 column 27 of the JSON text: found a fault (EOF while parsing an object), expected JSON
    test.gltf: byte 0 of the JSON text: found an invalid sequence, expected UTF-8
    test.gltf: line 1 column 11 of the JSON text: found a fault (number out of range), expected JSON
    test.gltf: line 1 column 128 of the JSON text: found a fault (recursion limit exceeded), expected JSON
    "#);
}

/// Positions that are not finite cannot be repaired.
#[test]
fn positions_that_are_not_finite_are_refused() {
    let mut doc = square();
    let mut positions = floats(&SQUARE);
    positions[8..12].copy_from_slice(&f32::NAN.to_le_bytes());
    set(&mut doc, "/buffers/0/uri", json!(super::build::uri(&[positions, vec![0; 12]].concat())));
    insta::assert_snapshot!(read(&doc).unwrap_err().to_string(), @r#"
    test.gltf: meshes[0].primitives[0].attributes.POSITION: found [0, 0, NaN] as element 0, expected finite numbers
    "#);
}

/// Limits hold for what many small accessors ask for together.
#[test]
fn limits_are_limits() {
    let options =
        |max_bytes, max_triangles| ReadOptions { max_bytes, max_triangles, ..ReadOptions::default() };
    let refuse = |o| super::build::read_as(&square(), &o).unwrap_err().to_string();
    insta::assert_snapshot!(refuse(options(60, 9)), @r#"
    test.gltf: nodes[0]: a file that needs more than 60 bytes is not supported; raise the limit if the file is trusted
    "#);
    insta::assert_snapshot!(refuse(options(1 << 20, 1)), @r#"
    test.gltf: meshes[0].primitives[0]: a file of more than 1 triangles is not supported; raise the limit if the file is trusted
    "#);
    assert!(super::build::read_as(&square(), &options(1 << 20, 2)).is_ok());
    let lists = (60..1000).filter(|&bytes| {
        let result = super::build::read_as(&square(), &options(bytes, 2));
        result.is_err_and(|e| e.to_string().contains("accessors["))
    });
    assert_eq!(lists.count(), 48 + 24, "what the two accessors take");
}

fn small_glb() -> Vec<u8> {
    let mut doc = square();
    let mut bin = floats(&SQUARE);
    bin.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()));
    doc["buffers"][0] = json!({"byteLength": bin.len()});
    glb(&doc, &bin)
}

#[test]
fn a_glb_gives_the_same_scene_as_its_json() {
    let (from_glb, notes) = read_glb(&small_glb()).unwrap();
    assert_eq!((from_glb, notes), read(&square()).unwrap());
}

/// A truncated file is an error at every length.
#[test]
fn every_prefix_of_a_glb_is_an_error() {
    let whole = small_glb();
    for length in 0..whole.len() {
        assert!(read_glb(&whole[..length]).is_err(), "{length} of {} bytes", whole.len());
    }
}

/// A prefix whose header claims to be whole gets further, and still ends in an error.
#[test]
fn every_prefix_with_a_corrected_length_is_an_error() {
    let whole = small_glb();
    for length in 12..whole.len() {
        let mut prefix = whole[..length].to_vec();
        prefix[8..12].copy_from_slice(&(length as u32).to_le_bytes());
        assert!(read_glb(&prefix).is_err(), "{length} of {} bytes", whole.len());
    }
}

/// Random damage ends in a scene or in an error; the limit of 1 MiB keeps allocations small.
#[test]
fn damaged_files_never_panic() {
    let whole = small_glb();
    let mut accepted = 0;
    for round in 0..20_000_u64 {
        let mut bytes = whole.clone();
        for hit in 0..=round % 3 {
            let r = mix64(round * 4 + hit);
            let at = (r >> 32) as usize % bytes.len();
            // Flipped bits, and digits that grow numbers within the JSON.
            bytes[at] = if r & 8 == 0 { bytes[at] ^ 1 << (r & 7) } else { b'0' + (r >> 8 & 7) as u8 };
        }
        accepted += u32::from(read_glb(&bytes).is_ok());
    }
    assert!((500..19_500).contains(&accepted), "the damage is neither void nor total: {accepted}");
}

//! Files become a [`Scene`] and notes.
//!
//! In: a path and [`ReadOptions`]. Out: a scene in this crate's conventions, and a [`Note`] for
//! whatever was ignored, repaired or assumed. A file is untrusted: every count in it is checked in
//! 64-bit arithmetic against the bytes that are there before anything is allocated, no reference
//! leaves the scene's folder, and no input makes a reader panic, recurse without bound, or wait.
//!
//! Winding: a transform of negative determinant is kept as it is, and triangles keep the order of the
//! file. `prepare` flips the winding of such objects, so that the front stays the front.

mod budget;
mod error;
mod file;
mod gltf;
mod names;
mod obj;
mod picture;
mod text;

use std::path::Path;

use crate::scene::text::Syntax;
use crate::scene::{Note, Scene, notes};

use budget::Budget;
use error::Fault;
pub use error::ImportError;

/// How to read a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// What the intensities of glTF's punctual lights mean.
    pub light_units: LightUnits,
    /// Most triangles that a file may hold, instances not counted.
    pub max_triangles: u64,
    /// Most bytes that a file, with the files it names and what is decoded from them, may take.
    pub max_bytes: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { light_units: LightUnits::Auto, max_triangles: 1 << 28, max_bytes: 4 << 30 }
    }
}

/// What the intensities of glTF's punctual lights mean; the modes of Blender's exporter by name.
///
/// Watts out: the exporter multiplies by 683 lm/W in its standard mode, and a path tracer that also
/// renders emissive materials has to undo that, since those are written without it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LightUnits {
    /// `BlenderSpec` where the generator is Blender's exporter, else `Unitless`.
    #[default]
    Auto,
    /// Candela and lux at 683 lm/W ("Standard", the exporter's default): divided by 683.
    BlenderSpec,
    /// W/sr and W/m^2, as is ("Unitless").
    Unitless,
    /// Point and spot lights in watts over the whole sphere, divided by 4 pi; suns as is ("Raw").
    Raw,
}

/// Reads the scene in the file at `path`, by its content and suffix.
///
/// # Errors
/// A file that cannot be read, contradicts its format, or needs what is not supported; the error names
/// the file, the place in it, what was found and what was expected.
pub fn read(path: &Path, options: &ReadOptions) -> Result<(Scene, Vec<Note>), ImportError> {
    read_file(path, options).map_err(|fault| fault.at(path))
}

fn read_file(path: &Path, options: &ReadOptions) -> Result<(Scene, Vec<Note>), Fault> {
    let suffix = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let mut budget = Budget::new(options);
    let folder = path.parent().unwrap_or(Path::new(""));
    let known = ["gltf", "glb", "json", "obj", "toml"].contains(&&*suffix);
    let bytes = file::read_regular(path, &mut budget)?;
    if bytes.starts_with(gltf::GLB_MAGIC) || suffix == "glb" {
        return gltf::read_glb(&bytes, folder, options, &mut budget);
    }
    if !known {
        return Err(Fault::Unsupported {
            place: "suffix".into(),
            feature: if suffix.is_empty() { "a file without a suffix".into() } else { format!(".{suffix}") },
            help: "readable are .gltf and .glb (glTF 2.0), .obj, and .toml and .json with the key `epsilux`"
                .into(),
        });
    }
    match &*suffix {
        "obj" => obj::read(&bytes, path, &mut budget),
        "toml" => text::read(bytes, Syntax::Toml, folder, &mut budget),
        "json" if !text::is_gltf(&bytes) => text::read(bytes, Syntax::Json, folder, &mut budget),
        _ => gltf::read_json(&bytes, folder, options, &mut budget),
    }
}

/// The scene in the JSON of a glTF file that needs no other files; `None` where it is none.
pub(crate) fn read_gltf(text: &[u8]) -> Option<Scene> {
    let options = ReadOptions::default();
    let read = gltf::read_json(text, Path::new(""), &options, &mut Budget::new(&options));
    read.ok().map(|(scene, _)| scene)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// Content comes before suffix, and what cannot be read is refused with what can.
    #[test]
    fn files_are_told_apart_and_refused_by_name() {
        let dir = tempfile::tempdir().unwrap();
        let glb = include_bytes!("../../fixtures/blender/still-life.glb");
        let files: [(&str, &[u8]); 12] = [
            ("misnamed.blend", glb),
            ("misnamed.gltf", glb),
            ("cut.glb", &glb[..1000]),
            ("text.glb", b"hello, this is text"),
            ("empty.glb", b""),
            ("scene.blend", b"BLENDER"),
            ("scene", b"?"),
            ("empty.gltf", b""),
            ("gltf.json", b"{\"asset\": {\"version\": \"2.0\"}}"),
            ("scene.json", b"{\"epsilux\": 1, \"asset\": 2}"),
            ("scene.toml", b"epsilux = 1\nobjct = 2"),
            ("latin1.toml", b"epsilux = 1 # \xe9"),
        ];
        let mut said = String::new();
        for (name, content) in files {
            let path = dir.path().join(name);
            fs::write(&path, content).unwrap();
            let line = match read(&path, &ReadOptions::default()) {
                Ok((scene, _)) => format!("{name}: {} objects", scene.objects.len()),
                Err(e) => e.to_string().replace(&*dir.path().to_string_lossy(), "DIR"),
            };
            said += &(line + "\n");
        }
        for name in ["missing.glb", "folder.glb"] {
            fs::create_dir_all(dir.path().join("folder.glb")).unwrap();
            let e = read(&dir.path().join(name), &ReadOptions::default()).unwrap_err();
            said += &(e.to_string().replace(&*dir.path().to_string_lossy(), "DIR") + "\n");
        }
        insta::assert_snapshot!(said, @r#"
        misnamed.blend: 19 objects
        misnamed.gltf: 19 objects
        DIR/cut.glb: header.length: found 255788, though the file has 1000 bytes, expected the length of the file (is it truncated?)
        DIR/text.glb: header.magic: found [68, 65, 6c, 6c], expected "glTF"
        DIR/empty.glb: header: found 0 bytes, expected at least 12
        DIR/scene.blend: suffix: .blend is not supported; readable are .gltf and .glb (glTF 2.0), .obj, and .toml and .json with the key `epsilux`
        DIR/scene: suffix: a file without a suffix is not supported; readable are .gltf and .glb (glTF 2.0), .obj, and .toml and .json with the key `epsilux`
        DIR/empty.gltf: line 1 column 0 of the JSON text: found a fault (EOF while parsing a value), expected JSON
        gltf.json: 0 objects
        DIR/scene.json: line 1, column 16: unknown key `asset`; expected one of `$schema`, `epsilux`, `title`, `up`, `render`, `camera`, `image`, `material`, `mesh`, `object`, `light`, `environment`
        DIR/scene.toml: line 2, column 1: unknown key `objct`; did you mean `object`?
        DIR/latin1.toml: byte 14: found an invalid sequence, expected UTF-8
        DIR/missing.glb: no such file
        DIR/folder.glb: found a folder, expected a file
        "#);
    }

    /// A pipe would wait for its writer for ever, and a device may never end.
    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_before_they_are_opened() {
        let dir = tempfile::tempdir().unwrap();
        let pipe = dir.path().join("pipe.glb");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.is_ok_and(|s| s.success()));
        for path in [&*pipe, Path::new("/dev/zero")] {
            let error = read(path, &ReadOptions::default()).unwrap_err().to_string();
            assert!(error.ends_with("expected a regular file"), "{error}");
        }
    }

    /// Buffers may lie in files beside the scene, with %-escapes in their names.
    #[test]
    fn external_buffers_are_read() {
        let dir = tempfile::tempdir().unwrap();
        let text = r#"{"asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": "data/a%20b.bin"}]}"#;
        let path = dir.path().join("scene.gltf");
        fs::write(&path, text).unwrap();
        let missing = read(&path, &ReadOptions::default()).unwrap_err().to_string();
        assert!(missing.ends_with("data/a b.bin: no such file (buffers[0].uri names it)"), "{missing}");
        fs::create_dir(dir.path().join("data")).unwrap();
        fs::write(dir.path().join("data/a b.bin"), [1; 36]).unwrap();
        assert_eq!(read(&path, &ReadOptions::default()).unwrap().0.objects.len(), 1);
    }
}

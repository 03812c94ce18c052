//! What a scene holds, in numbers.
//!
//! In: a valid scene. Out: counts, bounds and area in world space; nothing is rendered.

use std::fmt;

use glam::DVec3;
use serde::Serialize;

use crate::scene::{Image, Mesh, Object, Scene, Shape};

/// What a scene holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inventory {
    /// The scene's title.
    pub title: String,
    /// Shapes placed in the world.
    pub objects: usize,
    /// Triangles in the world, instances counted each.
    pub triangles: u64,
    /// Triangles kept in memory, shared meshes counted once.
    pub triangles_stored: u64,
    /// Exact spheres in the world.
    pub spheres: usize,
    /// Meshes.
    pub meshes: usize,
    /// Pictures that textures and the environment use.
    pub images: Vec<ImageSize>,
    /// What the scene takes in memory.
    pub memory_bytes: Memory,
    /// Names of the materials.
    pub materials: Vec<String>,
    /// Objects whose material emits.
    pub emitters: usize,
    /// Names of the lights that are not surfaces.
    pub lights: Vec<String>,
    /// Name of the environment.
    pub environment: Option<String>,
    /// Names of the cameras; the first is used where none is asked for.
    pub cameras: Vec<String>,
    /// Lowest and highest corner of all objects, metres; none where there is no object.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Surface of all objects, square metres.
    pub area: f64,
    /// Width and height that the author asks for, pixels.
    pub size: Option<[u32; 2]>,
    /// Samples per pixel that the author asks for.
    pub samples: Option<u32>,
}

/// A picture of a scene.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ImageSize {
    /// Its name, which need not be unique.
    pub name: String,
    /// Where it lies, relative to the scene's file; none where the scene's file holds it.
    pub file: Option<String>,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// What its decoded texels take in memory.
    pub bytes: u64,
}

/// Bytes of memory, by what takes them; each shared mesh and picture counts once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Memory {
    /// Vertices and triangles, without what a render builds over them.
    pub meshes: u64,
    /// Decoded texels.
    pub images: u64,
}

/// Counts what a scene holds.
#[must_use]
pub fn inventory(scene: &Scene) -> Inventory {
    let images: Vec<_> = scene.images.iter().map(image_size).collect();
    let memory_bytes = Memory {
        meshes: scene.meshes.iter().map(mesh_bytes).sum(),
        images: images.iter().map(|i| i.bytes).sum(),
    };
    let mut result = Inventory {
        title: scene.title.clone(),
        objects: scene.objects.len(),
        triangles: 0,
        triangles_stored: scene.meshes.iter().map(|m| m.triangles.len() as u64).sum(),
        spheres: 0,
        meshes: scene.meshes.len(),
        images,
        memory_bytes,
        materials: scene.materials.iter().map(|m| m.name.clone()).collect(),
        emitters: 0,
        lights: scene.lights.iter().map(|l| l.name.clone()).collect(),
        environment: scene.environment.as_ref().map(|e| e.name.clone()),
        cameras: scene.cameras.iter().map(|c| c.name.clone()).collect(),
        bounds: None,
        area: 0.0,
        size: scene.settings.size,
        samples: scene.settings.spp,
    };
    let mut bounds = Bounds::EMPTY;
    for object in &scene.objects {
        result.emitters += usize::from(scene.materials[object.material.0 as usize].kind.emission().is_some());
        match object.shape {
            Shape::Sphere { radius } => {
                result.spheres += 1;
                result.area += sphere(object, radius, &mut bounds);
            }
            Shape::Mesh(id) => {
                let mesh = &scene.meshes[id.0 as usize];
                result.triangles += mesh.triangles.len() as u64;
                let at = |i: u32| object.transform.transform_point3(mesh.positions[i as usize].as_dvec3());
                for corners in &mesh.triangles {
                    let [a, b, c] = corners.map(at);
                    [a, b, c].into_iter().for_each(|p| bounds.add(p));
                    result.area += 0.5 * (b - a).cross(c - a).length();
                }
            }
        }
    }
    result.bounds = (bounds.low.x <= bounds.high.x).then(|| [bounds.low.to_array(), bounds.high.to_array()]);
    result
}

fn image_size(image: &Image) -> ImageSize {
    let pixels = image.pixels.as_deref();
    ImageSize {
        name: image.name.clone(),
        file: image.file.clone(),
        width: pixels.map_or(0, |p| p.width),
        height: pixels.map_or(0, |p| p.height),
        bytes: pixels.map_or(0, |p| p.texels.bytes() as u64),
    }
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let lists = [
        size_of_val(&*mesh.positions),
        size_of_val(&*mesh.normals),
        size_of_val(&*mesh.tangents),
        size_of_val(&*mesh.uvs[0]),
        size_of_val(&*mesh.uvs[1]),
        size_of_val(&*mesh.colors),
        size_of_val(&*mesh.triangles),
    ];
    lists.map(|bytes| bytes as u64).iter().sum()
}

struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn add(&mut self, p: DVec3) {
        self.low = self.low.min(p);
        self.high = self.high.max(p);
    }
}

/// Area of a sphere, whose transform scales uniformly.
fn sphere(object: &Object, radius: f64, bounds: &mut Bounds) -> f64 {
    let r = radius * object.transform.matrix3.x_axis.length();
    let centre = object.transform.translation;
    bounds.add(centre - r);
    bounds.add(centre + r);
    4.0 * std::f64::consts::PI * r * r
}

impl fmt::Display for Inventory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |name: &str, value: String| writeln!(f, "{name:<14}{value}");
        if !self.title.is_empty() {
            row("title", self.title.clone())?;
        }
        row("objects", self.objects.to_string())?;
        let shared = match self.triangles_stored {
            stored if stored == self.triangles => String::new(),
            stored => format!(" ({stored} stored)"),
        };
        row("triangles", format!("{}{shared}", self.triangles))?;
        row("spheres", self.spheres.to_string())?;
        row("emitters", self.emitters.to_string())?;
        row("lights", list(&self.lights))?;
        row("environment", self.environment.clone().unwrap_or_else(|| "none".into()))?;
        row("materials", list(&self.materials))?;
        if !self.images.is_empty() {
            let name = |i: &ImageSize| format!("{} ({}x{})", i.name, i.width, i.height);
            row("images", list(&self.images.iter().map(name).collect::<Vec<_>>()))?;
        }
        let Memory { meshes, images } = self.memory_bytes;
        row("memory", format!("{} MB of meshes, {} MB of images", megabytes(meshes), megabytes(images)))?;
        row("cameras", list(&self.cameras))?;
        if let Some([low, high]) = self.bounds {
            let extent = |i: usize| short(high[i] - low[i]);
            row("extent", format!("{} x {} x {} m", extent(0), extent(1), extent(2)))?;
            let corner = |c: [f64; 3]| c.map(short).join(", ");
            row("bounds", format!("({}) to ({})", corner(low), corner(high)))?;
        }
        row("area", format!("{} m^2", short(self.area)))?;
        if let Some([w, h]) = self.size {
            row("size", format!("{w}x{h}"))?;
        }
        if let Some(samples) = self.samples {
            row("samples", samples.to_string())?;
        }
        Ok(())
    }
}

/// A count and the first few names.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 8;
    if names.is_empty() {
        return "none".into();
    }
    let shown = names.iter().take(SHOWN).cloned().collect::<Vec<_>>().join(", ");
    let more = if names.len() > SHOWN { ", .." } else { "" };
    format!("{}: {shown}{more}", names.len())
}

/// Millions of bytes, to three significant digits where they are few.
fn megabytes(bytes: u64) -> String {
    let mb = bytes as f64 / 1e6;
    match mb {
        0.0 => "0".into(),
        _ if mb < 0.01 => "<0.01".into(),
        _ if mb < 10.0 => format!("{mb:.2}"),
        _ if mb < 100.0 => format!("{mb:.1}"),
        _ => format!("{mb:.0}"),
    }
}

/// Five significant digits, without zeros at the end.
fn short(v: f64) -> String {
    if v == 0.0 {
        return "0".into();
    }
    let digits = (4 - libm::floor(libm::log10(v.abs())) as i32).max(0);
    if digits > 9 {
        return format!("{v:.4e}");
    }
    let text = format!("{v:.*}", digits as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The report's room by hand: 10 m high, and a sphere of radius 1.5 has 9 pi square metres.
    #[test]
    fn hexroom() {
        let (scene, _) = crate::scene::text::parse(include_str!("../../scenes/hexroom.toml")).unwrap();
        let inventory = inventory(&scene);
        assert_eq!((inventory.spheres, inventory.emitters), (4, 1));
        let [low, high] = inventory.bounds.unwrap();
        assert!((high[1] - low[1] - 10.0).abs() < 1e-6, "up is y: {low:?} {high:?}");
        insta::assert_snapshot!(inventory);
    }

    /// Shared meshes and pictures count once, and every list of a mesh counts.
    #[test]
    fn memory_is_that_of_what_is_stored() {
        use std::sync::Arc;

        use glam::{DAffine3, Vec2, Vec3};

        use crate::scene::{Image, Material, MaterialId, MaterialKind, MeshId, Pixels, Texels};

        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: [vec![Vec2::ZERO; 3], Vec::new()],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let object = Object {
            name: String::new(),
            shape: Shape::Mesh(MeshId(0)),
            material: MaterialId(0),
            transform: DAffine3::IDENTITY,
            visible_to_camera: true,
        };
        let pixels = Pixels { width: 3, height: 2, texels: Texels::Byte(vec![[0; 4]; 6]) };
        let kind = MaterialKind::Principled(Box::default());
        let scene = Scene {
            meshes: vec![mesh],
            objects: vec![object.clone(), object],
            materials: vec![Material { name: "m".into(), kind }],
            images: vec![Image {
                name: "wood".into(),
                file: Some("maps/wood.png".into()),
                encoded: None,
                pixels: Some(Arc::new(pixels)),
            }],
            ..Scene::default()
        };
        let inventory = inventory(&scene);
        assert_eq!(inventory.memory_bytes, Memory { meshes: 3 * 12 + 3 * 8 + 12, images: 24 });
        assert!(inventory.to_string().contains("1: wood (3x2)"), "{inventory}");
        let json = serde_json::to_value(&inventory).unwrap();
        assert_eq!(json["images"][0]["file"], "maps/wood.png");
        assert_eq!(json["memory_bytes"], serde_json::json!({"meshes": 72, "images": 24}));
        let sizes = [0, 1, 123_456, 45_678_901, 1_234_567_890].map(megabytes);
        assert_eq!(sizes, ["0", "<0.01", "0.12", "45.7", "1235"]);
    }

    #[test]
    fn numbers_are_short() {
        for (v, expected) in
            [(0.0, "0"), (10.0, "10"), (1234567.0, "1234567"), (-0.1, "-0.1"), (1e-7, "1.0000e-7")]
        {
            assert_eq!(short(v), expected);
        }
    }

    #[test]
    fn an_empty_scene_has_no_bounds() {
        assert_eq!(inventory(&Scene::default()).bounds, None);
    }
}

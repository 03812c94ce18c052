//! What a scene holds, in numbers.
//!
//! In: a valid scene. Out: counts, bounds and area in world space; nothing is rendered.

use std::fmt;

use glam::DVec3;
use serde::Serialize;

use crate::scene::{Object, Scene, Shape};

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

/// Counts what a scene holds.
#[must_use]
pub fn inventory(scene: &Scene) -> Inventory {
    let mut result = Inventory {
        title: scene.title.clone(),
        objects: scene.objects.len(),
        triangles: 0,
        triangles_stored: scene.meshes.iter().map(|m| m.triangles.len() as u64).sum(),
        spheres: 0,
        meshes: scene.meshes.len(),
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

//! Compares two scenes by what they show: order, names of meshes and sharing do not count.

use std::fmt::Debug;
use std::hash::{DefaultHasher, Hash, Hasher};

use epsilux::glam::{DMat3, DVec3, Vec2};
use epsilux::scene::{
    Channel, Environment, Image, ImageId, MaterialKind, Mesh, Note, Object, ScalarTexture, Scene, Shape,
    Texels, Textures,
};

/// The channels of a colour.
const RGB: [usize; 3] = [0, 1, 2];

/// How well a format keeps numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Held {
    /// Bit for bit.
    Exactly,
    /// As singles: 1e-5 of the scene's size for places, 1e-5 of area and of each number.
    InSingles,
}

impl Held {
    fn tolerance(self) -> f64 {
        match self {
            Self::Exactly => 0.0,
            Self::InSingles => 1e-5,
        }
    }
}

/// What is different and not excused by a note about it. Each begins with its aspect.
pub(super) fn differences(
    a: &Scene,
    b: &Scene,
    notes: &[Note],
    held: Held,
) -> impl Iterator<Item = String> + use<> {
    let mut found: Vec<(String, &[&str])> = Vec::new();
    let tolerance = held.tolerance();
    objects(a, b, notes, tolerance, &mut found);
    let all = !notes.iter().any(|n| n.code == "material-unused");
    let textured = !notes.iter().any(|n| n.code == "texture-lost");
    let list = |s| materials(s, all, textured);
    by_name("material", list(a), list(b), tolerance, &["material-changed"], &mut found);
    // Lights need no unique names; their order is kept.
    let lights = |s: &Scene| s.lights.iter().enumerate().map(|(i, l)| (i.to_string(), written(l))).collect();
    by_name("light", lights(a), lights(b), tolerance, &["light-lost"], &mut found);
    let cameras = |s: &Scene| s.cameras.iter().map(|c| (c.name.clone(), written(c))).collect();
    by_name("camera", cameras(a), cameras(b), tolerance, &["camera-lost"], &mut found);
    if a.cameras.first().map(|c| &c.name) != b.cameras.first().map(|c| &c.name) {
        found.push(("camera: another one is the first".into(), &[]));
    }
    let environment = |s: &Scene| written(&s.environment.as_ref().map(|e| sky(s, e)));
    one("environment", &environment(a), &environment(b), tolerance, &["texture-lost"], &mut found);
    one("settings", &written(&a.settings), &written(&b.settings), tolerance, &[], &mut found);
    one("title", &a.title, &b.title, 0.0, &["title-lost"], &mut found);
    let excused = |codes: &[&str]| notes.iter().any(|n| codes.contains(&n.code));
    let left: Vec<String> = found.into_iter().filter(|(_, codes)| !excused(codes)).map(|(d, _)| d).collect();
    left.into_iter()
}

fn written(value: &impl Debug) -> String {
    format!("{value:?}")
}

type Found<'a> = Vec<(String, &'a [&'a str])>;

fn one<'a>(aspect: &str, a: &str, b: &str, tolerance: f64, codes: &'a [&'a str], found: &mut Found<'a>) {
    if !close(a, b, tolerance) {
        found.push((format!("{aspect}: {a}\n    became {b}"), codes));
    }
}

fn by_name<'a>(
    aspect: &str,
    a: Vec<(String, String)>,
    b: Vec<(String, String)>,
    tolerance: f64,
    codes: &'a [&'a str],
    found: &mut Found<'a>,
) {
    for (name, value) in &a {
        match b.iter().find(|(n, _)| n == name) {
            Some((_, other)) => one(&format!("{aspect} {name}"), value, other, tolerance, codes, found),
            None => found.push((format!("{aspect} {name}: is not there any more"), codes)),
        }
    }
    for (name, _) in b.iter().filter(|(n, _)| !a.iter().any(|(name, _)| name == n)) {
        found.push((format!("{aspect} {name}: is new"), codes));
    }
}

/// Whether two texts are the same but for the last digits of their numbers.
fn close(a: &str, b: &str, tolerance: f64) -> bool {
    if a == b {
        return true;
    }
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '.' | '-' | '_');
    let tokens = |s: &str| -> Vec<String> {
        let mut list: Vec<String> = vec![String::new()];
        for c in s.chars() {
            if is_part(c) {
                list.last_mut().unwrap().push(c);
            } else {
                list.extend([c.to_string(), String::new()]);
            }
        }
        list
    };
    let (a, b) = (tokens(a), tokens(b));
    a.len() == b.len()
        && a.iter().zip(&b).all(|(a, b)| {
            a == b
                || match (a.parse::<f64>(), b.parse::<f64>()) {
                    // What is next to nothing may become nothing: sines of half a turn.
                    (Ok(a), Ok(b)) => (a - b).abs() <= tolerance * a.abs().max(b.abs()).max(0.01),
                    _ => false,
                }
        })
}

/// Every material by name, or every one that is used, with or without its textures, with the content of pictures in place of their numbers.
fn materials(s: &Scene, all: bool, textured: bool) -> Vec<(String, String)> {
    let used = |i: usize| s.objects.iter().any(|o| o.material.0 as usize == i);
    let kind = |kind: &MaterialKind| {
        let mut kind = kind.clone();
        if let MaterialKind::Principled(p) = &mut kind {
            if !textured {
                p.textures = Textures::default();
            }
            // glTF has one picture for both: the other comes back with a channel that changes nothing.
            for (slot, factor) in
                [(&mut p.textures.metallic, p.metallic), (&mut p.textures.roughness, p.roughness)]
            {
                *slot = slot.filter(|t| factor != 0.0 && !is_full(t, &s.images));
            }
            name_pictures(&mut p.textures, &s.images);
        }
        written(&kind)
    };
    let list = s.materials.iter().enumerate().filter(|(i, _)| all || used(*i));
    list.map(|(_, m)| (m.name.clone(), kind(&m.kind))).collect()
}

fn sky(s: &Scene, e: &Environment) -> Environment {
    let mut e = e.clone();
    if let Some(image) = &mut e.image {
        image.image = content(image.image, &s.images, &RGB);
    }
    e
}

fn name_pictures(t: &mut Textures, images: &[Image]) {
    for t in
        [&mut t.base_color, &mut t.emission, &mut t.specular_color, &mut t.sheen_color].into_iter().flatten()
    {
        t.image = content(t.image, images, &RGB);
    }
    let scalars = [
        &mut t.alpha,
        &mut t.metallic,
        &mut t.roughness,
        &mut t.specular,
        &mut t.transmission,
        &mut t.coat,
        &mut t.coat_roughness,
        &mut t.sheen_roughness,
    ];
    for t in scalars.into_iter().flatten() {
        t.texture.image = content(t.texture.image, images, &[index(t.channel)]);
        // Which one it is does not matter: formats put several numbers into one picture.
        t.channel = Channel::R;
    }
    for t in [&mut t.normal, &mut t.coat_normal].into_iter().flatten() {
        t.texture.image = content(t.texture.image, images, &RGB);
    }
}

/// Whether a channel is one everywhere.
fn is_full(t: &ScalarTexture, images: &[Image]) -> bool {
    let channel = index(t.channel);
    match &images[t.texture.image.0 as usize].pixels.as_ref().unwrap().texels {
        Texels::Byte(texels) => texels.iter().all(|t| t[channel] == u8::MAX),
        Texels::Short(texels) => texels.iter().all(|t| t[channel] == u16::MAX),
        Texels::Float(texels) => texels.iter().all(|t| t.get(channel).is_none_or(|&v| v == 1.0)),
    }
}

fn index(channel: Channel) -> usize {
    match channel {
        Channel::R => 0,
        Channel::G => 1,
        Channel::B => 2,
        Channel::A => 3,
    }
}

/// A number that stands for what these channels of a picture show.
fn content(id: ImageId, images: &[Image], channels: &[usize]) -> ImageId {
    let mut hasher = DefaultHasher::new();
    let pixels = images[id.0 as usize].pixels.as_ref().unwrap();
    (pixels.width, pixels.height).hash(&mut hasher);
    for &c in channels {
        match &pixels.texels {
            // A byte is as much as the short of the same share.
            Texels::Byte(t) => t.iter().for_each(|t| (u16::from(t[c]) * 257).hash(&mut hasher)),
            Texels::Short(t) => t.iter().for_each(|t| t[c].hash(&mut hasher)),
            Texels::Float(t) => t.iter().for_each(|t| t.get(c).map(|v| v.to_bits()).hash(&mut hasher)),
        }
    }
    ImageId(hasher.finish() as u32)
}

/// What is seen of an object, without its name, its mesh and its place in the list.
#[derive(Clone, Debug)]
struct Print {
    material: String,
    visible: bool,
    triangles: usize,
    /// Zero for a mesh.
    radius: f64,
    area: f64,
    /// The middle of its surface.
    middle: DVec3,
    /// Area vectors of its front, added up.
    front: DVec3,
    /// Mean over its surface of normals, texture coordinates and colours, where it has them.
    normal: Option<DVec3>,
    uvs: [Option<DVec3>; 2],
    color: Option<[f64; 4]>,
}

fn print(s: &Scene, o: &Object) -> Print {
    let material = s.materials[o.material.0 as usize].name.clone();
    let scale = o.transform.matrix3.x_axis.length();
    let empty = Print {
        material,
        visible: o.visible_to_camera,
        triangles: 0,
        radius: 0.0,
        area: 0.0,
        middle: o.transform.translation,
        front: DVec3::ZERO,
        normal: None,
        uvs: [None; 2],
        color: None,
    };
    match o.shape {
        Shape::Sphere { radius } => Print { radius: radius * scale, ..empty },
        Shape::Mesh(id) => print_mesh(&s.meshes[id.0 as usize], o, empty),
    }
}

fn print_mesh(mesh: &Mesh, o: &Object, empty: Print) -> Print {
    let mut p = Print { triangles: mesh.triangles.len(), middle: DVec3::ZERO, ..empty };
    let m = o.transform.matrix3;
    let side = m.determinant().signum();
    let turn = m.inverse().transpose();
    // Sum over corners, each with a third of its triangle's area.
    let mut sums: [DVec3; 5] = [DVec3::ZERO; 5];
    let mut alpha = 0.0;
    for t in &mesh.triangles {
        let corners = t.map(|i| o.transform.transform_point3(mesh.positions[i as usize].as_dvec3()));
        let [a, b, c] = corners;
        let vector = (b - a).cross(c - a) * 0.5;
        let area = vector.length();
        p.area += area;
        p.front += vector * side;
        p.middle += (a + b + c) / 3.0 * area;
        for i in t.map(|i| i as usize) {
            let third = area / 3.0;
            sums[0] += mesh.normals.get(i).map_or(DVec3::ZERO, |n| upright(turn, n.as_dvec3())) * third;
            for (sum, set) in sums[1..3].iter_mut().zip(&mesh.uvs) {
                *sum += set.get(i).map_or(DVec3::ZERO, |uv| uv.as_dvec2().extend(0.0)) * third;
            }
            sums[3] += mesh.colors.get(i).map_or(DVec3::ZERO, |c| c.truncate().as_dvec3()) * third;
            alpha += mesh.colors.get(i).map_or(0.0, |c| f64::from(c.w)) * third;
        }
    }
    let over = |sum: DVec3| sum / p.area.max(1e-300);
    p.middle = over(p.middle);
    let seen = p.triangles > 0;
    p.normal = (seen && !mesh.normals.is_empty()).then(|| over(sums[0]));
    // Zeros say nothing either: a set that is asked for and not there is written as zeros.
    let has = |k: usize| mesh.uvs[k].iter().any(|uv| *uv != Vec2::ZERO);
    p.uvs = [0, 1].map(|k| (seen && has(k)).then(|| over(sums[1 + k])));
    // White says nothing: some formats want a colour everywhere or nowhere.
    let white = mesh.colors.iter().all(|c| c.to_array() == [1.0; 4]);
    let color = over(sums[3]);
    p.color = (seen && !white).then(|| [color.x, color.y, color.z, alpha / p.area.max(1e-300)]);
    p
}

fn upright(turn: DMat3, n: DVec3) -> DVec3 {
    (turn * n).normalize_or_zero()
}

/// Finds for each object of `a` one of `b` that looks the same.
fn objects<'a>(a: &Scene, b: &Scene, notes: &[Note], tolerance: f64, found: &mut Found<'a>) {
    let said = |code: &str| notes.iter().any(|n| n.code == code);
    let prints = |s: &Scene| -> Vec<Print> {
        let mut list: Vec<Print> = s.objects.iter().map(|o| print(s, o)).collect();
        for p in &mut list {
            // What a note says is lost may be lost; all else is compared.
            if said("visibility-lost") {
                p.visible = true;
            }
            if said("uvs2-lost") {
                p.uvs[1] = None;
            }
            if let Some(c) = &mut p.color {
                if said("vertex-alpha-lost") {
                    c[3] = 1.0;
                }
                if said("value-clamped") || said("vertex-colors-clamped") {
                    c[..3].iter_mut().for_each(|c| *c = c.min(1.0));
                }
            }
        }
        list.retain(|p| p.triangles > 0 || p.radius > 0.0 || !said("object-empty"));
        list
    };
    let (a, mut b) = (prints(a), prints(b));
    let (areas, totals) = (a.iter().map(|p| p.area).sum::<f64>(), b.iter().map(|p| p.area).sum::<f64>());
    if (areas - totals).abs() > tolerance * areas {
        found.push((format!("objects: {areas} m^2 became {totals}"), &[]));
    }
    let size = a.iter().map(|p| p.middle.abs().max_element() + p.area.sqrt() + p.radius).fold(0.0, f64::max);
    for p in &a {
        match b.iter().position(|q| same(p, q, tolerance, size)) {
            Some(i) => _ = b.swap_remove(i),
            None => found.push((format!("object is not there any more: {p:?}"), &[])),
        }
    }
    found.extend(b.iter().map(|q| (format!("object is new: {q:?}"), &[][..])));
}

fn same(p: &Print, q: &Print, tolerance: f64, size: f64) -> bool {
    let near = |a: f64, b: f64, scale: f64| (a - b).abs() <= tolerance * scale;
    let point = |a: DVec3, b: DVec3, scale: f64| (a - b).abs().max_element() <= tolerance * scale;
    let maybe = |a: Option<DVec3>, b: Option<DVec3>| match (a, b) {
        (Some(a), Some(b)) => point(a, b, 1.0 + a.abs().max_element()),
        (a, b) => a.is_none() && b.is_none(),
    };
    let color = match (p.color, q.color) {
        (Some(a), Some(b)) => a.iter().zip(b).all(|(a, b)| near(*a, b, 1.0)),
        (a, b) => a.is_none() && b.is_none(),
    };
    p.material == q.material
        && p.visible == q.visible
        && p.triangles == q.triangles
        && near(p.radius, q.radius, p.radius)
        && near(p.area, q.area, p.area)
        && point(p.middle, q.middle, size)
        && point(p.front, q.front, p.area)
        && maybe(p.normal, q.normal)
        && maybe(p.uvs[0], q.uvs[0])
        && maybe(p.uvs[1], q.uvs[1])
        && color
}

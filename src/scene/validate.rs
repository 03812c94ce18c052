//! Validation: what `prepare` may rely on.
//!
//! In: a scene from anywhere. Out: the same scene with repairable meshes repaired and a note for each
//! repair, or the first value that makes no picture. Invariant: after `Ok`, every number lies in the
//! range its type documents, every id and index points at something, and a second call changes nothing.
//! Nothing is clamped: a reader that knows its format may clamp, with a note, before it gets here.

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DAffine3, DVec3};

use super::pictures;
use super::repair::repair;
use super::{
    Absorption, Camera, Light, LightKind, MAX_BODIES, Material, MaterialKind, Mesh, Note, Object, Principled,
    Projection, Scene, Settings, Shape,
};
use crate::color::Rgb;

/// The largest coordinate and length, metres: its square is far from overflowing a single.
pub const MAX_LENGTH: f64 = 1e15;
/// The smallest length that something may have, metres: its square is far from underflowing a single.
pub const MIN_LENGTH: f64 = 1e-15;
/// The largest radiance, intensity or irradiance: above it, sums and half floats overflow.
pub const MAX_RADIANCE: f32 = 1e30;
/// The most pixels along one side of a picture.
pub const MAX_SIDE: u32 = 65_536;
/// Largest factor on indirect light.
pub const MAX_INDIRECT_GAIN: f32 = 1e6;
/// How far a sphere's axes may differ in length, and leave the right angle; readers of formats whose
/// rotations are singles stay well below.
const SPHERE_TOLERANCE: f64 = 1e-5;

/// Why a scene cannot be rendered.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {message}")]
pub struct SceneError {
    /// Path in the scene, such as `materials[2].glass.ior` or `cameras[0].fov`; below the kind, keys are
    /// those of the text form.
    pub place: String,
    /// What was found, and what was expected.
    pub message: String,
}

pub(super) type Check = Result<(), SceneError>;

/// Checks every value, and repairs what can be repaired (degenerate triangles are dropped).
///
/// # Errors
/// The first value that is out of range, not finite, or refers to something that is not there.
pub fn validate(scene: &mut Scene) -> Result<Vec<Note>, SceneError> {
    settings(&scene.settings)?;
    unique("materials", "material", scene.materials.iter().map(|m| m.name.as_str()))?;
    pictures::images(&scene.images)?;
    for (i, m) in scene.materials.iter().enumerate() {
        material(m, scene.images.len(), &format!("materials[{i}]"))?;
        if let MaterialKind::Principled(p) = &m.kind {
            pictures::emission(p, &scene.images, &format!("materials[{i}].principled"))?;
        }
    }
    bodies(&scene.materials)?;
    let mut notes = Vec::new();
    for (i, mesh) in scene.meshes.iter_mut().enumerate() {
        let place = format!("meshes[{i}]");
        attributes(mesh, &place)?;
        notes.extend(repair(mesh, &place));
        values(mesh, &place)?;
    }
    let extents: Vec<DVec3> = scene.meshes.iter().map(extent).collect();
    for (i, o) in scene.objects.iter().enumerate() {
        object(o, scene.materials.len(), &extents, &format!("objects[{i}]"))?;
    }
    for (i, l) in scene.lights.iter().enumerate() {
        light(l, &format!("lights[{i}]"))?;
    }
    unique("cameras", "camera", scene.cameras.iter().map(|c| c.name.as_str()))?;
    for (i, c) in scene.cameras.iter().enumerate() {
        camera(c, &format!("cameras[{i}]"))?;
    }
    if let Some(e) = &scene.environment {
        pictures::environment(e, scene)?;
    }
    notes.extend(pictures::notes(scene));
    Ok(notes)
}

pub(super) fn wrong<T>(place: impl Into<String>, message: impl Into<String>) -> Result<T, SceneError> {
    Err(SceneError { place: place.into(), message: message.into() })
}

fn unique<'a>(list: &str, what: &str, names: impl Iterator<Item = &'a str>) -> Check {
    let mut seen = HashMap::new();
    for (i, name) in names.enumerate() {
        if let Some(first) = seen.insert(name, i) {
            return wrong(
                format!("{list}[{i}]"),
                format!("{what} {first} is called `{name}` too; names are unique"),
            );
        }
    }
    Ok(())
}

fn settings(s: &Settings) -> Check {
    if let Some([w, h]) = s.size
        && !((1..=MAX_SIDE).contains(&w) && (1..=MAX_SIDE).contains(&h))
    {
        return wrong("settings.size", format!("{w}x{h} pixels; each side has to be from 1 to {MAX_SIDE}"));
    }
    if s.spp == Some(0) {
        return wrong("settings.spp", "0 samples make no picture; at least 1 is needed");
    }
    if let Some(gain) = s.indirect_gain {
        let expected = "from 0 to a million";
        in_range("settings.indirect_gain", gain.into(), (0.0..=MAX_INDIRECT_GAIN).contains(&gain), expected)?;
    }
    match s.exposure {
        Some(e) => {
            in_range("settings.exposure", e.into(), (-126.0..=126.0).contains(&e), "from -126 to 126 stops")
        }
        None => Ok(()),
    }
}

pub(super) fn in_range(place: impl Into<String>, value: f64, ok: bool, range: &str) -> Check {
    if ok { Ok(()) } else { wrong(place, format!("{value} has to be {range}")) }
}

/// A fraction, such as roughness.
pub(super) fn fraction(place: String, value: f32) -> Check {
    in_range(place, value.into(), (0.0..=1.0).contains(&value), "from 0 to 1")
}

/// Each channel must satisfy `ok`.
fn channels(place: impl Into<String>, c: Rgb, ok: impl Fn(f32) -> bool, range: &str) -> Check {
    if c.to_array().into_iter().all(ok) {
        return Ok(());
    }
    wrong(place, format!("[{}, {}, {}]: each channel has to be {range}", c.r, c.g, c.b))
}

fn reflectance(place: String, c: Rgb) -> Check {
    channels(place, c, |v| (0.0..=1.0).contains(&v), "from 0 to 1")
}

pub(super) fn emitted(place: impl Into<String>, c: Rgb) -> Check {
    channels(place, c, |v| (0.0..=MAX_RADIANCE).contains(&v), "from 0 to 1e30")
}

/// A length above zero.
fn length(place: String, value: f64) -> Check {
    in_range(place, value, (MIN_LENGTH..=MAX_LENGTH).contains(&value), "from 1e-15 to 1e15 metres")
}

fn material(m: &Material, images: usize, place: &str) -> Check {
    match &m.kind {
        MaterialKind::Diffuse { color } => reflectance(format!("{place}.diffuse"), *color),
        MaterialKind::Mirror { color } => reflectance(format!("{place}.mirror"), *color),
        MaterialKind::Light { radiance, .. } => emitted(format!("{place}.light"), *radiance),
        MaterialKind::Glass(glass) => {
            let place = format!("{place}.glass");
            let ior = glass.ior;
            in_range(format!("{place}.ior"), ior.into(), ior > 0.0 && ior.is_finite(), "above zero")?;
            reflectance(format!("{place}.tint"), glass.tint)?;
            absorption(glass.absorption.as_ref(), &place)
        }
        MaterialKind::Principled(p) => principled(p, images, &format!("{place}.principled")),
    }
}

fn principled(p: &Principled, images: usize, place: &str) -> Check {
    reflectance(format!("{place}.base_color"), p.base_color)?;
    fraction(format!("{place}.metallic"), p.metallic)?;
    fraction(format!("{place}.roughness"), p.roughness)?;
    in_range(format!("{place}.ior"), p.ior.into(), p.ior >= 1.0 && p.ior.is_finite(), "at least 1")?;
    fraction(format!("{place}.specular"), p.specular)?;
    let finite = |v: f32| v >= 0.0 && v.is_finite();
    channels(format!("{place}.specular_color"), p.specular_color, finite, "zero or more")?;
    fraction(format!("{place}.transmission"), p.transmission)?;
    reflectance(format!("{place}.transmission_tint"), p.transmission_tint)?;
    absorption(p.absorption.as_ref(), place)?;
    emitted(format!("{place}.emission"), p.emission)?;
    fraction(format!("{place}.coat"), p.coat)?;
    fraction(format!("{place}.coat_roughness"), p.coat_roughness)?;
    let coat_ior = p.coat_ior;
    in_range(
        format!("{place}.coat_ior"),
        coat_ior.into(),
        coat_ior >= 1.0 && coat_ior.is_finite(),
        "at least 1",
    )?;
    reflectance(format!("{place}.sheen_color"), p.sheen_color)?;
    fraction(format!("{place}.sheen_roughness"), p.sheen_roughness)?;
    pictures::textures(p, images, place)
}

/// A path counts the bodies that it is in, and has room for so many.
fn bodies(materials: &[Material]) -> Check {
    let with_body = materials.iter().enumerate().filter(|(_, m)| m.kind.body().is_some());
    let Some((i, m)) = with_body.clone().nth(MAX_BODIES) else { return Ok(()) };
    let key = if matches!(m.kind, MaterialKind::Glass(_)) { "glass" } else { "principled" };
    let count = with_body.count();
    let message = format!("{count} materials have a priority; at most {MAX_BODIES} can");
    wrong(format!("materials[{i}].{key}.priority"), message)
}

fn absorption(a: Option<&Absorption>, place: &str) -> Check {
    let Some(a) = a else { return Ok(()) };
    channels(format!("{place}.absorption.color"), a.color, |v| v > 0.0 && v <= 1.0, "above 0 and up to 1")?;
    length(format!("{place}.absorption.distance"), a.distance.into())
}

/// Lengths of the lists, and indices into them.
fn attributes(mesh: &Mesh, place: &str) -> Check {
    let count = mesh.positions.len();
    if u32::try_from(count.max(mesh.triangles.len())).is_err() {
        return wrong(place, "more than 4294967295 vertices or triangles");
    }
    let lists = [
        ("normals", mesh.normals.len()),
        ("tangents", mesh.tangents.len()),
        ("uvs", mesh.uvs[0].len()),
        ("uvs2", mesh.uvs[1].len()),
        ("colors", mesh.colors.len()),
    ];
    for (key, length) in lists {
        if length != 0 && length != count {
            let message =
                format!("{length} {key} for {count} positions; there has to be one for each, or none");
            return wrong(format!("{place}.{key}"), message);
        }
    }
    for (i, t) in mesh.triangles.iter().enumerate() {
        if let Some(index) = t.iter().find(|&&index| index as usize >= count) {
            let message = format!("vertex {index} of {count}, which are counted from zero");
            return wrong(format!("{place}.triangles[{i}]"), message);
        }
    }
    Ok(())
}

/// Values of a repaired mesh.
fn values(mesh: &Mesh, place: &str) -> Check {
    let far = |v: f32| f64::from(v.abs()) > MAX_LENGTH;
    if let Some(i) = mesh.positions.iter().position(|p| p.to_array().into_iter().any(far)) {
        let message = format!("{} is farther than 1e15 metres from the origin", mesh.positions[i]);
        return wrong(format!("{place}.positions[{i}]"), message);
    }
    for (key, set) in ["uvs", "uvs2"].iter().zip(&mesh.uvs) {
        if let Some(i) = set.iter().position(|uv| !uv.is_finite()) {
            return wrong(format!("{place}.{key}[{i}]"), format!("{} is not finite", set[i]));
        }
    }
    match mesh.colors.iter().position(|c| !(c.is_finite() && c.min_element() >= 0.0 && c.w <= 1.0)) {
        Some(i) => {
            let message = format!("{}: channels have to be zero or more, alpha from 0 to 1", mesh.colors[i]);
            wrong(format!("{place}.colors[{i}]"), message)
        }
        None => Ok(()),
    }
}

/// The largest absolute coordinates of a mesh.
fn extent(mesh: &Mesh) -> DVec3 {
    mesh.positions.iter().fold(DVec3::ZERO, |max, p| max.max(p.abs().as_dvec3()))
}

fn object(o: &Object, materials: usize, extents: &[DVec3], place: &str) -> Check {
    if o.material.0 as usize >= materials {
        return wrong(format!("{place}.material"), format!("material {} of {materials}", o.material.0));
    }
    let transform = format!("{place}.transform");
    if let Shape::Sphere { .. } = o.shape {
        near(&format!("{place}.sphere.center"), o.transform.translation.abs())?;
    }
    invertible(&transform, &o.transform)?;
    let reach = match o.shape {
        Shape::Mesh(id) => match extents.get(id.0 as usize) {
            Some(&extent) => extent,
            None => return wrong(format!("{place}.mesh"), format!("mesh {} of {}", id.0, extents.len())),
        },
        Shape::Sphere { radius } => {
            length(format!("{place}.sphere.radius"), radius)?;
            let scale = uniform_scale(&transform, &o.transform)?;
            length(transform.clone(), radius * scale)?;
            DVec3::splat(radius)
        }
    };
    let m = o.transform.matrix3;
    let world = m.x_axis.abs() * reach.x + m.y_axis.abs() * reach.y + m.z_axis.abs() * reach.z;
    near(&transform, world + o.transform.translation.abs())
}

fn near(place: &str, p: DVec3) -> Check {
    // Written so that NaN fails too.
    if p.cmple(DVec3::splat(MAX_LENGTH)).all() {
        Ok(())
    } else {
        wrong(place, "reaches farther than 1e15 metres from the origin, or is not finite")
    }
}

fn invertible(place: &str, t: &DAffine3) -> Check {
    if !t.is_finite() {
        return wrong(place, "the transform is not finite");
    }
    let m = t.matrix3;
    let lengths = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    // Written so that NaN, from an overflow, fails too.
    if !(m.determinant().abs() > 1e-14 * lengths && lengths.is_finite()) {
        return wrong(place, "the transform flattens what it places: it has no inverse");
    }
    Ok(())
}

fn uniform_scale(place: &str, t: &DAffine3) -> Result<f64, SceneError> {
    let m = t.matrix3;
    let scale = m.x_axis.length();
    let even = [m.y_axis, m.z_axis].iter().all(|a| (a.length() / scale - 1.0).abs() <= SPHERE_TOLERANCE);
    let square = [m.x_axis.dot(m.y_axis), m.y_axis.dot(m.z_axis), m.z_axis.dot(m.x_axis)];
    if !even || square.iter().any(|d| d.abs() > SPHERE_TOLERANCE * scale * scale) {
        return wrong(
            place,
            "a sphere may be turned, moved and scaled evenly only, or it is no sphere any more",
        );
    }
    Ok(scale)
}

fn light(l: &Light, place: &str) -> Check {
    let transform = format!("{place}.transform");
    invertible(&transform, &l.transform)?;
    near(&transform, l.transform.translation.abs())?;
    match l.kind {
        LightKind::Point { intensity, radius } => {
            emitted(format!("{place}.point.intensity"), intensity)?;
            light_radius(radius, intensity, &format!("{place}.point.radius"))
        }
        LightKind::Spot { intensity, inner, outer, radius, .. } => {
            emitted(format!("{place}.spot.intensity"), intensity)?;
            let (inner_ok, outer_ok) = ((0.0..=outer).contains(&inner), outer > 0.0 && outer <= FRAC_PI_2);
            let degrees =
                |place: String, angle: f64, ok, range| in_range(place, angle.to_degrees(), ok, range);
            degrees(format!("{place}.spot.outer"), outer, outer_ok, "above 0 and up to 90 degrees")?;
            degrees(format!("{place}.spot.inner"), inner, inner_ok, "from 0 degrees to the outer angle")?;
            light_radius(radius, intensity, &format!("{place}.spot.radius"))
        }
        LightKind::Sun { irradiance, angle } => {
            emitted(format!("{place}.sun.irradiance"), irradiance)?;
            let ok = (0.0..PI).contains(&angle);
            in_range(
                format!("{place}.sun.angle"),
                angle.to_degrees(),
                ok,
                "from 0 up to, but not, 180 degrees",
            )
        }
        LightKind::Area { size, radiance, .. } => {
            emitted(format!("{place}.area.radiance"), radiance)?;
            size.iter().try_for_each(|&side| length(format!("{place}.area.size"), side))
        }
    }
}

/// Zero, or a length at which the sphere's radiance is in range.
fn light_radius(radius: f64, intensity: Rgb, place: &str) -> Check {
    if radius == 0.0 {
        return Ok(());
    }
    length(place.to_owned(), radius)?;
    let radiance = f64::from(intensity.max_channel()) / (PI * radius * radius);
    in_range(
        place,
        radius,
        radiance <= f64::from(MAX_RADIANCE),
        "zero, or so large that its radiance is at most 1e30",
    )
}

fn camera(c: &Camera, place: &str) -> Check {
    let transform = format!("{place}.transform");
    invertible(&transform, &c.transform)?;
    near(&transform, c.transform.translation.abs())?;
    match c.projection {
        Projection::Perspective { fov, .. } => {
            let ok = fov > 0.0 && fov < PI;
            in_range(format!("{place}.fov"), fov.to_degrees(), ok, "above 0 and below 180 degrees")?;
        }
        Projection::Orthographic { extent, .. } => length(format!("{place}.orthographic"), extent)?,
    }
    for shift in c.shift {
        in_range(format!("{place}.shift"), shift, shift.abs() <= 1e6, "from -1e6 to 1e6")?;
    }
    if let Some(lens) = c.lens {
        length(format!("{place}.lens.radius"), lens.radius)?;
        length(format!("{place}.lens.focus"), lens.focus_distance)?;
    }
    match c.aspect {
        Some(a) => in_range(format!("{place}.aspect"), a, (1e-5..=1e5).contains(&a), "from 1e-5 to 1e5"),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::text;

    /// A scene with something of every kind, changed by `break_it`, gives the error `expected`.
    fn check(break_it: impl FnOnce(&mut Scene), expected: &str) {
        let mut scene = text::parse(EVERYTHING).unwrap_or_else(|e| panic!("{e}")).0;
        break_it(&mut scene);
        let found = match validate(&mut scene) {
            Ok(_) => "ok".to_owned(),
            Err(e) => e.to_string(),
        };
        assert!(found.starts_with(expected), "found `{found}`, expected `{expected}`");
    }

    const EVERYTHING: &str = r#"
        epsilux = 1
        camera.a = { eye = [0, 0, 5], target = [0, 0, 0], fov = 40, lens = { radius = 0.1, focus = 5 } }
        camera.b = { eye = [0, 0, 5], target = [0, 0, 0], orthographic = 4 }
        environment = { radiance = [1, 1, 1] }
        [material]
        d = { diffuse = [0.5, 0.5, 0.5] }
        g = { glass = { absorption = { color = [0.9, 0.9, 0.9], distance = 1 } } }
        p = { principled = {} }
        [[object]]
        material = "d"
        sphere = { radius = 1 }
        [[object]]
        material = "g"
        mesh = { positions = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }
        [[light]]
        point = { intensity = [1, 1, 1] }
        [[light]]
        spot = { intensity = [1, 1, 1], outer = 90 }
        [[light]]
        sun = { irradiance = [1, 1, 1] }
        [[light]]
        area = { size = [1, 1], radiance = [1, 1, 1] }
    "#;

    fn glass(s: &mut Scene) -> &mut crate::scene::Glass {
        match &mut s.materials[1].kind {
            MaterialKind::Glass(g) => g,
            _ => unreachable!(),
        }
    }

    fn plastic(s: &mut Scene) -> &mut Principled {
        match &mut s.materials[2].kind {
            MaterialKind::Principled(p) => p,
            _ => unreachable!(),
        }
    }

    #[test]
    fn every_range_is_checked_and_named() {
        use glam::{DMat3, Vec2, Vec3, Vec4};
        let nan = f32::NAN;
        check(|_| (), "ok");
        check(|s| s.settings.size = Some([0, 4]), "settings.size: 0x4");
        check(|s| s.settings.spp = Some(0), "settings.spp");
        check(|s| s.settings.exposure = Some(nan), "settings.exposure: NaN");
        check(|s| s.settings.indirect_gain = Some(-1.0), "settings.indirect_gain: -1");
        check(|s| s.materials[2].name = "d".into(), "materials[2]: material 0 is called `d` too");
        check(
            |s| s.materials[0].kind = MaterialKind::Diffuse { color: Rgb::grey(1.001) },
            "materials[0].diffuse",
        );
        check(
            |s| s.materials[0].kind = MaterialKind::Mirror { color: Rgb::grey(nan) },
            "materials[0].mirror",
        );
        let lamp = |v| MaterialKind::Light { radiance: Rgb::grey(v), sides: crate::scene::Sides::Both };
        check(|s| s.materials[0].kind = lamp(-1.0), "materials[0].light");
        check(|s| s.materials[0].kind = lamp(1e30), "ok");
        check(|s| s.materials[0].kind = lamp(1.1e30), "materials[0].light");
        check(|s| glass(s).ior = 0.0, "materials[1].glass.ior: 0 has to be above zero");
        check(|s| glass(s).ior = f32::INFINITY, "materials[1].glass.ior");
        check(|s| glass(s).tint.g = -0.1, "materials[1].glass.tint");
        check(|s| glass(s).absorption.as_mut().unwrap().color.r = 0.0, "materials[1].glass.absorption.color");
        check(
            |s| glass(s).absorption.as_mut().unwrap().distance = 0.0,
            "materials[1].glass.absorption.distance",
        );
        check(|s| plastic(s).roughness = 1.01, "materials[2].principled.roughness");
        check(|s| plastic(s).ior = 0.9, "materials[2].principled.ior");
        check(|s| plastic(s).specular_color = Rgb::grey(3.0), "ok");
        check(|s| plastic(s).emission.b = 2e30, "materials[2].principled.emission");

        check(|s| s.meshes[0].normals = vec![Vec3::Z], "meshes[0].normals: 1 normals for 3 positions");
        check(|s| s.meshes[0].triangles[0][1] = 3, "meshes[0].triangles[0]: vertex 3 of 3");
        check(|s| s.meshes[0].positions[1].x = 2e15, "meshes[0].positions[1]");
        check(|s| s.meshes[0].uvs[1] = vec![Vec2::NAN; 3], "meshes[0].uvs2[0]");
        check(|s| s.meshes[0].colors = vec![Vec4::splat(1.1); 3], "meshes[0].colors[0]");

        check(|s| s.objects[0].material.0 = 3, "objects[0].material: material 3 of 3");
        check(|s| s.objects[1].shape = Shape::Mesh(crate::scene::MeshId(1)), "objects[1].mesh: mesh 1 of 1");
        check(|s| s.objects[0].shape = Shape::Sphere { radius: 0.0 }, "objects[0].sphere.radius");
        let flat = DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0));
        check(|s| s.objects[1].transform.matrix3 = flat, "objects[1].transform: the transform flattens");
        let uneven = DMat3::from_diagonal(DVec3::new(1.0, 1.001, 1.0));
        check(|s| s.objects[1].transform.matrix3 = uneven, "ok");
        check(|s| s.objects[0].transform.matrix3 = uneven, "objects[0].transform: a sphere");
        let mirrored = DMat3::from_diagonal(DVec3::new(2.0, -2.0, 2.0));
        check(|s| s.objects[0].transform.matrix3 = mirrored, "ok");
        check(|s| s.objects[0].transform.translation.y = f64::NAN, "objects[0].sphere.center: reaches");
        check(|s| s.objects[1].transform.translation.y = 0.9e15, "ok");
        check(|s| s.objects[1].transform.translation.y = 1.1e15, "objects[1].transform: reaches");
        check(
            |s| s.objects[1].transform.translation.y = f64::NAN,
            "objects[1].transform: the transform is not",
        );

        let point = |v, radius| LightKind::Point { intensity: Rgb::grey(v), radius };
        check(|s| s.lights[0].kind = point(1.0, -1.0), "lights[0].point.radius");
        check(|s| s.lights[0].kind = point(1e20, 1e-10), "lights[0].point.radius");
        check(|s| s.lights[0].kind = point(-1.0, 0.0), "lights[0].point.intensity");
        let spot = |inner, outer| LightKind::Spot {
            intensity: Rgb::WHITE,
            inner,
            outer,
            falloff: crate::scene::SpotFalloff::Gltf,
            radius: 0.0,
        };
        check(|s| s.lights[1].kind = spot(0.5, 0.4), "lights[1].spot.inner");
        check(|s| s.lights[1].kind = spot(0.0, 1.6), "lights[1].spot.outer");
        check(
            |s| s.lights[2].kind = LightKind::Sun { irradiance: Rgb::WHITE, angle: PI },
            "lights[2].sun.angle",
        );
        check(|s| s.lights[2].transform.matrix3 = flat, "lights[2].transform");
        let shape = crate::scene::AreaShape::Ellipse;
        let area = LightKind::Area { shape, size: [1.0, 0.0], radiance: Rgb::WHITE };
        check(|s| s.lights[3].kind = area, "lights[3].area.size");

        check(|s| s.cameras[1].name = "a".into(), "cameras[1]: camera 0 is called `a` too");
        let axis = crate::scene::FovAxis::Vertical;
        check(|s| s.cameras[0].projection = Projection::Perspective { fov: PI, axis }, "cameras[0].fov: 180");
        let flat_extent = Projection::Orthographic { extent: 0.0, axis };
        check(|s| s.cameras[1].projection = flat_extent, "cameras[1].orthographic");
        check(|s| s.cameras[0].shift[1] = f64::INFINITY, "cameras[0].shift");
        check(|s| s.cameras[0].lens.as_mut().unwrap().focus_distance = 0.0, "cameras[0].lens.focus");
        check(|s| s.cameras[0].aspect = Some(0.0), "cameras[0].aspect");
        check(|s| s.environment.as_mut().unwrap().radiance.r = nan, "environment.radiance");
    }
}

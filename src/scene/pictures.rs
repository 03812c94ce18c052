//! Validation of pictures, and of the textures that use them.

use std::collections::HashSet;

use super::notes::Notes;
use super::validate::{Check, emitted, fraction, in_range, wrong};
use super::{
    AlphaMode, Environment, Image, MAX_RADIANCE, MaterialKind, MeshId, Note, NoteEffect, Pixels, Principled,
    Scene, Shape, Texels, Texture,
};

/// The largest offset, scale and absolute angle of a texture: beyond it a single has no digits left for
/// the place within a picture.
const MAX_UV: f32 = 1e6;

/// Every picture: sizes, and texels that are floats.
pub(super) fn images(images: &[Image]) -> Check {
    for (i, image) in images.iter().enumerate() {
        let place = format!("images[{i}]");
        match &image.pixels {
            Some(pixels) => texels(pixels, &place)?,
            None => return wrong(place, format!("the picture `{}` has not been read", image.name)),
        }
    }
    Ok(())
}

fn texels(pixels: &Pixels, place: &str) -> Check {
    let (w, h, n) = (pixels.width, pixels.height, pixels.texels.len());
    if w == 0 || h == 0 || u64::from(w) * u64::from(h) != n as u64 {
        return wrong(place, format!("{n} texels for a picture of {w}x{h}"));
    }
    let Texels::Float(list) = &pixels.texels else { return Ok(()) };
    match list.iter().position(|t| !t.iter().all(|c| (0.0..=MAX_RADIANCE).contains(c))) {
        Some(at) => {
            let (x, y) = (at as u32 % w, at as u32 / w);
            wrong(
                format!("{place}.pixel[{x},{y}]"),
                format!("{:?}: each channel has to be from 0 to 1e30", list[at]),
            )
        }
        None => Ok(()),
    }
}

/// What a principled material adds to its numbers: alpha, and textures.
pub(super) fn textures(p: &Principled, images: usize, place: &str) -> Check {
    fraction(format!("{place}.alpha"), p.alpha)?;
    if let AlphaMode::Mask { cutoff } = p.alpha_mode {
        fraction(format!("{place}.cutoff"), cutoff)?;
    }
    for (key, t) in p.textures.iter() {
        texture(t, images, &format!("{place}.{key}_texture"))?;
    }
    for (key, normal) in [("normal", p.textures.normal), ("coat_normal", p.textures.coat_normal)] {
        if let Some(n) = normal {
            let range = format!("from -{MAX_UV} to {MAX_UV}");
            let place = format!("{place}.{key}_texture.strength");
            in_range(place, n.scale.into(), n.scale.abs() <= MAX_UV, &range)?;
        }
    }
    Ok(())
}

fn texture(t: &Texture, images: usize, place: &str) -> Check {
    if t.image.0 as usize >= images {
        return wrong(format!("{place}.image"), format!("image {} of {images}", t.image.0));
    }
    if t.uv_set > 1 {
        return wrong(format!("{place}.uv_set"), format!("{} has to be 0 or 1", t.uv_set));
    }
    let range = format!("from -{MAX_UV} to {MAX_UV}");
    let numbers =
        [("offset", t.offset[0]), ("offset", t.offset[1]), ("scale", t.scale[0]), ("scale", t.scale[1])];
    for (key, v) in numbers {
        in_range(format!("{place}.{key}"), v.into(), v.abs() <= MAX_UV, &range)?;
    }
    let ok = t.rotation.abs() <= MAX_UV;
    let degrees = f64::from(t.rotation).to_degrees();
    in_range(format!("{place}.rotation"), degrees, ok, "at most 57 million degrees either way")
}

/// Emission with its texture; the brightest texel counts.
pub(super) fn emission(p: &Principled, images: &[Image], place: &str) -> Check {
    let Some(t) = &p.textures.emission else { return Ok(()) };
    let pixels = images.get(t.image.0 as usize).and_then(|i| i.pixels.as_ref());
    let Some(Texels::Float(list)) = pixels.map(|p| &p.texels) else { return Ok(()) };
    let brightest = list.iter().flatten().fold(0.0f32, |m, &c| m.max(c));
    let product = brightest * p.emission.max_channel();
    let range = "at most 1e30 where the picture is brightest";
    in_range(format!("{place}.emission"), product.into(), product <= MAX_RADIANCE, range)
}

/// Notes about textures that cannot be laid as they are meant, at most one for each material and mesh, and
/// about what is not rendered.
pub(super) fn notes(scene: &Scene) -> Vec<Note> {
    let mut notes = Notes::default();
    let mut seen = HashSet::new();
    for (i, object) in scene.objects.iter().enumerate() {
        let material = &scene.materials[object.material.0 as usize];
        let MaterialKind::Principled(p) = &material.kind else { continue };
        if p.textures.is_empty() || !seen.insert((object.material, mesh_of(object.shape))) {
            continue;
        }
        let has = |set: u8| match object.shape {
            Shape::Mesh(m) => !scene.meshes[m.0 as usize].uvs[usize::from(set)].is_empty(),
            Shape::Sphere { .. } => false,
        };
        let varies = |t: &Texture| {
            let pixels = scene.images[t.image.0 as usize].pixels.as_ref();
            pixels.is_some_and(|p| p.texels.len() > 1)
        };
        let lost: Vec<&str> =
            p.textures.iter().filter(|(_, t)| !has(t.uv_set) && varies(t)).map(|(key, _)| key).collect();
        if lost.is_empty() {
            continue;
        }
        let what = match object.shape {
            Shape::Mesh(m) => format!("mesh \"{}\"", scene.meshes[m.0 as usize].name),
            Shape::Sphere { .. } => "a sphere".to_owned(),
        };
        let message = format!(
            "{what} has no texture coordinates for {} of material \"{}\", which is read at (0, 0)",
            lost.join(", "),
            material.name
        );
        notes.add("uv-missing", NoteEffect::Differs, format!("objects[{i}]"), message);
    }
    for (i, material) in scene.materials.iter().enumerate() {
        if let MaterialKind::Principled(p) = &material.kind
            && p.textures.coat_normal.is_some()
            && p.coat > 0.0
        {
            let message = "the coat's normals are not rendered: it follows those of the rest";
            let place = format!("materials[{i}].principled.coat_normal_texture");
            notes.add("coat-normal-ignored", NoteEffect::Differs, place, message);
        }
    }
    notes.finish()
}

fn mesh_of(shape: Shape) -> Option<MeshId> {
    match shape {
        Shape::Mesh(m) => Some(m),
        Shape::Sphere { .. } => None,
    }
}

/// The environment; its brightest texel counts.
pub(super) fn environment(e: &Environment, scene: &Scene) -> Check {
    emitted("environment.radiance", e.radiance)?;
    let Some(image) = e.image else { return Ok(()) };
    let Some(pixels) = scene.images.get(image.image.0 as usize).and_then(|i| i.pixels.as_ref()) else {
        return wrong("environment.image", format!("image {} of {}", image.image.0, scene.images.len()));
    };
    in_range(
        "environment.rotation",
        image.rotation.to_degrees(),
        image.rotation.abs() <= 1e3,
        "a few turns at most",
    )?;
    if let Texels::Float(list) = &pixels.texels {
        let brightest = list.iter().flatten().fold(0.0f32, |m, &c| m.max(c));
        let product = brightest * e.radiance.max_channel();
        let range = "at most 1e30 where the picture is brightest";
        in_range("environment.radiance", product.into(), product <= MAX_RADIANCE, range)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{EnvironmentImage, ImageId, Material, MaterialKind, validate};
    use super::*;
    use crate::color::Rgb;

    /// A scene with a textured material and an image sky, changed by `break_it`, gives this error.
    fn check(break_it: impl FnOnce(&mut Scene), expected: &str) {
        let pixels = Pixels { width: 2, height: 1, texels: Texels::Float(vec![[1.0; 3], [2.0; 3]]) };
        let mut p = Principled::default();
        p.textures.base_color = Some(Texture::new(ImageId(0)));
        let name = "m".to_owned();
        let mut scene = Scene {
            images: vec![Image {
                name: "i".into(),
                file: None,
                encoded: None,
                pixels: Some(Arc::new(pixels)),
            }],
            materials: vec![Material { name, kind: MaterialKind::Principled(Box::new(p)) }],
            environment: Some(Environment {
                name: "sky".into(),
                radiance: Rgb::WHITE,
                image: Some(EnvironmentImage { image: ImageId(0), rotation: 0.0 }),
                visible_to_camera: true,
            }),
            ..Scene::default()
        };
        break_it(&mut scene);
        let found = validate(&mut scene).map_or_else(|e| e.to_string(), |_| "ok".into());
        assert!(found.starts_with(expected), "found `{found}`, expected `{expected}`");
    }

    fn principled(s: &mut Scene) -> &mut Principled {
        match &mut s.materials[0].kind {
            MaterialKind::Principled(p) => p,
            _ => unreachable!(),
        }
    }

    /// Guards the note about missing texture coordinates: one for each material and mesh, however many
    /// objects there are, and none where nothing is lost.
    #[test]
    fn missing_coordinates_are_noted_once() {
        use glam::{DAffine3, Vec2, Vec3};

        use super::super::{MaterialId, Mesh, Object};
        let pixels = Pixels { width: 2, height: 1, texels: Texels::Byte(vec![[0; 4], [9; 4]]) };
        let mut p = Principled::default();
        p.textures.base_color = Some(Texture::new(ImageId(0)));
        p.textures.emission = Some(Texture { uv_set: 1, ..Texture::new(ImageId(0)) });
        let object = |shape| Object {
            name: "o".into(),
            shape,
            material: MaterialId(0),
            transform: DAffine3::IDENTITY,
            visible_to_camera: true,
        };
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Mesh {
            name: "leaf".into(),
            positions,
            uvs: [vec![Vec2::ZERO; 3], Vec::new()],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let mut scene = Scene {
            images: vec![Image {
                name: "i".into(),
                file: None,
                encoded: None,
                pixels: Some(Arc::new(pixels)),
            }],
            materials: vec![Material { name: "m".into(), kind: MaterialKind::Principled(Box::new(p)) }],
            meshes: vec![mesh],
            objects: vec![object(Shape::Mesh(MeshId(0))), object(Shape::Mesh(MeshId(0)))],
            ..Scene::default()
        };
        scene.objects.push(object(Shape::Sphere { radius: 1.0 }));
        let found: Vec<String> = validate(&mut scene).expect("valid").iter().map(Note::to_string).collect();
        assert_eq!(
            found,
            [
                "objects[0]: mesh \"leaf\" has no texture coordinates for emission of material \"m\", which is read at (0, 0)",
                "objects[2]: a sphere has no texture coordinates for base_color, emission of material \"m\", which is read at (0, 0)",
            ]
        );
    }

    /// Guards that nothing after validation meets a texel, an index or a number out of range.
    #[test]
    fn every_picture_and_texture_is_checked() {
        check(|_| (), "ok");
        check(|s| s.images[0].pixels = None, "images[0]: the picture `i` has not been read");
        let put = |s: &mut Scene, width, texels| {
            s.images[0].pixels = Some(Arc::new(Pixels { width, height: 1, texels }));
        };
        check(|s| put(s, 3, Texels::Byte(vec![[0; 4]; 2])), "images[0]: 2 texels for a picture of 3x1");
        check(|s| put(s, 1, Texels::Float(vec![[0.0, f32::NAN, 0.0]])), "images[0].pixel[0,0]");
        check(|s| put(s, 1, Texels::Float(vec![[0.0, -1.0, 0.0]])), "images[0].pixel[0,0]");
        let slot = |s: &mut Scene, f: fn(&mut Texture)| {
            f(principled(s).textures.base_color.as_mut().unwrap());
        };
        let place = "materials[0].principled.base_color_texture";
        check(|s| slot(s, |t| t.image.0 = 1), &format!("{place}.image: image 1 of 1"));
        check(|s| slot(s, |t| t.uv_set = 2), &format!("{place}.uv_set"));
        check(|s| slot(s, |t| t.scale[1] = f32::NAN), &format!("{place}.scale"));
        check(|s| principled(s).alpha = 1.5, "materials[0].principled.alpha");
        check(
            |s| principled(s).alpha_mode = AlphaMode::Mask { cutoff: -1.0 },
            "materials[0].principled.cutoff",
        );
        check(|s| principled(s).coat_ior = 0.5, "materials[0].principled.coat_ior");
        check(|s| s.environment.as_mut().unwrap().radiance = Rgb::grey(6e29), "environment.radiance");
        check(
            |s| s.environment.as_mut().unwrap().image.as_mut().unwrap().image.0 = 7,
            "environment.image: image 7 of 1",
        );
    }
}

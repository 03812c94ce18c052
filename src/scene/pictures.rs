//! Validation of pictures, and of the textures that use them.

use super::validate::{Check, emitted, fraction, in_range, wrong};
use super::{AlphaMode, Environment, Image, MAX_RADIANCE, Pixels, Principled, Scene, Texels, Texture};

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

//! Tiny scenes around textures, alpha, normal maps and vertex colours, each on the stage of
//! [`super::features`], and one with all of them.

use std::sync::Arc;

use epsilux::color::Rgb;
use epsilux::glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use epsilux::scene::{
    AlphaMode, Channel, Filter, Image, ImageId, LightKind, MaterialKind, Mesh, MeshId, NormalTexture, Pixels,
    Principled, ScalarTexture, Scene, Shape, Texels, Texture, Wrap,
};

use super::features::{MIDDLE, dark_stage, round_mesh, stage};
use super::scenes::{Build, diffuse, principled};

/// Adds a picture to a scene.
pub(crate) fn add_image(scene: &mut Scene, width: u32, height: u32, texels: Texels) -> ImageId {
    let pixels = Some(Arc::new(Pixels { width, height, texels }));
    scene.images.push(Image { name: "picture".into(), file: None, encoded: None, pixels });
    ImageId(scene.images.len() as u32 - 1)
}

/// Bytes without a pattern, the same for each number.
fn noise(number: u32, count: usize) -> Vec<[u8; 4]> {
    let mut state = number.wrapping_mul(0x9e37_79b9) | 1;
    let mut byte = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state >> 11) as u8
    };
    (0..count).map(|_| [byte(), byte(), byte(), byte()]).collect()
}

/// A picture of 5 x 4 random texels.
pub(crate) fn noise_image(scene: &mut Scene, number: u32) -> ImageId {
    add_image(scene, 5, 4, Texels::Byte(noise(number, 20)))
}

/// Random normals within 45 degrees or so of straight up.
pub(crate) fn bumps(scene: &mut Scene) -> ImageId {
    let normals = noise(77, 36).iter().map(|[r, g, _, _]| [64 + r / 2, 64 + g / 2, 230, 255]).collect();
    add_image(scene, 6, 6, Texels::Byte(normals))
}

/// The round mesh with its picture laid from the front in the first set, and from above in the second.
pub(crate) fn laid_mesh(levels: u32, smooth: bool) -> Mesh {
    let mut mesh = round_mesh(levels, smooth);
    mesh.uvs = [
        mesh.positions.iter().map(|p| Vec2::new(0.5 + 0.9 * p.x, 0.5 - 0.9 * p.y + 0.2 * p.z)).collect(),
        mesh.positions.iter().map(|p| Vec2::new(1.3 * p.x + 0.4 * p.y, 1.1 * p.z)).collect(),
    ];
    mesh
}

fn at_middle() -> DAffine3 {
    DAffine3::from_translation(MIDDLE)
}

/// The laid mesh in the middle of a stage; the material may add pictures.
fn laid_ball(smooth: bool, material: impl FnOnce(&mut Scene) -> MaterialKind) -> Scene {
    let mut scene = stage();
    let kind = material(&mut scene);
    scene.meshes.push(laid_mesh(2, smooth));
    let mesh = MeshId(scene.meshes.len() as u32 - 1);
    scene.object(Shape::Mesh(mesh), at_middle(), kind);
    scene
}

/// A principled ball whose textures use one random picture.
fn textured(number: u32, change: impl FnOnce(&mut Principled, Texture)) -> Scene {
    laid_ball(true, |scene| {
        let texture = Texture::new(noise_image(scene, number));
        principled(|p| change(p, texture))
    })
}

pub(crate) fn channel(texture: Texture, channel: Channel) -> Option<ScalarTexture> {
    Some(ScalarTexture { texture, channel })
}

/// A sheet that stands in front of the ball, upright, with its picture over it once.
fn sheet(scene: &mut Scene, center: DVec3, side: f64, kind: MaterialKind) {
    let v = side * DVec3::new(0.0, 1.0, 0.15);
    scene.quad(center, side * DVec3::X, v, kind);
    if let Some(mesh) = scene.meshes.last_mut() {
        mesh.uvs[0] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(Vec2::from).to_vec();
    }
}

/// How pictures lie: transform, wraps and filters.
fn lays() -> Vec<(String, Scene)> {
    let mut list = Vec::new();
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        for filter in [Filter::Linear, Filter::Nearest] {
            let scene = textured(1, |p, t| {
                p.specular = 0.0;
                let (scale, offset) = ([1.7, 0.8], [0.3, -0.4]);
                p.textures.base_color =
                    Some(Texture { wrap: [wrap, Wrap::Mirror], filter, scale, offset, rotation: 0.6, ..t });
            });
            list.push((format!("base colour, {wrap:?}, {filter:?}"), scene));
        }
    }
    let second = textured(2, |p, t| {
        p.textures.base_color = Some(Texture { uv_set: 1, ..t });
        p.textures.roughness = channel(t, Channel::G);
    });
    list.push(("base colour by the second set, roughness by the first".into(), second));
    let shorts = laid_ball(true, |scene| {
        let texels = noise(3, 20).iter().map(|t| t.map(|b| (u16::from(b) * 257) ^ 0x55)).collect();
        let texture = Texture::new(add_image(scene, 5, 4, Texels::Short(texels)));
        principled(|p| p.textures.base_color = Some(texture))
    });
    list.push(("base colour of sixteen bits".into(), shorts));
    let mut bare = textured(4, |p, t| p.textures.base_color = Some(t));
    bare.sphere(DVec3::new(1.4, 0.4, 0.6), 0.4, bare.materials[2].kind.clone());
    bare.meshes[1].uvs[0].clear();
    list.push(("base colour where there are no coordinates".into(), bare));
    list
}

/// What pictures vary.
fn slots() -> Vec<(String, Scene)> {
    let mut list: Vec<(&str, Scene)> = vec![
        (
            "metallic and roughness",
            textured(5, |p, t| {
                p.base_color = Rgb::new(1.0, 0.7, 0.3);
                (p.metallic, p.roughness) = (1.0, 0.9);
                p.textures.metallic = channel(t, Channel::B);
                p.textures.roughness = channel(t, Channel::G);
            }),
        ),
        (
            "strength of the layer",
            textured(6, |p, t| {
                p.base_color = Rgb::new(0.3, 0.2, 0.1);
                p.roughness = 0.3;
                p.textures.specular = channel(t, Channel::A);
            }),
        ),
        (
            "tint of the layer",
            textured(7, |p, t| {
                p.base_color = Rgb::new(0.3, 0.2, 0.1);
                (p.roughness, p.specular_color) = (0.3, Rgb::new(4.0, 3.0, 2.0));
                p.textures.specular_color = Some(t);
            }),
        ),
        (
            "share of glass",
            textured(8, |p, t| {
                (p.transmission, p.roughness) = (1.0, 0.3);
                p.textures.transmission = channel(t, Channel::R);
                p.textures.base_color = Some(t);
            }),
        ),
        (
            "smooth coloured glass",
            textured(9, |p, t| {
                (p.transmission, p.roughness) = (1.0, 0.0);
                p.transmission_tint = Rgb::new(0.9, 0.95, 1.0);
                p.textures.base_color = Some(t);
            }),
        ),
        (
            "glass of varying roughness",
            textured(10, |p, t| {
                (p.transmission, p.roughness) = (1.0, 0.8);
                p.textures.roughness = channel(t, Channel::R);
            }),
        ),
        (
            "coloured sheet",
            textured(11, |p, t| {
                (p.transmission, p.roughness, p.thin) = (1.0, 0.4, true);
                p.textures.base_color = Some(t);
            }),
        ),
        (
            "coat and its roughness",
            textured(13, |p, t| {
                p.base_color = Rgb::new(0.5, 0.1, 0.1);
                (p.coat, p.coat_roughness, p.emission) = (1.0, 0.7, Rgb::new(0.2, 0.1, 0.3));
                p.textures.coat = channel(t, Channel::R);
                p.textures.coat_roughness = channel(t, Channel::G);
            }),
        ),
        (
            "sheen and its roughness",
            textured(14, |p, t| {
                p.base_color = Rgb::new(0.1, 0.2, 0.4);
                (p.sheen_color, p.sheen_roughness) = (Rgb::new(0.9, 0.8, 0.6), 1.0);
                p.textures.sheen_color = Some(t);
                p.textures.sheen_roughness = channel(t, Channel::A);
            }),
        ),
    ];
    let mut copies = stage();
    let texture = Texture::new(noise_image(&mut copies, 12));
    copies.meshes.push(laid_mesh(1, true));
    let mesh = MeshId(copies.meshes.len() as u32 - 1);
    for (x, scale) in [(-0.9, DVec3::splat(0.8)), (0.9, DVec3::new(-0.7, 0.9, 0.6))] {
        let place = DAffine3::from_translation(DVec3::new(x, 0.9, 0.0)) * DAffine3::from_scale(scale);
        let kind = principled(|p| p.textures.base_color = Some(texture));
        copies.object(Shape::Mesh(mesh), place, kind);
    }
    list.push(("base colour of instances", copies));
    list.into_iter().map(|(name, scene)| (name.to_owned(), scene)).collect()
}

/// Normal maps, by stored and by generated tangents, in mirrored pictures and by mirroring transforms.
pub(crate) fn normal_maps() -> Vec<(String, Scene)> {
    let mapped = |scene: &mut Scene, roughness: f32, scale: f32| {
        let texture = Texture::new(bumps(scene));
        principled(|p| {
            p.roughness = roughness;
            p.base_color = Rgb::new(0.7, 0.4, 0.2);
            p.textures.normal = Some(NormalTexture { texture, scale });
        })
    };
    let mut list = vec![
        ("normal map", laid_ball(true, |s| mapped(s, 0.4, 1.0))),
        ("normal map of flat faces, weak", laid_ball(false, |s| mapped(s, 0.6, 0.5))),
        ("normal map of a mirror's kind", laid_ball(true, |s| mapped(s, 0.0, 0.3))),
    ];
    let mut stored = laid_ball(true, |s| mapped(s, 0.5, 0.8));
    if let Some(mesh) = stored.meshes.last_mut() {
        let tangent = |(i, n): (usize, &Vec3)| {
            let t = n.any_orthonormal_vector();
            t.extend(if i / 3 % 2 == 0 { 1.0 } else { -1.0 })
        };
        mesh.tangents = mesh.normals.iter().enumerate().map(tangent).collect();
    }
    list.push(("normal map by stored tangents", stored));
    let mut mirrored = laid_ball(true, |s| mapped(s, 0.4, 0.9));
    if let Some(object) = mirrored.objects.last_mut() {
        object.transform = DAffine3::from_translation(MIDDLE)
            * DAffine3::from_rotation_y(0.7)
            * DAffine3::from_scale(DVec3::new(-0.8, 1.1, 0.9));
    }
    list.push(("normal map by a mirroring transform", mirrored));
    let mut copies = stage();
    let kind = mapped(&mut copies, 0.4, 1.0);
    copies.meshes.push(laid_mesh(1, true));
    let mesh = MeshId(copies.meshes.len() as u32 - 1);
    for (x, scale) in [(-0.9, DVec3::splat(0.8)), (0.9, DVec3::new(-0.7, 0.9, 0.6))] {
        let place = DAffine3::from_translation(DVec3::new(x, 0.9, 0.0)) * DAffine3::from_scale(scale);
        copies.object(Shape::Mesh(mesh), place, kind.clone());
    }
    list.push(("normal maps of instances", copies));
    let mut bare = laid_ball(true, |s| mapped(s, 0.4, 1.0));
    if let Some(mesh) = bare.meshes.last_mut() {
        mesh.uvs[0].clear();
    }
    list.push(("normal map without a frame", bare));
    list.into_iter().map(|(name, scene)| (name.to_owned(), scene)).collect()
}

/// Alpha in front of the camera, in the lamp's light, and in front of lights without an extent.
pub(crate) fn cutouts() -> Vec<(String, Scene)> {
    let leaf = |scene: &mut Scene, mode: AlphaMode, alpha: f32| {
        let texture = Texture::new(noise_image(scene, 20));
        principled(|p| {
            (p.alpha, p.alpha_mode, p.roughness) = (alpha, mode, 0.6);
            p.textures.base_color = Some(texture);
            p.textures.alpha = channel(texture, Channel::A);
        })
    };
    let mask = AlphaMode::Mask { cutoff: 0.4 };
    let front = MIDDLE + DVec3::new(0.2, 0.2, 1.3);
    let above = MIDDLE + DVec3::new(1.2, 1.4, 1.2);
    let mut list = Vec::new();
    for (name, mode, alpha) in [("mask", mask, 0.9), ("blend", AlphaMode::Blend, 0.8)] {
        let mut scene = stage();
        scene.sphere(MIDDLE, 1.0, principled(|p| p.roughness = 0.3));
        let kind = leaf(&mut scene, mode, alpha);
        sheet(&mut scene, front, 1.0, kind.clone());
        sheet(&mut scene, above, 1.6, kind);
        list.push((format!("{name} in front and in the lamp's light"), scene));
        let mut points = dark_stage();
        points.sphere(MIDDLE, 1.0, diffuse(0.6));
        let kind = leaf(&mut points, mode, alpha);
        sheet(&mut points, front, 1.0, kind.clone());
        sheet(&mut points, front + DVec3::new(0.1, 0.1, 0.3), 1.2, kind);
        let light = LightKind::Point { intensity: Rgb::new(60.0, 50.0, 30.0), radius: 0.0 };
        points.light(light, DAffine3::from_translation(DVec3::new(0.5, 2.0, 5.0)));
        let sun = LightKind::Sun { irradiance: Rgb::new(2.0, 3.0, 4.0), angle: 0.0 };
        points.light(sun, super::scenes::facing(DVec3::ZERO, DVec3::new(-0.1, 0.6, 1.0).normalize()));
        list.push((format!("{name} before points"), points));
    }
    // A ball, in and out of which a path may pass, over itself and over glass.
    let mut balls = stage();
    let veil = principled(|p| {
        (p.alpha, p.alpha_mode, p.roughness) = (0.5, AlphaMode::Blend, 0.4);
        p.base_color = Rgb::new(0.8, 0.3, 0.2);
    });
    balls.sphere(MIDDLE, 1.0, veil.clone());
    balls.sphere(MIDDLE, 0.6, super::scenes::glass(1.4));
    let absorbing = principled(|p| {
        (p.alpha, p.alpha_mode, p.roughness, p.transmission) = (0.6, AlphaMode::Blend, 0.4, 1.0);
        p.absorption = Some(epsilux::scene::Absorption { color: Rgb::new(0.8, 0.5, 0.3), distance: 0.4 });
    });
    balls.sphere(DVec3::new(1.5, 0.5, 0.9), 0.5, absorbing);
    balls.sphere(DVec3::new(-1.5, 0.5, 0.9), 0.5, veil);
    if let Some(object) = balls.objects.last_mut() {
        object.visible_to_camera = false;
    }
    list.push(("half there balls, glass behind one and inside of one".into(), balls));
    list
}

/// Colours of vertices, with alpha and without.
pub(crate) fn vertex_colors() -> Vec<(String, Scene)> {
    let paint = |scene: &mut Scene, fade: bool| {
        if let Some(mesh) = scene.meshes.last_mut() {
            mesh.colors = mesh
                .positions
                .iter()
                .map(|p| {
                    let c = 0.5 + 0.6 * *p;
                    Vec4::new(
                        c.x.max(0.0),
                        c.y.max(0.0),
                        c.z.max(0.0),
                        if fade { 0.5 + 0.5 * p.y } else { 1.0 },
                    )
                })
                .collect();
        }
    };
    let mut matt = laid_ball(true, |_| diffuse(0.8));
    paint(&mut matt, false);
    let mut plastic = laid_ball(true, |_| principled(|p| p.roughness = 0.3));
    paint(&mut plastic, false);
    let mut glassy = laid_ball(true, |_| principled(|p| (p.transmission, p.roughness) = (1.0, 0.0)));
    paint(&mut glassy, false);
    let mut faded = textured(30, |p, t| {
        p.alpha_mode = AlphaMode::Blend;
        p.textures.base_color = Some(t);
    });
    paint(&mut faded, true);
    [
        ("coloured vertices, diffuse", matt),
        ("coloured vertices, principled", plastic),
        ("coloured vertices of smooth glass", glassy),
        ("coloured and faded vertices over a picture", faded),
    ]
    .map(|(name, scene)| (name.to_owned(), scene))
    .to_vec()
}

/// Surfaces whose light comes from a picture.
pub(crate) fn emissive() -> Vec<(String, Scene)> {
    let glow = |scene: &mut Scene, texels: Texels, change: &dyn Fn(&mut Principled, Texture)| {
        let texture = Texture::new(add_image(scene, 5, 4, texels));
        principled(|p| {
            (p.emission, p.specular, p.base_color) = (Rgb::new(4.0, 5.0, 6.0), 0.0, Rgb::grey(0.2));
            p.textures.emission = Some(texture);
            change(p, texture);
        })
    };
    let bytes = || Texels::Byte(noise(40, 20));
    let lamp = |scene: &mut Scene, kind| {
        scene.quad(DVec3::new(0.3, 3.2, 0.6), 6.0 * DVec3::X, 5.0 * DVec3::new(0.0, 0.2, 1.0), kind);
        if let Some(mesh) = scene.meshes.last_mut() {
            mesh.uvs[0] = [[0.1, 0.2], [1.3, 0.1], [1.2, 0.9], [-0.1, 1.4]].map(Vec2::from).to_vec();
        }
    };
    let mut square = dark_stage();
    square.sphere(MIDDLE, 1.0, principled(|p| p.roughness = 0.3));
    let kind = glow(&mut square, bytes(), &|_, _| ());
    lamp(&mut square, kind);
    let mut holes = dark_stage();
    holes.sphere(MIDDLE, 1.0, principled(|p| p.roughness = 0.3));
    let kind = glow(&mut holes, bytes(), &|p, t| {
        p.alpha_mode = AlphaMode::Blend;
        p.textures.alpha = channel(Texture { scale: [0.7, 1.2], ..t }, Channel::A);
    });
    lamp(&mut holes, kind);
    let mut mesh = dark_stage();
    // Half of the picture is black, and with it many of the triangles.
    let black = |(i, t)| if i % 5 < 3 { [0, 0, 0, 255] } else { t };
    let dark = noise(41, 20).into_iter().enumerate().map(black);
    let kind = glow(&mut mesh, Texels::Byte(dark.collect()), &|p, _| p.base_color = Rgb::grey(0.6));
    mesh.meshes.push(laid_mesh(1, true));
    let id = MeshId(mesh.meshes.len() as u32 - 1);
    mesh.object(Shape::Mesh(id), at_middle() * DAffine3::from_scale(DVec3::splat(1.2)), kind);
    let mut bright = dark_stage();
    bright.sphere(MIDDLE, 1.0, diffuse(0.7));
    let floats = noise(42, 20).iter().map(|&[r, g, b, _]| [r, g, b].map(|c| f32::from(c) / 60.0)).collect();
    let kind = glow(&mut bright, Texels::Float(floats), &|_, _| ());
    lamp(&mut bright, kind);
    [
        ("a picture on a square lamp", square),
        ("a picture on a square lamp with holes", holes),
        ("a picture on a glowing mesh", mesh),
        ("a bright picture on a square lamp", bright),
    ]
    .map(|(name, scene)| (name.to_owned(), scene))
    .to_vec()
}

/// Textures of surfaces that reflect and transmit.
pub(crate) fn textures() -> Vec<(String, Scene)> {
    lays().into_iter().chain(slots()).collect()
}

/// All of it at once.
pub(crate) fn everything_textured() -> Scene {
    let mut scene = stage();
    let picture = Texture::new(noise_image(&mut scene, 50));
    let bump = Texture::new(bumps(&mut scene));
    scene.meshes.push(laid_mesh(1, true));
    let mut painted = laid_mesh(1, true);
    painted.colors = painted.positions.iter().map(|p| (0.5 + 0.5 * *p).extend(0.5 + 0.5 * p.x)).collect();
    scene.meshes.push(painted);
    let n = scene.meshes.len() as u32;
    let place = |x: f64, z: f64, scale: DVec3| {
        DAffine3::from_translation(DVec3::new(x, 0.6, z)) * DAffine3::from_scale(0.6 * scale)
    };
    let bumpy = principled(|p| {
        p.metallic = 1.0;
        p.textures.base_color = Some(picture);
        p.textures.roughness = channel(picture, Channel::G);
        p.textures.metallic = channel(picture, Channel::B);
        p.textures.normal = Some(NormalTexture { texture: bump, scale: 0.7 });
    });
    let glassy = principled(|p| {
        p.transmission = 0.9;
        p.roughness = 0.4;
        p.textures.base_color = Some(Texture { uv_set: 1, ..picture });
        p.textures.transmission = channel(picture, Channel::R);
    });
    let faded = principled(|p| {
        p.alpha_mode = AlphaMode::Blend;
        p.textures.alpha = channel(picture, Channel::A);
    });
    scene.object(Shape::Mesh(MeshId(n - 2)), place(-1.3, 0.0, DVec3::ONE), bumpy);
    scene.object(Shape::Mesh(MeshId(n - 2)), place(0.0, 0.5, DVec3::new(-1.0, 1.0, 1.0)), glassy);
    scene.object(Shape::Mesh(MeshId(n - 1)), place(1.3, 0.0, DVec3::ONE), faded);
    let lamp = principled(|p| {
        p.emission = Rgb::grey(5.0);
        p.textures.emission = Some(picture);
    });
    sheet(&mut scene, DVec3::new(-0.6, 2.0, -1.0), 1.5, lamp);
    let leaf = principled(|p| {
        p.alpha_mode = AlphaMode::Mask { cutoff: 0.5 };
        p.textures.alpha = channel(picture, Channel::A);
    });
    sheet(&mut scene, DVec3::new(0.5, 0.9, 1.9), 0.8, leaf);
    scene
}

//! Tiny scenes, each around one feature, and one scene with everything: what two integrators are
//! compared on where no closed form is known.
//!
//! All of them show a stage: a floor, a ball of radius one that touches it, a lamp and a dim sky. The
//! lamp is large, so that an integrator finds it that never looks for lights.

use epsilux::color::Rgb;
use epsilux::glam::{DAffine3, DMat3, DVec3, Vec3};
use epsilux::scene::{
    Absorption, AreaShape, Camera, Environment, EnvironmentImage, FovAxis, Glass, Image, ImageId, Lens,
    LightKind, MaterialKind, Mesh, MeshId, Pixels, Principled, Projection, Scene, Shape, Sides, SpotFalloff,
    Texels,
};

use super::scenes::{Build, diffuse, emitter, facing, glass, principled};

/// Where the ball of a stage is.
pub(crate) const MIDDLE: DVec3 = DVec3::new(0.0, 1.0, 0.0);

/// A camera at `eye` that looks at `target`.
pub(crate) fn camera(eye: DVec3, target: DVec3, fov: f64) -> Camera {
    let back = (eye - target).normalize();
    let right = DVec3::Y.cross(back).normalize();
    Camera {
        name: "front".into(),
        transform: DAffine3::from_mat3_translation(DMat3::from_cols(right, back.cross(right), back), eye),
        projection: Projection::Perspective { fov: fov.to_radians(), axis: FovAxis::Horizontal },
        shift: [0.0; 2],
        lens: None,
        aspect: None,
    }
}

/// Floor, camera, and a sky of colours.
pub(crate) fn dark_stage() -> Scene {
    let mut scene = Scene::default();
    let floor = MaterialKind::Diffuse { color: Rgb::new(0.6, 0.5, 0.3) };
    scene.quad(DVec3::ZERO, 12.0 * DVec3::Z, 12.0 * DVec3::X, floor);
    scene.cameras.push(camera(DVec3::new(0.0, 2.2, 6.0), DVec3::new(0.0, 0.8, 0.0), 30.0));
    scene
}

/// The same with a lamp and a sky.
pub(crate) fn stage() -> Scene {
    let mut scene = dark_stage();
    scene.sphere(DVec3::new(3.5, 5.5, 3.0), 3.0, emitter(2.0));
    scene.environment = Some(Environment {
        name: "sky".into(),
        radiance: Rgb::new(0.3, 0.4, 0.6),
        image: None,
        visible_to_camera: true,
    });
    scene
}

fn ball(kind: MaterialKind) -> Scene {
    let mut scene = stage();
    scene.sphere(MIDDLE, 1.0, kind);
    scene
}

fn lit(kind: LightKind, transform: DAffine3) -> Scene {
    let mut scene = dark_stage();
    scene.sphere(MIDDLE, 1.0, principled(|p| p.roughness = 0.4));
    scene.light(kind, transform);
    scene
}

/// An octahedron whose faces are divided `levels` times, on the unit sphere; its normals are those of
/// the sphere. Winds counter-clockwise as seen from outside.
pub(crate) fn round_mesh(levels: u32, smooth: bool) -> Mesh {
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z];
    let mut faces = Vec::new();
    for (sx, sy, sz) in (0..8).map(|i| (i & 1, i >> 1 & 1, i >> 2)) {
        let sign = |s: i32| if s == 0 { 1.0 } else { -1.0 };
        let (a, b, c) = (x * sign(sx), y * sign(sy), z * sign(sz));
        faces.push(if sign(sx) * sign(sy) * sign(sz) > 0.0 { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..levels {
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [(a + b), (b + c), (c + a)].map(Vec3::normalize);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions: Vec<Vec3> = faces.iter().flatten().copied().collect();
    let triangles = (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let normals = if smooth { positions.clone() } else { Vec::new() };
    Mesh { name: "round".into(), positions, normals, triangles, ..Mesh::default() }
}

/// Copies of one mesh, placed by `transforms`, each in a material of its own.
fn copies(scene: &mut Scene, mesh: Mesh, placed: Vec<(DAffine3, MaterialKind)>) {
    let id = MeshId(scene.meshes.len() as u32);
    scene.meshes.push(mesh);
    for (transform, kind) in placed {
        scene.object(Shape::Mesh(id), transform, kind);
    }
}

fn placed(scale: DVec3, turn: f64, at: DVec3) -> DAffine3 {
    DAffine3::from_translation(at) * DAffine3::from_rotation_y(turn) * DAffine3::from_scale(scale)
}

/// Glass that tints and absorbs.
pub(crate) fn tinted_glass(ior: f32, distance: f32) -> MaterialKind {
    let absorption = Some(Absorption { color: Rgb::new(0.8, 0.5, 0.3), distance });
    MaterialKind::Glass(Glass { ior, tint: Rgb::new(0.7, 0.9, 1.0), absorption, priority: None })
}

/// Materials, each on the ball of a stage.
pub(crate) fn materials() -> Vec<(String, Scene)> {
    let mut list: Vec<(String, MaterialKind)> = vec![
        ("diffuse".into(), diffuse(0.7)),
        ("mirror".into(), super::scenes::mirror(0.9)),
        ("clear glass".into(), glass(1.5)),
        ("absorbing glass".into(), tinted_glass(1.5, 1.0)),
        ("absorber of index one".into(), tinted_glass(1.0, 1.0)),
        ("bubble".into(), glass(0.7)),
    ];
    let gold = Rgb::new(1.0, 0.7, 0.3);
    for roughness in [0.0, 0.25, 0.6, 1.0] {
        let mut add = |name: &str, change: &dyn Fn(&mut Principled)| {
            let kind = principled(|p| {
                (p.roughness, p.base_color) = (roughness, gold);
                change(p);
            });
            list.push((format!("{name}, roughness {roughness}"), kind));
        };
        add("metal", &|p| p.metallic = 1.0);
        add("dark metal", &|p| {
            p.metallic = 1.0;
            p.base_color = Rgb::BLACK;
        });
        add("plastic", &|_| ());
        add("strong tinted layer", &|p| {
            p.ior = 1.8;
            p.specular_color = Rgb::new(2.0, 1.0, 4.0);
        });
        add("weak layer", &|p| {
            p.specular = 0.3;
            p.specular_color = Rgb::new(0.2, 1.0, 0.6);
        });
        add("glass of roughness", &|p| {
            p.transmission = 1.0;
            p.transmission_tint = Rgb::new(0.9, 0.6, 0.8);
        });
        add("absorbing glass of roughness", &|p| {
            p.transmission = 1.0;
            p.absorption = Some(Absorption { color: Rgb::new(0.8, 0.5, 0.3), distance: 1.0 });
        });
        add("rough glass of index one", &|p| {
            p.transmission = 1.0;
            p.ior = 1.0;
            p.transmission_tint = Rgb::new(0.9, 0.6, 0.8);
            p.absorption = Some(Absorption { color: Rgb::new(0.8, 0.5, 0.3), distance: 1.0 });
        });
        add("sheet", &|p| {
            p.transmission = 1.0;
            p.thin = true;
            p.transmission_tint = Rgb::new(0.9, 0.6, 0.8);
            // A sheet has no inside, and absorbs nothing there.
            p.absorption = Some(Absorption { color: Rgb::new(0.8, 0.5, 0.3), distance: 1.0 });
        });
        add("mixture", &|p| {
            p.metallic = 0.4;
            p.transmission = 0.5;
            p.emission = Rgb::new(0.1, 0.2, 0.05);
        });
        add("mixture of index one", &|p| {
            p.metallic = 0.3;
            p.transmission = 0.5;
            p.ior = 1.0;
        });
    }
    list.into_iter().map(|(name, kind)| (name, ball(kind))).collect()
}

/// Coat and sheen, each on the ball of a stage.
pub(crate) fn layers() -> Vec<(String, Scene)> {
    let blue = Rgb::new(0.1, 0.3, 0.7);
    let mut list = Vec::new();
    let mut add = |name: &str, change: &dyn Fn(&mut Principled)| {
        let kind = principled(|p| {
            (p.roughness, p.base_color) = (0.5, blue);
            change(p);
        });
        list.push((name.to_owned(), ball(kind)));
    };
    add("rough coat", &|p| (p.coat, p.coat_roughness) = (0.9, 0.4));
    add("smooth coat over a rough base", &|p| (p.coat, p.coat_ior) = (1.0, 1.8));
    add("rough coat over a smooth base", &|p| (p.coat, p.coat_roughness, p.roughness) = (0.7, 0.6, 0.0));
    add("smooth coat over smooth metal", &|p| (p.coat, p.roughness, p.metallic) = (0.8, 0.0, 1.0));
    add("rough coat over metal", &|p| (p.coat, p.coat_roughness, p.metallic) = (1.0, 0.3, 1.0));
    add("coat over smooth glass", &|p| {
        (p.coat, p.coat_roughness, p.roughness, p.transmission) = (0.5, 0.5, 0.0, 1.0);
    });
    add("coat over rough glass", &|p| (p.coat, p.coat_roughness, p.transmission) = (0.5, 0.7, 1.0));
    add("coat over emission", &|p| {
        (p.coat, p.coat_ior, p.coat_roughness) = (1.0, 2.2, 0.5);
        p.emission = Rgb::new(2.0, 1.0, 0.5);
    });
    add("smooth coat and sheen over emission", &|p| {
        (p.coat, p.coat_ior, p.sheen_color) = (1.0, 2.2, Rgb::new(0.9, 0.2, 0.1));
        p.emission = Rgb::new(2.0, 1.0, 0.5);
    });
    add("coat of index one", &|p| (p.coat, p.coat_ior, p.coat_roughness) = (1.0, 1.0, 0.5));
    for roughness in [0.0, 0.2, 0.5, 1.0] {
        add(&format!("sheen of roughness {roughness}"), &|p| {
            (p.sheen_color, p.sheen_roughness) = (Rgb::new(1.0, 0.8, 0.4), roughness);
        });
    }
    add("sheen over nothing but diffuse", &|p| {
        (p.sheen_color, p.sheen_roughness, p.specular) = (Rgb::new(0.3, 0.8, 0.4), 0.4, 0.0);
    });
    add("sheen over coat", &|p| {
        (p.coat, p.coat_roughness, p.sheen_color) = (0.9, 0.2, Rgb::new(0.3, 0.8, 0.4));
    });
    // A flat lamp under a coat: what a light sample must dim, at all angles.
    let mut lamp = dark_stage();
    lamp.sphere(MIDDLE, 1.0, diffuse(0.7));
    let coated = principled(|p| {
        p.base_color = Rgb::grey(0.2);
        (p.coat, p.coat_ior, p.coat_roughness) = (1.0, 2.5, 0.3);
        p.emission = Rgb::new(4.0, 3.0, 2.0);
    });
    lamp.quad(DVec3::new(0.0, 4.0, 0.0), 5.0 * DVec3::X, 5.0 * DVec3::Z, coated);
    list.push(("coated lamp".to_owned(), lamp));
    list
}

/// A picture of all directions as the only light of a stage, turned.
pub(crate) fn under(mut scene: Scene, size: [u32; 2], texels: Texels) -> Scene {
    let image = ImageId(scene.images.len() as u32);
    let pixels = Pixels { width: size[0], height: size[1], texels };
    scene.images.push(Image {
        name: "sky".into(),
        file: None,
        encoded: None,
        pixels: Some(std::sync::Arc::new(pixels)),
    });
    scene.environment = Some(Environment {
        name: "sky".into(),
        radiance: Rgb::new(0.8, 1.0, 1.2),
        image: Some(EnvironmentImage { image, rotation: 2.0 }),
        visible_to_camera: true,
    });
    scene
}

/// Pictures as environments.
pub(crate) fn panoramas() -> Vec<(String, Scene)> {
    let lit = |kind: MaterialKind| {
        let mut scene = dark_stage();
        scene.sphere(MIDDLE, 1.0, kind);
        scene
    };
    let sun = |x: u32, y: u32| if (x, y) == (3, 2) { [200.0, 180.0, 100.0] } else { [0.2, 0.15, 0.1] };
    let gradient = |x: u32, y: u32| [0.1 * x as f32, 0.2 * (8 - y) as f32, 0.5 + 0.03 * (x * y) as f32];
    let float =
        |f: &dyn Fn(u32, u32) -> [f32; 3]| Texels::Float((0..128).map(|i| f(i % 16, i / 16)).collect());
    let matt = || principled(|p| p.roughness = 0.4);
    let bytes = (0..6u8).map(|i| [200 - 40 * i, 30 * i, 120, 255]).collect();
    let shorts = (0..3u16).map(|i| [60_000 - 20_000 * i, 30_000 * i, 12_000, 65_535]).collect();
    let rough_glass = || principled(|p| (p.roughness, p.transmission) = (0.4, 1.0));
    let coat = principled(|p| (p.coat, p.sheen_color) = (1.0, Rgb::new(0.3, 0.8, 0.4)));
    let mut hidden = under(lit(diffuse(0.6)), [16, 8], float(&gradient));
    if let Some(sky) = &mut hidden.environment {
        sky.visible_to_camera = false;
    }
    let mut lamps = under(lit(matt()), [16, 8], float(&sun));
    lamps.sphere(DVec3::new(3.5, 5.5, 3.0), 3.0, emitter(2.0));
    [
        ("picture with a sun", under(lit(matt()), [16, 8], float(&sun))),
        ("picture with a sun, diffuse", under(lit(diffuse(0.7)), [16, 8], float(&sun))),
        ("picture with a sun, glass of roughness", under(lit(rough_glass()), [16, 8], float(&sun))),
        ("picture with a sun and a lamp", lamps),
        ("picture of a gradient", under(lit(matt()), [16, 8], float(&gradient))),
        ("picture of a gradient, glass of roughness", under(lit(rough_glass()), [16, 8], float(&gradient))),
        ("picture of a gradient, coat and sheen", under(lit(coat), [16, 8], float(&gradient))),
        ("picture of a gradient, mirror", under(lit(super::scenes::mirror(0.9)), [16, 8], float(&gradient))),
        ("hidden picture", hidden),
        ("picture of three by two bytes", under(lit(matt()), [3, 2], Texels::Byte(bytes))),
        ("picture of one by three shorts", under(lit(matt()), [1, 3], Texels::Short(shorts))),
    ]
    .map(|(name, scene)| (name.to_owned(), scene))
    .to_vec()
}

/// Lights of every kind, each on a stage without other light.
pub(crate) fn lights() -> Vec<(String, Scene)> {
    let above = DVec3::new(2.0, 4.0, 1.0);
    let aim = facing(above, (above - MIDDLE).normalize());
    let color = Rgb::new(8.0, 6.0, 3.0);
    let spot =
        |falloff, radius| LightKind::Spot { intensity: color * 4.0, inner: 0.2, outer: 0.7, falloff, radius };
    let area = |shape, size| LightKind::Area { shape, size, radiance: color };
    let stretch = |x, y, z| aim * DAffine3::from_scale(DVec3::new(x, y, z));
    let shear =
        DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::new(0.7, 1.0, 0.0), DVec3::new(0.2, 0.3, 1.0)));
    let mut list = vec![
        ("point", lit(LightKind::Point { intensity: color * 4.0, radius: 0.0 }, aim)),
        ("point of a radius", lit(LightKind::Point { intensity: color * 4.0, radius: 1.5 }, aim)),
        (
            "scaled point of a radius",
            lit(LightKind::Point { intensity: color * 4.0, radius: 0.5 }, stretch(3.0, 3.0, 3.0)),
        ),
        ("spot", lit(spot(SpotFalloff::Gltf, 0.0), aim)),
        ("spot with Blender's falloff", lit(spot(SpotFalloff::Blender, 0.0), aim)),
        ("spot of a radius", lit(spot(SpotFalloff::Blender, 1.5), aim)),
        ("sharp sun", lit(LightKind::Sun { irradiance: color, angle: 0.0 }, aim)),
        ("wide sun", lit(LightKind::Sun { irradiance: color, angle: 1.2 }, aim)),
        ("rectangle", lit(area(AreaShape::Rectangle, [5.0, 4.0]), aim)),
        ("stretched rectangle", lit(area(AreaShape::Rectangle, [1.0, 1.0]), stretch(5.0, 4.0, 0.5))),
        ("mirrored rectangle", lit(area(AreaShape::Rectangle, [5.0, 4.0]), stretch(-1.0, 1.0, 1.0))),
        ("ellipse", lit(area(AreaShape::Ellipse, [5.0, 4.0]), aim)),
        ("sheared ellipse", lit(area(AreaShape::Ellipse, [5.0, 3.0]), aim * shear)),
        ("mirrored ellipse", lit(area(AreaShape::Ellipse, [5.0, 4.0]), stretch(1.0, -1.5, 1.0))),
    ];
    // Seen by the camera and in front of the ball, and hidden from it.
    let front = facing(DVec3::new(0.3, 1.6, 1.8), DVec3::new(0.1, -0.3, -1.0).normalize());
    for (name, shape, visible) in [
        ("rectangle in view", AreaShape::Rectangle, true),
        ("hidden rectangle in view", AreaShape::Rectangle, false),
        ("ellipse in view", AreaShape::Ellipse, true),
    ] {
        let mut scene = stage();
        scene.sphere(MIDDLE, 1.0, principled(|p| p.roughness = 0.2));
        scene.light(area(shape, [1.0, 0.8]), front).lights[0].visible_to_camera = visible;
        list.push((name, scene));
    }
    let mut hidden_ball = stage();
    hidden_ball.sphere(MIDDLE, 1.0, diffuse(0.5));
    hidden_ball.light(
        LightKind::Point { intensity: color, radius: 0.5 },
        facing(DVec3::new(0.5, 2.0, 1.5), DVec3::Z),
    );
    hidden_ball.lights[0].visible_to_camera = false;
    list.push(("hidden point of a radius", hidden_ball));
    let mut hidden_sky = ball(super::scenes::mirror(0.9));
    if let Some(sky) = &mut hidden_sky.environment {
        sky.visible_to_camera = false;
    }
    list.push(("hidden sky", hidden_sky));
    let mut hidden_sun = lit(
        LightKind::Sun { irradiance: color, angle: 1.2 },
        facing(DVec3::ZERO, DVec3::new(0.0, 0.7, -1.0).normalize()),
    );
    hidden_sun.lights[0].visible_to_camera = false;
    list.push(("hidden sun behind", hidden_sun));
    list.extend(emissive_surfaces());
    list.into_iter().map(|(name, scene)| (name.to_owned(), scene)).collect()
}

fn emissive_surfaces() -> Vec<(&'static str, Scene)> {
    let both = MaterialKind::Light { radiance: Rgb::new(5.0, 4.0, 2.0), sides: Sides::Both };
    // Three triangles that are no rectangle, seen from both sides.
    let mut triangles = dark_stage();
    triangles.sphere(MIDDLE, 1.0, principled(|p| p.roughness = 0.3));
    let corners = [[-2.0, 3.0, 0.5], [3.0, 3.5, 0.0], [2.5, 3.2, 3.5], [-2.5, 2.9, 3.6], [3.2, 1.0, 1.2]];
    triangles.meshes.push(Mesh {
        positions: corners.map(Vec3::from_array).to_vec(),
        triangles: vec![[0, 2, 1], [0, 3, 2], [1, 2, 4]],
        ..Mesh::default()
    });
    let mesh = MeshId(triangles.meshes.len() as u32 - 1);
    triangles.object(Shape::Mesh(mesh), DAffine3::IDENTITY, both.clone());
    // Camera and ball inside of a sphere that glows on both sides, and reflects.
    let mut inside = dark_stage();
    inside.sphere(MIDDLE, 1.0, principled(|p| p.roughness = 0.3));
    inside.sphere(
        DVec3::ZERO,
        9.0,
        principled(|p| {
            p.base_color = Rgb::grey(0.4);
            p.emission = Rgb::new(0.5, 0.3, 0.2);
        }),
    );
    // A ball that glows and reflects, lit by the lamp, resting on the floor that it lights.
    let mut glowing = stage();
    glowing.sphere(
        MIDDLE,
        1.0,
        principled(|p| {
            p.roughness = 0.5;
            p.emission = Rgb::new(0.6, 0.2, 0.1);
        }),
    );
    // The front of the ball's shell glows; it is glass that is seen from inside too.
    let mut glass_lamp = stage();
    glass_lamp.sphere(
        MIDDLE,
        1.0,
        principled(|p| {
            p.roughness = 0.4;
            p.transmission = 1.0;
            p.emission = Rgb::new(0.3, 0.2, 0.1);
        }),
    );
    // Two triangles that form a rectangle, in a mirrored copy.
    let mut mirrored = dark_stage();
    mirrored.sphere(MIDDLE, 1.0, diffuse(0.7));
    mirrored.quad(DVec3::ZERO, 5.0 * DVec3::Z, 5.0 * DVec3::X, emitter(5.0));
    if let Some(lamp) = mirrored.objects.last_mut() {
        lamp.transform = placed(DVec3::new(1.0, -1.0, 1.0), 0.4, DVec3::new(0.5, 4.0, 0.0));
    }
    // A sheet that glows and reflects what the lamp sends.
    let mut sheet = stage();
    let glowing_sheet = principled(|p| {
        p.roughness = 0.5;
        p.emission = Rgb::new(0.6, 0.4, 0.8);
    });
    sheet.quad(DVec3::new(0.2, 1.3, 0.0), 2.0 * DVec3::X, DVec3::new(0.0, 2.0, 0.3), glowing_sheet);
    vec![
        ("a sheet that glows and reflects", sheet),
        ("triangles that shine on both sides", triangles),
        ("inside of a sphere that glows and reflects", inside),
        ("a ball that glows and reflects", glowing),
        ("rough glass that glows", glass_lamp),
        ("a mirrored square lamp", mirrored),
    ]
}

/// Shadow rays in and out of absorbing bodies.
pub(crate) fn lights_and_media() -> Vec<(String, Scene)> {
    let color = Rgb::new(40.0, 30.0, 15.0);
    let rough = |index: f32| {
        principled(|p| {
            p.roughness = 0.5;
            p.transmission = 1.0;
            p.ior = index;
            p.absorption = Some(Absorption { color: Rgb::new(0.8, 0.5, 0.3), distance: 0.7 });
        })
    };
    let point = LightKind::Point { intensity: color, radius: 0.0 };
    let mut behind = dark_stage();
    behind.sphere(MIDDLE, 1.0, rough(1.4));
    behind.light(point, DAffine3::from_translation(DVec3::new(1.0, 2.5, -2.5)));
    let mut within = dark_stage();
    within.sphere(MIDDLE, 1.0, rough(1.4));
    within.light(point, DAffine3::from_translation(DVec3::new(0.2, 1.1, 0.3)));
    // A lamp in the middle of the ball, and a diffuse core beside it.
    let mut core = stage();
    core.sphere(MIDDLE, 1.0, rough(1.3));
    core.sphere(MIDDLE + DVec3::new(0.3, 0.2, 0.0), 0.4, emitter(3.0));
    core.sphere(MIDDLE + DVec3::new(-0.45, 0.0, 0.2), 0.3, diffuse(0.8));
    let mut free = dark_stage();
    free.sphere(MIDDLE, 1.0, rough(1.3));
    free.light(LightKind::Point { intensity: color, radius: 0.4 }, DAffine3::from_translation(MIDDLE));
    let mut smooth = dark_stage();
    smooth.sphere(MIDDLE, 1.0, tinted_glass(1.0, 0.7));
    smooth.sphere(MIDDLE, 0.5, diffuse(0.8));
    smooth.light(
        LightKind::Point { intensity: color, radius: 0.0 },
        DAffine3::from_translation(DVec3::new(0.1, 1.7, 0.3)),
    );
    [
        ("a point behind absorbing rough glass", behind),
        ("a point inside of absorbing rough glass", within),
        ("a lamp inside of absorbing rough glass", core),
        ("a free sphere inside of absorbing rough glass", free),
        ("a point inside of an absorber", smooth),
    ]
    .map(|(name, scene)| (name.to_owned(), scene))
    .to_vec()
}

/// Meshes, instances, normals and cameras.
pub(crate) fn shapes_and_cameras() -> Vec<(String, Scene)> {
    let matt = || principled(|p| p.roughness = 0.3);
    let three = |a: MaterialKind, b: MaterialKind| {
        vec![
            (placed(DVec3::splat(0.8), 0.3, DVec3::new(-0.7, 0.8, 0.0)), a),
            (placed(DVec3::new(-0.6, 0.9, 0.6), 0.9, DVec3::new(0.8, 0.9, 0.3)), b),
        ]
    };
    let mut list = Vec::new();
    for (name, smooth) in [("flat instances", false), ("smooth instances", true)] {
        let mut scene = stage();
        copies(&mut scene, round_mesh(1, smooth), three(matt(), diffuse(0.6)));
        list.push((name, scene));
    }
    let mut glassy = stage();
    copies(&mut glassy, round_mesh(1, true), three(glass(1.5), super::scenes::mirror(0.9)));
    list.push(("smooth instances of glass and mirror", glassy));
    let mut rough = stage();
    let rough_glass = principled(|p| {
        p.transmission = 1.0;
        p.roughness = 0.4;
    });
    copies(&mut rough, round_mesh(1, true), three(rough_glass, tinted_glass(1.3, 0.5)));
    list.push(("smooth instances of rough and absorbing glass", rough));
    let mut single = stage();
    let squeezed = placed(DVec3::new(-0.7, 1.1, 0.9), 0.5, MIDDLE);
    copies(&mut single, round_mesh(1, true), vec![(squeezed, matt())]);
    list.push(("one smooth mesh, mirrored", single));
    let mut hidden = stage();
    hidden.sphere(MIDDLE, 1.0, diffuse(0.7));
    copies(&mut hidden, round_mesh(1, false), three(matt(), diffuse(0.2)));
    let n = hidden.objects.len();
    for object in [n - 1, n - 3] {
        hidden.objects[object].visible_to_camera = false;
    }
    list.push(("hidden ball and hidden instance", hidden));
    let mut lens = ball(matt());
    lens.cameras[0].lens = Some(Lens { radius: 0.4, focus_distance: 4.0 });
    list.push(("lens", lens));
    let mut flat = ball(matt());
    flat.cameras[0].projection = Projection::Orthographic { extent: 3.0, axis: FovAxis::Vertical };
    flat.cameras[0].shift = [0.2, -0.1];
    list.push(("orthographic, shifted", flat));
    let mut tall = ball(matt());
    tall.cameras[0].projection = Projection::Perspective { fov: 0.5, axis: FovAxis::Vertical };
    tall.cameras[0].shift = [-0.1, 0.15];
    list.push(("vertical angle, shifted", tall));
    list.into_iter().map(|(name, scene)| (name.to_owned(), scene)).collect()
}

/// Everything at once.
pub(crate) fn everything() -> Scene {
    let mut scene = stage();
    let gold = principled(|p| {
        p.metallic = 1.0;
        p.roughness = 0.3;
        p.base_color = Rgb::new(1.0, 0.7, 0.3);
    });
    let plastic = principled(|p| {
        p.roughness = 0.4;
        p.base_color = Rgb::new(0.1, 0.3, 0.7);
        p.emission = Rgb::new(0.02, 0.0, 0.05);
    });
    let rough_glass = principled(|p| {
        p.transmission = 1.0;
        p.roughness = 0.5;
        p.absorption = Some(Absorption { color: Rgb::new(0.8, 0.5, 0.3), distance: 1.0 });
    });
    let sheet = principled(|p| {
        p.transmission = 0.8;
        p.thin = true;
        p.roughness = 0.3;
    });
    let smooth = principled(|p| {
        p.roughness = 0.0;
        p.metallic = 0.3;
        p.transmission = 0.3;
    });
    let at = |x: f64, y: f64, z: f64| placed(DVec3::splat(0.5), x, DVec3::new(x, y, z));
    let mut mirrored = at(0.6, 0.5, 1.2);
    mirrored.matrix3.x_axis *= -1.0;
    copies(
        &mut scene,
        round_mesh(1, true),
        vec![(at(-0.9, 0.5, 1.0), gold), (mirrored, rough_glass), (at(0.0, 1.7, -0.6), plastic)],
    );
    scene.sphere(DVec3::new(-1.2, 0.6, -0.6), 0.6, tinted_glass(1.5, 1.0));
    scene.sphere(DVec3::new(1.3, 0.6, -0.4), 0.6, smooth);
    scene.quad(DVec3::new(-0.1, 0.8, 1.9), 0.7 * DVec3::X, DVec3::new(0.0, 1.0, -0.3), sheet);
    scene.object(
        Shape::Sphere { radius: 0.3 },
        DAffine3::from_translation(DVec3::new(0.1, 0.3, 0.6)),
        super::scenes::mirror(0.9),
    );
    if let Some(object) = scene.objects.last_mut() {
        object.visible_to_camera = false;
    }
    let color = Rgb::new(3.0, 4.0, 6.0);
    let over = |x: f64, z: f64| facing(DVec3::new(x, 4.0, z), DVec3::new(0.2 * x, 1.0, 0.2 * z).normalize());
    scene
        .light(LightKind::Point { intensity: color, radius: 0.0 }, over(-2.0, 2.0))
        .light(
            LightKind::Spot {
                intensity: color * 3.0,
                inner: 0.1,
                outer: 0.6,
                falloff: SpotFalloff::Blender,
                radius: 0.0,
            },
            over(1.0, -1.5),
        )
        .light(LightKind::Sun { irradiance: color * 0.1, angle: 0.0 }, over(-1.0, -1.0))
        .light(LightKind::Sun { irradiance: color * 0.2, angle: 0.5 }, over(2.0, 1.0))
        .light(
            LightKind::Area { shape: AreaShape::Ellipse, size: [2.0, 1.0], radiance: color },
            over(-2.5, 0.0),
        )
        .light(
            LightKind::Area { shape: AreaShape::Rectangle, size: [1.0, 2.0], radiance: color },
            over(0.0, 1.0),
        )
        .light(LightKind::Point { intensity: color * 0.4, radius: 0.3 }, over(1.5, 2.5));
    scene.cameras[0].lens = Some(Lens { radius: 0.1, focus_distance: 5.0 });
    scene
}

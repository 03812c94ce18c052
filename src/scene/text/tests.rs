//! Tests of the text form as a whole: round trips, messages, the schema.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DMat3, DQuat, DVec3, Vec2, Vec3, Vec4};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;

use super::*;
use crate::color::Rgb;
use crate::scene::*;

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

/// Equal to the last bit, the sign of zero included (`==` does not see that, the printed form does).
fn same(a: &Scene, b: &Scene) -> bool {
    a == b && format!("{a:?}") == format!("{b:?}")
}

#[test]
fn every_scene_of_the_project_reads_without_notes_and_survives_writing() {
    let files = scenes();
    assert!(!files.is_empty());
    for file in files {
        let source = std::fs::read_to_string(&file).unwrap();
        let (scene, notes) = parse(&source).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        assert_eq!(notes, []);
        assert!(same(&parse(&to_toml(&scene)).unwrap().0, &scene), "{}", file.display());
        assert!(same(&parse(&to_json(&scene)).unwrap().0, &scene), "{}", file.display());
    }
}

/// The fixture with every key about pictures and layers: what it says arrives, and comes back.
#[test]
fn every_key_of_pictures_and_layers_arrives() {
    let source = include_str!("../../../fixtures/text/textures.toml");
    let (scene, notes) = parse(source).unwrap_or_else(|e| panic!("{e}"));
    // The fixture has the one key that arrives and is not rendered yet.
    assert!(notes.iter().all(|n| n.code == "coat-normal-ignored"), "{notes:?}");
    for key in schema()["$defs"]["PrincipledTable"]["properties"].as_object().unwrap().keys() {
        let about = ["texture", "alpha", "cutoff", "coat", "sheen"].iter().any(|w| key.contains(w));
        assert!(!about || source.contains(&format!("\n{key} = ")), "the fixture lacks {key}");
    }
    assert!(same(&parse(&to_toml(&scene)).unwrap().0, &scene));
    assert!(same(&parse(&to_json(&scene)).unwrap().0, &scene));
    insta::assert_snapshot!(to_toml(&scene));
}

#[test]
fn the_schema_file_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/epsilux.schema.json");
    let schema = format!("{:#}\n", schema());
    if std::env::var_os("EPSILUX_UPDATE").is_some() {
        std::fs::write(&path, &schema).unwrap();
    }
    let file = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(file == schema, "run the tests with EPSILUX_UPDATE=1 to write {}", path.display());
}

/// Finite doubles of every size that a coordinate may have, both zeros included.
fn coordinate() -> BoxedStrategy<f64> {
    prop_oneof![
        4 => -1e3..1e3f64,
        1 => (-40..40i32, -1.0..1.0f64).prop_map(|(e, m)| m * libm::exp2(f64::from(e))),
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 0.1, 1e-300]),
    ]
    .boxed()
}

fn single() -> BoxedStrategy<f32> {
    coordinate().prop_map(|v| v as f32).boxed()
}

fn dvec3() -> BoxedStrategy<DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from).boxed()
}

fn vec3() -> BoxedStrategy<Vec3> {
    [single(), single(), single()].prop_map(Vec3::from).boxed()
}

fn unit() -> BoxedStrategy<Vec3> {
    vec3().prop_map(|v| v.as_dvec3().try_normalize().unwrap_or(DVec3::X).as_vec3()).boxed()
}

fn size() -> BoxedStrategy<f64> {
    prop_oneof![1e-3..1e3f64, Just(1.0), Just(1e-10), Just(1e12)].boxed()
}

fn unit_single() -> BoxedStrategy<f32> {
    prop_oneof![0.0..=1.0f32, Just(0.0), Just(-0.0), Just(1.0), Just(1e-40), Just(f32::MIN_POSITIVE)].boxed()
}

fn rgb(channel: impl Strategy<Value = f32> + Clone + 'static) -> BoxedStrategy<Rgb> {
    [channel.clone(), channel.clone(), channel].prop_map(Rgb::from).boxed()
}

fn reflectance() -> BoxedStrategy<Rgb> {
    prop_oneof![rgb(unit_single()), Just(Rgb::WHITE)].boxed()
}

fn radiance() -> BoxedStrategy<Rgb> {
    rgb(prop_oneof![0.0..1e3f32, Just(0.0), Just(-0.0), Just(1e20)]).boxed()
}

fn name() -> BoxedStrategy<String> {
    prop_oneof!["[a-z]{1,3}", any::<String>(), Just(String::new()), Just("a.b [1]\u{7f}\u{0}\"\\".to_owned())]
        .boxed()
}

fn even_transform() -> BoxedStrategy<DAffine3> {
    let turned = (dvec3(), -3.0..3.0f64, 1e-2..1e2f64, dvec3()).prop_map(|(axis, turn, scale, at)| {
        let axis = axis.try_normalize().unwrap_or(DVec3::Y);
        DAffine3 { matrix3: DMat3::from_quat(DQuat::from_axis_angle(axis, turn)) * scale, translation: at }
    });
    prop_oneof![turned, dvec3().prop_map(DAffine3::from_translation), Just(DAffine3::IDENTITY)].boxed()
}

fn any_transform() -> BoxedStrategy<DAffine3> {
    let skewed = (even_transform(), [0.1..9.0f64, 0.1..9.0f64, -9.0..-0.1f64])
        .prop_map(|(t, s)| DAffine3 { matrix3: t.matrix3 * DMat3::from_diagonal(s.into()), ..t });
    prop_oneof![skewed, even_transform()].boxed()
}

fn absorption() -> BoxedStrategy<Option<Absorption>> {
    let channel = prop_oneof![1e-3..=1.0f32, Just(1e-40)];
    option::of((rgb(channel), size()).prop_map(|(color, d)| Absorption { color, distance: d as f32 })).boxed()
}

fn priority() -> BoxedStrategy<Option<u8>> {
    option::of(any::<u8>()).boxed()
}

/// Boxed, as are the other large ones: nested in each other they would overflow a test's stack.
fn texture() -> BoxedStrategy<Texture> {
    let wrap = prop::sample::select(vec![Wrap::Repeat, Wrap::Mirror, Wrap::Clamp]);
    let filter = prop::sample::select(vec![Filter::Linear, Filter::Nearest]);
    let uv = prop_oneof![-1e3..1e3f32, Just(0.0), Just(-0.0), Just(1.0), Just(1e-40)];
    let scale = prop_oneof![[uv.clone(), uv.clone()], uv.clone().prop_map(|s| [s, s]), Just([1.0; 2])];
    let offset = prop_oneof![[uv.clone(), uv.clone()], Just([0.0; 2])];
    let turn = prop_oneof![-7.0..7.0f32, Just(0.0), Just(-0.0), Just(std::f32::consts::FRAC_PI_2)];
    let other = (any::<u8>(), 0..2u8, offset, turn, scale, [wrap.clone(), wrap], filter).prop_map(
        |(image, uv_set, offset, rotation, scale, wrap, filter)| Texture {
            image: ImageId(image.into()),
            uv_set,
            offset,
            rotation,
            scale,
            wrap,
            filter,
        },
    );
    prop_oneof![any::<u8>().prop_map(|image| Texture::new(ImageId(image.into()))), other].boxed()
}

/// Textures of all slots, or none; the numbers of their pictures are not in range yet.
fn textures() -> BoxedStrategy<Textures> {
    let channel = prop::sample::select(vec![Channel::R, Channel::G, Channel::B, Channel::A]);
    let scalar =
        option::of((texture(), channel).prop_map(|(texture, channel)| ScalarTexture { texture, channel }))
            .boxed();
    let strength = prop_oneof![-9.0..9.0f32, Just(1.0), Just(-0.0)];
    let normal =
        option::of((texture(), strength).prop_map(|(texture, scale)| NormalTexture { texture, scale }))
            .boxed();
    let color = option::of(texture()).boxed();
    let some = (
        (color.clone(), scalar.clone(), scalar.clone(), scalar.clone(), normal.clone(), color.clone()),
        (
            scalar.clone(),
            color.clone(),
            scalar.clone(),
            scalar.clone(),
            scalar.clone(),
            normal,
            color,
            scalar,
        ),
    )
        .prop_map(|(a, b)| Textures {
            base_color: a.0,
            alpha: a.1,
            metallic: a.2,
            roughness: a.3,
            normal: a.4,
            emission: a.5,
            specular: b.0,
            specular_color: b.1,
            transmission: b.2,
            coat: b.3,
            coat_roughness: b.4,
            coat_normal: b.5,
            sheen_color: b.6,
            sheen_roughness: b.7,
        });
    prop_oneof![1 => Just(Textures::default()), 2 => some].boxed()
}

/// Keeps the textures whose picture is one of `count`, and points them at it.
fn point_at_pictures(textures: &mut Textures, count: usize) {
    match count as u32 {
        0 => *textures = Textures::default(),
        count => textures.iter_mut().for_each(|t| t.image.0 %= count),
    }
}

fn material_kind() -> BoxedStrategy<MaterialKind> {
    let sides = prop::sample::select(vec![Sides::Front, Sides::Both]);
    let alpha_mode = prop_oneof![
        Just(AlphaMode::Opaque),
        Just(AlphaMode::Blend),
        unit_single().prop_map(|cutoff| AlphaMode::Mask { cutoff }),
    ];
    let principled = (
        (reflectance(), unit_single(), unit_single(), 1.0..3.0f32, unit_single()),
        (rgb(0.0..9.0f32), unit_single(), reflectance(), any::<bool>(), absorption(), priority(), radiance()),
        (unit_single(), alpha_mode, unit_single(), unit_single(), 1.0..3.0f32, reflectance(), unit_single()),
        textures(),
    )
        .prop_map(|(a, b, c, textures)| {
            MaterialKind::Principled(Box::new(Principled {
                base_color: a.0,
                metallic: a.1,
                roughness: a.2,
                ior: a.3,
                specular: a.4,
                specular_color: b.0,
                transmission: b.1,
                transmission_tint: b.2,
                thin: b.3,
                absorption: b.4,
                priority: b.5,
                emission: b.6,
                alpha: c.0,
                alpha_mode: c.1,
                coat: c.2,
                coat_roughness: c.3,
                coat_ior: c.4,
                sheen_color: c.5,
                sheen_roughness: c.6,
                textures,
            }))
        });
    prop_oneof![
        reflectance().prop_map(|color| MaterialKind::Diffuse { color }),
        reflectance().prop_map(|color| MaterialKind::Mirror { color }),
        (0.1..3.0f32, reflectance(), absorption(), priority()).prop_map(
            |(ior, tint, absorption, priority)| MaterialKind::Glass(Glass {
                ior,
                tint,
                absorption,
                priority
            })
        ),
        (radiance(), sides).prop_map(|(radiance, sides)| MaterialKind::Light { radiance, sides }),
        principled,
        Just(MaterialKind::Principled(Box::default())),
    ]
    .boxed()
}

fn mesh() -> BoxedStrategy<Mesh> {
    let vertex = (
        vec3(),
        unit(),
        (unit(), any::<bool>()).prop_map(|(t, left)| t.extend(if left { -1.0 } else { 1.0 })),
        [single(), single()].prop_map(Vec2::from),
        [single(), single()].prop_map(Vec2::from),
        [unit_single(), unit_single(), unit_single(), unit_single()].prop_map(Vec4::from),
    );
    let lists = [any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>()];
    (name(), vec(vertex, 3..12), lists, vec([0..12u32, 0..12u32, 0..12u32], 0..8))
        .prop_map(|(name, vertices, lists, triangles)| {
            let count = vertices.len() as u32;
            Mesh {
                name,
                positions: vertices.iter().map(|v| v.0).collect(),
                normals: vertices.iter().filter(|_| lists[0]).map(|v| v.1).collect(),
                tangents: vertices.iter().filter(|_| lists[1]).map(|v| v.2).collect(),
                uvs: [
                    vertices.iter().filter(|_| lists[2]).map(|v| v.3).collect(),
                    vertices.iter().filter(|_| lists[3]).map(|v| v.4).collect(),
                ],
                colors: vertices.iter().filter(|_| lists[4]).map(|v| v.5).collect(),
                triangles: triangles.into_iter().map(|t| t.map(|i| i % count)).collect(),
            }
        })
        .boxed()
}

fn light() -> BoxedStrategy<Light> {
    let radius = || prop_oneof![Just(0.0), 1e-2..1e2f64];
    let falloff = prop::sample::select(vec![SpotFalloff::Gltf, SpotFalloff::Blender]);
    let outline = prop::sample::select(vec![AreaShape::Rectangle, AreaShape::Ellipse]);
    let kind = prop_oneof![
        (radiance(), radius()).prop_map(|(intensity, radius)| LightKind::Point { intensity, radius }),
        (radiance(), 0.0..=1.0f64, 1e-3..1.57f64, falloff, radius()).prop_map(
            |(intensity, share, outer, falloff, radius)| LightKind::Spot {
                intensity,
                inner: share * outer,
                outer,
                falloff,
                radius
            }
        ),
        (radiance(), 0.0..3.1f64).prop_map(|(irradiance, angle)| LightKind::Sun { irradiance, angle }),
        (outline, size(), size(), radiance()).prop_map(|(shape, w, h, radiance)| LightKind::Area {
            shape,
            size: [w, h],
            radiance
        }),
    ];
    (name(), kind, any_transform(), any::<bool>())
        .prop_map(|(name, kind, transform, visible_to_camera)| Light {
            name,
            kind,
            transform,
            visible_to_camera,
        })
        .boxed()
}

fn camera() -> BoxedStrategy<Camera> {
    let axis = prop::sample::select(vec![FovAxis::Horizontal, FovAxis::Vertical]);
    let projection =
        (1e-3..3.1f64, size(), any::<bool>(), axis).prop_map(|(fov, extent, perspective, axis)| {
            if perspective {
                Projection::Perspective { fov, axis }
            } else {
                Projection::Orthographic { extent, axis }
            }
        });
    let lens =
        option::of((size(), size()).prop_map(|(radius, focus_distance)| Lens { radius, focus_distance }));
    (name(), any_transform(), projection, [coordinate(), coordinate()], lens, option::of(0.1..10.0f64))
        .prop_map(|(name, transform, projection, shift, lens, aspect)| Camera {
            name,
            transform,
            projection,
            shift: shift.map(|s| s.clamp(-1e6, 1e6)),
            lens,
            aspect,
        })
        .boxed()
}

prop_compose! {
    fn settings()(
        size in option::of([1..9999u32, 1..9999u32]),
        spp in option::of(1..9999u32),
        exposure in option::of(-9.0..9.0f32),
        tone in option::of(prop::sample::select(vec![
            ToneCurve::Srgb, ToneCurve::Agx, ToneCurve::Neutral, ToneCurve::Sqrt, ToneCurve::Linear,
        ])),
        max_depth in option::of(any::<u32>()),
        indirect_gain in option::of(0.0..9.0f32),
    ) -> Settings {
        Settings { size, spp, exposure, tone, max_depth, indirect_gain }
    }
}

prop_compose! {
    fn scene()(
        title in name(),
        materials in vec((name(), material_kind()), 1..4),
        meshes in vec(mesh(), 0..4),
        objects in vec((name(), any::<u32>(), any::<u32>(), size(), any_transform(), even_transform(), any::<bool>()), 0..5),
        lights in vec(light(), 0..4),
        cameras in vec(camera(), 0..3),
        environment in option::of((name(), radiance(), any::<bool>())),
        images in vec((name(), "[a-z%. ]{1,9}"), 0..4),
        sky in option::of((any::<u32>(), prop_oneof![-7.0..7.0f64, Just(0.0), Just(-0.0)])),
        settings in settings(),
    ) -> Scene {
        let objects = objects.into_iter().map(|(name, material, mesh, size, any, even, visible_to_camera)| {
            let (shape, transform) = match mesh as usize % (meshes.len() + 1) {
                0 => (Shape::Sphere { radius: size }, even),
                m => (Shape::Mesh(MeshId(m as u32 - 1)), any),
            };
            let material = MaterialId(material % materials.len() as u32);
            Object { name, shape, material, transform, visible_to_camera }
        }).collect();
        // Names of materials and cameras have to be unique.
        let numbered = |i: usize, name: &str| if i == 0 { name.to_owned() } else { format!("{name}{i}\u{e9}") };
        Scene {
            title,
            objects,
            materials: materials.into_iter().enumerate().map(|(i, (name, mut kind))| {
                if let MaterialKind::Principled(p) = &mut kind {
                    point_at_pictures(&mut p.textures, images.len());
                }
                Material { name: numbered(i, &name), kind }
            }).collect(),
            meshes,
            lights,
            cameras: cameras.into_iter().enumerate()
                .map(|(i, c)| Camera { name: numbered(i, &c.name), ..c }).collect(),
            environment: environment.map(|(name, radiance, visible_to_camera)| {
                let image = sky.filter(|_| !images.is_empty()).map(|(id, rotation)| EnvironmentImage {
                    image: ImageId(id % images.len() as u32),
                    rotation,
                });
                Environment { name, radiance, image, visible_to_camera }
            }),
            images: images.into_iter().map(|(name, file)| {
                let texels = Texels::Byte(vec![[0, 1, 2, 255]]);
                let pixels = Some(Arc::new(Pixels { width: 1, height: 1, texels }));
                Image { name, file: Some(file), encoded: None, pixels }
            }).collect(),
            settings,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// What is written reads back as the same scene, to the last bit, in both syntaxes.
    #[test]
    fn what_is_written_reads_back_the_same(mut scene in scene()) {
        // Validation drops the degenerate triangles that random ones contain.
        let valid = validate(&mut scene);
        prop_assert!(valid.is_ok(), "{:?}", valid);
        // What the text says of a picture is where it lies.
        scene.images.iter_mut().for_each(|image| image.pixels = None);
        let toml = to_toml(&scene);
        let (read, notes) = parse(&toml).map_err(|e| TestCaseError::fail(format!("{e}\n{toml}")))?;
        // What validation says of a scene without fault is about what is not rendered.
        prop_assert!(notes.iter().all(|n| n.code == "coat-normal-ignored"), "{notes:?}");
        prop_assert!(same(&read, &scene), "{toml}\n{read:?}\n{scene:?}");
        prop_assert_eq!(to_toml(&read), toml);
        let json = to_json(&scene);
        let (read, _) = parse(&json).map_err(|e| TestCaseError::fail(format!("{e}\n{json}")))?;
        prop_assert!(same(&read, &scene), "{json}");
    }
}

/// The message for each bad input, with its place in the text underlined.
fn messages(cases: &[(&str, &str)]) -> String {
    let mut out = String::new();
    for (what, source) in cases {
        out.push_str(&format!("# {what}\n"));
        match parse(source) {
            Ok(_) => out.push_str("read without an error\n"),
            Err(e) => {
                let line = source.lines().nth(e.line - 1).unwrap_or_default();
                let width =
                    source.get(e.span.clone()).map_or(0, |s| s.lines().next().unwrap_or("").chars().count());
                let marks = format!("{}{}", " ".repeat(e.column - 1), "^".repeat(width.max(1)));
                out.push_str(&format!("{:?} at `{}`\n{line}\n{marks}\n{e}\n", e.kind, e.place));
            }
        }
        out.push('\n');
    }
    out
}

#[test]
fn mistakes_in_toml_are_pointed_at() {
    const HEAD: &str = "epsilux = 1\nmaterial.red = { diffuse = [1, 0, 0] }\n";
    const PICTURES: &str = "epsilux = 1\nimage.wood = \"wood.png\"\n[material.m.principled]\n";
    let cases = [
        ("not TOML", "title = \"half\nepsilux = 1\n"),
        ("a key twice", "epsilux = 1\nepsilux = 1\n"),
        ("no mark", "title = \"a\"\n"),
        ("no mark, and keys of another program", "[package]\nname = \"x\"\n"),
        ("a later version", "epsilux = 2\nlayers = []\n"),
        ("typo at the top", "epsilux = 1\ntitel = \"a\"\n"),
        ("typo in a key", "epsilux = 1\n[[object]]\nmaterial = \"m\"\nsphere = { radus = 1 }\n"),
        ("a key that is nothing like any", "epsilux = 1\n[render]\nwavelengths = 4\n"),
        ("typo in a kind", "epsilux = 1\n[material]\nred = { difuse = [1, 0, 0] }\n"),
        ("no kind", "epsilux = 1\n[material]\nred = {}\n"),
        ("two kinds", "epsilux = 1\n[material]\nred = { diffuse = [1, 0, 0], mirror = [1, 1, 1] }\n"),
        ("sides of a mirror", "epsilux = 1\n[material]\nm = { mirror = [1, 1, 1], sides = \"both\" }\n"),
        ("typo in a word", "epsilux = 1\n[render]\ntone = \"agz\"\n"),
        ("wrong type", "epsilux = 1\n[render]\nspp = \"many\"\n"),
        ("a fraction where a count is meant", "epsilux = 1\n[render]\nspp = 1.5\n"),
        ("a negative count", "epsilux = 1\n[render]\nsize = [-800, 800]\n"),
        ("a colour of two channels", "epsilux = 1\n[material]\nred = { diffuse = [1, 0] }\n"),
        ("a colour of four channels", "epsilux = 1\n[material]\nred = { diffuse = [1, 0, 0, 1] }\n"),
        (
            "a point of four numbers",
            "epsilux = 1\n[camera.a]\neye = [1, 2, 3, 4]\ntarget = [0, 0, 0]\nfov = 40\n",
        ),
        ("a point of two numbers", "epsilux = 1\n[camera.a]\neye = [1, 2]\ntarget = [0, 0, 0]\nfov = 40\n"),
        (
            "a triangle of four corners",
            "epsilux = 1\n[mesh.m]\npositions = [[0, 0, 0]]\ntriangles = [[0, 0, 0, 0]]\n",
        ),
        ("not a colour", "epsilux = 1\n[material]\nred = { diffuse = 0.5 }\n"),
        ("not a hex colour", "epsilux = 1\n[material]\nred = { diffuse = \"#12345é\" }\n"),
        ("too hot", "epsilux = 1\n[material]\nred = { light = { kelvin = 1e6 } }\n"),
        ("missing key", "epsilux = 1\n[[object]]\nmaterial = \"m\"\nbox = { size = [1, 1, 1] }\n"),
        ("no material", "epsilux = 1\n\n[[object]]\nsphere = { radius = 1 }\n"),
        ("unknown material", &format!("{HEAD}[[object]]\nmaterial = \"rad\"\nsphere = {{ radius = 1 }}\n")),
        ("unknown mesh, none there", &format!("{HEAD}[[object]]\nmaterial = \"red\"\nmesh = \"tree\"\n")),
        (
            "unknown material of a wall",
            &format!(
                "{HEAD}[[object]]\n[object.prism]\ncorners = [[0, 0], [1, 0], [0, 1]]\nbottom = 0\ntop = 1\n\
                 walls = [\"red\", \"\", \"blue\"]\n"
            ),
        ),
        (
            "too few walls",
            &format!(
                "{HEAD}[[object]]\nprism = {{ corners = [[0, 0], [1, 0], [0, 1]], bottom = 0, top = 1, walls = [\"red\"] }}\n"
            ),
        ),
        (
            "no area",
            &format!(
                "{HEAD}[[object]]\nmaterial = \"red\"\nrect = {{ corner = [0, 0, 0], edges = [[1, 0, 0], [2, 0, 0]] }}\n"
            ),
        ),
        (
            "negative radius",
            &format!("{HEAD}[[object]]\nname = \"ball\"\nmaterial = \"red\"\nsphere = {{ radius = -1 }}\n"),
        ),
        (
            "not finite",
            &format!(
                "{HEAD}[[object]]\nmaterial = \"red\"\nsphere = {{ center = [nan, 0, 0], radius = 1 }}\n"
            ),
        ),
        (
            "a shape that is flat",
            &format!(
                "{HEAD}[[object]]\nmaterial = \"red\"\nsphere = {{ radius = 1 }}\ntransform = {{ scale = [1, 0, 1] }}\n"
            ),
        ),
        ("too bright a wall", "epsilux = 1\n[material.red]\ndiffuse = [1.2, 0, 0]\n"),
        (
            "an index too large",
            &format!(
                "{HEAD}[mesh.m]\npositions = [[0, 0, 0]]\ntriangles = [\n  [0, 0, 0],\n  [0, 1, 0],\n]\n"
            ),
        ),
        (
            "a camera without direction",
            "epsilux = 1\n[camera.front]\neye = [1, 2, 3]\ntarget = [1, 2, 3]\nfov = 40\n",
        ),
        (
            "a camera placed twice",
            "epsilux = 1\n[camera]\na = { eye = [1, 2, 3], transform = { scale = 2 }, fov = 40 }\n",
        ),
        (
            "a camera that sees everything",
            "epsilux = 1\n[camera]\nfront = { eye = [1, 2, 3], target = [0, 0, 0], fov = 360 }\n",
        ),
        (
            "a matrix with perspective",
            "epsilux = 1\n[[light]]\npoint = { intensity = [1, 1, 1] }\ntransform = [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n",
        ),
        (
            "a spot inside out",
            "epsilux = 1\n[[light]]\nspot = { intensity = [1, 1, 1], inner = 40, outer = 30 }\n",
        ),
        (
            "a light aimed twice",
            "epsilux = 1\n[[light]]\nsun = { irradiance = [1, 1, 1] }\ndirection = [0, -1, 0]\ntarget = [0, 0, 0]\n",
        ),
        ("unknown image", &format!("{PICTURES}base_color_texture = \"wod\"\n")),
        ("a file where an image is named", &format!("{PICTURES}base_color_texture = \"oak.jpg\"\n")),
        (
            "unknown image, in a table",
            &format!("{PICTURES}coat_texture = {{ image = \"rust\", scale = 2 }}\n"),
        ),
        ("no picture", &format!("{PICTURES}alpha_texture = {{ scale = 2 }}\n")),
        ("two pictures", &format!("{PICTURES}alpha_texture = {{ image = \"wood\", file = \"wood.png\" }}\n")),
        ("not a texture", &format!("{PICTURES}base_color_texture = 3\n")),
        ("typo in a texture", &format!("{PICTURES}base_color_texture = {{ image = \"wood\", scal = 2 }}\n")),
        ("typo in a slot", &format!("{PICTURES}base_colour_texture = \"wood\"\n")),
        ("wrong scale", &format!("{PICTURES}normal_texture = {{ image = \"wood\", scale = \"big\" }}\n")),
        ("three scales", &format!("{PICTURES}normal_texture = {{ image = \"wood\", scale = [1, 2, 3] }}\n")),
        ("unknown wrap", &format!("{PICTURES}normal_texture = {{ image = \"wood\", wrap = \"tile\" }}\n")),
        (
            "unknown wrap of two",
            &format!("{PICTURES}normal_texture = {{ image = \"wood\", wrap = [\"clamp\", \"miror\"] }}\n"),
        ),
        ("a third set", &format!("{PICTURES}coat_texture = {{ image = \"wood\", uv_set = 2 }}\n")),
        ("a set below zero", &format!("{PICTURES}coat_texture = {{ image = \"wood\", uv_set = -1 }}\n")),
        ("no offset", &format!("{PICTURES}coat_texture = {{ image = \"wood\", offset = [0, nan] }}\n")),
        ("turned too far", &format!("{PICTURES}coat_texture = {{ image = \"wood\", rotation = 1e9 }}\n")),
        ("too large", &format!("{PICTURES}coat_texture = {{ image = \"wood\", scale = 1e7 }}\n")),
        ("too strong", &format!("{PICTURES}normal_texture = {{ image = \"wood\", strength = inf }}\n")),
        (
            "the channel of a colour",
            &format!("{PICTURES}emission_texture = {{ image = \"wood\", channel = \"r\" }}\n"),
        ),
        (
            "the strength of a number",
            &format!("{PICTURES}coat_texture = {{ image = \"wood\", strength = 1 }}\n"),
        ),
        ("unknown channel", &format!("{PICTURES}coat_texture = {{ image = \"wood\", channel = \"red\" }}\n")),
        ("unknown alpha mode", &format!("{PICTURES}alpha_mode = \"masked\"\n")),
        ("a cut-off without a mask", &format!("{PICTURES}alpha_mode = \"blend\"\ncutoff = 0.5\n")),
        ("a cut-off above one", &format!("{PICTURES}cutoff = 1.5\n")),
        ("an alpha above one", &format!("{PICTURES}alpha = 1.5\n")),
        ("too much sheen", &format!("{PICTURES}sheen_color = [0, 2, 0]\n")),
        ("a coat of air, and less", &format!("{PICTURES}coat_ior = 0.5\n")),
        ("a picture without a file", "epsilux = 1\n[image]\nwood = \"\"\n"),
        ("a picture that is a number", "epsilux = 1\n[image]\nwood = 3\n"),
        ("a typo in a picture", "epsilux = 1\n[image.wood]\nfle = \"wood.png\"\n"),
        ("an environment of nothing", "epsilux = 1\n[environment]\nname = \"sky\"\n"),
        ("an environment of an unknown image", "epsilux = 1\n[environment]\nimage = \"sky\"\n"),
        (
            "an environment turned without an image",
            "epsilux = 1\n[environment]\nradiance = [1, 1, 1]\nrotation = 30\n",
        ),
        (
            "an environment turned too far",
            "epsilux = 1\n[environment]\nimage = { file = \"sky.hdr\" }\nrotation = 1e9\n",
        ),
        (
            "a point after letters that take two bytes",
            "epsilux = 1\nenvironment = { name = \"äöü\", radiance = [-1, 0, 0] }\n",
        ),
    ];
    insta::assert_snapshot!(messages(&cases));
}

#[test]
fn mistakes_in_json_are_pointed_at() {
    let cases = [
        ("not JSON", "{ \"epsilux\": 1,\n  \"title\" \"a\" }"),
        ("cut off", "{ \"epsilux\": 1,"),
        ("no mark", "{ \"asset\": { \"version\": \"2.0\" } }"),
        ("a later version", "{ \"epsilux\": 7 }"),
        ("typo in a key", "{ \"epsilux\": 1,\n  \"render\": { \"sppp\": 4 } }"),
        ("wrong type", "{ \"epsilux\": 1,\n  \"render\": { \"spp\": true } }"),
        (
            "a name twice",
            "{ \"epsilux\": 1,\n  \"camera\": {\n    \"a\": { \"fov\": 1 }, \"a\": { \"fov\": 1 } } }",
        ),
        ("a value", "{ \"epsilux\": 1,\n  \"material\": { \"m\": { \"mirror\": [0, 0, 2] } } }"),
        (
            "a missing camera target",
            "{ \"epsilux\": 1, \"camera\": { \"a\": { \"eye\": [0, 0, 0], \"fov\": 9 } } }",
        ),
        (
            "unknown material",
            "{ \"epsilux\": 1, \"object\": [{ \"material\": \"m\",\n \"sphere\": { \"radius\": 1 } }] }",
        ),
    ];
    insta::assert_snapshot!(messages(&cases));
}

//! The scenes of the project hold exactly the numbers they should: typed in here a second time, from
//! the room's own description and not from the scene files.
//!
//! Everything is compared after the change to y-up: (x, y, z) -> (x, z, -y).

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use super::parse;
use crate::color::Rgb;
use crate::scene::{FovAxis, MaterialKind, Projection, Scene, Shape, Sides};

fn read(source: &str) -> Scene {
    parse(source).unwrap_or_else(|e| panic!("{e}")).0
}

fn hexroom() -> Scene {
    read(include_str!("../../../scenes/hexroom.toml"))
}

fn hexroom_diffuse() -> Scene {
    read(include_str!("../../../scenes/hexroom-diffuse.toml"))
}

/// Sum of the area vectors of each object, in the order of the file.
fn area_vectors(scene: &Scene, name: &str) -> DVec3 {
    let objects = scene.objects.iter().filter(|o| o.name == name);
    let meshes = objects.filter_map(|o| match o.shape {
        Shape::Mesh(id) => Some(&scene.meshes[id.0 as usize]),
        Shape::Sphere { .. } => None,
    });
    meshes
        .flat_map(|m| {
            m.triangles.iter().map(|t| {
                let [a, b, c] = t.map(|i| m.positions[i as usize].as_dvec3());
                (b - a).cross(c - a) * 0.5
            })
        })
        .sum()
}

/// Surface area in square metres of all meshes of each material.
fn areas(scene: &Scene) -> BTreeMap<&str, f64> {
    let mut areas = BTreeMap::new();
    for object in &scene.objects {
        if let Shape::Mesh(id) = object.shape {
            let mesh = &scene.meshes[id.0 as usize];
            for t in &mesh.triangles {
                let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
                let name = scene.materials[object.material.0 as usize].name.as_str();
                *areas.entry(name).or_insert(0.0) += (b - a).cross(c - a).length() * 0.5;
            }
        }
    }
    areas
}

fn check_areas(scene: &Scene, expected: &[(&str, f64)]) {
    let found = areas(scene);
    assert_eq!(found.keys().copied().collect::<Vec<_>>(), expected.iter().map(|e| e.0).collect::<Vec<_>>());
    for &(name, area) in expected {
        assert!((found[name] / area - 1.0).abs() < 1e-6, "{name}: {} m^2, expected {area}", found[name]);
    }
}

/// Name, material, centre in the scene's axes, radius.
fn spheres(scene: &Scene) -> Vec<(&str, &str, [f64; 3], f64)> {
    let mut spheres = Vec::new();
    for o in &scene.objects {
        if let Shape::Sphere { radius } = o.shape {
            let material = scene.materials[o.material.0 as usize].name.as_str();
            spheres.push((o.name.as_str(), material, o.transform.translation.to_array(), radius));
        }
    }
    spheres
}

fn check_material(scene: &Scene, name: &str, expected: &MaterialKind) {
    let found = scene.materials.iter().find(|m| m.name == name);
    assert_eq!(found.map(|m| &m.kind), Some(expected), "{name}");
}

fn check_diffuse(scene: &Scene, expected: &[(&str, [f32; 3])]) {
    for &(name, color) in expected {
        check_material(scene, name, &MaterialKind::Diffuse { color: color.into() });
    }
}

/// Position and axes of the camera in the scene's axes, and its angle over the width.
fn check_camera(scene: &Scene, name: &str, eye: [f64; 3], forward: DVec3, fov: f64) {
    let camera = scene.cameras.iter().find(|c| c.name == name).unwrap();
    assert_eq!(camera.transform.translation.to_array(), eye);
    let m = camera.transform.matrix3;
    let right = forward.cross(DVec3::Y).normalize();
    for (axis, expected) in
        [(m.x_axis, right), (m.y_axis, right.cross(forward).normalize()), (-m.z_axis, forward)]
    {
        assert!((axis - expected.normalize()).length() < 1e-15, "{name}: {axis} {expected}");
    }
    match camera.projection {
        Projection::Perspective { fov: found, axis } => {
            assert_eq!(axis, FovAxis::Horizontal);
            assert!((found.to_degrees() - fov).abs() < 1e-12, "{found}");
        }
        Projection::Orthographic { .. } => panic!("{name} is orthographic"),
    }
    assert!(camera.lens.is_none() && camera.shift == [0.0; 2]);
}

#[test]
fn the_hexroom_has_the_reports_shell() {
    for scene in [hexroom(), hexroom_diffuse()] {
        // Walls face inwards; length times height of each, with the room's x, y as x, -z here.
        for (i, [x, y]) in
            [[60.0, -30.0], [0.0, -100.0], [-60.0, -30.0], [-60.0, 30.0], [0.0, 100.0], [60.0, 30.0]]
                .iter()
                .enumerate()
        {
            let found = area_vectors(&scene, &format!("room wall {}", i + 1));
            assert_eq!(found, DVec3::new(*x, 0.0, -y), "wall {}", i + 1);
        }
        // The hexagon measures 10 x 12 and two triangles of 3 x 6 each; the light takes 2 x 2 of it.
        assert_eq!(area_vectors(&scene, "room floor"), DVec3::new(0.0, 156.0, 0.0));
        assert!((area_vectors(&scene, "room ceiling") - DVec3::new(0.0, -152.0, 0.0)).length() < 1e-9);
        assert_eq!(area_vectors(&scene, "light"), DVec3::new(0.0, -4.0, 0.0));
        let light = scene.meshes.iter().find(|m| m.name == "light").unwrap();
        let mut corners: Vec<[i32; 3]> =
            light.positions.iter().map(|p| p.to_array().map(|v| v as i32)).collect();
        corners.sort_unstable();
        assert_eq!(corners, [[4, 5, -1], [4, 5, 1], [6, 5, -1], [6, 5, 1]]);
        assert!(light.positions.iter().all(|p| *p == p.round()));
        let radiance = Rgb::grey(14.0);
        check_material(&scene, "light", &MaterialKind::Light { radiance, sides: Sides::Front });
        for mesh in &scene.meshes {
            assert!(
                mesh.positions.iter().all(|p| p.abs().cmple(Vec3::new(13.0, 5.0, 6.0)).all()),
                "{}",
                mesh.name
            );
        }
        assert_eq!(scene.cameras.len(), 2);
        assert_eq!(scene.cameras[0].name, "near");
        check_camera(&scene, "near", [-1.0, 0.0, 0.0], DVec3::X, 90.0);
        // From two metres away the plane from -1 to 1 covers 2 atan(1/2).
        check_camera(&scene, "far", [-2.0, 0.0, 0.0], DVec3::X, 53.130_102_354_155_98);
        assert_eq!(scene.settings.size, Some([800, 800]));
    }
}

#[test]
fn the_hexroom_has_the_numbers_of_the_comparison() {
    let scene = hexroom();
    let wall = 45f64.sqrt() * 10.0;
    check_areas(
        &scene,
        &[
            // Walls 3 and 4 lean; walls 2 and 5 are ten metres wide. A box of 2 x 2 x 2 has 24 m^2.
            ("blue", wall + 24.0),
            ("green", wall),
            ("light", 4.0),
            ("mirror", 2.0 * wall),
            ("orange", 24.0),
            ("red", 100.0),
            // Floor, ceiling, and the middle box of 2 x 2 x 1.4.
            ("white", 156.0 + 152.0 + 2.0 * (4.0 + 2.8 + 2.8)),
            ("yellow", 100.0),
        ],
    );
    assert_eq!(
        spheres(&scene),
        [
            ("purple glass", "purple", [7.0, -1.7, -3.2], 1.1),
            ("light blue glass", "lightblue", [6.0, -2.3, 0.0], 1.1),
            ("clear glass", "clear", [7.0, -1.7, 3.2], 1.1),
            ("mirror sphere", "mirror", [9.0, 1.2, -0.3], 1.5),
        ]
    );
    check_diffuse(
        &scene,
        &[
            ("white", [0.78, 0.78, 0.78]),
            ("red", [0.70, 0.15, 0.12]),
            ("green", [0.16, 0.60, 0.18]),
            ("blue", [0.16, 0.25, 0.70]),
            ("yellow", [0.72, 0.65, 0.15]),
            ("orange", [0.75, 0.40, 0.12]),
        ],
    );
    check_material(&scene, "mirror", &MaterialKind::Mirror { color: Rgb::WHITE });
    for (name, tint) in
        [("clear", [1.0, 1.0, 1.0]), ("lightblue", [0.70, 0.82, 1.0]), ("purple", [0.80, 0.35, 0.90])]
    {
        let glass = crate::scene::Glass { ior: 1.5, tint: tint.into(), absorption: None, priority: None };
        check_material(&scene, name, &MaterialKind::Glass(glass));
    }
    // The corner of the left box at its -x, -y, +z end: turned by 0.3 radians about the up axis.
    let (sin, cos) = (0.295_520_206_661_339_6_f64, 0.955_336_489_125_606_f64);
    let corner = Vec3::new((7.0 - cos + sin) as f32, -3.0, -(3.2 - sin - cos) as f32);
    let left = scene.meshes.iter().find(|m| m.name == "left box").unwrap();
    assert!(left.positions.iter().any(|p| p.abs_diff_eq(corner, 1e-6)), "{:?}", left.positions);
}

#[test]
fn the_diffuse_hexroom_has_the_numbers_of_the_comparison() {
    let scene = hexroom_diffuse();
    let wall = 45f64.sqrt() * 10.0;
    check_areas(
        &scene,
        &[
            ("blue", wall),
            ("cyan", 2.0 + 4.0 * 9.98),
            ("green", wall),
            ("light", 4.0),
            ("purple", 100.0 + 2.0 * 0.49 + 4.0 * 0.7 * 8.0),
            ("red", 100.0),
            ("white", 2.0 * wall + 152.0),
            ("yellow", 156.0),
        ],
    );
    assert_eq!(spheres(&scene), [("ball", "white", [6.0, -3.5, 0.0], 1.5)]);
    check_diffuse(
        &scene,
        &[
            ("white", [0.8, 0.8, 0.8]),
            ("red", [0.75, 0.12, 0.10]),
            ("green", [0.12, 0.65, 0.15]),
            ("blue", [0.15, 0.20, 0.75]),
            ("yellow", [0.80, 0.72, 0.10]),
            ("cyan", [0.10, 0.75, 0.75]),
            ("purple", [0.55, 0.12, 0.65]),
        ],
    );
}

#[test]
fn the_cornell_box_has_its_published_numbers() {
    let scene = read(include_str!("../../../scenes/cornell.toml"));
    check_diffuse(
        &scene,
        &[("white", [0.725, 0.71, 0.68]), ("red", [0.63, 0.065, 0.05]), ("green", [0.14, 0.45, 0.091])],
    );
    let radiance = Rgb::new(17.0, 12.0, 4.0);
    check_material(&scene, "light", &MaterialKind::Light { radiance, sides: Sides::Front });
    let close = |name: &str, expected: DVec3| {
        let found = area_vectors(&scene, name);
        assert!((found - expected).length() < 1e-5, "{name}: {found}");
    };
    // The published numbers are in centimetres here.
    close("floor", DVec3::new(0.0, (5.528 + 5.496) / 2.0 * 5.592, 0.0));
    close("ceiling", DVec3::new(0.0, -(5.56 * 5.592 - 1.3 * 1.05), 0.0));
    close("light", DVec3::new(0.0, -1.3 * 1.05, 0.0));
    close("back wall", DVec3::new(0.0, 0.0, -(5.496 + 5.56) / 2.0 * 5.488));
    close("right wall", DVec3::new(5.592 * 5.488, 0.0, 0.0));
    assert!(area_vectors(&scene, "left wall").x < -30.0);
    close("short block", DVec3::ZERO);
    close("tall block", DVec3::ZERO);
    // Half of 25 mm over 35 mm.
    let fov = 2.0 * libm::atan(0.0125 / 0.035).to_degrees();
    check_camera(&scene, "front", [2.78, 2.73, -8.0], DVec3::Z, fov);
}

#[test]
fn the_caustic_has_the_numbers_of_the_comparison() {
    let scene = read(include_str!("../../../scenes/caustic.toml"));
    check_areas(&scene, &[("floor", 144.0), ("light", 0.09)]);
    assert!(area_vectors(&scene, "floor").y > 0.0 && area_vectors(&scene, "light").y < 0.0);
    assert_eq!(spheres(&scene), [("ball", "glass", [0.0, 1.25, 0.0], 1.0)]);
    let light = scene.meshes.iter().find(|m| m.name == "light").unwrap();
    let middle = light.positions.iter().sum::<Vec3>() / 4.0;
    assert!(middle.abs_diff_eq(Vec3::new(1.8, 6.0, -0.8), 1e-6), "{middle}");
    check_diffuse(&scene, &[("floor", [0.7, 0.7, 0.7])]);
    let radiance = Rgb::new(400.0, 380.0, 340.0);
    check_material(&scene, "light", &MaterialKind::Light { radiance, sides: Sides::Front });
    let forward = DVec3::new(0.1, 0.55 - 4.2, -6.5).normalize();
    check_camera(&scene, "front", [0.0, 4.2, 6.5], forward, 38.0);
}

//! Transforms, from a scene and from nested nodes of glTF.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::accel::{PrimitiveId, RayKind};
use crate::check::random::Random;
use crate::check::stage::{Stage, U, diffuse, emitter, larger, object, prepared};
use crate::check::{Effort, Figure};
use crate::import;
use crate::scene::{Mesh, MeshId, Scene, Shape};
use crate::shape::{Ray, triangle};

pub(super) fn run(effort: Effort) -> Vec<Figure> {
    let mut random = Random::of("N74");
    let mut figures = Vec::new();
    let matrix = |x: [f64; 3], y: [f64; 3], z: [f64; 3]| DMat3::from_cols(x.into(), y.into(), z.into());
    let turn = {
        let z = random.direction().as_dvec3().normalize();
        let x = z.any_orthonormal_vector();
        DMat3::from_cols(x, z.cross(x), z)
    };
    let named = [
        ("scale 1e-6", turn * 1e-6, DVec3::new(1e-6, 2e-6, -3e-6)),
        ("scale 1e6", turn * 1e6, DVec3::new(-2e6, 3e5, 1e6)),
        ("mirrored", turn * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)), DVec3::new(1.0, 2.0, 3.0)),
        ("scaled by minus one, far away", DMat3::from_diagonal(DVec3::NEG_ONE), DVec3::new(1e4, 2e4, -1e4)),
        ("sheared", matrix([1.0, 0.0, 0.0], [2.5, 1.0, 0.0], [0.0, -0.7, 1.0]), DVec3::ZERO),
        (
            "sheared, mirrored and uneven",
            turn * matrix([3.0, 0.1, 0.0], [1.0, -0.02, 0.0], [0.3, 0.4, 5.0]),
            DVec3::ONE,
        ),
    ];
    for (name, m, t) in named {
        figures.extend(placed(name, DAffine3::from_mat3_translation(m, t), &mut random, effort));
    }
    figures.extend(nested(&mut random));
    figures
}

/// An icosahedron around the origin, front outside.
fn icosahedron() -> Mesh {
    let g = 1.618_034;
    let mut positions = Vec::new();
    for (a, b) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        positions.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
    }
    // Faces are the triples that are as close as two neighbours, wound so that they face outwards.
    let near = |i: usize, j: usize| positions[i].distance(positions[j]) < 2.1;
    let mut triangles = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                if near(i, j) && near(j, k) && near(k, i) {
                    let (a, b, c) = (positions[i], positions[j], positions[k]);
                    let outside = (b - a).cross(c - a).dot(a + b + c) > 0.0;
                    let [j, k] = if outside { [j, k] } else { [k, j] };
                    triangles.push([i, j, k].map(|v| v as u32));
                }
            }
        }
    }
    Mesh { positions, triangles, ..Mesh::default() }
}

/// A mesh that is copied to the world and emits, and two that share their triangles.
fn placed(name: &str, transform: DAffine3, random: &mut Random, effort: Effort) -> Vec<Figure> {
    let mesh = icosahedron();
    let exact: Vec<DVec3> = mesh.positions.iter().map(|p| plain(&transform, p.as_dvec3())).collect();
    let middle = transform.translation;
    let extent = exact.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let mut scene = Scene::default();
    scene.meshes.push(mesh.clone());
    object(&mut scene, Shape::Mesh(MeshId(0)), transform, emitter(1.0));
    let mut shared = Scene::default();
    shared.meshes.push(mesh.clone());
    // The twin is far enough away to be in nobody's way.
    let mut twin = transform;
    twin.translation += DVec3::splat(100.0 * extent);
    object(&mut shared, Shape::Mesh(MeshId(0)), transform, diffuse(0.5));
    object(&mut shared, Shape::Mesh(MeshId(0)), twin, diffuse(0.5));

    let (mut off, mut inward) = (f64::NAN, f64::NAN);
    if let Some(world) = prepared(scene.clone(), "N74", [1, 1]) {
        (off, inward) = (0.0, 0.0);
        let geometry = world.accel.geometry(0);
        if geometry.triangles.len() != mesh.triangles.len() {
            off = f64::INFINITY;
        }
        for (p, exact) in geometry.positions.iter().zip(&exact) {
            off = larger(off, (p.as_dvec3() - exact).abs().max_element() / extent);
        }
        for i in 0..geometry.triangles.len() as u32 {
            let v = geometry.vertices(i);
            let aside = v[0].as_dvec3() - middle;
            let outward = triangle::normal(v).is_some_and(|n| n.as_dvec3().dot(aside) > 0.0);
            inward += f64::from(u8::from(!outward));
        }
    }
    // Rays from outside see the light, and those from inside do not; through shared triangles they meet the
    // planes of the exact ones, and their fronts.
    let stage = Stage::new(scene, "N74");
    let shared = prepared(shared, "N74", [1, 1]);
    let (mut dark, mut lit, mut plane, mut back) = (0u64, 0u64, 0.0f64, 0u64);
    let rays = effort.trials(2_000);
    for i in 0..rays {
        let within = plain(&transform, random.direction().as_dvec3() * (0.9 * random.unit()));
        let beyond = plain(&transform, random.direction().as_dvec3() * 4.0);
        dark += u64::from(stage.radiance(beyond, within - beyond, 0, i as u32) != 1.0);
        lit += u64::from(stage.radiance(within, beyond - within, 0, i as u32) != 0.0);
        let ray = Ray::new(beyond.as_vec3(), (within - beyond).normalize().as_vec3());
        let hit = shared.as_ref().and_then(|s| {
            let hit = s.accel.closest(&ray, PrimitiveId::NONE, RayKind::Other)?;
            Some(s.surface(&ray, &hit, false)).map(|surface| (surface, hit.id.primitive))
        });
        let Some((surface, primitive)) = hit else {
            plane = f64::INFINITY;
            continue;
        };
        back += u64::from(surface.ng.dot(ray.d) >= 0.0 || surface.id.instance == 0);
        // Triangles may have been wound anew, and still be the same.
        let v = mesh.triangles.get(primitive as usize).map(|t| t.map(|i| exact[i as usize]));
        plane = larger(
            plane,
            v.map_or(f64::NAN, |[a, b, c]| {
                let n = (b - a).cross(c - a).normalize();
                (surface.p.as_dvec3() - a).dot(n).abs() / extent
            }),
        );
    }
    let what = format!("{name}, {rays} rays");
    vec![
        Figure::at_most(format!("{name}: error of positions, of the largest coordinate"), off, 4.0 * U),
        Figure::exactly(format!("{name}: triangles that face inwards"), inward, 0.0),
        Figure::exactly(format!("{what}: from outside that do not see the light"), dark as f64, 0.0),
        Figure::exactly(format!("{what}: from inside that see it"), lit as f64, 0.0),
        Figure::at_most(
            format!(
                "{what}: distance of hits from the exact plane of shared triangles, of the largest coordinate"
            ),
            plane,
            8.0 * U,
        ),
        Figure::exactly(format!("{what}: that meet backs of shared triangles"), back as f64, 0.0),
    ]
}

/// The transform of a point, written out.
fn plain(t: &DAffine3, p: DVec3) -> DVec3 {
    let m = t.matrix3;
    let row = |i: usize| m.x_axis[i] * p.x + m.y_axis[i] * p.y + m.z_axis[i] * p.z + t.translation[i];
    DVec3::new(row(0), row(1), row(2))
}

/// A tetrahedron with the corners of a cube, then its four triangles, front outside: 48 bytes of floats and 24
/// of shorts.
const TETRAHEDRON: &str =
    "AACAPwAAgD8AAIA/AACAPwAAgL8AAIC/AACAvwAAgD8AAIC/AACAvwAAgL8AAIA/AAABAAIAAAACAAMAAAADAAEAAQADAAIA";
const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
const DEPTH: usize = 20;

type Matrix = [[f64; 4]; 4];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| (0..4).map(|k| a[row][k] * b[k][column]).sum()))
}

/// A node, as JSON without its children, and its matrix. All numbers are multiples of 1/64, which any reader
/// takes exactly.
fn node(random: &mut Random, depth: usize, mirrored: bool) -> (String, Matrix) {
    let mut eighth = |size: f64| (random.between(-size, size) * 64.0).round() / 64.0;
    let [x, y, z] = [eighth(4.0), eighth(4.0), eighth(4.0)];
    if depth.is_multiple_of(3) {
        // A third of a turn about (1, 1, 1) takes x to y to z to x.
        let s = [1.25, 0.75, if mirrored { -1.0 } else { 1.0 }];
        let json = format!(
            r#""translation": [{x}, {y}, {z}], "rotation": [0.5, 0.5, 0.5, 0.5], "scale": [{}, {}, {}]"#,
            s[0], s[1], s[2]
        );
        let m = [[0.0, 0.0, s[2], x], [s[0], 0.0, 0.0, y], [0.0, s[1], 0.0, z], [0.0, 0.0, 0.0, 1.0]];
        return (json, m);
    }
    let mut m = [[0.0; 4]; 4];
    for (i, row) in m.iter_mut().enumerate().take(3) {
        for (j, v) in row.iter_mut().enumerate().take(3) {
            *v = eighth(0.25) + f64::from(u8::from(i == j));
        }
        row[3] = [x, y, z][i];
    }
    m[3][3] = 1.0;
    // Column by column.
    let numbers: Vec<String> = (0..16).map(|k| m[k % 4][k / 4].to_string()).collect();
    (format!(r#""matrix": [{}]"#, numbers.join(", ")), m)
}

/// A mesh under twenty nodes.
fn nested(random: &mut Random) -> Vec<Figure> {
    let mut figures = Vec::new();
    for mirrored in [false, true] {
        let mut whole: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        let mut nodes = Vec::new();
        for depth in 0..DEPTH {
            let (json, m) = node(random, depth, mirrored && depth == 0);
            whole = product(&whole, &m);
            let last = depth + 1 == DEPTH;
            let rest =
                if last { r#""mesh": 0"#.to_owned() } else { format!(r#""children": [{}]"#, depth + 1) };
            nodes.push(format!("{{{json}, {rest}}}"));
        }
        let text = format!(
            r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
            "accessors": [
                {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                  "min": [-1, -1, -1], "max": [1, 1, 1]}},
                {{"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 48}},
                            {{"buffer": 0, "byteOffset": 48, "byteLength": 24}}],
            "buffers": [{{"byteLength": 72, "uri": "data:application/octet-stream;base64,{TETRAHEDRON}"}}]}}"#,
            nodes.join(", ")
        );
        let exact = CORNERS.map(|[x, y, z]| {
            DVec3::from_array(std::array::from_fn(|i| {
                whole[i][0] * x + whole[i][1] * y + whole[i][2] * z + whole[i][3]
            }))
        });
        let middle = exact.iter().sum::<DVec3>() / 4.0;
        let extent = exact.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let (mut off, mut inward) = (f64::NAN, f64::NAN);
        let scene = import::read_gltf(text.as_bytes()).and_then(|scene| prepared(scene, "N74", [1, 1]));
        if let Some(scene) = scene {
            let geometry = scene.accel.geometry(0);
            let nearest = |e: &DVec3| {
                let distance = |p: &Vec3| (p.as_dvec3() - e).abs().max_element();
                geometry.positions.iter().map(distance).fold(f64::INFINITY, f64::min)
            };
            off = exact.iter().map(nearest).fold(0.0, f64::max) / extent;
            let faces = geometry.triangles.len();
            let outward = (0..faces as u32).filter(|&i| {
                let v = geometry.vertices(i);
                let aside = v.iter().map(|v| v.as_dvec3()).sum::<DVec3>() / 3.0 - middle;
                triangle::normal(v).is_some_and(|n| n.as_dvec3().dot(aside) > 0.0)
            });
            inward = 4.0 - outward.count() as f64;
        }
        let what = format!("{DEPTH} nested nodes{}", if mirrored { ", one of them mirrored" } else { "" });
        let determinant = {
            let [a, b, c, _] = whole;
            DVec3::new(a[0], a[1], a[2]).cross(DVec3::new(b[0], b[1], b[2])).dot(DVec3::new(c[0], c[1], c[2]))
        };
        let expected = if mirrored { -1.0 } else { 1.0 };
        figures.extend([
            Figure::exactly(format!("{what}: sign of the determinant"), determinant.signum(), expected),
            Figure::at_most(format!("{what}: error of positions, of the largest coordinate"), off, 4.0 * U),
            Figure::exactly(format!("{what}: triangles, of 4, that do not face outwards"), inward, 0.0),
        ]);
    }
    figures
}

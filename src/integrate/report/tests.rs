//! Each formula of the report against a known answer, and each slip against the formula.

use std::f32::consts::PI;

use super::*;
use crate::integrate::Quiet;
use crate::scene::text::parse_toml;

const TRIANGLE: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

fn near(a: f32, b: f32, bound: f32) -> bool {
    (a - b).abs() <= bound
}

fn options(size: [u32; 2], rays: u32) -> ReportOptions {
    let (slips, shortcuts) = (Slips::NONE, Shortcuts::REPORT);
    ReportOptions { camera: 0, size, crop: None, rays, seed: 1, threads: 1, slips, shortcuts }
}

/// A scene with a camera at z = 4 that looks along -z, through 8 x 8 pixels.
fn scene(text: &str) -> Scene {
    let head = "epsilux = 1\n[camera]\nfront = { eye = [0, 0, 4], target = [0, 0, 0], fov = 20 }\n";
    parse_toml(&format!("{head}{text}")).unwrap().0
}

/// Mean radiance of a picture.
fn mean(scene: &Scene, options: &ReportOptions) -> Rgb {
    let tracer = Tracer::new(scene, options).unwrap();
    let outcome = tracer.render(options, &Quiet).unwrap();
    assert_eq!(outcome.film.refused_total(), 0);
    let image = outcome.film.to_image();
    image.rgb.iter().fold(Rgb::BLACK, |sum, &c| sum + c) / image.rgb.len() as f32
}

/// A ball that fills the picture, under a white sky. What leaves it is what it reflects or lets through.
fn ball(material: &str) -> Scene {
    scene(&format!(
        "[material]\nm = {{ {material} }}\n[[object]]\nname = \"ball\"\nmaterial = \"m\"\n\
         sphere = {{ radius = 1.5 }}\n[environment]\nradiance = [1, 1, 1]\n"
    ))
}

/// 2.4: t, u and v of a hit; misses beside, behind, and in the plane.
#[test]
fn moeller_trumbore_finds_t_u_v() {
    let hit = |ps, d| moeller_trumbore(ps, d, TRIANGLE, Slips::NONE);
    assert_eq!(hit(Vec3::new(0.25, 0.5, 2.0), -Vec3::Z), Some([2.0, 0.25, 0.5]));
    assert_eq!(hit(Vec3::new(0.25, 0.5, -2.0), Vec3::Z), Some([2.0, 0.25, 0.5]), "from the back");
    for (ps, d) in [
        (Vec3::new(0.25, 0.5, 2.0), Vec3::Z),
        (Vec3::new(0.75, 0.5, 2.0), -Vec3::Z),
        (Vec3::new(-0.1, 0.5, 2.0), -Vec3::Z),
        (Vec3::new(-1.0, 0.2, 0.0), Vec3::X),
    ] {
        assert_eq!(hit(ps, d), None, "{ps} {d}");
    }
}

/// 2.4, slip: with Q = T x E2, Q . E2 and with it t is zero for every ray.
#[test]
fn the_printed_q_hits_nothing() {
    let slips = Slips { q_vector: true, ..Slips::NONE };
    for (x, y) in [(0.1, 0.1), (0.25, 0.5), (0.9, 0.05)] {
        assert_eq!(moeller_trumbore(Vec3::new(x, y, 2.0), -Vec3::Z, TRIANGLE, slips), None);
    }
}

/// Both roots from outside, from inside and behind; and what subtraction costs far away: at a distance
/// of 1000 radii, roots are off by more than a hundredth of the radius somewhere.
#[test]
fn the_pq_formula_finds_both_roots() {
    let hit = |z: f32, d| sphere_pq(Vec3::new(0.0, 0.0, z), d, Vec3::ZERO, 1.0);
    assert_eq!(hit(3.0, -Vec3::Z), Some([2.0, 4.0]));
    assert_eq!(hit(0.5, -Vec3::Z), Some([-0.5, 1.5]));
    assert_eq!(hit(3.0, Vec3::Z), Some([-4.0, -2.0]));
    assert_eq!(sphere_pq(Vec3::new(0.0, 1.5, 3.0), -Vec3::Z, Vec3::ZERO, 1.0), None);
    let worst = |distance: f32| {
        let error = |i: i32| {
            let h = 0.1 + 0.008 * i as f32;
            let roots = sphere_pq(Vec3::new(h, 0.0, distance), -Vec3::Z, Vec3::ZERO, 1.0);
            let exact = f64::from(distance) - (1.0 - f64::from(h) * f64::from(h)).sqrt();
            roots.map_or(f64::INFINITY, |[t, _]| (f64::from(t) - exact).abs())
        };
        (0..100).map(error).fold(0.0, f64::max)
    };
    assert!(worst(3.0) < 1e-5 && worst(1e3) > 1e-2, "{} {}", worst(3.0), worst(1e3));
}

/// A ray leaves the surface on the side of the normal, four centimetres away.
#[test]
fn rays_start_four_centimetres_off() {
    let share = Shortcuts::REPORT.offset;
    assert_eq!(offset_along_normal(Vec3::ONE, Vec3::Z, share), Vec3::new(1.0, 1.0, 1.04));
}

/// 3.1: the points of a light are inside of it, and their mean is its middle.
#[test]
fn points_of_a_light_are_uniform() {
    let n = 64;
    let at = |i: i32| (i as f32 + 0.5) / n as f32;
    let mut sum = Vec3::ZERO;
    for k in 0..n * n {
        let p = point_of_light(TRIANGLE, at(k % n), at(k / n));
        assert!(p.x >= 0.0 && p.y >= 0.0 && p.x + p.y <= 1.0, "{p}");
        sum += p / (n * n) as f32;
    }
    assert!(sum.distance(Vec3::new(1.0, 1.0, 0.0) / 3.0) < 1e-3, "{sum}");
}

/// 3.1: shadow rays to a square of two triangles sum up to its form factor; each slip changes the sum by
/// what it leaves out. Square of side 2 at distance 1: F = 4/pi X atan(X), X = 1/sqrt(2).
#[test]
fn shadow_rays_make_the_form_factor() {
    let light =
        |z: Vec3| [[-z - Vec3::X, z - Vec3::X, z + Vec3::X], [-z - Vec3::X, z + Vec3::X, -z + Vec3::X]];
    let sum = |slips: Slips| {
        let n = 64;
        let at = |i: i32| (i as f32 + 0.5) / n as f32;
        let mut sum = 0.0;
        for triangle in light(Vec3::Z) {
            for k in 0..n * n {
                let way = point_of_light(triangle, at(k % n), at(k / n)) + Vec3::Y;
                let (d, cos) = (way.length(), way.normalize().y);
                sum += shadow_ray([cos, cos], d, 2.0, 2, slips) / (n * n) as f32;
            }
        }
        sum
    };
    let x = 0.5f32.sqrt();
    let expected = 4.0 / PI * x * crate::math::atan2(x, 1.0);
    assert!(near(sum(Slips::NONE), expected, 1e-3 * expected), "{} {expected}", sum(Slips::NONE));
    let none = Slips::NONE;
    for (slips, factor) in [
        (Slips { area: true, ..none }, 0.5),
        (Slips { inverse_pi: true, ..none }, PI),
        (Slips { light_count: true, ..none }, 0.5),
        (Slips { shadow_comparison: true, ..none }, 0.0),
    ] {
        assert!(near(sum(slips), factor * expected, 1e-3 * expected), "{slips:?}");
    }
    // Behind the surface, or behind the light: both together, too, although their product is positive.
    for cos in [[-0.5, 0.5], [0.5, -0.5], [-0.5, -0.5]] {
        assert_eq!(shadow_ray(cos, 1.0, 1.0, 1, none), 0.0);
    }
}

/// 3.3: directions are unit, on the side of the normal, and their mean cosine is that of cos/pi: 2/3.
#[test]
fn diffuse_directions_follow_the_cosine() {
    let n = 64;
    let normal = Vec3::new(0.6, 0.0, -0.8);
    let at = |i: i32| (i as f32 + 0.5) / n as f32;
    let mut sum = Vec3::ZERO;
    for k in 0..n * n {
        let d = diffuse_direction(normal, at(k % n), at(k / n));
        assert!(near(d.length(), 1.0, 1e-5) && d.dot(normal) > 0.0);
        sum += d / (n * n) as f32;
    }
    assert!(sum.distance(normal * (2.0 / 3.0)) < 1e-3, "{sum}");
}

/// 3.3: under a white sky a ball is as bright as its colour; the extra pi makes it 3.14 times as bright,
/// more than all light there is.
#[test]
fn the_extra_pi_shows_in_the_furnace() {
    let scene = ball("diffuse = [1.0, 0.5, 0.25]");
    let mut options = options([8, 8], 64);
    options.shortcuts.roulette = false;
    let seen = mean(&scene, &options);
    assert!(near(seen.r, 1.0, 1e-4) && near(seen.g, 0.5, 1e-4) && near(seen.b, 0.25, 1e-4), "{seen:?}");
    options.slips.extra_pi = true;
    assert!(near(mean(&scene, &options).r, PI, 1e-3));
}

/// 3.4: a share alpha of the rays ends, and the others count for them. The other way round, the ball of
/// reflectance 0.8 is as bright as one of 0.2.
#[test]
fn roulette_absorbs_the_share_alpha() {
    assert!(near(absorption(Rgb::new(0.8, 0.5, 0.2)), 0.2, 1e-6));
    let share = |slips| (0..1000).filter(|i| survives(0.2, *i as f32 / 1000.0, slips)).count();
    let turned = Slips { roulette_sign: true, ..Slips::NONE };
    assert_eq!((share(Slips::NONE), share(turned)), (800, 200));
    let scene = ball("diffuse = [0.8, 0.8, 0.8]");
    let mut options = options([8, 8], 256);
    // Standard deviation of a ray 0.4, of the mean of 16384 rays 0.003.
    assert!(near(mean(&scene, &options).g, 0.8, 0.014));
    options.slips.roulette_sign = true;
    assert!(near(mean(&scene, &options).g, 0.2, 0.014));
}

/// 3.5: the angle of reflection; Snell's law in both directions, and its end at the critical angle.
#[test]
fn mirrors_and_glass_turn_rays() {
    let d = Vec3::new(0.6, -0.8, 0.0);
    assert_eq!(reflected(d, Vec3::Y), Vec3::new(0.6, 0.8, 0.0));
    let into = refracted(d, Vec3::Y, 1.0, 1.5).unwrap();
    assert!(near(into.x, 0.4, 1e-6) && into.y < 0.0 && near(into.length(), 1.0, 1e-6), "{into}");
    let out = refracted(into, Vec3::Y, 1.5, 1.0).unwrap();
    assert!(out.distance(d) < 1e-6, "{out}");
    assert_eq!(refracted(d, Vec3::Y, 1.5, 1.0).map(|d| near(d.x, 0.9, 1e-6)), Some(true));
    assert_eq!(refracted(Vec3::new(0.8, -0.6, 0.0), Vec3::Y, 1.5, 1.0), None, "0.8 * 1.5 > 1");
}

/// 3.6, corrected: 4 % head on, the same from both sides of a boundary, 1 at the critical angle, and
/// nowhere farther from Fresnel than 0.036.
#[test]
fn schlick_with_the_outside_angle_is_close_to_fresnel() {
    assert!(near(schlick_outside_angle(1.0, 1.5, 1.0), 0.04, 1e-6));
    let mut worst = 0.0f32;
    for i in 0..=1000 {
        let cos = i as f32 / 1000.0;
        let outside = schlick_outside_angle(1.0, 1.5, cos);
        worst = worst.max((outside - fresnel::dielectric(cos, 1.5).0).abs());
        // The cosine inside of the glass that belongs to it.
        let inside = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
        assert!(near(schlick_outside_angle(1.5, 1.0, inside), outside, 2e-3), "{cos}");
    }
    assert!(near(worst, 0.0357, 1e-3), "{worst}");
    let critical = (1.0 - 1.0 / 2.25f32).sqrt();
    assert!(schlick_outside_angle(1.5, 1.0, critical) > 0.99);
}

/// 3.5 and 3.6, slip: where the line in the glass comes from. Just before the critical angle the printed
/// formula gives 0.041 where Fresnel has almost 1; beyond it everything, where Fresnel has, for a ray from
/// outside, 5 %. On a ball the sine of the angle is the distance from the middle over the radius, so the
/// jump is a circle at 2/3 of the radius.
#[test]
fn schlick_with_the_inside_angle_jumps() {
    let cos = |sin: f32| (1.0 - sin * sin).sqrt();
    let (before, after) = (cos(0.6666), cos(0.6667));
    assert!(near(schlick_inside_angle(1.5, 1.0, before), 0.041, 1e-3));
    assert!(fresnel::dielectric(before, 1.0 / 1.5).0 > 0.9);
    assert_eq!(schlick_inside_angle(1.5, 1.0, after), 1.0);
    assert!(near(schlick_inside_angle(1.0, 1.5, before), 0.041, 1e-3));
    assert_eq!(schlick_inside_angle(1.0, 1.5, after), 1.0);
    assert!(near(fresnel::dielectric(after, 1.5).0, 0.05, 0.01));
}

/// 3.2: at glass the importance of both children adds up, so a ball of glass under a white sky is white.
/// What the threshold drops is missing: reflections of reflections, a part in a hundred at most.
#[test]
fn the_tree_keeps_the_importance_but_for_the_threshold() {
    let scene = ball("glass = { ior = 1.5 }");
    let mut options = options([8, 8], 16);
    let dropped = mean(&scene, &options).g;
    assert!(dropped < 0.9999 && dropped > 0.99, "{dropped}");
    options.shortcuts.threshold = 1e-6;
    assert!(near(mean(&scene, &options).g, 1.0, 1e-4));
    options.shortcuts = Shortcuts::NONE;
    assert!(near(mean(&scene, &options).g, 1.0, 2e-3));
}

/// 3.2: depth counts scattering events: at 0 there is only what shines; and a ray that has to pass a
/// ball of glass, in and out, needs two.
#[test]
fn the_tree_ends_at_its_depth() {
    let mut options = options([8, 8], 4);
    for (depth, expected) in [(0, 0.0), (1, 0.04), (2, 1.0)] {
        options.shortcuts.depth = depth;
        let seen = mean(&ball("glass = { ior = 1.5 }"), &options).g;
        assert!(near(seen, expected, 0.1), "{depth}: {seen}");
    }
}

/// Four rays in turn go through the four quarters of the pixel; so do the rays of each replication.
#[test]
fn rays_go_through_the_quarters() {
    let quarter = |ray| {
        let [x, y] = place_in_pixel(ray, 16, [0.99, 0.0]);
        2 * u32::from(y >= 0.5) + u32::from(x >= 0.5)
    };
    let sorted = |rays: [u32; 4]| {
        let mut q = rays.map(quarter);
        q.sort_unstable();
        q
    };
    for i in 0..4 {
        assert_eq!(sorted([4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]), [0, 1, 2, 3]);
        assert_eq!(sorted([i, i + 4, i + 8, i + 12]), [0, 1, 2, 3]);
    }
    assert_eq!(place_in_pixel(0, 1, [0.9, 0.2]), [0.9, 0.2], "one ray: the whole pixel");
    assert_eq!([0, 1, 2, 4, 5, 256].map(rays_per_pixel), [1, 1, 4, 4, 8, 256]);
}

/// What the method cannot do is an error that names it, and what it reduces is a note.
#[test]
fn refusals_and_notes() {
    let refuse = |scene: &Scene| Tracer::new(scene, &options([1, 1], 1)).unwrap_err().to_string();
    let mut sun = ball("diffuse = [1, 1, 1]");
    sun.cameras.clear();
    insta::assert_snapshot!(refuse(&sun), @"the scene has 0 cameras, and number 0 was asked for");
    let lamp = "[[light]]\nname = \"lamp\"\npoint = { intensity = [1, 1, 1] }\n";
    insta::assert_snapshot!(
        refuse(&scene(lamp)),
        @r#"light "lamp": the report's method knows only light from surfaces; expected a material that emits"#
    );
    let mut many = ball("light = [1, 1, 1]");
    let triangles = |n: usize| crate::scene::Mesh {
        positions: TRIANGLE.to_vec(),
        triangles: vec![[0, 1, 2]; n],
        ..Default::default()
    };
    many.meshes = vec![triangles(MOST_TRIANGLES + 1)];
    many.objects[0].shape = crate::scene::Shape::Mesh(crate::scene::MeshId(0));
    insta::assert_snapshot!(
        refuse(&many),
        @"found 10001 triangles, expected at most 10000: the report's method tries each of them"
    );
    many.meshes = vec![triangles(MOST_LIGHTS + 1)];
    insta::assert_snapshot!(
        refuse(&many),
        @"found 65 triangles that emit, expected at most 64: the report's method sends a shadow ray to each of them"
    );

    let rough = ball("principled = { metallic = 1, roughness = 0.5 }");
    let tracer = Tracer::new(&rough, &options([1, 1], 1)).unwrap();
    insta::assert_snapshot!(tracer.notes()[0], @r#""m" is principled and is rendered as a mirror"#);
}

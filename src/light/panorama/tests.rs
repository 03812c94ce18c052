use super::*;
use crate::math::mix64;

fn map(width: u32, height: u32, texel: impl Fn(u32, u32) -> [f32; 3]) -> Arc<Pixels> {
    let texels =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
    Arc::new(Pixels { width, height, texels: Texels::Float(texels) })
}

/// Positive texels of very different brightness, some of them black.
fn wild(width: u32, height: u32) -> Arc<Pixels> {
    map(width, height, |x, y| {
        let i = y * width + x;
        if i % 3 == 2 { [0.0; 3] } else { [1.0, 0.5, 0.1].map(|c| c * (1 + (i * 7) % 11) as f32) }
    })
}

/// Unit directions of a grid with `n` polar steps, with the solid angle of each.
fn directions(n: usize) -> impl Iterator<Item = (Vec3, f64)> {
    let cos = move |i: usize| libm::cos(std::f64::consts::PI * i as f64 / n as f64);
    (0..n).flat_map(move |i| {
        let (z, solid) =
            (0.5 * (cos(i) + cos(i + 1)), (cos(i) - cos(i + 1)) * std::f64::consts::PI / n as f64);
        (0..2 * n).map(move |k| {
            let (s, c) = sin_cos_turn((k as f32 + 0.5) / (2 * n) as f32);
            let r = (1.0 - z * z).sqrt() as f32;
            (Vec3::new(r * s, z as f32, r * c), solid)
        })
    })
}

fn uniform(i: u64) -> [f32; 2] {
    let bits = mix64(i + 1);
    [(bits >> 40) as f32, (bits >> 16 & 0xff_ffff) as f32].map(|x| x / (1 << 24) as f32)
}

/// Guards the density: it integrates to one over the sphere for odd sizes too, also where cells hold
/// several texels and the last ones fewer; and is positive wherever something shines.
#[test]
fn the_density_integrates_to_one() {
    for (w, h, most) in [(1, 1, 99), (2, 1, 99), (5, 3, 99), (16, 8, 9999), (17, 9, 20), (33, 7, 12)] {
        let map = Panorama::with_cells(wild(w, h), Rgb::WHITE, 0.7, most);
        let mut sum = 0.0;
        for (d, solid) in directions(256) {
            let pdf = map.pdf(d);
            assert!(pdf > 0.0 || map.radiance(d).is_black(), "{w}x{h} {d}");
            sum += f64::from(pdf) * solid;
        }
        assert!((sum - 1.0).abs() < 5e-3, "{w}x{h}: {sum}");
    }
}

/// Guards sampling against the density, by chi-square over bands of equal angles, and that nothing is
/// found where the density is zero.
#[test]
fn directions_follow_the_density() {
    for (w, h, most) in [(1, 1, 99), (2, 1, 99), (5, 3, 99), (9, 5, 12)] {
        let map = Panorama::with_cells(wild(w, h), Rgb::WHITE, 2.0, most);
        let bin = |d: Vec3| {
            let u = libm::atan2(f64::from(d.x), f64::from(d.z)) / std::f64::consts::TAU + 0.5;
            let v = libm::acos(f64::from(d.y).clamp(-1.0, 1.0)) / std::f64::consts::PI;
            ((v * 8.0) as usize).min(7) * 16 + ((u * 16.0) as usize).min(15)
        };
        let (mut expected, mut counts) = (vec![0.0; 128], vec![0.0; 128]);
        for (d, solid) in directions(512) {
            expected[bin(d)] += f64::from(map.pdf(d)) * solid;
        }
        let n = 100_000;
        for i in 0..n {
            let d = map.sample(uniform(i)).expect("a direction");
            assert!(map.pdf(d) > 0.0 && (d.length() - 1.0).abs() < 1e-6);
            counts[bin(d)] += 1.0;
        }
        let (mut x, mut freedom) = (0.0, -1.0);
        for (e, c) in expected.iter().zip(&counts).filter(|(e, _)| **e * n as f64 > 10.0) {
            let e: f64 = e * n as f64;
            x += (c - e) * (c - e) / e;
            freedom += 1.0;
        }
        // Five standard deviations, and the error of the quadrature.
        assert!(
            x < freedom + 5.0 * (2.0 * f64::max(freedom, 1.0)).sqrt() + 20.0,
            "{w}x{h}: {x} of {freedom}"
        );
    }
}

/// Guards the limit case: a picture of one colour is the uniform sphere, and has the figures of one.
#[test]
fn one_colour_is_a_uniform_sphere() {
    for (w, h) in [(1, 1), (2, 1), (5, 3), (64, 32)] {
        let map = Panorama::new(map(w, h, |_, _| [2.0, 1.0, 0.5]), Rgb::new(1.0, 2.0, 4.0), 1.0);
        for (d, _) in directions(16) {
            assert!((map.pdf(d) * 4.0 * PI - 1.0).abs() < 1e-3, "{w}x{h} {d}: {}", map.pdf(d) * 4.0 * PI);
            let off = (map.radiance(d) - Rgb::grey(2.0)).map(f32::abs).max_channel();
            assert!(off < 1e-6, "{w}x{h} {d}");
        }
        assert!((map.irradiance() / (2.0 * PI) - 1.0).abs() < 1e-5, "{}", map.irradiance());
        assert!((map.mean().r - 2.0).abs() < 1e-5 && map.brightest() == Rgb::grey(2.0));
    }
    assert!(Panorama::new(map(2, 2, |_, _| [0.0; 3]), Rgb::WHITE, 0.0).is_black());
}

/// Guards what the picture means: the middle is along -Z, +X to the right of it, the top row up; a turn is
/// counter-clockwise from above; integers are sRGB.
#[test]
fn directions_of_the_picture() {
    // Columns: red, green, blue, white; their middles are at 1/8, 3/8, 5/8 and 7/8 of a turn.
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    let at = |angle: f32| {
        // From -Z towards +X.
        let (s, c) = sin_cos_turn(angle);
        Vec3::new(s, 0.0, -c)
    };
    for (rotation, shift) in [(0.0, 0.0), (0.5, 0.5), (-7.0, -7.0)] {
        let map = Panorama::new(map(4, 1, |x, _| columns[x as usize]), Rgb::WHITE, rotation);
        for (x, expected) in columns.iter().enumerate() {
            let found = map.radiance(at((x as f32 + 0.5) / 4.0 - 0.5 - shift / (2.0 * PI)));
            let off = (found - Rgb::from(*expected)).map(f32::abs).max_channel();
            assert!(off < 1e-5, "{rotation} {x}: {found:?}");
        }
    }
    let rows = Panorama::new(map(1, 2, |_, y| [1.0 - y as f32; 3]), Rgb::WHITE, 0.0);
    assert_eq!((rows.radiance(Vec3::Y).r, rows.radiance(-Vec3::Y).r), (1.0, 0.0));
    assert!((rows.radiance(Vec3::X).r - 0.5).abs() < 1e-6);
    let grey = |texels| Panorama::new(Arc::new(Pixels { width: 1, height: 1, texels }), Rgb::WHITE, 0.0);
    let (byte, short) =
        (Texels::Byte(vec![[188, 188, 188, 255]]), Texels::Short(vec![[48_316, 48_316, 48_316, 65_535]]));
    for texels in [byte, short] {
        let found = grey(texels).radiance(Vec3::X).g;
        assert!((found - 0.502_886).abs() < 1e-4, "{found}");
    }
}

/// Guards what importance sampling is for: the irradiance of the ground under a sky with a small sun, by 64
/// samples, against as many uniform directions. Both errors are integrals, since uniform directions
/// hardly ever find the sun.
#[test]
fn a_small_sun_is_found() {
    let sun = |x: u32, y: u32| if (x, y) == (200, 40) { [2e4; 3] } else { [0.5, 0.7, 1.0] };
    let map = Panorama::new(map(512, 256, sun), Rgb::WHITE, 0.0);
    let (mut exact, mut squares) = (0.0, [0.0, 0.0]);
    for (d, solid) in directions(1024).filter(|(d, _)| d.y > 0.0) {
        let value = f64::from(map.radiance(d).luminance() * d.y);
        exact += value * solid;
        squares[0] += value * value / f64::from(map.pdf(d)) * solid;
        squares[1] += value * value * 4.0 * std::f64::consts::PI * solid;
    }
    let [by_picture, uniform] = squares.map(|s| (s / (exact * exact) - 1.0) / 64.0);
    assert!((exact - 3.4).abs() < 0.1, "{exact}");
    assert!(by_picture < 0.05 && uniform > 1000.0 * by_picture, "relMSE: {by_picture} against {uniform}");
}

//! Pictures in the reference integrator: a sum over texels, in f64, decoded by formula one by one.
//!
//! The place in the picture is KHR_texture_transform's: scaled, turned by (u, v) -> (c u + s v, c v - s u),
//! moved. Texel (i, j) of w x h has its middle at ((i + 1/2)/w, (j + 1/2)/h), row 0 on top. Linear: each
//! texel weighs as much as a tent of its width, zero at the middles of its neighbours. Nearest: the texel
//! that the place is in. What lies beyond the picture: it again, it mirrored and again, or its edge.

use glam::{DVec2, DVec4};

use crate::scene::{Filter, Pixels, Texels, Texture, Wrap};

/// The value of a texture at a place; `encoded` where integers are sRGB.
pub(super) fn read(t: &Texture, pixels: &Pixels, encoded: bool, uv: [DVec2; 2]) -> DVec4 {
    let uv = uv[usize::from(t.uv_set)] * DVec2::from(t.scale.map(f64::from));
    let (s, c) = (libm::sin(f64::from(t.rotation)), libm::cos(f64::from(t.rotation)));
    let turned = DVec2::new(c * uv.x + s * uv.y, c * uv.y - s * uv.x);
    let place = turned + DVec2::from(t.offset.map(f64::from));
    let size = [pixels.width, pixels.height].map(i64::from);
    // In texels, with the middle of the first at zero.
    let place = place * DVec2::new(size[0] as f64, size[1] as f64) - 0.5;
    let texel = |i: i64, j: i64| {
        let (i, j) = (inside(i, size[0], t.wrap[0]), inside(j, size[1], t.wrap[1]));
        decode(&pixels.texels, (j * size[0] + i) as usize, encoded)
    };
    if t.filter == Filter::Nearest {
        let near = (place + 0.5).floor();
        return texel(near.x as i64, near.y as i64);
    }
    let corner = place.floor();
    let mut sum = DVec4::ZERO;
    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let middle = corner + DVec2::new(dx, dy);
        let tent = (1.0 - (place - middle).abs()).max(DVec2::ZERO);
        sum += tent.x * tent.y * texel(middle.x as i64, middle.y as i64);
    }
    sum
}

/// The texel of a row of `n` that texel `i` shows.
fn inside(i: i64, n: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Repeat => (i % n + n) % n,
        Wrap::Mirror => {
            let there_and_back = (i % (2 * n) + 2 * n) % (2 * n);
            if there_and_back < n { there_and_back } else { 2 * n - 1 - there_and_back }
        }
        Wrap::Clamp => i.max(0).min(n - 1),
    }
}

fn decode(texels: &Texels, at: usize, encoded: bool) -> DVec4 {
    let integers = |v: [f64; 4], largest: f64| {
        let [r, g, b, a] = v.map(|c| c / largest);
        if encoded { DVec4::new(linear(r), linear(g), linear(b), a) } else { DVec4::new(r, g, b, a) }
    };
    match texels {
        Texels::Byte(list) => integers(list[at].map(f64::from), 255.0),
        Texels::Short(list) => integers(list[at].map(f64::from), 65535.0),
        Texels::Float(list) => {
            let [r, g, b] = list[at].map(f64::from);
            DVec4::new(r, g, b, 1.0)
        }
    }
}

/// sRGB (IEC 61966-2-1) to linear.
fn linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

//! The mesh that stands for an exact sphere in viewers that know none.

use std::f64::consts::PI;

/// Parts around the equator.
const AROUND: u32 = 32;
/// Parts from pole to pole.
const DOWN: u32 = 16;

/// Unit vectors to the vertices, which are positions and normals, and texture coordinates: u runs once
/// around +Y, v from the top to the bottom.
pub(super) fn vertices() -> (Vec<[f64; 3]>, Vec<[f32; 2]>) {
    let (mut points, mut uvs) = (Vec::new(), Vec::new());
    for row in 0..=DOWN {
        let (v, theta) = fraction(row, DOWN, PI);
        for column in 0..=AROUND {
            let (u, phi) = fraction(column, AROUND, 2.0 * PI);
            // Poles and seam close exactly.
            let s = if row == 0 || row == DOWN { 0.0 } else { libm::sin(theta) };
            let phi = if column == AROUND { 0.0 } else { phi };
            points.push([s * libm::cos(phi), libm::cos(theta), -s * libm::sin(phi)]);
            uvs.push([u as f32, v as f32]);
        }
    }
    (points, uvs)
}

fn fraction(part: u32, of: u32, whole: f64) -> (f64, f64) {
    let f = f64::from(part) / f64::from(of);
    (f, f * whole)
}

/// Triangles with their front outside; none has its corners at one place.
pub(super) fn triangles() -> Vec<[u32; 3]> {
    let at = |row: u32, column: u32| row * (AROUND + 1) + column;
    let mut out = Vec::new();
    for row in 0..DOWN {
        for column in 0..AROUND {
            let (a, b) = (at(row, column), at(row, column + 1));
            let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
            if row > 0 {
                out.push([a, c, b]);
            }
            if row + 1 < DOWN {
                out.push([b, c, d]);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// The front of every triangle is outside, and the surface is nearly that of the sphere.
    #[test]
    fn the_mesh_is_a_ball_with_its_front_outside() {
        let points: Vec<DVec3> = vertices().0.into_iter().map(DVec3::from).collect();
        assert!(points.iter().all(|p| (p.length() - 1.0).abs() < 1e-15));
        let mut area = 0.0;
        for t in triangles() {
            let [a, b, c] = t.map(|i| points[i as usize]);
            let n = (b - a).cross(c - a);
            assert!(n.dot(a + b + c) > 0.0, "{t:?}");
            area += 0.5 * n.length();
        }
        assert!((0.98..1.0).contains(&(area / (4.0 * PI))), "{area}");
    }
}

//! Primitive modes: strips and fans become triangles.

use gltf::json::mesh::Mode;

/// Number of triangles in `count` indices; `None` where the mode has no triangles.
pub(super) fn count(mode: Mode, count: u64) -> Option<u64> {
    match mode {
        Mode::Triangles => Some(count / 3),
        Mode::TriangleStrip | Mode::TriangleFan => Some(count.saturating_sub(2)),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => None,
    }
}

/// The triangles of `indices`, wound as glTF 2.0, section 3.7.2.1, says.
pub(super) fn list(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
        Mode::TriangleStrip => {
            let turn =
                |(i, t): (usize, &[u32])| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] };
            indices.windows(3).enumerate().map(turn).collect()
        }
        Mode::TriangleFan => {
            indices.get(1..).unwrap_or_default().windows(2).map(|t| [t[0], t[1], indices[0]]).collect()
        }
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Winding alternates in a strip, and a fan turns about its first vertex.
    #[test]
    fn modes_wind_as_the_specification_says() {
        let check = |mode, indices: &[u32], expected: &[[u32; 3]]| {
            assert_eq!(list(mode, indices), expected);
            assert_eq!(count(mode, indices.len() as u64), Some(expected.len() as u64));
        };
        check(Mode::Triangles, &[0, 1, 2, 3, 4, 5, 6], &[[0, 1, 2], [3, 4, 5]]);
        check(Mode::TriangleStrip, &[7, 8, 9, 5, 6], &[[7, 8, 9], [8, 5, 9], [9, 5, 6]]);
        check(Mode::TriangleFan, &[7, 8, 9, 5], &[[8, 9, 7], [9, 5, 7]]);
        check(Mode::TriangleStrip, &[1], &[]);
        check(Mode::TriangleFan, &[], &[]);
    }
}

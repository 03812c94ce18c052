//! Constructors: the flat shapes that people write by hand, as triangles.
//!
//! In: numbers of a scene file, in the file's own axes. Out: [`Surface`]s in the same axes, in double
//! precision, counter-clockwise seen from the front. Invariant: the triangles cover exactly the area
//! that was described, which [`fill`] checks against the polygon's own area, so a polygon that crosses
//! itself or a hole that leaves its outline is an error and never a wrong picture.

use glam::DVec3;

use super::model::{BoxTable, PrismTable, RectTable};
use super::up::Up;

/// Triangles in the axes of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Surface {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The faces of a prism; a part that has none is empty.
pub(super) struct PrismParts {
    pub(super) walls: Vec<Surface>,
    pub(super) floor: Surface,
    pub(super) ceiling: Surface,
}

/// More corners than this are a mesh, not a polygon that someone wrote.
const MAX_CORNERS: usize = 100_000;
/// How far corners may leave their common plane, as a share of the polygon's size.
const FLATNESS: f64 = 1e-6;
/// Relative difference allowed between the area described and the area covered.
const AREA_TOLERANCE: f64 = 1e-9;

impl Surface {
    /// The quadrilateral a, b, c, d; its front is where they run counter-clockwise.
    fn quad(corners: [DVec3; 4]) -> Self {
        Self { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]] }
    }

    /// Turns front to back.
    fn flip(&mut self) {
        for t in &mut self.triangles {
            t.swap(1, 2);
        }
    }

    /// Adds the triangles of another surface.
    pub(super) fn append(&mut self, other: &Self) {
        let base = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + base)));
    }
}

/// A box; eight corners, twelve triangles, the front outside.
pub(super) fn cuboid(shape: &BoxTable, up: Up) -> Result<Surface, String> {
    let size = DVec3::from(shape.size);
    if !(size.is_finite() && size.min_element() > 0.0) {
        return Err(format!("size {:?} has to be above zero along each axis", shape.size));
    }
    let (center, half) = (DVec3::from(shape.center), size * 0.5);
    let turn = shape.rotation.map(|r| r.matrix(up));
    let corner = |i: u32| {
        let side = |bit: u32| if i & bit == 0 { -1.0 } else { 1.0 };
        let p = half * DVec3::new(side(1), side(2), side(4));
        center + turn.map_or(p, |m| m * p)
    };
    // Corners of each face, counter-clockwise from outside; bit 0 of a corner is +x, bit 1 +y, bit 2 +z.
    const FACES: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Ok(Surface {
        positions: (0..8).map(corner).collect(),
        triangles: FACES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    })
}

/// A parallelogram.
pub(super) fn rect(shape: &RectTable) -> Result<Surface, String> {
    let corner = DVec3::from(shape.corner);
    let [e0, e1] = shape.edges.map(DVec3::from);
    let normal = e0.cross(e1);
    if normal == DVec3::ZERO {
        return Err("the two edges of a rect may not be parallel or zero".to_owned());
    }
    let mut surface = Surface::quad([corner, corner + e0, corner + e0 + e1, corner + e1]);
    turn_to(&mut surface, normal, corner + (e0 + e1) * 0.5, shape.facing)?;
    Ok(surface)
}

/// A flat polygon with holes.
pub(super) fn polygon(
    corners: &[[f64; 3]],
    holes: &[Vec<[f64; 3]>],
    facing: Option<[f64; 3]>,
) -> Result<Surface, String> {
    let outline: Vec<DVec3> = corners.iter().copied().map(DVec3::from).collect();
    let holes: Vec<Vec<DVec3>> = holes.iter().map(|h| h.iter().copied().map(DVec3::from).collect()).collect();
    let (surface, normal) = fill(&outline, &holes)?;
    let mut surface = surface;
    let middle = outline.iter().sum::<DVec3>() / outline.len() as f64;
    turn_to(&mut surface, normal, middle, facing)?;
    Ok(surface)
}

/// The walls, floor and ceiling of a prism.
pub(super) fn prism(shape: &PrismTable, up: Up) -> Result<PrismParts, String> {
    let (low, high) = (shape.bottom, shape.top);
    if !(low < high && low.is_finite() && high.is_finite()) {
        return Err(format!("bottom {low} has to be below top {high}"));
    }
    let raise =
        |plan: &[[f64; 2]], height: f64| plan.iter().map(|&c| up.raise(c, height)).collect::<Vec<_>>();
    let level = |height: f64, holes: &[Vec<[f64; 2]>], front_up: bool| {
        let holes: Vec<_> = holes.iter().map(|h| raise(h, height)).collect();
        let (mut surface, normal) = fill(&raise(&shape.corners, height), &holes)?;
        if (normal.dot(up.axis()) > 0.0) != front_up {
            surface.flip();
        }
        Ok::<_, String>((surface, normal))
    };
    let (floor, normal) = level(low, &shape.floor_holes, shape.inward)?;
    let (ceiling, _) = level(high, &shape.ceiling_holes, !shape.inward)?;
    // Seen from above, corners that run counter-clockwise have the inside on their left.
    let outward = normal.dot(up.axis()) > 0.0;
    let (bottom, top) = (raise(&shape.corners, low), raise(&shape.corners, high));
    let walls = (0..bottom.len()).map(|i| {
        let j = (i + 1) % bottom.len();
        let mut wall = Surface::quad([bottom[i], bottom[j], top[j], top[i]]);
        if outward == shape.inward {
            wall.flip();
        }
        wall
    });
    Ok(PrismParts { walls: walls.collect(), floor, ceiling })
}

/// Turns the front of `surface`, whose normal is `normal`, to the point `facing`.
fn turn_to(
    surface: &mut Surface,
    normal: DVec3,
    middle: DVec3,
    facing: Option<[f64; 3]>,
) -> Result<(), String> {
    let Some(facing) = facing else { return Ok(()) };
    let side = normal.dot(DVec3::from(facing) - middle);
    if side == 0.0 || !side.is_finite() {
        return Err("the point in facing lies in the surface's own plane".to_owned());
    }
    if side < 0.0 {
        surface.flip();
    }
    Ok(())
}

/// Fills a flat outline, minus holes; counter-clockwise about the normal that is returned with it.
fn fill(outline: &[DVec3], holes: &[Vec<DVec3>]) -> Result<(Surface, DVec3), String> {
    let count = outline.len() + holes.iter().map(Vec::len).sum::<usize>();
    if outline.len() < 3 || holes.iter().any(|h| h.len() < 3) {
        return Err("an outline needs at least three corners".to_owned());
    }
    if count > MAX_CORNERS {
        return Err(format!("{count} corners are more than {MAX_CORNERS}; use a mesh"));
    }
    let positions: Vec<DVec3> = outline.iter().chain(holes.iter().flatten()).copied().collect();
    if positions.iter().any(|p| !p.is_finite()) {
        return Err("a corner is not finite".to_owned());
    }
    let normal = area_vector(outline);
    let size = outline.iter().map(|p| p.distance(outline[0])).fold(0.0, f64::max);
    // Written so that NaN, from corners too large to multiply, fails too.
    if !(normal.length() > 1e-12 * size * size && normal.is_finite()) {
        return Err("the outline encloses no area".to_owned());
    }
    let unit = normal.normalize();
    let off = positions.iter().map(|p| (*p - outline[0]).dot(unit).abs()).fold(0.0, f64::max);
    if off > FLATNESS * size {
        return Err(format!("the corners are not in one plane, they are up to {off:.3e} m off; use a mesh"));
    }

    // Seen along the normal's largest component nothing is lost: two coordinates are simply kept.
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    let flat: Vec<[f64; 2]> = positions.iter().map(|p| [p[(axis + 1) % 3], p[(axis + 2) % 3]]).collect();
    let mut hole_starts = Vec::with_capacity(holes.len());
    let mut at = outline.len();
    for hole in holes {
        hole_starts.push(at as u32);
        at += hole.len();
    }
    let mut indices: Vec<u32> = Vec::new();
    if let (4, []) = (outline.len(), holes)
        && is_convex(&flat)
    {
        indices.extend([0, 1, 2, 0, 2, 3]);
    } else {
        earcut::Earcut::new().earcut_slice(&flat, &hole_starts, &mut indices);
    }

    let mut covered = 0.0;
    let mut triangles = Vec::with_capacity(indices.len() / 3);
    for t in indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]];
        let area = signed_area([flat[a as usize], flat[b as usize], flat[c as usize]]);
        covered += area.abs();
        triangles.push(if (area > 0.0) == (normal[axis] > 0.0) { [a, b, c] } else { [a, c, b] });
    }
    let described = normal[axis].abs() - holes.iter().map(|h| area_vector(h)[axis].abs()).sum::<f64>();
    if (covered - described).abs() > AREA_TOLERANCE * normal[axis].abs() {
        return Err("the outline crosses itself, or a hole crosses the outline or another hole".to_owned());
    }
    Ok((Surface { positions, triangles }, normal))
}

/// Newell's normal of a closed outline: its length is the area.
fn area_vector(corners: &[DVec3]) -> DVec3 {
    let origin = corners[0];
    let sum: DVec3 = corners.windows(2).map(|w| (w[0] - origin).cross(w[1] - origin)).sum();
    sum * 0.5
}

fn signed_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
}

fn is_convex(quad: &[[f64; 2]]) -> bool {
    let turn = |i: usize| signed_area([quad[i], quad[(i + 1) % 4], quad[(i + 2) % 4]]);
    (0..4).all(|i| turn(i) > 0.0) || (0..4).all(|i| turn(i) < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(surface: &Surface) -> DVec3 {
        let p = |i: u32| surface.positions[i as usize];
        surface.triangles.iter().map(|&[a, b, c]| (p(b) - p(a)).cross(p(c) - p(a)) * 0.5).sum()
    }

    /// Volume enclosed by the divergence theorem; negative where the front is inside.
    fn volume(surface: &Surface) -> f64 {
        let p = |i: u32| surface.positions[i as usize];
        surface.triangles.iter().map(|&[a, b, c]| p(a).dot(p(b).cross(p(c))) / 6.0).sum()
    }

    fn closed(shape: &PrismTable, up: Up) -> Surface {
        let parts = prism(shape, up).unwrap();
        let mut all = parts.floor;
        parts.walls.iter().for_each(|w| all.append(w));
        all.append(&parts.ceiling);
        all
    }

    #[test]
    fn boxes_and_prisms_are_closed_and_face_the_right_way() {
        let shape = BoxTable { center: [1.0, 2.0, 3.0], size: [2.0, 3.0, 4.0], rotation: None };
        let surface = cuboid(&shape, Up::Y).unwrap();
        assert_eq!(area(&surface), DVec3::ZERO, "closed");
        assert!((volume(&surface) - 24.0).abs() < 1e-12);

        let l_shape = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        for (reverse, inward, up) in
            [(false, false, Up::Z), (true, false, Up::Z), (false, true, Up::Y), (true, true, Up::Y)]
        {
            let mut corners = l_shape.to_vec();
            if reverse {
                corners.reverse();
            }
            let shape = PrismTable {
                corners,
                bottom: 1.0,
                top: 3.0,
                inward,
                walls: None,
                floor: None,
                ceiling: None,
                floor_holes: vec![],
                ceiling_holes: vec![],
            };
            let surface = closed(&shape, up);
            assert!(area(&surface).length() < 1e-12, "closed");
            let expected = if inward { -6.0 } else { 6.0 };
            assert!((volume(&surface) - expected).abs() < 1e-12, "{reverse} {inward} {up:?}");
        }
    }

    #[test]
    fn holes_are_left_open_and_facing_turns_the_front() {
        let square = |h: f64, z: f64| vec![[-h, -h, z], [h, -h, z], [h, h, z], [-h, h, z]];
        let facing_down = polygon(&square(2.0, 5.0), &[square(1.0, 5.0)], Some([0.0, 0.0, 0.0])).unwrap();
        assert!((area(&facing_down) - DVec3::new(0.0, 0.0, -12.0)).length() < 1e-12);
        let by_winding = polygon(&square(2.0, 5.0), &[], None).unwrap();
        assert!((area(&by_winding) - DVec3::new(0.0, 0.0, 16.0)).length() < 1e-12);
    }

    #[test]
    fn shapes_that_make_no_sense_are_errors() {
        let check = |corners: &[[f64; 3]], holes: &[Vec<[f64; 3]>], expected: &str| {
            let error = polygon(corners, holes, None).unwrap_err();
            assert!(error.contains(expected), "{error}");
        };
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        check(&square[..2], &[], "three corners");
        check(&[square[0], square[1], square[2], [0.0, 1.0, 0.1]], &[], "not in one plane");
        check(&[square[0], square[1], [2.0, 0.0, 0.0]], &[], "no area");
        check(&[[f64::NAN, 0.0, 0.0], square[1], square[2]], &[], "finite");
        check(&[[0.0, 0.0, 0.0], [3.0, 1.0, 0.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0]], &[], "crosses itself");
        let outside = vec![[0.5, 0.5, 0.0], [3.0, 0.5, 0.0], [0.5, 0.75, 0.0]];
        check(&square, &[outside], "crosses");
    }
}

//! Repairs of meshes that real files need: triangles without area, normals that are not numbers.
//!
//! In: a mesh whose indices are in range. Out: the same mesh without what cannot be rendered, and one
//! counted note for each sort of repair. Invariant: repairing twice changes nothing.

use glam::{DVec3, Vec3};

use super::{Mesh, Note, NoteEffect};

/// How far the squared length of a normal may be from one before it counts as not unit.
const UNIT_TOLERANCE: f32 = 1e-3;

pub(super) fn repair(mesh: &mut Mesh, place: &str) -> Vec<Note> {
    let mut notes = Vec::new();
    let mut note =
        |code, effect, message| notes.push(Note { code, place: place.to_owned(), message, effect });
    let name = mesh.name.clone();

    let before = mesh.triangles.len();
    let positions = &mesh.positions;
    let corners = |t: &[u32; 3]| t.map(|i| positions[i as usize]);
    mesh.triangles.retain(|t| corners(t).iter().all(|p| p.is_finite()));
    let finite = mesh.triangles.len();
    if finite < before {
        let message = format!(
            "{} of {before} triangles of mesh \"{name}\" have a corner that is not finite; they were dropped",
            before - finite
        );
        note("non-finite-triangles", NoteEffect::Missing, message);
    }
    mesh.triangles.retain(|t| !is_degenerate(corners(t)));
    let sound = mesh.triangles.len();
    if sound < finite {
        let message = format!(
            "{} of {before} triangles of mesh \"{name}\" have no area; they were dropped",
            finite - sound
        );
        note("degenerate-triangles", NoteEffect::None, message);
    }
    // No triangle uses these any more; as zeros they harm neither bounds nor files.
    for p in mesh.positions.iter_mut().filter(|p| !p.is_finite()) {
        *p = Vec3::ZERO;
    }

    let bad: Vec<usize> = (0..mesh.normals.len()).filter(|&i| !is_unit(mesh.normals[i])).collect();
    if !bad.is_empty() {
        let message = format!(
            "{} of {} normals of mesh \"{name}\" are not unit vectors; they were scaled, or taken from the triangles",
            bad.len(),
            mesh.normals.len()
        );
        note("invalid-normals", NoteEffect::Differs, message);
        let fallback = smooth_normals(mesh);
        for i in bad {
            // In double precision no single is too small or too large to scale.
            let n = mesh.normals[i].as_dvec3();
            let scaled = if n.is_finite() { n.try_normalize() } else { None };
            mesh.normals[i] = scaled.map_or(fallback[i], DVec3::as_vec3);
        }
    }

    let sane = |t: &glam::Vec4| is_unit(t.truncate()) && t.w.abs() == 1.0;
    let bad = mesh.tangents.iter().filter(|t| !sane(t)).count();
    if bad > 0 {
        let message = format!(
            "{bad} of {} tangents of mesh \"{name}\" are not unit vectors with a sign; all of its tangents were dropped",
            mesh.tangents.len()
        );
        note("invalid-tangents", NoteEffect::Differs, message);
        mesh.tangents.clear();
    }
    notes
}

fn is_unit(n: Vec3) -> bool {
    // Written so that NaN fails too.
    (n.length_squared() - 1.0).abs() <= UNIT_TOLERANCE
}

/// For each vertex the normalised sum of the area vectors around it; +Y where there are none.
fn smooth_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        let area = (b - a).cross(c - a);
        t.iter().for_each(|&i| sums[i as usize] += area);
    }
    sums.into_iter().map(|n| n.try_normalize().unwrap_or(DVec3::Y).as_vec3()).collect()
}

/// True where three points lie on one line: exact wherever their differences are exact in double
/// precision, which holds while coordinates along one axis are within 2^29 of each other in size.
fn is_degenerate([a, b, c]: [Vec3; 3]) -> bool {
    let (a, b, c) = (a.as_dvec3(), b.as_dvec3(), c.as_dvec3());
    let (e, f) = (b - a, c - a);
    // Well away from zero, rounding cannot decide; this is nearly always so.
    let bound = 1e-12 * e.length() * f.length();
    e.cross(f).abs().max_element() <= bound
        && equal_products(e.y, f.z, e.z, f.y)
        && equal_products(e.z, f.x, e.x, f.z)
        && equal_products(e.x, f.y, e.y, f.x)
}

/// Whether a b = c d exactly: a product is its rounded value and the error of that rounding, which a
/// fused multiply-add (here libm's, in software) gives without loss.
fn equal_products(a: f64, b: f64, c: f64, d: f64) -> bool {
    let (p, q) = (a * b, c * d);
    p == q && libm::fma(a, b, -p) == libm::fma(c, d, -q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh { name: "m".into(), positions, triangles, ..Mesh::default() }
    }

    #[test]
    fn points_on_a_line_are_told_from_thin_triangles_exactly() {
        let check = |a: [f32; 3], b: [f32; 3], c: [f32; 3], expected| {
            for t in [[a, b, c], [b, c, a], [c, a, b], [a, c, b]] {
                assert_eq!(is_degenerate(t.map(Vec3::from)), expected, "{t:?}");
            }
        };
        let p = [0.1f32, 0.3, 0.7];
        check([0.0; 3], p, p.map(|v| 2.0 * v), true);
        check([0.0; 3], p, p.map(|v| -4.0 * v), true);
        check(p, p, [1.0, 2.0, 3.0], true);
        let [x, y, z] = p.map(|v| 2.0 * v);
        check([0.0; 3], p, [x, y, z.next_up()], false);
        // Thinner than any relative tolerance in single precision would tell apart.
        check([0.0; 3], [1.0, 0.0, 0.0], [2.0, 1e-30, 0.0], false);
        check([0.0; 3], [1e-20, 0.0, 0.0], [0.0, 1e-20, 0.0], false);
        // The two products of this one round to the same double; only their errors differ.
        let (ulp, tiny) = (f32::EPSILON, f32::EPSILON / 512.0);
        check([tiny, 0.0, 0.0], [1.0, 0.5, 0.0], [1.0 + 2.0 * ulp, 0.5 + ulp, 0.0], false);
        check([16_777_216.0, 16_777_215.0, 0.0], [0.0; 3], [16_777_215.0, 16_777_214.0, 0.0], false);
    }

    #[test]
    fn what_cannot_be_rendered_is_dropped_and_counted() {
        let p = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(2.0, 0.0, 0.0), Vec3::NAN];
        let mut m = mesh(p.to_vec(), vec![[0, 1, 2], [0, 1, 3], [1, 1, 2], [0, 2, 4]]);
        let notes: Vec<String> = repair(&mut m, "meshes[0]").iter().map(Note::to_string).collect();
        assert_eq!(
            notes,
            [
                "meshes[0]: 1 of 4 triangles of mesh \"m\" have a corner that is not finite; they were dropped",
                "meshes[0]: 2 of 4 triangles of mesh \"m\" have no area; they were dropped",
            ]
        );
        assert_eq!(m.triangles, [[0, 1, 2]]);
        assert_eq!(m.positions[4], Vec3::ZERO);
        assert!(repair(&mut m, "").is_empty(), "a second repair has nothing to do");
    }

    #[test]
    fn normals_are_scaled_or_taken_from_the_triangles() {
        let mut m = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE], vec![[0, 1, 2]]);
        m.normals = vec![Vec3::NAN, Vec3::new(0.0, 1e-30, 0.0), Vec3::X, Vec3::ZERO];
        m.tangents = vec![Vec4::new(1.0, 0.0, 0.0, 0.5); 4];
        let codes: Vec<&str> = repair(&mut m, "").iter().map(|n| n.code).collect();
        assert_eq!(codes, ["invalid-normals", "invalid-tangents"]);
        assert_eq!(m.normals, [Vec3::Z, Vec3::Y, Vec3::X, Vec3::Y]);
        assert!(m.tangents.is_empty());
        assert!(repair(&mut m, "").is_empty(), "a second repair has nothing to do");
    }
}

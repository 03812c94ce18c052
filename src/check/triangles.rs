//! Hard cases about triangles, and about the trees over them.
//!
//! Sources of the failures that they look for: Woop, Benthin and Wald, JCGT 2(1), 2013 (leaks); Ize, JCGT 2(2),
//! 2013 (boxes that hide what is in them); issues of other renderers that the catalogue names.

mod coincident;
mod degenerate;
mod far;
pub(super) mod slivers;
mod tree;
mod watertight;

use super::{Case, Class};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N13",
        class: Class::Unit,
        guards: "No ray leaves a closed mesh, however exactly it is aimed at vertices and edges.",
        run: watertight::closed_mesh,
    },
    Case {
        id: "N14",
        class: Class::Unit,
        guards: "Axis-parallel rays, with zeros of both signs and origins on boxes, find what brute force finds.",
        run: tree::axis_parallel,
    },
    Case {
        id: "N15",
        class: Class::Unit,
        guards: "The tree over triangles of very different sizes finds what brute force finds, to the bit.",
        run: tree::soup,
    },
    Case {
        id: "N16",
        class: Class::Unit,
        guards: "Thin triangles are hit within their boxes only, missed only within rounding of an edge, and found in a tree as by brute force.",
        run: slivers::thin,
    },
    Case {
        id: "N17",
        class: Class::Unit,
        guards: "Triangles without an area are dropped and counted, are never hit, and never a light.",
        run: degenerate::no_area,
    },
    Case {
        id: "N18",
        class: Class::Unit,
        guards: "A ray misses a triangle whose three points lie on a line that the ray passes.",
        run: degenerate::on_a_line,
    },
    Case {
        id: "N19",
        class: Class::Unit,
        guards: "Points on tiny, huge and far triangles lie in the plane of the triangle.",
        run: far::in_plane,
    },
    Case {
        id: "N20",
        class: Class::Unit,
        guards: "Grazing rays know how far the plane is that they meet, and from which side.",
        run: far::grazing,
    },
    Case {
        id: "N21",
        class: Class::Unit,
        guards: "Of coincident triangles the first one wins, in any tree and with any number of threads.",
        run: coincident::first_wins,
    },
];

//! Hard cases about position: leaving a surface, at every scale and far from the origin.
//!
//! Sources of the failures that they look for: Waechter and Binder, Ray Tracing Gems, chapter 6, 2019; Pharr et
//! al., "Physically Based Rendering", 4th ed., section 6.8; Hanika, Ray Tracing Gems II, chapter 4, 2021.

mod leaving;
mod lit;
mod plates;
mod round;
mod scaled;
mod terminator;

use super::{Case, Class};

pub(super) const CASES: &[Case] = &[
    Case {
        id: "N01",
        class: Class::Unit,
        guards: "A ray that leaves a triangle does not meet it again, whatever the size of the triangle.",
        run: leaving::any_size,
    },
    Case {
        id: "N02",
        class: Class::Unit,
        guards: "A ray that leaves a triangle far from the origin of the world does not meet it again.",
        run: leaving::far_away,
    },
    Case {
        id: "N03",
        class: Class::Unit,
        guards: "A ray that leaves a finely meshed plane, however flatly, does not meet the neighbours of its triangle.",
        run: leaving::meshed_plane,
    },
    Case {
        id: "N04",
        class: Class::Unit,
        guards: "A ray that leaves a plate is not moved past a second one that is very near, at 37 scales.",
        run: plates::near_plates,
    },
    Case {
        id: "N05",
        class: Class::Unit,
        guards: "A ray through a ball of glass is deflected as Snell has it, whatever the size of the ball.",
        run: round::deflection,
    },
    Case {
        id: "N06",
        class: Class::Unit,
        guards: "A ray that leaves a sphere to its outside does not meet it again, small and far, or large.",
        run: round::outwards,
    },
    Case {
        id: "N07",
        class: Class::Statistical,
        guards: "A scene whose lengths are scaled by a power of two gives the same picture, bit for bit.",
        run: scaled::powers_of_two,
    },
    Case {
        id: "N08",
        class: Class::Statistical,
        guards: "A scene that is scaled a million times up or down, or stands far from the origin, gives the same picture.",
        run: scaled::anywhere,
    },
    Case {
        id: "N09",
        class: Class::Unit,
        guards: "A light does not shadow itself, at any distance.",
        run: lit::unobstructed,
    },
    Case {
        id: "N10",
        class: Class::Statistical,
        guards: "A ball that rests on the floor leaks no light where it touches it.",
        run: lit::contact,
    },
    Case {
        id: "N11",
        class: Class::Statistical,
        guards: "Coarse spheres with smooth normals approach the exact sphere at the terminator, and lose no light.",
        run: terminator::smooth_spheres,
    },
    Case {
        id: "N12",
        class: Class::Statistical,
        guards: "No light passes an opaque wall, however far its shading normals are bent.",
        run: lit::bent_normals,
    },
];

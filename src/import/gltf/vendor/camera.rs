//! Cameras: shift, depth of field, and exact angles.

use std::f64::consts::PI;

use gltf::json;

use super::check::Check;
use super::table;
use crate::scene::extension::CameraTable;
use crate::scene::notes::Notes;
use crate::scene::{Camera, FovAxis, Lens, Projection};

/// Changes `camera` by the extension of `source`, which stands at `place`.
pub(in super::super) fn camera(source: &json::Camera, place: &str, camera: &mut Camera, notes: &mut Notes) {
    let others = source.extensions.as_ref().map(|e| &e.others);
    let (t, place) = table::<CameraTable>(others, &source.extras, place, notes);
    let mut check = Check { place, notes };
    let given_axis = t.fov_axis.map(|word| word.0);
    let axis = given_axis.unwrap_or(FovAxis::Vertical);
    match (&mut camera.projection, t.fov, t.extent) {
        (Projection::Perspective { fov, axis: to }, Some(v), _) => {
            if v > 0.0 && v < PI {
                (*fov, *to) = (v, axis);
            } else {
                check.ignore("fov", &format!("{v} is no angle between 0 and pi"));
            }
        }
        (Projection::Orthographic { extent, axis: to }, _, Some(v)) => {
            if let Some(v) = check.length("extent", v) {
                (*extent, *to) = (v, axis);
                camera.aspect = None;
            }
        }
        _ => {}
    }
    match camera.projection {
        Projection::Perspective { .. } if t.extent.is_some() => {
            check.ignore("extent", "a perspective camera has a `fov`");
        }
        Projection::Orthographic { .. } if t.fov.is_some() => {
            check.ignore("fov", "an orthographic camera has an `extent`");
        }
        _ => {}
    }
    if let Some(aspect) = t.aspect {
        camera.aspect = Some(check.number("aspect", aspect, 1e-5, 1e5));
    }
    if let Some(shift) = t.shift {
        let shift = shift.map(|v| check.number("shift", v, -1e6, 1e6));
        // The scene measures the shift by the side that the angle spans.
        let (Projection::Perspective { axis: own, .. } | Projection::Orthographic { axis: own, .. }) =
            camera.projection;
        let factor = match (given_axis.unwrap_or(own), own, camera.aspect) {
            (FovAxis::Horizontal, FovAxis::Vertical, Some(aspect)) => Some(aspect),
            (FovAxis::Vertical, FovAxis::Horizontal, Some(aspect)) => Some(1.0 / aspect),
            (a, b, _) => (a == b).then_some(1.0),
        };
        match factor {
            Some(factor) => camera.shift = shift.map(|v| v * factor),
            None => {
                check.ignore("shift", "the shift is by another side than the angle, and no aspect is known");
            }
        }
    }
    if let Some(lens) = t.lens {
        match (lens.radius, lens.focus) {
            (Some(radius), Some(focus)) => {
                let radius = check.length("lens.radius", radius);
                let focus = check.length("lens.focus", focus);
                camera.lens =
                    radius.zip(focus).map(|(radius, focus_distance)| Lens { radius, focus_distance });
            }
            _ => check.ignore("lens", "a lens needs `radius` and `focus`"),
        }
    }
}

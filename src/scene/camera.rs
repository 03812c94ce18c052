//! Cameras.

use glam::DAffine3;

/// A camera placed in the world; it looks along its own -Z, with +Y up and +X to the right.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Unique in the scene.
    pub name: String,
    /// Camera space to world space: rotation and translation (any scale is ignored).
    pub transform: DAffine3,
    /// How directions map to the picture.
    pub projection: Projection,
    /// Where the middle of the picture sits, in units of the side that `fov` or `extent` spans; x to
    /// the right, y up. Zero is straight ahead.
    pub shift: [f64; 2],
    /// Depth of field; a pinhole where absent.
    pub lens: Option<Lens>,
    /// Width over height that the author meant; used where no size is given.
    pub aspect: Option<f64>,
}

/// How directions map to the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Straight lines through one point.
    Perspective {
        /// Full angle over the side named by `axis`, radians, (0, pi).
        fov: f64,
        /// Which side of the picture the angle spans.
        axis: FovAxis,
    },
    /// Parallel rays.
    Orthographic {
        /// Full extent of the side named by `axis`, metres, (0, inf).
        extent: f64,
        /// Which side of the picture the extent spans.
        axis: FovAxis,
    },
}

/// A side of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FovAxis {
    /// Left to right.
    #[default]
    Horizontal,
    /// Bottom to top.
    Vertical,
}

/// A thin lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Radius of the aperture, metres, (0, inf).
    pub radius: f64,
    /// Distance of the plane in focus along the view axis, metres, (0, inf).
    pub focus_distance: f64,
}

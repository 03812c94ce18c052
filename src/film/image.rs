//! A finished image in memory: what `output` writes and `report` compares.

use crate::color::Rgb;

/// Linear pixels and what is known about them. Row-major, top row first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Where the first pixel lies in the whole picture, when this is a crop of it.
    pub origin: [u32; 2],
    /// Width and height of the whole picture.
    pub full_size: [u32; 2],
    /// Mean radiance, W sr^-1 m^-2.
    pub rgb: Vec<Rgb>,
    /// Coverage in [0, 1], where the background is transparent.
    pub alpha: Option<Vec<f32>>,
    /// Variance of each pixel's mean, where it was estimated.
    pub variance: Option<Vec<Rgb>>,
    /// Samples that each mean counts, where it is known.
    pub count: Option<Vec<u32>>,
    /// Further quantities, such as normals.
    pub layers: Vec<Layer>,
    /// What a reader of the file should know, as name and value; a function of scene, settings and
    /// passes only, so that equal renders make equal files.
    pub attributes: Vec<(String, String)>,
}

/// A further quantity per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Channel names as EXR readers expect them (`N.X`, `albedo.R`, `Z`), each with one value a pixel.
    pub channels: Vec<(String, Vec<f32>)>,
}

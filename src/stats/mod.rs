//! Numbers about numbers: distributions, tests, errors of images.
//!
//! In: plain numbers and pixels. Out: probabilities, intervals, verdicts' ingredients and error measures. Sources
//! are named at each function. Probabilities serve reports and tests; none reaches an image.

mod distributions;
mod error;
pub mod gate;
mod interval;
mod moments;
mod slope;

pub use distributions::{
    NORMAL_95, normal_cdf, normal_quantile, sidak, sidak_each, student_quantile, student_two_sided, two_sided,
};
pub use error::{ERROR_FLOOR, luminance, luminance_of, relative_error, relative_mse, root_mean_square_error};
pub use interval::Interval;
pub use moments::{Moments, Welch, welch};
pub use slope::slope;

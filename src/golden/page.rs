//! placeholder until the page is merged
use super::Verification;
/// About
pub struct About {
    /// t
    pub title: String,
    /// c
    pub command: String,
    /// s
    pub significance: f64,
}
/// page
#[must_use]
pub fn page(_: &[Verification], a: &About) -> String {
    a.title.clone()
}

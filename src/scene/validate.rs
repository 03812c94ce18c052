//! Validation: what `prepare` may rely on.

use super::{Note, Scene};

/// Why a scene cannot be rendered.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {message}")]
pub struct SceneError {
    /// Path in the scene, such as `materials[2].ior` or `cameras["front"].fov`.
    pub place: String,
    /// What was found, and what was expected.
    pub message: String,
}

/// Checks every value, and repairs what can be repaired (degenerate triangles are dropped).
///
/// # Errors
/// The first value that is out of range, not finite, or refers to something that is not there.
pub fn validate(_scene: &mut Scene) -> Result<Vec<Note>, SceneError> {
    Ok(Vec::new())
}

//! The text form of a scene: TOML, and the same model as JSON.

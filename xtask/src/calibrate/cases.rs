//! What is rendered.

/// What a case is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Constants of the estimate were looked at on it.
    Tuned,
    /// It was not.
    Unseen,
    /// Few pixels carry its error: intervals have to hold, but may be wide, and errors may be doubted.
    Hard,
    /// Made to mislead: the error may be wrong, but not without a word.
    Misleading,
}

/// A scene, a target, and how long its reference is.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    pub(super) scene: &'static str,
    pub(super) flags: &'static [&'static str],
    /// The error that is asked for, relative.
    pub(super) target: f64,
    /// Samples per pixel at most.
    pub(super) most: u32,
    /// Those of the reference: its error should be a fifth of the target or less.
    pub(super) reference: u32,
}

impl Case {
    /// What the reference depends on, as a name: the target is no part of it.
    pub(super) fn picture(&self) -> &'static str {
        match self.name {
            "keyhole" | "pinhole" => "wide",
            name => name.split('@').next().unwrap_or(name),
        }
    }

    /// The scene of the reference: where paths do not find the light, one where they find as much.
    pub(super) fn reference_scene(&self) -> &'static str {
        if self.picture() == "wide" { "fixtures/misleading/wide.toml" } else { self.scene }
    }
}

const PHOTONS: &[&str] = &["--algorithm", "caustics=photon"];
const PATHS: &[&str] = &["--algorithm", "caustics=path"];

macro_rules! cases {
    ($($kind:ident $name:literal $scene:literal $flags:expr, $target:literal, $most:literal, $reference:literal;)*) => {
        pub(super) const CASES: &[Case] = &[$(Case {
            name: $name,
            kind: Kind::$kind,
            scene: $scene,
            flags: $flags,
            target: $target,
            most: $most,
            reference: $reference,
        }),*];
    };
}

cases! {
    Tuned "cornell" "scenes/cornell.toml" &[], 0.03, 8192, 8192;
    Tuned "hexroom-diffuse" "scenes/hexroom-diffuse.toml" &[], 0.03, 8192, 4096;
    Tuned "sky" "fixtures/golden/sky/scene.toml" PATHS, 0.03, 8192, 4096;
    Hard "materials" "scenes/materials.toml" PATHS, 0.03, 8192, 2048;
    Tuned "glass-slab-photons" "fixtures/golden/glass-slab/scene.toml" PHOTONS, 0.03, 2048, 12288;
    Unseen "many-lights" "fixtures/golden/many-lights/scene.toml" PATHS, 0.03, 8192, 4096;
    Unseen "textured" "fixtures/golden/textured/scene.toml" PATHS, 0.03, 8192, 4096;
    Unseen "depth-of-field" "fixtures/golden/depth-of-field/scene.toml" PATHS, 0.03, 8192, 4096;
    Unseen "coat-sheen" "fixtures/golden/coat-sheen/scene.toml" PATHS, 0.03, 8192, 4096;
    Unseen "room-direct" "fixtures/golden/room-direct/scene.toml" PATHS, 0.03, 8192, 4096;
    Unseen "edges" "fixtures/golden/edges/scene.toml" PATHS, 0.03, 8192, 2048;
    Unseen "sphere-penumbra" "fixtures/golden/sphere-penumbra/scene.toml" PATHS, 0.03, 8192, 2048;
    Unseen "nested-glass-photons" "fixtures/golden/nested-glass/scene.toml" PHOTONS, 0.03, 2048, 12288;
    Unseen "drink" "scenes/drink.toml" PATHS, 0.1, 2048, 8192;
    Unseen "hexroom-photons" "scenes/hexroom.toml" PHOTONS, 0.03, 4096, 12288;
    Hard "caustic-photons" "scenes/caustic.toml" PHOTONS, 0.03, 512, 16384;
    Unseen "edges@1%" "fixtures/golden/edges/scene.toml" PATHS, 0.01, 32768, 8192;
    Unseen "sphere-penumbra@1%" "fixtures/golden/sphere-penumbra/scene.toml" PATHS, 0.01, 32768, 8192;
    Misleading "keyhole" "fixtures/misleading/keyhole.toml" PATHS, 0.03, 512, 2048;
    Misleading "pinhole" "fixtures/misleading/pinhole.toml" PATHS, 0.03, 512, 2048;
    Misleading "caustic-paths" "scenes/caustic.toml" PATHS, 0.03, 512, 16384;
    Unseen "hexroom-paths" "scenes/hexroom.toml" PATHS, 0.03, 512, 4096;
}

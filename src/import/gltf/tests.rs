//! Files in, scenes and messages out: one case per feature, then hostile files.

mod build;
mod cameras_lights;
mod geometry;
mod hostile;
mod instances;
mod materials;
mod nodes;
mod still_life;
mod textures;

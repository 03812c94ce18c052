//! Which extensions are read, and what the others would change.

use super::super::error::Fault;
use super::super::notes::Notes;
use super::document::Extensions;
use crate::scene::NoteEffect;

/// Extensions that are read.
const READ: &[&str] = &[
    "EPSILUX_scene",
    "EXT_lights_area",
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "KHR_implicit_shapes",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Extensions that are not read: name, what the picture lacks without, and the effect of that.
const IGNORED: &[(&str, &str, NoteEffect)] = &[
    ("EXT_lights_image_based", "its environment is missing", NoteEffect::Missing),
    ("KHR_materials_anisotropy", "highlights are round", NoteEffect::Differs),
    ("KHR_materials_diffuse_transmission", "light does not pass diffusely", NoteEffect::Missing),
    ("KHR_materials_dispersion", "glass does not split colours", NoteEffect::Missing),
    ("KHR_materials_iridescence", "the thin film is missing", NoteEffect::Missing),
    ("KHR_materials_pbrSpecularGlossiness", "the metallic-roughness fallback is used", NoteEffect::Differs),
    ("KHR_materials_variants", "the default variant is shown", NoteEffect::None),
    ("KHR_animation_pointer", "animations are not played", NoteEffect::Differs),
    ("KHR_xmp_json_ld", "it is metadata", NoteEffect::None),
    ("KHR_draco_mesh_compression", "the uncompressed fallback is used", NoteEffect::None),
    ("EXT_meshopt_compression", "the uncompressed fallback is used", NoteEffect::None),
    ("KHR_texture_basisu", "the PNG or JPEG beside it is used, where there is one", NoteEffect::None),
    ("EXT_texture_avif", "the PNG or JPEG beside it is used, where there is one", NoteEffect::None),
    ("MSFT_texture_dds", "the PNG or JPEG beside it is used, where there is one", NoteEffect::None),
];

/// Refuses a file that requires what is not read, and notes what is ignored.
pub(super) fn check(extensions: &Extensions, notes: &mut Notes) -> Result<(), Fault> {
    for (i, name) in extensions.required.iter().enumerate() {
        if !READ.contains(&&**name) {
            return Err(Fault::Unsupported {
                place: format!("extensionsRequired[{i}]"),
                feature: name.clone(),
                help: help(name).into(),
            });
        }
    }
    for (name, (place, count)) in &extensions.found {
        if READ.contains(&&**name) {
            continue;
        }
        let known = IGNORED.iter().find(|(n, ..)| n == name);
        let (change, effect) =
            known.map_or(("what it describes is missing", NoteEffect::Missing), |&(_, c, e)| (c, e));
        let message = format!("{name} is not supported: {change}");
        notes.add_many("extension-ignored", effect, place, message, *count);
    }
    Ok(())
}

/// What the user of a file can do about a required extension.
fn help(name: &str) -> &'static str {
    match name {
        "KHR_draco_mesh_compression" => {
            "export again without compression (in Blender: Data, Compression, off)"
        }
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => "export again without meshopt compression",
        "KHR_texture_basisu" => "export the textures as PNG or JPEG",
        "KHR_materials_pbrSpecularGlossiness" => "convert the materials to metallic-roughness",
        _ => "export again without it, or as optional",
    }
}

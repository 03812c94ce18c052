//! The scene: its title, its environment, and the hints how to render it.

use super::super::super::error::Fault;
use super::super::accessor::Reader;
use super::super::texture::Textures;
use super::check::Check;
use super::{Root, choose};
use crate::color::Rgb;
use crate::scene::extension::{EnvironmentTable, FilmTable, SceneTable};
use crate::scene::notes::Notes;
use crate::scene::{Environment, EnvironmentImage, MAX_INDIRECT_GAIN, MAX_SIDE, NoteEffect, Scene, Settings};

/// The most by which an environment may be turned, radians: a few turns.
const MAX_ROTATION: f64 = 1e3;

/// Changes `scene` by the extension of the scene that was read.
pub(in super::super) fn scene(
    root: &Root,
    scene: &mut Scene,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let (place, extension, extras) = &root.scene;
    let (t, place) = choose::<SceneTable>(extension.as_ref(), extras.as_ref(), place, notes);
    if let Some(title) = t.title {
        scene.title = title;
    }
    if let Some(film) = t.film {
        let mut check = Check { place: format!("{place}.film"), notes };
        settings(&film, &mut scene.settings, &mut check);
    }
    if let Some(e) = t.environment {
        let place = format!("{place}.environment");
        scene.environment = Some(environment(e, place, textures, reader, notes)?);
    }
    Ok(())
}

fn settings(film: &FilmTable, settings: &mut Settings, check: &mut Check<'_>) {
    if let Some(size) = film.size {
        settings.size = Some(size.map(|v| check.whole("size", v, 1, MAX_SIDE)));
    }
    if let Some(exposure) = film.exposure {
        settings.exposure = Some(check.number("exposure", exposure, -126.0, 126.0) as f32);
    }
    if let Some(tone) = film.tone {
        settings.tone = Some(tone.0);
    }
    if let Some(spp) = film.spp {
        settings.spp = Some(check.whole("spp", spp, 1, u32::MAX));
    }
    if let Some(depth) = film.max_depth {
        settings.max_depth = Some(check.whole("max_depth", depth, 0, u32::MAX));
    }
    if let Some(gain) = film.indirect_gain {
        let most = MAX_INDIRECT_GAIN.into();
        settings.indirect_gain = Some(check.number("indirect_gain", gain, 0.0, most) as f32);
    }
}

fn environment(
    e: EnvironmentTable,
    place: String,
    textures: &mut Textures<'_>,
    reader: &mut Reader<'_>,
    notes: &mut Notes,
) -> Result<Environment, Fault> {
    let mut check = Check { place, notes };
    let radiance = e.radiance.map_or(Rgb::WHITE, |v| check.emitted("radiance", v));
    let rotation = e.rotation.map_or(0.0, |v| check.number("rotation", v, -MAX_ROTATION, MAX_ROTATION));
    let picture = match (e.image, &e.uri) {
        (None, None) => None,
        (Some(index), uri) => {
            if uri.is_some() {
                check.ignore("uri", "an `image` is given too");
            }
            let index = check.whole("image", index, 0, u32::MAX) as usize;
            let place = format!("{}.image", check.place);
            Some(("image", textures.image(index, &place, reader, check.notes)?))
        }
        (None, Some(uri)) => {
            let place = format!("{}.uri", check.place);
            Some(("uri", textures.file(uri, &place, reader, check.notes)))
        }
    };
    let image = match picture {
        None => None,
        Some((_, Ok(image))) => Some(EnvironmentImage { image, rotation }),
        Some((key, Err(reason))) => {
            let message = format!("the picture is left out: {reason}");
            let place = format!("{}.{key}", check.place);
            check.notes.add("texture-missing", NoteEffect::Missing, place, message);
            None
        }
    };
    Ok(Environment {
        name: e.name.unwrap_or_else(|| "environment".to_owned()),
        radiance,
        image,
        visible_to_camera: e.visible.unwrap_or(true),
    })
}

//! The scene: its title, its environment, and the hints how to render it.

use super::super::super::notes::Notes;
use super::check::Check;
use super::{Root, choose};
use crate::color::Rgb;
use crate::scene::extension::{EnvironmentTable, FilmTable, SceneTable};
use crate::scene::{Environment, MAX_SIDE, Scene, Settings};

/// Changes `scene` by the extension of the scene that was read.
pub(in super::super) fn scene(root: &Root, scene: &mut Scene, notes: &mut Notes) {
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
        let mut check = Check { place: format!("{place}.environment"), notes };
        scene.environment = Some(environment(e, &mut check));
    }
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
}

fn environment(e: EnvironmentTable, check: &mut Check<'_>) -> Environment {
    let radiance = e.radiance.map_or(Rgb::WHITE, |v| check.emitted("radiance", v));
    for key in [e.image.map(|_| "image"), e.uri.as_ref().map(|_| "uri")].into_iter().flatten() {
        check.ignore(key, "pictures of the environment are not read yet");
    }
    Environment {
        name: e.name.unwrap_or_else(|| "environment".to_owned()),
        radiance,
        image: None,
        visible_to_camera: e.visible.unwrap_or(true),
    }
}

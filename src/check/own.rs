//! Invariants on a scene of one's own: what must hold of any scene. What is often wrong with one is in `look`.

mod look;

use glam::DVec3;

use super::scaling::{moved, scaled};
use crate::film::Image;
use crate::integrate::naive::{ReferenceOptions, reference};
use crate::integrate::{Control, Outcome, RenderOptions, RunError, render};
use crate::prepare::{Algorithms, EffectsMode, Options, Prepared, Shortcuts, prepare};
use crate::report::{Verdict, compare};
use crate::scene::{Scene, Shape};

/// What an invariant says about a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Its name, such as `threads`.
    pub name: &'static str,
    /// What it comes to.
    pub verdict: Says,
    /// What was found, and what was expected.
    pub message: String,
}

/// What an invariant comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Says {
    /// It holds.
    Holds,
    /// It does not: a fault of the renderer.
    Fails,
    /// Something about the scene that its author should know.
    Look,
    /// It was not measured.
    Skipped,
}

/// Passes of the pictures that are compared bit for bit.
const PASSES: u32 = 8;
/// Samples a pixel where the default method is compared with the reference integrator.
const SAMPLES: u32 = 64;
/// Triangles times rays that the reference integrator may try, about a minute's work.
const MOST_TRIES: f64 = 2e10;
/// Powers of two that lengths are multiplied by.
const SCALES: [i32; 3] = [-10, 1, 10];

/// Checks a valid scene through one of its cameras, with pictures of this size; it should be small.
///
/// # Errors
/// The scene cannot be rendered, or `control` cancels.
pub fn check_scene(
    scene: &Scene,
    camera: usize,
    size: [u32; 2],
    control: &dyn Control,
) -> Result<Vec<Finding>, RunError> {
    let own = Own { scene, camera, size, control };
    let prepared = own.prepare(scene, EffectsMode::Auto)?;
    let first = own.render(scene, EffectsMode::Auto, 1)?;
    Ok(vec![
        own.refused(&first),
        own.threads(&first)?,
        own.kernels(&first)?,
        own.scales(&first)?,
        own.places(&first)?,
        own.reference()?,
        look::triangles(scene),
        look::lights(scene),
        look::camera(scene, camera, &prepared),
        look::overlaps(scene, &prepared),
    ])
}

struct Own<'a> {
    scene: &'a Scene,
    camera: usize,
    size: [u32; 2],
    control: &'a dyn Control,
}

fn say(name: &'static str, verdict: Says, message: impl Into<String>) -> Finding {
    Finding { name, verdict, message: message.into() }
}

/// Holds or fails.
fn judge(name: &'static str, holds: bool, good: impl Into<String>, bad: impl Into<String>) -> Finding {
    if holds { say(name, Says::Holds, good) } else { say(name, Says::Fails, bad) }
}

impl Own<'_> {
    /// As it is rendered: with the gain that the scene asks for.
    fn prepare(&self, scene: &Scene, effects: EffectsMode) -> Result<Prepared, RunError> {
        self.prepare_with(scene, effects, Shortcuts::of(&scene.settings))
    }

    fn prepare_with(
        &self,
        scene: &Scene,
        effects: EffectsMode,
        shortcuts: Shortcuts,
    ) -> Result<Prepared, RunError> {
        let options = Options {
            camera: scene.cameras.get(self.camera).map(|c| c.name.clone()),
            size: self.size,
            seed: 0,
            effects,
            max_depth: scene.settings.max_depth,
            shortcuts,
            transparent: false,
            algorithms: Algorithms::PATHS,
        };
        Ok(prepare(scene, &options)?)
    }

    fn render(&self, scene: &Scene, effects: EffectsMode, threads: usize) -> Result<Outcome, RunError> {
        let options = RenderOptions { threads, ..RenderOptions::passes(0..PASSES) };
        let outcome = render(&self.prepare(scene, effects)?, &options, self.control)?;
        if outcome.cancelled { Err(RunError::Cancelled) } else { Ok(outcome) }
    }

    fn refused(&self, first: &Outcome) -> Finding {
        let n = first.film.refused_total();
        let place = first.bad.first().map_or_else(String::new, |b| {
            let ([x, y], [w, h], pass) = (b.pixel, self.size, b.pass);
            format!(
                ", the first is not a radiance because of {:?}: `render SCENE --size {w}x{h} --replay {x},{y},{pass}` \
                 traces it alone",
                b.reason
            )
        });
        let cut = match first.counters.capped {
            0 => String::new(),
            n => {
                format!("; {n} paths were cut after 10000 events: light is trapped where nothing absorbs it")
            }
        };
        judge(
            "samples",
            n == 0,
            format!("every sample is a radiance{cut}"),
            format!("{n} samples are not a number, infinite or negative{place}{cut}"),
        )
    }

    fn threads(&self, first: &Outcome) -> Result<Finding, RunError> {
        let other = self.render(self.scene, EffectsMode::Auto, 3)?;
        let holds = other.film == first.film;
        Ok(judge("threads", holds, "one thread and three make the same bytes", "one thread and three differ"))
    }

    fn kernels(&self, first: &Outcome) -> Result<Finding, RunError> {
        let other = self.render(self.scene, EffectsMode::All, 1)?;
        let good = "the planned kernel and the one that simulates everything make the same bytes";
        let holds = other.film == first.film;
        Ok(judge("kernels", holds, good, "the planned kernel leaves something out: its bytes differ"))
    }

    fn scales(&self, first: &Outcome) -> Result<Finding, RunError> {
        let expected = first.film.to_image().rgb;
        for k in SCALES {
            let other = self.render(&scaled(self.scene, k), EffectsMode::Auto, 1)?.film.to_image().rgb;
            let differing = other.iter().zip(&expected).filter(|(a, b)| a != b).count();
            if differing > 0 && self.distant() {
                let message = format!(
                    "{differing} pixels differ at lengths times 2^{k}: environments and suns have no length to scale"
                );
                return Ok(say("scale", Says::Look, message));
            }
            if differing > 0 {
                let message =
                    format!("{differing} of {} pixels differ at lengths times 2^{k}", expected.len());
                return Ok(say("scale", Says::Fails, message));
            }
        }
        Ok(say("scale", Says::Holds, "lengths times 2^-10, 2 and 2^10 make the same bytes"))
    }

    /// The same scene somewhere else: other roundings, and the same picture but for noise.
    fn places(&self, first: &Outcome) -> Result<Finding, RunError> {
        const NAME: &str = "place";
        let extent = self.extent();
        let by = extent * DVec3::new(3.0, -1.5, 0.75);
        let other = self.render(&moved(self.scene, by), EffectsMode::Auto, 1)?.film.to_image();
        let Ok(c) = compare(&other, &first.film.to_image()) else {
            return Ok(say(NAME, Says::Skipped, "the pictures cannot be compared"));
        };
        let ratio = c.channels[1].ratio.unwrap_or(1.0);
        let said = format!("moved by {:.3e} m: green mean {ratio:.5} of what it was", by.length());
        Ok(match c.verdict {
            Verdict::Identical | Verdict::NoSignificantDifference => say(NAME, Says::Holds, said),
            Verdict::Differs => say(NAME, Says::Fails, format!("{said}: differs by more than noise")),
        })
    }

    /// The largest distance of an object's origin or vertex from the first one's, metres.
    fn extent(&self) -> f64 {
        let mut points = self.scene.objects.iter().flat_map(|o| {
            let corners = match o.shape {
                Shape::Mesh(id) => self.scene.meshes.get(id.0 as usize).map_or(&[][..], |m| &m.positions[..]),
                Shape::Sphere { .. } => &[],
            };
            let place = |v: &glam::Vec3| o.transform.transform_point3(v.as_dvec3());
            corners.iter().map(place).chain([o.transform.translation])
        });
        let Some(first) = points.next() else { return 1.0 };
        points.fold(0.0, |extent: f64, p| extent.max(p.distance(first)))
    }

    /// Whether something shines from infinitely far away.
    fn distant(&self) -> bool {
        let sun = |l: &crate::scene::Light| matches!(l.kind, crate::scene::LightKind::Sun { .. });
        self.scene.environment.is_some() || self.scene.lights.iter().any(sun)
    }

    /// The default method against brute force, in the middle of the picture.
    fn reference(&self) -> Result<Finding, RunError> {
        const NAME: &str = "reference";
        const SIDE: u32 = 16;
        let triangles: f64 = self.scene.objects.iter().map(|o| self.count(&o.shape)).sum();
        // Some ten segments a path.
        let tries = f64::from(SIDE * SIDE * SAMPLES) * 10.0 * triangles;
        if tries > MOST_TRIES {
            let message = format!(
                "{triangles:.0} triangles are too many for brute force; see `render --method reference`"
            );
            return Ok(say(NAME, Says::Skipped, message));
        }
        let max_depth = Some(self.scene.settings.max_depth.unwrap_or(16).min(16));
        let [w, h] = self.size;
        let (side_w, side_h) = (SIDE.min(w), SIDE.min(h));
        let crop = [(w - side_w) / 2, (h - side_h) / 2, side_w, side_h];
        // Brute force knows no shortcut.
        let mut prepared = self.prepare_with(self.scene, EffectsMode::Auto, Shortcuts::default())?;
        prepared.max_depth = max_depth;
        let options = RenderOptions { crop: Some(crop), ..RenderOptions::passes(0..SAMPLES) };
        let fast = render(&prepared, &options, self.control)?.film.to_image();
        let slow = ReferenceOptions {
            camera: self.camera,
            size: self.size,
            crop: Some(crop),
            spp: SAMPLES,
            seed: 1,
            max_depth,
            threads: 0,
        };
        let slow = reference(self.scene, &slow, &|| self.control.cancelled(), &|_| ());
        if self.control.cancelled() {
            return Err(RunError::Cancelled);
        }
        let Ok(slow) = slow else {
            return Ok(say(NAME, Says::Skipped, "the reference integrator cannot render it"));
        };
        let finding = Self::agree(&fast, &slow);
        Ok(match self.scene.settings.indirect_gain {
            Some(gain) if gain != 1.0 => Finding {
                message: format!("{}; without the scene's indirect_gain of {gain}", finding.message),
                ..finding
            },
            _ => finding,
        })
    }

    fn agree(fast: &Image, slow: &Image) -> Finding {
        const NAME: &str = "reference";
        let Ok(c) = compare(fast, slow) else {
            return say(NAME, Says::Skipped, "the pictures cannot be compared");
        };
        let ratio = c.channels[1].ratio.unwrap_or(1.0);
        let half = c.channels[1].ratio_interval.unwrap_or(f64::INFINITY);
        let said =
            format!("green mean {ratio:.4} +- {half:.4} of the brute-force integrator's, up to 16 events");
        match c.verdict {
            Verdict::Identical | Verdict::NoSignificantDifference => say(NAME, Says::Holds, said),
            // The reference integrator meets lights by chance alone: what it never met, it does not know.
            Verdict::Differs => say(
                NAME,
                Says::Look,
                format!(
                    "{said}: differs. Small lamps are met too rarely by brute force; if yours are large, report this"
                ),
            ),
        }
    }

    fn count(&self, shape: &Shape) -> f64 {
        match shape {
            Shape::Mesh(mesh) => {
                self.scene.meshes.get(mesh.0 as usize).map_or(0.0, |m| m.triangles.len() as f64)
            }
            Shape::Sphere { .. } => 1.0,
        }
    }
}

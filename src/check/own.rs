//! Invariants on a scene of one's own: what must hold of any scene, and what is often wrong with one.

use glam::{DVec3, Vec3};

use super::scaling::scaled;
use crate::accel::{PrimitiveId, RayKind};
use crate::film::Image;
use crate::integrate::naive::{ReferenceOptions, reference};
use crate::integrate::{Control, Outcome, RenderOptions, RunError, render};
use crate::prepare::{Algorithms, EffectsMode, Options, Prepared, prepare};
use crate::report::{Verdict, compare};
use crate::scene::{MaterialKind, Mesh, Scene, Shape};
use crate::shape::{Ray, offset_origin};

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
    let first = own.render(scene, EffectsMode::Auto, 1)?;
    Ok(vec![
        own.refused(&first),
        own.threads(&first)?,
        own.kernels(&first)?,
        own.scales(&first)?,
        own.reference()?,
        own.triangles(),
        own.lights(),
        own.inside(&own.prepare(scene, EffectsMode::Auto)?),
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
    fn prepare(&self, scene: &Scene, effects: EffectsMode) -> Result<Prepared, RunError> {
        let options = Options {
            camera: scene.cameras.get(self.camera).map(|c| c.name.clone()),
            size: self.size,
            seed: 0,
            effects,
            max_depth: scene.settings.max_depth,
            transparent: false,
            algorithms: Algorithms::default(),
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
            format!(", the first at pixel {},{} of pass {}: {:?}", b.pixel[0], b.pixel[1], b.pass, b.reason)
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
        let mut prepared = self.prepare(self.scene, EffectsMode::Auto)?;
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
        Ok(Self::agree(&fast, &slow))
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

    fn triangles(&self) -> Finding {
        let degenerate = |m: &Mesh| {
            let flat = |t: &&[u32; 3]| {
                let [a, b, c] =
                    t.map(|i| m.positions.get(i as usize).copied().unwrap_or(Vec3::NAN).as_dvec3());
                let area: DVec3 = (b - a).cross(c - a);
                let square = area.length_squared();
                square.is_nan() || square <= 0.0
            };
            m.triangles.iter().filter(flat).count()
        };
        let n: usize = self.scene.meshes.iter().map(degenerate).sum();
        if n == 0 {
            return say("triangles", Says::Holds, "every triangle has an area");
        }
        say("triangles", Says::Look, format!("{n} triangles have no area; they are never hit"))
    }

    fn lights(&self) -> Finding {
        let dark = |m: &crate::scene::Material| matches!(&m.kind, MaterialKind::Light { radiance, .. } if radiance.is_black());
        let used = |(i, m): (usize, &crate::scene::Material)| {
            let here = self.scene.objects.iter().any(|o| o.material.0 as usize == i);
            (here && dark(m)).then(|| m.name.clone())
        };
        let names: Vec<String> = self.scene.materials.iter().enumerate().filter_map(used).collect();
        if names.is_empty() {
            return say("lights", Says::Holds, "every lamp shines");
        }
        say("lights", Says::Look, format!("lamps without power: {}", names.join(", ")))
    }

    /// Whether the camera stands in something closed that is not a room: rays of all directions leave it through its
    /// back.
    fn inside(&self, prepared: &Prepared) -> Finding {
        let mut random = super::random::Random::of("camera inside");
        let Some(camera) = self.scene.cameras.get(self.camera) else {
            return say("camera", Says::Skipped, "there is no camera");
        };
        let eye = camera.transform.translation.as_vec3();
        const RAYS: usize = 64;
        let mut glass = 0;
        let mut name = String::new();
        for _ in 0..RAYS {
            let ray = Ray::new(eye, random.direction());
            let Some(hit) = prepared.accel.closest(&ray, PrimitiveId::NONE, RayKind::Other) else { continue };
            let surface = prepared.surface(&ray, &hit, false);
            let material = prepared.material_of(surface.object) as usize;
            let transmits = prepared.materials.get(material).is_some_and(|m| m.bsdf.transmits());
            if surface.ng.dot(ray.d) > 0.0 && transmits {
                glass += 1;
                name = self.scene.materials.get(material).map_or_else(String::new, |m| m.name.clone());
            }
            // Where a ray would go on from is finite, or geometry is broken.
            let on = offset_origin(surface.p, surface.p_err, surface.ng, ray.d);
            if !on.is_finite() {
                return say("camera", Says::Fails, format!("a ray from the camera ends at {on}"));
            }
        }
        if 10 * glass > 9 * RAYS {
            let message =
                format!("the camera stands inside of {name:?}: paths begin outside of every medium");
            return say("camera", Says::Look, message);
        }
        say("camera", Says::Holds, "the camera stands in the open")
    }
}

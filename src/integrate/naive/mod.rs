//! The reference integrator: slow, obvious, and independent of the fast one.
//!
//! In: a [`Scene`] that [`crate::scene::validate`] has passed. Out: an [`Image`], or the radiance along
//! single rays with its standard error. It is brute force in f64: every triangle is tried, directions
//! come from the BSDF alone, and there is no multiple importance sampling and no roulette. Nothing but
//! the scene is shared with the fast integrator, so that an error in one is a difference between both.
//!
//! # The contract that both integrators implement
//!
//! *Depth* counts scattering events. Emission met after k events counts if k <= `max_depth` (0 is
//! emission only). A light that cannot be met by chance is added at a vertex, as one more event, if the
//! depth there is below `max_depth`. Without `max_depth` this integrator stops after
//! [`DEPTH_CAP`] events; nothing else ends a path that still carries light.
//!
//! *Camera.* Pixel (x, y), row 0 on top, uniform in the pixel (box filter): sx = (x+u)/w - 1/2,
//! sy = 1/2 - (y+v)/h. Perspective over the horizontal side, t = tan(fov/2): direction
//! (2t (sx + shift_x), 2t (sy h/w + shift_y), -1); over the vertical side
//! (2t (sx w/h + shift_x), 2t (sy + shift_y), -1). Orthographic: parallel to -Z from the same plane
//! scaled by the extent. Lens: origin uniform on a disk, in focus at `focus_distance` along -Z.
//!
//! *Geometry.* The front of a triangle is where it winds counter-clockwise in its own space; a mirroring
//! transform keeps it. Shading normals are interpolated and go with the inverse transpose; where
//! (ns.wo)(ng.wo) <= 0 the geometric normal takes over. Cosines are those of ns. A direction is a
//! reflection only if (ng.wi)(ng.wo) > 0 and (ns.wi)(ns.wo) > 0, a transmission only if both are
//! negative; a sampled direction that disagrees ends the path. A path leaves its triangle for good; a
//! sphere is met again from inside only.
//!
//! *Emission*: [`crate::scene::MaterialKind::emission`], below coat and sheen; a `Light` reflects nothing.
//!
//! *Media.* A path starts in what is at the camera's position: what the innermost object around it encloses.
//! Refraction from the front to the back of a surface enters its absorption, refraction to the front leaves
//! into none. Each segment, shadow rays included, multiplies by color^(length/distance).
//!
//! *Bodies.* Surfaces whose material has a priority follow [`crate::scene::Body`]: where the same body is there
//! on both sides, a path goes straight on, no event counted, and shadow rays pass; else the surface has the
//! index of what is behind its front over that before it. Leaving a surface without a priority leads into
//! what bodies are around. A surface of another body within 1e-6 of the coordinates and parallel is crossed
//! with it. Where alpha lets a path pass a surface of a body, it is in what is behind.
//!
//! *Textures and vertex colours* are interpolated with the weights of a triangle's corners; `texture.rs` says
//! how pictures are read, `varying.rs` what they multiply. Where a mesh has no texture coordinates, and on
//! spheres, they are (0, 0). Normal maps: with n and t the interpolated normal and tangent in the mesh's own
//! space (`scene/tangents.rs`; the sign w is that of the first corner), neither made unit, texel
//! (x, y, z) = 2 texel - 1 with x and y times the scale means x t + y w (n x t) + z n, which goes to the world
//! as normals do. It replaces ns where (it.wo)(ng.wo) > 0 and the mesh has a frame.
//!
//! *Alpha.* With a chance of 1 - alpha (with certainty below the cut-off of a mask) a path passes a surface
//! as if it were not there: straight on, in the same medium, no event counted, and a camera ray stays one.
//! Shadow rays are dimmed by 1 - alpha. What is not there does not emit.
//!
//! *Lights* that are not surfaces never block. A segment gathers each light with an extent whose front
//! it crosses; the sun's disk and the environment are seen where nothing is hit. Camera rays (depth 0)
//! see neither lights, environment nor objects whose `visible_to_camera` is false; all other rays do.
//!
//! *Materials*: the files `material.rs`, `principled.rs` and `layers.rs` state theirs.

mod albedo;
mod camera;
mod detail;
mod fresnel;
mod geometry;
mod layers;
mod light;
mod material;
mod medium;
mod microfacet;
mod nesting;
mod path;
mod principled;
mod quadrature;
mod rng;
mod texture;
mod varying;

pub use path::{DEPTH_CAP, Estimate, Ray, Tracer};

use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use crate::color::Rgb;
use crate::film::Image;
use crate::scene::{Camera, Scene};
use nesting::Place;
use path::Moments;
use rng::Rng;

/// What to render.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceOptions {
    /// Index into [`Scene::cameras`].
    pub camera: usize,
    /// Width and height of the whole picture, pixels.
    pub size: [u32; 2],
    /// The part to render: left, top, width, height, pixels; all of it where absent. Its pixels are
    /// those of the whole picture.
    pub crop: Option<[u32; 4]>,
    /// Samples per pixel.
    pub spp: u32,
    /// Another seed gives an independent picture.
    pub seed: u64,
    /// Cap on scattering events; [`DEPTH_CAP`] where absent.
    pub max_depth: Option<u32>,
    /// Worker threads, which never change the result; 0 is one for each CPU.
    pub threads: usize,
}

/// Why nothing was rendered.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// The scene has no such camera.
    #[error("the scene has {count} cameras, and number {camera} was asked for")]
    NoCamera {
        /// The index asked for.
        camera: usize,
        /// How many there are.
        count: usize,
    },
    /// The crop is not inside the picture.
    #[error("the crop {crop:?} (left, top, width, height) is not inside a picture of {size:?} pixels")]
    Crop {
        /// The crop asked for.
        crop: [u32; 4],
        /// Width and height of the whole picture.
        size: [u32; 2],
    },
    /// The worker threads could not be started.
    #[error("cannot start worker threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Renders the scene.
///
/// `cancelled` is asked before each row; rows that were then not begun stay black with count 0.
/// `progress` hears the share of rows done, (0, 1], from any thread. The variance is that of each
/// pixel's mean, zero where there are fewer than two samples.
///
/// # Errors
/// See [`ReferenceError`].
pub fn reference(
    scene: &Scene,
    options: &ReferenceOptions,
    cancelled: &(dyn Fn() -> bool + Sync),
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Image, ReferenceError> {
    let count = scene.cameras.len();
    let camera = scene
        .cameras
        .get(options.camera)
        .ok_or(ReferenceError::NoCamera { camera: options.camera, count })?;
    let [full_w, full_h] = options.size;
    let crop = options.crop.unwrap_or([0, 0, full_w, full_h]);
    let [left, top, width, height] = crop;
    let inside =
        |start: u32, length: u32, full: u32| start.checked_add(length).is_some_and(|end| end <= full);
    if !inside(left, width, full_w) || !inside(top, height, full_h) {
        return Err(ReferenceError::Crop { crop, size: options.size });
    }

    let tracer = Tracer::new(scene);
    let start = tracer.place(camera.transform.translation);
    let done = AtomicU32::new(0);
    let row = |y: u32| -> Vec<Moments> {
        if cancelled() {
            return vec![Moments::default(); width as usize];
        }
        let pixels =
            (left..left + width).map(|x| pixel(&tracer, &start, camera, options, [x, top + y])).collect();
        progress(f64::from(done.fetch_add(1, Ordering::Relaxed) + 1) / f64::from(height));
        pixels
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build()?;
    let rows: Vec<Vec<Moments>> = pool.install(|| (0..height).into_par_iter().map(row).collect());

    let pixels: Vec<Moments> = rows.into_iter().flatten().collect();
    let to_rgb = |v: DVec3| Rgb::from(v.as_vec3().to_array());
    Ok(Image {
        width,
        height,
        origin: [left, top],
        full_size: options.size,
        rgb: pixels.iter().map(|p| to_rgb(p.mean)).collect(),
        variance: Some(pixels.iter().map(|p| to_rgb(p.variance_of_mean())).collect()),
        count: Some(pixels.iter().map(|p| p.count as u32).collect()),
        ..Image::default()
    })
}

fn pixel(
    tracer: &Tracer,
    start: &Place,
    camera: &Camera,
    options: &ReferenceOptions,
    at: [u32; 2],
) -> Moments {
    let address = u64::from(at[1]) * u64::from(options.size[0]) + u64::from(at[0]);
    let mut moments = Moments::default();
    for sample in 0..options.spp {
        let mut rng = Rng::new(options.seed, address, u64::from(sample));
        let ray = camera::camera_ray(camera, options.size, at, &mut rng);
        moments.add(tracer.radiance(ray, start, options.max_depth, &mut rng));
    }
    moments
}

/// A colour of the scene, to compute with.
fn rgb(color: Rgb) -> DVec3 {
    DVec3::new(f64::from(color.r), f64::from(color.g), f64::from(color.b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{
        AreaShape, Environment, FovAxis, Light, LightKind, Material, MaterialId, MaterialKind, Object,
        Projection, Shape,
    };
    use glam::DAffine3;

    /// A white ball under a grey sky, in front of a camera.
    fn ball() -> Scene {
        let kind = MaterialKind::Diffuse { color: Rgb::grey(0.5) };
        Scene {
            materials: vec![Material { name: "white".into(), kind }],
            objects: vec![Object {
                name: "ball".into(),
                shape: Shape::Sphere { radius: 1.0 },
                material: MaterialId(0),
                transform: DAffine3::from_translation(DVec3::new(0.5, 0.0, -4.0)),
                visible_to_camera: true,
            }],
            cameras: vec![Camera {
                name: "front".into(),
                transform: DAffine3::IDENTITY,
                projection: Projection::Perspective { fov: 1.0, axis: FovAxis::Horizontal },
                shift: [0.0; 2],
                lens: None,
                aspect: None,
            }],
            environment: Some(Environment {
                name: "sky".into(),
                radiance: Rgb::new(0.2, 0.4, 0.8),
                image: None,
                visible_to_camera: true,
            }),
            ..Scene::default()
        }
    }

    fn options() -> ReferenceOptions {
        let size = [12, 8];
        ReferenceOptions { camera: 0, size, crop: None, spp: 8, seed: 3, max_depth: None, threads: 1 }
    }

    fn render(scene: &Scene, options: &ReferenceOptions) -> Image {
        reference(scene, options, &|| false, &|_| ()).expect("the options fit the scene")
    }

    /// Guards repeatability: threads change nothing, and a crop is that part of the whole picture.
    #[test]
    fn threads_and_crops_change_no_pixel() {
        let whole = render(&ball(), &options());
        assert_eq!(whole, render(&ball(), &ReferenceOptions { threads: 3, ..options() }));
        assert_ne!(whole, render(&ball(), &ReferenceOptions { seed: 4, ..options() }));
        let part = render(&ball(), &ReferenceOptions { crop: Some([5, 2, 4, 3]), ..options() });
        assert_eq!((part.width, part.height, part.origin, part.full_size), (4, 3, [5, 2], [12, 8]));
        for y in 0..3 {
            let row = (y + 2) * 12 + 5;
            assert_eq!(part.rgb[y * 4..][..4], whole.rgb[row..][..4]);
        }
    }

    /// Guards the errors, and what is left of a picture that is cancelled.
    #[test]
    fn refusals_and_cancellation() {
        let refuse = |options| reference(&ball(), &options, &|| false, &|_| ()).unwrap_err().to_string();
        insta::assert_snapshot!(
            refuse(ReferenceOptions { camera: 1, ..options() }),
            @"the scene has 1 cameras, and number 1 was asked for"
        );
        insta::assert_snapshot!(
            refuse(ReferenceOptions { crop: Some([10, 0, 3, u32::MAX]), ..options() }),
            @"the crop [10, 0, 3, 4294967295] (left, top, width, height) is not inside a picture of [12, 8] pixels"
        );
        let cancelled = reference(&ball(), &options(), &|| true, &|_| ()).expect("an empty picture");
        assert_eq!(cancelled.count, Some(vec![0; 96]));
    }

    /// Guards what camera rays may not see: the mean of the picture tells which of object, sky and light
    /// is there. The camera is inside a hidden white shell, lit by a hidden light.
    #[test]
    fn hidden_from_the_camera_but_not_from_the_rest() {
        let radiance_at_the_middle = |scene: &Scene| {
            let ray = Ray::new(DVec3::ZERO, DVec3::new(0.1, 0.0, -1.0));
            Tracer::new(scene).estimate(ray, None, 1000, 1).mean
        };
        let mut scene = ball();
        // All of the sky, halved by the ball.
        let seen = radiance_at_the_middle(&scene);
        assert!((seen[0] - 0.1).abs() < 1e-6 && (seen[2] - 0.4).abs() < 1e-6, "{seen:?}");
        // The ball is hidden: the sky itself.
        scene.objects[0].visible_to_camera = false;
        let seen = radiance_at_the_middle(&scene);
        assert!((seen[0] - 0.2).abs() < 1e-6, "{seen:?}");
        // The sky is hidden too: nothing.
        if let Some(sky) = &mut scene.environment {
            sky.visible_to_camera = false;
        }
        assert_eq!(radiance_at_the_middle(&scene), [0.0; 3]);
        // The ball is back, and reflects the sky that the camera does not see.
        scene.objects[0].visible_to_camera = true;
        assert!((radiance_at_the_middle(&scene)[0] - 0.1).abs() < 1e-6);
        // A huge area light between camera and ball, shining at the ball: its back is black, and its
        // front, which covers nearly all that the ball's front sees, adds to the sky.
        let kind = LightKind::Area { shape: AreaShape::Rectangle, size: [1e6; 2], radiance: Rgb::WHITE };
        let transform = DAffine3::from_translation(DVec3::new(0.0, 0.0, -2.0));
        scene.lights.push(Light { name: "sheet".into(), kind, transform, visible_to_camera: true });
        let lit = radiance_at_the_middle(&scene)[0];
        assert!(lit > 0.5 && lit < 0.6, "{lit}");
        // Turned round, it shines at the camera, which sees it in front of the ball, if it may.
        scene.lights[0].transform *= DAffine3::from_rotation_y(std::f64::consts::PI);
        assert!((radiance_at_the_middle(&scene)[0] - 1.1).abs() < 1e-6);
        scene.lights[0].visible_to_camera = false;
        assert!((radiance_at_the_middle(&scene)[0] - 0.1).abs() < 1e-6);
    }
}

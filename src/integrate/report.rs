//! The method of the report "Monte Carlo Ray Tracing" (Aronsson and Arvidsson, Linköping 2021).
//!
//! In: a valid [`Scene`]. Out: samples for the film. Everything that the report does to light stands in
//! this one file, in its order and with its letters; the numbers in parentheses are its sections. The
//! guide's page [`crate::guide::report`] walks through it formula by formula.
//!
//! A ray carries an *importance* W: what the radiance that it finds is worth to its pixel. The ray from
//! the camera has W = 1, the rays that it causes have shares of it, and so a tree grows (3.2) until rays
//! are absorbed (3.4), matter too little, or are too deep. The pixel is the sum of W L over all rays.
//!
//! Where a formula of the report has a slip, the code is right and [`Slips`] can bring the slip back.
//! What the report simplifies on purpose is in [`Shortcuts`], so that the price of each can be measured.
//! The invariant: a sample is a function of scene, options, pixel and number of the ray, and of nothing
//! else.
//!
//! It works badly on what the report did not have: many triangles (each is tried), lights that are not
//! surfaces (refused), rough materials (reduced to the nearest of its four, with a note), surfaces inside
//! of absorbing glass, and anything much smaller than the four centimetres by which rays are moved.

mod room;
#[cfg(test)]
mod tests;

use glam::Vec3;
use rand::RngExt as _;

use super::drive::{Source, drive};
use super::path::Counters;
use super::photon::Maps;
use super::render::{Control, Outcome, RenderError, RenderOptions};
use crate::bsdf::fresnel;
use crate::color::Rgb;
use crate::film::{Film, FilmLayout, FixedPoint, Sample};
use crate::math::{Frame, PI, pow, pow5, safe_sqrt, sin_cos_turn, sqr};
use crate::prepare::{self, CameraRays};
use crate::sampling::warp::square_to_disk;
use crate::sampling::{Address, Purpose, Stream};
use crate::scene::{Note, Scene};
use room::{Kind, Object, Room, Solid};

/// Triangles that are still tried one by one for each ray.
pub const MOST_TRIANGLES: usize = 10_000;
/// Triangles that emit: each costs a shadow ray at every diffuse hit.
pub const MOST_LIGHTS: usize = 64;
/// Scattering events at which a tree ends in any case.
pub const MOST_EVENTS: u32 = 1000;

/// The report's slips, each by its section: true brings it back. All false is the corrected method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slips {
    /// 2.4: Q is crossed with the wrong edge, so that no triangle is ever hit.
    pub q_vector: bool,
    /// 3.1: the area of the light is missing.
    pub area: bool,
    /// 3.1: the 1/pi of the diffuse BRDF is missing.
    pub inverse_pi: bool,
    /// 3.1: the sum over the lights is divided by their number.
    pub light_count: bool,
    /// 3.1: "larger than one" in place of "larger than zero", so that no shadow ray counts.
    pub shadow_comparison: bool,
    /// 3.3: a pi too many in the importance of the diffuse ray.
    pub extra_pi: bool,
    /// 3.4: the comparison of the roulette the other way round.
    pub roulette_sign: bool,
    /// 3.5, 3.6: every angle at glass is taken for the one inside of the glass.
    pub schlick_inside_angle: bool,
}

impl Slips {
    /// None of them.
    pub const NONE: Self = Self {
        q_vector: false,
        area: false,
        inverse_pi: false,
        light_count: false,
        shadow_comparison: false,
        extra_pi: false,
        roulette_sign: false,
        schlick_inside_angle: false,
    };
    /// The report as printed.
    pub const ALL: Self = Self {
        q_vector: true,
        area: true,
        inverse_pi: true,
        light_count: true,
        shadow_comparison: true,
        extra_pi: true,
        roulette_sign: true,
        schlick_inside_angle: true,
    };

    /// The names of those that are on, as the command line has them.
    #[must_use]
    pub fn names(self) -> Vec<&'static str> {
        let all = [
            (self.q_vector, "q-vector"),
            (self.area, "area"),
            (self.inverse_pi, "inverse-pi"),
            (self.light_count, "light-count"),
            (self.shadow_comparison, "shadow-comparison"),
            (self.extra_pi, "extra-pi"),
            (self.roulette_sign, "roulette-sign"),
            (self.schlick_inside_angle, "schlick"),
        ];
        all.into_iter().filter(|(on, _)| *on).map(|(_, name)| name).collect()
    }
}

/// What the report simplifies, and the numbers that it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortcuts {
    /// How far a ray starts from its surface, in unit normals, which are metres.
    pub offset: f32,
    /// Whether glass reflects as Schlick has it; else as Fresnel has it.
    pub schlick: bool,
    /// Whether diffuse surfaces absorb a ray by roulette (3.4); else each goes on, with less importance.
    pub roulette: bool,
    /// The importance below which a ray is not followed (3.2).
    pub threshold: f32,
    /// Whether what is below the threshold is dropped; else it survives by chance and then counts more.
    pub drop_below_threshold: bool,
    /// Scattering events after which the tree ends (3.2).
    pub depth: u32,
}

impl Shortcuts {
    /// Those of the report's method.
    pub const REPORT: Self = Self {
        offset: 0.04,
        schlick: true,
        roulette: true,
        threshold: 0.01,
        drop_below_threshold: true,
        depth: 12,
    };
    /// The same method without a bias that a test could see: what each shortcut costs is measured from here.
    pub const NONE: Self = Self {
        offset: 1e-4,
        schlick: false,
        roulette: true,
        threshold: 0.01,
        drop_below_threshold: false,
        depth: 64,
    };
}

// ---------------------------------------------------------------------------------------------------
// 2.4, 2.5: where a ray meets a triangle and a sphere, and where the next one starts.

/// Distance along `d`, u and v where the ray from `ps` meets the triangle (2.4, Möller and Trumbore):
///
/// T = ps - v0, E1 = v1 - v0, E2 = v2 - v0, P = D x E2, Q = T x E1,
/// (t, u, v) = (Q . E2, P . T, Q . D) / (P . E1)
pub(crate) fn moeller_trumbore(ps: Vec3, d: Vec3, [v0, v1, v2]: [Vec3; 3], slips: Slips) -> Option<[f32; 3]> {
    let (t, e1, e2) = (ps - v0, v1 - v0, v2 - v0);
    let p = d.cross(e2);
    let q = t.cross(if slips.q_vector { e2 } else { e1 });
    let [t, u, v] = [q.dot(e2), p.dot(t), q.dot(d)].map(|x| x / p.dot(e1));
    // A ray in the triangle's plane divides by zero; written so that it misses.
    (t > 0.0 && t < f32::INFINITY && u >= 0.0 && v >= 0.0 && u + v <= 1.0).then_some([t, u, v])
}

/// Both distances along the unit vector `d` at which the line through `ps` meets the sphere about `c`,
/// the smaller one first, by the pq formula: t^2 + p t + q = 0, t = -p/2 -+ sqrt((p/2)^2 - q).
pub(crate) fn sphere_pq(ps: Vec3, d: Vec3, c: Vec3, r: f32) -> Option<[f32; 2]> {
    let m = ps - c;
    let p = 2.0 * d.dot(m);
    let q = m.dot(m) - r * r;
    let under_the_root = sqr(0.5 * p) - q;
    let root = under_the_root.sqrt();
    (under_the_root >= 0.0).then_some([-0.5 * p - root, -0.5 * p + root])
}

/// Where a ray starts that leaves `p`: off its surface by a share of the unit normal, which is
/// [`Shortcuts::offset`], 4 % in the report.
pub(crate) fn offset_along_normal(p: Vec3, n: Vec3, share: f32) -> Vec3 {
    p + n * share
}

struct Hit {
    t: f32,
    /// Unit normal on the front.
    n: Vec3,
    object: usize,
    /// Whether shadow rays go to what was hit.
    has_shadow_rays: bool,
}

impl Tracer {
    /// The first surface that the ray from `ps` along `d` meets.
    fn nearest(&self, ps: Vec3, d: Vec3, from_camera: bool) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        for (object, Object { surface, hidden_from_camera, around, solid }) in
            self.room.objects.iter().enumerate()
        {
            if from_camera && *hidden_from_camera {
                continue;
            }
            let limit = nearest.as_ref().map_or(f32::INFINITY, |hit| hit.t);
            match solid {
                Solid::Sphere { c, r } => {
                    if let Some(t) = first(sphere_pq(ps, d, *c, *r)).filter(|t| *t < limit) {
                        let n = (ps + d * t - *c) / *r;
                        nearest = Some(Hit { t, n, object, has_shadow_rays: false });
                    }
                }
                Solid::Triangles(triangles) => {
                    if passes_by(ps, d, *around) {
                        continue;
                    }
                    let mut limit = limit;
                    for (v, n) in triangles {
                        if let Some([t, ..]) = moeller_trumbore(ps, d, *v, self.slips)
                            && t < limit
                        {
                            limit = t;
                            let has_shadow_rays = !surface.emission.is_black();
                            nearest = Some(Hit { t, n: *n, object, has_shadow_rays });
                        }
                    }
                }
            }
        }
        nearest
    }

    /// Whether anything is in the way of the shadow ray from `ps` along `d` to a light `length` metres away.
    fn blocked(&self, ps: Vec3, d: Vec3, length: f32) -> bool {
        // The light itself is not in the way.
        let length = length * 0.9999;
        self.room.objects.iter().any(|Object { around, solid, .. }| match solid {
            Solid::Sphere { c, r } => first(sphere_pq(ps, d, *c, *r)).is_some_and(|t| t < length),
            Solid::Triangles(triangles) => {
                let hit = |(v, _): &([Vec3; 3], Vec3)| moeller_trumbore(ps, d, *v, self.slips);
                !passes_by(ps, d, *around)
                    && triangles.iter().any(|t| hit(t).is_some_and(|[t, ..]| t < length))
            }
        })
    }
}

/// The smaller distance that is ahead.
fn first(distances: Option<[f32; 2]>) -> Option<f32> {
    distances?.into_iter().find(|t| *t > 0.0)
}

/// Whether the ray surely passes by the sphere `(c, r)`.
fn passes_by(ps: Vec3, d: Vec3, (c, r): (Vec3, f32)) -> bool {
    let m = ps - c;
    m.length_squared() > r * r && (m.dot(d) > 0.0 || m.cross(d).length_squared() > r * r)
}

// ---------------------------------------------------------------------------------------------------
// 3.1: direct light.

/// The point u, v of a triangle; beyond the diagonal it is turned back, so that all points are equally
/// likely.
pub(crate) fn point_of_light([v0, v1, v2]: [Vec3; 3], u: f32, v: f32) -> Vec3 {
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    v0 + (v1 - v0) * u + (v2 - v0) * v
}

/// What a shadow ray to a light of radiance 1 brings to a surface of reflectance 1 (3.1):
///
/// A cos(alpha) cos(beta) / (pi d^2)
///
/// `cos` are the cosines of alpha, at the surface, and beta, at the light; `a` is the light's area,
/// `lights` the number of lights. It counts where both cosines are larger than zero.
pub(crate) fn shadow_ray([alpha, beta]: [f32; 2], d: f32, a: f32, lights: usize, slips: Slips) -> f32 {
    let larger_than = if slips.shadow_comparison { 1.0 } else { 0.0 };
    if alpha <= 0.0 || beta <= 0.0 || alpha * beta <= larger_than {
        return 0.0;
    }
    let a = if slips.area { 1.0 } else { a };
    let brdf = if slips.inverse_pi { 1.0 } else { 1.0 / PI };
    let share = if slips.light_count { 1.0 / lights as f32 } else { 1.0 };
    share * a * brdf * alpha * beta / (d * d)
}

// ---------------------------------------------------------------------------------------------------
// 3.3, 3.4: diffuse surfaces.

/// A direction about the normal `n` with density cos(theta)/pi, from two random numbers:
/// phi = 2 pi u, sin^2(theta) = v.
pub(crate) fn diffuse_direction(n: Vec3, u: f32, v: f32) -> Vec3 {
    let (sin_phi, cos_phi) = sin_cos_turn(u);
    let (sin_theta, cos_theta) = (v.sqrt(), safe_sqrt(1.0 - v));
    Frame::from_z(n).to_world(Vec3::new(cos_phi * sin_theta, sin_phi * sin_theta, cos_theta))
}

/// The share of importance that a diffuse surface passes on (3.3): BRDF cos / density is rho.
pub(crate) fn diffuse_importance(rho: Rgb, slips: Slips) -> Rgb {
    if slips.extra_pi { rho * PI } else { rho }
}

/// Absorption alpha of a surface (3.4): what it keeps even of the colour that it reflects best.
pub(crate) fn absorption(rho: Rgb) -> f32 {
    1.0 - rho.max_channel()
}

/// Whether the ray with the random number `u` survives a surface of absorption `alpha` (3.4), as it does
/// with a probability of 1 - alpha; its importance is then divided by that.
pub(crate) fn survives(alpha: f32, u: f32, slips: Slips) -> bool {
    if slips.roulette_sign { u < alpha } else { u >= alpha }
}

// ---------------------------------------------------------------------------------------------------
// 3.5, 3.6: mirrors and glass.

/// The direction `d` reflected about the normal `n`.
pub(crate) fn reflected(d: Vec3, n: Vec3) -> Vec3 {
    d - n * (2.0 * d.dot(n))
}

/// The direction `d` refracted from a medium of index `n1` into one of `n2`, by Snell's law; `n` is on
/// the side that `d` comes from. `None` under total reflection.
pub(crate) fn refracted(d: Vec3, n: Vec3, n1: f32, n2: f32) -> Option<Vec3> {
    let cos_1 = -d.dot(n);
    let sin_2_squared = sqr(n1 / n2) * (1.0 - cos_1 * cos_1);
    let cos_2 = safe_sqrt(1.0 - sin_2_squared);
    (sin_2_squared < 1.0).then(|| (d * (n1 / n2) + n * (n1 / n2 * cos_1 - cos_2)).normalize())
}

/// Schlick's R0 + (1 - R0) (1 - cos)^5 with R0 = ((n1 - n2) / (n1 + n2))^2.
fn schlick(n1: f32, n2: f32, cos: f32) -> f32 {
    let r0 = sqr((n1 - n2) / (n1 + n2));
    r0 + (1.0 - r0) * pow5((1.0 - cos).clamp(0.0, 1.0))
}

/// Reflectance of the boundary from index `n1` to `n2` by Schlick (3.5, 3.6), corrected: the angle is the
/// larger one of the two, which is outside of the glass, on whichever side the ray is. `cos_1` is the
/// cosine of the angle of incidence.
pub(crate) fn schlick_outside_angle(n1: f32, n2: f32, cos_1: f32) -> f32 {
    if n1 <= n2 {
        return schlick(n1, n2, cos_1);
    }
    let sin_2_squared = sqr(n1 / n2) * (1.0 - cos_1 * cos_1);
    // Up to the critical angle, where the outer angle is a right one, and R is 1.
    schlick(n1, n2, safe_sqrt(1.0 - sin_2_squared))
}

/// The same as printed: any angle of incidence is taken for the one inside of the glass. So there is total
/// reflection beyond the critical angle, from outside too; and just before it R is only 0.041 at n = 1.5.
pub(crate) fn schlick_inside_angle(n1: f32, n2: f32, cos_1: f32) -> f32 {
    let sin_critical = n1.min(n2) / n1.max(n2);
    if 1.0 - cos_1 * cos_1 >= sqr(sin_critical) { 1.0 } else { schlick(n1, n2, cos_1) }
}

// ---------------------------------------------------------------------------------------------------
// 3.2: the tree.

/// A ray of the tree.
struct Ray {
    ps: Vec3,
    d: Vec3,
    /// Importance.
    w: Rgb,
    depth: u32,
    /// Whether light that it meets counts: shadow rays have already brought that light to a diffuse
    /// surface, so it does not count for rays that come from there.
    meets_light: bool,
}

impl Ray {
    /// A ray that this one causes at `ps`, with the share `w` of its importance.
    fn child(&self, ps: Vec3, d: Vec3, w: Rgb, meets_light: bool) -> Self {
        Self { ps, d, w: self.w * w, depth: self.depth + 1, meets_light }
    }
}

impl Tracer {
    /// Radiance of one ray of a pixel: the sum of W L over the tree that grows from it.
    fn pixel_ray(&self, ps: Vec3, d: Vec3, rng: &mut Stream, counters: &mut Counters) -> Rgb {
        let mut sum = Rgb::BLACK;
        let mut tree = vec![Ray { ps, d, w: Rgb::WHITE, depth: 0, meets_light: true }];
        while let Some(ray) = tree.pop() {
            counters.rays += 1;
            let from_camera = ray.depth == 0;
            let Some(hit) = self.nearest(ray.ps, ray.d, from_camera) else {
                if !from_camera || self.room.sees_environment {
                    sum += ray.w * self.room.environment;
                }
                continue;
            };
            let surface = &self.room.objects[hit.object].surface;
            // The side that the ray is on.
            let front = hit.n.dot(ray.d) < 0.0;
            let n = if front { hit.n } else { -hit.n };
            let p = ray.ps + ray.d * hit.t;
            let above = offset_along_normal(p, n, self.shortcuts.offset);
            let below = offset_along_normal(p, -n, self.shortcuts.offset);

            // Light that is met.
            if (front || surface.both_sides) && (ray.meets_light || !hit.has_shadow_rays) {
                sum += ray.w * surface.emission;
            }
            // The tree ends where it is too deep (3.2).
            if ray.depth >= self.shortcuts.depth {
                continue;
            }
            match surface.kind {
                Kind::Black => {}
                Kind::Diffuse { rho } => {
                    // Direct light (3.1), and one ray for the indirect light (3.3), unless it is absorbed (3.4).
                    sum += ray.w * rho * self.direct_light(above, n, rng, counters);
                    let alpha = if self.shortcuts.roulette { absorption(rho) } else { 0.0 };
                    let [u, v, survival] = random(rng);
                    if alpha < 1.0 && survives(alpha, survival, self.slips) {
                        let w = diffuse_importance(rho, self.slips) / (1.0 - alpha);
                        let child = ray.child(above, diffuse_direction(n, u, v), w, false);
                        self.grow(&mut tree, child, rng);
                    }
                }
                Kind::Mirror { color } => {
                    let child = ray.child(above, reflected(ray.d, n), color, true);
                    self.grow(&mut tree, child, rng);
                }
                Kind::Glass { ior, tint, interior } => {
                    // Both children (3.5, 3.6): R of the importance is reflected, 1 - R refracted.
                    let (n1, n2) = if front { (1.0, ior) } else { (ior, 1.0) };
                    let through = if front { Rgb::WHITE } else { transmittance(interior, hit.t) };
                    let into = refracted(ray.d, n, n1, n2);
                    let r = if into.is_none() { 1.0 } else { self.reflectance(n1, n2, -ray.d.dot(n)) };
                    let child = ray.child(above, reflected(ray.d, n), through * r, true);
                    self.grow(&mut tree, child, rng);
                    if let Some(d) = into {
                        let child = ray.child(below, d, through * tint * (1.0 - r), true);
                        self.grow(&mut tree, child, rng);
                    }
                }
            }
        }
        sum
    }

    /// Adds a ray to the tree, if it is important enough (3.2).
    fn grow(&self, tree: &mut Vec<Ray>, mut ray: Ray, rng: &mut Stream) {
        let share = ray.w.max_channel() / self.shortcuts.threshold;
        if share < 1.0 {
            let [u] = random(rng);
            if self.shortcuts.drop_below_threshold || u >= share {
                return;
            }
            ray.w = ray.w / share;
        }
        tree.push(ray);
    }

    /// Direct light on a diffuse surface of reflectance 1 (3.1): a shadow ray to a random point of each
    /// light.
    fn direct_light(&self, p: Vec3, n: Vec3, rng: &mut Stream, counters: &mut Counters) -> Rgb {
        let mut sum = Rgb::BLACK;
        for light in &self.room.lights {
            let [u, v] = random(rng);
            let way = point_of_light(light.v, u, v) - p;
            let d = way.length();
            let direction = way / d;
            let mut beta = -direction.dot(light.n);
            if light.both_sides {
                beta = beta.abs();
            }
            let share =
                shadow_ray([n.dot(direction), beta], d, light.area, self.room.lights.len(), self.slips);
            if share > 0.0 {
                counters.rays += 1;
                if !self.blocked(p, direction, d) {
                    sum += light.radiance * share;
                }
            }
        }
        sum
    }

    /// Reflectance of glass (3.5, 3.6).
    fn reflectance(&self, n1: f32, n2: f32, cos_1: f32) -> f32 {
        if self.slips.schlick_inside_angle {
            schlick_inside_angle(n1, n2, cos_1)
        } else if self.shortcuts.schlick {
            schlick_outside_angle(n1, n2, cos_1)
        } else {
            fresnel::dielectric(cos_1, n2 / n1).0
        }
    }
}

/// Random numbers in [0, 1).
fn random<const N: usize>(rng: &mut Stream) -> [f32; N] {
    std::array::from_fn(|_| rng.random())
}

/// What is left of light after `length` metres in a medium.
fn transmittance(interior: Option<(Rgb, f32)>, length: f32) -> Rgb {
    let Some((color, distance)) = interior else { return Rgb::WHITE };
    Rgb::from(color.to_array().map(|c| pow(c, length / distance)))
}

// ---------------------------------------------------------------------------------------------------
// The camera: one ray in each quarter of the pixel.

/// Rays per pixel for as many as were asked for: one, or the next multiple of four.
#[must_use]
pub fn rays_per_pixel(asked: u32) -> u32 {
    if asked <= 1 { 1 } else { asked.div_ceil(4) * 4 }
}

/// Where ray number `ray` of `rays` goes through the pixel, [0, 1)^2: four in turn go through its four
/// quarters. The turn shifts by one after each four, since the film takes every fourth ray for a
/// replication, and each replication has to see the whole pixel.
fn place_in_pixel(ray: u32, rays: u32, [u, v]: [f32; 2]) -> [f32; 2] {
    if rays < 4 {
        return [u, v];
    }
    let quarter = (ray + ray / 4) % 4;
    [0.5 * ((quarter % 2) as f32 + u), 0.5 * ((quarter / 2) as f32 + v)]
}

impl Source for Tracer {
    fn sample(&self, pixel: [u32; 2], ray: u32, _: Option<&Maps>, counters: &mut Counters) -> Sample {
        let index = u64::from(pixel[1]) * u64::from(self.size[0]) + u64::from(pixel[0]);
        // A replication for each ray: numbers that know nothing of each other, as `rand` gives them.
        let mut rng = Address::new(self.seed, index, ray, 0).stream(0, Purpose::Report, 0);
        let place = place_in_pixel(ray, self.rays, random(&mut rng));
        let start = self.camera.ray(pixel, place, || square_to_disk(random(&mut rng)));
        let radiance = self.pixel_ray(start.o, start.d, &mut rng, counters);
        Sample { radiance, ..Sample::default() }
    }
}

// ---------------------------------------------------------------------------------------------------
// The scene as the method sees it.

/// What to render.
#[derive(Clone, Debug, PartialEq)]
pub struct ReportOptions {
    /// Index into [`Scene::cameras`].
    pub camera: usize,
    /// Width and height of the whole picture, pixels.
    pub size: [u32; 2],
    /// The part to render: left, top, width, height, pixels; all of it where absent.
    pub crop: Option<[u32; 4]>,
    /// Rays per pixel; see [`rays_per_pixel`].
    pub rays: u32,
    /// Another seed gives an independent picture.
    pub seed: u64,
    /// Threads, which never change the picture; 0 is one for each core.
    pub threads: usize,
    /// What is as printed.
    pub slips: Slips,
    /// What is simplified.
    pub shortcuts: Shortcuts,
}

/// Why the report's method cannot render a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReportError {
    /// The scene has no such camera.
    #[error("the scene has {count} cameras, and number {camera} was asked for")]
    NoCamera {
        /// The index asked for.
        camera: usize,
        /// How many there are.
        count: usize,
    },
    /// A light that is not a surface.
    #[error(
        "light \"{name}\": the report's method knows only light from surfaces; expected a material that emits"
    )]
    Light {
        /// Its name.
        name: String,
    },
    /// More triangles than can be tried one by one.
    #[error(
        "found {found} triangles, expected at most {MOST_TRIANGLES}: the report's method tries each of them"
    )]
    Triangles {
        /// How many.
        found: usize,
    },
    /// More lights than shadow rays are good for.
    #[error(
        "found {found} triangles that emit, expected at most {MOST_LIGHTS}: \
         the report's method sends a shadow ray to each of them"
    )]
    Lights {
        /// How many.
        found: usize,
    },
    /// The render could not start.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// A scene, ready for the report's method.
#[derive(Debug)]
pub struct Tracer {
    room: Room,
    camera: CameraRays,
    size: [u32; 2],
    rays: u32,
    seed: u64,
    slips: Slips,
    shortcuts: Shortcuts,
}

impl Tracer {
    /// Makes a scene ready: its surfaces in world space, its materials reduced to the report's.
    ///
    /// # Errors
    /// Where the scene holds what the report's method cannot do, or too much of what it can.
    pub fn new(scene: &Scene, options: &ReportOptions) -> Result<Self, ReportError> {
        let count = scene.cameras.len();
        let missing = ReportError::NoCamera { camera: options.camera, count };
        let camera = scene.cameras.get(options.camera).ok_or(missing)?;
        let shortcuts = options.shortcuts;
        Ok(Self {
            room: Room::new(scene)?,
            camera: CameraRays::new(camera, options.size),
            size: options.size,
            rays: rays_per_pixel(options.rays),
            seed: options.seed,
            slips: options.slips,
            shortcuts: Shortcuts { depth: shortcuts.depth.min(MOST_EVENTS), ..shortcuts },
        })
    }

    /// What is rendered otherwise than the scene has it.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.room.notes
    }

    /// Renders the picture, or the part of it that `options` name; otherwise they are those of [`Tracer::new`].
    ///
    /// # Errors
    /// See [`ReportError`].
    pub fn render(&self, options: &ReportOptions, control: &dyn Control) -> Result<Outcome, ReportError> {
        let emitted = self.room.objects.iter().map(|o| o.surface.emission.max_channel());
        let [w, h] = self.size;
        let layout = FilmLayout {
            crop: options.crop.unwrap_or([0, 0, w, h]),
            full_size: self.size,
            replications: prepare::replications(u64::from(w) * u64::from(h)),
            radiance: FixedPoint::around(emitted.fold(self.room.environment.max_channel(), f32::max)),
            length: FixedPoint::around(1.0),
            features: false,
            layers: false,
            layer_noise: false,
            transparent: false,
            cross: false,
            widening: false,
        };
        let passes = RenderOptions {
            threads: options.threads,
            crop: options.crop,
            ..RenderOptions::passes(0..self.rays)
        };
        Ok(drive(self, Film::new(layout), &passes, control)?)
    }
}

//! Photons on their way: from a light to wherever a surface spreads light.
//!
//! In: an address. Out: each place where a photon lands on a surface that spreads light, and may be seen or gathered. A
//! photon is thrown by delta lobes, and by those of materials that have none but narrow ones. Which ways it takes is a
//! [`Route`]: photons that look for caustics land where the event before threw them, and where they are spread they have
//! to be thrown again next, S+ (D S+)*; others take any way, (D|S)*.
//!
//! What surfaces do is defined for light towards the camera. Let w be the direction towards the camera and wi
//! that towards the light at one vertex. Normals that differ from the geometric one make radiance and flux
//! disagree by |w.ng| |wi.ns| / (|wi.ng| |w.ns|) (Veach, thesis, section 5.3), and layers dim what leaves by the
//! cosine of w, not of wi. Which normal counts depends on w too, which a photon does not know before: it
//! tries each, and takes one of those that a path from the camera would have taken.
//!
//! The medium that a photon passes is known only when it leaves it: paths from the camera know theirs from the
//! surface that they entered by. So its length waits.

use glam::Vec3;

use crate::accel::{Hit, PrimitiveId, RayKind};
use crate::bsdf::Transport;
use crate::color::Rgb;
use crate::film::light_class;
use crate::integrate::direct::emitted_share;
use crate::integrate::li::{interior, is_there};
use crate::integrate::path::{Counters, FAR_CAP};
use crate::integrate::{roulette, scatter as lobes};
use crate::light::PhotonLights;
use crate::prepare::{Detail, Prepared, PreparedMaterial, ROULETTE_START, Surface};
use crate::sampling::{Address, Purpose};
use crate::shape::{Ray, offset_origin};

/// A photon that lies on a surface that spreads light.
#[derive(Clone, Copy, Debug)]
pub(in crate::integrate) struct Photon {
    /// Where, world space.
    pub(super) p: Vec3,
    /// Unit direction that it came from.
    pub(super) wi: Vec3,
    /// Geometric normal of the surface, unit.
    pub(super) ng: Vec3,
    /// W.
    pub(super) power: Rgb,
    /// Length of its way, back to where it entered the medium in which it arrived, metres: what that medium
    /// absorbs has not been taken from its power.
    pub(super) inside: f32,
    /// Scattering events so far.
    pub(super) bounces: u32,
    /// Class of the light that it brings ([`light_class`]).
    pub(super) class: u8,
    /// Whether its way is S+ (D S+)*.
    pub(super) linked: bool,
}

impl Photon {
    /// Whether its first event threw it.
    pub(super) fn is_caustic(&self) -> bool {
        self.class % 2 == 1
    }
}

/// Which ways photons take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Route {
    /// S+ (D S+)*: what throws light throws them first, and again after each time that they are spread.
    Thrown,
    /// (D|S)*, anywhere.
    Any,
    /// The same, where what they meet first throws light, or does not.
    First {
        /// Whether it does.
        casts: bool,
    },
}

impl Route {
    /// Whether a photon that has had so many events, the last of which threw it or did not, goes on from something
    /// that throws light or does not.
    fn allows(self, bounces: u32, thrown: bool, casts: bool) -> bool {
        match self {
            Self::Thrown => thrown || casts,
            Self::Any => true,
            Self::First { casts: first } => bounces > 0 || first == casts,
        }
    }
}

/// A photon that lands, with what it lands on.
pub(super) struct Landing<'a> {
    pub(super) photon: Photon,
    /// How often it was spread on its way.
    pub(super) spread: u32,
    pub(super) surface: Surface,
    pub(super) hit: Hit,
    pub(super) detail: Detail,
    /// Index of the material.
    pub(super) index: u32,
    pub(super) material: &'a PreparedMaterial,
}

impl Landing<'_> {
    /// The photon as a map keeps it. Where a share of the surface is there, only that share of the photons lands, and a
    /// path that looks for them is there as seldom; the map stands for all that would arrive.
    pub(super) fn kept(&self) -> Photon {
        let there = self.material.cutout.as_ref().map_or(1.0, |c| c.coverage(&self.detail));
        Photon { power: self.photon.power * (1.0 / there), ..self.photon }
    }
}

/// Where photons start, and which way they go.
#[derive(Clone, Copy)]
pub(super) struct Walk<'a> {
    pub(super) scene: &'a Prepared,
    pub(super) lights: &'a PhotonLights,
    /// For each material, whether it throws light.
    pub(super) casts: &'a [bool],
    pub(super) route: Route,
}

/// Follows one photon, whose power is `share` of that of the light; `landed` is called wherever it lands.
pub(super) fn walk(
    Walk { scene, lights, casts: casting, route }: Walk<'_>,
    address: &Address,
    share: f32,
    counters: &mut Counters,
    mut landed: impl FnMut(&Landing<'_>, &mut Counters),
) {
    let numbers = |k| address.block(0, Purpose::Photon, 0, k);
    let Some(start) = lights.emit(&scene.lights, numbers(0), numbers(1)) else { return };
    if scene.max_depth == Some(0) {
        return;
    }
    let light = scene.apart.number(start.light);
    let mut power = start.power * share;
    if start.from != PrimitiveId::NONE {
        power *= emitted_share(scene, start.from, start.p, start.cos);
    }
    let (mut ray, mut from) = (start.ray, start.from);
    let (mut bounces, mut passed, mut inside) = (0u32, 0u32, 0.0f32);
    // Whether the last event threw it, how many spread it, whether the first threw it, and whether each that spread it
    // followed one that threw it.
    let (mut thrown, mut spread, mut caustic, mut linked) = (false, 0u32, false, true);
    // What the events so far have left, for roulette.
    let mut beta = Rgb::WHITE;
    loop {
        counters.rays += 1;
        let Some(hit) = scene.accel.closest(&ray, from, RayKind::Other) else { return };
        let surface = scene.surface(&ray, &hit, true);
        let index = scene.material_of(surface.object);
        let material = &scene.materials[index as usize];
        let detail = if material.detailed { scene.detail(surface.object, &hit) } else { Detail::NONE };
        inside += hit.t;
        from = surface.id;
        if !is_there(material, &detail, address, bounces, passed) {
            passed += 1;
            if passed >= FAR_CAP {
                counters.capped += 1;
                return;
            }
            ray = Ray::new(offset_origin(surface.p, surface.p_err, surface.ng, ray.d), ray.d);
            continue;
        }
        let casts = casting[index as usize];
        if power.is_black() || !route.allows(bounces, thrown, casts) {
            return;
        }
        let wi = -ray.d;
        let class = light_class(light, caustic) as u8;
        let (p, ng) = (surface.p, surface.ng);
        let photon = Photon { p, wi, ng, power, inside, bounces, class, linked: linked && thrown };
        let landing = Landing { photon, spread, surface, hit, detail, index, material };
        let lands =
            (thrown || route != Route::Thrown) && !material.narrow && spreads(material, &landing.detail);
        if lands {
            landed(&landing, counters);
        }
        // Where indirect light is left out, what is spread here counts for nothing where it lands next.
        let spreads_on = lands && !scene.kept.ends_after(1);
        // A path from the camera has these events, the next one, and one where the photon lands.
        if !(casts || spreads_on) || scene.max_depth.is_some_and(|cap| bounces.saturating_add(1) >= cap) {
            return;
        }
        if bounces >= FAR_CAP {
            counters.capped += 1;
            return;
        }

        let u = address.block(bounces, Purpose::Bsdf, 0, 0);
        let Some(next) = scatter(scene, &landing, spreads_on || material.narrow, u) else { return };
        let Scattered { w, weight, delta } = next;
        let throws = delta || material.narrow;
        linked &= throws || thrown;
        caustic |= throws && bounces == 0;
        spread += u32::from(!throws);
        thrown = throws;
        power *= weight;
        beta *= weight;
        if material.encloses && w.dot(surface.ng) * wi.dot(surface.ng) < 0.0 {
            // The path from the camera that comes from the front has been inside since.
            if w.dot(surface.ng) > 0.0 {
                power *= interior(scene, index, inside);
            }
            inside = 0.0;
        }
        ray = Ray::new(offset_origin(surface.p, surface.p_err, surface.ng, w), w);
        bounces += 1;
        match roulette::survive(beta, 1.0, bounces, ROULETTE_START, u[3]) {
            Some(scale) => {
                power *= scale;
                beta *= scale;
            }
            None => return,
        }
    }
}

/// The normals that a path from the camera may use at a surface, in the order in which it tries them: that of a
/// map, the interpolated one, the geometric one.
struct Normals([Option<Vec3>; 3]);

impl Normals {
    fn new(scene: &Prepared, landing: &Landing<'_>) -> Self {
        let Landing { surface, hit, detail, material, .. } = landing;
        let mapped =
            material.normal.as_ref().and_then(|map| scene.mapped_normal(map, surface.object, hit, detail));
        Self([mapped, (surface.ns != surface.ng).then_some(surface.ns), Some(surface.ng)])
    }

    /// The index of the one that counts for light that leaves in the direction `w`: the first that sees it on
    /// the side on which the geometric normal sees it.
    fn chosen(&self, w: Vec3) -> usize {
        let side = self.0[2].map_or(0.0, |ng| ng.dot(w));
        self.0[..2].iter().position(|n| n.is_some_and(|n| n.dot(w) * side > 0.0)).unwrap_or(2)
    }
}

/// Where a photon goes on, and the factor on its power.
#[derive(Clone, Copy)]
struct Scattered {
    w: Vec3,
    weight: Rgb,
    delta: bool,
}

/// A direction of a delta lobe, or of any other one where the photon `may_spread`; `None` where it ends.
fn scatter(scene: &Prepared, landing: &Landing<'_>, may_spread: bool, u: [f32; 4]) -> Option<Scattered> {
    let Landing { photon, surface, detail, material, .. } = landing;
    let (wi, ng) = (photon.wi, surface.ng);
    let normals = Normals::new(scene, landing);
    let mut found: [Option<Scattered>; 3] = [None; 3];
    for (i, n) in normals.0.iter().enumerate() {
        let Some(n) = *n else { continue };
        let frame = lobes::Frame::new(&Surface { ns: n, ..*surface }, wi);
        let bsdf = material.bsdf_at(detail, frame.cos());
        let sample = lobes::sample(scene.simulates, &bsdf, &frame, [u[0], u[1], u[2]], Transport::Importance);
        let Some((w, sample)) = sample else { continue };
        if !sample.delta {
            // Any normal serves to sample a lobe with a density, but only one.
            if may_spread && normals.chosen(wi) == i {
                let value = spread(scene, landing, w);
                let weight = value.map(|f| f * (w.dot(ng).abs() / sample.pdf)).filter(|x| x.is_finite());
                found[i] = weight.map(|weight| Scattered { w, weight, delta: false });
            }
            continue;
        }
        if normals.chosen(w) != i {
            continue;
        }
        let mut weight = sample.weight;
        if n != ng {
            weight *= (w.dot(ng) * wi.dot(n) / (wi.dot(ng) * w.dot(n))).abs();
        }
        if w.dot(ng) * wi.dot(ng) < 0.0 {
            // Layers dim what leaves; the sample has dimmed it by the cosine of what arrives.
            let below = |d: Vec3| material.emission_scale(detail, d.dot(n).abs());
            let (leaving, arriving) = (below(w), below(wi));
            if leaving != arriving {
                weight *= leaving / arriving;
            }
        }
        if weight.is_finite() {
            found[i] = Some(Scattered { w, weight, delta: true });
        }
    }
    // Each of several is one event of its own: one is followed, and stands for all.
    let count = found.iter().flatten().count();
    let pick = ((u[1] * count as f32) as usize).min(count.saturating_sub(1));
    let next = found.into_iter().flatten().nth(pick)?;
    Some(Scattered { weight: next.weight * count as f32, ..next })
}

/// What the surface under a photon makes of light from `wi` in the direction `w` towards the camera, with the
/// normal and the lobes of a path that comes from there: the value, times the cosine to the shading normal over
/// that to the geometric one. `None` where it is zero.
pub(super) fn spread(scene: &Prepared, landing: &Landing<'_>, w: Vec3) -> Option<Rgb> {
    let Landing { photon, surface, detail, material, .. } = landing;
    let normals = Normals::new(scene, landing);
    let ns = normals.0[normals.chosen(w)]?;
    let frame = lobes::Frame::new(&Surface { ns, ..*surface }, w);
    let bsdf = material.bsdf_at(detail, frame.cos());
    let (f, _) = lobes::f_and_pdf(scene.simulates, &bsdf, &frame, photon.wi, Transport::Radiance)?;
    Some(f * cosine_ratio(photon, frame.ns()))
}

/// The cosine of a photon's direction to the shading normal over that to the geometric normal.
#[inline]
pub(super) fn cosine_ratio(photon: &Photon, ns: Vec3) -> f32 {
    if ns == photon.ng { 1.0 } else { (photon.wi.dot(ns) / photon.wi.dot(photon.ng)).abs() }
}

/// Whether a surface spreads light at all, which does not depend on directions.
fn spreads(material: &PreparedMaterial, detail: &Detail) -> bool {
    !material.bsdf_at(detail, 1.0).is_delta()
}

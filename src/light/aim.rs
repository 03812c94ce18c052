//! Aiming light at what throws it: mirrors and clear glass.
//!
//! In: a point of a light, or a direction that light comes from. Out: a direction, or a place to start from,
//! with a density. A *target* is a shape that holds a part of what throws light; it is chosen by the flux that
//! reaches it, roughly, and then sampled by solid angle, or by its disk across parallel light. Targets may
//! overlap and hide each other, so that the density of a direction is the sum over all targets that lie in it:
//! whatever light first meets one of them is found, with a density that does not depend on which was chosen.
//!
//! From inside of a target everything lies in its direction; the density is then that of the emission itself,
//! the cosine at a surface, or the same everywhere at a point.

use glam::{DVec3, Vec3};

use super::{Rectangle, SphereLight, TriangleLight};
use crate::math::{Frame, INV_PI, PI};
use crate::sampling::Discrete;
use crate::sampling::warp::{
    SQUARE_TO_SPHERE_PDF, square_to_cone, square_to_cone_pdf, square_to_cosine_hemisphere, square_to_disk,
    square_to_sphere,
};

/// Most targets that are looked at one by one for every photon.
pub(super) const MOST_TARGETS: usize = 64;

/// What holds a part of the things that throw light.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// A ball.
    Ball,
    /// A flat rectangle.
    Rectangle(Rectangle),
    /// A triangle.
    Triangle(TriangleLight),
}

/// Something to aim at.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its shape.
    pub shape: Shape,
    /// A ball around it, with a little room for rounding.
    pub ball: SphereLight,
    /// Share of the light which it throws on, roughly, or how much it is preferred; (0, inf).
    pub strength: f32,
}

/// A target as seen from one point.
#[derive(Clone, Copy, Debug)]
enum View {
    /// The point is inside.
    Around,
    /// A cone: its axis, and 1 - cos of its half angle.
    Cone(Vec3, f32),
    /// The flat shape of the target.
    Flat,
}

/// Everything to aim at.
#[derive(Clone, Debug, Default)]
pub struct Aim {
    targets: Vec<Target>,
    /// The distribution over the targets' disks across parallel light.
    disks: Discrete,
    /// The sum of their areas times strength, m^2.
    area: f64,
}

impl Target {
    /// A ball; what throws light touches it from inside.
    #[must_use]
    pub fn ball(center: Vec3, radius: f32, strength: f32) -> Self {
        Self { shape: Shape::Ball, ball: SphereLight { center, radius }, strength }
    }

    /// A flat shape with these corners.
    #[must_use]
    pub fn flat(shape: Shape, corners: &[Vec3], strength: f32) -> Self {
        let ball = ball_around(corners.iter().copied());
        Self { shape, ball, strength }
    }

    /// How it is seen from `p`, and its solid angle; `None` from where it is seen edge-on.
    fn view(&self, p: Vec3) -> Option<(View, f32)> {
        let solid = |pdf: f32| (pdf > 0.0 && pdf.is_finite()).then(|| (View::Flat, 1.0 / pdf));
        match &self.shape {
            Shape::Rectangle(r) => solid(r.pdf(p, self.ball.center)),
            Shape::Triangle(t) => solid(t.pdf(p, self.ball.center)),
            Shape::Ball => Some(match self.ball.cone(p) {
                Some((axis, one_minus_cos)) => {
                    (View::Cone(axis, one_minus_cos), 1.0 / square_to_cone_pdf(one_minus_cos))
                }
                None => (View::Around, 4.0 * PI),
            }),
        }
    }

    /// The largest cosine with `n` of a direction from `p` to the target, [0, 1].
    fn largest_cosine(&self, p: Vec3, n: Vec3) -> f32 {
        let d = self.ball.center - p;
        let (height, length2, r) = (d.dot(n), d.length_squared(), self.ball.radius);
        if length2 <= r * r {
            return 1.0;
        }
        // cos(a - b) of the angles to the normal and under which the ball's radius is seen.
        let (sin_b, inv) = (r / length2.sqrt(), 1.0 / length2.sqrt());
        let cos_a = (height * inv).clamp(-1.0, 1.0);
        let cos_b = ((1.0 - sin_b) * (1.0 + sin_b)).max(0.0).sqrt();
        if cos_a >= cos_b {
            return 1.0;
        }
        let sin_a = ((1.0 - cos_a) * (1.0 + cos_a)).max(0.0).sqrt();
        (cos_a * cos_b + sin_a * sin_b).clamp(0.0, 1.0)
    }

    /// Density per solid angle with which the target is sampled from `p` in the direction `w`.
    fn pdf(&self, view: &View, p: Vec3, w: Vec3, n: Option<Vec3>) -> f32 {
        match (&self.shape, view) {
            (_, View::Around) => n.map_or(SQUARE_TO_SPHERE_PDF, |n| w.dot(n).max(0.0) * INV_PI),
            (_, &View::Cone(axis, one_minus_cos)) => {
                // 1 - cos of the angle between unit vectors, from their chord.
                let inside = 0.5 * (w - axis).length_squared() <= one_minus_cos;
                if inside { square_to_cone_pdf(one_minus_cos) } else { 0.0 }
            }
            (Shape::Rectangle(r), View::Flat) => {
                let q = meet(p, w, r.corner(), r.normal());
                q.filter(|q| r.contains(*q)).map_or(0.0, |q| r.pdf(p, q))
            }
            (Shape::Triangle(t), View::Flat) => {
                let q = meet(p, w, t.v[0], t.normal());
                q.filter(|q| t.contains(*q)).map_or(0.0, |q| t.pdf(p, q))
            }
            (Shape::Ball, View::Flat) => 0.0,
        }
    }

    /// A direction from `p` and its density.
    fn sample(&self, view: &View, p: Vec3, n: Option<Vec3>, u: [f32; 2]) -> Option<(Vec3, f32)> {
        Some(match (&self.shape, view) {
            (_, View::Around) => {
                let w = match n {
                    None => square_to_sphere(u),
                    Some(n) => Frame::from_z(n).to_world(square_to_cosine_hemisphere(u)).normalize(),
                };
                (w, self.pdf(view, p, w, n))
            }
            (_, &View::Cone(axis, one_minus_cos)) => {
                let w = Frame::from_z(axis).to_world(square_to_cone(u, one_minus_cos)).normalize();
                (w, square_to_cone_pdf(one_minus_cos))
            }
            (Shape::Rectangle(r), View::Flat) => {
                let s = r.sample(p, u)?;
                ((s.p - p).try_normalize()?, s.pdf)
            }
            (Shape::Triangle(t), View::Flat) => {
                let s = t.sample(p, u)?;
                ((s.p - p).try_normalize()?, s.pdf)
            }
            (Shape::Ball, View::Flat) => return None,
        })
    }

    /// Whether the line through `p` along the unit vector `w` meets the ball.
    fn in_line(&self, p: Vec3, w: Vec3) -> bool {
        let (d, w) = (self.ball.center.as_dvec3() - p.as_dvec3(), w.as_dvec3());
        let r = f64::from(self.ball.radius);
        (d - w * d.dot(w)).length_squared() <= r * r
    }
}

/// A ball around the box of some points, with room for rounding.
#[must_use]
pub fn ball_around(points: impl Iterator<Item = Vec3> + Clone) -> SphereLight {
    let lo = points.clone().fold(Vec3::INFINITY, Vec3::min);
    let hi = points.clone().fold(Vec3::NEG_INFINITY, Vec3::max);
    let center = lo * 0.5 + hi * 0.5;
    let radius = points.map(|p| p.as_dvec3().distance_squared(center.as_dvec3())).fold(0.0, f64::max).sqrt();
    let rounding = f64::from(center.abs().max_element()) * f64::from(crate::math::gamma(8));
    SphereLight { center, radius: (radius * 1.000_01 + rounding) as f32 }
}

/// Where a half line meets the plane through `corner` with normal `n`.
fn meet(p: Vec3, w: Vec3, corner: Vec3, n: Vec3) -> Option<Vec3> {
    let (n, w, p) = (n.as_dvec3(), w.as_dvec3(), p.as_dvec3());
    let t = n.dot(corner.as_dvec3() - p) / n.dot(w);
    (t > 0.0 && t < f64::INFINITY).then(|| (p + w * t).as_vec3())
}

impl Aim {
    /// All of `targets`; of more than `MOST_TARGETS` neighbours are put into one ball.
    #[must_use]
    pub fn new(mut targets: Vec<Target>) -> Self {
        if targets.len() > MOST_TARGETS {
            let mut merged = Vec::new();
            merge(&mut targets, MOST_TARGETS, &mut merged);
            targets = merged;
        }
        let areas: Vec<f64> = targets.iter().map(|t| f64::from(t.strength) * 0.25 * t.ball.area()).collect();
        Self { disks: Discrete::new(&areas), area: areas.iter().sum(), targets }
    }

    /// What is aimed at.
    #[must_use]
    pub fn targets(&self) -> &[Target] {
        &self.targets
    }

    /// The flux that a light at `p` with unit radiance or intensity sends to all targets, roughly; `n` is the
    /// normal of a surface, with whose cosine it emits.
    #[must_use]
    pub fn flux(&self, p: Vec3, n: Option<Vec3>) -> f32 {
        self.targets.iter().filter_map(|t| t.view(p).map(|(view, solid)| weight(t, &view, solid, p, n))).sum()
    }

    /// A unit direction from `p` to a target, with its density per solid angle. `n` is the normal of the
    /// surface that `p` lies on: directions below it are `None`. `u[0]` chooses the target.
    #[must_use]
    pub fn direction(&self, p: Vec3, n: Option<Vec3>, u: [f32; 3]) -> Option<(Vec3, f32)> {
        let mut views = [(View::Flat, 0.0f32); MOST_TARGETS];
        let mut total = 0.0;
        for (slot, t) in views.iter_mut().zip(&self.targets) {
            if let Some((view, solid)) = t.view(p) {
                *slot = (view, weight(t, &view, solid, p, n));
                total += slot.1;
            }
        }
        let views = &views[..self.targets.len()];
        let threshold = u[0] * total;
        let (mut below, mut chosen) = (0.0, None);
        for (i, &(_, w)) in views.iter().enumerate().filter(|(_, (_, w))| *w > 0.0) {
            chosen = Some(i);
            if threshold < below + w {
                break;
            }
            below += w;
        }
        let chosen = chosen?;
        let (w, own) = self.targets[chosen].sample(&views[chosen].0, p, n, [u[1], u[2]])?;
        if n.is_some_and(|n| w.dot(n) <= 0.0) {
            return None;
        }
        // The target that was chosen lies in the direction, whatever rounding says of its rim.
        let density = |(i, t): (usize, &Target)| {
            let (view, weight) = &views[i];
            if *weight == 0.0 {
                return 0.0;
            }
            weight * if i == chosen { own } else { t.pdf(view, p, w, n) }
        };
        let pdf = self.targets.iter().enumerate().map(density).sum::<f32>() / total;
        (pdf > 0.0 && pdf.is_finite()).then_some((w, pdf))
    }

    /// Area of all disks across parallel light, each times the strength of its target, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area
    }

    /// A line along the unit vector `w` that meets a target, given by its point nearest to the target's
    /// middle, with its density per area across `w`. `u[0]` chooses the target.
    #[must_use]
    pub fn across(&self, w: Vec3, u: [f32; 3]) -> Option<(Vec3, f64)> {
        let (chosen, _, _) = self.disks.sample(u[0])?;
        let target = &self.targets[chosen];
        let frame = Frame::from_z(w);
        let d = square_to_disk([u[1], u[2]]) * target.ball.radius;
        let p = target.ball.center + frame.s * d.x + frame.t * d.y;
        let strength = |(i, t): (usize, &Target)| {
            if i == chosen || t.in_line(p, w) { f64::from(t.strength) } else { 0.0 }
        };
        let pdf = self.targets.iter().enumerate().map(strength).sum::<f64>() / self.area;
        (pdf > 0.0 && pdf.is_finite()).then_some((p, pdf))
    }
}

/// What a target weighs in the choice, given its solid angle.
fn weight(target: &Target, view: &View, solid: f32, p: Vec3, n: Option<Vec3>) -> f32 {
    let flux = match (view, n) {
        (_, None) => solid,
        (View::Around, Some(_)) => PI,
        (_, Some(n)) => solid * target.largest_cosine(p, n),
    };
    target.strength * flux
}

/// Puts neighbours into balls until there are at most `most`.
fn merge(targets: &mut [Target], most: usize, merged: &mut Vec<Target>) {
    if targets.len() <= most {
        merged.extend_from_slice(targets);
        return;
    }
    if most == 1 {
        let ball = targets.iter().map(|t| t.ball).reduce(around);
        let strength = targets.iter().map(|t| t.strength).fold(0.0, f32::max);
        merged.extend(ball.map(|b| Target::ball(b.center, b.radius, strength)));
        return;
    }
    let lo = targets.iter().map(|t| t.ball.center).fold(Vec3::INFINITY, Vec3::min);
    let hi = targets.iter().map(|t| t.ball.center).fold(Vec3::NEG_INFINITY, Vec3::max);
    let axis = (hi - lo).max_position();
    targets.sort_by(|a, b| a.ball.center[axis].total_cmp(&b.ball.center[axis]));
    let (left, right) = targets.split_at_mut(targets.len() / 2);
    merge(left, most / 2, merged);
    merge(right, most - most / 2, merged);
}

/// The smallest ball around two, with room for rounding.
fn around(a: SphereLight, b: SphereLight) -> SphereLight {
    let (ca, cb) = (a.center.as_dvec3(), b.center.as_dvec3());
    let (ra, rb) = (f64::from(a.radius), f64::from(b.radius));
    let d = ca.distance(cb);
    if d + rb <= ra {
        return a;
    }
    if d + ra <= rb {
        return b;
    }
    let radius = 0.5 * (d + ra + rb);
    let center: DVec3 = ca + (cb - ca) * ((radius - ra) / d);
    let rounding = center.abs().max_element() * f64::from(crate::math::gamma(8));
    SphereLight { center: center.as_vec3(), radius: (radius * 1.000_01 + rounding) as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mix64;

    fn uniform(i: u64) -> [f32; 3] {
        [0, 1, 2].map(|k| (mix64(3 * i + k + 1) >> 40) as f32 / 16_777_216.0)
    }

    /// Balls that overlap and hide each other, one around the origin, and flat shapes.
    fn aims() -> Vec<Aim> {
        let square =
            Rectangle::new(Vec3::new(-1.0, 2.0, -1.0), [Vec3::Z * 2.0, Vec3::X * 2.0]).expect("a square");
        let square = Target::flat(Shape::Rectangle(square), &square.corners(), 0.5);
        let v = [Vec3::new(1.0, 0.5, 0.0), Vec3::new(2.0, 0.5, 1.0), Vec3::new(1.0, 2.0, 1.0)];
        let triangle = Target::flat(Shape::Triangle(TriangleLight::new(v).expect("a triangle")), &v, 1.0);
        let balls = [(Vec3::Y * 3.0, 1.0), (Vec3::new(0.5, 4.0, 0.0), 1.2), (Vec3::new(-2.0, 0.3, 1.0), 0.7)];
        let balls = balls.map(|(c, r)| Target::ball(c, r, 1.0));
        let mut all = balls.to_vec();
        all.extend([square, triangle]);
        let inside = vec![Target::ball(Vec3::X * 0.5, 1.0, 0.2), balls[0]];
        let many = (0..200).map(|i| Target::ball(Vec3::from(uniform(i)) * 4.0 + 1.0, 0.1, 1.0)).collect();
        [balls.to_vec(), vec![square, triangle], all, inside, many].map(Aim::new).to_vec()
    }

    /// Guards the density: the mean of its inverse is the solid angle of everything that is aimed at, wherever
    /// targets overlap, and what is found is where it says.
    #[test]
    fn directions_have_their_density() {
        let n = 40_000;
        for (which, aim) in aims().iter().enumerate() {
            for normal in [None, Some(Vec3::new(0.3, 1.0, 0.2).normalize())] {
                let above = |w: Vec3| normal.is_none_or(|n| w.dot(n) > 0.0);
                let lies = |w: Vec3| {
                    above(w)
                        && aim.targets.iter().any(|t| {
                            t.view(Vec3::ZERO).is_some_and(|(v, _)| t.pdf(&v, Vec3::ZERO, w, normal) > 0.0)
                        })
                };
                let (mut found, mut solid) = (0.0, 0.0);
                for i in 0..n {
                    let u = uniform(i);
                    if let Some((w, pdf)) = aim.direction(Vec3::ZERO, normal, u) {
                        assert!(above(w) && (w.length() - 1.0).abs() < 1e-5);
                        found += 1.0 / f64::from(pdf) / n as f64;
                    }
                    let w = square_to_sphere([u[1], u[2]]);
                    solid += f64::from(u8::from(lies(w))) * 4.0 * std::f64::consts::PI / n as f64;
                }
                // The inverse has a spread of about itself, the fraction of hits one of sqrt(p (1 - p) / n).
                let sigma =
                    (solid * 4.0 * std::f64::consts::PI / n as f64).sqrt() + solid / (n as f64).sqrt();
                assert!((found - solid).abs() < 5.0 * sigma, "{which} {normal:?}: {found} {solid}");
            }
        }
    }

    /// Guards the same for parallel light, whose place has a density per area.
    #[test]
    fn places_have_their_density() {
        let w = Vec3::new(0.2, -0.5, 0.8).normalize();
        let frame = Frame::from_z(w);
        let n = 40_000;
        for (which, aim) in aims().iter().enumerate() {
            let (mut found, mut area) = (0.0, 0.0);
            for i in 0..n {
                let u = uniform(i);
                let (p, pdf) = aim.across(w, u).expect("targets");
                assert!(aim.targets.iter().any(|t| {
                    let d = (t.ball.center - p).cross(w).length();
                    d <= 1.001 * t.ball.radius
                }));
                found += 1.0 / pdf / n as f64;
                let q = (frame.s * (2.0 * u[1] - 1.0) + frame.t * (2.0 * u[2] - 1.0)) * 8.0;
                area += 256.0 * f64::from(u8::from(aim.targets.iter().any(|t| t.in_line(q, w)))) / n as f64;
            }
            let sigma = (area * 256.0 / n as f64).sqrt() + area / (n as f64).sqrt();
            assert!((found - area).abs() < 5.0 * sigma, "{which}: {found} {area}");
        }
    }

    /// Guards the limit on what is looked at: many targets become few that hold them all.
    #[test]
    fn many_targets_are_merged() {
        let many: Vec<Target> =
            (0..1000).map(|i| Target::ball(Vec3::from(uniform(i)) * 9.0, 0.05, 0.5)).collect();
        let aim = Aim::new(many.clone());
        assert!(aim.targets.len() <= MOST_TARGETS && aim.targets.iter().all(|t| t.strength == 0.5));
        let holds =
            |a: &Target, b: &Target| a.ball.center.distance(b.ball.center) + b.ball.radius <= a.ball.radius;
        assert!(many.iter().all(|m| aim.targets.iter().any(|t| holds(t, m))));
    }
}

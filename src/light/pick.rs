//! Choosing a light: by what it could contribute to the point that is lit.
//!
//! Lights come in groups: the emissive primitives of one object, or a single light. A group weighs as
//! much as the irradiance that it could give unobstructed: its peak intensity over the squared distance
//! to its middle (never less than its own radius), or what falls from infinitely far away. Within a
//! group, power decides. Weights are ratios of quantities that scale alike, so scaling a scene by a
//! power of two changes no probability. Beyond [`MANY_LIGHTS`] groups power alone decides.

use glam::Vec3;

use super::Emitter;
use crate::math::{ONE_MINUS_EPSILON, PI};
use crate::sampling::Discrete;

/// Groups that are weighed one by one for every point.
pub(crate) const MANY_LIGHTS: usize = 64;

/// How a group's light thins out with distance.
#[derive(Clone, Copy, Debug)]
enum Reach {
    /// Peak intensity from around a point.
    Near { center: Vec3, radius2: f32, intensity: f32 },
    /// The same irradiance everywhere.
    Distant { irradiance: f32 },
}

#[derive(Clone, Debug)]
struct Group {
    reach: Reach,
    /// Index of its first light, and the distribution over its lights.
    first: usize,
    members: Discrete,
}

/// The probabilities of choosing lights.
#[derive(Clone, Debug, Default)]
pub(super) struct Pick {
    groups: Vec<Group>,
    group_of: Vec<u32>,
    /// The distribution over groups where there are many.
    by_power: Option<Discrete>,
}

impl Pick {
    /// Probabilities for `emitters`, of which each run of `sizes` forms a group.
    pub(super) fn new(emitters: &[Emitter], sizes: &[usize], scene_radius: f64) -> Self {
        let mut pick = Self::default();
        let mut first = 0;
        let mut powers = Vec::new();
        for &size in sizes {
            let members = &emitters[first..first + size];
            let power: Vec<f64> = members.iter().map(|e| e.power(scene_radius)).collect();
            powers.push(power.iter().sum());
            pick.group_of.extend(std::iter::repeat_n(pick.groups.len() as u32, size));
            pick.groups.push(Group { reach: reach(members), first, members: Discrete::new(&power) });
            first += size;
        }
        if pick.groups.len() > MANY_LIGHTS {
            pick.by_power = Some(Discrete::new(&powers));
        }
        pick
    }

    /// A light for the point `p`, and the probability of its choice.
    #[inline]
    pub(super) fn sample(&self, p: Vec3, u: f32) -> Option<(usize, f32)> {
        let (group, share, u) = match &self.by_power {
            Some(by_power) => by_power.sample(u)?,
            None if self.groups.len() == 1 => (0, 1.0, u),
            None => self.weighed(p, u)?,
        };
        let group = &self.groups[group];
        let (i, pmf, _) = group.members.sample(u)?;
        Some((group.first + i, share * pmf))
    }

    /// The probability with which [`Self::sample`] chooses a light for the point `p`.
    #[inline]
    pub(super) fn pmf(&self, p: Vec3, light: usize) -> f32 {
        let g = self.group_of[light] as usize;
        let group = &self.groups[g];
        let share = match &self.by_power {
            Some(by_power) => by_power.pmf(g),
            None if self.groups.len() == 1 => 1.0,
            None => self.weight(group, p) / self.groups.iter().map(|g| self.weight(g, p)).sum::<f32>(),
        };
        share * group.members.pmf(light - group.first)
    }

    fn weighed(&self, p: Vec3, u: f32) -> Option<(usize, f32, f32)> {
        let total: f32 = self.groups.iter().map(|g| self.weight(g, p)).sum();
        let target = u * total;
        let mut below = 0.0;
        let mut chosen = None;
        for (i, g) in self.groups.iter().enumerate() {
            let w = self.weight(g, p);
            if w > 0.0 {
                // The last group that weighs anything takes what rounding leaves over.
                chosen = Some((i, w / total, ((target - below) / w).clamp(0.0, ONE_MINUS_EPSILON)));
                if target < below + w {
                    break;
                }
            }
            below += w;
        }
        chosen
    }

    #[inline]
    fn weight(&self, group: &Group, p: Vec3) -> f32 {
        match group.reach {
            Reach::Distant { irradiance } => irradiance,
            Reach::Near { center, radius2, intensity } => {
                let d2 = (center - p).length_squared().max(radius2);
                // A point light at the very point that is lit is no reason to forget the others.
                if d2 > 0.0 {
                    (intensity / d2).min(f32::MAX / MANY_LIGHTS as f32)
                } else {
                    f32::MAX / MANY_LIGHTS as f32
                }
            }
        }
    }
}

/// The reach of a group; lights from infinitely far away stand alone.
fn reach(members: &[Emitter]) -> Reach {
    match members {
        [Emitter::Sun { irradiance, .. }] => Reach::Distant { irradiance: irradiance.luminance() },
        [Emitter::Panorama { map, .. }] => Reach::Distant { irradiance: map.irradiance() },
        [Emitter::Environment { radiance, .. }] => Reach::Distant { irradiance: radiance.luminance() * PI },
        _ => {
            let corners = || members.iter().flat_map(Emitter::corners);
            let lo = corners().fold(Vec3::INFINITY, Vec3::min);
            let hi = corners().fold(Vec3::NEG_INFINITY, Vec3::max);
            let center = lo * 0.5 + hi * 0.5;
            let radius2 = corners().map(|c| (c - center).length_squared()).fold(0.0, f32::max);
            let intensity = members.iter().map(Emitter::peak_intensity).sum::<f64>() as f32;
            Reach::Near { center, radius2, intensity }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    fn lamp(position: Vec3, intensity: f32) -> Emitter {
        Emitter::Point { position, intensity: Rgb::grey(intensity), spot: None }
    }

    /// N53: probabilities sum to one wherever the point is, agree with how often lights are chosen, and
    /// a light 1e6 times as strong does not hide the others where they are near.
    #[test]
    fn probabilities_are_what_is_sampled() {
        let sky = Emitter::Environment { radiance: Rgb::grey(0.5), visible_to_camera: true };
        for count in [3usize, 200] {
            let mut emitters: Vec<Emitter> =
                (0..count).map(|i| lamp(Vec3::new(i as f32, 1.0, 0.0), 1.0 + i as f32)).collect();
            emitters.push(lamp(Vec3::new(0.0, 1e3, 0.0), 1e6));
            emitters.push(sky.clone());
            let sizes = vec![1; emitters.len()];
            let pick = Pick::new(&emitters, &sizes, 1e3);
            for p in
                [Vec3::ZERO, Vec3::new(1.0, 1.0, 1e-6), Vec3::new(50.0, -3.0, 7.0), Vec3::new(2.0, 1.0, 0.0)]
            {
                let pmf: Vec<f32> = (0..emitters.len()).map(|i| pick.pmf(p, i)).collect();
                assert!((pmf.iter().sum::<f32>() - 1.0).abs() < 1e-5 && pmf.iter().all(|&x| x >= 0.0));
                let n = 1 << 16;
                let mut hits = vec![0u32; emitters.len()];
                for k in 0..n {
                    let (i, chance) = pick.sample(p, (k as f32 + 0.5) / n as f32).expect("a light");
                    assert!((chance - pmf[i]).abs() <= 1e-6, "{chance} {}", pmf[i]);
                    hits[i] += 1;
                }
                for (h, p) in hits.iter().zip(&pmf) {
                    assert!((*h as f32 / n as f32 - p).abs() < 1e-4, "{h} {p}");
                }
            }
        }
        assert!(Pick::new(&[], &[], 1.0).sample(Vec3::ZERO, 0.5).is_none());
    }
}

//! How far a picture is from what it would become, from nothing but itself.
//!
//! In: a film of replications. Out: an estimate of
//!
//! E = sqrt( mean over pixels of (I - R)^2 / (R^2 + c^2) ),  c = a tenth of the mean of R,
//!
//! in luminance, I being the picture and R what it converges to; and an interval that holds the E that a
//! reference would show, of this very picture, in 95 of 100 renders.
//!
//! *Estimate.* A pixel's (I - R)^2 has the mean v, the variance of I, which the K replication means m_r give
//! without bias. R stands in the denominator, and the picture's own I may not take its place: where a pixel
//! happens to be bright, it would shrink its own error. So the means fall into two halves; v comes from the
//! differences within one, 1 / (R^2 + c^2) from the mean of the other, less its own curvature times the
//! variance of that mean (second order of the delta method), averaged over all ways to halve them.
//!
//! *Interval.* With t = v / (R^2 + c^2) of a pixel, n the pixels, and kappa the excess kurtosis of the m_r, both
//! the estimate and the truth vary: over t^2, by 2/(K-1) + kappa/K and by 2 + kappa/K. Estimates of t have the
//! mean square t^2 (1 + 2/(K-1) + kappa/K). For K = 4 the two together are from 1.6 (normal) to 2 (anything
//! with heavy tails) times the mean square of the estimates, whatever kappa is: so their sum gives the
//! variance without knowing the distribution. Pixels have to be independent for that, as they are where each
//! path lights one pixel. Where a photon lights several, the variance is that many times larger as [`Squares::together`]
//! says.
//!
//! *Photon maps* have a bias, which no noise shows. What wider disks would change does ([`MapBias`]); its square is
//! added to that of the noise, and so are the squares of what both may be off by.
//!
//! *Where it ends.* Half of the replications has to say what R is. Above an E of a quarter it cannot: pixels that no
//! sample of a half lit seem dark, and their error enormous. The estimate is then too large, never too small by
//! that, and is not trusted. Below, what the second order leaves is granted to the interval.

use super::doubt::Shown;
use super::together::Blocks;
use super::{Doubt, Film, MapBias, Tail};
use crate::stats::{ERROR_FLOOR, NORMAL_95, luminance_of};

/// What the squares of the pixels' estimates are taken times; between what normal noise and heavy tails ask for.
const SPREAD: f64 = 1.75;
/// What the delta method leaves of the relative bias of E^2, times E^2: at most, in simulations of uniform,
/// exponential and rare samples up to [`ErrorEstimate::NOISIEST`].
const LEFT: f64 = 1.5;

/// An estimate of the error of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// E, relative: 0.01 is one per cent.
    pub error: f64,
    /// What of it is bias of photon maps, where there are any: E^2 is the square of that and the square of noise.
    pub map_bias: Option<MapBias>,
    /// Lower and upper end of its 95 % interval.
    pub interval: [f64; 2],
    /// How many pixels carry the error, effectively: (sum t)^2 / sum t^2; fewer where their errors go together.
    pub effective_pixels: f64,
    /// Whether the interval can be trusted: there is no doubt.
    pub trusted: bool,
    /// Why not.
    pub doubt: Option<Doubt>,
    /// The few samples that carry much of the light, where the interval cannot be trusted and there are such.
    pub tail: Option<Tail>,
}

impl ErrorEstimate {
    /// Above this error the halves are too noisy to say what they converge to: no estimate is trusted.
    pub const NOISIEST: f64 = 0.25;
    /// Where fewer pixels carry the error, the sum over them is not normal enough for its interval.
    pub const FEWEST_PIXELS: f64 = 60.0;
}

/// What each pixel adds to the square of the error.
#[derive(Clone, Debug, PartialEq)]
pub struct Squares {
    /// Estimates of v / (R^2 + c^2) of each pixel that has samples, row by row; noise may make single ones negative.
    pub of_pixels: Vec<f32>,
    /// How many times the variance of their sum is that of independent pixels, [1, inf).
    pub together: f64,
    /// What the bias of photon maps adds, where there are any.
    pub map_bias: Option<MapBias>,
    /// What of their mean is noise of the photons in maps, about: it falls more slowly than other noise, since disks shrink.
    pub gathered: f64,
}

impl Squares {
    /// The error, and how sure it is; the tail is left out.
    #[must_use]
    pub fn estimate(&self) -> ErrorEstimate {
        let n = self.of_pixels.len().max(1) as f64;
        let (mut sum, mut squares) = (0.0, 0.0);
        for &t in &self.of_pixels {
            let t = f64::from(t);
            sum += t;
            squares += t * t;
        }
        // Noise makes the sum negative only where there is hardly any error.
        let mean = (sum / n).max(0.0);
        let sampling = if sum > 0.0 { SPREAD * self.together * squares / (sum * sum) } else { 0.0 };
        let relative = (sampling + (LEFT * mean) * (LEFT * mean)).sqrt();
        let noise = mean.sqrt();
        // Errors are positive, and their square spreads by a factor: hence the logarithm, halved by the root.
        let factor = libm::exp(0.5 * NORMAL_95 * relative);
        let effective_pixels = if squares > 0.0 { sum * sum / squares } else { n } / self.together;
        let (mut error, mut interval) = (noise, [noise / factor, noise * factor]);
        if let Some(bias) = self.map_bias {
            let square = mean + bias.error * bias.error;
            // How far an end of the square of the whole is from its middle.
            let away = |end: usize| {
                let of = |middle: f64, end: f64| end * end - middle * middle;
                libm::hypot(of(noise, interval[end]), of(bias.error, bias.interval[end]))
            };
            interval = [(square - away(0)).max(0.0).sqrt(), (square + away(1)).sqrt()];
            error = square.sqrt();
        }
        let doubt = if error > ErrorEstimate::NOISIEST {
            Some(Doubt::TooNoisy)
        } else {
            let few = effective_pixels < ErrorEstimate::FEWEST_PIXELS;
            few.then_some(Doubt::FewPixels { carry: effective_pixels })
        };
        ErrorEstimate {
            error,
            map_bias: self.map_bias,
            interval,
            effective_pixels,
            trusted: doubt.is_none(),
            doubt,
            tail: None,
        }
    }
}

impl Film {
    /// The error of the picture that the film holds; `None` where no estimate is possible: fewer than two
    /// replications with samples in some pixel that has any, or nothing but black.
    #[must_use]
    pub fn error(&self) -> Option<ErrorEstimate> {
        Some(self.error_of(&self.error_squares()?))
    }

    /// The same from squares of this film.
    #[must_use]
    pub fn error_of(&self, squares: &Squares) -> ErrorEstimate {
        self.error_beside(squares, self.missing_light(squares.estimate().error))
    }

    /// The same where [`Self::missing_light`] is known, be it of some samples before.
    #[must_use]
    pub fn error_beside(&self, squares: &Squares, light: Option<Doubt>) -> ErrorEstimate {
        let mut found = squares.estimate();
        // What is missing says more than that something may be.
        found.doubt = match light {
            Some(Doubt::LightNotFound { .. }) => light,
            _ => found.doubt.or(light),
        };
        found.trusted = found.doubt.is_none();
        if !found.trusted {
            found.tail = self.tail();
        }
        found
    }

    /// What each pixel shows; nothing where one has fewer than two replications.
    pub(super) fn shown(&self) -> Vec<Shown> {
        let k = self.layout.replications as usize;
        let format = self.layout.radiance;
        let (mut all, mut means) = (Vec::with_capacity(self.pixels()), Vec::with_capacity(k));
        for (sums, counts) in self.sums.chunks(k).zip(self.counts.chunks(k)) {
            means.clear();
            let own = sums.iter().zip(counts).filter(|(_, n)| **n > 0);
            means.extend(own.map(|(s, &n)| (luminance_of(s.map(|s| format.about_mean(s, n))), f64::from(n))));
            if means.len() < 2 {
                return Vec::new();
            }
            all.push(Shown { luminance: pooled(&means).0, variance: variance(&means) });
        }
        all
    }

    /// What each pixel adds to the square of the error; `None` as for [`Self::error`].
    #[must_use]
    pub fn error_squares(&self) -> Option<Squares> {
        let k = self.layout.replications as usize;
        let format = self.layout.radiance;
        // The means of the replications of all pixels, where those of each end, and which pixel that is.
        let (mut means, mut ends) =
            (Vec::with_capacity(self.counts.len()), Vec::with_capacity(self.pixels()));
        for (pixel, (sums, counts)) in self.sums.chunks(k).zip(self.counts.chunks(k)).enumerate() {
            let before = means.len();
            for (sums, &n) in sums.iter().zip(counts).filter(|(_, n)| **n > 0) {
                means.push((luminance_of(sums.map(|s| format.about_mean(s, n))), f64::from(n)));
            }
            match means.len() - before {
                0 => {}
                1 => return None,
                _ => ends.push((means.len(), pixel)),
            }
        }
        let pixels = || {
            let begins = std::iter::once(0).chain(ends.iter().map(|e| e.0));
            begins.zip(&ends).map(|(begin, &(end, pixel))| (pixel, &means[begin..end]))
        };
        let total: f64 = pixels().map(|(_, m)| pooled(m).0).sum();
        if total <= 0.0 {
            return None;
        }
        let c = ERROR_FLOOR * total / ends.len() as f64;
        let [.., width, height] = self.layout.crop.map(|n| n as usize);
        let mut blocks = Blocks::new([width, height], k);
        let mut deviations = vec![0.0; k];
        let mut of_pixels = Vec::with_capacity(ends.len());
        for (pixel, own) in pixels() {
            of_pixels.push(relative_variance(own, c) as f32);
            // Pixels that lack a replication have no part in it.
            if own.len() == k {
                let (mean, n) = pooled(own);
                let weight = (k as f64 / (n * (mean * mean + c * c))).sqrt();
                deviations.iter_mut().zip(own).for_each(|(d, m)| *d = weight * m.1.sqrt() * (m.0 - mean));
                blocks.add([pixel % width, pixel / width], &deviations);
            }
        }
        let (map_bias, gathered) = self.map_bias(c).map_or((None, 0.0), |(bias, noise)| (Some(bias), noise));
        Some(Squares { of_pixels, together: blocks.factor(), map_bias, gathered })
    }
}

/// Mean and count of some replications together.
fn pooled(means: &[(f64, f64)]) -> (f64, f64) {
    let n: f64 = means.iter().map(|m| m.1).sum();
    (means.iter().map(|m| m.0 * m.1).sum::<f64>() / n, n)
}

/// Variance of the mean of some replications together.
fn variance(means: &[(f64, f64)]) -> f64 {
    let (mean, n) = pooled(means);
    let sum: f64 = means.iter().map(|m| m.1 * (m.0 - mean) * (m.0 - mean)).sum();
    sum / ((means.len() - 1) as f64 * n)
}

/// Variance of one sample, from the difference of two means.
fn between(a: (f64, f64), b: (f64, f64)) -> f64 {
    (a.0 - b.0) * (a.0 - b.0) / (1.0 / a.1 + 1.0 / b.1)
}

/// An estimate of v / (R^2 + c^2) of a pixel.
fn relative_variance(means: &[(f64, f64)], c: f64) -> f64 {
    let (mean, n) = pooled(means);
    let inverse = |x: f64| 1.0 / (x * x + c * c);
    let &[m0, m1, m2, m3] = means else {
        // Two or three replications cannot be halved; sum and difference of normal numbers are independent.
        return variance(means) * inverse(mean);
    };
    if m0.1 == m1.1 && m1.1 == m2.1 && m2.1 == m3.1 {
        return of_equal([m0.0, m1.0, m2.0, m3.0], c);
    }
    let mut sum = 0.0;
    for [a, b, x, y] in [[m0, m1, m2, m3], [m0, m2, m1, m3], [m0, m3, m1, m2]] {
        for ([a, b], [x, y]) in [([a, b], [x, y]), ([x, y], [a, b])] {
            let (r, r_n) = pooled(&[x, y]);
            let f = inverse(r);
            let curvature = (6.0 * r * r - 2.0 * c * c) * f * f * f;
            sum += between(a, b) / n * (f - 0.5 * curvature * between(x, y) / r_n);
        }
    }
    sum / 6.0
}

/// [`relative_variance`] of four means of equally many samples, where most of the divisions cancel.
fn of_equal([m0, m1, m2, m3]: [f64; 4], c: f64) -> f64 {
    let half = |ab: f64, xy: f64, r: f64| {
        let f = 1.0 / (r * r + c * c);
        let curvature = (6.0 * r * r - 2.0 * c * c) * f * f * f;
        ab * (f - 0.125 * curvature * xy)
    };
    let mut sum = 0.0;
    for [a, b, x, y] in [[m0, m1, m2, m3], [m0, m2, m1, m3], [m0, m3, m1, m2]] {
        let (ab, xy) = ((a - b) * (a - b), (x - y) * (x - y));
        sum += half(ab, xy, 0.5 * (x + y)) + half(xy, ab, 0.5 * (a + b));
    }
    sum / 48.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::{FilmLayout, Sample};
    use crate::math::mix64;

    struct Numbers(u64);

    impl Numbers {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            (mix64(self.0) >> 11) as f64 / (1u64 << 53) as f64
        }

        fn exponential(&mut self) -> f64 {
            -libm::log(1.0 - self.unit())
        }
    }

    const SIDE: u32 = 24;

    /// Pictures of known pixels, whose samples are `draw` times the pixel: how often the interval holds the
    /// true error, and the mean of estimated over true square.
    fn trials(name: u64, passes: u32, draw: impl Fn(&mut Numbers) -> f64) -> (f64, f64, f64) {
        const TRIALS: u32 = 200;
        let mut random = Numbers(name);
        let (mut held, mut ratio, mut trusted) = (0u32, 0.0, 0u32);
        for _ in 0..TRIALS {
            let mut film = Film::new(FilmLayout::plain([SIDE, SIDE]));
            let truth: Vec<f64> = (0..SIDE * SIDE).map(|_| libm::exp(2.0 * random.unit() - 1.0)).collect();
            for (pixel, r) in truth.iter().enumerate() {
                for pass in 0..passes {
                    let radiance = Rgb::grey((r * draw(&mut random)) as f32);
                    film.add(pixel, pass, &Sample { radiance, ..Sample::default() }).expect("a radiance");
                }
            }
            let c = ERROR_FLOOR * truth.iter().sum::<f64>() / truth.len() as f64;
            let image = film.to_image();
            let squares = truth.iter().zip(&image.rgb).map(|(r, i)| {
                let d = f64::from(i.g) - r;
                d * d / (r * r + c * c)
            });
            let e2 = squares.sum::<f64>() / truth.len() as f64;
            let found = film.error().expect("four replications");
            held += u32::from((found.interval[0]..=found.interval[1]).contains(&e2.sqrt()));
            ratio += found.error * found.error / e2;
            trusted += u32::from(found.trusted);
        }
        let share = |n: u32| f64::from(n) / f64::from(TRIALS);
        (share(held), ratio / f64::from(TRIALS), share(trusted))
    }

    /// Guards the claim of the interval: of 200 pictures, 95 % hold the truth, give or take three standard errors
    /// of 1.5 %. Noise of one sample over its pixel is 0.6, 1, and 2.4.
    #[test]
    fn intervals_hold_the_truth() {
        // Uniform, exponential, and light that three samples in ten find.
        let check = |name: u64, passes: u32, draw: &dyn Fn(&mut Numbers) -> f64| {
            let (held, ratio, trusted) = trials(name, passes, draw);
            assert!((0.905..=0.995).contains(&held), "{name}: {held}");
            assert!((ratio - 1.0).abs() < 0.05, "{name}: {ratio}");
            assert!(trusted > 0.99, "{name}: {trusted}");
        };
        check(1, 16, &|n| 2.0 * n.unit());
        check(2, 64, &|n| n.exponential());
        check(3, 256, &|n| if n.unit() < 0.3 { n.exponential() / 0.3 } else { 0.0 });
    }

    /// Guards the short formula by the long one, which takes any counts.
    #[test]
    fn equal_counts_are_no_other_case() {
        let mut random = Numbers(5);
        for _ in 0..100 {
            let m: [f64; 4] = std::array::from_fn(|_| random.exponential());
            let counts = [8.0, 8.0, 8.0, 8.0 * (1.0 + 1e-12)];
            let long: Vec<(f64, f64)> = m.into_iter().zip(counts).collect();
            let (long, short) = (relative_variance(&long, 0.2), of_equal(m, 0.2));
            assert!((long / short - 1.0).abs() < 1e-9, "{long} {short}");
        }
    }

    /// Guards that a picture whose error sits in a few pixels is not trusted.
    #[test]
    fn rare_light_is_not_trusted() {
        let (_, _, trusted) =
            trials(4, 16, |n| if n.unit() < 1e-3 { 1e3 * n.exponential() } else { 0.01 * n.unit() });
        assert!(trusted < 0.05, "{trusted}");
    }

    /// Guards exposure: a picture twice as bright has the same error.
    #[test]
    fn exposure_does_not_matter() {
        let film = |scale: f32| {
            let mut film = Film::new(FilmLayout::plain([4, 4]));
            let mut random = Numbers(7);
            for i in 0..256 {
                let radiance = Rgb::grey(scale * random.unit() as f32);
                film.add(i % 16, i as u32 / 16, &Sample { radiance, ..Sample::default() }).expect("ok");
            }
            film.error().expect("an estimate").error
        };
        assert!((film(1.0) / film(1024.0) - 1.0).abs() < 1e-12);
        assert_eq!(Film::new(FilmLayout::plain([4, 4])).error(), None);
    }
}

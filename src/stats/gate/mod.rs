//! Golden gates: is a new render of a scene, as a whole and in every part, what it used to be?
//!
//! In: *runs*, renders of one scene by one sampler at one length, which differ in the seed alone. Some
//! are pilots: they choose what is looked at ([`Profile`], [`Family::design`]). At least [`FEWEST_RUNS`] others say
//! what each of those statistics does when nothing is wrong ([`Null::new`]). Out: for a run under test,
//! one p-value for each statistic, and a verdict over all of them ([`Null::test`]), and the smallest change
//! that each would notice ([`Null::power`]).
//!
//! The invariant: a statistic takes its variance from its own values over independent runs, never from
//! the variances of pixels or samples. Pixels that share a photon map, a tile of a sampler or a light
//! path are correlated, and samples of a low-discrepancy sequence are not independent; runs are.
//! Pixels' variances only choose weights, where an error costs power and not validity. Since pilots
//! and null runs are different ones, weights cannot be fitted to the noise that they are judged by.
//!
//! Statistics are sums of many pixels, and nearly normal; what skewness is left goes into the p-value
//! (see [`Null`]). Works badly where a statistic hangs on a handful of samples (a caustic that one run
//! in ten sees): its skewness is then so large that nothing but a gross error is called one.
//!
//! Sources: Welch's test over tiles of renders is from Jung, Hanika and Dachsbacher, "Detecting Bias in
//! Monte Carlo Renderers using Welch's t-test", JCGT 9(2), 2020; shared significance from Šidák, JASA
//! 62(318), 1967; the matched filter is the classical detector of a known signal in uncorrelated noise
//! (North, 1943); the curve for skewed sums is Pearson's type III (Phil. Trans. A 186, 1895).

mod family;
mod null;

pub use family::{Family, Kind, Planes, Profile, Statistic, floor};
pub use null::{FEWEST_RUNS, Finding, Null, NullStatistic, Outcome};

#[cfg(test)]
mod tests;

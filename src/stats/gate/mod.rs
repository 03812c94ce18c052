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
//! (see [`Null`]). Light that one run in a hundred sees is the enemy: where no null run met it, the first run under
//! test that does looks like an error. So no pixel may move a sum by more than about a deviation
//! ([`Statistic`]), and tiles whose runs are far from normal are not judged alone, but as a part of larger ones.
//! Works badly for light that most runs do not see: of that nothing but a gross error is called one.
//!
//! Sources: Welch's test over tiles of renders is from Jung, Hanika and Dachsbacher, "Detecting Bias in
//! Monte Carlo Renderers using Welch's t-test", JCGT 9(2), 2020; shared significance from Šidák, JASA
//! 62(318), 1967; the matched filter is the classical detector of a known signal in uncorrelated noise
//! (North, 1943);
//! limited influence is from Huber (Annals of Mathematical Statistics 35, 1964); the curve for skewed sums is Pearson's type III (Phil. Trans. A 186, 1895).

mod family;
mod null;
mod statistic;

pub use family::{Family, Planes, Profile, floor};
pub use null::{FEWEST_RUNS, Finding, Null, NullStatistic, Outcome};
pub use statistic::{Kind, Statistic};

#[cfg(test)]
mod tests;

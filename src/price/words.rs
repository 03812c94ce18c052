//! A price as a line for people.

use std::fmt;

use super::{Better, Price, Priced};
use crate::stats::Interval;

/// `without caustics: 2.8 % (±0.2) darker, pixels off by 14 % (12 to 16); saves 31 % of the rays, ..; better only up to 43
/// samples`. Time is what it took here and now.
impl fmt::Display for Priced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self.shortcuts.iter().map(ToString::to_string).collect();
        let name = if names.len() > 1 { "all of these".to_owned() } else { names.concat() };
        match &self.price {
            Ok(price) => write!(f, "{name}: {price}"),
            Err(reason) => write!(f, "{name}: changes nothing, {reason}"),
        }
    }
}

impl fmt::Display for Price {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}; ", brightness(&self.bias), error(&self.error))?;
        write!(f, "{}", saved(self.work, "rays"))?;
        let [full, short] = self.elapsed.map(|t| t.as_secs_f64());
        if full > 0.0 {
            write!(f, ", {}", saved(short / full, "time"))?;
        }
        match self.better {
            Better::Never => write!(f, ", and is no less noisy for it: never better"),
            Better::Unknown => write!(f, ", and whether it is less noisy does not show"),
            Better::Until(until) if until.value.is_finite() => {
                write!(f, "; better only up to {} samples", round(until.value))
            }
            Better::Until(until) if until.low.is_finite() => {
                write!(f, "; better up to {} samples at least", round(until.low))
            }
            Better::Until(_) => write!(f, "; better as far as can be seen"),
        }
    }
}

/// What a bias does to the picture.
fn brightness(bias: &Interval) -> String {
    let half = bias.within();
    if bias.value == 0.0 && half == 0.0 {
        return "exactly as bright".to_owned();
    }
    if bias.may_be_zero() {
        return format!("as bright within {}", share(half.max(bias.value.abs())));
    }
    let word = if bias.value < 0.0 { "darker" } else { "brighter" };
    format!("{} (\u{b1}{}) {word}", share(bias.value.abs()), digits(100.0 * half, 1))
}

/// What is saved, where the short render takes that share.
fn saved(taken: f64, what: &str) -> String {
    match 1.0 - taken {
        saved if saved >= 0.0005 => format!("saves {} of the {what}", share(saved)),
        saved if saved <= -0.0005 => format!("takes {} more {what}", share(-saved)),
        _ => format!("saves no {what}"),
    }
}

/// How far off pixels are.
fn error(error: &Interval) -> String {
    match error.ends() {
        [_, high] if high <= 0.0 => "pixels the same".to_owned(),
        [low, high] if low <= 0.0 => format!("pixels off by less than {}", share(high)),
        [low, high] => {
            let [low, high] = [low, high].map(|x| digits(100.0 * x, 2));
            format!("pixels off by {} ({low} to {high})", share(error.value))
        }
    }
}

/// A share in per cent, with two digits that count.
fn share(x: f64) -> String {
    format!("{} %", digits(100.0 * x, 2))
}

/// A number with so many digits that count, and all of those before the point.
fn digits(x: f64, count: i32) -> String {
    if !(x.abs() > 0.0 && x.is_finite()) {
        return format!("{x}");
    }
    let places = (count - 1 - libm::floor(libm::log10(x.abs())) as i32).clamp(0, 9) as usize;
    format!("{x:.places$}")
}

/// A number of samples, with two digits that count.
fn round(samples: f64) -> String {
    let unit = libm::exp10((libm::floor(libm::log10(samples.max(1.0))) - 1.0).max(0.0));
    format!("{}", (samples / unit).round() * unit)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::prepare::{Omission, Shortcut};

    fn priced(bias: [f64; 3], error: [f64; 3], work: f64, better: Better) -> String {
        let estimate = |[value, low, high]: [f64; 3]| Interval { value, low, high };
        let price = Price {
            bias: estimate(bias),
            layers: Vec::new(),
            error: estimate(error),
            work,
            variance: 0.5,
            better,
            rays: 9.0,
            elapsed: [Duration::from_secs(2), Duration::from_secs(1)],
        };
        Priced { shortcuts: vec![Shortcut::Without(Omission::Caustics)], price: Ok(price) }.to_string()
    }

    #[test]
    fn lines_say_what_was_measured() {
        let until = |value, low, high| Better::Until(Interval { value, low, high });
        let infinity = f64::INFINITY;
        let lines = [
            priced([-0.0281, -0.0301, -0.0261], [0.14, 0.12, 0.16], 0.69, until(43.2, 30.0, 61.0)),
            priced([0.000_3, -0.001, 0.002], [0.0, 0.0, 0.004], 1.0, Better::Unknown),
            priced([0.25, 0.24, 0.26], [0.3, 0.28, 0.32], 1.031, Better::Never),
            priced([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0.5, until(infinity, infinity, infinity)),
            priced([-0.1, -0.2, -0.01], [0.1, 0.0, 0.2], 0.9, until(infinity, 12_345.0, infinity)),
        ];
        insta::assert_snapshot!(lines.join("\n"), @"
        without caustics: 2.8 % (±0.2) darker, pixels off by 14 % (12 to 16); saves 31 % of the rays, saves 50 % of the time; better only up to 43 samples
        without caustics: as bright within 0.15 %, pixels off by less than 0.40 %; saves no rays, saves 50 % of the time, and whether it is less noisy does not show
        without caustics: 25 % (±1) brighter, pixels off by 30 % (28 to 32); takes 3.1 % more rays, saves 50 % of the time, and is no less noisy for it: never better
        without caustics: exactly as bright, pixels the same; saves 50 % of the rays, saves 50 % of the time; better as far as can be seen
        without caustics: 10 % (±10) darker, pixels off by less than 20 %; saves 10.0 % of the rays, saves 50 % of the time; better up to 12000 samples at least
        ");
        let idle = Priced { shortcuts: vec![Shortcut::Schlick], price: Err("no glass".to_owned()) };
        assert_eq!(idle.to_string(), "Schlick's reflectance: changes nothing, no glass");
    }
}

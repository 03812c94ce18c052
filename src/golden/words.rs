//! Findings as people say them.

use super::run::scalar;
use super::verdict::Reason;
use crate::film::LightLayer;
use crate::stats::gate::{Finding, Kind};

/// A share as per cent with a sign and as many digits as mean something.
pub(super) fn percent(share: f64) -> String {
    let p = 100.0 * share;
    match p.abs() {
        a if a >= 99.5 => format!("{p:+.0} %"),
        a if a >= 9.95 => format!("{p:+.1} %"),
        a if a >= 0.1 => format!("{p:+.2} %"),
        _ => format!("{p:+.4} %"),
    }
}

/// What a shift of a logarithm means, as a change of the number itself.
fn change(shift: f64) -> f64 {
    libm::expm1(shift)
}

/// Standard errors; many are as good as infinitely many.
fn z(z: f64) -> String {
    if z.abs() >= 1000.0 {
        format!("z = {}1000 or more", if z < 0.0 { "-" } else { "+" })
    } else {
        format!("z = {z:+.1}")
    }
}

/// The plane in the words of light.
fn light(plane: &str) -> String {
    match plane {
        "luminance" => "the picture".to_owned(),
        "red" | "green" | "blue" => format!("the {plane} of the picture"),
        "glass" => "light through glass and mirrors".to_owned(),
        "caustic" => "caustic light".to_owned(),
        other => format!("{other} light"),
    }
}

/// What a finding says.
pub(super) fn message(f: &Finding) -> String {
    let z = z(f.z);
    let plane = light(&f.statistic.of);
    match &f.statistic.kind {
        Kind::Image => format!("{plane} {} (relative to each pixel), {z}", percent(f.shift)),
        Kind::Matched => format!("{plane} {}, {z}", percent(f.shift)),
        Kind::Tile { side, at: [x, y] } => {
            format!("{side}x{side} pixels at {x},{y}: {}, {z}", percent(f.shift))
        }
        Kind::Wave { half_waves: [u, v] } => {
            format!("a slow change across the picture ({u}, {v} half waves): {}, {z}", percent(f.shift))
        }
        Kind::Scalar => match f.statistic.of.as_str() {
            scalar::NOISE => format!("variance of the pixels {}, {z}", percent(change(f.shift))),
            scalar::ERROR => format!("error of the pixels {}, {z}", percent(change(f.shift))),
            scalar::SLOPE => format!(
                "error falls as samples to the power of {:.2}, expected {:.2}, {z}",
                f.expected + f.shift,
                f.expected
            ),
            scalar::PEAKS => format!("brightest samples {}, {z}", percent(change(f.shift))),
            other => format!("{other} {:+.3}, {z}", f.shift),
        },
    }
}

/// Whether a finding alone would be good news: less noise.
pub(super) fn is_better(f: &Finding) -> bool {
    f.statistic.kind == Kind::Scalar && f.shift < 0.0
}

/// What is significant, worst first; of tiles and waves, which come in crowds, only the worst few.
pub(super) fn reasons<'a>(significant: impl Iterator<Item = &'a Finding>) -> Vec<Reason> {
    const MOST_PARTS: usize = 2;
    let mut parts = 0;
    let mut found: Vec<&Finding> = significant.collect();
    // Layers name the culprit, then other wholes, then parts; of each the largest z first.
    let part = |f: &Finding| matches!(f.statistic.kind, Kind::Tile { .. } | Kind::Wave { .. });
    let layer = |f: &Finding| {
        f.statistic.kind == Kind::Matched && LightLayer::ALL.iter().any(|l| l.name() == f.statistic.of)
    };
    let rank = |f: &Finding| (part(f), !layer(f));
    found.sort_by(|a, b| rank(a).cmp(&rank(b)).then(b.z.abs().total_cmp(&a.z.abs())));
    found
        .into_iter()
        .filter(|f| {
            parts += usize::from(part(f));
            !part(f) || parts <= MOST_PARTS
        })
        .map(|f| Reason { gate: f.statistic.to_string(), message: message(f), better: is_better(f) })
        .collect()
}

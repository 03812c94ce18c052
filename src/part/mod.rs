//! Parts of a render: some of its passes, made at another time or on another machine.
//!
//! In: films of passes of one render. Out: one film, the same as if all had been rendered together, since sums
//! are exact and a pass needs no other pass. A part says what it is a part of: scene, settings and plan. What
//! differs in any of them is refused, and so is a pass that is there twice; passes that are missing are listed.

mod bytes;

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::film::{Film, StateError};

/// What a part is a part of: everything that samples depend on, by name, as an image file says it of itself
/// (hash of the scene, camera, seed, plan ..), in its order.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity(pub Vec<(String, String)>);

/// Some passes of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What of.
    pub identity: Identity,
    /// How pictures for a screen are made of it, where nothing else is asked for: tone curve, and exposure in stops.
    pub screen: (String, f32),
    /// The passes that the film holds whole: half open, in order, with something between them.
    pub passes: Vec<Range<u32>>,
    /// Their sums.
    pub film: Film,
    /// Rays traced for them.
    pub rays: u64,
    /// Paths cut by the far safety cap.
    pub capped: u64,
}

/// Why bytes are no part, or parts no render.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The bytes do not begin as a part does.
    #[error("this is not a part of a render")]
    NotAPart,
    /// A newer version wrote it.
    #[error("found {found}, expected {expected}: a newer version wrote it")]
    Version {
        /// The schema that it names.
        found: String,
        /// The one that is known.
        expected: &'static str,
    },
    /// The checksum is not that of the bytes.
    #[error("it is damaged or cut short: its checksum is wrong")]
    Damaged,
    /// The header is not one.
    #[error("its header cannot be read: {0}")]
    Header(String),
    /// The sums are not those of the layout.
    #[error(transparent)]
    State(#[from] StateError),
    /// Parts of different renders.
    #[error("they are parts of different renders: {what} is {own} in one and {other} in the other")]
    Mixed {
        /// What differs.
        what: String,
        /// In the first.
        own: String,
        /// In the other.
        other: String,
    },
    /// A pass is there twice.
    #[error("passes {}..{} are there twice", .0.start, .0.end)]
    Overlap(Range<u32>),
}

impl Identity {
    /// Whether `other` is the same render.
    ///
    /// # Errors
    /// What differs, and how.
    pub fn check(&self, other: &Self) -> Result<(), PartError> {
        let value = |of: &Self, name: &str| of.0.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone());
        let names = self.0.iter().chain(&other.0).map(|(name, _)| name);
        for name in names {
            let (own, other) = (value(self, name), value(other, name));
            if own != other {
                let said = |v: Option<String>| v.map_or_else(|| "not given".to_owned(), |v| first(&v));
                return Err(PartError::Mixed { what: name.clone(), own: said(own), other: said(other) });
            }
        }
        Ok(())
    }
}

/// The beginning of a text, for messages.
fn first(text: &str) -> String {
    const MOST: usize = 24;
    match text.char_indices().nth(MOST) {
        Some((at, _)) => format!("{} ..", &text[..at]),
        None => text.to_owned(),
    }
}

impl Part {
    /// Adds another part of the same render.
    ///
    /// # Errors
    /// It is one of another render, or shares passes with this one; this one is then as it was.
    pub fn add(&mut self, other: Self) -> Result<(), PartError> {
        self.identity.check(&other.identity)?;
        let mut passes = self.passes.clone();
        passes.extend(other.passes);
        let passes = join(passes)?;
        self.film.merge(other.film).map_err(|other| {
            let said = |film: &Film| format!("{:?}", film.layout());
            PartError::Mixed { what: "the film".into(), own: said(&self.film), other: said(&other) }
        })?;
        self.passes = passes;
        self.rays += other.rays;
        self.capped += other.capped;
        Ok(())
    }

    /// Passes from the first on that are missing between others.
    #[must_use]
    pub fn gaps(&self) -> Vec<Range<u32>> {
        let mut next = 0;
        let mut gaps = Vec::new();
        for p in &self.passes {
            if p.start > next {
                gaps.push(next..p.start);
            }
            next = p.end;
        }
        gaps
    }

    /// Number of passes.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.passes.iter().map(|p| p.end - p.start).sum()
    }
}

/// Ranges in order, neighbours as one.
fn join(mut ranges: Vec<Range<u32>>) -> Result<Vec<Range<u32>>, PartError> {
    ranges.retain(|r| !r.is_empty());
    ranges.sort_by_key(|r| (r.start, r.end));
    let mut joined: Vec<Range<u32>> = Vec::new();
    for r in ranges {
        match joined.last_mut() {
            Some(last) if r.start < last.end => return Err(PartError::Overlap(r.start..last.end.min(r.end))),
            Some(last) if r.start == last.end => last.end = r.end,
            _ => joined.push(r),
        }
    }
    Ok(joined)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;
    use crate::film::{FilmLayout, Sample};

    fn part(passes: Range<u32>) -> Part {
        let mut film = Film::new(FilmLayout::plain([2, 2]));
        for pass in passes.clone() {
            for pixel in 0..4 {
                let radiance = Rgb::new(0.3, pixel as f32, 1.0 / (1.0 + pass as f32));
                film.add(pixel, pass, &Sample { radiance, ..Sample::default() }).expect("a radiance");
            }
        }
        let identity = [("scene_sha256", "0123"), ("seed", "1")]
            .map(|(name, value)| (name.to_owned(), value.to_owned()));
        let identity = Identity(identity.into());
        let rays = u64::from(passes.end - passes.start);
        Part {
            identity,
            screen: ("srgb".into(), 0.0),
            passes: std::iter::once(passes).collect(),
            film,
            rays,
            capped: 0,
        }
    }

    /// Guards that parts in any order are the whole, and that gaps are known.
    #[test]
    fn parts_in_any_order_are_the_whole() {
        let mut sum = part(8..11);
        sum.add(part(0..3)).expect("other passes");
        assert_eq!(sum.gaps(), std::iter::once(3..8).collect::<Vec<_>>());
        assert_eq!(sum.count(), 6);
        sum.add(part(3..8)).expect("the passes between");
        assert_eq!(sum, part(0..11));
        assert_eq!(Part::from_bytes(&sum.to_bytes()).expect("a part"), sum);
    }

    /// Guards what is refused, in words, and that a refusal changes nothing.
    #[test]
    fn strangers_and_twins_are_refused() {
        let mut sum = part(0..8);
        let mut refuse = |other: Part| {
            let said = sum.add(other).expect_err("refused").to_string();
            assert_eq!(sum, part(0..8));
            said
        };
        assert_eq!(refuse(part(6..9)), "passes 6..8 are there twice");
        let mut seed = part(8..9);
        seed.identity.0[1].1 = "2".into();
        assert_eq!(refuse(seed), "they are parts of different renders: seed is 1 in one and 2 in the other");
        let mut capped = part(8..9);
        capped.identity.0.push(("max_depth".into(), "a text that is longer than what is shown of it".into()));
        assert_eq!(
            refuse(capped),
            "they are parts of different renders: max_depth is not given in one and a text that is longer th .. in \
             the other"
        );
    }

    /// Guards that a file that was cut short at any byte, or changed at any, is refused.
    #[test]
    fn damaged_bytes_are_refused() {
        let whole = part(0..3).to_bytes();
        for n in 0..whole.len() {
            Part::from_bytes(&whole[..n]).expect_err("cut short");
            let mut changed = whole.clone();
            changed[n] ^= 1;
            Part::from_bytes(&changed).expect_err("changed");
        }
    }
}

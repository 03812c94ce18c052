//! What a render simulates, what it leaves out, and why: a plan for people and for programs.
//!
//! In: a [`Plan`], and the notes on the way to its scene. Out: aligned lines, each of which begins with what it is
//! about, so that it can be searched; and the same as data. This is the one home of those words.

use std::fmt;

use serde::Serialize;

use crate::prepare::{Effects, Plan, Shortcut};
use crate::scene::{Note, NoteEffect};

/// A plan, and what was noticed on the way to its scene.
#[derive(Clone, Copy, Debug)]
pub struct Explanation<'a> {
    plan: &'a Plan,
    notes: &'a [Note],
}

/// What a line is about.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    Simulated,
    LeftOut,
    NotModelled,
    Differs,
    Kernel,
    Algorithm,
    Shortcut,
}

impl Section {
    fn word(self) -> &'static str {
        match self {
            Self::Simulated => "simulated",
            Self::LeftOut => "left out",
            Self::NotModelled => "not modelled",
            Self::Differs => "differs",
            Self::Kernel => "kernel",
            Self::Algorithm => "algorithm",
            Self::Shortcut => "shortcut",
        }
    }

    /// Escape codes that begin its colour: what lacks in the picture stands out, what cannot matter stands back.
    fn colour(self) -> &'static str {
        match self {
            Self::Simulated => "\u{1b}[32m",
            Self::LeftOut => "\u{1b}[2m",
            Self::NotModelled | Self::Shortcut => "\u{1b}[1;33m",
            Self::Differs => "\u{1b}[33m",
            Self::Kernel | Self::Algorithm => "\u{1b}[36m",
        }
    }
}

struct Line {
    section: Section,
    what: String,
    why: String,
}

impl<'a> Explanation<'a> {
    /// Explains `plan`; `notes` are those of reading, repairing and completing its scene.
    #[must_use]
    pub fn new(plan: &'a Plan, notes: &'a [Note]) -> Self {
        Self { plan, notes }
    }

    /// The lines with colours for a terminal.
    #[must_use]
    pub fn coloured(&self) -> String {
        self.text(|section, word| format!("{}{word}\u{1b}[0m", section.colour()))
    }

    fn text(&self, paint: impl Fn(Section, &str) -> String) -> String {
        let lines = self.lines();
        let width = lines.iter().map(|l| l.what.chars().count()).max().unwrap_or(0).max(14);
        let line = |l: &Line| {
            let word = paint(l.section, &format!("{:<12}", l.section.word()));
            format!("{word}  {:<width$}  {}", l.what, l.why).trim_end().to_owned()
        };
        lines.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    fn lines(&self) -> Vec<Line> {
        let mut lines = Vec::new();
        let mut add = |section, what: &str, why: String| lines.push(Line { section, what: what.into(), why });
        for need in &self.plan.needs {
            let more = if need.count > 1 { format!(" (and {} more)", need.count - 1) } else { String::new() };
            add(Section::Simulated, need.effect.name(), format!("{}{more}", need.witness));
        }
        for left in &self.plan.left_out {
            add(Section::LeftOut, left.effect.name(), left.reason.clone());
        }
        for unseen in &self.plan.unseen {
            add(Section::NotModelled, unseen.what, unseen.reason.clone());
        }
        for (effect, section) in
            [(NoteEffect::Missing, Section::NotModelled), (NoteEffect::Differs, Section::Differs)]
        {
            for note in self.notes.iter().filter(|n| n.effect == effect) {
                add(section, note.code, note.to_string());
            }
        }
        add(Section::Kernel, self.plan.kernel().name, kernel_reason(self.plan).to_owned());
        for choice in &self.plan.choices {
            add(Section::Algorithm, choice.about, format!("{}: {}", choice.chosen, choice.reason));
        }
        for shortcut in &self.plan.shortcuts {
            add(Section::Shortcut, &shortcut.to_string(), shortcut.flag());
        }
        lines
    }
}

/// As a pipe receives it.
impl fmt::Display for Explanation<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(|_, word| word.to_owned()))
    }
}

fn kernel_reason(plan: &Plan) -> &'static str {
    let simulates = plan.kernel().simulates;
    if simulates == plan.effects() {
        "simulates exactly this"
    } else if plan.tables == Effects::EVERYTHING {
        "as asked for: simulates all there is, with all tables"
    } else {
        "the smallest that simulates all of this"
    }
}

/// A plan as data.
#[derive(Clone, Debug, Serialize)]
pub struct PlanFacts<'a> {
    simulated: Vec<Simulated<'a>>,
    left_out: Vec<LeftOut<'a>>,
    not_modelled: Vec<NotModelled<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kernel: Option<Kernel>,
    algorithms: Vec<Algorithm<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shortcuts: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct Simulated<'a> {
    effect: &'static str,
    witness: &'a str,
    count: usize,
}

#[derive(Clone, Debug, Serialize)]
struct LeftOut<'a> {
    effect: &'static str,
    reason: &'a str,
}

#[derive(Clone, Debug, Serialize)]
struct NotModelled<'a> {
    what: &'static str,
    reason: &'a str,
}

#[derive(Clone, Debug, Serialize)]
struct Kernel {
    name: &'static str,
    reason: &'static str,
}

#[derive(Clone, Debug, Serialize)]
struct Algorithm<'a> {
    about: &'static str,
    chosen: &'a str,
    reason: &'a str,
}

impl<'a> From<&'a Plan> for PlanFacts<'a> {
    fn from(plan: &'a Plan) -> Self {
        let simulated = plan.needs.iter().map(|n| Simulated {
            effect: n.effect.name(),
            witness: &n.witness,
            count: n.count,
        });
        let left_out = plan.left_out.iter().map(|l| LeftOut { effect: l.effect.name(), reason: &l.reason });
        let not_modelled = plan.unseen.iter().map(|u| NotModelled { what: u.what, reason: &u.reason });
        let algorithms =
            plan.choices.iter().map(|c| Algorithm { about: c.about, chosen: &c.chosen, reason: &c.reason });
        Self {
            simulated: simulated.collect(),
            left_out: left_out.collect(),
            not_modelled: not_modelled.collect(),
            kernel: Some(Kernel { name: plan.kernel().name, reason: kernel_reason(plan) }),
            algorithms: algorithms.collect(),
            shortcuts: plan.shortcuts.iter().map(Shortcut::flag).collect(),
        }
    }
}

impl PlanFacts<'_> {
    /// The facts that decide what a picture is: the kernel changes no bit of it, and is not among them.
    #[must_use]
    pub fn of_picture(self) -> Self {
        Self { kernel: None, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prepare::{Caustics, Choice, Effect, LeftOut, Need, Unseen};

    /// Guards the alignment of all columns, the order of sections, and that colour adds nothing but colour.
    #[test]
    fn lines_are_aligned_and_colour_is_only_colour() {
        let note = |code, effect| Note { code, place: "nodes[3]".into(), message: "is lost".into(), effect };
        let notes = [
            note("harmless", NoteEffect::None),
            note("tangents-invalid", NoteEffect::Differs),
            note("skin-ignored", NoteEffect::Missing),
        ];
        let plan = Plan {
            needs: vec![Need { effect: Effect::Mirror, witness: "material \"Ü\"".into(), count: 3 }],
            left_out: vec![LeftOut { effect: Effect::Lens, reason: "the camera is a pinhole".into() }],
            unseen: vec![Unseen { what: "caustics", reason: "light \"L\"".into() }],
            choices: vec![Choice {
                about: "light",
                chosen: "none".into(),
                reason: "there is no light".into(),
            }],
            tables: Effects::of(&[Effect::Mirror]),
            kernel: 1,
            replications: 4,
            caustics: Caustics::Path,
            indirect: crate::prepare::Indirect::Path,
            shortcuts: Vec::new(),
            light_samples: 1,
            split: 1,
            roulette: 4,
        };
        let explanation = Explanation::new(&plan, &notes);
        insta::assert_snapshot!(explanation.to_string(), @r#"
        simulated     mirror            material "Ü" (and 2 more)
        left out      lens              the camera is a pinhole
        not modelled  caustics          light "L"
        not modelled  skin-ignored      nodes[3]: is lost
        differs       tangents-invalid  nodes[3]: is lost
        kernel        report            the smallest that simulates all of this
        algorithm     light             none: there is no light
        "#);
        let mut bare = String::new();
        for part in explanation.coloured().split('\u{1b}') {
            bare += part.strip_prefix('[').and_then(|p| p.split_once('m')).map_or(part, |(_, rest)| rest);
        }
        assert_eq!(bare, explanation.to_string());
    }
}

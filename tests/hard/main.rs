//! The catalogue of hard cases (`epsilux check`), as tests: each by its id, with what it guards.

use epsilux::check::{Bound, Effort, cases};

/// Measures a case, and fails with its figures where one is out of its bound.
fn run(id: &str) {
    let case =
        cases().into_iter().find(|c| c.id == id).unwrap_or_else(|| panic!("{id} is not in the catalogue"));
    let figures = (case.run)(Effort::Usual);
    assert!(!figures.is_empty(), "{id} measures nothing");
    let line = |f: &epsilux::check::Figure| {
        let bound = match f.bound {
            Bound::Exactly(v) => format!("expected {v}"),
            Bound::AtMost(v) => format!("at most {v:e}"),
            Bound::AtLeast(v) => format!("at least {v:e}"),
        };
        format!("{} {}: {:e}, {bound}", if f.holds() { "  " } else { "! " }, f.what, f.value)
    };
    let lines: Vec<String> = figures.iter().map(line).collect();
    assert!(figures.iter().all(epsilux::check::Figure::holds), "{id}: {}\n{}", case.guards, lines.join("\n"));
}

/// One test for each id, so that a failure names it and they run side by side.
macro_rules! hard_cases {
    ($($id:ident)*) => {
        const IDS: &[&str] = &[$(stringify!($id)),*];
        $(
            #[test]
            #[allow(non_snake_case)]
            fn $id() {
                run(stringify!($id));
            }
        )*
    };
}

hard_cases! {
    N01 N02 N03 N04 N05 N06 N07 N08 N09 N10 N11 N12 N13 N14 N15 N16 N17 N18 N19 N20 N21 N22 N23 N24 N25 N26 N27 N28 N29 N30 N31 N32 N33 N34 N35 N36 N37 N38 N39 N40 N41 N42 N43 N44 N45 N46 N47 N48 N49 N50 N51 N52 N53 N54 N55 N56 N57 N58 N59 N60 N61 N62 N63 N64 N65 N66 N67 N68 N69 N70 N71 N72 N73 N74 N75
}

/// Guards against a case that is in the catalogue and not here.
#[test]
fn every_case_is_a_test() {
    let catalogue: Vec<&str> = cases().iter().map(|c| c.id).collect();
    assert_eq!(catalogue, IDS);
}

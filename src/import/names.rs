//! Makes names unique.

use std::collections::{HashMap, HashSet};

/// Hands out names, each once.
#[derive(Default)]
pub(crate) struct Names {
    taken: HashSet<String>,
    next: HashMap<String, usize>,
}

impl Names {
    /// `wanted`, or where that is taken `wanted.2`, `wanted.3` and so on.
    pub(crate) fn unique(&mut self, wanted: &str) -> String {
        if self.taken.insert(wanted.into()) {
            return wanted.into();
        }
        let next = self.next.entry(wanted.into()).or_insert(2);
        loop {
            let name = format!("{wanted}.{next}");
            *next += 1;
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_even_beside_names_that_look_like_ours() {
        let mut names = Names::default();
        let given: Vec<_> = ["a", "a.2", "a", "a", ""].map(|n| names.unique(n)).into();
        assert_eq!(given, ["a", "a.2", "a.3", "a.4", ""]);
    }
}

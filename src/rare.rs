//! Accidents that may happen, but rarely: a claim beside the code that lives with them, and its proof in tests.
//!
//! `rarely!(p, condition)` *is* the condition, and claims that it is true with a probability of at most `p`. What is
//! done then loses light, or is a little wrong, which is right only as long as the claim is. In: conditions. Out, in
//! the crate's own unit tests and nowhere else: how often each was tried and true in this thread ([`counted`]). So a
//! render costs nothing for it, results cannot depend on it, nothing panics on input, and tests that run side by side
//! do not see each other. Source of the idea: `CHECK_RARE` of pbrt-v4.

/// `rarely!(p, condition)` is `condition`.
#[cfg(not(test))]
macro_rules! rarely {
    ($p:expr, $condition:expr) => {
        $condition
    };
}

/// `rarely!(p, condition)` is `condition`, counted.
#[cfg(test)]
macro_rules! rarely {
    ($p:expr, $condition:expr) => {{
        std::thread_local! {
            static COUNT: std::cell::Cell<[u64; 2]> = const { std::cell::Cell::new([0; 2]) };
        }
        let claim = || $crate::rare::Claim { place: file!(), condition: stringify!($condition), most: $p };
        $crate::rare::count(&COUNT, $condition, claim)
    }};
}

pub(crate) use rarely;

#[cfg(test)]
pub(crate) use counting::{Claim, Counted, count, counted};

#[cfg(test)]
mod counting {
    use std::cell::{Cell, RefCell};
    use std::thread::LocalKey;

    /// How often something was tried, and how often it was true.
    type Count = LocalKey<Cell<[u64; 2]>>;

    thread_local! {
        static SEEN: RefCell<Vec<(Claim, &'static Count)>> = const { RefCell::new(Vec::new()) };
    }

    /// What is claimed.
    #[derive(Clone, Copy)]
    pub(crate) struct Claim {
        /// The file.
        pub(crate) place: &'static str,
        /// What is rare.
        pub(crate) condition: &'static str,
        /// Its largest probability.
        pub(crate) most: f64,
    }

    /// A claim, and what this thread saw of it.
    #[derive(Clone, Copy)]
    pub(crate) struct Counted {
        pub(crate) claim: Claim,
        pub(crate) tried: u64,
        pub(crate) happened: u64,
    }

    impl Counted {
        /// Whether the claim can be true: as many or more accidents would be a chance of less than 1e-5. (A Poisson
        /// variable of mean m exceeds m + 4.5 sqrt(m) + 8 less often than that, at any m.)
        pub(crate) fn is_rare(&self) -> bool {
            let mean = self.claim.most * self.tried as f64;
            self.happened as f64 <= mean + 4.5 * mean.sqrt() + 8.0
        }

        /// What was seen, a line for people.
        pub(crate) fn says(&self) -> String {
            let Claim { place, condition, most } = self.claim;
            format!("{place}: {condition}: {} of {}, at most {most:e}", self.happened, self.tried)
        }
    }

    pub(crate) fn count(count: &'static Count, happened: bool, claim: impl FnOnce() -> Claim) -> bool {
        let [tried, times] = count.get();
        if tried == 0 {
            SEEN.with_borrow_mut(|seen| seen.push((claim(), count)));
        }
        count.set([tried + 1, times + u64::from(happened)]);
        happened
    }

    /// All claims that this thread has come by.
    pub(crate) fn counted() -> Vec<Counted> {
        let read = |&(claim, count): &(Claim, &'static Count)| {
            let [tried, happened] = count.get();
            Counted { claim, tried, happened }
        };
        SEEN.with_borrow(|seen| seen.iter().map(read).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Guards that a false claim is noticed, a true one is not, and the condition is passed on.
    #[test]
    fn false_claims_are_noticed() {
        let mut times = 0;
        for i in 0..100_000u32 {
            times += u32::from(rarely!(1e-3, i % 1000 == 0));
            times += u32::from(rarely!(5e-4, i % 1000 == 1));
        }
        assert_eq!(times, 200);
        let verdicts: Vec<(u64, u64, bool)> =
            counted().iter().map(|c| (c.tried, c.happened, c.is_rare())).collect();
        assert_eq!(verdicts, [(100_000, 100, true), (100_000, 100, false)]);
    }
}

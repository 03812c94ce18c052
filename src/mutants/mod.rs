//! Deliberate faults, by which golden tests and hard cases are tested: a suite that cannot fail proves nothing.
//!
//! `planted!(name(x, ..))` marks a place where a fault can be. It *is* `x`: the macro drops everything else,
//! so code reads as if only `x` stood there, and compiles as if it did. Who wants to understand the renderer
//! need not look further.
//!
//! Built with `--cfg epsilux_mutants` the same words call the function `name` of `faults`, which spoils `x`
//! where the environment variable `EPSILUX_MUTANT` names its `Mutant`, and leaves it alone otherwise. `list`
//! says which there are, what each does and which gates and hard cases have to notice; `cargo xtask golden mutate`
//! and `cargo xtask hard --mutants` go through them. The invariant: no release has any of it, since this does not compile without debug assertions.

#[cfg(all(epsilux_mutants, not(debug_assertions)))]
compile_error!(
    "--cfg epsilux_mutants plants faults on purpose: only builds with debug assertions may have it"
);

#[cfg(epsilux_mutants)]
pub(crate) mod faults;
#[cfg(epsilux_mutants)]
mod list;

#[cfg(epsilux_mutants)]
pub use list::Mutant;

/// `planted!(name(x, ..))` is `x`.
#[cfg(not(epsilux_mutants))]
macro_rules! planted {
    ($fault:ident($sound:expr $(, $more:expr)* $(,)?)) => {
        $sound
    };
}

/// `planted!(name(x, ..))` is `x`, or what the mutant of that name makes of it.
#[cfg(epsilux_mutants)]
macro_rules! planted {
    ($fault:ident($sound:expr $(, $more:expr)* $(,)?)) => {
        $crate::mutants::faults::$fault($sound $(, $more)*)
    };
}

pub(crate) use planted;

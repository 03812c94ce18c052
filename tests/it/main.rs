//! Fast tests of the repository and of the whole program.

mod command;
mod compare;
mod help;
mod mistakes;
mod render;
mod tidy;
